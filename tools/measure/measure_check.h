/* SPDX-License-Identifier: BSD-3-Clause */
/* The second world of a measure_run: the same bodies as they lie now, searched triangle by triangle in double. */
#ifndef DPT_TOOLS_MEASURE_CHECK_H
#define DPT_TOOLS_MEASURE_CHECK_H

#include "measure/measure_tool.h"

struct measure_brute {
    void *block;
    dpt_world *world;
    dpt_tool tool;
    uint32_t segments;
    uint32_t body_count;
    uint32_t searches; /* a comparison; the least time counts */
    uint32_t ns, work; /* of the last comparison */
    /* Of each body: its id, and its memory if it gives way. */
    dpt_body id[DPT_ARM_BODIES_MAX];
    void *body_block[DPT_ARM_BODIES_MAX];
};

/* After the bodies were added to the world that is checked. Close it also after a failure. */
dpt_result measure_brute_open(struct measure_brute *brute, const struct scene_bodies *bodies,
                              const struct measure_tool *tool, uint32_t searches);
void measure_brute_close(struct measure_brute *brute);

/*
 * By how much the world's distances of the tool's segments, of the step just taken, differ from those of all triangles, m.
 * Tips are not looked at.
 */
dpt_result measure_brute_compare(struct measure_brute *brute, const struct scene_bodies *bodies,
                                 const struct measure_tool *tool, const dpt_world *world, dpt_tool id, double *error);

#endif
