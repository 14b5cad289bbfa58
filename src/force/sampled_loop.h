/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Is a sampled loop stable? A device of one or two coordinates, each a mass with viscous damping, is held by a spring and
 * a damper that a computer samples and whose force stands still in between: docs/algorithms/coupling.md.
 */
#ifndef DPT_SAMPLED_LOOP_H
#define DPT_SAMPLED_LOOP_H

/* Delays of more periods are modelled by longer periods. */
enum { SAMPLED_PERIODS_MAX = 16 };

/* How a mass moves over one period, in units of the mass and the period. */
struct sampled_axis {
    double decay;       /* of its velocity */
    double gliding;     /* how far a velocity of 1 carries it */
    double position[2]; /* what the newer and the older command add to the position */
    double velocity[2]; /* and to the velocity */
    double unit;        /* period^2 / mass: a stiffness times that has no unit */
};

struct sampled_loop {
    struct sampled_axis axis[2];
    double period; /* s */
    int delay;     /* whole periods */
};

/* What holds two coordinates: a stiffness, symmetric and not negative, and a damper in proportion to it. */
struct sampled_spring {
    double along[2], between;
    double damping_time; /* s: damping / stiffness */
    int leaves_free;     /* 1: one direction is not held, so the stiffness' determinant is 0 */
};

/* Masses above 0 and dampings of `axes` coordinates, 1 or 2; the period, above 0, and the delay, in s. */
struct sampled_loop dpti_sampled_loop(const double *mass, const double *damping, int axes, double period, double delay);

/* 1 if all motion dies away, but for a drift in a direction that is left free. One coordinate: `along[0]` alone counts. */
int dpti_sampled_loop_holds(const struct sampled_loop *loop, int axes, const struct sampled_spring *spring);

#endif
