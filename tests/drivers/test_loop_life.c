/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * How the servo loop begins and ends: devices that come back, stopping, several devices at once, whose limits hold, and
 * definitions that are refused.
 */
#include "drivers/loop_fixture.h"

#include <pthread.h>
#include <signal.h>
#include <sys/time.h>

static void a_device_that_comes_back_is_served(void)
{
    struct flaky *flaky = flaky_over("sim");
    struct host host = { .flaky = flaky, .force = 1.0 };
    dpt_loop_def def = def_for(&host);
    def.ticks = 5000;
    def.reopen = 1;
    dpt_loop *loop = loop_of(&flaky->device, &def);
    dpt_loop_stats stats = { .size = sizeof stats };
    flaky->is_out = 1;
    CHECK(dpt_loop_run(loop, &stats) == DPT_OK, "the run failed");
    check_sums(&stats);
    CHECK(stats.losses == 1 && stats.reopened == 1 && stats.lost == 1001 && stats.fresh == 3999, "%d lost, %d fresh",
          (int)stats.lost, (int)stats.fresh);
    dpt_loop_close(loop);
    def.reopen = 0;
    loop = loop_of(&flaky->device, &def);
    flaky->is_out = 1;
    CHECK(dpt_loop_run(loop, &stats) == DPT_E_LOST && stats.ticks == 1, "%d ticks without a device", (int)stats.ticks);
    flaky->is_out = 0;
    CHECK(dpt_loop_run(loop, &stats) == DPT_OK && stats.fresh == 5000, "a second run");
    dpt_loop_close(loop);
    dpt_device_close(&flaky->device);
}

/* A trace counts its samples anew after each clear. */
static void a_device_that_begins_anew_is_served(void)
{
    char text[4096] = "tick,ax,ay,az,bx,by,bz\n", name[128];
    for (int row = 0; row < 100; row++)
        sprintf(text + strlen(text), "%d,0,0,0,0,0,1\n", row);
    struct small_file file = file_with(text);
    snprintf(name, sizeof name, "replay:%s", file.path);
    dpt_device *device = device_named("%s", name);
    struct host host = { .force = 1.0 };
    dpt_loop_def def = def_for(&host);
    def.ticks = 3300;
    def.reopen = 1;
    dpt_loop *loop = loop_of(device, &def);
    dpt_loop_stats stats = { .size = sizeof stats };
    CHECK(dpt_loop_run(loop, &stats) == DPT_OK || stats.ticks == 3300, "%d ticks", (int)stats.ticks);
    check_sums(&stats);
    CHECK(stats.fresh == 300 && stats.reopened == 2 && stats.losses == 3 && stats.reordered == 0,
          "%d fresh, %d came back, %d reordered", (int)stats.fresh, (int)stats.reopened, (int)stats.reordered);
    dpt_loop_close(loop);
    dpt_device_close(device);
    unlink(file.path);
}

static dpt_loop *running;

static void on_alarm(int signal_number)
{
    (void)signal_number;
    dpt_loop_stop(running);
}

static void *stop_soon(void *loop)
{
    rest(0.05);
    dpt_loop_stop(loop);
    return NULL;
}

static void stops_when_asked(void)
{
    struct flaky *flaky = flaky_over("sim:?live=1");
    struct host host = { .flaky = flaky, .force = 1.0 };
    dpt_loop_def def = def_for(&host);
    dpt_loop *loop = host.loop = running = loop_of(&flaky->device, &def);
    dpt_loop_stats stats = { .size = sizeof stats };

    dpt_loop_stop(loop);
    CHECK(dpt_loop_run(loop, &stats) == DPT_OK && stats.ticks == 0 && flaky->writes == 1, "stopped before it ran: %d",
          (int)stats.ticks);

    host.stop_at = 100;
    CHECK(dpt_loop_run(loop, &stats) == DPT_OK && host.ticks == 100, "by a tick, after %d", (int)host.ticks);
    CHECK(flaky->written.force[0] == 0.0, "it ends with %g N", flaky->written.force[0]);

    pthread_t thread;
    CHECK(pthread_create(&thread, NULL, stop_soon, loop) == 0, "no thread");
    CHECK(dpt_loop_run(loop, &stats) == DPT_OK && host.ticks > 100, "by a thread");
    pthread_join(thread, NULL);
    CHECK(flaky->written.force[0] == 0.0, "it ends with %g N", flaky->written.force[0]);

    struct sigaction action = { .sa_handler = on_alarm }, before;
    const struct itimerval soon = { { 0, 0 }, { 0, 50000 } };
    sigaction(SIGALRM, &action, &before);
    setitimer(ITIMER_REAL, &soon, NULL);
    CHECK(dpt_loop_run(loop, NULL) == DPT_OK, "by a signal");
    sigaction(SIGALRM, &before, NULL);
    CHECK(flaky->written.force[0] == 0.0, "it ends with %g N", flaky->written.force[0]);
    dpt_loop_stop(NULL);
    dpt_loop_close(loop);
    dpt_device_close(&flaky->device);
}

struct served {
    struct host host;
    dpt_device *device;
    dpt_loop *loop;
    dpt_loop_stats stats;
    dpt_result result;
};

static void *serve(void *user)
{
    struct served *served = user;
    served->result = dpt_loop_run(served->loop, &served->stats);
    return NULL;
}

static void several_devices_at_once(void)
{
    enum { DEVICES = 3 };
    static struct served served[DEVICES];
    pthread_t threads[DEVICES];
    for (int i = 0; i < DEVICES; i++) {
        served[i].host.force = 0.1 * (i + 1);
        served[i].stats.size = sizeof served[i].stats;
        served[i].device = device_named("sim:?mass=1&damping=0&live=%d", i != 2);
        dpt_loop_def def = def_for(&served[i].host);
        def.ticks = 300;
        served[i].loop = loop_of(served[i].device, &def);
    }
    for (int i = 0; i < DEVICES; i++)
        CHECK(pthread_create(&threads[i], NULL, serve, &served[i]) == 0, "no thread");
    for (int i = 0; i < DEVICES; i++) {
        pthread_join(threads[i], NULL);
        check_sums(&served[i].stats);
        CHECK(served[i].result == DPT_OK && served[i].stats.ticks == 300, "device %d: %d ticks", i,
              (int)served[i].stats.ticks);
        CHECK(counts_of(served[i].device).commands == 301, "device %d: %d commands", i,
              (int)counts_of(served[i].device).commands);
        dpt_loop_close(served[i].loop);
        dpt_device_close(served[i].device);
    }
}

/* The lesser of the guard's and the device's limits holds; a device without force gets none. */
static void limits_are_the_lesser(void)
{
    static const struct {
        const char *name;
        double guard, least, most;
    } cases[] = { { "sim:?force=2", 5.0, 1.999, 2.0 },
                  { "sim:?force=8", 3.0, 2.999, 3.0 },
                  { "sim:?force=0", 3.0, 0.0, 0.0 } };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct flaky *flaky = flaky_over(cases[i].name);
        struct host host = { .flaky = flaky, .force = 100.0 };
        dpt_loop_def def = def_for(&host);
        const dpt_guard_def guard = guard_without_ramps(cases[i].guard);
        def.guard = &guard;
        dpt_loop *loop = loop_of(&flaky->device, &def);
        host.loop = loop;
        dpt_loop_stats stats = { .size = sizeof stats };
        host.stop_at = 20;
        dpt_loop_run(loop, &stats);
        CHECK(stats.clamped == 20, "%s: %d clamped", cases[i].name, (int)stats.clamped);
        CHECK(flaky->strongest >= cases[i].least && flaky->strongest <= cases[i].most, "%s: %g N", cases[i].name,
              flaky->strongest);
        dpt_loop_close(loop);
        dpt_device_close(&flaky->device);
    }
}

static void wrong_defs_are_refused(void)
{
    dpt_device *device = device_named("sim"), *slow = device_named("sim:?rate=250");
    dpt_loop_def good = def_for(NULL), def = good;
    dpt_loop *loop = (dpt_loop *)&def;
    dpt_loop_stats stats = { .size = 8 };
    CHECK(dpt_loop_open(NULL, &def, &loop) == DPT_E_ARGUMENT && !loop, "no device");
    CHECK(dpt_loop_open(device, NULL, &loop) == DPT_E_ARGUMENT, "no def");
    CHECK(dpt_loop_open(device, &def, NULL) == DPT_E_ARGUMENT, "no place");
    def.size--;
    CHECK(dpt_loop_open(device, &def, &loop) == DPT_E_SIZE, "a size that is not known");
    def = good, def.tick = NULL;
    CHECK(dpt_loop_open(device, &def, &loop) == DPT_E_ARGUMENT, "no tick");
    def = good, def.priority = 100;
    CHECK(dpt_loop_open(device, &def, &loop) == DPT_E_ARGUMENT, "priority 100");
    def = good, def.awake = 2;
    CHECK(dpt_loop_open(device, &def, &loop) == DPT_E_ARGUMENT, "awake 2");
    def = good, def.lock = 2;
    CHECK(dpt_loop_open(device, &def, &loop) == DPT_E_ARGUMENT, "lock 2");
    def = good, def.reopen = 2;
    CHECK(dpt_loop_open(device, &def, &loop) == DPT_E_ARGUMENT, "reopen 2");
    const double rates[] = { NAN, -1.0, 0.5, 1e6, INFINITY };
    for (int i = 0; i < 5; i++) {
        def = good, def.rate = rates[i];
        CHECK(dpt_loop_open(device, &def, &loop) == DPT_E_ARGUMENT, "rate %g", rates[i]);
    }
    dpt_guard_def guard = guard_without_ramps(5.0);
    def = good, def.guard = &guard, guard.hold = NAN;
    CHECK(dpt_loop_open(device, &def, &loop) == DPT_E_ARGUMENT, "hold NaN");
    def = good, def.reserved_pointer = &def;
    CHECK(dpt_loop_open(device, &def, &loop) == DPT_E_ARGUMENT, "a reserved pointer");
    def = good, def.reserved_pointer_2 = &def;
    CHECK(dpt_loop_open(device, &def, &loop) == DPT_E_ARGUMENT, "another one");
    def = good, def.guard = &guard, guard.hold = 0.003, guard.size = 0;
    CHECK(dpt_loop_open(device, &def, &loop) == DPT_E_SIZE, "a guard without a size");
    CHECK(dpt_loop_open(slow, &good, &loop) == DPT_E_ARGUMENT, "4 ms a tick, and commands hold for 3");
    def = good, def.guard = &guard, guard.size = sizeof guard, guard.hold = 0.01;
    CHECK(dpt_loop_open(slow, &def, &loop) == DPT_OK, "and for 10");
    CHECK(dpt_loop_run(NULL, &stats) == DPT_E_ARGUMENT && dpt_loop_run(loop, &stats) == DPT_E_SIZE, "run");
    dpt_loop_close(loop);
    dpt_loop_close(NULL);
    dpt_loop_def_defaults(NULL, 8);
    dpt_device_close(device);
    dpt_device_close(slow);
}

static void quantiles_are_bin_ends(void)
{
    uint64_t bins[DPT_LOOP_BINS] = { 0 };
    CHECK(dpt_loop_quantile(bins, 0.5) == 0.0 && dpt_loop_quantile(NULL, 0.5) == 0.0, "nothing");
    bins[0] = 50, bins[40] = 49, bins[63] = 1;
    CHECK(fabs(dpt_loop_quantile(bins, 0.5) - 1e-6 * pow(2.0, 0.25)) < 1e-18, "%g", dpt_loop_quantile(bins, 0.5));
    CHECK(fabs(dpt_loop_quantile(bins, 0.99) / (1e-6 * pow(2.0, 10.25)) - 1.0) < 1e-12, "%g",
          dpt_loop_quantile(bins, 0.99));
    CHECK(fabs(dpt_loop_quantile(bins, 1.0) / (1e-6 * pow(2.0, 16.0)) - 1.0) < 1e-12, "%g",
          dpt_loop_quantile(bins, 1.0));
    CHECK(dpt_loop_quantile(bins, NAN) == 0.0 && dpt_loop_quantile(bins, 2.0) == 0.0, "no fraction");
}
int main(void)
{
    TEST(a_device_that_comes_back_is_served);
    TEST(a_device_that_begins_anew_is_served);
    TEST(stops_when_asked);
    TEST(several_devices_at_once);
    TEST(limits_are_the_lesser);
    TEST(wrong_defs_are_refused);
    TEST(quantiles_are_bin_ends);
    return check_report();
}
