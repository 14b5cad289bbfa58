/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What lies between the simulated device and its host: a delay in parts of a period, jitter, samples and commands that
 * are lost, samples that come twice. Moments and losses are compared with a generator of the test's own.
 */
#include <math.h>
#include <time.h>

#include "drivers/open_device.h"

/* u(p, i) of docs/back_ends.md, "sim". */
static double uniform(uint64_t seed, uint64_t period, uint64_t i)
{
    uint64_t z = seed + (4 * period + i + 1) * 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return ldexp((double)((z ^ (z >> 31)) >> 11), -53);
}

/* The first numbers of seed 1234567, which others publish for this generator. */
static void the_generator_is_the_published_one(void)
{
    static const uint64_t known[] = { 6457827717110365317u, 3203168211198807973u, 9817491932198370423u,
                                      4593380528125082431u, 16408922859458223821u };
    for (uint64_t n = 0; n < 5; n++)
        CHECK(uniform(1234567, n / 4, n % 4) == ldexp((double)(known[n] >> 11), -53), "number %d", (int)n);
}

static void a_delay_may_end_within_a_period(void)
{
    static const double delays[] = { 0.5, 0.25, 0.999, 1.5, 2.75, 7.3, 14.9, 15.0 };
    for (size_t d = 0; d < sizeof delays / sizeof *delays; d++) {
        dpt_device *device = device_named("sim:?mass=0.5&damping=0&rate=500&delay=%.17g", delays[d]);
        dpt_device_info info = { .size = sizeof info };
        CHECK(dpt_device_get_info(device, &info) == DPT_OK && info.delay == delays[d] / 500.0, "%g s", info.delay);
        for (int n = 0; n < 60; n++) {
            const dpt_device_state state = state_of(device);
            const double t = fmax(n - delays[d], 0.0) / 500.0;
            CHECK(fabs(state.velocity[2] - 4.0 * t) < 1e-15 && fabs(state.pose.position[2] - 2.0 * t * t) < 1e-16,
                  "delay %g, period %d: %g, not %g", delays[d], n, state.pose.position[2], 2.0 * t * t);
            write_force(device, 0.0, 0.0, 2.0);
        }
        dpt_device_close(device);
    }
}

/* A force that changes in each period tells by the velocity when it did. With half a period it goes into the next. */
static void jitter_delays_each_command_by_its_own_share(void)
{
    enum { PERIODS = 3000 };
    const double rate = 1000.0, jitter = 0.0009;
    static const double delays[] = { 0.0, 0.5, 2.5 };
    for (int d = 0; d < 3; d++) {
        dpt_device *device = device_named("sim:?mass=1&damping=0&jitter=%g&delay=%g&seed=77", jitter, delays[d]);
        double command[PERIODS], begins[PERIODS], sum = 0.0, squares = 0.0;
        uint64_t random = 3;
        double before = 0.0;
        for (int n = 0; n < PERIODS; n++) {
            const double v = state_of(device).velocity[0], end = n / rate, start = end - 1.0 / rate;
            double impulse = 0.0;
            for (int p = n > 5 ? n - 5 : 0; p < n; p++) {
                const double until = p + 1 < n ? fmin(begins[p + 1], end) : end;
                impulse += command[p] * fmax(0.0, until - fmax(begins[p], start));
            }
            CHECK(fabs(v - before - impulse) < 1e-12, "delay %g, period %d: %g, not %g", delays[d], n, v - before,
                  impulse);
            before = v;
            command[n] = random_in(&random, -5.0, 5.0);
            const double share = uniform(77, (uint64_t)n, 0);
            begins[n] = (n + delays[d]) / rate + jitter * share;
            sum += share;
            squares += share * share;
            write_force(device, command[n], 0.0, 0.0);
        }
        sum /= PERIODS;
        squares = squares / PERIODS - sum * sum;
        CHECK(fabs(sum - 0.5) < 0.03 && fabs(squares - 1.0 / 12.0) < 0.01, "mean %g, variance %g: not uniform", sum,
              squares);
        dpt_device_close(device);
    }
}

static int is_about(int seen, int of, double probability)
{
    return fabs(seen - of * probability) <= 5.0 * sqrt(of * probability * (1.0 - probability)) + 1.0;
}

static void samples_and_commands_are_lost(void)
{
    enum { PERIODS = 4000 };
    const double loss = 0.15;
    dpt_device *device = device_named("sim:?mass=1&damping=0&loss=%g&seed=9", loss),
               *whole = device_named("sim:?mass=1&damping=0");
    int samples = 0, commands = 0, both = 0, missed = 0, has_read = 0, is_armed = 0;
    double acting = 0.0;
    uint64_t last = 0;
    dpt_device_state newest = { .size = sizeof newest };
    for (int n = 0; n < PERIODS; n++) {
        const dpt_device_state state = state_of(device), sent = state_of(whole);
        const int is_lost = uniform(9, (uint64_t)n, 2) < loss, command_is_lost = uniform(9, (uint64_t)n, 1) < loss;
        CHECK(state.status == DPT_DEVICE_STATUS_READY && (state.fresh == 0) == is_lost, "period %d: fresh %u", n,
              state.fresh);
        if (is_lost) {
            CHECK(!has_read || (state.sequence == last && !memcmp(&state.pose, &newest.pose, sizeof state.pose)),
                  "period %d: another sample", n);
        } else {
            CHECK(state.sequence == (uint64_t)n && (!has_read || (int)state.fresh == n - (int)last),
                  "period %d: number %d, fresh %u", n, (int)state.sequence, state.fresh);
            CHECK(!memcmp(&state.pose, &sent.pose, sizeof sent.pose), "period %d: %g, not %g", n,
                  state.pose.position[0], sent.pose.position[0]);
            newest = state;
            last = state.sequence;
            has_read = 1;
        }
        samples += is_lost;
        commands += command_is_lost;
        both += is_lost && command_is_lost;
        missed += is_armed && command_is_lost;
        const double command = n % 7 - 3.0;
        write_force(device, command, 0.0, 0.0);
        if (!command_is_lost) {
            acting = command;
            is_armed = 1;
        }
        write_force(whole, acting, 0.0, 0.0);
    }
    state_of(device);
    const dpt_device_counts counts = counts_of(device);
    samples += uniform(9, PERIODS, 2) < loss;
    CHECK(counts.lost == (uint64_t)samples && counts.missed == (uint64_t)missed && counts.commands == PERIODS &&
              counts.samples == PERIODS + 1,
          "%d lost, %d missed", (int)counts.lost, (int)counts.missed);
    CHECK(is_about(samples, PERIODS, loss) && is_about(commands, PERIODS, loss) && is_about(both, PERIODS, loss * loss),
          "%d samples, %d commands, %d both", samples, commands, both);
    dpt_device_close(device);
    dpt_device_close(whole);
}

/* A line that loses every command has no force, and one that loses every sample gives none. */
static void a_line_may_lose_everything(void)
{
    dpt_device *device = device_named("sim:?loss=1&gravity=1");
    for (int n = 0; n < 50; n++) {
        const dpt_device_state state = state_of(device);
        CHECK(state.fresh == 0 && state.pose.position[1] == 0.0, "period %d: fresh %u", n, state.fresh);
        write_force(device, 1.0, 0.0, 0.0);
    }
    CHECK(counts_of(device).lost == 50 && counts_of(device).missed == 0, "counts");
    dpt_device_close(device);
}

static void samples_come_twice(void)
{
    enum { PERIODS = 4000 };
    const double doubled = 0.2;
    dpt_device *device = device_named("sim:?hand=press&double=%g&seed=4", doubled),
               *whole = device_named("sim:?hand=press");
    dpt_device_state before = { .size = sizeof before };
    int repeats = 0;
    for (int n = 0; n < PERIODS; n++) {
        const dpt_device_state state = state_of(device), sent = state_of(whole);
        const int is_repeat = n > 0 && uniform(4, (uint64_t)n, 3) < doubled;
        if (is_repeat)
            CHECK(state.fresh == 1 && state.sequence == before.sequence && state.time_ns == before.time_ns &&
                      !memcmp(&state.pose, &before.pose, sizeof state.pose),
                  "period %d: fresh %u, number %d", n, state.fresh, (int)state.sequence);
        else
            CHECK(state.sequence == (uint64_t)n && state.time_ns == sent.time_ns &&
                      (n == 0 || (int)state.fresh == n - (int)before.sequence) &&
                      !memcmp(&state.pose, &sent.pose, sizeof state.pose),
                  "period %d: fresh %u, number %d", n, state.fresh, (int)state.sequence);
        before = state;
        repeats += is_repeat;
    }
    CHECK(is_about(repeats, PERIODS, doubled) && counts_of(device).lost == 0, "%d repeats", repeats);
    dpt_device_close(device);
    dpt_device_close(whole);
}

static dpt_result no_force(void *user, const dpt_loop_sample *sample, dpt_wrench *wrench)
{
    (void)user;
    (void)sample;
    (void)wrench;
    return DPT_OK;
}

/* The loop sees what comes twice as reordered, what is lost as stale, and both as numbers that were skipped. */
static void the_loop_counts_both(void)
{
    enum { TICKS = 5000 };
    dpt_device *device = device_named("sim:?hand=wipe&double=0.1&loss=0.05&seed=21");
    int lost = 0, repeated = 0, last = 0;
    for (int n = 0; n < TICKS; n++) {
        const int is_lost = uniform(21, (uint64_t)n, 2) < 0.05;
        const int is_repeat = !is_lost && n > 0 && uniform(21, (uint64_t)n, 3) < 0.1;
        lost += is_lost;
        repeated += is_repeat;
        last = is_lost || is_repeat ? last : n;
    }
    dpt_loop_def def;
    dpt_loop_stats stats = { .size = sizeof stats };
    dpt_loop *loop;
    dpt_loop_def_init(&def);
    def.tick = no_force;
    def.ticks = TICKS;
    def.lock = def.priority = 0;
    CHECK(dpt_loop_open(device, &def, &loop) == DPT_OK && dpt_loop_run(loop, &stats) == DPT_OK, "loop");
    CHECK(stats.reordered == (uint64_t)repeated && stats.stale == (uint64_t)(lost + repeated) &&
              stats.fresh == (uint64_t)(TICKS - lost - repeated) && stats.skipped == (uint64_t)(last + 1) - stats.fresh,
          "%d reordered, %d stale, %d skipped", (int)stats.reordered, (int)stats.stale, (int)stats.skipped);
    dpt_loop_close(loop);
    dpt_device_close(device);
}

/* By the clock several periods pass between two reads: each has its own chance. */
static void a_live_line_loses_the_same_samples(void)
{
    dpt_device *device = device_named("sim:?live=1&loss=0.3&double=0.2&seed=5&hand=press");
    const struct timespec nap = { 0, 2300000 };
    dpt_device_state state = { .size = sizeof state };
    uint64_t lost = 0;
    for (int n = 0; n < 100; n++) {
        state = state_of(device);
        CHECK(state.sequence == 0 || uniform(5, state.sequence, 2) >= 0.3, "number %d was lost", (int)state.sequence);
        nanosleep(&nap, NULL);
    }
    const dpt_device_counts counts = counts_of(device);
    for (uint64_t p = 0; p < counts.samples; p++)
        lost += uniform(5, p, 2) < 0.3;
    CHECK(counts.lost == lost && counts.samples > 100, "%d lost, not %d", (int)counts.lost, (int)lost);
    dpt_device_close(device);
}

int main(void)
{
    TEST(the_generator_is_the_published_one);
    TEST(a_delay_may_end_within_a_period);
    TEST(jitter_delays_each_command_by_its_own_share);
    TEST(samples_and_commands_are_lost);
    TEST(a_line_may_lose_everything);
    TEST(samples_come_twice);
    TEST(the_loop_counts_both);
    TEST(a_live_line_loses_the_same_samples);
    return check_report();
}
