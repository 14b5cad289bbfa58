/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * An arm whose motors are on CAN (drivers/can/can.c), against simulated motor controllers on a bus that stands in for the
 * kernel's, or on the interface that $DPT_CAN names (can_kernel.h): its poses, frames, forces and weight. Time is simulated.
 */
#include "drivers/can_fixture.h"
#include "drivers/dynamics_checks.h"
#include "lib/pose.h"

#include "platform/clock.h"
#include "simulate/simulate_serial.h"

static char gantry_path[64];

static void samples_come_in_turn(void)
{
    uint64_t time = 0;
    for (int k = 0; k < 300; k++) {
        const uint64_t sequence = state.sequence;
        can_tick();
        CHECK(dpt_device_read(device, &state) == DPT_OK && state.fresh == 1 && state.sequence == sequence + 1 &&
                  state.time_ns > time && state.time_ns <= clock_now(),
              "%u fresh", state.fresh);
        time = state.time_ns;
        CHECK(dpt_device_read(device, &state) == DPT_OK && state.fresh == 0 && state.time_ns == time, "read twice");
    }
}

static void open_and_tell(int ambiguous, const char *firmware, const char *serial)
{
    char settings[320];
    dpt_device_info info = { .size = sizeof info };
    snprintf(settings, sizeof settings, ELBOW "&nodes=5,63,0&watchdog=0.02%s&firmware=%s",
             ambiguous ? "&" DYNAMICS : "", firmware);
    error.size = sizeof error;
    simulate(elbow_path, settings);
    for (uint32_t k = 0; k < 3; k++)
        simulated.node[k].is_done = ambiguous ? 0 : simulated.node[k].is_done;
    /* The driver is not told which. */
    *strstr(settings, "&firmware") = '\0';
    CHECK(open_at(where_of(elbow_path, settings)) == DPT_OK, "%s", error.text);
    if (!device)
        return;
    (ambiguous ? check_dynamics : check_no_dynamics)(device);
    CHECK(dpt_device_get_info(device, &info) == DPT_OK, "info");
    CHECK(info.pose_dofs == 6 && info.wrench_dofs == 3 && info.joints == 3 && info.rate == 1000.0 &&
              info.watchdog == 0.02 && info.flags == DPT_DEVICE_FLAG_ARM,
          "%u %u %u", info.pose_dofs, info.wrench_dofs, info.joints);
    CHECK(strstr(info.name, firmware), "%s", info.name);
    CHECK(!strcmp(info.serial, serial), "%s", info.serial);
    CHECK(info.force_max > 4.0 && info.force_max < 12.0 && info.torque_max == 0.0, "%g N", info.force_max);
    for (int k = 0; k < 3; k++)
        CHECK(info.workspace_min[k] < -0.05 && info.workspace_max[k] > 0.05 &&
                  info.workspace_max[k] - info.workspace_min[k] < 0.81,
              "%g to %g m", info.workspace_min[k], info.workspace_max[k]);
    CHECK(dpt_device_read(device, &state) == DPT_OK && state.status == DPT_DEVICE_STATUS_READY && state.reasons == 0 &&
              state.code == 0 && state.temperature == -1.0,
          "%u %u", state.status, state.reasons);
    CHECK(vec3_within(state.pose.position, 1e-6), "%g %g %g off the middle", state.pose.position[0],
          state.pose.position[1], state.pose.position[2]);
    for (uint32_t k = 0; k < 3; k++) {
        const struct simulate_can_node *node = &simulated.node[k];
        CHECK(node->state == ODRIVE_STATE_CLOSED_LOOP && node->is_torque_mode && node->torque == 0.0f, "node %u: %u", k,
              node->state);
        CHECK(node->node == simulated.arm.ends[k].number, "a node has got another number");
    }
    samples_come_in_turn();
    pass_ms(3);
    CHECK(dpt_device_read(device, &state) == DPT_OK && state.fresh == 3, "%u fresh", state.fresh);
    dpt_device_get_counts(device, &counts);
    CHECK(counts.lost == 0 && counts.damaged == 0 && counts.missed == 0 && counts.resets == 0 &&
              counts.samples >= 300 && counts.samples < 310,
          "%u lost of %u, %u missed", (unsigned)counts.lost, (unsigned)counts.samples, (unsigned)counts.missed);
    finish();
}

static void opens_and_tells(void)
{
    for (int ambiguous = 0; ambiguous < 2; ambiguous++) {
        open_and_tell(ambiguous, "0.5", "");
        open_and_tell(ambiguous, "0.6", "300000000000");
    }
}

/* A host may write before it has read: where the arm is, open knows. */
static void the_first_write_may_be_before_the_first_read(void)
{
    double efforts[3];
    const dpt_wrench root = { { 0.0, 0.0, 1.0 }, { 0.0, 0.0, 0.0 } };
    error.size = sizeof error;
    simulate(elbow_path, ELBOW);
    CHECK(open_at(where_of(elbow_path, ELBOW)) == DPT_OK, "%s", error.text);
    if (!device)
        return;
    CHECK(write_up(1.0) == DPT_OK, "write");
    can_tick();
    dpt_arm_efforts(simulated.arm.arm, simulated.arm.middle, &root, efforts);
    for (int k = 0; k < 3; k++)
        CHECK(fabs((double)simulated.node[k].torque / simulated.arm.torque_per_effort[k] - efforts[k]) < 1e-5,
              "joint %d gives %g Nm", k, (double)simulated.node[k].torque);
    CHECK(dpt_device_read(device, &state) == DPT_OK && state.fresh >= 1 && state.sequence >= 1, "%u", state.fresh);
    finish();
}

/* A force that is held comes to where the hand's spring holds it; too much is scaled down as a whole. */
static void closes_the_loop(void)
{
    start(elbow_path, ELBOW);
    for (int i = 0; i < 4000; i++) {
        CHECK(write_force(0.6, 1.5, -0.9) == DPT_OK, "write");
        can_tick();
        CHECK(dpt_device_read(device, &state) == DPT_OK && state.fresh == 1, "read");
    }
    static const double force[3] = { 0.6, 1.5, -0.9 };
    for (int k = 0; k < 3; k++) {
        CHECK(fabs(state.pose.position[k] - force[k] / 150.0) < 2e-6, "%c %g, not %g", "xyz"[k], state.pose.position[k],
              force[k] / 150.0);
        CHECK(fabs(state.velocity[k]) < 1e-4, "%g m/s", state.velocity[k]);
    }
    for (uint32_t k = 0; k < 3; k++)
        CHECK(fabs(state.joint[k] - simulated.joint[k]) < 1e-6, "joint %u", k);
    float within[3], beyond[3];
    CHECK(write_force(0.6, 1.5, -0.9) == DPT_OK, "write");
    can_tick();
    for (int k = 0; k < 3; k++)
        within[k] = simulated.node[k].torque;
    CHECK(write_force(6e299, 1.5e300, -9e299) == DPT_OK, "write");
    can_tick();
    double greatest = 0.0;
    for (int k = 0; k < 3; k++) {
        beyond[k] = simulated.node[k].torque;
        const double effort = fabs((double)beyond[k] / simulated.arm.torque_per_effort[k]);
        CHECK(effort <= 2.0 * (1.0 + 1e-6), "joint %d gives %g Nm", k, effort);
        greatest = fmax(greatest, effort);
        CHECK(fabs((double)beyond[k] * (double)within[0] - (double)within[k] * (double)beyond[0]) < 1e-5,
              "joint %d is not scaled as the others", k);
    }
    CHECK(fabs(greatest - 2.0) < 1e-5, "no joint is at its limit: %g", greatest);
    CHECK(dpt_device_read(device, &state) == DPT_OK, "read");
    CHECK(write_force(NAN, 0.0, 0.0) == DPT_E_FINITE, "NaN");
    can_tick();
    CHECK(!is_pushing(), "NaN pushes");
    finish();
}

/* Nobody holds the arm, and it stays; and what the weight takes of a joint's strength is not there for forces. */
static void its_weight_is_held_up(void)
{
    start(elbow_path, "gear=8,-8,10&watchdog=none");
    simulated.hand_stiffness = simulated.hand_damping = 0.0;
    double fallen = 0.0;
    const double before = state.pose.position[1];
    for (int i = 0; i < 3000; i++) {
        CHECK(write_up(0.0) == DPT_OK, "write");
        can_tick();
        CHECK(dpt_device_read(device, &state) == DPT_OK, "read");
        if (i == 400)
            fallen = state.pose.position[1] - before;
    }
    /* It falls a little while the weight is taken over, and then drifts by what damping leaves. */
    CHECK(fallen < -0.001 && fallen > -0.2, "%g m", fallen);
    CHECK(vec3_within(state.velocity, 1e-3), "it moves: %g m/s", state.velocity[1]);
    double weight[3];
    dpt_arm_weight(simulated.arm.arm, simulated.joint, simulated.arm.gravity, weight);
    CHECK(simulated.arm.gravity[2] == -9.80665 && simulated.arm.gravity[0] == 0.0, "gravity");
    for (int k = 0; k < 3; k++)
        CHECK(fabs((double)simulated.node[k].torque / simulated.arm.torque_per_effort[k] - weight[k]) < 1e-5,
              "joint %d: %g Nm for %g", k, (double)simulated.node[k].torque / simulated.arm.torque_per_effort[k],
              weight[k]);
    CHECK(write_up(-1e3) == DPT_OK, "write");
    can_tick();
    for (int k = 0; k < 3; k++)
        CHECK(fabs((double)simulated.node[k].torque / simulated.arm.torque_per_effort[k]) <= 2.0 + 1e-5,
              "joint %d is above its limit", k);
    finish();
    /* An arm that is too weak for itself. */
    start(elbow_path, "gear=8,-8,10&watchdog=none&torque=1,0.1,0.1");
    for (int i = 0; i < 100; i++) {
        CHECK(write_force(0.1, 0.1, 0.1) == DPT_OK, "write");
        can_tick();
        dpt_device_read(device, &state);
        for (int k = 1; k < 3; k++)
            CHECK(fabs((double)simulated.node[k].torque / simulated.arm.torque_per_effort[k]) <= 0.1001,
                  "joint %d is above its limit", k);
    }
    CHECK(is_pushing(), "it gives up");
    finish();
}

/* Which way is which: every choice of axes and signs, of which half are right-handed. */
static void check_frame(const int from[3], const int sign[3], const char *axes)
{
    static const double places[3] = { 0.125, -0.0625, 0.03125 }, speeds[3] = { 1, -2, 4 };
    static const double centre[3] = { 0.0625, 0.0, -0.125 };
    char settings[160];
    snprintf(settings, sizeof settings, "gear=128,128,-64&watchdog=none&centre=0.0625,0,-0.125%s", axes);
    simulate(gantry_path, settings);
    simulated.is_kinematic = 1;
    memcpy(simulated.joint, places, sizeof places);
    memcpy(simulated.speed, speeds, sizeof speeds);
    CHECK(open_at(where_of(gantry_path, settings)) == DPT_OK, "%s", error.text);
    if (!device)
        return;
    dpt_device_read(device, &state);
    for (int k = 0; k < 3; k++) {
        CHECK(state.pose.position[k] == sign[k] * (places[from[k]] - centre[from[k]]), "%s: %c %g", axes, "xyz"[k],
              state.pose.position[k]);
        CHECK(state.velocity[k] == sign[k] * speeds[from[k]] && state.spin[k] == 0.0, "%s: %c %g m/s", axes, "xyz"[k],
              state.velocity[k]);
        /* The root's axis that points along k in the device's frame: turned by q it must. */
        const double v[3] = { from[k] == 0, from[k] == 1, from[k] == 2 };
        double axis[3];
        turn3(state.pose.orientation, v, axis);
        CHECK(fabs(axis[k] - sign[k]) < 1e-15, "%s: %c %g", axes, "xyz"[k], axis[k]);
    }
    /* One newton along each axis of the device is one along that of the root. */
    for (int k = 0; k < 3; k++) {
        CHECK(write_force(k == 0, k == 1, k == 2) == DPT_OK, "write");
        can_tick();
        const double expected = sign[k] / ((from[k] == 2 ? -64.0 : 128.0) * 2.0 * M_PI);
        for (int n = 0; n < 3; n++)
            CHECK(fabs((double)simulated.node[n].torque - (n == from[k] ? expected : 0.0)) < 1e-9,
                  "%s: motor %d gives %g", axes, n, (double)simulated.node[n].torque);
    }
    finish();
}

static void frames_are_as_they_are_set(void)
{
    /* z is up, and x away from the user, where nothing is said. */
    static const int usual_from[3] = { 1, 2, 0 }, usual_sign[3] = { -1, 1, -1 };
    static const int orders[6][3] = { { 0, 1, 2 }, { 1, 2, 0 }, { 2, 0, 1 }, { 0, 2, 1 }, { 2, 1, 0 }, { 1, 0, 2 } };
    int right_handed = 0;
    error.size = sizeof error;
    check_frame(usual_from, usual_sign, "");
    for (int order = 0; order < 6; order++)
        for (int signs = 0; signs < 8; signs++) {
            int sign[3], product = order < 3 ? 1 : -1;
            char axes[32] = "&axes=";
            for (int k = 0; k < 3; k++) {
                sign[k] = signs >> k & 1 ? -1 : 1;
                product *= sign[k];
                snprintf(axes + strlen(axes), 3, "%s%c", sign[k] < 0 ? "-" : k ? "+" : "", "xyz"[orders[order][k]]);
            }
            right_handed += product > 0;
            if (product > 0)
                check_frame(orders[order], sign, axes);
            char settings[64];
            snprintf(settings, sizeof settings, "gear=1,1,1%s", axes);
            if (product < 0)
                refused(open_at(where_of(gantry_path, settings)), DPT_E_SETTING, "right-handed");
        }
    CHECK(right_handed == 24, "%d", right_handed);
}

/*
 * With a motion that every wire can represent, devices of three kinds give the same poses and are given the same forces, bit
 * for bit. Places are of sim's encoder, whose steps are a power of two; serial has them as float, can as float turns of
 * motors with 1024 to a metre. A motor's torque has 2 pi in it, so there the bits are those of the force times a constant.
 */
static struct simulate_serial at_port;

static void each_ms_at_port(void)
{
    simulate_serial_tick(&at_port);
}

enum { STEPS = 2000 };

/* The motion of a simulated device, and a force in each of its places. */
static void record_motion(dpt_pose *poses, dpt_wrench *forces)
{
    dpt_device *sim;
    int places = 0;
    CHECK(dpt_device_open("sim:?hand=wipe&step=0.000244140625&reach=0.06", &sim, &error) == DPT_OK, "%s", error.text);
    for (int i = 0; i < STEPS; i++) {
        CHECK(dpt_device_read(sim, &state) == DPT_OK && state.fresh == 1, "sim");
        poses[i] = state.pose;
        for (int k = 0; k < 3; k++)
            forces[i].force[k] = 0.37 - 41.7 * state.pose.position[k];
        places += i && memcmp(&poses[i], &poses[i - 1], sizeof poses[i]) != 0;
        CHECK(dpt_device_write(sim, &forces[i]) == DPT_OK, "sim");
    }
    dpt_device_close(sim);
    CHECK(places > 200, "%d places are too few to show anything", places);
}

/* The same place and force over both wires, as bits. How many forces were not zero. */
static uint64_t compare_wires(dpt_device *port, const dpt_pose *pose, const dpt_wrench *force, int step)
{
    uint64_t seen = 0;
    dpt_wrench wrench = *force;
    for (int k = 0; k < 3; k++) {
        at_port.mechanism.position[k] = simulated.joint[k] = pose->position[k];
        at_port.mechanism.velocity[k] = 0.0;
    }
    can_each_ms = each_ms_at_port;
    can_tick();
    CHECK(dpt_device_read(port, &state) == DPT_OK, "port");
    CHECK(!memcmp(&state.pose, pose, sizeof *pose), "serial: pose %d", step);
    for (int k = 0; k < 3; k++)
        CHECK(0.37 - 41.7 * state.pose.position[k] == force->force[k], "serial: force %d", step);
    CHECK(dpt_device_write(port, &wrench) == DPT_OK, "port");
    can_tick();
    dpt_device_read(port, &state);
    can_each_ms = each_ms;
    can_tick();
    CHECK(dpt_device_read(device, &state) == DPT_OK && state.status == DPT_DEVICE_STATUS_READY, "can");
    CHECK(!memcmp(&state.pose, pose, sizeof *pose), "can: pose %d", step);
    for (int k = 0; k < 3; k++)
        wrench.force[k] = 0.37 - 41.7 * state.pose.position[k];
    CHECK(!memcmp(&wrench, force, sizeof wrench), "can: force %d", step);
    CHECK(dpt_device_write(device, &wrench) == DPT_OK, "can");
    can_tick();
    dpt_device_read(device, &state);
    for (int k = 0; k < 3; k++) {
        const float at_motor = (float)force->force[k];
        const float torque = (float)(force->force[k] * (1.0 / (1024.0 * 2.0 * M_PI)));
        CHECK(!memcmp(&at_port.device.force[k], &at_motor, 4), "serial: %a, not %a", (double)at_port.device.force[k],
              (double)at_motor);
        CHECK(!memcmp(&simulated.node[k].torque, &torque, 4), "can: %a, not %a", (double)simulated.node[k].torque,
              (double)torque);
        seen += at_motor != 0.0f;
    }
    return seen;
}

static void wires_give_the_same_bits(void)
{
    static dpt_pose poses[STEPS];
    static dpt_wrench forces[STEPS];
    dpt_device *port;
    char name[128];
    error.size = sizeof error;
    state.size = sizeof state;
    record_motion(poses, forces);
    CHECK(simulate_serial_start(&at_port, NULL) == 0, "no pty");
    at_port.mechanism.hand_stiffness = at_port.mechanism.damping = 0.0;
    at_port.mechanism.hand_damping = 0.0;
    at_port.mechanism.mass = 1e300;
    can_each_ms = each_ms_at_port;
    snprintf(name, sizeof name, "serial:%s?silent=30", at_port.path);
    CHECK(dpt_device_open(name, &port, &error) == DPT_OK, "%s", error.text);
    start(gantry_path, "gear=1024,1024,1024&watchdog=none&axes=xyz&rate=1000");
    simulated.is_kinematic = 1;
    uint64_t seen = 0;
    for (int i = 0; i < STEPS; i++)
        seen += compare_wires(port, &poses[i], &forces[i], i);
    CHECK(seen > STEPS / 4, "%u forces", (unsigned)seen);
    finish();
    can_each_ms = each_ms_at_port;
    dpt_device_close(port);
    can_each_ms = NULL;
    simulate_serial_end(&at_port);
}

/* And with joints that turn, whose gears are powers of two, an effort is a float and is that float again at the motor. */
static void efforts_come_back_exactly(void)
{
    uint64_t random = 5;
    start(elbow_path, "gear=8,-8,16&weight=0&watchdog=none");
    simulated.is_kinematic = 1;
    for (int i = 0; i < 2000; i++) {
        dpt_wrench root = { { 0 }, { 0 } }, wrench = { { 0 }, { 0 } };
        double efforts[3];
        can_tick();
        CHECK(dpt_device_read(device, &state) == DPT_OK, "read");
        for (int k = 0; k < 3; k++)
            wrench.force[k] = random_in(&random, -2.0, 2.0);
        root.force[0] = -wrench.force[2];
        root.force[1] = -wrench.force[0];
        root.force[2] = wrench.force[1];
        CHECK(dpt_arm_efforts(simulated.arm.arm, state.joint, &root, efforts) == DPT_OK &&
                  dpt_device_write(device, &wrench) == DPT_OK,
              "write");
        can_tick();
        static const float gear[3] = { 8.0f, -8.0f, 16.0f };
        for (int k = 0; k < 3; k++)
            CHECK(simulated.node[k].torque * gear[k] == (float)efforts[k], "%a, not %a",
                  (double)(simulated.node[k].torque * gear[k]), efforts[k]);
    }
    finish();
}

int main(void)
{
    can_real = getenv("DPT_CAN");
    arm_file(elbow_path, elbow, 3, elbow_tool);
    arm_file(gantry_path, gantry, 3, no_tool);
    TEST(opens_and_tells);
    TEST(the_first_write_may_be_before_the_first_read);
    TEST(closes_the_loop);
    TEST(wires_give_the_same_bits);
    /* Of these a kernel could say nothing new. */
    if (!can_real) {
        TEST(its_weight_is_held_up);
        TEST(frames_are_as_they_are_set);
        TEST(efforts_come_back_exactly);
    }
    unlink(elbow_path);
    unlink(gantry_path);
    return check_report();
}
