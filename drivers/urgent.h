/* SPDX-License-Identifier: BSD-3-Clause */
/* What a loop asks of the system while it runs: priority, wakes without slack, memory that is not paged out. */
#ifndef DPT_DRIVERS_URGENT_H
#define DPT_DRIVERS_URGENT_H

#include <sched.h>
#include <stdint.h>

/* How the calling thread was before. */
struct urgent {
    int holds_lock;
    int slack; /* of its timers, ns; 0: not changed */
    int is_scheduled;
    int policy;
    struct sched_param param;
};

/*
 * Ask for all of it, in the calling thread. Returns what was not permitted, as DPT_LOOP_...
 *   priority  by SCHED_FIFO; 0: as it is
 *   lock      1: lock the memory of the whole process
 */
uint32_t urgent_begin(struct urgent *saved, uint32_t priority, uint32_t lock);

/* Undo it, in the same thread. Memory is unlocked by the last loop, if nothing was locked before the first. */
uint32_t urgent_end(const struct urgent *saved);

#endif
