/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * For tests of the servo loop: a driver of the test's own, from outside of the library, between the loop and a simulated
 * device. It loses, repeats, reorders and refuses by a seeded plan, and counts what it did. And a host that counts what the
 * loop tells it.
 */
#ifndef DPT_TESTS_LOOP_FIXTURE_H
#define DPT_TESTS_LOOP_FIXTURE_H

#include <math.h>
#include <time.h>

#include "drivers/open_device.h"
#include "dynpoint/driver.h"

/* What can be done to a read or a write. */
enum trouble { NONE, REPEAT, SKIP, OLD, ERROR, UNPLUG, FAULT, BAD_POSE, BUSY, TROUBLES };

struct flaky {
    dpt_device device;
    dpt_device *inner;
    uint64_t random;
    double share; /* of each trouble */
    int is_out;   /* unplugged */
    dpt_device_state last;
    uint64_t did[TROUBLES], skipped, losses, cleared, writes;
    double strongest;
    dpt_wrench written;
    dpt_wrench acts;            /* what it gives: the last that it took; nothing while it is not ready */
    uint64_t taken, taken_ns;   /* how many it took; the time of the sample before the last one */
    int is_off;                 /* the last read said so */
    uint64_t first_ns, last_ns; /* of writes, by the clock */
};

static inline uint64_t clock_ns(void)
{
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (uint64_t)time.tv_sec * 1000000000u + (uint64_t)time.tv_nsec;
}

static inline void rest(double seconds)
{
    struct timespec time = { (time_t)seconds, (long)(1e9 * (seconds - floor(seconds))) };
    while (nanosleep(&time, &time) != 0)
        continue;
}

static inline dpt_result flaky_open(const dpt_driver *driver, const char *where, dpt_device **device,
                                    dpt_device_error *error)
{
    (void)driver;
    struct flaky *flaky = calloc(1, sizeof *flaky);
    dpt_result result = dpt_device_open(where, &flaky->inner, error);
    if (result != DPT_OK) {
        free(flaky);
        return result;
    }
    flaky->last.size = sizeof flaky->last;
    *device = &flaky->device;
    return DPT_OK;
}

static inline void flaky_info(const dpt_device *device, dpt_device_info *info)
{
    dpt_device_get_info(((const struct flaky *)device)->inner, info);
}

static inline enum trouble next_trouble(struct flaky *flaky)
{
    double dice = random_in(&flaky->random, 0.0, 1.0);
    for (int trouble = REPEAT; trouble < BUSY; trouble++, dice -= flaky->share)
        if (dice < flaky->share)
            return (enum trouble)trouble;
    return NONE;
}

static inline void stop_acting(struct flaky *flaky)
{
    static const dpt_wrench zero;
    flaky->acts = zero;
    flaky->taken_ns = 0;
}

static inline dpt_result read_in_trouble(struct flaky *flaky, dpt_device_state *state)
{
    enum trouble trouble = flaky->last.sequence ? next_trouble(flaky) : NONE;
    if (flaky->is_out)
        trouble = UNPLUG;
    else if (trouble == UNPLUG)
        flaky->losses++;
    flaky->did[trouble]++;
    if (trouble == UNPLUG || trouble == ERROR) {
        flaky->is_out = trouble == UNPLUG;
        *state = flaky->last;
        return trouble == UNPLUG ? DPT_E_LOST : DPT_E_SYSTEM;
    }
    if (trouble == REPEAT || trouble == OLD) {
        *state = flaky->last;
        state->fresh = trouble == OLD;
        state->sequence -= trouble == OLD && flaky->did[OLD] % 2;
        return DPT_OK;
    }
    dpt_result result = DPT_OK;
    for (int i = 0; i < (trouble == SKIP ? 3 : 1); i++)
        result = dpt_device_read(flaky->inner, state);
    flaky->skipped += trouble == SKIP ? 2 : 0;
    flaky->last = *state;
    if (trouble == FAULT)
        state->status = flaky->did[FAULT] % 2 ? DPT_DEVICE_STATUS_FAULT : DPT_DEVICE_STATUS_UNREADY;
    if (trouble == BAD_POSE)
        state->pose.orientation[flaky->did[BAD_POSE] % 4] = flaky->did[BAD_POSE] % 8 < 4 ? NAN : 2.0;
    return result;
}

/* What is not ready has stopped by itself: its next sample is of a time without force. */
static inline dpt_result flaky_read(dpt_device *device, dpt_device_state *state)
{
    struct flaky *flaky = (struct flaky *)device;
    if (flaky->is_off)
        stop_acting(flaky);
    const dpt_result result = read_in_trouble(flaky, state);
    flaky->is_off = result == DPT_E_LOST || state->status != DPT_DEVICE_STATUS_READY;
    return result;
}

static inline dpt_result flaky_write(dpt_device *device, const dpt_wrench *wrench)
{
    struct flaky *flaky = (struct flaky *)device;
    flaky->writes++;
    flaky->last_ns = clock_ns();
    flaky->first_ns = flaky->first_ns ? flaky->first_ns : flaky->last_ns;
    if (flaky->share > 0.0 && random_in(&flaky->random, 0.0, 1.0) < flaky->share) {
        static const dpt_result refusals[] = { DPT_E_BUSY, DPT_E_SYSTEM, DPT_E_NOT_READY };
        const dpt_result refusal = refusals[flaky->did[BUSY]++ % 3];
        if (refusal == DPT_E_NOT_READY)
            stop_acting(flaky);
        return refusal;
    }
    flaky->written = *wrench;
    flaky->strongest = fmax(flaky->strongest, wrench->force[0]);
    const dpt_result result = dpt_device_write(flaky->inner, wrench);
    if (result != DPT_OK)
        return result;
    flaky->acts = *wrench;
    flaky->taken++;
    flaky->taken_ns = flaky->last.time_ns;
    return DPT_OK;
}

static inline dpt_result flaky_clear(dpt_device *device)
{
    struct flaky *flaky = (struct flaky *)device;
    flaky->cleared++;
    flaky->is_out = 0;
    return dpt_device_clear(flaky->inner);
}

static inline void flaky_counts(const dpt_device *device, dpt_device_counts *counts)
{
    dpt_device_get_counts(((const struct flaky *)device)->inner, counts);
}

static inline void flaky_close(dpt_device *device)
{
    dpt_device_close(((struct flaky *)device)->inner);
    free(device);
}

static const dpt_driver flaky_driver = {
    sizeof(dpt_driver), DPT_DRIVER_VERSION, "flaky",      "a bad line", flaky_open, flaky_info, flaky_read,
    flaky_write,        flaky_clear,        flaky_counts, flaky_close,  NULL,       NULL,       NULL
};

static inline struct flaky *flaky_over(const char *name)
{
    dpt_device *device = NULL;
    CHECK(dpt_device_open_with(&flaky_driver, name, &device, NULL) == DPT_OK, "%s", name);
    return (struct flaky *)device;
}

/* A host that numbers its commands, and looks at what the loop tells it. */
struct host {
    struct flaky *flaky;
    uint64_t ticks, commands, failures, nans, not_ready, wrong_dt, not_zero;
    uint64_t wrong_sent, wrong_count, acted, kept, several, off; /* of what it is told was sent */
    uint64_t seen_ns, seen_taken, seen_sequence;
    uint64_t idle, idle_lost, idle_wrong; /* ticks without a sample for the host */
    double late_max;                      /* that it was told of, s */
    double force;
    double slow; /* s that every 50th tick takes longer */
    dpt_loop *loop;
    uint64_t stop_at;
};

/* What the loop says was sent is what the device has, and no other. */
static inline void compare_sent(struct host *host, const dpt_loop_sample *sample)
{
    static const dpt_wrench zero;
    const struct flaky *flaky = host->flaky;
    host->wrong_sent += memcmp(&sample->sent, &flaky->acts, sizeof flaky->acts) != 0;
    if (sample->info->flags & DPT_DEVICE_FLAG_DETERMINISTIC)
        host->wrong_sent += sample->sent_ns != flaky->taken_ns;
    host->wrong_count += sample->commands != flaky->taken - host->seen_taken;
    host->acted += memcmp(&sample->sent, &zero, sizeof zero) != 0;
    host->kept += sample->commands == 0 && memcmp(&sample->sent, &zero, sizeof zero) != 0;
    host->several += sample->commands > 1;
    host->off += sample->commands > 0 && memcmp(&sample->sent, &zero, sizeof zero) == 0;
    host->seen_taken = flaky->taken;
}

static inline dpt_result feel(void *user, const dpt_loop_sample *sample, dpt_wrench *wrench)
{
    struct host *host = user;
    const dpt_device_state *state = sample->state;
    double passed = host->seen_ns ? (double)(state->time_ns - host->seen_ns) * 1e-9 : 0.001;
    host->wrong_dt += fabs(sample->dt - passed) > 1e-12;
    host->seen_ns = state->time_ns;
    host->ticks++;
    host->seen_sequence = state->sequence;
    host->late_max = fmax(host->late_max, sample->late);
    if (host->flaky)
        compare_sent(host, sample);
    if (host->slow > 0.0 && host->ticks % 50 == 0)
        rest(host->slow);
    if (host->stop_at && host->ticks == host->stop_at)
        dpt_loop_stop(host->loop);
    host->not_zero += wrench->force[0] != 0.0 || wrench->torque[2] != 0.0;
    host->not_ready += state->status != DPT_DEVICE_STATUS_READY;
    if (host->flaky && host->flaky->share > 0.0 && host->ticks % 97 == 0) {
        host->failures += state->status == DPT_DEVICE_STATUS_READY;
        wrench->force[0] = 1e3;
        return DPT_E_ARGUMENT;
    }
    host->commands += state->status == DPT_DEVICE_STATUS_READY;
    wrench->force[0] = host->force > 0.0 ? host->force : 1e-6 * (double)host->ticks;
    if (host->flaky && host->flaky->share > 0.0 && host->ticks % 89 == 0 && state->status == DPT_DEVICE_STATUS_READY) {
        host->nans++;
        wrench->torque[1] = NAN;
    }
    return DPT_OK;
}

/* Ticks without a sample: of those that are fresh the pose is wrong. */
static inline void rest_a_tick(void *user, const dpt_loop_sample *sample)
{
    struct host *host = user;
    const dpt_device_state *state = sample->state;
    host->idle++;
    host->idle_lost += state->status == DPT_DEVICE_STATUS_LOST;
    const double *q = state->pose.orientation;
    const double square = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
    host->idle_wrong += sample->size != sizeof *sample || sample->dt != 0.0 ||
                        (state->fresh && state->sequence > host->seen_sequence && fabs(square - 1.0) < 1e-9);
    if (state->fresh && state->sequence > host->seen_sequence)
        host->seen_sequence = state->sequence;
    host->late_max = fmax(host->late_max, sample->late);
}

static inline dpt_loop_def def_for(struct host *host)
{
    dpt_loop_def def;
    dpt_loop_def_init(&def);
    def.tick = feel;
    def.user = host;
    def.lock = 0;
    def.priority = 0;
    return def;
}

static inline dpt_guard_def guard_without_ramps(double force_max)
{
    dpt_guard_def def;
    dpt_guard_def_init(&def);
    def.force_max = force_max;
    def.force_slew = def.torque_slew = def.start = 0.0;
    return def;
}

static inline dpt_loop *loop_of(dpt_device *device, const dpt_loop_def *def)
{
    dpt_loop *loop = NULL;
    dpt_result result = dpt_loop_open(device, def, &loop);
    CHECK(result == DPT_OK, "%s", dpt_result_name(result));
    return loop;
}

static inline uint64_t sum_of(const uint64_t *bins)
{
    uint64_t sum = 0;
    for (int i = 0; i < DPT_LOOP_BINS; i++)
        sum += bins[i];
    return sum;
}

/* What must hold of every run. */
static inline void check_sums(const dpt_loop_stats *stats)
{
    CHECK(stats->fresh + stats->failed + stats->stale + stats->not_ready + stats->lost == stats->ticks,
          "of %d ticks %d fresh, %d failed, %d stale, %d not ready, %d lost", (int)stats->ticks, (int)stats->fresh,
          (int)stats->failed, (int)stats->stale, (int)stats->not_ready, (int)stats->lost);
}

#endif
