/* SPDX-License-Identifier: BSD-3-Clause */
#include "trace.h"

#include <math.h>

#include "dynpoint/base.h"

/* From here on neighbouring integers are the same double. */
#define TICKS_END 0x1p53

static const char *check_row(const double *row, size_t columns)
{
    if (row[0] != floor(row[0]))
        return "the tick is not an integer";
    if (!(fabs(row[0]) < TICKS_END))
        return "the tick is not within 2^53";
    for (size_t i = 1; i < columns; i++)
        if (!(fabs(row[i]) <= DPT_COORDINATE_MAX))
            return "a coordinate is beyond 1e6 m";
    return NULL;
}

#define HEADER "tick,ax,ay,az,bx,by,bz"

static const char *const headers[] = { HEADER, NULL };

const struct csv_format trace_format = {
    .headers = headers,
    .header_error = "the header is not " HEADER,
    .check_row = check_row,
};

int trace_is_jump(const struct csv_table *trace, size_t row)
{
    return row == 0 || csv_table_row(trace, row)[0] != csv_table_row(trace, row - 1)[0] + 1.0;
}
