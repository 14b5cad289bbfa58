/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The layout of a .dpa file, version 7: the single source of docs/format.md, of the compiler's writer and of the
 * core's reader. `struct dpt_mesh` is the first bytes of a file of the newest version. An older file has fewer
 * sections, so the tail begins earlier, or is missing: read it by mesh_tail.
 *
 * Little-endian. Every number has 4 or 8 bytes. Sections hold 4-byte words only, begin at multiples of 64, and follow
 * each other in the order of MESH_SECTIONS, with less than 64 zero bytes between them.
 */
#ifndef DPT_MESH_FORMAT_H
#define DPT_MESH_FORMAT_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "base/lanes.h"
#include "dynpoint/mesh.h"
#include "mesh/spring_net.h"

/* 89 44 50 41 0d 0a 1a 0a: like that of PNG. A transfer in text mode destroys it, and no text begins so. */
#define MESH_MAGIC              "\211DPA\r\n\032\n"
#define MESH_BYTE_ORDER         0x01020304u
#define MESH_BYTE_ORDER_SWAPPED 0x04030201u
#define MESH_VERSION            7u
#define MESH_VERSION_PLAIN      6u /* of a mesh that was not moved, and without cells that have a term for their volume */
#define MESH_ALIGN              64u
#define MESH_LEVELS_MAX         8u /* 16^8 leaves are more than 2^32 triangles fill */

#define MESH_SELF_INTERSECTIONS_MAX 10000u /* of pairs; the count stops there */

/*
 * Weights of an embedding: the largest size, and how far their sum may be off 1. The compiler's weights have 24 bits of
 * one unit, and the sum is 1 exactly.
 */
#define MESH_WEIGHT_MAX 128.0f
#define MESH_WEIGHT_SUM 0x1p-16

/*
 * Springs: masses, stiffnesses and lengths that are not 0 are within these, drag and viscosity at most
 * MESH_DAMPING_MAX. A slice has few enough entries that a reader can look up the other end of every spring.
 */
#define MESH_SPRING_MIN         1e-15f
#define MESH_SPRING_MAX         1e15f
#define MESH_DAMPING_MAX        1e9f
#define MESH_SLICE_ENTRIES_MAX  1024u
#define MESH_SPRING_ENTRIES_MAX (UINT32_MAX / LANES)
#define MESH_CELLS_MAX          (1u << 26)

/* Rounding: how far the square of the stable step may exceed what the file's own numbers allow. */
#define MESH_STEP_ROUNDING 1e-5

/* How far from the source's origin that of a moved mesh may be, m. */
#define MESH_ORIGIN_MAX 1e9

/* Codes in place of a neighbour over an edge. */
#define MESH_EDGE_OPEN UINT32_MAX
#define MESH_EDGE_MANY (UINT32_MAX - 1) /* non-manifold: three triangles or more */

/* Codes in place of the place of a source triangle that was dropped. */
#define MESH_DROPPED_DEGENERATE (UINT32_MAX - 1)
#define MESH_DROPPED_DUPLICATE  (UINT32_MAX - 2)

/* Bits of a part's flags. CLOSED: every edge has two triangles, wound one way; a cavity's wall inward. */
#define MESH_PART_CLOSED   1u
#define MESH_PART_MANIFOLD 2u  /* no edge has more than two */
#define MESH_PART_WOUND    4u  /* no two triangles run through an edge in the same direction */
#define MESH_PART_SOLID    8u  /* it has an inside: closed, or nearly (docs/algorithms/winding.md) */
#define MESH_PART_WINDING  16u /* solid, and a point's side is decided by winding number only */
#define MESH_PART_BURIED   32u /* wholly inside another, solid part: both of its sides are inside */

/* A triangle's flags, DPT_EDGE_... and DPT_CORNER_... of dynpoint/mesh.h, are below this. */
#define MESH_FLAGS_END 0x40000u

/* clang-format off */
/*      id                name          words per entry, of what  */
#define MESH_SECTIONS(X)                                                                           \
    X(MESH_VERTICES,      "vertices")   /* 3 floats a vertex                                    */ \
    X(MESH_TRIANGLES,     "triangles")  /* 3 vertices a triangle                                */ \
    X(MESH_NEIGHBOURS,    "neighbours") /* 3 a triangle: over the edge from corner k to k + 1   */ \
    X(MESH_FAN_FIRST,     "fan_first")  /* 1 a vertex and one more: where its fan begins        */ \
    X(MESH_FANS,          "fans")       /* 3 a triangle: the triangles at each vertex, ascending */ \
    X(MESH_PARTS,         "parts")      /* 1 a triangle: its part                               */ \
    X(MESH_PART_TABLE,    "part_table") /* 4 a part: flags, triangles, open and many-edges      */ \
    X(MESH_SOURCES,       "sources")    /* 1 a triangle: its number in the source               */ \
    X(MESH_PLACES,        "places")     /* 1 a source triangle: its place here, or why not      */ \
    X(MESH_BOXES,         "boxes")      /* 6 x 16 floats a node, the leaves' parents first      */ \
    X(MESH_LEAVES,        "leaves")     /* 9 x 16 floats a leaf of 16 triangles                 */ \
    X(MESH_MOMENTS,       "moments")    /* 20 x 16 floats a node, then 1 word a leaf; or empty  */ \
    X(MESH_NORMALS,       "normals")    /* 3 floats a vertex, or empty (mesh_normals)           */ \
    X(MESH_FLAGS,         "flags")      /* 1 a triangle: its edges and corners                  */ \
    X(MESH_VERTEX_SOURCES, "vertex_sources") /* 1 a vertex: its number in the source            */ \
    X(MESH_EMBED_NODES,   "embed_nodes")   /* 4 nodes a vertex, or empty                        */ \
    X(MESH_EMBED_WEIGHTS, "embed_weights") /* 4 floats a vertex, or empty                       */ \
    X(MESH_SPRING_REST,   "spring_rest")   /* 3 floats a node; empty: the nodes are the vertices */ \
    X(MESH_SPRING_MASS,   "spring_mass")   /* 1 float a node: kg; 0: fixed                      */ \
    X(MESH_SPRING_DRAG,   "spring_drag")   /* 1 float a node: 1/s                               */ \
    X(MESH_SPRING_FIRST,  "spring_first")  /* 1 a slice and one more: its first entry           */ \
    X(MESH_SPRING_ENDS,   "spring_ends")   /* 16 nodes an entry: where its springs end          */ \
    X(MESH_SPRING_STIFFNESS, "spring_stiff")  /* 16 floats an entry: N/m                        */ \
    X(MESH_SPRING_LENGTH, "spring_length") /* 16 floats an entry: m                             */ \
    X(MESH_CELL_NODES,    "cell_nodes")    /* 8 x 16 nodes a slice of cells: their corners      */ \
    X(MESH_CELL_STIFFNESS, "cell_stiff")   /* 16 floats a slice of cells: N/m                   */
/* clang-format on */

#define MESH_SECTION_ID(id, name) id,
enum { MESH_SECTIONS(MESH_SECTION_ID) MESH_SECTION_COUNT };
#undef MESH_SECTION_ID

/* Parts of a file that are not sections, for faults. */
enum { MESH_HEADER = MESH_SECTION_COUNT, MESH_PADDING };

#define MESH_BOX_WORDS    (6u * LANES)
#define MESH_LEAF_WORDS   (9u * LANES)
#define MESH_MOMENT_WORDS (MESH_MOMENT_ROWS * LANES)

/*
 * Rows of a block of moments, of 16 children each: area vector, its place, quadrupole, octupole, remainder, radius. A
 * radius of -1 stands for no child.
 */
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

/*
 * What follows the section table: nothing in version 1, four words in version 2, up to the crease in version 3, up to
 * self_intersection in version 4, up to outside_distance in version 5, up to stable_step in version 6.
 */
struct mesh_tail {
    uint32_t solid_components;
    uint32_t cavities;
    uint32_t winding_components;
    uint32_t buried_components;
    uint32_t crease_edges;
    uint32_t normalless_vertices;
    double crease;                    /* rad */
    uint32_t self_intersections;      /* pairs of triangles; DPT_NONE: not known */
    uint32_t self_intersections_more; /* 1: the search stopped early, there may be more */
    uint32_t self_intersection[2];    /* one pair, by source number, or DPT_NONE twice */
    uint32_t nodes;                   /* of the mesh that the vertices are embedded in; 0: none */
    uint32_t outside_vertices;        /* those outside of all its cells */
    double outside_distance;          /* the largest distance of a vertex from all cells, m */
    uint32_t spring_nodes;            /* vertices, or nodes of the embedding; 0: no springs */
    uint32_t springs;                 /* each counted once */
    uint32_t spring_entries;          /* of all slices */
    uint32_t fixed_nodes;             /* those without mass */
    double viscosity;                 /* s */
    double spring_mass;               /* kg, of all nodes as if none were fixed */
    double poisson;                   /* Poisson's ratio of the net; 0 if it is not known */
    double stable_step;               /* s: of symplectic Euler without damping (springs.md) */
    double origin[3];                 /* m: what was taken off the scaled source's coordinates */
    double cell_size;                 /* m; 0 without cells */
    uint64_t cells;                   /* of a lattice, with a term for their volume; else 0 */
};

/*
 * Offsets are part of the format. After `magic` come 4-byte words up to `bytes`, then 8-byte words up to `section`.
 * The tail has 4-byte words, except for the crease, outside_distance and what follows fixed_nodes.
 */
struct dpt_mesh {
    char magic[8];
    uint32_t byte_order;
    uint32_t version; /* of the format; an older reader does not understand it */
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
    struct mesh_tail tail; /* at this offset in the newest version only */
};

/* How many sections a file of this version has. */
static inline uint32_t mesh_section_count(uint32_t version)
{
    return version == 1   ? MESH_MOMENTS
           : version == 2 ? MESH_NORMALS
           : version < 5  ? MESH_VERTEX_SOURCES
           : version == 5 ? MESH_SPRING_REST
           : version == 6 ? MESH_CELL_NODES
                          : MESH_SECTION_COUNT;
}

/* The bytes of the tail in a file of this version. */
static inline size_t mesh_tail_bytes(uint32_t version)
{
    return version == 1   ? 0
           : version == 2 ? offsetof(struct mesh_tail, crease_edges)
           : version == 3 ? offsetof(struct mesh_tail, self_intersections)
           : version == 4 ? offsetof(struct mesh_tail, nodes)
           : version == 5 ? offsetof(struct mesh_tail, spring_nodes)
           : version == 6 ? offsetof(struct mesh_tail, origin)
                          : sizeof(struct mesh_tail);
}

/* The offset of the tail. */
static inline size_t mesh_tail_offset(uint32_t version)
{
    return offsetof(struct dpt_mesh, section) + mesh_section_count(version) * sizeof(struct mesh_section);
}

/* The bytes of the header, section table and tail included. */
static inline uint32_t mesh_header_bytes(uint32_t version)
{
    return (uint32_t)(mesh_tail_offset(version) + mesh_tail_bytes(version));
}

/*
 * The tail of a file of any version. Fields that its version lacks are 0 or unknown; in version 1 the closed parts
 * count as the solid ones.
 */
static inline struct mesh_tail mesh_tail(const struct dpt_mesh *mesh)
{
    struct mesh_tail tail = { .solid_components = mesh->closed_components,
                              .self_intersections = DPT_NONE,
                              .self_intersection = { DPT_NONE, DPT_NONE } };
    memcpy(&tail, (const char *)mesh + mesh_tail_offset(mesh->version), mesh_tail_bytes(mesh->version));
    return tail;
}

/* The words of a section. */
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
 * Whether a file has normals. It has none where triangles share few vertices, on average fewer than two triangles a
 * vertex: normals would be a quarter of the file then and save nothing.
 */
static inline int mesh_stores_normals(const struct dpt_mesh *mesh)
{
    return mesh->version > 2 && 2 * (uint64_t)mesh->vertices <= 3 * (uint64_t)mesh->triangles;
}

/* Slices of 16 nodes. */
static inline uint32_t mesh_slices(uint32_t nodes)
{
    return nodes / LANES + (nodes % LANES > 0);
}

/* How many 4-byte words a section of the springs must have. */
static inline uint64_t mesh_spring_words(const struct mesh_tail *tail, int id)
{
    const uint64_t nodes = tail->spring_nodes;
    if (!nodes)
        return 0;
    switch (id) {
    case MESH_SPRING_REST:
        return tail->nodes ? 3 * nodes : 0;
    case MESH_SPRING_MASS:
    case MESH_SPRING_DRAG:
        return nodes;
    case MESH_SPRING_FIRST:
        return (uint64_t)mesh_slices(tail->spring_nodes) + 1;
    case MESH_CELL_NODES:
        return 8 * LANES * (uint64_t)mesh_slices((uint32_t)tail->cells);
    case MESH_CELL_STIFFNESS:
        return LANES * (uint64_t)mesh_slices((uint32_t)tail->cells);
    default:
        return (uint64_t)tail->spring_entries * LANES;
    }
}

/* How many 4-byte words a section must have by the header's counts. nodes: boxes of all levels. */
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
    case MESH_VERTEX_SOURCES:
        return mesh->vertices;
    case MESH_EMBED_NODES:
    case MESH_EMBED_WEIGHTS:
        return mesh_tail(mesh).nodes ? 4 * (uint64_t)mesh->vertices : 0;
    case MESH_SPRING_REST:
    case MESH_SPRING_MASS:
    case MESH_SPRING_DRAG:
    case MESH_SPRING_FIRST:
    case MESH_SPRING_ENDS:
    case MESH_SPRING_STIFFNESS:
    case MESH_SPRING_LENGTH:
    case MESH_CELL_NODES:
    case MESH_CELL_STIFFNESS: {
        const struct mesh_tail tail = mesh_tail(mesh);
        return mesh_spring_words(&tail, id);
    }
    default:
        return mesh_tail(mesh).winding_components ? nodes * MESH_MOMENT_WORDS + mesh->leaves : 0;
    }
}

/*
 * The moments of a file, or NULL if it has none: for each node, in the order of the boxes, the 16 children as
 * kernel_moments (kernel_ops.h) reads them. `lanes` gets the words behind them, one for each leaf: a bit for each
 * triangle of a solid part.
 */
static inline const float *mesh_moments(const struct dpt_mesh *mesh, const uint32_t **lanes)
{
    if (!mesh_tail(mesh).winding_components)
        return NULL;
    *lanes = mesh_words(mesh, MESH_MOMENTS) + mesh->section[MESH_MOMENTS].bytes / 4 - mesh->leaves;
    return mesh_floats(mesh, MESH_MOMENTS);
}

/* The masses and springs of a file; returns 0 if it has none. */
static inline int mesh_spring_net(const struct dpt_mesh *mesh, struct spring_net *net)
{
    const struct mesh_tail tail = mesh_tail(mesh);
    if (!tail.spring_nodes)
        return 0;
    net->nodes = tail.spring_nodes;
    net->slices = mesh_slices(tail.spring_nodes);
    net->springs = tail.springs;
    net->rest = mesh_floats(mesh, tail.nodes ? MESH_SPRING_REST : MESH_VERTICES);
    net->mass = mesh_floats(mesh, MESH_SPRING_MASS);
    net->drag = mesh_floats(mesh, MESH_SPRING_DRAG);
    net->first = mesh_words(mesh, MESH_SPRING_FIRST);
    net->neighbour = mesh_words(mesh, MESH_SPRING_ENDS);
    net->stiffness = mesh_floats(mesh, MESH_SPRING_STIFFNESS);
    net->length = mesh_floats(mesh, MESH_SPRING_LENGTH);
    net->viscosity = tail.viscosity;
    net->square = 4.0 / (tail.stable_step * tail.stable_step);
    net->cells = (uint32_t)tail.cells;
    net->cell_slices = mesh_slices(net->cells);
    net->cell_nodes = net->cells ? mesh_words(mesh, MESH_CELL_NODES) : NULL;
    net->cell_stiffness = net->cells ? mesh_floats(mesh, MESH_CELL_STIFFNESS) : NULL;
    net->cell_size = tail.cell_size;
    net->poisson = tail.poisson;
    return 1;
}

/* Unit normals, 3 floats a vertex, zero at a vertex without one; NULL if the file has no normals. */
static inline const float *mesh_normals(const struct dpt_mesh *mesh)
{
    return mesh_stores_normals(mesh) ? mesh_floats(mesh, MESH_NORMALS) : NULL;
}

/* The flags of triangles, a word each; NULL in a file before version 3. */
static inline const uint32_t *mesh_flags(const struct dpt_mesh *mesh)
{
    return mesh->version > 2 ? mesh_words(mesh, MESH_FLAGS) : NULL;
}

/* The MESH_PART_... bits of a part. In a file of version 1 a closed part counts as solid. */
static inline uint32_t mesh_part_flags(const struct dpt_mesh *mesh, uint32_t part)
{
    uint32_t flags = mesh_words(mesh, MESH_PART_TABLE)[4 * (size_t)part];
    if (mesh->version == 1)
        flags = (flags & 7u) | (flags & MESH_PART_CLOSED ? MESH_PART_SOLID : 0);
    return flags;
}

/*
 * The shape of the tree follows from the number of leaves. Level 0 are the leaves; node k of a level has the 16 nodes
 * from 16 k of the level below, the last node fewer. Fills in `count` of each level and `nodes`, the sum over levels
 * from 1 on; returns the number of levels above the leaves.
 */
static inline uint32_t mesh_levels(uint32_t leaves, uint32_t count[MESH_LEVELS_MAX + 1], uint64_t *nodes)
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

/* The next multiple of MESH_ALIGN. */
static inline uint64_t mesh_aligned(uint64_t offset)
{
    return (offset + MESH_ALIGN - 1) & ~(uint64_t)(MESH_ALIGN - 1);
}

/* A section's name as the file holds it, filled up with zeros. */
static inline void mesh_section_name(int id, char out[16])
{
#define MESH_SECTION_NAME(section, text)                                                                               \
    case section: {                                                                                                    \
        const char name[16] = text;                                                                                    \
        memcpy(out, name, sizeof name);                                                                                \
        break;                                                                                                         \
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
