/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * For tests of `near_only`: two worlds in which the same happens, with three bodies and a tool of many segments that join.
 * One searches for all segments, the other leaves out those that are far.
 */
#ifndef DPT_TESTS_NEAR_PAIR_H
#define DPT_TESTS_NEAR_PAIR_H

#include "lib/rig.h"
#include "lib/solid.h"

enum { NEAR_SEGMENTS = 24, NEAR_BODIES = 3, NEAR_SHEET = 2, SHEET_VERTICES_MAX = 1024 };

struct near_world {
    struct rig rig;
    dpt_body body[NEAR_BODIES];
    dpt_result result; /* of the step */
};

struct near_pair {
    struct near_world all, near;
    const struct solid *solids; /* NEAR_BODIES */
    dpt_segment segments[NEAR_SEGMENTS];
    dpt_pose pose;                   /* of the tool */
    dpt_pose body_pose[NEAR_BODIES]; /* as both worlds have them */
    double speed[3], spin[4];        /* of a tick */
    int is_free;                     /* the tool's segments are given in the world */
    int bodies_are_slow;             /* none jumps with its motion swept, which no tool can follow in a tick */
    int is_soft;                     /* the sheet's vertices move */
    double wave;                     /* rad */
    int has_budget;
    double force_error; /* N, allowed */
    uint64_t seed;
    /* Of all ticks: answers of segments, those that were left out, and ticks with a force. */
    uint64_t answers, left_out, forces;
};

/* Meshes of the bodies: a ball-like one, a ring and a sheet. 0: they cannot be made. */
int near_solids_open(struct solid solids[NEAR_BODIES]);

/* `def`: of both worlds; `near_budget`: of the one that leaves segments out. */
void near_pair_open(struct near_pair *pair, const struct solid *solids, const dpt_world_def *def, uint32_t near_budget,
                    uint64_t seed);

/* From the first tick on a wave runs through the sheet. */
void near_pair_soften(struct near_pair *pair);

void near_pair_close(struct near_pair *pair);

/* Move the tool, and let something else happen now and then. Then step both worlds. */
void near_pair_tick(struct near_pair *pair);

/* The ends of a segment in the world, where the tool was set last. */
void near_pair_ends(const struct near_pair *pair, uint32_t segment, double ends[6]);

/* Compare all answers of segments, the tool's, and the step's. */
void near_pair_compare(struct near_pair *pair);

/* Of the world that leaves segments out: its proxy, while it is pushed, goes through nothing. */
void near_pair_check_proxy(const struct near_pair *pair);

#endif
