/* SPDX-License-Identifier: BSD-3-Clause */
/* What a loop requests from the system while it runs: real-time priority, exact timers, locked memory. */
#ifndef DPT_DRIVERS_URGENT_H
#define DPT_DRIVERS_URGENT_H

#include <sched.h>
#include <stdint.h>

/* What urgent_begin changed, and the values before. */
struct urgent {
    int holds_lock;           /* 1: this loop is counted among those that hold the lock */
    int slack;                /* timer slack of the thread before, ns; 0: not changed */
    int is_scheduled;         /* 1: policy and param were changed */
    int policy;               /* of the thread before */
    struct sched_param param; /* of the thread before */
};

/*
 * Request all of it for the calling thread. Returns what was not permitted, DPT_LOOP_NOTE_... bits.
 *   priority   by SCHED_FIFO, 1..99; 0: unchanged
 *   lock       1: lock the memory of the whole process
 */
uint32_t urgent_begin(struct urgent *saved, uint32_t priority, uint32_t lock);

/*
 * Undo it, in the same thread. The last loop unlocks the memory, if none was locked before the first loop. Returns
 * DPT_LOOP_NOTE_NO_RETURN if the priority could not be restored, else 0.
 */
uint32_t urgent_end(const struct urgent *saved);

#endif
