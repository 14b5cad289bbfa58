/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The file of an arm: for each check of the reader a damaged file that it alone refuses, with a code, a byte and a section;
 * files of the other byte order, and of versions before.
 *
 *     test_arm [GOLDEN [ARM_OPEN [EVERY]]]
 *     test_arm write FILE
 *
 * GOLDEN is the folder golden, ARM_OPEN the source of the reader (sites.h); from the top of the tree they are found
 * without. Each byte of a file is damaged, or one in EVERY. golden/arm_2_mesh_6.dpa is what `write` wrote, `whole_arm`;
 * arm_1_mesh_6.dpa the same before there were tips, arm_1.dpa and arm_1_mesh_4.dpa when meshes were of version 3 and 4.
 * They are to be kept: a new format, of an arm or of a mesh, gets a file beside them.
 */
#include "arm/whole_arm.h"
#include "base/byte_order.h"
#include "lib/sites.h"

static const char *golden = "tests/golden", *reader = "src/arm/arm_open.c";
static size_t every = 1; /* how many bytes further the next one is damaged */

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
    reverse(other.bytes + 320, 4, 4);
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
    for (int i = 0; i < JAWS; i++, at += JOINT) {
        reverse(at, 4, 2);
        reverse(at + 8, 8, 6);
    }
    for (int i = 0; i < JAW_LINKS; i++, at += LINK) {
        reverse(at, 4, 4);
        reverse(at + 16, 8, 16);
    }
    for (int i = 0; i < TIPS; i++, at += TIP) {
        reverse(at, 4, 4);
        reverse(at + 16, 8, 1);
    }
    reverse(at, 8, 3 * CORNERS);
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
          "row %zu: %s at %llu (%s), line %d, not %s at %llu (%s)", row, dpt_result_name(fault.code),
          (unsigned long long)fault.byte, fault.section, site, dpt_result_name(damage->code), (unsigned long long)byte,
          damage->section);
    CHECK(dpt_arm_open(file.bytes, file.size, &arm) == damage->code && !arm, "row %zu opens", row);
    if (result != DPT_E_BYTE_ORDER)
        CHECK(dpt_arm_convert(file.bytes, file.size, NULL) == damage->code, "row %zu converts", row);
    /* In the other byte order it is refused for the same reason. */
    if (damage->seal == SEALED && damage->change == SET && damage->at >= AT_JOINTS && damage->at < AT_END &&
        (damage->at < AT_BODIES || damage->at >= AT_JAWS)) {
        struct file other = other_arm(&file);
        fault = (dpt_mesh_fault){ .size = sizeof fault };
        CHECK(dpt_arm_convert(other.bytes, other.size, &fault) == damage->code && fault.byte == byte &&
                  !strcmp(fault.section, damage->section),
              "row %zu, the other order: %s at %llu", row, dpt_result_name(fault.code), (unsigned long long)fault.byte);
        free(other.bytes);
    }
    free(block);
}

#define J(i, field)    (AT_JOINTS + (i)*JOINT + (int64_t)offsetof(dpt_arm_joint, field))
#define L(i, field)    (AT_LINKS + (i)*LINK + (int64_t)offsetof(dpt_arm_link, field))
#define S(i, field)    (AT_SEGMENTS + (i)*SEGMENT + (int64_t)offsetof(dpt_segment, field))
#define B(i, field)    (AT_BODIES + (i)*BODY + (int64_t)offsetof(struct arm_body, field))
#define M(i, field)    (AT_JAWS + (i)*JOINT + (int64_t)offsetof(dpt_arm_joint, field))
#define N(i, field)    (AT_JAW_LINKS + (i)*LINK + (int64_t)offsetof(dpt_arm_link, field))
#define T(i, field)    (AT_TIPS + (i)*TIP + (int64_t)offsetof(struct arm_tip, field))
#define C(i, k)        (AT_CORNERS + (i)*CORNER + 8 * (k))
#define H(field)       (int64_t) offsetof(struct dpt_arm, field)
#define WORD(at, to)   SET, at, 4, to, SEALED
#define WIDE(at, to)   SET, at, 8, to, SEALED
#define NUMBER(at, to) SET, at, 8, bits(to), SEALED

static void expect_rows(const struct damage *table, size_t rows)
{
    for (size_t row = 0; row < rows; row++)
        expect_row(&table[row], row);
}

static void damage_of_header_and_places(void)
{
    const dpt_result layout = DPT_E_LAYOUT;
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
        { WORD(H(version), 3), DPT_E_VERSION, "header", THERE },
        { WORD(H(version), 1), layout, "header", H(header_bytes) },
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
        { WORD(H(jaws), 9), layout, "header", THERE },
        { WORD(H(jaw_links), 65), layout, "header", THERE },
        { WORD(H(tips), 65), layout, "header", THERE },
        { WORD(H(tips), 0), layout, "header", THERE },
        { WORD(H(corners), 64 * TIPS + 1), layout, "header", THERE },
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
    };
    expect_rows(table, sizeof table / sizeof *table);
}

static void damage_of_joints_and_links(void)
{
    const dpt_result layout = DPT_E_LAYOUT, index = DPT_E_INDEX, finite = DPT_E_FINITE, unit = DPT_E_POSE;
    const struct damage table[] = {
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
    };
    expect_rows(table, sizeof table / sizeof *table);
}

static void damage_of_the_rest(void)
{
    const dpt_result layout = DPT_E_LAYOUT, index = DPT_E_INDEX, finite = DPT_E_FINITE, unit = DPT_E_POSE;
    const struct damage table[] = {
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
        /* check_tips */
        { WORD(M(1, kind), 3), index, "jaws", THERE },
        { NUMBER(M(0, upper), -0.1), finite, "jaws", THERE },
        { WORD(M(0, name) + 8, 1), layout, "jaws", M(0, name) },
        { WORD(N(2, parent), 2), index, "jaw_links", THERE },
        { WORD(N(1, joint), JAWS), index, "jaw_links", THERE },
        { WORD(N(2, slides), 2), index, "jaw_links", THERE },
        { NUMBER(N(1, pose.position[2]), NAN), finite, "jaw_links", THERE },
        { WORD(N(2, slides), 0), index, "jaws", M(1, size) },
        { WORD(T(1, bytes), 80), layout, "tips", THERE },
        { WORD(T(1, link), JAW_LINKS), index, "tips", THERE },
        { WORD(T(1, first_corner), 3), index, "tips", THERE },
        { WORD(T(0, corner_count), 2), index, "tips", THERE },
        { WORD(T(0, corner_count), 65), index, "tips", THERE },
        { WORD(T(2, corner_count), 5), index, "tips", THERE },
        { WORD(T(2, corner_count), 3), layout, "header", H(corners) },
        { NUMBER(T(1, radius), -1e-9), finite, "tips", THERE },
        { WORD(T(2, name) + 8, 1), layout, "tips", T(2, name) },
        { NUMBER(C(0, 2), NAN), finite, "corners", THERE },
        { NUMBER(C(CORNERS - 1, 1), 1.1e6), finite, "corners", THERE },
        /* The mesh's reader, of the second mesh: a section of its own, a byte of the arm's */
        { WORD((int64_t)(whole.size - meshes[1].size) + 1536, 1), DPT_E_CHECKSUM, "vertices", THERE },
    };
    expect_rows(table, sizeof table / sizeof *table);
}

static void each_check_has_its_damage(void)
{
    damage_of_header_and_places();
    damage_of_joints_and_links();
    damage_of_the_rest();
}

/* 63 bytes and a zero are a name, 64 bytes are none. */
static void names_end(void)
{
    const int64_t names[] = { H(name), J(1, name), B(1, name), M(0, name), T(2, name) };
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        struct file file = copy_of(&whole);
        dpt_mesh_fault fault = { .size = sizeof fault };
        memset(file.bytes + names[i], 'x', DPT_ARM_NAME - 1);
        seal_arm(&file);
        CHECK(dpt_arm_verify(file.bytes, file.size, &fault) == DPT_OK, "name %zu of 63 bytes", i);
        file.bytes[names[i] + DPT_ARM_NAME - 1] = 'x';
        seal_arm(&file);
        CHECK(dpt_arm_verify(file.bytes, file.size, &fault) == DPT_E_LAYOUT && fault.byte == (uint64_t)names[i],
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
    for (size_t at = 0; at < whole.size; at += every) {
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
            CHECK(dpt_arm_forward(arm, q, &tool) == DPT_OK && isfinite(tool.position[0]), "%zu", at);
            CHECK(dpt_arm_weight(arm, q, g, efforts) == DPT_OK && isfinite(efforts[1]), "%zu", at);
        } else {
            refused++;
        }
        free(file.bytes);
    }
    CHECK(taken > 200 / every && refused > whole.size / every / 2, "%llu taken, %llu refused",
          (unsigned long long)taken, (unsigned long long)refused);
}

static void every_length_is_refused(void)
{
    for (size_t size = 0; size < whole.size; size += size < AT_END ? every : 61) {
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
    CHECK(dpt_arm_verify(other.bytes, other.size, &fault) == DPT_E_BYTE_ORDER && fault.byte == 8, "%s",
          dpt_result_name(fault.code));
    CHECK(dpt_arm_convert(other.bytes, other.size, &fault) == DPT_OK, "%s at %llu", dpt_result_name(fault.code),
          (unsigned long long)fault.byte);
    CHECK(!memcmp(other.bytes, whole.bytes, whole.size), "converted to other bytes");
    CHECK(dpt_arm_convert(again.bytes, again.size, NULL) == DPT_OK && !memcmp(again.bytes, whole.bytes, whole.size),
          "a converted file changes");
    free(other.bytes);
    free(again.bytes);
}

/* Counts that leave the file, in the other byte order, are not followed. */
static void other_order_is_checked_first(void)
{
    const int64_t counts[] = { H(joints), H(links),   H(segments),  H(bodies), H(bytes),
                               H(tips),   H(version), H(jaw_links), H(jaws),   H(corners) };
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
              dpt_arm_open(NULL, 8, &arm) == DPT_E_ARGUMENT && dpt_arm_verify(NULL, 8, NULL) == DPT_E_ARGUMENT &&
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
    CHECK(dpt_arm_verify(kept.bytes, kept.size, NULL) == (host_is_little() ? DPT_OK : DPT_E_BYTE_ORDER),
          "%s as it lies", path);
    CHECK(dpt_arm_convert(kept.bytes, kept.size, &fault) == DPT_OK, "%s: %s at %llu (%s)", path,
          dpt_result_name(fault.code), (unsigned long long)fault.byte, fault.section);
    return kept;
}

static void arms_with_older_meshes_open(void)
{
    struct file of_3 = read_golden("arm_1.dpa"), of_4 = read_golden("arm_1_mesh_4.dpa");
    struct file of_5 = read_golden("arm_1_mesh_5.dpa");
    free(of_5.bytes);
    free(of_3.bytes);
    free(of_4.bytes);
}

/* The compiler writes the bytes of a kept file, but for its own version. */
static void expect_golden(const char *name, const struct file *wrote)
{
    struct file kept = read_golden(name);
    const dpt_arm *arm;
    dpt_arm_body body = { .size = sizeof body };
    CHECK(kept.size == wrote->size && dpt_arm_open(wrote->bytes, wrote->size, &arm) == DPT_OK, "%s: %zu bytes, not %zu",
          name, wrote->size, kept.size);
    if (kept.size == wrote->size) {
        memcpy(kept.bytes + H(writer_version), wrote->bytes + H(writer_version), 4);
        for (uint32_t i = 0; dpt_arm_get_body(arm, i, &body) == DPT_OK; i++) {
            const size_t at = (size_t)((const unsigned char *)body.mesh - wrote->bytes);
            struct file mesh = file_of(kept.bytes + at, body.mesh_bytes);
            memcpy(mesh.bytes + 28, wrote->bytes + at + 28, 4);
            seal_header(&mesh);
            memcpy(kept.bytes + at, mesh.bytes, mesh.size);
            free(mesh.bytes);
        }
        seal_arm(&kept);
        CHECK(!memcmp(kept.bytes, wrote->bytes, wrote->size), "%s: other bytes", name);
    }
    free(kept.bytes);
}

/* An arm without tips is written as it was before there were any. */
static void golden_files_are_what_we_write(void)
{
    struct arm_arrays arrays;
    whole_arm(&arrays);
    arrays.def.jaw_count = arrays.def.jaw_link_count = arrays.def.tip_count = 0;
    struct arm without = arm_of(&arrays.def);
    struct file file = file_of(without.file.bytes, without.file.size);
    expect_golden("arm_2_mesh_6.dpa", &whole);
    expect_golden("arm_1_mesh_6.dpa", &file);
    free(file.bytes);
    dpt_compiled_free(&without.file);
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
    if (argc > 3)
        every = (size_t)strtoul(argv[3], NULL, 10);
    if (every == 0)
        return 2;
    TEST(each_check_has_its_damage);
    TEST(names_end);
    TEST(no_check_is_forgotten);
    TEST(wrong_bytes_do_no_harm);
    TEST(every_length_is_refused);
    TEST(either_byte_order_converts);
    TEST(other_order_is_checked_first);
    TEST(meshes_are_no_arms);
    TEST(arms_with_older_meshes_open);
    TEST(golden_files_are_what_we_write);
    free_whole();
    return check_report();
}
