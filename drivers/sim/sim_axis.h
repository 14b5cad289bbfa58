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

#include "csv.h"
#include "exchange/latest_value.h"

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

/*
 * The hand on a simulated device: a script of forces, or of positions that a spring pulls to. Values are interpolated
 * linearly between the rows of a table; before the first and after the last row they stay. Buttons stay until the next
 * row. All values are in the device's frame.
 */

enum hand_kind { HAND_NONE, HAND_HOLD, HAND_PRESS, HAND_WIPE, HAND_TABLE };

struct sim_hand {
    enum hand_kind kind;
    double reach, cycle; /* of HAND_PRESS and HAND_WIPE: m, s */
    struct csv_table table;
    size_t row; /* of the table: the last one used */
    /* Steered from another thread. */
    struct latest_value steering;
    double wanted[LATEST_VALUE_PLACES][3];
    int is_steered;
    double steered_time;  /* s, of the last step towards what is wanted */
    double steered_at[3]; /* m */
};

/* What the hand wants at one time. */
struct hand_target {
    int is_position; /* 1: `value` is a position; 0: a force */
    double value[6]; /* position in m and rotation vector in rad, or force in N and torque in Nm */
    uint32_t buttons;
};

/*
 * Open a script: "" for no hand, a built-in name ("hold", "press", "wipe"), or a file's path.
 *   reach, cycle   of "press" and "wipe", m and s
 */
dpt_result sim_hand_open(struct sim_hand *hand, const char *script, double reach, double cycle,
                         dpt_device_error *error);
void sim_hand_close(struct sim_hand *hand);

/*
 * From now on the hand goes to a position, at STEERING_SPEED at most, whatever its script says; buttons stay the
 * script's. In any one thread. 0: this hand pushes by a force, or there is none.
 */
#define STEERING_SPEED 0.5 /* m/s */
int sim_hand_steer(struct sim_hand *hand, const double position[3]);

/* The target at `time`, s, which must not decrease from call to call. */
void sim_hand_at(struct sim_hand *hand, double time, struct hand_target *target);

#endif
