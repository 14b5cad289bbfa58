/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Coulomb friction of touches in a step of tissue: a touch that pushes sticks, so that the tool and the surface move alike
 * along it since the last substep, or slips and pulls with as much as its push allows. docs/algorithms/tissue.md.
 */
#ifndef DPT_TISSUE_FRICTION_H
#define DPT_TISSUE_FRICTION_H

#include "tissue/tissue_state.h"

/* Begin a substep with the rubs of the one before. */
void dpti_rubs_begin(struct tissue_solve *solve);

/*
 * A touch that held in the last step rubs as it did then, if what it touches is rough. Returns 0 if there is no room.
 */
int dpti_rubs_take(struct tissue_solve *solve, uint32_t touch, const struct held_touch *held);

/* After the last pass: which way the rub of a touch pulls, if it slips; else 0. */
vec3 dpti_rubs_against(const struct tissue_solve *solve, uint32_t touch);

/* What pushes that are known do to tools and nodes: those of rubs that slip. */
void dpti_rubs_set_known(struct tissue_solve *solve);

/*
 * After a pass: rubs that pull more than they can begin to slip, and new pushes rub. Without `may_stick` none begins to
 * stick, so that passes end. Returns 1 if another pass is needed.
 */
int dpti_rubs_update(struct tissue_solve *solve, int may_stick);

/* After the last pass: how many touches of each tool stick and slip. */
void dpti_rubs_end(struct tissue_solve *solve);

#endif
