/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The part of the driver that runs in OpenHaptics' own thread, the servo thread. The library has one scheduler for all
 * devices. Our one callback in it gives each device one frame a tick: sample, force, errors. The servo thread and the
 * hosts' threads exchange the latest sample and the latest command of each device (latest_value.h). Neither waits.
 */
#ifndef DPT_DRIVERS_OPENHAPTICS_SERVO_H
#define DPT_DRIVERS_OPENHAPTICS_SERVO_H

#include "exchange/latest_value.h"
#include "openhaptics/openhaptics_library.h"

enum { SERVOS_MAX = 8, SERVO_JOINTS = 6, SERVO_MOTORS = 16 };

struct servo_sample {
    uint64_t sequence; /* grows by 1 a tick */
    uint64_t time_ns;
    uint64_t missed; /* ticks without a command younger than the watchdog */
    uint32_t status, reasons, code, buttons;
    uint32_t clear_requests; /* the newest servo.clear_requests that the servo thread saw */
    dpt_pose pose;
    double velocity[3], spin[3], joint[SERVO_JOINTS];
    double temperature; /* -1: not known */
};

struct servo_command {
    dpt_wrench wrench; /* in the device's frame, N and Nm, within its limits */
    uint64_t time_ns;
};

struct servo {
    /* Set by the host, fixed while the servo is in the scheduler. */
    const struct hd_library *hd;
    unsigned device, style;      /* style: HD_CALIBRATION_..., one bit, or 0 */
    int input_dofs, output_dofs; /* degrees of freedom, 0, 3 or 6 */
    double centre_mm[3];         /* of the workspace in the library's frame, mm: the origin of poses */
    uint64_t watchdog_ns;
    uint32_t ramp_ticks; /* ticks from no force to all of it */

    /* Shared by the threads. */
    struct latest_value samples, commands;
    struct servo_sample sample[LATEST_VALUE_PLACES];
    struct servo_command command[LATEST_VALUE_PLACES];
    uint32_t clear_requests; /* counts the host's requests to clear a fault */
    uint32_t must_leave;     /* 1: the host wants the servo out of the scheduler */

    /* Of the servo thread. */
    struct servo_sample last;
    /* 1: the next five fields are known. The host may read them, too, once it has the first sample. */
    int has_capabilities;
    int has_inkwell;       /* before that: it may have one */
    int temperature_count; /* motors with a temperature; before that: at most */
    int has_spin;
    int joints;  /* 0, 3 or 6 */
    int buttons; /* 0 or 4 */
    int is_calibrated, is_docked, is_valid, is_lost, is_armed, is_leaving, gives_force;
    uint32_t fault;      /* number of the error, or 0 */
    uint32_t live_ticks; /* ticks since commands began, at most ramp_ticks */
    uint64_t fault_ns;   /* when that error came last */
};

/* Sleep for a millisecond. */
void servo_wait(void);

/* The scheduler. From here on to scheduler_leave: one thread at a time. */

/*
 * Stop the scheduler so that a device can be opened or closed. Sends zero force to all devices first. Returns 0, and
 * does not stop it, if the servo thread does not respond within a second.
 */
int scheduler_pause(const struct hd_library *hd);

/*
 * Start the scheduler again, with all servos in it and `servo` (may be NULL) added. After an error `servo` is not in
 * it.
 */
hd_error scheduler_resume(struct servo *servo);

/*
 * Take a servo out of the scheduler, after zero force was sent once more. Returns 0 if the servo thread does not
 * respond within a second: it may then use `servo` for ever.
 */
int scheduler_leave(struct servo *servo);

/* These may be called from any thread. */
int scheduler_is_paused(void);
int scheduler_is_dead(void);      /* 1: our callback is not scheduled any more */
uint64_t scheduler_since(void);   /* when it was last started, ns of clock_now */
unsigned scheduler_devices(void); /* number of servos in it */

#endif
