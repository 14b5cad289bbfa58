/* SPDX-License-Identifier: BSD-3-Clause */
/* What dpt_compile_arm writes of an arm comes back when it is opened; what it refuses, it says in words. */
#include "arm/whole_arm.h"
#include "lib/check.h"
#include "lib/size_checks.h"

static void expect_link(const dpt_arm_link *is, const dpt_arm_link *should)
{
    CHECK(is->parent == should->parent && is->joint == should->joint && is->slides == should->slides &&
              is->factor == should->factor && is->offset == should->offset && is->mass == should->mass,
          "a link with another number");
    for (int k = 0; k < 3; k++)
        CHECK(is->pose.position[k] == should->pose.position[k] && fabs(is->axis[k] - should->axis[k]) < 1e-15 &&
                  is->centre[k] == should->centre[k],
              "a link elsewhere");
    for (int k = 0; k < 4; k++)
        CHECK(fabs(is->pose.orientation[k] - should->pose.orientation[k]) < 1e-15, "turned");
}

static void what_is_compiled_comes_back(void)
{
    struct arm_arrays arrays;
    dpt_arm_info info = { .size = sizeof info };
    dpt_arm_joint joint = { .size = sizeof joint };
    dpt_arm_link link = { .size = sizeof link };
    dpt_arm_body body = { .size = sizeof body };
    dpt_segment segment;
    const dpt_arm *arm = NULL;
    whole_arm(&arrays);
    CHECK(dpt_arm_open(whole.bytes, whole.size, &arm) == DPT_OK && (const void *)arm == whole.bytes, "it opens");
    CHECK(dpt_arm_get_info(arm, &info) == DPT_OK, "info");
    CHECK(info.format_version == 2 && info.joints == JOINTS && info.links == LINKS && info.segments == SEGMENTS &&
              info.bodies == BODIES && info.jaws == JAWS && info.jaw_links == JAW_LINKS && info.tips == TIPS &&
              info.tool_link == 2 && info.mass == 5.5 && info.source_bytes == 1234 &&
              info.source_hash == 0x0123456789abcdefu && info.bytes == whole.size,
          "another info");
    CHECK(!memcmp(&info.tool, &arrays.def.tool, sizeof info.tool), "another tool");
    CHECK(!strcmp(info.name, "lift") && !strcmp(info.root_name, "floor") && !strcmp(info.tool_name, "tip"), "%s %s %s",
          info.name, info.root_name, info.tool_name);
    for (uint32_t i = 0; i < JOINTS; i++) {
        CHECK(dpt_arm_get_joint(arm, i, &joint) == DPT_OK, "joint %u", i);
        CHECK(!memcmp(&joint, &arrays.joints[i], sizeof joint), "joint %u", i);
    }
    for (uint32_t i = 0; i < LINKS; i++) {
        CHECK(dpt_arm_get_link(arm, i, &link) == DPT_OK, "link %u", i);
        expect_link(&link, &arrays.links[i]);
    }
    for (uint32_t i = 0; i < JAWS; i++) {
        CHECK(dpt_arm_get_jaw(arm, i, &joint) == DPT_OK, "jaw %u", i);
        CHECK(!memcmp(&joint, &arrays.jaws[i], sizeof joint), "jaw %u", i);
    }
    for (uint32_t i = 0; i < JAW_LINKS; i++) {
        CHECK(dpt_arm_get_jaw_link(arm, i, &link) == DPT_OK, "jaw link %u", i);
        expect_link(&link, &arrays.jaw_links[i]);
    }
    for (uint32_t i = 0; i < TIPS; i++) {
        dpt_arm_tip tip = { .size = sizeof tip };
        const dpt_arm_tip *from = &arrays.tips[i];
        CHECK(dpt_arm_get_tip(arm, i, &tip) == DPT_OK, "tip %u", i);
        CHECK(tip.link == from->link && tip.corner_count == from->corner_count && tip.radius == from->radius &&
                  !strcmp(tip.name, from->name) && !memcmp(tip.corners, from->corners, 24 * from->corner_count) &&
                  (const unsigned char *)tip.corners > whole.bytes,
              "tip %u", i);
    }
    for (uint32_t i = 0; i < SEGMENTS; i++) {
        CHECK(dpt_arm_get_segment(arm, i, &segment) == DPT_OK, "segment %u", i);
        CHECK(!memcmp(&segment, &arrays.segments[i], sizeof segment), "segment %u", i);
    }
    for (uint32_t i = 0; i < BODIES; i++) {
        const dpt_mesh *mesh;
        CHECK(dpt_arm_get_body(arm, i, &body) == DPT_OK, "body %u", i);
        CHECK(!memcmp(&body.pose, &arrays.bodies[i].pose, sizeof body.pose) &&
                  !strcmp(body.name, arrays.bodies[i].name),
              "body %u", i);
        const unsigned char *at = (const void *)body.mesh;
        CHECK(at > whole.bytes && (size_t)(at - whole.bytes) % 64 == 0 && body.mesh_bytes == meshes[i].size &&
                  !memcmp(at, meshes[i].bytes, meshes[i].size),
              "mesh %u", i);
        CHECK(dpt_mesh_open(at, body.mesh_bytes, &mesh) == DPT_OK && mesh == body.mesh, "mesh %u", i);
    }
}

static void what_is_not_there_is_refused(void)
{
    dpt_arm_info info = { .size = sizeof info };
    dpt_arm_joint joint = { .size = sizeof joint };
    dpt_arm_link link = { .size = sizeof link };
    dpt_arm_body body = { .size = sizeof body };
    dpt_segment segment;
    const dpt_arm *arm = NULL;
    CHECK(dpt_arm_open(whole.bytes, whole.size, &arm) == DPT_OK, "it opens");
    CHECK(dpt_arm_get_joint(arm, JOINTS, &joint) == DPT_E_ARGUMENT &&
              dpt_arm_get_link(arm, LINKS, &link) == DPT_E_ARGUMENT &&
              dpt_arm_get_segment(arm, SEGMENTS, &segment) == DPT_E_ARGUMENT &&
              dpt_arm_get_body(arm, BODIES, &body) == DPT_E_ARGUMENT,
          "an index beyond");
    CHECK(dpt_arm_get_info(NULL, &info) == DPT_E_ARGUMENT && dpt_arm_get_info(arm, NULL) == DPT_E_ARGUMENT &&
              dpt_arm_get_joint(NULL, 0, &joint) == DPT_E_ARGUMENT &&
              dpt_arm_get_joint(arm, 0, NULL) == DPT_E_ARGUMENT && dpt_arm_get_link(NULL, 0, &link) == DPT_E_ARGUMENT &&
              dpt_arm_get_link(arm, 0, NULL) == DPT_E_ARGUMENT &&
              dpt_arm_get_segment(NULL, 0, &segment) == DPT_E_ARGUMENT &&
              dpt_arm_get_segment(arm, 0, NULL) == DPT_E_ARGUMENT &&
              dpt_arm_get_body(NULL, 0, &body) == DPT_E_ARGUMENT && dpt_arm_get_body(arm, 0, NULL) == DPT_E_ARGUMENT,
          "NULL");
    dpt_arm_tip tip = { .size = sizeof tip };
    const double two_jaws[JAWS] = { 0.0 }, no_number[JAWS] = { 0.0, NAN };
    dpt_pose pose;
    CHECK(dpt_arm_get_jaw(arm, JAWS, &joint) == DPT_E_ARGUMENT && dpt_arm_get_jaw(NULL, 0, &joint) == DPT_E_ARGUMENT &&
              dpt_arm_get_jaw(arm, 0, NULL) == DPT_E_ARGUMENT &&
              dpt_arm_get_jaw_link(arm, JAW_LINKS, &link) == DPT_E_ARGUMENT &&
              dpt_arm_get_jaw_link(NULL, 0, &link) == DPT_E_ARGUMENT &&
              dpt_arm_get_jaw_link(arm, 0, NULL) == DPT_E_ARGUMENT &&
              dpt_arm_get_tip(arm, TIPS, &tip) == DPT_E_ARGUMENT && dpt_arm_get_tip(NULL, 0, &tip) == DPT_E_ARGUMENT &&
              dpt_arm_get_tip(arm, 0, NULL) == DPT_E_ARGUMENT,
          "tips");
    CHECK(dpt_arm_tip_pose(arm, TIPS, two_jaws, &pose) == DPT_E_ARGUMENT &&
              dpt_arm_tip_pose(NULL, 0, two_jaws, &pose) == DPT_E_ARGUMENT &&
              dpt_arm_tip_pose(arm, 0, NULL, &pose) == DPT_E_ARGUMENT &&
              dpt_arm_tip_pose(arm, 0, two_jaws, NULL) == DPT_E_ARGUMENT &&
              dpt_arm_tip_pose(arm, 0, no_number, &pose) == DPT_E_FINITE,
          "poses of tips");
    info.size = offsetof(dpt_arm_info, jaws) - 1;
    joint.size--;
    link.size--;
    body.size--;
    CHECK(dpt_arm_get_info(arm, &info) == DPT_E_SIZE && dpt_arm_get_joint(arm, 0, &joint) == DPT_E_SIZE &&
              dpt_arm_get_link(arm, 0, &link) == DPT_E_SIZE && dpt_arm_get_body(arm, 0, &body) == DPT_E_SIZE,
          "sizes");
}

static dpt_result get_tip(void *out)
{
    const dpt_arm *arm;
    dpt_arm_open(whole.bytes, whole.size, &arm);
    return dpt_arm_get_tip(arm, 1, out);
}

static dpt_result compile_tip(void *given)
{
    struct arm_arrays arrays;
    dpt_compiled out;
    whole_arm(&arrays);
    arrays.def.jaw_count = arrays.def.jaw_link_count = 0;
    arrays.def.tip_count = 1;
    arrays.def.tips = given;
    const dpt_result result = dpt_compile_arm(&arrays.def, &out, NULL);
    dpt_compiled_free(&out);
    return result;
}

static void tips_go_by_their_size(void)
{
    const struct sized taken = { "dpt_arm_tip", sizeof(dpt_arm_tip), sizeof(dpt_arm_tip), compile_tip };
    const struct sized filled = { "dpt_arm_tip", sizeof(dpt_arm_tip), sizeof(dpt_arm_tip), get_tip };
    check_input(&taken, &lift.tips[0]);
    check_output(&filled);
}

/* A fixed tip, one that turns about an oblique axis, and one that slides on one that turns about y: closed forms. */
static void tips_go_with_their_jaws(void)
{
    static const double identity[7] = { 0, 0, 0, 1, 0, 0, 0 };
    const dpt_arm *arm;
    dpt_pose pose;
    dpt_arm_open(whole.bytes, whole.size, &arm);
    for (int i = 0; i < 20; i++) {
        const double jaws[JAWS] = { 0.1 * i - 0.4, 0.001 * i };
        CHECK(dpt_arm_tip_pose(arm, 0, jaws, &pose) == DPT_OK && !memcmp(&pose, identity, sizeof pose),
              "the fixed tip moves");
        CHECK(dpt_arm_tip_pose(arm, 1, jaws, &pose) == DPT_OK, "the second");
        const double half = 0.5 * (0.1 - jaws[0]);
        const double *q = pose.orientation, *p = pose.position;
        CHECK(fabs(q[0] - cos(half)) < 1e-14 && fabs(q[1]) < 1e-14 && fabs(q[2] - 0.6 * sin(half)) < 1e-14 &&
                  fabs(q[3] + 0.8 * sin(half)) < 1e-14 && p[0] == 0 && p[1] == 0.01 && p[2] == 0.1,
              "coordinate %g: turned %g %g %g %g", jaws[0], q[0], q[1], q[2], q[3]);
        CHECK(dpt_arm_tip_pose(arm, 2, jaws, &pose) == DPT_OK, "the third");
        const double turn = 2 * atan2(0.8, 0.6) + jaws[0];
        CHECK(fabs(p[0] - (0.02 * cos(turn) + jaws[1] * sin(turn))) < 1e-14 && p[1] == 0 &&
                  fabs(p[2] - (0.1 - 0.02 * sin(turn) + jaws[1] * cos(turn))) < 1e-14,
              "coordinates %g, %g: at %g %g %g", jaws[0], jaws[1], p[0], p[1], p[2]);
        /* about y, then by (0.5, 0.5, -0.5, 0.5) */
        const double w = 0.5 * cos(turn / 2), s = 0.5 * sin(turn / 2);
        CHECK(fabs(q[0] - (w + s)) < 1e-14 && fabs(q[1] - (w + s)) < 1e-14 && fabs(q[2] - (s - w)) < 1e-14 &&
                  fabs(q[3] - (w - s)) < 1e-14,
              "turned %g %g %g %g", q[0], q[1], q[2], q[3]);
    }
}

/* A change to the arrays of `whole_arm`, and what is then said. */
struct refusal {
    void *at;
    size_t width;
    const void *to;
    dpt_result code;
    const char *text;
};

/* The arrays that are changed, and what they are changed to. */
static struct arm_arrays a;
static char longest[DPT_ARM_NAME + 8], unended[DPT_ARM_NAME];
static const double nan_value = NAN, minus = -1.0, huge = 1.1e6, zero = 0.0, near = 1.000002;
static const uint32_t none = DPT_NONE, zeros = 0, one = 1, two = 2, three = 3, many = 65;
static const char *const long_name = longest;
static const void *const null = NULL;

#define CHANGED(field, value) &a.field, sizeof a.field, &(value)
static const struct refusal refusals[] = {
    { CHANGED(def.size, three), DPT_E_SIZE, "the def's size field is not set" },
    { CHANGED(def.joint_count, zeros), DPT_E_LIMIT, "0 joints: an arm has 1 to 8" },
    { CHANGED(def.joint_count, many), DPT_E_LIMIT, "65 joints: an arm has 1 to 8" },
    { CHANGED(def.link_count, zeros), DPT_E_LIMIT, "0 links: an arm has 1 to 64" },
    { CHANGED(def.link_count, many), DPT_E_LIMIT, "65 links: an arm has 1 to 64" },
    { CHANGED(def.segment_count, many), DPT_E_LIMIT, "65 segments: an arm has 0 to 64" },
    { CHANGED(def.body_count, many), DPT_E_LIMIT, "65 bodies: an arm has 0 to 64" },
    { CHANGED(def.joints, null), DPT_E_ARGUMENT, "no array of joints" },
    { CHANGED(def.links, null), DPT_E_ARGUMENT, "no array of links" },
    { CHANGED(def.segments, null), DPT_E_ARGUMENT, "no array of segments" },
    { CHANGED(def.bodies, null), DPT_E_ARGUMENT, "no array of bodies" },
    { CHANGED(def.reserved, long_name), DPT_E_ARGUMENT, "the def's reserved fields are not 0" },
    { CHANGED(def.tool_link, three), DPT_E_INDEX, "the tool: tool_link is no link" },
    { CHANGED(def.tool.position[1], nan_value), DPT_E_FINITE, "the tool: its position is not within 1e6 m" },
    { CHANGED(def.tool.orientation[0], near), DPT_E_POSE,
      "the tool: its orientation (w, x, y, z) is not of unit length" },
    { CHANGED(def.name, long_name), DPT_E_LIMIT, "name, root_name or tool_name has more than 63 bytes" },
    { CHANGED(def.root_name, long_name), DPT_E_LIMIT, "name, root_name or tool_name has more than 63 bytes" },
    { CHANGED(def.tool_name, long_name), DPT_E_LIMIT, "name, root_name or tool_name has more than 63 bytes" },
    { CHANGED(joints[0].size, three), DPT_E_SIZE, "joint 0: its size is not set" },
    { CHANGED(joints[1].kind, three), DPT_E_INDEX, "joint 1, elbow: there is no such kind" },
    { CHANGED(joints[0].kind, zeros), DPT_E_INDEX, "joint 0, rail: no link moves by it as its kind says" },
    { CHANGED(joints[0].lower, nan_value), DPT_E_FINITE,
      "joint 0, rail: its lower limit is not within 1e6, or not 0 though it is continuous" },
    { CHANGED(joints[1].upper, huge), DPT_E_FINITE,
      "joint 1, elbow: its upper limit is below the lower, or above 1e6" },
    { CHANGED(joints[0].velocity, minus), DPT_E_FINITE, "joint 0, rail: its velocity is negative or not finite" },
    { CHANGED(joints[0].effort, nan_value), DPT_E_FINITE, "joint 0, rail: its effort is negative or not finite" },
    { CHANGED(joints[0].damping, nan_value), DPT_E_FINITE, "joint 0, rail: its damping is negative or not finite" },
    { CHANGED(joints[0].friction, minus), DPT_E_FINITE, "joint 0, rail: its friction is negative or not finite" },
    { CHANGED(joints[1].name, unended), DPT_E_LIMIT, "joint 1: its name has more than 63 bytes" },
    { CHANGED(links[0].size, three), DPT_E_SIZE, "link 0: its size is not set" },
    { CHANGED(links[1].parent, two), DPT_E_INDEX, "link 1, elbow: its parent is no link before it" },
    { CHANGED(links[1].joint, none), DPT_E_INDEX,
      "link 1: its joint is not there, or comes too early on the way to the tool" },
    { CHANGED(links[0].joint, one), DPT_E_INDEX,
      "link 0, elbow: its joint is not there, or comes too early on the way to the tool" },
    { CHANGED(links[0].slides, two), DPT_E_INDEX, "link 0, rail: slides is neither 0 nor 1" },
    { CHANGED(links[2].pose.position[2], huge), DPT_E_FINITE, "link 2, elbow: its position is not within 1e6 m" },
    { CHANGED(links[2].pose.orientation[0], near), DPT_E_POSE,
      "link 2, elbow: its orientation (w, x, y, z) is not of unit length" },
    { CHANGED(links[0].axis[2], zero), DPT_E_POSE, "link 0, rail: its axis is not of unit length" },
    { CHANGED(links[1].factor, zero), DPT_E_FINITE, "link 1, elbow: its factor is 0 or not within 1e6" },
    { CHANGED(links[1].offset, huge), DPT_E_FINITE, "link 1, elbow: its offset is not within 1e6" },
    { CHANGED(links[1].mass, minus), DPT_E_FINITE, "link 1, elbow: its mass is negative, or above 1e6 kg" },
    { CHANGED(links[1].centre[0], nan_value), DPT_E_FINITE, "link 1, elbow: its centre is not within 1e6 m" },
    { CHANGED(segments[1].a[1], nan_value), DPT_E_FINITE, "segment 1: an end is not within 1e6 m" },
    { CHANGED(segments[1].b[2], huge), DPT_E_FINITE, "segment 1: an end is not within 1e6 m" },
    { CHANGED(segments[0].radius, minus), DPT_E_FINITE, "segment 0: its radius is negative, or above 1e6 m" },
    { CHANGED(bodies[0].size, three), DPT_E_SIZE, "body 0: its size is not set" },
    { CHANGED(bodies[1].mesh, null), DPT_E_ARGUMENT, "body 1: it has no mesh" },
    { CHANGED(bodies[1].pose.position[0], nan_value), DPT_E_FINITE, "body 1, lamp: its position is not within 1e6 m" },
    { CHANGED(bodies[0].pose.orientation[0], near), DPT_E_POSE,
      "body 0, table: its orientation (w, x, y, z) is not of unit length" },
    { CHANGED(bodies[0].name, unended), DPT_E_LIMIT, "body 0: its name has more than 63 bytes" },
    { CHANGED(def.reserved_word, one), DPT_E_ARGUMENT, "the def's reserved fields are not 0" },
    { CHANGED(def.reserved_pointer, long_name), DPT_E_ARGUMENT, "the def's reserved fields are not 0" },
    { CHANGED(def.jaw_count, many), DPT_E_LIMIT, "65 jaws: an arm has 0 to 8" },
    { CHANGED(def.jaw_link_count, many), DPT_E_LIMIT, "65 jaw links: an arm has 0 to 64" },
    { CHANGED(def.tip_count, many), DPT_E_LIMIT, "65 tips: an arm has 0 to 64" },
    { CHANGED(def.tip_count, zeros), DPT_E_ARGUMENT, "jaws, and no tip that they move" },
    { CHANGED(def.jaws, null), DPT_E_ARGUMENT, "no array of jaws" },
    { CHANGED(def.jaw_links, null), DPT_E_ARGUMENT, "no array of jaw links" },
    { CHANGED(def.tips, null), DPT_E_ARGUMENT, "no array of tips" },
    { CHANGED(jaws[0].size, three), DPT_E_SIZE, "jaw 0: its size is not set" },
    { CHANGED(jaws[1].kind, three), DPT_E_INDEX, "jaw 1, slide: there is no such kind" },
    { CHANGED(jaws[1].kind, zeros), DPT_E_INDEX, "jaw 1, slide: no link moves by it as its kind says" },
    { CHANGED(jaws[1].name, unended), DPT_E_LIMIT, "jaw 1: its name has more than 63 bytes" },
    { CHANGED(jaw_links[0].size, three), DPT_E_SIZE, "jaw link 0: its size is not set" },
    { CHANGED(jaw_links[1].parent, two), DPT_E_INDEX, "jaw link 1, squeeze: its parent is no link before it" },
    { CHANGED(jaw_links[2].factor, zero), DPT_E_FINITE, "jaw link 2, slide: its factor is 0 or not within 1e6" },
    { CHANGED(tips[0].size, three), DPT_E_SIZE, "tip 0: its size is not set" },
    { CHANGED(tips[1].link, three), DPT_E_INDEX, "tip 1, jaw: it is fixed to no jaw link" },
    { CHANGED(tips[1].corners, null), DPT_E_ARGUMENT, "tip 1: it has no corners, or not 3 to 64 of them" },
    { CHANGED(tips[1].corner_count, two), DPT_E_ARGUMENT, "tip 1: it has no corners, or not 3 to 64 of them" },
    { CHANGED(tips[2].corner_count, many), DPT_E_ARGUMENT, "tip 2: it has no corners, or not 3 to 64 of them" },
    { CHANGED(tips[1].radius, minus), DPT_E_FINITE, "tip 1, jaw: its radius is negative, or above 1e6 m" },
    { CHANGED(tips[2].name, unended), DPT_E_LIMIT, "tip 2: its name has more than 63 bytes" },
};

static void refusals_name_what_is_wrong(void)
{
    memset(longest, 'x', sizeof longest - 1);
    memset(unended, '\n', sizeof unended);
    for (size_t row = 0; row < sizeof refusals / sizeof *refusals; row++) {
        const struct refusal *refusal = &refusals[row];
        dpt_compiled out = { &out, 1 };
        dpt_diag diag = { .size = sizeof diag };
        whole_arm(&a);
        memcpy(refusal->at, refusal->to, refusal->width);
        dpt_result result = dpt_compile_arm(&a.def, &out, &diag);
        CHECK(result == refusal->code && diag.code == result && !strcmp(diag.text, refusal->text), "row %zu: %s: %s",
              row, dpt_result_name(result), diag.text);
        CHECK(!out.bytes && !out.size, "row %zu: bytes", row);
        CHECK(dpt_compile_arm(&a.def, &out, NULL) == refusal->code, "row %zu without a diag", row);
    }
    dpt_compiled out;
    dpt_diag small = { .size = 8 };
    whole_arm(&a);
    CHECK(dpt_compile_arm(&a.def, NULL, NULL) == DPT_E_ARGUMENT &&
              dpt_compile_arm(NULL, &out, NULL) == DPT_E_ARGUMENT &&
              dpt_compile_arm(&a.def, &out, &small) == DPT_E_SIZE,
          "arguments");
}

static int no_memory;

void *__real_calloc(size_t count, size_t size);
void *__wrap_calloc(size_t count, size_t size);
void *__wrap_calloc(size_t count, size_t size)
{
    return no_memory ? NULL : __real_calloc(count, size);
}

static void no_memory_is_an_error(void)
{
    struct arm_arrays arrays;
    dpt_compiled out = { &out, 1 };
    dpt_diag diag = { .size = sizeof diag };
    whole_arm(&arrays);
    no_memory = 1;
    CHECK(dpt_compile_arm(&arrays.def, &out, &diag) == DPT_E_MEMORY && !out.bytes && !out.size, "%s", diag.text);
    no_memory = 0;
    CHECK(!strcmp(diag.text, "memory ran out"), "%s", diag.text);
}

static void a_damaged_mesh_is_not_taken(void)
{
    struct arm_arrays arrays;
    struct file mesh = copy_of(&meshes[0]);
    dpt_compiled out;
    dpt_diag diag = { .size = sizeof diag };
    whole_arm(&arrays);
    mesh.bytes[960] ^= 1;
    arrays.bodies[1].mesh = (const void *)mesh.bytes;
    CHECK(dpt_compile_arm(&arrays.def, &out, &diag) == DPT_E_CHECKSUM && !out.bytes &&
              !strcmp(diag.text, "a body's mesh is damaged"),
          "%s", diag.text);
    free(mesh.bytes);
}

/* Within 1e-6 of unit length is made so; what stands behind a name is not kept. */
static void nearly_right_is_made_right(void)
{
    struct arm_arrays arrays;
    whole_arm(&arrays);
    for (int k = 0; k < 4; k++) {
        arrays.def.tool.orientation[k] *= 1.0 + 9e-7;
        arrays.links[1].pose.orientation[k] *= 1.0 - 9e-7;
        arrays.bodies[1].pose.orientation[k] *= 1.0 + 9e-7;
    }
    for (int k = 0; k < 3; k++)
        arrays.links[2].axis[k] *= 1.0 - 9e-7;
    arrays.joints[0].name[20] = 'x';
    arrays.bodies[0].name[63] = 'x';
    struct arm arm = arm_of(&arrays.def);
    for (uint32_t i = 0; arm.open && i < LINKS; i++) {
        dpt_arm_link link = { .size = sizeof link };
        struct arm_arrays right;
        whole_arm(&right);
        dpt_arm_get_link(arm.open, i, &link);
        expect_link(&link, &right.links[i]);
    }
    CHECK(arm.file.size == whole.size &&
              !memcmp((char *)arm.file.bytes + AT_JOINTS, whole.bytes + AT_JOINTS, JOINTS * JOINT),
          "another name");
    dpt_compiled_free(&arm.file);
}

int main(void)
{
    make_whole();
    TEST(what_is_compiled_comes_back);
    TEST(what_is_not_there_is_refused);
    TEST(tips_go_with_their_jaws);
    TEST(tips_go_by_their_size);
    TEST(refusals_name_what_is_wrong);
    TEST(nearly_right_is_made_right);
    TEST(no_memory_is_an_error);
    TEST(a_damaged_mesh_is_not_taken);
    free_whole();
    return check_report();
}
