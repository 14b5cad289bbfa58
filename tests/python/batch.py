# SPDX-License-Identifier: BSD-3-Clause
"""dynpoint.batch: what one call on many environments answers is what single worlds answer, bit for bit, on any number of
threads; loads balance; a cloth weighs m g; an environment that fails stops no other."""
import doctest
import gc
import tempfile
import threading
import unittest
from pathlib import Path

import numpy as np

import dynpoint as dp
import dynpoint.batch
from verdicts import main, program

COUNT, TICKS, DT = 12, 160, 0.001
SPRINGS = {"integrator": "implicit"}


def make_mesh(*arguments):
    """A shape of the program's, as arrays."""
    with tempfile.TemporaryDirectory() as room:
        program("make", *arguments, "-o", f"{room}/it.obj")
        rows = [line.split() for line in Path(f"{room}/it.obj").read_text(encoding="ascii").splitlines()]
    places = np.array([row[1:4] for row in rows if row and row[0] == "v"], float)
    return places, np.array([[int(word.split("/")[0]) - 1 for word in row[1:4]] for row in rows if row and row[0] == "f"])


def sheet(cells, size, density=400.0, thickness=0.001):
    """A square cloth in the plane y = 0, held by nothing."""
    at = np.linspace(-size / 2, size / 2, cells + 1)
    places = np.array([[x, 0, z] for z in at for x in at])
    corners = []
    for i in range(cells):
        for k in range(cells):
            a = i * (cells + 1) + k
            b, c, d = a + 1, a + cells + 2, a + cells + 1
            corners += [(a, d, c), (a, c, b)]
    return dp.Mesh.compile(places, corners, unit="m", springs={
        "kind": "sheet", "young": 1e5, "thickness": thickness, "density": density, "drag": 10.0, "viscosity": 1e-4})


def poses_at(tick, top, count=COUNT):
    """Each environment's tool comes down elsewhere, at its own speed, and slides."""
    poses = np.zeros((count, 7))
    i = np.arange(count)
    depth = np.minimum(0.009, (2 + 0.3 * i) * 4e-5 * tick)
    poses[:, 0] = 0.004 * np.sin(i) + 5e-6 * i * tick
    poses[:, 1] = top + 0.004 - depth
    poses[:, 2] = 0.004 * np.cos(3 * i)
    poses[:, 3] = 1
    return poses


class Batch(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        places, corners = make_mesh("liver", "600")
        settings = {"kind": "volume", "spacing": 0.03, "young": 5000.0, "density": 1000.0, "drag": 5.0,
                    "viscosity": 0.002, "fixed": np.flatnonzero(places[:, 1] < np.median(places[:, 1]))}
        cls.liver = dp.Mesh.compile(places, corners, unit="m")
        cls.soft = dp.Mesh.compile(places, corners, unit="m", springs=settings)
        near = np.hypot(places[:, 0], places[:, 2]) < 0.012
        cls.top = float(places[near, 1].max())

    def make(self, threads, **settings):
        world = dp.batch.World(COUNT, read=dp.batch.READ, threads=threads, max_contacts=16, **settings)
        body = world.add_body(self.liver, static_friction=0.4, kinetic_friction=0.3)
        soft = world.add_deformable(self.soft, (0, 0, 0.5), springs=SPRINGS, load_radius=0.01)
        near, far = (world.add_tool([0, 0, 0], [0, 0.1, 0], 0.002) for _ in range(2))
        return world, body, soft, near, far

    def run_batch(self, threads):
        world, body, soft, near, far = self.make(threads)
        kept = []
        for tick in range(TICKS):
            near.pose = poses_at(tick, self.top)
            far.pose = poses_at(tick, self.top) + [0, 0, 0.5, 0, 0, 0, 0]
            body.pose[:, 0] = 1e-5 * tick
            world.step(DT)
            kept.append([array.copy() for tool in (near, far) for array in
                         (tool.wrench, tool.proxy, tool.hit["gap"], tool.force["energy"], tool.loads, tool.load_count,
                          tool.contacts, tool.contact_count)]
                        + [body.wrench.copy(), soft.wrench.copy(), soft.loads.copy()])
        return kept, soft.vertices

    def test_a_batch_answers_as_single_worlds_do_bit_for_bit(self):
        kept, vertices = self.run_batch(2)
        touched = 0
        for i in range(COUNT):
            with dp.World(max_contacts=16) as world:
                body = world.add_body(self.liver, static_friction=0.4, kinetic_friction=0.3)
                soft = world.add_deformable(self.soft, (0, 0, 0.5), load_radius=0.01)
                springs = dp.Springs(self.soft, **SPRINGS)
                tools = [world.add_tool([0, 0, 0], [0, 0.1, 0], 0.002) for _ in range(2)]
                for tick in range(TICKS):
                    pose = poses_at(tick, self.top)[i]
                    body.pose = (1e-5 * tick, 0, 0)
                    tools[0].pose, tools[1].pose = pose, pose + [0, 0, 0.5, 0, 0, 0, 0]
                    world.step(DT)
                    soft.step(springs, DT)
                    row = kept[tick]
                    for k, tool in enumerate(tools):
                        wrench, proxy, gap, energy, loads, load_count, contacts, contact_count = row[8 * k:8 * k + 8]
                        touched += load_count[i] > 0
                        self.assertEqual(wrench[i].tobytes(), tool.wrench.tobytes())
                        self.assertEqual(proxy[i].tobytes(), tool.proxy.tobytes())
                        self.assertEqual(gap[i].tobytes(), tool.hit["gap"].tobytes())
                        self.assertEqual(energy[i], tool.force["energy"])
                        for mine, theirs, count in ((loads, tool.loads, load_count),
                                                    (contacts, tool.contacts, contact_count)):
                            self.assertEqual(count[i], len(theirs))
                            for name in ("body", "segment", "triangle"):
                                self.assertTrue(np.array_equal(mine[name][i, :count[i]], theirs[name]))
                        self.assertEqual(loads["point"][i, :load_count[i]].tobytes(), tool.loads["point"].tobytes())
                        self.assertEqual(contacts["normal"][i, :contact_count[i]].tobytes(),
                                         tool.contacts["normal"].tobytes())
                    self.assertEqual(row[16][i].tobytes(), body.wrench.tobytes())
                    dense = np.zeros((len(self.soft.vertices), 3))
                    for load in soft.loads:
                        dense[load["vertex"]] += load["force"]
                    self.assertEqual(row[18][i].tobytes(), dense.tobytes())
                self.assertEqual(vertices[i].tobytes(), soft.vertices.tobytes())
        self.assertGreater(touched, COUNT * TICKS / 2)

    def test_a_batch_does_not_depend_on_how_many_threads_step_it(self):
        one = self.run_batch(1)
        for threads in (2, 3, 40):
            other = self.run_batch(threads)
            self.assertEqual(one[1].tobytes(), other[1].tobytes())
            for mine, theirs in zip(one[0], other[0]):
                self.assertTrue(all(a.tobytes() == b.tobytes() for a, b in zip(mine, theirs)), threads)

    def test_loads_of_tool_and_tissue_balance_and_friction_keeps_to_its_cone(self):
        world, body, soft, near, far = self.make(2)
        worst, slid, cone, known, points = 0.0, 0.0, 0.0, 0, 0
        for tick in range(TICKS):
            near.pose = poses_at(tick, self.top)
            far.pose = near.pose + [0, 0, 0.5, 0, 0, 0, 0]
            world.step(DT)
            scale = np.abs(far.wrench[:, :3]).max() + 1e-9
            worst = max(worst, np.abs(far.wrench[:, :3] + soft.loads.sum(1)).max() / scale,
                        np.abs(near.wrench[:, :3] + body.wrench[:, :3]).max(),
                        np.abs(near.wrench[:, :3] - (near.loads["force"] * near.touching[..., None]).sum(1)).max())
            push = (near.loads["force"] * near.normals).sum(-1)
            size = np.linalg.norm(near.friction, axis=-1)
            felt = near.touching & (push > 0.05)
            slid = max(slid, size[felt].max(initial=0))
            cone = max(cone, (size[felt] / push[felt]).max(initial=0))
            at = np.linalg.norm(near.loads["point"] - near.proxy[:, None, :3], axis=-1)[near.normals.any(-1)]
            known, points = known + len(at), points + int(near.touching.sum())
            self.assertTrue(np.allclose(at, 0.002, atol=2e-5), at)  # the first end of the axis is what touches
        self.assertGreater(known, 0.95 * points)
        self.assertLess(worst, 1e-10)
        self.assertGreater(slid, 0.01)
        self.assertLess(cone, 0.41)

    def test_a_cloth_on_a_tool_weighs_m_g(self):
        mesh = sheet(6, 0.12)
        with dp.batch.World(4, threads=2, stiffness=500.0) as world:
            cloth = world.add_deformable(mesh, (0, 0.02, 0), load_radius=0.01,
                                         springs={**SPRINGS, "gravity": (0.0, -9.81, 0.0)})
            tool = world.add_tool([-0.1, 0, 0], [0.1, 0, 0], 0.01)
            tool.set(lock_rotation=1)
            cloth.set(static_friction=1.0, kinetic_friction=1.0)
            tool.pose[:, 1] = [-0.002, 0, 0.001, 0.002]
            felt = []
            for tick in range(3000):
                world.step(DT)
                if tick >= 2000:
                    felt.append(tool.wrench[:, 1].copy())
        weight = float(mesh.info.spring_mass) * 9.81
        print("note cloth on a tool: felt", np.mean(felt, 0).round(5).tolist(), "N, m g is", round(weight, 5))
        self.assertTrue(np.allclose(-np.mean(felt, 0), weight, rtol=0.02), np.mean(felt, 0) / weight)

    def test_an_environment_that_fails_stops_no_other(self):
        world, body, soft, near, far = self.make(2)
        world.step(DT)
        near.pose[5] = np.nan
        with self.assertRaisesRegex(dp.Error, "environment 5, and 0 others") as caught:
            world.step(DT)
        self.assertEqual((caught.exception.name, np.flatnonzero(world.results).tolist()), ("DPT_E_FINITE", [5]))
        self.assertEqual(near.force["reason"][5], dp.Force.STALE)
        near.pose = poses_at(0, self.top)
        world.step(DT)
        self.assertFalse(world.results.any())

    def test_an_environment_begins_again(self):
        world, body, soft, near, far = self.make(2)
        first, second = [], []
        for kept in (first, second):
            for tick in range(TICKS):
                near.pose = poses_at(tick, self.top)
                far.pose = near.pose + [0, 0, 0.5, 0, 0, 0, 0]
                if tick == 0:
                    world.reset([3, 4])
                world.step(DT)
                kept.append(np.concatenate((near.wrench[3:5], far.wrench[3:5])))
        self.assertEqual(np.array(first).tobytes(), np.array(second).tobytes())
        self.assertGreater(np.abs(np.array(first)[-1, 2:, 1]).min(), 0.001)

    def test_vertices_that_are_set_are_where_the_step_finds_them(self):
        with dp.batch.World(3, threads=2) as world:
            soft = world.add_deformable(self.liver)
            tool = world.add_tool([0, 0, 0], [0, 0.1, 0], 0.002)
            tool.pose = (0, self.top + 0.01, 0, 1, 0, 0, 0)
            world.step(DT)
            moved = np.stack([soft.rest + np.float32([0, dy, 0]) for dy in (0, 0.005, 0.012)])
            soft.vertices = moved
            world.step(DT)
            self.assertEqual(soft.vertices.tobytes(), moved.tobytes())
            self.assertEqual((tool.wrench[:, 1] > 0.1).tolist(), [False, False, True])
            with self.assertRaises(TypeError):
                soft.vertices = moved[:2]
            with self.assertRaises(ValueError):
                world.tools[0].rows = (*tool.rows[:2], np.zeros((2, 6)), *tool.rows[3:])
                world.step(DT)

    def test_vertices_that_are_set_outlive_a_step_that_is_refused(self):
        with dp.batch.World(3, threads=2) as world:
            soft, tool = world.add_deformable(self.liver), world.add_tool([0, 0, 0], [0, 0.1, 0], 0.002)
            moved = np.stack([soft.rest + np.float32([0, 0.005, 0])] * 3)
            soft.vertices = moved
            rows, tool.rows = tool.rows, (*tool.rows[:2], np.zeros((2, 6)), *tool.rows[3:])
            self.assertRaises(ValueError, world.step, DT)
            tool.rows = rows
            world.step(DT)
            self.assertEqual(soft.vertices.tobytes(), moved.tobytes())

    def test_springs_without_settings_of_their_own(self):
        with dp.batch.World(2) as world:
            kinds = [world.add_deformable(self.soft, springs=springs).springs for springs in ({}, True, None, False)]
        self.assertEqual([springs is not None for springs in kinds], [True, True, False, False])

    def test_a_second_thread_is_kept_out_and_nothing_leaks(self):
        world, body, soft, near, far = self.make(2)
        refused = []

        def other():
            for _ in range(200):
                try:
                    world.step(DT)
                except RuntimeError as error:
                    refused.append(str(error))

        threads = [threading.Thread(target=other) for _ in range(2)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertTrue(all("another thread is in it" in text for text in refused))
        world.step(DT)
        del world, body, soft, near, far
        gc.collect()
        self.assertFalse([thing for thing in gc.get_objects() if isinstance(thing, dp.batch.World)])

    def test_steps_and_refused_steps_keep_no_memory(self):
        world = dp.batch.World(4, threads=2, read=dp.batch.READ, max_contacts=4)
        body, tool = world.add_deformable(self.liver), world.add_tool([0, 0, 0], [0, 0.1, 0], 0.01)
        call, first = dp._dynpoint.step_batch, (world.worlds, DT, 2, 16)
        few = (*body.rows[:4], (None,) * 3, *body.rows[5:])
        refused = [(TypeError, (*first, (tool.rows,), ((body.ids,),), world.results)),
                   (TypeError, (*first, (), (few,), world.results)),
                   (RuntimeError, (world.worlds[:1] * 2, DT, 2, 16, (), (), np.zeros(2, np.int32)))]

        def some(times):
            for _ in range(times):
                world.step(DT)
                for error, arguments in refused:
                    self.assertRaises(error, call, *arguments)
            gc.collect()
            return int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1]) * 4096

        before = some(200)
        self.assertLess(some(1500) - before, 400000)

    def test_doctests(self):
        self.assertEqual(doctest.testmod(dp.batch).failed, 0)


if __name__ == "__main__":
    main()
