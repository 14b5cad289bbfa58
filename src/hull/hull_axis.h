/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef DPT_HULL_AXIS_H
#define DPT_HULL_AXIS_H

#include "hull/hull_state.h"

/* Set the axis of a hull that has corners and edges, so that `reach` is small, and `reach`. */
void dpti_hull_set_axis(struct dpt_hull *hull);

#endif
