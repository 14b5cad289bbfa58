/* SPDX-License-Identifier: BSD-3-Clause */
/* TRACE.csv: refused in a line that is there, or rows of finite numbers whose ticks increase. */
#include "trace.h"

#include <math.h>

#include "target.h"

FUZZ_TARGET(trace)
{
    struct trace trace = { .count = 0 };
    const char *text = (const char *)bytes;
    uint64_t line = 0;
    if (size == 0)
        return 0;
    const char *wrong = trace_parse(&trace, text, text + size, &line);
    MUST(line <= size);
    MUST(wrong || trace.count > 0);
    for (size_t i = 0; i < trace.count; i++) {
        for (int k = 0; k < 6; k++)
            MUST(fabs(trace.rows[i].ends[k]) <= DPT_COORDINATE_MAX);
        MUST(i == 0 || trace.rows[i].tick > trace.rows[i - 1].tick);
        MUST(trace_jumps(&trace, i) || i > 0);
    }
    fuzz_accepted += !wrong;
    trace_free(&trace);
    return 0;
}
