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

COMMAND, ORDER, STOP = 4, 5, 3  # of docs/wire.md


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


def with_interrupts():
    """A shell's job in the background ignores Ctrl-C, and so would what it starts."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


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
        self.sent, self.looked_at, self.said = bytearray(), 0, []
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
        """Of all commands so far; to turn the motors off is zero force too."""
        end = self.sent.rfind(b"\0") + 1
        for frame in bytes(self.sent[self.looked_at:end]).split(b"\0"):
            body = unstuff(frame) if len(frame) > 5 else b"\0"
            if body[0] == COMMAND:
                self.said.append(struct.unpack_from("<3f", body, 12))
            elif body[0] == ORDER and body[4] == STOP:
                self.said.append((0, 0, 0))
        self.looked_at = max(end, self.looked_at)
        return self.said

    def close(self):
        self.ends = True
        self.thread.join()
        self.simulator.terminate()
        self.simulator.wait()
        self.simulator.stdout.close()
        for end in (self.far, self.near, self.slave):
            os.close(end)


HEAD = """
import os, sys, time, gc, signal
import dynpoint as dp
name, count = sys.argv[1], 0
def end():
    print("pushing", flush=True)
    END
"""
# A machine that has more to do than it can may miss the device's watchdog, or its samples: then go on.
LOOP = HEAD + """
device = dp.Device(name)
def tick(state, wrench, dt):
    global count
    wrench[1] = 1.0
    if state.status != dp.DeviceStatus.READY:
        device.clear()
    else:
        count += 1
        if count == 100:
            return end()
dp.Loop(device, tick, lock=0, reopen=1).run()
"""
OWN = HEAD + """
device = dp.Device(name)
def late(call, *arguments):
    try:
        return call(*arguments)
    except dp.Error as error:
        if error.name not in ("DPT_E_NOT_READY", "DPT_E_LOST"):
            raise
def push():
    global count
    state = late(device.read)
    if state is not None and state.status == dp.DeviceStatus.READY:
        count += late(device.write, [0, 1, 0, 0, 0, 0]) or 0
    else:
        late(device.clear)
    time.sleep(0.001)
while count < 100:
    push()
end()
"""
SCENE = HEAD + """
mesh = dp.Mesh.compile([[-9, -.001, -9], [9, -.001, -9], [9, -.001, 9], [-9, -.001, 9]], [[0, 3, 2], [0, 2, 1]], unit="m")
told = []
signal.signal(signal.SIGUSR1, lambda number, frame: told.append(number))
def felt(state, wrench, dt, result):
    if told:
        end()
reopen = dp.constants()["DPT_HOST_FLAG_REOPEN"]
dp.Scene(device=name, bodies=[mesh], flags=reopen, felt=FELT).run()
"""


class Safety(unittest.TestCase):
    def end(self, program, how, wake, until):
        """What the program says, its status, and all forces. None if it was stopped instead: a machine that has more to
        do than it can has missed the device's watchdog, and a scene leaves a fault to its user."""
        line, before, heard = Line(), 0, 0
        try:
            with subprocess.Popen([sys.executable, "-W", "ignore", "-c", program.replace("END", how), line.name], text=True,
                                  stdout=subprocess.PIPE, stderr=subprocess.PIPE, preexec_fn=with_interrupts) as ran:
                while wake and ran.poll() is None and time.monotonic() < until:
                    time.sleep(0.05)
                    forces = line.forces()
                    if sum(map(any, forces)) > 30:
                        ran.send_signal(wake)
                        break
                    if len(forces) > before:
                        before, heard = len(forces), time.monotonic()
                    elif before and time.monotonic() - heard > 3:
                        ran.kill()
                        return None
                try:
                    said, told = ran.communicate(timeout=max(60, until - time.monotonic()))
                except subprocess.TimeoutExpired:
                    ran.kill()
                    raise
            time.sleep(0.2)
            return said, told, ran.returncode, line.forces()
        finally:
            line.close()

    def ends_in_zero(self, program, how, error, status, wake=None):
        """Run a program that ends by `how` once it has pushed; or send it a signal then. The last command is zero force."""
        until, ended = time.monotonic() + 600, None
        while ended is None:
            ended = self.end(program, how, wake, until)
        said, told, returned, forces = ended
        if wake != signal.SIGINT:
            self.assertIn("pushing", said, told)
        self.assertIn(error, told)
        self.assertEqual(returned, status, told)
        self.assertGreater(sum(map(any, forces)), 20)
        self.assertEqual(forces[-1], (0, 0, 0))

    def test_an_exception_in_a_tick(self):
        self.ends_in_zero(LOOP, "raise ZeroDivisionError('in a tick')", "ZeroDivisionError: in a tick", 1)

    def test_Ctrl_C_in_a_tick(self):
        self.ends_in_zero(LOOP, "os.kill(os.getpid(), signal.SIGINT)", "KeyboardInterrupt", -signal.SIGINT)

    def test_sys_exit_in_a_tick(self):
        self.ends_in_zero(LOOP, "sys.exit(3)", "", 3)

    def test_a_tick_that_returns_nonsense(self):
        self.ends_in_zero(LOOP, "return 'hard'", "what the tick returned: wanted 6 numbers", 1)

    def test_an_exception_in_a_loop_of_one_s_own(self):
        self.ends_in_zero(OWN, "raise ZeroDivisionError('here')", "ZeroDivisionError: here", 1)

    def test_Ctrl_C_in_a_loop_of_one_s_own(self):
        self.ends_in_zero(OWN, "os.kill(os.getpid(), signal.SIGINT)", "KeyboardInterrupt", -signal.SIGINT)

    def test_sys_exit_in_a_loop_of_one_s_own(self):
        self.ends_in_zero(OWN, "sys.exit(3)", "", 3)

    def test_the_interpreter_s_end(self):
        self.ends_in_zero(OWN, "pass", "", 0)

    def test_garbage(self):
        self.ends_in_zero(OWN, "global device; del device; gc.collect(); os._exit(7)", "", 7)

    def test_a_fork_sends_nothing(self):
        self.ends_in_zero(OWN, """global device
    child = os.fork()
    if child == 0:
        del device
        sys.exit(0)
    while os.waitpid(child, os.WNOHANG)[0] == 0:
        push()""", "", 0)

    def test_Ctrl_C_in_the_library_s_loop(self):
        self.ends_in_zero(SCENE.replace("FELT", "None"), "pass", "KeyboardInterrupt", -signal.SIGINT, signal.SIGINT)

    def test_Ctrl_C_that_is_the_system_s(self):
        program = "import signal; signal.signal(signal.SIGINT, signal.SIG_DFL)" + SCENE.replace("FELT", "None")
        self.ends_in_zero(program, "pass", "", -signal.SIGINT, signal.SIGINT)

    def test_an_exception_in_what_is_felt(self):
        self.ends_in_zero(SCENE.replace("FELT", "felt"), "raise ZeroDivisionError('felt')", "ZeroDivisionError: felt", 1,
                          signal.SIGUSR1)

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
        felt, seen = threading.Event(), []

        def feel(state, wrench, dt, result):
            seen.append(state.sequence)
            if len(seen) == 50:
                felt.set()

        with dp.Scene("liver", "sim:?hand=press&live=1", felt=feel) as scene:
            thread = threading.Thread(target=lambda: (felt.wait(), scene.stop()))
            thread.start()
            stats = scene.run()
            thread.join()
            self.assertGreaterEqual(stats.ticks, 50)
            self.assertEqual((scene.running, len(seen)), (False, int(scene.info.ticks)))


if __name__ == "__main__":
    main()
