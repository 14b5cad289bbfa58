/* SPDX-License-Identifier: BSD-3-Clause */
/* How a device moved since the measurement began, in positions and in angles, and whether that is within limits. */
#ifndef DPT_DRIVERS_IDENTIFY_MOTION_H
#define DPT_DRIVERS_IDENTIFY_MOTION_H

#include "dynpoint/device.h"

/* The two spaces: index of displacement, speed and limits. */
enum { IDENTIFY_POSITIONS, IDENTIFY_ANGLES, IDENTIFY_SPACES };

/* Limits of speed, m/s and rad/s, and of displacement, m and rad, of each space. */
extern const double identify_speed_max[IDENTIFY_SPACES], identify_displacement_max[IDENTIFY_SPACES];

/* Speed is taken over so long, or over 4 periods if that is longer. */
#define IDENTIFY_SPEED_TIME 0.004

enum { IDENTIFY_WINDOW_MAX = 512 };

struct identify_motion {
    uint32_t spaces; /* 1 or 2 */
    uint32_t window; /* samples of the ring in use */
    int has_start;
    dpt_pose start;
    double displacement[IDENTIFY_SPACES][3]; /* m; rad: a rotation vector */
    double speed[IDENTIFY_SPACES][3];        /* m/s, rad/s */
    double furthest[IDENTIFY_SPACES], fastest[IDENTIFY_SPACES];
    uint64_t samples; /* since the ring was emptied */
    uint64_t ring_ns[IDENTIFY_WINDOW_MAX];
    double ring[IDENTIFY_WINDOW_MAX][IDENTIFY_SPACES][3];
};

void identify_motion_init(struct identify_motion *motion, const dpt_device_info *info);

/* Forget the speed, after a pause in which no samples were taken. */
void identify_motion_pause(struct identify_motion *motion);

void identify_motion_add(struct identify_motion *motion, const dpt_device_state *state);

#endif
