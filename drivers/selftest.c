/* SPDX-License-Identifier: BSD-3-Clause */
/* The self-test of a device (selftest.h): what it reports while it is read, and how it moves when it is pushed. */
#include "dynpoint/selftest.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/quaternion.h"
#include "base/return_if_error.h"
#include "base/sized.h"
#include "base/vec3.h"
#include "platform/clock.h"
#include "rotation.h"

/* A slower watchdog, s, is not tested: the test would push the hand too far. */
static const double WATCHDOG_MAX = 0.1;

/* Smallest motion, m and rad, that velocity and spin are checked by. */
static const double DISPLACEMENT_MIN = 1e-3, ROTATION_MIN = 0.02;

static const dpt_wrench zero;

struct selftest {
    dpt_device *device;
    dpt_device_info info;
    dpt_selftest_def def;
    dpt_selftest_counts counts;
    dpt_result result; /* DPT_OK: go on */
    /* Over all observations; as in selftest_motion. */
    double displacement_max, displacement_error_max, rotation_max, rotation_error_max;
};

/* ---- the report ---- */

static void report_line(struct selftest *test, uint32_t verdict, const char *what, double measured, const char *unit)
{
    const dpt_selftest_line line = {
        .size = sizeof line, .verdict = verdict, .measured = measured, .what = what, .unit = unit
    };
    if (test->result != DPT_OK)
        return;
    test->counts.passed += verdict == DPT_SELFTEST_PASSED;
    test->counts.failed += verdict == DPT_SELFTEST_FAILED;
    test->counts.notes += verdict == DPT_SELFTEST_NOTE;
    if (test->def.report && test->def.report(test->def.user, &line))
        test->result = DPT_E_CANCELLED;
}

static void judge(struct selftest *test, int passed, const char *what, double measured, const char *unit)
{
    report_line(test, passed ? DPT_SELFTEST_PASSED : DPT_SELFTEST_FAILED, what, measured, unit);
}

static void note(struct selftest *test, const char *what)
{
    report_line(test, DPT_SELFTEST_NOTE, what, 0.0, "");
}

/* ---- a motion, and the velocity that the device reports ---- */

/*
 * The motion since the first sample, in the device's frame, by poses and by the integral of the reported velocity and
 * spin (m, rad). An error is the distance between the two.
 */
struct selftest_motion {
    double displacement[3], velocity_integral[3], rotation[3], spin_integral[3];
    double displacement_max, displacement_error_max, rotation_max, rotation_error_max;
};

static double difference(const double *a, const double *b)
{
    return length(sub(vec3_of(a), vec3_of(b)));
}

static void add_motion(struct selftest_motion *motion, const dpt_device_state *from, const dpt_device_state *to)
{
    const double dt = (double)(int64_t)(to->time_ns - from->time_ns) * 1e-9;
    double rotation[3];
    rotation_between(from->pose.orientation, to->pose.orientation, rotation);
    for (int k = 0; k < 3; k++) {
        motion->displacement[k] += to->pose.position[k] - from->pose.position[k];
        motion->velocity_integral[k] += 0.5 * dt * (from->velocity[k] + to->velocity[k]);
        motion->rotation[k] += rotation[k];
        motion->spin_integral[k] += 0.5 * dt * (from->spin[k] + to->spin[k]);
    }
    motion->displacement_max = fmax(motion->displacement_max, vec3_length(motion->displacement));
    motion->displacement_error_max =
        fmax(motion->displacement_error_max, difference(motion->displacement, motion->velocity_integral));
    motion->rotation_max = fmax(motion->rotation_max, vec3_length(motion->rotation));
    motion->rotation_error_max = fmax(motion->rotation_error_max, difference(motion->rotation, motion->spin_integral));
}

/* What observe() saw. */
struct observed {
    dpt_result result;            /* of the last read or write */
    dpt_device_state first, last; /* the first and the last fresh sample */
    uint64_t reads, fresh, skipped, misnumbered, not_finite, slow_reads, slow_writes;
    double seconds;              /* how long it took */
    double quaternion_error_max; /* largest difference of a quaternion's length from 1 */
    double age;                  /* of the last sample, s */
    int is_ready;                /* on every read */
    struct selftest_motion motion;
};

static int numbers_are_finite(const dpt_device_state *state)
{
    double sum = 0.0;
    for (int k = 0; k < 3; k++)
        sum += 0.0 * state->pose.position[k] + 0.0 * state->velocity[k] + 0.0 * state->spin[k];
    for (int k = 0; k < 4; k++)
        sum += 0.0 * state->pose.orientation[k];
    return sum == 0.0;
}

static double unit_length_error(const double *q)
{
    return fabs(quaternion_length(q) - 1.0);
}

/* Add the state that was just read. */
static void add_state(struct observed *seen, const dpt_device_state *now)
{
    const dpt_device_state *before = &seen->last;
    if (!numbers_are_finite(now)) {
        seen->not_finite++;
        return;
    }
    seen->quaternion_error_max = fmax(seen->quaternion_error_max, unit_length_error(now->pose.orientation));
    if (seen->fresh) {
        seen->misnumbered += now->sequence - before->sequence != now->fresh;
        seen->misnumbered += now->fresh > 0 && now->time_ns < before->time_ns;
    }
    if (!now->fresh)
        return;
    if (seen->fresh) {
        seen->skipped += now->fresh - 1;
        add_motion(&seen->motion, before, now);
    } else {
        seen->first = *now;
    }
    seen->fresh++;
    seen->last = *now;
}

/* Read for so many seconds and write this wrench after each read; NULL: write nothing. */
static void observe(struct selftest *test, double seconds, const dpt_wrench *wrench, struct observed *seen)
{
    const int is_real_time = !(test->info.flags & DPT_DEVICE_FLAG_DETERMINISTIC);
    const double period = 1.0 / test->info.rate;
    const double read_period = test->def.rate > 0.0 ? 1.0 / test->def.rate : 0.5 * period;
    const uint64_t slow_ns = (uint64_t)(fmax(0.25 * period, 20e-6) * 1e9);
    dpt_device_state now = { .size = sizeof now };
    uint64_t begin = 0, before = 0, between = 0, after = 0;
    memset(seen, 0, sizeof *seen);
    seen->is_ready = 1;
    if (test->result == DPT_OK)
        test->result = clock_read(&begin);
    while (test->result == DPT_OK && seen->seconds < seconds && seen->result == DPT_OK) {
        test->result = clock_read(&before);
        seen->result = dpt_device_read(test->device, &now);
        between = clock_now();
        add_state(seen, &now);
        seen->age = (double)(int64_t)(between - now.time_ns) * 1e-9;
        seen->is_ready &= now.status == DPT_DEVICE_STATUS_READY;
        if (wrench && seen->result == DPT_OK)
            seen->result = dpt_device_write(test->device, wrench);
        after = clock_now();
        seen->result = seen->result == DPT_E_BUSY ? DPT_OK : seen->result;
        seen->reads++;
        seen->slow_reads += between - before > slow_ns;
        seen->slow_writes += after - between > slow_ns;
        seen->seconds = is_real_time ? (double)(between - begin) * 1e-9 : seen->seconds + period;
        if (is_real_time)
            clock_sleep((uint64_t)(1e9 * read_period));
    }
    test->displacement_error_max = fmax(test->displacement_error_max, seen->motion.displacement_error_max);
    test->displacement_max = fmax(test->displacement_max, seen->motion.displacement_max);
    test->rotation_error_max = fmax(test->rotation_error_max, seen->motion.rotation_error_max);
    test->rotation_max = fmax(test->rotation_max, seen->motion.rotation_max);
}

/* ---- what it reports while nothing pushes ---- */

static int is_inside(const dpt_device_info *info, const dpt_device_state *state)
{
    int is_inside_box = 1;
    for (int k = 0; k < 3; k++) {
        const double slack = 0.1 * (info->workspace_max[k] - info->workspace_min[k]);
        is_inside_box &= state->pose.position[k] >= info->workspace_min[k] - slack &&
                         state->pose.position[k] <= info->workspace_max[k] + slack;
    }
    return is_inside_box;
}

/* The identity looks like half a turn about z if a driver sends quaternions with w last. */
static int is_half_turn_about_z(const double *q)
{
    return fabs(q[0]) < 1e-6 && fabs(q[1]) < 1e-6 && fabs(q[2]) < 1e-6;
}

/* Returns 0 if the info makes no sense, so that nothing else can be tested. */
static int test_info(struct selftest *test)
{
    const dpt_device_info *info = &test->info;
    const uint32_t failed = test->counts.failed;
    judge(test,
          (info->pose_dofs == 3 || info->pose_dofs == 6) &&
              (info->wrench_dofs == 0 || info->wrench_dofs == 3 || info->wrench_dofs == 6),
          "degrees of freedom are 3 or 6", info->pose_dofs, "");
    judge(test, info->rate >= 100.0 && info->rate <= 1e5, "a rate of a haptic loop", info->rate, "Hz");
    return test->counts.failed == failed;
}

static void test_times(struct selftest *test, const struct observed *seen)
{
    const double rate = test->info.rate;
    const double steps = (double)(seen->last.sequence - seen->first.sequence);
    const double by_time = 1e9 * steps / fmax((double)(int64_t)(seen->last.time_ns - seen->first.time_ns), 1.0);
    judge(test, seen->misnumbered == 0, "samples are numbered as `fresh` says", (double)seen->misnumbered, "are not");
    judge(test, by_time > 0.9 * rate && by_time < 1.1 * rate, "its rate by time_ns too", by_time, "Hz");
    if (!(test->info.flags & DPT_DEVICE_FLAG_DETERMINISTIC))
        judge(test, fabs(seen->age) < 1.0, "time_ns is of the monotonic clock", seen->age, "s old");
}

static void test_orientation(struct selftest *test, const struct observed *seen)
{
    const double *q = seen->last.pose.orientation;
    judge(test, seen->quaternion_error_max < 1e-6, "quaternions of unit length", seen->quaternion_error_max, "off");
    if (test->info.pose_dofs == 3)
        judge(test, fabs(q[0] - 1.0) < 1e-6, "no orientation with 3 degrees of freedom", q[0], "is w");
}

static void test_waiting(struct selftest *test, const struct observed *seen)
{
    const double percent = 100.0 / fmax((double)seen->reads, 1.0);
    judge(test, 2 * seen->slow_reads <= seen->reads, "reads do not wait", percent * (double)seen->slow_reads,
          "% took a quarter of a period");
    judge(test, 2 * seen->slow_writes <= seen->reads, "writes do not wait", percent * (double)seen->slow_writes,
          "% took a quarter of a period");
}

static void test_samples(struct selftest *test)
{
    const dpt_wrench not_finite = { { 0.0, NAN, 0.0 }, { 0.0, 0.0, 0.0 } };
    const double rate = test->info.rate;
    dpt_device_counts counts = { .size = sizeof counts };
    struct observed seen;
    observe(test, test->def.seconds, &zero, &seen);
    judge(test, seen.result == DPT_OK, "reads and writes for a second", seen.seconds, "s");
    judge(test, seen.is_ready, "ready all the time", (double)seen.last.reasons, "reasons");
    const double measured = (double)(seen.fresh + seen.skipped) / fmax(seen.seconds, 1e-9);
    judge(test, measured > 0.9 * rate && measured < 1.1 * rate, "samples at its rate", measured, "Hz");
    test_times(test, &seen);
    judge(test, seen.not_finite == 0, "each number of a sample is finite", (double)seen.not_finite, "samples are not");
    judge(test, seen.fresh && is_inside(&test->info, &seen.last), "within its workspace", seen.last.pose.position[0],
          "m in x");
    test_orientation(test, &seen);
    test_waiting(test, &seen);
    dpt_device_get_counts(test->device, &counts);
    judge(test, counts.damaged == 0, "no frame damaged", (double)counts.damaged, "frames");
    judge(test, counts.lost * 100 <= counts.samples, "at most 1 % of samples lost", (double)counts.lost, "samples");
    const dpt_result result = dpt_device_write(test->device, &not_finite);
    judge(test, result == DPT_E_FINITE, "a force that is not finite is refused", result, "(code)");
    if (is_half_turn_about_z(seen.last.pose.orientation))
        note(test, "turned by half a turn about z: is it sent as x, y, z, w? The order is w, x, y, z");
}

/* ---- how it moves ---- */

/* What a force moved along an axis, m: the displacement beyond that of the initial velocity. */
static double driven_displacement(const struct observed *seen, int axis)
{
    const double time = (double)(int64_t)(seen->last.time_ns - seen->first.time_ns) * 1e-9;
    return seen->last.pose.position[axis] - seen->first.pose.position[axis] - seen->first.velocity[axis] * time;
}

static dpt_wrench push_along(const struct selftest *test, int axis, double sign)
{
    dpt_wrench push = zero;
    push.force[axis] = sign * test->def.push * test->info.force_max;
    return push;
}

static void test_pushes(struct selftest *test)
{
    for (int axis = 0; axis < 3; axis++)
        for (double sign = 1.0; sign >= -1.0 && test->result == DPT_OK; sign -= 2.0) {
            const dpt_wrench push = push_along(test, axis, sign);
            struct observed still, pushed;
            char what[64];
            observe(test, 0.2, &zero, &still);
            observe(test, test->def.push_seconds, &push, &pushed);
            dpt_device_write(test->device, &zero);
            /*
             * A hand that holds it stops it, so the displacement counts; nothing brakes a free one, so the drive
             * counts.
             */
            const double displacement = sign * (pushed.last.pose.position[axis] - pushed.first.pose.position[axis]);
            const double moved = fmax(displacement, sign * driven_displacement(&pushed, axis));
            snprintf(what, sizeof what, "%.2g N along %c%c moves the hand that way",
                     test->def.push * test->info.force_max, sign > 0.0 ? '+' : '-', "xyz"[axis]);
            judge(test, pushed.result == DPT_OK && moved > 0.0, what, 1e3 * moved, "mm");
        }
}

/*
 * Push to the right, then write nothing for `silence` s, then observe `after_silence` (may be NULL). Returns the
 * displacement that the push drove, m.
 */
static double push_and_wait(struct selftest *test, double silence, struct observed *after_silence)
{
    const dpt_wrench push = push_along(test, 0, 1.0);
    struct observed seen;
    observe(test, 0.2, &zero, &seen);
    observe(test, test->def.push_seconds, &push, &seen);
    const double pushed = driven_displacement(&seen, 0);
    if (silence > 0.0)
        observe(test, silence, NULL, &seen);
    if (after_silence)
        observe(test, test->def.push_seconds, NULL, after_silence);
    return pushed;
}

static void test_watchdog(struct selftest *test)
{
    const double watchdog = test->info.watchdog;
    struct observed after_silence;
    if (!(watchdog > 0.0)) {
        note(test, "it has no watchdog: its force stays when commands end");
        return;
    }
    if (watchdog > WATCHDOG_MAX) {
        note(test, "its watchdog is slower than 0.1 s, and is not tested");
        return;
    }
    const double pushed = push_and_wait(test, 1.5 * watchdog + 5.0 / test->info.rate, &after_silence);
    const double driven_after = driven_displacement(&after_silence, 0);
    if (dpt_device_write(test->device, &zero) == DPT_E_NOT_READY)
        dpt_device_clear(test->device);
    judge(test, pushed > 0.0 && driven_after < 0.5 * pushed, "without commands its watchdog ends a force",
          1e3 * driven_after, "mm driven on");
}

/* Checks velocity and spin by all motions that were observed. */
static void test_velocity(struct selftest *test)
{
    const double displacement_min = fmax(DISPLACEMENT_MIN, 10.0 * test->info.position_step);
    const double rotation_min = fmax(ROTATION_MIN, 10.0 * test->info.angle_step);
    if (test->displacement_max > displacement_min)
        judge(test, test->displacement_error_max < 0.3 * test->displacement_max, "moves as its velocity says",
              1e3 * test->displacement_error_max, "mm off");
    else
        note(test, "it did not move by a millimetre: its velocity is not tested");
    if (test->info.pose_dofs == 6 && test->rotation_max > rotation_min)
        judge(test, test->rotation_error_max < 0.3 * test->rotation_max, "turns as its spin says",
              test->rotation_error_max, "rad off");
    else if (test->info.pose_dofs == 6)
        note(test, "it did not turn by a degree: neither its spin nor the order of its quaternions is tested");
}

static int gives_force(const struct selftest *test)
{
    return test->info.wrench_dofs >= 3 && test->info.force_max > 0.0;
}

/* All tests of an open device. Returns 0 if its info makes no sense. */
static int test_device(struct selftest *test)
{
    test->info = (dpt_device_info){ .size = sizeof test->info };
    dpt_device_get_info(test->device, &test->info);
    if (!test_info(test))
        return 0;
    test_samples(test);
    if (test->result == DPT_OK && gives_force(test) && test->def.may_move) {
        test_pushes(test);
        test_watchdog(test);
    } else {
        note(test, gives_force(test) ? "its forces are not tested without may_move, --move" : "it gives no force");
    }
    test_velocity(test);
    return 1;
}

/* ---- from open to close ---- */

static dpt_result open_device(struct selftest *test, const dpt_driver *driver, const char *where, const char *what)
{
    dpt_device_error error = { .size = sizeof error };
    const dpt_result result = dpt_device_open_with(driver, where, &test->device, &error);
    judge(test, result == DPT_OK, result == DPT_OK ? what : error.text, result, "(code)");
    return result;
}

/* Close the device, under force if it may move, and open it again: the force must have ended. */
static dpt_result test_close(struct selftest *test, const dpt_driver *driver, const char *where)
{
    const int may_push = test->result == DPT_OK && gives_force(test) && test->def.may_move;
    struct observed after;
    const double pushed = may_push ? push_and_wait(test, 0.0, NULL) : 0.0;
    dpt_device_close(test->device);
    test->device = NULL;
    if (test->result != DPT_OK)
        return test->result;
    DPT_TRY(open_device(test, driver, where, "opens again"));
    if (may_push) {
        observe(test, test->def.push_seconds, NULL, &after);
        const double driven_after = driven_displacement(&after, 0);
        judge(test, pushed > 0.0 && driven_after < 0.5 * pushed, "gives no force after close", 1e3 * driven_after,
              "mm driven on");
    }
    dpt_device_close(test->device);
    return test->result;
}

/* ---- the two calls ---- */

void dpt_selftest_def_defaults(dpt_selftest_def *def, size_t size)
{
    const dpt_selftest_def defaults = { .seconds = 1.0, .push = 0.05, .push_seconds = 0.05 };
    sized_defaults(def, size, &defaults, sizeof defaults);
}

static int in_range(double value, double min, double max)
{
    return value >= min && value <= max;
}

static dpt_result begin(struct selftest *test, const dpt_selftest_def *given, const dpt_selftest_counts *counts)
{
    dpt_selftest_def *def = &test->def;
    memset(test, 0, sizeof *test);
    test->counts.size = sizeof test->counts;
    if (!counts)
        return DPT_E_ARGUMENT;
    DPT_TRY(sized_check(counts, sizeof *counts, 0));
    dpt_selftest_def_init(def);
    if (given)
        DPT_TRY(sized_read(given, sizeof *def, def, sizeof *def));
    return def->may_move <= 1 && in_range(def->seconds, 0.1, 3600.0) &&
                   (def->rate == 0.0 || in_range(def->rate, 1.0, 1e6)) && in_range(def->push, 0.001, 1.0) &&
                   in_range(def->push_seconds, 0.01, 1.0)
               ? DPT_OK
               : DPT_E_ARGUMENT;
}

dpt_result dpt_device_selftest(dpt_device *device, const dpt_selftest_def *def, dpt_selftest_counts *counts)
{
    struct selftest test;
    DPT_TRY(begin(&test, def, counts));
    if (!device)
        return DPT_E_ARGUMENT;
    test.device = device;
    test_device(&test);
    sized_write(counts, counts->size, &test.counts, sizeof test.counts);
    return test.result;
}

dpt_result dpt_driver_selftest(const dpt_driver *driver, const char *where, const dpt_selftest_def *def,
                               dpt_selftest_counts *counts)
{
    struct selftest test;
    DPT_TRY(begin(&test, def, counts));
    dpt_result result = open_device(&test, driver, where, "opens");
    if (result == DPT_OK && test_device(&test))
        result = test_close(&test, driver, where);
    else if (result == DPT_OK)
        dpt_device_close(test.device);
    sized_write(counts, counts->size, &test.counts, sizeof test.counts);
    return result != DPT_OK ? result : test.result;
}
