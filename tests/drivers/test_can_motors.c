/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Arms of Damiao, RobStride, CyberGear and moteus motors, and of motors of several makers (drivers/can/drive.h), against simulated
 * ones on a bus that stands in for the kernel's, or on the interface that $DPT_CAN names (can_kernel.h). Time is simulated. Each
 * fault is provoked: within five milliseconds no motor gives a torque, or its own watchdog ends it. What goes on the wire is
 * tested in test_drive.c, and by peers in drive_peers.py.
 */
#include "drivers/can_fixture.h"

#include "dynpoint/guard.h"
#include "dynpoint/selftest.h"
#include "platform/clock.h"

/* Five ticks of the loop; and watchdogs of so many milliseconds. */
enum { TICKS_MAX = 5, WATCHDOG_MS = 20 };

static const struct kind {
    const char *name, *settings, *title;
    uint32_t hot[2]; /* a fault of too much heat, by the makers' numbers, of the joints 1 and 2 */
} kinds[] = {
    { "damiao", "drive=damiao", "arm of Damiao motors", { 0xb, 0xc } },
    { "robstride", "drive=robstride&model=rs-02,44:17", "arm of RobStride motors", { 0x4, 0x4 } },
    { "cybergear", "drive=cybergear&nodes=5,6,127", "arm of CyberGear motors", { 0x4, 0x4 } },
    { "moteus", "drive=moteus&nodes=1,2,9", "arm of moteus motors", { 38, 38 } },
    { "mixed", "drive=odrive,damiao,robstride&model=rs-03&nodes=1,2,3&firmware=0.6", "several makers", { 0xb, 0x4 } },
    { "mixed with CAN-FD", "drive=damiao,moteus,damiao&nodes=1,1,2", "several makers", { 38, 0xc } },
};
enum { KINDS = sizeof kinds / sizeof *kinds };

static const struct kind *kind;
static dpt_guard guard;
static uint64_t torques_without_watchdog, torques_on_the_bus;

static const char *settings(void)
{
    static char text[256];
    snprintf(text, sizeof text, "%s&weight=0&torque=1.5,1.5,1.5&watchdog=0.02", kind->settings);
    return text;
}

/* 1: a motor gives more than its smallest torque to either side of zero. */
static int gives_torque(void)
{
    for (uint32_t i = 0; i < simulated.arm.joints; i++) {
        const struct simulate_can_node *node = &simulated.node[i];
        if (node->state == ODRIVE_STATE_CLOSED_LOOP && fabs((double)node->torque) > 0.51 * drive_torque_step(node->end))
            return 1;
    }
    return 0;
}

/* Told of each frame: no torque may reach a motor whose watchdog is not set. */
static void hear(int fd, const struct can_frame *raw)
{
    struct can_message frame = { .id = raw->can_id & CAN_EFF_MASK, .size = raw->can_dlc };
    struct drive_message said;
    if (fd == simulated.line.fd || raw->can_id & (CAN_ERR_FLAG | CAN_RTR_FLAG) || raw->can_dlc > 8)
        return;
    frame.flags = raw->can_id & CAN_EFF_FLAG ? CAN_MESSAGE_EXTENDED : 0;
    memcpy(frame.data, raw->data, 8);
    for (uint32_t i = 0; i < simulated.arm.joints; i++) {
        const struct simulate_can_node *node = &simulated.node[i];
        if (!node->end->drive->answers || node->end->drive->is_fd ||
            node->end->drive->decode(node->end, &frame, &said) != DRIVE_TORQUE)
            continue;
        torques_on_the_bus++;
        torques_without_watchdog += !(node->watchdog > 0.0) && node->state == ODRIVE_STATE_CLOSED_LOOP;
    }
}

/* One tick of a loop whose guard is set as usual. */
static void tick_of_loop(double force)
{
    const dpt_wrench wanted = { { 0.0, force, 0.0 }, { 0.0, 0.0, 0.0 } };
    dpt_wrench out;
    const dpt_result result = dpt_device_read(device, &state);
    const int is_ready = result == DPT_OK && state.status == DPT_DEVICE_STATUS_READY;
    dpt_guard_step(&guard, clock_now(), is_ready && state.fresh ? &wanted : NULL, is_ready, &out);
    if (is_ready)
        dpt_device_write(device, &out);
    can_tick();
}

static void begin(void)
{
    dpt_guard_def def;
    dpt_guard_def_init(&def);
    guard.size = sizeof guard;
    dpt_guard_init(&guard, &def);
    torques_without_watchdog = torques_on_the_bus = 0;
    can_carried = hear;
    start(elbow_path, settings());
    CHECK(torques_without_watchdog == 0 && !gives_torque(), "%s: a torque before the watchdog is set", kind->name);
    for (int i = 0; i < 200; i++)
        tick_of_loop(2.0);
    CHECK(gives_torque() && state.status == DPT_DEVICE_STATUS_READY && torques_without_watchdog == 0,
          "%s: no force: %u %x", kind->name, state.status, state.code);
}

static void end(void)
{
    close_device();
    pass_ms(2);
    for (uint32_t i = 0; i < simulated.arm.joints; i++)
        CHECK(simulated.node[i].state == ODRIVE_STATE_IDLE, "%s: motor %u is on after close", kind->name, i);
    end_simulation();
    can_carried = NULL;
}

/* ---- sound ---- */

static void tells_what_it_is(void)
{
    dpt_device_info info = { .size = sizeof info };
    dpt_device_get_info(device, &info);
    CHECK(strstr(info.name, kind->title) && info.joints == 3 && info.wrench_dofs == 3 && info.watchdog == 0.02,
          "%s: %s", kind->name, info.name);
    double reach = 0.0;
    for (uint32_t i = 0; i < 3; i++) {
        const struct drive_node *of = simulated.node[i].end;
        reach = fmax(reach, 6.283185307179586 * drive_position_step(of) * (i == 0 ? 0.4 : i == 1 ? 0.4 : 0.2));
        if (of->drive->answers)
            CHECK(fabs(simulated.node[i].watchdog - 0.02) < 1e-9 && simulated.node[i].is_torque_mode,
                  "%s: motor %u has a watchdog of %g s", kind->name, i, simulated.node[i].watchdog);
    }
    const int is_known = !can_arm_has_reporters(&simulated.arm);
    CHECK((info.position_step > 0.0) == is_known && (info.angle_step > 0.0) == is_known, "%s: %g m", kind->name,
          info.position_step);
    CHECK(!is_known || (info.position_step > 0.4 * reach && info.position_step < 1.001 * reach), "%s: %g of %g m",
          kind->name, info.position_step, reach);
    dpt_coupling_def def;
    dpt_coupling_def_init(&def);
    CHECK(dpt_device_fill_coupling(&info, &def) == DPT_OK && def.position_step == info.position_step, "%s: %g",
          kind->name, def.position_step);
}

static void torques_are_right(void)
{
    for (int k = 0; k < 50; k++) {
        float torques[DPT_JOINTS_MAX];
        const dpt_wrench wrench = { { 0.02 * k, 3.0 - 0.1 * k, -0.05 * k }, { 0.0, 0.0, 0.0 } };
        struct can_arm arm = simulated.arm;
        can_arm_apply_ranges(&arm);
        dpt_device_read(device, &state);
        can_arm_torques(&arm, state.joint, &wrench, 0.0, torques);
        dpt_device_write(device, &wrench);
        can_tick();
        for (uint32_t i = 0; i < 3; i++) {
            const struct simulate_can_node *node = &simulated.node[i];
            const double step = drive_torque_step(node->end);
            CHECK(fabs((double)node->torque - (double)torques[i]) <= 0.5 * step + 1e-6, "%s: motor %u %g, not %g Nm",
                  kind->name, i, (double)node->torque, (double)torques[i]);
            CHECK(fabs((double)node->torque) <= 1.5 + 1e-6, "%s: motor %u %g Nm", kind->name, i, (double)node->torque);
        }
    }
}

static void each_kind_feels(void)
{
    for (kind = kinds; kind < kinds + KINDS; kind++) {
        begin();
        tells_what_it_is();
        for (int i = 0; i < 20; i++) /* the ramp is over */
            tick_of_loop(2.0);
        dpt_device_get_counts(device, &counts);
        const uint64_t samples = counts.samples, lost = counts.lost;
        for (int i = 0; i < 500; i++) {
            const uint64_t sequence = state.sequence;
            tick_of_loop(1.0 + 0.001 * i);
            CHECK(state.fresh == 1 && state.sequence == sequence + 1, "%s: %u fresh", kind->name, state.fresh);
        }
        dpt_device_get_counts(device, &counts);
        CHECK(counts.samples == samples + 500 && counts.lost == lost && counts.missed == 0 && counts.damaged == 0,
              "%s: %u samples, %u lost, %u missed", kind->name, (unsigned)(counts.samples - samples),
              (unsigned)(counts.lost - lost), (unsigned)counts.missed);
        torques_are_right();
        end();
    }
}

/* The tool is where the simulated joints are, within the motors' steps. */
static void poses_are_right(void)
{
    for (kind = kinds; kind < kinds + KINDS; kind++) {
        start(elbow_path, settings());
        simulated.is_kinematic = 1;
        for (int k = 0; k < 40; k++) {
            double step = 1e-6;
            for (uint32_t i = 0; i < 3; i++) {
                simulated.joint[i] += 0.008 * (i == 1 ? -1.0 : 1.0);
                step = fmax(step, 6.3 * drive_position_step(simulated.node[i].end));
            }
            pass_ms(1);
            dpt_device_read(device, &state);
            pass_ms(1);
            dpt_device_read(device, &state);
            for (uint32_t i = 0; i < 3; i++)
                CHECK(fabs(state.joint[i] - simulated.joint[i]) <= step, "%s: joint %u at %g, not %g", kind->name, i,
                      state.joint[i], simulated.joint[i]);
        }
        CHECK(state.status == DPT_DEVICE_STATUS_READY, "%s: %x", kind->name, state.code);
        end();
    }
}

/* Without a word the driver sets a watchdog where it can at all motors; where it cannot there is no force. */
static void watchdogs_are_set_without_a_word(void)
{
    dpt_device_info info = { .size = sizeof info };
    error.size = sizeof error;
    start(elbow_path, "drive=damiao&weight=0");
    dpt_device_get_info(device, &info);
    CHECK(info.watchdog == 0.05 && info.wrench_dofs == 3 && simulated.node[0].watchdog == 0.05, "%g s", info.watchdog);
    finish();
    start(elbow_path, "drive=odrive,damiao&nodes=1,2,3&weight=0");
    dpt_device_get_info(device, &info);
    CHECK(info.watchdog == 0.0 && info.wrench_dofs == 0, "%g s", info.watchdog);
    finish();
}

/* ---- faults ---- */

static void fall_silent(void)
{
    simulated.node[2].is_mute = 1;
}

static void speak(void)
{
    simulated.node[2].is_mute = 0;
}

static void overheat(void)
{
    simulated.node[1].causes = kind->hot[0];
}

static void overheat_too(void)
{
    simulated.node[2].causes = kind->hot[1];
}

static void cool_down(void)
{
    simulated.node[1].causes = simulated.node[2].causes = 0;
    for (uint32_t i = 0; i < 3; i++)
        simulated.node[i].temperature = 30.0f;
}

/* The motor does not mind, but the host reads its temperature. */
static void glow(void)
{
    for (uint32_t i = 0; i < 3; i++)
        simulated.node[i].temperature = 130.0f;
}

static void reboot(void)
{
    simulate_can_reboot(&simulated.node[1]);
}

static void double_node(void)
{
    simulated.node[1].copies = 2;
}

static void single_node(void)
{
    simulated.node[1].copies = 1;
}

static void give_orders(void)
{
    const struct drive_message order = { .kind = DRIVE_TORQUE, .as.command.torque = 0.4f };
    struct can_message frame;
    const struct drive_node *of = simulated.node[1].end;
    CHECK(of->drive->encode(of, &order, &frame) && socketcan_send(&stranger, &frame, 1) == 1, "no order");
}

static void nothing(void)
{
}

static const struct fault {
    const char *name;
    void (*cause)(void), (*cure)(void);
    uint32_t status, reason;
    int settles;     /* ms until the host knows */
    int by_watchdog; /* 1: the motors cannot be told */
    int needs_stand_in;
} faults[] = {
    { "too hot", overheat, cool_down, DPT_DEVICE_STATUS_FAULT, DPT_REASON_OVERHEATED, 3, 0, 0 },
    { "too hot elsewhere", overheat_too, cool_down, DPT_DEVICE_STATUS_FAULT, DPT_REASON_OVERHEATED, 3, 0, 0 },
    { "hot by its thermometer", glow, cool_down, DPT_DEVICE_STATUS_FAULT, DPT_REASON_OVERHEATED, 3, 0, 0 },
    { "silent", fall_silent, speak, DPT_DEVICE_STATUS_LOST, DPT_REASON_SILENT, 60, 0, 0 },
    { "restarted", reboot, nothing, DPT_DEVICE_STATUS_FAULT, DPT_REASON_DEVICE, 3, 0, 0 },
    { "two of one number", double_node, single_node, DPT_DEVICE_STATUS_FAULT, DPT_REASON_LINK, 30, 0, 0 },
    { "someone else's orders", give_orders, nothing, DPT_DEVICE_STATUS_FAULT, DPT_REASON_LINK, 3, 0, 0 },
    { "bus-off", go_off, come_on, DPT_DEVICE_STATUS_LOST, DPT_REASON_LINK, 3, 0, 1 },
    { "interface down", shut, mend, DPT_DEVICE_STATUS_LOST, DPT_REASON_LINK, 3, 1, 1 },
    { "unplugged", unplug, mend, DPT_DEVICE_STATUS_LOST, DPT_REASON_UNPLUGGED, 3, 1, 1 },
};

static int knows_heat(void)
{
    for (uint32_t i = 0; i < 3; i++)
        if (simulated.node[i].end->drive == &damiao_drive || simulated.node[i].end->drive == &cybergear_drive)
            return 1;
    return 0;
}

static void provoke(const struct fault *fault)
{
    begin();
    open_stranger();
    /* A moteus has no order to switch on: one that has restarted obeys the next torque. If its position jumps, that is a fault. */
    const int is_left_out = (fault->cause == glow && !knows_heat()) ||
                            (fault->cause == reboot && simulated.node[1].end->drive == &moteus_drive);
    if (!is_left_out) {
        CHECK(fault->cause != glow || state.temperature > 0.0, "%s: no temperature", kind->name);
        fault->cause();
        int ticks = 0, quiet_ticks = 0, last_fresh = 0;
        const int limit = fault->by_watchdog ? WATCHDOG_MS + 2 : TICKS_MAX;
        for (; ticks < fault->settles + WATCHDOG_MS + 5; ticks++) {
            tick_of_loop(2.0);
            /* Silence begins with the last sample. */
            last_fresh = fault->cause == fall_silent && state.fresh ? ticks + 1 : last_fresh;
            quiet_ticks = gives_torque() ? ticks + 1 - last_fresh : quiet_ticks;
            if (state.status != DPT_DEVICE_STATUS_READY && !gives_torque() && ticks > limit)
                break;
        }
        /* While two answer, or none, the host cannot know at once; the guard or the fault ends the force. */
        const int known_later = fault->cause == double_node;
        CHECK(quiet_ticks <= (known_later ? fault->settles : limit), "%s, %s: a torque for %d ms", kind->name,
              fault->name, quiet_ticks);
        CHECK(state.status == fault->status && state.reasons & fault->reason, "%s, %s: status %u, reasons %x, code %x",
              kind->name, fault->name, state.status, state.reasons, state.code);
        fault->cure();
        for (int i = 0; i < 30; i++) {
            tick_of_loop(2.0);
            CHECK(!gives_torque(), "%s, %s: it comes back by itself", kind->name, fault->name);
        }
        const dpt_result result = clear();
        CHECK(result == DPT_OK && !gives_torque(), "%s, %s: %d after clear", kind->name, fault->name, result);
        for (int i = 0; i < 200; i++)
            tick_of_loop(2.0);
        CHECK(gives_torque() && state.status == DPT_DEVICE_STATUS_READY && torques_without_watchdog == 0,
              "%s, %s: it does not work afterwards: %u %x", kind->name, fault->name, state.status, state.code);
    }
    socketcan_close(&stranger);
    end();
}

static void every_fault_ends_all_torque(void)
{
    for (kind = kinds; kind < kinds + KINDS; kind++)
        for (size_t i = 0; i < sizeof faults / sizeof *faults; i++)
            if (!can_real || !faults[i].needs_stand_in)
                provoke(&faults[i]);
}

/* The host is killed: the motors' own watchdogs end the force, and it is told to the next host. */
static void a_dead_host_is_noticed_by_the_motors(void)
{
    for (kind = kinds; kind < kinds + KINDS; kind++) {
        begin();
        int ticks = 0;
        for (; gives_torque() && ticks < 100; ticks++)
            can_tick();
        CHECK(ticks >= WATCHDOG_MS - 2 && ticks <= WATCHDOG_MS + 2, "%s: a torque for %d ms", kind->name, ticks);
        pass_ms(20);
        for (uint32_t i = 0; i < 3; i++)
            CHECK(simulated.node[i].state == ODRIVE_STATE_IDLE, "%s: motor %u is on", kind->name, i);
        for (int i = 0; i < 3; i++) {
            dpt_device_read(device, &state);
            can_tick();
        }
        CHECK(state.status < DPT_DEVICE_STATUS_READY, "%s: status %u", kind->name, state.status);
        CHECK(clear() == DPT_OK, "%s: it cannot be cleared", kind->name);
        end();
    }
}

/* ---- what is refused at open ---- */

static void refuse(const char *with, dpt_result code, const char *word)
{
    char text[400];
    snprintf(text, sizeof text, "%s", where_of(elbow_path, with));
    refused(open_at(text), code, word);
    for (uint32_t i = 0; simulated.line.fd >= 0 && i < 3; i++)
        CHECK(!gives_torque(), "a torque");
}

static void wrong_motors_are_refused(void)
{
    error.size = sizeof error;
    simulate(elbow_path, "drive=damiao,cybergear,moteus&nodes=1,2,3");
    const char *with = "drive=damiao,cybergear,moteus&nodes=1,2,3&answer=0.3";
    simulated.node[1].is_mute = 1;
    refuse(with, DPT_E_DEVICE, "no CyberGear 2");
    simulated.node[1].is_mute = 0;
    simulated.node[2].value[DRIVE_VERSION] = 3.0;
    refuse(with, DPT_E_PROTOCOL, "moteus 3: its version of its registers is 3");
    simulated.node[2].value[DRIVE_VERSION] = 4.0;
    simulated.node[1].refuses = 1u << DRIVE_WATCHDOG;
    refuse(with, DPT_E_PROTOCOL, "CyberGear 2: its watchdog was set to 0.05, and reads back as 0");
    simulated.node[1].refuses = 0;
    simulated.node[1].lacks = 1u << DRIVE_WATCHDOG;
    refuse(with, DPT_E_PROTOCOL, "CyberGear 2 does not tell its watchdog");
    simulated.node[1].lacks = 0;
    simulated.node[0].refuses = 1u << DRIVE_CONTROL;
    simulated.node[0].value[DRIVE_CONTROL] = 2.0;
    refuse(with, DPT_E_PROTOCOL, "Damiao 1: its control mode was set to 1");
    simulated.node[0].refuses = 0;
    simulated.node[0].value[DRIVE_TORQUE_RANGE] = -1.0;
    refuse(with, DPT_E_PROTOCOL, "Damiao 1: its range of torques is -1");
    simulated.node[0].value[DRIVE_TORQUE_RANGE] = 10.0;
    simulated.node[0].causes = simulated.node[0].errors = 0xb;
    refuse(with, DPT_E_NOT_READY, "MOS_OVER_TEMPERATURE");
    simulated.node[0].causes = simulated.node[0].errors = 0;
    simulated.node[0].copies = 2;
    refuse(with, DPT_E_DEVICE, "two motors with the number 1");
    simulated.node[0].copies = 1;
    CHECK(open_at(where_of(elbow_path, with)) == DPT_OK, "%s", error.text);
    if (device)
        finish();
    else
        end_simulation();
}

static void wrong_settings_are_refused(void)
{
    error.size = sizeof error;
    simulated.line.fd = -1;
    refuse("drive=servo", DPT_E_SETTING, "drive: 'servo'");
    refuse("drive=robstride", DPT_E_SETTING, "model: ''");
    refuse("drive=robstride&model=rs-99", DPT_E_SETTING, "rs-99");
    refuse("drive=robstride&model=44:0", DPT_E_SETTING, "44:0");
    refuse("drive=damiao&nodes=1,2,16", DPT_E_SETTING, "1 to 15 of Damiao");
    refuse("drive=damiao&nodes=1,2,2", DPT_E_SETTING, "same ids");
    refuse("drive=damiao&answers=17,17,18", DPT_E_SETTING, "same ids");
    refuse("drive=odrive,damiao,damiao&nodes=0,1,2", DPT_E_SETTING, "joints 0 and 1 would use the same ids");
    refuse("drive=odrive,moteus,moteus&nodes=8,1,2", DPT_E_SETTING, "joints 0 and 1 would use the same ids");
    refuse("drive=moteus&nodes=0,1,2", DPT_E_SETTING, "1 to 126 of moteus");
    if (can_real)
        return;
    can_is_classic = 1;
    refuse("drive=moteus", DPT_E_DEVICE, "no CAN-FD");
    can_is_classic = 0;
}

/* Loads that are worked out by hand: bits of frames with most stuffing, at the rates of the bus. */
static void loads_are_computed(void)
{
    static const struct {
        const struct can_drive *drive;
        uint32_t joints, bitrate, data_bitrate;
        double rate, load;
    } cases[] = {
        { &odrive_drive, 4, 1000000, 0, 1000.0, 0.92 },         { &damiao_drive, 3, 1000000, 0, 1000.0, 0.81 },
        { &damiao_drive, 4, 1000000, 0, 1000.0, 1.08 },         { &robstride_drive, 3, 1000000, 0, 1000.0, 0.96 },
        { &cybergear_drive, 6, 1000000, 0, 500.0, 0.96 },       { &moteus_drive, 3, 1000000, 5000000, 1000.0, 0.8196 },
        { &moteus_drive, 4, 1000000, 5000000, 1000.0, 1.0928 }, { &moteus_drive, 1, 1000000, 0, 1000.0, 0.91 },
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        struct drive_node nodes[DPT_JOINTS_MAX];
        for (uint32_t i = 0; i < cases[k].joints; i++)
            nodes[i].drive = cases[k].drive;
        const double load =
            drive_bus_load(nodes, cases[k].joints, cases[k].rate, 0, cases[k].bitrate, cases[k].data_bitrate);
        CHECK(fabs(load - cases[k].load) < 1e-9, "%s, %u joints: %g, not %g", cases[k].drive->name, cases[k].joints,
              load, cases[k].load);
    }
}

int main(void)
{
    can_real = getenv("DPT_CAN");
    arm_file(elbow_path, elbow, 3, elbow_tool);
    TEST(each_kind_feels);
    TEST(poses_are_right);
    TEST(watchdogs_are_set_without_a_word);
    TEST(every_fault_ends_all_torque);
    TEST(a_dead_host_is_noticed_by_the_motors);
    TEST(wrong_motors_are_refused);
    TEST(wrong_settings_are_refused);
    TEST(loads_are_computed);
    unlink(elbow_path);
    return check_report();
}
