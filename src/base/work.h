/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The work of a tick, and how much of it is allowed: one meter for all stages. A unit is one block of 16 lanes that is
 * looked at, or a step that costs as much; docs/algorithms/budget.md says which. Work is spent where it is done; who
 * needs to stop asks what is left.
 */
#ifndef DPT_WORK_H
#define DPT_WORK_H

#include <stdint.h>

/* A limit that nothing reaches. */
#define WORK_UNLIMITED UINT32_MAX

struct work {
    uint32_t done;  /* units */
    uint32_t limit; /* of `done` */
};

/* `units` are allowed. */
static inline struct work work_of(uint32_t units)
{
    return (struct work){ 0, units };
}

/* What is done may go beyond the limit, by what is not divided. */
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

#endif
