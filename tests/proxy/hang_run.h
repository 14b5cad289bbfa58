/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Whether a ball's proxy hangs where nothing holds it: frictionless wipes, 5 mm deep and at 0.1 m/s, beside the local minimum
 * that a ball reaches by steps of 1 um (oracle/ball_path.h).
 */
#ifndef DPT_TESTS_HANG_RUN_H
#define DPT_TESTS_HANG_RUN_H

#include "lib/solid.h"

struct hang_sums {
    uint64_t ticks;
    double force, oracle; /* N */
    uint64_t farther,
        nearer;       /* ticks in which the proxy is farther from the device than the oracle by 5 %, or nearer */
    uint64_t folding; /* in which the oracle did not come to rest within what a proxy may move */
};

/* Adds to the sums. */
void hang_run(const struct solid *solid, double radius, uint64_t seed, uint64_t ticks, struct hang_sums *sums);

#endif
