/* SPDX-License-Identifier: BSD-3-Clause */
/* The driver for serial lines (drivers/serial/serial.c) with a device that is well, on lines that are good, bad and full. */
#include "drivers/serial_fixture.h"

#include "drivers/dynamics_checks.h"
#include "dynpoint/driver.h"

#include <math.h>

#include "platform/clock.h"

static void opens_and_tells(void)
{
    dpt_device_info info = { .size = sizeof info };
    not_a_tty = 0;
    start(NULL, "?silent=30&" DYNAMICS);
    check_dynamics(device);
    CHECK(not_a_tty == 1, "a pty has modem lines: then this shows nothing");
    CHECK(dpt_device_get_info(device, &info) == DPT_OK, "info");
    CHECK(info.pose_dofs == 3 && info.wrench_dofs == 3 && info.joints == 0 && info.buttons == 1, "dofs");
    CHECK(info.flags == DPT_DEVICE_FLAG_SIMULATED && info.rate == 1000 && info.force_max == 5 &&
              info.watchdog == (double)0.02f && info.workspace_max[1] == (double)0.1f,
          "numbers");
    CHECK(strcmp(info.name, "simulated serial device") == 0 && strcmp(info.serial, "0") == 0, "%s", info.name);
    CHECK(state.status == DPT_DEVICE_STATUS_READY && state.reasons == 0 && state.temperature == -1, "%u", state.status);
    CHECK(simulated.device.force[1] == 0, "it pushes before it was told to");
    simulated.buttons = 1;
    uint64_t time = 0;
    for (int i = 0; i < 100; i++) {
        simulate_serial_tick(&simulated);
        const uint64_t sequence = state.sequence;
        CHECK(dpt_device_read(device, &state) == DPT_OK && state.fresh == 1, "%u fresh", state.fresh);
        CHECK(state.sequence == sequence + 1 && state.time_ns > time && state.buttons == 1, "at %d", i);
        CHECK(state.time_ns <= clock_now(), "a sample of the future");
        CHECK(state.pose.orientation[0] == 1, "orientation");
        time = state.time_ns;
        CHECK(dpt_device_read(device, &state) == DPT_OK && state.fresh == 0, "read twice");
        CHECK(state.sequence == sequence + 1 && state.time_ns == time, "an old one is another");
    }
    for (int i = 0; i < 3; i++)
        simulate_serial_tick(&simulated);
    CHECK(dpt_device_read(device, &state) == DPT_OK && state.fresh == 3, "%u fresh", state.fresh);
    finish();
}

/* A force that is held comes to where the hand's spring holds it, and too much is cut. */
static void closes_the_loop(void)
{
    start(NULL, "?silent=30");
    for (int i = 0; i < 4000; i++) {
        CHECK(write_force(1.5) == DPT_OK, "write");
        simulate_serial_tick(&simulated);
        CHECK(simulated.device.force[1] == 1.5f, "%g", (double)simulated.device.force[1]);
        CHECK(dpt_device_read(device, &state) == DPT_OK && state.fresh == 1, "read");
    }
    CHECK(fabs(state.pose.position[1] - 1.5 / 150) < 1e-6, "%g", state.pose.position[1]);
    CHECK(fabs(state.velocity[1]) < 1e-6, "%g", state.velocity[1]);
    CHECK(write_force(-1e300) == DPT_OK, "write");
    simulate_serial_tick(&simulated);
    CHECK(fabs((double)simulated.device.force[1] + 5) < 1e-5, "%g", (double)simulated.device.force[1]);
    CHECK(write_force(NAN) == DPT_E_FINITE, "NaN");
    simulate_serial_tick(&simulated);
    CHECK(simulated.device.force[1] == 0, "%g", (double)simulated.device.force[1]);
    finish();
}

/* Orientation, spin and joints, and torque, of a device that has them. */
static void six_freedoms_and_joints(void)
{
    struct wire_info info;
    simulate_serial_info(&info);
    info.pose_dofs = info.wrench_dofs = 6;
    info.joints = 1;
    info.torque_max = 0.1f;
    info.flags = 0xffffffffu;
    start(&info, "?silent=30");
    check_no_dynamics(device);
    dpt_device_info told = { .size = sizeof told };
    CHECK(dpt_device_get_info(device, &told) == DPT_OK &&
              told.flags == (DPT_DEVICE_FLAG_SIMULATED | DPT_DEVICE_FLAG_ARM),
          "flags %x: a loop does not wait for a device that has its own time", told.flags);
    const dpt_wrench wrench = { { 3, 4, 12 }, { 0, 0.3, 0.4 } };
    CHECK(dpt_device_write(device, &wrench) == DPT_OK, "write");
    simulate_serial_tick(&simulated);
    const float *force = simulated.device.force, *torque = simulated.device.torque;
    CHECK(fabs((double)force[0] - 3 * 5 / 13.0) < 1e-6 && fabs((double)force[2] - 12 * 5 / 13.0) < 1e-6, "%g",
          (double)force[0]);
    CHECK(fabs((double)torque[1] - 0.06) < 1e-7 && fabs((double)torque[2] - 0.08) < 1e-7, "%g", (double)torque[1]);
    CHECK(dpt_device_read(device, &state) == DPT_OK && state.pose.orientation[0] == 1, "read");
    finish();
}

/* What really went over the line, and so what both sides must have counted. */
struct truth {
    struct relay_way way; /* first */
    uint64_t seed;
    int calm; /* pass all */
    uint32_t sent, damaged, newest, lost, reordered, late, from;
    uint8_t *came;
    int is_commands;
};
enum { NUMBERS = 1 << 20 };
static uint32_t cycles = 60000;

static int number_of(const uint8_t *frame, size_t size, uint8_t type, uint32_t *number, uint32_t *answers)
{
    struct wire_reader reader = { 0 };
    struct wire_message message;
    for (size_t i = 0; i < size; i++)
        if (wire_read(&reader, frame[i], &message) == WIRE_MESSAGE && message.type == type) {
            *number = type == WIRE_STATE ? message.as.state.sequence : message.as.command.sequence;
            *answers = type == WIRE_STATE ? 0 : message.as.command.answers;
            return *number < NUMBERS;
        }
    return 0;
}

static int choose_fate(struct relay_way *way, uint8_t *frame, size_t size)
{
    struct truth *truth = (struct truth *)way;
    uint32_t number, answers;
    if (!number_of(frame, size, truth->is_commands ? WIRE_COMMAND : WIRE_STATE, &number, &answers))
        return RELAY_PASS;
    truth->sent++;
    if (truth->calm)
        return RELAY_PASS;
    /* Now and then all are held for longer than the watchdog waits. */
    if (way->turn % 9973 < 30)
        return 30 - way->turn % 9973;
    const uint64_t dice = random_bits(&truth->seed) % 1000;
    if (dice < 15)
        return RELAY_DROP;
    if (dice < 30) {
        const size_t bit = random_bits(&truth->seed) % 8, at = random_bits(&truth->seed) % (size - 1);
        /* Not into a zero, which would make two damaged pieces of one frame. */
        if (frame[at] != 1 << bit) {
            frame[at] = (uint8_t)(frame[at] ^ 1 << bit);
            truth->damaged++;
        }
        return RELAY_PASS;
    }
    return dice < 60 ? 1 + (int)(random_bits(&truth->seed) % 12) : RELAY_PASS;
}

static void keep_truth(struct relay_way *way, const uint8_t *frame, size_t size)
{
    struct truth *truth = (struct truth *)way;
    uint32_t number, answers;
    if (!number_of(frame, size, truth->is_commands ? WIRE_COMMAND : WIRE_STATE, &number, &answers))
        return;
    CHECK(!truth->came[number], "number %u twice", number);
    truth->came[number] = 1;
    if (number > truth->newest) {
        truth->newest = number;
        /* The device takes it in before it makes its next sample. */
        if (truth->is_commands && simulated.device.sequence - answers > simulated.device.watchdog_samples)
            truth->late++;
    } else {
        truth->reordered++;
    }
}

static struct truth commands, states;

static void cycle(void)
{
    relay_turn(&commands.way);
    simulate_serial_tick(&simulated);
    relay_turn(&states.way);
}

/* While the host blocks, the rest goes on, and the line is good. */
static void cycle_while(dpt_result (*blocking)(void), const char *what)
{
    commands.calm = states.calm = 1;
    each_ms = cycle;
    const dpt_result result = blocking();
    halt();
    commands.calm = states.calm = 0;
    CHECK(result == DPT_OK, "%s: %d %s", what, result, error.text);
}

static char middle[64];

static dpt_result open_middle(void)
{
    return open_at(middle, "?silent=60");
}

/* What both sides counted, against what went over the line. */
static void compare_counts(int faults)
{
    dpt_device_get_counts(device, &counts);
    const struct wire_device *there = &simulated.device;
    for (uint32_t i = 1; i < commands.newest; i++)
        commands.lost += !commands.came[i];
    /* States before the first one that came are none of this host's. */
    uint32_t first = 1;
    while (!states.came[first])
        first++;
    for (uint32_t i = first; i < states.newest; i++)
        states.lost += !states.came[i];
    CHECK(commands.newest == counts.commands - counts.refused && counts.refused == 0, "%u, %u", commands.newest,
          (unsigned)counts.commands);
    CHECK(there->commands.lost == commands.lost && there->commands.reordered == commands.reordered &&
              there->late == commands.late && there->commands.repeated == 0,
          "the device counts %u lost, %u reordered, %u late, not %u, %u, %u", there->commands.lost,
          there->commands.reordered, there->late, commands.lost, commands.reordered, commands.late);
    CHECK(counts.missed == (uint64_t)commands.lost + commands.reordered + commands.late, "%u missed",
          (unsigned)counts.missed);
    CHECK(there->reader.damaged == commands.damaged, "%u damaged at the device, not %u", there->reader.damaged,
          commands.damaged);
    CHECK(counts.lost == states.lost && counts.reordered == states.reordered,
          "the host counts %u lost, %u reordered, not %u, %u", (unsigned)counts.lost, (unsigned)counts.reordered,
          states.lost, states.reordered);
    CHECK(counts.damaged == states.damaged, "%u damaged at the host, not %u", (unsigned)counts.damaged, states.damaged);
    CHECK(counts.samples == states.newest - first + 1 && counts.resets == 0, "%u samples, not %u",
          (unsigned)counts.samples, states.newest - first + 1);
    CHECK(commands.lost > cycles / 120 && commands.reordered > cycles / 120 && commands.late > cycles / 3000 &&
              states.lost > cycles / 120 && states.reordered > cycles / 120 && faults > (int)cycles / 20000,
          "too little went wrong to show anything");
}

static void all_that_goes_wrong_is_counted_on_both_sides(void)
{
    uint64_t fresh = 0;
    int faults = 0;
    CHECK(simulate_serial_start(&simulated, NULL) == 0, "no pty");
    memset(&commands, 0, sizeof commands);
    memset(&states, 0, sizeof states);
    commands.way.from = states.way.to = relay_pty(middle);
    commands.way.to = states.way.from = relay_open(simulated.path);
    commands.way.fate = states.way.fate = choose_fate;
    commands.way.delivered = states.way.delivered = keep_truth;
    commands.came = calloc(2, NUMBERS);
    states.came = commands.came + NUMBERS;
    commands.is_commands = 1;
    commands.seed = 10;
    states.seed = 11;
    cycle_while(open_middle, "open");
    if (!device)
        return;
    dpt_device_get_counts(device, &counts);
    dpt_device_read(device, &state);
    for (uint32_t i = 0; i < cycles; i++) {
        const dpt_result written = write_force(0.001 * (i % 1000));
        CHECK(written == DPT_OK || written == DPT_E_NOT_READY, "write: %d", written);
        commands.calm = states.calm = i >= cycles - 100;
        cycle();
        CHECK(dpt_device_read(device, &state) == DPT_OK, "read in cycle %u", i);
        fresh += state.fresh;
        if (state.status == DPT_DEVICE_STATUS_FAULT) {
            CHECK(state.reasons == DPT_REASON_WATCHDOG, "%u", state.reasons);
            faults++;
            cycle_while(clear, "clear");
        }
    }
    compare_counts(faults);
    CHECK(fresh > cycles / 2, "%u fresh", (unsigned)fresh);
    printf("    %u commands: %u lost, %u reordered, %u late; %u samples: %u lost, %u reordered; %d faults cleared\n",
           commands.newest, commands.lost, commands.reordered, commands.late, (unsigned)counts.samples, states.lost,
           states.reordered, faults);
    commands.calm = states.calm = 1;
    each_ms = cycle;
    close_device();
    halt();
    close(commands.way.from);
    close(commands.way.to);
    simulate_serial_end(&simulated);
    free(commands.came);
}

/* A host that only reads shows life, or the device would end the session after 1000 samples. */
static void a_host_that_reads_is_there(void)
{
    start(NULL, "?silent=30");
    const uint32_t begin = simulated.device.sequence;
    go();
    while (simulated.device.sequence - begin < 3000) {
        CHECK(dpt_device_read(device, &state) == DPT_OK, "read");
        pause_ms(5);
    }
    halt();
    CHECK(state.status == DPT_DEVICE_STATUS_READY && simulated.device.session != 0, "%u", state.status);
    finish();
}

/* Nobody takes the bytes: commands are refused, none is cut in two, and those that were not arrive. */
static void a_full_line_never_blocks(void)
{
    start(NULL, "?silent=30");
    int ok = 0, busy = 0;
    for (int i = 0; i < 3000; i++) {
        const dpt_result result = write_force(1);
        CHECK(result == DPT_OK || result == DPT_E_BUSY, "%d", result);
        ok += result == DPT_OK;
        busy += result == DPT_E_BUSY;
    }
    CHECK(ok > 10 && busy > 100, "%d, %d", ok, busy);
    for (int i = 0; i < 5; i++)
        simulate_serial_tick(&simulated);
    /* The rest of one that was begun goes before the next. */
    CHECK(write_force(1) == DPT_OK, "write");
    simulate_serial_tick(&simulated);
    const struct wire_device *there = &simulated.device;
    CHECK(there->commands.accepted == (uint32_t)ok + 1 && there->commands.lost == 0 && there->reader.damaged == 0,
          "%u of %d, %u lost, %u damaged", there->commands.accepted, ok + 1, there->commands.lost,
          there->reader.damaged);
    dpt_device_get_counts(device, &counts);
    CHECK(counts.commands == 3001 && counts.refused == (uint64_t)busy, "%u, %u", (unsigned)counts.commands,
          (unsigned)counts.refused);
    dpt_device_read(device, &state);
    finish();
}

/* However much waits: four reads, a poll, a heartbeat; and a command is one write, two after one in part. */
static void calls_are_bounded(void)
{
    struct wire_info info;
    simulate_serial_info(&info);
    info.watchdog = 10;
    start(&info, "?silent=30");
    for (int round = 0; round < 300; round++) {
        for (int i = 0; i < round; i++)
            simulate_serial_tick(&simulated);
        watched = 1;
        calls = 0;
        CHECK(dpt_device_read(device, &state) == DPT_OK, "read");
        const int reading = calls;
        calls = 0;
        write_force(1);
        watched = 0;
        CHECK(reading <= 6 && calls <= 2, "%d, %d calls", reading, calls);
    }
    finish();
}

static void count_ports(void *user, const dpt_driver *driver, const char *where, const char *about)
{
    CHECK(driver == dpt_driver_find("serial") && !strncmp(where, "/dev/", 5) && about[0], "%s", where);
    ++*(int *)user;
}

static void finds_ports(void)
{
    int ports = 0;
    const dpt_driver *driver = dpt_driver_find("serial");
    driver->find(driver, count_ports, &ports);
    error.size = sizeof error;
    if (ports == 0)
        CHECK(dpt_device_open("serial", &device, &error) == DPT_E_DEVICE && strstr(error.text, "no serial port"), "%s",
              error.text);
    dpt_device_close(device);
}

/* An argument: how many cycles on the bad line. */
int main(int argc, char **argv)
{
    if (argc > 1)
        cycles = (uint32_t)strtoul(argv[1], NULL, 10);
    if (!has_ptys("all of test_serial"))
        return check_report();
    TEST(opens_and_tells);
    TEST(closes_the_loop);
    TEST(six_freedoms_and_joints);
    TEST(all_that_goes_wrong_is_counted_on_both_sides);
    TEST(a_host_that_reads_is_there);
    TEST(a_full_line_never_blocks);
    TEST(calls_are_bounded);
    TEST(finds_ports);
    return check_report();
}
