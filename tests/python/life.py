# SPDX-License-Identifier: BSD-3-Clause
"""Objects keep what they need, and nothing stays of those that are gone."""
import gc
import resource
import sys
import tracemalloc
import unittest
import warnings
import weakref

import numpy as np

import dynpoint as dp
from verdicts import main

OBJECTS = int(sys.argv.pop(1)) if len(sys.argv) > 1 else 100000
VERTICES = np.array([[-1, 0, -1], [1, 0, -1], [0, 0, 1.0]])
TRIANGLES = np.array([[0, 2, 1]], np.uint32)


def grown(work, count):
    """Bytes of Python's own that `work` leaves behind, and KiB of the process."""
    for _ in range(200):
        work()
    gc.collect()
    tracemalloc.start()
    before, pages = tracemalloc.get_traced_memory()[0], resident()
    for _ in range(count):
        work()
    gc.collect()
    after = tracemalloc.get_traced_memory()[0]
    tracemalloc.stop()
    return after - before, resident() - pages


def resident():
    with open("/proc/self/statm") as told:
        return int(told.read().split()[1]) * resource.getpagesize() // 1024


class Life(unittest.TestCase):
    def test_members_keep_their_world_and_worlds_their_meshes(self):
        def felt():
            world = dp.World()
            world.add_body(dp.Mesh.compile(VERTICES, TRIANGLES, unit="m"))
            return world.add_tool([0, 0, 0], [0, 1, 0], 0.01)

        tools = [felt() for _ in range(50)]
        gc.collect()
        filler = [bytes(4096) for _ in range(1000)]
        for tool in tools:
            for height in (0.1, 0.005):
                tool.tick([0, height, 0], 0.001)
            self.assertGreater(tool.wrench[1], 2)
        del filler

    def test_what_is_put_into_a_scene_s_world_lives_as_long_as_the_scene(self):
        mesh, scene = dp.Mesh.compile(VERTICES, TRIANGLES, unit="m"), dp.Scene("liver", "sim:", ticks=1)
        before = sys.getrefcount(mesh)
        scene.body(0).remove()  # a scene has room for its own
        scene.world.add_body(mesh)
        gc.collect()
        self.assertGreater(sys.getrefcount(mesh), before)
        scene.close()
        self.assertEqual(sys.getrefcount(mesh), before)

    def test_a_scene_lives_as_long_as_its_world(self):
        tool = dp.Scene("liver", "sim:", ticks=1).tool
        gc.collect()
        self.assertTrue(tool.valid)
        self.assertEqual(tool.law, "proxy")

    def test_a_mesh_goes_with_its_last_user(self):
        mesh = dp.Mesh.compile(VERTICES, TRIANGLES, unit="m")
        gone = weakref.ref(mesh)
        world = dp.World()
        body = world.add_body(mesh)
        view = mesh.vertices
        del mesh
        gc.collect()
        self.assertIsNotNone(gone())
        body.remove()
        del body
        self.assertIsNotNone(gone())
        del view
        gc.collect()
        self.assertIsNone(gone())

    def test_nothing_leaks(self):
        mesh = dp.Mesh.compile(VERTICES, TRIANGLES, unit="m", springs={"kind": "sheet"})
        ends, content = np.zeros((2, 6)), bytes(mesh)
        world = dp.World(max_contacts=4)
        tool = world.add_tool([0, 0, 0], [0, 1, 0], 0.01)

        def members():
            body = world.add_body(mesh)
            body.static_friction = 0.5
            mine = world.add_tool([0, 0, 0], [0, 1, 0])
            mine.tick([0, 0.1, 0], 0.001)
            mine.remove()
            body.remove()

        def whole():
            with dp.World(max_bodies=1, max_tools=1, certificate_bytes=0) as own:
                soft = own.add_deformable(mesh)
                soft.step(dp.Springs(mesh), 0.001)
                soft.vertices

        def answers():
            tool.tick([0, 0.005, 0], 0.001)
            tool.hit, tool.force, tool.wrench, tool.proxy, tool.contacts, repr(tool), mesh.query(ends), mesh.info

        def refused():
            for call in (lambda: mesh.query(ends[:, :5]), lambda: tool.set_pose("x"), lambda: dp.World(colour=1),
                         lambda: tool.set_pose([np.nan] * 7), lambda: dp.Mesh(content[:-8]), lambda: dp.World(law="x"),
                         lambda: dp.Mesh.compile(VERTICES, [[0, 1, 9]], unit="m")):
                try:
                    call()
                except (TypeError, ValueError, dp.Error):
                    continue
                raise AssertionError("it was not refused")

        def devices():
            with dp.Device("sim:") as device:
                dp.Loop(device, lambda state, wrench, dt: None).run(3)
                device.read()

        def meshes():
            dp.Mesh(content)
            dp.Mesh.compile(VERTICES, TRIANGLES, unit="m")

        share = {members: 4, whole: 20, answers: 10, refused: 40, devices: 50, meshes: 20}
        for work, part in share.items():
            count = OBJECTS // part
            own, pages = grown(work, count)
            self.assertLess(own, 20000, work.__name__)
            self.assertLess(pages, 6000, work.__name__)

    def test_handles_close_with_their_objects(self):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            for _ in range(20):
                dp.Scene("membrane", "sim:", ticks=1)
                dp.Device("sim:")
            gc.collect()
        self.assertLess(len(dp._device._open), 3)


main()
