/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef DPT_TESTS_TISSUE_UNFELT_H
#define DPT_TESTS_TISSUE_UNFELT_H

#include "dynpoint.h"

/* m: how far the surface has risen at most that a touch of the last step, with a spread load, did not feel. */
double tissue_unfelt(const dpt_world *world, dpt_body body);

#endif
