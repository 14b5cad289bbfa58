/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The guard stands between a host and a device's motors (docs/drivers.md). Whatever the host sends and however late,
 * the wrench that leaves the guard is finite and within limits, it changes no faster than its slew, and it ends when
 * the host falls silent.
 *
 * The guard is part of the core and pure: it uses no device, no clock and no POSIX, and all memory is the caller's. So
 * firmware and hosts in other languages can use it. The servo loop (loop.h) contains one.
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

/* What the guard allows. dpt_guard_def_init fills in the defaults, which are given last below. */
typedef struct dpt_guard_def {
    uint32_t size;      /* sizeof(dpt_guard_def), set by dpt_guard_def_init */
    uint32_t reserved;  /* 0 */
    double force_max;   /* largest length of the force vector, N, 0..1000; 5 */
    double torque_max;  /* largest length of the torque vector, Nm, 0..1000; 0.2 */
    double force_slew;  /* fastest change of the force vector, N/s; 0: unlimited; 2000 */
    double torque_slew; /* fastest change of the torque vector, Nm/s; 0: unlimited; 80 */
    double hold;        /* how long a command stays valid, s, 0..10; 0.003 */
    double stop;        /* duration of the ramp to zero after that, s, 0..10; 0.002 */
    /* Duration of the ramp from zero to a whole command, s, 0..100; 0.1. A driver may have a ramp of its own beside it. */
    double start;
} dpt_guard_def;

/*
 *                 fresh command                       ramp over
 *       OFF ------------------------> STARTING ----------------------> RUNNING
 *        ^                             |    ^                             |
 *        | ramp over        silence    |    | fresh command               | silence
 *        |                  > hold     v    | (from where the ramp is)    v > hold
 *        +-------------------------- STOPPING <---------------------------+
 *
 *       From every state to OFF, with zero force at once: the device is not ready, or a command is not finite.
 *       With the default times the force is zero 5 ms after the last command: 5 ticks at 1 kHz.
 */
enum { DPT_GUARD_OFF = 0, DPT_GUARD_STARTING = 1, DPT_GUARD_RUNNING = 2, DPT_GUARD_STOPPING = 3 };

/*
 * The memory of a guard: 512 bytes on the stack, in a static variable or in a struct of the caller's own. A copy is a
 * guard of its own. The content belongs to the library and may change with each release; the size does not.
 * dpt_guard_get_info reports what the guard did.
 */
typedef struct dpt_guard {
    uint32_t size; /* sizeof(dpt_guard), set by the caller */
    uint32_t reserved;
    uint64_t opaque[63];
} dpt_guard;

/* What a guard has done since dpt_guard_init, and its present state. */
typedef struct dpt_guard_info {
    uint32_t size;       /* sizeof(dpt_guard_info), set by the caller */
    uint32_t state;      /* DPT_GUARD_OFF ... */
    uint64_t stops;      /* how often it left STARTING or RUNNING */
    uint64_t clamped;    /* commands that were above a limit */
    uint64_t slewed;     /* steps on which the slew kept the wrench from its command */
    uint64_t not_finite; /* commands that were not finite */
    uint64_t now_ns;     /* time of the last step */
    uint64_t fresh_ns;   /* time of the last command */
    double gain;         /* factor of the ramp, 0..1 */
    dpt_wrench command;  /* the last command, clamped to the limits */
    dpt_wrench sent;     /* the last wrench that the guard let through */
} dpt_guard_info;

/* Fill in the first `size` bytes; what dpt_guard_def_init calls with its own caller's sizeof. */
DPT_API void dpt_guard_def_defaults(dpt_guard_def *def, size_t size);

static inline void dpt_guard_def_init(dpt_guard_def *def)
{
    dpt_guard_def_defaults(def, sizeof *def);
}

/*
 * Put a guard into OFF, with all counts 0. After an error the guard gives no force.
 *   def   NULL: the defaults
 */
DPT_API dpt_result dpt_guard_init(dpt_guard *guard, const dpt_guard_def *def);

/* For a guard that was not initialised this is DPT_E_ARGUMENT, and all of `info` is zero. */
DPT_API dpt_result dpt_guard_get_info(const dpt_guard *guard, dpt_guard_info *info);

/*
 * Compute the wrench to send now. Call it on every tick, also on those without a command.
 *
 * `out` is finite and within the limits. It changes no faster than the slew, except in a stop. It is zero at the latest
 * hold + stop after the last fresh command (if stop is 0, as soon as hold is over), and at once if `ready` is 0 or the
 * command is not finite.
 *   now_ns   time of any clock, ns. A clock that goes back counts as standing still
 *   command  a fresh command, or NULL if there is none
 *   ready    0: the device or its pose cannot be trusted
 *   out      zero if the guard is NULL or was not initialised, such as one whose bytes are all zero
 */
DPT_API void dpt_guard_step(dpt_guard *guard, uint64_t now_ns, const dpt_wrench *command, int ready, dpt_wrench *out);

DPT_END

#endif
