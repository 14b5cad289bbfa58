/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Identification measures a haptic device: its rate and steps and, by small known pushes, its mass, damping, friction
 * and delay (docs/drivers.md, "Identification"; docs/algorithms/identify.md). A coupling is computed from these. The
 * command `dynpoint device identify` runs it.
 *
 *     dpt_identify_def def;
 *     dpt_identify_result measured = { .size = sizeof measured };
 *     dpt_identify_def_init(&def);
 *     def.may_move = 1;
 *     result = dpt_device_identify(device, &def, &measured);
 *     if (result == DPT_OK && measured.measured & DPT_IDENTIFIED_MASS)
 *         printf("%g kg\n", measured.mass.value);
 *
 * Let go of the device: what a hand adds is measured with it. Results hold near the pose at which they were measured.
 *
 * Safety: the force is at most 0.5 N and 10 % of the device's force_max, the torque at most 0.01 Nm and 10 % of its
 * torque_max. The measurement ends at once, and with zero force, at the speeds, displacements and faults that the
 * DPT_IDENTIFY_END_... constants name. Whatever ends it, the last command is zero force.
 *
 * Threads: the device belongs to the thread that measures it, as in a loop (loop.h). The report function is called in
 * that thread.
 */
#ifndef DYNPOINT_IDENTIFY_H
#define DYNPOINT_IDENTIFY_H

#include "dynpoint/device.h"

DPT_BEGIN

/* dpt_identify_progress.stage */
enum {
    DPT_IDENTIFY_STAGE_REST = 0, /* it only watches */
    DPT_IDENTIFY_STAGE_PUSH = 1, /* it pushes along an axis */
    DPT_IDENTIFY_STAGE_TURN = 2  /* it turns about an axis */
};

/* What the measurement does. The library fills it in; `size` is that of the library that runs. */
typedef struct dpt_identify_progress {
    uint32_t size;
    uint32_t stage; /* DPT_IDENTIFY_STAGE_... */
    uint32_t axis;  /* 0, 1, 2: x, y, z */
    uint32_t reserved;
    double done; /* fraction of the whole measurement, 0..1 */
} dpt_identify_progress;

/*
 * Called about 20 times a second, between a sample and its command: it must return within a small part of a period.
 * Return 0 to go on; any other value ends the measurement.
 */
typedef int dpt_identify_report_fn(void *user, const dpt_identify_progress *progress);

/* dpt_identify_def.button: no button is needed. */
#define DPT_IDENTIFY_NO_BUTTON 0xffffffffu

/* How to measure. dpt_identify_def_init fills in the defaults, which are given last below. */
typedef struct dpt_identify_def {
    uint32_t size;                  /* sizeof(dpt_identify_def), set by dpt_identify_def_init */
    uint32_t may_move;              /* 1: it may push the device; 0: only what needs no force is measured; 0 */
    uint32_t button;                /* number of a dead man's button, as of a pedal: released, it ends the measurement;
                          DPT_IDENTIFY_NO_BUTTON */
    uint32_t blocks;                /* seconds of pushes along each axis, 4..32; 8 */
    uint64_t seed;                  /* of the pushes' order; 1 */
    double seconds;                 /* how long to watch it at rest, s, 0.1..60; 1 */
    dpt_identify_report_fn *report; /* may be NULL */
    void *user;                     /* first argument of `report`; NULL */
} dpt_identify_def;

/* dpt_identify_result.end */
enum {
    DPT_IDENTIFY_END_COMPLETE = 0,
    DPT_IDENTIFY_END_STOPPED = 1,      /* the report function asked to stop */
    DPT_IDENTIFY_END_RELEASED = 2,     /* the dead man's button was not held */
    DPT_IDENTIFY_END_SPEED = 3,        /* faster than 0.2 m/s or 2 rad/s, over 4 ms */
    DPT_IDENTIFY_END_DISPLACEMENT = 4, /* further than 20 mm or 0.35 rad from where it began */
    DPT_IDENTIFY_END_SAMPLES = 5,      /* more than 4 samples or commands in a row were lost or late */
    DPT_IDENTIFY_END_NOT_READY = 6,    /* the device was not ready */
    DPT_IDENTIFY_END_LOST = 7,         /* the device was lost */
    /* It was not pushed, for nothing would end a force if this program died. */
    DPT_IDENTIFY_END_NO_WATCHDOG = 8
};

/* Bits of dpt_identify_result.flags. */
enum {
    /* It springs back, or moves without force. The results are those of the device and what holds it. */
    DPT_IDENTIFY_FLAG_HELD = 1,
    /* The allowed force does not move it along each axis: it is locked, held fast, or has more friction than that. */
    DPT_IDENTIFY_FLAG_STUCK = 2,
    /* The same of the allowed torque. */
    DPT_IDENTIFY_FLAG_TURN_STUCK = 4
};

/* Bits of dpt_identify_result.measured. A value whose bit is missing is 0. */
enum {
    DPT_IDENTIFIED_RATE = 1, /* and jitter */
    DPT_IDENTIFIED_MASS = 2,
    DPT_IDENTIFIED_DAMPING = 4,
    DPT_IDENTIFIED_FRICTION = 8,
    DPT_IDENTIFIED_INERTIA = 16,
    DPT_IDENTIFIED_SPIN_DAMPING = 32,
    DPT_IDENTIFIED_SPIN_FRICTION = 64,
    DPT_IDENTIFIED_DELAY = 128,
    DPT_IDENTIFIED_POSITION_STEP = 256,
    DPT_IDENTIFIED_ANGLE_STEP = 512
};

/* A value and its 95 % interval. Frozen. */
typedef struct dpt_identified {
    double value, low, high;
} dpt_identified;

/*
 * What was measured. The mass, the damping and the friction are those of the axes of the device, and may differ by
 * direction: `mass` and `damping` are the least ones over all directions, `friction` the least of the three axes, for
 * these limit a coupling. Where directions do not differ by more than 5 % or what chance explains, they are the means.
 * Rotation alike.
 */
typedef struct dpt_identify_result {
    uint32_t size;                /* sizeof(dpt_identify_result), set by the caller */
    uint32_t end;                 /* DPT_IDENTIFY_END_... */
    uint32_t flags;               /* DPT_IDENTIFY_FLAG_... */
    uint32_t measured;            /* DPT_IDENTIFIED_... */
    uint64_t samples;             /* samples that arrived in all */
    uint64_t lost;                /* samples that never arrived, by their numbers */
    uint64_t late;                /* reads, of one each period, that found no new sample */
    uint64_t doubled;             /* samples that arrived twice, or after a later one */
    double rate;                  /* Hz, by the samples' times */
    double jitter;                /* standard deviation of the time between samples, s */
    double jitter_max;            /* its largest difference from a whole number of periods, s */
    dpt_identified mass;          /* kg */
    dpt_identified damping;       /* Ns/m */
    dpt_identified friction;      /* N */
    dpt_identified inertia;       /* kg m2 */
    dpt_identified spin_damping;  /* Nms/rad */
    dpt_identified spin_friction; /* Nm */
    /*
     * From the time at which the device takes a command to the time at which it acts, s. Half a period of the
     * zero-order hold is not in it; the lag of a motor is.
     */
    dpt_identified delay;
    double position_step; /* smallest change of position that was seen, m */
    double angle_step;    /* rad */
    double stiffness;     /* of a spring that pulls the device back, N/m; about 0 for a free one */
    double turn_stiffness;
    double mass_matrix[9]; /* row by row, symmetric; as the next three in the device's frame */
    double damping_matrix[9];
    double inertia_matrix[9];
    double spin_damping_matrix[9];
    /* Unit vectors along which mass, damping, ... are least; zero where all directions are alike. */
    double mass_direction[3];
    double damping_direction[3];
    double inertia_direction[3];
    double spin_damping_direction[3];
    double force_bound;      /* largest force that was allowed, N */
    double torque_bound;     /* Nm */
    double speed_max;        /* fastest motion, m/s */
    double displacement_max; /* furthest from where it began, m */
    dpt_pose pose;           /* where it began */
} dpt_identify_result;

/* Fill in the first `size` bytes; what dpt_identify_def_init calls with its own caller's sizeof. */
DPT_API void dpt_identify_def_defaults(dpt_identify_def *def, size_t size);

static inline void dpt_identify_def_init(dpt_identify_def *def)
{
    dpt_identify_def_defaults(def, sizeof *def);
}

/*
 * Measure an open, ready device. It stays open, without force. Takes about `seconds`. With may_move it takes 4 s and up
 * to twice `blocks` seconds more for each of three axes, and as much again if the device gives torque.
 *   def      NULL: the defaults
 *   result   what was measured until `end`
 *
 * DPT_OK        `end` says how it ended
 * DPT_E_MEMORY  memory ran out
 * DPT_E_SYSTEM  there is no usable clock, or the device failed to take zero force at the end
 */
DPT_API dpt_result dpt_device_identify(dpt_device *device, const dpt_identify_def *def, dpt_identify_result *result);

/* One line of English for a DPT_IDENTIFY_END_...; "?" for any other number. */
DPT_API const char *dpt_identify_end_text(uint32_t end);

/*
 * Read device dynamics from a file that `dynpoint device identify -o` or a person wrote: a line for each value, as
 * "mass=0.045", with the names and ranges of the settings in docs/drivers.md, "Names and settings". NAME_low and
 * NAME_high may stand beside them. Blank lines and lines that begin with '#' are skipped.
 *   info    its fields that the file names are replaced, also by 0; after an error it is unchanged
 *   error   may be NULL. After a failure the text says which file, which line and why
 *
 * DPT_E_OPEN, DPT_E_SYNTAX. DPT_E_LIMIT: the file has more than 64 KiB.
 */
DPT_API dpt_result dpt_device_dynamics_read(const char *path, dpt_device_info *info, dpt_device_error *error);

DPT_END

#endif
