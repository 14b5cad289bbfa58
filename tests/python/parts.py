# SPDX-License-Identifier: BSD-3-Clause
"""What needs urdfdom, libccd or libwebsockets does what the program does that is linked to them, and says what is
missing where the system has them not: in a copy of the package that asks for libraries that no system has."""

import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

import dynpoint as dp
from verdicts import BUILD, PROGRAM, main

PACKAGE = Path(dp.__file__).parent
BUILT = (BUILD / "built_with.h").read_text()
ROBOT = Path(__file__).parent.parent / "golden-urdf/masses.urdf"
CURVED = ["curved-cone:0.01,0,0.02", "ellipsoid:0.01,0.02,0.02"]
LIBRARIES = {"urdf": "liburdfdom_model.so.", "convex": "libccd.so.", "view": "libwebsockets.so."}
# The Debian packages, by what they are for.
SAID = {
    "urdf": "it needs urdfdom (Debian: liburdfdom-model3.0 libexpat1): ",
    "convex": "it needs libccd (Debian: libccd2): ",
    "view": "it needs libwebsockets (Debian: libwebsockets17): ",
}


def felt(tip):
    """What a scene with this tip feels."""
    with dp.Scene("liver", "sim:?hand=press", tips=[tip], law="point", ticks=1500) as scene:
        scene.run()
        return float(scene.info.force_max)


class Parts(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.room = tempfile.TemporaryDirectory()
        # Two copies: one asks for another version of each library, one was built without its parts.
        for name in ("lacking", "without"):
            shutil.copytree(PACKAGE, Path(cls.room.name, name, "dynpoint"))
        for part, library in LIBRARIES.items():
            file = f"dynpoint/libdynpoint_{part}.so"
            Path(cls.room.name, "without", file).unlink(missing_ok=True)
            changed = Path(cls.room.name, "lacking", file)
            if changed.exists():
                content = changed.read_bytes()
                assert library.encode() in content
                changed.write_bytes(content.replace(library.encode(), library.replace("lib", "lix", 1).encode()))

    @classmethod
    def tearDownClass(cls):
        cls.room.cleanup()

    def run_in(self, name, *words):
        path = {"PYTHONPATH": str(Path(self.room.name, name))} if name else {}
        return subprocess.run(
            [sys.executable, *map(str, words)], env={**os.environ, **path}, capture_output=True, text=True, timeout=120
        )

    def said_of(self, part, text):
        """Of a system without the library, and of a package without the part."""
        lacking, without = text("lacking"), text("without")
        self.assertIn(SAID[part] + "this package was built without it", without)
        if f"DPT_HAS_{dict(view='lws').get(part, part).upper()}\n" in BUILT:
            self.assertRegex(
                lacking,
                re.escape(SAID[part] + LIBRARIES[part].replace("lib", "lix", 1)) + ".*cannot open shared object file",
            )

    @unittest.skipUnless("DPT_HAS_URDF" in BUILT, "a build without urdfdom")
    def test_a_robot_is_read_as_the_program_reads_it(self):
        told, made = Path(self.room.name, "told.dpa"), Path(self.room.name, "made.dpa")
        subprocess.run([PROGRAM, "compile", ROBOT, "-o", told], check=True, capture_output=True)
        ran = self.run_in(None, "-m", "dynpoint", "compile", ROBOT, "-o", made)
        self.assertEqual((ran.returncode, made.read_bytes()), (0, told.read_bytes()), ran.stderr)
        arm = dp.Arm.load(ROBOT)
        self.assertEqual(bytes(memoryview(arm)), told.read_bytes())
        renamed = Path(self.room.name, "compiled.arm")
        renamed.write_bytes(told.read_bytes())
        self.assertEqual(bytes(memoryview(dp.Arm.load(renamed))), told.read_bytes())
        broken = Path(self.room.name, "broken.urdf")
        broken.write_text("<robot name='x'><link/></robot>")
        with self.assertRaisesRegex(dp.Error, "broken.urdf"):
            dp.Arm.load(broken)

    def test_without_urdfdom_it_is_named(self):
        def text(name):
            ran = self.run_in(name, "-m", "dynpoint", "compile", ROBOT, "-o", Path(self.room.name, "no.dpa"))
            self.assertEqual(ran.returncode, 2)
            return ran.stderr

        self.said_of("urdf", text)

    @unittest.skipUnless("DPT_HAS_CONVEX" in BUILT, "a build without libccd")
    def test_a_curved_tip_is_felt_as_the_program_feels_it(self):
        for tip in CURVED:
            record = Path(self.room.name, "tip.dpr")
            subprocess.run(
                [
                    PROGRAM,
                    "run",
                    "liver",
                    "--device",
                    "sim:?hand=press",
                    "--law",
                    "point",
                    "--tip",
                    tip,
                    "--ticks",
                    "1500",
                    "--record",
                    record,
                ],
                check=True,
                capture_output=True,
            )
            told = dp.Recording(record).records["asked"]
            with dp.Scene(
                "liver", "sim:?hand=press", tips=[tip], law="point", ticks=1500, record=record.with_name("mine.dpr")
            ) as scene:
                scene.run()
            mine = dp.Recording(record.with_name("mine.dpr")).records["asked"]
            self.assertTrue(told.any() and (told == mine).all(), tip)

    def test_without_libccd_it_is_named(self):
        def text(name):
            ran = self.run_in(name, "-c", f"import dynpoint as dp; dp.Scene('liver', 'sim:', tips=[{CURVED[0]!r}])")
            self.assertEqual(ran.returncode, 1)
            return ran.stderr

        self.said_of("convex", text)
        self.assertEqual(
            self.run_in(
                "without", "-c", "import dynpoint as dp; dp.Scene('liver', 'sim:', tips=['box:0.01,0.01,0.01'])"
            ).returncode,
            0,
        )

    @unittest.skipUnless(
        "DPT_HAS_LWS" in BUILT and "DPT_HAS_VIEW_PAGE" in BUILT, "a build without the viewer's server or its page"
    )
    def test_with_libwebsockets_the_program_serves(self):
        with subprocess.Popen(
            [sys.executable, "-m", "dynpoint", "view", "liver", "--law", "bed"], text=True, stdout=subprocess.PIPE
        ) as ran:
            self.assertRegex(ran.stdout.readline(), r"the viewer: http://127.0.0.1:\d+/#[0-9a-f]{32}")
            self.assertIn(b"libdynpoint_view.so", Path(f"/proc/{ran.pid}/maps").read_bytes())
            ran.terminate()

    def test_without_libwebsockets_it_is_named(self):
        def text(name):
            program = Path(self.room.name, name, "dynpoint/program")
            ran = subprocess.run(
                [program, "run", "liver", "--device", "sim:?hand=press", "--view", "--ticks", "5"],
                capture_output=True,
                text=True,
            )
            self.assertEqual(ran.returncode, 2)
            return ran.stderr

        if (PACKAGE / "page.html").exists():
            self.said_of("view", text)


main()
