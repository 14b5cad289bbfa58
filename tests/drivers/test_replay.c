/* SPDX-License-Identifier: BSD-3-Clause */
/* A trace as a device: each row once and in turn, with its pose, jumps as gaps of time, and an end. */
#include <math.h>
#include <time.h>

#include "drivers/dynamics_checks.h"
#include "drivers/open_device.h"

enum { ROWS = 500, GAP_AT = 200, GAP = 7 };

struct motion {
    double a[ROWS][3], b[ROWS][3];
    int tick[ROWS];
    struct small_file file;
};

/* A tool that turns all the way round, past where its axis is opposite to z, with a jump in between. */
static void make_motion(struct motion *motion)
{
    static char text[ROWS * 200];
    char *at = text + sprintf(text, "# a motion\n  # of a tool\ntick,ax,ay,az,bx,by,bz\n");
    for (int row = 0; row < ROWS; row++) {
        double angle = 0.03 * row, tilt = row < GAP_AT ? 0.0 : 0.4;
        const double way[3] = { sin(angle) * cos(tilt), sin(angle) * sin(tilt), cos(angle) };
        motion->tick[row] = 1000 + row + (row >= GAP_AT ? GAP : 0);
        for (int k = 0; k < 3; k++) {
            motion->a[row][k] = 0.01 * cos(0.01 * row + k) + (row >= GAP_AT ? 0.05 : 0.0);
            motion->b[row][k] = motion->a[row][k] + 0.25 * way[k];
        }
        const double *a = motion->a[row], *b = motion->b[row];
        at += sprintf(at, "%d,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g\n", motion->tick[row], a[0], a[1], a[2], b[0], b[1],
                      b[2]);
    }
    motion->file = file_with(text);
}

/* R(q) (0, 0, length) */
static void along_z(const double *q, double length, double *out)
{
    out[0] = length * 2.0 * (q[1] * q[3] + q[0] * q[2]);
    out[1] = length * 2.0 * (q[2] * q[3] - q[0] * q[1]);
    out[2] = length * (q[0] * q[0] - q[1] * q[1] - q[2] * q[2] + q[3] * q[3]);
}

static void check_row(const struct motion *motion, const dpt_device_state *state, int row)
{
    const double *q = state->pose.orientation;
    double tip[3], norm = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
    along_z(q, 0.25, tip);
    CHECK(fabs(norm - 1.0) < 1e-14, "row %d: a quaternion of %g", row, norm);
    for (int k = 0; k < 3; k++) {
        CHECK(state->pose.position[k] == motion->a[row][k], "row %d: at %g", row, state->pose.position[k]);
        CHECK(fabs(state->pose.position[k] + tip[k] - motion->b[row][k]) < 1e-14, "row %d: B is off by %g", row,
              state->pose.position[k] + tip[k] - motion->b[row][k]);
    }
}

static void rows_are_samples(void)
{
    static struct motion motion;
    make_motion(&motion);
    dpt_device *device = device_named("replay:%s", motion.file.path);
    dpt_device_state state, before = { .size = sizeof before };
    for (int lap = 0; lap < 2; lap++) {
        for (int row = 0; row < ROWS; row++) {
            state = state_of(device);
            check_row(&motion, &state, row);
            uint64_t ticks = (uint64_t)(motion.tick[row] - motion.tick[0]);
            CHECK(state.status == DPT_DEVICE_STATUS_READY && state.sequence == ticks &&
                      state.time_ns == ticks * 1000000u,
                  "row %d: sample %d", row, (int)state.sequence);
            CHECK(state.fresh == (row == GAP_AT ? GAP + 1 : 1), "row %d: fresh %u", row, state.fresh);
            int jumps = row == 0 || row == GAP_AT;
            double turn = 0.0;
            for (int k = 0; k < 3; k++) {
                double speed = jumps ? 0.0 : 1000.0 * (motion.a[row][k] - motion.a[row - 1][k]);
                CHECK(fabs(state.velocity[k] - speed) < 1e-12, "row %d: %g m/s", row, state.velocity[k]);
                turn += state.spin[k] * state.spin[k];
            }
            CHECK(fabs(sqrt(turn) - (jumps ? 0.0 : 1000.0 * 0.03)) < 1e-9, "row %d: %g rad/s", row, sqrt(turn));
            if (!jumps) {
                double same = 0.0;
                for (int k = 0; k < 4; k++)
                    same += state.pose.orientation[k] * before.pose.orientation[k];
                CHECK(fabs(same - cos(0.015)) < 1e-12, "row %d: it turns more than the tool", row);
            }
            write_force(device, 1.0, 2.0, 3.0);
            before = state;
        }
        for (int i = 0; i < 3; i++) {
            CHECK(dpt_device_read(device, &state) == DPT_E_LOST && state.fresh == 0, "it goes on");
            CHECK(state.status == DPT_DEVICE_STATUS_LOST && state.reasons == DPT_REASON_UNPLUGGED, "%u", state.reasons);
            CHECK(!memcmp(&state.pose, &before.pose, sizeof state.pose), "the last pose is forgotten");
        }
        dpt_wrench wrench = { { 0.0 }, { 0.0 } };
        CHECK(dpt_device_write(device, &wrench) == DPT_E_LOST, "it takes force");
        CHECK(dpt_device_clear(device) == DPT_OK, "it does not start again");
    }
    CHECK(counts_of(device).resets == 2 && counts_of(device).commands == 2 * ROWS, "%d commands",
          (int)counts_of(device).commands);
    dpt_device_close(device);
    unlink(motion.file.path);
}

/* Each setting from nothing to the most that it may be, and no further. */
static void what_a_maker_does_not_tell_can_be_named(void)
{
    static const struct {
        const char *name;
        double most;
    } settings[] = { { "mass", 100 },        { "inertia", 10 },         { "damping", 1000 },
                     { "spin_damping", 10 }, { "friction", 100 },       { "spin_friction", 10 },
                     { "delay", 1 },         { "position_step", 0.01 }, { "angle_step", 0.1 } };
    struct small_file file = file_with("tick,ax,ay,az,bx,by,bz\n0,0,0,0,0,0,1\n");
    dpt_device *device = device_named("replay:%s?rate=500&" DYNAMICS, file.path);
    check_dynamics(device);
    dpt_device_close(device);
    device = device_named("replay:%s", file.path);
    check_no_dynamics(device);
    dpt_device_close(device);
    for (size_t i = 0; i < sizeof settings / sizeof *settings; i++) {
        const struct {
            double value;
            dpt_result result;
        } cases[] = { { 0.0, DPT_OK },
                      { settings[i].most, DPT_OK },
                      { 1.001 * settings[i].most, DPT_E_SETTING },
                      { -1e-9, DPT_E_SETTING },
                      { NAN, DPT_E_SETTING } };
        for (int k = 0; k < 5; k++) {
            char name[128];
            dpt_device_error error = { .size = sizeof error };
            snprintf(name, sizeof name, "replay:%s?%s=%.17g", file.path, settings[i].name, cases[k].value);
            CHECK(dpt_device_open(name, &device, &error) == cases[k].result, "%s: %s", name, error.text);
            CHECK(cases[k].result == DPT_OK || strstr(error.text, settings[i].name), "%s", error.text);
            dpt_device_close(device);
        }
    }
    unlink(file.path);
}

static void again_begins_anew(void)
{
    struct small_file file = file_with("tick,ax,ay,az,bx,by,bz\n5,0,0,0,0,0,1\n6,0.1,0,0,0.1,0,-1\n8,0,0,1,0,0,1\n");
    static const uint64_t sequence[] = { 0, 1, 3, 4, 5, 7, 8 };
    dpt_device *device = device_named("replay:%s?again=1&rate=500", file.path);
    dpt_device_info info = { .size = sizeof info };
    CHECK(dpt_device_get_info(device, &info) == DPT_OK && info.rate == 500.0 &&
              info.flags == (DPT_DEVICE_FLAG_SIMULATED | DPT_DEVICE_FLAG_DETERMINISTIC) &&
              info.workspace_max[0] == 0.1 && info.workspace_min[2] == 0.0 && info.workspace_max[2] == 1.0,
          "info");
    for (int i = 0; i < 7; i++) {
        dpt_device_state state = state_of(device);
        double z[3];
        along_z(state.pose.orientation, 1.0, z);
        CHECK(state.sequence == sequence[i] && state.time_ns == sequence[i] * 2000000u, "read %d: sample %d", i,
              (int)state.sequence);
        CHECK(fabs(z[2] - (i % 3 == 1 ? -1.0 : 1.0)) < 1e-14, "read %d: z is %g", i, z[2]);
        CHECK((state.velocity[0] == 0.0) == (i % 3 != 1), "read %d: %g m/s over a jump", i, state.velocity[0]);
    }
    dpt_device_close(device);
    unlink(file.path);
}

static void live_keeps_time(void)
{
    static struct motion motion;
    make_motion(&motion);
    dpt_device *device = device_named("replay:%s?live=1", motion.file.path);
    dpt_device_state state = { .size = sizeof state };
    const struct timespec nap = { 0, 700000 };
    uint64_t seen = 0, reads = 0;
    while (dpt_device_read(device, &state) == DPT_OK && reads < 100000) {
        int row = (int)state.sequence;
        row -= row >= GAP_AT ? GAP : 0;
        check_row(&motion, &state, row);
        seen += state.fresh;
        CHECK(seen == state.sequence + 1, "%d seen at sample %d", (int)seen, (int)state.sequence);
        reads++;
        nanosleep(&nap, NULL);
    }
    CHECK(state.status == DPT_DEVICE_STATUS_LOST && reads > 5, "%d reads", (int)reads);
    dpt_device_close(device);
    unlink(motion.file.path);
}

static void wrong_traces_are_refused(void)
{
    static const struct {
        const char *text;
        dpt_result code;
        const char *reason;
    } cases[] = {
        { "", DPT_E_SYNTAX, ":1: there are no rows" },
        { "tick,ax,ay,az\n", DPT_E_SYNTAX, ":1: the header is not tick,ax,ay,az,bx,by,bz" },
        { "tick,ax,ay,az,bx,by,bz\n1,0,0,0,0,0\n", DPT_E_SYNTAX, ":2: there are too few" },
        { "tick,ax,ay,az,bx,by,bz\n1.5,0,0,0,0,0,1\n", DPT_E_SYNTAX, ":2: the tick is not an integer" },
        { "tick,ax,ay,az,bx,by,bz\n1e30,0,0,0,0,0,1\n", DPT_E_SYNTAX, ":2: the tick is not within 2^53" },
        { "tick,ax,ay,az,bx,by,bz\n1,0,0,0,0,0,2e6\n", DPT_E_SYNTAX, ":2: a coordinate is beyond 1e6 m" },
        { "tick,ax,ay,az,bx,by,bz\n2,0,0,0,0,0,1\n1,0,0,0,0,0,1\n", DPT_E_SYNTAX, ":3: the first column" },
        { "tick,ax,ay,az,bx,by,bz\n1,0,0,0,0,0,1\n9e15,0,0,0,0,0,1\n", DPT_E_LIMIT,
          "at 1000 Hz, are more than 100 years" },
    };
    dpt_device *device;
    dpt_device_error error = { .size = sizeof error };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct small_file file = file_with(cases[i].text);
        char name[128];
        snprintf(name, sizeof name, "replay:%s", file.path);
        CHECK(dpt_device_open(name, &device, &error) == cases[i].code && !device, "case %d: %s", (int)i, error.text);
        CHECK(strstr(error.text, cases[i].reason) != NULL, "case %d: %s", (int)i, error.text);
        unlink(file.path);
    }
    CHECK(dpt_device_open("replay", &device, &error) == DPT_E_SETTING, "%s", error.text);
    CHECK(dpt_device_open("replay:?live=1", &device, &error) == DPT_E_SETTING, "%s", error.text);
    CHECK(dpt_device_open("replay:/nowhere.csv", &device, &error) == DPT_E_OPEN, "%s", error.text);
}

int main(void)
{
    TEST(rows_are_samples);
    TEST(what_a_maker_does_not_tell_can_be_named);
    TEST(again_begins_anew);
    TEST(live_keeps_time);
    TEST(wrong_traces_are_refused);
    return check_report();
}
