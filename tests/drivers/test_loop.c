/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What the servo loop counts must be what was done to it: by a seeded plan of troubles, then by the clock, with ticks that
 * take too long, and with each fault of a device.
 */
#include "drivers/loop_fixture.h"

static void sixty_thousand_ticks_lose_nothing(void)
{
    dpt_device *device = device_named("sim:?hand=wipe");
    struct host host = { .force = 0.5 };
    dpt_loop_def def = def_for(&host);
    def.ticks = 60000;
    dpt_loop *loop = loop_of(device, &def);
    dpt_loop_stats stats = { .size = sizeof stats };
    CHECK(dpt_loop_run(loop, &stats) == DPT_OK, "the run failed");
    dpt_device_counts counts = counts_of(device);
    check_sums(&stats);
    CHECK(stats.fresh == 60000 && host.ticks == 60000 && stats.sent == 60000 && counts.samples == 60000, "%d fresh",
          (int)stats.fresh);
    CHECK(counts.commands == 60001 && counts.missed == 0 && host.wrong_dt == 0, "%d commands, %d missed",
          (int)counts.commands, (int)counts.missed);
    CHECK(!stats.missed && !stats.skipped && !stats.stops && !stats.refused && !stats.clamped && !stats.slewed,
          "something was wrong");
    dpt_loop_close(loop);
    dpt_device_close(device);
}

/* Each trouble once in two hundred ticks: every count is what was done, none is missed. */
static void every_trouble_is_counted(void)
{
    struct flaky *flaky = flaky_over("sim:?hand=wipe&force=1000");
    struct host host = { .flaky = flaky };
    dpt_loop_def def = def_for(&host);
    flaky->share = 0.005;
    flaky->random = 5;
    def.ticks = 60000;
    def.reopen = 1;
    def.idle = rest_a_tick;
    const dpt_guard_def guard = guard_without_ramps(1000.0);
    def.guard = &guard;
    dpt_loop *loop = loop_of(&flaky->device, &def);
    dpt_loop_stats stats = { .size = sizeof stats };
    dpt_result result = dpt_loop_run(loop, &stats);
    CHECK(result == DPT_OK || result == DPT_E_LOST, "%s", dpt_result_name(result));
    check_sums(&stats);
    const uint64_t *did = flaky->did;
    CHECK(did[OLD] == stats.reordered && did[SKIP] * 2 == flaky->skipped, "%d reordered, %d counted", (int)did[OLD],
          (int)stats.reordered);
    CHECK(did[REPEAT] + did[OLD] + did[ERROR] == stats.stale, "%d repeats, %d old, %d errors; %d stale",
          (int)did[REPEAT], (int)did[OLD], (int)did[ERROR], (int)stats.stale);
    CHECK(did[UNPLUG] == stats.lost && flaky->losses == stats.losses, "%d of %d losses", (int)stats.losses,
          (int)flaky->losses);
    CHECK(flaky->cleared == stats.reopened || flaky->cleared == stats.reopened + 1, "%d of %d came back",
          (int)stats.reopened, (int)flaky->cleared);
    CHECK(did[FAULT] + did[BAD_POSE] == stats.not_ready && did[FAULT] == host.not_ready,
          "%d faults, %d bad poses; %d not ready", (int)did[FAULT], (int)did[BAD_POSE], (int)stats.not_ready);
    CHECK(host.idle == stats.stale + stats.lost + did[BAD_POSE] && host.idle + host.ticks == stats.ticks &&
              host.idle_lost == stats.lost && host.idle_wrong == 0 && host.late_max == 0.0,
          "%d ticks without a sample, %d of them lost, %d wrong", (int)host.idle, (int)host.idle_lost,
          (int)host.idle_wrong);
    CHECK(flaky->skipped == stats.skipped, "%d samples skipped, %d counted", (int)flaky->skipped, (int)stats.skipped);
    CHECK(host.failures == stats.failed && host.commands == stats.fresh, "%d failed, %d fresh", (int)stats.failed,
          (int)stats.fresh);
    CHECK(host.nans == stats.not_finite && host.not_zero == 0, "%d not finite, %d counted", (int)host.nans,
          (int)stats.not_finite);
    CHECK(did[BUSY] == stats.refused || did[BUSY] == stats.refused + 1, "%d busy, %d refused", (int)did[BUSY],
          (int)stats.refused);
    CHECK(stats.sent + stats.refused < flaky->writes && flaky->writes < stats.sent + stats.refused + 11,
          "%d writes for %d", (int)flaky->writes, (int)(stats.sent + stats.refused));
    CHECK(host.wrong_sent == 0 && host.wrong_count == 0, "%d ticks were told of another wrench, %d of another number",
          (int)host.wrong_sent, (int)host.wrong_count);
    CHECK(host.acted > 5000 && host.kept > 20 && host.several > 100 && host.off > 100,
          "%d with force, %d with an older one, %d after several, %d after none", (int)host.acted, (int)host.kept,
          (int)host.several, (int)host.off);
    for (int trouble = REPEAT; trouble < TROUBLES; trouble++)
        CHECK(did[trouble] > 20, "trouble %d only %d times", trouble, (int)did[trouble]);
    CHECK(stats.stops > flaky->losses && flaky->written.force[0] == 0.0, "%d stops", (int)stats.stops);
    dpt_loop_close(loop);
    dpt_device_close(&flaky->device);
}

/* Without trouble each command arrives on its own tick, in turn; what arrives is what the host said. */
struct order {
    struct host host;
    uint64_t wrong;
};

static dpt_result number(void *user, const dpt_loop_sample *sample, dpt_wrench *wrench)
{
    struct order *order = user;
    double expected = sample->state->sequence ? 1e-6 * (double)sample->state->sequence : 0.0;
    order->wrong += order->host.flaky->written.force[1] != expected;
    order->wrong += sample->sent.force[1] != expected || sample->commands != (expected > 0.0);
    order->wrong += sample->size != sizeof *sample || sample->info->rate != 1000.0;
    wrench->force[1] = 1e-6 * (double)(sample->state->sequence + 1);
    return DPT_OK;
}

static void commands_arrive_in_turn(void)
{
    struct flaky *flaky = flaky_over("sim");
    struct order order = { .host.flaky = flaky };
    dpt_loop_def def = def_for(&order.host);
    def.tick = number;
    def.user = &order;
    def.ticks = 60000;
    const dpt_guard_def guard = guard_without_ramps(5.0);
    def.guard = &guard;
    dpt_loop *loop = loop_of(&flaky->device, &def);
    dpt_loop_stats stats = { .size = sizeof stats };
    CHECK(dpt_loop_run(loop, &stats) == DPT_OK && stats.sent == 60000, "%d sent", (int)stats.sent);
    CHECK(order.wrong == 0, "%d commands lost or out of turn", (int)order.wrong);
    CHECK(flaky->written.force[1] == 0.0, "it ends with %g N", flaky->written.force[1]);
    dpt_loop_close(loop);
    dpt_device_close(&flaky->device);
}

static uint64_t live_ticks = 3000;

/*
 * By the clock: each 50th tick takes three periods and a half longer. Ticks and missed deadlines together are the time
 * that has passed, but for what the first and the last were late.
 */
static void no_late_tick_goes_unnoticed(void)
{
    struct flaky *flaky = flaky_over("sim:?hand=press&live=1");
    struct host host = { .flaky = flaky, .force = 0.1, .slow = 0.0035 };
    dpt_loop_def def = def_for(&host);
    def.ticks = live_ticks;
    def.priority = 80;
    def.lock = 1;
    def.idle = rest_a_tick;
    dpt_loop *loop = loop_of(&flaky->device, &def);
    dpt_loop_stats stats = { .size = sizeof stats };
    CHECK(dpt_loop_run(loop, &stats) == DPT_OK, "the run failed");
    check_sums(&stats);
    double periods = (double)(flaky->last_ns - flaky->first_ns) * 1e3 * 1e-9;
    double slack = 2.0 * (stats.late_max + stats.took_max) * 1e3 + 3.0;
    CHECK(stats.missed >= 3 * (host.ticks / 50), "%d missed, of %d slow ticks", (int)stats.missed,
          (int)(host.ticks / 50));
    CHECK(fabs(periods - (double)(stats.ticks + stats.missed)) <= slack,
          "%.1f periods, %d ticks, %d missed, slack %.1f", periods, (int)stats.ticks, (int)stats.missed, slack);
    CHECK(sum_of(stats.late) == stats.ticks && sum_of(stats.took) == stats.ticks, "%d and %d in the histograms",
          (int)sum_of(stats.late), (int)sum_of(stats.took));
    CHECK(dpt_loop_quantile(stats.took, 1.0) >= 0.0035 && stats.took_max >= 0.0035, "the slowest took %g s",
          stats.took_max);
    CHECK(host.late_max == stats.late_max && host.idle + host.ticks == stats.ticks, "%g s late, and %g s were told",
          stats.late_max, host.late_max);
    dpt_device_counts counts = counts_of(&flaky->device);
    uint64_t samples = stats.fresh + stats.skipped;
    CHECK(counts.samples >= samples && (double)counts.samples <= (double)samples + slack + 1.0,
          "%d samples, %d seen and %d skipped", (int)counts.samples, (int)stats.fresh, (int)stats.skipped);
    CHECK(counts.commands == flaky->writes && host.wrong_dt == 0, "%d commands of %d", (int)counts.commands,
          (int)flaky->writes);
    CHECK(host.wrong_sent == 0 && host.wrong_count == 0 && host.acted > 0,
          "%d ticks were told of another wrench, %d of another number", (int)host.wrong_sent, (int)host.wrong_count);
    printf("    late: median %.3g us, 99 %% %.3g us, most %.3g us; %d of %d deadlines missed, %d stops%s%s\n",
           1e6 * dpt_loop_quantile(stats.late, 0.5), 1e6 * dpt_loop_quantile(stats.late, 0.99), 1e6 * stats.late_max,
           (int)stats.missed, (int)(stats.missed + stats.ticks), (int)stats.stops,
           stats.notes & DPT_LOOP_NOTE_NO_PRIORITY ? "; no priority" : "",
           stats.notes & DPT_LOOP_NOTE_NO_LOCK ? "; no lock" : "");
    dpt_loop_close(loop);
    dpt_device_close(&flaky->device);
}

/* A tick that hangs: the device's own watchdog ends the force, and the guard starts anew after it. */
struct hang {
    struct flaky *flaky;
    double before, after, sent;
    int ticks;
};

static dpt_result hang_once(void *user, const dpt_loop_sample *sample, dpt_wrench *wrench)
{
    struct hang *hang = user;
    hang->ticks++;
    if (hang->ticks == 300) {
        hang->before = sample->state->velocity[0];
        rest(0.2);
    }
    if (hang->ticks == 301) {
        hang->after = sample->state->velocity[0];
        hang->sent = hang->flaky->written.force[0];
    }
    wrench->force[0] = 1.0;
    return DPT_OK;
}

static void a_tick_that_hangs_gives_no_force(void)
{
    struct flaky *flaky = flaky_over("sim:?mass=1&damping=0&live=1&watchdog=0.01");
    struct hang hang = { .flaky = flaky };
    dpt_loop_def def = def_for(NULL);
    def.tick = hang_once;
    def.user = &hang;
    def.ticks = 1000;
    dpt_loop *loop = loop_of(&flaky->device, &def);
    dpt_loop_stats stats = { .size = sizeof stats };
    CHECK(dpt_loop_run(loop, &stats) == DPT_OK && hang.ticks > 301, "%d ticks", hang.ticks);
    CHECK(hang.before > 0.0 && hang.after - hang.before <= 0.0121, "%g Ns in the dark", hang.after - hang.before);
    CHECK(hang.sent == 0.0, "a command that took long is sent with %g N", hang.sent);
    CHECK(stats.stops >= 1 && stats.missed >= 198 && counts_of(&flaky->device).missed >= 180, "%d stops, %d missed",
          (int)stats.stops, (int)stats.missed);
    dpt_loop_close(loop);
    dpt_device_close(&flaky->device);
}

/* For each reason: force until it comes, none from that sample on, and after a clear it returns by the ramp. */
struct patient {
    dpt_device *device;
    double v[1200], force[1200];
    uint64_t first, count, unready;
    uint32_t reasons;
    int clears;
};

static dpt_result press(void *user, const dpt_loop_sample *sample, dpt_wrench *wrench)
{
    struct patient *patient = user;
    const dpt_device_state *state = sample->state;
    if (state->sequence < 1200)
        patient->v[state->sequence] = state->velocity[0];
    patient->count = state->sequence + 1;
    patient->reasons |= state->reasons;
    patient->unready += state->status != DPT_DEVICE_STATUS_READY;
    if (patient->clears && patient->unready == 100)
        dpt_device_clear(patient->device);
    wrench->force[0] = 1.0;
    return DPT_OK;
}

static void every_fault_ends_the_force(void)
{
    for (uint32_t bit = 1; dpt_device_reason_name(bit); bit <<= 1) {
        const char *name = dpt_device_reason_name(bit);
        int is_lost = bit == DPT_REASON_UNPLUGGED || bit == DPT_REASON_SILENT;
        dpt_device *device = device_named("sim:?mass=1&damping=0&fault=%s@0.3", name);
        struct patient patient = { .device = device, .clears = 1 };
        dpt_loop_def def = def_for(NULL);
        def.tick = press;
        def.user = &patient;
        def.ticks = 700;
        dpt_loop *loop = loop_of(device, &def);
        dpt_loop_stats stats = { .size = sizeof stats };
        dpt_result result = dpt_loop_run(loop, &stats);
        check_sums(&stats);
        CHECK(result == (is_lost ? DPT_E_LOST : DPT_OK), "%s: %s", name, dpt_result_name(result));
        CHECK(stats.stops == 1 && fabs(patient.v[299] - patient.v[298] - 0.001) < 1e-12, "%s: no force before", name);
        if (is_lost) {
            CHECK(stats.losses == 1 && patient.count == 300, "%s: %d samples", name, (int)patient.count);
            dpt_device_clear(device);
            double v = state_of(device).velocity[0];
            double most = patient.v[299] + 0.001 * (bit == DPT_REASON_SILENT ? 5.0 : 1.0);
            CHECK(v <= most + 1e-12 && state_of(device).velocity[0] == v, "%s: force in the dark, %g Ns", name,
                  v - patient.v[299]);
        } else {
            CHECK(patient.reasons == bit && stats.not_ready == 100, "%s: %d not ready", name, (int)stats.not_ready);
            for (int n = 301; n < 400; n++)
                CHECK(patient.v[n] == patient.v[300], "%s, period %d: force", name, n);
            for (int n = 401; n < 499; n++) {
                double force = (patient.v[n + 1] - patient.v[n]) * 1000.0;
                CHECK(fabs(force - 0.01 * (double)(n - 400)) < 1e-9, "%s: %g N at %d", name, force, n);
            }
            CHECK(fabs(patient.v[699] - patient.v[698] - 0.001) < 1e-12, "%s: it does not come back", name);
        }
        dpt_loop_close(loop);
        dpt_device_close(device);
    }
}
/* An argument: how many ticks by the clock. */
int main(int argc, char **argv)
{
    if (argc > 1)
        live_ticks = strtoull(argv[1], NULL, 10);
    TEST(sixty_thousand_ticks_lose_nothing);
    TEST(every_trouble_is_counted);
    TEST(commands_arrive_in_turn);
    TEST(no_late_tick_goes_unnoticed);
    TEST(a_tick_that_hangs_gives_no_force);
    TEST(every_fault_ends_the_force);
    return check_report();
}
