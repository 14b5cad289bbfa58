/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What goes wrong on a CAN bus and with its nodes, and what the driver for arms there (drivers/can/can.c) makes of it; on a bus
 * that stands in for the kernel's, or on the interface that $DPT_CAN names (can_kernel.h). Time is simulated.
 */
#include "drivers/can_fixture.h"

static void become_passive(void)
{
    bus_has_error(CAN_ERR_CRTL, CAN_ERR_CRTL_TX_PASSIVE);
}

static void become_active(void)
{
    bus_has_error(CAN_ERR_CRTL, CAN_ERR_CRTL_ACTIVE);
}

static void fill_up(void)
{
    can_is_full = 1;
}

static void empty(void)
{
    can_is_full = 0;
}

/* The host reads nothing while more comes than there is room for. */
static void stand_still(void)
{
    can_room = 20;
    pass_ms(10);
    can_room = 278;
}

static void overrun(void)
{
    bus_has_error(CAN_ERR_CRTL, CAN_ERR_CRTL_RX_OVERFLOW);
}

static void babble(void)
{
    simulated.node[1].extra_frames = 20;
}

static void be_quiet(void)
{
    simulated.node[1].extra_frames = 0;
}

static void double_node(void)
{
    simulated.node[1].copies = 2;
}

static void single_node(void)
{
    simulated.node[1].copies = 1;
}

static void other_serial(void)
{
    simulated.node[1].serial += 7;
    const struct odrive_message asks = { .node = 1, .command = ODRIVE_ADDRESS, .is_request = 1 };
    struct can_message frame;
    odrive_encode(&asks, ODRIVE_0_6, &frame);
    socketcan_send(&stranger, &frame, 1);
}

static void fall_silent(void)
{
    simulated.node[2].is_mute = 1;
}

static void speak(void)
{
    simulated.node[2].is_mute = 0;
}

static void stop_beating(void)
{
    simulated.node[2].heartbeat_ticks = 0;
}

static void beat(void)
{
    simulated.node[2].heartbeat_ticks = 100;
}

static void reboot(void)
{
    simulate_can_reboot(&simulated.node[0]);
}

static void overheat(void)
{
    simulated.node[0].causes = 0x2000 | 0x4000;
}

/* As it is when errors are cyclic, too: they are here before the heartbeat. */
static void overheat_and_tell(void)
{
    const struct odrive_message asks = { .node = 0, .command = ODRIVE_ERROR, .is_request = 1 };
    struct can_message frame;
    overheat();
    pass_ms(1);
    odrive_encode(&asks, ODRIVE_0_6, &frame);
    socketcan_send(&stranger, &frame, 1);
}

static void cool_down(void)
{
    simulated.node[0].causes = 0;
}

static void press_button(void)
{
    simulated.node[2].causes = 0x2000000;
}

static void release_button(void)
{
    simulated.node[2].causes = 0;
}

/* The host hangs for longer than the controllers wait, but not for so long that frames are dropped. */
static void hang(void)
{
    pass_ms(30);
}

static void panel_stops(void)
{
    someone_says(1, ODRIVE_ESTOP, 0.0f);
}

static void other_host(void)
{
    someone_says(1, ODRIVE_SET_TORQUE, 0.25f);
}

static void go_mad(void)
{
    const struct can_message frame = { .id = 1 << 5 | ODRIVE_ESTIMATES, .size = 8, .data = { 0, 0, 0xc0, 0x7f } };
    socketcan_send(&stranger, &frame, 1);
    simulated.joint[1] = NAN;
}

static void come_to_its_senses(void)
{
    for (int i = 0; i < 3; i++) {
        simulated.joint[i] = simulated.arm.middle[i];
        simulated.speed[i] = 0.0;
    }
}

/* Its encoder has found another index, or begun anew at 0: the joint has not moved. A turn is 45 degrees of the joint. */
static void jump(void)
{
    simulated.arm.zero[1] += 0.25 * simulated.arm.joint_per_turn[1];
}

static void jump_back(void)
{
    simulated.arm.zero[1] = 0.0;
}

/*
 * Each fault, as it comes to an arm that pushes: found within some cycles, reported for what it is, and the end of all
 * torque; not cleared while its cause is there; and cleared when that is gone.
 */
static const struct fault {
    const char *name;
    void (*cause)(void), (*cure)(void);
    uint32_t status, reasons, code;
    int within; /* ms */
    int needs_stand_in;
    int stays;       /* it cannot be cleared before it is cured */
    int keeps_force; /* nothing can be sent: the controllers' watchdogs are what ends it */
    int settles;     /* ms until that is no longer all that is known */
} faults[] = {
    /* clang-format off */
    { "bus-off", go_off, come_on, DPT_DEVICE_STATUS_LOST, DPT_REASON_LINK, CAN_CODE(CAN_CODE_OFF, 0xff), 1, 1, 0, 0, 0 },
    { "error-passive until restarted", become_passive, come_on, DPT_DEVICE_STATUS_FAULT, DPT_REASON_LINK, CAN_CODE(CAN_CODE_PASSIVE, 0xff), 1, 1, 1, 0, 0 },
    { "error-passive", become_passive, become_active, DPT_DEVICE_STATUS_FAULT, DPT_REASON_LINK, CAN_CODE(CAN_CODE_PASSIVE, 0xff), 1, 1, 1, 0, 0 },
    { "ENOBUFS", fill_up, empty, DPT_DEVICE_STATUS_LOST, DPT_REASON_LINK, CAN_CODE(CAN_CODE_STUCK, 0xff), 60, 1, 1, 1, 60 },
    { "interface down", shut, mend, DPT_DEVICE_STATUS_LOST, DPT_REASON_LINK, CAN_CODE(CAN_CODE_DOWN, 0xff), 1, 1, 1, 1, 0 },
    { "interface gone", unplug, mend, DPT_DEVICE_STATUS_LOST, DPT_REASON_UNPLUGGED, CAN_CODE(CAN_CODE_GONE, 0xff), 1, 1, 1, 1, 0 },
    { "kernel drops", stand_still, NULL, DPT_DEVICE_STATUS_FAULT, DPT_REASON_LINK, CAN_CODE(CAN_CODE_DROPPED, 0xff), 10, 1, 0, 0, 0 },
    { "controller overruns", overrun, NULL, DPT_DEVICE_STATUS_FAULT, DPT_REASON_LINK, CAN_CODE(CAN_CODE_DROPPED, 0xff), 1, 1, 0, 0, 0 },
    { "babbling", babble, be_quiet, DPT_DEVICE_STATUS_FAULT, DPT_REASON_LINK, CAN_CODE(CAN_CODE_BABBLING, 1), 100, 0, 0, 0, 0 },
    { "duplicate", double_node, single_node, DPT_DEVICE_STATUS_FAULT, DPT_REASON_LINK, CAN_CODE(CAN_CODE_DUPLICATE, 1), 220, 0, 0, 0, 0 },
    { "two serial numbers", other_serial, NULL, DPT_DEVICE_STATUS_FAULT, DPT_REASON_LINK, CAN_CODE(CAN_CODE_DUPLICATE, 1), 2, 0, 0, 0, 0 },
    { "silent", fall_silent, speak, DPT_DEVICE_STATUS_LOST, DPT_REASON_SILENT, CAN_CODE(CAN_CODE_NO_ESTIMATE, 2), 52, 0, 1, 0, 0 },
    { "no heartbeat", stop_beating, beat, DPT_DEVICE_STATUS_LOST, DPT_REASON_SILENT, CAN_CODE(CAN_CODE_NO_HEARTBEAT, 2), 502, 0, 1, 0, 0 },
    { "reboot", reboot, NULL, DPT_DEVICE_STATUS_FAULT, DPT_REASON_DEVICE, CAN_CODE(CAN_CODE_RESTARTED, 0), 101, 0, 0, 0, 0 },
    { "too hot", overheat, cool_down, DPT_DEVICE_STATUS_FAULT, DPT_REASON_OVERHEATED, 0x6000, 102, 0, 1, 0, 0 },
    { "too hot, and says so", overheat_and_tell, cool_down, DPT_DEVICE_STATUS_FAULT, DPT_REASON_OVERHEATED, 0x6000, 1, 0, 1, 0, 0 },
    { "estop", press_button, release_button, DPT_DEVICE_STATUS_FAULT, DPT_REASON_ESTOP, 0x2000000, 102, 0, 1, 0, 0 },
    { "watchdog", hang, NULL, DPT_DEVICE_STATUS_FAULT, DPT_REASON_WATCHDOG, 0x1000000, 102, 0, 0, 0, 0 },
    { "estop by frame", panel_stops, NULL, DPT_DEVICE_STATUS_FAULT, DPT_REASON_ESTOP, CAN_CODE(CAN_CODE_FOREIGN_ORDER, 1), 1, 0, 0, 0, 0 },
    { "another host", other_host, NULL, DPT_DEVICE_STATUS_FAULT, DPT_REASON_LINK, CAN_CODE(CAN_CODE_FOREIGN_ORDER, 1), 1, 0, 0, 0, 0 },
    { "a place it cannot have come to", jump, jump_back, DPT_DEVICE_STATUS_FAULT, DPT_REASON_UNCALIBRATED, CAN_CODE(CAN_CODE_JUMPED, 1), 1, 0, 0, 0, 0 },
    { "not a number", go_mad, come_to_its_senses, DPT_DEVICE_STATUS_LOST, DPT_REASON_SILENT, CAN_CODE(CAN_CODE_NO_ESTIMATE, 1), 52, 0, 1, 0, 0 },
    /* clang-format on */
};

/* A cause that stays cannot be cleared; once it is cured, the device works as before. */
static void cure(const struct fault *fault, dpt_result code)
{
    const uint64_t taken = simulated.node[0].torques;
    if (fault->stays)
        CHECK(clear() == code && !is_pushing(), "%s: cleared in spite of its cause", fault->name);
    if (fault->cause == become_passive)
        CHECK(simulated.node[0].torques == taken, "motors are switched on over a bad bus");
    dpt_device_get_counts(device, &counts);
    CHECK(counts.resets == (fault->cause == reboot), "%s: %u resets", fault->name, (unsigned)counts.resets);
    if (fault->cure)
        fault->cure();
    pass_ms(2);
    const uint64_t lost = counts.lost, sequence = state.sequence;
    CHECK(clear() == DPT_OK, "%s: not cleared", fault->name);
    dpt_device_read(device, &state);
    CHECK(state.fresh <= 2 && state.sequence > sequence, "%s: %u fresh", fault->name, state.fresh);
    dpt_device_get_counts(device, &counts);
    CHECK(fault->status == DPT_DEVICE_STATUS_FAULT || counts.lost <= lost + 1, "%s: %u lost while it was opened",
          fault->name, (unsigned)(counts.lost - lost));
    CHECK(counts.resets == (fault->cause == reboot || fault->status == DPT_DEVICE_STATUS_LOST), "%s: %u resets",
          fault->name, (unsigned)counts.resets);
    CHECK(!is_pushing(), "%s: it pushes before it is told to", fault->name);
    CHECK(push_until_it_fails(600) > 600 && is_pushing() && state.reasons == 0 && state.code == 0,
          "%s: it does not work afterwards: %x %x", fault->name, state.reasons, state.code);
}

static void provoke(const struct fault *fault)
{
    start(elbow_path, ELBOW "&nodes=0,1,2&watchdog=0.025&firmware=0.6");
    open_stranger();
    CHECK(push_until_it_fails(50) > 50 && is_pushing(), "%s: it does not begin well", fault->name);
    fault->cause();
    const int after = push_until_it_fails(fault->within + 50);
    CHECK(after <= fault->within, "%s: found after %d ms", fault->name, after);
    for (int i = 0; i < fault->settles; i++) {
        can_tick();
        dpt_device_read(device, &state);
    }
    CHECK(state.status == fault->status && state.code == fault->code, "%s: status %u, code %x", fault->name,
          state.status, state.code);
    CHECK((state.reasons & fault->reasons) == fault->reasons, "%s: %x", fault->name, state.reasons);
    const dpt_result code = fault->status == DPT_DEVICE_STATUS_LOST ? DPT_E_LOST : DPT_E_NOT_READY;
    CHECK(write_up(1.0) == code, "%s: it takes a force", fault->name);
    /* What read sent at once is there by now. */
    pass_ms(fault->keeps_force ? 30 : 1);
    CHECK(!is_pushing(), "%s: a motor still pushes", fault->name);
    for (int i = 0; i < 30; i++) {
        can_tick();
        CHECK(dpt_device_read(device, &state) == (code == DPT_E_LOST ? DPT_E_LOST : DPT_OK) &&
                  state.status == fault->status && write_up(1.0) == code && !is_pushing(),
              "%s: it comes back by itself", fault->name);
    }
    const int is_estop = fault->status == DPT_DEVICE_STATUS_LOST || fault->reasons == DPT_REASON_ESTOP;
    for (uint32_t i = 0; i < 3 && !fault->keeps_force; i++) {
        CHECK(simulated.node[i].torque == 0.0f, "%s: motor %u was not told zero", fault->name, i);
        CHECK(is_estop || !(simulated.node[i].errors & 0x2000000), "%s: motor %u has an estop", fault->name, i);
        CHECK(fault->status != DPT_DEVICE_STATUS_LOST || simulated.node[i].errors & 0x2000000,
              "%s: motor %u has no estop", fault->name, i);
    }
    dpt_device_get_counts(device, &counts);
    CHECK((counts.refused > 0) == (fault->cause == fill_up || fault->cause == shut || fault->cause == unplug),
          "%s: %u refused", fault->name, (unsigned)counts.refused);
    CHECK((counts.damaged > 0) == (fault->cause == go_mad), "%s: %u damaged", fault->name, (unsigned)counts.damaged);
    cure(fault, code);
    socketcan_close(&stranger);
    finish();
}

static void every_fault_ends_all_torque(void)
{
    int left_out = 0;
    for (size_t i = 0; i < sizeof faults / sizeof *faults; i++)
        if (can_real && faults[i].needs_stand_in)
            left_out++;
        else
            provoke(&faults[i]);
    if (left_out)
        printf("    %d faults are of the stand-in; tests/vm/test_can_bus.c has them\n", left_out);
}

/* A bus that has become bad takes the order to stop at the third time. */
static int frames_lost;

static int lose_orders(int fd, const struct can_frame *frame)
{
    (void)frame;
    return fd != simulated.line.fd && frames_lost-- > 0 ? CAN_DROP : CAN_PASS;
}

static void stopping_is_tried_again(void)
{
    start(elbow_path, ELBOW "&nodes=0,1,2&firmware=0.6&silent=5");
    CHECK(push_until_it_fails(20) > 20, "begin");
    simulated.node[0].causes = 0x2000;
    frames_lost = 1000000;
    can_fate = lose_orders;
    for (int i = 0; i < 150 && state.status == DPT_DEVICE_STATUS_READY; i++) {
        can_tick();
        dpt_device_read(device, &state);
    }
    CHECK(state.status == DPT_DEVICE_STATUS_FAULT && is_pushing(), "%u", state.status);
    /* A stop is two frames for each of three. */
    frames_lost = 12;
    int after = 0;
    for (; after < 100 && is_pushing(); after++) {
        can_tick();
        dpt_device_read(device, &state);
    }
    CHECK(after > 10 && after < 40, "it took %d ms", after);
    can_fate = NULL;
    simulated.node[0].causes = 0;
    CHECK(clear() == DPT_OK, "clear");
    finish();
}

/* A cable that is out for some seconds, and controllers without watchdogs, which push all the while: told when it is back. */
static void stopping_is_never_given_up(void)
{
    start(elbow_path, ELBOW);
    CHECK(push_until_it_fails(20) > 20, "begin");
    for (int i = 0; i < 3; i++)
        simulated.node[i].is_mute = 1;
    frames_lost = 1000000;
    can_fate = lose_orders;
    for (int i = 0; i < 5000; i++) {
        can_tick();
        dpt_device_read(device, &state);
    }
    CHECK(state.status == DPT_DEVICE_STATUS_LOST && is_pushing(), "%u", state.status);
    for (int i = 0; i < 3; i++)
        simulated.node[i].is_mute = 0;
    can_fate = NULL;
    for (int i = 0; i < 12; i++) {
        can_tick();
        dpt_device_read(device, &state);
    }
    CHECK(!is_pushing(), "it pushes on");
    finish();
}

/* A line that was shut and is up again: the first that is said there ends all torque, before anything is asked. */
static int pushed_ms;

static void each_ms_of_pushing(void)
{
    each_ms();
    pushed_ms += is_pushing();
}

static void clearing_begins_with_a_stop(void)
{
    start(elbow_path, ELBOW);
    CHECK(push_until_it_fails(20) > 20, "begin");
    shut();
    CHECK(push_until_it_fails(2) <= 2 && state.status == DPT_DEVICE_STATUS_LOST, "%u", state.status);
    pass_ms(1);
    CHECK(is_pushing(), "it can be told to stop");
    mend();
    can_each_ms = each_ms_of_pushing;
    pushed_ms = 0;
    CHECK(clear() == DPT_OK, "clear");
    CHECK(pushed_ms <= 1, "it pushed for %d ms", pushed_ms);
    finish();
}

/* Where places are asked for, they are asked of one that has stopped, too: it is not silent besides. */
static void a_fault_is_not_taken_for_silence(void)
{
    start(elbow_path, ELBOW "&request=1&firmware=0.6");
    CHECK(push_until_it_fails(20) > 20, "begin");
    simulated.node[0].causes = 0x2000;
    CHECK(push_until_it_fails(102) <= 102, "not found");
    uint32_t fresh = 0;
    for (int i = 0; i < 200; i++) {
        can_tick();
        CHECK(dpt_device_read(device, &state) == DPT_OK && state.status == DPT_DEVICE_STATUS_FAULT &&
                  state.code == 0x2000 && !is_pushing(),
              "%d ms: status %u, code %x", i, state.status, state.code);
        fresh += state.fresh;
    }
    CHECK(fresh >= 190, "%u samples of 200", fresh);
    simulated.node[0].causes = 0;
    CHECK(clear() == DPT_OK, "clear");
    finish();
}

/* What stood still long ago is no leave to run ahead for ever. */
static void a_twin_after_a_pause_is_found(void)
{
    start(elbow_path, ELBOW "&silent=5");
    simulated.node[1].is_mute = 1;
    simulated.node[1].heartbeat_ticks = 0;
    for (int i = 0; i < 450; i++) {
        write_up(1.0);
        can_tick();
        dpt_device_read(device, &state);
    }
    simulated.node[1].is_mute = 0;
    simulated.node[1].heartbeat_ticks = 100;
    CHECK(push_until_it_fails(20) > 20, "a pause is no fault with silent=5: %x", state.code);
    simulated.node[1].copies = 2;
    CHECK(push_until_it_fails(220) <= 220 && (state.code & 0xff) == CAN_CODE_DUPLICATE, "%x", state.code);
    simulated.node[1].copies = 1;
    finish();
}

/* 0.5 says in its heartbeat that the motor has errors, not which: it is asked. */
static void parts_are_asked_for_their_errors(void)
{
    start(elbow_path, ELBOW "&firmware=0.5");
    CHECK(push_until_it_fails(20) > 20, "begin");
    simulated.node[1].motor_errors = 0x1000;
    CHECK(push_until_it_fails(101) <= 101, "not found");
    CHECK(state.status == DPT_DEVICE_STATUS_FAULT && state.reasons & DPT_REASON_DEVICE, "%x", state.reasons);
    for (int i = 0; i < 3; i++) {
        can_tick();
        dpt_device_read(device, &state);
    }
    CHECK(state.reasons & DPT_REASON_OVERLOADED && state.code == 0x1000, "%x %x", state.reasons, state.code);
    CHECK(!is_pushing(), "it pushes");
    CHECK(clear() == DPT_OK, "clear");
    finish();
}

/* Frames that are no messages fill whole batches, and hide none. */
static void a_storm_of_errors_hides_nothing(void)
{
    start(elbow_path, ELBOW);
    for (int i = 0; i < 200; i++) {
        for (int k = 0; k < 150; k++)
            bus_has_error(CAN_ERR_BUSERROR | CAN_ERR_ACK, 0);
        CHECK(write_up(1.0) == DPT_OK, "write");
        can_tick();
        CHECK(dpt_device_read(device, &state) == DPT_OK && state.fresh == 1 && state.status == DPT_DEVICE_STATUS_READY,
              "%u fresh, %x", state.fresh, state.code);
    }
    finish();
}

/* Frames of random content, ids of ours and of no one, errors of all classes: nothing that is read is nonsense. */
static void nonsense_does_no_harm(void)
{
    uint64_t random = 7;
    int failed = 0;
    start(elbow_path, ELBOW "&nodes=0,1,2");
    for (int i = 0; i < 20000; i++) {
        const uint64_t kind = random_bits(&random), data = random_bits(&random);
        struct can_frame frame = { .can_id = (canid_t)(kind & 0x7f), .can_dlc = kind >> 8 & 15 };
        frame.can_dlc = frame.can_dlc > 8 ? 8 : frame.can_dlc;
        frame.can_id |= kind >> 16 & 15 ? 0 : CAN_RTR_FLAG;
        if ((kind >> 20 & 63) == 0)
            frame.can_id = CAN_ERR_FLAG | (canid_t)(kind >> 32 & CAN_ERR_MASK);
        memcpy(frame.data, &data, 8);
        if (kind >> 26 & 1)
            bus_carries(NULL, &frame, sizeof frame);
        write_force(0.1, 0.2, 0.3);
        can_tick();
        dpt_device_read(device, &state);
        const double *q = state.pose.orientation;
        CHECK(vec3_within(state.pose.position, 1.0) && vec3_within(state.velocity, 1e300) &&
                  fabs(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3] - 1.0) < 1e-9,
              "cycle %d: a pose that cannot be", i);
        CHECK(state.status <= DPT_DEVICE_STATUS_READY && !state.reasons == (state.status == DPT_DEVICE_STATUS_READY),
              "cycle %d: %u, %x", i, state.status, state.reasons);
        if (state.status == DPT_DEVICE_STATUS_READY)
            continue;
        failed++;
        come_to_its_senses();
        become_active();
        for (int k = 0; k < 3; k++)
            simulated.node[k].node = (uint8_t)k;
        CHECK(clear() == DPT_OK, "cycle %d: %x is not cleared", i, state.code);
    }
    CHECK(failed > 200, "%d", failed);
    finish();
}

int main(void)
{
    can_real = getenv("DPT_CAN");
    arm_file(elbow_path, elbow, 3, elbow_tool);
    TEST(every_fault_ends_all_torque);
    TEST(parts_are_asked_for_their_errors);
    TEST(stopping_is_tried_again);
    TEST(stopping_is_never_given_up);
    TEST(a_fault_is_not_taken_for_silence);
    TEST(a_twin_after_a_pause_is_found);
    /* Of these a kernel could say nothing new, or cannot be told to fail. */
    if (!can_real) {
        TEST(a_storm_of_errors_hides_nothing);
        TEST(nonsense_does_no_harm);
        TEST(clearing_begins_with_a_stop);
    }
    unlink(elbow_path);
    return check_report();
}
