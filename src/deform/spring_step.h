/* SPDX-License-Identifier: BSD-3-Clause */
/* Steps of springs, how long they may be, and their energy: docs/algorithms/springs.md. */
#ifndef DPT_SPRING_STEP_H
#define DPT_SPRING_STEP_H

#include "deform/spring_state.h"

/*
 * s: the longest stable step of an explicit integrator for modes of up to a squared frequency, at most
 * DPT_SPRINGS_STEP_MAX; 0: none. drag: the least of all nodes, 1/s.
 */
double dpti_springs_limit(uint32_t integrator, double square, double viscosity, double drag);

/*
 * `count` substeps of h seconds with SYMPLECTIC or EULER, of the slices that are awake, however long they are. Returns
 * 0, and keeps the state, if it would leave the finite range.
 */
int dpti_springs_substeps(struct dpt_springs *springs, double h, uint32_t count);

/* ---- implicit steps ---- */

/* Fill in what does not change: masses, sums of stiffness. */
void dpti_implicit_begin(struct dpt_springs *springs);

/* Call after nodes were placed elsewhere: the energy is not known any more. */
void dpti_implicit_forget(struct dpt_springs *springs);

/* After a step that was undone: the account and the common acceleration are as before it. */
void dpti_implicit_return(struct dpt_springs *springs, double account, const double common[3]);

/* ---- the energy of springs and of motion, J, in double ---- */

/* The energy of one slice. A spring counts half at each of its nodes. */
double dpti_springs_elastic(const struct dpt_springs *springs, uint32_t slice);

/* The energy of all slices. */
double dpti_springs_kinetic(const struct dpt_springs *springs);

/* ---- the highest frequency: "The stable step" ---- */

/*
 * Fill in `square` and `stable_step`, which hold in any configuration. Contacts count with the def's contact_stiffness.
 * The nodes' masses are known. Scratch: the second state and the first points.
 */
void dpti_springs_find_step(struct dpt_springs *springs);

#endif
