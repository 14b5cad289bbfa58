# SPDX-License-Identifier: BSD-3-Clause
"""A probe presses a soft block of Newton's, on Warp's CPU: physics is Newton's, contact and force dynpoint's.

    pip install dynpoint newton
    python3 newton_touch.py              # the first time Warp compiles Newton's kernels: a minute
    python3 newton_touch.py 0            # a tool of 4,000 N/m shakes where the block does not tell how it gives way
    python3 newton_touch.py 0 1000       # a softer one does not
"""
import sys

import newton
import numpy as np
import warp as wp

import dynpoint as dp
from dynpoint.with_newton import Touch, measure_compliance

wp.set_device("cpu")
STEP, TICKS, SIDE, EDGE, YOUNG, POISSON = 0.005, 5, 5, 0.014, 2e4, 0.2

builder = newton.ModelBuilder(up_axis=newton.Axis.Z, gravity=(0.0, 0.0, -9.81))
builder.add_soft_grid(pos=wp.vec3(-0.035, -0.035, 0.0), rot=wp.quat_identity(), vel=wp.vec3(0.0, 0.0, 0.0), dim_x=SIDE,
                      dim_y=SIDE, dim_z=SIDE, cell_x=EDGE, cell_y=EDGE, cell_z=EDGE, density=875.0,
                      k_mu=YOUNG / 2 / (1 + POISSON), k_lambda=YOUNG * POISSON / (1 + POISSON) / (1 - 2 * POISSON),
                      k_damp=1e-4, add_surface_mesh_edges=False, particle_radius=1e-4)
for i, place in enumerate(builder.particle_q):
    if place[2] < 1e-6:  # the bottom is held
        builder.particle_mass[i] = 0.0
        builder.particle_flags[i] = 0
builder.color()
model = builder.finalize()
solver = newton.solvers.SolverVBD(model, iterations=10)
state, after = model.state(), model.state()

# A step of this solver leaves most of a push to the steps behind it, so a single push goes too far: a small share is
# told.
SHARE = float(sys.argv[1]) if len(sys.argv) > 1 else 0.03
STIFFNESS = float(sys.argv[2]) if len(sys.argv) > 2 else 4000.0
top = np.flatnonzero(model.particle_q.numpy()[:, 2] > 0.069)
compliance = SHARE * measure_compliance(model, solver, state, STEP, top[::7])
touch = Touch(model, state, segments=dp.make_segments([0, 0, 0], [0, 0, 0.1], 0.008), dt=STEP, ticks=TICKS,
              compliance=compliance, load_radius=0.02, max_points=64, static_friction=0.3, kinetic_friction=0.3,
              tool_settings={"stiffness": STIFFNESS})
felt, left = [], 0.0
for step in range(240):
    time = step * STEP
    state.clear_forces()
    touch.load(state)
    solver.step(state, after, None, None, STEP)
    touch.feel(after, (0, 0, 0.085 - 0.02 * min(1.0, time / 0.5)))
    state, after = after, state
    felt.append(touch.wrench[2])
    left = max(left, np.abs(touch.wrench[:3] + touch.tissue.body.loads["force"].sum(0)).max())
    if step % 24 == 0:
        height = 1000 * state.particle_q.numpy()[:, 2].max()
        print(f"{time:4.2f} s  felt {touch.wrench[2]:6.3f} N  the block's top is at {height:5.2f} mm")
hum = np.std(felt[-60:])
print(f"compliance {compliance:.2e} m/N; {felt[-1]:.3f} N, hum {hum:.1e} N; tool and tissue leave {left:.1e} N")
if not (felt[-1] > 0.5 and hum < 0.02 * felt[-1] and left < 1e-12):
    raise SystemExit("it is not felt as it should be")
