/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What belongs to the paper's baseline alone (DPT_METHOD_PAPER, docs/algorithms/paper.md), for comparison with
 * it. Experimental: names, structs and functions of this header may change in any release; dynpoint.h does not include it.
 *
 * Threads: as world.h and strip.h say. A table of routes is read-only once it is made, and may be shared.
 */
#ifndef DYNPOINT_BASELINE_H
#define DYNPOINT_BASELINE_H

#include "dynpoint/strip.h"
#include "dynpoint/world.h"

DPT_BEGIN

/*
 * How DPT_METHOD_PAPER works; dpt_world_def.baseline points to one while the world is made. dpt_baseline_def_init fills
 * in the defaults, given last.
 */
struct dpt_baseline_def {
    uint32_t size;     /* sizeof(dpt_baseline_def), set by dpt_baseline_def_init */
    uint32_t parts;    /* pieces of a segment, each with its own dynamic point, 1..64; 1 */
    uint32_t one_step; /* 1: one move of the descent a tick, as the paper has it; 0: all of it; 0 */
    uint32_t reserved; /* 0 */
};

/* Fill in the first `size` bytes; what dpt_baseline_def_init calls with its own caller's sizeof. */
DPT_API void dpt_baseline_def_defaults(dpt_baseline_def *def, size_t size);

static inline void dpt_baseline_def_init(dpt_baseline_def *def)
{
    dpt_baseline_def_defaults(def, sizeof *def);
}

/*
 * The traversal distances of all pairs of triangles, for meshes of up to 10,000 of them: the paper's table, as a
 * yardstick. About 2 bytes a pair, and seconds to fill.
 *   bytes   0 for a mesh with more triangles, and for NULL
 */
typedef struct dpt_route_table dpt_route_table;

DPT_API size_t dpt_route_table_bytes(const dpt_mesh *mesh);
DPT_API dpt_result dpt_route_table_create(void *block, size_t bytes, const dpt_mesh *mesh,
                                          const dpt_route_table **table);

/* As dpt_strip_route, by the table; def.search may be 0. */
DPT_API dpt_result dpt_strip_route_by_table(dpt_strip *strip, const dpt_route_table *table,
                                            uint32_t from, uint32_t to);

DPT_END

#endif
