/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The guard: what stands between any host and a device's motors (docs/drivers.md). It keeps a wrench finite, limited,
 * slewed and fresh, whatever the host says and however late it is.
 *
 * Pure, and part of the core: no device, no clock, no POSIX, all memory the caller's. So firmware and hosts in other
 * languages use it as it is; the loop (loop.h) has one in it.
 *
 * Threads: a guard belongs to one thread at a time; different guards may be used by different threads.
 *
 *     dpt_guard guard = { .size = sizeof guard };
 *     dpt_guard_init(&guard, NULL);
 *     each tick:    dpt_guard_step(&guard, now_ns, fresh ? &wrench : NULL, ready, &sent);
 */
#ifndef DYNPOINT_GUARD_H
#define DYNPOINT_GUARD_H

#include "dynpoint/types.h"

DPT_BEGIN

/* What the guard allows. Times in s; dpt_guard_def_init fills in the defaults, given last. */
typedef struct dpt_guard_def {
    uint32_t size;      /* sizeof(dpt_guard_def), set by dpt_guard_def_init */
    uint32_t reserved;  /* 0 */
    double force_max;   /* N, of the vector's length, 0..1000; 5 */
    double torque_max;  /* Nm, likewise; 0.2 */
    double force_slew;  /* N/s, how fast the vector may change; 0: as it likes; 2000 */
    double torque_slew; /* Nm/s, likewise; 80 */
    double hold;        /* that a command counts without a fresh one, 0..10; 0.003 */
    double stop;        /* of the ramp to zero after that, 0..10; 0.002: in sum 5 ticks of 1 kHz */
    double start;       /* of the ramp from zero to all of a command on the way back, 0..100; 0.1 */
} dpt_guard_def;

/*
 *                 fresh command                       ramp over
 *       OFF ------------------------> STARTING ----------------------> RUNNING
 *        ^                             |    ^                             |
 *        | ramp over        silence    |    | fresh command               | silence
 *        |                  > hold     v    | (from where the ramp is)    v > hold
 *        +-------------------------- STOPPING <---------------------------+
 *
 *       and from all of them to OFF, with zero force at once: not ready, or a command that is not finite
 */
enum { DPT_GUARD_OFF = 0, DPT_GUARD_STARTING = 1, DPT_GUARD_RUNNING = 2, DPT_GUARD_STOPPING = 3 };

/*
 * A guard's memory: 512 bytes, for the stack, a static variable or a struct of the caller's own; copied, it is another
 * guard. What is in it is the library's, and may change with each release; dpt_guard_get_info tells what it did. This
 * size stays.
 */
typedef struct dpt_guard {
    uint32_t size; /* sizeof(dpt_guard), set by the caller */
    uint32_t reserved;
    uint64_t opaque[63];
} dpt_guard;

/* What a guard had to do since dpt_guard_init, and what it does now. */
typedef struct dpt_guard_info {
    uint32_t size;       /* sizeof(dpt_guard_info), set by the caller */
    uint32_t state;      /* DPT_GUARD_OFF ... */
    uint64_t stops;      /* how often it left STARTING or RUNNING */
    uint64_t clamped;    /* commands that were too strong */
    uint64_t slewed;     /* steps on which the wrench changed less than was asked for */
    uint64_t not_finite; /* commands */
    uint64_t now_ns;     /* of the last step */
    uint64_t fresh_ns;   /* of the last command */
    double gain;         /* 0..1, of the ramp */
    dpt_wrench command;  /* the last one, clamped */
    dpt_wrench sent;     /* what left last */
} dpt_guard_info;

/* Fill in the first `size` bytes; what dpt_guard_def_init calls with its own caller's sizeof. */
DPT_API void dpt_guard_def_defaults(dpt_guard_def *def, size_t size);

static inline void dpt_guard_def_init(dpt_guard_def *def)
{
    dpt_guard_def_defaults(def, sizeof *def);
}

/* OFF, with all counts 0. `def` NULL: the defaults. A guard that could not be made gives no force. */
DPT_API dpt_result dpt_guard_init(dpt_guard *guard, const dpt_guard_def *def);

/* DPT_E_ARGUMENT, and all zero, of a guard that was not initialised. */
DPT_API dpt_result dpt_guard_get_info(const dpt_guard *guard, dpt_guard_info *info);

/*
 * What to send now; to be called each tick, also when nothing came. Pure: no clock, no system. What leaves is finite and
 * within the limits; it changes no faster than the slew but for a stop; it is zero hold + stop after the last fresh
 * command at the latest (with a stop of 0 as soon as hold is over), and at once when that is asked for.
 *   now_ns   of any clock; one that goes back stands still
 *   command  a fresh one, or NULL
 *   ready    0: the device or its pose cannot be trusted
 *   out      all zero for a guard that is NULL or was not initialised, such as one of zeros
 */
DPT_API void dpt_guard_step(dpt_guard *guard, uint64_t now_ns, const dpt_wrench *command, int ready,
                            dpt_wrench *out);

DPT_END

#endif
