# SPDX-License-Identifier: BSD-3-Clause
"""A probe presses a soft organ of MuJoCo's, and slides over a bone beside it: physics is MuJoCo's, contact and force
dynpoint's.

    pip install dynpoint mujoco
    python3 mujoco_touch.py
"""
import mujoco
import numpy as np

from dynpoint.with_mujoco import Touch

SCENE = """<mujoco>
  <option timestep="0.005" integrator="discrete"/>
  <worldbody>
    <flexcomp name="organ" type="grid" dim="3" count="6 6 6" spacing=".014 .014 .014" radius="0" mass="0.3"
              pos="0 0 0.035">
      <contact selfcollide="none" contype="0" conaffinity="0"/>
      <elasticity young="2e4" poisson="0.2" damping="0.01"/>
      <pin gridrange="0 0 0 5 5 0"/>
    </flexcomp>
    <geom name="bone" type="box" size="0.03 0.03 0.03" pos="0.08 0 0.03" contype="0" conaffinity="0"/>
    <body name="probe" mocap="true">
      <geom type="capsule" fromto="0 0 0.006 0 0 0.12" size="0.006" contype="0" conaffinity="0"/>
    </body>
  </worldbody>
</mujoco>"""

PATH = (0.08, 0.064, 0.064, 0.08, 0.08, 0.058)  # m: down, a while, up, over the bone, down

model = mujoco.MjModel.from_xml_string(SCENE)
data = mujoco.MjData(model)
touch = Touch(model, data, tool="probe", flexes=["organ"], geoms=["bone"], ticks=5, load_radius=0.02, max_points=64,
              static_friction=0.3, kinetic_friction=0.2, tool_settings={"stiffness": 1000})
on_organ, on_bone = 0.0, 0.0
for step in range(600):
    time = step * model.opt.timestep
    data.mocap_pos[0] = (np.interp(time, (1.5, 2), (0, 0.08)), 0, np.interp(time, (0, 1, 1.4, 1.5, 2, 2.5), PATH))
    touch.step()
    on_organ, on_bone = max(on_organ, touch.flexes[0].body.wrench[2] * -1), max(on_bone, touch.body_wrenches[0][2] * -1)
    if step % 60 == 0:
        top = 1000 * data.flexvert_xpos[:, 2].max()
        print(f"{time:4.2f} s  felt {np.round(touch.wrench[:3], 3)} N  the organ's top is at {top:5.2f} mm")
print(f"the organ was pressed by {on_organ:.2f} N, the bone by {on_bone:.2f} N")
if not (on_organ > 0.5 and on_bone > 0.5):
    raise SystemExit("one of them was not touched")
