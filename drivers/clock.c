/* SPDX-License-Identifier: BSD-3-Clause */
#define _POSIX_C_SOURCE 200809L
#include "clock.h"

#include <time.h>

static dpt_result read_ns(clockid_t clock, uint64_t *ns)
{
    struct timespec time;
    if (clock_gettime(clock, &time) != 0)
        return DPT_E_SYSTEM;
    *ns = (uint64_t)time.tv_sec * 1000000000u + (uint64_t)time.tv_nsec;
    return DPT_OK;
}

dpt_result clock_read(uint64_t *now)
{
    return read_ns(CLOCK_MONOTONIC, now);
}

uint64_t clock_now(void)
{
    uint64_t now = 0;
    read_ns(CLOCK_MONOTONIC, &now);
    return now;
}

uint64_t clock_wall(void)
{
    uint64_t wall = 0;
    read_ns(CLOCK_REALTIME, &wall);
    return wall;
}
