/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The self-test, on a driver that breaks what it is told to. Behind it is a mass that is still there after a close:
 * each fault must be found, by the line that is about it, and a sound device passes whole.
 */
#include <math.h>
#include <time.h>

#include "drivers/open_device.h"
#include "dynpoint/selftest.h"
#include "lib/size_checks.h"

enum fault {
    SOUND,
    OPENS_ONCE,
    FOUR_FREEDOMS,
    SLOW_RATE,
    GOES_AWAY,
    WRITE_FAILS,
    NEVER_READY,
    FAULT_LATER,
    OUT_OF_STEP,
    SEQUENCE_STANDS,
    SEQUENCE_BACK,
    SEQUENCE_SKIPS,
    ALWAYS_FRESH,
    TIME_BACK,
    HALF_THE_RATE,
    MICROSECONDS,
    TIME_OF_DAY,
    NAN_POSITION,
    NAN_ORIENTATION,
    INFINITE_VELOCITY,
    NAN_SPIN,
    NOT_UNIT,
    OUTSIDE,
    TURNED_WITHOUT_TURNS,
    READ_WAITS,
    WRITE_WAITS,
    DAMAGED,
    LOSSES,
    NO_FORCE,
    REVERSED,
    SWAPPED,
    NO_WATCHDOG,
    FORCE_AFTER_CLOSE,
    MILLIMETRES,
    DEGREES,
    W_LAST,
    W_LAST_AT_REST,
    FAULTS
};

static struct {
    enum fault fault;
    int dofs, turns, is_live, opens, stays_away;
    uint64_t began_ns;
} plan;

/* The machine: it outlives its driver. */
static struct {
    double x[3], v[3], force[3], angle;
    uint64_t period, quiet;
    int is_armed;
} machine;

struct bad {
    dpt_device device;
    uint64_t reads, read_period;
    dpt_device_counts counts;
};

static const double MASS = 0.2, DAMPING = 0.5, SPIN = 1.5, PERIOD = 0.001;

static uint64_t clock_ns(clockid_t clock)
{
    struct timespec time;
    clock_gettime(clock, &time);
    return (uint64_t)time.tv_sec * 1000000000u + (uint64_t)time.tv_nsec;
}

static void dawdle(void)
{
    const struct timespec time = { 0, 400000 };
    nanosleep(&time, NULL);
}

static void go_on(void)
{
    if (++machine.quiet > 10 && plan.fault != NO_WATCHDOG && plan.fault != FORCE_AFTER_CLOSE)
        memset(machine.force, 0, sizeof machine.force);
    for (int k = 0; k < 3; k++) {
        machine.v[k] += PERIOD * (machine.force[k] - DAMPING * machine.v[k]) / MASS;
        machine.x[k] += PERIOD * machine.v[k];
    }
    machine.angle += plan.turns ? PERIOD * SPIN : 0.0;
    machine.period++;
}

static dpt_result bad_open(const dpt_driver *driver, const char *where, dpt_device **device, dpt_device_error *error)
{
    (void)driver, (void)where;
    if (plan.fault == OPENS_ONCE && plan.opens++) {
        snprintf(error->text, sizeof error->text, "the port is in use");
        return DPT_E_DEVICE;
    }
    struct bad *bad = calloc(1, sizeof *bad);
    bad->read_period = machine.period;
    *device = &bad->device;
    return DPT_OK;
}

static void bad_info(const dpt_device *device, dpt_device_info *info)
{
    (void)device;
    info->pose_dofs = plan.fault == FOUR_FREEDOMS ? 4 : (uint32_t)plan.dofs;
    info->wrench_dofs = 3;
    info->flags = plan.is_live ? 0 : DPT_DEVICE_FLAG_DETERMINISTIC;
    info->rate = plan.fault == SLOW_RATE ? 10.0 : plan.fault == HALF_THE_RATE ? 2000.0 : 1000.0;
    info->force_max = 4.0;
    info->watchdog = 0.01;
    for (int k = 0; k < 3; k++) {
        info->workspace_min[k] = plan.fault == OUTSIDE ? 10.0 : -5.0;
        info->workspace_max[k] = plan.fault == OUTSIDE ? 11.0 : 5.0;
    }
}

static void spoil(const struct bad *bad, dpt_device_state *state)
{
    const int now = bad->reads > 50;
    switch (plan.fault) {
    case NEVER_READY:
        state->status = DPT_DEVICE_STATUS_UNREADY;
        break;
    case FAULT_LATER:
        state->status = now ? DPT_DEVICE_STATUS_FAULT : DPT_DEVICE_STATUS_READY;
        break;
    case SEQUENCE_STANDS:
        state->sequence = 7;
        break;
    case SEQUENCE_BACK:
        state->sequence = 1000000 - machine.period;
        break;
    case SEQUENCE_SKIPS:
        state->sequence = 2 * machine.period;
        break;
    case TIME_BACK:
        state->time_ns -= bad->reads % 100 == 99 ? 5000000 : 0;
        break;
    case MICROSECONDS:
        state->time_ns /= 1000;
        break;
    case TIME_OF_DAY:
        state->time_ns = clock_ns(CLOCK_REALTIME);
        break;
    case NAN_POSITION:
        state->pose.position[1] = now ? NAN : 0.0;
        break;
    case NAN_ORIENTATION:
        state->pose.orientation[2] = now ? NAN : 0.0;
        break;
    case INFINITE_VELOCITY:
        state->velocity[0] = now ? -INFINITY : 0.0;
        break;
    case NAN_SPIN:
        state->spin[2] = now ? NAN : 0.0;
        break;
    case NOT_UNIT:
        state->pose.orientation[0] = 1.001;
        break;
    default:
        break;
    }
}

static void fill_in(const struct bad *bad, dpt_device_state *state)
{
    static const double axis[3] = { 0.6, 0.8, 0.0 };
    const double sine = sin(0.5 * machine.angle), cosine = cos(0.5 * machine.angle);
    double q[4] = { cosine, sine * axis[0], sine * axis[1], sine * axis[2] };
    memset(state, 0, sizeof *state);
    state->status = DPT_DEVICE_STATUS_READY;
    state->sequence = machine.period;
    state->time_ns = plan.began_ns + machine.period * 1000000u;
    for (int k = 0; k < 3; k++) {
        state->pose.position[k] = machine.x[k];
        state->velocity[k] = machine.v[k] * (plan.fault == MILLIMETRES ? 1000.0 : 1.0);
        state->spin[k] = plan.turns ? SPIN * axis[k] * (plan.fault == DEGREES ? 57.29577951308232 : 1.0) : 0.0;
    }
    if (plan.fault == W_LAST || plan.fault == W_LAST_AT_REST || plan.fault == TURNED_WITHOUT_TURNS) {
        const double w = q[0];
        memmove(q, q + 1, 3 * sizeof *q);
        q[3] = w;
    }
    memcpy(state->pose.orientation, q, sizeof q);
    spoil(bad, state);
}

static dpt_result bad_read(dpt_device *device, dpt_device_state *state)
{
    struct bad *bad = (struct bad *)device;
    const int is_new = plan.fault != ALWAYS_FRESH && plan.fault != OUT_OF_STEP ? 1 : bad->reads % 2;
    bad->reads++;
    if (plan.is_live)
        while (plan.began_ns + machine.period * 1000000u < clock_ns(CLOCK_MONOTONIC))
            go_on();
    else if (is_new)
        go_on();
    if (plan.fault == READ_WAITS)
        dawdle();
    fill_in(bad, state);
    state->fresh = (uint32_t)(machine.period - bad->read_period);
    if (plan.fault == ALWAYS_FRESH || plan.fault == SEQUENCE_SKIPS)
        state->fresh = 1;
    if (plan.fault == OUT_OF_STEP)
        state->sequence += state->fresh ? 0 : 1;
    bad->read_period = machine.period;
    if (plan.fault == GOES_AWAY && bad->reads > 50)
        return DPT_E_LOST;
    return DPT_OK;
}

static dpt_result bad_write(dpt_device *device, const dpt_wrench *wrench)
{
    (void)device;
    machine.quiet = 0;
    for (int k = 0; k < 3 && plan.fault != NO_FORCE; k++)
        machine.force[plan.fault == SWAPPED ? (k + 1) % 3 : k] =
            (plan.fault == REVERSED ? -1.0 : 1.0) * wrench->force[k];
    if (plan.fault == WRITE_WAITS)
        dawdle();
    return plan.fault == WRITE_FAILS ? DPT_E_SYSTEM : DPT_OK;
}

static dpt_result bad_clear(dpt_device *device)
{
    (void)device;
    return DPT_OK;
}

static void bad_counts(const dpt_device *device, dpt_device_counts *counts)
{
    const struct bad *bad = (const struct bad *)device;
    counts->samples = bad->reads;
    counts->damaged = plan.fault == DAMAGED;
    counts->lost = plan.fault == LOSSES ? bad->reads / 50 : 0;
}

static void bad_close(dpt_device *device)
{
    if (plan.fault != FORCE_AFTER_CLOSE)
        memset(machine.force, 0, sizeof machine.force);
    free(device);
}

static const dpt_driver bad_driver = {
    .size = sizeof(dpt_driver),
    .version = DPT_DRIVER_VERSION,
    .name = "bad",
    .about = "a test's own",
    .open = bad_open,
    .info = bad_info,
    .read = bad_read,
    .write = bad_write,
    .clear = bad_clear,
    .counts = bad_counts,
    .close = bad_close,
};

/* ---- what is reported ---- */

struct heard {
    char failed[1024], noted[1024], last[128];
    uint32_t lines, verdicts[3];
    uint32_t stop_after; /* lines; 0: none */
};

static int hear(void *user, const dpt_selftest_line *line)
{
    struct heard *heard = user;
    char *to = line->verdict == DPT_SELFTEST_FAILED ? heard->failed : heard->noted;
    CHECK(line->size == sizeof *line && line->verdict <= DPT_SELFTEST_NOTE && line->what[0] &&
              !strchr(line->what, '\n') && line->unit,
          "line %u", heard->lines);
    if (line->verdict != DPT_SELFTEST_PASSED)
        snprintf(to + strlen(to), sizeof heard->failed - strlen(to), "%s; ", line->what);
    snprintf(heard->last, sizeof heard->last, "%s", line->what);
    heard->verdicts[line->verdict]++;
    heard->lines++;
    return heard->stop_after && heard->lines >= heard->stop_after;
}

static dpt_selftest_def def_for(struct heard *heard)
{
    dpt_selftest_def def;
    dpt_selftest_def_init(&def);
    def.seconds = 0.2;
    def.may_move = 1;
    def.report = hear;
    def.user = heard;
    return def;
}

static void start(enum fault fault, int dofs, int turns, int is_live)
{
    memset(&machine, 0, sizeof machine);
    memset(&plan, 0, sizeof plan);
    plan.fault = fault;
    plan.dofs = dofs;
    plan.turns = turns;
    plan.is_live = is_live;
    plan.began_ns = is_live ? clock_ns(CLOCK_MONOTONIC) : 1000000000;
}

static dpt_result run(struct heard *heard, dpt_selftest_counts *counts)
{
    const dpt_selftest_def def = def_for(heard);
    counts->size = sizeof *counts;
    const dpt_result result = dpt_driver_selftest(&bad_driver, NULL, &def, counts);
    CHECK(counts->failed == heard->verdicts[DPT_SELFTEST_FAILED] &&
              counts->passed == heard->verdicts[DPT_SELFTEST_PASSED] &&
              counts->notes == heard->verdicts[DPT_SELFTEST_NOTE],
          "%u failed, %u passed, %u notes", counts->failed, counts->passed, counts->notes);
    return result;
}

static void a_sound_device_passes(void)
{
    for (int kind = 0; kind < 4; kind++) {
        struct heard heard = { .lines = 0 };
        dpt_selftest_counts counts;
        start(SOUND, kind ? 6 : 3, kind >= 2, kind == 3);
        CHECK(run(&heard, &counts) == DPT_OK && counts.failed == 0, "kind %d: %s", kind, heard.failed);
        CHECK(counts.passed >= 26 && counts.notes == (kind == 1), "kind %d: %u passed, %s", kind, counts.passed,
              heard.noted);
        for (int k = 0; k < 3; k++)
            CHECK(machine.force[k] == 0.0, "kind %d: %g N are left", kind, machine.force[k]);
    }
}

static void each_fault_is_found(void)
{
    static const struct {
        enum fault fault;
        int dofs, turns, is_live;
        const char *line; /* that fails */
        dpt_result result;
    } cases[] = {
        { OPENS_ONCE, 3, 0, 0, "the port is in use", DPT_E_DEVICE },
        { FOUR_FREEDOMS, 3, 0, 0, "degrees of freedom are 3 or 6", DPT_OK },
        { SLOW_RATE, 3, 0, 0, "a rate of a haptic loop", DPT_OK },
        { GOES_AWAY, 3, 0, 0, "reads and writes for a second", DPT_OK },
        { WRITE_FAILS, 3, 0, 0, "reads and writes for a second", DPT_OK },
        { NEVER_READY, 3, 0, 0, "ready all the time", DPT_OK },
        { FAULT_LATER, 3, 0, 0, "ready all the time", DPT_OK },
        { OUT_OF_STEP, 3, 0, 0, "samples are numbered", DPT_OK },
        { SEQUENCE_STANDS, 3, 0, 0, "samples are numbered", DPT_OK },
        { SEQUENCE_BACK, 3, 0, 0, "samples are numbered", DPT_OK },
        { SEQUENCE_SKIPS, 3, 0, 0, "samples are numbered", DPT_OK },
        { ALWAYS_FRESH, 3, 0, 0, "samples are numbered", DPT_OK },
        { TIME_BACK, 3, 0, 0, "samples are numbered", DPT_OK },
        { HALF_THE_RATE, 3, 0, 1, "samples at its rate", DPT_OK },
        { HALF_THE_RATE, 3, 0, 0, "its rate by time_ns", DPT_OK },
        { MICROSECONDS, 3, 0, 0, "its rate by time_ns", DPT_OK },
        { TIME_OF_DAY, 3, 0, 1, "time_ns is of the monotonic clock", DPT_OK },
        { NAN_POSITION, 3, 0, 0, "each number of a sample is finite", DPT_OK },
        { NAN_ORIENTATION, 6, 0, 0, "each number of a sample is finite", DPT_OK },
        { INFINITE_VELOCITY, 3, 0, 0, "each number of a sample is finite", DPT_OK },
        { NAN_SPIN, 6, 0, 0, "each number of a sample is finite", DPT_OK },
        { NOT_UNIT, 6, 0, 0, "quaternions of unit length", DPT_OK },
        { OUTSIDE, 3, 0, 0, "within its workspace", DPT_OK },
        { TURNED_WITHOUT_TURNS, 3, 0, 0, "no orientation with 3", DPT_OK },
        { READ_WAITS, 3, 0, 0, "reads do not wait", DPT_OK },
        { WRITE_WAITS, 3, 0, 0, "writes do not wait", DPT_OK },
        { DAMAGED, 3, 0, 0, "no frame damaged", DPT_OK },
        { LOSSES, 3, 0, 0, "at most 1 % of samples lost", DPT_OK },
        { NO_FORCE, 3, 0, 0, "0.2 N along +x moves", DPT_OK },
        { REVERSED, 3, 0, 0, "0.2 N along +z moves", DPT_OK },
        { SWAPPED, 3, 0, 0, "0.2 N along +x moves", DPT_OK },
        { NO_WATCHDOG, 3, 0, 0, "its watchdog ends a force", DPT_OK },
        { FORCE_AFTER_CLOSE, 3, 0, 0, "gives no force after close", DPT_OK },
        { MILLIMETRES, 3, 0, 0, "moves as its velocity says", DPT_OK },
        { DEGREES, 6, 1, 0, "turns as its spin says", DPT_OK },
        { W_LAST, 6, 1, 0, "turns as its spin says", DPT_OK },
    };
    uint64_t met = 1u << SOUND;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct heard heard = { .lines = 0 };
        dpt_selftest_counts counts;
        start(cases[i].fault, cases[i].dofs, cases[i].turns, cases[i].is_live);
        dpt_result result = run(&heard, &counts);
        CHECK(result == cases[i].result, "%s: %s", cases[i].line, dpt_result_name(result));
        CHECK(counts.failed > 0 && strstr(heard.failed, cases[i].line), "%s: failed was %s", cases[i].line,
              heard.failed);
        met |= (uint64_t)1 << cases[i].fault;
    }
    CHECK(met == ((uint64_t)1 << W_LAST_AT_REST) - 1, "%llx: a fault is not tried", (unsigned long long)met);
}

/* At rest it may be so: a person is asked. */
static void a_quaternion_at_rest_is_noted(void)
{
    struct heard heard = { .lines = 0 };
    dpt_selftest_counts counts;
    start(W_LAST_AT_REST, 6, 0, 0);
    CHECK(run(&heard, &counts) == DPT_OK && strstr(heard.noted, "is it sent as x, y, z, w?"), "%s", heard.noted);
}

/* Without consent nothing is pushed, and that is said. */
static void nothing_moves_unasked(void)
{
    struct heard heard = { .lines = 0 };
    dpt_selftest_counts counts = { .size = sizeof counts };
    dpt_selftest_def def = def_for(&heard);
    def.may_move = 0;
    start(FORCE_AFTER_CLOSE, 3, 0, 0);
    CHECK(dpt_driver_selftest(&bad_driver, NULL, &def, &counts) == DPT_OK && !counts.failed, "%s", heard.failed);
    CHECK(strstr(heard.noted, "not tested without may_move") && strstr(heard.noted, "its velocity is not tested"), "%s",
          heard.noted);
    CHECK(machine.x[0] == 0.0 && machine.x[1] == 0.0 && machine.x[2] == 0.0, "it moved");
}

/* After whichever line: no more is said, and no force stays. */
static void a_report_may_stop_it(void)
{
    struct heard all = { .lines = 0 };
    dpt_selftest_counts counts;
    start(SOUND, 6, 1, 0);
    CHECK(run(&all, &counts) == DPT_OK, "%s", all.failed);
    for (uint32_t after = 1; after <= all.lines; after++) {
        struct heard heard = { .stop_after = after };
        start(SOUND, 6, 1, 0);
        dpt_result result = run(&heard, &counts);
        CHECK(result == DPT_E_CANCELLED && heard.lines == after, "after %u: %u lines, %s", after, heard.lines,
              dpt_result_name(result));
        for (int k = 0; k < 3; k++)
            CHECK(machine.force[k] == 0.0, "after %u: %g N are left", after, machine.force[k]);
    }
}

static void an_open_device_stays_open(void)
{
    dpt_device *device = device_named("sim:?hand=wipe&dofs=6");
    struct heard heard = { .lines = 0 };
    dpt_selftest_counts counts = { .size = sizeof counts };
    dpt_selftest_def def = def_for(&heard);
    CHECK(dpt_device_selftest(device, &def, &counts) == DPT_OK && !counts.failed, "%s", heard.failed);
    CHECK(state_of(device).status == DPT_DEVICE_STATUS_READY, "it does not read any more");
    CHECK(dpt_device_selftest(device, NULL, &counts) == DPT_OK && counts.failed == 0 && counts.passed > 10 &&
              counts.notes > 0,
          "%u failed", counts.failed);
    dpt_device_close(device);
}

static void a_driver_that_does_not_open_says_why(void)
{
    struct heard heard = { .lines = 0 };
    dpt_selftest_counts counts = { .size = sizeof counts };
    const dpt_selftest_def def = def_for(&heard);
    CHECK(dpt_driver_selftest(dpt_driver_find("sim"), "?weight=1", &def, &counts) == DPT_E_SETTING &&
              counts.failed == 1 && heard.lines == 1 && strstr(heard.last, "weight"),
          "%s", heard.last);
    CHECK(dpt_driver_selftest(NULL, NULL, &def, &counts) == DPT_E_ARGUMENT, "no driver");
}

static dpt_result take_def(void *given)
{
    dpt_selftest_counts counts = { .size = sizeof counts };
    start(SOUND, 3, 0, 0);
    return dpt_driver_selftest(&bad_driver, NULL, given, &counts);
}

static dpt_result fill_counts(void *out)
{
    start(SOUND, 3, 0, 0);
    return dpt_driver_selftest(&bad_driver, NULL, NULL, out);
}

static void defaults(void *def, size_t size)
{
    dpt_selftest_def_defaults(def, size);
}

static void arguments_are_checked(void)
{
    const struct sized of_def = { "dpt_selftest_def", sizeof(dpt_selftest_def), sizeof(dpt_selftest_def), take_def };
    const struct sized of_counts = { "dpt_selftest_counts", sizeof(dpt_selftest_counts), sizeof(dpt_selftest_counts),
                                     fill_counts };
    dpt_selftest_def good, def;
    dpt_selftest_def_init(&good);
    check_input(&of_def, &good);
    check_output(&of_counts);
    check_defaults(&of_def, defaults, &good);
    double *const fields[] = { &def.seconds, &def.rate, &def.push, &def.push_seconds };
    const double wrong[4][4] = {
        { 0.0, 3601.0, NAN, -1.0 }, { 0.5, 2e6, NAN, -1.0 }, { 0.0, 1.01, NAN, -1.0 }, { 0.0, 1.01, NAN, -1.0 }
    };
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 4; k++) {
            def = good;
            *fields[i] = wrong[i][k];
            CHECK(take_def(&def) == DPT_E_ARGUMENT, "field %d is %g", i, wrong[i][k]);
        }
    def = good;
    def.may_move = 2;
    CHECK(take_def(&def) == DPT_E_ARGUMENT, "may_move is 2");
    dpt_selftest_counts counts = { .size = sizeof counts };
    CHECK(dpt_device_selftest(NULL, NULL, &counts) == DPT_E_ARGUMENT, "no device");
    CHECK(dpt_driver_selftest(&bad_driver, NULL, NULL, NULL) == DPT_E_ARGUMENT, "no counts");
}

int main(void)
{
    TEST(a_sound_device_passes);
    TEST(each_fault_is_found);
    TEST(a_quaternion_at_rest_is_noted);
    TEST(nothing_moves_unasked);
    TEST(a_report_may_stop_it);
    TEST(an_open_device_stays_open);
    TEST(a_driver_that_does_not_open_says_why);
    TEST(arguments_are_checked);
    return check_report();
}
