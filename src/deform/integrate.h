/* SPDX-License-Identifier: BSD-3-Clause */
/* Explicit steps of springs: docs/algorithms/springs.md. */
#ifndef DPT_INTEGRATE_H
#define DPT_INTEGRATE_H

#include "deform/spring_state.h"

/*
 * s: the longest stable step of an explicit integrator for modes of up to a squared frequency, at most
 * DPT_SPRINGS_STEP_MAX; 0: none. drag: the least of all nodes, 1/s.
 */
double dpti_springs_limit(uint32_t integrator, double square, double viscosity, double drag);

/*
 * `count` substeps of h seconds with SYMPLECTIC or EULER, of the slices that are awake, however long they are. Returns 0,
 * and keeps the state, if it would leave the finite range.
 */
int dpti_springs_substeps(struct dpt_springs *springs, double h, uint32_t count);

#endif
