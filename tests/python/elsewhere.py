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
from pathlib import Path

os.environ.setdefault("DYNPOINT_BUILD", "")

import numpy as np

import dynpoint as dp
import dynpoint.batch
import dynpoint.bulk
from verdicts import main

VERTICES = np.array([[-1, 0, -1], [1, 0, -1], [0, 0, 1.0]])
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

    def test_what_the_package_lacks_is_told(self):
        (self.room / "a.urdf").write_text("<robot name='a'><link name='b'/></robot>", encoding="utf-8")
        with self.assertRaisesRegex(dp.Error, "it needs urdfdom"):
            dp.Arm.load(self.room / "a.urdf")

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

    def test_ctrl_c_ends_a_loop_and_zero_force_goes_out(self):
        scene = dp.Scene("liver", "sim:?hand=press&live=1", record=self.room / "r.dpr")
        begun = threading.Event()

        def interrupt():
            begun.wait(60)
            signal.raise_signal(signal.SIGINT)

        before = signal.signal(signal.SIGINT, signal.default_int_handler)
        killer = threading.Thread(target=interrupt)
        killer.start()
        try:
            with self.assertRaises(KeyboardInterrupt):
                with scene:
                    threading.Timer(0.2, begun.set).start()
                    scene.run()
                    time.sleep(1)
        finally:
            begun.set()
            killer.join()
            signal.signal(signal.SIGINT, before)
        self.assertGreater(len(dp.Recording(self.room / "r.dpr").records), 0)


if __name__ == "__main__":
    main()
