# SPDX-License-Identifier: BSD-3-Clause
"""Newton's physics, dynpoint's contact. Particles and bodies move in Newton, on any device of Warp's; what the tool
touches and feels comes from dynpoint; the loads go into the state of Newton's next step. docs/physics.md.

    touch = Touch(model, state_0, segments=make_segments(a, b, radius), dt=0.005, ticks=5, compliance=compliance)
    for each step:
        state_0.clear_forces()
        touch.load(state_0)                               # what the tool did
        solver.step(state_0, state_1, control, contacts, 0.005)
        touch.feel(state_1, pose)                         # where all is now, and the device
        touch.wrench                                      # N and Nm
        state_0, state_1 = state_1, state_0
"""
from __future__ import annotations

from typing import Any, Dict, List, Optional, Sequence, Tuple

import numpy as np

from ._mesh import Mesh
from ._structs import Floats, Numbers, Records
from ._tissue import Tissue, between
from ._world import Body, World


def _pose(transform: Any) -> Floats:
    """A transform of Warp's has the quaternion's w last."""
    at = np.asarray(transform, np.float64)
    return np.concatenate((at[:3], at[6:7], at[3:6]))


def measure_compliance(model: Any, solver: Any, state: Any, dt: float, particles: Sequence[int], *, push: float = 0.05,
                       control: Any = None, contacts: Any = None) -> float:
    """How far a newton that acts on a particle in one step has moved it by the end of the step, m/N: some particles are
    pushed, in states of their own, and the median is told."""
    before, after = model.state(), model.state()
    before.assign(state)

    def stepped(particle: Optional[int]) -> Floats:
        before.clear_forces()
        forces = np.zeros((model.particle_count, 3), np.float32)
        if particle is not None:
            forces[particle, 2] = push
        before.particle_f.assign(forces)
        solver.step(before, after, control, contacts, dt)
        return np.array(after.particle_q.numpy(), np.float64)

    rest = stepped(None)
    found = [np.linalg.norm(stepped(particle)[particle] - rest[particle]) / push for particle in particles]
    moved = [float(compliance) for compliance in found if compliance > 1e-9]
    if not moved:
        raise ValueError("none of these particles moves")
    return float(np.median(moved))


class Touch:
    """A tool that you move, felt by dynpoint.

    segments    capsules, in the tool's frame (dynpoint.make_segments)
    triangles   the soft body's surface, in numbers of particles; None: all that the model has
    compliance  m/N, of a step of Newton's (measure_compliance); 0: it is not told
    bodies      rigid ones: pairs of a body's number and its Mesh, in the body's frame
    dt, ticks   Newton's step, s, and how many of dynpoint's are in it
    settings    of the soft body and the rigid ones: static_friction and so on
    """

    def __init__(self, model: Any, state: Any, *, segments: Records, dt: float, ticks: int = 1, triangles: Any = None,
                 compliance: float = 0.0, load_radius: float = 0.0, bodies: Sequence[Tuple[int, Mesh]] = (),
                 max_points: int = 16, world: Optional[Dict[str, Any]] = None,
                 tool_settings: Optional[Dict[str, Any]] = None, **settings: Any) -> None:
        self.dt, self.ticks = dt / ticks, ticks
        self.world = World(**{"max_bodies": len(bodies) + 1, **(world or {})})
        self.tissue: Optional[Tissue] = None
        if model.particle_count:
            corners = np.asarray(model.tri_indices.numpy() if triangles is None else triangles).reshape(-1, 3)
            self.tissue = Tissue(self.world, state.particle_q.numpy(), corners, compliance, load_radius,
                                 max_points=max_points)
            self.tissue.body.set_settings(**settings)
        self.numbers = [number for number, _ in bodies]
        places = state.body_q.numpy() if bodies else ()
        self.centres: List[Floats] = [np.asarray(model.body_com.numpy()[number], np.float64) for number in self.numbers]
        self.bodies: List[Body] = [self.world.add_body(mesh, _unit(_pose(places[number])), **settings)
                                   for number, mesh in bodies]
        self.tool = self.world.add_tool(segments, **(tool_settings or {}))
        self.is_placed = False
        self.wrench: Floats = np.zeros(6)
        self.mean_wrench: Floats = np.zeros(6)
        self.body_wrenches: Floats = np.zeros((len(bodies), 6))

    def load(self, state: Any) -> None:
        """Add what the tool did since the last step to the state's forces."""
        if self.tissue:
            forces = state.particle_f.numpy() + self.tissue.take()
            state.particle_f.assign(forces.astype(np.float32))
        if self.bodies:
            wrenches = np.array(state.body_f.numpy())
            for number, body, centre, wrench in zip(self.numbers, self.bodies, self.centres, self.body_wrenches):
                arm = _turned(body.pose, centre)  # torques are about the centre of mass there, and about the origin here
                wrenches[number] += np.concatenate((wrench[:3], wrench[3:] - np.cross(arm, wrench[:3])))
            state.body_f.assign(wrenches.astype(np.float32))

    def feel(self, state: Any, pose: Numbers) -> None:
        """Positions after a step, and where the device is by its end; dynpoint's ticks on the way. The first time the
        tool jumps there."""
        goal = np.asarray(pose, np.float64)
        goal = np.concatenate((goal, (1.0, 0.0, 0.0, 0.0))) if len(goal) == 3 else goal
        if self.tissue:
            self.tissue.give(state.particle_q.numpy())
        places = state.body_q.numpy() if self.bodies else ()
        if not self.is_placed:
            self.tool.teleport(goal)
            self.is_placed = True
        begin, starts = self.tool.pose, [body.pose for body in self.bodies]
        self.mean_wrench[:] = 0
        self.body_wrenches[:] = 0
        for tick in range(1, self.ticks + 1):
            part = tick / self.ticks
            self.tool.set_pose(between(begin, goal, part))
            for number, body, start in zip(self.numbers, self.bodies, starts):
                body.set_pose(_unit(between(start, _pose(places[number]), part)))
            self.world.step(self.dt)
            if self.tissue:
                self.tissue.tick(self.dt)
            self.wrench = self.tool.wrench
            self.mean_wrench += self.wrench / self.ticks
            for row, body in zip(self.body_wrenches, self.bodies):
                row += body.wrench / self.ticks


def _turned(pose: Floats, vector: Floats) -> Floats:
    axis = pose[4:]
    once = 2 * np.cross(axis, vector)
    turned: Floats = vector + pose[3] * once + np.cross(axis, once)
    return turned


def _unit(pose: Floats) -> Floats:
    """Newton's quaternions are float32."""
    return np.concatenate((pose[:3], pose[3:] / np.linalg.norm(pose[3:])))


__all__ = ["Touch", "measure_compliance"]
