/* SPDX-License-Identifier: BSD-3-Clause */
/* How fast springs can swing: docs/algorithms/springs.md, "The stable step". */
#ifndef DPT_FREQUENCY_H
#define DPT_FREQUENCY_H

#include "deform/spring_state.h"

/*
 * Fill in `square` and `stable_step`, which hold in any configuration; what touches nodes has the def's
 * contact_stiffness. The nodes' masses are known. Scratch: the second state and the first points.
 */
void dpti_springs_find_step(struct dpt_springs *springs);

#endif
