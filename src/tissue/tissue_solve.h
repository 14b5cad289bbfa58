/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A step of tissue together with the tools that touch it: SPEC's linear complementarity problem of tools, couplings and
 * tissue, one in each substep. docs/algorithms/tissue.md.
 */
#ifndef DPT_TISSUE_SOLVE_H
#define DPT_TISSUE_SOLVE_H

#include "tissue/tissue_state.h"

/*
 * Solve for the next substep. Returns how far, m, any touch goes from where it was gathered: its tool, and its point on the
 * tissue, together.
 */
double dpti_tissue_solve(struct tissue_solve *solve);

/* m/N: how far the body's own surface yields at one touch by a push at another. */
double dpti_tissue_yield(const struct tissue_solve *solve, uint32_t touch, uint32_t by);

/* Make the substep that was solved for. Returns 0 if a body would leave the finite range. */
int dpti_tissue_substep(struct tissue_solve *solve);

#endif
