# SPDX-License-Identifier: BSD-3-Clause
"""Many environments with a soft block and a tool each: dynpoint.batch.World beside single worlds, and beside MuJoCo's own
contact on the same scene. PYTHONPATH names the package, MuJoCo is of build/venv-python or build/venv-soft:

    python_batch.py [ENVIRONMENTS [TICKS]]

The block is MuJoCo's flex of 6 vertices a side, 70 mm; here it is masses and springs, of the same surface. The tool, a
capsule of 100 mm, comes down onto it, and slides. Errors are those of the gap against brute force, each at its own
positions. Ticks a second are those of one environment times environments, the best of three; physics, contact and what
is read are within.
"""
import sys
import time
from concurrent.futures import ThreadPoolExecutor

import mujoco
import numpy as np

import dynpoint as dp
import dynpoint.batch
from peer_mujoco import HALF, RADIUS, gap_of, load

SIDE, DT, BOTTOM = 6, 0.001, 0.0101
LYING = (0.5 ** 0.5, 0.0, 0.5 ** 0.5, 0.0)  # the axis along x


def place(i, tick, top):
    """Environment i's tool: down to 3 mm of depth within 100 ticks, then to and fro."""
    depth = 0.003 * min(1.0, tick / 100) * (0.5 + 0.5 * ((7 * i) % 11) / 10)
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
    steps = 0.0
    for tick in range(ticks):
        tool.pose[:, :3] = [place(i, tick, top) for i in range(count)]
        begin = time.perf_counter()
        world.step(DT)
        steps += time.perf_counter() - begin
    return count * ticks / steps, tool.wrench.copy()


def run_singles(mesh, top, count, ticks):
    made = []
    for _ in range(count):
        world = dp.World()
        body = world.add_deformable(mesh, load_radius=0.02)
        springs, tool = dp.Springs(mesh, integrator="implicit"), world.add_tool([0, 0, -HALF], [0, 0, HALF], RADIUS)
        made.append((world, body, springs, tool))
    steps, wrenches = 0.0, []
    for tick in range(ticks):
        poses = [np.array([*place(i, tick, top), *LYING]) for i in range(count)]
        begin = time.perf_counter()
        wrenches = []
        for (world, body, springs, tool), pose in zip(made, poses):
            tool.set_pose(pose)
            world.step(DT)
            body.step(springs, DT)
            wrenches.append((tool.wrench, tool.proxy, tool.force, tool.hit, tool.loads, body.loads)[0])
        steps += time.perf_counter() - begin
    return count * ticks / steps, np.array(wrenches)


def run_contact(mesh, top, count, ticks, threads):
    """Contact and force alone: somebody else's vertices come in with each tick."""
    world = dp.batch.World(count, threads=threads, read=("proxy", "force", "hit", "loads"))
    block = world.add_deformable(mesh)
    tool = world.add_tool([0, 0, -HALF], [0, 0, HALF], RADIUS)
    tool.pose[:, 3:] = LYING
    still, steps = np.repeat(mesh.vertices[None], count, 0), 0.0
    for tick in range(ticks):
        tool.pose[:, :3] = [place(i, tick, top) for i in range(count)]
        moved = still * np.float32(1 + 0.002 * np.sin(0.1 * tick))
        begin = time.perf_counter()
        block.vertices = moved
        world.step(DT)
        steps += time.perf_counter() - begin
    return count * ticks / steps


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
    steps = 0.0

    def some(part):
        for data in datas[part::threads]:
            step(model, data)

    with ThreadPoolExecutor(threads) as pool:
        for tick in range(ticks):
            for i, data in enumerate(datas):
                data.mocap_pos[0] = place(i, tick, top)
                mujoco.mj_kinematics(model, data)
            begin = time.perf_counter()
            list(pool.map(some, range(threads)))
            steps += time.perf_counter() - begin
    return count * ticks / steps


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
    rows, few = {}, count // 10
    for _ in range(3):
        for name, run in (("one by one", lambda: run_singles(mesh, top, count, ticks)),
                          ("batch, 1 thread", lambda: run_batch(mesh, top, count, ticks, 1)),
                          ("batch, 2 threads", lambda: run_batch(mesh, top, count, ticks, 2)),
                          ("contact, 1 thread", lambda: (run_contact(mesh, top, count, ticks, 1), None)),
                          ("contact, 2 threads", lambda: (run_contact(mesh, top, count, ticks, 2), None)),
                          ("MuJoCo, 1 thread", lambda: (run_mujoco(model, start, top, few, ticks, 1), None)),
                          ("MuJoCo, 2 threads", lambda: (run_mujoco(model, start, top, few, ticks, 2), None)),
                          ("its contact, 1", lambda: (run_mujoco_contact(model, start, top, few, ticks, 1), None)),
                          ("its contact, 2", lambda: (run_mujoco_contact(model, start, top, few, ticks, 2), None))):
            rate, wrench = run()
            rows[name] = max(rate, rows.get(name, (0, None))[0]), wrench
    alone = rows["one by one"]
    for name, (rate, wrench) in rows.items():
        same = "" if wrench is None else ", the same bits" if wrench.tobytes() == alone[1].tobytes() else ", OTHER BITS"
        print(f"  {name:18} {rate:9.0f} ticks a second, {rate / alone[0]:5.2f} of one by one{same}")
    errors, rest = judge_ours(mesh, top, 300)
    tell("here", errors)
    tell("MuJoCo", judge_mujoco(model, start, top, 300))
    print(f"  tool and tissue leave {rest:.1e} N")


if __name__ == "__main__":
    main()
