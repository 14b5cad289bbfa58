/* SPDX-License-Identifier: BSD-3-Clause */
/* Implicit steps of springs: docs/algorithms/springs.md. */
#ifndef DPT_IMPLICIT_H
#define DPT_IMPLICIT_H

#include "deform/spring_state.h"

/* Fill in what does not change: masses, sums of stiffness. */
void dpti_implicit_begin(struct dpt_springs *springs);

/* Nodes were put somewhere else: what was known of the energy is not so. */
void dpti_implicit_forget(struct dpt_springs *springs);

/*
 * A step of h seconds, of the slices that are awake. Sets *flags. Returns 0, and keeps the state, if it would leave the
 * finite range.
 */
int dpti_implicit_step(struct dpt_springs *springs, double h, uint32_t *flags);

#endif
