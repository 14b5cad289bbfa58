#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""make bench: what a viewer costs a haptic loop by the clock.

viewer.py BUILD [PAIRS [SECONDS]]   runs scenes on a live simulated device, in pairs: without a viewer, and with one that
                                    draws each frame. Each tick's own times come from the run's recording, not from
                                    bins. Prints a CSV: the medians over the pairs of each percentile of how late a tick
                                    was and how long its work took, and the ratio of the 99 % with its spread.
Standard library only.
"""
import base64
import os
import re
import socket
import struct
import subprocess
import sys
import tempfile
import threading

SCENES = ("liver", "soft-liver")
SKIP = 500  # ticks: the beginning


class Client(threading.Thread):
    """A viewer that draws at once: it reads every frame and says so."""

    def __init__(self, url):
        super().__init__(daemon=True)
        self.port, self.token = re.fullmatch(r"http://127\.0\.0\.1:(\d+)/#(\w+)", url).groups()
        self.frames = self.bytes = 0

    def exactly(self, size):
        data = bytearray()
        while len(data) < size:
            more = self.socket.recv(min(size - len(data), 1 << 20))
            if not more:
                raise EOFError
            data += more
        return bytes(data)

    def say(self, text):
        data = text.encode()
        self.socket.sendall(struct.pack("!BB4x", 0x81, 0x80 | len(data)) + data)

    def message(self):
        whole = b""
        while True:
            first, length = self.exactly(2)
            if length >= 126:
                length = int.from_bytes(self.exactly(2 if length == 126 else 8), "big")
            data = self.exactly(length)
            if first & 15 == 8:
                raise EOFError
            whole += data
            if first & 0x80:
                return whole

    def run(self):
        host = f"127.0.0.1:{self.port}"
        self.socket = socket.create_connection(("127.0.0.1", int(self.port)))
        self.socket.sendall(
            (f"GET / HTTP/1.1\r\nHost: {host}\r\nOrigin: http://{host}\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n"
             "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Protocol: dynpoint\r\n"
             f"Sec-WebSocket-Key: {base64.b64encode(os.urandom(16)).decode()}\r\n\r\n").encode())
        head = b""
        while not head.endswith(b"\r\n\r\n"):
            head += self.exactly(1)
        assert b" 101 " in head.split(b"\r\n")[0], head
        try:
            self.say(self.token)
            self.message()
            self.say("ready")
            while True:
                frame = self.message()
                if frame[0] == 2:
                    self.frames += 1
                    self.bytes += len(frame)
                    self.say("drawn")
        except (EOFError, OSError):
            pass


def measure(program, scene, seconds, folder, with_viewer):
    """One run: each tick's lateness and work in us, and how many frames were drawn."""
    path = os.path.join(folder, "run.dpr")
    command = [program, "run", scene, "--device", "sim:?hand=press&live=1", "--for", str(seconds), "--record", path]
    run = subprocess.Popen(command + ["--view"] * with_viewer, stdout=subprocess.PIPE, text=True)
    client = None
    if with_viewer:
        address = run.stdout.readline().split()
        if not address:
            sys.exit(f"{program} run --view ended with status {run.wait()}")
        client = Client(address[-1])
        client.start()
    run.communicate()
    assert run.returncode == 0
    table = subprocess.run([program, "record", "csv", path, "-o", "-"], check=True, capture_output=True, text=True)
    rows = [line.split(",") for line in table.stdout.splitlines()]
    late, took = rows[0].index("late_ns"), rows[0].index("took_ns")
    rows = rows[1 + SKIP:]
    return ([int(row[late]) / 1000 for row in rows], [int(row[took]) / 1000 for row in rows if row[took] != "0"],
            client.frames if client else 0, client.bytes if client else 0)


def percentile(values, share):
    return sorted(values)[min(len(values) - 1, int(share * len(values)))]


def median(values):
    return percentile(values, 0.5)


def main():
    program = os.path.join(sys.argv[1], "dynpoint")
    pairs = int(sys.argv[2]) if len(sys.argv) > 2 else 7
    seconds = float(sys.argv[3]) if len(sys.argv) > 3 else 10.0
    shares = (0.5, 0.99, 0.999, 1.0)
    print("scene,what,viewer,median_us,p99_us,p999_us,max_us,p99_ratio,p99_ratio_least,p99_ratio_most,frames_a_second,kB_a_frame")
    with tempfile.TemporaryDirectory() as folder:
        for scene in SCENES:
            runs = {0: [], 1: []}
            for pair in range(pairs):
                for with_viewer in (pair % 2, 1 - pair % 2):
                    runs[with_viewer].append(measure(program, scene, seconds, folder, with_viewer))
            for what, column in (("late", 0), ("took", 1)):
                ratios = [percentile(b[column], 0.99) / percentile(a[column], 0.99) for a, b in zip(runs[0], runs[1])]
                for with_viewer in (0, 1):
                    of = runs[with_viewer]
                    times = [median([percentile(run[column], share) for run in of]) for share in shares]
                    frames = sum(run[2] for run in of)
                    print(f"{scene},{what},{with_viewer}," + ",".join(f"{time:.1f}" for time in times)
                          + (f",{median(ratios):.3f},{min(ratios):.3f},{max(ratios):.3f},{frames / pairs / seconds:.1f},"
                             f"{sum(run[3] for run in of) / max(frames, 1) / 1000:.1f}" if with_viewer else ",,,,,"),
                          flush=True)


main()
