/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A device's side of the protocol (drivers/serial/wire_device.h), asked frame by frame without a line: sessions, watchdog, latched
 * faults. Time passes by samples, so that every count is exact.
 */
#include <math.h>

#include "lib/check.h"
#include "serial/wire_device.h"

enum { WATCHDOG = 20, SESSION = 0x4711 };

static struct wire_device device;
static struct wire_sample sample;
static struct wire_reader host;
static struct wire_message state, other; /* the last state that it said, and the last of anything else */
static int states, others;

static void begin(void)
{
    const struct wire_info info = { .pose_dofs = 3,
                                    .wrench_dofs = 6,
                                    .joints = 2,
                                    .rate = 1000,
                                    .force_max = 5,
                                    .torque_max = 0.1f,
                                    .watchdog = 0.02f,
                                    .name = "a device" };
    memset(&sample, 0, sizeof sample);
    memset(&host, 0, sizeof host);
    memset(&state, 0, sizeof state);
    wire_device_init(&device, &info);
}

static void tick(void)
{
    uint8_t out[WIRE_OUT_MAX];
    struct wire_message message;
    states = others = 0;
    const size_t size = wire_device_sample(&device, &sample, out);
    CHECK(size <= WIRE_OUT_MAX, "%zu bytes", size);
    for (size_t i = 0; i < size; i++)
        if (wire_read(&host, out[i], &message) == WIRE_MESSAGE) {
            if (message.type == WIRE_STATE) {
                state = message;
                states++;
            } else {
                other = message;
                others++;
            }
        }
    CHECK(host.damaged == 0, "it sends what is no frame");
}

static void say(struct wire_message *message)
{
    uint8_t frame[WIRE_FRAME_MAX];
    const size_t size = wire_encode(message, frame);
    CHECK(size > 0, "type %d", message->type);
    for (size_t i = 0; i < size; i++)
        wire_device_take(&device, frame[i]);
}

static void hello(uint16_t session)
{
    struct wire_message message = { .type = WIRE_HELLO, .session = session };
    say(&message);
}

static void order(uint16_t session, uint8_t what)
{
    struct wire_message message = { .type = WIRE_ORDER, .session = session };
    message.as.order = what;
    say(&message);
}

static void command(uint16_t session, uint32_t sequence, uint32_t answers, float force)
{
    struct wire_message message = { .type = WIRE_COMMAND, .session = session };
    message.as.command.sequence = sequence;
    message.as.command.answers = answers;
    message.as.command.force[1] = force;
    message.as.command.torque[0] = force / 100;
    say(&message);
}

static int forceless(void)
{
    for (int i = 0; i < 3; i++)
        if (device.force[i] != 0 || device.torque[i] != 0)
            return 0;
    return 1;
}

static void make_ready(void)
{
    begin();
    hello(SESSION);
    order(SESSION, WIRE_ENABLE);
    tick();
    CHECK(state.as.state.status == WIRE_STATUS_READY, "status %d", state.as.state.status);
}

static void says_nothing_before_a_hello(void)
{
    int beats = 0;
    begin();
    command(SESSION, 1, 0, 1);
    order(SESSION, WIRE_ENABLE);
    order(0, WIRE_ENABLE);
    command(0, 1, 0, 1);
    for (int i = 0; i < 1000; i++) {
        tick();
        beats += others;
        CHECK(states == 0 && forceless(), "sample %d", i);
        CHECK(others == 0 || other.type == WIRE_HEARTBEAT, "sample %d", i);
    }
    CHECK(beats == 10, "%d heartbeats in a second", beats);
    hello(SESSION);
    tick();
    CHECK(states == 1 && others == 1 && other.type == WIRE_INFO, "%d %d", states, others);
    CHECK(other.session == SESSION && strcmp(other.as.info.name, "a device") == 0, "%s", other.as.info.name);
    CHECK(state.session == SESSION && state.as.state.sequence == 1001, "%u", (unsigned)state.as.state.sequence);
    CHECK(state.as.state.status == WIRE_STATUS_UNREADY, "%d", state.as.state.status);
    tick();
    CHECK(states == 1 && others == 0, "%d %d", states, others);
}

static void gives_force_only_when_ready(void)
{
    begin();
    hello(SESSION);
    tick();
    command(SESSION, 1, 1, 2);
    CHECK(forceless(), "not enabled");
    order(SESSION, WIRE_ENABLE);
    CHECK(forceless(), "before a command");
    tick();
    command(SESSION, 2, 1, 2);
    CHECK(device.force[1] == 2 && device.torque[0] == 0.02f, "%g %g", (double)device.force[1],
          (double)device.torque[0]);
    command(SESSION, 3, 1, -1e30f);
    CHECK(fabs((double)device.force[1] + 5) < 1e-6 && fabs((double)device.torque[0] + 0.1) < 1e-7, "%g %g",
          (double)device.force[1], (double)device.torque[0]);
    order(SESSION, WIRE_STOP);
    CHECK(forceless(), "stopped");
    command(SESSION, 4, 1, 2);
    CHECK(forceless(), "a command after stop");
    tick();
    CHECK(state.as.state.echo == 4 && state.as.state.lost == 0, "%u", (unsigned)state.as.state.echo);
}

static void watchdog_bites_after_its_time_and_stays(void)
{
    make_ready();
    /* It does not run before the first command. */
    for (int i = 0; i < 500; i++)
        tick();
    CHECK(state.as.state.status == WIRE_STATUS_READY, "%d", state.as.state.status);
    command(SESSION, 1, device.sequence, 2);
    for (int i = 1; i <= WATCHDOG; i++) {
        tick();
        CHECK(device.force[1] == 2, "sample %d", i);
    }
    tick();
    CHECK(forceless(), "one more");
    CHECK(state.as.state.status == WIRE_STATUS_FAULT && state.as.state.reasons == WIRE_REASON_WATCHDOG, "%d %d",
          state.as.state.status, state.as.state.reasons);
    for (uint32_t i = 2; i < 50; i++) {
        command(SESSION, i, device.sequence, 2);
        order(SESSION, WIRE_ENABLE);
        tick();
        CHECK(forceless() && state.as.state.status == WIRE_STATUS_FAULT, "it let go by itself");
    }
    /* A new host finds the fault, too. */
    hello(SESSION + 1);
    order(SESSION + 1, WIRE_ENABLE);
    tick();
    CHECK(state.session == SESSION + 1 && state.as.state.status == WIRE_STATUS_FAULT, "%d", state.as.state.status);
    order(SESSION + 1, WIRE_CLEAR);
    tick();
    CHECK(state.as.state.status == WIRE_STATUS_UNREADY && state.as.state.reasons == 0, "%d", state.as.state.status);
    command(SESSION + 1, 1, device.sequence, 2);
    CHECK(forceless(), "cleared is not enabled");
    order(SESSION + 1, WIRE_ENABLE);
    command(SESSION + 1, 2, device.sequence, 2);
    CHECK(device.force[1] == 2, "%g", (double)device.force[1]);
}

static void a_cause_that_holds_is_not_cleared(void)
{
    make_ready();
    command(SESSION, 1, device.sequence, 2);
    sample.causes = WIRE_REASON_ESTOP | WIRE_REASON_DEVICE;
    sample.code = 77;
    tick();
    CHECK(forceless() && state.as.state.status == WIRE_STATUS_FAULT && state.as.state.code == 77, "%d %d",
          state.as.state.status, state.as.state.code);
    order(SESSION, WIRE_CLEAR);
    order(SESSION, WIRE_ENABLE);
    command(SESSION, 2, device.sequence, 2);
    CHECK(forceless(), "between two samples");
    tick();
    CHECK(state.as.state.reasons == (WIRE_REASON_ESTOP | WIRE_REASON_DEVICE), "%d", state.as.state.reasons);
    sample.causes = 0;
    tick();
    CHECK(state.as.state.status == WIRE_STATUS_FAULT, "gone is not cleared");
    order(SESSION, WIRE_CLEAR);
    order(SESSION, WIRE_ENABLE);
    tick();
    CHECK(state.as.state.status == WIRE_STATUS_READY, "%d", state.as.state.status);
    sample.causes = WIRE_REASON_UNCALIBRATED;
    command(SESSION, 3, device.sequence, 2);
    tick();
    CHECK(forceless() && state.as.state.status == WIRE_STATUS_UNREADY &&
              state.as.state.reasons == WIRE_REASON_UNCALIBRATED,
          "%d %d", state.as.state.status, state.as.state.reasons);
    sample.causes = 0;
    tick();
    CHECK(state.as.state.status == WIRE_STATUS_READY, "no fault: it goes on by itself");
}

static void commands_are_counted(void)
{
    make_ready();
    const uint32_t now = device.sequence;
    command(SESSION, 1, now, 1);
    command(SESSION, 2, now, 2);
    command(SESSION, 5, now, 3);
    command(SESSION, 4, now, 4);
    command(SESSION, 4, now, 5);
    command(SESSION - 1, 6, now, 6);
    CHECK(device.force[1] == 3, "%g", (double)device.force[1]);
    tick();
    CHECK(state.as.state.echo == 5 && state.as.state.lost == 1 && state.as.state.reordered == 1 &&
              state.as.state.late == 0,
          "%u %d %d %d", (unsigned)state.as.state.echo, state.as.state.lost, state.as.state.reordered,
          state.as.state.late);
    for (int i = 0; i < WATCHDOG - 1; i++)
        tick();
    /* The oldest sample that may still be answered is WATCHDOG samples old. */
    command(SESSION, 6, now, 4);
    CHECK(device.force[1] == 4 && device.late == 0, "%g", (double)device.force[1]);
    tick();
    command(SESSION, 7, now, 5);
    CHECK(device.force[1] == 4 && device.late == 1, "%g", (double)device.force[1]);
    /* Late ones do not feed the watchdog. */
    for (uint32_t i = 0; i < WATCHDOG; i++) {
        command(SESSION, 8 + i, now, 5);
        tick();
    }
    CHECK(state.as.state.status == WIRE_STATUS_FAULT && forceless(), "%d", state.as.state.status);
    CHECK(state.as.state.late == WATCHDOG + 1 && state.as.state.lost == 1, "%d", state.as.state.late);
}

static void an_answer_that_was_lost_is_given_again(void)
{
    make_ready();
    command(SESSION, 1, device.sequence, 1);
    hello(SESSION);
    CHECK(device.force[1] == 1, "a repeated hello stops it");
    tick();
    CHECK(others == 1 && other.type == WIRE_INFO && state.as.state.echo == 1, "%d", others);
    hello(SESSION + 1);
    CHECK(forceless(), "another host's hello");
    command(SESSION, 2, device.sequence, 1);
    tick();
    CHECK(forceless() && state.as.state.echo == 0 && state.session == SESSION + 1, "a command of the old session");
}

static void a_host_that_is_gone_ends_the_session(void)
{
    struct wire_message life = { .type = WIRE_HEARTBEAT, .session = SESSION };
    make_ready();
    for (int i = 0; i < 3000; i++) {
        if (i % 1000 == 0)
            say(&life);
        tick();
        CHECK(states == 1, "sample %d", i);
    }
    int more = 0;
    for (int i = 0; i < 3000; i++) {
        tick();
        more += states;
    }
    CHECK(more == 0 && device.session == 0 && !device.is_enabled, "%d states to nobody", more);
}

static void a_log_goes_out_once(void)
{
    make_ready();
    wire_device_log(&device, "motor 2 is warm");
    tick();
    CHECK(others == 1 && other.type == WIRE_LOG && other.as.log.size == 15 &&
              memcmp(other.as.log.text, "motor 2 is warm", 15) == 0,
          "%d", others);
    tick();
    CHECK(others == 0 && states == 1, "%d", others);
}

int main(void)
{
    TEST(says_nothing_before_a_hello);
    TEST(gives_force_only_when_ready);
    TEST(watchdog_bites_after_its_time_and_stays);
    TEST(a_cause_that_holds_is_not_cleared);
    TEST(commands_are_counted);
    TEST(an_answer_that_was_lost_is_given_again);
    TEST(a_host_that_is_gone_ends_the_session);
    TEST(a_log_goes_out_once);
    return check_report();
}
