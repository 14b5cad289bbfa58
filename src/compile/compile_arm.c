/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Write the arrays of an arm as the bytes of its file (arm_format.h). Only the reader (arm_open.c) knows the ranges of
 * the numbers. So the finished bytes are verified with it, and its fault is explained in words.
 */
#include "arm/arm_format.h"
#include "base/byte_order.h"
#include "base/return_if_error.h"
#include "base/sized.h"
#include "base/vec3.h"
#include "compile/model.h"
#include "compile/text.h"

static const source_location nowhere = { 0, 0 };

/* Messages for the reader's faults. One applies from its field to that of the next message of the same record. */
static const struct reason {
    const char *section;
    size_t field;
    const char *text;
} reasons[] = {
    { "header", offsetof(struct dpt_arm, tool_link), "tool_link is no link" },
    { "header", offsetof(struct dpt_arm, tool.position), "its position is not within 1e6 m" },
    { "header", offsetof(struct dpt_arm, tool.orientation), "its orientation (w, x, y, z) is not of unit length" },
    { "joints", 0, "no link moves by it as its kind says" },
    { "joints", offsetof(struct arm_joint, kind), "there is no such kind" },
    { "joints", offsetof(struct arm_joint, lower),
      "its lower limit is not within 1e6, or not 0 though it is continuous" },
    { "joints", offsetof(struct arm_joint, upper), "its upper limit is below the lower, or above 1e6" },
    { "joints", offsetof(struct arm_joint, velocity), "its velocity is negative or not finite" },
    { "joints", offsetof(struct arm_joint, effort), "its effort is negative or not finite" },
    { "joints", offsetof(struct arm_joint, damping), "its damping is negative or not finite" },
    { "joints", offsetof(struct arm_joint, friction), "its friction is negative or not finite" },
    { "links", offsetof(struct arm_link, parent), "its parent is no link before it" },
    { "links", offsetof(struct arm_link, joint), "its joint is not there, or comes too early on the way to the tool" },
    { "links", offsetof(struct arm_link, slides), "slides is neither 0 nor 1" },
    { "links", offsetof(struct arm_link, pose.position), "its position is not within 1e6 m" },
    { "links", offsetof(struct arm_link, pose.orientation), "its orientation (w, x, y, z) is not of unit length" },
    { "links", offsetof(struct arm_link, axis), "its axis is not of unit length" },
    { "links", offsetof(struct arm_link, factor), "its factor is 0 or not within 1e6" },
    { "links", offsetof(struct arm_link, offset), "its offset is not within 1e6" },
    { "links", offsetof(struct arm_link, mass), "its mass is negative, or above 1e6 kg" },
    { "links", offsetof(struct arm_link, centre), "its centre is not within 1e6 m" },
    { "segments", offsetof(dpt_segment, a), "an end is not within 1e6 m" },
    { "segments", offsetof(dpt_segment, radius), "its radius is negative, or above 1e6 m" },
    { "bodies", offsetof(struct arm_body, pose.position), "its position is not within 1e6 m" },
    { "bodies", offsetof(struct arm_body, pose.orientation), "its orientation (w, x, y, z) is not of unit length" },
    { "tips", offsetof(struct arm_tip, link), "it is fixed to no jaw link" },
    { "tips", offsetof(struct arm_tip, radius), "its radius is negative, or above 1e6 m" },
    { "corners", 0, "it is not within 1e6 m" },
};

static const char *reason_at(const char *section, size_t field)
{
    const char *text = "it is damaged";
    for (size_t i = 0; i < sizeof reasons / sizeof *reasons; i++)
        if (!strcmp(reasons[i].section, section) && reasons[i].field <= field)
            text = reasons[i].text;
    return text;
}

/* The records of a file, in their order. */
struct records {
    const char *what, *section; /* in words; of the reasons */
    const void *first;
    size_t count, width;
    const struct arm_joint *joints; /* of links */
    size_t joint_count;
    size_t name; /* offset in a record; 0: it has none */
};
enum { RECORD_KINDS = 8 };

static void list_records(const struct dpt_arm *arm, struct records records[RECORD_KINDS])
{
    const struct records all[RECORD_KINDS] = {
        { "joint", "joints", arm_joints(arm), arm->joints, sizeof(struct arm_joint), NULL, 0,
          offsetof(struct arm_joint, name) },
        { "link", "links", arm_links(arm), arm->links, sizeof(struct arm_link), arm_joints(arm), arm->joints, 0 },
        { "segment", "segments", arm_segments(arm), arm->segments, sizeof(dpt_segment), NULL, 0, 0 },
        { "body", "bodies", arm_bodies(arm), arm->bodies, sizeof(struct arm_body), NULL, 0,
          offsetof(struct arm_body, name) },
        { "jaw", "joints", arm_jaws(arm), arm_jaw_count(arm), sizeof(struct arm_joint), NULL, 0,
          offsetof(struct arm_joint, name) },
        { "jaw link", "links", arm_jaw_links(arm), arm_jaw_link_count(arm), sizeof(struct arm_link), arm_jaws(arm),
          arm_jaw_count(arm), 0 },
        { "tip", "tips", arm_tips(arm), arm_tip_count(arm), sizeof(struct arm_tip), NULL, 0,
          offsetof(struct arm_tip, name) },
        { "corner", "corners", arm_corners(arm), arm_corner_count(arm), sizeof(struct arm_corner), NULL, 0, 0 },
    };
    memcpy(records, all, sizeof all);
}

/* The name of a record; for a link, that of its joint. "" if there is none. */
static const char *name_of(const struct records *records, size_t index)
{
    const char *record = (const char *)records->first + index * records->width;
    const struct arm_link *link = (const void *)record;
    if (records->name)
        return record + records->name;
    return records->joints && link->joint < records->joint_count ? records->joints[link->joint].name : "";
}

/* Fill the diag with the reader's fault, in words. `arm` is the file in the host's byte order. */
static dpt_result explain_fault(const struct compile_context *context, const struct dpt_arm *arm,
                                const dpt_mesh_fault *fault)
{
    struct records records[RECORD_KINDS];
    uint64_t byte = fault->byte;
    list_records(arm, records);
    if (byte < arm->header_bytes)
        return compile_fail(context, fault->code, nowhere, "the tool: %s", reason_at("header", (size_t)byte));
    byte -= arm->header_bytes;
    for (size_t i = 0; i < RECORD_KINDS; i++) {
        const size_t bytes = records[i].count * records[i].width;
        if (byte < bytes) {
            const size_t index = (size_t)byte / records[i].width;
            const char *name = name_of(&records[i], index);
            const source_word shown = { name, name + strlen(name) };
            char printable[WORD_SHOWN];
            return compile_fail(context, fault->code, nowhere, "%s %zu%s%s: %s", records[i].what, index,
                                *name ? ", " : "", word_printable(&shown, printable),
                                reason_at(records[i].section, (size_t)byte % records[i].width));
        }
        byte -= bytes;
    }
    return compile_fail(context, fault->code, nowhere, "a body's mesh is damaged");
}

/*
 * Copy item i of one of the def's arrays into `own`. The caller's struct may be older or newer than this library's, of
 * current_size bytes: base/sized.h has the rule.
 */
static dpt_result read_item(const struct compile_context *context, const char *what, const void *array, uint32_t i,
                            void *own, size_t current_size)
{
    const uint32_t size = sized_of(array);
    dpt_result result = size % 8 ? DPT_E_SIZE : sized_take(sized_item(array, i), size, current_size, own, current_size);
    if (result == DPT_E_UNSUPPORTED)
        return compile_fail(context, result, nowhere, "%s %u: it has fields of a newer version", what, i);
    if (result != DPT_OK)
        return compile_fail(context, result, nowhere, "%s 0: its size is not set", what);
    return DPT_OK;
}

static dpt_result read_tip(const struct compile_context *context, const dpt_arm_def *def, uint32_t i, dpt_arm_tip *tip)
{
    return read_item(context, "tip", def->tips, i, tip, sizeof *tip);
}

static dpt_result read_body(const struct compile_context *context, const dpt_arm_def *def, uint32_t i,
                            dpt_arm_body *body)
{
    return read_item(context, "body", def->bodies, i, body, sizeof *body);
}

/* Check the counts, the pointers to the arrays, and each body's size and mesh. */
static dpt_result check_def(const struct compile_context *context, const dpt_arm_def *def)
{
    const struct {
        const char *what;
        uint32_t count, min, max;
        const void *array;
    } arrays[] = {
        { "joints", def->joint_count, 1, DPT_JOINTS_MAX, def->joints },
        { "links", def->link_count, 1, DPT_ARM_LINKS_MAX, def->links },
        { "segments", def->segment_count, 0, DPT_ARM_SEGMENTS_MAX, def->segments },
        { "bodies", def->body_count, 0, DPT_ARM_BODIES_MAX, def->bodies },
        { "jaws", def->jaw_count, 0, DPT_JOINTS_MAX, def->jaws },
        { "jaw links", def->jaw_link_count, 0, DPT_ARM_LINKS_MAX, def->jaw_links },
        { "tips", def->tip_count, 0, DPT_ARM_TIPS_MAX, def->tips },
    };
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) {
        if (arrays[i].count < arrays[i].min || arrays[i].count > arrays[i].max)
            return compile_fail(context, DPT_E_LIMIT, nowhere, "%u %s: an arm has %u to %u", arrays[i].count,
                                arrays[i].what, arrays[i].min, arrays[i].max);
        if (arrays[i].count && !arrays[i].array)
            return compile_fail(context, DPT_E_ARGUMENT, nowhere, "no array of %s", arrays[i].what);
    }
    for (uint32_t i = 0; i < def->body_count; i++) {
        dpt_arm_body body;
        DPT_TRY(read_body(context, def, i, &body));
        if (!body.mesh)
            return compile_fail(context, DPT_E_ARGUMENT, nowhere, "body %u: it has no mesh", i);
    }
    if (!def->tip_count && (def->jaw_count || def->jaw_link_count))
        return compile_fail(context, DPT_E_ARGUMENT, nowhere, "jaws, and no tip that they move");
    for (uint32_t i = 0; i < def->tip_count; i++) {
        dpt_arm_tip tip;
        DPT_TRY(read_tip(context, def, i, &tip));
        if (!tip.corners || tip.reserved || tip.reserved_pointer || tip.corner_count < 3 ||
            tip.corner_count > DPT_HULL_CORNERS_MAX)
            return compile_fail(context, DPT_E_ARGUMENT, nowhere, "tip %u: it has no corners, or not 3 to %d of them",
                                i, DPT_HULL_CORNERS_MAX);
    }
    return DPT_OK;
}

/* Copy a name, and fill the rest with zeros. Returns 0 if the name is too long. */
static int put_name(char to[DPT_ARM_NAME], const char *name)
{
    size_t length = 0;
    while (name && length < DPT_ARM_NAME && name[length])
        length++;
    memset(to, 0, DPT_ARM_NAME);
    if (length && length < DPT_ARM_NAME)
        memcpy(to, name, length);
    return length < DPT_ARM_NAME;
}

static dpt_result fail_name_length(const struct compile_context *context, const char *what, uint32_t index)
{
    return compile_fail(context, DPT_E_LIMIT, nowhere, "%s %u: its name has more than %d bytes", what, index,
                        DPT_ARM_NAME - 1);
}

/* Scale a vector to unit length if it is so within 1e-6. The reader refuses any other. */
static void make_unit(double *number, int count)
{
    double square = 0.0;
    for (int i = 0; i < count; i++)
        square += number[i] * number[i];
    for (int i = 0; i < count && within(square - 1.0, 2e-6); i++)
        number[i] /= sqrt(square);
}

/* Write joints; `what` they are, for a message. */
static dpt_result put_joints(const struct compile_context *context, const char *what, const dpt_arm_joint *given,
                             uint32_t count, struct arm_joint *joints)
{
    for (uint32_t i = 0; i < count; i++) {
        dpt_arm_joint from;
        DPT_TRY(read_item(context, what, given, i, &from, sizeof from));
        joints[i] = (struct arm_joint){ .bytes = sizeof *joints,
                                        .kind = from.kind,
                                        .lower = from.lower,
                                        .upper = from.upper,
                                        .velocity = from.velocity,
                                        .effort = from.effort,
                                        .damping = from.damping,
                                        .friction = from.friction };
        if (!put_name(joints[i].name, from.name))
            return fail_name_length(context, what, i);
    }
    return DPT_OK;
}

static dpt_result put_links(const struct compile_context *context, const char *what, const dpt_arm_link *given,
                            uint32_t count, struct arm_link *links)
{
    for (uint32_t i = 0; i < count; i++) {
        dpt_arm_link from;
        DPT_TRY(read_item(context, what, given, i, &from, sizeof from));
        links[i] = (struct arm_link){ .bytes = sizeof *links,
                                      .parent = from.parent,
                                      .joint = from.joint,
                                      .slides = from.slides,
                                      .pose = from.pose,
                                      .factor = from.factor,
                                      .offset = from.offset,
                                      .mass = from.mass };
        memcpy(links[i].axis, from.axis, sizeof from.axis);
        memcpy(links[i].centre, from.centre, sizeof from.centre);
        make_unit(links[i].pose.orientation, 4);
        make_unit(links[i].axis, 3);
    }
    return DPT_OK;
}

/* Jaws, jaw links, tips and corners, from `at` on. */
static dpt_result put_tips(const struct compile_context *context, const dpt_arm_def *def, void *at)
{
    struct arm_joint *jaws = at;
    struct arm_link *links = (void *)(jaws + def->jaw_count);
    struct arm_tip *tips = (void *)(links + def->jaw_link_count);
    struct arm_corner *corners = (void *)(tips + def->tip_count);
    uint32_t corner_count = 0;
    DPT_TRY(put_joints(context, "jaw", def->jaws, def->jaw_count, jaws));
    DPT_TRY(put_links(context, "jaw link", def->jaw_links, def->jaw_link_count, links));
    for (uint32_t i = 0; i < def->tip_count; i++) {
        dpt_arm_tip from;
        DPT_TRY(read_tip(context, def, i, &from));
        tips[i] = (struct arm_tip){ .bytes = sizeof *tips,
                                    .link = from.link,
                                    .first_corner = corner_count,
                                    .corner_count = from.corner_count,
                                    .radius = from.radius };
        if (!put_name(tips[i].name, from.name))
            return fail_name_length(context, "tip", i);
        memcpy(corners + corner_count, from.corners, from.corner_count * sizeof *corners);
        corner_count += from.corner_count;
    }
    return DPT_OK;
}

static dpt_result put_records(const struct compile_context *context, const dpt_arm_def *def, struct dpt_arm *arm)
{
    struct arm_joint *joints = (void *)((char *)arm + arm->header_bytes);
    struct arm_link *links = (void *)(joints + arm->joints);
    dpt_segment *segments = (void *)(links + arm->links);
    struct arm_body *bodies = (void *)(segments + arm->segments);
    uint64_t end = arm_records_end(arm);
    DPT_TRY(put_joints(context, "joint", def->joints, arm->joints, joints));
    DPT_TRY(put_links(context, "link", def->links, arm->links, links));
    DPT_TRY(put_tips(context, def, bodies + arm->bodies));
    if (arm->segments)
        memcpy(segments, def->segments, arm->segments * sizeof *segments);
    for (uint32_t i = 0; i < arm->bodies; i++) {
        dpt_arm_body from;
        DPT_TRY(read_body(context, def, i, &from));
        const struct dpt_mesh *mesh = from.mesh;
        bodies[i].mesh_offset = mesh_aligned(end);
        bodies[i].mesh_bytes = mesh->bytes;
        bodies[i].pose = from.pose;
        make_unit(bodies[i].pose.orientation, 4);
        if (!put_name(bodies[i].name, from.name))
            return fail_name_length(context, "body", i);
        memcpy((char *)arm + bodies[i].mesh_offset, mesh, (size_t)mesh->bytes);
        end = bodies[i].mesh_offset + mesh->bytes;
    }
    return DPT_OK;
}

static dpt_result put_header(const struct compile_context *context, const dpt_arm_def *def, struct dpt_arm *arm)
{
    memcpy(arm->magic, ARM_MAGIC, sizeof arm->magic);
    arm->byte_order = MESH_BYTE_ORDER;
    arm->version = def->tip_count ? ARM_VERSION : 1;
    arm->header_bytes = def->tip_count ? sizeof *arm : ARM_HEADER_1;
    arm->writer_version = DPT_VERSION_NUMBER;
    arm->joints = def->joint_count;
    arm->links = def->link_count;
    arm->segments = def->segment_count;
    arm->bodies = def->body_count;
    arm->tool_link = def->tool_link;
    arm->source_bytes = def->source_bytes;
    arm->source_hash = def->source_hash;
    arm->tool = def->tool;
    make_unit(arm->tool.orientation, 4);
    if (!put_name(arm->name, def->name) || !put_name(arm->root_name, def->root_name) ||
        !put_name(arm->tool_name, def->tool_name))
        return compile_fail(context, DPT_E_LIMIT, nowhere, "name, root_name or tool_name has more than %d bytes",
                            DPT_ARM_NAME - 1);
    for (uint32_t i = 0; i < def->tip_count; i++) {
        dpt_arm_tip tip;
        DPT_TRY(read_tip(context, def, i, &tip));
        arm->corners += tip.corner_count;
    }
    arm->jaws = def->jaw_count;
    arm->jaw_links = def->jaw_link_count;
    arm->tips = def->tip_count;
    arm->bytes = arm_records_end(arm);
    for (uint32_t i = 0; i < arm->bodies; i++) {
        dpt_arm_body body;
        DPT_TRY(read_body(context, def, i, &body));
        arm->bytes = mesh_aligned(arm->bytes) + body.mesh->bytes;
    }
    return DPT_OK;
}

/* Convert a mesh to little-endian, on a big-endian host. */
static void mesh_to_file_order(struct dpt_mesh *mesh)
{
    const uint32_t version = mesh->version, header_bytes = mesh->header_bytes;
    struct crc32 crc;
    crc32_init(&crc);
    for (uint32_t id = 0; id < mesh->section_count; id++) {
        struct mesh_section *section = &mesh->section[id];
        char *content = (char *)mesh + section->offset;
        mesh_swap4(content, section->bytes / 4);
        section->crc32 = crc32_of(&crc, content, (size_t)section->bytes);
    }
    mesh->header_crc32 = 0;
    mesh_swap_header(mesh, version);
    mesh->header_crc32 = crc32_of(&crc, mesh, header_bytes);
    mesh_swap4(&mesh->header_crc32, 1);
}

/* Convert the whole file to little-endian, on a big-endian host. */
static void arm_to_file_order(struct dpt_arm *arm)
{
    const struct dpt_arm header = *arm;
    for (uint32_t i = 0; i < header.bodies; i++)
        mesh_to_file_order((void *)((char *)arm + arm_bodies(arm)[i].mesh_offset));
    arm_swap_records(&header, arm);
    arm_swap_header(arm);
    arm->crc32 = arm_crc(arm, (size_t)header.bytes);
    mesh_swap4(&arm->crc32, 1);
}

static dpt_result compile_arm(const struct compile_context *context, const dpt_arm_def *def, dpt_compiled *out)
{
    struct dpt_arm header = { .bytes = 0 };
    dpt_mesh_fault fault = { .size = sizeof fault };
    DPT_TRY(check_def(context, def));
    DPT_TRY(put_header(context, def, &header));
    struct dpt_arm *arm = header.bytes <= SIZE_MAX / 2 ? (void *)compiled_block((size_t)header.bytes) : NULL;
    if (!arm)
        return compile_fail(context, DPT_E_MEMORY, nowhere, "memory ran out");
    *out = (dpt_compiled){ arm, (size_t)header.bytes };
    memcpy(arm, &header, header.header_bytes);
    DPT_TRY(put_records(context, def, arm));
    arm->crc32 = arm_crc(arm, out->size);
    if (dpt_arm_verify(arm, out->size, &fault) != DPT_OK)
        return explain_fault(context, arm, &fault);
    if (!host_is_little())
        arm_to_file_order(arm);
    return DPT_OK;
}

static dpt_result check_call(const struct compile_context *context, const dpt_arm_def *given, dpt_arm_def *def,
                             dpt_compiled *out)
{
    if (!out)
        return compile_fail(context, DPT_E_ARGUMENT, nowhere, "no place for the bytes");
    if (!given)
        return compile_fail(context, DPT_E_ARGUMENT, nowhere, "no def");
    *def = (dpt_arm_def){ .size = sizeof *def };
    dpt_result result = sized_read(given, SIZED_FIRST(dpt_arm_def, jaw_count), def, sizeof *def);
    if (result == DPT_E_UNSUPPORTED)
        return compile_fail(context, result, nowhere, "the def has fields of a newer version");
    if (result != DPT_OK)
        return compile_fail(context, result, nowhere, "the def's size field is not set");
    if (def->reserved || def->reserved_word || def->reserved_pointer)
        return compile_fail(context, DPT_E_ARGUMENT, nowhere, "the def's reserved fields are not 0");
    return DPT_OK;
}

dpt_result dpt_compile_arm(const dpt_arm_def *given, dpt_compiled *out, dpt_diag *diag)
{
    struct compile_context context;
    dpt_arm_def def = { .size = sizeof def };
    dpt_diag own = { .size = sizeof own };
    if (out)
        *out = (dpt_compiled){ NULL, 0 };
    if (diag)
        DPT_TRY(sized_check(diag, sizeof *diag, 0));
    compile_context_init(&context, NULL, &own);
    dpt_result result = check_call(&context, given, &def, out);
    if (result == DPT_OK)
        result = compile_arm(&context, &def, out);
    if (result != DPT_OK)
        dpt_compiled_free(out);
    if (diag)
        sized_write(diag, diag->size, &own, sizeof own);
    return result;
}
