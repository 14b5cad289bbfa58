/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The servo loop that serves a device, with the guard (guard.h) between the host and the motors (docs/drivers.md).
 *
 *     dpt_loop_def_init(&def);
 *     def.tick = feel;    dpt_result feel(void *user, const dpt_loop_sample *sample, dpt_wrench *wrench)
 *     def.user = &scene;
 *     dpt_loop_create(device, &def, &loop);
 *     dpt_loop_run(loop, &stats);    until dpt_loop_stop(loop)
 *     dpt_loop_free(loop);
 *
 * Threads: a loop, its device and the tick belong to the thread that runs it; dpt_loop_stop alone may be called from any
 * other. Different loops may run in different threads. What a tick shares with other threads is the host's to guard: a
 * tick that waits for a lock is late.
 */
#ifndef DYNPOINT_LOOP_H
#define DYNPOINT_LOOP_H

#include "dynpoint/device.h"
#include "dynpoint/guard.h"

DPT_BEGIN

/*
 * What a tick is told. The library fills it in; its size is that of the library that runs, and a field of a later
 * release is there where the size says so. What it points to is the loop's, for the time of the call: the state, which
 * is fresh and whose pose is sound, but whose status and reasons are to be looked at; and the info, as it was at
 * dpt_loop_create.
 *
 * `sent` is the wrench that has acted since the sample before this one, as an observer of energy needs it: what the
 * device took last, after the guard. A command that the device had no room for (DPT_E_BUSY, or a call that failed) is
 * dropped, and the one before acts on: `sent` stays. A device that is not ready, or lost, gives no force: its first
 * such sample is still told what acted before it, from then on `sent` is zero until the device takes a command again.
 * So it is before the first command of a run.
 *
 * `commands` is how many the device took since the last call: 1 as a rule; 0 and `sent` is older than that; of more, as
 * where samples were late, `sent` is the last.
 */
typedef struct dpt_loop_sample {
    uint32_t size;
    uint32_t commands;
    const dpt_device_state *state;
    const dpt_device_info *info;
    double dt; /* since the sample of the last call, s; one period at first, and after a loss */
    uint64_t sent_ns; /* when the device took `sent`, on the clock of state->time_ns; 0 before */
    dpt_wrench sent;  /* in the device's frame */
} dpt_loop_sample;

/*
 * One tick of the host: from a fresh sample to a wrench, in the device's frame. It is called for samples of a device
 * that is not ready, too, to be seen; its wrench is not used then. It may call dpt_device_clear.
 *   wrench  zero before the call
 * Anything but DPT_OK, and there is no fresh command. While a tick takes its time nothing is sent: only a device's own
 * watchdog ends the force of a tick that hangs.
 */
typedef dpt_result dpt_loop_tick_fn(void *user, const dpt_loop_sample *sample, dpt_wrench *wrench);

/* dpt_loop_def_init fills in the defaults, given last. */
typedef struct dpt_loop_def {
    uint32_t size;     /* sizeof(dpt_loop_def), set by dpt_loop_def_init */
    uint32_t priority; /* of the thread, by SCHED_FIFO, 1..99; 0: as it is; 80 */
    uint32_t lock;     /* 1: keep the process in memory while it runs, see dpt_loop_run; 1 */
    uint32_t reopen; /* 1: dpt_device_clear a device that is lost, once a second; 0: end then; 0 */
    double rate;     /* Hz, 1..100000; 0: the device's own, soon after its samples; 0 */
    uint64_t ticks;  /* 0: until dpt_loop_stop; 0 */
    dpt_loop_tick_fn *tick;       /* not NULL */
    void *user;                   /* its first argument; NULL */
    const dpt_guard_def *guard;   /* read by dpt_loop_create; NULL: its defaults; NULL */
    const void *reserved_pointer; /* NULL */
} dpt_loop_def;

/* Bin k of a histogram counts what took 2^(k/4) us up to 2^((k+1)/4) us; the first also less, the last also more. */
#define DPT_LOOP_BINS 64

/* What was not permitted: bits of dpt_loop_stats.notes. */
enum {
    DPT_LOOP_NOTE_NO_PRIORITY = 1, /* the scheduler stayed as it was */
    DPT_LOOP_NOTE_NO_LOCK = 2,     /* memory may be paged out */
    DPT_LOOP_NOTE_NO_RETURN = 4    /* the thread kept the loop's priority at the end */
};

typedef struct dpt_loop_stats {
    uint32_t size;      /* sizeof(dpt_loop_stats), set by the caller */
    uint32_t notes;     /* DPT_LOOP_NOTE_... */
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
 * when the device is lost; always with zero force, and the thread's scheduling and timer slack as they were.
 * Where the machine was suspended in between the guard starts anew, with its ramp (Linux).
 *   stats   may be NULL
 *
 * Memory is locked only where that costs the host nothing: where RLIMIT_MEMLOCK is unlimited, or the process is privileged
 * (CAP_IPC_LOCK). Under a finite limit the host could then create no thread and allocate nothing: nothing is locked, and
 * the notes say DPT_LOOP_NOTE_NO_LOCK. The lock is of the whole process (mlockall). The last of several loops ends it
 * (munlockall), for what the host locked meanwhile too. It stays where the host had locked memory before the first loop, and
 * where the system does not tell (other than Linux).
 *
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
