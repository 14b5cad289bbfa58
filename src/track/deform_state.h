/* SPDX-License-Identifier: BSD-3-Clause */
/* What a deformable body's block holds: docs/algorithms/deform.md. */
#ifndef DPT_DEFORM_STATE_H
#define DPT_DEFORM_STATE_H

#include "deform/deform_loads.h"
#include "deform/local_yield.h"
#include "track/world_state.h"

/* The load of one tool in a tick: its points, and their total wrench. */
struct tool_load {
    uint32_t tool_slot;
    uint32_t first, count; /* in points */
    uint32_t reserved;
    vec3 origin;      /* in the world: the torque is about it */
    dpt_wrench whole; /* on the body, in its frame, about that frame's origin */
};

/* At the beginning of the block; the arrays follow. */
struct deform {
    struct surface_motion motion;
    dpt_deformable_def def;    /* its pose is not kept */
    struct load_point *points; /* of this tick, in the body's frame; max_points */
    struct tool_load *tools;   /* likewise */
    uint32_t point_count, tool_count;
    int has_lost_tool;         /* 1: there was no room for any point of a tool */
    struct local_yield *yield; /* NULL: it has no compliance of its own */
    float *target;             /* target positions of the vertices; only with a period or a yield */
    float *next;               /* their positions in the next step; likewise */
    double time_left;          /* s, until they reach the target; 0: they have */
    void *solve;               /* struct tissue_solve; NULL: the mesh has no springs, and the body no yield */
};

/* That of a body, or NULL if it is rigid. */
static inline struct deform *deform_of(const struct body *body)
{
    return (struct deform *)(void *)body->surface.motion;
}

/* m: how far any vertex moved before this tick, at most. */
static inline double deform_step(const struct body *body, uint32_t tick)
{
    const struct surface_motion *motion = body->surface.motion;
    return surface_has_moved(&body->surface, tick)
               ? (double)motion->step[motion->first[motion->levels]] / body->surface.filter_scale
               : 0.0;
}

#endif
