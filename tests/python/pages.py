# SPDX-License-Identifier: BSD-3-Clause
"""What a page of a viewer says and hears, by hand: a web socket, whose frames are made and read here from RFC 6455
alone, and plain requests."""

import base64
import os
import socket
import struct
from urllib.parse import urlsplit


class Page:
    """A socket to the server of `url`."""

    def __init__(self, url, patience=20):
        parts = urlsplit(url)
        self.host, self.token = parts.netloc, parts.fragment
        self.socket = socket.create_connection((parts.hostname, parts.port))
        self.socket.settimeout(patience)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.socket.close()

    def ask(self, line="GET / HTTP/1.1", **headers):
        """The status and the headers of the answer; host=None leaves out that header."""
        named = {"host": self.host, **headers}
        lines = [line, *(f"{name.replace('_', '-')}: {value}" for name, value in named.items() if value is not None)]
        self.socket.sendall("\r\n".join([*lines, "", ""]).encode())
        head = b""
        while not head.endswith(b"\r\n\r\n"):
            head += self.take(1)
        first, *rest = head.decode().strip().split("\r\n")
        return int(first.split()[1]), {name.lower(): value for name, value in (line.split(": ", 1) for line in rest)}

    def upgrade(self, **headers):
        """The status of a handshake; headers replace those of a page of this server."""
        return self.ask(
            **{
                "origin": "http://" + self.host,
                "upgrade": "websocket",
                "connection": "Upgrade",
                "sec_websocket_version": 13,
                "sec_websocket_protocol": "dynpoint",
                "sec_websocket_key": base64.b64encode(os.urandom(16)).decode(),
                **headers,
            }
        )[0]

    def join(self):
        """A page that is known: the first message."""
        assert self.upgrade() == 101
        self.say(self.token)
        return self.hear()

    def take(self, size):
        parts = b""
        while len(parts) < size:
            part = self.socket.recv(size - len(parts))
            if not part:
                raise EOFError
            parts += part
        return parts

    def say(self, text, first=0x81, masked=True):
        content = text.encode()
        size = (
            bytes([len(content) | 128 * masked])
            if len(content) < 126
            else struct.pack(">BH", 126 | 128 * masked, len(content))
        )
        mask = os.urandom(4) if masked else b""
        self.socket.sendall(
            bytes([first]) + size + mask + bytes(x ^ mask[i % 4] if masked else x for i, x in enumerate(content))
        )

    def hear(self):
        """The next message's bytes; of a close its code."""
        first, size = self.take(2)
        (size,) = (
            struct.unpack(">H", self.take(2))
            if size == 126
            else struct.unpack(">Q", self.take(8))
            if size == 127
            else (size,)
        )
        content = self.take(size)
        return struct.unpack(">H", content)[0] if first == 0x88 else content

    def closed_with(self):
        """The code of the close that comes, after whatever was on its way."""
        while not isinstance(heard := self.hear(), int):
            pass
        return heard
