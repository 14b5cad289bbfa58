# SPDX-License-Identifier: BSD-3-Clause
"""Whatever ends a program that pushes, the last command on the line is zero force: programs of Python push with the simulated
serial device, through a line that is read here."""
import os
import pty
import re
import select
import signal
import struct
import subprocess
import sys
import tempfile
import threading
import time
import tty
import unittest
from pathlib import Path

import numpy as np

import dynpoint as dp
from verdicts import PROGRAM, main

COMMAND = 4


def unstuff(frame):
    """The body of a frame between two zeros (docs/wire.md), without its checksum."""
    code, body, at = frame[:-5], bytearray(), 0
    while at < len(code):
        step = code[at]
        body += code[at + 1:at + step]
        at += step
        if at < len(code):
            body.append(0)
    return bytes(body)


class Line:
    """A pseudo-terminal in front of the simulated device's, which keeps what a host sends."""

    def __init__(self):
        self.simulator = subprocess.Popen([PROGRAM, "device", "simulate", "serial"], stdout=subprocess.PIPE, text=True)
        there = re.search(r"/dev/\S+", self.simulator.stdout.readline())[0].split("serial:")[-1]
        self.far = os.open(there, os.O_RDWR | os.O_NOCTTY)
        self.near, self.slave = pty.openpty()
        for end in (self.far, self.slave):
            tty.setraw(end)
            os.set_blocking(end, False)
        os.set_blocking(self.near, False)
        self.name = "serial:" + os.ttyname(self.slave)
        self.sent = bytearray()
        self.ends = False
        self.thread = threading.Thread(target=self.carry)
        self.thread.start()

    def carry(self):
        while not self.ends:
            for end in select.select([self.near, self.far], [], [], 0.05)[0]:
                try:
                    some = os.read(end, 4096)
                    if end == self.near:
                        self.sent += some
                    os.write(self.far if end == self.near else self.near, some)
                except OSError:  # nobody listens on the other side
                    time.sleep(0.002)

    def forces(self):
        """Of all commands so far."""
        bodies = [unstuff(frame) for frame in bytes(self.sent).split(b"\0") if len(frame) > 5]
        return [struct.unpack_from("<3f", body, 12) for body in bodies if body[0] == COMMAND]

    def close(self):
        self.ends = True
        self.thread.join()
        self.simulator.terminate()
        self.simulator.wait()
        self.simulator.stdout.close()
        for end in (self.far, self.near, self.slave):
            os.close(end)


HEAD = """
import os, sys, time, gc, signal, threading
import numpy as np
import dynpoint as dp
name = sys.argv[1]
"""
# A machine that has more to do than it can may miss the device's watchdog: then go on.
LOOP = HEAD + """
device = dp.Device(name)
count = 0
def tick(state, wrench, dt):
    global count
    wrench[1] = 1.0
    if state.status != dp.DeviceStatus.READY:
        device.clear()
    else:
        count += 1
    if count == 300:
        print("pushing", flush=True)
        END
dp.Loop(device, tick, lock=0, reopen=1).run(4000)
"""
OWN = HEAD + """
device = dp.Device(name)
k = 0
while k < 400:
    if device.read().status != dp.DeviceStatus.READY:
        device.clear()
        continue
    try:
        device.write([0, 1, 0, 0, 0, 0])
    except dp.Error as error:
        if error.name not in ("DPT_E_NOT_READY", "DPT_E_LOST"):
            raise
    time.sleep(0.001)
    k += 1
    if k == 300:
        print("pushing", flush=True)
        END
print("at the end", flush=True)
"""
SCENE = HEAD + """
mesh = dp.Mesh.compile([[-9, -.001, -9], [9, -.001, -9], [9, -.001, 9], [-9, -.001, 9]], [[0, 3, 2], [0, 2, 1]], unit="m")
scene = dp.Scene(device=name, bodies=[mesh], flags=dp.constants()["DPT_HOST_FLAG_REOPEN"], ticks=4000)
threading.Timer(1.5, lambda: (print("pushing", flush=True), os.kill(os.getpid(), signal.SIGINT))).start()
scene.run()
"""
FELT = SCENE.replace("ticks=4000)", "ticks=4000, felt=felt)").replace("scene = ", """count = 0
def felt(state, wrench, dt, result):
    global count
    count += 1
    if count == 1000:
        print("pushing", flush=True)
        END
scene = """).replace("threading.Timer", "0 and threading.Timer")


class Safety(unittest.TestCase):
    def ends_in_zero(self, program, error, status=1):
        """Run a program that says when it pushes; the line's last commands, and what it said."""
        line = Line()
        try:
            ran = subprocess.run([sys.executable, "-W", "ignore", "-c", program, line.name], capture_output=True, text=True, timeout=60)
            time.sleep(0.2)
            forces = line.forces()
        finally:
            line.close()
        self.assertIn("pushing", ran.stdout, ran.stderr)
        self.assertIn(error, ran.stderr)
        self.assertEqual(ran.returncode, status, ran.stderr)
        pushes = [k for k, force in enumerate(forces) if any(force)]
        self.assertGreater(len(pushes), 50)
        self.assertEqual(forces[-1], (0, 0, 0))
        return len(forces) - 1 - pushes[-1]

    def test_an_exception_in_a_tick(self):
        self.ends_in_zero(LOOP.replace("END", "raise ZeroDivisionError('in a tick')"), "ZeroDivisionError: in a tick")

    def test_Ctrl_C_in_a_tick(self):
        self.ends_in_zero(LOOP.replace("END", "os.kill(os.getpid(), signal.SIGINT)"), "KeyboardInterrupt", -signal.SIGINT)

    def test_sys_exit_in_a_tick(self):
        self.ends_in_zero(LOOP.replace("END", "sys.exit(3)"), "", 3)

    def test_a_tick_that_returns_nonsense(self):
        self.ends_in_zero(LOOP.replace("END", "return 'hard'"), "what the tick returned: wanted 6 numbers")

    def test_an_exception_in_a_loop_of_one_s_own(self):
        self.ends_in_zero(OWN.replace("END", "raise ZeroDivisionError('here')"), "ZeroDivisionError: here")

    def test_Ctrl_C_in_a_loop_of_one_s_own(self):
        self.ends_in_zero(OWN.replace("END", "os.kill(os.getpid(), signal.SIGINT)"), "KeyboardInterrupt", -signal.SIGINT)

    def test_sys_exit_in_a_loop_of_one_s_own(self):
        self.ends_in_zero(OWN.replace("END", "sys.exit(0)"), "", 0)

    def test_the_interpreter_s_end(self):
        self.ends_in_zero(OWN.replace("END", "pass"), "", 0)

    def test_garbage(self):
        self.ends_in_zero(OWN.replace("END", "break") + "del device; gc.collect(); os._exit(7)", "", 7)

    def test_a_fork_sends_nothing(self):
        self.ends_in_zero(OWN.replace("END", """child = os.fork()
        if child == 0:
            del device
            sys.exit(0)
        os.waitpid(child, 0)"""), "", 0)

    def test_Ctrl_C_in_the_library_s_loop(self):
        self.ends_in_zero(SCENE, "KeyboardInterrupt", -signal.SIGINT)

    def test_an_exception_in_what_is_felt(self):
        self.ends_in_zero(FELT.replace("END", "raise ZeroDivisionError('felt')"), "ZeroDivisionError: felt")

    def test_a_scene_felt_is_recorded_and_read(self):
        with tempfile.TemporaryDirectory() as room:
            path, seen = Path(room) / "läuft.dpr", []
            scene = dp.Scene("liver", "sim:?hand=press", ticks=800, record=path,
                             felt=lambda state, wrench, dt, result: seen.append((result, wrench.copy(), scene.tool.wrench)))
            stats, info = scene.run(), scene.info
            scene.close()
            self.assertEqual((int(stats.ticks), len(seen), int(info.ticks)), (800, 800, 800))
            recording = dp.Recording(path)
            self.assertEqual((len(recording), recording.rate, recording.scene["scene"]), (800, 1000.0, "liver"))
            self.assertTrue(np.array_equal(recording.records["asked"], [wrench for _, wrench, _ in seen]))
            self.assertGreater(info.force_max, 0.1)
            told = subprocess.run([PROGRAM, "replay", path], capture_output=True, text=True)
            self.assertEqual(told.returncode, 0, told.stderr)
            path.write_bytes(path.read_bytes()[:-100])
            with self.assertWarnsRegex(UserWarning, "799 records before it"):
                self.assertEqual(len(dp.Recording(path)), 799)

    def test_a_scene_whose_loop_is_ours(self):
        with dp.Device("sim:?hand=press") as device, dp.Scene("liver", info=device.info) as scene:
            largest = 0.0
            for _ in range(1500):
                state = np.zeros(1, dp.DEVICE_STATE)
                device.read(state)
                wrench = scene.tick(state, int(state[0].time_ns))
                device.write(wrench)
                largest = max(largest, float(np.linalg.norm(wrench[:3])))
            self.assertGreater(largest, 0.1)
            self.assertLess(largest, device.info.force_max)
            self.assertEqual(scene.info.ticks, 1500)
            # Silence: the guard ends the force.
            state["fresh"] = 0
            for k in range(10):
                wrench = scene.tick(state, int(state[0].time_ns) + (k + 1) * 1000000)
            self.assertEqual(wrench.tolist(), [0] * 6)

    def test_a_scene_stops_from_another_thread(self):
        with dp.Scene("liver", "sim:?hand=press&live=1") as scene:
            threading.Timer(0.3, scene.stop).start()
            stats = scene.run()
            self.assertGreater(stats.ticks, 50)
            self.assertFalse(scene.running)


if __name__ == "__main__":
    main()
