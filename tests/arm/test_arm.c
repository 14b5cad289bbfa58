/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The file of an arm: what is compiled comes back; for each check of the reader a damaged file that it alone refuses,
 * with a code, a byte and a section; what the compiler refuses, it says in words.
 *
 *     test_arm [GOLDEN [ARM_OPEN]]
 *     test_arm write FILE
 *
 * GOLDEN is the folder golden, ARM_OPEN the source of the reader (sites.h); from the top of the tree they are found
 * without. golden/arm_1_mesh_4.dpa is what `write` wrote, `whole_arm` below; arm_1.dpa the same when meshes were of
 * version 3. They are to be kept: a new format, of an arm or of a mesh, gets a file beside them.
 */
#include "arm/arm_format.h"
#include "lib/arm_random.h"
#include "lib/dpa.h"
#include "lib/sites.h"

static const char *golden = "tests/golden", *reader = "src/arm/arm_open.c";

/* As the format has them: not by the library's structs. */
enum { HEADER = 320, JOINT = 120, LINK = 144, SEGMENT = 56, BODY = 136 };
enum { JOINTS = 2, LINKS = 3, SEGMENTS = 2, BODIES = 2 };
enum {
    AT_JOINTS = HEADER,
    AT_LINKS = AT_JOINTS + JOINTS * JOINT,
    AT_SEGMENTS = AT_LINKS + LINKS * LINK,
    AT_BODIES = AT_SEGMENTS + SEGMENTS * SEGMENT,
    AT_END = AT_BODIES + BODIES * BODY
};

static struct file meshes[BODIES]; /* in the host's byte order, as all here */
static struct file whole;

/* A lift that turns a bar, at whose end a link mimics the turn; two meshes around. */
static void whole_arm(struct arm_arrays *arm)
{
    *arm = (struct arm_arrays){
        .def = { .size = sizeof arm->def,
                 .joint_count = JOINTS,
                 .link_count = LINKS,
                 .segment_count = SEGMENTS,
                 .body_count = BODIES,
                 .tool_link = 2,
                 .tool = { { 0.0, 0.0, 0.125 }, { 0.5, 0.5, -0.5, 0.5 } },
                 .name = "lift",
                 .root_name = "floor",
                 .tool_name = "tip",
                 .source_bytes = 1234,
                 .source_hash = 0x0123456789abcdefu },
        .joints = { { .size = sizeof(dpt_arm_joint),
                      .kind = DPT_JOINT_PRISMATIC,
                      .lower = -0.25,
                      .upper = 0.5,
                      .velocity = 0.3,
                      .effort = 100.0,
                      .damping = 2.0,
                      .friction = 0.5,
                      .name = "rail" },
                    { .size = sizeof(dpt_arm_joint),
                      .kind = DPT_JOINT_CONTINUOUS,
                      .name = "elbow" } },
        .links = { { .size = sizeof(dpt_arm_link),
                     .parent = DPT_NONE,
                     .joint = 0,
                     .slides = 1,
                     .pose = DPT_POSE_IDENTITY,
                     .axis = { 0.0, 0.0, 1.0 },
                     .factor = 1.0,
                     .mass = 4.0 },
                   { .size = sizeof(dpt_arm_link),
                     .parent = 0,
                     .joint = 1,
                     .pose = { { 0.1, 0.2, 0.3 }, { 0.6, 0.0, 0.8, 0.0 } },
                     .axis = { 0.0, 1.0, 0.0 },
                     .factor = 1.0,
                     .offset = 0.25,
                     .mass = 1.5,
                     .centre = { 0.2, 0.0, 0.01 } },
                   { .size = sizeof(dpt_arm_link),
                     .parent = 1,
                     .joint = 1,
                     .pose = { { 0.4, 0.0, 0.0 }, { 1.0, 0.0, 0.0, 0.0 } },
                     .axis = { 0.0, 0.6, -0.8 },
                     .factor = -2.0 } },
        .segments = { { { 0.0, 0.0, 0.0 }, { 0.0, 0.0, 0.1 }, 0.004 },
                      { { 0.01, 0.0, 0.0 }, { 0.0, 0.02, 0.1 }, 0.0 } },
        .bodies = { { .size = sizeof(dpt_arm_body), .pose = DPT_POSE_IDENTITY, .name = "table" },
                    { .size = sizeof(dpt_arm_body),
                      .pose = { { 1.0, -2.0, 3.0 }, { 0.0, 0.0, 0.0, -1.0 } },
                      .name = "lamp" } },
    };
    arm->def.joints = arm->joints;
    arm->def.links = arm->links;
    arm->def.segments = arm->segments;
    arm->def.bodies = arm->bodies;
    for (int i = 0; i < BODIES; i++)
        arm->bodies[i].mesh = (const void *)meshes[i].bytes;
}

static void make_whole(void)
{
    struct arm_arrays arrays;
    meshes[0] = file_of_shape("box", 12);
    meshes[1] = file_of_holed_shape("sphere", 40, 1);
    whole_arm(&arrays);
    struct arm arm = arm_of(&arrays.def);
    whole = file_of(arm.file.bytes, arm.file.size);
    dpt_compiled_free(&arm.file);
}

static void expect_link(const dpt_arm_link *is, const dpt_arm_link *should)
{
    CHECK(is->parent == should->parent && is->joint == should->joint &&
              is->slides == should->slides && is->factor == should->factor &&
              is->offset == should->offset && is->mass == should->mass,
          "a link with another number");
    for (int k = 0; k < 3; k++)
        CHECK(is->pose.position[k] == should->pose.position[k] &&
                  fabs(is->axis[k] - should->axis[k]) < 1e-15 && is->centre[k] == should->centre[k],
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
    CHECK(dpt_arm_open(whole.bytes, whole.size, &arm) == DPT_OK && (const void *)arm == whole.bytes,
          "it opens");
    CHECK(dpt_arm_get_info(arm, &info) == DPT_OK, "info");
    CHECK(info.format_version == 1 && info.joints == JOINTS && info.links == LINKS &&
              info.segments == SEGMENTS && info.bodies == BODIES && info.tool_link == 2 &&
              info.mass == 5.5 && info.source_bytes == 1234 &&
              info.source_hash == 0x0123456789abcdefu && info.bytes == whole.size,
          "another info");
    CHECK(!memcmp(&info.tool, &arrays.def.tool, sizeof info.tool), "another tool");
    CHECK(!strcmp(info.name, "lift") && !strcmp(info.root_name, "floor") &&
              !strcmp(info.tool_name, "tip"),
          "%s %s %s", info.name, info.root_name, info.tool_name);
    for (uint32_t i = 0; i < JOINTS; i++) {
        CHECK(dpt_arm_get_joint(arm, i, &joint) == DPT_OK, "joint %u", i);
        CHECK(!memcmp(&joint, &arrays.joints[i], sizeof joint), "joint %u", i);
    }
    for (uint32_t i = 0; i < LINKS; i++) {
        CHECK(dpt_arm_get_link(arm, i, &link) == DPT_OK, "link %u", i);
        expect_link(&link, &arrays.links[i]);
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
        CHECK(at > whole.bytes && (size_t)(at - whole.bytes) % 64 == 0 &&
                  body.mesh_bytes == meshes[i].size && !memcmp(at, meshes[i].bytes, meshes[i].size),
              "mesh %u", i);
        CHECK(dpt_mesh_open(at, body.mesh_bytes, &mesh) == DPT_OK && mesh == body.mesh, "mesh %u",
              i);
    }
    CHECK(dpt_arm_get_joint(arm, JOINTS, &joint) == DPT_E_ARGUMENT &&
              dpt_arm_get_link(arm, LINKS, &link) == DPT_E_ARGUMENT &&
              dpt_arm_get_segment(arm, SEGMENTS, &segment) == DPT_E_ARGUMENT &&
              dpt_arm_get_body(arm, BODIES, &body) == DPT_E_ARGUMENT,
          "an index beyond");
    CHECK(dpt_arm_get_info(NULL, &info) == DPT_E_ARGUMENT &&
              dpt_arm_get_info(arm, NULL) == DPT_E_ARGUMENT &&
              dpt_arm_get_joint(NULL, 0, &joint) == DPT_E_ARGUMENT &&
              dpt_arm_get_joint(arm, 0, NULL) == DPT_E_ARGUMENT &&
              dpt_arm_get_link(NULL, 0, &link) == DPT_E_ARGUMENT &&
              dpt_arm_get_link(arm, 0, NULL) == DPT_E_ARGUMENT &&
              dpt_arm_get_segment(NULL, 0, &segment) == DPT_E_ARGUMENT &&
              dpt_arm_get_segment(arm, 0, NULL) == DPT_E_ARGUMENT &&
              dpt_arm_get_body(NULL, 0, &body) == DPT_E_ARGUMENT &&
              dpt_arm_get_body(arm, 0, NULL) == DPT_E_ARGUMENT,
          "NULL");
    info.size--;
    joint.size--;
    link.size--;
    body.size--;
    CHECK(dpt_arm_get_info(arm, &info) == DPT_E_SIZE &&
              dpt_arm_get_joint(arm, 0, &joint) == DPT_E_SIZE &&
              dpt_arm_get_link(arm, 0, &link) == DPT_E_SIZE &&
              dpt_arm_get_body(arm, 0, &body) == DPT_E_SIZE,
          "sizes");
}

enum seal { AS_IT_IS, SEALED };
enum change { SET, CUT, GROW, SHIFT, NO_BYTES };

struct damage {
    enum change change;
    int64_t at; /* CUT and GROW: by how many bytes */
    int width;  /* of what is set, 4 or 8 */
    uint64_t value;
    enum seal seal;
    dpt_result code;
    const char *section;
    int64_t byte; /* THERE: of what was changed */
};

#define THERE (-1)

static uint64_t bits(double number)
{
    uint64_t is;
    memcpy(&is, &number, sizeof is);
    return is;
}

static void put(unsigned char *bytes, int64_t at, int width, uint64_t value)
{
    const uint32_t half = (uint32_t)value;
    memcpy(bytes + at, width == 8 ? (const void *)&value : (const void *)&half, (size_t)width);
}

/* The checksum of these bytes, at its place, in the host's byte order. */
static void seal_arm(struct file *file)
{
    put(file->bytes, 20, 4, 0);
    put(file->bytes, 20, 4, crc_of(file->bytes, file->size));
}

static struct file damaged(const struct damage *damage, unsigned char **block)
{
    size_t size = whole.size;
    size += damage->change == GROW ? (size_t)damage->at : 0;
    size -= damage->change == CUT ? (size_t)damage->at : 0;
    *block = calloc(1, size + 8);
    struct file file = { *block + (damage->change == SHIFT ? damage->at : 0), size };
    memcpy(file.bytes, whole.bytes, size < whole.size ? size : whole.size);
    if (damage->change == SET)
        put(file.bytes, damage->at, damage->width, damage->value);
    else if (damage->seal == SEALED)
        put(file.bytes, 48, 8, size);
    if (damage->seal == SEALED)
        seal_arm(&file);
    if (damage->change == NO_BYTES)
        file.size = 0;
    return file;
}

/* As a machine of the other byte order holds it. Counts are those of `whole`. */
static struct file other_arm(const struct file *file)
{
    struct file other = copy_of(file);
    unsigned char *at = other.bytes + AT_JOINTS;
    for (int i = 0; i < BODIES; i++) {
        uint64_t offset;
        memcpy(&offset, other.bytes + AT_BODIES + i * BODY, 8);
        struct file turned = other_order(&meshes[i]);
        memcpy(other.bytes + offset, turned.bytes, turned.size);
        free(turned.bytes);
    }
    reverse(other.bytes + 8, 4, 10);
    reverse(other.bytes + 48, 8, 10);
    for (int i = 0; i < JOINTS; i++, at += JOINT) {
        reverse(at, 4, 2);
        reverse(at + 8, 8, 6);
    }
    for (int i = 0; i < LINKS; i++, at += LINK) {
        reverse(at, 4, 4);
        reverse(at + 16, 8, 16);
    }
    reverse(at, 8, SEGMENTS * SEGMENT / 8);
    at += SEGMENTS * SEGMENT;
    for (int i = 0; i < BODIES; i++, at += BODY)
        reverse(at, 8, 9);
    seal_arm(&other);
    reverse(other.bytes + 20, 4, 1);
    return other;
}

static void expect_row(const struct damage *damage, size_t row)
{
    unsigned char *block;
    struct file file = damaged(damage, &block);
    dpt_mesh_fault fault = { .size = sizeof fault };
    const dpt_arm *arm = NULL;
    const uint64_t byte = (uint64_t)(damage->byte == THERE ? damage->at : damage->byte);
    site = 0;
    dpt_result result = dpt_arm_verify(file.bytes, file.size, &fault);
    if (!strcmp(damage->section, "vertices"))
        CHECK(site == 0, "line %d refuses a mesh", site);
    else
        site_note();
    CHECK(result == damage->code && fault.code == result && fault.byte == byte &&
              !strcmp(fault.section, damage->section),
          "row %zu: %s at %llu (%s), line %d, not %s at %llu (%s)", row,
          dpt_result_name(fault.code), (unsigned long long)fault.byte, fault.section, site,
          dpt_result_name(damage->code), (unsigned long long)byte, damage->section);
    CHECK(dpt_arm_open(file.bytes, file.size, &arm) == damage->code && !arm, "row %zu opens", row);
    if (result != DPT_E_BYTE_ORDER)
        CHECK(dpt_arm_convert(file.bytes, file.size, NULL) == damage->code, "row %zu converts",
              row);
    /* In the other byte order it is refused for the same reason. */
    if (damage->seal == SEALED && damage->change == SET && damage->at >= AT_JOINTS &&
        damage->at < AT_BODIES) {
        struct file other = other_arm(&file);
        fault = (dpt_mesh_fault){ .size = sizeof fault };
        CHECK(dpt_arm_convert(other.bytes, other.size, &fault) == damage->code &&
                  fault.byte == byte && !strcmp(fault.section, damage->section),
              "row %zu, the other order: %s at %llu", row, dpt_result_name(fault.code),
              (unsigned long long)fault.byte);
        free(other.bytes);
    }
    free(block);
}

#define J(i, field)    (AT_JOINTS + (i)*JOINT + (int64_t)offsetof(dpt_arm_joint, field))
#define L(i, field)    (AT_LINKS + (i)*LINK + (int64_t)offsetof(dpt_arm_link, field))
#define S(i, field)    (AT_SEGMENTS + (i)*SEGMENT + (int64_t)offsetof(dpt_segment, field))
#define B(i, field)    (AT_BODIES + (i)*BODY + (int64_t)offsetof(struct arm_body, field))
#define H(field)       (int64_t) offsetof(struct dpt_arm, field)
#define WORD(at, to)   SET, at, 4, to, SEALED
#define WIDE(at, to)   SET, at, 8, to, SEALED
#define NUMBER(at, to) SET, at, 8, bits(to), SEALED

static void each_check_has_its_damage(void)
{
    const dpt_result layout = DPT_E_LAYOUT, index = DPT_E_INDEX, finite = DPT_E_FINITE,
                     unit = DPT_E_POSE;
    const int64_t size = (int64_t)whole.size, first = (AT_END + 63) / 64 * 64;
    const struct damage table[] = {
        /* begin */
        { SHIFT, 4, 0, 0, AS_IT_IS, DPT_E_ALIGN, "header", 0 },
        { NO_BYTES, 0, 0, 0, AS_IT_IS, DPT_E_TRUNCATED, "header", 0 },
        { SET, 0, 4, 0x20796c70, AS_IT_IS, DPT_E_MAGIC, "header", 0 },
        { CUT, size - 5, 0, 0, AS_IT_IS, DPT_E_TRUNCATED, "header", 5 },
        { WORD(H(byte_order), 0x01020403), layout, "header", THERE },
        /* dpt_arm_verify */
        { WORD(H(byte_order), MESH_BYTE_ORDER_SWAPPED), DPT_E_BYTE_ORDER, "header", THERE },
        /* check_header */
        { WORD(H(version), 2), DPT_E_VERSION, "header", THERE },
        { WORD(H(version), 0), layout, "header", THERE },
        { CUT, size - HEADER + 1, 0, 0, AS_IT_IS, DPT_E_TRUNCATED, "header", HEADER - 1 },
        { WORD(H(header_bytes), 312), layout, "header", THERE },
        { CUT, 1, 0, 0, AS_IT_IS, DPT_E_TRUNCATED, "header", size - 1 },
        { GROW, 1, 0, 0, AS_IT_IS, DPT_E_TRAILING, "header", size },
        { WORD(H(joints), 0), layout, "header", THERE },
        { WORD(H(joints), 9), layout, "header", THERE },
        { WORD(H(links), 0), layout, "header", THERE },
        { WORD(H(links), 65), layout, "header", THERE },
        { WORD(H(segments), 65), layout, "header", THERE },
        { WORD(H(bodies), 65), layout, "header", THERE },
        { CUT, size - AT_END + 8, 0, 0, SEALED, layout, "header", H(bytes) },
        /* check_crc */
        { SET, H(source_hash), 4, 1, AS_IT_IS, DPT_E_CHECKSUM, "header", H(crc32) },
        { SET, first + 1000, 4, 0x12345678, AS_IT_IS, DPT_E_CHECKSUM, "header", H(crc32) },
        /* check_meshes_place */
        { WIDE(B(0, mesh_offset), (uint64_t)first + 64), layout, "bodies", THERE },
        { WIDE(B(1, mesh_offset), (uint64_t)first), layout, "bodies", THERE },
        { CUT, size - AT_END, 0, 0, SEALED, layout, "bodies", B(0, mesh_offset) },
        { WIDE(B(0, mesh_bytes), (uint64_t)size - (uint64_t)first + 1), layout, "bodies", THERE },
        { WIDE(B(1, mesh_bytes), UINT64_MAX), layout, "bodies", THERE },
        { WORD(AT_END + 4, 0x01010101), layout, "padding", THERE },
        { GROW, 64, 0, 0, SEALED, layout, "header", size },
        /* check_joint */
        { WORD(J(1, size), 128), layout, "joints", THERE },
        { WORD(J(1, kind), 3), index, "joints", THERE },
        { NUMBER(J(0, lower), NAN), finite, "joints", THERE },
        { NUMBER(J(0, lower), -1.1e6), finite, "joints", THERE },
        { NUMBER(J(0, upper), -0.26), finite, "joints", THERE },
        { NUMBER(J(0, upper), INFINITY), finite, "joints", THERE },
        { NUMBER(J(1, lower), -1.0), finite, "joints", THERE },
        { NUMBER(J(1, upper), 1.0), finite, "joints", J(1, lower) },
        { NUMBER(J(0, velocity), -1.0), finite, "joints", THERE },
        { NUMBER(J(0, effort), INFINITY), finite, "joints", THERE },
        { NUMBER(J(0, damping), NAN), finite, "joints", THERE },
        { NUMBER(J(0, friction), -1e-9), finite, "joints", THERE },
        { WORD(J(0, name) + 60, 0x61616161), layout, "joints", J(0, name) },
        /* check_link */
        { WORD(L(2, size), 0), layout, "links", THERE },
        { WORD(L(1, parent), 1), index, "links", THERE },
        { WORD(L(0, parent), 0), index, "links", THERE },
        { WORD(L(2, joint), JOINTS), index, "links", THERE },
        { WORD(L(2, slides), 2), index, "links", THERE },
        { NUMBER(L(1, pose.position[1]), -1.1e6), finite, "links", THERE },
        { NUMBER(L(1, pose.orientation), 0.6000001), unit, "links", THERE },
        { NUMBER(L(1, pose.orientation[3]), NAN), unit, "links", L(1, pose.orientation) },
        { NUMBER(L(2, axis), 1.0), unit, "links", THERE },
        { NUMBER(L(2, factor), 0.0), finite, "links", THERE },
        { NUMBER(L(2, factor), -0.0), finite, "links", THERE },
        { NUMBER(L(2, factor), NAN), finite, "links", THERE },
        { NUMBER(L(2, offset), 1.1e6), finite, "links", THERE },
        { NUMBER(L(2, mass), -1.0), finite, "links", THERE },
        { NUMBER(L(2, centre[2]), INFINITY), finite, "links", THERE },
        /* check_content, check_order */
        { WORD(H(tool_link), LINKS), index, "header", THERE },
        { WORD(L(0, joint), 1), index, "links", THERE },
        { WORD(L(0, slides), 0), index, "joints", AT_JOINTS },
        { WORD(J(0, kind), DPT_JOINT_REVOLUTE), index, "joints", AT_JOINTS },
        { NUMBER(H(tool.position), NAN), finite, "header", THERE },
        { NUMBER(H(tool.orientation), 0.0), unit, "header", THERE },
        { WORD(H(name) + 8, 1), layout, "header", H(name) },
        { WORD(H(root_name) + 60, 1), layout, "header", H(root_name) },
        { WORD(H(tool_name) + 4, 1), layout, "header", H(tool_name) },
        { NUMBER(S(1, a[2]), 1.1e6), finite, "segments", THERE },
        { NUMBER(S(1, b), NAN), finite, "segments", THERE },
        { NUMBER(S(0, radius), -0.001), finite, "segments", THERE },
        { NUMBER(B(1, pose.position[2]), -INFINITY), finite, "bodies", THERE },
        { NUMBER(B(1, pose.orientation), 1.0), unit, "bodies", THERE },
        { WORD(B(0, name) + 16, 1), layout, "bodies", B(0, name) },
        /* The mesh's reader, of the second mesh: a section of its own, a byte of the arm's */
        { WORD((int64_t)(whole.size - meshes[1].size) + 960, 1), DPT_E_CHECKSUM, "vertices",
          THERE },
    };
    const size_t rows = sizeof table / sizeof *table;
    for (size_t row = 0; row < rows; row++)
        expect_row(&table[row], row);
}

/* 63 bytes and a zero are a name, 64 bytes are none. */
static void names_end(void)
{
    const int64_t names[] = { H(name), J(1, name), B(1, name) };
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        struct file file = copy_of(&whole);
        dpt_mesh_fault fault = { .size = sizeof fault };
        memset(file.bytes + names[i], 'x', DPT_ARM_NAME - 1);
        seal_arm(&file);
        CHECK(dpt_arm_verify(file.bytes, file.size, &fault) == DPT_OK, "name %zu of 63 bytes", i);
        file.bytes[names[i] + DPT_ARM_NAME - 1] = 'x';
        seal_arm(&file);
        CHECK(dpt_arm_verify(file.bytes, file.size, &fault) == DPT_E_LAYOUT &&
                  fault.byte == (uint64_t)names[i],
              "name %zu of 64 bytes", i);
        free(file.bytes);
    }
}

static void no_check_is_forgotten(void)
{
    site_expect_all(reader, 30);
}

/* A single wrong byte is always seen; with the checksum made good it is refused, or harmless. */
static void wrong_bytes_do_no_harm(void)
{
    uint64_t random = 8, taken = 0, refused = 0;
    for (size_t at = 0; at < whole.size; at++) {
        struct file file = copy_of(&whole);
        dpt_mesh_fault fault = { .size = sizeof fault };
        file.bytes[at] ^= (unsigned char)(1 + random_bits(&random) % 255);
        CHECK(dpt_arm_verify(file.bytes, file.size, &fault) != DPT_OK && fault.byte <= file.size,
              "byte %zu may be anything", at);
        seal_arm(&file);
        const dpt_arm *arm = NULL;
        if (dpt_arm_open(file.bytes, file.size, &arm) == DPT_OK) {
            const double q[DPT_JOINTS_MAX] = { 0.1, -0.2 }, g[3] = { 0.0, 0.0, -9.81 };
            double efforts[DPT_JOINTS_MAX];
            dpt_pose tool;
            taken++;
            CHECK(dpt_arm_forward(arm, q, &tool) == DPT_OK && isfinite(tool.position[0]), "%zu",
                  at);
            CHECK(dpt_arm_weight(arm, q, g, efforts) == DPT_OK && isfinite(efforts[1]), "%zu", at);
        } else {
            refused++;
        }
        free(file.bytes);
    }
    CHECK(taken > 200 && refused > whole.size / 2, "%llu taken, %llu refused",
          (unsigned long long)taken, (unsigned long long)refused);
}

static void every_length_is_refused(void)
{
    for (size_t size = 0; size < whole.size; size += size < AT_END ? 1 : 61) {
        struct file file = file_of(whole.bytes, size);
        dpt_result result = dpt_arm_verify(file.bytes, size, NULL);
        CHECK(result == DPT_E_TRUNCATED, "%zu bytes: %s", size, dpt_result_name(result));
        free(file.bytes);
    }
}

static void either_byte_order_converts(void)
{
    struct file other = other_arm(&whole), again = copy_of(&whole);
    dpt_mesh_fault fault = { .size = sizeof fault };
    CHECK(dpt_arm_verify(other.bytes, other.size, &fault) == DPT_E_BYTE_ORDER && fault.byte == 8,
          "%s", dpt_result_name(fault.code));
    CHECK(dpt_arm_convert(other.bytes, other.size, &fault) == DPT_OK, "%s at %llu",
          dpt_result_name(fault.code), (unsigned long long)fault.byte);
    CHECK(!memcmp(other.bytes, whole.bytes, whole.size), "converted to other bytes");
    CHECK(dpt_arm_convert(again.bytes, again.size, NULL) == DPT_OK &&
              !memcmp(again.bytes, whole.bytes, whole.size),
          "a converted file changes");
    free(other.bytes);
    free(again.bytes);
}

/* Counts that leave the file, in the other byte order, are not followed. */
static void other_order_is_checked_first(void)
{
    const int64_t counts[] = { H(joints), H(links), H(segments), H(bodies), H(bytes), H(version) };
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++) {
        struct file other = other_arm(&whole);
        memset(other.bytes + counts[i], 0x7f, 4);
        struct file before = copy_of(&other);
        dpt_result result = dpt_arm_convert(other.bytes, other.size, NULL);
        CHECK(result == DPT_E_LAYOUT || result == DPT_E_TRUNCATED || result == DPT_E_VERSION ||
                  result == DPT_E_CHECKSUM,
              "%s", dpt_result_name(result));
        CHECK(!memcmp(other.bytes, before.bytes, other.size), "changed all the same");
        free(before.bytes);
        free(other.bytes);
    }
    struct file other = other_arm(&whole);
    other.bytes[H(source_hash)] ^= 1;
    CHECK(dpt_arm_convert(other.bytes, other.size, NULL) == DPT_E_CHECKSUM, "a wrong checksum");
    free(other.bytes);
}

static void meshes_are_no_arms(void)
{
    const dpt_arm *arm;
    const dpt_mesh *mesh;
    dpt_mesh_fault small = { .size = 4 };
    CHECK(dpt_arm_open(meshes[0].bytes, meshes[0].size, &arm) == DPT_E_MAGIC, "a mesh is an arm");
    CHECK(dpt_mesh_open(whole.bytes, whole.size, &mesh) == DPT_E_MAGIC, "an arm is a mesh");
    CHECK(dpt_arm_open(whole.bytes, whole.size, NULL) == DPT_E_ARGUMENT &&
              dpt_arm_open(NULL, 8, &arm) == DPT_E_ARGUMENT &&
              dpt_arm_verify(NULL, 8, NULL) == DPT_E_ARGUMENT &&
              dpt_arm_convert(NULL, 8, NULL) == DPT_E_ARGUMENT,
          "NULL");
    CHECK(dpt_arm_verify(whole.bytes, whole.size, &small) == DPT_E_SIZE &&
              dpt_arm_convert(whole.bytes, whole.size, &small) == DPT_E_SIZE,
          "a fault of 4 bytes");
}

/* Opens, in either byte order; the caller frees it. */
static struct file read_golden(const char *name)
{
    char path[512];
    struct file kept = { calloc(1, 1 << 14), 0 };
    dpt_mesh_fault fault = { .size = sizeof fault };
    snprintf(path, sizeof path, "%s/%s", golden, name);
    FILE *stream = fopen(path, "rb");
    if (stream) {
        kept.size = fread(kept.bytes, 1, 1 << 14, stream);
        fclose(stream);
    }
    CHECK(dpt_arm_verify(kept.bytes, kept.size, NULL) ==
              (mesh_host_is_little() ? DPT_OK : DPT_E_BYTE_ORDER),
          "%s as it lies", path);
    CHECK(dpt_arm_convert(kept.bytes, kept.size, &fault) == DPT_OK, "%s: %s at %llu (%s)", path,
          dpt_result_name(fault.code), (unsigned long long)fault.byte, fault.section);
    return kept;
}

static void arms_with_older_meshes_open(void)
{
    struct file kept = read_golden("arm_1.dpa");
    free(kept.bytes);
}

/* The compiler writes the same bytes, but for its own version. */
static void golden_file_is_what_we_write(void)
{
    struct file kept = read_golden("arm_1_mesh_4.dpa");
    CHECK(kept.size == whole.size, "%zu bytes, not %zu", whole.size, kept.size);
    if (kept.size == whole.size) {
        memcpy(kept.bytes + H(writer_version), whole.bytes + H(writer_version), 4);
        for (int i = 0; i < BODIES; i++) {
            uint64_t at;
            memcpy(&at, whole.bytes + B(i, mesh_offset), 8);
            struct file mesh = file_of(kept.bytes + at, meshes[i].size);
            memcpy(mesh.bytes + 28, whole.bytes + at + 28, 4);
            seal_header(&mesh);
            memcpy(kept.bytes + at, mesh.bytes, mesh.size);
            free(mesh.bytes);
        }
        seal_arm(&kept);
        CHECK(!memcmp(kept.bytes, whole.bytes, whole.size), "the compiler writes other bytes");
    }
    free(kept.bytes);
}

/* A change to the arrays of `whole_arm`, and what is then said. */
struct refusal {
    void *at;
    size_t width;
    const void *to;
    dpt_result code;
    const char *text;
};

static void refusals_name_what_is_wrong(void)
{
    static struct arm_arrays a;
    char longest[DPT_ARM_NAME + 8], unended[DPT_ARM_NAME];
    const double nan = NAN, minus = -1.0, huge = 1.1e6, zero = 0.0, near = 1.000002;
    const uint32_t none = DPT_NONE, zeros = 0, one = 1, two = 2, three = 3, many = 65;
    const char *long_name = longest;
    const void *null = NULL;
    memset(longest, 'x', sizeof longest - 1);
    longest[sizeof longest - 1] = 0;
    memset(unended, '\n', sizeof unended);
#define CHANGED(field, value) &a.field, sizeof a.field, &(value)
    const struct refusal table[] = {
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
        { CHANGED(def.reserved, long_name), DPT_E_ARGUMENT,
          "the def's reserved field is not NULL" },
        { CHANGED(def.tool_link, three), DPT_E_INDEX, "the tool: tool_link is no link" },
        { CHANGED(def.tool.position[1], nan), DPT_E_FINITE,
          "the tool: its position is not within 1e6 m" },
        { CHANGED(def.tool.orientation[0], near), DPT_E_POSE,
          "the tool: its orientation (w, x, y, z) is not of unit length" },
        { CHANGED(def.name, long_name), DPT_E_LIMIT,
          "name, root_name or tool_name has more than 63 bytes" },
        { CHANGED(def.root_name, long_name), DPT_E_LIMIT,
          "name, root_name or tool_name has more than 63 bytes" },
        { CHANGED(def.tool_name, long_name), DPT_E_LIMIT,
          "name, root_name or tool_name has more than 63 bytes" },
        { CHANGED(joints[0].size, three), DPT_E_SIZE, "joint 0: its size is not set" },
        { CHANGED(joints[1].kind, three), DPT_E_INDEX, "joint 1, elbow: there is no such kind" },
        { CHANGED(joints[0].kind, zeros), DPT_E_INDEX,
          "joint 0, rail: no link moves by it as its kind says" },
        { CHANGED(joints[0].lower, nan), DPT_E_FINITE,
          "joint 0, rail: its lower limit is not within 1e6, or not 0 though it is continuous" },
        { CHANGED(joints[1].upper, huge), DPT_E_FINITE,
          "joint 1, elbow: its upper limit is below the lower, or above 1e6" },
        { CHANGED(joints[0].velocity, minus), DPT_E_FINITE,
          "joint 0, rail: its velocity is negative or not finite" },
        { CHANGED(joints[0].effort, nan), DPT_E_FINITE,
          "joint 0, rail: its effort is negative or not finite" },
        { CHANGED(joints[0].damping, nan), DPT_E_FINITE,
          "joint 0, rail: its damping is negative or not finite" },
        { CHANGED(joints[0].friction, minus), DPT_E_FINITE,
          "joint 0, rail: its friction is negative or not finite" },
        { CHANGED(joints[1].name, unended), DPT_E_LIMIT,
          "joint 1: its name has more than 63 bytes" },
        { CHANGED(links[0].size, three), DPT_E_SIZE, "link 0: its size is not set" },
        { CHANGED(links[1].parent, two), DPT_E_INDEX,
          "link 1, elbow: its parent is no link before it" },
        { CHANGED(links[1].joint, none), DPT_E_INDEX,
          "link 1: its joint is not there, or comes too early on the way to the tool" },
        { CHANGED(links[0].joint, one), DPT_E_INDEX,
          "link 0, elbow: its joint is not there, or comes too early on the way to the tool" },
        { CHANGED(links[0].slides, two), DPT_E_INDEX, "link 0, rail: slides is neither 0 nor 1" },
        { CHANGED(links[2].pose.position[2], huge), DPT_E_FINITE,
          "link 2, elbow: its position is not within 1e6 m" },
        { CHANGED(links[2].pose.orientation[0], near), DPT_E_POSE,
          "link 2, elbow: its orientation (w, x, y, z) is not of unit length" },
        { CHANGED(links[0].axis[2], zero), DPT_E_POSE,
          "link 0, rail: its axis is not of unit length" },
        { CHANGED(links[1].factor, zero), DPT_E_FINITE,
          "link 1, elbow: its factor is 0 or not within 1e6" },
        { CHANGED(links[1].offset, huge), DPT_E_FINITE,
          "link 1, elbow: its offset is not within 1e6" },
        { CHANGED(links[1].mass, minus), DPT_E_FINITE,
          "link 1, elbow: its mass is negative, or above 1e6 kg" },
        { CHANGED(links[1].centre[0], nan), DPT_E_FINITE,
          "link 1, elbow: its centre is not within 1e6 m" },
        { CHANGED(segments[1].a[1], nan), DPT_E_FINITE, "segment 1: an end is not within 1e6 m" },
        { CHANGED(segments[1].b[2], huge), DPT_E_FINITE, "segment 1: an end is not within 1e6 m" },
        { CHANGED(segments[0].radius, minus), DPT_E_FINITE,
          "segment 0: its radius is negative, or above 1e6 m" },
        { CHANGED(bodies[0].size, three), DPT_E_SIZE, "body 0: its size is not set" },
        { CHANGED(bodies[1].mesh, null), DPT_E_ARGUMENT, "body 1: it has no mesh" },
        { CHANGED(bodies[1].pose.position[0], nan), DPT_E_FINITE,
          "body 1, lamp: its position is not within 1e6 m" },
        { CHANGED(bodies[0].pose.orientation[0], near), DPT_E_POSE,
          "body 0, table: its orientation (w, x, y, z) is not of unit length" },
        { CHANGED(bodies[0].name, unended), DPT_E_LIMIT,
          "body 0: its name has more than 63 bytes" },
    };
    for (size_t row = 0; row < sizeof table / sizeof *table; row++) {
        const struct refusal *refusal = &table[row];
        dpt_compiled out = { &out, 1 };
        dpt_diag diag = { .size = sizeof diag };
        whole_arm(&a);
        memcpy(refusal->at, refusal->to, refusal->width);
        dpt_result result = dpt_compile_arm(&a.def, &out, &diag);
        CHECK(result == refusal->code && diag.code == result && !strcmp(diag.text, refusal->text),
              "row %zu: %s: %s", row, dpt_result_name(result), diag.text);
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
    CHECK(dpt_compile_arm(&arrays.def, &out, &diag) == DPT_E_MEMORY && !out.bytes && !out.size,
          "%s", diag.text);
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

static int write_arm(const char *path)
{
    struct arm_arrays arrays;
    dpt_compiled file;
    whole_arm(&arrays);
    FILE *stream = fopen(path, "wb");
    if (!stream || dpt_compile_arm(&arrays.def, &file, NULL) != DPT_OK)
        return 2;
    size_t written = fwrite(file.bytes, 1, file.size, stream);
    return fclose(stream) || written != file.size ? 2 : 0;
}

int main(int argc, char **argv)
{
    make_whole();
    if (argc > 2 && !strcmp(argv[1], "write"))
        return write_arm(argv[2]);
    if (argc > 1)
        golden = argv[1];
    if (argc > 2)
        reader = argv[2];
    TEST(what_is_compiled_comes_back);
    TEST(each_check_has_its_damage);
    TEST(names_end);
    TEST(no_check_is_forgotten);
    TEST(wrong_bytes_do_no_harm);
    TEST(every_length_is_refused);
    TEST(either_byte_order_converts);
    TEST(other_order_is_checked_first);
    TEST(meshes_are_no_arms);
    TEST(arms_with_older_meshes_open);
    TEST(golden_file_is_what_we_write);
    TEST(refusals_name_what_is_wrong);
    TEST(nearly_right_is_made_right);
    TEST(no_memory_is_an_error);
    TEST(a_damaged_mesh_is_not_taken);
    for (int i = 0; i < BODIES; i++)
        free(meshes[i].bytes);
    free(whole.bytes);
    return check_report();
}
