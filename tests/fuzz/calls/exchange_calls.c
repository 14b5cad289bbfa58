/* SPDX-License-Identifier: BSD-3-Clause */
/* The exchange of the latest value, by one thread: both calls in any order. */
#include "fuzz/calls/calls.h"

static dpt_latest latest;
static uint64_t places[DPT_LATEST_PLACES], written, taken;

static void begin(void)
{
    CALL(dpt_latest_init, &latest);
    memset(places, 0, sizeof places);
    written = taken = 0;
}

static void begin_anew(void)
{
    if (draw_one_in(4)) {
        CALL(dpt_latest_init, NULL);
        CALL(dpt_latest_publish, NULL);
        HOLDS(CALL(dpt_latest_take, NULL) == 0, "something from nowhere");
    }
    begin();
}

static void places_must_be_shared_out(void)
{
    HOLDS(latest.writing < DPT_LATEST_PLACES && latest.reading < DPT_LATEST_PLACES && latest.writing != latest.reading,
          "the writer has place %u, the reader %u", latest.writing, latest.reading);
}

static void publish(void)
{
    const uint32_t reading = latest.reading;
    places_must_be_shared_out();
    places[latest.writing] = ++written;
    CALL(dpt_latest_publish, &latest);
    HOLDS(latest.reading == reading, "the reader's place became %u", latest.reading);
    places_must_be_shared_out();
}

static void take(void)
{
    const uint32_t writing = latest.writing, reading = latest.reading;
    const int is_new = CALL(dpt_latest_take, &latest);
    HOLDS(is_new == (written > taken), "%d, after %llu of %llu", is_new, (unsigned long long)taken,
          (unsigned long long)written);
    HOLDS(latest.writing == writing && (is_new || latest.reading == reading), "places became %u and %u", latest.writing,
          latest.reading);
    HOLDS(!written || places[latest.reading] == written, "%llu, and not %llu",
          (unsigned long long)places[latest.reading], (unsigned long long)written);
    places_must_be_shared_out();
    taken = written;
}

static const struct move moves[] = {
    { "begin anew", begin_anew, 1 }, { "publish", publish, 4 }, { "take", take, 4 }, { NULL, NULL, 0 }
};

const struct noun exchange_noun = { "exchange", begin, NULL, moves };
