/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * An exchange of the latest value between two threads, one writer and one reader. Neither waits for the other, and
 * neither sees half a value. Of three places one is the writer's, one the reader's, and the third changes hands in
 * one atomic exchange. A value that is not taken in time is overwritten. docs/algorithms/exchange.md says why the memory
 * orders are these.
 *
 *     writer: places[latest.writing] = value; latest_value_publish(&latest);
 *     reader: if (latest_value_take(&latest)) { places[latest.reading] is new }
 */
#ifndef DPT_LATEST_VALUE_H
#define DPT_LATEST_VALUE_H

#include <stdint.h>

enum { LATEST_VALUE_PLACES = 3, LATEST_VALUE_NEW = 4 };

struct latest_value {
    uint32_t writing, between, reading;
};

/* Before both threads begin. */
static inline void latest_value_init(struct latest_value *latest)
{
    latest->writing = 0;
    latest->between = 1;
    latest->reading = 2;
}

/* By the writer: hand over places[writing]; `writing` is another place then. */
static inline void latest_value_publish(struct latest_value *latest)
{
    latest->writing = __atomic_exchange_n(&latest->between, latest->writing | LATEST_VALUE_NEW, __ATOMIC_ACQ_REL) &
                      ~(uint32_t)LATEST_VALUE_NEW;
}

/* By the reader: 1 if there is a new value, which is in places[reading] then; 0 if none came since the last call. */
static inline int latest_value_take(struct latest_value *latest)
{
    if (!(__atomic_load_n(&latest->between, __ATOMIC_RELAXED) & LATEST_VALUE_NEW))
        return 0;
    latest->reading =
        __atomic_exchange_n(&latest->between, latest->reading, __ATOMIC_ACQ_REL) & ~(uint32_t)LATEST_VALUE_NEW;
    return 1;
}

#endif
