/* SPDX-License-Identifier: BSD-3-Clause */
/* That the stand-in for libHD keeps the rules that the vendor's pages state: what other tests rest on. */
#include "drivers/hd/host.h"

#include "openhaptics/openhaptics_library.h"

static const struct hd_library *hd;

static void expect_error(unsigned code, unsigned which)
{
    const hd_error got = hd->hdGetError();
    CHECK(got.code == code && (code == HD_SUCCESS || got.device == which), "0x%x of %u, not 0x%x", got.code, got.device,
          code);
}

static void the_last_error_comes_first(void)
{
    hd->hdBeginFrame(7);
    hd->hdEndFrame(9);
    hd->hdUnschedule(1234);
    expect_error(HD_INVALID_OPERATION, 0);
    expect_error(HD_BAD_HANDLE, 9);
    expect_error(HD_BAD_HANDLE, 7);
    expect_error(HD_SUCCESS, 0);
}

static void values_and_forces_are_of_frames(void)
{
    double force[3] = { 0.0, 1.0, 0.0 }, number = 0.0;
    const unsigned which = hd->hdInitDevice(NULL);
    CHECK(which == 0, "%u", which);
    hd->hdGetDoublev(HD_NOMINAL_MAX_FORCE, &number);
    CHECK(number == 3.3, "%g", number);
    expect_error(HD_SUCCESS, 0);
    hd->hdGetDoublev(HD_CURRENT_VELOCITY, force);
    expect_error(HD_FRAME_ERROR, 0);
    hd->hdSetDoublev(HD_CURRENT_FORCE, force);
    expect_error(HD_FRAME_ERROR, 0);
    CHECK(lib->violations == 2, "%u", lib->violations);
    hd->hdEndFrame(which);
    expect_error(HD_ILLEGAL_END, 0);

    /* Nested ones are one; force is that of the end, if it is switched on, and stays. */
    hd->hdBeginFrame(which);
    hd->hdBeginFrame(which);
    hd->hdSetDoublev(HD_CURRENT_FORCE, force);
    hd->hdEndFrame(which);
    CHECK(force_of(there) == 0.0, "%g before the end", force_of(there));
    force[1] = 2.0;
    hd->hdEnable(HD_FORCE_OUTPUT);
    hd->hdSetDoublev(HD_CURRENT_FORCE, force);
    hd->hdEndFrame(which);
    CHECK(force_of(there) == 2.0, "%g", force_of(there));
    expect_error(HD_SUCCESS, 0);
    hd->hdBeginFrame(which);
    expect_error(HD_ILLEGAL_BEGIN, 0);

    /* Too much is an error and no force, or is cut. */
    for (int clamps = 0; clamps < 2; clamps++) {
        lib->ticks++;
        force[1] = 5.0;
        if (clamps)
            hd->hdEnable(HD_MAX_FORCE_CLAMPING);
        hd->hdBeginFrame(which);
        hd->hdSetDoublev(HD_CURRENT_FORCE, force);
        hd->hdEndFrame(which);
        CHECK(fabs(force_of(there) - (clamps ? 3.3 : 0.0)) < 1e-12, "%g", force_of(there));
        expect_error(clamps ? HD_SUCCESS : HD_EXCEEDED_MAX_FORCE, 0);
    }
    hd->hdDisableDevice(which);
    CHECK(force_of(there) == 0.0, "%g of none", force_of(there));
    renew();
}

static char order[32];
static int rounds;

static unsigned twice(void *letter)
{
    strncat(order, letter, 1);
    return ++rounds < 6 ? HD_CALLBACK_CONTINUE : HD_CALLBACK_DONE;
}

static void callbacks_run_by_priority_until_they_are_done(void)
{
    unsigned long ids[20];
    char letters[] = "abc";
    ids[0] = hd->hdScheduleAsynchronous(twice, letters + 1, 100);
    ids[1] = hd->hdScheduleAsynchronous(twice, letters + 2, 0);
    ids[2] = hd->hdScheduleAsynchronous(twice, letters + 0, 65535);
    hold();
    hd->hdStartScheduler();
    tick(1);
    CHECK(!strcmp(order, "abc"), "%s", order);
    CHECK(hd->hdWaitForCompletion(ids[1], HD_WAIT_CHECK_STATUS) == 1, "done too soon");
    tick(1);
    CHECK(!strcmp(order, "abcabc") && hd->hdWaitForCompletion(ids[1], HD_WAIT_CHECK_STATUS) == 0 &&
              hd->hdWaitForCompletion(ids[0], HD_WAIT_CHECK_STATUS) == 1,
          "%s", order);
    hd->hdUnschedule(ids[0]);
    expect_error(HD_SUCCESS, 0);
    hd->hdUnschedule(ids[1]);
    expect_error(HD_INVALID_OPERATION, 0);
    hd->hdUnschedule(ids[2]);
    for (int i = 0; i < 17; i++)
        ids[i] = hd->hdScheduleAsynchronous(twice, letters, 1);
    expect_error(HD_SCHEDULER_FULL, 0);
    hd->hdStopScheduler();
    CHECK(hd->hdWaitForCompletion(ids[3], HD_WAIT_CHECK_STATUS) == 1, "gone with the stop");
    renew();
}

/* Never faster than its rate, and of several. */
static void the_thread_keeps_its_rate(void)
{
    static const unsigned long rates[] = { 1000, 500, 2000 };
    for (int i = 0; i < 3; i++) {
        const struct timespec wait = { 0, 50000000 };
        hd->hdSetSchedulerRate(rates[i]);
        expect_error(HD_SUCCESS, 0);
        const unsigned long before = lib->ticks;
        const uint64_t begin = real_now();
        hd->hdStartScheduler();
        nanosleep(&wait, NULL);
        hd->hdStopScheduler();
        const double ticks = (double)(lib->ticks - before);
        const double most = (double)(real_now() - begin) * 1e-9 * (double)rates[i];
        CHECK(ticks > 0.0 && ticks <= most + 2.0, "%g ticks where at most %g fit", ticks, most);
    }
    hd->hdSetSchedulerRate(700);
    expect_error(HD_INVALID_VALUE, 0);
    renew();
}

/* A mass in a hand's spring: the force goes through it. */
static void a_device_moves_under_force(void)
{
    double force[3] = { 0.0, 1.5, 0.0 };
    const unsigned which = hd->hdInitDevice("Default Device");
    there->moves = 1;
    hd->hdEnable(HD_FORCE_OUTPUT);
    hold();
    hd->hdBeginFrame(which);
    hd->hdSetDoublev(HD_CURRENT_FORCE, force);
    hd->hdEndFrame(which);
    hd->hdStartScheduler();
    tick(4000);
    CHECK(fabs(there->transform[13] - 10.0) < 1e-3, "%g mm", there->transform[13]);
    there->in_inkwell = 1;
    tick(4000);
    CHECK(fabs(there->transform[13]) < 1e-3, "%g mm in the inkwell", there->transform[13]);
    hd->hdStopScheduler();
    hd->hdDisableDevice(which);
    renew();
}

static void calibration_has_its_moments(void)
{
    const unsigned which = hd->hdInitDevice("Left Device");
    left->calibration = HD_CALIBRATION_NEEDS_MANUAL_INPUT;
    CHECK(which == 1 && hd->hdCheckCalibration() == HD_CALIBRATION_NEEDS_MANUAL_INPUT, "%u", which);
    hd->hdUpdateCalibration(HD_CALIBRATION_AUTO);
    expect_error(HD_INVALID_VALUE, 1);
    hd->hdUpdateCalibration(HD_CALIBRATION_INKWELL);
    expect_error(HD_INVALID_OPERATION, 1);
    left->in_inkwell = 1;
    CHECK(hd->hdCheckCalibration() == HD_CALIBRATION_NEEDS_UPDATE, "in the inkwell");
    hd->hdUpdateCalibration(HD_CALIBRATION_INKWELL);
    expect_error(HD_SUCCESS, 0);
    CHECK(hd->hdCheckCalibration() == HD_CALIBRATION_OK && lib->violations > 0,
          "out of the scheduler's thread, and nobody minds");
    hd->hdDisableDevice(which);
    renew();
}

int main(int argc, char **argv)
{
    (void)argc;
    take_stand_in(argv[0], "libHD-stand-in.so");
    CHECK(hd_library_load(library_path, &hd, &error) == DPT_OK, "%s", error.text);
    renew();
    TEST(the_last_error_comes_first);
    TEST(values_and_forces_are_of_frames);
    TEST(callbacks_run_by_priority_until_they_are_done);
    TEST(the_thread_keeps_its_rate);
    TEST(a_device_moves_under_force);
    TEST(calibration_has_its_moments);
    return check_report();
}
