# SPDX-License-Identifier: BSD-3-Clause
"""A block of MuJoCo's (flex) is pressed by a ball that a still hand holds. MuJoCo steps at 30 to 1,000 Hz, dynpoint's
loop at 1 kHz; MuJoCo tells how far a vertex gives way in one of its steps, or nothing:

    feel_mujoco.py BUILD [FILE.csv]

How far it gives way is measured: a newton acts on a vertex of the middle of the top for one step. Hum is the rms of the
force about a line, in windows of 51 ms; of jumps, from tick to tick, the largest. The hand is still by then.
"""
import sys
from ctypes import byref, c_double, c_uint32, c_uint64

from peer_mujoco import (Contact, Pose, Segment, address, check, double3, double4, mujoco, np, skip, struct, verdicts)

COUNT, SPACING, BALL, STIFFNESS, DEPTH, LOADS = 7, 0.012, 0.012, 500.0, 0.006, 4096
STEP, PRESSED, STILL, TICKS, WINDOW = 0.0005, 300, 1000, 1600, 51  # s of MuJoCo; ticks of 1 ms
SCENE = """<mujoco>
  <option timestep="{step}" gravity="0 0 0" integrator="{integrator}"/>
  <size memory="200M"/>
  <worldbody>
    <flexcomp name="organ" type="grid" dim="3" count="{count} {count} {count}" spacing="{spacing} {spacing} {spacing}"
              radius="0" mass="0.5" pos="0 0 0">
      <contact selfcollide="none"/>
      <pin gridrange="0 0 0 {last} {last} 0"/>
      <elasticity young="5000" poisson="0.2" damping="0.01"/>
    </flexcomp>
  </worldbody>
</mujoco>"""

Load = struct("dpt_load", (c_uint32, "vertex reserved"), (double3, "force"))
Wrench = struct("dpt_wrench", (double3, "force torque"))
ForceInfo = struct("dpt_force_info", (c_uint32, "size reason flags law"), (Wrench, "wrench"), (c_double, "energy lag"),
                   (c_uint64, "folds"), (c_uint32, "sticking slipping"), (c_double, "body_work"))


def open_model():
    for integrator in ("discrete", "implicitfast"):
        text = SCENE.format(step=STEP, integrator=integrator, count=COUNT, spacing=SPACING, last=COUNT - 1)
        try:
            return mujoco.MjModel.from_xml_string(text)
        except ValueError as error:
            refused = error
    skip(f"version {mujoco.__version__} says: {str(refused).splitlines()[0]}")


class Physics:
    """MuJoCo's block; forces are on its vertices, in its order."""

    def __init__(self, period):
        self.model = open_model()
        self.data, self.steps = mujoco.MjData(self.model), round(period / STEP)
        mujoco.mj_forward(self.model, self.data)

    def step(self, loads):
        self.data.xfrc_applied[:] = 0
        for vertex, force in loads:
            self.data.xfrc_applied[self.model.flex_vertbodyid[vertex], :3] += force
        for _ in range(self.steps):
            mujoco.mj_step(self.model, self.data)
        mujoco.mj_kinematics(self.model, self.data)
        mujoco.mj_flex(self.model, self.data)
        return self.data.flexvert_xpos


def give_way(period):
    """m/N: of a vertex of the middle of the top, in one step."""
    physics = Physics(period)
    before = physics.data.flexvert_xpos.copy()
    vertex = np.linalg.norm(before - [0, 0, before[:, 2].max()], axis=1).argmin()
    return (before - physics.step([(vertex, np.array([0, 0, -0.01]))]))[vertex, 2] / 0.01


class Feel(Contact):
    tool_shape = Segment(double3(0, 0, 0), double3(0, 0, 0), BALL)

    def __init__(self, build, physics, period, compliance):
        self.period, self.compliance = period, compliance
        shell = physics.model.flex_shell[:3 * physics.model.flex_shellnum[0]].reshape(-1, 3)
        super().__init__(build, physics.data.flexvert_xpos, shell)
        self.loads, self.count, self.seconds = (Load * LOADS)(), c_uint32(), c_double()
        self.info = ForceInfo(size=0)

    def define(self, world_def, body_def):
        world_def.stiffness = STIFFNESS
        body_def.period, body_def.load_radius, body_def.compliance = self.period, 3 * SPACING, self.compliance

    def take_loads(self):
        if self.compliance:
            self.must(self.core.dpt_body_get_mean_loads(self.world, self.body, self.loads, c_uint32(LOADS),
                                                        byref(self.count), byref(self.seconds)))
            self.must(self.core.dpt_body_set_answered_loads(self.world, self.body, self.loads, self.count))
        else:
            self.must(self.core.dpt_body_get_loads(self.world, self.body, self.loads, c_uint32(LOADS),
                                                   byref(self.count)))
        return [(self.order[load.vertex], np.array(load.force)) for load in self.loads[:self.count.value]]

    def set_vertices(self, vertices):
        positions = vertices[self.order].astype("f4")
        self.must(self.core.dpt_body_set_vertices(self.world, self.body, 0, c_uint32(len(positions)),
                                                  address(positions), c_double(-1)))

    def press(self, height):
        pose = Pose(double3(0.0007, 0.0004, height), double4(1, 0, 0, 0))
        self.must(self.core.dpt_tool_set_pose(self.world, self.tool, byref(pose)))
        self.must(self.core.dpt_world_step(self.world, c_double(0.001), None))
        if self.compliance:
            self.must(self.core.dpt_body_step_springs(self.world, self.body, None, c_double(0.001), None))
        self.info.size = ForceInfo.__dict__["body_work"].offset + 8
        self.must(self.core.dpt_tool_get_force_info(self.world, self.tool, byref(self.info)))
        return np.linalg.norm(self.info.wrench.force), self.info.reason


def run(build, ticks, compliance):
    """Of the force of a still hand: mean, hum and largest jump, N; ticks in which the ball had lost the surface."""
    physics, forces, lost = Physics(0.001 * ticks), [], 0
    feel = Feel(build, physics, 0.001 * ticks, compliance)
    top = physics.data.flexvert_xpos[:, 2].max()
    for tick in range(TICKS):
        if tick % ticks == 0:
            feel.set_vertices(physics.step(feel.take_loads()))
        depth = DEPTH - (DEPTH + 0.002) * max(0, 1 - tick / PRESSED)
        force, reason = feel.press(top + BALL - depth)
        forces.append(force)
        lost += reason > 1  # neither DPT_FORCE_ACTS nor _FREE
    still = np.array(forces[STILL:])
    windows = still[:len(still) // WINDOW * WINDOW].reshape(-1, WINDOW)
    x = np.arange(WINDOW) - WINDOW // 2
    left = windows - windows.mean(1, keepdims=True) - (windows @ x / (x @ x))[:, None] * x
    return still.mean(), np.sqrt((left ** 2).mean()), abs(np.diff(still)).max(), lost


def main():
    build, rows = sys.argv[1], []
    print(f"  MuJoCo {mujoco.__version__}, a ball of {1000 * BALL:g} mm and {STIFFNESS:g} N/m on its block")
    print("     rate   gives way, told   force    hum   largest jump")
    for ticks, shares in ((1, (1,)), (2, (1,)), (10, (1,)), (33, (0, 1, 10, 0.1))):
        own = give_way(0.001 * ticks)
        for share in shares:
            compliance = share * own
            mean, hum, jump, lost = run(build, ticks, compliance)
            rows.append((1000 / ticks, compliance, mean, hum, jump))
            print(f"    {1000 / ticks:5.0f} {1000 * compliance:9.3g} mm/N {mean:12.4f} N {1000 * hum:8.3f} mN"
                  f" {1000 * jump:8.3f} mN")
            if share == 1:
                check(f"{1000 / ticks:.0f} Hz: a hum of at most 0.5 % or 1 mN", hum <= max(0.005 * mean, 0.001))
            if share:
                check(f"{share:g} of it told: it is held, within 2 % of the force", hum <= 0.02 * mean and not lost)
            else:
                check("without it the ball bounces", hum > 0.1 * mean)
    if len(sys.argv) > 2:
        with open(sys.argv[2], "w", encoding="ascii") as table:
            print("rate,compliance,force,hum,jump", file=table)
            for row in rows:
                print(*(f"{number:.4g}" for number in row), sep=",", file=table)
    print(f"{sum(verdicts)} passed, {len(verdicts) - sum(verdicts)} failed, 0 skipped")
    sys.exit(not all(verdicts))


main()
