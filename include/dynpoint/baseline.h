/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Settings and tables of the paper's baseline (DPT_METHOD_PAPER, docs/algorithms/paper.md). They serve comparisons with
 * the paper. Experimental: any release may change this header. dynpoint.h does not include it.
 *
 * Threads: as world.h and strip.h say. Once it is made, a table of routes is read-only, and threads may share it.
 */
#ifndef DYNPOINT_BASELINE_H
#define DYNPOINT_BASELINE_H

#include "dynpoint/strip.h"
#include "dynpoint/world.h"

DPT_BEGIN

/*
 * Settings of DPT_METHOD_PAPER. dpt_world_def.baseline points to this struct while a world is created. Begin with
 * dpt_baseline_def_init.
 */
struct dpt_baseline_def {
    uint32_t size;     /* sizeof(dpt_baseline_def), set by dpt_baseline_def_init */
    uint32_t parts;    /* pieces of a segment, each with its own dynamic point, 1..64; default 1 */
    uint32_t one_step; /* 1: one step of the descent a tick, as in the paper; 0: all; default 0 */
    uint32_t reserved; /* 0 */
};

/* Fill in the defaults of the first `size` bytes. Call dpt_baseline_def_init, which passes your sizeof. */
DPT_API void dpt_baseline_def_defaults(dpt_baseline_def *def, size_t size);

static inline void dpt_baseline_def_init(dpt_baseline_def *def)
{
    dpt_baseline_def_defaults(def, sizeof *def);
}

/*
 * Opaque: the paper's table of the traversal distances of all pairs of triangles, for comparison. It holds a mesh of up
 * to 10,000 triangles, takes about 2 bytes for each pair, and is filled in seconds.
 */
typedef struct dpt_route_table dpt_route_table;

/* The bytes that a table needs; 0 for a mesh of more than 10,000 triangles, and for NULL. */
DPT_API size_t dpt_route_table_bytes(const dpt_mesh *mesh);

/* Make and fill a table in `block`, which has at least dpt_route_table_bytes(mesh) bytes. */
DPT_API dpt_result dpt_route_table_create(void *block, size_t bytes, const dpt_mesh *mesh,
                                          const dpt_route_table **table);

/* As dpt_strip_route, with the table instead of a search. def.search may be 0. */
DPT_API dpt_result dpt_strip_route_by_table(dpt_strip *strip, const dpt_route_table *table, uint32_t from, uint32_t to);

DPT_END

#endif
