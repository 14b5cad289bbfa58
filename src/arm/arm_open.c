/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Open an arm: verify once, trust afterwards, as mesh_open.c does for meshes. In a file that opens, every index is
 * within its array and every number within its range, even if someone forged the checksums.
 */
#include "arm/arm_format.h"
#include "base/return_if_error.h"
#include "base/sized.h"
#include "base/vec3.h"

/* The squared length of a unit vector may be off by this. The compiler's are within a few roundings. */
#define UNIT_TOLERANCE 1e-12

/* The largest velocity, effort, damping or friction of a joint: as good as no limit. */
#define LIMIT_MAX 1e300

/* Fill `fault`, which may be NULL, and return `code`. `byte` counts from the beginning of the file. */
static dpt_result fail(dpt_mesh_fault *fault, dpt_result code, uint64_t byte, int section)
{
    static const char names[][16] = { "header", "joints",    "links", "segments", "bodies",
                                      "jaws",   "jaw_links", "tips",  "corners",  "padding" };
    if (fault) {
        dpt_mesh_fault own = { .code = code, .byte = byte };
        memcpy(own.section, names[section], sizeof own.section);
        sized_write(fault, fault->size, &own, sizeof own);
    }
    return code;
}

/* The same for a damaged field. `field` points into the file at `arm`. */
static dpt_result fail_at(dpt_mesh_fault *fault, dpt_result code, const struct dpt_arm *arm, int section,
                          const void *field)
{
    return fail(fault, code, (uint64_t)((const char *)field - (const char *)arm), section);
}

/* Check version, lengths and counts of a header in the host's byte order. */
static dpt_result check_header(const struct dpt_arm *arm, size_t size, dpt_mesh_fault *fault)
{
    if (arm->version > ARM_VERSION)
        return fail_at(fault, DPT_E_VERSION, arm, ARM_HEADER, &arm->version);
    if (arm->version == 0)
        return fail_at(fault, DPT_E_LAYOUT, arm, ARM_HEADER, &arm->version);
    if (size < sizeof *arm)
        return fail(fault, DPT_E_TRUNCATED, size, ARM_HEADER);
    if (arm->header_bytes != (arm->version < 2 ? ARM_HEADER_1 : sizeof *arm))
        return fail_at(fault, DPT_E_LAYOUT, arm, ARM_HEADER, &arm->header_bytes);
    if (size < arm->bytes)
        return fail(fault, DPT_E_TRUNCATED, size, ARM_HEADER);
    if (size > arm->bytes)
        return fail(fault, DPT_E_TRAILING, arm->bytes, ARM_HEADER);
    if (arm->joints < 1 || arm->joints > DPT_JOINTS_MAX)
        return fail_at(fault, DPT_E_LAYOUT, arm, ARM_HEADER, &arm->joints);
    if (arm->links < 1 || arm->links > DPT_ARM_LINKS_MAX)
        return fail_at(fault, DPT_E_LAYOUT, arm, ARM_HEADER, &arm->links);
    if (arm->segments > DPT_ARM_SEGMENTS_MAX)
        return fail_at(fault, DPT_E_LAYOUT, arm, ARM_HEADER, &arm->segments);
    if (arm->bodies > DPT_ARM_BODIES_MAX)
        return fail_at(fault, DPT_E_LAYOUT, arm, ARM_HEADER, &arm->bodies);
    if (arm_jaw_count(arm) > DPT_JOINTS_MAX)
        return fail_at(fault, DPT_E_LAYOUT, arm, ARM_HEADER, &arm->jaws);
    if (arm_jaw_link_count(arm) > DPT_ARM_LINKS_MAX)
        return fail_at(fault, DPT_E_LAYOUT, arm, ARM_HEADER, &arm->jaw_links);
    if (arm_tip_count(arm) > DPT_ARM_TIPS_MAX || (arm->version > 1 && !arm->tips))
        return fail_at(fault, DPT_E_LAYOUT, arm, ARM_HEADER, &arm->tips);
    if (arm_corner_count(arm) > DPT_HULL_CORNERS_MAX * arm_tip_count(arm))
        return fail_at(fault, DPT_E_LAYOUT, arm, ARM_HEADER, &arm->corners);
    if (arm->bytes < arm_records_end(arm))
        return fail_at(fault, DPT_E_LAYOUT, arm, ARM_HEADER, &arm->bytes);
    return DPT_OK;
}

/* Check the checksum. `arm` is the header in the host's byte order, `bytes` the file in its own. */
static dpt_result check_crc(const struct dpt_arm *arm, const void *bytes, dpt_mesh_fault *fault)
{
    if (arm_crc(bytes, (size_t)arm->bytes) != arm->crc32)
        return fail_at(fault, DPT_E_CHECKSUM, arm, ARM_HEADER, &arm->crc32);
    return DPT_OK;
}

/* Check that the meshes follow the records and each other, aligned, with nothing but zeros between them. */
static dpt_result check_meshes_place(const struct dpt_arm *arm, dpt_mesh_fault *fault)
{
    uint64_t end = arm_records_end(arm);
    for (uint32_t i = 0; i < arm->bodies; i++) {
        const struct arm_body *body = &arm_bodies(arm)[i];
        if (body->mesh_offset != mesh_aligned(end) || body->mesh_offset > arm->bytes)
            return fail_at(fault, DPT_E_LAYOUT, arm, ARM_BODIES, &body->mesh_offset);
        if (body->mesh_bytes > arm->bytes - body->mesh_offset)
            return fail_at(fault, DPT_E_LAYOUT, arm, ARM_BODIES, &body->mesh_bytes);
        for (; end < body->mesh_offset; end++)
            if (((const char *)arm)[end])
                return fail(fault, DPT_E_LAYOUT, end, ARM_PADDING);
        end += body->mesh_bytes;
    }
    if (end != arm->bytes)
        return fail(fault, DPT_E_LAYOUT, end, ARM_HEADER);
    return DPT_OK;
}

static dpt_result check_range(const struct dpt_arm *arm, int section, const double *number, int count, double min,
                              double max, dpt_mesh_fault *fault)
{
    for (int i = 0; i < count; i++)
        if (!(number[i] >= min && number[i] <= max))
            return fail_at(fault, DPT_E_FINITE, arm, section, &number[i]);
    return DPT_OK;
}

/* Check coordinates, in m or rad. */
static dpt_result check_coordinates(const struct dpt_arm *arm, int section, const double *number, int count,
                                    dpt_mesh_fault *fault)
{
    return check_range(arm, section, number, count, -DPT_COORDINATE_MAX, DPT_COORDINATE_MAX, fault);
}

static dpt_result check_unit(const struct dpt_arm *arm, int section, const double *number, int count,
                             dpt_mesh_fault *fault)
{
    double square = 0.0;
    for (int i = 0; i < count; i++)
        square += number[i] * number[i];
    if (!within(square - 1.0, UNIT_TOLERANCE))
        return fail_at(fault, DPT_E_POSE, arm, section, number);
    return DPT_OK;
}

static dpt_result check_pose(const struct dpt_arm *arm, int section, const dpt_pose *pose, dpt_mesh_fault *fault)
{
    DPT_TRY(check_coordinates(arm, section, pose->position, 3, fault));
    return check_unit(arm, section, pose->orientation, 4, fault);
}

/* Check that a name ends in a zero and that only zeros follow: the same name is then the same bytes. */
static dpt_result check_name(const struct dpt_arm *arm, int section, const char *name, dpt_mesh_fault *fault)
{
    int has_ended = 0;
    for (int i = 0; i < DPT_ARM_NAME; i++) {
        if (has_ended ? name[i] != 0 : i == DPT_ARM_NAME - 1 && name[i] != 0)
            return fail_at(fault, DPT_E_LAYOUT, arm, section, name);
        has_ended = name[i] == 0;
    }
    return DPT_OK;
}

static dpt_result check_joint(const struct dpt_arm *arm, int section, const struct arm_joint *joint,
                              dpt_mesh_fault *fault)
{
    if (joint->bytes != sizeof *joint)
        return fail_at(fault, DPT_E_LAYOUT, arm, section, &joint->bytes);
    if (joint->kind > DPT_JOINT_PRISMATIC)
        return fail_at(fault, DPT_E_INDEX, arm, section, &joint->kind);
    DPT_TRY(check_coordinates(arm, section, &joint->lower, 1, fault));
    DPT_TRY(check_range(arm, section, &joint->upper, 1, joint->lower, DPT_COORDINATE_MAX, fault));
    if (joint->kind == DPT_JOINT_CONTINUOUS && (joint->lower != 0.0 || joint->upper != 0.0))
        return fail_at(fault, DPT_E_FINITE, arm, section, &joint->lower);
    DPT_TRY(check_range(arm, section, &joint->velocity, 1, 0.0, LIMIT_MAX, fault));
    DPT_TRY(check_range(arm, section, &joint->effort, 1, 0.0, LIMIT_MAX, fault));
    DPT_TRY(check_range(arm, section, &joint->damping, 1, 0.0, LIMIT_MAX, fault));
    DPT_TRY(check_range(arm, section, &joint->friction, 1, 0.0, LIMIT_MAX, fault));
    return check_name(arm, section, joint->name, fault);
}

/* One of some links, which so many joints move. */
static dpt_result check_link(const struct dpt_arm *arm, int section, const struct arm_link *links, uint32_t index,
                             uint32_t joints, dpt_mesh_fault *fault)
{
    const struct arm_link *link = &links[index];
    if (link->bytes != sizeof *link)
        return fail_at(fault, DPT_E_LAYOUT, arm, section, &link->bytes);
    if (link->parent != DPT_NONE && link->parent >= index)
        return fail_at(fault, DPT_E_INDEX, arm, section, &link->parent);
    if (link->joint >= joints)
        return fail_at(fault, DPT_E_INDEX, arm, section, &link->joint);
    if (link->slides > 1)
        return fail_at(fault, DPT_E_INDEX, arm, section, &link->slides);
    DPT_TRY(check_pose(arm, section, &link->pose, fault));
    DPT_TRY(check_unit(arm, section, link->axis, 3, fault));
    DPT_TRY(check_coordinates(arm, section, &link->factor, 1, fault));
    if (link->factor == 0.0)
        return fail_at(fault, DPT_E_FINITE, arm, section, &link->factor);
    DPT_TRY(check_coordinates(arm, section, &link->offset, 1, fault));
    DPT_TRY(check_range(arm, section, &link->mass, 1, 0.0, DPT_COORDINATE_MAX, fault));
    return check_coordinates(arm, section, link->centre, 3, fault);
}

/* Check that each of some joints moves at least one of the links in the way of its kind. */
static dpt_result check_moved(const struct dpt_arm *arm, int section, const struct arm_joint *joints,
                              uint32_t joint_count, const struct arm_link *links, uint32_t link_count,
                              dpt_mesh_fault *fault)
{
    uint32_t moved = 0;
    for (uint32_t i = 0; i < link_count; i++)
        if (links[i].slides == (joints[links[i].joint].kind == DPT_JOINT_PRISMATIC))
            moved |= 1u << links[i].joint;
    for (uint32_t i = 0; i < joint_count; i++)
        if (!(moved >> i & 1))
            return fail_at(fault, DPT_E_INDEX, arm, section, &joints[i]);
    return DPT_OK;
}

/* Check the order of joints: those on the path to the tool come first, in the order of the path. */
static dpt_result check_order(const struct dpt_arm *arm, dpt_mesh_fault *fault)
{
    const struct arm_link *links = arm_links(arm);
    uint8_t path[DPT_ARM_LINKS_MAX];
    uint32_t count = arm_path(links, arm->tool_link, path), joints_met = 0;
    for (uint32_t i = 0; i < count; i++) {
        const struct arm_link *link = &links[path[i]];
        if (link->joint > joints_met)
            return fail_at(fault, DPT_E_INDEX, arm, ARM_LINKS, &link->joint);
        joints_met += link->joint == joints_met;
    }
    return DPT_OK;
}

/* Check the tips, and the jaws that move them. */
static dpt_result check_tips(const struct dpt_arm *arm, dpt_mesh_fault *fault)
{
    uint32_t corners = 0;
    for (uint32_t i = 0; i < arm_jaw_count(arm); i++)
        DPT_TRY(check_joint(arm, ARM_JAWS, &arm_jaws(arm)[i], fault));
    for (uint32_t i = 0; i < arm_jaw_link_count(arm); i++)
        DPT_TRY(check_link(arm, ARM_JAW_LINKS, arm_jaw_links(arm), i, arm_jaw_count(arm), fault));
    DPT_TRY(check_moved(arm, ARM_JAWS, arm_jaws(arm), arm_jaw_count(arm), arm_jaw_links(arm), arm_jaw_link_count(arm),
                        fault));
    for (uint32_t i = 0; i < arm_tip_count(arm); i++) {
        const struct arm_tip *tip = &arm_tips(arm)[i];
        if (tip->bytes != sizeof *tip)
            return fail_at(fault, DPT_E_LAYOUT, arm, ARM_TIPS, &tip->bytes);
        if (tip->link != DPT_NONE && tip->link >= arm_jaw_link_count(arm))
            return fail_at(fault, DPT_E_INDEX, arm, ARM_TIPS, &tip->link);
        if (tip->first_corner != corners)
            return fail_at(fault, DPT_E_INDEX, arm, ARM_TIPS, &tip->first_corner);
        if (tip->corner_count < 3 || tip->corner_count > DPT_HULL_CORNERS_MAX ||
            tip->corner_count > arm_corner_count(arm) - corners)
            return fail_at(fault, DPT_E_INDEX, arm, ARM_TIPS, &tip->corner_count);
        DPT_TRY(check_range(arm, ARM_TIPS, &tip->radius, 1, 0.0, DPT_COORDINATE_MAX, fault));
        DPT_TRY(check_name(arm, ARM_TIPS, tip->name, fault));
        corners += tip->corner_count;
    }
    if (corners != arm_corner_count(arm))
        return fail_at(fault, DPT_E_LAYOUT, arm, ARM_HEADER, &arm->corners);
    return check_coordinates(arm, ARM_CORNERS, arm_corners(arm)->at, 3 * (int)corners, fault);
}

/* Check all but the lengths and the meshes of a file in the host's byte order. */
static dpt_result check_content(const struct dpt_arm *arm, dpt_mesh_fault *fault)
{
    DPT_TRY(check_meshes_place(arm, fault));
    for (uint32_t i = 0; i < arm->joints; i++)
        DPT_TRY(check_joint(arm, ARM_JOINTS, &arm_joints(arm)[i], fault));
    for (uint32_t i = 0; i < arm->links; i++)
        DPT_TRY(check_link(arm, ARM_LINKS, arm_links(arm), i, arm->joints, fault));
    if (arm->tool_link >= arm->links)
        return fail_at(fault, DPT_E_INDEX, arm, ARM_HEADER, &arm->tool_link);
    DPT_TRY(check_order(arm, fault));
    DPT_TRY(check_moved(arm, ARM_JOINTS, arm_joints(arm), arm->joints, arm_links(arm), arm->links, fault));
    DPT_TRY(check_pose(arm, ARM_HEADER, &arm->tool, fault));
    DPT_TRY(check_name(arm, ARM_HEADER, arm->name, fault));
    DPT_TRY(check_name(arm, ARM_HEADER, arm->root_name, fault));
    DPT_TRY(check_name(arm, ARM_HEADER, arm->tool_name, fault));
    for (uint32_t i = 0; i < arm->segments; i++) {
        const dpt_segment *segment = &arm_segments(arm)[i];
        DPT_TRY(check_coordinates(arm, ARM_SEGMENTS, segment->a, 3, fault));
        DPT_TRY(check_coordinates(arm, ARM_SEGMENTS, segment->b, 3, fault));
        DPT_TRY(check_range(arm, ARM_SEGMENTS, &segment->radius, 1, 0.0, DPT_COORDINATE_MAX, fault));
    }
    for (uint32_t i = 0; i < arm->bodies; i++) {
        DPT_TRY(check_pose(arm, ARM_BODIES, &arm_bodies(arm)[i].pose, fault));
        DPT_TRY(check_name(arm, ARM_BODIES, arm_bodies(arm)[i].name, fault));
    }
    return check_tips(arm, fault);
}

/*
 * Verify each mesh; convert it instead if `bytes`, the writable file, is not NULL. In a fault, the byte counts from the
 * beginning of the arm's file, and the section is one of the mesh's.
 */
static dpt_result check_meshes(const struct dpt_arm *arm, void *bytes, dpt_mesh_fault *fault)
{
    for (uint32_t i = 0; i < arm->bodies; i++) {
        const uint64_t at = arm_bodies(arm)[i].mesh_offset;
        const size_t size = (size_t)arm_bodies(arm)[i].mesh_bytes;
        dpt_result result = bytes ? dpt_mesh_convert((char *)bytes + at, size, fault)
                                  : dpt_mesh_verify((const char *)arm + at, size, fault);
        if (result != DPT_OK && fault)
            fault->byte += at;
        DPT_TRY(result);
    }
    return DPT_OK;
}

/*
 * Check all up to the byte order, and copy the header to `arm` in the file's byte order. If the file is shorter than
 * the header, the rest of `arm` is zero.
 */
static dpt_result read_header(const void *bytes, size_t size, struct dpt_arm *arm, dpt_mesh_fault *fault)
{
    const size_t min_bytes = sizeof arm->magic + 8;
    if (!bytes)
        return DPT_E_ARGUMENT;
    if (fault)
        DPT_TRY(sized_check(fault, sizeof *fault, 0));
    if ((uintptr_t)bytes % 8)
        return fail(fault, DPT_E_ALIGN, 0, ARM_HEADER);
    if (memcmp(bytes, ARM_MAGIC, size < 8 ? size : 8))
        return fail(fault, DPT_E_MAGIC, 0, ARM_HEADER);
    if (size < min_bytes)
        return fail(fault, DPT_E_TRUNCATED, size, ARM_HEADER);
    memset(arm, 0, sizeof *arm);
    memcpy(arm, bytes, size < sizeof *arm ? size : sizeof *arm);
    if (arm->byte_order != MESH_BYTE_ORDER && arm->byte_order != MESH_BYTE_ORDER_SWAPPED)
        return fail_at(fault, DPT_E_LAYOUT, arm, ARM_HEADER, &arm->byte_order);
    return DPT_OK;
}

dpt_result dpt_arm_verify(const void *bytes, size_t size, dpt_mesh_fault *fault)
{
    struct dpt_arm header;
    DPT_TRY(read_header(bytes, size, &header, fault));
    if (header.byte_order == MESH_BYTE_ORDER_SWAPPED)
        return fail_at(fault, DPT_E_BYTE_ORDER, &header, ARM_HEADER, &header.byte_order);
    DPT_TRY(check_header(&header, size, fault));
    DPT_TRY(check_crc(&header, bytes, fault));
    DPT_TRY(check_content((const struct dpt_arm *)bytes, fault));
    return check_meshes((const struct dpt_arm *)bytes, NULL, fault);
}

dpt_result dpt_arm_open(const void *bytes, size_t size, const dpt_arm **arm)
{
    if (!arm)
        return DPT_E_ARGUMENT;
    DPT_TRY(dpt_arm_verify(bytes, size, NULL));
    *arm = bytes;
    return DPT_OK;
}

dpt_result dpt_arm_convert(void *bytes, size_t size, dpt_mesh_fault *fault)
{
    struct dpt_arm header;
    DPT_TRY(read_header(bytes, size, &header, fault));
    if (header.byte_order != MESH_BYTE_ORDER_SWAPPED)
        return dpt_arm_verify(bytes, size, fault);

    arm_swap_header(&header);
    DPT_TRY(check_header(&header, size, fault));
    DPT_TRY(check_crc(&header, bytes, fault));
    arm_swap_records(&header, bytes);
    memcpy(bytes, &header, header.header_bytes);
    DPT_TRY(check_content((const struct dpt_arm *)bytes, fault));
    DPT_TRY(check_meshes((const struct dpt_arm *)bytes, bytes, fault));
    header.crc32 = arm_crc(bytes, size);
    memcpy(bytes, &header, header.header_bytes);
    return DPT_OK;
}
