/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * An exchange of the latest value between two threads, one writer and one reader: new vertices from physics to the
 * haptic loop, loads the other way. Neither thread waits, and neither sees half a value. You supply three places for
 * values, of any type. A value that is not taken in time is overwritten.
 *
 *     static float places[DPT_LATEST_PLACES][3 * VERTICES];
 *     dpt_latest latest;
 *     dpt_latest_init(&latest);                           before both threads begin
 *
 *     writer:  fill places[latest.writing]; dpt_latest_publish(&latest);
 *     reader:  if (dpt_latest_take(&latest))
 *                  read places[latest.reading];
 *
 * Threads: publish is the writer's, take the reader's; `writing` is read by the writer alone, `reading` by the reader.
 */
#ifndef DYNPOINT_EXCHANGE_H
#define DYNPOINT_EXCHANGE_H

#include "dynpoint/result.h"

DPT_BEGIN

enum { DPT_LATEST_PLACES = 3 };

/* Which of the three places is whose. This struct never changes. */
typedef struct dpt_latest {
    uint32_t writing; /* the place that the writer fills */
    uint32_t between; /* the library's own */
    uint32_t reading; /* the place that the reader has taken last */
} dpt_latest;

/* Begin: nothing has been published. */
DPT_API void dpt_latest_init(dpt_latest *latest);

/* Hand over places[latest->writing]. The writer gets another place, of which the content is an older value. */
DPT_API void dpt_latest_publish(dpt_latest *latest);

/* 1 if a value was published since the last call: it is in places[latest->reading] now. 0 if none was. */
DPT_API int dpt_latest_take(dpt_latest *latest);

DPT_END

#endif
