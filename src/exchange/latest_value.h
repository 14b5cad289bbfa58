/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The latest value from one thread to another. Neither waits for the other, and none sees half of a value: of three places
 * one is the writer's, one the reader's, and the third changes hands in one exchange. Values that are not fetched in
 * time are written over.
 *
 *     writer: places[latest.writing] = value; latest_hand(&latest);
 *     reader: if (latest_take(&latest)) { places[latest.reading] is new }
 */
#ifndef DPT_LATEST_VALUE_H
#define DPT_LATEST_VALUE_H

#include <stdint.h>

enum { LATEST_PLACES = 3, LATEST_NEW = 4 };

struct latest {
    uint32_t writing, between, reading;
};

static inline void latest_init(struct latest *latest)
{
    latest->writing = 0;
    latest->between = 1;
    latest->reading = 2;
}

static inline void latest_hand(struct latest *latest)
{
    latest->writing =
        __atomic_exchange_n(&latest->between, latest->writing | LATEST_NEW, __ATOMIC_ACQ_REL) &
        ~(uint32_t)LATEST_NEW;
}

/* 1 when there is one that was not taken before. */
static inline int latest_take(struct latest *latest)
{
    if (!(__atomic_load_n(&latest->between, __ATOMIC_RELAXED) & LATEST_NEW))
        return 0;
    latest->reading = __atomic_exchange_n(&latest->between, latest->reading, __ATOMIC_ACQ_REL) &
                      ~(uint32_t)LATEST_NEW;
    return 1;
}

#endif
