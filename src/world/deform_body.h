/* SPDX-License-Identifier: BSD-3-Clause */
/* Deformable bodies of a world, from tick to tick: docs/algorithms/deform.md. */
#ifndef DPT_DEFORM_BODY_H
#define DPT_DEFORM_BODY_H

#include "track/deform_state.h"

/* After a reset of the world: its ticks are counted anew, and there are no loads. Nothing for a rigid body. */
void dpti_deform_reset(struct body *body);

/* At the end of a step: the strips' triangles on bodies that are displaced are moved out of the tools. */
void dpti_deform_displace(struct dpt_world *world);

/* Before a step of dt: vertices that are on their way move on, and loads of the last tick are forgotten. */
void dpti_deform_begin_step(struct dpt_world *world, double dt);

#endif
