/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A snapshot: what a viewer needs of a world, in one flat block of bytes that you supply. Bodies and their poses, moved
 * vertices, tools and proxies, nearest pairs, contacts, strips, wrenches. Take one between two steps, at the rate at
 * which pictures are drawn, hand it to the drawing thread (exchange.h), and read it there, or send it away: the format
 * (docs/format.md) is little-endian on every machine and has a version.
 *
 *     dpt_snapshot_def def;
 *     dpt_snapshot_def_init(&def);
 *     size_t capacity = dpt_snapshot_bytes(world, &def), bytes;
 *     haptic thread:   dpt_world_take_snapshot(world, &def, block, capacity, &bytes);
 *     drawing thread:  dpt_snapshot_info info = { .size = sizeof info };
 *                      dpt_snapshot_get_info(block, bytes, &info);
 *                      for (i = 0; i < info.tools; i++)
 *                          dpt_snapshot_get_tool(block, bytes, i, &tool);
 *
 * Threads: dpt_snapshot_bytes and dpt_world_take_snapshot belong to the world's thread. All others may be called from any
 * thread; they read the block alone.
 */
#ifndef DYNPOINT_SNAPSHOT_H
#define DYNPOINT_SNAPSHOT_H

#include "dynpoint/types.h"
#include "dynpoint/world.h"

DPT_BEGIN

/*
 * How much of a world a snapshot holds. Bodies, tools, segments and channels are always in it. dpt_snapshot_def_init fills in the
 * defaults, which are given last below. Of what does not fit, the rest is left out, and dpt_snapshot_info.flags say so;
 * not of what is not wanted at all.
 */
typedef struct dpt_snapshot_def {
    uint32_t size;         /* sizeof(dpt_snapshot_def), set by dpt_snapshot_def_init */
    uint32_t max_contacts; /* of all tools; 0: none; at most 2^20; 256 */
    uint32_t max_strip;    /* triangles of all strips; 0: none; at most 2^20; 1024 */
    /*
     * Vertices of all deformable bodies; 0: none; at most 2^28; 0. They take 12 bytes each, and make most of the time
     * of a snapshot. Leave them out if the thread that moves them can hand them over itself.
     */
    uint32_t max_vertices;
} dpt_snapshot_def;

/* Fill in the first `size` bytes; what dpt_snapshot_def_init calls with its own caller's sizeof. */
DPT_API void dpt_snapshot_def_defaults(dpt_snapshot_def *def, size_t size);

static inline void dpt_snapshot_def_init(dpt_snapshot_def *def)
{
    dpt_snapshot_def_defaults(def, sizeof *def);
}

/*
 * The bytes that are enough for every snapshot of this world by `def` (NULL: the defaults) until bodies or tools are
 * added; a multiple of 8. 0 for arguments that cannot be used.
 */
DPT_API size_t dpt_snapshot_bytes(const dpt_world *world, const dpt_snapshot_def *def);

/*
 * Take a snapshot of the last step; the world does not change. Poses and segments are those set last, so take it before
 * the next ones are set. The time is in proportion to what is in it: below 1 us for one tool with some contacts, and some
 * 8 us more for 25,000 vertices (docs/measurements.md).
 *   def    NULL: the defaults
 *   block  aligned anyhow
 *   bytes  how long the snapshot is, a multiple of 8
 *
 * DPT_E_MEMORY: it does not fit into `capacity` bytes; nothing was written. DPT_E_LIMIT: a field of def is out of range.
 */
DPT_API dpt_result dpt_world_take_snapshot(const dpt_world *world, const dpt_snapshot_def *def, void *block,
                                           size_t capacity, size_t *bytes);

/* Bits of dpt_snapshot_info.flags: there was no room for all of them. */
enum {
    DPT_SNAPSHOT_FLAG_CONTACTS_CUT = 1,
    DPT_SNAPSHOT_FLAG_STRIPS_CUT = 2,
    DPT_SNAPSHOT_FLAG_VERTICES_CUT = 4 /* of some deformable bodies the vertices are not in it */
};

/* What a snapshot holds. */
typedef struct dpt_snapshot_info {
    uint32_t size;    /* sizeof(dpt_snapshot_info), set by the caller */
    uint32_t version; /* of the format */
    uint32_t flags;   /* DPT_SNAPSHOT_FLAG_... */
    uint32_t work;    /* units, of the last step */
    uint64_t steps;   /* of the world since it was created, those that failed not counted */
    double time;      /* s: the sum of those steps' dt */
    uint32_t bodies;  /* how many of each; their indices count from 0 */
    uint32_t tools;
    uint32_t segments;
    uint32_t contacts;
    uint32_t strip; /* triangles of strips */
    uint32_t vertices;
    uint32_t channels; /* that needles have made */
    uint32_t reserved; /* 0 */
} dpt_snapshot_info;

/*
 * Check a whole block, and tell what is in it. The other readers below need no check before them; they look at what they
 * read alone. The block may be aligned anyhow.
 *
 * DPT_E_MAGIC: this is no snapshot. DPT_E_VERSION: it is newer than this library. DPT_E_TRUNCATED: it is cut off.
 * DPT_E_LAYOUT: it does not hold together.
 */
DPT_API dpt_result dpt_snapshot_get_info(const void *block, size_t bytes, dpt_snapshot_info *info);

/* Bits of dpt_snapshot_body.flags. */
enum {
    DPT_SNAPSHOT_BODY_FLAG_DEFORMS = 1, /* it has vertices of its own */
    DPT_SNAPSHOT_BODY_FLAG_STALE = 2,   /* its pose cannot be used */
    DPT_SNAPSHOT_BODY_FLAG_HELD = 4     /* it was held where it was, in this tick or after it (springs.h) */
};

typedef struct dpt_snapshot_body {
    uint32_t size; /* sizeof(dpt_snapshot_body), set by the caller */
    uint32_t id;
    uint32_t flags;        /* DPT_SNAPSHOT_BODY_FLAG_... */
    uint32_t first_vertex; /* of its own in the snapshot, or DPT_NONE: they are not in it */
    uint32_t vertices;     /* of its own; 0: it is rigid */
    uint32_t reserved;     /* 0 */
    uint64_t user;
    dpt_pose pose;
} dpt_snapshot_body;

typedef struct dpt_snapshot_tool {
    uint32_t size; /* sizeof(dpt_snapshot_tool), set by the caller */
    uint32_t id;
    uint32_t law;           /* DPT_LAW_... */
    uint32_t reason;        /* DPT_FORCE_... */
    uint32_t flags;         /* DPT_FORCE_FLAG_... */
    uint32_t first_segment; /* of the snapshot's segments; the next `segments` are the tool's */
    uint32_t segments;
    uint32_t first_contact; /* likewise */
    uint32_t contacts;
    uint32_t first_strip; /* likewise */
    uint32_t strip;
    uint32_t nearest_segment; /* of the tool, from 0: its hit is the tool's */
    uint32_t is_free;         /* 1: its segments are set in the world */
    uint32_t reserved;        /* 0 */
    uint64_t user;
    uint64_t folds;
    dpt_pose pose;  /* as dpt_tool_get_pose */
    dpt_pose proxy; /* as dpt_tool_get_proxy */
    dpt_wrench wrench;
    double energy;
    double lag;
    double body_work;
    dpt_pose end; /* as dpt_tool_get_end; in snapshots of 0.2 as the proxy */
} dpt_snapshot_tool;

/*
 * A segment where the device has it, and where the proxy has it, both in the world; and its hit (dpt_hit). A tool's tips
 * (tip.h) follow its segments as their edges, each with the tip's hit. What names a tip elsewhere, a contact or the nearest
 * segment, names its first edge here.
 */
typedef struct dpt_snapshot_segment {
    uint32_t size; /* sizeof(dpt_snapshot_segment), set by the caller */
    uint32_t status;
    uint32_t contact;
    uint32_t flags; /* DPT_HIT_FLAG_... */
    uint32_t triangle;
    uint32_t body;
    uint32_t work;
    uint32_t tool;     /* index in the snapshot */
    uint32_t reserved; /* 0 */
    uint32_t reserved_2;
    double a[3];
    double b[3];
    double radius;
    double proxy_a[3]; /* a and b, where there is no proxy */
    double proxy_b[3];
    double p[3];
    double q[3];
    double distance;
    double gap;
    double depth;
    double error_bound;
    double lower_bound;
} dpt_snapshot_segment;

/* A contact, with the fields of dpt_contact that a picture shows. */
typedef struct dpt_snapshot_contact {
    uint32_t size; /* sizeof(dpt_snapshot_contact), set by the caller */
    uint32_t id;
    uint32_t body;
    uint32_t segment; /* of the tool, from 0 */
    uint32_t triangle;
    uint32_t contact;
    uint32_t flags;
    uint32_t tool;     /* index in the snapshot */
    uint32_t reserved; /* 0 */
    uint32_t reserved_2;
    double s0;
    double s1;
    double s;
    double gap;
    double p[3];
    double q[3];
    double normal[3];
    double overlap;
} dpt_snapshot_contact;

/* A triangle of a segment's strip, with its overlap (dpt_overlap). */
typedef struct dpt_snapshot_strip {
    uint32_t size;     /* sizeof(dpt_snapshot_strip), set by the caller */
    uint32_t triangle; /* source number */
    uint32_t body;
    uint32_t segment; /* of the tool, from 0 */
    uint32_t flags;
    uint32_t reserved; /* 0 */
    double gap;
    double overlap;
} dpt_snapshot_strip;

/* A channel that a tool has made (dpt_channel), with what a picture shows. It is there also while its tool is out of it. */
typedef struct dpt_snapshot_channel {
    uint32_t size; /* sizeof(dpt_snapshot_channel), set by the caller */
    uint32_t id;
    uint32_t body;
    uint32_t triangle; /* source number, at the entry */
    uint32_t flags;    /* DPT_CHANNEL_FLAG_... */
    uint32_t ruptures;
    uint32_t layers;
    uint32_t tool;     /* index in the snapshot */
    uint32_t reserved; /* 0 */
    uint32_t reserved_2;
    double entry[3];
    double axis[3];
    double radius; /* m: of the hole, that of the tool */
    double depth;
    double deepest;
    double inside;
    double friction;
    double tip;
} dpt_snapshot_channel;

/*
 * Read one item. DPT_E_ARGUMENT: there is none with this index; the item is empty then. The errors of
 * dpt_snapshot_get_info.
 */
DPT_API dpt_result dpt_snapshot_get_body(const void *block, size_t bytes, uint32_t index, dpt_snapshot_body *body);
DPT_API dpt_result dpt_snapshot_get_tool(const void *block, size_t bytes, uint32_t index, dpt_snapshot_tool *tool);
DPT_API dpt_result dpt_snapshot_get_segment(const void *block, size_t bytes, uint32_t index,
                                            dpt_snapshot_segment *segment);
DPT_API dpt_result dpt_snapshot_get_contact(const void *block, size_t bytes, uint32_t index,
                                            dpt_snapshot_contact *contact);
DPT_API dpt_result dpt_snapshot_get_strip(const void *block, size_t bytes, uint32_t index, dpt_snapshot_strip *strip);
DPT_API dpt_result dpt_snapshot_get_channel(const void *block, size_t bytes, uint32_t index,
                                            dpt_snapshot_channel *channel);

/*
 * Copy vertices, in the frame of their body, in the order of dpt_mesh_get_vertices.
 *   xyz   room for 3 * count
 *
 * DPT_E_ARGUMENT: there are not so many; nothing is copied.
 */
DPT_API dpt_result dpt_snapshot_get_vertices(const void *block, size_t bytes, uint32_t first, uint32_t count,
                                             float *xyz);

DPT_END

#endif
