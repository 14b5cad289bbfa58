/* SPDX-License-Identifier: BSD-3-Clause */
#include "record/run_trace.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "scene/host_file.h"

int is_trace_name(const char *path)
{
    return host_file_ends_in(path, ".csv");
}

int run_trace_open(struct run_trace *trace, const char *path)
{
    return output_open(&trace->output, "run", path);
}

int run_trace_allocate(struct run_trace *trace, uint64_t capacity)
{
    trace->capacity = capacity;
    trace->rows = calloc(capacity, 6 * sizeof *trace->rows);
    return trace->rows ? 0 : complain("run", "memory ran out");
}

void run_trace_tick(struct run_trace *trace, const dpt_segment *stylus)
{
    if (trace->count == trace->capacity)
        return;
    double *row = trace->rows + 6 * trace->count++;
    memcpy(row, stylus->a, sizeof stylus->a);
    memcpy(row + 3, stylus->b, sizeof stylus->b);
}

int run_trace_write(struct run_trace *trace)
{
    struct output output = trace->output;
    FILE *file = output.file;
    trace->output.file = NULL;
    fputs("tick,ax,ay,az,bx,by,bz\n", file);
    for (uint64_t i = 0; i < trace->count; i++) {
        fprintf(file, "%" PRIu64, i);
        for (int k = 0; k < 6; k++)
            fprintf(file, ",%.17g", trace->rows[6 * i + (uint64_t)k]);
        fputc('\n', file);
    }
    return output_close(&output, "run");
}

void run_trace_close(struct run_trace *trace)
{
    if (trace->output.file) {
        fclose(trace->output.file);
        output_drop(&trace->output);
    }
    free(trace->rows);
}
