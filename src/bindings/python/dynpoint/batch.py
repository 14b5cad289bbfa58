# SPDX-License-Identifier: BSD-3-Clause
"""Many environments of one scene, stepped by one call on all processors. Arrays have a row for each environment."""
from __future__ import annotations

import os
from types import TracebackType
from typing import Any, Dict, Iterator, List, Optional, Sequence, Tuple, Type, Union

import numpy as np
import numpy.typing as npt

from . import _dynpoint
from . import _world
from ._mesh import Mesh
from ._structs import CONTACT, FORCE, HIT, TOOL_LOAD, Floats, Numbers, Records
from ._world import Body, DeformableBody, Springs

# dpt_deformable_def.max_points where nothing is said.
_POINTS = 16
READ = ("proxy", "force", "hit", "loads", "contacts")
_IDENTITY = (0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0)


def rotate(quaternions: Floats, vectors: Floats) -> Floats:
    """Vectors (..., 3) turned by quaternions (..., 4) (w, x, y, z).

    >>> rotate(np.array([0.5 ** 0.5, 0, 0, 0.5 ** 0.5]), np.array([1.0, 0, 0])).round(3).tolist()
    [-0.0, 1.0, 0.0]
    """
    axis = quaternions[..., 1:]
    once = 2 * np.cross(axis, vectors)
    turned: Floats = vectors + quaternions[..., :1] * once + np.cross(axis, once)
    return turned


def count_processors() -> int:
    """Those that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


class _Members:
    """One body or tool in each environment; a sequence of them."""

    def __init__(self, world: World, members: Sequence[Any]) -> None:
        self.world = world
        self.members = list(members)
        self.ids = np.array([member.id for member in members], np.uint32)
        self._pose: Floats = np.array([member.pose for member in members])
        self.wrench: Floats = np.zeros((world.count, 6))

    @property
    def pose(self) -> Floats:
        """(n, 7): position, quaternion (w, x, y, z), read by each step. Write into it, or set all of it."""
        return self._pose

    @pose.setter
    def pose(self, poses: npt.ArrayLike) -> None:
        self._pose[...] = poses

    def __len__(self) -> int:
        return len(self.members)

    def __getitem__(self, i: int) -> Any:
        return self.members[i]

    def __iter__(self) -> Iterator[Any]:
        return iter(self.members)

    def set(self, **settings: Any) -> None:
        """Settings of all of them, as static_friction=0.3; a number each, or an array of n."""
        for i, member in enumerate(self.members):
            member.set_settings(**{name: value[i] if isinstance(value, np.ndarray) else value
                                   for name, value in settings.items()})


class Tools(_Members):
    """A tool in each environment; `tools[i]` is the Tool of environment i. Arrays are written by each step, in place.

    pose      (n, 7) where the device is, read by each step: write into it
    wrench    (n, 6) what is felt, N and Nm
    proxy     (n, 7) the poses that have gone through nothing
    force     n structs of FORCE
    hit       n structs of HIT, at the device's pose
    loads     (n, k) structs of TOOL_LOAD; of row i the first load_count[i] are of this step
    contacts  (n, k) structs of CONTACT; likewise, contact_count
    """

    def __init__(self, world: World, members: Sequence[Any], segments: Records) -> None:
        super().__init__(world, members)
        n, read = world.count, world.read
        self.segments = segments
        self.proxy: Floats = self.pose.copy()
        self.force: Records = np.zeros(n, FORCE)
        self.hit: Records = np.zeros(n if "hit" in read else 0, HIT)
        self.loads: Records = np.zeros((n if "loads" in read else 0, world.room), TOOL_LOAD)
        self.load_count = np.zeros(n, np.uint32)
        self.contacts: Records = np.zeros((n if "contacts" in read else 0, world.room), CONTACT)
        self.contact_count = np.zeros(n, np.uint32)
        self.rows = (self.ids, self.pose, self.wrench, self.proxy if "proxy" in read else None,
                     self.force if "force" in read else None, self.hit if len(self.hit) else None,
                     self.loads if len(self.loads) else None, self.load_count,
                     self.contacts if len(self.contacts) else None, self.contact_count)

    @property
    def touching(self) -> npt.NDArray[np.bool_]:
        """(n, k): which of `loads` are of the last step."""
        return np.arange(self.loads.shape[1]) < self.load_count[:, None]

    @property
    def normals(self) -> Floats:
        """(n, k, 3): of each load, from the point towards the tool's axis, where the proxy is: unit. 0 where there is no
        load, and for tools without a radius. A world needs read=("loads", "proxy", ...)."""
        if not len(self.loads) or self.rows[3] is None:
            raise ValueError('normals: the batch has them of read=("loads", "proxy")')
        which = np.minimum(self.loads["segment"], len(self.segments) - 1)
        at, turn = self.proxy[:, None, :3], self.proxy[:, None, 3:]
        a = at + rotate(turn, self.segments["a"][which])
        along = rotate(turn, (self.segments["b"] - self.segments["a"])[which])
        point = self.loads["point"]
        length = (along * along).sum(-1)
        s = np.clip(((point - a) * along).sum(-1) / np.where(length > 0, length, 1), 0, 1)
        away = a + s[..., None] * along - point
        size = np.linalg.norm(away, axis=-1)
        is_known = self.touching & (self.loads["segment"] < len(self.segments)) & (size > 1e-9)
        normals: Floats = np.where(is_known[..., None], away / np.where(is_known, size, 1)[..., None], 0)
        return normals

    @property
    def friction(self) -> Floats:
        """(n, k, 3): the part of each load's force that is across its normal, N; 0 where that is not known."""
        normals = self.normals
        across = self.loads["force"] - (self.loads["force"] * normals).sum(-1, keepdims=True) * normals
        friction: Floats = np.where(np.any(normals, axis=-1, keepdims=True), across, 0)
        return friction


class Bodies(_Members):
    """A body in each environment. `pose` (n, 7) is read by each step: write into it to move them. `wrench` (n, 6) is what
    tools do to them."""

    def __init__(self, world: World, members: Sequence[Any]) -> None:
        super().__init__(world, members)
        self.rows: Tuple[Any, ...] = (self.ids, self.pose, self.wrench, None, None, None, None)


class DeformableBodies(Bodies):
    """A body that gives way, in each environment. `loads` (n, vertices, 3) is the force on each vertex, N, in the body's
    frame; `springs` are those of each environment, or None."""

    def __init__(self, world: World, members: Sequence[Any], springs: Optional[List[Springs]], is_stepped: bool) -> None:
        super().__init__(world, members)
        self.springs = springs
        self.rest: npt.NDArray[np.float32] = np.asarray(members[0].vertices)
        self.nodes = springs[0].nodes if springs else None
        self.loads: Floats = np.zeros((world.count, len(self.rest), 3))
        self.load_count = np.zeros(world.count, np.uint32)
        self.steppers = tuple(springs) if springs else (None,) * world.count if is_stepped else None
        self.put: Optional[npt.NDArray[np.float32]] = None
        self._hand_over()

    def _hand_over(self) -> None:
        self.rows = (self.ids, self.pose, self.wrench, self.put, self.steppers, self.loads, self.load_count)

    @property
    def vertices(self) -> npt.NDArray[np.float32]:
        """(n, vertices, 3), in the body's frame, m: a copy. Set, they are where the next step finds them."""
        return np.stack([member.vertices for member in self.members])

    @vertices.setter
    def vertices(self, positions: npt.NDArray[np.float32]) -> None:
        shape = (self.world.count, *self.rest.shape)
        if positions.shape != shape or positions.dtype != np.float32:
            raise TypeError(f"vertices: wanted float32 of shape {shape}, not {positions.dtype} of {positions.shape}")
        self.put = np.ascontiguousarray(positions)
        self._hand_over()

    def stepped(self) -> None:
        """The vertices that were set are there now."""
        if self.put is not None:
            self.put = None
            self._hand_over()


class World:
    """n environments. Keywords are those of dynpoint.World. What is added to it is added to each of them.

    read     what is read after each step beside wrenches: some of READ. "hit" costs a search; "contacts" needs
             max_contacts
    threads  None: as many as there are processors. The answers do not depend on it
    room     loads and contacts of a tool that are read

    >>> mesh = Mesh.compile([[-1, 0, -1], [1, 0, -1], [0, 0, 1]], [[0, 2, 1]], unit="m")
    >>> world = World(3)
    >>> body = world.add_body(mesh)
    >>> tool = world.add_tool([0, 0, 0], [0, 0.1, 0], radius=0.01)
    >>> for height in (0.1, 0.05, 0.005):
    ...     tool.pose[:, 1] = height
    ...     world.step(0.001)
    >>> tool.wrench[:, 1].round(2).tolist()
    [2.5, 2.5, 2.5]
    """

    def __init__(self, n: int, *, read: Sequence[str] = ("proxy", "force", "loads"), threads: Optional[int] = None,
                 room: int = 8, **settings: Any) -> None:
        for name in read:
            if name not in READ:
                raise ValueError(f"read: {name!r} is none of {', '.join(READ)}")
        if n < 1 or room < 1:
            raise ValueError("n, room: wanted 1 or more")
        self.worlds = tuple(_world.World(**settings) for _ in range(n))
        self.count = n
        self.read = tuple(read)
        self.room = room
        self.threads = threads or count_processors()
        self.tools: List[Tools] = []
        self.bodies: List[Bodies] = []
        self.results = np.zeros(n, np.int32)
        self._points = _POINTS

    def add_body(self, mesh: Mesh, pose: Optional[Numbers] = None, **settings: Any) -> Bodies:
        """A rigid body in each; all share the mesh."""
        bodies = Bodies(self, [world.add_body(mesh, pose, **settings) for world in self.worlds])
        self.bodies.append(bodies)
        return bodies

    def add_deformable(self, mesh: Mesh, pose: Optional[Numbers] = None, *,
                       springs: Union[Dict[str, Any], bool, None] = None, **settings: Any) -> DeformableBodies:
        """A body that gives way, in each. `springs`: a dict of settings, or True, for masses and springs of the mesh,
        which the step moves; without them you set `vertices`. Other keywords are those of dpt_deformable_def: with
        `compliance` the tool feels the tissue give way between two of your steps."""
        members = [world.add_deformable(mesh, pose, **settings) for world in self.worlds]
        moved: Optional[List[Springs]] = None
        if springs is not None and springs is not False:
            given = springs if isinstance(springs, dict) else {}
            moved = [Springs(mesh, **given) for _ in members]
        bodies = DeformableBodies(self, members, moved, settings.get("compliance", 0) > 0)
        self._points = max(self._points, int(settings.get("max_points", _POINTS)))
        self.bodies.append(bodies)
        return bodies

    def add_tool(self, a: Any, b: Any = None, radius: Any = 0.0, pose: Optional[Numbers] = None,
                 **settings: Any) -> Tools:
        """A tool of capsules in each."""
        segments = _world.make_segments(a, b, radius)
        members = [world.add_tool(segments, **settings) for world in self.worlds]
        for member in members:
            member.teleport(_IDENTITY if pose is None else pose)
        tools = Tools(self, members, segments)
        self.tools.append(tools)
        return tools

    def step(self, dt: float) -> None:
        """A tick of each environment: tools and bodies are moved to `pose`, what springs move goes on, answers are
        written. An environment that fails does not stop the others; then the first one's error is raised, and `results`
        has all of them."""
        try:
            _dynpoint.step_batch(self.worlds, dt, self.threads, self._points, tuple(tool.rows for tool in self.tools),
                                 tuple(body.rows for body in self.bodies), self.results)
        except _dynpoint.Error:  # of an environment; any other exception is of a step that was not done
            self._stepped()
            raise
        self._stepped()

    def _stepped(self) -> None:
        for body in self.bodies:
            if isinstance(body, DeformableBodies):
                body.stepped()

    def reset(self, which: Any = None) -> None:
        """Environments begin again, all or those of an index or a mask: tools jump to `pose`, bodies that give way are
        as they were made and at rest, nothing is known of the steps before."""
        numbers = np.arange(self.count)
        for i in numbers if which is None else np.atleast_1d(numbers[which]):
            self._reset(int(i))

    def _reset(self, i: int) -> None:
        for body in self.bodies:
            body[i].teleport(body.pose[i])
            if isinstance(body, DeformableBodies):
                if body.springs and body.nodes is not None:
                    body.springs[i].nodes = body.nodes
                body[i].vertices = body.rest
        for tool in self.tools:
            tool[i].teleport(tool.pose[i])
        self.worlds[i].reset()

    def close(self) -> None:
        for world in self.worlds:
            world.close()

    def __len__(self) -> int:
        return self.count

    def __enter__(self) -> World:
        return self

    def __exit__(self, kind: Optional[Type[BaseException]], error: Optional[BaseException],
                 trace: Optional[TracebackType]) -> None:
        self.close()

    def __repr__(self) -> str:
        return (f"<dynpoint.batch.World: {self.count} environments of {len(self.bodies)} bodies and {len(self.tools)} "
                f"tools, {self.threads} threads>")
