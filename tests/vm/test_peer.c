/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The emulated controllers of tests/vm/peer.py, by frames that are written out here byte by byte, from ODrive's documentation: so
 * that what the driver is held against is held against something itself.
 */
#include "vm/can_socket.h"

#include <math.h>

#include "lib/check.h"
#include "vm/net.h"
#include "vm/peer.h"

enum { NEW = 0, OTHER = 5, OLD = 2, SOON = 5000 };
enum {
    VERSION = 0x00,
    HEARTBEAT = 0x01,
    ESTOP = 0x02,
    ERROR = 0x03,
    AXIS_STATE = 0x07,
    ESTIMATES = 0x09,
    MODE = 0x0b,
    TORQUE = 0x0e,
    CLEAR = 0x18,
};

#define FRICTION 0.01

static const char name[] = "vcan3";
static struct peer peer;
static int line;
static unsigned torques;
static uint32_t torques_crc;

static uint32_t crc32(uint32_t crc, const uint8_t *bytes, size_t size)
{
    crc = ~crc;
    for (size_t i = 0; i < 8 * size; i++) {
        crc ^= bytes[i / 8] >> i % 8 & 1;
        crc = crc >> 1 ^ (crc & 1 ? 0xedb88320 : 0);
    }
    return ~crc;
}

static void send_frame(unsigned node, unsigned command, unsigned size, uint64_t data)
{
    const struct can_frame frame = can_frame_of(node << 5 | command, size, data);
    const int problem = can_send(line, &frame);
    CHECK(problem == 0, "%s", strerror(problem));
}

static void request(unsigned node, unsigned command)
{
    const struct can_frame frame = can_frame_of((node << 5 | command) | CAN_RTR_FLAG, 0, 0);
    const int problem = can_send(line, &frame);
    CHECK(problem == 0, "%s", strerror(problem));
}

static void send_torque(unsigned node, float torque)
{
    uint32_t bits;
    memcpy(&bits, &torque, sizeof bits);
    send_frame(node, TORQUE, 4, bits);
    if (node != NEW)
        return;
    const struct can_frame frame = can_frame_of(0, 4, bits);
    torques_crc = crc32(torques_crc, frame.data, 4);
    torques++;
}

/* Take all that came up to now. */
static void drain(void)
{
    while (can_next(line, 0).problem == 0)
        ;
}

/* The next message of this kind, behind those that were taken. */
static struct can_frame next_of(unsigned node, unsigned command)
{
    for (int i = 0; i < SOON; i++) {
        const struct can_heard heard = can_next(line, SOON);
        if (heard.problem == 0 && heard.frame.can_id == (node << 5 | command))
            return heard.frame;
    }
    CHECK(0, "no message %02x of axis %u", command, node);
    return can_frame_of(0, 8, 0);
}

/* The next message of this kind after all that came up to now. */
static struct can_frame fresh(unsigned node, unsigned command)
{
    drain();
    return next_of(node, command);
}

static uint32_t word(const struct can_frame *frame, int at)
{
    return frame->data[at] | (uint32_t)frame->data[at + 1] << 8 | (uint32_t)frame->data[at + 2] << 16 |
           (uint32_t)frame->data[at + 3] << 24;
}

static float number(const struct can_frame *frame, int at)
{
    const uint32_t bits = word(frame, at);
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

/* Waits for a heartbeat with this state and this error. */
static void check_beats(unsigned node, unsigned state, uint32_t error, const char *when)
{
    struct can_frame frame = { .can_dlc = 0 };
    for (int i = 0; i < 60; i++) {
        frame = fresh(node, HEARTBEAT);
        if (frame.can_dlc == 8 && frame.data[4] == state && word(&frame, 0) == error)
            return;
    }
    CHECK(0, "%s: axis %u has state %u, error %x, %u bytes", when, node, frame.data[4], word(&frame, 0), frame.can_dlc);
}

static void close_loop(unsigned node)
{
    send_frame(node, CLEAR, 0, 0);
    send_frame(node, MODE, 8, 1 | (uint64_t)1 << 32);
    send_frame(node, AXIS_STATE, 4, 8);
}

static void axes_are_idle_at_rest(void)
{
    const unsigned nodes[] = { NEW, OTHER, OLD };
    for (int i = 0; i < 3; i++) {
        check_beats(nodes[i], 1, 0, "at first");
        const struct can_frame estimates = fresh(nodes[i], ESTIMATES);
        CHECK(estimates.can_dlc == 8 && word(&estimates, 0) == 0 && word(&estimates, 4) == 0, "%u bytes, %g, %g",
              estimates.can_dlc, (double)number(&estimates, 0), (double)number(&estimates, 4));
    }
}

static void the_newer_firmware_tells_its_version(void)
{
    /* The answer may be there as soon as the question is sent: what is taken away is taken before. */
    drain();
    request(OTHER, VERSION);
    const struct can_frame version = next_of(OTHER, VERSION);
    static const uint8_t bytes[8] = { 2, 4, 4, 58, 0, 6, 10, 0 };
    CHECK(version.can_dlc == 8 && !memcmp(version.data, bytes, 8), "%u bytes, %u.%u.%u", version.can_dlc,
          version.data[4], version.data[5], version.data[6]);
    request(OLD, VERSION);
    for (struct can_heard heard; (heard = can_next(line, SOON)).problem == 0;) {
        CHECK(heard.frame.can_id != (OLD << 5 | VERSION), "0.5 has no version");
        if (heard.frame.can_id == (OLD << 5 | HEARTBEAT))
            break;
    }
}

/* At last friction takes all of the torque. */
static void torque_moves_an_axis_in_closed_loop_only(void)
{
    send_torque(NEW, 0.01f);
    close_loop(NEW);
    close_loop(OLD);
    check_beats(NEW, 8, 0, "closed loop");
    check_beats(OLD, 8, 0, "closed loop");
    struct can_frame estimates = fresh(NEW, ESTIMATES);
    CHECK(word(&estimates, 0) == 0, "a torque from before counts: %g", (double)number(&estimates, 0));
    for (int i = 0; i < 100; i++) {
        send_torque(NEW, (float)i * 1e-4f);
        send_torque(OTHER, 0.001f);
    }
    for (int i = 0; i < 100; i++) {
        send_torque(NEW, 0.01f);
        send_torque(OLD, -0.01f);
        estimates = fresh(NEW, ESTIMATES);
    }
    const double last = 0.01 / FRICTION / (2.0 * 3.14159265358979);
    CHECK(fabs((double)number(&estimates, 4) - last) < 1e-6, "%g rev/s", (double)number(&estimates, 4));
    CHECK(number(&estimates, 0) > 0.0f, "%g rev", (double)number(&estimates, 0));
    estimates = fresh(OLD, ESTIMATES);
    CHECK(fabs((double)number(&estimates, 4) + last) < 1e-6, "%g rev/s", (double)number(&estimates, 4));
    estimates = fresh(OTHER, ESTIMATES);
    CHECK(word(&estimates, 0) == 0 && word(&estimates, 4) == 0, "an idle axis moves");
}

static void an_emergency_stop_lasts_until_errors_are_cleared(void)
{
    close_loop(NEW);
    check_beats(NEW, 8, 0, "closed loop");
    send_frame(NEW, ESTOP, 0, 0);
    send_frame(OLD, ESTOP, 0, 0);
    check_beats(NEW, 1, 0x02000000, "emergency stop");
    check_beats(OLD, 1, 0x4000, "emergency stop");
    send_frame(NEW, AXIS_STATE, 4, 8);
    fresh(NEW, HEARTBEAT);
    check_beats(NEW, 1, 0x02000000, "not cleared");
    request(NEW, ERROR);
    const struct can_frame error = fresh(NEW, ERROR);
    CHECK(word(&error, 0) == 0x02000000 && word(&error, 4) == 0x02000000, "%x, %x", word(&error, 0), word(&error, 4));
    close_loop(NEW);
    check_beats(NEW, 8, 0, "cleared");
}

static void the_watchdog_ends_the_closed_loop(void)
{
    close_loop(NEW);
    close_loop(OLD);
    check_beats(NEW, 1, 0x01000000, "silence");
    check_beats(OLD, 1, 0x800, "silence");
}

static void it_reports_what_it_heard(void)
{
    const struct can_frame extended = can_frame_of(0x1234567 | CAN_EFF_FLAG, 0, 0);
    CHECK(can_send(line, &extended) == 0, "%s", strerror(errno));
    fresh(NEW, HEARTBEAT);
    CHECK(peer_stop(&peer) == 0, "no report");
    static const struct {
        const char *name;
        double value;
    } numbers[] = {
        { "0.Estop.count", 1 },
        { "2.Estop.count", 1 },
        { "0.Get_Error.requests", 1 },
        { "5.Get_Version.requests", 1 },
        { "5.Set_Input_Torque.count", 100 },
        { "2.Set_Input_Torque.count", 100 },
        { "0.Set_Controller_Mode.Control_Mode", 1 },
        { "0.Set_Controller_Mode.Input_Mode", 1 },
        { "0.Set_Axis_State.Axis_Requested_State", 8 },
        { "0.state", 1 },
        { "0.error", 0x01000000 },
        { "5.position", 0 },
        { "strangers", 2 },
        { "errors", 0 },
    };
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
        CHECK(peer_number(&peer, numbers[i].name) == numbers[i].value, "%s: %g instead of %g", numbers[i].name,
              peer_number(&peer, numbers[i].name), numbers[i].value);
    CHECK(peer_number(&peer, "0.Set_Input_Torque.count") == torques, "%g torques instead of %u",
          peer_number(&peer, "0.Set_Input_Torque.count"), torques);
    CHECK(peer_number(&peer, "0.Set_Input_Torque.crc") == torques_crc, "they are others");
    CHECK(peer_number(&peer, "0.Set_Input_Torque.Input_Torque") == (double)0.01f, "%.9g Nm",
          peer_number(&peer, "0.Set_Input_Torque.Input_Torque"));
    CHECK(peer_number(&peer, "0.sent.Get_Encoder_Estimates") >= 100, "%g estimates",
          peer_number(&peer, "0.sent.Get_Encoder_Estimates"));
    CHECK(isnan(peer_number(&peer, "2.Get_Version.requests")), "0.5 has a version");
}

int main(void)
{
    if (!getenv("DPT_PEER")) {
        SKIP("the peer", "no python-can");
        return check_report();
    }
    const int problem = net_add(name) || net_up(name)
                            ? EIO
                            : peer_start(&peer, "--interface vcan3 --axis 0:0.6 --axis 5:0.6 "
                                                "--axis 2:0.5 --rate 400 --watchdog 2 --friction 0.01");
    line = can_socket(name);
    if (problem || line < 0) {
        printf("  FAIL no peer: %s\n", strerror(problem ? problem : errno));
        check_failed++;
        return check_report();
    }
    TEST(axes_are_idle_at_rest);
    TEST(the_newer_firmware_tells_its_version);
    TEST(torque_moves_an_axis_in_closed_loop_only);
    TEST(an_emergency_stop_lasts_until_errors_are_cleared);
    TEST(the_watchdog_ends_the_closed_loop);
    TEST(it_reports_what_it_heard);
    close(line);
    net_remove(name);
    return check_report();
}
