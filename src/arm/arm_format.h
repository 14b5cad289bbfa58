/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The layout of an arm's .dpa file. The compiler's writer, the core's reader and docs/format.md follow this header alone.
 * `struct dpt_arm` is the first bytes of the file. Joints, links, segments and bodies come after it; in version 2 also
 * jaws, jaw links, tips and corners; then the meshes of the bodies. Each mesh is a whole file (mesh_format.h) at a
 * multiple of 64; fewer than 64 zero bytes stand before it.
 *
 * An arm whose tool has no tips is written as version 1, whose header ends before `jaws`.
 *
 * Numbers are little-endian, 4 or 8 bytes wide. Every record is a multiple of 8 bytes.
 */
#ifndef DPT_ARM_FORMAT_H
#define DPT_ARM_FORMAT_H

#include "base/crc32.h"
#include "dynpoint/arm.h"
#include "mesh/mesh_swap.h"

/* The magic of a mesh, with another fourth byte. */
#define ARM_MAGIC   "\211DPK\r\n\032\n"
#define ARM_VERSION 2u

/* The records. Their fields mean what those of dpt_arm_joint, dpt_arm_link and dpt_arm_body mean (arm.h). */
struct arm_joint {
    uint32_t bytes; /* of the record */
    uint32_t kind;
    double lower;
    double upper;
    double velocity;
    double effort;
    double damping;
    double friction;
    char name[DPT_ARM_NAME];
};

struct arm_link {
    uint32_t bytes; /* of the record */
    uint32_t parent;
    uint32_t joint;
    uint32_t slides;
    dpt_pose pose;
    double axis[3];
    double factor;
    double offset;
    double mass;
    double centre[3];
};

struct arm_body {
    uint64_t mesh_offset;
    uint64_t mesh_bytes;
    dpt_pose pose;
    char name[DPT_ARM_NAME];
};

struct arm_tip {
    uint32_t bytes; /* of the record */
    uint32_t link;
    uint32_t first_corner; /* its corners follow those of the tip before it */
    uint32_t corner_count;
    double radius;
    char name[DPT_ARM_NAME];
};

struct arm_corner {
    double at[3];
};

/*
 * The header. After `magic` come 4-byte words up to `bytes`, then 8-byte words up to `name`; from `jaws` on 4-byte
 * words.
 */
struct dpt_arm {
    char magic[8];
    uint32_t byte_order;
    uint32_t version; /* of the oldest reader that understands the file */
    uint32_t header_bytes;
    uint32_t crc32;          /* of the whole file with this word set to 0 */
    uint32_t writer_version; /* major << 16 | minor << 8 | patch of the compiler */
    uint32_t joints;
    uint32_t links;
    uint32_t segments;
    uint32_t bodies;
    uint32_t tool_link;
    uint64_t bytes; /* length of the file */
    uint64_t source_bytes;
    uint64_t source_hash;
    dpt_pose tool;
    char name[DPT_ARM_NAME];
    char root_name[DPT_ARM_NAME];
    char tool_name[DPT_ARM_NAME];
    uint32_t jaws; /* from here on only in version 2: arm_jaw_count and the like know */
    uint32_t jaw_links;
    uint32_t tips;
    uint32_t corners;
};

/* The header of version 1. */
enum { ARM_HEADER_1 = 320 };

typedef char arm_header_keeps_its_size[sizeof(struct dpt_arm) == 336 ? 1 : -1];
typedef char arm_header_1_keeps_its_size[offsetof(struct dpt_arm, jaws) == ARM_HEADER_1 ? 1 : -1];
typedef char arm_joint_keeps_its_size[sizeof(struct arm_joint) == 120 ? 1 : -1];
typedef char arm_link_keeps_its_size[sizeof(struct arm_link) == 144 ? 1 : -1];
typedef char arm_segment_keeps_its_size[sizeof(dpt_segment) == 56 ? 1 : -1];
typedef char arm_body_keeps_its_size[sizeof(struct arm_body) == 136 ? 1 : -1];
typedef char arm_tip_keeps_its_size[sizeof(struct arm_tip) == 88 ? 1 : -1];

/* The sections of a file, as a fault names them. */
enum {
    ARM_HEADER,
    ARM_JOINTS,
    ARM_LINKS,
    ARM_SEGMENTS,
    ARM_BODIES,
    ARM_JAWS,
    ARM_JAW_LINKS,
    ARM_TIPS,
    ARM_CORNERS,
    ARM_PADDING
};

/* The counts that only version 2 has. */
static inline uint32_t arm_jaw_count(const struct dpt_arm *arm)
{
    return arm->version < 2 ? 0 : arm->jaws;
}

static inline uint32_t arm_jaw_link_count(const struct dpt_arm *arm)
{
    return arm->version < 2 ? 0 : arm->jaw_links;
}

static inline uint32_t arm_tip_count(const struct dpt_arm *arm)
{
    return arm->version < 2 ? 0 : arm->tips;
}

static inline uint32_t arm_corner_count(const struct dpt_arm *arm)
{
    return arm->version < 2 ? 0 : arm->corners;
}

static inline const struct arm_joint *arm_joints(const struct dpt_arm *arm)
{
    return (const void *)((const char *)arm + arm->header_bytes);
}

static inline const struct arm_link *arm_links(const struct dpt_arm *arm)
{
    return (const void *)(arm_joints(arm) + arm->joints);
}

static inline const dpt_segment *arm_segments(const struct dpt_arm *arm)
{
    return (const void *)(arm_links(arm) + arm->links);
}

static inline const struct arm_body *arm_bodies(const struct dpt_arm *arm)
{
    return (const void *)(arm_segments(arm) + arm->segments);
}

static inline const struct arm_joint *arm_jaws(const struct dpt_arm *arm)
{
    return (const void *)(arm_bodies(arm) + arm->bodies);
}

static inline const struct arm_link *arm_jaw_links(const struct dpt_arm *arm)
{
    return (const void *)(arm_jaws(arm) + arm_jaw_count(arm));
}

static inline const struct arm_tip *arm_tips(const struct dpt_arm *arm)
{
    return (const void *)(arm_jaw_links(arm) + arm_jaw_link_count(arm));
}

static inline const struct arm_corner *arm_corners(const struct dpt_arm *arm)
{
    return (const void *)(arm_tips(arm) + arm_tip_count(arm));
}

/* The offset at which the records end, by the header's counts. */
static inline uint64_t arm_records_end(const struct dpt_arm *arm)
{
    return arm->header_bytes + arm->joints * sizeof(struct arm_joint) + arm->links * sizeof(struct arm_link) +
           arm->segments * sizeof(dpt_segment) + arm->bodies * sizeof(struct arm_body) +
           arm_jaw_count(arm) * sizeof(struct arm_joint) + arm_jaw_link_count(arm) * sizeof(struct arm_link) +
           arm_tip_count(arm) * sizeof(struct arm_tip) + arm_corner_count(arm) * sizeof(struct arm_corner);
}

/* The checksum that a file of these bytes should have. `bytes` may be in either byte order. */
static inline uint32_t arm_crc(const void *bytes, size_t size)
{
    struct crc32 crc;
    struct dpt_arm header;
    crc32_init(&crc);
    memcpy(&header, bytes, sizeof header);
    header.crc32 = 0;
    return crc32_more(&crc, crc32_of(&crc, &header, sizeof header), (const char *)bytes + sizeof header,
                      size - sizeof header);
}

/* List some links from the first without a parent to `link`; `link` is the last one. Returns their number. */
static inline uint32_t arm_path(const struct arm_link *links, uint32_t link, uint8_t path[DPT_ARM_LINKS_MAX])
{
    uint32_t count = 0, at = 0;
    for (uint32_t i = link; i != DPT_NONE; i = links[i].parent)
        count++;
    for (uint32_t i = link; i != DPT_NONE; i = links[i].parent)
        path[count - ++at] = (uint8_t)i;
    return count;
}

/* Swap the byte order of a header. Twice gives the same bytes again, as for arm_swap_records. */
static inline void arm_swap_header(struct dpt_arm *arm)
{
    uint32_t header_bytes = arm->header_bytes;
    if (arm->byte_order != MESH_BYTE_ORDER)
        mesh_swap4(&header_bytes, 1);
    const int is_long = header_bytes != ARM_HEADER_1;
    const size_t first4 = offsetof(struct dpt_arm, byte_order);
    const size_t first8 = offsetof(struct dpt_arm, bytes);
    mesh_swap4((char *)arm + first4, (first8 - first4) / 4);
    mesh_swap8((char *)arm + first8, (offsetof(struct dpt_arm, name) - first8) / 8);
    if (is_long)
        mesh_swap4((char *)arm + ARM_HEADER_1, (sizeof *arm - ARM_HEADER_1) / 4);
}

static inline void arm_swap_joint(char *at)
{
    const size_t first4 = offsetof(struct arm_joint, lower);
    mesh_swap4(at, first4 / 4);
    mesh_swap8(at + first4, (offsetof(struct arm_joint, name) - first4) / 8);
}

static inline void arm_swap_link(char *at)
{
    const size_t first8 = offsetof(struct arm_link, pose);
    mesh_swap4(at, first8 / 4);
    mesh_swap8(at + first8, (sizeof(struct arm_link) - first8) / 8);
}

/* Swap the byte order of the records of the file at `bytes`. `arm` is its header in the host's byte order. */
static inline void arm_swap_records(const struct dpt_arm *arm, void *bytes)
{
    const size_t radius = offsetof(struct arm_tip, radius);
    char *at = (char *)bytes + arm->header_bytes;
    for (uint32_t i = 0; i < arm->joints; i++, at += sizeof(struct arm_joint))
        arm_swap_joint(at);
    for (uint32_t i = 0; i < arm->links; i++, at += sizeof(struct arm_link))
        arm_swap_link(at);
    for (uint32_t i = 0; i < arm->segments; i++, at += sizeof(dpt_segment))
        mesh_swap8(at, sizeof(dpt_segment) / 8);
    for (uint32_t i = 0; i < arm->bodies; i++, at += sizeof(struct arm_body))
        mesh_swap8(at, offsetof(struct arm_body, name) / 8);
    for (uint32_t i = 0; i < arm_jaw_count(arm); i++, at += sizeof(struct arm_joint))
        arm_swap_joint(at);
    for (uint32_t i = 0; i < arm_jaw_link_count(arm); i++, at += sizeof(struct arm_link))
        arm_swap_link(at);
    for (uint32_t i = 0; i < arm_tip_count(arm); i++, at += sizeof(struct arm_tip)) {
        mesh_swap4(at, radius / 4);
        mesh_swap8(at + radius, 1);
    }
    mesh_swap8(at, arm_corner_count(arm) * sizeof(struct arm_corner) / 8);
}

#endif
