/* SPDX-License-Identifier: BSD-3-Clause */
/* A clock, and times in order. */
#ifndef DPT_BENCH_TIMING_H
#define DPT_BENCH_TIMING_H

#include <stdlib.h>
#include <time.h>

/* In ns. */
static inline double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return 1e9 * (double)t.tv_sec + (double)t.tv_nsec;
}

/* Of this thread's processor, in us. */
static inline double processor_time(void)
{
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return 1e6 * (double)t.tv_sec + 1e-3 * (double)t.tv_nsec;
}

/* For qsort. */
static inline int by_size(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

#endif
