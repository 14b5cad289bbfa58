# SPDX-License-Identifier: BSD-3-Clause
"""What a user writes, for mypy --strict; it is not run."""
from pathlib import Path

import numpy as np
import numpy.typing as npt

import dynpoint as dp


def feel(path: Path, poses: npt.NDArray[np.float64]) -> list[float]:
    mesh = dp.Mesh.load(path, unit="mm")
    forces: list[float] = []
    out = np.zeros(6)
    with dp.World(budget=3000) as world:
        body: dp.Body = world.add_body(mesh, static_friction=0.3)
        tool = world.add_tool([0, 0, 0], [0, 0, 0.1], radius=0.002)
        body.stiffness = 800.0
        for pose in poses:
            wrench: npt.NDArray[np.float64] = tool.tick(pose, 0.001, out)
            forces.append(float(wrench[1]))
    hits = mesh.query(np.zeros((4, 6)), threads=2)
    nearest: float = float(hits["distance"].min())
    return [*forces, nearest, float(mesh.distance(poses[:, :3])[0])]


def push(state: object, wrench: npt.NDArray[np.float64], dt: float) -> None:
    wrench[1] = 1.0


def serve(name: str) -> int:
    with dp.Device(name) as device:
        return int(dp.Loop(device, push, guard={"force_max": 2.0}).run(ticks=100).ticks)
