/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The servo loop, and the guard that stands between any host and a device's motors (docs/drivers.md).
 *
 *     dpt_loop_def_init(&def);
 *     def.tick = feel;    dpt_result feel(void *user, const dpt_device_state *state, double dt, dpt_wrench *wrench)
 *     def.user = &scene;
 *     dpt_loop_create(device, &def, &loop);
 *     dpt_loop_run(loop, &stats);    until dpt_loop_stop(loop)
 *     dpt_loop_free(loop);
 */
#ifndef DYNPOINT_LOOP_H
#define DYNPOINT_LOOP_H

#include "dynpoint/driver.h"

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

/* Its memory, and what it had to do. For reading only. */
typedef struct dpt_guard {
    uint32_t size;       /* sizeof(dpt_guard), set by the caller */
    uint32_t state;      /* DPT_GUARD_OFF ... */
    uint64_t stops;      /* how often it left STARTING or RUNNING */
    uint64_t clamped;    /* commands that were too strong */
    uint64_t slewed;     /* steps on which the wrench changed less than was asked for */
    uint64_t not_finite; /* commands */
    uint64_t hold_ns;
    uint64_t stop_ns;
    uint64_t now_ns;   /* of the last step */
    uint64_t fresh_ns; /* of the last command */
    double force_max;
    double torque_max;
    double force_slew;
    double torque_slew;
    double start;
    double gain;        /* 0..1, of the ramp */
    double stop_gain;   /* that the ramp to zero began with */
    dpt_wrench command; /* the last one, clamped */
    dpt_wrench held;    /* what the ramp to zero began with */
    dpt_wrench sent;    /* what left last */
} dpt_guard;

/* Fill in the first `size` bytes; what dpt_guard_def_init calls with its own caller's sizeof. */
DPT_API void dpt_guard_def_defaults(dpt_guard_def *def, size_t size);

static inline void dpt_guard_def_init(dpt_guard_def *def)
{
    dpt_guard_def_defaults(def, sizeof *def);
}

/* OFF, with all counts 0. `def` NULL: the defaults. */
DPT_API dpt_result dpt_guard_init(dpt_guard *guard, const dpt_guard_def *def);

/*
 * What to send now; to be called each tick, also when nothing came. Pure: no clock, no system. What leaves is finite and
 * within the limits; it changes no faster than the slew but for a stop; it is zero hold + stop after the last fresh
 * command at the latest (with a stop of 0 as soon as hold is over), and at once when that is asked for.
 *   now_ns   of any clock; one that goes back stands still
 *   command  a fresh one, or NULL
 *   ready    0: the device or its pose cannot be trusted
 *   out      all zero for a guard that is NULL or was not initialised
 */
DPT_API void dpt_guard_step(dpt_guard *guard, uint64_t now_ns, const dpt_wrench *command, int ready,
                            dpt_wrench *out);

/*
 * One tick of the host: from a fresh sample to a wrench, in the device's frame.
 *   state   status and reasons too: it is called for samples of a device that is not ready, to be seen; its wrench is
 *           not used then. It may call dpt_device_clear
 *   dt      since the sample of the last call, s; one period at first
 *   wrench  zero before the call
 * Anything but DPT_OK, and there is no fresh command. While a tick takes its time nothing is sent: only a device's own
 * watchdog ends the force of a tick that hangs.
 */
typedef dpt_result dpt_loop_tick(void *user, const dpt_device_state *state, double dt,
                                 dpt_wrench *wrench);

/* dpt_loop_def_init fills in the defaults, given last. */
typedef struct dpt_loop_def {
    uint32_t size;     /* sizeof(dpt_loop_def), set by dpt_loop_def_init */
    uint32_t priority; /* of the thread, by SCHED_FIFO, 1..99; 0: as it is; 80 */
    uint32_t lock;     /* 1: keep all of the process in memory, from now on; 1 */
    uint32_t reopen; /* 1: dpt_device_clear a device that is lost, once a second; 0: end then; 0 */
    double rate;     /* Hz, 1..100000; 0: the device's own, half way between its samples; 0 */
    uint64_t ticks;  /* 0: until dpt_loop_stop; 0 */
    dpt_loop_tick *tick; /* not NULL */
    void *user;          /* its first argument; NULL */
    dpt_guard_def guard; /* its defaults */
} dpt_loop_def;

/* Bin k of a histogram counts what took 2^(k/4) us up to 2^((k+1)/4) us; the first also less, the last also more. */
#define DPT_LOOP_BINS 64

/* What was not permitted: bits of dpt_loop_stats.notes. */
enum {
    DPT_LOOP_NO_PRIORITY = 1, /* the scheduler stayed as it was */
    DPT_LOOP_NO_LOCK = 2,     /* memory may be paged out */
    DPT_LOOP_NO_RETURN = 4    /* the thread kept the loop's priority at the end */
};

typedef struct dpt_loop_stats {
    uint32_t size;      /* sizeof(dpt_loop_stats), set by the caller */
    uint32_t notes;     /* DPT_LOOP_... */
    uint64_t ticks;     /* each of them is in one of the next five */
    uint64_t fresh;     /* with a fresh sample of a ready device, and a command from it */
    uint64_t failed;    /* likewise, but the host's tick gave no command */
    uint64_t stale;     /* without a fresh sample */
    uint64_t not_ready; /* with a sample of a device that was not ready, or no pose */
    uint64_t lost;      /* while the device was lost */
    uint64_t skipped;   /* samples that were never seen */
    uint64_t reordered; /* samples older than one seen before; counted in `stale` too */
    uint64_t sent;      /* commands that the device took */
    uint64_t refused;   /* commands that it did not */
    uint64_t
        missed; /* deadlines: periods that began while a tick was under way, or slept through */
    uint64_t losses;   /* times that the device was lost */
    uint64_t reopened; /* times that it came back */
    uint64_t stops;    /* of the guard, see there */
    uint64_t clamped;
    uint64_t slewed;
    uint64_t not_finite;
    double late_max; /* s, of a tick behind its deadline */
    double took_max; /* s, of a tick's own work */
    uint64_t late[DPT_LOOP_BINS];
    uint64_t took[DPT_LOOP_BINS];
} dpt_loop_stats;

typedef struct dpt_loop dpt_loop;

/* Fill in the first `size` bytes; what dpt_loop_def_init calls with its own caller's sizeof. */
DPT_API void dpt_loop_def_defaults(dpt_loop_def *def, size_t size);

static inline void dpt_loop_def_init(dpt_loop_def *def)
{
    dpt_loop_def_defaults(def, sizeof *def);
}

/*
 * A loop for an open device, which stays the caller's. The guard's limits become the lesser of the def's and the device's.
 * DPT_E_ARGUMENT where a command would not count until the next tick (hold shorter than a period).
 */
DPT_API dpt_result dpt_loop_create(dpt_device *device, const dpt_loop_def *def, dpt_loop **loop);

/*
 * Serve the device in this thread, at absolute deadlines: read, tick, guard, write. A deterministic device has its own
 * time: no one waits, the thread and memory stay as they are, nothing is late. Ends after `ticks`, on dpt_loop_stop, or
 * when the device is lost; always with zero force, and the thread's scheduling as it was.
 *   stats   may be NULL
 * DPT_E_LOST: the device was lost. DPT_E_SYSTEM: there is no clock to go by. Else what the device answered to the last
 * command, that of zero force.
 */
DPT_API dpt_result dpt_loop_run(dpt_loop *loop, dpt_loop_stats *stats);

/* End the run that is under way, or else the next one. From any thread, also from a signal handler. */
DPT_API void dpt_loop_stop(dpt_loop *loop);

DPT_API void dpt_loop_free(dpt_loop *loop);

/* Of a histogram: the time, in s, that `fraction` (0..1) of what it counts did not exceed, rounded up to a bin's end. */
DPT_API double dpt_loop_quantile(const uint64_t *bins, double fraction);

DPT_END

#endif
