/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Touches of bodies with a load_radius: each loads a patch of the surface, and feels how that moves in the mean, by the same
 * weights. Where the surface is, is known by its own point alone: docs/algorithms/tissue.md.
 */
#ifndef DPT_TISSUE_SPREAD_H
#define DPT_TISSUE_SPREAD_H

#include "deform/deform_loads.h"
#include "tissue/tissue_state.h"

/* The patch of a touch, and with it the depth of its link and the gap that is felt there. */
void dpti_spread_find(struct tissue_solve *solve, uint32_t touch, struct load_patch *patch);

/* After a step: what the next one must know of its touches. */
void dpti_spread_note(struct tissue_solve *solve);

#endif
