# SPDX-License-Identifier: BSD-3-Clause
"""What systems do differently, of the package on another one: names, programs, processes, threads and Ctrl-C. Needs no
C program beside it."""

import json
import os
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest
import unittest.mock
from pathlib import Path

os.environ.setdefault("DYNPOINT_BUILD", "")

import numpy as np

import dynpoint as dp
import dynpoint.batch
import dynpoint.bulk
from verdicts import main

VERTICES = np.array([[-1, 0, -1], [1, 0, -1], [0, 0, 1.0]])
ROBOT = """<robot name='a'>
  <link name='desk'><collision><geometry><mesh filename='\u809d.obj'/></geometry></collision></link>
  <link name='tool'><collision><geometry><cylinder radius='0.004' length='0.1'/></geometry></collision></link>
  <joint name='turn' type='revolute'><parent link='desk'/><child link='tool'/><axis xyz='0 0 1'/>
    <limit lower='-1' upper='1' effort='2' velocity='3'/></joint>
</robot>"""
# Holds a list until it is killed.
HOLD = """import sys
import dynpoint.bulk
with dynpoint.bulk.locked(sys.argv[1]):
    print("held", flush=True)
    sys.stdin.read()
"""
OBJ = "v -1 0 -1\nv 1 0 -1\nv 0 0 1\nf 1 3 2\n"


class Elsewhere(unittest.TestCase):
    def setUp(self):
        self.place = tempfile.TemporaryDirectory()
        self.room = Path(self.place.name)
        self.addCleanup(self.place.cleanup)
        self.mesh = dp.Mesh.compile(VERTICES, [[0, 2, 1]], unit="m")

    def run_program(self, *words):
        return subprocess.run([sys.executable, "-m", "dynpoint", *map(str, words)], capture_output=True, check=False)

    def test_the_program_compiles_a_file_of_an_odd_name_and_its_status_comes_back(self):
        source, out = self.room / "Leber \u00e4\u03b1 \u809d.obj", self.room / "\u809d.dpa"
        source.write_text(OBJ, encoding="utf-8")
        ran = self.run_program("compile", source, "-o", out)
        self.assertEqual((ran.returncode, ran.stderr), (0, b""))
        self.assertEqual(out.read_bytes(), bytes(dp.Mesh.load(source, unit="m")))
        self.assertEqual(self.run_program("compile", self.room / "none.obj", "-o", out).returncode, 2)

    def test_a_scene_file_is_read_and_felt(self):
        scene = {"bodies": [{"shape": "box", "triangles": 12}]}
        path = self.room / "\u809d.json"
        path.write_text(json.dumps(scene), encoding="utf-8")
        with dp.Scene(path, "sim:?hand=press", ticks=50, record=self.room / "r.dpr") as scene:
            scene.run()
        self.assertEqual(len(dp.Recording(self.room / "r.dpr").records), 50)

    def test_robots(self):
        """They are read; or a package without urdfdom says so."""
        if not os.environ.get("URDF"):
            (self.room / "a.urdf").write_text("<robot name='a'><link name='b'/></robot>", encoding="utf-8")
            with self.assertRaisesRegex(dp.Error, "it needs urdfdom"):
                dp.Arm.load(self.room / "a.urdf")
            return
        (self.room / "\u809d.obj").write_text(OBJ, encoding="utf-8")
        (self.room / "\u809d.urdf").write_text(ROBOT, encoding="utf-8")
        arm = dp.Arm.load(self.room / "\u809d.urdf")
        self.assertEqual((int(arm.info.joints), arm.joints[0].name, float(arm.joints[0].lower)), (1, b"turn", -1.0))
        self.assertEqual([(name, sorted(mesh.vertices.tolist())) for name, _, mesh in arm.bodies],
                         [("desk", sorted(VERTICES.tolist()))])
        (self.room / "\u809d2.urdf").write_text("<robot name='a'><link name='b'/></robot>", encoding="utf-8")
        with self.assertRaisesRegex(dp.Error, "\u809d2.urdf"):
            dp.Arm.load(self.room / "\u809d2.urdf")

    @unittest.mock.patch.dict(os.environ)
    def test_names_of_meshes_are_those_of_the_system(self):
        if not os.environ.get("URDF"):
            return
        urdf, places = self.room / "robots" / "\u809d.urdf", self.room / "places"
        mesh, shared = places / "p" / "\u809d.obj", places / "share" / "q" / "\u809d.obj"
        urdf.parent.mkdir()
        for path in (mesh, shared):
            path.parent.mkdir(parents=True)
            path.write_text(OBJ, encoding="utf-8")
        listed = os.pathsep.join([str(self.room / "none"), str(places)])
        os.environ["AMENT_PREFIX_PATH"] = listed
        package = "package://p/\u809d.obj"
        for filename, *options in ((str(mesh),), (mesh.as_posix(),), (mesh.as_uri(),), ("../places/p/\u809d.obj",),
                                   (package, "--packages", listed), (package, "--packages", f"{places / 'p'}{os.sep}"),
                                   ("package://q/\u809d.obj",)):
            urdf.write_text(ROBOT.replace("\u809d.obj", filename), encoding="utf-8")
            with self.subTest(filename=filename):
                self.assertEqual([name for name, *_ in dp.Arm.load(urdf, *options).bodies], ["desk"])

    def test_environments_on_three_threads_are_those_of_one(self):
        forces = []
        for threads in (1, 3):
            world = dp.batch.World(7, threads=threads)
            world.add_body(self.mesh)
            tool = world.add_tool([0, 0, 0], [0, 0.1, 0], radius=0.01)
            for i in range(20):
                tool.pose[:, :3] = np.array([[0, 0.05 - 0.005 * i + 0.001 * k, 0] for k in range(7)])
                world.step(0.001)
            forces.append(tool.wrench.copy())
        self.assertTrue(np.any(forces[0]) and np.array_equal(*forces))

    def test_a_list_is_compiled_by_two_processes(self):
        for i in range(6):
            (self.room / f"{i}.obj").write_text(OBJ if i != 3 else "v 0 0 0\nf 1 2 3\n", encoding="utf-8")
        lines = [f"{self.room / f'{i}.obj'}\t{self.room / f'{i}.dpa'}\n" for i in range(6)]
        (self.room / "\u809d.txt").write_text("".join(lines), encoding="utf-8")
        done = dp.bulk.run("compile", self.room / "\u809d.txt", self.room / "table.tsv", workers=2, unit="m")
        self.assertEqual([row.verdict for row in done.rows], ["DPT_OK"] * 3 + ["DPT_E_INDEX"] + ["DPT_OK"] * 2)
        self.assertEqual((self.room / "5.dpa").read_bytes(), bytes(dp.Mesh.load(self.room / "5.obj", unit="m")))

    def test_one_call_at_a_time_works_on_a_list(self):
        (self.room / "a.obj").write_text(OBJ, encoding="utf-8")
        listed, table = self.room / "\u809d.txt", self.room / "table.tsv"
        listed.write_text(f"{self.room / 'a.obj'}\t{self.room / 'a.dpa'}\n", encoding="utf-8")
        words = ("compile", "--list", listed, "-o", self.room / "other.tsv", "--unit", "m")
        with subprocess.Popen([sys.executable, "-c", HOLD, listed], stdin=subprocess.PIPE, stdout=subprocess.PIPE) as holder:
            try:
                self.assertEqual(holder.stdout.readline().strip(), b"held")
                with self.assertRaisesRegex(BlockingIOError, "another call works on this list"):
                    dp.bulk.run("compile", listed, table, workers=1, unit="m")
                ran = self.run_program(*words)
                self.assertEqual(ran.returncode, 2)
                self.assertIn(b"another dynpoint works on", ran.stderr)
            finally:
                holder.kill()
        # It leaves no lock; and the program takes the same one as this package.
        done = dp.bulk.run("compile", listed, table, workers=1, unit="m")
        self.assertEqual([row.verdict for row in done.rows], ["DPT_OK"])
        with dp.bulk.locked(listed):
            self.assertEqual(self.run_program(*words).returncode, 2)
            self.assertEqual(listed.read_text(encoding="utf-8").count("a.obj"), 1)
        self.assertEqual(self.run_program(*words).returncode, 0)

    def test_ctrl_c_ends_a_loop_and_zero_force_goes_out(self):
        begun, ticks = threading.Event(), []

        def felt(*_):
            ticks.append(1)
            if len(ticks) == 20:
                begun.set()

        scene = dp.Scene("liver", "sim:?hand=press&live=1", record=self.room / "r.dpr", felt=felt)

        def interrupt():
            begun.wait(60)
            signal.raise_signal(signal.SIGINT)

        before = signal.signal(signal.SIGINT, signal.default_int_handler)
        killer = threading.Thread(target=interrupt)
        killer.start()
        try:
            with self.assertRaises(KeyboardInterrupt):
                with scene:
                    scene.run()
                    time.sleep(1)
        finally:
            begun.set()
            killer.join()
            signal.signal(signal.SIGINT, before)
        self.assertGreaterEqual(len(dp.Recording(self.room / "r.dpr").records), 20)


if __name__ == "__main__":
    main()
