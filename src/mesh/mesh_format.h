/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The layout of a .dpa file, version 4: the single source of docs/format.md, of the compiler's writer
 * and of the core's reader. `struct dpt_mesh` is the file's first bytes; an older file has fewer sections, and so
 * begins what follows them, if it has that at all, earlier: read it by mesh_tail.
 *
 * Little-endian; every number is 4 or 8 bytes wide; sections hold 4-byte words only, begin at
 * multiples of 64 and follow each other in the order of MESH_SECTIONS with less than 64 zero bytes
 * between them.
 */
#ifndef DPT_MESH_FORMAT_H
#define DPT_MESH_FORMAT_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "base/lanes.h"
#include "dynpoint/mesh.h"

/* 89 44 50 41 0d 0a 1a 0a: like PNG's, survives no text-mode transfer, and no text begins so. */
#define MESH_MAGIC              "\211DPA\r\n\032\n"
#define MESH_BYTE_ORDER         0x01020304u
#define MESH_BYTE_ORDER_SWAPPED 0x04030201u
#define MESH_VERSION            4u
#define MESH_ALIGN              64u
#define MESH_LEVELS_MAX         8u /* 16^8 is more leaves than 2^32 triangles can fill */

#define MESH_SELF_INTERSECTIONS_MAX 10000u /* pairs that are counted */

/* Neighbour over an edge. */
#define MESH_EDGE_OPEN UINT32_MAX
#define MESH_EDGE_MANY (UINT32_MAX - 1) /* non-manifold: three triangles or more */

/* Place of a source triangle that was dropped. */
#define MESH_DROPPED_DEGENERATE (UINT32_MAX - 1)
#define MESH_DROPPED_DUPLICATE  (UINT32_MAX - 2)

/* Bits of a part's flags. */
#define MESH_PART_CLOSED                                                                           \
    1u /* every edge has two triangles, wound one way; a cavity's wall inward */
#define MESH_PART_MANIFOLD 2u /* no edge has more than two */
#define MESH_PART_WOUND    4u /* no two triangles run through an edge in the same direction */
#define MESH_PART_SOLID    8u /* it has an inside: closed, or nearly (docs/algorithms/winding.md) */
#define MESH_PART_WINDING  16u /* solid, and only a winding number tells on which side a point is */
#define MESH_PART_BURIED   32u /* it lies wholly inside of another, solid part: both its sides do */

/* A triangle's flags (DPT_EDGE_..., DPT_CORNER_... of dynpoint/mesh.h) are below. */
#define MESH_FLAGS_END 0x40000u

/* clang-format off */
/*      id                name          words per entry, of what  */
#define MESH_SECTIONS(X)                                                                           \
    X(MESH_VERTICES,      "vertices")   /* 3 floats a vertex                                    */ \
    X(MESH_TRIANGLES,     "triangles")  /* 3 vertices a triangle                                */ \
    X(MESH_NEIGHBOURS,    "neighbours") /* 3 a triangle: over the edge from corner k to k + 1   */ \
    X(MESH_FAN_FIRST,     "fan_first")  /* 1 a vertex and one more: where its fan begins        */ \
    X(MESH_FANS,          "fans")       /* 3 a triangle: the triangles at each vertex, by number */ \
    X(MESH_PARTS,         "parts")      /* 1 a triangle: its part                               */ \
    X(MESH_PART_TABLE,    "part_table") /* 4 a part: flags, triangles, open and many-edges      */ \
    X(MESH_SOURCES,       "sources")    /* 1 a triangle: its number in the source               */ \
    X(MESH_PLACES,        "places")     /* 1 a source triangle: its place here, or why not      */ \
    X(MESH_BOXES,         "boxes")      /* 6 x 16 floats a node, the leaves' parents first      */ \
    X(MESH_LEAVES,        "leaves")     /* 9 x 16 floats a leaf of 16 triangles                 */ \
    X(MESH_MOMENTS,       "moments")    /* 20 x 16 floats a node, then 1 word a leaf; or empty  */ \
    X(MESH_NORMALS,       "normals")    /* 3 floats a vertex, or empty (mesh_normals)           */ \
    X(MESH_FLAGS,         "flags")      /* 1 a triangle: its edges and corners                  */
/* clang-format on */

#define MESH_SECTION_ID(id, name) id,
enum { MESH_SECTIONS(MESH_SECTION_ID) MESH_SECTION_COUNT };
#undef MESH_SECTION_ID

/* Places in a file that are no section. */
enum { MESH_HEADER = MESH_SECTION_COUNT, MESH_PADDING };

#define MESH_BOX_WORDS    (6u * LANES)
#define MESH_LEAF_WORDS   (9u * LANES)
#define MESH_MOMENT_WORDS (MESH_MOMENT_ROWS * LANES)

/* A block of moments, of 16 children: area vector, its place, quadrupole, octupole, remainder, radius; a radius of -1 stands for none. */
enum {
    MESH_MOMENT_AREA = 0, /* x, y, z */
    MESH_MOMENT_AT = 3,   /* x, y, z */
    MESH_MOMENT_QUAD = 6, /* xx, yy, xy, xz, yz */
    MESH_MOMENT_OCT = 11, /* xxx, yyy, xxy, yyx, xxz, yyz, xyz */
    MESH_MOMENT_REMAINDER = 18,
    MESH_MOMENT_RADIUS = 19,
    MESH_MOMENT_ROWS = 20
};

struct mesh_section {
    char name[16]; /* filled up with zeros */
    uint64_t offset;
    uint64_t bytes;
    uint32_t crc32;
    uint32_t reserved[3];
};

/* What stands behind the section table: nothing in version 1, four words in version 2, up to the crease in version 3. */
struct mesh_tail {
    uint32_t solid_components;
    uint32_t cavities;
    uint32_t winding_components;
    uint32_t buried_components;
    uint32_t crease_edges;
    uint32_t normalless_vertices;
    double crease;                    /* rad */
    uint32_t self_intersections;      /* pairs of triangles; DPT_NONE: not known */
    uint32_t self_intersections_more; /* the search stopped, there may be more: 1 */
    uint32_t self_intersection[2];    /* one pair, by numbers of the source, or DPT_NONE twice */
};

/*
 * Offsets are part of the format. After `magic` come 4-byte words up to `bytes`, then 8-byte words up
 * to `section`; the tail is words of 4 bytes, but for the crease.
 */
struct dpt_mesh {
    char magic[8];
    uint32_t byte_order;
    uint32_t version; /* the oldest reader that understands it */
    uint32_t header_bytes;
    uint32_t header_crc32; /* of header_bytes bytes with this word 0 */
    uint32_t section_count;
    uint32_t writer_version; /* major << 16 | minor << 8 | patch of the compiler */
    uint32_t triangles;
    uint32_t vertices;
    uint32_t source_triangles;
    uint32_t source_vertices;
    uint32_t parts;
    uint32_t leaves;
    uint32_t levels; /* of boxes, the root included */
    uint32_t dropped_degenerate;
    uint32_t dropped_duplicate;
    uint32_t unused_vertices;
    uint32_t concave_polygons;
    uint32_t open_edges;
    uint32_t nonmanifold_edges;
    uint32_t wrong_way_edges;
    uint32_t closed_components;
    uint32_t inward_components;
    uint32_t turned_triangles;
    uint32_t reserved;
    uint64_t bytes; /* the file's length */
    uint64_t source_bytes;
    uint64_t source_hash;
    double scale;
    double rounding;
    double box_min[3];
    double box_max[3];
    double filter_centre[3]; /* boxes and leaves hold (x - centre) * scale, within -1..1 */
    double filter_scale;     /* a power of two */
    struct mesh_section section[MESH_SECTION_COUNT];
    struct mesh_tail tail; /* here in the newest version alone */
};

/* How many sections a file of some version has, and how long its header is. */
static inline uint32_t mesh_section_count(uint32_t version)
{
    return version == 1 ? MESH_MOMENTS : version == 2 ? MESH_NORMALS : MESH_SECTION_COUNT;
}

static inline size_t mesh_tail_bytes(uint32_t version)
{
    return version == 1   ? 0
           : version == 2 ? offsetof(struct mesh_tail, crease_edges)
           : version == 3 ? offsetof(struct mesh_tail, self_intersections)
                          : sizeof(struct mesh_tail);
}

static inline size_t mesh_tail_offset(uint32_t version)
{
    return offsetof(struct dpt_mesh, section) +
           mesh_section_count(version) * sizeof(struct mesh_section);
}

static inline uint32_t mesh_header_bytes(uint32_t version)
{
    return (uint32_t)(mesh_tail_offset(version) + mesh_tail_bytes(version));
}

/* As far as the file's version has it, else zeros or not known; what is closed is solid in version 1 too. */
static inline struct mesh_tail mesh_tail(const struct dpt_mesh *mesh)
{
    struct mesh_tail tail = { .solid_components = mesh->closed_components,
                              .self_intersections = DPT_NONE,
                              .self_intersection = { DPT_NONE, DPT_NONE } };
    memcpy(&tail, (const char *)mesh + mesh_tail_offset(mesh->version),
           mesh_tail_bytes(mesh->version));
    return tail;
}

static inline const void *mesh_section(const struct dpt_mesh *mesh, int id)
{
    return (const char *)mesh + mesh->section[id].offset;
}

static inline const float *mesh_floats(const struct dpt_mesh *mesh, int id)
{
    return mesh_section(mesh, id);
}

static inline const uint32_t *mesh_words(const struct dpt_mesh *mesh, int id)
{
    return mesh_section(mesh, id);
}

/*
 * There are normals but where triangles have their vertices nearly alone, fans of two on average or fewer: there they
 * would be a quarter of the file and save nothing.
 */
static inline int mesh_stores_normals(const struct dpt_mesh *mesh)
{
    return mesh->version > 2 && 2 * (uint64_t)mesh->vertices <= 3 * (uint64_t)mesh->triangles;
}

/* How many 4-byte words a section must have, by the header's counts; boxes: nodes of all levels. */
static inline uint64_t mesh_section_words(const struct dpt_mesh *mesh, int id, uint64_t nodes)
{
    switch (id) {
    case MESH_VERTICES:
        return 3 * (uint64_t)mesh->vertices;
    case MESH_TRIANGLES:
    case MESH_NEIGHBOURS:
    case MESH_FANS:
        return 3 * (uint64_t)mesh->triangles;
    case MESH_FAN_FIRST:
        return (uint64_t)mesh->vertices + 1;
    case MESH_PARTS:
    case MESH_SOURCES:
    case MESH_FLAGS:
        return mesh->triangles;
    case MESH_PART_TABLE:
        return 4 * (uint64_t)mesh->parts;
    case MESH_PLACES:
        return mesh->source_triangles;
    case MESH_BOXES:
        return nodes * MESH_BOX_WORDS;
    case MESH_LEAVES:
        return (uint64_t)mesh->leaves * MESH_LEAF_WORDS;
    case MESH_NORMALS:
        return mesh_stores_normals(mesh) ? 3 * (uint64_t)mesh->vertices : 0;
    default:
        return mesh_tail(mesh).winding_components ? nodes * MESH_MOMENT_WORDS + mesh->leaves : 0;
    }
}

/*
 * The moments of a file that has some, else NULL: of each node, in the order of the boxes, 16 children as
 * kernel_moments (kernel_ops.h) reads them; `lanes` gets the words behind, of each leaf the triangles of solid parts as bits.
 */
static inline const float *mesh_moments(const struct dpt_mesh *mesh, const uint32_t **lanes)
{
    if (!mesh_tail(mesh).winding_components)
        return NULL;
    *lanes = mesh_words(mesh, MESH_MOMENTS) + mesh->section[MESH_MOMENTS].bytes / 4 - mesh->leaves;
    return mesh_floats(mesh, MESH_MOMENTS);
}

/* Unit normals, 3 floats a vertex, zero where there is none; NULL when the file has no such. */
static inline const float *mesh_normals(const struct dpt_mesh *mesh)
{
    return mesh_stores_normals(mesh) ? mesh_floats(mesh, MESH_NORMALS) : NULL;
}

/* A word a triangle; NULL in an older file. */
static inline const uint32_t *mesh_flags(const struct dpt_mesh *mesh)
{
    return mesh->version > 2 ? mesh_words(mesh, MESH_FLAGS) : NULL;
}

/* A part's bits, one for one. What is closed is solid in a file of version 1 too. */
static inline uint32_t mesh_part_flags(const struct dpt_mesh *mesh, uint32_t part)
{
    uint32_t flags = mesh_words(mesh, MESH_PART_TABLE)[4 * (size_t)part];
    if (mesh->version == 1)
        flags = (flags & 7u) | (flags & MESH_PART_CLOSED ? MESH_PART_SOLID : 0);
    return flags;
}

/*
 * The tree's shape follows from the number of leaves: node k of a level has the 16 nodes from 16 k of
 * the level below (the last one fewer), level 0 being the leaves. Fills `count` of each level, from
 * 1 on; returns the number of levels of boxes.
 */
static inline uint32_t mesh_levels(uint32_t leaves, uint32_t count[MESH_LEVELS_MAX + 1],
                                   uint64_t *nodes)
{
    uint32_t level = 0;
    *nodes = 0;
    count[0] = leaves;
    do {
        count[level + 1] = (count[level] + LANES - 1) / LANES;
        *nodes += count[++level];
    } while (count[level] > 1);
    return level;
}

static inline uint64_t mesh_aligned(uint64_t offset)
{
    return (offset + MESH_ALIGN - 1) & ~(uint64_t)(MESH_ALIGN - 1);
}

/* A section's name as the file holds it, filled up with zeros. */
static inline void mesh_section_name(int id, char out[16])
{
#define MESH_SECTION_NAME(section, text)                                                           \
    case section: {                                                                                \
        const char name[16] = text;                                                                \
        memcpy(out, name, sizeof name);                                                            \
        break;                                                                                     \
    }
    switch (id) {
        MESH_SECTIONS(MESH_SECTION_NAME)
        MESH_SECTION_NAME(MESH_HEADER, "header")
        MESH_SECTION_NAME(MESH_PADDING, "padding")
    default:
        memset(out, 0, 16);
    }
#undef MESH_SECTION_NAME
}

#endif
