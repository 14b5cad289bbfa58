# SPDX-License-Identifier: BSD-3-Clause
"""From arrays to a force with ctypes alone (docs/ffi.md): python3 tests/ffi/touch.py BUILD."""
import re
import sys
from ctypes import (CDLL, CFUNCTYPE, POINTER, Structure, addressof, byref, c_char, c_char_p, c_double, c_float, c_int32,
                    c_size_t, c_uint8, c_uint32, c_uint64, c_void_p, sizeof)
from math import cos, sin
from os.path import exists

core = CDLL(sys.argv[1] + "/libdynpoint.so")
compiler = CDLL(sys.argv[1] + "/libdynpoint_compile.so")
drivers = CDLL(sys.argv[1] + "/libdynpoint_drivers.so")
core.dpt_world_bytes.restype = c_size_t  # all other results used here are int32, ctypes' default
core.dpt_deformable_bytes.restype = c_size_t


def struct(name, *fields):
    listed = [(field, kind) for kind, names in fields for field in names.split()]
    return type(name, (Structure,), {"_fields_": listed})


double3, double4 = c_double * 3, c_double * 4
Pose = struct("dpt_pose", (double3, "position"), (double4, "orientation"))
Segment = struct("dpt_segment", (double3, "a b"), (c_double, "radius"))
Wrench = struct("dpt_wrench", (double3, "force torque"))
Hit = struct("dpt_hit", (c_uint32, "size status contact flags triangle segment body work"),
             (c_double, "distance gap depth s"), (double3, "p q"),
             (c_double, "error_bound lower_bound"))
WorldDef = struct("dpt_world_def", (c_uint32, "size max_bodies max_tools max_segments method kernel"
                                    " until budget"), (c_double, "stiffness"),
                  (c_uint64, "certificate_bytes"), (c_double, "margin side_limit fade"),
                  (c_uint32, "max_contacts smooth_normals strip strip_capacity strip_search law"),
                  (c_double, "strip_width strip_depth"), (c_void_p, "baseline reserved_pointer"),
                  (c_double, "onset"), (c_uint32, "sweep_budget max_tips max_channels reserved"))
Step = struct("dpt_step", (c_uint32, "size status contact work"), (c_double, "distance"),
              (c_uint32, "contacts flags"))
ToolSettings = struct("dpt_tool_settings", (c_uint32, "size law"),
                      (c_double, "stiffness rotational_stiffness damping"), (c_uint32, "lock_rotation near_only piercing reserved"))
BodySettings = struct("dpt_body_settings", (c_uint32, "size unfelt"),
                      (c_double, "side_limit static_friction kinetic_friction stiffness puncture_force toughness"
                                  " cutting_force shaft_friction shaft_viscosity shaft_stiffness"))
ForceInfo = struct("dpt_force_info", (c_uint32, "size reason flags law"), (Wrench, "wrench"),
                     (c_double, "energy lag"), (c_uint64, "folds"), (c_uint32, "sticking slipping"), (c_double, "body_work"))
ToolLoad = struct("dpt_tool_load", (c_uint32, "size body segment contact triangle reserved"), (double3, "point force torque"))
Region = struct("dpt_body_region", (c_uint32, "size reserved"), (c_double, "puncture_force toughness cutting_force"
                                                                      " shaft_friction shaft_viscosity"))
Channel = struct("dpt_channel", (c_uint32, "size id body triangle flags ruptures layers reserved"), (double3, "weight entry axis"),
                 (c_double, "depth deepest inside friction tip"))
Contact = struct("dpt_contact", (c_uint32, "size id body segment triangle contact flags reserved"),
                 (c_double, "s0 s1 s gap"), (double3, "p q normal weight"),
                 (c_double, "overlap moment"), (double3, "thrust thrust_moment"), (c_double, "square end_gap_0 end_gap_1"),
                 (double3, "end_normal_0 end_normal_1"))
Overlap = struct("dpt_overlap", (c_uint32, "size triangle flags reserved"), (c_double, "distance s"),
                 (double3, "q weight"), (c_double, "gap overlap"))
DeformDef = struct("dpt_deformable_def", (c_uint32, "size max_points"), (c_void_p, "mesh"), (POINTER(Pose), "pose"),
                   (double3, "box_min box_max"), (c_double, "period load_radius"), (c_uint32, "response passes"),
                   (c_double, "compliance"), (POINTER(c_float), "compliances"), (c_void_p, "reserved_pointer"))
Load = struct("dpt_load", (c_uint32, "vertex reserved"), (double3, "force"))
Latest = struct("dpt_latest", (c_uint32, "writing between reading"))
State = struct("dpt_device_state", (c_uint32, "size status reasons code buttons fresh"),
               (c_uint64, "sequence time_ns"), (Pose, "pose"), (double3, "velocity spin"),
               (c_double, "temperature"), (c_double * 6, "reserved"), (c_double * 8, "joint"))
Guard = struct("dpt_guard", (c_uint32, "size reserved"), (c_uint64 * 63, "opaque"))
CouplingDef = struct("dpt_coupling_def", (c_uint32, "size has_torque"),
                     (c_double, "mass inertia damping spin_damping friction spin_friction position_step angle_step"
                                " delay force_max torque_max stiffness_max rate loop_delay zoom force_scale rho lever"
                                " stiffness rotational_stiffness tool_damping gain_margin"))
Coupling = struct("dpt_coupling", (c_uint32, "size limit flags reserved"),
                  (c_double, "stiffness rotational_stiffness damping delay delay_needed stable stable_turn depth"))
PassivityDef = struct("dpt_passivity_def", (c_uint32, "size observe_only"),
                      (c_double, "damping spin_damping force_max torque_max force_slew torque_slew delay reserve"
                                 " body_power"))
Passivity = struct("dpt_passivity", (c_uint32, "size reserved"), (c_uint64 * 127, "opaque"))
PassivitySample = struct("dpt_passivity_sample", (c_uint32, "size reserved"), (c_double, "dt energy body_work"),
                         (Pose, "pose"), (Wrench, "sent"))
PassivityInfo = struct("dpt_passivity_info", (c_uint32, "size reserved"), (c_uint64, "steps acted"),
                       (c_double, "account account_min eps damped body_work taken"))
GuardInfo = struct("dpt_guard_info", (c_uint32, "size state"),
                   (c_uint64, "stops clamped slewed not_finite now_ns fresh_ns"), (c_double, "gain"),
                   (Wrench, "command sent"))
RecordHeader = struct("dpt_record_header", (c_uint32, "size writer_version"), (c_double, "rate"), (c_uint64, "began_ns"),
                      (c_char_p, "text"), (c_size_t, "text_bytes"))
Record = struct("dpt_record", (c_uint32, "size device"), (c_uint64, "number sequence time_ns sent_ns late_ns took_ns"),
                (c_double, "dt"), (c_uint32, "flags"), (c_int32, "result"),
                (c_uint32, "status reasons code buttons fresh commands force_reason force_flags hit_status contact"
                           " hit_flags triangle"), (Pose, "pose"), (double3, "velocity spin"), (c_double * 8, "joint"),
                (Wrench, "asked sent"), (Pose, "proxy"), (c_double, "distance gap energy lag"), (double3, "point"),
                (c_double, "depth inside"), (c_uint32, "ruptures layers"))
Identified = struct("dpt_identified", (c_double, "value low high"))
IdentifyResult = struct("dpt_identify_result", (c_uint32, "size end flags measured"),
                        (c_uint64, "samples lost late doubled"), (c_double, "rate jitter jitter_max"),
                        (Identified, "mass damping friction inertia spin_damping spin_friction delay"),
                        (c_double, "position_step angle_step stiffness turn_stiffness"),
                        (c_double * 9, "mass_matrix damping_matrix inertia_matrix spin_damping_matrix"),
                        (double3, "mass_direction damping_direction inertia_direction spin_damping_direction"),
                        (c_double, "force_bound torque_bound speed_max displacement_max"), (Pose, "pose"))
CompileDef = struct("dpt_compile_def", (c_uint32, "size format"), (c_double, "scale"), (c_void_p, "progress user"),
                    (c_double, "crease"), (c_uint32, "threads recentre"), (c_void_p, "nodes cells"),
                    (c_uint32, "node_count cell_count"), (c_void_p, "springs name note note_user"))
SpringRegion = struct("dpt_spring_region", (c_uint32, "kind fixed"), (c_double * 6, "box"), (c_double, "young density drag"))
SpringDef = struct("dpt_spring_net_def", (c_uint32, "size kind"),
                   (c_double, "young density drag viscosity thickness bending spacing"), (c_void_p, "regions fixed"),
                   (c_uint32, "region_count fixed_count"), (c_double, "poisson"))
MeshSprings = struct("dpt_mesh_springs", (c_uint32, "size nodes slices springs"), (c_double, "viscosity"),
                     (POINTER(c_float), "rest mass drag"), (POINTER(c_uint32), "first neighbours"),
                     (POINTER(c_float), "stiffness length"), (c_void_p, "reserved"))
SpringsDef = struct("dpt_springs_def", (c_uint32, "size integrator"), (c_void_p, "mesh reserved_pointer"),
                    (c_uint32, "max_loads reserved"), (double3, "gravity"),
                    (c_double, "stiffness contact_stiffness sleep_speed"),
                    (c_uint32, "sleep_steps iterations max_substeps kernel min_substeps reserved_word"))
Compiled = struct("dpt_compiled", (c_void_p, "bytes"), (c_size_t, "size"))
Joint = struct("dpt_arm_joint", (c_uint32, "size kind"), (c_double, "lower upper velocity effort damping friction"),
               (c_char * 64, "name"))
Link = struct("dpt_arm_link", (c_uint32, "size parent joint slides"), (Pose, "pose"), (double3, "axis"),
              (c_double, "factor offset mass"), (double3, "centre"))
ArmBody = struct("dpt_arm_body", (c_uint32, "size reserved"), (Pose, "pose"), (c_void_p, "mesh"),
                 (c_size_t, "mesh_bytes"), (c_char * 64, "name"))
ArmDef = struct("dpt_arm_def", (c_uint32, "size joint_count link_count segment_count body_count tool_link"),
                (Pose, "tool"), (POINTER(Joint), "joints"), (POINTER(Link), "links"),
                (POINTER(Segment), "segments"), (POINTER(ArmBody), "bodies"),
                (c_char_p, "name root_name tool_name"), (c_void_p, "reserved"),
                (c_uint64, "source_bytes source_hash"), (c_uint32, "jaw_count jaw_link_count tip_count reserved_word"),
                (POINTER(Joint), "jaws"), (POINTER(Link), "jaw_links"), (c_void_p, "tips reserved_pointer"))

verdicts = []


def check(what, is_so):
    print("  ok  " if is_so else "  FAIL", what)
    verdicts.append(bool(is_so))


def is_near(number, wanted):
    return abs(number - wanted) < 1e-12


column = 0 if sizeof(c_void_p) == 8 else 1
sizes = re.findall(r"SIZE\((\w+), (\d+), (\d+)\)", open(sys.path[0] + "/../abi/layouts.txt").read())
sizes = {name: int(bytes[column]) for name, *bytes in sizes}
for kind in (Pose, Segment, Wrench, Hit, ToolLoad, Channel, Contact, Overlap, WorldDef, Step, ToolSettings, BodySettings, ForceInfo,
             DeformDef, Load, Latest, State, Guard, GuardInfo, CouplingDef, Coupling, PassivityDef, Passivity,
             PassivitySample, PassivityInfo, RecordHeader, Record, Identified, IdentifyResult, CompileDef,
             SpringRegion, SpringDef, MeshSprings, Compiled, Joint, Link, ArmBody, ArmDef):
    check(kind.__name__ + " has its size", sizeof(kind) == sizes[kind.__name__])

# A box of 2 x 2 x 1 m with its top at z = 1: corner i at the bits of i; two triangles a side.
corners = [(2 * (i & 1) - 1, (i & 2) - 1, i >> 2) for i in range(8)]
sides = [(0, 1, 3, 2), (4, 5, 7, 6), (0, 1, 5, 4), (2, 3, 7, 6), (0, 2, 6, 4), (1, 3, 7, 5)]
triangles = [t for a, b, c, d in sides for t in ((a, b, c), (a, c, d))]
vertices = (c_double * 24)(*[x for corner in corners for x in corner])
numbers = (c_uint32 * 36)(*[i for triangle in triangles for i in triangle])
file = Compiled()
check("compile", compiler.dpt_compile_arrays(vertices, c_size_t(8), numbers, c_size_t(12), None,
                                             byref(file), None) == 0)
mesh = c_void_p()  # looks into file.bytes: keep them until the mesh is no longer used
check("open", core.dpt_mesh_open(c_void_p(file.bytes), c_size_t(file.size), byref(mesh)) == 0)

flags, normals = c_uint32(), (c_double * 9)()
check("flags", core.dpt_mesh_get_triangle_flags(mesh, c_uint32(2), byref(flags)) == 0)
check("two creases and a diagonal", bin(flags.value).count("1") == 5 and flags.value & 0x1c0)
check("normals", core.dpt_mesh_get_vertex_normals(mesh, c_uint32(2), normals) == 0)
check("upward at the top's corners", all(0.5 < z < 0.6 for z in normals[2::3]))

# Driven by other physics: by the vertices' numbers, and by the four nodes of a large cell about the box.
sources, count, moved = POINTER(c_uint32)(), c_uint32(), POINTER(c_float)()
check("numbers of vertices", core.dpt_mesh_get_vertex_sources(mesh, byref(sources), byref(count)) == 0 and count.value == 8)
check("places of vertices", core.dpt_mesh_get_vertices(mesh, byref(moved), byref(count)) == 0)
check("each is where its source is", all(moved[3 * v + k] == vertices[3 * sources[v] + k] for v in range(8) for k in range(3)))
points = [(-8, -8, -8), (24, -8, -8), (-8, 24, -8), (-8, -8, 24)]
node_places, cell = (c_double * 12)(*[x for point in points for x in point]), (c_uint32 * 4)(0, 1, 2, 3)
compile_def = CompileDef(size=sizeof(CompileDef), nodes=addressof(node_places), cells=addressof(cell), node_count=4, cell_count=1)
embedded_file, embedded = Compiled(), c_void_p()
check("embed", compiler.dpt_compile_arrays(vertices, c_size_t(8), numbers, c_size_t(12), byref(compile_def),
                                           byref(embedded_file), None) == 0)
check("open it", core.dpt_mesh_open(c_void_p(embedded_file.bytes), c_size_t(embedded_file.size), byref(embedded)) == 0)
nodes, weights, node_count = POINTER(c_uint32)(), POINTER(c_float)(), c_uint32()
check("its nodes", core.dpt_mesh_get_embedding(embedded, byref(nodes), byref(weights), byref(node_count)) == 0
      and node_count.value == 4)
check("they give the vertices", all(
    abs(sum(weights[4 * v + k] * points[nodes[4 * v + k]][axis] for k in range(4)) - corners[sources[v]][axis]) < 1e-5
    for v in range(8) for axis in range(3)))
compiler.dpt_compiled_free(byref(embedded_file))

# Its own physics: a lattice of cubes of 0.5 m about it, its lower half fixed.
region = SpringRegion(kind=1, fixed=1, box=(c_double * 6)(-9, -9, -9, 9, 9, 0.6))
spring_def = SpringDef(size=sizeof(SpringDef), kind=2, density=100, spacing=0.5, regions=addressof(region), region_count=1)
compile_def = CompileDef(size=sizeof(CompileDef), springs=addressof(spring_def))
check("make springs", compiler.dpt_compile_arrays(vertices, c_size_t(8), numbers, c_size_t(12), byref(compile_def),
                                                  byref(embedded_file), None) == 0)
check("open them", core.dpt_mesh_open(c_void_p(embedded_file.bytes), c_size_t(embedded_file.size), byref(embedded)) == 0)
springs = MeshSprings(size=sizeof(MeshSprings))
check("its springs", core.dpt_mesh_get_springs(embedded, byref(springs)) == 0 and springs.nodes == 75)
check("what is fixed, and what moves", all(
    (springs.mass[i] == 0) == (springs.rest[3 * i + 2] < 0.6) for i in range(springs.nodes)))
springs_def, stepped, told = SpringsDef(), c_void_p(), (c_float * 8)()
core.dpt_springs_def_defaults(byref(springs_def), c_size_t(sizeof(springs_def)))
springs_def.mesh = embedded
core.dpt_springs_bytes.restype = c_size_t
need = core.dpt_springs_bytes(byref(springs_def))
springs_block = (c_double * (need // 8 + 1))()
check("make them go", core.dpt_springs_create(springs_block, c_size_t(need), byref(springs_def), byref(stepped)) == 0)
check("what is above gives way", core.dpt_springs_get_compliances(stepped, c_double(0.01), 8, told) == 0 and all(
    (told[v] > 0) == (corners[sources[v]][2] > 0.6) for v in range(8)))
foreseen = (c_float * (3 * core.dpt_springs_get_count(stepped)))()
check("it falls", core.dpt_springs_foresee(stepped, c_double(0.01), None, 0, len(foreseen) // 3, foreseen) == 0)
compiler.dpt_compiled_free(byref(embedded_file))

ends = (c_double * 6)(0.3, 0.2, 1.5, 0.3, 0.2, 2.5)
hit = Hit(size=sizeof(Hit))
check("query", core.dpt_query_segments(mesh, None, ends, None, c_size_t(1), byref(hit), None) == 0)
check("0.5 m to (0.3, 0.2, 1)", is_near(hit.distance, 0.5) and is_near(hit.q[2], 1))
check("exact, on the top", hit.status == 3 and triangles[hit.triangle] in ((4, 5, 7), (4, 7, 6)))

definition, world, body, tool = WorldDef(), c_void_p(), c_uint32(), c_uint32()
core.dpt_world_def_defaults(byref(definition), c_size_t(sizeof(definition)))
definition.max_contacts = 8
definition.strip, definition.strip_width = 1, 0.05  # DPT_STRIP_KIND_SHADOW
definition.law = 0  # DPT_LAW_POINT
need = core.dpt_world_bytes(byref(definition))
block = (c_double * (need // 8 + 1))()  # doubles, so that the block is aligned to 8
check("create", core.dpt_world_create(block, c_size_t(need), byref(definition), byref(world)) == 0)
check("add a body", core.dpt_body_add(world, mesh, None, byref(body)) == 0)
stylus = Segment(double3(0, 0, 0), double3(0, 0, 1), 0.1)
check("add a tool", core.dpt_tool_add(world, byref(stylus), 1, byref(tool)) == 0)

pose = Pose(double3(0.3, 0.2, 1.05), double4(1, 0, 0, 0))
step, wrench = Step(size=sizeof(Step)), Wrench()
check("move", core.dpt_tool_set_pose(world, tool, byref(pose)) == 0)
check("step", core.dpt_world_step(world, c_double(0.001), byref(step)) == 0)
check("wrench", core.dpt_tool_get_wrench(world, tool, byref(wrench)) == 0)
check("exact, pressed in", step.status == 3 and step.contact == 3)
check("500 N/m times 0.05 m, upward", is_near(wrench.force[2], 25) and is_near(wrench.force[0], 0))

contact, count = Contact(size=sizeof(Contact)), c_uint32()
check("contacts", core.dpt_tool_get_contacts(world, tool, byref(contact), 1, byref(count)) == 0)
check("one region, at the end a", count.value == 1 == step.contacts and contact.s == 0)
load, on_body = ToolLoad(size=sizeof(ToolLoad)), Wrench()
check("loads", core.dpt_tool_get_loads(world, tool, byref(load), 1, byref(count)) == 0 and count.value == 1)
check("its push, in that contact", load.contact == contact.id and is_near(load.force[2], wrench.force[2]))
check("wrench on the body", core.dpt_body_get_wrench(world, body, byref(on_body)) == 0)
check("the reaction", is_near(on_body.force[2], -wrench.force[2]))
check("0.05 m deep, upward", is_near(contact.gap, -0.05) and is_near(contact.normal[2], 1))

overlaps = (Overlap * 12)()
overlaps[0].size = sizeof(Overlap)
check("strip", core.dpt_tool_get_strip(world, tool, 0, overlaps, 12, byref(count), None) == 0)
deepest = max(overlaps[: count.value], key=lambda overlap: overlap.overlap)
check("of the top, 0.05 m deep", deepest.triangle == contact.triangle and is_near(deepest.overlap, 0.05))

settings = ToolSettings(size=sizeof(ToolSettings))
check("its settings", core.dpt_tool_get_settings(world, tool, byref(settings)) == 0 and settings.stiffness == 500)
settings.law = 2  # DPT_LAW_PROXY
check("a proxy", core.dpt_tool_set_settings(world, tool, byref(settings)) == 0)
rough = BodySettings(size=sizeof(BodySettings), static_friction=0.4, kinetic_friction=0.3)
check("friction", core.dpt_body_set_settings(world, body, byref(rough)) == 0)
for height in (1.2, 1.2, 1.05):  # from the open, where the proxy is known to be outside
    pose.position[2] = height
    core.dpt_tool_set_pose(world, tool, byref(pose))
    core.dpt_world_step(world, c_double(0.001), None)
force, proxy = ForceInfo(size=sizeof(ForceInfo)), Pose()
check("its force", core.dpt_tool_get_force_info(world, tool, byref(force)) == 0 and force.reason == 0)
check("its proxy", core.dpt_tool_get_proxy(world, tool, byref(proxy)) == 0)
check("no channels here", core.dpt_tool_get_channels(world, tool, None, 0, byref(count)) == -9 and count.value == 0)
check("nor a needle", core.dpt_tool_insert(world, tool) == -9)
check("nor regions", core.dpt_body_set_regions(world, body, (c_uint8 * 12)(), 12, byref(Region(size=sizeof(Region))), 1) == -9)
check("on the top, pulled at by 500 N/m", abs(proxy.position[2] - 1.1) < 1e-4 and force.law == 2
      and is_near(force.wrench.force[2], 500 * (proxy.position[2] - 1.05)))
settings.law = 0  # DPT_LAW_POINT
core.dpt_tool_set_settings(world, tool, byref(settings))

# A soft box beside it, of which the top is lowered by 0.1 m: where it is now is what is felt, and its corners hold it.
soft_def, soft = DeformDef(), c_uint32()
core.dpt_deformable_def_defaults(byref(soft_def), c_size_t(sizeof(soft_def)))
soft_def.mesh = mesh.value
beside = Pose(double3(5, 0, 0), double4(1, 0, 0, 0))
soft_def.pose = POINTER(Pose)(beside)
need = core.dpt_deformable_bytes(byref(soft_def))
soft_block = (c_double * (need // 8 + 1))()
check("add a soft body", core.dpt_body_add_deformable(world, soft_block, c_size_t(need), byref(soft_def), byref(soft)) == 0)
at = POINTER(c_float)()
check("its vertices", core.dpt_body_get_vertices(world, soft, byref(at), byref(count)) == 0 and count.value == 8)
lowered = (c_float * 24)(*[min(x, 0.9) if i % 3 == 2 else x for i, x in enumerate(at[:24])])
check("move them", core.dpt_body_set_vertices(world, soft, 0, 8, lowered, c_double(-1)) == 0)
first = (c_uint32 * 1)(0)
check("one of them", core.dpt_body_set_vertex_list(world, soft, first, 1, lowered, c_double(0)) == 0)
check("they are there", core.dpt_body_get_vertices(world, soft, byref(at), byref(count)) == 0
      and at[:24] == lowered[:])
pose.position[:] = (5.3, 0.2, 0.95)
core.dpt_tool_teleport(world, tool, byref(pose))
check("step beside", core.dpt_world_step(world, c_double(0.001), byref(step)) == 0 and step.contact == 3)
core.dpt_tool_get_wrench(world, tool, byref(wrench))
loads = (Load * 64)()
check("loads", core.dpt_body_get_loads(world, soft, loads, 64, byref(count)) == 0 and count.value > 0)
check("they are 25 N downward, as it is 25 N upward", abs(wrench.force[2] - 25) < 1e-4 and
      abs(sum(load.force[2] for load in loads[:count.value]) + wrench.force[2]) < 1e-9)
core.dpt_body_remove(world, soft)  # only then may its block go
# One that gives way by 1 mm/N: two ticks have a mean of their loads, and an answer to it is taken.
soft_def.compliance = 1e-3
need = core.dpt_deformable_bytes(byref(soft_def))
soft_block = (c_double * (need // 8 + 1))()
check("add what gives way", core.dpt_body_add_deformable(world, soft_block, c_size_t(need), byref(soft_def), byref(soft)) == 0)
pose.position[:] = (5.3, 0.2, 1.05)
core.dpt_tool_teleport(world, tool, byref(pose))
settings.law = 2  # DPT_LAW_PROXY
core.dpt_tool_set_settings(world, tool, byref(settings))
for _ in range(2):
    core.dpt_world_step(world, c_double(0.001), None)
    check("it gives way", core.dpt_body_step_springs(world, soft, None, c_double(0.001), None) == 0)
seconds = c_double()
check("the mean of its loads", core.dpt_body_get_mean_loads(world, soft, loads, 64, byref(count), byref(seconds)) == 0
      and is_near(seconds.value, 0.002))
check("an answer", core.dpt_body_set_answered_loads(world, soft, loads, count) == 0)
check("and what comes next", core.dpt_body_set_foreseen_vertices(world, soft, 0, 0, None) == 0)
settings.law = 0
core.dpt_tool_set_settings(world, tool, byref(settings))
core.dpt_body_remove(world, soft)
pose.position[:] = (0.3, 0.2, 1.05)
core.dpt_tool_teleport(world, tool, byref(pose))

latest = Latest()
core.dpt_latest_init(byref(latest))
check("nothing new", core.dpt_latest_take(byref(latest)) == 0)
place = latest.writing
core.dpt_latest_publish(byref(latest))
check("something new, once", core.dpt_latest_take(byref(latest)) == 1 and latest.reading == place
      and core.dpt_latest_take(byref(latest)) == 0)

device, state, guard, sent = c_void_p(), State(size=sizeof(State)), Guard(size=sizeof(Guard)), Wrench()
check("open a device", drivers.dpt_device_open(b"sim:?hand=press", byref(device), None) == 0)
measured = IdentifyResult(size=sizeof(IdentifyResult))
check("watch it at rest", drivers.dpt_device_identify(device, None, byref(measured)) == 0 and
      abs(measured.rate - 1000) < 1e-6 and measured.measured & 1 and not measured.mass.value)
drivers.dpt_device_close(device)
check("open it again", drivers.dpt_device_open(b"sim:?hand=press", byref(device), None) == 0)
check("a guard", core.dpt_guard_init(byref(guard), None) == 0)
touched = 0
for tick in range(3000):  # the hand presses 3 cm down in 2 s; the mesh's top is 1 cm below where it begins
    check_read = drivers.dpt_device_read(device, byref(state))
    x, y, z = state.pose.position  # y is up, in the mesh z
    pose.position[:] = (x, -z, 1.11 + y)
    core.dpt_tool_set_pose(world, tool, byref(pose))
    core.dpt_world_step(world, c_double(0.001), None)
    core.dpt_tool_get_wrench(world, tool, byref(wrench))
    x, y, z = wrench.force
    wrench.force[:] = (x, z, -y)
    core.dpt_guard_step(byref(guard), c_uint64(state.time_ns), byref(wrench), state.status == 3, byref(sent))
    touched += check_read == 0 and drivers.dpt_device_write(device, byref(sent)) == 0 and sent.force[1] > 1
coupling_def, coupling = CouplingDef(size=sizeof(CouplingDef)), Coupling(size=sizeof(Coupling))
core.dpt_coupling_def_defaults(byref(coupling_def), c_size_t(sizeof(coupling_def)))
coupling_def.mass, coupling_def.damping, coupling_def.gain_margin = 0.1, 0.5, 1
check("a coupling", core.dpt_coupling_for_device(byref(coupling_def), byref(coupling)) == 0)
check("0.5 Ns/m in half a period of 1 ms", abs(coupling.stiffness - 1000) < 5 and coupling.limit == 1)
passivity, saw = Passivity(size=sizeof(Passivity)), PassivityInfo(size=sizeof(PassivityInfo))
check("an observer", core.dpt_passivity_init(byref(passivity), None) == 0)
sample = PassivitySample(size=sizeof(PassivitySample), dt=0.001, pose=Pose(double3(0, 0, 0), double4(1, 0, 0, 0)))
wrench.force[:], wrench.torque[:] = (0, 1, 0), (0, 0, 0)
for _ in range(3):  # a newton goes along with the hand, a millimetre at a time
    check("it sees", core.dpt_passivity_step(byref(passivity), byref(sample), byref(wrench)) == 0)
    sample.pose.position[1] += 0.001
    sample.sent = wrench
check("energy from nothing ends", core.dpt_passivity_get_info(byref(passivity), byref(saw)) == 0 and saw.acted == 1
      and wrench.force[1] == 0 and is_near(saw.account, -0.001))
header = RecordHeader(size=sizeof(RecordHeader), rate=1000, text=b"scene=box", text_bytes=9)
record = Record(size=sizeof(Record), time_ns=state.time_ns, status=state.status, asked=wrench, sent=sent)
recording, used, at = (c_char * 2048)(), c_size_t(), c_size_t()
check("a recording's header", core.dpt_record_header_write(byref(header), recording, c_size_t(2048), byref(used)) == 0)
begin = used.value
check("a record", core.dpt_record_write(byref(record), 1, byref(recording, begin), c_size_t(2048 - begin), byref(used)) == 0)
end = c_size_t(begin + used.value)
again, told = Record(size=sizeof(Record)), RecordHeader(size=sizeof(RecordHeader))
check("what it says", core.dpt_record_header_read(recording, end, byref(told), byref(at)) == 0 and told.text == b"scene=box")
check("and the record", core.dpt_record_read(recording, end, byref(at), byref(again), 1, byref(count)) == 0
      and count.value == 1 and at.value == end.value and bytes(again) == bytes(record))

did = GuardInfo(size=sizeof(GuardInfo))
check("what the guard did", core.dpt_guard_get_info(byref(guard), byref(did)) == 0 and did.state == 2)
check("it is felt, and holds the hand off", touched > 500 and did.stops == 0 and state.pose.position[1] < 0)
drivers.dpt_device_close(device)

# An arm of two links in a plane, 0.3 m and 0.2 m, with the box beside it.
joints, links, bodies = (Joint * 2)(), (Link * 2)(), (ArmBody * 1)()
for i, name in enumerate((b"shoulder", b"elbow")):
    joints[i] = Joint(size=sizeof(Joint), kind=1, name=name)  # DPT_JOINT_CONTINUOUS
    links[i] = Link(size=sizeof(Link), parent=(i - 1) & 0xffffffff, joint=i, axis=double3(0, 0, 1), factor=1,
                    pose=Pose(double3(0.3 * i, 0, 0), double4(1, 0, 0, 0)), mass=1)
bodies[0] = ArmBody(size=sizeof(ArmBody), pose=Pose(double3(0, 0, 0), double4(1, 0, 0, 0)), mesh=mesh, name=b"box")
arm_def = ArmDef(size=sizeof(ArmDef), joint_count=2, link_count=2, body_count=1, tool_link=1, joints=joints, links=links,
                 tool=Pose(double3(0.2, 0, 0), double4(1, 0, 0, 0)), bodies=bodies, name=b"planar")
arm_file, arm = Compiled(), c_void_p()
check("compile an arm", compiler.dpt_compile_arm(byref(arm_def), byref(arm_file), None) == 0)
check("open it", core.dpt_arm_open(c_void_p(arm_file.bytes), c_size_t(arm_file.size), byref(arm)) == 0)
angles, efforts, shoulder = (c_double * 2)(0.5, 0.7), (c_double * 2)(), Joint(size=sizeof(Joint))
check("forward", core.dpt_arm_forward(arm, angles, byref(pose)) == 0)
check("where two links reach", is_near(pose.position[0], 0.3 * cos(0.5) + 0.2 * cos(1.2))
      and is_near(pose.position[1], 0.3 * sin(0.5) + 0.2 * sin(1.2)))
wrench.force[:], wrench.torque[:] = (0, 1, 0), (0, 0, 0)
check("efforts", core.dpt_arm_efforts(arm, angles, byref(wrench), efforts) == 0)
check("a newton upward on the levers", is_near(efforts[0], pose.position[0]) and is_near(efforts[1], 0.2 * cos(1.2)))
check("its joint", core.dpt_arm_get_joint(arm, c_uint32(0), byref(shoulder)) == 0 and shoulder.name == b"shoulder")
check("its box", core.dpt_arm_get_body(arm, c_uint32(0), byref(bodies[0])) == 0 and bodies[0].mesh_bytes == file.size)
check("no such joint: DPT_E_ARGUMENT", core.dpt_arm_get_joint(arm, c_uint32(2), byref(shoulder)) == -1)
compiler.dpt_compiled_free(byref(arm_file))

skipped = not exists(sys.argv[1] + "/libdynpoint_urdf.so")
if skipped:
    print("  skip a robot's description: no libdynpoint_urdf")
else:
    urdf, angles = CDLL(sys.argv[1] + "/libdynpoint_urdf.so"), (c_double * 3)(0, 0, 0)
    note = CFUNCTYPE(None, c_void_p, c_uint64, c_char_p)
    notes = []
    UrdfDef = struct("dpt_urdf_def", (c_uint32, "size reserved"), (c_char_p, "tool packages"), (c_void_p, "mesh"),
                     (note, "note"), (c_void_p, "user reserved_pointer"))
    check("dpt_urdf_def has its size", sizeof(UrdfDef) == sizes["dpt_urdf_def"])
    check("compile a URDF", urdf.dpt_urdf_compile_file(b"docs/samples/arm.urdf", None, byref(arm_file), None) == 0)
    check("open it", core.dpt_arm_open(c_void_p(arm_file.bytes), c_size_t(arm_file.size), byref(arm)) == 0)
    check("forward", core.dpt_arm_forward(arm, angles, byref(pose)) == 0)
    check("where its forearm ends", is_near(pose.position[0], 0.3) and is_near(pose.position[2], 0.1))
    compiler.dpt_compiled_free(byref(arm_file))
    hear = note(lambda user, line, text: notes.append((line, text)))
    urdf_def = UrdfDef(size=sizeof(UrdfDef), tool=b"upper_arm", note=hear)
    path = b"docs/samples/arm.urdf"
    check("another tool", urdf.dpt_urdf_compile_file(path, byref(urdf_def), byref(arm_file), None) == 0)
    check("what is noted", [line for line, text in notes] == [8] and b"'stylus'" in notes[0][1])
    compiler.dpt_compiled_free(byref(arm_file))

check("a body is no tool: DPT_E_HANDLE", core.dpt_tool_set_pose(world, body, byref(pose)) == -8)
check("no pose: DPT_E_ARGUMENT", core.dpt_tool_set_pose(world, tool, None) == -1)
check("no size: DPT_E_SIZE", core.dpt_world_step(world, c_double(0.001), byref(Step())) == -2)
compiler.dpt_compiled_free(byref(file))

print(f"{sum(verdicts)} passed, {len(verdicts) - sum(verdicts)} failed, {int(skipped)} skipped")
sys.exit(not all(verdicts))
