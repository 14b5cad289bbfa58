# SPDX-License-Identifier: BSD-3-Clause
"""Worlds: bodies, tools, the step, and what it found."""
from __future__ import annotations

from types import TracebackType
from typing import Any, Mapping, Optional, Sequence, Tuple, Type, Union

import numpy as np
import numpy.typing as npt

from . import _dynpoint
from ._mesh import Mesh
from ._structs import (CHANNEL, CONTACT, FORCE, HIT, LOAD, REGION, SEGMENT, SPRINGS_INFO, STEP, SWEEP, TOOL_LOAD,
                       WORLD_INFO, Floats, Force, Numbers, Records, room)


def make_segments(a: Any, b: Any = None, radius: Any = 0.0) -> Records:
    """Structs of SEGMENT: from ends (3) or (n, 3) each, and radii.

    >>> make_segments([0, 0, 0], [0, 0, 0.1], 0.002)["radius"]
    array([0.002])
    """
    if b is None:
        given = np.asarray(a)
        if given.dtype.itemsize != SEGMENT.itemsize:
            raise TypeError("wanted ends a and b, or an array of dynpoint.SEGMENT")
        return np.ascontiguousarray(given)
    first, second = np.atleast_2d(np.asarray(a, np.float64)), np.atleast_2d(np.asarray(b, np.float64))
    if first.shape != second.shape or first.shape[1] != 3:
        raise TypeError(f"a, b: wanted numbers of shape (3) or (n, 3), not {np.shape(a)} and {np.shape(b)}")
    segments = np.zeros(len(first), SEGMENT)
    segments["a"], segments["b"], segments["radius"] = first, second, radius
    return segments


def _setting(name: str, doc: str) -> Any:
    def get(self: Any) -> Any:
        return self.get_setting(name)

    def put(self: Any, value: Any) -> None:
        self.set_settings(**{name: value})

    return property(get, put, doc=doc)


class World(_dynpoint.World):
    """Bodies, and tools that feel them. Keywords are those of dpt_world_def, as budget, margin, max_contacts. One thread at a
    time may be in it. It closes with its block: `with World() as world`, or when nobody has it.

    >>> world = World(max_contacts=8)
    >>> mesh = Mesh.compile([[-1, 0, -1], [1, 0, -1], [0, 0, 1]], [[0, 2, 1]], unit="m")
    >>> body = world.add_body(mesh)
    >>> tool = world.add_tool([0, 0, 0], [0, 0.1, 0], radius=0.01)
    >>> for height in (0.1, 0.05, 0.005):
    ...     tool.set_pose([0, height, 0])
    ...     world.step(0.001)
    >>> tool.wrench.round(2).tolist()
    [0.0, 2.5, 0.0, 0.0, 0.0, 0.0]
    >>> tool
    <dynpoint.Tool 536936448: proxy, 500 N/m, acts, 2.5 N>
    """

    __slots__ = ("__weakref__",)

    def add_body(self, mesh: Mesh, pose: Optional[Numbers] = None, **settings: Any) -> Body:
        """A rigid body. Poses are 7 numbers: position, then quaternion (w, x, y, z); or 3, a position."""
        body = Body(self, mesh, pose)
        if settings:
            body.set_settings(**settings)
        return body

    def add_deformable(self, mesh: Mesh, pose: Optional[Numbers] = None, *, compliances: Optional[npt.ArrayLike] = None,
                       **settings: Any) -> DeformableBody:
        """A body whose vertices are moved. Keywords are those of dpt_deformable_def, as load_radius. `compliances`, one a
        vertex, are copied."""
        return DeformableBody(self, mesh, pose, settings,
                              None if compliances is None else np.ascontiguousarray(compliances, np.float32))

    def add_tool(self, a: Any, b: Any = None, radius: Any = 0.0, **settings: Any) -> Tool:
        """A tool of capsules, in its own frame: ends (3) or (n, 3), and radii."""
        tool = Tool(self, make_segments(a, b, radius))
        if settings:
            tool.set_settings(**settings)
        return tool

    def report(self, dt: float) -> Any:
        """One step, and what it found over all tools: a struct of STEP."""
        out = room(STEP)
        self.step(dt, out)
        return out[0]

    @property
    def info(self) -> Any:
        """The most that it has used at one time (dpt_world_info)."""
        info = room(WORLD_INFO)
        self.get_info(info)
        return info[0]

    def __enter__(self) -> World:
        return self

    def __exit__(self, kind: Optional[Type[BaseException]], error: Optional[BaseException],
                 trace: Optional[TracebackType]) -> None:
        self.close()

    def __reduce__(self) -> Any:
        raise TypeError("a World cannot be pickled: its memory is this process's")

    def __repr__(self) -> str:
        if self.closed:
            return "<dynpoint.World: closed>"
        info = self.info
        return f"<dynpoint.World: {info.bodies} bodies, {info.tools} tools, kernel {info.kernel}>"


class _Member:
    __slots__ = ()

    def __reduce__(self) -> Any:
        raise TypeError(f"a {type(self).__name__} cannot be pickled: it is of a world of this process")


class Body(_Member, _dynpoint.Body):
    """A rigid body of a world. It stays in the world until `remove`, whether somebody has this object or not."""

    __slots__ = ("__weakref__",)

    static_friction: float = _setting("static_friction", "Coulomb friction of a contact that sticks, 0..10")
    kinetic_friction: float = _setting("kinetic_friction", "of one that slips, at most the static one")
    stiffness: float = _setting("stiffness", "of the surface, N/m; 0: rigid")
    side_limit: float = _setting("side_limit", "how deep a tool may be behind an open sheet, m; 0: a quarter of its size")
    puncture_force: float = _setting("puncture_force", "N, at which a piercing tool ruptures a wall; 0: by the toughness")
    toughness: float = _setting("toughness", "J/m2, that it takes to open the material")
    cutting_force: float = _setting("cutting_force", "N, at a tip that goes deeper, beside what the toughness gives")
    shaft_friction: float = _setting("shaft_friction", "N for each metre of a shaft that is inside")
    shaft_viscosity: float = _setting("shaft_viscosity", "Ns/m2, likewise for each m/s")
    shaft_stiffness: float = _setting("shaft_stiffness", "N/m2, by which a shaft that sticks gives; 0: it slips")
    unfelt: int = _setting("unfelt", "1: to tools it is as if it were not there")

    @property
    def pose(self) -> Floats:
        """7 numbers: position, quaternion (w, x, y, z). To set it sweeps the motion; `teleport` jumps."""
        return np.array(self.get_pose())

    @pose.setter
    def pose(self, pose: Numbers) -> None:
        self.set_pose(pose)

    @property
    def wrench(self) -> Floats:
        """What all tools do to it: force, torque about its frame's origin, in world axes."""
        return np.array(self.get_wrench())

    def set_regions(self, of_triangle: Any, regions: Sequence[Mapping[str, float]]) -> None:
        """Parts of the surface that take of a needle what they say: `puncture_force`, `toughness`, `cutting_force`,
        `shaft_friction`, `shaft_viscosity`. `of_triangle`: a number a triangle of the source, 0: none, k: regions[k - 1].
        """
        laws, known = np.zeros(len(regions), REGION), (REGION.names or ())[2:]
        laws["size"] = REGION.itemsize
        for i, region in enumerate(regions):
            for name, value in region.items():
                if name not in known:
                    raise ValueError(f"regions[{i}]: there is no {name!r}; there are {', '.join(known)}")
                laws[name][i] = value
        numbers = np.asarray(of_triangle)
        if numbers.size and (numbers.dtype.kind not in "iub" or numbers.min() < 0 or numbers.max() > 255):
            raise ValueError(f"of_triangle: wanted whole numbers from 0 to {len(laws)}, one a triangle of the source")
        _dynpoint.Body.set_regions(self, numbers.astype(np.uint8).tobytes(), laws.tobytes())

    def __repr__(self) -> str:
        if not self.valid:
            return f"<dynpoint.{type(self).__name__}: removed>"
        return f"<dynpoint.{type(self).__name__} {self.id}: {self.mesh!r}>"


class DeformableBody(Body):
    """A body whose vertices are moved: by you, or by Springs."""

    __slots__ = ()

    @property
    def vertices(self) -> npt.NDArray[np.float32]:
        """(n, 3), in the body's frame, m: a copy. To set all of them takes float32 in C order."""
        mesh = self.mesh
        out = np.zeros((int(mesh.info.vertices), 3), np.float32)
        self.get_vertices(out)
        return out

    @vertices.setter
    def vertices(self, positions: npt.NDArray[np.float32]) -> None:
        self.set_vertices(positions, 0, -1.0)

    def move(self, positions: npt.NDArray[np.float32], first: int = 0, bound: float = -1.0) -> None:
        """Move vertices from `first` on. `bound`: none moves farther, m; below 0 it is measured."""
        self.set_vertices(positions, first, bound)

    @property
    def loads(self) -> Records:
        """What tools do to vertices: structs of LOAD, in the body's frame."""
        loads = np.zeros(256, LOAD)
        count = self.get_loads(loads)
        if count > len(loads):
            loads = np.zeros(count, LOAD)
            count = self.get_loads(loads)
        return loads[:count]

    @property
    def mean_loads(self) -> Tuple[Records, float]:
        """Of a body with a compliance: the mean loads of the steps since the last answer, each vertex once, and how many
        seconds these were. For a step of physics of your own."""
        loads = np.zeros(256, LOAD)
        count, seconds = self.get_mean_loads(loads)
        if count > len(loads):
            loads = np.zeros(count, LOAD)
            count, seconds = self.get_mean_loads(loads)
        return loads[:count], seconds

    def answer(self, loads: Records) -> None:
        """The vertices that are set before the next step of the world hold what these loads do: those that your physics
        had for its step."""
        self.set_answered_loads(loads)

    def foresee(self, positions: npt.NDArray[np.float32], first: int = 0) -> None:
        """Of a body with a compliance, after `answer` and `vertices`: where vertices from `first` on will be after the next
        step of your physics, if the loads stay those of the answer (Springs.foresee). What is light needs it to be still."""
        self.set_foreseen_vertices(positions, first)

    def step(self, springs: Optional[Springs], dt: float) -> Any:
        """After a step of the world: its springs go on, solved together with the tools that touch (SPRINGS_INFO). None: the
        body has a compliance, by which it gives way between two steps of physics of your own."""
        info = room(SPRINGS_INFO)
        self.step_springs(springs, dt, info)
        return info[0]


class Springs(_dynpoint.Springs):
    """Masses and springs of a mesh that was compiled with them. Keywords are those of dpt_springs_def, as integrator."""

    __slots__ = ("__weakref__",)

    def step(self, dt: float, loads: Optional[Records] = None) -> Any:
        """Go on by dt, with forces on nodes: structs of LOAD."""
        info = room(SPRINGS_INFO)
        self.step_once(dt, loads, info)
        return info[0]

    def foresee(self, dt: float, loads: Optional[Records] = None) -> npt.NDArray[np.float32]:
        """Where a step would take the nodes: (n, 3), m. They stay where they are."""
        positions = np.zeros((self.count, 3), np.float32)
        self.foresee_once(dt, loads, positions)
        return positions

    @property
    def nodes(self) -> npt.NDArray[np.float32]:
        """Where the nodes are: (n, 3), m."""
        return self.state[0]

    @nodes.setter
    def nodes(self, positions: npt.NDArray[np.float32]) -> None:
        self.put_nodes(0, positions, None)

    @property
    def state(self) -> Tuple[npt.NDArray[np.float32], npt.NDArray[np.float32]]:
        """Positions and speeds."""
        positions, speeds = np.zeros((self.count, 3), np.float32), np.zeros((self.count, 3), np.float32)
        self.get_nodes(positions, speeds)
        return positions, speeds

    @property
    def energy(self) -> Tuple[float, float]:
        """What the springs hold, and what moves, J."""
        return self.get_energy()

    def __reduce__(self) -> Any:
        raise TypeError("Springs cannot be pickled: their memory is this process's")

    def __repr__(self) -> str:
        return f"<dynpoint.Springs: {self.count} nodes, stable to {self.stable_step:.3g} s>"


class Tool(_Member, _dynpoint.Tool):
    """A tool of a world. `tick(pose, dt, out)` is set_pose, the world's step and get_wrench in one call."""

    __slots__ = ("__weakref__",)

    law: Union[str, int] = _setting("law", '"proxy", "bed" or "point"')
    stiffness: float = _setting("stiffness", "N/m")
    rotational_stiffness: float = _setting("rotational_stiffness", "Nm/rad; 0: as the stiffness says")
    damping: float = _setting("damping", "Ns/m")
    lock_rotation: int = _setting("lock_rotation", "1: the proxy does not turn away from the device")
    piercing: Union[str, int] = _setting("piercing", 'the end that pierces: "none", "a" or "b"')
    near_only: int = _setting("near_only", "1: only segments that may be nearest are searched for")

    @property
    def pose(self) -> Floats:
        """7 numbers: position, quaternion (w, x, y, z). To set it sweeps the motion; `teleport` jumps."""
        return np.array(self.get_pose())

    @pose.setter
    def pose(self, pose: Numbers) -> None:
        self.set_pose(pose)

    @property
    def proxy(self) -> Floats:
        """The pose that has gone through nothing."""
        return np.array(self.get_proxy())

    @property
    def wrench(self) -> Floats:
        """Force, N, and torque about its frame's origin, Nm, of the last step, before any limits."""
        return np.array(self.get_wrench())

    @property
    def hit(self) -> Any:
        """The nearest pair, at the device's pose (HIT)."""
        out = room(HIT)
        self.get("hit", out)
        return out[0]

    def segment_hit(self, segment: int) -> Any:
        """The same of one segment."""
        out = room(HIT)
        self.get("segment_hit", out, segment)
        return out[0]

    def sweep(self, segment: int = 0) -> Any:
        """The first touch of a segment between the last two steps (SWEEP). A proxy has none."""
        out = room(SWEEP)
        self.get("sweep", out, segment)
        return out[0]

    @property
    def force(self) -> Any:
        """What it feels and why (FORCE)."""
        out = room(FORCE)
        self.get("force", out)
        return out[0]

    def _list(self, name: str, dtype: Any, capacity: int) -> Records:
        out = np.zeros(capacity, dtype)
        count = self.list(name, out)
        if count > capacity:
            out = np.zeros(count, dtype)
            count = self.list(name, out)
        return out[:count]

    @property
    def contacts(self) -> Records:
        """Stretches that touch (CONTACT): of a world with max_contacts."""
        return self._list("contacts", CONTACT, 32)

    @property
    def loads(self) -> Records:
        """Points at which bodies push it (TOOL_LOAD)."""
        return self._list("loads", TOOL_LOAD, 8)

    @property
    def channels(self) -> Records:
        """Holes that it has made (CHANNEL): of a world with max_channels."""
        return self._list("channels", CHANNEL, 8)

    def set_segments(self, a: Any, b: Any = None, radius: Any = 0.0) -> None:
        """Set it free: its segments in the world's frame, as many as it has."""
        self.put_segments(make_segments(a, b, radius))

    def wrench_on(self, body: Body) -> Floats:
        """What it does to one body."""
        return np.array(self.get_body_wrench(body))

    def __repr__(self) -> str:
        if not self.valid:
            return "<dynpoint.Tool: removed>"
        force = self.force
        size = float(np.linalg.norm(self.wrench[:3]))
        return f"<dynpoint.Tool {self.id}: {self.law}, {self.stiffness:g} N/m, {Force(force.reason).name.lower()}, {size:.3g} N>"
