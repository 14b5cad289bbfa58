/* SPDX-License-Identifier: BSD-3-Clause */
/* The sweep of one motion step of a segment past all bodies that it may have met: docs/algorithms/swept_motion.md. */
#ifndef DPT_SWEPT_MOTION_H
#define DPT_SWEPT_MOTION_H

#include "track/world_state.h"

/* Where a segment is now, and what this tick knows of it there. */
struct motion_state dpti_motion_state_now(const struct dpt_world *world, const struct segment *segment);

/* Whether two states are at exactly the same place. */
int dpti_motion_is_same(const struct motion_state *from, const struct motion_state *to);

/* m: no point of the segment is farther from where it ends up than this, at any time of the motion. */
double dpti_motion_displacement(const struct motion_state *previous, const struct motion_state *now);

/* Goes through the bodies that a motion may have met, in the order of their slots. */
struct swept_bodies {
    const struct dpt_world *world;
    struct box axis_box; /* of the axis where it is now, in the world */
    double reach;        /* m */
    const struct near_bodies *near_bodies;
    uint32_t next; /* index in near_bodies */
};

/*
 * The bodies within `reach` (m) of a segment where it is now, and those whose own motion may have brought them within
 * it.
 */
struct swept_bodies dpti_motion_bodies(struct dpt_world *world, uint32_t segment_index, double reach);

/* The next of them, or NULL. */
const struct body *dpti_motion_next_body(struct swept_bodies *bodies);

/* Write the hit of a sweep with `body` as users get it; `sweep` keeps its segment and age. */
void dpti_motion_write_sweep(const struct rigid_sweep *rigid, const struct body *body, dpt_sweep *sweep);

/*
 * Reset a segment's sweep to one without a hit; status: DPT_SWEEP_... With DPT_SWEEP_NONE the axis may have crossed.
 */
void dpti_motion_set_no_sweep(struct segment *segment, uint32_t status);

/* Sweep the first step of the backlog past `bodies`, from its beginning or where the budget ended it. Returns 0 if the
 * budget ends it again, else 1. */
int dpti_motion_sweep_step(struct dpt_world *world, uint32_t segment_index, struct swept_bodies bodies,
                           struct motion_backlog *backlog);

#endif
