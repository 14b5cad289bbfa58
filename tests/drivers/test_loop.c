/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The servo loop. A driver of the test's own, from outside of the library, stands between the loop and a simulated device,
 * and loses, repeats, reorders and refuses by a seeded plan: what the loop counts must be what was done to it. Then the
 * same by the clock, with ticks that take too long; faults, unplugging, stopping, several devices.
 */
#include <math.h>
#include <pthread.h>
#include <signal.h>
#include <sys/time.h>
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
    dpt_wrench acts; /* what it gives: the last that it took; nothing while it is not ready */
    uint64_t taken, taken_ns;   /* how many it took; the time of the sample before the last one */
    int is_off;                 /* the last read said so */
    uint64_t first_ns, last_ns; /* of writes, by the clock */
};

static uint64_t clock_ns(void)
{
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (uint64_t)time.tv_sec * 1000000000u + (uint64_t)time.tv_nsec;
}

static void rest(double seconds)
{
    struct timespec time = { (time_t)seconds, (long)(1e9 * (seconds - floor(seconds))) };
    while (nanosleep(&time, &time) != 0)
        continue;
}

static dpt_result flaky_open(const dpt_driver *driver, const char *where, dpt_device **device,
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

static void flaky_info(const dpt_device *device, dpt_device_info *info)
{
    dpt_device_get_info(((const struct flaky *)device)->inner, info);
}

static enum trouble next_trouble(struct flaky *flaky)
{
    double dice = random_in(&flaky->random, 0.0, 1.0);
    for (int trouble = REPEAT; trouble < BUSY; trouble++, dice -= flaky->share)
        if (dice < flaky->share)
            return (enum trouble)trouble;
    return NONE;
}

static void stop_acting(struct flaky *flaky)
{
    static const dpt_wrench zero;
    flaky->acts = zero;
    flaky->taken_ns = 0;
}

static dpt_result read_in_trouble(struct flaky *flaky, dpt_device_state *state)
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
        state->pose.orientation[flaky->did[BAD_POSE] % 4] =
            flaky->did[BAD_POSE] % 8 < 4 ? NAN : 2.0;
    return result;
}

/* What is not ready has stopped by itself: its next sample is of a time without force. */
static dpt_result flaky_read(dpt_device *device, dpt_device_state *state)
{
    struct flaky *flaky = (struct flaky *)device;
    if (flaky->is_off)
        stop_acting(flaky);
    const dpt_result result = read_in_trouble(flaky, state);
    flaky->is_off = result == DPT_E_LOST || state->status != DPT_DEVICE_STATUS_READY;
    return result;
}

static dpt_result flaky_write(dpt_device *device, const dpt_wrench *wrench)
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

static dpt_result flaky_clear(dpt_device *device)
{
    struct flaky *flaky = (struct flaky *)device;
    flaky->cleared++;
    flaky->is_out = 0;
    return dpt_device_clear(flaky->inner);
}

static void flaky_counts(const dpt_device *device, dpt_device_counts *counts)
{
    dpt_device_get_counts(((const struct flaky *)device)->inner, counts);
}

static void flaky_close(dpt_device *device)
{
    dpt_device_close(((struct flaky *)device)->inner);
    free(device);
}

static const dpt_driver flaky_driver = { sizeof(dpt_driver), DPT_DRIVER_VERSION, "flaky",
                                         "a bad line",       flaky_open,         flaky_info,
                                         flaky_read,         flaky_write,        flaky_clear,
                                         flaky_counts,       flaky_close,        NULL };

static struct flaky *flaky_over(const char *name)
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
    uint64_t seen_ns, seen_taken;
    double force;
    double slow; /* s that every 50th tick takes longer */
    dpt_loop *loop;
    uint64_t stop_at;
};

/* What the loop says was sent is what the device has, and no other. */
static void compare_sent(struct host *host, const dpt_loop_sample *sample)
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

static dpt_result feel(void *user, const dpt_loop_sample *sample, dpt_wrench *wrench)
{
    struct host *host = user;
    const dpt_device_state *state = sample->state;
    double passed = host->seen_ns ? (double)(state->time_ns - host->seen_ns) * 1e-9 : 0.001;
    host->wrong_dt += fabs(sample->dt - passed) > 1e-12;
    host->seen_ns = state->time_ns;
    host->ticks++;
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
    if (host->flaky && host->flaky->share > 0.0 && host->ticks % 89 == 0 &&
        state->status == DPT_DEVICE_STATUS_READY) {
        host->nans++;
        wrench->torque[1] = NAN;
    }
    return DPT_OK;
}

static dpt_loop_def def_for(struct host *host)
{
    dpt_loop_def def;
    dpt_loop_def_init(&def);
    def.tick = feel;
    def.user = host;
    def.lock = 0;
    def.priority = 0;
    return def;
}

static dpt_guard_def guard_without_ramps(double force_max)
{
    dpt_guard_def def;
    dpt_guard_def_init(&def);
    def.force_max = force_max;
    def.force_slew = def.torque_slew = def.start = 0.0;
    return def;
}

static dpt_loop *loop_of(dpt_device *device, const dpt_loop_def *def)
{
    dpt_loop *loop = NULL;
    dpt_result result = dpt_loop_create(device, def, &loop);
    CHECK(result == DPT_OK, "%s", dpt_result_name(result));
    return loop;
}

static uint64_t sum_of(const uint64_t *bins)
{
    uint64_t sum = 0;
    for (int i = 0; i < DPT_LOOP_BINS; i++)
        sum += bins[i];
    return sum;
}

/* What must hold of every run. */
static void check_sums(const dpt_loop_stats *stats)
{
    CHECK(stats->fresh + stats->failed + stats->stale + stats->not_ready + stats->lost ==
              stats->ticks,
          "of %d ticks %d fresh, %d failed, %d stale, %d not ready, %d lost", (int)stats->ticks,
          (int)stats->fresh, (int)stats->failed, (int)stats->stale, (int)stats->not_ready,
          (int)stats->lost);
}

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
    CHECK(stats.fresh == 60000 && host.ticks == 60000 && stats.sent == 60000 &&
              counts.samples == 60000,
          "%d fresh", (int)stats.fresh);
    CHECK(counts.commands == 60001 && counts.missed == 0 && host.wrong_dt == 0,
          "%d commands, %d missed", (int)counts.commands, (int)counts.missed);
    CHECK(!stats.missed && !stats.skipped && !stats.stops && !stats.refused && !stats.clamped &&
              !stats.slewed,
          "something was wrong");
    dpt_loop_free(loop);
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
    const dpt_guard_def guard = guard_without_ramps(1000.0);
    def.guard = &guard;
    dpt_loop *loop = loop_of(&flaky->device, &def);
    dpt_loop_stats stats = { .size = sizeof stats };
    dpt_result result = dpt_loop_run(loop, &stats);
    CHECK(result == DPT_OK || result == DPT_E_LOST, "%s", dpt_result_name(result));
    check_sums(&stats);
    const uint64_t *did = flaky->did;
    CHECK(did[OLD] == stats.reordered && did[SKIP] * 2 == flaky->skipped,
          "%d reordered, %d counted", (int)did[OLD], (int)stats.reordered);
    CHECK(did[REPEAT] + did[OLD] + did[ERROR] == stats.stale,
          "%d repeats, %d old, %d errors; %d stale", (int)did[REPEAT], (int)did[OLD],
          (int)did[ERROR], (int)stats.stale);
    CHECK(did[UNPLUG] == stats.lost && flaky->losses == stats.losses, "%d of %d losses",
          (int)stats.losses, (int)flaky->losses);
    CHECK(flaky->cleared == stats.reopened || flaky->cleared == stats.reopened + 1,
          "%d of %d came back", (int)stats.reopened, (int)flaky->cleared);
    CHECK(did[FAULT] + did[BAD_POSE] == stats.not_ready && did[FAULT] == host.not_ready,
          "%d faults, %d bad poses; %d not ready", (int)did[FAULT], (int)did[BAD_POSE],
          (int)stats.not_ready);
    CHECK(flaky->skipped == stats.skipped, "%d samples skipped, %d counted", (int)flaky->skipped,
          (int)stats.skipped);
    CHECK(host.failures == stats.failed && host.commands == stats.fresh, "%d failed, %d fresh",
          (int)stats.failed, (int)stats.fresh);
    CHECK(host.nans == stats.not_finite && host.not_zero == 0, "%d not finite, %d counted",
          (int)host.nans, (int)stats.not_finite);
    CHECK(did[BUSY] == stats.refused || did[BUSY] == stats.refused + 1, "%d busy, %d refused",
          (int)did[BUSY], (int)stats.refused);
    CHECK(stats.sent + stats.refused < flaky->writes &&
              flaky->writes < stats.sent + stats.refused + 11,
          "%d writes for %d", (int)flaky->writes, (int)(stats.sent + stats.refused));
    CHECK(host.wrong_sent == 0 && host.wrong_count == 0,
          "%d ticks were told of another wrench, %d of another number", (int)host.wrong_sent,
          (int)host.wrong_count);
    CHECK(host.acted > 5000 && host.kept > 20 && host.several > 100 && host.off > 100,
          "%d with force, %d with an older one, %d after several, %d after none", (int)host.acted,
          (int)host.kept, (int)host.several, (int)host.off);
    for (int trouble = REPEAT; trouble < TROUBLES; trouble++)
        CHECK(did[trouble] > 20, "trouble %d only %d times", trouble, (int)did[trouble]);
    CHECK(stats.stops > flaky->losses && flaky->written.force[0] == 0.0, "%d stops",
          (int)stats.stops);
    dpt_loop_free(loop);
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
    dpt_loop_free(loop);
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
    dpt_loop *loop = loop_of(&flaky->device, &def);
    dpt_loop_stats stats = { .size = sizeof stats };
    CHECK(dpt_loop_run(loop, &stats) == DPT_OK, "the run failed");
    check_sums(&stats);
    double periods = (double)(flaky->last_ns - flaky->first_ns) * 1e3 * 1e-9;
    double slack = 2.0 * (stats.late_max + stats.took_max) * 1e3 + 3.0;
    CHECK(stats.missed >= 3 * (host.ticks / 50), "%d missed, of %d slow ticks", (int)stats.missed,
          (int)(host.ticks / 50));
    CHECK(fabs(periods - (double)(stats.ticks + stats.missed)) <= slack,
          "%.1f periods, %d ticks, %d missed, slack %.1f", periods, (int)stats.ticks,
          (int)stats.missed, slack);
    CHECK(sum_of(stats.late) == stats.ticks && sum_of(stats.took) == stats.ticks,
          "%d and %d in the histograms", (int)sum_of(stats.late), (int)sum_of(stats.took));
    CHECK(dpt_loop_quantile(stats.took, 1.0) >= 0.0035 && stats.took_max >= 0.0035,
          "the slowest took %g s", stats.took_max);
    dpt_device_counts counts = counts_of(&flaky->device);
    uint64_t samples = stats.fresh + stats.skipped;
    CHECK(counts.samples >= samples && (double)counts.samples <= (double)samples + slack + 1.0,
          "%d samples, %d seen and %d skipped", (int)counts.samples, (int)stats.fresh,
          (int)stats.skipped);
    CHECK(counts.commands == flaky->writes && host.wrong_dt == 0, "%d commands of %d",
          (int)counts.commands, (int)flaky->writes);
    CHECK(host.wrong_sent == 0 && host.wrong_count == 0 && host.acted > 0,
          "%d ticks were told of another wrench, %d of another number", (int)host.wrong_sent,
          (int)host.wrong_count);
    printf("    late: median %.3g us, 99 %% %.3g us, most %.3g us; %d of %d deadlines missed, %d "
           "stops%s%s\n",
           1e6 * dpt_loop_quantile(stats.late, 0.5), 1e6 * dpt_loop_quantile(stats.late, 0.99),
           1e6 * stats.late_max, (int)stats.missed, (int)(stats.missed + stats.ticks),
           (int)stats.stops, stats.notes & DPT_LOOP_NOTE_NO_PRIORITY ? "; no priority" : "",
           stats.notes & DPT_LOOP_NOTE_NO_LOCK ? "; no lock" : "");
    dpt_loop_free(loop);
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
    CHECK(hang.before > 0.0 && hang.after - hang.before <= 0.0121, "%g Ns in the dark",
          hang.after - hang.before);
    CHECK(hang.sent == 0.0, "a command that took long is sent with %g N", hang.sent);
    CHECK(stats.stops >= 1 && stats.missed >= 198 && counts_of(&flaky->device).missed >= 180,
          "%d stops, %d missed", (int)stats.stops, (int)stats.missed);
    dpt_loop_free(loop);
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
        CHECK(stats.stops == 1 && fabs(patient.v[299] - patient.v[298] - 0.001) < 1e-12,
              "%s: no force before", name);
        if (is_lost) {
            CHECK(stats.losses == 1 && patient.count == 300, "%s: %d samples", name,
                  (int)patient.count);
            dpt_device_clear(device);
            double v = state_of(device).velocity[0];
            double most = patient.v[299] + 0.001 * (bit == DPT_REASON_SILENT ? 5.0 : 1.0);
            CHECK(v <= most + 1e-12 && state_of(device).velocity[0] == v,
                  "%s: force in the dark, %g Ns", name, v - patient.v[299]);
        } else {
            CHECK(patient.reasons == bit && stats.not_ready == 100, "%s: %d not ready", name,
                  (int)stats.not_ready);
            for (int n = 301; n < 400; n++)
                CHECK(patient.v[n] == patient.v[300], "%s, period %d: force", name, n);
            for (int n = 401; n < 499; n++) {
                double force = (patient.v[n + 1] - patient.v[n]) * 1000.0;
                CHECK(fabs(force - 0.01 * (double)(n - 400)) < 1e-9, "%s: %g N at %d", name, force,
                      n);
            }
            CHECK(fabs(patient.v[699] - patient.v[698] - 0.001) < 1e-12,
                  "%s: it does not come back", name);
        }
        dpt_loop_free(loop);
        dpt_device_close(device);
    }
}

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
    CHECK(stats.losses == 1 && stats.reopened == 1 && stats.lost == 1001 && stats.fresh == 3999,
          "%d lost, %d fresh", (int)stats.lost, (int)stats.fresh);
    dpt_loop_free(loop);
    def.reopen = 0;
    loop = loop_of(&flaky->device, &def);
    flaky->is_out = 1;
    CHECK(dpt_loop_run(loop, &stats) == DPT_E_LOST && stats.ticks == 1, "%d ticks without a device",
          (int)stats.ticks);
    flaky->is_out = 0;
    CHECK(dpt_loop_run(loop, &stats) == DPT_OK && stats.fresh == 5000, "a second run");
    dpt_loop_free(loop);
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
    CHECK(dpt_loop_run(loop, &stats) == DPT_OK || stats.ticks == 3300, "%d ticks",
          (int)stats.ticks);
    check_sums(&stats);
    CHECK(stats.fresh == 300 && stats.reopened == 2 && stats.losses == 3 && stats.reordered == 0,
          "%d fresh, %d came back, %d reordered", (int)stats.fresh, (int)stats.reopened,
          (int)stats.reordered);
    dpt_loop_free(loop);
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
    CHECK(dpt_loop_run(loop, &stats) == DPT_OK && stats.ticks == 0 && flaky->writes == 1,
          "stopped before it ran: %d", (int)stats.ticks);

    host.stop_at = 100;
    CHECK(dpt_loop_run(loop, &stats) == DPT_OK && host.ticks == 100, "by a tick, after %d",
          (int)host.ticks);
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
    dpt_loop_free(loop);
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
        dpt_loop_free(served[i].loop);
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
        CHECK(flaky->strongest >= cases[i].least && flaky->strongest <= cases[i].most, "%s: %g N",
              cases[i].name, flaky->strongest);
        dpt_loop_free(loop);
        dpt_device_close(&flaky->device);
    }
}

static void wrong_defs_are_refused(void)
{
    dpt_device *device = device_named("sim"), *slow = device_named("sim:?rate=250");
    dpt_loop_def good = def_for(NULL), def = good;
    dpt_loop *loop = (dpt_loop *)&def;
    dpt_loop_stats stats = { .size = 8 };
    CHECK(dpt_loop_create(NULL, &def, &loop) == DPT_E_ARGUMENT && !loop, "no device");
    CHECK(dpt_loop_create(device, NULL, &loop) == DPT_E_ARGUMENT, "no def");
    CHECK(dpt_loop_create(device, &def, NULL) == DPT_E_ARGUMENT, "no place");
    def.size--;
    CHECK(dpt_loop_create(device, &def, &loop) == DPT_E_SIZE, "a size that is not known");
    def = good, def.tick = NULL;
    CHECK(dpt_loop_create(device, &def, &loop) == DPT_E_ARGUMENT, "no tick");
    def = good, def.priority = 100;
    CHECK(dpt_loop_create(device, &def, &loop) == DPT_E_ARGUMENT, "priority 100");
    def = good, def.lock = 2;
    CHECK(dpt_loop_create(device, &def, &loop) == DPT_E_ARGUMENT, "lock 2");
    def = good, def.reopen = 2;
    CHECK(dpt_loop_create(device, &def, &loop) == DPT_E_ARGUMENT, "reopen 2");
    const double rates[] = { NAN, -1.0, 0.5, 1e6, INFINITY };
    for (int i = 0; i < 5; i++) {
        def = good, def.rate = rates[i];
        CHECK(dpt_loop_create(device, &def, &loop) == DPT_E_ARGUMENT, "rate %g", rates[i]);
    }
    dpt_guard_def guard = guard_without_ramps(5.0);
    def = good, def.guard = &guard, guard.hold = NAN;
    CHECK(dpt_loop_create(device, &def, &loop) == DPT_E_ARGUMENT, "hold NaN");
    def = good, def.reserved_pointer = &def;
    CHECK(dpt_loop_create(device, &def, &loop) == DPT_E_ARGUMENT, "a reserved pointer");
    def = good, def.guard = &guard, guard.hold = 0.003, guard.size = 0;
    CHECK(dpt_loop_create(device, &def, &loop) == DPT_E_SIZE, "a guard without a size");
    CHECK(dpt_loop_create(slow, &good, &loop) == DPT_E_ARGUMENT,
          "4 ms a tick, and commands hold for 3");
    def = good, def.guard = &guard, guard.size = sizeof guard, guard.hold = 0.01;
    CHECK(dpt_loop_create(slow, &def, &loop) == DPT_OK, "and for 10");
    CHECK(dpt_loop_run(NULL, &stats) == DPT_E_ARGUMENT && dpt_loop_run(loop, &stats) == DPT_E_SIZE,
          "run");
    dpt_loop_free(loop);
    dpt_loop_free(NULL);
    dpt_loop_def_defaults(NULL, 8);
    dpt_device_close(device);
    dpt_device_close(slow);
}

static void quantiles_are_bin_ends(void)
{
    uint64_t bins[DPT_LOOP_BINS] = { 0 };
    CHECK(dpt_loop_quantile(bins, 0.5) == 0.0 && dpt_loop_quantile(NULL, 0.5) == 0.0, "nothing");
    bins[0] = 50, bins[40] = 49, bins[63] = 1;
    CHECK(fabs(dpt_loop_quantile(bins, 0.5) - 1e-6 * pow(2.0, 0.25)) < 1e-18, "%g",
          dpt_loop_quantile(bins, 0.5));
    CHECK(fabs(dpt_loop_quantile(bins, 0.99) / (1e-6 * pow(2.0, 10.25)) - 1.0) < 1e-12, "%g",
          dpt_loop_quantile(bins, 0.99));
    CHECK(fabs(dpt_loop_quantile(bins, 1.0) / (1e-6 * pow(2.0, 16.0)) - 1.0) < 1e-12, "%g",
          dpt_loop_quantile(bins, 1.0));
    CHECK(dpt_loop_quantile(bins, NAN) == 0.0 && dpt_loop_quantile(bins, 2.0) == 0.0,
          "no fraction");
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
    TEST(a_device_that_comes_back_is_served);
    TEST(a_device_that_begins_anew_is_served);
    TEST(stops_when_asked);
    TEST(several_devices_at_once);
    TEST(limits_are_the_lesser);
    TEST(wrong_defs_are_refused);
    TEST(quantiles_are_bin_ends);
    return check_report();
}
