/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A segment's motion from one place to another, past all bodies that it may have met:
 * docs/algorithms/swept_motion.md.
 */
#ifndef DPT_SWEPT_MOTION_H
#define DPT_SWEPT_MOTION_H

#include "world/world_state.h"

/* Where a segment is now, and what is known of it there. */
struct motion_state dpti_motion_state_now(const struct dpt_world *world,
                                          const struct segment *segment);

int dpti_motion_is_same(const struct motion_state *from, const struct motion_state *to);

/* No point of the segment moves by more. */
double dpti_motion_displacement(const struct motion_state *previous,
                                const struct motion_state *now);

/* The bodies that a motion may have met. */
struct swept_bodies {
    const struct dpt_world *world;
    struct box axis_box;
    double reach;
    const struct near_bodies *near_bodies;
    uint32_t next; /* place on its list */
};

/* Those within reach of a segment where it is now, and those whose own motion may have brought them there. */
struct swept_bodies dpti_motion_bodies(struct dpt_world *world, uint32_t segment_index,
                                       double reach);

/* The next of them, or NULL. */
const struct body *dpti_motion_next_body(struct swept_bodies *bodies);

/* A tour that met a body, as users get it; the segment and the age are left alone. */
void dpti_motion_write_sweep(const struct rigid_sweep *rigid, const struct body *body,
                             dpt_sweep *sweep);

/* No sweep, and why: DPT_SWEEP_... */
void dpti_motion_set_no_sweep(struct segment *segment, uint32_t status);

/* The voyage's first leg, from its beginning or from where it was stopped; 0 where the budget ended. */
int dpti_motion_sweep_step(struct dpt_world *world, uint32_t segment_index,
                           struct swept_bodies bodies, struct motion_backlog *backlog);

#endif
