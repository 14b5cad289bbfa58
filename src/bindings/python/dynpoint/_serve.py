# SPDX-License-Identifier: BSD-3-Clause
"""The server of a viewer's page: what tools/view/server does by libwebsockets, by Python's own http.server.
docs/view.md has its messages and whom it refuses. The page is the program's, so it wants a web socket; of that protocol
(RFC 6455) only what the page uses is spoken: whole messages, text from the page, bytes to it."""

from __future__ import annotations

import base64
import hashlib
import math
import re
import secrets
import socket
import struct
import threading
import time
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any, Callable, Iterable, List, Optional, Sequence, Tuple

PROTOCOL = "dynpoint"
CLIENTS, CONNECTIONS, UNDRAWN, FRAMES_A_SECOND, MESSAGES_A_SECOND, MESSAGE = 4, 32, 2, 60, 500, 4096
HEADERS_SECONDS = TOKEN_SECONDS = 2.0
SEND_SECONDS, PAGE_SECONDS, LEAVE_SECONDS = 40.0, 5.0, 0.1
NORMAL, POLICY, LATER = 1000, 1008, 1013
_TEXT, _BYTES, _CLOSE, _PING, _PONG = 1, 2, 8, 9, 10
_FRAME = struct.pack("<I", 2)
_HAND = re.compile(r"hand ([-+0-9.eE]+) ([-+0-9.eE]+) ([-+0-9.eE]+)")
_TICKS, _NUMBER, _DROPPED, _LOST = 8, 16, 24, 32  # offsets in a frame's header

Steer = Callable[[float, float, float], None]


class _Refused(Exception):
    """The client said what it may not; its code to close with."""


def end_message(text: str) -> bytes:
    told = text.encode()
    return struct.pack("<II", 3, len(told)) + told


class _Socket:
    """A web socket after its handshake."""

    def __init__(self, connection: socket.socket) -> None:
        self.connection = connection
        self.lock = threading.Lock()  # of what is sent
        self.is_closing = False

    def send(self, code: int, content: bytes, patience: float = -1) -> None:
        """`patience`, s: of what is on its way before it; -1 waits for it however long it takes."""
        size = len(content)
        head = bytes([0x80 | code])
        head += (
            bytes([size])
            if size < 126
            else struct.pack(">BH", 126, size)
            if size < 65536
            else struct.pack(">BQ", 127, size)
        )
        if not self.lock.acquire(timeout=patience):
            raise TimeoutError("the page takes nothing")
        try:
            if not self.is_closing:
                self.is_closing = code == _CLOSE
                self.connection.sendall(head)
                self.connection.sendall(content)
        finally:
            self.lock.release()

    def close(self, code: int, patience: float = -1) -> None:
        """Take leave. A page that takes nothing for `patience` seconds is hung up on."""
        try:
            if patience >= 0:
                self.connection.settimeout(patience)
            self.send(_CLOSE, struct.pack(">H", code), patience)
        except OSError:
            self.hang_up()

    def hang_up(self) -> None:
        """Threads that wait for the page wake up."""
        try:
            self.connection.shutdown(socket.SHUT_RDWR)
        except OSError:
            pass

    def _take(self, size: int) -> bytes:
        parts, left = [], size
        while left:
            part = self.connection.recv(left)
            if not part:
                raise ConnectionError("the page has gone")
            parts.append(part)
            left -= len(part)
        return b"".join(parts)

    def receive(self) -> str:
        """The next message of the page. A browser masks, and does not split what is short."""
        while True:
            first, second = self._take(2)
            code, size = first & 15, second & 127
            is_long = size == 127  # its length follows in eight bytes
            if size == 126:
                size = struct.unpack(">H", self._take(2))[0]
            if is_long or first & 0xF0 != 0x80 or not second & 128 or size > MESSAGE or (code >= 8 and size > 125):
                raise _Refused(POLICY)
            mask = self._take(4) * (size // 4 + 1)
            content = bytes(a ^ b for a, b in zip(self._take(size), mask))
            if code == _CLOSE:
                raise ConnectionError("the page has gone")
            if code == _PING:
                self.send(_PONG, content)
            elif code == _TEXT:
                try:
                    return content.decode()
                except UnicodeDecodeError:
                    raise _Refused(POLICY) from None
            elif code != _PONG:
                raise _Refused(POLICY)


class _Client:
    """A page that gave the token: its own thread sends, so that a slow one delays no other."""

    def __init__(self, server: ViewServer, link: _Socket) -> None:
        self.server, self.link = server, link
        self.is_ready = self.is_gone = False
        self.undrawn = self.serial = self.frames = self.first_number = self.ticks_until = self.ticks_missed = 0
        self.allowance, self.heard_at = float(MESSAGES_A_SECOND), time.monotonic()

    def is_hungry(self) -> bool:
        return self.is_ready and self.undrawn < UNDRAWN

    def _frame(self) -> bytes:
        """The newest one; what this client was not sent is counted in it."""
        server = self.server
        frame, self.serial = bytearray(server.newest), server.serial
        (number,) = struct.unpack_from("<Q", frame, _NUMBER)
        (lost,) = struct.unpack_from("<Q", frame, _LOST)
        (ticks,) = struct.unpack_from("<I", frame, _TICKS)
        if self.frames == 0:
            self.first_number, self.ticks_until = number, server.ticks_before
        self.ticks_missed += server.ticks_before - self.ticks_until
        self.ticks_until = server.ticks_before + ticks
        struct.pack_into("<QQ", frame, _DROPPED, number - self.first_number - self.frames, lost + self.ticks_missed)
        self.frames += 1
        self.undrawn += 1
        return bytes(frame)

    def send(self) -> None:
        """Its thread: the scene; after "ready" what else comes first, frames, the end."""
        server = self.server
        try:
            self.link.send(_BYTES, server.first[0])
            with server.changed:
                server.changed.wait_for(lambda: self.is_ready or self.is_gone)
            for message in server.first[1:]:
                if message[:4] == _FRAME:
                    with server.changed:
                        server.changed.wait_for(lambda: self.is_gone or self.undrawn < UNDRAWN)
                        self.undrawn += 1
                if self.is_gone:
                    return
                self.link.send(_BYTES, message)
            while True:
                with server.changed:
                    server.changed.wait_for(
                        lambda: (
                            self.is_gone or server.end is not None or (self.is_hungry() and self.serial < server.serial)
                        )
                    )
                    if self.is_gone:
                        return
                    frame = self._frame() if self.is_hungry() and self.serial < server.serial else None
                    end = server.end
                if frame is not None:
                    self.link.send(_BYTES, frame)
                elif end is not None:
                    self.link.send(_BYTES, end)
                    return
        except OSError:
            self.link.hang_up()  # what was cut cannot be gone on from

    def hear(self, text: str) -> None:
        now = time.monotonic()
        self.allowance = min(MESSAGES_A_SECOND, self.allowance + (now - self.heard_at) * MESSAGES_A_SECOND) - 1
        self.heard_at = now
        hand = _HAND.fullmatch(text)
        with self.server.changed:
            if self.allowance < 0:
                raise _Refused(POLICY)
            if text == "ready" and not self.is_ready:
                self.is_ready = True
            elif text == "drawn" and self.undrawn > 0:
                self.undrawn -= 1
            elif not (hand and self.server.steer):
                raise _Refused(POLICY)
            self.server.changed.notify_all()
        if hand and self.server.steer:
            try:
                x, y, z = map(float, hand.groups())
            except ValueError:
                raise _Refused(POLICY) from None
            if not all(math.isfinite(c) and abs(c) <= 1e6 for c in (x, y, z)):
                raise _Refused(POLICY)
            self.server.steer(x, y, z)


class _Handler(BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"
    timeout = HEADERS_SECONDS
    server: ViewServer

    def version_string(self) -> str:
        return "dynpoint"

    def log_message(self, format: str, *args: Any) -> None:
        """Nothing: an address is a secret."""

    def setup(self) -> None:
        super().setup()
        self.late = threading.Timer(HEADERS_SECONDS, self._cut)  # however slowly they come
        self.late.daemon = True
        self.late.start()

    def finish(self) -> None:
        self.late.cancel()
        super().finish()

    def _cut(self) -> None:
        _Socket(self.connection).hang_up()

    def _is_late(self, link: _Socket) -> None:
        self.server.refused += 1
        link.close(POLICY)
        self._cut()

    def _answer(self, status: HTTPStatus, content: bytes = b"", kind: str = "text/plain") -> None:
        self.close_connection = True
        if status != HTTPStatus.OK:
            self.server.refused += 1
        self.send_response(status)
        for name, value in (
            ("content-security-policy", self.server.policy()),
            ("x-content-type-options", "nosniff"),
            ("referrer-policy", "no-referrer"),
            ("cross-origin-resource-policy", "same-origin"),
            ("cross-origin-opener-policy", "same-origin"),
            ("cache-control", "no-store"),
            ("content-type", kind),
            ("content-length", str(len(content))),
            ("connection", "close"),
        ):
            self.send_header(name, value)
        self.end_headers()
        if self.command != "HEAD":
            self.wfile.write(content)

    def _is_own(self) -> bool:
        return self.headers.get_all("host", []) in [[name] for name in self.server.hosts]

    def do_HEAD(self) -> None:
        self.do_GET()

    def do_GET(self) -> None:
        self.late.cancel()
        if not self._is_own():
            self._answer(HTTPStatus.FORBIDDEN)
        elif self.path != "/":
            self._answer(HTTPStatus.NOT_FOUND)
        elif "upgrade" not in self.headers:
            self.connection.settimeout(PAGE_SECONDS)
            self._answer(HTTPStatus.OK, self.server.page, "text/html; charset=utf-8")
        else:
            self._upgrade()

    def send_error(self, code: int, message: Optional[str] = None, explain: Optional[str] = None) -> None:
        """Of what BaseHTTPRequestHandler refuses: a method without a function of its name is not allowed."""
        if not hasattr(self, "headers"):
            self.close_connection = True
            return
        self._answer(HTTPStatus.METHOD_NOT_ALLOWED if code == HTTPStatus.NOT_IMPLEMENTED else HTTPStatus(code))

    def _upgrade(self) -> None:
        key = self.headers.get("sec-websocket-key", "")
        offered = [word.strip() for word in self.headers.get("sec-websocket-protocol", "").split(",")]
        if self.headers.get_all("origin", []) != ["http://" + self.headers["host"]]:
            return self._answer(HTTPStatus.FORBIDDEN)
        if (
            self.headers["upgrade"].lower() != "websocket"
            or self.headers.get("sec-websocket-version") != "13"
            or PROTOCOL not in offered
            or len(key) != 24
            or self.command != "GET"
        ):
            return self._answer(HTTPStatus.BAD_REQUEST)
        if not self.server.has_room():
            return self._answer(HTTPStatus.SERVICE_UNAVAILABLE)
        self.close_connection = True
        proof = hashlib.sha1(key.encode() + b"258EAFA5-E914-47DA-95CA-C5AB0DC85B11", usedforsecurity=False).digest()
        self.send_response(HTTPStatus.SWITCHING_PROTOCOLS)
        for name, value in (
            ("upgrade", "websocket"),
            ("connection", "Upgrade"),
            ("sec-websocket-protocol", PROTOCOL),
            ("sec-websocket-accept", base64.b64encode(proof).decode()),
        ):
            self.send_header(name, value)
        self.end_headers()
        self._speak(_Socket(self.connection))

    def _speak(self, link: _Socket) -> None:
        client = None
        try:
            self.late = threading.Timer(TOKEN_SECONDS, self._is_late, (link,))
            self.late.daemon = True
            self.late.start()
            token = link.receive()
            self.late.cancel()
            if not secrets.compare_digest(token.encode(), self.server.token.encode()):
                raise _Refused(POLICY)
            client = self.server.enter(link)
            self.connection.settimeout(SEND_SECONDS)
            sender = threading.Thread(target=client.send, name="dynpoint page", daemon=True)
            sender.start()
            while True:
                try:
                    client.hear(link.receive())
                except TimeoutError:
                    if link.is_closing:
                        break
                    link.send(_PING, b"")
        except _Refused as refusal:
            self.server.refused += 1
            link.close(refusal.args[0])
        except (OSError, ValueError):
            pass
        finally:
            self.late.cancel()
            if client:
                self.server.leave(client)
            self._drain()

    def _drain(self) -> None:
        """What the page has said meanwhile would make the system throw away what it still has to get."""
        until = time.monotonic() + 0.5
        try:
            self.connection.shutdown(socket.SHUT_WR)
            self.connection.settimeout(0.5)
            while time.monotonic() < until and self.connection.recv(65536):
                pass
        except OSError:
            pass


class ViewServer(ThreadingHTTPServer):
    """Serves the page on this machine alone, at 127.0.0.1, in threads of its own.

    first   messages for each page: the scene, and what else comes before frames
    next    a newer frame or None; called in one thread, 60 times a second at most, while a page waits for one
    steer   where the simulated hand is to go; None: it is not asked
    frames  origins of pages that may have this one in a frame of theirs"""

    daemon_threads = True
    block_on_close = False
    request_queue_size = CONNECTIONS

    def __init__(
        self,
        first: Sequence[bytes],
        next: Optional[Callable[[], Optional[bytes]]] = None,
        steer: Optional[Steer] = None,
        *,
        port: int = 0,
        end: Optional[str] = None,
        frames: Iterable[str] = (),
    ) -> None:
        folder = Path(__file__).parent
        try:
            self.page = (folder / "page.html").read_bytes()
            self.page_policy = (folder / "page.csp").read_text().strip()
        except FileNotFoundError:
            raise RuntimeError(
                "this package was built without the viewer's page: make deps view, then make wheel"
            ) from None
        self.first, self.next, self.steer = list(first), next, steer
        self.frame_origins = list(frames)
        self.token = secrets.token_hex(16)
        self.changed = threading.Condition()
        self.clients: List[_Client] = []
        self.newest, self.serial, self.ticks_before, self._ticks, self.refused = b"", 0, 0, 0, 0
        self.end = None if end is None else end_message(end)
        self.is_closed = False
        self._places = threading.BoundedSemaphore(CONNECTIONS)
        super().__init__(("127.0.0.1", port), _Handler)
        self.hosts = [f"{name}:{self.server_port}" for name in ("127.0.0.1", "localhost")]
        for name, work in (("dynpoint viewer", self.serve_forever), ("dynpoint frames", self._look)):
            threading.Thread(target=work, name=name, daemon=True).start()

    @property
    def url(self) -> str:
        """The page's address with its token, which browsers send to nobody: a secret."""
        return f"http://127.0.0.1:{self.server_port}/#{self.token}"

    def policy(self) -> str:
        """The page's, with who may frame it."""
        allowed = " ".join(self.frame_origins) or "'none'"
        return self.page_policy.replace("frame-ancestors 'none'", f"frame-ancestors {allowed}")

    def process_request(self, request: Any, address: Any) -> None:
        if not self._places.acquire(blocking=False):
            self.refused += 1
            self.shutdown_request(request)
            return
        super().process_request(request, address)

    def process_request_thread(self, request: Any, address: Any) -> None:
        try:
            super().process_request_thread(request, address)
        finally:
            self._places.release()

    def handle_error(self, request: Any, address: Any) -> None:
        """A client that went away is no error of ours."""

    def has_room(self) -> bool:
        with self.changed:
            return len(self.clients) < CLIENTS

    def enter(self, link: _Socket) -> _Client:
        client = _Client(self, link)
        with self.changed:
            if len(self.clients) >= CLIENTS:
                raise _Refused(LATER)
            self.clients.append(client)
        return client

    def leave(self, client: _Client) -> None:
        with self.changed:
            client.is_gone = True
            self.clients.remove(client)
            self.changed.notify_all()

    def _look(self) -> None:
        """For frames, while a page waits for one."""
        while not self.is_closed:
            with self.changed:
                self.changed.wait_for(
                    lambda: self.is_closed or (self.end is None and any(c.is_hungry() for c in self.clients))
                )
            if self.next and not self.is_closed:
                self._take(self.next())
            time.sleep(1 / FRAMES_A_SECOND)

    def _take(self, frame: Optional[bytes]) -> None:
        if frame is None:
            return
        with self.changed:
            self.newest, self.ticks_before = frame, self._ticks
            self._ticks += struct.unpack_from("<I", frame, _TICKS)[0]
            self.serial += 1
            self.changed.notify_all()

    def tell_end(self, text: str) -> None:
        """There will be no more frames, and this says why. The first call counts."""
        with self.changed:
            if self.end is None:
                self.end = end_message(text)
            self.changed.notify_all()

    def close(self, text: str = "The view was closed.") -> None:
        """Take leave of the pages: half a second at most is given to what they still have to get."""
        if self.is_closed:
            return
        self.tell_end(text)
        until = time.monotonic() + 0.5
        for client in list(self.clients):
            while client.is_ready and not client.is_gone and time.monotonic() < until:
                time.sleep(0.01)
        self.is_closed = True
        for client in list(self.clients):
            client.link.close(NORMAL, LEAVE_SECONDS)
        with self.changed:
            self.changed.notify_all()
        self.shutdown()
        self.server_close()


def messages_of(page: bytes) -> Tuple[bytes, ...]:
    """What a page that plays by itself has in it (docs/view.md, "Messages")."""
    found = re.search(rb'id="data"[^>]*>([A-Za-z0-9+/=\s]*)<', page)
    if not found:
        raise ValueError("the page has no messages")
    content = base64.b64decode(found[1])
    messages, at = [], 0
    while at < len(content):
        (size,) = struct.unpack_from("<Q", content, at)
        messages.append(content[at + 8 : at + 8 + size])
        at += 8 + (size + 7) // 8 * 8
    return tuple(messages)
