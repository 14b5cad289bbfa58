# SPDX-License-Identifier: BSD-3-Clause
"""MuJoCo's physics, dynpoint's contact. Tool and bodies move in MuJoCo; what the tool touches and feels, of soft bodies
(flex) and of rigid geoms, comes from dynpoint; the loads go back into MuJoCo's next step. docs/physics.md.

    model = mujoco.MjModel.from_xml_path("scene.xml")     # the tool's geoms have contype="0" conaffinity="0"
    data = mujoco.MjData(model)
    touch = Touch(model, data, tool="probe", flexes=["organ"], geoms=["bone"])
    for each step:
        touch.step()                                      # mj_step, and the ticks of dynpoint within it
        touch.wrench                                      # what the tool feels, N and Nm
"""
from __future__ import annotations

from importlib import import_module
from typing import Any, Dict, List, Optional, Sequence, Tuple

import numpy as np
import numpy.typing as npt

from ._mesh import Mesh
from ._structs import Floats, Records
from ._tissue import Tissue, between
from ._world import Body, World, make_segments

mujoco: Any = import_module("mujoco")

_BOX = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)
_BOX_TRIANGLES = np.array([[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6],
                           [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]])


def _id(model: Any, kind: Any, name: str) -> int:
    number = int(mujoco.mj_name2id(model, kind, name))
    if number < 0:
        raise ValueError(f"the model has no {kind.name.removeprefix('mjOBJ_').lower()} '{name}'")
    return number


def _quaternion(matrix: Floats) -> Floats:
    quaternion = np.zeros(4)
    mujoco.mju_mat2Quat(quaternion, matrix)
    return quaternion


class Flex(Tissue):
    """A soft body of MuJoCo's."""

    def __init__(self, model: Any, data: Any, name: str, world: World, compliance: float, load_radius: float,
                 settings: Dict[str, Any]) -> None:
        number = _id(model, mujoco.mjtObj.mjOBJ_FLEX, name)
        facts = model.flex_vertadr, model.flex_vertnum, model.flex_dim
        first, count, dimension = (int(array[number]) for array in facts)
        self.rows = slice(first, first + count)
        self.is_sheet = dimension == 2
        if dimension == 2:
            at, size = int(model.flex_elemdataadr[number]), int(model.flex_elemnum[number])
            corners = np.asarray(model.flex_elem[at:at + 3 * size]).reshape(-1, 3)
        elif dimension == 3:
            at, size = int(model.flex_shelldataadr[number]), int(model.flex_shellnum[number])
            corners = np.asarray(model.flex_shell[at:at + 3 * size]).reshape(-1, 3)
        else:
            raise ValueError(f"flex '{name}' has no surface: its dimension is {dimension}")
        if int(model.flex_interp[number]):
            raise ValueError(f"flex '{name}': its vertices follow few nodes, which have no load for each of them")
        super().__init__(world, data.flexvert_xpos[self.rows], corners, compliance, load_radius, **settings)
        self.is_foreseen = False
        self.vertex_bodies = np.asarray(model.flex_vertbodyid[self.rows])


def measure_compliance(model: Any, data: Any, flex: str, push: float = 0.01, samples: int = 12) -> float:
    """How far a newton that acts on a vertex in one step has moved it by the end of the step, m/N: some vertices are
    pushed in a copy of the state, and the median is told. Vertices that do not move are left out."""
    number = _id(model, mujoco.mjtObj.mjOBJ_FLEX, flex)
    first, count = int(model.flex_vertadr[number]), int(model.flex_vertnum[number])
    found = []

    def stepped(vertex: Optional[int]) -> Floats:
        copy = mujoco.MjData(model)
        copy.qpos[:], copy.qvel[:], copy.ctrl[:], copy.act[:] = data.qpos, data.qvel, data.ctrl, data.act
        copy.mocap_pos[:], copy.mocap_quat[:], copy.time = data.mocap_pos, data.mocap_quat, data.time
        if vertex is not None:
            copy.xfrc_applied[model.flex_vertbodyid[vertex], 2] = push
        mujoco.mj_step(model, copy)
        mujoco.mj_kinematics(model, copy)
        mujoco.mj_flex(model, copy)
        return np.array(copy.flexvert_xpos)

    rest = stepped(None)
    for vertex in np.unique(np.linspace(first, first + count - 1, samples).astype(int)):
        moved = float(np.linalg.norm(stepped(int(vertex))[vertex] - rest[vertex])) / push
        if moved > 1e-9:
            found.append(moved)
    if not found:
        raise ValueError(f"flex '{flex}': none of its vertices moves")
    return float(np.median(found))


def _shape_of(model: Any, geom: int) -> Tuple[Floats, npt.NDArray[Any]]:
    """A geom's surface in its own frame: a mesh or a box."""
    kind = int(model.geom_type[geom])
    if kind == mujoco.mjtGeom.mjGEOM_BOX:
        return _BOX * model.geom_size[geom], _BOX_TRIANGLES
    if kind != mujoco.mjtGeom.mjGEOM_MESH:
        raise ValueError(f"geom {geom}: wanted a mesh or a box")
    number = int(model.geom_dataid[geom])
    vertex, face = int(model.mesh_vertadr[number]), int(model.mesh_faceadr[number])
    return (np.array(model.mesh_vert[vertex:vertex + int(model.mesh_vertnum[number])], float),
            np.array(model.mesh_face[face:face + int(model.mesh_facenum[number])]))


class Touch:
    """A tool of MuJoCo's, felt by dynpoint.

    tool       the body that carries it; its capsules and spheres are the tool. A mocap body is moved by you, any other
               one by MuJoCo with what the tool feels
    flexes     names of soft bodies, of dimension 2 or 3
    geoms      names of meshes and boxes, felt as rigid; their bodies get what the tool does to them
    ticks      of dynpoint in a step of MuJoCo's
    settings   of flexes and geoms alike: static_friction and so on
    Of flexes  load_radius, m; compliance, m/N: by name, or None: it is measured
    foresees   names of flexes of which each step is made once more, in a copy, to see where it leads: what is light goes on
               by its speed, and the tool shakes without. None: those of dimension 2. Only those that have a compliance
    """

    def __init__(self, model: Any, data: Any, *, tool: str, flexes: Sequence[str] = (), geoms: Sequence[str] = (),
                 ticks: int = 1, load_radius: float = 0.0, compliance: Optional[Dict[str, float]] = None,
                 foresees: Optional[Sequence[str]] = None, world: Optional[Dict[str, Any]] = None,
                 tool_settings: Optional[Dict[str, Any]] = None, max_points: int = 16, **settings: Any) -> None:
        mujoco.mj_forward(model, data)
        self.model, self.data, self.ticks = model, data, ticks
        self.dt = model.opt.timestep / ticks
        self.world = World(**{"max_bodies": max(1, len(flexes) + len(geoms)), **(world or {})})
        self.tool_body = _id(model, mujoco.mjtObj.mjOBJ_BODY, tool)
        ends = self._tool_segments(tool)
        self.flexes: List[Flex] = []
        for name in flexes:
            given = (compliance or {}).get(name)
            self.flexes.append(Flex(model, data, name, self.world, measure_compliance(model, data, name) if given is None
                                    else given, load_radius, {"max_points": max_points}))
        unknown = set(foresees or ()) - set(flexes)
        if unknown:
            raise ValueError(f"foresees: '{sorted(unknown)[0]}' is none of the flexes")
        for name, flex in zip(flexes, self.flexes):
            flex.is_foreseen = flex.answers and (flex.is_sheet if foresees is None else name in foresees)
        self._ahead = mujoco.MjData(model) if any(flex.is_foreseen for flex in self.flexes) else None
        self.geoms = [_id(model, mujoco.mjtObj.mjOBJ_GEOM, name) for name in geoms]
        self.bodies: List[Body] = []
        for geom in self.geoms:
            places, triangles = _shape_of(model, geom)
            self.bodies.append(self.world.add_body(Mesh.compile(places, triangles, unit="m"), self._geom_pose(geom)))
        for body in (*self.bodies, *(flex.body for flex in self.flexes)):
            body.set_settings(**settings)
        self.tool = self.world.add_tool(ends, **(tool_settings or {}))
        self.tool.teleport(self._tool_pose())
        self.wrench: Floats = np.zeros(6)
        self.mean_wrench: Floats = np.zeros(6)
        self.body_wrenches: Floats = np.zeros((len(self.geoms), 6))
        self._applied: Floats = np.zeros((model.nbody, 6))

    def _tool_segments(self, name: str) -> Records:
        model, made = self.model, []
        for geom in range(int(model.body_geomadr[self.tool_body]), int(model.body_geomadr[self.tool_body] +
                                                                      model.body_geomnum[self.tool_body])):
            kind = int(model.geom_type[geom])
            if kind not in (mujoco.mjtGeom.mjGEOM_CAPSULE, mujoco.mjtGeom.mjGEOM_SPHERE):
                continue
            half = np.zeros(3)
            if kind == mujoco.mjtGeom.mjGEOM_CAPSULE:
                mujoco.mju_rotVecQuat(half, np.array([0, 0, model.geom_size[geom][1]]), model.geom_quat[geom])
            made.append(make_segments(model.geom_pos[geom] - half, model.geom_pos[geom] + half, model.geom_size[geom][0]))
        if not made:
            raise ValueError(f"body '{name}' has neither capsules nor spheres")
        return np.concatenate(made)

    def _tool_pose(self) -> Floats:
        return np.concatenate((self.data.xpos[self.tool_body], self.data.xquat[self.tool_body]))

    def _geom_pose(self, geom: int) -> Floats:
        return np.concatenate((self.data.geom_xpos[geom], _quaternion(self.data.geom_xmat[geom])))

    def _apply(self, body: int, force: Floats, torque: Floats, point: Floats) -> None:
        """A wrench about a point, on a body, beside what others apply."""
        self._applied[body, :3] += force
        self._applied[body, 3:] += torque + np.cross(point - self.data.xipos[body], force)

    def step(self) -> None:
        """One step of MuJoCo's, with the mean of what the tool did since the last one; then dynpoint's ticks. What you
        apply in data.xfrc_applied stays there."""
        model, data = self.model, self.data
        self._applied[:] = 0
        for flex in self.flexes:
            forces = flex.take()
            places = data.flexvert_xpos[flex.rows]
            for vertex in np.flatnonzero(forces.any(1)):  # one that is pinned to a body loads that
                self._apply(int(flex.vertex_bodies[vertex]), forces[vertex], np.zeros(3), places[vertex])
        for geom, wrench in zip(self.geoms, self.body_wrenches):
            self._apply(int(model.geom_bodyid[geom]), wrench[:3], wrench[3:], data.geom_xpos[geom])
        if model.body_mocapid[self.tool_body] < 0:
            self._apply(self.tool_body, self.mean_wrench[:3], self.mean_wrench[3:], data.xpos[self.tool_body])
        others = data.xfrc_applied.copy()
        data.xfrc_applied += self._applied
        mujoco.mj_step(model, data)
        if self._ahead is not None:
            mujoco.mj_copyData(self._ahead, model, data)
            mujoco.mj_step(model, self._ahead)
        data.xfrc_applied[:] = others
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        mujoco.mj_flex(model, data)
        if self._ahead is not None:
            mujoco.mj_kinematics(model, self._ahead)
            mujoco.mj_flex(model, self._ahead)
        for flex in self.flexes:
            ahead = self._ahead.flexvert_xpos[flex.rows] if self._ahead is not None and flex.is_foreseen else None
            flex.give(data.flexvert_xpos[flex.rows], ahead)
        self._feel()

    def _feel(self) -> None:
        """dynpoint's ticks, on the way of tool and geoms from where they were."""
        goal = self._tool_pose()
        self.mean_wrench[:] = 0
        self.body_wrenches[:] = 0
        begin = self.tool.pose
        starts = [body.pose for body in self.bodies]
        goals = [self._geom_pose(geom) for geom in self.geoms]
        for tick in range(1, self.ticks + 1):
            part = tick / self.ticks
            self.tool.set_pose(between(begin, goal, part))
            for body, start, end in zip(self.bodies, starts, goals):
                if not np.array_equal(start, end):
                    body.set_pose(between(start, end, part))
            self.world.step(self.dt)
            for flex in self.flexes:
                flex.tick(self.dt)
            self.wrench = self.tool.wrench
            self.mean_wrench += self.wrench / self.ticks
            for row, body in zip(self.body_wrenches, self.bodies):
                row += body.wrench / self.ticks


__all__ = ["Flex", "Touch", "measure_compliance"]
