# SPDX-License-Identifier: BSD-3-Clause
"""A soft body of somebody else's physics, as a body that gives way: what adapters share."""
from __future__ import annotations

from typing import Any, Optional

import numpy as np
import numpy.typing as npt

from ._mesh import Mesh
from ._structs import LOAD, Floats, Records
from ._world import DeformableBody, World


class Tissue:
    """Vertices in the numbers of their owner, who moves them; the loads of tools, for the owner's next step.

    places       (n, 3), m, in the world: all that the owner has
    corners      (m, 3): triangles of the surface, in the owner's numbers
    compliance   m/N: how far a newton that acts on a vertex in a step of the owner's has moved it by the end of the
                 step; 0: it is not told, and the loads are those of the last tick
    """

    def __init__(self, world: World, places: Any, corners: Any, compliance: float, load_radius: float,
                 **settings: Any) -> None:
        used, corners = np.unique(corners, return_inverse=True)
        self.count = len(places)
        self.mesh = Mesh.compile(np.asarray(places)[used], corners.reshape(-1, 3), unit="m")
        self.order: npt.NDArray[np.int64] = used[self.mesh.vertex_sources]  # the owner's number of each of ours
        self.answers = compliance > 0
        self.body: DeformableBody = world.add_deformable(self.mesh, compliance=compliance, load_radius=load_radius,
                                                         **settings)
        self._taken: Records = np.zeros(0, LOAD)

    def take(self) -> Floats:
        """(n, 3), N: what tools did to the owner's vertices, the mean since this was asked last."""
        self._taken = self.body.mean_loads[0].copy() if self.answers else self.body.loads
        forces = np.zeros((self.count, 3))
        np.add.at(forces, self.order[self._taken["vertex"]], self._taken["force"])
        return forces

    def give(self, places: Any, foreseen: Optional[Any] = None) -> None:
        """The owner's positions after the step that had what `take` told; and, of a body that answers, where the next step
        will lead if these loads stay: what is light needs it to be still."""
        if self.answers:
            self.body.answer(self._taken)
        self.body.vertices = np.ascontiguousarray(np.asarray(places)[self.order], np.float32)
        if self.answers and foreseen is not None:
            self.body.foresee(np.ascontiguousarray(np.asarray(foreseen)[self.order], np.float32))

    def tick(self, dt: float) -> None:
        """After a step of the world: it gives way, and the tool feels so."""
        if self.answers:
            self.body.step(None, dt)


def between(a: Floats, b: Floats, part: float) -> Floats:
    """A pose on the way from one to the other."""
    if part == 1:
        return b
    turn = b[3:] if a[3:] @ b[3:] >= 0 else -b[3:]
    mixed = np.concatenate((a[:3] + part * (b[:3] - a[:3]), a[3:] + part * (turn - a[3:])))
    mixed[3:] /= np.linalg.norm(mixed[3:])
    return mixed
