/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The format of a trace, the motion of a segment: one row a tick, "tick,ax,ay,az,bx,by,bz". Ticks are increasing
 * integers within 2^53. Coordinates are in the world frame, in m, within DPT_COORDINATE_MAX.
 */
#ifndef DPT_DRIVERS_TRACE_H
#define DPT_DRIVERS_TRACE_H

#include "csv.h"

extern const struct csv_format trace_format;

/* 1 if the motion jumps to this row: it is the first, or its tick is not that of the row before plus 1. */
int trace_is_jump(const struct csv_table *trace, size_t row);

#endif
