/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The side of OpenHaptics that its own thread sees. The library has one scheduler for all devices, and so there is one
 * callback of ours, which gives each device a frame a tick: sample, force, errors. With the threads of the hosts it
 * shares the latest sample and the latest command of each device (latest_value.h), and nothing waits.
 */
#ifndef DPT_DRIVERS_OPENHAPTICS_SERVO_H
#define DPT_DRIVERS_OPENHAPTICS_SERVO_H

#include "exchange/latest_value.h"
#include "openhaptics/openhaptics_library.h"

enum { SERVOS_MAX = 8, SERVO_JOINTS = 6, SERVO_MOTORS = 16 };

struct servo_sample {
    uint64_t sequence; /* grows by 1 a tick */
    uint64_t time_ns;
    uint64_t missed; /* ticks without a command that still counts */
    uint32_t status, reasons, code, buttons;
    uint32_t clear_requests; /* that it has heard of */
    dpt_pose pose;
    double velocity[3], spin[3], joint[SERVO_JOINTS];
    double temperature; /* -1: not known */
};

struct servo_command {
    dpt_wrench wrench; /* within the device's limits */
    uint64_t time_ns;
};

struct servo {
    /* Of the host, fixed while it is in the scheduler. */
    const struct hd_library *hd;
    unsigned device, style;      /* of calibration: one bit, or 0 */
    int input_dofs, output_dofs; /* degrees of freedom, 0, 3 or 6 */
    double centre_mm[3];         /* of the workspace, mm: the origin of poses */
    uint64_t watchdog_ns;
    uint32_t ramp_ticks; /* ticks from no force to all of it */

    /* Between the threads. */
    struct latest_value samples, commands;
    struct servo_sample sample[LATEST_VALUE_PLACES];
    struct servo_command command[LATEST_VALUE_PLACES];
    uint32_t clear_requests; /* of faults, asked for by the host */
    uint32_t must_leave;

    /* Of the scheduler's thread. */
    struct servo_sample last;
    int has_capabilities; /* the next two lines are known, also to the host, with its first sample */
    int has_inkwell, temperature_count; /* of so many motors; both at first what may be */
    int has_spin, joints, buttons;      /* joints 0, 3 or 6; buttons 0 or 4 */
    int is_calibrated, is_docked, is_valid, is_lost, is_armed, is_leaving, gives_force;
    uint32_t fault, live_ticks; /* code, or 0; ticks since commands began, at most `ramp` */
    uint64_t fault_ns;          /* when it was last heard of */
};

void servo_wait(void); /* a millisecond */

/* The scheduler; all of it is for one thread at a time. */

/*
 * Stop it for a while, so that a device can be opened or closed; before, zero is sent to all. 0, and it is not stopped,
 * when its thread does not come by within a second.
 */
int scheduler_pause(const struct hd_library *hd);

/* Start it again, with `servo` in it; NULL: with those that were there. After an error it is not in it. */
hd_error scheduler_resume(struct servo *servo);

/*
 * Take it out: once more zero is sent. 0 when the scheduler's thread does not come by within a second: then it may
 * still use `servo`, for ever.
 */
int scheduler_leave(struct servo *servo);

/* For any thread. */
int scheduler_is_paused(void);
int scheduler_is_dead(void);      /* our callback is not in it any more */
uint64_t scheduler_since(void);   /* when it was last started */
unsigned scheduler_devices(void); /* how many are in it */

#endif
