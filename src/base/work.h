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

static inline void work_spend(struct work *work, uint32_t units)
{
    work->done += units;
}

/* Spend units, or what is left. */
static inline void work_spend_left(struct work *work, uint32_t units)
{
    const uint32_t left = work_left(work);
    work->done += units < left ? units : left;
}

#endif
