# SPDX-License-Identifier: BSD-3-Clause
"""What cannot be done is refused with a text that says what was wanted, and the process goes on."""
import multiprocessing
import os
import pickle
import signal
import tempfile
import threading
import unittest
from pathlib import Path

import numpy as np

import dynpoint as dp
from verdicts import main

VERTICES = np.array([[-1, 0, -1], [1, 0, -1], [0, 0, 1.0]])
TRIANGLES = np.array([[0, 2, 1]], np.uint32)


def sheet(**settings):
    return dp.Mesh.compile(VERTICES, TRIANGLES, unit="m", **settings)


def in_a_child(function):
    """What a fork of this process gets of a call: the exception's name and text."""
    read, write = os.pipe()
    child = os.fork()
    if child == 0:
        try:
            function()
            said = "nothing"
        except BaseException as error:
            said = f"{type(error).__name__}: {error}"
        os.write(write, said.encode())
        os._exit(0)
    os.close(write)
    said = os.read(read, 4096).decode()
    os.close(read)
    os.waitpid(child, 0)
    return said


class Misuse(unittest.TestCase):
    def refuse(self, kind, text, function, *arguments, **keywords):
        with self.assertRaisesRegex(kind, text):
            function(*arguments, **keywords)

    def test_use_after_close(self):
        world = dp.World()
        body, tool = world.add_body(sheet()), world.add_tool([0, 0, 0], [0, 1, 0])
        world.close()
        world.close()
        for call in (lambda: world.step(0.001), lambda: tool.set_pose([0, 0, 0]), lambda: tool.wrench, lambda: body.pose,
                     lambda: world.add_body(sheet()), lambda: tool.tick([0, 0, 0], 0.001), world.reset, lambda: world.info):
            self.refuse(ValueError, "the world is closed", call)
        self.assertEqual((repr(world), body.valid, repr(tool)), ("<dynpoint.World: closed>", False, "<dynpoint.Tool: removed>"))
        device = dp.Device("sim:")
        device.close()
        device.close()
        for call in (device.read, lambda: device.write([0] * 6), device.clear, lambda: device.info,
                     lambda: dp.Loop(device, print).run(1)):
            self.refuse(ValueError, "the device is closed", call)
        scene = dp.Scene("liver", "sim:", ticks=1)
        held, hand = scene.world, scene.tool
        scene.close()
        self.refuse(ValueError, "the scene is closed", scene.run)
        self.refuse(ValueError, "the scene is closed", lambda: scene.info)
        self.refuse(ValueError, "the world is closed", held.step, 0.001)
        self.assertFalse(hand.valid)

    def test_removed_members(self):
        with dp.World() as world:
            body, tool = world.add_body(sheet()), world.add_tool([0, 0, 0], [0, 1, 0])
            body.remove()
            tool.remove()
            self.refuse(dp.Error, "the id is stale", body.remove)
            self.refuse(dp.Error, "the id is stale", tool.set_pose, [0, 0, 0])
            try:
                tool.set_pose([0, 0, 0])
            except dp.Error as error:
                self.assertEqual((error.code, error.name), (dp.constants().get("DPT_E_HANDLE", -8), "DPT_E_HANDLE"))

    def test_arrays_of_the_wrong_kind(self):
        mesh, ends = sheet(), np.zeros((4, 6))
        self.refuse(TypeError, "wanted an array of float64, not one of f", mesh.query, ends.astype(np.float32))
        self.refuse(ValueError, "in C order without gaps", mesh.query, np.zeros((6, 4)).T)
        self.refuse(ValueError, r"wanted an array of shape \(n, 6\)", mesh.query, np.zeros((4, 5)))
        self.refuse(TypeError, r"wanted float64 of shape \(n, 3\)", mesh.query, np.zeros((4, 3)), np.zeros((3, 3)))
        self.refuse(ValueError, "wanted 4 radii", mesh.query, ends, radius=np.zeros(3))
        self.refuse(TypeError, "wanted an array of structs", mesh.query, ends, out=np.zeros(4))
        self.refuse(ValueError, "wanted 4 radii and room for as many hits", mesh.query, ends, out=np.zeros(3, dp.HIT))
        read_only = np.zeros(4, dp.HIT)
        read_only.flags.writeable = False
        self.refuse(ValueError, "room for as many hits", mesh.query, ends, out=read_only)
        self.refuse(TypeError, r"wanted whole numbers of shape \(n, 3\), not float64", dp.Mesh.compile, VERTICES, [[0.5, 1, 2]], unit=1)
        self.refuse(TypeError, r"wanted numbers of shape \(n, 3\), not <U1", dp.Mesh.compile, [["a", "b", "c"]], TRIANGLES, unit=1)
        self.refuse(ValueError, "below 0", dp.Mesh.compile, VERTICES, [[-1, 1, 2]], unit="m")
        self.refuse(dp.Error, "names vertex 3, .* only 3", dp.Mesh.compile, VERTICES, [[0, 1, 3]], unit="m")
        with dp.World() as world:
            tool = world.add_tool([0, 0, 0], [0, 1, 0])
            for pose in ([1, 2], "position", 7, np.zeros((2, 7)), [1, 2, "x"], {}):
                self.refuse(TypeError, "pose: wanted [37] numbers", tool.set_pose, pose)
            self.refuse(ValueError, "wanted 6 numbers", tool.get_wrench, np.zeros(5))
            self.refuse(TypeError, "wanted an array of float64", tool.get_wrench, np.zeros(6, np.float32))
            self.refuse(TypeError, "out: wanted structs of", world.step, 0.001, np.zeros(1, dp.HIT))
            self.refuse(TypeError, "wanted a Mesh", world.add_body, "liver.obj")
            body = world.add_deformable(sheet())
            self.refuse(TypeError, "wanted an array of float32", body.move, np.zeros((3, 3)))
            self.refuse(dp.Error, "argument", body.move, np.zeros((4, 3), np.float32))

    def test_numbers_that_are_none(self):
        mesh = sheet()
        self.refuse(dp.Error, "not finite", mesh.query, np.full((1, 6), np.nan))
        self.refuse(dp.Error, "finite", dp.Mesh.compile, np.where(VERTICES, np.inf, 0), TRIANGLES, unit="m")
        with dp.World() as world:
            world.add_body(mesh)
            tool = world.add_tool([0, 0, 0], [0, 1, 0], 0.01)
            for height in (0.1, 0.005):
                tool.tick([0, height, 0], 0.001)
            self.assertGreater(tool.wrench[1], 1)
            self.refuse(dp.Error, "not finite", tool.tick, [0, np.nan, 0], 0.001)
            self.assertEqual(tool.wrench.tolist(), [0] * 6)
            self.refuse(dp.Error, "quaternion", tool.set_pose, [0, 0, 0, 2, 0, 0, 0])
            self.refuse(dp.Error, "", world.step, 0.0)
            self.refuse(dp.Error, "", world.step, float("nan"))
            self.refuse(TypeError, "real number|float", world.step, "soon")

    def test_settings_that_there_are_not(self):
        self.refuse(TypeError, "there is no setting 'colour'; there are .*'margin'", dp.World, colour=1)
        self.refuse(TypeError, "there is no setting 'size'", dp.World, size=8)
        self.refuse(ValueError, r"law: 'soft' is none of \['point', 'bed', 'proxy'\]", dp.World, law="soft")
        self.refuse(ValueError, "max_bodies: wanted a whole number", dp.World, max_bodies=-1)
        self.refuse(ValueError, "max_bodies: wanted a whole number", dp.World, max_bodies=1.5)
        self.refuse(TypeError, "margin: wanted a number", dp.World, margin="wide")
        self.refuse(dp.Error, "", dp.World, max_bodies=0)
        self.refuse(ValueError, "unit: 'yard' is none of m, ", dp.Mesh.compile, VERTICES, TRIANGLES, unit="yard")
        self.refuse(TypeError, "unit", dp.Mesh.compile, VERTICES, TRIANGLES)
        with dp.World() as world:
            tool = world.add_tool([0, 0, 0], [0, 1, 0])
            with self.assertRaisesRegex(dp.Error, "."):
                tool.stiffness = -1
            self.assertEqual(tool.stiffness, 500)
            with self.assertRaises(AttributeError):
                tool.stifness = 1
            self.refuse(dp.Error, "max_contacts", lambda: tool.contacts)
        self.refuse(dp.Error, "no springs|does not have", dp.Springs, sheet())

    def test_files_that_there_are_not(self):
        with tempfile.TemporaryDirectory() as room:
            bad = Path(room) / "näh.obj"
            bad.write_text("v 0 0\n")
            self.refuse(dp.Error, "näh.obj: line 1: ", dp.Mesh.load, bad, unit="mm")
            self.refuse(TypeError, "wanted unit=", dp.Mesh.load, bad)
            bad = Path(room) / "cut.dpa"
            bad.write_bytes(bytes(sheet())[:200])
            self.refuse(dp.Error, "Mesh: ", dp.Mesh.load, bad)
            whole = bytearray(bytes(sheet()))
            whole[len(whole) // 2] ^= 1
            self.refuse(dp.Error, r"checksum does not match.* \(byte \d+, \w+\)", dp.Mesh, bytes(whole))
            self.refuse(dp.Error, "not a dynpoint file", dp.Arm, b"x" * 400)
            (Path(room) / "no.dpr").write_bytes(b"nothing at all" * 9)
            self.refuse(dp.Error, "not a dynpoint file", dp.Recording, Path(room) / "no.dpr")
            self.refuse(FileNotFoundError, "", dp.Mesh.load, Path(room) / "nothing.dpa")
            self.refuse(dp.Error, "cannot be opened", dp.Scene, Path(room) / "nothing.dpa", "sim:")
        self.refuse(dp.Error, "nodevice", dp.Device, "nodevice:")
        self.refuse(dp.Error, "sim:", dp.Device, "sim:?colour=red")
        self.refuse(dp.Error, "Scene: ", dp.Scene, "liver")

    def test_a_second_thread(self):
        mesh = dp.Mesh.compile(VERTICES, TRIANGLES, unit="m", springs={"kind": "sheet"})
        with dp.World() as world:
            body, springs = world.add_deformable(mesh), dp.Springs(mesh)
            kinds, done = set(), threading.Event()

            def step():
                while not done.is_set():
                    try:
                        body.step(springs, 0.001)
                    except RuntimeError as error:
                        kinds.add(str(error))

            threads = [threading.Thread(target=step) for _ in range(4)]
            for thread in threads:
                thread.start()
            for _ in range(2000):
                try:
                    world.step(0.001)
                except RuntimeError as error:
                    kinds.add(str(error))
                if kinds:
                    break
            done.set()
            for thread in threads:
                thread.join()
            self.assertTrue(kinds and all("another thread is in it" in kind for kind in kinds), kinds)
            world.step(0.001)

    def test_a_fork_may_use_nothing(self):
        world, device, scene = dp.World(), dp.Device("sim:"), dp.Scene("liver", "sim:", ticks=1)
        mesh, guard = sheet(), dp.Guard()
        tool = world.add_tool([0, 0, 0], [0, 1, 0])
        loop = dp.Loop(device, lambda *_: None)
        for call in (lambda: world.step(0.001), lambda: tool.tick([0, 0, 0], 0.001), device.read, device.close,
                     lambda: device.write([1, 0, 0, 0, 0, 0]), scene.run, scene.close, lambda: guard.step(1, None),
                     lambda: loop.run(1), lambda: device.steer([0, 0, 0]), world.close):
            said = in_a_child(call)
            self.assertRegex(said, "RuntimeError: .*it belongs to the process that made it")
        # A mesh does not change: it may be asked, and a world of the child's own be made.
        self.assertEqual(in_a_child(lambda: mesh.query(np.zeros((1, 6)))), "nothing")
        self.assertEqual(in_a_child(lambda: dp.World().step(0.001)), "nothing")
        world.step(0.001)
        device.read()
        self.assertEqual(scene.run().ticks, 1)
        scene.close()
        device.close()

    def test_Ctrl_C_is_a_fork_s_own_while_its_parent_runs_a_loop(self):
        before, felt = signal.signal(signal.SIGINT, signal.default_int_handler), threading.Event()
        try:
            with dp.Scene("liver", "sim:?hand=press&live=1", felt=lambda *_: felt.set()) as scene:
                thread = threading.Thread(target=scene.run)
                thread.start()
                felt.wait()
                self.assertEqual(in_a_child(lambda: signal.raise_signal(signal.SIGINT)), "KeyboardInterrupt: ")
                scene.stop()
                thread.join()
        finally:
            signal.signal(signal.SIGINT, before)

    def test_what_pickles_and_what_does_not(self):
        with dp.World() as world, dp.Device("sim:") as device, dp.Scene("liver", "sim:") as scene:
            for one in (world, world.add_body(sheet()), world.add_tool([0, 0, 0], [0, 1, 0]), device, scene,
                        dp.Loop(device, print)):
                self.refuse(TypeError, "cannot be pickled", pickle.dumps, one)
        with multiprocessing.get_context("spawn").Pool(1) as pool:
            self.assertEqual(pool.apply(len, (sheet(),)), 1)


if __name__ == "__main__":
    main()
