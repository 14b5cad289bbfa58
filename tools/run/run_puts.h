/* SPDX-License-Identifier: BSD-3-Clause */
/* How often a run put its proxy at the device, why, and how long it had no force for that: docs/algorithms/force.md. */
#ifndef DPT_TOOLS_RUN_PUTS_H
#define DPT_TOOLS_RUN_PUTS_H

#include <inttypes.h>

#include "host/scene.h"

struct run_puts {
    uint64_t squeezed, turned; /* ticks in which it was put */
    uint64_t inside;           /* ticks without force: where it was put, or began, may be inside or behind something */
};

static inline void run_puts_tick(struct run_puts *puts, const struct scene *scene)
{
    dpt_force_info force = { .size = sizeof force };
    if (scene->force.law != DPT_LAW_PROXY || dpt_tool_get_force_info(scene->world, scene->tool, &force) != DPT_OK)
        return;
    puts->squeezed += force.reason == DPT_FORCE_INSIDE && (force.flags & DPT_FORCE_FLAG_SQUEEZED);
    puts->turned += (force.flags & DPT_FORCE_FLAG_REPLACED) != 0;
    puts->inside += force.reason == DPT_FORCE_INSIDE || force.reason == DPT_FORCE_UNDECIDED;
}

/* A part of the report at the end: a line, if there is something to say, or keys of a JSON object behind others. */
static inline void run_puts_print(const struct run_puts *puts, int is_json)
{
    if (is_json)
        printf(",\"put_squeezed\":%" PRIu64 ",\"put_turned\":%" PRIu64 ",\"inside\":%" PRIu64, puts->squeezed,
               puts->turned, puts->inside);
    else if (puts->inside)
        printf("  without force on %" PRIu64 ", as inside of something or behind it; put there by bodies that left no "
               "room %" PRIu64 " times, by a turn of more than 1 rad %" PRIu64 " times\n",
               puts->inside, puts->squeezed, puts->turned);
}

#endif
