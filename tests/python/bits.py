# SPDX-License-Identifier: BSD-3-Clause
"""What the package answers, for another machine to answer alike: python3 bits.py MESH.obj UNIT TRACE.csv prints a
digest of a compiled mesh's bytes, of nearest pairs, of wrenches and of a recording. With the files MESH.dpa and
TOLD.csv that `dynpoint compile` and `dynpoint replay` wrote of the same it compares them too, bit for bit."""

import csv
import hashlib
import sys
import tempfile
from pathlib import Path

import numpy as np

import dynpoint as dp

mesh = dp.Mesh.load(sys.argv[1], unit=sys.argv[2])
ends = np.ascontiguousarray(np.loadtxt(sys.argv[3], delimiter=",", skiprows=1)[:, 1:])


def show(what, content):
    print(what, hashlib.sha256(content).hexdigest()[:32], flush=True)


show("mesh", bytes(mesh))
hits = mesh.query(ends, radius=0.002, threads=2)
show(
    "pairs",
    b"".join(np.ascontiguousarray(hits[name]).tobytes() for name in ("distance", "gap", "p", "q", "triangle", "flags")),
)
with dp.World() as world:
    world.add_body(mesh)
    tool = world.add_tool(ends[0, :3], ends[0, 3:], 0.002)
    felt, far = [], []
    for row in ends:
        tool.set_segments(row[:3], row[3:], 0.002)
        world.step(0.001)
        felt.append(tool.wrench)
        far.append(float(tool.hit.distance))
assert np.any(felt)
if len(sys.argv) > 4:
    assert bytes(mesh) == Path(sys.argv[4]).read_bytes()
    with open(sys.argv[5]) as told:
        rows = [row for row in csv.DictReader(told)]
    known = [i for i, row in enumerate(rows) if row["distance"]]
    assert len(rows) == len(ends) and len(known) >= 50 and np.any(np.array(felt)[known])
    for i in known:
        assert far[i] == float(rows[i]["distance"]), i
        assert felt[i].tolist() == [float(rows[i][name]) for name in ("fx", "fy", "fz", "tx", "ty", "tz")], i
    print("as C", len(known), "ticks")
show("wrenches", np.array(felt).tobytes())
with tempfile.TemporaryDirectory() as room:
    with dp.Scene("soft-liver", "sim:?hand=press", ticks=300, record=Path(room) / "r.dpr") as scene:
        scene.run()
    show("recording", dp.Recording(Path(room) / "r.dpr").records["asked"].tobytes())
