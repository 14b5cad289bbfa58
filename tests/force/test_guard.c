/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The guard on a clock of the test's own: each state meets each event, and random schedules keep what the header
 * promises.
 */
#include "dynpoint/guard.h"
#include "lib/check.h"
#include "lib/vector.h"

static const uint64_t MS = 1000000u;
static const uint64_t BEGIN = 5000000000u;

static dpt_wrench push(double force)
{
    dpt_wrench wrench = { { 0.6 * force, -0.8 * force, 0.0 }, { 0.0, 0.0, 0.01 * force } };
    return wrench;
}

static int is_zero(const dpt_wrench *wrench)
{
    return length3(wrench->force) == 0.0 && length3(wrench->torque) == 0.0;
}

static int is_same(const dpt_wrench *a, const dpt_wrench *b)
{
    return memcmp(a, b, sizeof *a) == 0;
}

static dpt_guard guard_of(const dpt_guard_def *def)
{
    dpt_guard guard = { .size = sizeof guard };
    CHECK(dpt_guard_init(&guard, def) == DPT_OK, "the def is refused");
    return guard;
}

static dpt_guard_info info_of(const dpt_guard *guard)
{
    dpt_guard_info info = { .size = sizeof info };
    CHECK(dpt_guard_get_info(guard, &info) == DPT_OK, "no info");
    return info;
}

/* Ticks of 1 ms with fresh commands until it runs; the time of the last. */
static uint64_t bring_to_run(dpt_guard *guard, const dpt_wrench *command)
{
    uint64_t now = BEGIN;
    dpt_wrench out;
    for (int i = 0; i < 1000 && info_of(guard).state != DPT_GUARD_RUNNING; i++)
        dpt_guard_step(guard, now += MS, command, 1, &out);
    return now;
}

/* A guard in `state`, whose last fresh command came at the returned time. */
static uint64_t bring_to(dpt_guard *guard, uint32_t state, const dpt_wrench *command)
{
    dpt_wrench out;
    uint64_t now = BEGIN;
    *guard = guard_of(NULL);
    if (state == DPT_GUARD_STARTING)
        for (int i = 0; i < 20; i++)
            dpt_guard_step(guard, now += MS, command, 1, &out);
    if (state == DPT_GUARD_RUNNING || state == DPT_GUARD_STOPPING)
        now = bring_to_run(guard, command);
    if (state == DPT_GUARD_STOPPING)
        dpt_guard_step(guard, now + 4 * MS, NULL, 1, &out);
    CHECK(info_of(guard).state == state, "in %u, not in %u", info_of(guard).state, state);
    return now;
}

enum event {
    FRESH, /* a tick after the last one */
    NOTHING,
    SILENT_HOLD,
    SILENT_RAMP,
    SILENT_LONG,
    LATE_FRESH, /* fresh, but after hold and stop are over */
    TOO_STRONG,
    TOO_TWISTED,
    NOT_A_NUMBER,
    INFINITE,
    NOT_READY,
    NOT_READY_FRESH,
    CLOCK_BACK,
    EVENTS
};

static const char *const event_names[EVENTS] = { "fresh",        "nothing",    "hold",       "ramp",
                                                 "long silence", "late fresh", "too strong", "too twisted",
                                                 "NaN",          "infinite",   "not ready",  "not ready and fresh",
                                                 "clock back" };

/* What each state becomes; * where the force must be zero at once. */
static const char *const becomes[4] = {
    /* fresh nothing hold ramp long late strong twisted nan inf unready unready-fresh back */
    "S O* O* O* O* S S S O* O* O* O* O*",
    "S S S D O* S S S O* O* O* O* S",
    "R R R D O* S R R O* O* O* O* R",
    "S D D D O* S S S O* O* O* O* D",
};

static void every_state_meets_every_event(void)
{
    static const char letters[] = "OSRD";
    const dpt_wrench command = push(2.0), strong = push(1e200);
    dpt_wrench bad = push(1.0), infinite = push(1.0), twisted = push(1.0);
    bad.torque[2] = NAN;
    infinite.force[0] = INFINITY;
    twisted.torque[0] = 1.0;
    for (uint32_t state = 0; state < 4; state++) {
        const char *expected = becomes[state];
        for (int event = 0; event < EVENTS; event++) {
            dpt_guard guard;
            uint64_t fresh = bring_to(&guard, state, &command);
            uint64_t base = state == DPT_GUARD_STOPPING ? fresh + 4 * MS : fresh;
            dpt_wrench out, before = info_of(&guard).sent;
            uint64_t at[EVENTS];
            for (int i = 0; i < EVENTS; i++)
                at[i] = base + 1;
            at[SILENT_HOLD] = fresh + 3 * MS;
            at[SILENT_RAMP] = fresh + 4 * MS + 1;
            at[SILENT_LONG] = fresh + 5 * MS;
            at[LATE_FRESH] = fresh + 900 * MS;
            at[CLOCK_BACK] = base - MS;
            const dpt_wrench *given = NULL;
            if (event == FRESH || event == LATE_FRESH || event == NOT_READY_FRESH)
                given = &command;
            if (event == TOO_STRONG)
                given = &strong;
            if (event == TOO_TWISTED)
                given = &twisted;
            if (event == NOT_A_NUMBER)
                given = &bad;
            if (event == INFINITE)
                given = &infinite;
            dpt_guard_step(&guard, at[event], given, event != NOT_READY && event != NOT_READY_FRESH, &out);
            const dpt_guard_info after = info_of(&guard);
            CHECK(letters[after.state] == *expected, "%u, %s: %c, not %c", state, event_names[event],
                  letters[after.state], *expected);
            if (expected[1] == '*')
                CHECK(is_zero(&out), "%u, %s: %g N", state, event_names[event], length3(out.force));
            CHECK(is_same(&out, &after.sent), "%u, %s: another wrench is kept", state, event_names[event]);
            CHECK(length3(out.force) <= 5.0 && length3(out.torque) <= 0.2, "%u, %s: too strong", state,
                  event_names[event]);
            if (event == NOTHING && state == DPT_GUARD_RUNNING)
                CHECK(is_same(&out, &before), "a command does not hold");
            CHECK((after.not_finite == 1) == (event == NOT_A_NUMBER || event == INFINITE), "%u, %s: %d not finite",
                  state, event_names[event], (int)after.not_finite);
            CHECK((after.clamped == 1) == (event == TOO_STRONG || event == TOO_TWISTED), "%u, %s: %d clamped", state,
                  event_names[event], (int)after.clamped);
            int was_on = state == DPT_GUARD_STARTING || state == DPT_GUARD_RUNNING;
            int stops = expected[0] == 'O' || expected[0] == 'D' || event == LATE_FRESH;
            uint64_t earlier = state == DPT_GUARD_STOPPING;
            CHECK(after.stops == earlier + (uint64_t)(was_on && stops), "%u, %s: %d stops", state, event_names[event],
                  (int)after.stops);
            expected += strcspn(expected, " ");
            expected += *expected == ' ';
        }
    }
}

/* 1 kHz, the defaults: three ticks hold, the fourth half, the fifth and all after it zero. */
static void silence_ends_in_five_ticks(void)
{
    const dpt_wrench command = push(2.0);
    dpt_guard guard;
    uint64_t now = bring_to(&guard, DPT_GUARD_RUNNING, &command);
    dpt_wrench out, before = info_of(&guard).sent;
    for (int tick = 1; tick <= 20; tick++) {
        dpt_guard_step(&guard, now += MS, NULL, 1, &out);
        if (tick <= 3)
            CHECK(is_same(&out, &before), "tick %d: %g N", tick, length3(out.force));
        if (tick == 4)
            CHECK(fabs(length3(out.force) - 1.0) < 1e-12, "half way: %g N", length3(out.force));
        if (tick >= 5)
            CHECK(is_zero(&out), "tick %d: %g N", tick, length3(out.force));
    }
    CHECK(info_of(&guard).stops == 1 && info_of(&guard).state == DPT_GUARD_OFF, "%d stops", (int)info_of(&guard).stops);
}

/* The ramp to zero is a matter of time: seldom or often looked at, the same force at the same moment. */
static void ramp_does_not_depend_on_calls(void)
{
    const dpt_wrench command = push(3.0);
    for (uint64_t at = 3 * MS + 1; at < 5 * MS; at += 77777) {
        dpt_guard seldom, often;
        dpt_wrench a, b;
        uint64_t now = bring_to(&seldom, DPT_GUARD_RUNNING, &command);
        bring_to(&often, DPT_GUARD_RUNNING, &command);
        for (uint64_t t = 1000; t < at; t += 1000)
            dpt_guard_step(&often, now + t, NULL, 1, &b);
        dpt_guard_step(&seldom, now + at, NULL, 1, &a);
        dpt_guard_step(&often, now + at, NULL, 1, &b);
        double part = (double)(5 * MS - at) / (double)(2 * MS);
        CHECK(is_same(&a, &b), "%g and %g N", length3(a.force), length3(b.force));
        CHECK(fabs(length3(a.force) - 3.0 * part) < 1e-12, "%g N", length3(a.force));
    }
}

/* 0.1 s from nothing to all of it, in a straight line; from the middle of a stop it goes on where that was. */
static void start_is_a_ramp(void)
{
    const dpt_wrench command = push(2.0);
    dpt_guard guard = guard_of(NULL);
    dpt_wrench out;
    for (uint64_t tick = 0; tick <= 150; tick++) {
        dpt_guard_step(&guard, BEGIN + tick * MS, &command, 1, &out);
        double part = tick < 100 ? (double)tick * 0.01 : 1.0;
        CHECK(fabs(length3(out.force) - 2.0 * part) < 1e-12, "tick %d: %g N", (int)tick, length3(out.force));
    }
    CHECK(is_same(&out, &command) && info_of(&guard).slewed == 0, "it does not get there");
    uint64_t now = BEGIN + 150 * MS + 4 * MS + MS / 2;
    for (uint64_t tick = 0; tick < 20; tick++) {
        dpt_guard_step(&guard, now + tick * MS, &command, 1, &out);
        CHECK(fabs(length3(out.force) - 2.0 * (0.25 + 0.01 * (double)tick)) < 1e-12, "tick %d after a stop: %g N",
              (int)tick, length3(out.force));
    }
    CHECK(info_of(&guard).state == DPT_GUARD_STARTING, "it has not started again");
}

static void slew_is_a_straight_line(void)
{
    dpt_guard_def def;
    dpt_guard_def_init(&def);
    def.start = 0.0;
    def.force_slew = 100.0;
    def.torque_slew = 0.0;
    const dpt_wrench one = push(1.0), other = push(-1.0);
    dpt_guard guard = guard_of(&def);
    dpt_wrench out;
    for (uint64_t tick = 0; tick <= 10; tick++)
        dpt_guard_step(&guard, BEGIN + tick * MS, &one, 1, &out);
    CHECK(fabs(length3(out.force) - 1.0) < 1e-12, "1 N after 10 ms at 100 N/s: %g", length3(out.force));
    for (uint64_t tick = 1; tick <= 20; tick++) {
        dpt_guard_step(&guard, BEGIN + (10 + tick) * MS, &other, 1, &out);
        CHECK(fabs(out.force[0] - 0.6 * (1.0 - 0.1 * (double)tick)) < 1e-12, "%g N", out.force[0]);
        CHECK(out.torque[2] == other.torque[2], "torque has no slew, and is late");
    }
}

/* As long as it may be, to the last bit. */
static void limit_to(double *v, double most)
{
    double size = length3(v);
    if (size == 0.0 || size > 1e300)
        return;
    for (int k = 0; k < 3; k++)
        v[k] *= most / size;
    while (length3(v) > most)
        for (int k = 0; k < 3; k++)
            v[k] *= 1.0 - 0x1p-53;
}

/* The command of a step: mostly the one before; at times one far above the limits, or just at them. */
static void next_command(uint64_t *random, int step, int gives, double calm, double force_max, dpt_wrench *command)
{
    if (gives && random_in(random, 0.0, 1.0) > 0.7 * calm) {
        double scale = pow(10.0, random_in(random, -3.0, 1.5));
        for (int k = 0; k < 3; k++) {
            command->force[k] = random_in(random, -scale, scale);
            command->torque[k] = random_in(random, -scale, scale);
        }
        if (random_in(random, 0.0, 1.0) < 0.01)
            command->force[step % 3] = 1e308;
    }
    if (step % 16 == 0)
        limit_to(command->force, force_max);
}

/* No step changes the wrench by more than the slew allows in dt, but for the fall to zero of a stop. */
static void check_slew(const dpt_guard_def *def, const dpt_wrench *before, const dpt_wrench *out, double dt,
                       int stopped, const char *at)
{
    double change[3], turn[3];
    for (int k = 0; k < 3; k++) {
        change[k] = out->force[k] - before->force[k];
        turn[k] = out->torque[k] - before->torque[k];
    }
    double force_step = def->force_slew * dt, torque_step = def->torque_slew * dt;
    if (!stopped && def->force_slew > 0.0)
        CHECK(length3(change) <= force_step * (1.0 + 1e-12) + 1e-14, "%s: %g N in %g s", at, length3(change), dt);
    if (!stopped && def->torque_slew > 0.0)
        CHECK(length3(turn) <= torque_step * (1.0 + 1e-12) + 1e-14, "%s: %g Nm in %g s", at, length3(turn), dt);
    if (stopped && def->force_slew > 0.0)
        CHECK(length3(out->force) <= length3(before->force) + force_step * (1.0 + 1e-12) + 1e-14,
              "%s: a stop adds force", at);
}

/* Limits of which some are 0, that is off or at once. */
static dpt_guard_def random_def(uint64_t *random, int run)
{
    dpt_guard_def def;
    dpt_guard_def_init(&def);
    def.force_max = random_in(random, 0.0, 10.0);
    def.torque_max = run % 5 ? random_in(random, 0.0, 1.0) : 0.0;
    def.force_slew = run % 3 ? random_in(random, 1.0, 5000.0) : 0.0;
    def.torque_slew = run % 4 ? random_in(random, 0.1, 100.0) : 0.0;
    def.hold = random_in(random, 0.0, 0.01);
    def.stop = run % 7 ? random_in(random, 0.0, 0.01) : 0.0;
    def.start = run % 6 ? random_in(random, 0.0, 0.1) : 0.0;
    return def;
}

/* Nothing of it is exact that need not be: only the promises of the header. */
static void random_schedules_keep_the_promises(void)
{
    uint64_t random = 7, steps = 0, zero = 0, at_limit = 0, full = 0, stops = 0;
    for (int run = 0; run < 400; run++) {
        const dpt_guard_def def = random_def(&random, run);
        dpt_guard guard = guard_of(&def);
        uint64_t end = (uint64_t)(def.hold * 1e9 + 0.5) + (uint64_t)(def.stop * 1e9 + 0.5);
        uint64_t now = random_bits(&random) >> 20, fresh = 0, earlier_stops = 0;
        int has_fresh = 0;
        dpt_wrench before = push(0.0), command = push(0.0);
        double calm = random_in(&random, 0.0, 1.0);
        for (int step = 0; step < 2000; step++) {
            double what = random_in(&random, 0.0, 1.0);
            uint64_t passed = (uint64_t)(random_in(&random, 0.0, 2e6));
            if (what > 0.99)
                passed = (uint64_t)random_in(&random, 0.0, 2e9);
            int back = what < 0.005;
            uint64_t last = now;
            now = back ? now : now + passed;
            int was_stopping = info_of(&guard).state == DPT_GUARD_STOPPING;
            int gives = random_in(&random, 0.0, 1.0) < 0.2 + 0.8 * calm;
            int ready = random_in(&random, 0.0, 1.0) > 0.003;
            int finite = 1;
            next_command(&random, step, gives, calm, def.force_max, &command);
            dpt_wrench given = command, out;
            if (random_in(&random, 0.0, 1.0) < 0.002) {
                given.torque[step % 3] = step & 1 ? NAN : -INFINITY;
                finite = 0;
            }
            dpt_guard_step(&guard, back ? now - passed : now, gives ? &given : NULL, ready, &out);
            if (gives && finite && ready) {
                fresh = now;
                has_fresh = 1;
            }
            double force = length3(out.force), torque = length3(out.torque);
            CHECK(force <= def.force_max && torque <= def.torque_max, "run %d: %g N, %g Nm", run, force, torque);
            if (!has_fresh || now - fresh >= end || !ready || (gives && !finite))
                if (!(has_fresh && now == fresh && ready))
                    CHECK(is_zero(&out), "run %d, step %d: %g N", run, step, force);
            int stopped = was_stopping || info_of(&guard).stops != earlier_stops ||
                          info_of(&guard).state == DPT_GUARD_STOPPING || info_of(&guard).state == DPT_GUARD_OFF;
            char at[64];
            snprintf(at, sizeof at, "run %d, step %d", run, step);
            check_slew(&def, &before, &out, (double)(now - last) * 1e-9, stopped, at);
            steps++;
            zero += (uint64_t)is_zero(&out);
            at_limit += force > 0.999 * def.force_max;
            full += info_of(&guard).state == DPT_GUARD_RUNNING && gives && is_same(&out, &command);
            earlier_stops = info_of(&guard).stops;
            before = out;
        }
        stops += info_of(&guard).stops;
    }
    CHECK(zero > steps / 20 && at_limit > steps / 100 && full > steps / 100 && stops > 1000,
          "the schedules are too tame: of %d steps %d zero, %d at the limit, %d as asked, %d stops", (int)steps,
          (int)zero, (int)at_limit, (int)full, (int)stops);
}

/* Of the last command and of what left: clamped, and on its ramp. */
static void it_tells_what_it_did(void)
{
    const dpt_wrench command = push(20.0);
    dpt_guard guard = guard_of(NULL);
    dpt_wrench out;
    dpt_guard_info before = info_of(&guard);
    CHECK(before.state == DPT_GUARD_OFF && !before.fresh_ns && is_zero(&before.command), "at first");
    for (uint64_t tick = 0; tick <= 50; tick++)
        dpt_guard_step(&guard, BEGIN + tick * MS, &command, 1, &out);
    dpt_guard_step(&guard, BEGIN + 51 * MS, NULL, 1, &out);
    const dpt_guard_info after = info_of(&guard);
    CHECK(fabs(length3(after.command.force) - 5.0) < 1e-12 && is_same(&after.sent, &out), "commanded %g N, sent %g N",
          length3(after.command.force), length3(after.sent.force));
    CHECK(after.clamped == 51 && after.now_ns == BEGIN + 51 * MS && after.fresh_ns == BEGIN + 50 * MS &&
              fabs(after.gain - 0.51) < 1e-12,
          "%d clamped, gain %g", (int)after.clamped, after.gain);
}

static void is_total(void)
{
    dpt_guard guard = { .size = sizeof guard };
    dpt_wrench out = push(1.0), command = push(1.0);
    dpt_guard_def def;
    dpt_guard_step(NULL, BEGIN, &command, 1, &out);
    CHECK(is_zero(&out), "no guard, %g N", length3(out.force));
    for (int filled = 0; filled < 256; filled++) {
        dpt_guard_info info = { .size = sizeof info, .state = 7, .sent = push(1.0) };
        memset(&guard, filled, sizeof guard);
        for (int knows_size = 0; knows_size < 2; knows_size++) {
            out = push(1.0);
            dpt_guard_step(&guard, BEGIN, &command, 1, &out);
            CHECK(is_zero(&out), "memory of %02x, size %u: %g N", (unsigned)filled, guard.size, length3(out.force));
            CHECK(dpt_guard_get_info(&guard, &info) == DPT_E_ARGUMENT && info.state == DPT_GUARD_OFF &&
                      is_zero(&info.sent),
                  "memory of %02x: what it did is told", (unsigned)filled);
            guard.size = sizeof guard;
        }
    }
    CHECK(dpt_guard_get_info(NULL, NULL) == DPT_E_ARGUMENT, "no guard");
    CHECK(dpt_guard_init(NULL, NULL) == DPT_E_ARGUMENT, "NULL");
    guard.size = 8;
    CHECK(dpt_guard_init(&guard, NULL) == DPT_E_SIZE, "a size that is not known");
    dpt_guard_def_init(&def);
    CHECK(def.size == sizeof def, "%u", def.size);
    double *const fields[] = { &def.force_max, &def.torque_max, &def.force_slew, &def.torque_slew,
                               &def.hold,      &def.stop,       &def.start };
    for (size_t i = 0; i < sizeof fields / sizeof *fields; i++) {
        const double wrong[] = { NAN, INFINITY, -1e-300 };
        double right = *fields[i];
        for (int k = 0; k < 3; k++) {
            *fields[i] = wrong[k];
            guard.size = sizeof guard;
            CHECK(dpt_guard_init(&guard, &def) == DPT_E_ARGUMENT, "field %d is %g", (int)i, wrong[k]);
            dpt_guard_step(&guard, BEGIN, &command, 1, &out);
            CHECK(is_zero(&out), "a guard that was refused gives %g N", length3(out.force));
        }
        *fields[i] = right;
    }
    def.size = 1;
    guard.size = sizeof guard;
    CHECK(dpt_guard_init(&guard, &def) == DPT_E_SIZE, "a def of another size");
    dpt_guard_def_init(&def);
    def.start = def.force_slew = 0.0;
    guard = guard_of(&def);
    dpt_guard_step(&guard, BEGIN, &command, 1, &out);
    CHECK(!is_zero(&out), "a guard without a ramp gives nothing");
    guard.size = 4104;
    CHECK(dpt_guard_init(&guard, &def) == DPT_E_SIZE, "a size that was never set");
    dpt_guard_step(&guard, BEGIN, &command, 1, &out);
    CHECK(is_zero(&out), "a guard that was refused another time gives %g N", length3(out.force));
    dpt_guard_def_defaults(NULL, 8);
    guard = guard_of(NULL);
    dpt_guard_step(&guard, BEGIN, &command, 1, NULL);
    CHECK(info_of(&guard).state == DPT_GUARD_STARTING, "without a place to write to");
}

int main(void)
{
    TEST(every_state_meets_every_event);
    TEST(silence_ends_in_five_ticks);
    TEST(ramp_does_not_depend_on_calls);
    TEST(start_is_a_ramp);
    TEST(slew_is_a_straight_line);
    TEST(random_schedules_keep_the_promises);
    TEST(it_tells_what_it_did);
    TEST(is_total);
    return check_report();
}
