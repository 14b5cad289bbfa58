/* SPDX-License-Identifier: BSD-3-Clause */
/* Bodies of a world. Their public functions are in dynpoint/body.h. */
#ifndef DPT_BODY_H
#define DPT_BODY_H

#include "track/world_state.h"

/* DPT_OK, or DPT_E_FULL if the world has as many bodies as it can hold. */
dpt_result dpti_body_can_add(const struct dpt_world *world);

/* Add a body, for which there is room, and return its id. pose: valid; NULL: the identity. */
uint32_t dpti_body_add(struct dpt_world *world, const struct surface *surface, const dpt_pose *pose);

/*
 * Vertices of a deformable body have moved, by at most `moved` (m) since they were moved last. has_begun_anew: the
 * planes that are cached of it do not hold any more.
 */
void dpti_body_note_vertices(struct dpt_world *world, struct body *body, double moved, int has_begun_anew);

#endif
