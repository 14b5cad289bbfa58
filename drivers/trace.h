/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * TRACE.csv: the motion of a segment, a row a tick: tick,ax,ay,az,bx,by,bz in metres. Ticks are integers that increase,
 * within 2^53; coordinates lie within DPT_COORDINATE_MAX.
 */
#ifndef DPT_DRIVERS_TRACE_H
#define DPT_DRIVERS_TRACE_H

#include "csv.h"

extern const struct csv_format trace_format;

/* A row that does not follow the one before by one tick jumps; the first row does. */
int trace_is_jump(const struct csv_table *trace, size_t row);

#endif
