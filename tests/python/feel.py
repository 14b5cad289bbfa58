# SPDX-License-Identifier: BSD-3-Clause
"""The package answers as the C program does, bit for bit: nearest pairs, wrenches, queries, recordings; and its doctests."""
import csv
import doctest
import importlib
import io
import pickle
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import hypothesis
import hypothesis.extra.numpy as arrays
import numpy as np
from hypothesis import strategies

import dynpoint as dp
from dynpoint import _structs
from verdicts import PROGRAM, main, program

PYTHON = [sys.executable, "-m", "dynpoint"]


def felt_by_c(mesh, trace, *options):
    rows = list(csv.DictReader(io.StringIO(program("replay", mesh, trace, "-o", "-", *options))))
    return {name: np.array([float(row[name]) if row[name] else np.nan for row in rows])
            for name in rows[0] if name not in ("status", "contact")}


class Feel(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.room = tempfile.TemporaryDirectory()
        room = Path(cls.room.name)
        cls.obj, cls.dpa, cls.trace = room / "Leber ü.obj", room / "liver.dpa", room / "trace.csv"
        program("make", "liver", "3000", "-o", cls.obj)
        program("compile", cls.obj, "-o", cls.dpa)
        program("make", "trace", "--mesh", cls.dpa, "--seed", 3, "--ticks", 600, "-o", cls.trace)
        cls.mesh = dp.Mesh.load(cls.obj, unit="m")
        rows = np.loadtxt(cls.trace, delimiter=",", skiprows=1)
        cls.ends = np.ascontiguousarray(rows[:, 1:])

    @classmethod
    def tearDownClass(cls):
        cls.room.cleanup()

    def test_a_mesh_has_the_program_s_bytes(self):
        self.assertEqual(bytes(self.mesh), self.dpa.read_bytes())
        self.assertEqual(self.mesh, dp.Mesh.load(self.dpa))
        self.assertEqual(len(self.mesh), 3000)

    def test_regions_are_those_of_the_program(self):
        held, soft = self.dpa.with_name("held.txt"), self.dpa.with_name("soft.dpa")
        held.write_text("box -0.2 -0.2 -0.1 0.2 0.2 -0.035 fixed\nsphere 0 0 0 0.03 20000 1000 5\n")
        program("compile", self.obj, "-o", soft, "--springs", "volume", "--young", 5000, "--regions", held)
        places = [{"box": (-0.2, -0.2, -0.1, 0.2, 0.2, -0.035), "fixed": True}, {"sphere": (0, 0, 0, 0.03), "young": 20000, "density": 1000, "drag": 5}]
        springs = {"kind": "volume", "young": 5000, "regions": places}
        self.assertEqual(bytes(dp.Mesh.load(self.obj, unit="m", springs=springs)), soft.read_bytes())
        for place, said in (({"fixed": True}, "a box or a sphere"), ({"box": (0, 0, 0, 1), "fixed": 1}, "a box has 6 numbers"),
                            ({"sphere": (0, 0, 0, 1), "young": 2}, "not sphere, young")):
            with self.assertRaisesRegex(ValueError, said):
                dp.Mesh.load(self.obj, unit="m", springs={"kind": "volume", "regions": [place]})

    def test_a_tool_feels_what_the_program_s_feels(self):
        told = felt_by_c(self.dpa, self.trace, "--radius", 0.002)
        felt = {name: [] for name in ("distance", "gap", "fx", "fy", "fz", "tx", "ty", "tz", "px", "qz", "triangle")}
        with dp.World() as world:
            world.add_body(self.mesh)
            tool = world.add_tool(self.ends[0, :3], self.ends[0, 3:], 0.002)
            for row in self.ends:
                tool.set_segments(row[:3], row[3:], 0.002)
                world.step(0.001)
                hit, wrench = tool.hit, tool.wrench
                for name in ("distance", "gap", "triangle"):
                    felt[name].append(hit[name])
                felt["px"].append(hit.p[0])
                felt["qz"].append(hit.q[2])
                for i, name in enumerate(("fx", "fy", "fz", "tx", "ty", "tz")):
                    felt[name].append(wrench[i])
        known = ~np.isnan(told["gap"])
        self.assertGreater(np.count_nonzero(told["fx"]), 50)
        for name, values in felt.items():
            mine, theirs = np.array(values, float), told[name]
            self.assertTrue(np.array_equal(mine[known], theirs[known]), name)

    def test_a_query_is_the_same_on_any_number_of_threads(self):
        one = self.mesh.query(self.ends, radius=0.002)
        others = [self.mesh.query(self.ends, radius=0.002, threads=threads) for threads in (2, 7)]
        others.append(self.mesh.query(self.ends[:, :3].copy(), self.ends[:, 3:].copy(), np.full(len(self.ends), 0.002)))
        for hits in others:
            hits["work"] = one["work"]  # which depends on the segment before
            self.assertEqual(hits.tobytes(), one.tobytes())

    def test_distances_are_those_of_a_point(self):
        points = self.ends[:, :3]
        plain, signed = self.mesh.distance(points), self.mesh.distance(points, signed=True)
        self.assertTrue(np.allclose(plain, np.abs(signed), atol=1e-6))
        self.assertLess(self.mesh.distance([[0.02, 0, 0]], signed=True)[0] + 1, 1.0)

    def test_three_calls_and_one_give_the_same(self):
        made = []
        for combined in (False, True):
            with dp.World() as world:
                world.add_body(self.mesh)
                tool = world.add_tool([0, 0, 0], [0, 0.05, 0], 0.002)
                out, all_of_it = np.zeros(6), []
                for k in range(300):
                    pose = np.array([0.02, 0.3 - 0.001 * k, 0.01, 1, 0, 0, 0])
                    if combined:
                        tool.tick(pose, 0.001, out)
                    else:
                        tool.set_pose(pose)
                        world.step(0.001)
                        tool.get_wrench(out)
                    all_of_it.append(out.copy())
                made.append(np.array(all_of_it))
        self.assertTrue(np.array_equal(*made))
        self.assertTrue(made[0].any())

    def test_a_mesh_pickles(self):
        again = pickle.loads(pickle.dumps(self.mesh))
        self.assertEqual(again, self.mesh)
        self.assertEqual(hash(again), hash(self.mesh))

    def test_arrays_are_views_and_keep_the_mesh(self):
        vertices, triangles = dp.Mesh.load(self.dpa).vertices, dp.Mesh.load(self.dpa).triangles
        self.assertEqual(vertices.shape, (int(self.mesh.info.vertices), 3))
        self.assertFalse(vertices.flags.owndata or vertices.flags.writeable)
        self.assertTrue(np.array_equal(vertices, self.mesh.vertices) and np.array_equal(triangles, self.mesh.triangles))
        corners = np.loadtxt((line[2:] for line in self.obj.read_text().splitlines() if line.startswith("v ")))
        self.assertTrue(np.allclose(corners[self.mesh.vertex_sources], vertices, atol=1e-7))

    def test_a_needle_pierces_and_tells_its_channel(self):
        at = [[x, y, z] for x in (-0.05, 0.05) for y in (-0.05, 0.0) for z in (-0.05, 0.05)]
        corners = [(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1), (2, 3, 7), (2, 7, 6), (0, 2, 6),
                   (0, 6, 4), (1, 5, 7), (1, 7, 3)]
        box = dp.Mesh.compile(at, corners, unit="m")
        for puncture in (0.5, 1e6):
            with dp.World(max_channels=8) as world:
                body, tool = world.add_body(box), world.add_tool([0, 0.1, 0], [0, 0, 0], 0.0005)
                body.puncture_force, body.shaft_friction, tool.piercing = puncture, 20.0, "b"
                self.assertEqual((tool.piercing, body.puncture_force, body.shaft_friction), ("b", puncture, 20.0))
                for height in np.linspace(0.01, -0.02, 300):
                    tool.tick([0.01, height, 0.003], 0.001)
                self.assertEqual(len(tool.channels), puncture == 0.5)
                if puncture == 0.5:
                    self.assertEqual((tool.channels["body"][0], tool.channels.dtype), (body.id, dp.CHANNEL))
                    self.assertAlmostEqual(tool.channels["depth"][0], 0.02, delta=2e-3)
                    tool.teleport([-0.02, -0.01, 0])
                    tool.insert()
                    self.assertEqual(len(tool.channels), 2)
        with dp.World() as world, self.assertRaisesRegex(dp.Error, "max_channels"):
            world.add_tool([0, 0, 0], [0, 0.1, 0], 0.001).channels
        for soft, wanted in (([6, 7], 1), ([4, 5], 0)):  # the top, and a side
            with dp.World(max_channels=8) as world:
                body, tool = world.add_body(box), world.add_tool([0, 0.1, 0], [0, 0, 0], 0.0005)
                tool.piercing = "b"
                of_triangle = np.zeros(12, np.int64)
                of_triangle[soft] = 1
                body.set_regions(of_triangle, [{"puncture_force": 0.5, "shaft_friction": 20.0}])
                del of_triangle
                for height in np.linspace(0.01, -0.02, 300):
                    tool.tick([0.01, height, 0.003], 0.001)
                self.assertEqual(len(tool.channels), wanted)
                with self.assertRaisesRegex(dp.Error, "set_regions"):
                    body.set_regions([2] * 12, [{"toughness": 1.0}])
                others = [bytes([number % 2 * 7] * 12) for number in range(1000)]  # where freed bytes were
                tool.teleport([-0.02, 0.01, 0.003])
                for height in np.linspace(0.01, -0.02, 300):
                    tool.tick([-0.02, height, 0.003], 0.001)
                self.assertEqual((len(tool.channels), len(others)), (2 * wanted, 1000))
                for numbers in ([256] * 12, [0.5] * 12, np.full(12, -1)):
                    with self.assertRaisesRegex(ValueError, "whole numbers from 0 to 1, one a triangle"):
                        body.set_regions(numbers, [{}])
                with self.assertRaisesRegex(ValueError, "no 'size'; there are puncture_force, "):
                    body.set_regions([0] * 12, [{"size": 9}])
                body.set_regions([], [])
        with dp.World(max_channels=8) as world:  # a body that gives way
            body, tool = world.add_deformable(box, compliance=1e-3), world.add_tool([0, 0.1, 0], [0, 0, 0], 0.0005)
            tool.piercing, of_triangle = "b", np.ones(12, np.int64)
            body.set_regions(of_triangle, [{"puncture_force": 0.2, "shaft_friction": 20.0}])
            for height in np.linspace(0.01, -0.02, 600):
                tool.tick([0.01, height, 0.003], 0.001)
            self.assertEqual(tool.channels["ruptures"][0], 1)

    def test_fields_are_those_of_the_library_where_numpy_has_the_names(self):
        with dp.World() as world:
            world.add_body(self.mesh)
            tool = world.add_tool([0, 0, 0], [0, 0.1, 0], 0.002)
            tool.tick([0, 0.05, 0], 0.001)
            hit, force = tool.hit, tool.force
        for struct in (hit, force, pickle.loads(pickle.dumps(hit)), pickle.loads(pickle.dumps(np.array([hit])))[0]):
            self.assertEqual((struct.flags, type(struct.flags)), (struct["flags"], np.uint32))
        hit.flags = 5
        self.assertEqual((hit.flags, hit["flags"], dp.Hit(int(hit.flags))), (5, 5, dp.Hit.GAP | dp.Hit.BUDGET))
        self.assertIs(type(np.zeros(1, dp.SEGMENT)[0].flags), type(np.zeros(1, dp.HIT).flags))  # NumPy's
        self.assertEqual((np.zeros(1, _structs.HOST_INFO)[0].put, np.zeros(1, dp.RECORD)[0].device), (0, 0))
        for dtype in [each for each in vars(_structs).values() if isinstance(each, np.dtype)]:
            struct = np.zeros(1, dtype)[0]
            for field in set(dtype.names) - {"size"}:
                self.assertIs(type(getattr(struct, field)), type(struct[field]), field)
        self.assertEqual(repr(np.zeros(1, dp.SEGMENT)[0]).split("(")[0].split(".")[-1], "Struct")

    def test_a_compliance_for_each_vertex(self):
        count, felt, soft = int(self.mesh.info.vertices), [], 2.0 ** -9  # of as many bits in a float
        x, top, z = self.mesh.vertices[self.mesh.vertices[:, 1].argmax()].tolist()
        for each in (None, np.full(count, soft), np.zeros(count)):
            with dp.World() as world:
                body = world.add_deformable(self.mesh, compliance=soft, compliances=each, load_radius=0.01)
                tool, wrenches = world.add_tool([0, 0, 0], [0, 0.05, 0], 0.002), np.zeros((300, 6))
                for k, wrench in enumerate(wrenches):
                    tool.tick([x, top + 0.01 - 0.0001 * k, z], 0.001)
                    body.step(None, 0.001)
                    tool.get_wrench(wrench)
                felt.append(wrenches)
        self.assertTrue(felt[0].any() and np.array_equal(felt[0], felt[1]) and not np.array_equal(felt[0], felt[2]))
        with dp.World() as world, self.assertRaisesRegex(ValueError, f"compliances: wanted {count}"):
            world.add_deformable(self.mesh, compliance=soft, compliances=[soft])

    def test_a_step_is_foreseen(self):
        mesh = dp.Mesh.load(self.obj, unit="m", springs={"kind": "volume", "young": 3000, "spacing": 0.02, "fixed": [0]})
        for integrator in ("symplectic", "implicit"):
            springs = dp.Springs(mesh, integrator=integrator, gravity=[0, -9.81, 0])
            load = np.zeros(1, dp.LOAD)
            load["vertex"], load["force"] = springs.count // 2, [0.01, 0, 0]
            for loads in (None, load, load):
                before = springs.nodes
                told = springs.foresee(0.001, loads)
                self.assertTrue(np.array_equal(springs.nodes, before))
                springs.step(0.001, loads)
                self.assertTrue(np.array_equal(springs.nodes, told) and not np.array_equal(told, before))
        with self.assertRaisesRegex(dp.Error, "Springs.foresee"):
            springs.foresee(np.nan)
        with self.assertRaisesRegex(TypeError, "loads"):
            springs.foresee(0.001, "none")
        rest = self.mesh.vertices
        with dp.World() as world:
            body = world.add_deformable(self.mesh, compliance=1e-3, period=0.004)
            body.answer(np.zeros(0, dp.LOAD))
            body.vertices = rest + np.float32(1e-4)
            body.foresee(rest + np.float32(3e-4))
            body.foresee(rest[:5] + np.float32(2e-4), 0)
            for _ in range(4):
                world.step(0.001)
                body.step(None, 0.001)
            moved = (body.vertices - rest)
            self.assertTrue(np.allclose(moved[:5], 2e-4, atol=1e-6) and np.allclose(moved[5:], 3e-4, atol=1e-6))
            with self.assertRaisesRegex(dp.Error, "DeformableBody.foresee"):
                body.foresee(rest, 1)
            rigid = world.add_deformable(self.mesh)
            with self.assertRaisesRegex(dp.Error, "DeformableBody.foresee"):
                rigid.foresee(rest)

    def test_a_soft_body_gives_way_and_is_felt(self):
        mesh = dp.Mesh.load(self.obj, unit="m", springs={"kind": "volume", "young": 3000, "spacing": 0.02, "fixed": [0]})
        self.assertGreater(mesh.info.springs, 0)
        with dp.World() as world:
            body = world.add_deformable(mesh, load_radius=0.01)
            springs = dp.Springs(mesh, integrator="implicit")
            top = float(mesh.vertices[:, 1].max())
            at = mesh.vertices[mesh.vertices[:, 1].argmax()].astype(float)
            tool = world.add_tool([0, 0, 0], [0, 0.1, 0], 0.004)
            for k in range(300):
                tool.tick([at[0], top + 0.01 - 0.0001 * k, at[2]], 0.001)
                info = body.step(springs, 0.001)
            self.assertGreater(tool.wrench[1], 0.01)
            self.assertLess(body.vertices[:, 1].max(), top - 0.001)
            self.assertGreater(springs.energy[0], 0)
            self.assertEqual(info.nodes, springs.count)
            self.assertTrue(np.isfinite(springs.nodes).all())
            self.assertAlmostEqual(float(np.linalg.norm(tool.wrench[:3] + body.wrench[:3])), 0, places=9)

    def test_contacts_and_loads_are_structs(self):
        with dp.World(max_contacts=16) as world:
            world.add_body(self.mesh)
            tool = world.add_tool([-0.3, 0, 0], [0.3, 0, 0], 0.003, law="bed")
            self.assertEqual((tool.law, tool.contacts.dtype, len(tool.contacts)), ("bed", dp.CONTACT, 0))
            step = world.report(0.001)
            self.assertEqual(step.contacts, len(tool.contacts))
            self.assertGreater(len(tool.contacts), 0)
            self.assertTrue(np.allclose(tool.loads["force"].sum(axis=0), tool.wrench[:3], atol=1e-9))
            self.assertEqual(dp.Contact(step.contact), dp.Contact.PENETRATING)

    def test_settings_are_attributes(self):
        with dp.World(law="point", stiffness=200) as world:
            body, tool = world.add_body(self.mesh, static_friction=0.5), world.add_tool([0, 0, 0], [0, 1, 0])
            self.assertEqual((tool.law, tool.stiffness, body.static_friction), ("point", 200.0, 0.5))
            tool.law, tool.damping, body.stiffness = "proxy", 2, 1000
            self.assertEqual((tool.law, tool.damping, body.stiffness, body.kinetic_friction), ("proxy", 2.0, 1000.0, 0.0))
            body.pose = [0, 1, 0]
            self.assertEqual(body.pose.tolist(), [0, 1, 0, 1, 0, 0, 0])

    def test_an_arm_moves(self):
        arm = dp.Arm.load(Path(__file__).parent.parent / "golden/arm_2_mesh_6.dpa")
        at = np.linspace(0.1, 0.4, int(arm.info.joints))
        self.assertEqual((len(arm.joints), len(arm.links)), (arm.info.joints, arm.info.links))
        change = np.array([arm.forward(at + 1e-6 * row)[:3] - arm.forward(at - 1e-6 * row)[:3] for row in np.eye(len(at))]) / 2e-6
        self.assertTrue(np.allclose(change.T, arm.jacobian(at)[:3], atol=1e-8))
        rates, wrench = np.arange(len(at)) + 1.0, np.array([1, 2, 3, 0.1, 0.2, 0.3])
        self.assertTrue(np.allclose(arm.velocity(at, rates), arm.jacobian(at) @ rates))
        self.assertTrue(np.allclose(arm.efforts(at, wrench), wrench @ arm.jacobian(at)))
        self.assertEqual(len(arm.weight(at)), len(at))
        for name, pose, mesh in arm.bodies:
            self.assertEqual((len(pose), len(mesh) > 0), (7, True), name)
        self.assertEqual(pickle.loads(pickle.dumps(arm)).info.name, arm.info.name)
        with self.assertRaisesRegex(TypeError, "joints: wanted"):
            arm.forward([0.1] * 9)

    def test_the_program_is_the_package_s(self):
        self.assertEqual(subprocess.run([*PYTHON, "--version"], capture_output=True, text=True).stdout, program("--version"))
        told = subprocess.run([*PYTHON, "info", self.dpa, "--json"], capture_output=True, text=True)
        self.assertEqual(told.stdout, program("info", self.dpa, "--json"))
        self.assertEqual(subprocess.run([*PYTHON, "info", "nothing.dpa"], capture_output=True).returncode, 2)

    def test_enums_have_the_library_s_values(self):
        known = dp.constants()
        for kind, prefix in _structs.PREFIXES.items():
            mine = {prefix + member.name: member.value for member in kind}
            for name, value in mine.items():
                self.assertEqual(known[name], value)
            longer = [p for p in _structs.PREFIXES.values() if p.startswith(prefix) and p != prefix]
            theirs = {n for n in known if n.startswith(prefix) and not any(n.startswith(p) for p in longer)
                      and not n.startswith("DPT_CONTACT_FLAG") and not n.startswith("DPT_FORCE_FLAG_" if kind is dp.Force else "~")}
            self.assertEqual(theirs, set(mine))

    def test_doctests(self):
        count = 0
        for name in ("_mesh", "_world", "_device", "_arm", "_recording", "_structs"):
            result = doctest.testmod(importlib.import_module("dynpoint." + name))
            self.assertEqual(result.failed, 0, name)
            count += result.attempted
        self.assertGreater(count, 12)

    @hypothesis.settings(max_examples=40, deadline=None, database=None, derandomize=True)
    @hypothesis.given(arrays.arrays(np.float64, strategies.tuples(strategies.integers(3, 12), strategies.just(3)),
                                    elements=strategies.floats(-1, 1, width=16)),
                      strategies.randoms(use_true_random=False))
    def test_any_mesh_has_the_program_s_bytes_and_pairs(self, vertices, random):
        triangles = np.array([random.sample(range(len(vertices)), 3) for _ in range(random.randint(1, 20))], np.uint32)
        room = Path(self.room.name)
        file = room / "any.off"
        file.write_text("\n".join(["OFF", f"{len(vertices)} {len(triangles)} 0",
                                   *(" ".join(repr(float(x)) for x in v) for v in vertices),
                                   *("3 " + " ".join(map(str, t)) for t in triangles)]) + "\n")
        made = subprocess.run([PROGRAM, "compile", file, "-o", room / "any.dpa"], capture_output=True, text=True)
        try:
            mesh = dp.Mesh.load(file, unit="m")
        except dp.Error as error:
            self.assertEqual(made.returncode, 2, error)
            self.assertIn(str(error).split(": ", 1)[1], made.stderr)
            return
        self.assertEqual(bytes(mesh), (room / "any.dpa").read_bytes())
        ends = np.array([[random.uniform(-2, 2) for _ in range(6)] for _ in range(8)])
        with open(room / "any.csv", "w") as trace:
            trace.write("tick,ax,ay,az,bx,by,bz\n")
            for i, row in enumerate(ends):
                trace.write(f"{2 * i}," + ",".join(repr(float(x)) for x in row) + "\n")
        told = felt_by_c(room / "any.dpa", room / "any.csv", "--until", "track")
        hits = mesh.query(ends, pair=1)
        self.assertTrue(np.allclose(hits["distance"], told["distance"], rtol=0, atol=2e-7))


main()
