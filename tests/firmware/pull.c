/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * docs/samples/safe_device.c presses onto a sheet by firmware on an emulated Cortex-M7, and the plug is pulled at random
 * instants of its run: a way of the line is cut, or both; it is unplugged; the host is killed, stopped or interrupted; the
 * firmware loses its power. The motors' force, which the firmware itself tells over a second UART (meter.h), is zero within its
 * watchdog's time after the last command, and stays so; where commands pass, the host's guard ends it before that. And the host
 * says why it ended. Times are of the firmware's clock. run.sh gives the commands:
 *
 *     pull SAFE_DEVICE SCENE METER PULLS QEMU ARGUMENTS...      QEMU writes the second UART to the file METER
 */
#include "drivers/relay.h"

#include <math.h>
#include <signal.h>
#include <time.h>

#include "firmware/emulator.h"
#include "firmware/meter.h"
#include "lib/check.h"
#include "lib/plug.h"

/* Of pressed.elf (run.sh), ms. */
enum { PERIOD = 4, WATCHDOG = 500 };

/* Commands with a force that answer the last sample that passed: its own, the guard's three periods, its ramp of 2 ms. */
enum { GUARDED_MAX = 5 };

enum { COMMANDS_CUT, SAMPLES_CUT, LINE_CUT, UNPLUGGED, KILLED, STOPPED, INTERRUPTED, NO_POWER, KINDS };

static struct plug_kind kinds[KINDS] = {
    [COMMANDS_CUT] = { "commands cut", 1, 2, "(watchdog), and gave no force" },
    [SAMPLES_CUT] = { "samples cut", 0, 2, "the device is gone" },
    [LINE_CUT] = { "line cut", 0, 2, "the device is gone" },
    [UNPLUGGED] = { "unplugged", 0, 2, "the device is gone" },
    [KILLED] = { "host killed", 0, 128 + SIGKILL, "" },
    [STOPPED] = { "host stopped", 1, 2, "(watchdog), and gave no force" },
    [INTERRUPTED] = { "host interrupted", 0, 0, "ticks, in contact on" },
    [NO_POWER] = { "firmware without power", 0, 2, "the device is gone" },
};

static char **qemu;
static const char *safe_device, *scene, *meter_path;
static uint64_t seed = 1;
static unsigned long pulls;
static struct emulator firmware;
static struct plug plug;
static char ours[64];
static struct relay_way out, back; /* to the firmware, from it */
static int is_cut[2];              /* of out, of back */

/* What has passed since the host began. */
static struct {
    struct wire_reader out, back;
    uint32_t sample; /* sequence of the last */
    unsigned commands;
    unsigned answered; /* of them, with a force, those to the last sample */
    double force;      /* N, of the last command */
} line;

/* What the firmware's motors do. */
static struct {
    int file;
    struct meter_reading last;
    uint32_t command_ms, zero_ms; /* when the last command came, and when the force became zero */
    uint64_t readings;
} meter;

static double length_of(const float force[3])
{
    return sqrt((double)force[0] * force[0] + (double)force[1] * force[1] + (double)force[2] * force[2]);
}

static void read_meter(void)
{
    struct meter_reading next;
    while (pread(meter.file, &next, sizeof next, (off_t)(meter.readings * sizeof next)) == (ssize_t)sizeof next) {
        if (next.commands != meter.last.commands)
            meter.command_ms = next.ms;
        if (length_of(next.force) == 0.0 && (length_of(meter.last.force) > 0.0 || meter.readings == 0))
            meter.zero_ms = next.ms;
        meter.last = next;
        meter.readings++;
    }
}

static int is_pushing(void)
{
    return length_of(meter.last.force) > 0.0;
}

static int choose_fate(struct relay_way *way, uint8_t *frame, size_t size)
{
    (void)frame, (void)size;
    return is_cut[way == &back] ? RELAY_DROP : RELAY_PASS;
}

static void note_command(const struct wire_command *command)
{
    line.force = length_of(command->force);
    line.commands++;
    if (command->answers == line.sample)
        line.answered += line.force > 0.0;
}

static void note_frame(struct relay_way *way, const uint8_t *frame, size_t size)
{
    struct wire_message message;
    for (size_t i = 0; i < size; i++) {
        if (wire_read(way == &out ? &line.out : &line.back, frame[i], &message) != WIRE_MESSAGE)
            continue;
        if (message.type == WIRE_COMMAND)
            note_command(&message.as.command);
        if (message.type == WIRE_STATE) {
            line.sample = message.as.state.sequence;
            line.answered = 0;
        }
    }
}

/* Relay for so long, or until `enough` says so; whether it did. */
static int relay_for(double seconds, int (*enough)(void))
{
    const struct timespec wait = { 0, 1000000 };
    for (double t = 0.0; t < seconds; t += 1.1e-3) {
        relay_turn(&out);
        relay_turn(&back);
        read_meter();
        if (enough && enough())
            return 1;
        nanosleep(&wait, NULL);
    }
    return 0;
}

static int has_ended(void)
{
    return child_has_ended(&plug.host);
}

/* A while after the force has ended: the watchdog's time is over too. */
static int has_rested(void)
{
    return !is_pushing() && meter.last.ms - meter.zero_ms > 100 && meter.last.ms - meter.command_ms > WATCHDOG + 50;
}

static int power_on(void)
{
    meter.readings = 0;
    memset(&meter.last, 0, sizeof meter.last);
    unlink(meter_path);
    if (!emulator_start(&firmware, qemu))
        return 0;
    /* QEMU makes the file after it has said the pty's name. */
    const struct timespec wait = { 0, 10000000 };
    for (int i = 0; i < 500 && (meter.file = open(meter_path, O_RDONLY | O_CLOEXEC)) < 0; i++)
        nanosleep(&wait, NULL);
    out.to = back.from = relay_open(firmware.line);
    return meter.file >= 0 && out.to >= 0;
}

static void power_off(void)
{
    emulator_kill(&firmware);
    read_meter();
    close(meter.file);
    close(out.to);
    out.to = back.from = -1;
}

static void plug_in(void)
{
    out.from = back.to = relay_pty(ours);
    is_cut[0] = is_cut[1] = 0;
}

static void pull(int kind)
{
    switch (kind) {
    case COMMANDS_CUT:
        is_cut[0] = 1;
        break;
    case SAMPLES_CUT:
        is_cut[1] = 1;
        break;
    case LINE_CUT:
        is_cut[0] = is_cut[1] = 1;
        break;
    case UNPLUGGED:
        close(out.from);
        out.from = back.to = -1;
        break;
    case NO_POWER:
        power_off();
        break;
    default:
        plug_signal(&plug, &kinds[kind]);
    }
}

/*
 * safe_device begins, and runs for a random time, and until it pushes if it must. 0: the machine is so busy that the firmware
 * has stopped itself before, or samples were late.
 */
static int run_host(int must_push)
{
    char device[128];
    char *const words[] = { (char *)(uintptr_t)safe_device, (char *)(uintptr_t)scene, device, NULL };
    plug_in();
    snprintf(device, sizeof device, "serial:%s?answer=5&silent=1&mass=0.1&damping=5&delay=0.008", ours);
    memset(&line, 0, sizeof line);
    CHECK(child_start(&plug.host, words), "%s does not start", safe_device);
    relay_for(random_in(&seed, 0.0, 1.6), has_ended);
    if (must_push)
        relay_for(3.0, is_pushing);
    if (!has_ended() && (!line.commands || meter.last.status == WIRE_STATUS_READY))
        return 1;
    plug_give_up(&plug);
    close(out.from);
    return 0;
}

static void pull_once(int kind)
{
    const int was_running = line.commands > 0, was_pushing = is_pushing();
    const uint32_t pulled_ms = meter.last.ms;
    const unsigned commands = line.commands;
    pull(kind);
    if (kind != NO_POWER) {
        CHECK(relay_for(5.0, has_rested), "%s: %g N after %u ms", kinds[kind].name, length_of(meter.last.force),
              (unsigned)(meter.last.ms - pulled_ms));
        CHECK(!was_pushing || (int32_t)(meter.zero_ms - meter.command_ms) <= WATCHDOG + 2 * PERIOD,
              "%s: a force %d ms after the last command", kinds[kind].name, (int)(meter.zero_ms - meter.command_ms));
    }
    if (was_running && (kind == SAMPLES_CUT || kind == INTERRUPTED))
        CHECK(line.force == 0.0 && line.answered <= GUARDED_MAX,
              "%s: the last command is %g N, %u of the last have a force", kinds[kind].name, line.force, line.answered);
    const unsigned guarded = kind == SAMPLES_CUT ? line.answered : 0;
    if (kind == COMMANDS_CUT || kind == LINE_CUT || kind == UNPLUGGED)
        CHECK(line.commands == commands, "%s: a command passes", kinds[kind].name);
    plug_check_end(&plug, &kinds[kind], was_running);
    plug_note(&kinds[kind], was_running, was_pushing, kind != NO_POWER && was_pushing ? meter.zero_ms - pulled_ms : 0,
              guarded);
    if (out.from >= 0)
        close(out.from);
    if (kind == NO_POWER)
        CHECK(power_on(), "the firmware does not start again");
}

static void the_force_ends_when_the_plug_is_pulled(void)
{
    plug = (struct plug){ .kinds = kinds,
                          .kind_count = KINDS,
                          .wait_for = relay_for,
                          .has_ended = has_ended,
                          .is_pushing = is_pushing,
                          .patience = 10.0,
                          .busy = "this machine is busy: the firmware's watchdog ended the force before" };
    plug_pull_all(&plug, pulls, run_host, pull_once);
}

int main(int argc, char **argv)
{
    if (argc < 6)
        return 2;
    safe_device = argv[1];
    scene = argv[2];
    meter_path = argv[3];
    pulls = strtoul(argv[4], NULL, 10);
    qemu = argv + 5;
    out.fate = back.fate = choose_fate;
    out.delivered = back.delivered = note_frame;
    if (power_on()) {
        TEST(the_force_ends_when_the_plug_is_pulled);
    } else {
        printf("    the firmware does not start\n");
        check_failed++;
    }
    if (firmware.process > 0)
        power_off();
    return check_report();
}
