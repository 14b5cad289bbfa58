/* SPDX-License-Identifier: BSD-3-Clause */
/* Deformable bodies of a world, from tick to tick: docs/algorithms/deform.md. */
#ifndef DPT_DEFORM_BODY_H
#define DPT_DEFORM_BODY_H

#include "deform/spring_state.h"
#include "track/deform_state.h"

/*
 * After a reset of the world, which counts its ticks from 0: drop the loads of a body. Does nothing for a rigid body.
 */
void dpti_deform_reset(struct body *body);

/*
 * What dpt_body_get_loads writes, for a deformable body, without the loads of the tools that a function leaves out; NULL:
 * of all.
 */
dpt_result dpti_deform_get_loads(const struct dpt_world *world, const struct body *body,
                                 int (*is_left_out)(const void *user, uint32_t tool_slot), const void *user,
                                 dpt_load *loads, uint32_t capacity, uint32_t *count);

/*
 * `count` vertices that were gathered from springs: 1 if the body's may be there, and its room is moved there. Then the
 * vertices follow.
 */
int dpti_deform_has_room(struct dpt_world *world, struct body *body, const struct spring_vertices *vertices,
                         uint32_t count);
void dpti_deform_follow(struct dpt_world *world, struct body *body, const struct spring_vertices *vertices,
                        uint32_t count);

/* They go back to where they were before; is_unmoved: that is where they were in the last tick, and they have not moved. */
void dpti_deform_return(struct dpt_world *world, struct body *body, const struct spring_vertices *vertices,
                        uint32_t count, int is_unmoved);

/* A segment's strip, if its tool pushes the surface of the body in this slot out of the way; else NULL. */
const struct segment_strip *dpti_deform_displacing_strip(const struct dpt_world *world, uint32_t segment_index,
                                                         uint32_t slot);

/* At the end of a step: the strips' triangles on bodies that are displaced are moved out of the tools. */
void dpti_deform_displace(struct dpt_world *world);

/* Before a step of dt: move vertices towards their targets, and forget the loads of the last tick. */
void dpti_deform_begin_step(struct dpt_world *world, double dt);

#endif
