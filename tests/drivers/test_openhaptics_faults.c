/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Devices by OpenHaptics, on a stand-in for the vendor's library (tests/drivers/hd): each fault is provoked, ends the force, says
 * what it is, and can be got over.
 */
#include "drivers/hd/host.h"

static void numbers_that_are_none_are_not_trusted(void)
{
    double *const places[] = { &there->transform[12], &there->transform[13], &there->transform[10],
                               &there->transform[10], &there->velocity[1],   &there->spin[2],
                               &there->joints[0],     &there->gimbal[1] };
    const double wrong[] = { NAN, INFINITY, 7.0, -1.0, NAN, -INFINITY, NAN, NAN };
    start("");
    serve(150, 1.0);
    CHECK(force_of(there) == 1.0, "%g", force_of(there));
    for (int i = 0; i < 8; i++) {
        const double before = *places[i];
        const dpt_device_state was = state;
        *places[i] = wrong[i];
        tick(1);
        CHECK(force_of(there) == 0.0, "case %d: force", i);
        CHECK(dpt_device_read(device, &state) == DPT_OK && state.status == DPT_DEVICE_STATUS_UNREADY &&
                  state.reasons == DPT_REASON_UNCALIBRATED && state.fresh == 1,
              "case %d: %s", i, dpt_device_status_name(state.status));
        CHECK(!memcmp(&state.pose, &was.pose, sizeof was.pose) &&
                  !memcmp(state.velocity, was.velocity, sizeof was.velocity) &&
                  !memcmp(state.spin, was.spin, sizeof was.spin) && !memcmp(state.joint, was.joint, sizeof was.joint),
              "case %d: it moved", i);
        CHECK(push(device, 1.0) == DPT_E_NOT_READY, "case %d: it takes force", i);
        *places[i] = before;
        tick(1);
        dpt_device_read(device, &state);
        serve(150, 1.0);
        CHECK(force_of(there) == 1.0, "case %d: it does not come back", i);
    }
    finish();
}

static void silence_of_the_host_ends_the_force(void)
{
    dpt_device_counts counts = { .size = sizeof counts };
    start("");
    serve(200, 1.0);
    for (int n = 1; n <= 30; n++) {
        tick(1);
        /* The last write was a tick before the last tick of serve. */
        CHECK(force_of(there) == (n + 1 < 10 ? 1.0 : 0.0), "%d ms later: %g N", n + 1, force_of(there));
    }
    dpt_device_read(device, &state);
    dpt_device_get_counts(device, &counts);
    CHECK(counts.missed == 22, "%d ticks missed a command", (int)counts.missed);
    serve(1, 1.0);
    CHECK(fabs(force_of(there) - 0.01) < 1e-15, "it kicks: %g", force_of(there));
    CHECK(state.status == DPT_DEVICE_STATUS_READY, "%s", dpt_device_status_name(state.status));
    finish();
    start("&watchdog=0.05");
    serve(200, 1.0);
    tick(45);
    CHECK(force_of(there) == 1.0, "sooner than it was told: %g", force_of(there));
    tick(10);
    CHECK(force_of(there) == 0.0, "later than it was told: %g", force_of(there));
    finish();
}

/* All threads stand for five seconds; or the scheduler's alone, and the host goes on. */
static void a_stop_in_a_debugger_does_not_kick(void)
{
    for (int host_goes_on = 0; host_goes_on < 2; host_goes_on++) {
        start("&silent=60");
        serve(200, 2.0);
        CHECK(force_of(there) == 2.0, "%g", force_of(there));
        pass(5.0);
        there->transform[13] = -50.0;
        if (host_goes_on)
            CHECK(push(device, 2.0) == DPT_OK, "write");
        tick(1);
        CHECK(force_of(there) == (host_goes_on ? 0.02 : 0.0), "it kicks with %g N", force_of(there));
        for (int n = 1; n < 50; n++) {
            const double before = force_of(there);
            serve(1, 2.0);
            CHECK(force_of(there) - before < 0.0200001, "tick %d: %g N at once", n, force_of(there) - before);
        }
        finish();
    }
}

static void the_clock_may_fail(void)
{
    start("&silent=0.1");
    serve(200, 1.0);
    host.clock_fails = 1;
    lib->tick();
    host.clock_fails = 0;
    CHECK(force_of(there) == 0.0, "%g N without a clock", force_of(there));
    serve(200, 1.0);
    host.clock_fails = 1;
    push(device, 1.0);
    host.clock_fails = 0;
    tick(1);
    CHECK(force_of(there) == 0.0, "%g N by a command without a time", force_of(there));
    finish();
}

/* From 0.7 of the limit less, at the limit nothing. */
static void warm_motors_give_less(void)
{
    start("");
    CHECK(state.temperature == 0.0, "%g", state.temperature);
    serve(200, 2.0);
    for (int n = 0; n <= 99; n++) {
        const double heat = n / 99.0 * 0.99;
        there->temperature[n % 3] = heat;
        there->temperature[(n + 1) % 3] = there->temperature[(n + 2) % 3] = 0.3 * heat;
        serve(1, 2.0);
        const double expected = heat <= 0.7 ? 2.0 : 2.0 * (1.0 - heat) / 0.3;
        CHECK(fabs(force_of(there) - expected) < 1e-12, "at %g: %g N", heat, force_of(there));
        CHECK(state.temperature == heat && state.status == DPT_DEVICE_STATUS_READY, "%g", state.temperature);
    }
    there->temperature[0] = there->temperature[1] = there->temperature[2] = 1.0;
    tick(1);
    CHECK(force_of(there) == 0.0, "hot, and %g N", force_of(there));
    tick(1);
    CHECK(dpt_device_read(device, &state) == DPT_OK && state.status == DPT_DEVICE_STATUS_FAULT &&
              state.reasons == DPT_REASON_OVERHEATED && state.code == HD_WARM_MOTORS,
          "%s, %x", dpt_device_status_name(state.status), state.code);
    CHECK(clear_device(device) == DPT_E_NOT_READY, "cleared while it is hot");
    there->temperature[0] = there->temperature[1] = there->temperature[2] = 0.5;
    tick(110);
    CHECK(clear_device(device) == DPT_OK, "not cleared when it is cool");
    dpt_device_read(device, &state);
    serve(1, 2.0);
    CHECK(fabs(force_of(there) - 0.02) < 1e-15, "it kicks: %g", force_of(there));
    finish();
    /* Each motor counts. */
    there->outputs = 7;
    there->temperature[6] = 0.85;
    start("");
    serve(150, 2.0);
    CHECK(state.temperature == 0.85 && fabs(force_of(there) - 1.0) < 1e-12, "at %g: %g N", state.temperature,
          force_of(there));
    finish();
    /* One that does not tell. */
    lib->unsupported[0] = HD_MOTOR_TEMPERATURE;
    start("");
    serve(150, 2.0);
    CHECK(state.temperature == -1.0 && force_of(there) == 2.0, "%g", state.temperature);
    finish();
}

/* Those that the device gets over stay until they are cleared, as a fault does here. */
static void force_errors_are_faults(void)
{
    static const struct {
        unsigned code;
        uint32_t reason;
    } kinds[] = { { HD_WARM_MOTORS, DPT_REASON_OVERHEATED },
                  { HD_EXCEEDED_MAX_FORCE, DPT_REASON_OVERLOADED },
                  { HD_EXCEEDED_MAX_FORCE_IMPULSE, DPT_REASON_OVERLOADED },
                  { HD_EXCEEDED_MAX_VELOCITY, DPT_REASON_OVERLOADED },
                  { HD_FORCE_ERROR, DPT_REASON_DEVICE },
                  { HD_FRAME_ERROR, DPT_REASON_DEVICE },
                  { HD_INVALID_OPERATION, DPT_REASON_DEVICE } };
    start("");
    for (int i = 0; i < 7; i++) {
        serve(150, 1.0);
        CHECK(force_of(there) == 1.0, "%x: %g", kinds[i].code, force_of(there));
        lib->raise = kinds[i].code;
        lib->raise_more = 2;
        push(device, 1.0);
        tick(1);
        CHECK(dpt_device_read(device, &state) == DPT_OK && state.status == DPT_DEVICE_STATUS_FAULT &&
                  state.reasons == kinds[i].reason && state.code == kinds[i].code,
              "%x: %s, %u, %x", kinds[i].code, dpt_device_status_name(state.status), state.reasons, state.code);
        CHECK(push(device, 1.0) == DPT_E_NOT_READY, "%x: it takes force", kinds[i].code);
        tick(1);
        CHECK(force_of(there) == 0.0, "%x: %g N", kinds[i].code, force_of(there));
        tick(20);
        CHECK(lib->errors() == 0, "%x: %d are left", kinds[i].code, lib->errors());
        CHECK(dpt_device_read(device, &state) == DPT_OK && state.status == DPT_DEVICE_STATUS_FAULT && state.fresh == 21,
              "%x: gone by itself", kinds[i].code);
        CHECK(clear_device(device) == DPT_E_NOT_READY, "%x: cleared at once", kinds[i].code);
        tick(100);
        CHECK(clear_device(device) == DPT_OK, "%x: not cleared", kinds[i].code);
        CHECK(dpt_device_read(device, &state) == DPT_OK && state.code == 0 && state.reasons == 0, "%x", state.code);
        serve(1, 1.0);
        CHECK(fabs(force_of(there) - 0.01) < 1e-15, "%x: it kicks", kinds[i].code);
    }
    finish();
}

static void no_force_after_clear_until_a_write(void)
{
    start("&watchdog=1");
    serve(150, 1.0);
    CHECK(clear_device(device) == DPT_OK, "clear");
    tick(1);
    CHECK(force_of(there) == 0.0, "%g N", force_of(there));
    dpt_device_read(device, &state);
    serve(1, 1.0);
    CHECK(fabs(force_of(there) - 0.01) < 1e-15, "it kicks: %g", force_of(there));
    finish();
}

/* After these it has to be opened again. */
static void scheduler_errors_are_loss(void)
{
    static const struct {
        unsigned code;
        uint32_t reason;
    } kinds[] = { { HD_COMM_ERROR, DPT_REASON_LINK },       { HD_COMM_CONFIG_ERROR, DPT_REASON_LINK },
                  { HD_TIMER_ERROR, DPT_REASON_DEVICE },    { HD_INVALID_PRIORITY, DPT_REASON_DEVICE },
                  { HD_SCHEDULER_FULL, DPT_REASON_DEVICE }, { HD_DEVICE_FAULT, DPT_REASON_DEVICE },
                  { HD_BAD_HANDLE, DPT_REASON_DEVICE },     { HD_INVALID_LICENSE, DPT_REASON_DEVICE } };
    dpt_device_counts counts = { .size = sizeof counts };
    start("");
    for (int i = 0; i < 8; i++) {
        tick(15);
        dpt_device_read(device, &state);
        serve(150, 1.0);
        const dpt_pose pose = state.pose;
        const uint64_t sequence = state.sequence;
        dpt_device_get_counts(device, &counts);
        const uint64_t missed = counts.missed;
        lib->raise = kinds[i].code;
        there->transform[12] += 1.0;
        tick(2);
        const unsigned long frames = there->frames;
        CHECK(force_of(there) == 0.0, "%x: %g N", kinds[i].code, force_of(there));
        CHECK(dpt_device_read(device, &state) == DPT_E_LOST && state.status == DPT_DEVICE_STATUS_LOST &&
                  state.reasons == kinds[i].reason && state.code == kinds[i].code && state.fresh == 0,
              "%x: %s, %u, %x", kinds[i].code, dpt_device_status_name(state.status), state.reasons, state.code);
        CHECK(!memcmp(&state.pose, &pose, sizeof pose), "%x: a pose of a lost device", kinds[i].code);
        CHECK(push(device, 1.0) == DPT_E_LOST, "%x: it takes force", kinds[i].code);
        tick(200);
        CHECK(there->frames == frames, "%x: it is still used", kinds[i].code);
        there->is_plugged = 0;
        CHECK(clear_device(device) == DPT_E_LOST, "%x: cleared while it is away", kinds[i].code);
        CHECK(dpt_device_read(device, &state) == DPT_E_LOST && state.reasons != 0, "%x: not lost", kinds[i].code);
        there->is_plugged = 1;
        CHECK(clear_device(device) == DPT_OK, "%x: not cleared", kinds[i].code);
        CHECK(dpt_device_read(device, &state) == DPT_OK && state.fresh > 0 && state.sequence > sequence,
              "%x: samples begin anew", kinds[i].code);
        dpt_device_get_counts(device, &counts);
        CHECK(counts.resets == (uint64_t)i + 1, "%d resets", (int)counts.resets);
        CHECK(counts.missed == missed && counts.samples == state.sequence, "%d missed, and %d before",
              (int)counts.missed, (int)missed);
        serve(110, 1.0);
    }
    finish();
}

/* The worse one counts, in whatever order they lie on the stack. */
static void the_worst_error_counts(void)
{
    for (int order = 0; order < 2; order++) {
        start("");
        lib->hold();
        lib->raise = order ? HD_COMM_ERROR : HD_FORCE_ERROR;
        there->temperature[0] = order ? 1.0 : 0.0;
        tick(1);
        lib->raise = order ? HD_FORCE_ERROR : HD_COMM_ERROR;
        tick(1);
        CHECK(dpt_device_read(device, &state) == DPT_E_LOST && state.code == HD_COMM_ERROR, "%x", state.code);
        there->temperature[0] = 0.0;
        finish();
    }
}

/* Frames by another part of the program, in our tick. */
static unsigned steal_a_frame(void *unused)
{
    void HD_CALL (*begin)(unsigned) = NULL;
    void *symbol = __real_dlsym(__real_dlopen(library_path, RTLD_NOW), "hdBeginFrame");
    (void)unused;
    memcpy(&begin, &symbol, sizeof begin);
    begin(0);
    return HD_CALLBACK_DONE;
}

static void a_second_frame_is_a_fault_with_its_number(void)
{
    unsigned long HD_CALL (*schedule)(hd_callback *, void *, unsigned short) = NULL;
    start("");
    void *symbol = __real_dlsym(__real_dlopen(library_path, RTLD_NOW), "hdScheduleAsynchronous");
    memcpy(&schedule, &symbol, sizeof schedule);
    schedule(steal_a_frame, NULL, 0);
    tick(2);
    CHECK(dpt_device_read(device, &state) == DPT_OK && state.status == DPT_DEVICE_STATUS_FAULT &&
              state.reasons == DPT_REASON_DEVICE && state.code == HD_ILLEGAL_BEGIN,
          "%s, %x", dpt_device_status_name(state.status), state.code);
    tick(200);
    CHECK(clear_device(device) == DPT_OK, "not cleared");
    finish();
}

static void the_inkwell_gives_no_force(void)
{
    start("");
    serve(150, 1.0);
    there->in_inkwell = 1;
    tick(1);
    CHECK(force_of(there) == 0.0, "%g N in the inkwell", force_of(there));
    CHECK(dpt_device_read(device, &state) == DPT_OK && state.status == DPT_DEVICE_STATUS_UNREADY &&
              state.reasons == DPT_REASON_DOCKED && state.fresh == 1,
          "%s, %u", dpt_device_status_name(state.status), state.reasons);
    CHECK(!strcmp(dpt_device_reason_name(state.reasons), "docked"), "the name");
    CHECK(push(device, 1.0) == DPT_E_NOT_READY, "it takes force");
    CHECK(clear_device(device) == DPT_E_NOT_READY, "cleared in the inkwell");
    there->in_inkwell = 0;
    tick(1);
    dpt_device_read(device, &state);
    serve(1, 1.0);
    CHECK(fabs(force_of(there) - 0.01) < 1e-15, "it kicks: %g", force_of(there));
    finish();
    /* One without an inkwell says 0 all the time. */
    there->styles = HD_CALIBRATION_AUTO;
    there->in_inkwell = 1;
    start("");
    CHECK(state.status == DPT_DEVICE_STATUS_READY, "%s", dpt_device_status_name(state.status));
    finish();
}

static void silence_of_the_device_is_loss(void)
{
    /* Our callback is thrown out: known as soon as the watchdog's time has passed. */
    patience = "";
    start("");
    patience = "&silent=2";
    serve(150, 1.0);
    lib->drops_callbacks = 1;
    tick(8);
    CHECK(dpt_device_read(device, &state) == DPT_OK && state.fresh == 0, "lost too soon");
    tick(5);
    CHECK(dpt_device_read(device, &state) == DPT_E_LOST && state.reasons == DPT_REASON_SILENT, "%u", state.reasons);
    CHECK(push(device, 1.0) == DPT_E_LOST, "write");
    CHECK(clear_device(device) == DPT_OK, "not cleared");
    dpt_device_read(device, &state);
    serve(150, 1.0);
    CHECK(force_of(there) == 1.0, "%g", force_of(there));

    /* The scheduler hangs: after a tenth of a second, and for good. */
    lib->hangs = 1;
    tick(90);
    CHECK(dpt_device_read(device, &state) == DPT_OK && state.fresh == 0, "lost too soon");
    tick(20);
    CHECK(dpt_device_read(device, &state) == DPT_E_LOST && state.reasons == DPT_REASON_SILENT, "%u", state.reasons);
    lib->hangs = 0;
    tick(5);
    CHECK(dpt_device_read(device, &state) == DPT_E_LOST && state.fresh == 0, "back by itself");
    CHECK(clear_device(device) == DPT_OK, "not cleared");
    finish();
}

static dpt_device *meanwhile_opened;
static int times_read;

static void open_another(void)
{
    CHECK(open_at(&meanwhile_opened, "Left Device", "") == DPT_OK, "%s", error.text);
}

static void read_later(void)
{
    times_read++;
    host.skew += 5000000000;
    CHECK(dpt_device_read(device, &state) == DPT_OK, "lost while another one opens");
}

static void read_now(void)
{
    times_read++;
    CHECK(dpt_device_read(device, &state) == DPT_OK && state.fresh == 0, "lost before the next sample");
}

/* While the scheduler stands for another device, and until its next tick; and just when one asks whether it lives. */
static void a_pause_is_no_death(void)
{
    start("");
    lib->in_init = read_later;
    lib->in_start = read_now;
    CHECK(open_at(&meanwhile_opened, "Left Device", "") == DPT_OK && times_read == 2, "%s", error.text);
    CHECK(dpt_device_read(device, &state) == DPT_OK && state.fresh > 0, "lost");
    close_one(meanwhile_opened);
    meanwhile_opened = NULL;
    lib->in_wait = open_another;
    pass(0.02);
    CHECK(dpt_device_read(device, &state) == DPT_OK && !lib->in_wait && meanwhile_opened,
          "lost by a pause, or nobody asked");
    close_one(meanwhile_opened);
    CHECK(dpt_device_read(device, &state) == DPT_OK, "lost");
    finish();
}

static void no_force_meanwhile(void)
{
    times_read++;
    CHECK(force_of(there) == 0.0, "%g N while the scheduler stands", force_of(there));
}

/* Nobody says that forces end with the scheduler. */
static void no_force_stays_while_another_opens(void)
{
    times_read = 0;
    start("&watchdog=1");
    serve(150, 1.0);
    lib->in_init = no_force_meanwhile;
    CHECK(open_at(&meanwhile_opened, "Left Device", "") == DPT_OK && times_read == 1, "%s", error.text);
    dpt_device_read(device, &state);
    serve(1, 1.0);
    CHECK(force_of(there) < 0.5, "it kicks: %g", force_of(there));
    serve(150, 1.0);
    lib->in_start = no_force_meanwhile;
    close_one(meanwhile_opened);
    CHECK(times_read == 2, "not started again");
    finish();
}

static void raise_in_the_first_frame(void)
{
    lib->unsupported[0] = HD_CURRENT_JOINT_ANGLES;
    lib->lingers = 1;
}

/* A start may take as long as it likes, and what the first tick raises is of whom it concerns. */
static void a_start_is_no_fault_of_others(void)
{
    dpt_device_info info = { .size = sizeof info };
    patience = "";
    start("");
    lib->in_start = read_later;
    CHECK(open_at(&meanwhile_opened, "Left Device", "") == DPT_OK, "%s", error.text);
    CHECK(dpt_device_read(device, &state) == DPT_OK, "lost by a slow start");
    close_one(meanwhile_opened);
    finish();
    patience = "&silent=2";
    start("");
    lib->in_start = raise_in_the_first_frame;
    CHECK(open_at(&meanwhile_opened, "Left Device", "") == DPT_OK, "%s", error.text);
    dpt_device_get_info(meanwhile_opened, &info);
    CHECK(dpt_device_read(device, &state) == DPT_OK && state.status == DPT_DEVICE_STATUS_FAULT &&
              state.code == HD_INVALID_ENUM && info.joints == 0,
          "%s, %x, %u joints", dpt_device_status_name(state.status), state.code, info.joints);
    close_one(meanwhile_opened);
    finish();
}

/* While it hangs nothing of ours is freed; when it goes on, it lets go of what was closed. */
static void a_scheduler_that_hangs_does_not_hang_us(void)
{
    start("");
    lib->hangs = 1;
    CHECK(open_at(&meanwhile_opened, "Left Device", "") == DPT_E_DEVICE && strstr(error.text, "hangs") &&
              !left->is_open,
          "%s", error.text);
    CHECK(clear_device(device) == DPT_E_LOST, "clear");
    close_one(device);
    CHECK(there->is_open, "closed under the scheduler's hands");
    lib->hangs = 0;
    tick(2);
    const unsigned long frames = there->frames;
    tick(10);
    CHECK(there->frames == frames && there->force[1] == 0.0, "it is still served");
    /* What was left behind is closed before the next is opened, which fails otherwise. */
    start("");
    finish();
}

int main(int argc, char **argv)
{
    (void)argc;
    take_stand_in(argv[0], "libHD-stand-in.so");
    renew();
    TEST(numbers_that_are_none_are_not_trusted);
    TEST(silence_of_the_host_ends_the_force);
    TEST(a_stop_in_a_debugger_does_not_kick);
    TEST(the_clock_may_fail);
    TEST(warm_motors_give_less);
    TEST(force_errors_are_faults);
    TEST(no_force_after_clear_until_a_write);
    TEST(scheduler_errors_are_loss);
    TEST(the_worst_error_counts);
    TEST(a_second_frame_is_a_fault_with_its_number);
    TEST(the_inkwell_gives_no_force);
    TEST(silence_of_the_device_is_loss);
    TEST(a_pause_is_no_death);
    TEST(no_force_stays_while_another_opens);
    TEST(a_start_is_no_fault_of_others);
    TEST(a_scheduler_that_hangs_does_not_hang_us);
    return check_report();
}
