/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Devices by OpenHaptics, on a stand-in for the vendor's library (tests/drivers/hd): what a sample and a command come to. Time goes
 * tick by tick, by the test's own clock. How devices are opened: test_openhaptics_open.c; what ends the force:
 * test_openhaptics_faults.c.
 */
#include "drivers/hd/host.h"

#include "drivers/dynamics_checks.h"

#include <pthread.h>

#include "dynpoint/openhaptics.h"
#include "lib/fixture.h"
#include "lib/rig.h"

static void opens_and_tells(void)
{
    static const double workspace[6] = { -80, -60, -35, 80, 60, 35 };
    dpt_device_info info = { .size = sizeof info };
    start("");
    CHECK(error.text[0] == '\0', "there is nothing to say: %s", error.text);
    CHECK(dpt_device_get_info(device, &info) == DPT_OK, "info");
    CHECK(info.pose_dofs == 6 && info.wrench_dofs == 3 && info.joints == 6 && info.buttons == 4 && info.flags == 0,
          "dofs");
    CHECK(info.rate == 1000.0 && info.force_max == 3.3 && info.force_continuous == 0.88 && info.torque_max == 0.0 &&
              info.stiffness_max == 500.0 && info.watchdog == 0.01 && info.position_step == 0.0,
          "numbers");
    for (int k = 0; k < 3; k++)
        CHECK(info.workspace_min[k] == workspace[k] / 1000.0 && info.workspace_max[k] == workspace[3 + k] / 1000.0,
              "workspace");
    check_no_dynamics(device);
    CHECK(!strcmp(info.name, "stand-in") && !strcmp(info.serial, "A0"), "%s", info.name);
    CHECK(there->enabled == 7, "%x: output, clamping and ramping are on", there->enabled);
    CHECK(state.status == DPT_DEVICE_STATUS_READY && state.reasons == 0 && state.code == 0, "%s",
          dpt_device_status_name(state.status));
    CHECK(force_of(there) == 0.0, "it pushes before it was told to");
    const unsigned long frames = there->frames;
    for (int i = 0; i < 100; i++) {
        const uint64_t sequence = state.sequence;
        there->buttons = i % 16;
        tick(1);
        CHECK(dpt_device_read(device, &state) == DPT_OK && state.fresh == 1 && state.sequence == sequence + 1,
              "%u fresh", state.fresh);
        CHECK(state.time_ns == host.now, "the time of a sample");
        CHECK(state.buttons == (uint32_t)i % 16, "%x", state.buttons);
        CHECK(dpt_device_read(device, &state) == DPT_OK && state.fresh == 0 && state.sequence == sequence + 1 &&
                  state.time_ns == host.now,
              "an old one is another");
    }
    CHECK(there->frames == frames + 100, "%lu frames in 100 ticks", there->frames - frames);
    tick(3);
    CHECK(dpt_device_read(device, &state) == DPT_OK && state.fresh == 3, "%u fresh", state.fresh);
    dpt_device_counts counts = { .size = sizeof counts };
    dpt_device_get_counts(device, &counts);
    CHECK(counts.samples == state.sequence && counts.lost == 0 && counts.commands == 0 && counts.missed == 0, "counts");
    finish();
}

/* By Rodrigues' formula, column by column, as the library has it. */
static void turn_by(double transform[16], const double axis[3], double angle)
{
    const double c = cos(angle), s = sin(angle);
    for (int column = 0; column < 3; column++)
        for (int row = 0; row < 3; row++) {
            const int other = 3 - column - row;
            const double sign = (row - column + 3) % 3 == 1 ? 1.0 : -1.0;
            transform[4 * column + row] =
                (1.0 - c) * axis[column] * axis[row] + (row == column ? c : sign * s * axis[other]);
        }
}

static void turned(const double q[4], int axis, double out[3])
{
    const double w = q[0], x = q[1], y = q[2], z = q[3];
    const double columns[3][3] = { { w * w + x * x - y * y - z * z, 2.0 * (x * y + w * z), 2.0 * (x * z - w * y) },
                                   { 2.0 * (x * y - w * z), w * w - x * x + y * y - z * z, 2.0 * (y * z + w * x) },
                                   { 2.0 * (x * z + w * y), 2.0 * (y * z - w * x), w * w - x * x - y * y + z * z } };
    memcpy(out, columns[axis], sizeof columns[axis]);
}

/* Units, frames, and a transform that is a little off, as the vendor's are. */
static void samples_are_in_our_units(void)
{
    uint64_t seed = 9;
    double worst = 0.0, off = 0.0;
    const double box[6] = { -80, -60, -35, 100, 80, 35 };
    memcpy(there->workspace, box, sizeof box);
    start("");
    for (int n = 0; n < 2000; n++) {
        double axis[3], size = 0.0;
        for (int k = 0; k < 3; k++) {
            axis[k] = random_in(&seed, -1.0, 1.0);
            there->transform[12 + k] = random_in(&seed, -80.0, 80.0);
            there->velocity[k] = random_in(&seed, -500.0, 500.0);
            there->spin[k] = random_in(&seed, -9.0, 9.0);
            there->joints[k] = random_in(&seed, -2.0, 2.0);
            there->gimbal[k] = random_in(&seed, -2.0, 2.0);
            size += axis[k] * axis[k];
        }
        for (int k = 0; k < 3; k++)
            axis[k] /= sqrt(size);
        turn_by(there->transform, axis, n < 4 ? 3.141592653589793 : random_in(&seed, -4.0, 4.0));
        const double blur = n % 2 ? 1e-3 : 0.0;
        for (int i = 0; i < 11; i++)
            there->transform[i] += i % 4 < 3 ? random_in(&seed, -blur, blur) : 0.0;
        tick(1);
        CHECK(dpt_device_read(device, &state) == DPT_OK && state.status == DPT_DEVICE_STATUS_READY, "sample %d: %s", n,
              dpt_device_status_name(state.status));
        double square = 0.0;
        for (int k = 0; k < 4; k++)
            square += state.pose.orientation[k] * state.pose.orientation[k];
        CHECK(fabs(square - 1.0) < 1e-15 && state.pose.orientation[0] >= 0.0, "sample %d: %g", n, square - 1.0);
        for (int column = 0; column < 3; column++) {
            double is[3], length = 0.0;
            const double *was = there->transform + 4 * column;
            turned(state.pose.orientation, column, is);
            for (int k = 0; k < 3; k++)
                length += was[k] * was[k];
            for (int k = 0; k < 3; k++) {
                const double error_of = fabs(is[k] - was[k] / sqrt(length));
                if (column == 2 || n % 2 == 0)
                    worst = fmax(worst, error_of);
                else
                    off = fmax(off, error_of);
            }
        }
        for (int k = 0; k < 3; k++) {
            const double middle = 0.5 * (box[k] + box[3 + k]);
            CHECK(state.pose.position[k] == (there->transform[12 + k] - middle) / 1000.0, "position");
            CHECK(state.velocity[k] == there->velocity[k] / 1000.0 && state.spin[k] == there->spin[k] &&
                      state.joint[k] == there->joints[k] && state.joint[3 + k] == there->gimbal[k],
                  "sample %d", n);
        }
    }
    /* The stylus is z: that axis is kept; the others give way by as much as they were off. */
    CHECK(worst < 1e-14 && off < 5e-3 && off > 1e-4, "%g, %g", worst, off);
    finish();
}

/* Of 3 and 6 degrees of freedom, in and out. */
static void forces_and_torques_in_their_units(void)
{
    static const struct {
        int inputs, outputs;
        double torque;
        uint32_t wrench_dofs;
    } kinds[] = { { 3, 3, 0, 3 }, { 6, 3, 0, 3 }, { 6, 6, 188, 6 }, { 6, 6, 0, 3 }, { 6, 0, 0, 0 } };
    for (int i = 0; i < 5; i++) {
        const dpt_wrench wrench = { { 0.1, -0.7, 1.3 }, { 0.01, 0.05, -0.02 } };
        const dpt_wrench strong = { { 3e5, 4e5, 0.0 }, { 0.0, -1e300, 0.0 } };
        dpt_device_info info = { .size = sizeof info };
        there->inputs = kinds[i].inputs;
        there->outputs = kinds[i].outputs;
        there->torque_max = kinds[i].torque;
        there->transform[0] = there->transform[5] = -1.0;
        there->joints[2] = there->gimbal[0] = there->spin[1] = 0.5;
        start("");
        dpt_device_get_info(device, &info);
        CHECK(info.pose_dofs == (uint32_t)kinds[i].inputs && info.joints == info.pose_dofs &&
                  info.wrench_dofs == kinds[i].wrench_dofs && info.torque_max == kinds[i].torque / 1e3,
              "kind %d: %u, %u", i, info.pose_dofs, info.wrench_dofs);
        const int turns = kinds[i].inputs == 6;
        CHECK(state.pose.orientation[turns ? 3 : 0] == 1.0 && state.joint[2] == 0.5 &&
                  state.joint[3] == (turns ? 0.5 : 0.0) && state.spin[1] == (turns ? 0.5 : 0.0),
              "kind %d: %g", i, state.pose.orientation[0]);
        for (int n = 0; n < 150; n++) {
            CHECK(dpt_device_write(device, &wrench) == DPT_OK, "write");
            tick(1);
        }
        for (int k = 0; k < 3; k++) {
            CHECK(there->force[k] == (kinds[i].wrench_dofs ? wrench.force[k] : 0.0), "kind %d: %g", i, there->force[k]);
            CHECK(there->torque[k] == (kinds[i].wrench_dofs == 6 ? 1000.0 * wrench.torque[k] : 0.0), "kind %d: %g mNm",
                  i, there->torque[k]);
        }
        CHECK(dpt_device_write(device, &strong) == DPT_OK, "write");
        tick(1);
        if (kinds[i].wrench_dofs)
            CHECK(fabs(there->force[0] - 0.6 * 3.3) < 1e-14 && fabs(there->force[1] - 0.8 * 3.3) < 1e-14, "kind %d: %g",
                  i, there->force[0]);
        if (kinds[i].wrench_dofs == 6)
            CHECK(fabs(there->torque[1] + 188.0) < 1e-12, "kind %d: %g", i, there->torque[1]);
        CHECK(lib->errors() == 0 &&
                  dpt_device_write(device, &(dpt_wrench){ { NAN, 0, 0 }, { 0, 0, 0 } }) == DPT_E_FINITE,
              "kind %d: %d errors", i, lib->errors());
        tick(1);
        CHECK(force_of(there) == 0.0, "kind %d: NaN pushes", i);
        finish();
    }
}

/* From the first command on, and after each silence: n of 100 parts in the n-th tick. */
static void force_comes_along_a_ramp(void)
{
    /* A host that never reads is one all the same. */
    start("&silent=0.05");
    for (int n = 0; n < 200; n++) {
        CHECK(push(device, 1.0) == DPT_OK, "write, tick %d", n);
        tick(1);
    }
    CHECK(force_of(there) == 1.0, "%g", force_of(there));
    finish();
    start("");
    for (int n = 1; n <= 150; n++) {
        serve(1, 1.5);
        const double expected = 1.5 * ((n < 100 ? n : 100) / 100.0);
        CHECK(fabs(force_of(there) - expected) < 1e-15, "tick %d: %g", n, force_of(there));
    }
    CHECK(force_of(there) == 1.5, "%.17g", force_of(there));
    finish();
    lib->rate = 2000;
    start("&rate=2000");
    serve(100, 1.0);
    CHECK(fabs(force_of(there) - 0.5) < 1e-15, "at 2000 Hz: %g", force_of(there));
    finish();
    start("&rate=1000"); /* for the next tests: a scheduler keeps its rate */
    finish();
}

/* A held force comes to where the hand's spring holds it. */
static void closes_the_loop(void)
{
    there->moves = 1;
    start("");
    serve(4000, 1.5);
    CHECK(fabs(state.pose.position[1] - 1.5 / 150.0) < 1e-6, "%g", state.pose.position[1]);
    CHECK(fabs(state.velocity[1]) < 1e-6, "%g", state.velocity[1]);
    finish();
}

/* An error of one is not the other's; one of nobody is everyone's. */
static void errors_are_told_apart(dpt_device *other)
{
    dpt_device_state other_state = { .size = sizeof other_state };
    lib->raise = HD_EXCEEDED_MAX_VELOCITY;
    lib->raise_device = 1;
    tick(1);
    dpt_device_read(device, &state);
    dpt_device_read(other, &other_state);
    CHECK(state.status == DPT_DEVICE_STATUS_READY && other_state.status == DPT_DEVICE_STATUS_FAULT, "%u, %u",
          state.status, other_state.status);
    tick(1);
    CHECK(force_of(there) == 1.0 && force_of(left) == 0.0, "%g, %g", force_of(there), force_of(left));
    tick(120);
    CHECK(clear_device(other) == DPT_OK, "clear");
    lib->raise = HD_COMM_ERROR;
    lib->raise_device = 1;
    tick(1);
    CHECK(dpt_device_read(device, &state) == DPT_OK && dpt_device_read(other, &other_state) == DPT_E_LOST,
          "one line fails");
    CHECK(clear_device(other) == DPT_OK && dpt_device_read(device, &state) == DPT_OK, "clear");
    lib->raise = HD_FORCE_ERROR;
    lib->raise_device = 77;
    tick(1);
    dpt_device_read(device, &state);
    dpt_device_read(other, &other_state);
    CHECK(state.status == DPT_DEVICE_STATUS_FAULT && other_state.status == DPT_DEVICE_STATUS_FAULT, "%u, %u",
          state.status, other_state.status);
    tick(120);
    CHECK(clear_device(device) == DPT_OK && clear_device(other) == DPT_OK, "clear");
}

/* Both lose our callback: each is cleared by itself, and errors from before harm none. */
static dpt_device *both_lose_the_callback(dpt_device *other)
{
    dpt_device_state other_state = { .size = sizeof other_state };
    lib->drops_callbacks = 1;
    pass(3.0);
    tick(1);
    CHECK(dpt_device_read(device, &state) == DPT_E_LOST && dpt_device_read(other, &other_state) == DPT_E_LOST,
          "both are lost");
    close_one(other);
    CHECK(clear_device(device) == DPT_OK, "clear");
    CHECK(open_at(&other, "Left Device", "&watchdog=1") == DPT_OK, "%s", error.text);
    lib->drops_callbacks = 1;
    pass(3.0);
    tick(1);
    CHECK(dpt_device_read(device, &state) == DPT_E_LOST && dpt_device_read(other, &other_state) == DPT_E_LOST,
          "both are lost");
    CHECK(clear_device(other) == DPT_OK && clear_device(device) == DPT_OK, "clear");
    CHECK(dpt_device_read(device, &state) == DPT_OK && dpt_device_read(other, &other_state) == DPT_OK, "both are back");
    return other;
}

/* One that cannot be opened, and one that is closed, leave the other alone. */
static void the_other_is_left_alone(dpt_device *other)
{
    dpt_device *none;
    CHECK(open_at(&none, "Nobody", "") == DPT_E_DEVICE, "%s", error.text);
    CHECK(open_at(&none, "", "") == DPT_E_DEVICE && strstr(error.text, "open already"), "%s", error.text);
    left->name[0] = 'D';
    CHECK(open_at(&none, "", "&rate=500") == DPT_E_DEVICE, "%s", error.text);
    dpt_device_read(device, &state);
    serve(150, 1.0);
    CHECK(force_of(there) == 1.0, "%g", force_of(there));
    close_one(other);
    CHECK(!left->is_open, "not closed");
    tick(1);
    CHECK(dpt_device_read(device, &state) == DPT_OK && state.fresh > 0, "lost with the other");
    serve(150, 1.0);
    CHECK(force_of(there) == 1.0, "%g", force_of(there));
}

static void two_devices_share_the_scheduler(void)
{
    dpt_device *other = NULL;
    dpt_device_state other_state = { .size = sizeof other_state };
    start("&watchdog=1");
    serve(150, 1.0);
    const uint64_t sequence = state.sequence;
    left->force_max = 7.0;
    CHECK(open_at(&other, "Left Device", "&watchdog=1") == DPT_OK, "%s", error.text);
    CHECK(dpt_device_read(device, &state) == DPT_OK && state.sequence > sequence,
          "the first one is lost by the second");
    left->transform[12] = 11.0;
    for (int n = 0; n < 150; n++) {
        tick(1);
        CHECK(dpt_device_read(device, &state) == DPT_OK && dpt_device_read(other, &other_state) == DPT_OK &&
                  state.time_ns == other_state.time_ns,
              "tick %d", n);
        CHECK(push(device, 1.0) == DPT_OK && push(other, -5.0) == DPT_OK, "tick %d", n);
    }
    tick(1);
    CHECK(force_of(there) == 1.0 && force_of(left) == -5.0, "%g, %g", force_of(there), force_of(left));
    CHECK(other_state.pose.position[0] == 0.011 && state.pose.position[0] == 0.0, "poses");
    errors_are_told_apart(other);
    other = both_lose_the_callback(other);
    the_other_is_left_alone(other);
    finish();
}

enum { VISITS = 5 };
static int visits, visits_over;

static void wait_a_tick(void)
{
    const struct timespec time = { 0, 1000000 };
    nanosleep(&time, NULL);
}

static void *visit(void *name)
{
    for (int i = 0; i < VISITS; i++) {
        dpt_device *other;
        if (dpt_device_open(name, &other, NULL) != DPT_OK)
            continue;
        for (int n = 0; n < 20; n++) {
            push(other, 1.0);
            wait_a_tick();
        }
        visits += dpt_device_clear(other) == DPT_OK;
        dpt_device_close(other);
    }
    __atomic_store_n(&visits_over, 1, __ATOMIC_RELEASE);
    return NULL;
}

/* One serves its device while another comes and goes: for ThreadSanitizer too. */
static void hosts_have_threads_of_their_own(void)
{
    char name[512];
    pthread_t thread;
    int lost = 0;
    visits = visits_over = 0;
    start("");
    go();
    snprintf(name, sizeof name, "openhaptics:Left Device?library=%s&silent=2", library_path);
    if (pthread_create(&thread, NULL, visit, name) != 0)
        exit(1);
    while (!__atomic_load_n(&visits_over, __ATOMIC_ACQUIRE)) {
        lost += dpt_device_read(device, &state) != DPT_OK || push(device, 1.0) != DPT_OK;
        wait_a_tick();
    }
    pthread_join(thread, NULL);
    hold();
    CHECK(visits == VISITS && lost == 0, "%d visits, %d times lost", visits, lost);
    finish();
}

/* Tool and mesh as `dynpoint run` has them. */
static void scene_open(struct rig *scene, const dpt_mesh *mesh)
{
    dpt_world_def def = rig_def(DPT_LAW_PROXY);
    const dpt_segment stylus = { .radius = 0.002 };
    def.max_contacts = 0;
    def.max_bodies = def.max_tools = def.max_segments = 1;
    def.stiffness = 40.0;
    rig_open(scene, &def, mesh, &stylus, 1);
}

static dpt_wrench scene_feel(struct rig *scene, const dpt_pose *pose, const double origin[3])
{
    double z[3], ends[6];
    turned(pose->orientation, 2, z);
    for (int k = 0; k < 3; k++) {
        ends[k] = origin[k] + pose->position[k];
        ends[3 + k] = ends[k] + 0.1 * z[k];
    }
    rig_step_ends(scene, ends, 0.002);
    return scene->force.wrench;
}

/* A spring and a lever: what a rounded pose does to it is bounded by its stiffness. */
static dpt_wrench spring_feel(const dpt_pose *pose)
{
    dpt_wrench wrench = { { 0.0 }, { 0.0 } };
    double z[3];
    turned(pose->orientation, 2, z);
    for (int k = 0; k < 3; k++)
        wrench.force[k] = -30.0 * (pose->position[k] + 0.1 * z[k] - (k == 2 ? 0.1 : 0.0));
    return wrench;
}

static void compare_motions(const dpt_mesh *mesh, const double origin[3], int is_turned)
{
    struct rig scenes[2];
    dpt_device *sim = NULL;
    dpt_device_state truth = { .size = sizeof truth };
    double far = 0.0, wrong = 0.0, strongest = 0.0;
    int pressed = 0;
    scene_open(&scenes[0], mesh);
    scene_open(&scenes[1], mesh);
    CHECK(dpt_device_open(is_turned ? "sim:?hand=wipe&reach=0.03&cycle=1"
                                    : "sim:?hand=press&reach=0.03&cycle=1&step=9.5367431640625e-07",
                          &sim, &error) == DPT_OK,
          "%s", error.text);
    start("");
    serve(150, 0.0);
    for (int n = 0; n < 2000; n++) {
        CHECK(dpt_device_read(sim, &truth) == DPT_OK, "read");
        dpt_pose pose = truth.pose;
        const double axis[3] = { 0.6, 0.0, 0.8 };
        dpt_hd_to_transform(&pose, there->transform);
        if (is_turned)
            turn_by(there->transform, axis, 5.0 * pose.position[1]);
        tick(1);
        CHECK(dpt_device_read(device, &state) == DPT_OK && state.fresh == 1, "tick %d", n);
        const double half = 2.5 * pose.position[1];
        for (int k = 0; is_turned && k < 4; k++)
            pose.orientation[k] = k == 0 ? cos(half) : sin(half) * axis[k - 1];
        const dpt_wrench is = is_turned ? spring_feel(&pose) : scene_feel(&scenes[0], &pose, origin);
        const dpt_wrench felt = is_turned ? spring_feel(&state.pose) : scene_feel(&scenes[1], &state.pose, origin);
        CHECK(dpt_device_write(sim, &is) == DPT_OK && dpt_device_write(device, &felt) == DPT_OK, "write");
        tick(1);
        dpt_device_read(device, &state);
        CHECK(!memcmp(felt.force, there->force, sizeof felt.force), "tick %d: %.17g N is %.17g N", n, felt.force[1],
              there->force[1]);
        CHECK(is_turned ||
                  (!memcmp(is.force, there->force, sizeof is.force) && !memcmp(&pose, &state.pose, sizeof pose)),
              "tick %d: %.17g N is %.17g N", n, is.force[1], there->force[1]);
        pressed += is.force[1] > 0.0;
        for (int k = 0; k < 3; k++) {
            strongest = fmax(strongest, fabs(is.force[k]));
            wrong = fmax(wrong, fabs(is.force[k] - there->force[k]));
            if (pose.position[k] != 0.0)
                far = fmax(far, fabs(state.pose.position[k] / pose.position[k] - 1.0));
        }
    }
    printf("    %s: force on %d of 2000 ticks, at most %.2f N; places off by %.2g of themselves, forces by %.2g N\n",
           is_turned ? "between the grid's places" : "on the grid", pressed, strongest, far, wrong);
    CHECK(pressed > 300 && strongest < 3.3, "%d pressed, %g N", pressed, strongest);
    CHECK(far <= (is_turned ? 0x1p-52 : 0.0), "%g", far);
    CHECK(wrong <= (is_turned ? 30.0 * (0.1 * 1e-15 + 0.03 * 0x1p-51) : 0.0), "%g N", wrong);
    dpt_device_close(sim);
    finish();
    rig_close(&scenes[0]);
    rig_close(&scenes[1]);
}

/*
 * The motion of a simulated device, given to the stand-in in mm. Places on a grid of 2^-20 m are exact in m and in mm, and
 * so the pose and the force of a scene are the same bits. Others are rounded once each way: a place is off by at most one
 * part in 2^52, an axis by a few parts, and the force of a spring by as much as that stretches it.
 */
static void the_same_motion_gives_the_same_force(void)
{
    struct fixture fixture;
    if (!fixture_from_shape(&fixture, "liver", 3000))
        return;
    dpt_mesh_info mesh = { .size = sizeof mesh };
    dpt_mesh_get_info(fixture.mesh, &mesh);
    const double origin[3] = { 0.5 * (mesh.box_min[0] + mesh.box_max[0]), mesh.box_max[1] + 0.007,
                               0.5 * (mesh.box_min[2] + mesh.box_max[2]) };
    for (int is_turned = 0; is_turned < 2; is_turned++)
        compare_motions(fixture.mesh, origin, is_turned);
    fixture_free(&fixture);
}

/* The loop and its guard, by the clock, and a fault in between. */
static dpt_result press(void *user, const dpt_loop_sample *sample, dpt_wrench *wrench)
{
    int *count = user;
    (void)sample;
    if (++*count == 400)
        __atomic_store_n(&lib->raise, HD_EXCEEDED_MAX_VELOCITY, __ATOMIC_RELAXED);
    wrench->force[1] = 1.0;
    return DPT_OK;
}

static void a_loop_serves_it(void)
{
    dpt_loop_def def;
    dpt_loop *loop;
    dpt_loop_stats stats = { .size = sizeof stats };
    int count = 0;
    there->moves = 1;
    start("&silent=5&watchdog=1");
    go();
    dpt_loop_def_init(&def);
    def.tick = press;
    def.user = &count;
    def.ticks = 800;
    def.lock = def.priority = 0;
    CHECK(dpt_loop_open(device, &def, &loop) == DPT_OK, "loop");
    CHECK(dpt_loop_run(loop, &stats) != DPT_E_LOST, "lost");
    hold();
    CHECK(stats.ticks == 800 && stats.fresh > 100 && stats.not_ready > 10, "%d fresh, %d not ready", (int)stats.fresh,
          (int)stats.not_ready);
    CHECK(there->force[1] == 0.0, "it ends with force");
    dpt_loop_close(loop);
    finish();
}

int main(int argc, char **argv)
{
    (void)argc;
    take_stand_in(argv[0], "libHD-stand-in.so");
    renew();
    TEST(opens_and_tells);
    TEST(samples_are_in_our_units);
    TEST(forces_and_torques_in_their_units);
    TEST(force_comes_along_a_ramp);
    TEST(closes_the_loop);
    TEST(two_devices_share_the_scheduler);
    TEST(hosts_have_threads_of_their_own);
    TEST(the_same_motion_gives_the_same_force);
    TEST(a_loop_serves_it);
    return check_report();
}
