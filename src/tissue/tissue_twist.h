/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Torsion in a step of tissue: friction against a tool's turn about the normal of the touch that pushes it most, by a couple
 * on the corners of the touched triangle. docs/algorithms/tissue.md.
 */
#ifndef DPT_TISSUE_TWIST_H
#define DPT_TISSUE_TWIST_H

#include "tissue/tissue_state.h"

/* Tools that rub and have no twist yet get one, at the touch that pushes most. Returns 1 if there are such. */
int dpti_twists_add(struct tissue_solve *solve);

/* Begin a substep, and what twists that slip do to tools and nodes, before a pass: as rubs. */
void dpti_twists_begin(struct tissue_solve *solve);
void dpti_twists_set_known(struct tissue_solve *solve);

/* How far tools would turn on the surface. */
void dpti_twists_set_gaps(struct tissue_solve *solve);

/* After a pass: as rubs. */
int dpti_twists_update(struct tissue_solve *solve, int may_stick);

static inline vec3 twist_axis(uint32_t axis)
{
    return (vec3){ axis == 0 ? 1.0 : 0.0, axis == 1 ? 1.0 : 0.0, axis == 2 ? 1.0 : 0.0 };
}

/* What a newton of a twist moves along one axis of the body's frame: its nodes, as those of a touch. */
struct tissue_link dpti_twist_part(struct tissue_solve *solve, struct tissue_twist *twist, uint32_t axis);

/* m: how far a twist is turned by nodes that move `within`, a unit vector, by `spread`. */
double dpti_twist_product(const struct tissue_solve *solve, const struct tissue_twist *twist, vec3 within);

#endif
