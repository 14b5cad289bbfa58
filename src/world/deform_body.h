/* SPDX-License-Identifier: BSD-3-Clause */
/* A deformable body's block: docs/algorithms/deform.md. */
#ifndef DPT_DEFORM_BODY_H
#define DPT_DEFORM_BODY_H

#include "dynpoint/deform.h"
#include "world/world_state.h"

/* At the beginning of the block; the arrays of the surface's motion follow. */
struct deform {
    struct surface_motion motion;
    dpt_deform_def def; /* its pose is not kept */
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
