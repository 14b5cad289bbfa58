/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What the driver for arms on CAN (drivers/can/can.c) does until it is open: settings, nodes that are unfit, late or in use, and
 * calls of the system that fail; on a bus that stands in for the kernel's (can_kernel.h). Time is simulated.
 */
#include "drivers/can_fixture.h"

static char gantry_path[64];

static void settings_are_checked(void)
{
    static const struct {
        const char *settings, *word;
    } wrong[] = {
        { "gear=8,8", "gear" },
        { "gear=8,8,8,8", "gear" },
        { "gear=8,0,8", "joint 1" },
        { "gear=8,x,8", "gear" },
        { "nodes=1,2,1", "nodes" },
        { "nodes=1,2,64", "nodes" },
        { "nodes=1,2,0.5", "nodes" },
        { "axes=xxy", "axes" },
        { "axes=yxz", "axes" },
        { "axes=xy", "axes" },
        { "axes=xyzz", "axes" },
        { "torque=1,1", "torque" },
        { "torque=1,-1,1", "torque" },
        { "centre=0,0", "centre" },
        { "firmware=0.7", "firmware" },
        { "weight=0.5", "weight" },
        { "rate=1", "rate" },
        { "rate=50", "three periods" },
        { "silent=0.0029", "three periods" },
        { "spede=1", "spede" },
        { "heartbeat=1e999", "heartbeat" },
        { "watchdog=0", "none" },
        { "watchdog=11", "none" },
        { "watchdog=off", "none" },
    };
    char where[256];
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++)
        refused(open_at(where_of(elbow_path, wrong[i].settings)), DPT_E_SETTING, wrong[i].word);
    refused(open_at(""), DPT_E_SETTING, "can:can0");
    refused(open_at("can0"), DPT_E_SETTING, "arm");
    refused(open_at("can0?arm=/does/not/exist.dpa"), DPT_E_OPEN, "/does/not/exist.dpa");
    refused(open_at("can0?arm=Makefile"), DPT_E_MAGIC, "no compiled arm");
    refused(open_at(where_of(gantry_path, "weight=0")), DPT_E_SETTING, "a metre");
    snprintf(where, sizeof where, "a-name-that-is-too-long?arm=%s", elbow_path);
    refused(open_at(where), DPT_E_SETTING, "interface");
    snprintf(where, sizeof where, "can9?arm=%s", elbow_path);
    refused(open_at(where), DPT_E_DEVICE, "no interface can9");
}

static void refusals_say_the_cure(void)
{
    const char *where = where_of(elbow_path, ELBOW);
    can_no_family = 1;
    refused(open_at(where), DPT_E_UNSUPPORTED, "modprobe");
    can_no_family = 0;
    can_is_down = 1;
    refused(open_at(where), DPT_E_DEVICE, "ip link set can0 up");
    can_is_down = 0;
    can_is_ethernet = 1;
    refused(open_at(where), DPT_E_DEVICE, "no CAN interface");
    can_is_ethernet = 0;
    can_is_full = 1;
    refused(open_at(where), DPT_E_DEVICE, "nobody on can0 acknowledges");
    can_is_full = 0;
    refused(open_at(where), DPT_E_DEVICE, "no node 0 on can0");
}

/* Another controller of that number, which says nothing else. */
static void each_ms_with_a_twin(void)
{
    struct odrive_message address = { .node = 1, .command = ODRIVE_ADDRESS };
    struct can_message frame;
    address.as.address.serial = 0x123456789abc;
    odrive_encode(&address, ODRIVE_0_6, &frame);
    if (simulated.ticks % 100 == 0)
        socketcan_send(&stranger, &frame, 1);
    each_ms();
}

static void each_ms_with_another_host(void)
{
    if (simulated.ticks % 100 == 0)
        someone_says(0, ODRIVE_SET_TORQUE, 0.1f);
    each_ms();
}

/* What is wrong with a node before it is used at all. */
static void nodes_are_checked(void)
{
    static const char settings[] = ELBOW "&nodes=0,1,2&firmware=0.6";
    error.size = sizeof error;
    simulate(elbow_path, settings);
    const char *where = where_of(elbow_path, settings);
    struct simulate_can_node *node = &simulated.node[1];
    const struct simulate_can_node sound = *node;
    node->is_mute = 1;
    refused(open_at(where), DPT_E_DEVICE, "no node 1");
    *node = sound;
    node->heartbeat_ticks = 0;
    refused(open_at(where), DPT_E_DEVICE, "no heartbeat");
    *node = sound;
    node->generation = ODRIVE_0_5;
    refused(open_at(where), DPT_E_PROTOCOL, "node 1 has firmware 0.5");
    CHECK(node->node == 1, "it was given the number %u", node->node);
    *node = sound;
    node->estimate_ticks = 10;
    refused(open_at(where), DPT_E_DEVICE, "100 times a second, not 1000: set");
    refused(open_at(where), DPT_E_DEVICE, "encoder_msg_rate_ms (0.6) to 1,");
    *node = sound;
    node->estimate_ticks = 0;
    refused(open_at(where), DPT_E_DEVICE, "0 times a second");
    *node = sound;
    node->copies = 2;
    refused(open_at(where), DPT_E_DEVICE, "two controllers with the number 1");
    *node = sound;
    node->heartbeat_ticks = 1000;
    refused(open_at(where), DPT_E_DEVICE, "heartbeat less often");
    *node = sound;
    open_stranger();
    can_each_ms = each_ms_with_another_host;
    refused(open_at(where), DPT_E_DEVICE, "someone else");
    can_each_ms = each_ms_with_a_twin;
    refused(open_at(where), DPT_E_DEVICE, "two controllers with the number 1");
    socketcan_close(&stranger);
    can_each_ms = each_ms;
    node->causes = 0x40000000;
    refused(open_at(where), DPT_E_NOT_READY, "node 1: IDLE, CALIBRATION_ERROR");
    pass_ms(2);
    CHECK(simulated.node[0].state == ODRIVE_STATE_IDLE, "the others are on");
    *node = sound;
    node->state = 4;
    node->causes = 0x10;
    refused(open_at(where), DPT_E_NOT_READY, "BAD_CONFIG");
    *node = sound;
    CHECK(open_at(where) == DPT_OK, "%s", error.text);
    finish();
    simulate(elbow_path, ELBOW);
    refused(open_at(where_of(elbow_path, ELBOW "&request=1")), DPT_E_DEVICE, "needless");
    refused(open_at(where_of(elbow_path, ELBOW "&rate=800")), DPT_E_DEVICE, "?rate= is more");
    simulated.node[1].heartbeat_ticks = 50;
    refused(open_at(where_of(elbow_path, ELBOW)), DPT_E_DEVICE, "?heartbeat=");
    end_simulation();
}

/* Power that comes half a second late. */
static void each_ms_of_a_late_one(void)
{
    simulated.node[1].is_mute = simulated.ticks < 590;
    each_ms();
}

static void one_that_comes_late_is_asked_too(void)
{
    static const unsigned generations[] = { ODRIVE_0_5, ODRIVE_0_6 };
    for (int i = 0; i < 2; i++) {
        dpt_device_info info = { .size = sizeof info };
        simulate(elbow_path, ELBOW);
        for (int k = 0; k < 3; k++) {
            simulated.node[k].generation = (uint8_t)generations[i];
            simulated.node[k].is_done = i != 0; /* of 0.5 it would tell */
        }
        simulated.ticks = 37; /* its heartbeat is between two questions */
        can_each_ms = each_ms_of_a_late_one;
        CHECK(open_at(where_of(elbow_path, ELBOW)) == DPT_OK, "0.%u: %s", generations[i], error.text);
        if (!device)
            return;
        dpt_device_get_info(device, &info);
        CHECK(strstr(info.name, i ? "0.6" : "0.5"), "%s", info.name);
        can_each_ms = each_ms;
        finish();
    }
}

/* A queue of the interface's that has room for some frames only, until some are on the bus. */
static int room_left, times_full;

static int fill_the_queue(int fd, const struct can_frame *frame)
{
    (void)frame;
    if (fd != simulated.line.fd && --room_left == 0) {
        times_full++;
        can_is_full = 1;
    }
    return CAN_PASS;
}

static void each_ms_with_room_again(void)
{
    room_left = 6;
    can_is_full = 0;
    each_ms();
}

/* A host before us died: motors are on, and not in torque control. That they are on does not say that they took our orders. */
static void motors_that_are_on_are_told_their_mode(void)
{
    for (uint64_t beat_at = 0; beat_at < 100; beat_at += 5) {
        simulate(elbow_path, ELBOW);
        for (int i = 0; i < 3; i++) {
            simulated.node[i].state = ODRIVE_STATE_CLOSED_LOOP;
            simulated.node[i].torque = 0.125f;
        }
        simulated.ticks = beat_at;
        times_full = 0;
        room_left = 6;
        can_fate = fill_the_queue;
        can_each_ms = each_ms_with_room_again;
        CHECK(open_at(where_of(elbow_path, ELBOW)) == DPT_OK, "%s", error.text);
        CHECK(times_full > 0, "there was room for all");
        for (int i = 0; i < 3; i++)
            CHECK(simulated.node[i].is_torque_mode && !is_pushing(), "beat at %u: motor %d is not", (unsigned)beat_at,
                  i);
        can_fate = NULL;
        if (device)
            finish();
    }
}

/* One that says where it is until its motor is on, and then no more. */
static void each_ms_until_on(void)
{
    struct simulate_can_node *node = simulated.node;
    const int on = node[0].state == ODRIVE_STATE_CLOSED_LOOP && node[1].state == ODRIVE_STATE_CLOSED_LOOP &&
                   node[2].state == ODRIVE_STATE_CLOSED_LOOP;
    node[1].estimate_ticks = !on;
    each_ms();
}

static void what_was_switched_on_in_vain_is_switched_off(void)
{
    simulate(elbow_path, ELBOW);
    can_each_ms = each_ms_until_on;
    refused(open_at(where_of(elbow_path, ELBOW)), DPT_E_DEVICE, "no whole sample");
    pass_ms(1);
    for (int i = 0; i < 3; i++)
        CHECK(simulated.node[i].state == ODRIVE_STATE_IDLE, "motor %d is on", i);
    can_each_ms = each_ms;
    simulated.node[1].estimate_ticks = 1;
    CHECK(open_at(where_of(elbow_path, ELBOW)) == DPT_OK, "%s", error.text);
    if (!device)
        return;
    CHECK(push_until_it_fails(20) > 20, "begin");
    simulate_can_reboot(&simulated.node[0]);
    CHECK(push_until_it_fails(101) <= 101, "not found");
    can_each_ms = each_ms_until_on;
    CHECK(clear() == DPT_E_NOT_READY, "cleared without a sample");
    pass_ms(1);
    CHECK(simulated.node[0].state == ODRIVE_STATE_IDLE, "motor 0 is on");
    CHECK(write_up(1.0) != DPT_OK, "it takes a force");
    can_each_ms = each_ms;
    simulated.node[1].estimate_ticks = 1;
    dpt_device_read(device, &state);
    CHECK(state.status == DPT_DEVICE_STATUS_LOST, "%u, %x", state.status, state.code);
    CHECK(clear() == DPT_OK && push_until_it_fails(20) > 20, "clear");
    finish();
}

/*
 * Each call of an open, some cycles, a clear and a close fails in its turn, with each of some errors: nothing hangs, nothing
 * stays open, what is refused has a reason, and a bus that lives works when it is cleared.
 */
static void every_call_may_fail(void)
{
    static const int errors[] = { EIO, EINTR, EAGAIN, ENOBUFS, ENETDOWN, ENODEV, ENOMEM };
    int walked = 0, refusals = 0;
    error.size = sizeof error;
    simulate(elbow_path, ELBOW);
    const char *where = where_of(elbow_path, ELBOW);
    for (size_t e = 0; e < sizeof errors / sizeof *errors; e++) {
        int done = 0;
        can_fail_errno = errors[e];
        for (int number = 1; !done; number += number < 40 ? 1 : number / 12) {
            can_calls = 0;
            can_fail_at = number;
            const dpt_result opened = open_at(where);
            walked++;
            if (opened != DPT_OK) {
                refusals++;
                CHECK(device == NULL && error.text[0] && can_held_open == 0, "call %d, error %d: %s, %d left", number,
                      can_fail_errno, error.text, can_held_open);
                continue;
            }
            for (int i = 0; i < 5; i++) {
                can_watched = 1;
                const dpt_result got = dpt_device_read(device, &state);
                const dpt_result put = write_up(0.1);
                can_watched = 0;
                can_tick();
                CHECK(got == DPT_OK || got == DPT_E_LOST, "call %d, error %d: read %d", number, can_fail_errno, got);
                CHECK(put == DPT_OK || put == DPT_E_LOST || put == DPT_E_BUSY || put == DPT_E_NOT_READY,
                      "call %d, error %d: write %d", number, can_fail_errno, put);
            }
            clear();
            const int before = can_fail_at;
            can_fail_at = 0;
            CHECK(clear() == DPT_OK, "call %d, error %d: clear", number, can_fail_errno);
            can_fail_at = before;
            close_device();
            done = can_calls < number;
        }
    }
    can_fail_at = 0;
    end_simulation();
    CHECK(refusals > 60, "%d", refusals);
    printf("    %d calls failed, %d opens were refused\n", walked, refusals);
}

/* Motors keep their last torque when the host dies: none is given to those of which nothing is known. */
static void without_a_watchdog_there_is_no_force(void)
{
    static const struct {
        const char *settings;
        int gives_force;
    } cases[] = { { "gear=8,-8,10", 0 }, { "gear=8,-8,10&watchdog=none", 1 }, { "gear=8,-8,10&watchdog=0.02", 1 } };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        dpt_device_info info = { .size = sizeof info };
        int pushed = 0;
        start(elbow_path, cases[i].settings);
        CHECK(error.code == DPT_OK && (strstr(error.text, "?watchdog=none") == NULL) == cases[i].gives_force,
              "%s: '%s'", cases[i].settings, error.text);
        dpt_device_get_info(device, &info);
        CHECK(info.wrench_dofs == (cases[i].gives_force ? 3 : 0) && (info.force_max > 0.0) == cases[i].gives_force,
              "%s: %u freedoms, %g N", cases[i].settings, info.wrench_dofs, info.force_max);
        for (int k = 0; k < 200; k++) {
            CHECK(write_up(1.0) == DPT_OK, "write");
            can_tick();
            CHECK(dpt_device_read(device, &state) == DPT_OK && state.status == DPT_DEVICE_STATUS_READY, "%s: %u",
                  cases[i].settings, state.status);
            pushed += is_pushing();
        }
        CHECK((pushed > 150) == cases[i].gives_force && (pushed > 0) == cases[i].gives_force,
              "%s: it pushes in %d periods of 200", cases[i].settings, pushed);
        finish();
    }
}

int main(void)
{
    arm_file(elbow_path, elbow, 3, elbow_tool);
    arm_file(gantry_path, gantry, 3, no_tool);
    TEST(settings_are_checked);
    TEST(nodes_are_checked);
    TEST(refusals_say_the_cure);
    TEST(one_that_comes_late_is_asked_too);
    TEST(motors_that_are_on_are_told_their_mode);
    TEST(what_was_switched_on_in_vain_is_switched_off);
    TEST(every_call_may_fail);
    TEST(without_a_watchdog_there_is_no_force);
    unlink(elbow_path);
    unlink(gantry_path);
    return check_report();
}
