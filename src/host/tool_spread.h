/* SPDX-License-Identifier: BSD-3-Clause */
/* Where a tool's centre is, and how far it spreads about it (docs/algorithms/force.md). */
#ifndef DPT_HOST_TOOL_SPREAD_H
#define DPT_HOST_TOOL_SPREAD_H

#include "dynpoint/types.h"

/*
 * m: the root mean square distance of the points of lines from their centre, which is weighted by their lengths; of points
 * alone, all count alike. At least one line.
 */
double tool_spread(const dpt_segment *lines, uint32_t count, double centre[3]);

#endif
