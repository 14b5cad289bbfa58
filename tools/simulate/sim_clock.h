/* SPDX-License-Identifier: BSD-3-Clause */
/* The clock of what is simulated: so many ticks a second. */
#ifndef DPT_TOOLS_SIM_CLOCK_H
#define DPT_TOOLS_SIM_CLOCK_H

#include <math.h>
#include <time.h>

/* Until *stop is not 0. Ticks that are more than 10 ms late are left out: a real device does not make up for them either. */
static inline void pace(double rate, void (*tick)(void *user), void *user, const volatile int *stop)
{
    const long period = (long)(1e9 / rate);
    struct timespec next;
    clock_gettime(CLOCK_MONOTONIC, &next);
    while (!*stop) {
        struct timespec now;
        tick(user);
        next.tv_nsec += period;
        while (next.tv_nsec >= 1000000000) {
            next.tv_nsec -= 1000000000;
            next.tv_sec++;
        }
        clock_gettime(CLOCK_MONOTONIC, &now);
        const double left =
            difftime(next.tv_sec, now.tv_sec) + 1e-9 * (double)(next.tv_nsec - now.tv_nsec);
        if (left < -0.01)
            next = now;
        else if (left > 0) {
            const struct timespec wait = { (time_t)left, (long)(1e9 * (left - floor(left))) };
            nanosleep(&wait, NULL);
        }
    }
}

#endif
