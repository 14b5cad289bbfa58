/* SPDX-License-Identifier: BSD-3-Clause */
#define _POSIX_C_SOURCE 200809L
#include "clock.h"

#include <time.h>

#include "base/return_if_error.h"

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

dpt_result clock_read_suspended(uint64_t *now, int64_t *suspended)
{
    *suspended = 0;
#if defined(__linux__) && defined(CLOCK_BOOTTIME)
    uint64_t boot;
    const int has_boot = read_ns(CLOCK_BOOTTIME, &boot) == DPT_OK;
    DPT_TRY(clock_read(now));
    if (has_boot)
        *suspended = (int64_t)(boot - *now);
    return DPT_OK;
#else
    return clock_read(now);
#endif
}

uint64_t clock_now(void)
{
    uint64_t now = 0;
    read_ns(CLOCK_MONOTONIC, &now);
    return now;
}

uint64_t clock_thread(void)
{
    uint64_t thread = 0;
    read_ns(CLOCK_THREAD_CPUTIME_ID, &thread);
    return thread;
}

uint64_t clock_wall(void)
{
    uint64_t wall = 0;
    read_ns(CLOCK_REALTIME, &wall);
    return wall;
}
