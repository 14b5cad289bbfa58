# SPDX-License-Identifier: BSD-3-Clause
"""A page in a browser that shows a scene that is felt: Scene.view, and `python3 -m dynpoint view` where the system has no
libwebsockets."""

from __future__ import annotations

import argparse
import html
import os
import re
import shutil
import subprocess
import sys
import tempfile
import threading
import weakref
import webbrowser
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Iterable, List, Optional, Type

from . import _dynpoint
from ._files import PROGRAM
from ._serve import ViewServer, messages_of

if TYPE_CHECKING:
    from ._device import Scene

# Where notebooks of this machine are; pages of others are named by Scene.view(frames=...).
NOTEBOOKS = ("http://localhost:*", "http://127.0.0.1:*", "https://localhost:*", "https://127.0.0.1:*")
_FOLDER = Path(__file__).parent


def _close_soon(server: ViewServer) -> None:
    """From the collector, which must not wait."""
    try:
        threading.Thread(target=server.close, args=("The scene was closed.",), daemon=True).start()
    except RuntimeError:  # at the interpreter's end, which takes the server's threads along
        pass


class View:
    """A page at `url` that shows a scene, until `close`, or until its scene closes. In a notebook it is shown in place.
    The address is a secret: who has it sees the scene, and with `control` moves its hand."""

    def __init__(self, server: ViewServer, title: str, scene: Optional[Scene] = None) -> None:
        self._server, self.title = server, title
        self._scene = None if scene is None else weakref.ref(scene)
        self._room: Optional[str] = None
        if scene is not None:
            weakref.finalize(scene, _close_soon, server).atexit = False

    @property
    def url(self) -> str:
        return self._server.url

    @property
    def closed(self) -> bool:
        return self._server.is_closed

    @property
    def pages(self) -> int:
        """How many look on now."""
        return len(self._server.clients)

    def open(self) -> None:
        """A browser. The address is handed to it in a file that the user alone may read, and is on no command line."""
        self._room = self._room or tempfile.mkdtemp(prefix="dynpoint-")
        file = Path(self._room, "view.html")
        file.touch(mode=0o600)
        file.write_text(f'<!DOCTYPE html><meta http-equiv="refresh" content="0;url={self.url}">')
        webbrowser.open(file.as_uri())

    def close(self, why: str = "The view was closed.") -> None:
        self._server.close(why)
        if self._room:
            shutil.rmtree(self._room, ignore_errors=True)
            self._room = None
        scene = self._scene() if self._scene else None
        if scene is not None and not scene.closed:
            end_view(scene)

    def _repr_html_(self) -> str:
        """An iframe. From now on pages of NOTEBOOKS may frame this one; without the token they see nothing in it."""
        if self.closed:
            return html.escape(repr(self))
        if not self._server.frame_origins:
            self._server.frame_origins = list(NOTEBOOKS)
        return (
            f'<iframe src="{html.escape(self.url)}" title="{html.escape(self.title)}" width="100%" height="520" '
            'style="border:0" sandbox="allow-scripts allow-same-origin" referrerpolicy="no-referrer"></iframe>'
        )

    def __enter__(self) -> View:
        return self

    def __exit__(
        self, kind: Optional[Type[BaseException]], error: Optional[BaseException], trace: Optional[TracebackType]
    ) -> None:
        self.close()

    def __reduce__(self) -> str:
        raise TypeError("a View cannot be pickled: it is a server of this process")

    def __repr__(self) -> str:
        return f"<dynpoint.View of {self.title}: {'closed' if self.closed else f'port {self._server.server_port}'}>"


def end_view(scene: Scene) -> None:
    """What the closed view of a scene had there; while the scene runs it stays."""
    try:
        scene.view_end()
    except RuntimeError:
        pass


def read_origins(frames: Iterable[str]) -> List[str]:
    """Each is one source of a policy: a space in it would begin another one, a semicolon end the directive."""
    if isinstance(frames, str):
        raise ValueError(f"frames: wanted a list of origins, as [{frames!r}]")
    origins = list(frames)
    for origin in origins:
        if not re.fullmatch(r"https?://[^\s;,]+", origin):
            raise ValueError(f"frames: {origin!r} is no origin, as 'https://hub.example.org'")
    return origins


def view_scene(scene: Scene, device: Optional[str], title: str, control: bool, port: int, frames: Iterable[str]) -> View:
    origins = read_origins(frames)
    first = scene.view_begin(os.fsencode(title), os.fsencode(device or ""), control)
    there = weakref.ref(scene)

    def next_frame() -> Optional[bytes]:
        one = there()
        return None if one is None else one.view_next()

    def steer(x: float, y: float, z: float) -> None:
        one = there()
        if one is not None:
            one.view_steer(x, y, z)

    try:
        server = ViewServer([first], next_frame, steer if control else None, port=port, frames=origins)
    except BaseException:
        scene.view_end()
        raise
    return View(server, title, scene)


def has_libwebsockets() -> bool:
    """Whether the program itself can serve."""
    try:
        import ctypes  # which not every Python has

        ctypes.CDLL(str(_FOLDER / "libdynpoint_view.so"))
    except (ImportError, OSError):
        return False
    return True


def _is_scene(name: str) -> bool:
    if name in _dynpoint.scene_names() or name.endswith(".json"):
        return True
    try:
        _dynpoint.Arm(Path(name).read_bytes())
    except (OSError, ValueError, _dynpoint.Error):
        return False
    return True


def _of_program(words: List[str]) -> List[bytes]:
    """The messages of a page that the program writes."""
    with tempfile.TemporaryDirectory() as room:
        page = Path(room, "page.html")
        made = subprocess.run([PROGRAM, "view", *words, "-o", page])
        if made.returncode > 1 or not page.exists():
            sys.exit(made.returncode)
        return list(messages_of(page.read_bytes()))


def serves(words: List[str]) -> bool:
    """Whether these words of a command line want a page served: else they are the program's alone."""
    return (
        words[:1] == ["view"]
        and len(words) > 1
        and words[1] != "complete"
        and not {"-o", "--help", "-h"}.intersection(words)
    )


def command(words: List[str]) -> int:
    """`view` by Python's server."""
    told = argparse.ArgumentParser("dynpoint view", add_help=False, allow_abbrev=False)
    told.add_argument("what")
    for name in ("--device", "--mesh", "--tool"):
        told.add_argument(name)
    told.add_argument("--port", type=int, default=0)
    told.add_argument("--for", type=float, dest="seconds")
    for name in ("--open", "--control"):
        told.add_argument(name, action="store_true")
    chosen, others = told.parse_known_args(words)
    if others:
        print(f"dynpoint view: {others[0]} needs libwebsockets (Debian: libwebsockets17)", file=sys.stderr)
        return 2
    if chosen.seconds is not None and not chosen.seconds > 0:
        print("dynpoint view: --for must be positive", file=sys.stderr)
        return 2
    if _is_scene(chosen.what):
        return _show_scene(chosen)
    named = [word for name in ("mesh", "tool") if getattr(chosen, name) for word in (f"--{name}", getattr(chosen, name))]
    with View(ViewServer(_of_program([chosen.what, *named]), port=chosen.port), chosen.what) as view:
        _tell(view, chosen.open)
        try:
            threading.Event().wait(_seconds(chosen))
        except KeyboardInterrupt:
            pass
    return 0


def _seconds(chosen: argparse.Namespace) -> Optional[float]:
    """None: until it is interrupted."""
    return None if chosen.seconds is None or chosen.seconds > threading.TIMEOUT_MAX else float(chosen.seconds)


def _tell(view: View, is_opened: bool) -> None:
    print(f"the viewer: {view.url}", flush=True)
    if is_opened:
        view.open()


def _show_scene(chosen: argparse.Namespace) -> int:
    from ._device import Scene

    device = chosen.device or ("sim:?hand=hold&live=1" if chosen.control else "sim:?hand=press&live=1")
    try:
        with Scene(chosen.what, device, tool=chosen.tool) as scene:
            _tell(scene.view(control=chosen.control, port=chosen.port), chosen.open)
            if (seconds := _seconds(chosen)) is not None:
                ends = threading.Timer(seconds, scene.stop)
                ends.daemon = True
                ends.start()
            try:
                scene.run()
            except KeyboardInterrupt:
                pass
    except (_dynpoint.Error, ValueError, OSError) as error:
        print(f"dynpoint view: {error}", file=sys.stderr)
        return 2
    return 0
