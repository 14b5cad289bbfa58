/* SPDX-License-Identifier: BSD-3-Clause */
/* Tools in a step of tissue: what they touch before it, and what they feel after it. */
#ifndef DPT_TISSUE_TOOLS_H
#define DPT_TISSUE_TOOLS_H

#include "tissue/tissue_state.h"

/*
 * All tools whose proxies are within `reach`, m, and their own motion, of a body of the solve, and their touches. Where a
 * device leaps past so much surface that a tick has no time for it, they are those that are nearer, at least within
 * `least`, and solve->is_cut is 1.
 */
void dpti_tissue_gather(struct tissue_solve *solve, struct dpt_world *world, double reach, double least);

/* How many substeps dt has for the bodies of the solve. */
uint32_t dpti_tissue_substeps(const struct tissue_solve *solve, double dt);

/* After the step: the tools' wrenches, loads and energies. */
void dpti_tissue_tell(struct tissue_solve *solve, struct dpt_world *world);

/*
 * Whether nothing that the answer of the last tick depends on has changed: tools stand still, what they touch sleeps, no
 * body has moved, and the answer has repeated itself. Then it may be told again.
 */
int dpti_tissue_rests(const struct tissue_solve *solve, const struct dpt_world *world);
void dpti_tissue_tell_again(struct tissue_solve *solve, struct dpt_world *world);

#endif
