/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The work meter of a tick, one for all stages. A unit is one block of 16 lanes, or a step that costs as much;
 * docs/algorithms/budget.md lists them. Work is counted where it is done; a stage that may stop checks what is left.
 */
#ifndef DPT_WORK_H
#define DPT_WORK_H

#include <stdint.h>

/* A limit that is never reached. */
#define WORK_UNLIMITED UINT32_MAX

struct work {
    uint32_t done;  /* units */
    uint32_t limit; /* units */
};

/* A meter that allows `units`. */
static inline struct work work_of(uint32_t units)
{
    return (struct work){ 0, units };
}

/* Units that are left. `done` may exceed the limit, by work that cannot be divided. */
static inline uint32_t work_left(const struct work *work)
{
    return work->done < work->limit ? work->limit - work->done : 0;
}

static inline int work_is_spent(const struct work *work)
{
    return work->done >= work->limit;
}

/* Allow no more than `units` from now on, where more were left. */
static inline void work_limit_to(struct work *work, uint32_t units)
{
    if (work_left(work) > units)
        work->limit = work->done + units;
}

static inline void work_spend(struct work *work, uint32_t units)
{
    work->done += units;
}

/* Units that a search may count on after it has looked at what is left: four for each level of a tree. */
enum { WORK_COUNTED_ON = 32 };

/* Spend units that came in between, or as many as leave a search what it counts on. */
static inline void work_spend_between(struct work *work, uint32_t units)
{
    const uint32_t left = work_left(work);
    const uint32_t max = left > WORK_COUNTED_ON ? left - WORK_COUNTED_ON : 0;
    work->done += units < max ? units : max;
}

#endif
