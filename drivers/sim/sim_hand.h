/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The hand on a simulated device: a script of forces, or of positions that a spring pulls to. Values are interpolated
 * linearly between the rows of a table; before the first and after the last row they stay. Buttons stay until the next
 * row. All values are in the device's frame.
 */
#ifndef DPT_DRIVERS_SIM_HAND_H
#define DPT_DRIVERS_SIM_HAND_H

#include "csv.h"
#include "exchange/latest_value.h"

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
 * From now on the hand goes to a position, at STEERING_SPEED at most, whatever its script says; buttons stay the script's.
 * In any one thread. 0: this hand pushes by a force, or there is none.
 */
#define STEERING_SPEED 0.5 /* m/s */
int sim_hand_steer(struct sim_hand *hand, const double position[3]);

/* The target at `time`, s, which must not decrease from call to call. */
void sim_hand_at(struct sim_hand *hand, double time, struct hand_target *target);

#endif
