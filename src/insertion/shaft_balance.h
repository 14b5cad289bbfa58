/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Where the tip of a tool that is in channels comes to rest along them: docs/algorithms/insertion.md. All channels lie
 * on one line. A place, without more, is one in the first of them.
 */
#ifndef DPT_SHAFT_BALANCE_H
#define DPT_SHAFT_BALANCE_H

#include "insertion/shaft_friction.h"

#include <stdint.h>

/* A tool is in so many channels at most. */
enum { INSERTION_CHANNELS_MAX = 6 };

/* One channel in a balance. */
struct balance_part {
    struct shaft shaft;
    double offset;  /* m: added to a place it gives the place in this channel */
    double uncut;   /* the place in this channel from which on the tip cuts */
    double cutting; /* N, there */
};

/* What acts along the line. */
struct balance {
    double stiffness; /* N/m, above 0: of the spring to the device */
    double device;    /* the place where the device would have the tip */
    double dt;        /* s */
    uint32_t count;
    struct balance_part parts[INSERTION_CHANNELS_MAX];
};

/* N: what friction takes along the shafts, where the tip goes to a place. */
double dpti_balance_friction(const struct balance *balance, double place);

/*
 * The place where the spring's pull is what friction and cutting take. Cutting takes up to its force, and nothing on
 * the way back. *cutting: what it takes there, N. Unique: what resists never falls on the way in.
 */
double dpti_balance_solve(const struct balance *balance, double *cutting);

#endif
