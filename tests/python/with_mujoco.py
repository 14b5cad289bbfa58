# SPDX-License-Identifier: BSD-3-Clause
"""dynpoint.with_mujoco: physics of MuJoCo's, contact of ours. Loads balance, weights are m g, tissue that tells how far
it gives way does not shake, the gap is that of brute force; and the sample runs."""
import importlib.util
import subprocess
import sys
import unittest
from pathlib import Path

import numpy as np

from verdicts import main

HAS_MUJOCO = importlib.util.find_spec("mujoco") is not None
if HAS_MUJOCO:
    import mujoco

    from dynpoint.with_mujoco import Touch, measure_compliance

ROOT = Path(__file__).resolve().parents[2]
OFF = 'contype="0" conaffinity="0"'
PROBE = f'<body name="probe" mocap="true" pos="0 0 0.1"><geom type="sphere" size="0.01" {OFF}/></body>'
BLOCK = """<flexcomp name="organ" type="grid" dim="3" count="{count} {count} {count}" spacing="{edge} {edge} {edge}"
  radius="0" mass="0.3" pos="0 0 {height}"><contact selfcollide="none" contype="0" conaffinity="0"/>
  <elasticity young="2e4" poisson="0.2" damping="0.01"/>{pins}</flexcomp>"""
SHEET = """<flexcomp name="sheet" type="grid" dim="2" count="15 15 1" spacing=".01 .01 .01" radius="0" mass="0.09"
  pos="0 0 0"><contact selfcollide="none" contype="0" conaffinity="0"/>
  <elasticity young="2e5" poisson="0.2" thickness="1e-3" damping="0.001" elastic2d="stretch"/>
  <pin gridrange="0 0 14 0"/><pin gridrange="0 14 14 14"/><pin gridrange="0 0 0 14"/><pin gridrange="14 0 14 14"/>
  </flexcomp>"""
PINNED = '<pin gridrange="0 0 0 4 4 0"/>'


def make(world, timestep):
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco><option timestep="{timestep}" integrator="discrete"/><worldbody>{world}</worldbody></mujoco>')
    return model, mujoco.MjData(model)


def block(count=5, height=0.035, pins=PINNED):
    return BLOCK.format(count=count, edge=0.07 / (count - 1), height=height, pins=pins)


@unittest.skipUnless(HAS_MUJOCO, "no mujoco")
class WithMujoco(unittest.TestCase):
    def press(self, compliance, period=0.01):
        """A ball of 2,000 N/m comes down 15 mm, and stays."""
        model, data = make(block(6, pins='<pin gridrange="0 0 0 5 5 0"/>') + PROBE, period)
        model.dof_damping[:] = 0.007
        touch = Touch(model, data, tool="probe", flexes=["organ"], ticks=round(period / 0.001), load_radius=0.02,
                      max_points=64, compliance=compliance, tool_settings={"stiffness": 2000})
        forces, left, apart = [], 0.0, []
        for step in range(round(1.0 / period)):
            data.mocap_pos[0, 2] = 0.09 - 0.02 * min(1.0, step * period / 0.3)
            touch.step()
            forces.append(touch.wrench[2])
            left = max(left, np.abs(touch.wrench[:3] + touch.flexes[0].body.loads["force"].sum(0)).max())
            apart.append(np.linalg.norm(touch.flexes[0].body.vertices - touch.tool.proxy[:3], axis=1).min())
        return np.array(forces), left, np.array(apart), touch

    def test_tissue_that_answers_does_not_shake_at_100_hz(self):
        silent, left, apart, touch = self.press(None)
        shaking, _, _, _ = self.press({"organ": 0})
        fast, _, _, _ = self.press(None, 0.001)
        hum, shake = silent[-30:].std(), shaking[-30:].std()
        print(f"note 100 Hz, 2,000 N/m: {silent[-1]:.4f} N, hum {hum:.1e} N with the tissue's answer, {shake:.2f} N "
              f"without; {fast[-1]:.4f} N at 1,000 Hz")
        self.assertLess(hum, 1e-3 * silent[-1])
        self.assertGreater(shake, 0.1 * silent[-1])
        self.assertLess(abs(silent[-1] / fast[-1] - 1), 0.01)
        self.assertLess(left, 1e-12 * silent.max())
        self.assertGreater(apart.min(), 0.01 - 1e-5)  # the ball is in no vertex

    def press_sheet(self, foresees):
        """A ball of 2,000 N/m comes down 10 mm on a sheet of 0.09 kg in a frame, and stays; MuJoCo steps at 500 Hz."""
        model, data = make(SHEET + PROBE, 0.002)
        model.dof_damping[:] = 5e-4
        model.opt.gravity[:] = 0
        touch = Touch(model, data, tool="probe", flexes=["sheet"], ticks=2, load_radius=0.03, max_points=64,
                      foresees=foresees, tool_settings={"stiffness": 2000})
        forces = []
        for step in range(750):
            data.mocap_pos[0, 2] = 0.012 - 0.012 * min(1.0, step / 150)
            touch.step()
            forces.append(touch.wrench[2])
        return np.array(forces[-200:])

    def test_a_light_sheet_is_still_as_its_steps_are_foreseen(self):
        still, named, shaking = self.press_sheet(None), self.press_sheet(["sheet"]), self.press_sheet([])
        print(f"note a sheet at 500 Hz, 2,000 N/m: {still.mean():.4f} N, hum {still.std():.1e} N with its steps foreseen, "
              f"{shaking.std():.1e} N without")
        self.assertTrue(np.array_equal(still, named))  # sheets are by default
        self.assertGreater(still.mean(), 0.05)
        self.assertLess(still.std(), 1e-3)
        self.assertGreater(shaking.std(), 50 * still.std())

    def test_what_is_felt_is_what_holds_the_tissue(self):
        """The pinned vertices bear the tool and the block's weight: force in, force out, by MuJoCo's own dynamics at
        rest."""
        _, _, _, touch = self.press(None, 0.001)
        data, model = touch.data, touch.model
        self.assertLess(np.abs(data.qacc).max(), 0.5)
        weight = float(model.body_mass[model.flex_vertbodyid[model.flex_vertbodyid > 0]].sum()) * 9.81
        held = float(data.qfrc_passive.reshape(-1, 3)[:, 2].sum())  # what the elastic forces do to all that is free
        self.assertLess(abs(held / (weight + touch.wrench[2]) - 1), 0.02, (held, weight, touch.wrench[2]))

    def test_a_soft_block_on_two_bars_weighs_m_g(self):
        bars = "".join(f'<geom type="capsule" fromto="-.06 {y} 0 .06 {y} 0" size="0.01" {OFF}/>' for y in (0.02, -0.02))
        model, data = make(block(height=0.047, pins="") + f'<body name="bars" mocap="true">{bars}</body>', 0.001)
        model.dof_damping[:] = 0.012
        touch = Touch(model, data, tool="bars", flexes=["organ"], load_radius=0.025, max_points=64, static_friction=0.8,
                      kinetic_friction=0.8, compliance={"organ": 0})
        felt = []
        for step in range(2000):
            touch.step()
            felt.append(-touch.mean_wrench[2])
        weight = 0.3 * 9.81
        print(f"note a soft block on bars: felt {np.mean(felt[1200:]):.4f} N, m g is {weight:.4f}")
        self.assertLess(abs(np.mean(felt[1200:]) / weight - 1), 0.02)

    def test_a_tool_of_mujoco_s_lies_on_a_box_that_stands_on_its_floor(self):
        model, data = make(f"""<geom name="floor" type="plane" size="1 1 .1"/>
          <body name="box" pos="0 0 0.05"><freejoint/><geom name="box" type="box" size=".05 .05 .05" mass="0.5"/></body>
          <body name="probe" pos="0.01 0 0.112"><joint type="slide" axis="0 0 1" damping="2"/>
            <joint type="slide" axis="1 0 0" damping="2"/>
            <geom type="capsule" fromto="-.03 0 0 .03 0 0" size="0.01" mass="0.2" {OFF}/></body>""", 0.001)
        touch = Touch(model, data, tool="probe", geoms=["box"], static_friction=0.5, kinetic_friction=0.5)
        for _ in range(2000):
            touch.step()
        floor = sum(data.efc_force[contact.efc_address:contact.efc_address + 4].sum() for contact in data.contact)
        print(f"note a tool on a box: felt {touch.wrench[2]:.4f} N of {0.2 * 9.81:.4f}, the floor bears {floor:.3f} of "
              f"{0.7 * 9.81:.3f}")
        self.assertLess(abs(touch.wrench[2] / (0.2 * 9.81) - 1), 0.02)
        self.assertLess(abs(floor / (0.7 * 9.81) - 1), 0.02)
        self.assertLess(np.abs(touch.body_wrenches[0, :3] + touch.mean_wrench[:3]).max(), 1e-12)
        self.assertLess(np.abs(data.xfrc_applied).max(), 1e-300)  # nothing of ours stays there

    def test_what_cannot_be_is_said(self):
        model, data = make(block() + PROBE + f'<geom name="ball" type="sphere" size="0.01" {OFF}/>'
                           f'<body name="bare" mocap="true"><geom type="box" size=".1 .1 .1" {OFF}/></body>', 0.001)
        for arguments, why in (({"tool": "none"}, "no body 'none'"), ({"tool": "probe", "flexes": ["x"]}, "no flex 'x'"),
                               ({"tool": "probe", "foresees": ["organ"]}, "'organ' is none of the flexes"),
                               ({"tool": "probe", "geoms": ["ball"]}, "wanted a mesh or a box"),
                               ({"tool": "bare"}, "neither capsules nor spheres")):
            with self.assertRaisesRegex(ValueError, why):
                Touch(model, data, **arguments)

    def test_a_compliance_is_what_a_step_does(self):
        model, data = make(block(pins="") + PROBE, 0.001)
        mass = float(model.body_mass[model.flex_vertbodyid[0]])
        self.assertTrue(0.2 * 1e-6 / mass < measure_compliance(model, data, "organ") <= 1.001 * 1e-6 / mass)

    def test_the_sample(self):
        told = subprocess.run([sys.executable, ROOT / "docs/samples/mujoco_touch.py"], capture_output=True, text=True,
                              check=False)
        self.assertEqual(told.returncode, 0, told.stdout + told.stderr)
        self.assertRegex(told.stdout, "the organ was pressed by .* N, the bone by .* N")


if __name__ == "__main__":
    main()
