/* SPDX-License-Identifier: BSD-3-Clause */
/* TRACE.csv: refused in a line that is there, or rows of finite numbers whose ticks increase. */
#include "csv.h"

#include <math.h>

#include "fuzz/target.h"

FUZZ_TARGET(trace)
{
    struct csv_table trace = { .rows = 0 };
    const char *text = (const char *)bytes;
    uint64_t line = 0;
    if (size == 0)
        return 0;
    const char *wrong = NULL;
    dpt_result result = csv_table_parse(&trace, text, text + size, &trace_format, &line, &wrong);
    MUST(line <= size);
    MUST(result == DPT_OK ? !wrong && trace.rows > 0 && trace.columns == 7 : wrong != NULL);
    for (size_t i = 0; i < trace.rows; i++) {
        const double *row = csv_table_row(&trace, i);
        MUST(fabs(row[0]) < 0x1p53 && row[0] == floor(row[0]));
        for (int k = 1; k < 7; k++)
            MUST(fabs(row[k]) <= DPT_COORDINATE_MAX);
        MUST(i == 0 || row[0] > csv_table_row(&trace, i - 1)[0]);
        MUST(trace_is_jump(&trace, i) || i > 0);
    }
    fuzz_accepted += result == DPT_OK;
    csv_table_free(&trace);
    return 0;
}
