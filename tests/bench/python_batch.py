# SPDX-License-Identifier: BSD-3-Clause
"""Many environments with a soft block and a tool each: dynpoint.batch.World beside single worlds, and beside MuJoCo's own
contact on the same scene. PYTHONPATH names the package, MuJoCo is of build/venv-python or build/venv-soft:

    python_batch.py [ENVIRONMENTS [TICKS [ROUNDS]]]          or make bench-batch, which is 1000 20 3

The block is MuJoCo's flex of 6 vertices a side, 70 mm; here it is masses and springs, of the same surface. The tool, a
capsule of 100 mm, comes down onto it, and slides. Errors are those of the gap against brute force, each at its own
positions. Ticks a second are those of one environment times environments; physics, contact and what
is read are within. The runs take turns in each round, and the fastest of each counts; how many processors other programs
took meanwhile is told: figures of a machine where that is not near 0 say little.
"""
import gc
import os
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from functools import partial

import mujoco
import numpy as np

import dynpoint as dp
import dynpoint.batch
from peer_mujoco import HALF, RADIUS, gap_of, load

SIDE, DT = 6, 0.001
LYING = (0.5 ** 0.5, 0.0, 0.5 ** 0.5, 0.0)  # the axis along x


def busy():
    """Seconds that all processors have worked, for whomever."""
    with open("/proc/stat", encoding="ascii") as stat:
        user, nice, system, _, _, interrupts, soft, stolen = map(int, stat.readline().split()[1:9])
    return (user + nice + system + interrupts + soft + stolen) / os.sysconf("SC_CLK_TCK")


class Watch:
    """Time that passed, and time that processors took for this program and for all, while it ran."""

    def __init__(self):
        self.wall = self.processors = 0.0
        self.first = time.perf_counter(), time.process_time(), busy()

    def __enter__(self):
        self.began = time.perf_counter(), time.process_time()

    def __exit__(self, *_):
        self.wall += time.perf_counter() - self.began[0]
        self.processors += time.process_time() - self.began[1]

    def rates(self, ticks):
        """Ticks a second, us of processors a tick, and how many processors others took since the watch was made."""
        wall, own, all_of_it = (now - then for now, then in zip((time.perf_counter(), time.process_time(), busy()), self.first))
        return ticks / self.wall, 1e6 * self.processors / ticks, max(0.0, all_of_it - own) / wall


def place(i, tick, top):
    """Environment i's tool: down to 3 mm of depth within 8 ticks, then to and fro."""
    depth = 0.003 * min(1.0, tick / 8) * (0.5 + 0.5 * ((7 * i) % 11) / 10)
    return (0.004 * np.sin(0.02 * tick + i), 0.004 * np.cos(1.7 * i), top + RADIUS + 0.0005 - depth)


def surface(model, data):
    shell = model.flex_shell[:3 * model.flex_shellnum[0]].reshape(-1, 3)
    used, corners = np.unique(shell, return_inverse=True)
    return data.flexvert_xpos[used].copy(), corners.reshape(-1, 3)


def make_block(vertices, corners):
    height = vertices[:, 2]
    return dp.Mesh.compile(vertices, corners, unit="m", springs={
        "kind": "volume", "spacing": 0.018, "young": 5000.0, "density": 875.0, "drag": 1.0, "viscosity": 0.002,
        "fixed": np.flatnonzero(height < height.min() + 1e-6)})


def make_batch(mesh, count, threads):
    world = dp.batch.World(count, threads=threads, read=("proxy", "force", "hit", "loads"))
    block = world.add_deformable(mesh, springs={"integrator": "implicit"}, load_radius=0.02)
    return world, block, world.add_tool([0, 0, -HALF], [0, 0, HALF], RADIUS)


def run_batch(mesh, top, count, ticks, threads):
    world, block, tool = make_batch(mesh, count, threads)
    tool.pose[:, 3:] = LYING
    watch = Watch()
    for tick in range(ticks):
        tool.pose[:, :3] = [place(i, tick, top) for i in range(count)]
        with watch:
            world.step(DT)
    return *watch.rates(count * ticks), tool.wrench.copy()


def run_singles(mesh, top, count, ticks):
    made = []
    for _ in range(count):
        world = dp.World()
        body = world.add_deformable(mesh, load_radius=0.02)
        springs, tool = dp.Springs(mesh, integrator="implicit"), world.add_tool([0, 0, -HALF], [0, 0, HALF], RADIUS)
        made.append((world, body, springs, tool))
    watch, wrenches = Watch(), []
    for tick in range(ticks):
        poses = [np.array([*place(i, tick, top), *LYING]) for i in range(count)]
        wrenches = []
        with watch:
            for (world, body, springs, tool), pose in zip(made, poses):
                tool.set_pose(pose)
                world.step(DT)
                body.step(springs, DT)
                wrenches.append((tool.wrench, tool.proxy, tool.force, tool.hit, tool.loads, body.loads)[0])
    return *watch.rates(count * ticks), np.array(wrenches)


def run_contact(mesh, top, count, ticks, threads):
    """Contact and force alone: somebody else's vertices come in with each tick."""
    world = dp.batch.World(count, threads=threads, read=("proxy", "force", "hit", "loads"))
    block = world.add_deformable(mesh)
    tool = world.add_tool([0, 0, -HALF], [0, 0, HALF], RADIUS)
    tool.pose[:, 3:] = LYING
    still, watch = np.repeat(mesh.vertices[None], count, 0), Watch()
    for tick in range(ticks):
        tool.pose[:, :3] = [place(i, tick, top) for i in range(count)]
        moved = still * np.float32(1 + 0.002 * np.sin(0.1 * tick))
        with watch:
            block.vertices = moved
            world.step(DT)
    return *watch.rates(count * ticks), None


def run_mujoco_contact(model, start, top, count, ticks, threads):
    """Its contact alone: mj_flex and mj_collision."""
    return run_mujoco(model, start, top, count, ticks, threads, lambda model, data: (mujoco.mj_flex(model, data),
                                                                              mujoco.mj_collision(model, data)))


def start_mujoco(model, start):
    data = mujoco.MjData(model)
    data.qpos[:], data.mocap_quat[0] = start, LYING
    mujoco.mj_kinematics(model, data)
    return data


def run_mujoco(model, start, top, count, ticks, threads, step=mujoco.mj_step):
    datas = [start_mujoco(model, start) for _ in range(count)]
    watch = Watch()

    def some(part):
        for data in datas[part::threads]:
            step(model, data)

    with ThreadPoolExecutor(threads) as pool:
        for tick in range(ticks):
            for i, data in enumerate(datas):
                data.mocap_pos[0] = place(i, tick, top)
                mujoco.mj_kinematics(model, data)
            with watch:
                list(pool.map(some, range(threads)))
    return *watch.rates(count * ticks), None


def judge_ours(mesh, top, ticks):
    """Errors of the gap in ticks whose axis is outside, and inside: the device's pose, the block as the step found it."""
    world, block, tool = make_batch(mesh, 4, 1)
    tool.pose[:, 3:] = LYING
    errors = [], []
    for tick in range(ticks):
        tool.pose[:, :3] = [place(i, tick, top) for i in range(4)]
        before = block.vertices.astype(float)
        world.step(DT)
        for i in range(4 if tick % 5 == 0 else 0):
            at = tool.pose[i, :3]
            truth, is_through = gap_of(at - [HALF, 0, 0], at + [HALF, 0, 0], before[i][mesh.triangles.astype(int)])
            errors[is_through].append(abs(tool.hit["distance"][i] - RADIUS - truth))
    return errors, np.abs(tool.wrench[:, :3] + block.loads.sum(1)).max()


def judge_mujoco(model, start, top, ticks):
    """The same of its least contact distance, where it has one."""
    data, errors = start_mujoco(model, start), ([], [])
    shell = model.flex_shell[:3 * model.flex_shellnum[0]].reshape(-1, 3)
    tool = model.geom("tool").id
    for tick in range(ticks):
        data.mocap_pos[0] = at = np.array(place(0, tick, top))
        mujoco.mj_step1(model, data)
        if tick % 2 == 0:
            found = min((c.dist for c in data.contact if tool in c.geom and 0 in c.flex), default=np.nan)
            truth, is_through = gap_of(at - [HALF, 0, 0], at + [HALF, 0, 0], data.flexvert_xpos[shell])
            errors[is_through].append(abs(found - truth))
        mujoco.mj_step2(model, data)
    return errors


def tell(who, errors):
    for where, some in zip(("outside", "inside"), errors):
        known = np.array(some)[~np.isnan(some)]
        print(f"  {who}, axis {where}: {len(some)} ticks, {len(some) - len(known)} without an answer"
              + (f", error of the gap {np.median(known):.1e} m, at most {known.max():.1e}" if len(known) else ""))


def main():
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 1000
    ticks = int(sys.argv[2]) if len(sys.argv) > 2 else 60
    rounds = int(sys.argv[3]) if len(sys.argv) > 3 else 1
    model = load(SIDE)
    model.opt.timestep = DT
    model.geom_margin[:] = 0.002
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    for _ in range(1500):  # it falls onto the floor
        mujoco.mj_step(model, data)
    vertices, corners = surface(model, data)
    start = data.qpos.copy()
    top, mesh = float(vertices[:, 2].max()), make_block(vertices, corners)
    print(f"{len(mesh)} triangles, {len(mesh.vertices)} vertices, {int(mesh.info.spring_nodes)} nodes here; {count} "
          f"environments; {model.nflexvert} vertices, {model.nflexelem} tetrahedra in MuJoCo {mujoco.__version__}")
    few = max(1, count // 50)
    runs = {"one by one": lambda: run_singles(mesh, top, count, ticks)}
    for name, run in {
            "batch.World": lambda n: run_batch(mesh, top, count, ticks, n),
            "contact and force alone": lambda n: run_contact(mesh, top, count, ticks, n),
            "MuJoCo's step": lambda n: run_mujoco(model, start, top, few, ticks, n),
            "MuJoCo's contact alone": lambda n: run_mujoco_contact(model, start, top, few, ticks, n)}.items():
        runs[f"{name}, 1 thread"], runs[f"{name}, 2 threads"] = partial(run, 1), partial(run, 2)
    tries = {name: [] for name in runs}
    for _ in range(rounds):
        for name, run in runs.items():
            tries[name].append(run())
            gc.collect()
    alone, bits = max(one[0] for one in tries["one by one"]), tries["one by one"][0][3].tobytes()
    print("| | ticks a second | of one by one | us of processors a tick | processors that others took |\n|---|---|---|---|---|")
    for name, some in tries.items():
        rate, _, others, wrench = max(some, key=lambda one: one[0])
        cost = min(one[1] for one in some)
        same = "" if wrench is None else "; the same bits" if wrench.tobytes() == bits else "; OTHER BITS"
        print(f"| {name}{same} | {rate:,.0f} | {rate / alone:.2f} | {cost:,.1f} | {others:.2f} |", flush=True)
    errors, rest = judge_ours(mesh, top, 300)
    tell("here", errors)
    tell("MuJoCo", judge_mujoco(model, start, top, 300))
    print(f"  tool and tissue leave {rest:.1e} N")


if __name__ == "__main__":
    main()
