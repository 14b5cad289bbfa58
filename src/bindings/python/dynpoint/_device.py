# SPDX-License-Identifier: BSD-3-Clause
"""Devices, the guard before their motors, loops, and scenes that are felt. Whatever ends the program, zero force goes out
before a handle closes."""
from __future__ import annotations

import atexit
import os
import time
import weakref
from types import TracebackType
from typing import Any, Callable, Iterable, List, Mapping, Optional, Sequence, Tuple, Type, Union

import numpy as np

from . import _dynpoint
from ._mesh import Mesh, PathLike
from ._structs import (DEVICE_COUNTS, DEVICE_INFO, DEVICE_STATE, GUARD_INFO, HOST_INFO, LOOP_STATS, Floats,
                       GuardState, Numbers, Records, room)
from ._view import View, end_view, view_scene
from ._world import Body, Tool, World, make_segments

Tick = Callable[[Any, Floats, float], Optional[Numbers]]

_open: "weakref.WeakSet[Union[Device, Scene]]" = weakref.WeakSet()


@atexit.register
def _close_all() -> None:
    """At the interpreter's end: loops end, then all that is open closes, with zero force."""
    for one in list(_open):
        if isinstance(one, Scene):
            one.stop()
            for _ in range(200):
                if not one.running:
                    break
                time.sleep(0.01)
        try:
            one.close()
        except (RuntimeError, _dynpoint.Error):  # a fork's, or still running: its own watchdog ends the force
            pass


class _Closes:
    """What closes with its block."""

    __slots__ = ()

    def __exit__(self, kind: Optional[Type[BaseException]], error: Optional[BaseException],
                 trace: Optional[TracebackType]) -> None:
        self.close()  # type: ignore[attr-defined]

    def __reduce__(self) -> Any:
        raise TypeError(f"a {type(self).__name__} cannot be pickled: it holds a device of this process")


class Device(_Closes, _dynpoint.Device):
    """An open device, by the name that people type, as "serial:/dev/ttyACM0" or "sim:?hand=press".

    >>> with Device("sim:?hand=press") as device:
    ...     state = device.read()
    ...     device.write([0, 0, 0])
    True
    """

    __slots__ = ("__weakref__", "name")

    def __init__(self, name: str) -> None:
        self.name = name
        _open.add(self)

    @property
    def info(self) -> Any:
        """What it is and can do (dpt_device_info)."""
        info = room(DEVICE_INFO)
        self.get_info(info)
        return info[0]

    @property
    def counts(self) -> Any:
        """Since it was opened (dpt_device_counts)."""
        counts = room(DEVICE_COUNTS)
        self.get_counts(counts)
        return counts[0]

    def read(self, out: Optional[Records] = None) -> Any:
        """A sample (dpt_device_state): into `out`, an array of one DEVICE_STATE, or a new one."""
        state = room(DEVICE_STATE) if out is None else out
        self.read_into(state)
        return state[0]

    def __enter__(self) -> Device:
        return self

    def __repr__(self) -> str:
        if self.closed:
            return f"<dynpoint.Device {self.name}: closed>"
        info = self.info
        return f"<dynpoint.Device {self.name}: {info.name.decode()}, {info.rate:g} Hz, {info.force_max:g} N>"


class Guard(_dynpoint.Guard):
    """Between a loop of yours and a device's motors. Keywords are those of dpt_guard_def, as force_max.

    >>> guard = Guard(force_max=3, force_slew=0, start=0)
    >>> guard.step(0, [4, 0, 0, 0, 0, 0]).round(9).tolist()
    [3.0, 0.0, 0.0, 0.0, 0.0, 0.0]
    >>> guard.step(9_000_000, None).tolist()  # silence of 9 ms
    [0.0, 0.0, 0.0, 0.0, 0.0, 0.0]
    """

    __slots__ = ()

    def step(self, now_ns: int, wrench: Optional[Numbers], ready: bool = True) -> Floats:
        """What to send now. None: no command came. Call it on every tick."""
        return np.array(self.decide(now_ns, wrench, ready))

    @property
    def info(self) -> Any:
        """What it did (dpt_guard_info)."""
        info = room(GUARD_INFO)
        self.get_info(info)
        return info[0]

    def __repr__(self) -> str:
        return f"<dynpoint.Guard: {GuardState(self.info.state).name.lower()}>"


class Loop:
    """A loop at the device's rate whose tick is yours: tick(state, wrench, dt) fills `wrench`, 6 numbers that begin as
    zero, or returns 6. A guard of the library stands before the motors. An exception, Ctrl-C and sys.exit in it send
    zero force, end the loop and go on. Keywords are those of dpt_loop_def, as rate; `guard` is a dict of
    dpt_guard_def's."""

    __slots__ = ("device", "tick", "guard", "settings")

    def __init__(self, device: Device, tick: Tick, *, guard: Optional[Mapping[str, float]] = None, **settings: Any) -> None:
        if not callable(tick):
            raise TypeError(f"tick: wanted a function of (state, wrench, dt), not {tick!r}")
        self.device, self.tick, self.settings = device, tick, settings
        self.guard = None if guard is None else dict(guard)

    def run(self, ticks: int = 0) -> Any:
        """Serve the device in this thread: so many ticks, or until it is lost or interrupted; what happened
        (dpt_loop_stats)."""
        state, wrench, stats = room(DEVICE_STATE), np.zeros(6), room(LOOP_STATS)
        sample = state[0]
        tick = self.tick
        _dynpoint.run_loop(self.device, lambda _state, out, dt: tick(sample, out, dt), state, wrench, self.guard, stats,
                           ticks=ticks, **self.settings)
        return stats[0]

    def __reduce__(self) -> Any:
        raise TypeError("a Loop cannot be pickled: it holds a device of this process")

    def __repr__(self) -> str:
        return f"<dynpoint.Loop: {self.tick!r} on {self.device!r}>"


def _text(value: Union[PathLike, None]) -> Optional[bytes]:
    return None if value is None else os.fsencode(value)


_Placed = Union[Mesh, Tuple[Mesh, Optional[Numbers]], Mapping[str, Any]]


def _body(item: _Placed) -> Tuple[Any, Any, Any, Any, Any]:
    """A mesh; a mesh and its pose; or a dict of mesh, pose, name, settings, and numbers of dpt_host_body."""
    if isinstance(item, Mesh):
        return item, None, None, None, None
    if isinstance(item, Mapping):
        rest = dict(item)
        mesh, pose, name, settings = rest.pop("mesh"), rest.pop("pose", None), rest.pop("name", None), rest.pop("settings", None)
        return mesh, pose, settings, name, rest or None
    mesh, pose = item
    return mesh, pose, None, None, None


class Scene(_Closes, _dynpoint.Scene):
    """A scene that is felt with a device, and safely so: what `dynpoint run` does. `scene` is a name (scene_names()), a
    scene file, a compiled mesh or arm; or `bodies` are your own meshes. The loop is the library's, `run`; or yours,
    `tick`, for a scene without a device, which `info` describes. Keywords are those of dpt_host_def, as stiffness or
    record.

    >>> with Scene("liver", "sim:?hand=press", ticks=1000) as scene:
    ...     stats = scene.run()
    ...     int(stats.ticks), bool(scene.info.force_max > 0)
    (1000, True)
    """

    __slots__ = ("__weakref__", "name", "_meshes", "note", "_device_name", "_view")
    name: str
    note: str
    _device_name: Optional[str]
    _view: Optional[View]
    _meshes: List[Mesh]

    def __new__(cls, scene: Optional[PathLike] = None, device: Optional[str] = None, *, tool: Optional[PathLike] = None,
                identified: Optional[PathLike] = None, record: Optional[PathLike] = None, jaw: Optional[str] = None,
                tips: Sequence[str] = (), segments: Optional[Records] = None, bodies: Sequence[_Placed] = (), info: Any = None,
                felt: Optional[Callable[[Any, Floats, float, str], Any]] = None, **settings: Any) -> Scene:
        texts = {"scene": _text(scene), "device": _text(device), "tool": _text(tool), "identified": _text(identified),
                 "record": _text(record), "jaw": _text(jaw)}
        state, wrench = room(DEVICE_STATE), np.zeros(6)
        sample, call = state[0], felt
        placed = [_body(item) for item in bodies]
        described = None if info is None else np.array([info], DEVICE_INFO)
        self = super().__new__(
            cls, texts, [os.fsencode(tip) for tip in tips], None if segments is None else make_segments(segments), placed,
            described, None if call is None else lambda _state, out, dt, result: call(sample, out, dt, result), state, wrench,
            **settings)
        self.name = os.fspath(scene) if scene is not None else f"{len(placed)} bodies"
        self._meshes = [item[0] for item in placed]
        self.note = ""
        self._device_name, self._view = device, None
        _open.add(self)
        return self

    def run(self) -> Any:
        """Serve the device in this thread: until `ticks`, `stop`, Ctrl-C, or when it is lost. Python's other threads go
        on. What happened (dpt_loop_stats); `note` has what a person should know."""
        stats = room(LOOP_STATS)
        self.note = self.run_into(stats)
        return stats[0]

    def tick(self, state: Records, now_ns: int) -> Floats:
        """One tick of a loop of yours: the newest sample, an array of one DEVICE_STATE; what to send."""
        out: Floats = np.array(self.decide(state, now_ns))
        return out

    @property
    def info(self) -> Any:
        """What is so now, and what has happened (dpt_host_info)."""
        info = room(HOST_INFO)
        self.get_info(info)
        return info[0]

    def view(self, *, control: bool = False, open: bool = False, port: int = 0, frames: Iterable[str] = (),
             title: Optional[str] = None) -> View:
        """A page in a browser that shows the scene while it runs: begin before `run`. It is served by Python's own
        server, to this machine alone, and needs a token, which is in View.url. `control` lets the page move a simulated
        hand. In a notebook it shows itself; `frames` are the origins of other pages that may have it in a frame of
        theirs."""
        if self._view is not None and self._view.closed:
            end_view(self)
        view = view_scene(self, self._device_name, title or self.name, control, port, frames)
        self._view = view
        if open:
            view.open()
        return view

    def close(self) -> None:
        """Zero force goes out, the device closes, pages are told."""
        try:
            super().close()
        finally:
            if self._view is not None and self.closed:
                self._view.close("The scene was closed.")

    @property
    def world(self) -> World:
        """Its world; not to be used while it runs but in `felt`."""
        world = self.get_world(World)
        assert isinstance(world, World)
        return world

    @property
    def tool(self) -> Tool:
        return Tool.of(self.world, self.get_tool())

    def body(self, index: int) -> Body:
        """A body, in the scene's order."""
        world, number = self.world, self.get_body(index)
        if number == 0:
            raise IndexError(f"there is no body {index}")
        mesh = self._meshes[index] if index < len(self._meshes) else None
        return Body.of(world, number, mesh)

    def __enter__(self) -> Scene:
        return self

    def __repr__(self) -> str:
        if self.closed:
            return f"<dynpoint.Scene {self.name}: closed>"
        if self.running:
            return f"<dynpoint.Scene {self.name}: running>"
        info = self.info
        return f"<dynpoint.Scene {self.name}: {info.ticks} ticks, {info.stiffness:.4g} N/m>"
