/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The hand on a simulated device: a script of forces, or of places that a spring pulls to. Between rows values change
 * linearly, before the first and behind the last they stay; buttons stay until the next row.
 */
#ifndef DPT_DRIVERS_SIM_HAND_H
#define DPT_DRIVERS_SIM_HAND_H

#include "csv.h"

enum hand_kind { HAND_NONE, HAND_HOLD, HAND_PRESS, HAND_WIPE, HAND_TABLE };

struct sim_hand {
    enum hand_kind kind;
    double reach, cycle; /* of HAND_PRESS and HAND_WIPE: m, s */
    struct csv_table table;
    size_t row; /* the last one that was in use */
};

/* Of one moment: a place (m and a rotation vector, rad) or a force (N, Nm). */
struct hand_target {
    int is_position; /* 1: `at` is a place; 0: it is a force */
    double value[6];
    uint32_t buttons;
};

/* `script` is "", the name of one that is built in, or a file's. */
dpt_result sim_hand_open(struct sim_hand *hand, const char *script, double reach, double cycle,
                         dpt_device_error *error);
void sim_hand_close(struct sim_hand *hand);

/* Time goes on from call to call. */
void sim_hand_at(struct sim_hand *hand, double time, struct hand_target *target);

#endif
