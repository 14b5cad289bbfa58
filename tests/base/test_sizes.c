/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Structs that begin with their size, of callers that are older or newer than the library: every function of the core
 * and of the arms' compiler that takes or fills one, with the first release's size, today's, and 8 bytes more. What the
 * fields mean is for other tests.
 */
#include <stddef.h>

#include "dynpoint/baseline.h"
#include "lib/fixture.h"
#include "lib/size_checks.h"

/* What every case asks of. */
static struct fixture fixture;
static dpt_compiled arm_bytes;
static const dpt_arm *arm;
static dpt_world *world;
static dpt_tool tool;
static dpt_body body;
static dpt_strip *strip;

/* ---- what the library fills ---- */

static dpt_result mesh_info(void *out)
{
    return dpt_mesh_get_info(fixture.mesh, out);
}

static dpt_result mesh_springs(void *out)
{
    return dpt_mesh_get_springs(fixture.mesh, out);
}

static dpt_result mesh_section(void *out)
{
    return dpt_mesh_get_section(fixture.mesh, 1, out);
}

/* Damaged: the answer is in the fault, and the code is that of the damage. */
static dpt_result damaged(dpt_result result)
{
    return result == DPT_E_MAGIC ? DPT_OK : result;
}

static dpt_result mesh_fault(void *out)
{
    static const uint64_t bytes[8] = { 1 };
    return damaged(dpt_mesh_verify(bytes, sizeof bytes, out));
}

static dpt_result arm_fault(void *out)
{
    static const uint64_t bytes[8] = { 1 };
    return damaged(dpt_arm_verify(bytes, sizeof bytes, out));
}

static dpt_result arm_info(void *out)
{
    return dpt_arm_get_info(arm, out);
}

static dpt_result arm_joint(void *out)
{
    return dpt_arm_get_joint(arm, 0, out);
}

static dpt_result arm_link(void *out)
{
    return dpt_arm_get_link(arm, 0, out);
}

static dpt_result arm_body(void *out)
{
    return dpt_arm_get_body(arm, 0, out);
}

static dpt_result step(void *out)
{
    return dpt_world_step(world, 0.001, out);
}

static dpt_result usage(void *out)
{
    return dpt_world_get_info(world, out);
}

static dpt_result hit(void *out)
{
    return dpt_tool_get_hit(world, tool, out);
}

static dpt_result contact(void *out)
{
    uint32_t count;
    return dpt_tool_get_contacts(world, tool, out, 1, &count);
}

static dpt_result tool_load(void *out)
{
    uint32_t count;
    return dpt_tool_get_loads(world, tool, out, 1, &count);
}

/* Of a needle through the mesh, in a world of its own. */
static dpt_result channel(void *out)
{
    static uint64_t block[1 << 18];
    const dpt_segment needle = { { 0, 0, 0 }, { 0, 0, 10 }, 0.01 };
    const dpt_body_settings soft = { .size = sizeof soft, .puncture_force = 1.0 };
    dpt_tool_settings sharp = { .size = sizeof sharp };
    dpt_pose pose = DPT_POSE_IDENTITY;
    dpt_world_def def;
    dpt_world *own;
    dpt_tool piercing;
    dpt_body pierced;
    uint32_t count = 0;
    dpt_world_def_init(&def);
    def.max_channels = 1;
    pose.position[2] = -5.0;
    if (dpt_world_create(block, sizeof block, &def, &own) != DPT_OK ||
        dpt_body_add(own, fixture.mesh, NULL, &pierced) != DPT_OK ||
        dpt_body_set_settings(own, pierced, &soft) != DPT_OK || dpt_tool_add(own, &needle, 1, &piercing) != DPT_OK ||
        dpt_tool_get_settings(own, piercing, &sharp) != DPT_OK)
        return DPT_E_MEMORY;
    sharp.piercing = DPT_PIERCING_B;
    dpt_tool_set_settings(own, piercing, &sharp);
    dpt_tool_set_pose(own, piercing, &pose);
    CHECK(dpt_tool_insert(own, piercing) == DPT_OK, "a needle through the mesh");
    return dpt_tool_get_channels(own, piercing, out, 1, &count);
}

static dpt_result sweep(void *out)
{
    return dpt_tool_get_sweep(world, tool, 0, out);
}

static dpt_result tool_overlap(void *out)
{
    uint32_t count;
    return dpt_tool_get_strip(world, tool, 0, out, 1, &count, NULL);
}

/* Through the middle of the mesh's box. */
static dpt_segment segment;

static dpt_result overlap(void *out)
{
    uint32_t count;
    return dpt_strip_overlaps(strip, fixture.mesh, NULL, &segment, 1, out, 1, &count);
}

static dpt_result query_hit(void *out)
{
    const double ends[6] = { 2.0, 0.0, 0.0, 3.0, 0.0, 0.0 };
    return dpt_query_segments(fixture.mesh, NULL, ends, NULL, 1, out, NULL);
}

static dpt_result body_settings(void *out)
{
    return dpt_body_get_settings(world, body, out);
}

static dpt_result tool_settings(void *out)
{
    return dpt_tool_get_settings(world, tool, out);
}

static dpt_result tool_force(void *out)
{
    return dpt_tool_get_force_info(world, tool, out);
}

static dpt_result guard(void *out)
{
    return dpt_guard_init(out, NULL);
}

static dpt_guard a_guard;

static dpt_result guard_info(void *out)
{
    return dpt_guard_get_info(&a_guard, out);
}

static dpt_coupling_def a_coupling_def;

static dpt_result coupling(void *out)
{
    return dpt_coupling_for_device(&a_coupling_def, out);
}

static dpt_result passivity(void *out)
{
    return dpt_passivity_init(out, NULL);
}

static dpt_passivity a_passivity;

static dpt_result passivity_info(void *out)
{
    return dpt_passivity_get_info(&a_passivity, out);
}

static unsigned char recording[2048];
static size_t recording_bytes, first_record;

static dpt_result record_header(void *out)
{
    size_t at;
    return dpt_record_header_read(recording, first_record + recording_bytes, out, &at);
}

static dpt_result record(void *out)
{
    size_t at = first_record;
    uint32_t count;
    return dpt_record_read(recording, first_record + recording_bytes, &at, out, 1, &count);
}

static const struct sized outputs[] = {
    { "dpt_mesh_info", offsetof(dpt_mesh_info, solid_components), sizeof(dpt_mesh_info), mesh_info },
    { "dpt_mesh_springs", sizeof(dpt_mesh_springs), sizeof(dpt_mesh_springs), mesh_springs },
    { "dpt_mesh_section", sizeof(dpt_mesh_section), sizeof(dpt_mesh_section), mesh_section },
    { "dpt_mesh_fault", sizeof(dpt_mesh_fault), sizeof(dpt_mesh_fault), mesh_fault },
    { "dpt_mesh_fault of an arm", sizeof(dpt_mesh_fault), sizeof(dpt_mesh_fault), arm_fault },
    { "dpt_arm_info", offsetof(dpt_arm_info, jaws), sizeof(dpt_arm_info), arm_info },
    { "dpt_arm_joint", sizeof(dpt_arm_joint), sizeof(dpt_arm_joint), arm_joint },
    { "dpt_arm_link", sizeof(dpt_arm_link), sizeof(dpt_arm_link), arm_link },
    { "dpt_arm_body", sizeof(dpt_arm_body), sizeof(dpt_arm_body), arm_body },
    { "dpt_step", offsetof(dpt_step, contacts), sizeof(dpt_step), step },
    { "dpt_world_info", sizeof(dpt_world_info), sizeof(dpt_world_info), usage },
    { "dpt_hit", sizeof(dpt_hit), sizeof(dpt_hit), hit },
    { "dpt_contact", sizeof(dpt_contact), sizeof(dpt_contact), contact },
    { "dpt_tool_load", sizeof(dpt_tool_load), sizeof(dpt_tool_load), tool_load },
    { "dpt_channel", sizeof(dpt_channel), sizeof(dpt_channel), channel },
    { "dpt_sweep", sizeof(dpt_sweep), sizeof(dpt_sweep), sweep },
    { "dpt_overlap of a tool", sizeof(dpt_overlap), sizeof(dpt_overlap), tool_overlap },
    { "dpt_overlap", sizeof(dpt_overlap), sizeof(dpt_overlap), overlap },
    { "dpt_guard", sizeof(dpt_guard), sizeof(dpt_guard), guard },
    { "dpt_guard_info", sizeof(dpt_guard_info), sizeof(dpt_guard_info), guard_info },
    { "dpt_coupling", sizeof(dpt_coupling), sizeof(dpt_coupling), coupling },
    { "dpt_passivity", sizeof(dpt_passivity), sizeof(dpt_passivity), passivity },
    { "dpt_passivity_info", sizeof(dpt_passivity_info), sizeof(dpt_passivity_info), passivity_info },
    { "dpt_body_settings", offsetof(dpt_body_settings, puncture_force), sizeof(dpt_body_settings), body_settings },
    { "dpt_tool_settings", offsetof(dpt_tool_settings, piercing), sizeof(dpt_tool_settings), tool_settings },
    { "dpt_force_info", sizeof(dpt_force_info), sizeof(dpt_force_info), tool_force },
    { "dpt_record_header", sizeof(dpt_record_header), sizeof(dpt_record_header), record_header },
    { "dpt_record", offsetof(dpt_record, depth), sizeof(dpt_record), record },
    { "dpt_hit of a query", sizeof(dpt_hit), sizeof(dpt_hit), query_hit },
};

static void outputs_are_filled_as_far_as_they_go(void)
{
    for (size_t i = 0; i < sizeof outputs / sizeof *outputs; i++)
        check_output(&outputs[i]);
}

/* ---- what the library takes ---- */

static dpt_result world_def(void *given)
{
    static uint64_t block[1 << 18];
    dpt_world *made;
    const size_t bytes = dpt_world_bytes(given);
    dpt_result result = dpt_world_create(block, sizeof block, given, &made);
    CHECK((result == DPT_OK) == (bytes > 0 && bytes <= sizeof block), "%zu bytes, %s", bytes, dpt_result_name(result));
    return result;
}

static dpt_result baseline_def(void *given)
{
    dpt_world_def def;
    dpt_world_def_init(&def);
    def.max_contacts = 32;
    def.baseline = given;
    return world_def(&def);
}

static dpt_result set_body(void *given)
{
    return dpt_body_set_settings(world, body, given);
}

static dpt_result set_tool(void *given)
{
    return dpt_tool_set_settings(world, tool, given);
}

/* The body is removed again, so that there is room for the next one. */
static dpt_result deform_def(void *given)
{
    static uint64_t block[1 << 13];
    dpt_body made;
    const size_t bytes = dpt_deformable_bytes(given);
    dpt_result result = dpt_body_add_deformable(world, block, sizeof block, given, &made);
    CHECK((result == DPT_OK) == (bytes > 0 && bytes <= sizeof block), "%zu bytes, %s", bytes, dpt_result_name(result));
    return result == DPT_OK ? dpt_body_remove(world, made) : result;
}

static dpt_result strip_def(void *given)
{
    static uint64_t block[1 << 13];
    dpt_strip *made;
    const size_t bytes = dpt_strip_bytes(given);
    dpt_result result = dpt_strip_create(block, sizeof block, given, &made);
    CHECK((result == DPT_OK) == (bytes > 0), "%zu bytes", bytes);
    return result;
}

static dpt_result guard_def(void *given)
{
    dpt_guard made = { .size = sizeof made };
    return dpt_guard_init(&made, given);
}

static dpt_result coupling_def(void *given)
{
    dpt_coupling made = { .size = sizeof made };
    return dpt_coupling_for_device(given, &made);
}

static dpt_passivity_def a_passivity_def;

static dpt_result passivity_def(void *given)
{
    dpt_passivity made = { .size = sizeof made };
    return dpt_passivity_init(&made, given);
}

static const dpt_passivity_sample a_passivity_sample = { .size = sizeof a_passivity_sample,
                                                         .dt = 1e-3,
                                                         .pose = { { 0.0 }, { 1.0 } } };

static dpt_result passivity_sample(void *given)
{
    dpt_wrench wrench = { { 1.0 }, { 0.0 } };
    return dpt_passivity_step(&a_passivity, given, &wrench);
}

static dpt_result shadow(void *given)
{
    return dpt_strip_shadow(strip, fixture.mesh, NULL, given);
}

static dpt_result query_def(void *given)
{
    const double ends[6] = { 2.0, 0.0, 0.0, 3.0, 0.0, 0.0 };
    dpt_hit answer = DPT_HIT_INIT;
    return dpt_query_segments(fixture.mesh, NULL, ends, NULL, 1, &answer, given);
}

static dpt_arm_def arm_of(const dpt_arm_joint *joint, const dpt_arm_link *link, const dpt_arm_body *scene)
{
    const dpt_pose identity = DPT_POSE_IDENTITY;
    return (dpt_arm_def){ .size = sizeof(dpt_arm_def),
                          .joint_count = 1,
                          .link_count = 1,
                          .body_count = 1,
                          .tool = identity,
                          .joints = joint,
                          .links = link,
                          .bodies = scene };
}

static dpt_arm_joint a_joint;
static dpt_arm_link a_link;
static dpt_arm_body a_body;

static dpt_result compile_arm(const dpt_arm_def *def)
{
    dpt_compiled out;
    dpt_result result = dpt_compile_arm(def, &out, NULL);
    dpt_compiled_free(&out);
    return result;
}

static dpt_result arm_def(void *given)
{
    return compile_arm(given);
}

static dpt_result given_joint(void *given)
{
    const dpt_arm_def def = arm_of(given, &a_link, &a_body);
    return compile_arm(&def);
}

static dpt_result given_link(void *given)
{
    const dpt_arm_def def = arm_of(&a_joint, given, &a_body);
    return compile_arm(&def);
}

static dpt_result given_body(void *given)
{
    const dpt_arm_def def = arm_of(&a_joint, &a_link, given);
    return compile_arm(&def);
}

static const dpt_record_header a_record_header = {
    .size = sizeof a_record_header, .rate = 1000.0, .text = "a=b", .text_bytes = 3
};
static const dpt_record a_record = { .size = sizeof a_record, .sequence = 7, .dt = 0.001 };

static dpt_result write_header(void *given)
{
    unsigned char bytes[128];
    size_t written;
    const dpt_result result = dpt_record_header_write(given, bytes, sizeof bytes, &written);
    CHECK((result == DPT_OK) == (dpt_record_header_bytes(given) > 0), "%s", dpt_result_name(result));
    return result;
}

static dpt_result write_record(void *given)
{
    unsigned char bytes[1024];
    size_t written;
    return dpt_record_write(given, 1, bytes, sizeof bytes, &written);
}

static dpt_world_def a_world_def, defaults;
static dpt_deformable_def a_deform_def;
static const dpt_strip_def a_strip_def = { sizeof a_strip_def, 64, 0, 0 };
static const dpt_baseline_def a_baseline_def = { sizeof a_baseline_def, 1, 0, 0 };
static const dpt_body_settings a_body_settings = { .size = sizeof a_body_settings,
                                                   .side_limit = 0.01,
                                                   .static_friction = 0.5,
                                                   .kinetic_friction = 0.4,
                                                   .stiffness = 700.0 };
static const dpt_tool_settings a_tool_settings = {
    .size = sizeof a_tool_settings, .law = DPT_LAW_POINT, .stiffness = 300.0, .damping = 0.5, .lock_rotation = 1
};
static dpt_guard_def a_guard_def;
static const dpt_query_def a_query_def = { .size = sizeof a_query_def };
static dpt_shadow a_shadow;
static dpt_arm_def an_arm_def;

static const struct {
    struct sized of;
    const void *good;
} inputs[] = {
    { { "dpt_world_def", offsetof(dpt_world_def, max_channels), sizeof(dpt_world_def), world_def }, &a_world_def },
    { { "dpt_baseline_def", sizeof(dpt_baseline_def), sizeof(dpt_baseline_def), baseline_def }, &a_baseline_def },
    { { "dpt_deformable_def", offsetof(dpt_deformable_def, compliance), sizeof(dpt_deformable_def), deform_def },
      &a_deform_def },
    { { "dpt_body_settings", offsetof(dpt_body_settings, puncture_force), sizeof(dpt_body_settings), set_body },
      &a_body_settings },
    { { "dpt_tool_settings", offsetof(dpt_tool_settings, piercing), sizeof(dpt_tool_settings), set_tool },
      &a_tool_settings },
    { { "dpt_strip_def", sizeof(dpt_strip_def), sizeof(dpt_strip_def), strip_def }, &a_strip_def },
    { { "dpt_guard_def", sizeof(dpt_guard_def), sizeof(dpt_guard_def), guard_def }, &a_guard_def },
    { { "dpt_coupling_def", sizeof(dpt_coupling_def), sizeof(dpt_coupling_def), coupling_def }, &a_coupling_def },
    { { "dpt_passivity_def", sizeof(dpt_passivity_def), sizeof(dpt_passivity_def), passivity_def }, &a_passivity_def },
    { { "dpt_passivity_sample", sizeof(dpt_passivity_sample), sizeof(dpt_passivity_sample), passivity_sample },
      &a_passivity_sample },
    { { "dpt_record_header", sizeof(dpt_record_header), sizeof(dpt_record_header), write_header }, &a_record_header },
    { { "dpt_record", offsetof(dpt_record, depth), sizeof(dpt_record), write_record }, &a_record },
    { { "dpt_shadow", sizeof(dpt_shadow), sizeof(dpt_shadow), shadow }, &a_shadow },
    { { "dpt_query_def", sizeof(dpt_query_def), sizeof(dpt_query_def), query_def }, &a_query_def },
    { { "dpt_arm_def", offsetof(dpt_arm_def, jaw_count), sizeof(dpt_arm_def), arm_def }, &an_arm_def },
    { { "dpt_arm_joint", sizeof(dpt_arm_joint), sizeof(dpt_arm_joint), given_joint }, &a_joint },
    { { "dpt_arm_link", sizeof(dpt_arm_link), sizeof(dpt_arm_link), given_link }, &a_link },
    { { "dpt_arm_body", sizeof(dpt_arm_body), sizeof(dpt_arm_body), given_body }, &a_body },
};

static void inputs_are_taken_as_far_as_they_go(void)
{
    for (size_t i = 0; i < sizeof inputs / sizeof *inputs; i++)
        check_input(&inputs[i].of, inputs[i].good);
}

/* An array's first size is its stride, and what lies in an item behind what we know must be zero in each. */
static void arrays_go_by_the_first_size(void)
{
    struct {
        dpt_arm_joint joint;
        double newer;
    } joints[2] = { { .joint = a_joint }, { .joint = a_joint } };
    dpt_arm_link links[2] = { a_link, a_link };
    links[1].parent = 0;
    links[1].joint = 1;
    joints[0].joint.size = sizeof joints[0];
    joints[1].joint.size = 77; /* is not looked at */
    dpt_arm_def def = arm_of(&joints[0].joint, links, &a_body);
    def.joint_count = def.link_count = 2;
    def.tool_link = 1;
    CHECK(compile_arm(&def) == DPT_OK, "%s", dpt_result_name(compile_arm(&def)));
    joints[1].newer = 1.0;
    CHECK(compile_arm(&def) == DPT_E_UNSUPPORTED, "%s", dpt_result_name(compile_arm(&def)));
}

/* ---- defaults ---- */

static void world_defaults(void *def, size_t size)
{
    dpt_world_def_defaults(def, size);
}

static void deform_defaults(void *def, size_t size)
{
    dpt_deformable_def_defaults(def, size);
}

/* The mesh has no default. */
static dpt_result deform_def_with_mesh(void *given)
{
    ((dpt_deformable_def *)given)->mesh = fixture.mesh;
    return deform_def(given);
}

static void coupling_defaults(void *def, size_t size)
{
    dpt_coupling_def_defaults(def, size);
}

static void passivity_defaults(void *def, size_t size)
{
    dpt_passivity_def_defaults(def, size);
}

static void guard_defaults(void *def, size_t size)
{
    dpt_guard_def_defaults(def, size);
}

static void defaults_fill_what_fits(void)
{
    const struct sized of_world = { "dpt_world_def", 0, sizeof defaults, world_def };
    const struct sized of_deform = { "dpt_deformable_def", 0, sizeof a_deform_def, deform_def_with_mesh };
    const struct sized of_guard = { "dpt_guard_def", 0, sizeof a_guard_def, guard_def };
    const struct sized of_coupling = { "dpt_coupling_def", 0, sizeof a_coupling_def, coupling_def };
    const struct sized of_passivity = { "dpt_passivity_def", 0, sizeof a_passivity_def, passivity_def };
    check_defaults(&of_world, world_defaults, &defaults);
    dpt_deformable_def whole;
    dpt_deformable_def_init(&whole);
    check_defaults(&of_deform, deform_defaults, &whole);
    check_defaults(&of_guard, guard_defaults, &a_guard_def);
    check_defaults(&of_coupling, coupling_defaults, &a_coupling_def);
    check_defaults(&of_passivity, passivity_defaults, &a_passivity_def);
}

/* Where the shadow begins: at the nearest triangle. */
static int find_triangle(void)
{
    dpt_hit nearest = DPT_HIT_INIT;
    dpt_result result = dpt_tool_get_hit(world, tool, &nearest);
    a_shadow.triangle = nearest.triangle;
    return result == DPT_OK;
}

static int open_all(void)
{
    static uint64_t block[1 << 18], strip_block[1 << 13];
    const dpt_pose identity = DPT_POSE_IDENTITY;
    dpt_mesh_info info = { .size = sizeof info };
    if (!fixture_from_shape(&fixture, "box", 12) || dpt_mesh_get_info(fixture.mesh, &info) != DPT_OK)
        return 0;
    for (int k = 0; k < 3; k++) {
        segment.a[k] = 0.5 * (info.box_min[k] + info.box_max[k]);
        segment.b[k] = segment.a[k] + (k == 2 ? info.box_max[k] - info.box_min[k] : 0.001);
    }
    segment.radius = 0.001;
    dpt_guard_def_init(&a_guard_def);
    dpt_deformable_def_init(&a_deform_def);
    a_deform_def.mesh = fixture.mesh;
    a_guard.size = sizeof a_guard;
    dpt_coupling_def_init(&a_coupling_def);
    dpt_passivity_def_init(&a_passivity_def);
    a_passivity.size = sizeof a_passivity;
    dpt_world_def_init(&defaults);
    dpt_world_def_init(&a_world_def);
    a_world_def.max_contacts = 32;
    a_world_def.law = DPT_LAW_BED;
    a_world_def.strip = DPT_STRIP_KIND_SHADOW;
    a_world_def.max_segments = 1;
    a_world_def.max_bodies = 2;
    a_world_def.certificate_bytes = 4096;
    a_shadow = (dpt_shadow){ .size = sizeof a_shadow, .segment = segment, .direction = { 0, 0, 1 }, .depth = 1.0 };
    a_joint = (dpt_arm_joint){ .size = sizeof a_joint, .kind = DPT_JOINT_CONTINUOUS };
    a_link = (dpt_arm_link){
        .size = sizeof a_link, .parent = DPT_NONE, .pose = identity, .axis = { 0, 0, 1 }, .factor = 1.0
    };
    a_body = (dpt_arm_body){ .size = sizeof a_body, .pose = identity, .mesh = fixture.mesh };
    an_arm_def = arm_of(&a_joint, &a_link, &a_body);
    return dpt_guard_init(&a_guard, &a_guard_def) == DPT_OK &&
           dpt_passivity_init(&a_passivity, &a_passivity_def) == DPT_OK &&
           dpt_record_header_write(&a_record_header, recording, sizeof recording, &first_record) == DPT_OK &&
           dpt_record_write(&a_record, 1, recording + first_record, sizeof recording - first_record,
                            &recording_bytes) == DPT_OK &&
           dpt_compile_arm(&an_arm_def, &arm_bytes, NULL) == DPT_OK &&
           dpt_arm_open(arm_bytes.bytes, arm_bytes.size, &arm) == DPT_OK &&
           dpt_world_bytes(&a_world_def) <= sizeof block &&
           dpt_world_create(block, sizeof block, &a_world_def, &world) == DPT_OK &&
           dpt_body_add(world, fixture.mesh, NULL, &body) == DPT_OK &&
           dpt_tool_add(world, &segment, 1, &tool) == DPT_OK && dpt_world_step(world, 0.001, NULL) == DPT_OK &&
           find_triangle() && dpt_strip_create(strip_block, sizeof strip_block, &a_strip_def, &strip) == DPT_OK &&
           dpt_strip_shadow(strip, fixture.mesh, NULL, &a_shadow) == DPT_OK;
}

int main(void)
{
    if (!open_all()) {
        puts("  FAIL nothing to ask");
        check_failed++;
        return check_report();
    }
    TEST(outputs_are_filled_as_far_as_they_go);
    TEST(inputs_are_taken_as_far_as_they_go);
    TEST(arrays_go_by_the_first_size);
    TEST(defaults_fill_what_fits);
    dpt_compiled_free(&arm_bytes);
    fixture_free(&fixture);
    return check_report();
}
