/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Where the loop's deadlines come to lie between a device's samples, and what it does when the machine was suspended, on
 * clocks that are made up: the linker puts ours between the loop and the C library (tests.mk). Wakes are late by up to
 * 60 us, samples by up to 40.
 */
#include <time.h>

#include "dynpoint/driver.h"
#include "dynpoint/loop.h"
#include "lib/check.h"
#include "lib/random.h"

enum { PERIOD = 1000000, TICKS = 4000 };

static uint64_t now = 1000 * (uint64_t)PERIOD, seed = 1;

/* While suspended the monotonic clock stands still, that since boot goes on. */
static uint64_t suspended, boot_reads, pauses;

int __wrap_clock_gettime(clockid_t clock, struct timespec *time);
int __wrap_clock_gettime(clockid_t clock, struct timespec *time)
{
    now += 200;
    uint64_t told = now;
    if (clock != CLOCK_MONOTONIC) {
        told += suspended;
        now += pauses && ++boot_reads % pauses == 0 ? 3 * PERIOD / 2 : 0;
    }
    *time = (struct timespec){ (time_t)(told / 1000000000u), (long)(told % 1000000000u) };
    return 0;
}

int __wrap_clock_nanosleep(clockid_t clock, int flags, const struct timespec *until, struct timespec *left);
int __wrap_clock_nanosleep(clockid_t clock, int flags, const struct timespec *until, struct timespec *left)
{
    uint64_t end = (uint64_t)until->tv_sec * 1000000000u + (uint64_t)until->tv_nsec;
    (void)clock, (void)flags, (void)left;
    now = (end > now ? end : now) + (uint64_t)random_in(&seed, 0.0, 60000.0);
    return 0;
}

/* Samples every `period`, from `offset` on, each a little late. */
static struct device {
    dpt_device device;
    uint64_t offset, period, number, arrives, before;
    uint64_t transport; /* from when a sample is taken to when it can be read */
    uint64_t late;      /* of the first samples one in so many is a quarter of a period late; 0: none */
} made;

static dpt_result open_made(const dpt_driver *driver, const char *where, dpt_device **device, dpt_device_error *error)
{
    (void)driver, (void)where, (void)error;
    *device = &made.device;
    return DPT_OK;
}

static void info_of_made(const dpt_device *device, dpt_device_info *info)
{
    (void)device;
    info->pose_dofs = info->wrench_dofs = 3;
    info->rate = 1000.0;
    info->force_max = 5.0;
}

static dpt_result read_made(dpt_device *device, dpt_device_state *state)
{
    (void)device;
    uint64_t before = made.number;
    while (made.arrives <= now) {
        made.before = made.arrives;
        made.number++;
        made.arrives = made.offset + made.number * made.period + (uint64_t)random_in(&seed, 0.0, 40000.0);
        if (made.late && made.number < TICKS && random_bits(&seed) % made.late == 0)
            made.arrives += PERIOD / 4;
    }
    state->status = DPT_DEVICE_STATUS_READY;
    state->fresh = (uint32_t)(made.number - before);
    state->sequence = made.number;
    state->time_ns = made.before - made.transport;
    state->pose.orientation[0] = 1.0;
    return DPT_OK;
}

static double written[TICKS + 1];
static int writes;

static dpt_result write_made(dpt_device *device, const dpt_wrench *wrench)
{
    (void)device;
    if (writes <= TICKS)
        written[writes++] = wrench->force[0];
    return DPT_OK;
}

static dpt_result clear_made(dpt_device *device)
{
    (void)device;
    return DPT_OK;
}

static void counts_of_made(const dpt_device *device, dpt_device_counts *counts)
{
    (void)device, (void)counts;
}

static void close_made(dpt_device *device)
{
    (void)device;
}

static const dpt_driver driver = { .size = sizeof driver,
                                   .version = DPT_DRIVER_VERSION,
                                   .name = "made",
                                   .about = "made up",
                                   .open = open_made,
                                   .info = info_of_made,
                                   .read = read_made,
                                   .write = write_made,
                                   .clear = clear_made,
                                   .counts = counts_of_made,
                                   .close = close_made };

static double ages, oldest; /* of samples when they are read, behind the first half of the ticks */
static int aged, told, run_ticks = TICKS;

static dpt_result nothing(void *user, const dpt_loop_sample *sample, dpt_wrench *wrench)
{
    (void)user, (void)wrench;
    if (++told > run_ticks / 2) {
        const double age = (double)(now - sample->state->time_ns);
        ages += age;
        oldest = age > oldest ? age : oldest;
        aged++;
    }
    return DPT_OK;
}

static dpt_loop_stats run_made(uint64_t offset, uint64_t period, double rate, dpt_loop_tick_fn *tick)
{
    dpt_device *device;
    dpt_loop_def def;
    dpt_loop *loop;
    dpt_loop_stats stats = { .size = sizeof stats };
    made.offset = made.arrives = now + PERIOD + offset;
    made.period = period;
    made.number = 0;
    writes = aged = told = 0;
    ages = oldest = 0.0;
    CHECK(dpt_device_open_with(&driver, NULL, &device, NULL) == DPT_OK, "open");
    dpt_loop_def_init(&def);
    def.tick = tick;
    def.ticks = (uint64_t)run_ticks;
    def.rate = rate;
    def.priority = def.lock = 0;
    CHECK(dpt_loop_open(device, &def, &loop) == DPT_OK, "loop");
    CHECK(dpt_loop_run(loop, &stats) == DPT_OK && stats.ticks == def.ticks, "run");
    dpt_loop_close(loop);
    dpt_device_close(device);
    return stats;
}

/* How many of the ticks had no fresh sample, or too many. */
static uint64_t bad_ticks(uint64_t offset, uint64_t period, double rate)
{
    const dpt_loop_stats stats = run_made(offset, period, rate, nothing);
    CHECK(stats.missed == 0, "%llu missed", (unsigned long long)stats.missed);
    return stats.stale + stats.skipped;
}

static void deadlines_stay_between_samples(void)
{
    uint64_t worst = 0;
    for (uint64_t offset = 0; offset < PERIOD; offset += PERIOD / 32) {
        uint64_t bad = bad_ticks(offset, PERIOD, 0.0);
        worst = bad > worst ? bad : worst;
    }
    CHECK(worst <= TICKS / 100, "%llu of %d", (unsigned long long)worst, TICKS);
}

/* A command waits for an eighth of a period and what jitter there is, wherever the deadlines began. */
static void samples_are_served_soon(void)
{
    for (uint64_t offset = 0; offset < PERIOD; offset += PERIOD / 32) {
        bad_ticks(offset, PERIOD, 0.0);
        CHECK(aged > TICKS / 3 && ages / aged < PERIOD / 4.0 && oldest < PERIOD / 2.0,
              "%.0f ns in the mean of %d, %.0f at most", ages / aged, aged, oldest);
    }
}

/* A sample can be read some time after it was taken, and now and then one is late: few ticks go without. */
static void samples_that_come_late_are_waited_for(void)
{
    for (uint64_t transport = 0; transport < 2 * PERIOD; transport += PERIOD / 8) {
        made.transport = transport;
        const uint64_t bad = bad_ticks(PERIOD / 3, PERIOD, 0.0);
        CHECK(bad <= TICKS / 100, "%llu of %d", (unsigned long long)bad, TICKS);
    }
    made.transport = 0;
    made.late = 200;
    const uint64_t bad = bad_ticks(0, PERIOD, 0.0);
    made.late = 0;
    CHECK(bad <= TICKS / 200, "%llu of %d, where one sample in 200 is late", (unsigned long long)bad, TICKS);
}

/* What was late once is forgotten: ten thousand ticks later samples are served soon again. */
static void lateness_is_forgotten(void)
{
    run_ticks = 20 * TICKS;
    made.late = 100;
    bad_ticks(0, PERIOD, 0.0);
    made.late = 0;
    run_ticks = TICKS;
    CHECK(ages / aged < PERIOD / 4.0, "%.0f ns in the mean of %d", ages / aged, aged);
}

/* A device's clock is off by a thousandth, either way: its samples drift through a whole period and more. */
static void deadlines_follow_a_clock_that_drifts(void)
{
    for (int sign = -1; sign <= 1; sign += 2) {
        uint64_t bad = bad_ticks(0, (uint64_t)(PERIOD + sign * PERIOD / 1000), 0.0);
        CHECK(bad <= TICKS / 100, "%llu of %d", (unsigned long long)bad, TICKS);
    }
}

/* What it is for: at a rate of one's own the worst place costs many. */
static void a_rate_of_its_own_is_kept(void)
{
    uint64_t worst = 0;
    for (uint64_t offset = 0; offset < PERIOD; offset += PERIOD / 32) {
        uint64_t bad = bad_ticks(offset, PERIOD, 1000.0);
        worst = bad > worst ? bad : worst;
    }
    CHECK(worst > TICKS / 5, "%llu of %d", (unsigned long long)worst, TICKS);
}

enum { SLEEPS_AT = 2000, RAMP = 100 };
static int suspends;

static dpt_result push(void *user, const dpt_loop_sample *sample, dpt_wrench *wrench)
{
    (void)user, (void)sample;
    wrench->force[0] = 1.0;
    suspended += suspends && writes == SLEEPS_AT ? 5 * (uint64_t)PERIOD : 0;
    return DPT_OK;
}

/* The tick during which it sleeps sends nothing, and the force comes back by the start ramp. */
static void a_machine_that_was_suspended_starts_anew(void)
{
#ifdef CLOCK_BOOTTIME
    suspends = 1;
    dpt_loop_stats stats = run_made(PERIOD / 2, PERIOD, 1000.0, push);
    suspends = 0;
    CHECK(stats.stops == 1, "%d stops", (int)stats.stops);
    CHECK(written[SLEEPS_AT - 1] == 1.0 && written[SLEEPS_AT] == 0.0, "%g N, then %g N", written[SLEEPS_AT - 1],
          written[SLEEPS_AT]);
    for (int i = SLEEPS_AT + 1; i < SLEEPS_AT + RAMP - 5; i++)
        CHECK(written[i] > written[i - 1] && written[i] < 0.015 * (i - SLEEPS_AT), "%g N in tick %d after it",
              written[i], i - SLEEPS_AT);
    CHECK(written[SLEEPS_AT + RAMP + 5] == 1.0, "it does not come back");
#else
    SKIP("a suspended machine", "there is no clock that goes on");
#endif
}

/* A thread may be interrupted between the two clocks: that is no sleep. */
static void a_pause_between_the_clocks_is_no_sleep(void)
{
    pauses = 10;
    dpt_loop_stats stats = run_made(PERIOD / 2, PERIOD, 1000.0, push);
    pauses = 0;
    CHECK(boot_reads > TICKS && stats.stops == 0 && written[TICKS - 1] == 1.0, "%d stops", (int)stats.stops);
}

int main(void)
{
    TEST(deadlines_stay_between_samples);
    TEST(samples_are_served_soon);
    TEST(samples_that_come_late_are_waited_for);
    TEST(lateness_is_forgotten);
    TEST(deadlines_follow_a_clock_that_drifts);
    TEST(a_rate_of_its_own_is_kept);
    TEST(a_machine_that_was_suspended_starts_anew);
    TEST(a_pause_between_the_clocks_is_no_sleep);
    return check_report();
}
