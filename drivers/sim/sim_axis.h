/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * One axis of a simulated device: a mass with a viscous damper, a spring to a centre, a motor with a time constant, and
 * dry friction. While it moves, position x, velocity v and the motor's force f follow
 *     x' = v
 *     m v' = f + push - spring (x - centre) - damping v - friction sign(v)
 *     f' = (command - f) / lag        or f = command, without lag
 * An axis at rest (v = 0) stays there, bit for bit, while |f + push - spring (x - centre)| <= stiction. An axis whose
 * velocity becomes zero is at rest from that moment on.
 *
 * The solution between two such moments is the matrix exponential. The moments are located to 2^-50 of the time asked
 * for, and none is missed. Angles and inertias take the place of positions and masses for axes that turn.
 */
#ifndef DPT_DRIVERS_SIM_AXIS_H
#define DPT_DRIVERS_SIM_AXIS_H

struct sim_axis {
    double mass;     /* kg, above 0 */
    double damping;  /* Ns/m */
    double spring;   /* N/m */
    double lag;      /* s; 0: none */
    double friction; /* while it moves, N */
    double stiction; /* at rest, N; at least `friction`. 0: no friction at all */
};

struct sim_motion {
    double x, v; /* m, m/s */
    double f;    /* the motor's force, N */
};

/* What acts on an axis and stays the same for a time. */
struct sim_load {
    double command; /* N */
    double push;    /* N */
    double centre;  /* of the spring, m */
};

/*
 * The motion over a time under a constant force F (push and command) and a decaying one, d = f - command at its
 * beginning. Without friction and with the centre at 0,
 *     x' = xx x + xv v + xf F + xd d        v' = vx x + vv v + vf F + vd d        d' = dd d
 */
struct sim_transition {
    double time; /* s */
    double xx, xv, xf, xd, vx, vv, vf, vd, dd;
};

/* The transition over `time`, s, which is above 0. */
struct sim_transition sim_axis_transition(const struct sim_axis *axis, double time);

/* Move the axis by the time of `over`, which is a transition of this axis. */
void sim_axis_advance(const struct sim_axis *axis, const struct sim_transition *over, const struct sim_load *load,
                      struct sim_motion *motion);

#endif
