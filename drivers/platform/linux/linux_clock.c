/* SPDX-License-Identifier: BSD-3-Clause */
#define _GNU_SOURCE
#include <errno.h>
#include <time.h>

#include "base/return_if_error.h"
#include "platform/clock.h"

static const uint64_t SECOND = 1000000000u;

dpt_result clock_read_suspended(uint64_t *now, int64_t *suspended)
{
    struct timespec boot;
    *suspended = 0;
    const int has_boot = clock_gettime(CLOCK_BOOTTIME, &boot) == 0;
    DPT_TRY(clock_read(now));
    if (has_boot)
        *suspended = (int64_t)((uint64_t)boot.tv_sec * SECOND + (uint64_t)boot.tv_nsec - *now);
    return DPT_OK;
}

int clock_timer_open(struct clock_timer *timer)
{
    timer->handle = NULL;
    return 1;
}

int clock_timer_wait(const struct clock_timer *timer, uint64_t deadline)
{
    const struct timespec time = { .tv_sec = (time_t)(deadline / SECOND), .tv_nsec = (long)(deadline % SECOND) };
    (void)timer;
    const int error = clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &time, NULL);
    return error == EINTR ? 1 : error ? -1 : 0;
}

void clock_timer_close(struct clock_timer *timer)
{
    (void)timer;
}
