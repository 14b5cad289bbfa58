/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A stand-in for libHD: a shared library of ours with the same functions, which keeps the rules that the vendor's pages
 * state and has simulated devices behind it. The driver loads it as it would the vendor's. It knows nothing of how the
 * vendor's is made; where the pages say nothing it does the least.
 *
 * Rules: how a device is, and forces, in frames only, what it is at any time; a frame of a device in a tick, nested ones count as one; frames in the
 * scheduler's thread, or while the scheduler stands; a frame makes its device the current one; forces act from the end of a
 * frame until the end of another, also when the scheduler is stopped; one stack of errors, the last first; callbacks by priority; a thread with 1000 ticks a
 * second; calibration by style, at its moment. What breaks a rule is an error, as documented, and counted here.
 *
 * A test finds struct stand_in by its name. In the environment: STAND_IN_SWING, how far the hand goes down and up, m.
 */
#ifndef DPT_TESTS_STAND_IN_H
#define DPT_TESTS_STAND_IN_H

#include "simulate/mechanism.h"

enum { STAND_IN_DEVICES = 2, STAND_IN_STALE = 0x7f3a11c0, STAND_IN_NONE = -1 /* no device */ };

struct stand_in_device {
    /* What it is: to be changed before it is opened. */
    char name[32], model[32], serial[32];
    int inputs, outputs;
    double force_max, force_continuous, stiffness, torque_max; /* N, N, N/mm, mNm */
    double workspace[6];                                       /* mm */
    unsigned styles;

    /* How it is: to be changed between ticks. */
    int is_plugged, in_inkwell, buttons;
    unsigned calibration;
    int resists; /* to be calibrated */
    double transform[16], velocity[3], spin[3], joints[3], gimbal[3];
    double temperature[8];
    int moves; /* by what follows; else only a test moves it */
    double swing;
    struct mechanism mechanism;

    /* What was done to it. */
    int is_open, depth;
    unsigned enabled; /* bit k: capability 0x4000 + k */
    unsigned long frame_tick, frames, updates;
    double set_force[3], set_torque[3]; /* in this frame */
    double force[3], torque[3];         /* since the end of the last one */
};

struct stand_in {
    struct stand_in_device device[STAND_IN_DEVICES];

    /* Faults, each of the next call or tick; 0 is none. */
    unsigned fail_init, fail_rate, fail_schedule, fail_start;
    unsigned raise;
    int raise_device;    /* STAND_IN_NONE: with garbage for a device */
    unsigned raise_more; /* so many more times */
    int drops_callbacks;
    int lingers; /* in the call that raises it, for another thread to take it; hdStartScheduler waits for one */
    /* For as long as they are set. */
    int goes_stale; /* after an hdInitDevice that failed the next gives STAND_IN_STALE */
    int hangs;      /* no ticks */
    unsigned unsupported[4];
    unsigned unsupported_as; /* this error; 0: HD_INVALID_ENUM */

    unsigned long ticks;
    unsigned rate, violations;
    char violation[64]; /* the last one */

    /* Called, once each, at the begin of these, as if another thread did it. */
    void (*in_init)(void), (*in_start)(void), (*in_wait)(void);

    void (*reset)(void); /* all as new; the scheduler must stand */
    void (*hold)(void);  /* no ticks but by tick(), in the caller's thread */
    void (*go)(void);
    void (*tick)(void);
    int (*errors)(void); /* that are on the stack */
};

extern struct stand_in stand_in;

/* Between the library's parts. */
void stand_in_push(unsigned code, int internal, unsigned device);
void stand_in_break(const char *rule);
void stand_in_wait(void); /* a millisecond */
void stand_in_meanwhile(void (**what)(void));
int stand_in_is_servo(void); /* the calling thread is the scheduler's */
int stand_in_runs(void);
void stand_in_after_tick(void);
void stand_in_clear_scheduler(void);

#endif
