/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * dpt_latest: the exchange of the latest value between a writer and a reader, in one thread and in two. Values are of
 * 4 kB, so that one that is torn shows. The first argument is how many values the writer publishes
 * at least; a twentieth of as many is taken.
 */
#include <pthread.h>
#include <sched.h>

#include "dynpoint/exchange.h"
#include "lib/check.h"
#include "lib/random.h"

enum { WORDS = 512, ORDERS = 20000 };

static dpt_latest latest;
static uint64_t places[DPT_LATEST_PLACES][WORDS], counted;
static unsigned long published_least = 1000000;
static int is_enough;

/* Three places, and each is somebody's. */
static int places_are_shared_out(void)
{
    const uint32_t writing = latest.writing, reading = latest.reading;
    return writing < DPT_LATEST_PLACES && reading < DPT_LATEST_PLACES && writing != reading;
}

static void write_value(uint64_t value)
{
    for (int i = 0; i < WORDS; i++)
        places[latest.writing][i] = value;
}

/* The rules of exchange.h, in any order of both calls. */
static void each_order_of_calls_gives_the_latest(void)
{
    uint64_t random = 1, written = 0, published = 0, taken = 0;
    dpt_latest_init(&latest);
    for (int i = 0; i < ORDERS; i++) {
        const int publishes = random_bits(&random) % 3 == 0;
        const uint32_t before = latest.reading;
        CHECK(places_are_shared_out(), "writing %u, reading %u", latest.writing, latest.reading);
        if (publishes) {
            write_value(++written);
            dpt_latest_publish(&latest);
            published = written;
            CHECK(latest.reading == before, "the reader's place became %u", latest.reading);
            continue;
        }
        CHECK(dpt_latest_take(&latest) == (published > taken), "%d published, %d taken", (int)published, (int)taken);
        CHECK(published > taken || latest.reading == before, "another place, and nothing new");
        CHECK(!published || places[latest.reading][0] == published, "%d, and not %d", (int)places[latest.reading][0],
              (int)published);
        taken = published;
    }
}

static void nothing_is_done_without_an_exchange(void)
{
    dpt_latest_init(NULL);
    dpt_latest_publish(NULL);
    CHECK(dpt_latest_take(NULL) == 0, "something from nowhere");
}

static void *count(void *unused)
{
    while (!__atomic_load_n(&is_enough, __ATOMIC_RELAXED)) {
        write_value(++counted);
        dpt_latest_publish(&latest);
        if (counted % 64 == 0)
            sched_yield();
    }
    return unused;
}

static void two_threads_see_whole_values_and_never_older_ones(void)
{
    pthread_t thread;
    uint64_t last = 0;
    dpt_latest_init(&latest);
    CHECK(!dpt_latest_take(&latest), "something before there is anything");
    const int has_begun = pthread_create(&thread, NULL, count, NULL) == 0;
    CHECK(has_begun, "no thread");
    for (unsigned long taken = 0; (taken < published_least / 20 || last < published_least) && has_begun;) {
        if (!dpt_latest_take(&latest)) {
            sched_yield();
            continue;
        }
        const uint64_t *value = places[latest.reading];
        taken++;
        CHECK(value[0] > last, "%d after %d", (int)value[0], (int)last);
        for (int i = 1; i < WORDS; i++)
            CHECK(value[i] == value[0], "torn: %d, %d", (int)value[0], (int)value[i]);
        last = value[0];
    }
    __atomic_store_n(&is_enough, 1, __ATOMIC_RELAXED);
    if (has_begun)
        pthread_join(thread, NULL);
    CHECK(dpt_latest_take(&latest) == (last != counted) && places[latest.reading][0] == counted,
          "the last is not the last");
    CHECK(!dpt_latest_take(&latest), "something after the last");
}

int main(int argc, char **argv)
{
    uint64_t unused;
    take_count(argc, argv, &published_least, &unused);
    TEST(each_order_of_calls_gives_the_latest);
    TEST(nothing_is_done_without_an_exchange);
    TEST(two_threads_see_whole_values_and_never_older_ones);
    return check_report();
}
