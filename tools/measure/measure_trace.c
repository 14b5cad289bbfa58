/* SPDX-License-Identifier: BSD-3-Clause */
#include "measure/measure_trace.h"

#include <stdlib.h>

#include "base/quaternion.h"
#include "cli/command_options.h"
#include "shape/trace_hand.h"

enum { COLUMNS = 7 };

int measure_trace_make(struct csv_table *trace, const struct scene *scene, const struct measure_hand *def)
{
    const struct scene_body *body = &scene->bodies.body[def->body];
    const struct quaternion turn = quaternion_unit(quaternion_of(body->pose.orientation));
    const vec3 origin = vec3_of(body->pose.position);
    struct trace_hand hand;
    *trace = (struct csv_table){ .columns = COLUMNS };
    trace->values =
        def->ticks <= SIZE_MAX / (COLUMNS * sizeof(double)) ? malloc(def->ticks * COLUMNS * sizeof(double)) : NULL;
    if (!trace->values)
        return complain(scene->command, "memory ran out");
    trace->rows = def->ticks;
    trace_hand_begin(&hand, body->mesh, def->seed, def->length, def->band, def->speed);
    hand.stands = def->stands;
    for (size_t i = 0; i < trace->rows; i++) {
        double *row = trace->values + COLUMNS * i, ends[6];
        trace_hand_move(&hand, ends);
        row[0] = (double)i;
        vec3_store(add(origin, quaternion_turn(turn, vec3_of(ends))), row + 1);
        vec3_store(add(origin, quaternion_turn(turn, vec3_of(ends + 3))), row + 4);
    }
    return 0;
}

int measure_trace_read(struct csv_table *trace, const char *command, const char *path, size_t least)
{
    dpt_device_error error = { .size = sizeof error };
    if (csv_table_read(trace, path, &trace_format, &error) != DPT_OK)
        return complain(command, "%s", error.text);
    if (trace->rows >= least)
        return 0;
    const size_t rows = trace->rows;
    csv_table_free(trace);
    return complain(command, "%s: it has %zu ticks, and at least %zu are needed", path, rows, least);
}
