/* SPDX-License-Identifier: BSD-3-Clause */
/* A hand that leads a tool, end a first, over a mesh: 1 ms a tick. */
#ifndef DPT_TESTS_HAND_MOTION_H
#define DPT_TESTS_HAND_MOTION_H

#include "dynpoint.h"
#include "lib/solid.h"

enum {
    HAND_WIPE, /* below the surface, from place to place at 0.1 m/s */
    HAND_FAST, /* the same at 1 m/s */
    HAND_POKE, /* in and out, 20 mm a second at most, at one place after another */
    HAND_MOTIONS
};

extern const char *const hand_motion_names[HAND_MOTIONS];

/* How it holds the tool. */
enum {
    HAND_FOLLOWS, /* as the surface lies: it turns as far as that does */
    HAND_HOLDS,   /* as where it began, but for what it nods: at most 0.9 rad from there. It stays within 40 mm */
    HAND_HOLDINGS
};

extern const char *const hand_holding_names[HAND_HOLDINGS];

/* Ticks in which a hand comes down from where it began, in the open. */
enum { HAND_DESCENT = 150 };

struct hand {
    const struct solid *solid;
    int motion, holding;
    uint64_t seed, tick;
    double depth;                /* m: below the surface */
    double start[3];             /* its first place */
    double at[3], out[3];        /* a place on the surface, and away from it */
    double next[3], next_out[3]; /* where it goes */
    double gone, way;            /* m, on the way there */
    double held[4], nod[3], rate;
};

void hand_begin(struct hand *hand, const struct solid *solid, int motion, int holding, double depth, uint64_t seed);

/* The pose of its next tick; the first is in the open. */
void hand_move(struct hand *hand, dpt_pose *pose);

#endif
