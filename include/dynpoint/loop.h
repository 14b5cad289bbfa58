/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The servo loop. At each tick it reads a device, calls the host's function, passes the wrench through a guard
 * (guard.h) and writes it (docs/drivers.md, "The loop").
 *
 *     dpt_result feel(void *user, const dpt_loop_sample *sample, dpt_wrench *wrench);
 *
 *     dpt_loop_def_init(&def);
 *     def.tick = feel;
 *     def.user = &scene;
 *     dpt_loop_open(device, &def, &loop);
 *     dpt_loop_run(loop, &stats);              returns after dpt_loop_stop(loop)
 *     dpt_loop_close(loop);
 *
 * Threads: a loop and its device belong to the thread that runs the loop, and the host's function is called there.
 * dpt_loop_stop may be called from any thread. Different loops may run in different threads. The host must protect data
 * that it shares with other threads, but a tick that waits for a lock is late.
 */
#ifndef DYNPOINT_LOOP_H
#define DYNPOINT_LOOP_H

#include "dynpoint/device.h"
#include "dynpoint/guard.h"

DPT_BEGIN

/*
 * The input of one tick of the host. The library fills it in. `size` is that of the library that runs: a field of a
 * later release exists if the size covers it. What the pointers point to belongs to the loop and is valid during the
 * call.
 *
 *   state     A fresh sample. Its pose is finite and of unit length. The device may still be not ready: look at
 *             `status` and `reasons`.
 *   info      The device's description, read by dpt_loop_open.
 *   dt        Time since the sample of the call before, s. One period on the first call and after a loss.
 *   sent      The wrench that has acted since the sample before this one, in the device's frame: the last one that the
 *             device took, after the guard. An observer of energy needs it. If the device refused a command
 *             (DPT_E_BUSY, or a call that failed), that command is dropped, the one before still acts, and `sent`
 *             stays. `sent` is zero before the first command of a run. A device that is not ready, or is lost, gives no
 *             force. Its first such sample still reports the wrench that acted before it; after that `sent` is zero
 *             until the device takes a command again.
 *   sent_ns   When the device took `sent`, on the clock of state->time_ns; 0 if there is none.
 *   commands  The number of commands that the device took since the call before. Usually 1. If 0, `sent` is older than
 *             that call. If more than 1, because samples came late, `sent` is the last of them.
 *   other     With two devices (dpt_loop_def.other), the second one's sample; NULL in it, and with one device.
 *   late      From the deadline to this tick, s. 0 for a deterministic device, which is never late.
 */
typedef struct dpt_loop_sample {
    uint32_t size;
    uint32_t commands;
    const dpt_device_state *state;
    const dpt_device_info *info;
    double dt;
    uint64_t sent_ns;
    dpt_wrench sent;
    double late;
    const struct dpt_loop_sample *other;
    const void *reserved_pointer; /* NULL */
} dpt_loop_sample;

/*
 * One tick of the host: compute a wrench, in the device's frame, from a fresh sample. It is also called if the device
 * is not ready, so that the host sees the sample; the wrench is not used then. It may call dpt_device_clear.
 *   wrench   zero before the call
 *
 * With two devices (dpt_loop_def.other) `wrench` is an array of two, and the call comes if either device has a fresh
 * sample. A device without one has a `dt` of 0 and state->fresh 0 in its sample, and its wrench is not used.
 *
 * If it returns anything but DPT_OK, there is no fresh command. The loop sends nothing while this function runs. If it
 * hangs, only the device's own watchdog ends the force.
 */
typedef dpt_result dpt_loop_tick_fn(void *user, const dpt_loop_sample *sample, dpt_wrench *wrench);

/*
 * A tick that has no sample for the host: there is no fresh one, or its pose is not sound, or the device is lost. It is
 * for those who record a run: no wrench is asked for. `sample` is as in a call of dpt_loop_tick_fn, but `dt` is 0, and
 * `state` is what was read last: its pose may be an old one, or may not be finite.
 */
typedef void dpt_loop_idle_fn(void *user, const dpt_loop_sample *sample);

/* dpt_loop_def_init fills in the defaults, which are given last below. */
typedef struct dpt_loop_def {
    uint32_t size;                    /* sizeof(dpt_loop_def), set by dpt_loop_def_init */
    uint32_t priority;                /* of the thread, by SCHED_FIFO, 1..99; 0: unchanged; 80 */
    uint32_t lock;                    /* 1: lock the process in memory while the loop runs, see dpt_loop_run; 1 */
    uint32_t reopen;                  /* 1: call dpt_device_clear once a second while the device is lost; 0: end; 0 */
    double rate;                      /* Hz, 1..100000; 0: the device's rate, each tick soon after a sample; 0 */
    uint64_t ticks;                   /* number of ticks to run; 0: until dpt_loop_stop; 0 */
    dpt_loop_tick_fn *tick;           /* not NULL */
    void *user;                       /* first argument of `tick` and `idle`; NULL */
    const dpt_guard_def *guard;       /* read by dpt_loop_open; NULL: the guard's defaults; NULL */
    const void *reserved_pointer;     /* NULL */
    dpt_loop_idle_fn *idle;           /* called on each tick that does not call `tick`; NULL */
    const void *reserved_pointer_2;   /* NULL */
    uint32_t cpu;                     /* the thread runs on this processor alone, counted from 1; 0: on any; 0 */
    uint32_t awake;                   /* 1: processors stay out of sleep from which they wake late (Linux); 0 */
    dpt_device *other;                /* a second device, served in the same ticks; NULL */
    const dpt_guard_def *other_guard; /* its guard, as `guard`; NULL */
} dpt_loop_def;

/*
 * Bins of a histogram of times. Bin k counts times from 2^(k/4) us to 2^((k+1)/4) us. The first bin also counts shorter
 * ones, the last bin also longer ones.
 */
#define DPT_LOOP_BINS 64

/* What the system did not permit: bits of dpt_loop_stats.notes. */
enum {
    DPT_LOOP_NOTE_NO_PRIORITY = 1, /* the thread's scheduling stayed as it was */
    DPT_LOOP_NOTE_NO_LOCK = 2,     /* memory may be paged out */
    DPT_LOOP_NOTE_NO_RETURN = 4,   /* the thread kept the loop's priority or processor */
    DPT_LOOP_NOTE_NO_CPU = 8,      /* the thread ran on any processor */
    DPT_LOOP_NOTE_NO_AWAKE = 16    /* processors may have slept */
};

/* What happened in a run. Each tick is in exactly one of `fresh`, `failed`, `stale`, `not_ready` and `lost`. */
typedef struct dpt_loop_stats {
    uint32_t size;      /* sizeof(dpt_loop_stats), set by the caller */
    uint32_t notes;     /* DPT_LOOP_NOTE_... */
    uint64_t ticks;     /* all ticks */
    uint64_t fresh;     /* ticks with a fresh sample of a ready device, and a command for it */
    uint64_t failed;    /* ticks with such a sample, but the host's function gave no command */
    uint64_t stale;     /* ticks without a fresh sample */
    uint64_t not_ready; /* ticks whose sample is of an unready device, or has no valid pose */
    uint64_t lost;      /* ticks while the device was lost */
    uint64_t skipped;   /* samples that were never seen */
    uint64_t reordered; /* samples older than one seen before; their ticks are in `stale` */
    uint64_t sent;      /* commands that the device took */
    uint64_t refused;   /* commands that the device did not take */
    uint64_t missed;    /* deadlines that passed during a tick or during sleep */
    uint64_t losses;    /* how often the device was lost */
    uint64_t reopened;  /* how often it came back */
    uint64_t stops;     /* from here to `not_finite`: the guard's counts, see dpt_guard_info */
    uint64_t clamped;
    uint64_t slewed;
    uint64_t not_finite;
    double late_max;              /* longest time from a deadline to its tick, s */
    double took_max;              /* longest time that a tick took, s */
    uint64_t late[DPT_LOOP_BINS]; /* histogram of the times from deadline to tick */
    uint64_t took[DPT_LOOP_BINS]; /* histogram of the times that ticks took */
} dpt_loop_stats;

typedef struct dpt_loop dpt_loop;

/* Fill in the first `size` bytes; what dpt_loop_def_init calls with its own caller's sizeof. */
DPT_API void dpt_loop_def_defaults(dpt_loop_def *def, size_t size);

static inline void dpt_loop_def_init(dpt_loop_def *def)
{
    dpt_loop_def_defaults(def, sizeof *def);
}

/*
 * Create a loop for an open device. The device stays the caller's and must outlive the loop. The guard limits force and
 * torque to the smaller of its def's and the device's maxima. A second device is served in the same ticks, each with a
 * guard of its own; the first one's samples set the pace.
 *
 * DPT_E_ARGUMENT: a value is out of range; or the two devices are one, or only one is deterministic; or a guard's `hold`
 * is shorter than a period, so that a command would end before the next tick.
 */
DPT_API dpt_result dpt_loop_open(dpt_device *device, const dpt_loop_def *def, dpt_loop **loop);

/*
 * Serve the device in this thread, at absolute deadlines: read, tick, guard, write. Returns after `ticks`, after
 * dpt_loop_stop, or when the device is lost (unless `reopen` is 1). At the end it sends zero force and restores the
 * thread's scheduling and timer slack.
 *   stats   may be NULL; with two devices an array of two, the first one's size being their distance. What is counted of
 *           the loop is in the first: `notes`, `missed`, `late` and `took`
 *
 * A deterministic device has a time of its own. The loop then does not wait, leaves thread and memory as they are, and
 * is never late. If the machine was suspended during the run, the guard starts again with its ramp (Linux).
 *
 * Locked memory: the lock covers the whole process (mlockall). The loop locks only if RLIMIT_MEMLOCK is unlimited or
 * the process is privileged (CAP_IPC_LOCK). Under a finite limit a lock would keep the host from creating threads and
 * allocating memory, so nothing is locked and the notes have DPT_LOOP_NOTE_NO_LOCK. When the last of several loops
 * ends, it unlocks the process (munlockall), including what the host locked meanwhile. It does not unlock if the host
 * had locked memory before the first loop, or if the system does not tell (systems other than Linux).
 *
 * Processors that sleep deeply need up to some hundred microseconds to wake. `awake` holds /dev/cpu_dma_latency at 0 for
 * the time of the run, which needs the right to write it and costs power.
 *
 * DPT_E_LOST: the device was lost. DPT_E_SYSTEM: there is no usable clock. Otherwise the device's answer to the last
 * command, that of zero force.
 */
DPT_API dpt_result dpt_loop_run(dpt_loop *loop, dpt_loop_stats *stats);

/*
 * End the present run, or the next one if none is running. May be called from any thread and from a signal handler.
 */
DPT_API void dpt_loop_stop(dpt_loop *loop);

/* Close a loop that is not running. NULL is allowed. The device stays open. */
DPT_API void dpt_loop_close(dpt_loop *loop);

/*
 * A quantile of a histogram: the time in s that `fraction` (0..1) of the counted times do not exceed, rounded up to the
 * end of a bin. 0 for an empty histogram or a bad argument.
 *   bins   DPT_LOOP_BINS counts
 */
DPT_API double dpt_loop_quantile(const uint64_t *bins, double fraction);

DPT_END

#endif
