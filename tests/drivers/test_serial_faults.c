/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What goes wrong with a device at a serial line, with what is there in its place, with settings and with calls of the
 * system, and what the driver (drivers/serial/serial.c) makes of it.
 */
#include "drivers/serial_fixture.h"

#include "drivers/wire_frame.h"

static void silence_is_loss_and_can_be_cleared(void)
{
    start(NULL, "?silent=0.2");
    write_force(1);
    simulate_serial_tick(&simulated);
    pause_ms(300);
    CHECK(dpt_device_read(device, &state) == DPT_OK, "a sample that waits is no silence");
    pause_ms(300);
    CHECK(dpt_device_read(device, &state) == DPT_E_LOST && state.status == DPT_DEVICE_STATUS_LOST &&
              state.reasons == DPT_REASON_SILENT && state.fresh == 0,
          "%u %u", state.status, state.reasons);
    CHECK(write_force(1) == DPT_E_LOST, "write");
    /* It speaks again, its watchdog has bitten: still lost, until it is cleared. */
    for (int i = 0; i < 30; i++)
        simulate_serial_tick(&simulated);
    CHECK(dpt_device_read(device, &state) == DPT_E_LOST && write_force(1) == DPT_E_LOST, "read");
    CHECK(simulated.device.reasons == WIRE_REASON_WATCHDOG && simulated.device.force[1] == 0, "%d",
          simulated.device.reasons);
    const uint64_t sequence = state.sequence;
    go();
    CHECK(clear() == DPT_OK, "clear");
    halt();
    simulate_serial_tick(&simulated);
    CHECK(dpt_device_read(device, &state) == DPT_OK && state.status == DPT_DEVICE_STATUS_READY, "read");
    CHECK(state.sequence > sequence, "its numbers begin anew");
    dpt_device_get_counts(device, &counts);
    CHECK(counts.resets == 1 && counts.damaged == 0, "%u", (unsigned)counts.resets);
    finish();
}

/* A fault stays until it is cleared, and while its cause is there it cannot be. */
static void faults_are_cleared(void)
{
    start(NULL, "?silent=30");
    CHECK(write_force(1) == DPT_OK, "write");
    for (int i = 0; i < 25; i++)
        simulate_serial_tick(&simulated);
    CHECK(dpt_device_read(device, &state) == DPT_OK && state.status == DPT_DEVICE_STATUS_FAULT &&
              state.reasons == DPT_REASON_WATCHDOG,
          "%u %u", state.status, state.reasons);
    CHECK(write_force(1) == DPT_E_NOT_READY && simulated.device.force[1] == 0, "write");
    go();
    CHECK(clear() == DPT_OK, "clear");
    simulated.causes = WIRE_REASON_ESTOP;
    for (int i = 0; i < 10000 && state.reasons != DPT_REASON_ESTOP; i++) {
        pause_ms(1);
        CHECK(dpt_device_read(device, &state) == DPT_OK, "read");
    }
    CHECK(state.status == DPT_DEVICE_STATUS_FAULT && state.reasons == DPT_REASON_ESTOP, "%u", state.reasons);
    CHECK(clear() == DPT_E_NOT_READY, "clear");
    simulated.causes = 0;
    CHECK(clear() == DPT_OK, "clear");
    halt();
    dpt_device_read(device, &state);
    CHECK(state.status == DPT_DEVICE_STATUS_READY && state.reasons == 0, "%u", state.reasons);
    dpt_device_get_counts(device, &counts);
    CHECK(counts.resets == 0, "%u", (unsigned)counts.resets);
    finish();
}

static void damage_alone_is_the_line(void)
{
    start(NULL, "?silent=0.2");
    pause_ms(300);
    CHECK(write(simulated.master, "no frame at all\0", 16) == 16, "write");
    CHECK(dpt_device_read(device, &state) == DPT_E_LOST, "read");
    CHECK(state.reasons == (DPT_REASON_SILENT | DPT_REASON_LINK), "%u", state.reasons);
    const uint8_t body[] = { WIRE_STATE, WIRE_VERSION + 1, 0, 0 };
    uint8_t frame[16];
    const size_t size = frame_of(body, sizeof body, frame);
    CHECK(write(simulated.master, frame, size) == (ssize_t)size, "write");
    CHECK(dpt_device_read(device, &state) == DPT_E_LOST && state.reasons & DPT_REASON_VERSION, "%u", state.reasons);
    dpt_device_get_counts(device, &counts);
    CHECK(counts.damaged == 2, "%u", (unsigned)counts.damaged);
    finish();
}

static void a_device_that_begins_anew_is_noticed(void)
{
    start(NULL, "?silent=30");
    const struct wire_info info = simulated.device.info;
    for (int i = 0; i < 200; i++) {
        simulate_serial_tick(&simulated);
        CHECK(dpt_device_read(device, &state) == DPT_OK, "read");
    }
    wire_device_init(&simulated.device, &info);
    for (int i = 0; i < 200; i++)
        simulate_serial_tick(&simulated);
    CHECK(write_force(1) == DPT_OK, "not known yet");
    simulate_serial_tick(&simulated);
    CHECK(simulated.device.force[1] == 0, "a command of a session that it does not know");
    CHECK(dpt_device_read(device, &state) == DPT_E_LOST, "read");
    dpt_device_get_counts(device, &counts);
    CHECK(counts.resets == 1, "%u", (unsigned)counts.resets);
    CHECK(write_force(1) == DPT_E_LOST, "write");
    go();
    CHECK(clear() == DPT_OK, "clear");
    halt();
    CHECK(dpt_device_read(device, &state) == DPT_OK && state.status == DPT_DEVICE_STATUS_READY, "read");
    finish();
}

/* Firmware that shows life within a session, and what is left in a line of an earlier one, end none. */
static void only_a_heartbeat_without_a_session_ends_it(void)
{
    struct wire_message alive = { .type = WIRE_HEARTBEAT };
    uint8_t frame[WIRE_FRAME_MAX];
    start(NULL, "?silent=30");
    const uint16_t session = simulated.device.session, sessions[] = { session, session == 7 ? 8 : 7, 0 };
    for (int i = 0; i < 3; i++) {
        alive.session = sessions[i];
        alive.as.heartbeat.sequence = simulated.device.sequence;
        const size_t size = wire_encode(&alive, frame);
        CHECK(write(simulated.master, frame, size) == (ssize_t)size, "no room");
        simulate_serial_tick(&simulated);
        const dpt_result result = dpt_device_read(device, &state);
        CHECK(result == (sessions[i] ? DPT_OK : DPT_E_LOST), "session %u of %u: %s", sessions[i], session,
              dpt_result_name(result));
    }
    go();
    CHECK(clear() == DPT_OK, "clear");
    halt();
    finish();
}

static void unplugged_and_plugged_in_again(void)
{
    char link[64];
    snprintf(link, sizeof link, "build/tests/serial.%ld", (long)getpid());
    CHECK(simulate_serial_start(&simulated, NULL) == 0, "no pty");
    unlink(link);
    CHECK(symlink(simulated.path, link) == 0, "%s", strerror(errno));
    go();
    CHECK(open_at(link, "?answer=0.5") == DPT_OK, "%s", error.text);
    halt();
    simulate_serial_end(&simulated);
    if (!device)
        return;
    dpt_device_read(device, &state);
    CHECK(dpt_device_read(device, &state) == DPT_E_LOST && state.reasons == DPT_REASON_UNPLUGGED, "%u", state.reasons);
    CHECK(write_force(1) == DPT_E_LOST, "write");
    unlink(link);
    CHECK(clear() == DPT_E_LOST && held == 0, "clear while it is gone");
    CHECK(dpt_device_read(device, &state) == DPT_E_LOST && state.reasons == DPT_REASON_UNPLUGGED, "read");
    CHECK(simulate_serial_start(&simulated, NULL) == 0, "no pty");
    CHECK(symlink(simulated.path, link) == 0, "%s", strerror(errno));
    CHECK(clear() == DPT_E_LOST, "clear while it does not answer");
    go();
    CHECK(clear() == DPT_OK, "clear");
    halt();
    simulate_serial_tick(&simulated);
    CHECK(dpt_device_read(device, &state) == DPT_OK && state.status == DPT_DEVICE_STATUS_READY, "%u", state.status);
    finish();
    unlink(link);
}

static void refused(dpt_result result, dpt_result code, const char *word)
{
    CHECK(result == code && error.code == code, "%d: %s", result, error.text);
    CHECK(strstr(error.text, word) && strlen(error.text) < sizeof error.text - 1, "'%s' lacks '%s'", error.text, word);
    CHECK(device == NULL && held == 0, "%d descriptors are left", held);
}

static void refusals_say_the_cure(void)
{
    char path[64];
    refused(open_at("/dev/does-not-exist", ""), DPT_E_DEVICE, "plugged in");
    refused(open_at("/dev/null", ""), DPT_E_DEVICE, "not a serial port");
    refused(open_at("/dev/null", "?speed=1234567"), DPT_E_SETTING, "115200");
    refused(open_at("/dev/null", "?spede=9600"), DPT_E_SETTING, "spede");
    const int master = relay_pty(path);
    calls = 0;
    fail_at = 2; /* the allocation, and then open */
    fail_errno = EACCES;
    refused(open_at(path, ""), DPT_E_PERMISSION, "usermod -aG dialout");
    fail_at = 0;
    other_speed = 1;
    refused(open_at(path, ""), DPT_E_SYSTEM, "runs at 9600 baud where 1000000");
    other_speed = 0;
    refused(open_at(path, "?answer=0.2"), DPT_E_DEVICE, "no answer");
    const int line = relay_open(path);
    CHECK(flock(line, LOCK_EX) == 0, "flock");
    refused(open_at(path, ""), DPT_E_SYSTEM, "in use by another program");
    close(line);
    close(master);
}

/* Something else is at the other end, and sends `noise` every 5 ms. */
static uint8_t noise[64];
static size_t noise_size;
static int noisy;

static void make_noise(void)
{
    if (now_ns / 1000000u % 5 == 0)
        CHECK(write(noisy, noise, noise_size) == (ssize_t)noise_size, "no room for noise");
}

static void other_devices_are_told_apart(void)
{
    char path[64];
    const uint8_t body[] = { WIRE_HEARTBEAT, 9, 0, 0 };
    noisy = relay_pty(path);
    noise_size = 16;
    memcpy(noise, "$GPGGA,123519\r\n\0", 16);
    each_ms = make_noise;
    refused(open_at(path, "?answer=0.5"), DPT_E_DEVICE, "another speed");
    halt();
    noise_size = frame_of(body, sizeof body, noise);
    each_ms = make_noise;
    refused(open_at(path, "?answer=0.5"), DPT_E_PROTOCOL, "version 9");
    halt();
    close(noisy);
    /* Samples that the line cannot carry. */
    struct wire_info info;
    simulate_serial_info(&info);
    CHECK(simulate_serial_start(&simulated, &info) == 0, "no pty");
    go();
    refused(open_at(simulated.path, "?speed=460800"), DPT_E_SETTING, "at least 610000 baud");
    simulated.device.info.wrench_dofs = 4;
    refused(open_at(simulated.path, ""), DPT_E_DEVICE, "makes no sense");
    halt();
    simulate_serial_end(&simulated);
}

/*
 * Each system call of an open, a few cycles, a clear and a close fails in its turn, with each of some errors: nothing
 * hangs, nothing stays open, what is refused has a reason, and a line that lives works when it is cleared.
 */
static void every_call_may_fail(void)
{
    static const int errors[] = { EIO, EINTR, EAGAIN, ENOTTY, ENOMEM };
    int walked = 0, refusals = 0;
    CHECK(simulate_serial_start(&simulated, NULL) == 0, "no pty");
    go();
    for (size_t e = 0; e < sizeof errors / sizeof *errors; e++) {
        int done = 0;
        fail_errno = errors[e];
        for (int number = 1; !done && number < 200; number++) {
            calls = 0;
            fail_at = number;
            device = NULL;
            const dpt_result opened = open_at(simulated.path, "?answer=2&silent=5");
            walked++;
            if (opened != DPT_OK) {
                refusals++;
                CHECK(device == NULL && error.text[0] && held == 0, "call %d, error %d: %s, %d left", number,
                      fail_errno, error.text, held);
                continue;
            }
            for (int i = 0; i < 3; i++) {
                watched = 1;
                const dpt_result got = dpt_device_read(device, &state);
                const dpt_result put = write_force(0.1);
                watched = 0;
                CHECK(got == DPT_OK || got == DPT_E_LOST, "call %d, error %d: read %d", number, fail_errno, got);
                CHECK(put == DPT_OK || put == DPT_E_LOST || put == DPT_E_BUSY || put == DPT_E_NOT_READY,
                      "call %d, error %d: write %d", number, fail_errno, put);
            }
            clear();
            const int before = fail_at;
            fail_at = 0;
            const dpt_result cleared = clear();
            CHECK(cleared == DPT_OK, "call %d, error %d: clear %d", number, fail_errno, cleared);
            fail_at = before;
            done = calls < number;
            close_device();
        }
        CHECK(done, "error %d: no end", fail_errno);
    }
    fail_at = 0;
    halt();
    simulate_serial_end(&simulated);
    CHECK(refusals > 20, "%d", refusals);
    printf("    %d calls failed, %d opens were refused\n", walked, refusals);
}

int main(void)
{
    if (!has_ptys("all of test_serial_faults"))
        return check_report();
    TEST(silence_is_loss_and_can_be_cleared);
    TEST(faults_are_cleared);
    TEST(damage_alone_is_the_line);
    TEST(a_device_that_begins_anew_is_noticed);
    TEST(only_a_heartbeat_without_a_session_ends_it);
    TEST(unplugged_and_plugged_in_again);
    TEST(refusals_say_the_cure);
    TEST(other_devices_are_told_apart);
    TEST(every_call_may_fail);
    return check_report();
}
