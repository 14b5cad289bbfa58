/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What a loop requests from the system while it runs: real-time priority, a processor that is awake, exact timers, locked
 * memory.
 */
#ifndef DPT_PLATFORM_URGENT_H
#define DPT_PLATFORM_URGENT_H

#include <stdint.h>

/* What urgent_begin changed, and the values before. */
struct urgent {
    int holds_lock;          /* 1: this loop is counted among those that hold the lock */
    int slack;               /* timer slack of the thread before, ns; 0: not changed */
    int is_scheduled;        /* 1: policy and priority were changed */
    int policy, priority;    /* of the thread before */
    int is_pinned;           /* 1: the processors of the thread were changed */
    int latency;             /* what keeps processors awake while it is open; -1: nothing */
    uint64_t processors[16]; /* of the thread before: room for a cpu_set_t */
};

/*
 * Request all of it for the calling thread. Returns what was not permitted, DPT_LOOP_NOTE_... bits.
 *   priority   by SCHED_FIFO or what the system has of its kind, 1..99; 0: unchanged
 *   lock       1: lock the memory of the whole process
 *   cpu        the only processor to run on, from 1; 0: any
 *   awake      1: keep processors awake
 */
uint32_t urgent_begin(struct urgent *saved, uint32_t priority, uint32_t lock, uint32_t cpu, uint32_t awake);

/*
 * Undo it, in the same thread. The last loop unlocks the memory, if none was locked before the first loop. Returns
 * DPT_LOOP_NOTE_NO_RETURN if the priority could not be restored, else 0.
 */
uint32_t urgent_end(const struct urgent *saved);

#endif
