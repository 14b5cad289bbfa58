# SPDX-License-Identifier: BSD-3-Clause
"""A soft body of MuJoCo's (flex) falls on a floor, and a tool goes along it and through it: how far away, or how deep,
is it? dynpoint's answer and MuJoCo's own contacts against brute force, on the same positions:

    peer_mujoco.py BUILD [FILE.csv]

Ticks are of three kinds. `apart`: the tool touches nothing. `touch`: its surface penetrates, its axis does not.
`through`: its axis is inside somewhere. MuJoCo gives the distance of each tetrahedron within a margin; its answer is
the least. Its positions are double, dynpoint's and those of brute force are float: that is 4e-9 m. Times are medians,
called from Python: vertices, pose and step here, mj_flex and mj_collision there, with the margin that distances need,
and without one, which finds what touches alone.
"""
import sys
import time
from ctypes import (CDLL, Structure, byref, c_double, c_size_t, c_uint32, c_uint64, c_void_p, sizeof)


def skip(why):
    print(f"  skip MuJoCo's soft bodies: {why}\n0 passed, 0 failed, 1 skipped")
    sys.exit(0)


try:
    import mujoco
    import numpy as np
except ImportError as error:
    skip(f"{error}; make deps soft installs it")
if not hasattr(mujoco, "mj_flex"):
    skip(f"version {mujoco.__version__} has none; make deps soft installs one that has")

RADIUS, HALF, MARGIN, SPACING = 0.002, 0.05, 0.02, 0.07
SCENE = """<mujoco>
  <option timestep="0.0005" integrator="{integrator}"/>
  <size memory="200M"/>
  <worldbody>
    <flexcomp name="organ" type="grid" dim="3" count="{count} {count} {count}" spacing="{spacing} {spacing} {spacing}"
              radius="0" mass="0.3" pos="0 0 0.06">
      <contact selfcollide="none"/>
      <elasticity young="5000" poisson="0.2" damping="0.01"/>
    </flexcomp>
    <geom type="plane" size="1 1 .1" pos="0 0 0.01"/>
    <body name="tool" mocap="true"><geom name="tool" type="capsule" size="{radius} {half}" margin="{margin}"/></body>
  </worldbody>
</mujoco>"""
verdicts = []


def check(what, is_so):
    print("  ok  " if is_so else "  FAIL", what)
    verdicts.append(bool(is_so))


# ---- brute force: the signed distance of a capsule and a closed surface, by all triangles

def to_edges(p, a, b):
    """Distances of points p and segments ab, of any shapes that broadcast."""
    ab = b - a
    t = np.clip(((p - a) * ab).sum(-1) / (ab * ab).sum(-1), 0, 1)
    return np.linalg.norm(p - a - t[..., None] * ab, axis=-1)


def to_triangles(p, t):
    """Distances of points p (n x 1 x 3) and triangles t (m x 3 x 3)."""
    normal = np.cross(t[:, 1] - t[:, 0], t[:, 2] - t[:, 0])
    normal /= np.linalg.norm(normal, axis=-1)[:, None]
    inside = np.ones(p.shape[:1] + t.shape[:1], bool)
    distance = np.full(inside.shape, np.inf)
    for k in range(3):
        a, b = t[:, k], t[:, (k + 1) % 3]
        inside &= (np.cross(normal, b - a) * (p - a)).sum(-1) >= 0
        distance = np.minimum(distance, to_edges(p, a, b))
    return np.where(inside, abs(((p - t[:, 0]) * normal).sum(-1)), distance)


def to_segments(a, b, c, d):
    """Distances of one segment ab and segments cd: from the ends, and of the lines where these are nearest within."""
    u, v, w = b - a, d - c, a - c
    uu, uv, vv, uw, vw = u @ u, v @ u, (v * v).sum(-1), w @ u, (v * w).sum(-1)
    det = np.maximum(uu * vv - uv * uv, 1e-9 * uu * vv)  # of parallel ones the ends are as near
    s, t = (uv * vw - vv * uw) / det, (uu * vw - uv * uw) / det
    lines = np.linalg.norm(w + s[:, None] * u - t[:, None] * v, axis=-1)
    lines[(s < 0) | (s > 1) | (t < 0) | (t > 1)] = np.inf
    return np.minimum.reduce([lines, to_edges(a, c, d), to_edges(b, c, d), to_edges(c, a, b), to_edges(d, a, b)])


def crossings(a, b, t):
    """Where the segment ab goes through triangles, in 0..1 of it."""
    normal = np.cross(t[:, 1] - t[:, 0], t[:, 2] - t[:, 0])
    height_a, height_b = (((p - t[:, 0]) * normal).sum(-1) for p in (a, b))
    t, height_a, height_b = (x[height_a * height_b < 0] for x in (t, height_a, height_b))
    sides = [(np.cross(t[:, k] - a, t[:, (k + 1) % 3] - a) * (b - a)).sum(-1) for k in range(3)]
    through = np.all([side >= 0 for side in sides], axis=0) | np.all([side <= 0 for side in sides], axis=0)
    return np.sort((height_a / (height_a - height_b))[through])


def is_inside(p, t):
    """By the solid angles of all triangles."""
    a, b, c = (t[:, k] - p for k in range(3))
    x, y, z = (np.linalg.norm(v, axis=-1) for v in (a, b, c))
    top = (a * np.cross(b, c)).sum(-1)
    below = x * y * z + (a * b).sum(-1) * z + (b * c).sum(-1) * x + (c * a).sum(-1) * y
    return np.arctan2(top, below).sum() > np.pi


def deepest(a, b, t, low, high):
    """How deep the axis is between low and high, where it is inside: at 61 points, then between the best, thrice."""
    for _ in range(4):
        s, step = np.linspace(low, high, 61, retstep=True)
        depth = to_triangles(a + s[:, None, None] * (b - a), t).min(-1)
        best = s[depth.argmax()]
        low, high = max(low, best - step), min(high, best + step)
    return depth.max()


def gap_of(a, b, t):
    """The gap of the tool's surface, and whether its axis is inside somewhere."""
    ends = [0, *crossings(a, b, t), 1]
    inside = [(low, high) for low, high in zip(ends, ends[1:])
              if low < high and is_inside(a + (low + high) / 2 * (b - a), t)]
    if inside:
        return -max(deepest(a, b, t, low, high) for low, high in inside) - RADIUS, True
    tips = to_triangles(np.array([[a], [b]]), t).min()
    return min(tips, *(to_segments(a, b, t[:, k], t[:, (k + 1) % 3]).min() for k in range(3))) - RADIUS, False


# ---- dynpoint, by ctypes

def struct(name, *fields):
    return type(name, (Structure,), {"_fields_": [(field, kind) for kind, names in fields for field in names.split()]})


double3, double4 = c_double * 3, c_double * 4
Compiled = struct("dpt_compiled", (c_void_p, "bytes"), (c_size_t, "size"))
Pose = struct("dpt_pose", (double3, "position"), (double4, "orientation"))
Segment = struct("dpt_segment", (double3, "a b"), (c_double, "radius"))
Hit = struct("dpt_hit", (c_uint32, "size status contact flags triangle segment body work"),
             (c_double, "distance gap depth s"), (double3, "p q"), (c_double, "error_bound lower_bound"))
WorldDef = struct("dpt_world_def", (c_uint32, "size max_bodies max_tools max_segments method kernel until budget"),
                  (c_double, "stiffness"), (c_uint64, "certificate_bytes"), (c_double, "margin side_limit fade"),
                  (c_uint32, "max_contacts smooth_normals strip strip_capacity strip_search law"),
                  (c_double, "strip_width strip_depth"), (c_void_p, "baseline reserved_pointer"), (c_double, "onset"),
                  (c_uint32, "sweep_budget reserved"))
DeformDef = struct("dpt_deformable_def", (c_uint32, "size max_points"), (c_void_p, "mesh pose"),
                   (double3, "box_min box_max"), (c_double, "period load_radius"), (c_uint32, "response passes"),
                   (c_double, "compliance"), (c_void_p, "compliances reserved_pointer"))


def address(numbers):
    return c_void_p(numbers.ctypes.data)


class Contact:
    tool_shape = Segment(double3(0, 0, -HALF), double3(0, 0, HALF), RADIUS)

    def define(self, world_def, body_def):
        world_def.until = 2  # DPT_UNTIL_CONTACT

    def __init__(self, build, vertices, corners):
        self.core, compiler = CDLL(build + "/libdynpoint.so"), CDLL(build + "/libdynpoint_compile.so")
        core = self.core
        core.dpt_world_bytes.restype = core.dpt_deformable_bytes.restype = c_size_t
        file, mesh, xyz, count = Compiled(), c_void_p(), c_void_p(), c_uint32()
        used, corners = np.unique(corners, return_inverse=True)  # those of the surface alone
        places, corners = vertices[used].astype("f4"), corners.astype("u4").copy()
        doubles = places.astype("f8")
        self.must(compiler.dpt_compile_arrays(address(doubles), c_size_t(len(used)), address(corners),
                                              c_size_t(corners.size // 3), None, byref(file), None))
        self.must(core.dpt_mesh_open(c_void_p(file.bytes), c_size_t(file.size), byref(mesh)))
        self.must(core.dpt_mesh_get_vertices(mesh, byref(xyz), byref(count)))
        numbered = np.frombuffer((c_uint32 * (3 * count.value)).from_address(xyz.value), "f4").reshape(-1, 3)
        which = {place.tobytes(): i for place, i in zip(places, used)}
        self.order = np.array([which[place.tobytes()] for place in numbered])
        world_def, body_def, self.file = WorldDef(), DeformDef(), file
        core.dpt_world_def_defaults(byref(world_def), c_size_t(sizeof(world_def)))
        core.dpt_deformable_def_defaults(byref(body_def), c_size_t(sizeof(body_def)))
        body_def.mesh = mesh
        self.define(world_def, body_def)
        sizes = core.dpt_world_bytes(byref(world_def)), core.dpt_deformable_bytes(byref(body_def))
        self.blocks = [(c_double * (size // 8 + 1))() for size in sizes]
        self.world, self.body, self.tool, self.hit = c_void_p(), c_uint32(), c_uint32(), Hit(size=sizeof(Hit))
        self.must(core.dpt_world_create(self.blocks[0], c_size_t(sizes[0]), byref(world_def), byref(self.world)))
        self.must(core.dpt_body_add_deformable(self.world, self.blocks[1], c_size_t(sizes[1]), byref(body_def),
                                      byref(self.body)))
        self.must(core.dpt_tool_add(self.world, byref(self.tool_shape), 1, byref(self.tool)))

    @staticmethod
    def must(result):
        if result:
            sys.exit(f"dynpoint: result {result}")

    def tick(self, vertices, position, orientation):
        positions, pose = vertices[self.order].astype("f4"), Pose(double3(*position), double4(*orientation))
        begin = time.perf_counter()
        self.must(self.core.dpt_body_set_vertices(self.world, self.body, 0, c_uint32(len(positions)),
                                                    address(positions), c_double(-1)))
        self.must(self.core.dpt_tool_set_pose(self.world, self.tool, byref(pose)))
        self.must(self.core.dpt_world_step(self.world, c_double(0.001), None))
        took = time.perf_counter() - begin
        self.must(self.core.dpt_tool_get_hit(self.world, self.tool, byref(self.hit)))
        return self.hit.gap, took


# ---- MuJoCo

def load(count):
    # Soft bodies are integrated implicitly by `discrete` from version 4 on, by `implicitfast` before.
    for integrator in ("discrete", "implicitfast"):
        scene = SCENE.format(integrator=integrator, count=count, spacing=SPACING / (count - 1), radius=RADIUS,
                             half=HALF, margin=MARGIN)
        try:
            return mujoco.MjModel.from_xml_string(scene)
        except ValueError as error:
            refused = error
    skip(f"version {mujoco.__version__} says: {str(refused).splitlines()[0]}")


def own_contact(model, data):
    """The least distance of the tool and any element, NaN where none is within the margin; the time."""
    mujoco.mj_kinematics(model, data)
    begin = time.perf_counter()
    mujoco.mj_flex(model, data)
    mujoco.mj_collision(model, data)
    took = time.perf_counter() - begin
    tool = model.geom("tool").id
    return min((c.dist for c in data.contact if tool in c.geom and 0 in c.flex), default=np.nan), took


def motion(i, ticks, top):
    """Over the top face, from 10 mm above it to 8 mm deep, lying, leaning, and upright in the end."""
    t = i / ticks
    depth = 0.001 - 0.009 * np.sin(6 * np.pi * t)
    lean = np.pi / 2 * (1 - max(0, 3 * t - 2)) + 0.2 * np.sin(40 * t)
    axis = np.array([np.sin(lean) * np.cos(9 * t), np.sin(lean) * np.sin(9 * t), np.cos(lean)])
    low = HALF * abs(axis[2])
    position = np.array([0.012 * np.sin(13 * t), 0.012 * np.cos(11 * t), top + low - depth + RADIUS])
    turn = np.array([1 + axis[2], -axis[1], axis[0], 0])
    return position, turn / np.linalg.norm(turn), axis


def compare(build, count, ticks, rows):
    # Physics, in which the tool is in nobody's way; MuJoCo's contact with a margin, and without.
    free, wide, narrow = load(count), load(count), load(count)
    tool = free.geom("tool").id
    free.geom_contype[tool] = free.geom_conaffinity[tool] = narrow.geom_margin[tool] = 0
    physics, pairs = mujoco.MjData(free), [(model, mujoco.MjData(model)) for model in (wide, narrow)]
    mujoco.mj_forward(free, physics)
    shell = free.flex_shell[:3 * free.flex_shellnum[0]].reshape(-1, 3)
    ours = Contact(build, physics.flexvert_xpos, shell)
    seen = {kind: [] for kind in ("apart", "touch", "through")}
    for i in range(ticks):
        mujoco.mj_step(free, physics)
        position, orientation, axis = motion(i, ticks, physics.flexvert_xpos[:, 2].max())
        answers = []
        for model, data in pairs:
            data.qpos[:], data.mocap_pos[0], data.mocap_quat[0] = physics.qpos, position, orientation
            answers.append(own_contact(model, data))
        vertices = pairs[0][1].flexvert_xpos  # a step ahead of those of `physics`
        gap, took = ours.tick(vertices, position, orientation)
        truth, is_through = gap_of(position - HALF * axis, position + HALF * axis,
                                   vertices.astype("f4").astype("f8")[shell])
        kind = "through" if is_through else "touch" if truth < 0 else "apart"
        seen[kind].append((abs(gap - truth), abs(answers[0][0] - truth), took, answers[0][1], answers[1][1]))
    print(f"  {len(ours.order)} vertices, {len(shell)} triangles, {free.nflexelem} tetrahedra")
    print("            ticks  dynpoint: error, largest      time   MuJoCo: error, largest      time, without margin")
    for kind in seen:
        seen[kind] = np.array(seen[kind])
        middle, worst = np.nanmedian(seen[kind], axis=0), np.nanmax(seen[kind], axis=0)
        unknown = int(np.isnan(seen[kind][:, 1]).sum())
        print(f"    {kind:8}{len(seen[kind]):5} {middle[0]:13.1e} m {worst[0]:8.1e} m {1e6 * middle[2]:6.0f} us"
              f" {middle[1]:11.1e} m {worst[1]:8.1e} m {1e6 * middle[3]:6.0f} us {1e6 * middle[4]:6.0f} us"
              + (f", {unknown} beyond its margin" if unknown else ""))
        rows.append((len(shell), kind, len(seen[kind]), middle[0], worst[0], middle[1], worst[1], *middle[2:]))
    apart, touch, through = (np.nanmax(ticks, axis=0) for ticks in seen.values())
    check(f"{len(shell)} triangles: while the axis is outside, dynpoint's gap is that of brute force within 1e-12 m",
          max(apart[0], touch[0]) < 1e-12)
    check("its depth within 1e-5 of the diagonal, and 2 um of the brute force", through[0] < 1e-5 * 0.122 + 2e-6)
    check("apart, MuJoCo's distance is the same within 5 um", apart[1] < 5e-6)


def main():
    build, file = sys.argv[1], sys.argv[2] if len(sys.argv) > 2 else None
    rows = []
    print(f"  MuJoCo {mujoco.__version__}")
    for count, ticks in ((8, 160), (10, 80)):
        compare(build, count, ticks, rows)
    if file:
        with open(file, "w", encoding="ascii") as table:
            print("triangles,kind,ticks,error_median,error_max,mujoco_error_median,mujoco_error_max,"
                  "time,mujoco_time,mujoco_time_without_margin", file=table)
            for row in rows:
                print(*row[:3], *(f"{number:.3g}" for number in row[3:]), sep=",", file=table)
    print(f"{sum(verdicts)} passed, {len(verdicts) - sum(verdicts)} failed, 0 skipped")
    sys.exit(not all(verdicts))


if __name__ == "__main__":
    main()
