# SPDX-License-Identifier: BSD-3-Clause
"""What the package of Python adds to C, and what its peers take for the same questions: python3 tests/bench/python_ticks.py
BUILD, where dynpoint is installed. Times are of the thread's processor; C and Python take turns, and the least of each
counts. Peers are measured where they are installed: trimesh, open3d, fcl (python-fcl), coal."""
import csv
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

import dynpoint as dp

build = Path(sys.argv[1])
SEGMENTS = int(sys.argv[2]) if len(sys.argv) > 2 else 1000000
out = csv.writer(sys.stdout)
out.writerow(("what", "ns", "over C, ns", "ratio to C", "error, m"))


def timed(work, count):
    began = time.thread_time_ns()
    work(count)
    return (time.thread_time_ns() - began) / count


def in_c(mesh, *arguments):
    return float(subprocess.run([build / "tests/bench/python_ticks", mesh, *map(str, arguments)], check=True,
                                capture_output=True, text=True).stdout)


def ticks(path):
    mesh = dp.Mesh.load(path)
    world = dp.World()
    world.add_body(mesh)
    tool = world.add_tool([0, 0, 0], [0, 0.1, 0], 0.002)
    pose, wrench = np.array([0, 0.5, 0, 1, 0, 0, 0.0]), np.zeros(6)

    def three(count):
        set_pose, step, get_wrench = tool.set_pose, world.step, tool.get_wrench
        for _ in range(count):
            set_pose(pose)
            step(0.001)
            get_wrench(wrench)

    def one(count):
        tick = tool.tick
        for _ in range(count):
            tick(pose, 0.001, wrench)

    def nothing(count):
        for _ in range(count):
            pass

    count, least = 200000, {}
    for _ in range(7):
        for name, took in (("C", in_c(path, "ticks", count)), ("three calls", timed(three, count)),
                           ("one call", timed(one, count)), ("an empty loop", timed(nothing, count))):
            least[name] = min(took, least.get(name, took))
    for name, took in least.items():
        out.writerow((f"tick: {name}", f"{took:.0f}", f"{took - least['C']:.0f}", f"{took / least['C']:.2f}", ""))


def exact(mesh, ends):
    return mesh.query(ends, pair=1)["distance"]


def trimesh_(vertices, triangles, ends):
    """The nearest of 64 points a segment."""
    import trimesh
    points = between(ends)
    near = trimesh.proximity.ProximityQuery(trimesh.Trimesh(vertices, triangles, process=False)).on_surface(points)[1]
    return near.reshape(len(ends), -1).min(axis=1)


def open3d_(vertices, triangles, ends):
    import open3d
    scene = open3d.t.geometry.RaycastingScene(nthreads=1)
    scene.add_triangles(vertices.astype(np.float32), triangles)
    return scene.compute_distance(between(ends).astype(np.float32), nthreads=1).numpy().reshape(len(ends), -1).min(axis=1)


def between(ends):
    share = np.linspace(0, 1, 64)[:, None]
    return (ends[:, None, :3] * (1 - share) + ends[:, None, 3:] * share).reshape(-1, 3)


def frame_of(end):
    """Rotation and centre of a capsule along z."""
    axis = end[3:] - end[:3]
    z = axis / np.linalg.norm(axis)
    x = np.cross(z, [1, 0, 0] if abs(z[0]) < 0.9 else [0, 1, 0])
    x /= np.linalg.norm(x)
    return np.column_stack((x, np.cross(z, x), z)), (end[:3] + end[3:]) / 2, np.linalg.norm(axis)


def fcl_(vertices, triangles, ends):
    import fcl
    model = fcl.BVHModel()
    model.beginModel(len(vertices), len(triangles))
    model.addSubModel(vertices, triangles)
    model.endModel()
    body, answers = fcl.CollisionObject(model), []
    for end in ends:
        rotation, centre, length = frame_of(end)
        tool = fcl.CollisionObject(fcl.Capsule(1e-6, length), fcl.Transform(rotation, centre))
        answers.append(fcl.distance(body, tool, fcl.DistanceRequest(), fcl.DistanceResult()))
    return np.maximum(np.array(answers), 0)


def coal_(vertices, triangles, ends):
    import coal
    model = coal.BVHModelOBBRSS()
    model.beginModel(len(triangles), len(vertices))
    model.addVertices(vertices)
    model.addTriangles(triangles.astype(np.int64))
    model.endModel()
    request, here, answers = coal.DistanceRequest(), coal.Transform3s(), []
    for end in ends:
        rotation, centre, length = frame_of(end)
        there = coal.Transform3s(rotation, centre)
        answers.append(coal.distance(model, here, coal.Capsule(1e-6, length), there, request, coal.DistanceResult()))
    return np.maximum(np.array(answers), 0)


def queries(path, room):
    mesh = dp.Mesh.load(path)
    numbers = np.random.default_rng(5)
    middle = (mesh.info.box_min + mesh.info.box_max) / 2
    size = mesh.info.box_max - mesh.info.box_min
    ends = np.empty((SEGMENTS, 6))
    ends[:, :3] = middle + size * numbers.uniform(-0.8, 0.8, (SEGMENTS, 3))
    ends[:, 3:] = ends[:, :3] + numbers.normal(0, 0.03, (SEGMENTS, 3))
    file = room / "ends"
    ends.tofile(file)
    hits, least = np.zeros(SEGMENTS, dp.HIT), {}
    for _ in range(3):
        for name, took in (("C", in_c(path, "query", SEGMENTS, file)),
                           ("dynpoint", timed(lambda count: mesh.query(ends, out=hits), SEGMENTS))):
            least[name] = min(took, least.get(name, took))
    began = time.perf_counter_ns()
    mesh.query(ends, threads=2, out=hits)
    least["dynpoint, 2 threads, wall clock"] = (time.perf_counter_ns() - began) / SEGMENTS
    least["dynpoint, the pair alone"] = timed(lambda count: exact(mesh, ends), SEGMENTS)
    for name, took in least.items():
        out.writerow((f"segment: {name}", f"{took:.0f}", f"{took - least['C']:.0f}", f"{took / least['C']:.3f}", "0" if name != "C" else ""))
    few = ends[:2000]
    truth = exact(mesh, few)
    for name, peer in (("trimesh, 64 points", trimesh_), ("Open3D, 64 points", open3d_), ("python-fcl", fcl_), ("coal", coal_)):
        try:
            answers = []
            took = timed(lambda count: answers.append(peer(mesh.vertices.astype(float), mesh.triangles.copy(), few)), len(few))
        except ImportError as error:
            print(f"{name}: not measured: {error}", file=sys.stderr)
            continue
        wrong = np.abs(answers[0] - truth)
        missed = np.count_nonzero((truth == 0) & (answers[0] > 1e-5)) / max(1, np.count_nonzero(truth == 0))
        out.writerow((f"segment: {name}", f"{took:.0f}", f"{took - least['C']:.0f}", f"{took / least['C']:.1f}",
                      f"{wrong.max():.2g}; crossings missed: {missed:.0%}"))


with tempfile.TemporaryDirectory() as folder:
    room = Path(folder)
    subprocess.run([build / "dynpoint", "make", "liver", "-o", room / "liver.obj"], check=True)
    subprocess.run([build / "dynpoint", "compile", room / "liver.obj", "-o", room / "liver.dpa"], check=True, capture_output=True)
    ticks(room / "liver.dpa")
    sys.stdout.flush()
    queries(room / "liver.dpa", room)
