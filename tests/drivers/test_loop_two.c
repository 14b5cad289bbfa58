/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Two devices in one loop: each is served as if it were alone, with a guard and counts of its own. Oracle: the same device
 * in a loop of its own, whose wrenches and samples must be the same bits.
 */
#include <math.h>

#include "drivers/open_device.h"

enum { TICKS = 3000, DEVICES = 2 };

static const char *const names[DEVICES] = {
    "sim:?hand=press&reach=0.02&cycle=1&loss=0.1&double=0.05&seed=3",
    "sim:?hand=wipe&reach=0.01&cycle=2&mass=0.2&damping=2&delay=1&loss=0.2&seed=9"
};

/* A digest of all that a host sees of a device. */
struct seen {
    uint64_t digest, samples, blank;
};

struct host {
    struct seen seen[DEVICES];
    double stiffness[DEVICES];
    int first; /* which device is the loop's first */
};

static void digest(struct seen *seen, const void *bytes, size_t size)
{
    for (size_t i = 0; i < size; i++)
        seen->digest = (seen->digest ^ ((const unsigned char *)bytes)[i]) * 0x100000001b3u;
}

/* A wall at y = 0, from below. */
static void serve(struct host *host, int index, const dpt_loop_sample *sample, dpt_wrench *wrench)
{
    struct seen *seen = &host->seen[index];
    const double y = sample->state->pose.position[1];
    if (sample->dt == 0) {
        seen->blank++;
        wrench->force[0] = 3; /* it must not be used */
        return;
    }
    seen->samples++;
    digest(seen, &sample->state->sequence, sizeof sample->state->sequence);
    digest(seen, &sample->state->pose, sizeof sample->state->pose);
    digest(seen, &sample->dt, sizeof sample->dt);
    digest(seen, &sample->sent, sizeof sample->sent);
    digest(seen, &sample->commands, sizeof sample->commands);
    wrench->force[1] = y < 0 ? -host->stiffness[index] * y : 0;
}

static dpt_result answer(void *user, const dpt_loop_sample *sample, dpt_wrench *wrench)
{
    struct host *host = user;
    serve(host, host->first, sample, &wrench[0]);
    if (sample->other) {
        CHECK(!sample->other->other, "the other's other");
        serve(host, 1 - host->first, sample->other, &wrench[1]);
    }
    return DPT_OK;
}

static dpt_loop_def def_of(struct host *host)
{
    dpt_loop_def def;
    dpt_loop_def_init(&def);
    def.tick = answer;
    def.user = host;
    def.ticks = TICKS;
    return def;
}

static dpt_guard_def guard_of(double force_max)
{
    dpt_guard_def guard;
    dpt_guard_def_init(&guard);
    guard.force_max = force_max;
    return guard;
}

static const double limits[DEVICES] = { 1.5, 3 };

static struct host new_host(int first)
{
    return (struct host){ .stiffness = { 400, 700 }, .first = first };
}

static void run_alone(int index, struct seen *seen, dpt_loop_stats *stats)
{
    struct host host = new_host(index);
    dpt_device *device = device_named("%s", names[index]);
    const dpt_guard_def guard = guard_of(limits[index]);
    dpt_loop_def def = def_of(&host);
    dpt_loop *loop;
    def.guard = &guard;
    stats->size = sizeof *stats;
    CHECK(dpt_loop_open(device, &def, &loop) == DPT_OK, "create");
    CHECK(dpt_loop_run(loop, stats) == DPT_OK, "run");
    dpt_loop_close(loop);
    dpt_device_close(device);
    *seen = host.seen[index];
}

static void check_counts(const dpt_loop_stats *is, const dpt_loop_stats *alone, int index)
{
    CHECK(is->ticks == alone->ticks && is->fresh == alone->fresh && is->stale == alone->stale &&
              is->skipped == alone->skipped && is->reordered == alone->reordered && is->sent == alone->sent &&
              is->refused == alone->refused && is->clamped == alone->clamped && is->slewed == alone->slewed &&
              is->stops == alone->stops && is->failed == alone->failed,
          "device %d: %u fresh, %u stale, %u clamped; alone %u, %u, %u", index, (unsigned)is->fresh,
          (unsigned)is->stale, (unsigned)is->clamped, (unsigned)alone->fresh, (unsigned)alone->stale,
          (unsigned)alone->clamped);
}

static void each_is_served_as_if_it_were_alone(void)
{
    struct seen seen[DEVICES] = { { 0 } };
    dpt_loop_stats alone[DEVICES];
    for (int i = 0; i < DEVICES; i++)
        run_alone(i, &seen[i], &alone[i]);
    for (int first = 0; first < DEVICES; first++) {
        struct host host = new_host(first);
        const int second = 1 - first;
        dpt_device *devices[] = { device_named("%s", names[first]), device_named("%s", names[second]) };
        const dpt_guard_def guard = guard_of(limits[first]), other = guard_of(limits[second]);
        dpt_loop_stats stats[DEVICES] = { { .size = sizeof *stats } };
        dpt_loop_def def = def_of(&host);
        dpt_loop *loop;
        def.guard = &guard;
        def.other = devices[1];
        def.other_guard = &other;
        CHECK(dpt_loop_open(devices[0], &def, &loop) == DPT_OK, "create");
        CHECK(dpt_loop_run(loop, stats) == DPT_OK, "run");
        for (int i = 0; i < DEVICES; i++) {
            const int index = i ? second : first;
            CHECK(host.seen[index].digest == seen[index].digest && host.seen[index].samples == seen[index].samples,
                  "device %d of %d: %u samples, alone %u", index, first, (unsigned)host.seen[index].samples,
                  (unsigned)seen[index].samples);
            CHECK(host.seen[index].blank > 100, "device %d is never without a sample", index);
            check_counts(&stats[i], &alone[index], index);
            dpt_device_close(devices[i]);
        }
        dpt_loop_close(loop);
    }
    CHECK(alone[0].clamped > 100 && alone[0].fresh > 2000, "%u clamped, %u fresh", (unsigned)alone[0].clamped,
          (unsigned)alone[0].fresh);
}

/* The second is unplugged after half a second. */
static void one_that_is_lost(void)
{
    for (uint32_t reopen = 0; reopen < 2; reopen++) {
        struct host host = new_host(0);
        dpt_device *first = device_named("sim:?hand=press&cycle=1"),
                   *second = device_named("sim:?hand=press&cycle=1&fault=unplugged@0.5");
        dpt_loop_stats stats[DEVICES] = { { .size = sizeof *stats } };
        dpt_loop_def def = def_of(&host);
        dpt_loop *loop;
        def.other = second;
        def.reopen = reopen;
        CHECK(dpt_loop_open(first, &def, &loop) == DPT_OK, "create");
        const dpt_result result = dpt_loop_run(loop, stats);
        if (reopen) {
            CHECK(result == DPT_OK && stats[0].ticks == TICKS && stats[0].fresh == TICKS, "%s, %u ticks",
                  dpt_result_name(result), (unsigned)stats[0].fresh);
            CHECK(stats[1].losses == 1 && stats[1].reopened == 1 && stats[1].lost > 900 && stats[1].fresh > 1000,
                  "lost for %u ticks, back %u times", (unsigned)stats[1].lost, (unsigned)stats[1].reopened);
        } else {
            CHECK(result == DPT_E_LOST && stats[1].lost == 1 && stats[0].ticks < 510, "%s, %u ticks",
                  dpt_result_name(result), (unsigned)stats[0].ticks);
        }
        dpt_loop_close(loop);
        dpt_device_close(first);
        dpt_device_close(second);
    }
}

static void pairs_that_are_none_are_refused(void)
{
    struct host host = new_host(0);
    dpt_device *first = device_named("sim:"), *second = device_named("sim:?live=1");
    dpt_guard_def guard = guard_of(2);
    dpt_loop *loop;
    dpt_loop_def def = def_of(&host);
    def.other = first;
    CHECK(dpt_loop_open(first, &def, &loop) == DPT_E_ARGUMENT && !loop, "one device twice");
    def.other = second;
    CHECK(dpt_loop_open(first, &def, &loop) == DPT_E_ARGUMENT, "two kinds of time");
    def.other = NULL;
    def.other_guard = &guard;
    CHECK(dpt_loop_open(first, &def, &loop) == DPT_E_ARGUMENT, "a guard of no device");
    dpt_device_close(second);
    second = device_named("sim:");
    def.other = second;
    guard.hold = 1e-4;
    CHECK(dpt_loop_open(first, &def, &loop) == DPT_E_ARGUMENT, "commands that hold too shortly");
    guard = guard_of(2);
    CHECK(dpt_loop_open(first, &def, &loop) == DPT_OK, "a pair");
    dpt_loop_stats stats[DEVICES] = { { .size = sizeof *stats + 4 } };
    CHECK(dpt_loop_run(loop, stats) == DPT_E_SIZE, "stats that are not aligned");
    dpt_loop_close(loop);
    dpt_device_close(first);
    dpt_device_close(second);
}

/* By the clock: both get force, and the loop is late for neither. */
static void two_that_live(void)
{
    struct host host = new_host(0);
    dpt_device *first = device_named("sim:?live=1&hand=press&cycle=0.5"),
               *second = device_named("sim:?live=1&hand=press&cycle=0.5&rate=500");
    dpt_loop_stats stats[DEVICES] = { { .size = sizeof *stats } };
    dpt_loop_def def = def_of(&host);
    dpt_loop *loop;
    def.ticks = 600;
    def.other = second;
    CHECK(dpt_loop_open(first, &def, &loop) == DPT_OK, "create");
    CHECK(dpt_loop_run(loop, stats) == DPT_OK, "run");
    CHECK(stats[0].fresh > 0 && stats[1].fresh > 0 && stats[1].stale > stats[1].fresh / 4, "%u and %u fresh, %u stale",
          (unsigned)stats[0].fresh, (unsigned)stats[1].fresh, (unsigned)stats[1].stale);
    CHECK(stats[1].sent == stats[1].ticks && stats[1].missed == 0, "%u sent", (unsigned)stats[1].sent);
    dpt_loop_close(loop);
    dpt_device_close(first);
    dpt_device_close(second);
}

int main(void)
{
    TEST(each_is_served_as_if_it_were_alone);
    TEST(one_that_is_lost);
    TEST(pairs_that_are_none_are_refused);
    TEST(two_that_live);
    return check_report();
}
