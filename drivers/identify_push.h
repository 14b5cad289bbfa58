/* SPDX-License-Identifier: BSD-3-Clause */
/* Pushes along one axis: which force comes next. Positions here; angles alike. */
#ifndef DPT_DRIVERS_IDENTIFY_PUSH_H
#define DPT_DRIVERS_IDENTIFY_PUSH_H

#include <stdint.h>

/* Limits of the pushes along one axis, and how strong they are. */
struct identify_strength {
    double level; /* strongest force, N */
    double speed; /* above which the device is braked, m/s */
    double range; /* beyond which it is brought back, m from where the measurement began */
    double rise;  /* how long `level` takes to bring it to `speed`, s */
};

/*
 * A trial push: one way with a given level until the device moves or time is up, then the other way until it stops,
 * then none. It tells how strong the pushes must be.
 */
struct identify_trial {
    double level, push_time;                  /* N, with sign; s */
    double speed, range;                      /* at which the push ends */
    double least;                             /* but not before the device moved so far, m */
    double y0;                                /* where it began */
    double brake, rest;                       /* when braking and when rest began; negative: not yet */
    double peak_speed, peak_time, peak, last; /* along the push */
};

/* The force at this time, s, of a device at y that moves at v. *is_over is set when the trial has ended. */
double identify_trial_force(struct identify_trial *trial, double time, double y, double v, int *is_over);

/* Random pushes of random duration, which keep within speed and range. */
struct identify_pushes {
    struct identify_strength strength;
    double dwell_min; /* s */
    uint64_t random;
    double force, until; /* the present push */
    int brake;           /* 1, -1: the way that it is braked; 0: it is not */
    int is_far;          /* braked for its range */
    double brake_force;  /* 0..level */
    double brake_began;
};

double identify_pushes_force(struct identify_pushes *pushes, double time, double y, double v);

#endif
