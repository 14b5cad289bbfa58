# SPDX-License-Identifier: BSD-3-Clause
"""The nearest pair of segments and a liver, by this package and by others of Python in one run: python3
tests/bench/python_peers.py PROGRAM [SEGMENTS], where dynpoint is installed, and trimesh with rtree, Open3D, python-fcl
and coal (tests/bench/requirements-python.txt), as far as they are there. Prints docs/python.md's table: time of the
processor, and the error by brute force over all triangles in double precision. What takes long answers the first
segments alone."""

import subprocess
import sys
import tempfile
import time
from importlib import import_module
from importlib.metadata import version
from pathlib import Path

import numpy as np

import dynpoint as dp

SEGMENTS = int(sys.argv[2]) if len(sys.argv) > 2 else 1000000
JUDGED = min(400, SEGMENTS)
TOUCH = 1e-5  # m: who says more of a segment that goes through the surface has missed that


def dot(a, b):
    return np.einsum("...i,...i->...", a, b)


def to_segment(points, a, b):
    """Squared distances of points to segments."""
    along = b - a
    length = dot(along, along)
    s = np.clip(
        np.divide(
            dot(points - a, along),
            length,
            out=np.zeros(np.broadcast_shapes(points.shape, a.shape)[:-1]),
            where=length > 0,
        ),
        0,
        1,
    )
    rest = points - a - s[..., None] * along
    return dot(rest, rest)


def segments_apart(p, q, a, b):
    """Squared distances of one segment and many: at an end, or between the two lines where that lies within both."""
    u, v, w = q - p, b - a, p - a
    uu, uv, vv, uw, vw = dot(u, u), dot(v, u), dot(v, v), dot(w, u), dot(v, w)
    size = uu * vv - uv * uv
    with np.errstate(divide="ignore", invalid="ignore"):
        s, t = (uv * vw - vv * uw) / size, (uu * vw - uv * uw) / size
        rest = w + s[:, None] * u - t[:, None] * v
        inner = np.where((size > 0) & (s >= 0) & (s <= 1) & (t >= 0) & (t <= 1), dot(rest, rest), np.inf)
    ends = np.minimum(
        np.minimum(to_segment(p, a, b), to_segment(q, a, b)), np.minimum(to_segment(a, p, q), to_segment(b, p, q))
    )
    return np.fmin(inner, ends)


class Judge:
    """The least distance over all triangles: of edges, of ends above a triangle's inside, and 0 where a segment goes
    through."""

    def __init__(self, corners):
        self.a, self.b, self.c = corners[:, 0], corners[:, 1], corners[:, 2]
        self.normal = np.cross(self.b - self.a, self.c - self.a)
        self.size = dot(self.normal, self.normal)

    def above(self, points):
        """Whether points, one or one a triangle, are above the inside of each triangle."""
        inside = self.size > 0
        for one, other in ((self.a, self.b), (self.b, self.c), (self.c, self.a)):
            inside = inside & (dot(np.cross(other - one, points - one), self.normal) >= 0)
        return inside

    def distance(self, p, q):
        least = min(
            segments_apart(p, q, one, other).min()
            for one, other in ((self.a, self.b), (self.b, self.c), (self.c, self.a))
        )
        heights = [dot(point - self.a, self.normal) for point in (p, q)]
        for point, height in zip((p, q), heights):
            over = self.above(point)
            if over.any():
                least = min(least, (height[over] ** 2 / self.size[over]).min())
        with np.errstate(divide="ignore", invalid="ignore"):
            at = heights[0] / (heights[0] - heights[1])
            hit = p + at[:, None] * (q - p)
            through = (heights[0] * heights[1] <= 0) & (heights[0] != heights[1]) & self.above(np.nan_to_num(hit))
        return 0.0 if through.any() else float(np.sqrt(least))


def by_dynpoint(mesh, ends, **settings):
    def answer(count):
        return mesh.query(ends[:count], **settings)["distance"]

    return answer


def by_points(distances, ends, points):
    """The nearest of points along each segment, as who has no segments does."""
    shares = np.linspace(0, 1, points)[:, None]

    def answer(count):
        a, b = ends[:count, None, :3], ends[:count, None, 3:]
        return distances((a + shares * (b - a)).reshape(-1, 3)).reshape(-1, points).min(axis=1)

    return answer


def by_trimesh(vertices, triangles, ends):
    trimesh = import_module("trimesh")
    mesh = trimesh.Trimesh(vertices, triangles, process=False)
    return by_points(lambda points: trimesh.proximity.closest_point(mesh, points)[1], ends, 8)


def by_open3d(vertices, triangles, ends, points):
    o3d = import_module("open3d")
    scene = o3d.t.geometry.RaycastingScene(nthreads=1)
    scene.add_triangles(o3d.core.Tensor(vertices), o3d.core.Tensor(triangles))
    return by_points(
        lambda p: scene.compute_distance(o3d.core.Tensor(p.astype(np.float32)), nthreads=1).numpy(), ends, points
    )


def turns(ends):
    """Middle, length, and a rotation of z onto each segment."""
    along = ends[:, 3:] - ends[:, :3]
    length = np.linalg.norm(along, axis=1)
    z = along / length[:, None]
    x = np.cross(z, np.where(np.abs(z[:, :1]) < 0.9, [[1.0, 0, 0]], [[0, 1.0, 0]]))
    x /= np.linalg.norm(x, axis=1)[:, None]
    return (ends[:, :3] + ends[:, 3:]) / 2, length, np.stack((x, np.cross(z, x), z), axis=2)


THIN = 1e-6  # m: the radius of the capsule that stands for a segment; it is added again


def by_fcl(vertices, triangles, ends):
    fcl = import_module("fcl")
    model = fcl.BVHModel()
    model.beginModel(len(vertices), len(triangles))
    model.addSubModel(vertices.astype(float), triangles)
    model.endModel()
    body = fcl.CollisionObject(model)

    def answer(count):
        found = np.empty(count)
        middles, lengths, rotations = turns(ends[:count])
        for i in range(count):
            tool = fcl.CollisionObject(fcl.Capsule(THIN, lengths[i]), fcl.Transform(rotations[i], middles[i]))
            found[i] = fcl.distance(body, tool, fcl.DistanceRequest(), fcl.DistanceResult())
        return np.maximum(found + THIN, 0)

    return answer


def by_coal(vertices, triangles, ends):
    coal = import_module("coal")
    points, faces = coal.StdVec_Vec3s(), coal.StdVec_Triangle()
    for vertex in vertices.astype(float):
        points.append(vertex)
    for triangle in triangles.tolist():
        faces.append(coal.Triangle(*triangle))
    model = coal.BVHModelOBBRSS()
    model.beginModel(len(faces), len(points))
    model.addSubModel(points, faces)
    model.endModel()
    here, request = coal.Transform3s.Identity(), coal.DistanceRequest()

    def answer(count):
        found = np.empty(count)
        middles, lengths, rotations = turns(ends[:count])
        for i in range(count):
            result = coal.DistanceResult()
            found[i] = coal.distance(
                model, here, coal.Capsule(THIN, lengths[i]), coal.Transform3s(rotations[i], middles[i]), request, result
            )
        return np.maximum(found + THIN, 0)

    return answer


def row(name, answer, count, truth):
    """Time of count segments; errors of those that were judged."""
    answer(min(100, count))
    began = time.process_time()
    found = answer(count)
    took = (time.process_time() - began) / count
    judged = min(len(truth), count)
    error = np.abs(found[:judged] - truth[:judged])
    through = truth[:judged] == 0
    missed = np.count_nonzero(found[:judged][through] > TOUCH)
    print(
        f"| {name} | {count:,} | {1e6 * took:,.1f} | {1e6 * error.max():.3g} | {missed} of {np.count_nonzero(through)} |",
        flush=True,
    )


def main():
    with tempfile.TemporaryDirectory() as room:
        subprocess.run([sys.argv[1], "make", "liver", "-o", Path(room) / "liver.obj"], check=True)
        mesh = dp.Mesh.load(Path(room) / "liver.obj", unit="m")
    vertices, triangles = np.array(mesh.vertices), np.array(mesh.triangles)
    numbers = np.random.default_rng(5)
    middle, size = (mesh.info.box_min + mesh.info.box_max) / 2, mesh.info.box_max - mesh.info.box_min
    ends = np.empty((SEGMENTS, 6))
    ends[:, :3] = middle + size * numbers.uniform(-0.8, 0.8, (SEGMENTS, 3))
    ends[:, 3:] = ends[:, :3] + numbers.normal(0, 0.03, (SEGMENTS, 3))
    judge = Judge(vertices.astype(float)[triangles])
    truth = np.array([judge.distance(row[:3], row[3:]) for row in ends[:JUDGED]])
    print(
        f"{len(triangles):,} triangles; {JUDGED:,} segments judged, "
        f"of which {np.count_nonzero(truth == 0)} go through the surface"
    )
    print("\n| | segments | us each | error, um, at most | crossings missed |\n|---|---|---|---|---|")
    row(f"dynpoint {dp.__version__}, `pair=1`", by_dynpoint(mesh, ends, pair=1), SEGMENTS, truth)
    row("dynpoint, with gap and depth", by_dynpoint(mesh, ends), SEGMENTS, truth)
    for package, module, name, make, count in (
        ("coal", "coal", "coal {}, a thin capsule", by_coal, 20000),
        ("python-fcl", "fcl", "python-fcl {}, a thin capsule", by_fcl, 20000),
        ("open3d-cpu", "open3d", "Open3D {}, 8 points", lambda *mesh: by_open3d(*mesh, 8), 10000),
        ("open3d-cpu", "open3d", "Open3D {}, 64 points", lambda *mesh: by_open3d(*mesh, 64), 2000),
        ("trimesh", "trimesh", "trimesh {}, 8 points", by_trimesh, 400),
    ):
        try:
            import_module(module)
        except ImportError:
            print(f"{package}: not installed", file=sys.stderr)
            continue
        row(name.format(version(package)), make(vertices, triangles, ends), min(count, SEGMENTS), truth)


main()
