/* SPDX-License-Identifier: BSD-3-Clause */
/* The servo loop of an identification: one stage after the other, each with its pushes, all within the limits. */
#ifndef DPT_DRIVERS_IDENTIFY_SERVE_H
#define DPT_DRIVERS_IDENTIFY_SERVE_H

#include <stdint.h>

#include "dynpoint/device.h"
#include "dynpoint/identify.h"
#include "dynpoint/loop.h"
#include "identify_record.h"

/* ---- how a device moved since the measurement began, in positions and in angles ---- */

/* The two spaces: index of displacement, speed and limits. */
enum { IDENTIFY_POSITIONS, IDENTIFY_ANGLES, IDENTIFY_SPACES };

/* Limits of speed, m/s and rad/s, and of displacement, m and rad, of each space. */
extern const double identify_speed_max[IDENTIFY_SPACES], identify_displacement_max[IDENTIFY_SPACES];

/* Speed is measured over this time, or over 4 periods if that is longer. */
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

/* ---- pushes along one axis: which force comes next; positions here, angles alike ---- */

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
    double min_motion;                        /* but not before the device moved so far, m */
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

/* ---- the loop ---- */

enum identify_stage {
    IDENTIFY_REST,  /* no force; samples are recorded */
    IDENTIFY_TRIAL, /* one trial push */
    IDENTIFY_BLOCK, /* random pushes; samples and commands are recorded */
    IDENTIFY_RETURN /* back to where the measurement began, as far as the force suffices */
};

/* A spring and a damper that bring the device back; 0: not yet known. */
struct identify_return {
    double stiffness, damping;
};

/* Room for what is recorded in one space. */
struct identify_store {
    struct identify_sample *samples;
    struct identify_command *commands;
    uint32_t sample_count, command_count, capacity;
};

struct identify_server {
    dpt_device *device;
    dpt_device_info info;
    dpt_identify_def def;
    dpt_identify_result *result;
    double bound[IDENTIFY_SPACES];                         /* N, Nm */
    double speed[IDENTIFY_SPACES], range[IDENTIFY_SPACES]; /* that pushes aim at */
    double planned;                                        /* duration of all stages, s */
    double past;                                           /* of the stages before this one, s */
    struct identify_motion motion;
    struct identify_store store[IDENTIFY_SPACES];
    struct identify_return back[IDENTIFY_SPACES][3];
    /* The present stage. */
    enum identify_stage stage;
    uint32_t space, axis;
    double duration; /* s; of a trial and a return at most */
    struct identify_trial trial;
    struct identify_pushes pushes;
    double settled; /* since when the device is back, s; negative: it is not */
    dpt_loop *loop;
    int is_over;       /* the stage has come to its end */
    int has_sample;    /* in this stage */
    uint64_t begin_ns; /* of its first sample */
    uint64_t last_ns, sent_ns;
    uint32_t unsent; /* ticks in a row after which the device had taken no command */
    double reported; /* when, s */
};

/*
 * Run a stage, which `stage`, `space`, `axis`, `duration`, `trial` and `pushes` describe. At its end the force is zero.
 * Why it ended early is in result->end. DPT_E_SYSTEM: the loop could not run.
 */
dpt_result identify_serve(struct identify_server *server);

#endif
