# SPDX-License-Identifier: BSD-3-Clause
"""What the package of Python adds to C: python3 tests/bench/python_ticks.py BUILD [SEGMENTS], where dynpoint is installed and
BUILD/tests/bench/python_ticks made. Times are of the thread's processor; C and Python take turns, and the least of each
counts."""
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
out.writerow(("what", "ns", "over C, ns", "ratio to C"))


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
        out.writerow((f"tick: {name}", f"{took:.0f}", f"{took - least['C']:.0f}", f"{took / least['C']:.2f}"))


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
    least["dynpoint, the pair alone"] = timed(lambda count: mesh.query(ends, pair=1, out=hits), SEGMENTS)
    for name, took in least.items():
        out.writerow((f"segment: {name}", f"{took:.0f}", f"{took - least['C']:.0f}", f"{took / least['C']:.3f}"))


with tempfile.TemporaryDirectory() as folder:
    room = Path(folder)
    subprocess.run([build / "dynpoint", "make", "liver", "-o", room / "liver.obj"], check=True)
    subprocess.run([build / "dynpoint", "compile", room / "liver.obj", "-o", room / "liver.dpa"], check=True, capture_output=True)
    ticks(room / "liver.dpa")
    sys.stdout.flush()
    queries(room / "liver.dpa", room)
