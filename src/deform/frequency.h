/* SPDX-License-Identifier: BSD-3-Clause */
/* How fast springs can swing: docs/algorithms/springs.md, "The stable step". */
#ifndef DPT_FREQUENCY_H
#define DPT_FREQUENCY_H

#include "deform/spring_state.h"

/*
 * 1/s^2: no squared frequency is higher, in any configuration; what touches nodes has the def's contact_stiffness. Where
 * nodes are, and their masses, are known. Scratch: the second state and the first points.
 */
double dpti_springs_square(struct dpt_springs *springs);

#endif
