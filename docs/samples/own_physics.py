# SPDX-License-Identifier: BSD-3-Clause
"""Your physics, our contact, by Python's standard library alone: a needle is held still, and a heart beats against it.

    python3 docs/samples/own_physics.py build      # or another folder of libdynpoint.so and libdynpoint_compile.so

Physics makes a step every ten ticks, gets the mean of the needle's loads, and tells how far a newton moves a vertex in a
step. With SOFA, MuJoCo or Newton, `step` is theirs.
"""
import sys
from array import array
from ctypes import (CDLL, POINTER, Structure, byref, c_char_p, c_double, c_float, c_size_t, c_uint32, c_uint64,
                    c_void_p, sizeof)
from math import cos, exp, pi, sin

if len(sys.argv) != 2:
    sys.exit("usage: python3 own_physics.py BUILD, the folder of libdynpoint.so and libdynpoint_compile.so")
core = CDLL(sys.argv[1] + "/libdynpoint.so")
compiler = CDLL(sys.argv[1] + "/libdynpoint_compile.so")
core.dpt_world_bytes.restype = core.dpt_deformable_bytes.restype = c_size_t
core.dpt_result_text.restype = c_char_p


def must(result):
    if result:
        sys.exit(core.dpt_result_text(result).decode())


def struct(name, *fields):  # as in the headers, in the same order
    return type(name, (Structure,), {"_fields_": [(field, kind) for kind, names in fields for field in names.split()]})


double3, double4, float_p = c_double * 3, c_double * 4, POINTER(c_float)
Compiled = struct("dpt_compiled", (c_void_p, "bytes"), (c_size_t, "size"))
Pose = struct("dpt_pose", (double3, "position"), (double4, "orientation"))
Segment = struct("dpt_segment", (double3, "a b"), (c_double, "radius"))
Wrench = struct("dpt_wrench", (double3, "force torque"))
Load = struct("dpt_load", (c_uint32, "vertex reserved"), (double3, "force"))
WorldDef = struct("dpt_world_def", (c_uint32, "size max_bodies max_tools max_segments method kernel until budget"),
                  (c_double, "stiffness"), (c_uint64, "certificate_bytes"), (c_double, "margin side_limit fade"),
                  (c_uint32, "max_contacts smooth_normals strip strip_capacity strip_search law"),
                  (c_double, "strip_width strip_depth"), (c_void_p, "baseline reserved_pointer"), (c_double, "onset"),
                  (c_uint32, "sweep_budget reserved"))
DeformDef = struct("dpt_deformable_def", (c_uint32, "size max_points"), (c_void_p, "mesh pose"),
                   (double3, "box_min box_max"), (c_double, "period load_radius"), (c_uint32, "response passes"),
                   (c_double, "compliance"), (c_void_p, "compliances reserved_pointer"))
ForceReport = struct("dpt_force_info", (c_uint32, "size reason flags law"), (Wrench, "wrench"),
                     (c_double, "energy lag"), (c_uint64, "folds"), (c_uint32, "sticking slipping"),
                     (c_double, "body_work"))

# Your organ, in your order: here an egg of 40 mm, of rings around the z axis and two poles.
RINGS, SECTORS, SIZE = 15, 24, (0.04, 0.04, 0.05)
angles = [(pi * (i + 1) / (RINGS + 1), 2 * pi * j / SECTORS) for i in range(RINGS) for j in range(SECTORS)]
rest = [(sin(a) * cos(b), sin(a) * sin(b), cos(a)) for a, b in angles] + [(0, 0, 1), (0, 0, -1)]
rest = [tuple(x * size for x, size in zip(place, SIZE)) for place in rest]
north, south = RINGS * SECTORS, RINGS * SECTORS + 1
triangles = []
for j in range(SECTORS):
    k = (j + 1) % SECTORS
    triangles += [(north, j, k), (south, (RINGS - 1) * SECTORS + k, (RINGS - 1) * SECTORS + j)]
    for ring in range(0, (RINGS - 1) * SECTORS, SECTORS):
        triangles += [(ring + j, ring + SECTORS + j, ring + SECTORS + k), (ring + j, ring + SECTORS + k, ring + k)]

# Your physics: a spring draws each vertex to its place in the beating heart, x' = (place - x) / TAU + force / DRAG.
PERIOD, BEAT, TAU, DRAG = 0.01, 0.05, 0.03, 6.0
PART = 1 - exp(-PERIOD / TAU)  # of its way goes a vertex in a step
now = list(rest)


def step(time, forces):
    growth = 1 + BEAT * sin(2 * pi * time)
    for v, place in enumerate(rest):
        force = forces.get(v, (0, 0, 0))
        now[v] = tuple(x + PART * (growth * p + TAU / DRAG * f - x) for x, p, f in zip(now[v], place, force))


# A mesh of it. The library numbers vertices anew; which is which is told by where they are, in float as it keeps them.
vertices, corners = array("d", sum(rest, ())), array("I", sum(triangles, ()))
file, mesh, xyz, count = Compiled(), c_void_p(), float_p(), c_uint32()
must(compiler.dpt_compile_arrays(c_void_p(vertices.buffer_info()[0]), c_size_t(len(rest)),
                                 c_void_p(corners.buffer_info()[0]), c_size_t(len(triangles)), None, byref(file), None))
must(core.dpt_mesh_open(c_void_p(file.bytes), c_size_t(file.size), byref(mesh)))
must(core.dpt_mesh_get_vertices(mesh, byref(xyz), byref(count)))
mine = {tuple(array("f", place)): v for v, place in enumerate(rest)}
order = [mine[tuple(xyz[3 * i:3 * i + 3])] for i in range(count.value)]  # vertex i of the library is yours of order[i]


def new_block(size):  # doubles, so that it is aligned to 8
    return (c_double * (size // 8 + 1))()


world_def, body_def, world, body, tool = WorldDef(), DeformDef(), c_void_p(), c_uint32(), c_uint32()
core.dpt_world_def_defaults(byref(world_def), c_size_t(sizeof(world_def)))
world_size = core.dpt_world_bytes(byref(world_def))
world_block = new_block(world_size)
must(core.dpt_world_create(world_block, c_size_t(world_size), byref(world_def), byref(world)))
core.dpt_deformable_def_defaults(byref(body_def), c_size_t(sizeof(body_def)))
body_def.mesh, body_def.period, body_def.load_radius = mesh, PERIOD, 0.01
body_def.compliance = PART * TAU / DRAG  # m/N
body_size = core.dpt_deformable_bytes(byref(body_def))
body_block = new_block(body_size)
must(core.dpt_body_add_deformable(world, body_block, c_size_t(body_size), byref(body_def), byref(body)))
needle = Segment(double3(0, 0, 0), double3(0, 0, 0.15), 0.001)
must(core.dpt_tool_add(world, byref(needle), 1, byref(tool)))

pose, proxy, report, loads = Pose(double3(0, 0, 0), double4(1, 0, 0, 0)), Pose(), ForceReport(), (Load * 4096)()
report.size = sizeof(report)
load_count, seconds, felt, worst = c_uint32(), c_double(), [], 0.0
for tick in range(3000):
    if tick % 10 == 0:
        must(core.dpt_body_get_mean_loads(world, body, loads, c_uint32(len(loads)), byref(load_count), byref(seconds)))
        must(core.dpt_body_set_answered_loads(world, body, loads, load_count))
        forces = {}
        for load in loads[:load_count.value]:
            forces[order[load.vertex]] = [a + b for a, b in zip(forces.get(order[load.vertex], (0, 0, 0)), load.force)]
        step(0.001 * tick, forces)
        positions = array("f", (x for v in order for x in now[v]))  # of numpy: now[order].astype("f")
        must(core.dpt_body_set_vertices(world, body, 0, c_uint32(len(order)), c_void_p(positions.buffer_info()[0]),
                                          c_double(-1)))
    pose.position[2] = SIZE[2] - 0.001 + 0.01 * max(0.0, 1 - 0.002 * tick)  # down for half a second, then 2 mm deep
    must(core.dpt_tool_set_pose(world, tool, byref(pose)))
    must(core.dpt_world_step(world, c_double(0.001), None))
    must(core.dpt_body_step_springs(world, body, None, c_double(0.001), None))
    must(core.dpt_tool_get_force_info(world, tool, byref(report)))
    must(core.dpt_tool_get_proxy(world, tool, byref(proxy)))
    must(core.dpt_body_get_loads(world, body, loads, c_uint32(len(loads)), byref(load_count)))
    force = report.wrench.force
    felt.append(force[2])
    left = [force[k] + sum(load.force[k] for load in loads[:load_count.value]) for k in range(3)]
    worst = max(worst, max(map(abs, left)))
    if report.reason > 1 or report.flags & 8:  # neither DPT_FORCE_ACTS nor _FREE; DPT_FORCE_FLAG_SQUEEZED
        sys.exit("the needle has lost the surface")
    if tick % 100 == 0:
        depth = 1000 * (proxy.position[2] - pose.position[2])
        print(f"{tick / 1000:3.1f} s  depth {depth:7.4f} mm  force {force[2]:7.4f} N")

compiler.dpt_compiled_free(byref(file))
second, third = felt[1000:2000], felt[2000:]
is_beating = max(second) > 0.5 and min(second) == 0 and max(map(abs, map(float.__sub__, second, third))) < 0.01
print(f"loads and force leave {worst:.1g} N; it beats:", is_beating)
sys.exit(not (is_beating and worst <= 1e-12 * max(felt)))
