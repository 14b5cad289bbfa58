# SPDX-License-Identifier: BSD-3-Clause
"""dynpoint.with_newton without Newton: what it asks of a model and a state, in NumPy's arrays."""
import unittest
from types import SimpleNamespace

import numpy as np

import dynpoint as dp
from dynpoint.with_newton import Touch
from verdicts import main


class Array:
    """As Warp's."""

    def __init__(self, content):
        self.content = np.array(content, np.float32)

    def numpy(self):
        return self.content


class WithNewton(unittest.TestCase):
    def test_the_first_time_the_tool_jumps_to_the_device(self):
        wall = dp.Mesh.compile([[0, -1, -1], [0, 2, -1], [0, 0, 2]], [[0, 1, 2]], unit="m")
        model = SimpleNamespace(particle_count=0, body_com=Array([[0, 0, 0]]))
        state = SimpleNamespace(body_q=Array([[0.05, 0, 0, 0, 0, 0, 1]]))
        touch = Touch(model, state, segments=dp.make_segments([0, 0, 0], [0, 0, 0.1], 0.002), dt=0.005, ticks=5,
                      bodies=[(0, wall)])
        touch.feel(state, (0.1, 0, 0))  # the wall is between it and the origin
        self.assertEqual((touch.wrench.any(), touch.tool.proxy[:3].tolist()), (False, [0.1, 0, 0]))
        touch.feel(state, (0.04, 0, 0))
        self.assertGreater(touch.wrench[0], 1)


if __name__ == "__main__":
    main()
