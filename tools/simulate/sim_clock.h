/* SPDX-License-Identifier: BSD-3-Clause */
/* The clock of a simulated device: so many ticks a second. */
#ifndef DPT_TOOLS_SIM_CLOCK_H
#define DPT_TOOLS_SIM_CLOCK_H

#include "platform/clock.h"

/*
 * Call `tick` at `rate`, Hz, until *stop is not 0. If it is more than 10 ms late, ticks are skipped, because a real
 * device does not make up for them either.
 */
static inline void sim_clock_run(double rate, void (*tick)(void *user), void *user, const volatile int *stop)
{
    const uint64_t period = (uint64_t)(1e9 / rate);
    uint64_t next = clock_now();
    while (!*stop) {
        tick(user);
        next += period;
        const uint64_t now = clock_now();
        if (now > next + 10000000u)
            next = now;
        else if (now < next)
            clock_sleep(next - now);
    }
}

#endif
