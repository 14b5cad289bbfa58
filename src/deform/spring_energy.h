/* SPDX-License-Identifier: BSD-3-Clause */
/* What springs hold, and what moves, J, in double. */
#ifndef DPT_SPRING_ENERGY_H
#define DPT_SPRING_ENERGY_H

#include "deform/spring_state.h"

/* Half of each spring of each node of a slice. */
double dpti_springs_elastic(const struct dpt_springs *springs, uint32_t slice);

/* All of them. */
double dpti_springs_kinetic(const struct dpt_springs *springs);

#endif
