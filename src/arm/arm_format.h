/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The layout of an arm's .dpa file, version 1. The compiler's writer, the core's reader and docs/format.md follow this
 * header alone. `struct dpt_arm` is the first bytes of the file. Joints, links, segments and bodies come after it, then
 * the meshes of the bodies. Each mesh is a whole file (mesh_format.h) at a multiple of 64; fewer than 64 zero bytes
 * stand before it.
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
#define ARM_VERSION 1u

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

/* The header. After `magic` come 4-byte words up to `bytes`, then 8-byte words up to `name`. */
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
};

typedef char arm_header_keeps_its_size[sizeof(struct dpt_arm) == 320 ? 1 : -1];
typedef char arm_joint_keeps_its_size[sizeof(struct arm_joint) == 120 ? 1 : -1];
typedef char arm_link_keeps_its_size[sizeof(struct arm_link) == 144 ? 1 : -1];
typedef char arm_segment_keeps_its_size[sizeof(dpt_segment) == 56 ? 1 : -1];
typedef char arm_body_keeps_its_size[sizeof(struct arm_body) == 136 ? 1 : -1];

/* The sections of a file, as a fault names them. */
enum { ARM_HEADER, ARM_JOINTS, ARM_LINKS, ARM_SEGMENTS, ARM_BODIES, ARM_PADDING };

static inline const struct arm_joint *arm_joints(const struct dpt_arm *arm)
{
    return (const void *)(arm + 1);
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

/* The offset at which the records end, by the header's counts. */
static inline uint64_t arm_records_end(const struct dpt_arm *arm)
{
    return sizeof *arm + arm->joints * sizeof(struct arm_joint) +
           arm->links * sizeof(struct arm_link) + arm->segments * sizeof(dpt_segment) +
           arm->bodies * sizeof(struct arm_body);
}

/* The checksum that a file of these bytes should have. `bytes` may be in either byte order. */
static inline uint32_t arm_crc(const void *bytes, size_t size)
{
    struct crc32 crc;
    struct dpt_arm header;
    crc32_init(&crc);
    memcpy(&header, bytes, sizeof header);
    header.crc32 = 0;
    return crc32_more(&crc, crc32_of(&crc, &header, sizeof header),
                      (const char *)bytes + sizeof header, size - sizeof header);
}

/* List the links from the root to `link`; `link` is the last one. Returns their number. */
static inline uint32_t arm_path(const struct dpt_arm *arm, uint32_t link,
                                uint8_t path[DPT_ARM_LINKS_MAX])
{
    const struct arm_link *links = arm_links(arm);
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
    const size_t first4 = offsetof(struct dpt_arm, byte_order);
    const size_t first8 = offsetof(struct dpt_arm, bytes);
    mesh_swap4((char *)arm + first4, (first8 - first4) / 4);
    mesh_swap8((char *)arm + first8, (offsetof(struct dpt_arm, name) - first8) / 8);
}

/* Swap the byte order of the records of the file at `bytes`. `arm` is its header in the host's byte order. */
static inline void arm_swap_records(const struct dpt_arm *arm, void *bytes)
{
    const size_t first4 = offsetof(struct arm_joint, lower),
                 first8 = offsetof(struct arm_link, pose);
    char *at = (char *)bytes + sizeof *arm;
    for (uint32_t i = 0; i < arm->joints; i++, at += sizeof(struct arm_joint)) {
        mesh_swap4(at, first4 / 4);
        mesh_swap8(at + first4, (offsetof(struct arm_joint, name) - first4) / 8);
    }
    for (uint32_t i = 0; i < arm->links; i++, at += sizeof(struct arm_link)) {
        mesh_swap4(at, first8 / 4);
        mesh_swap8(at + first8, (sizeof(struct arm_link) - first8) / 8);
    }
    for (uint32_t i = 0; i < arm->segments; i++, at += sizeof(dpt_segment))
        mesh_swap8(at, sizeof(dpt_segment) / 8);
    for (uint32_t i = 0; i < arm->bodies; i++, at += sizeof(struct arm_body))
        mesh_swap8(at, offsetof(struct arm_body, name) / 8);
}

#endif
