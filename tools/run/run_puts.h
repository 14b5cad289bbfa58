/* SPDX-License-Identifier: BSD-3-Clause */
/* What a run says of proxies that were put at their device. */
#ifndef DPT_TOOLS_RUN_PUTS_H
#define DPT_TOOLS_RUN_PUTS_H

#include <inttypes.h>
#include <stdio.h>

#include "host/host_session.h"

/* A part of the report at the end: a line, if there is something to say, or keys of a JSON object behind others. */
static inline void run_puts_print(const struct host_puts *puts, int is_json)
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
