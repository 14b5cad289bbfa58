/* SPDX-License-Identifier: BSD-3-Clause */
/* What a hand must not feel of a tool's proxy as set by default, counted while it wipes or pokes. */
#ifndef DPT_TESTS_JUMP_RUN_H
#define DPT_TESTS_JUMP_RUN_H

#include "lib/hand_motion.h"
#include "proxy/soak_oracle.h"

struct jump_counts {
    uint64_t ticks, acts;
    uint64_t jumps;    /* ticks in which the wrench changed by more than K (3 |device's motion|_M + 1 m/s dt) */
    double largest;    /* change, as a share of that */
    uint64_t puts;     /* proxies that were put */
    uint64_t early;    /* of them, where the device had turned by less than 1 rad since it was free last */
    uint64_t passed;   /* proxies with a force or in the open that are on the other side of a closed mesh */
    uint64_t overlaps; /* triangles nearer than the radius; both of each 16th tick, and after large changes */
    uint64_t folds;
    double force; /* N, the sum of all ticks */
};

struct jump_run_def {
    struct soak_oracle *oracle;
    dpt_segment segment;
    int motion, holding; /* of the hand */
    double depth, friction;
    uint64_t seed, ticks;
    FILE *tell; /* each one is told there; NULL: nowhere */
};

/* Adds to the counts. */
void jump_run(const struct jump_run_def *def, struct jump_counts *counts);

#endif
