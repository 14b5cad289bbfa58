/* SPDX-License-Identifier: BSD-3-Clause */
/* dynpoint device: list, watch, test, measure and simulate devices. */
#define _POSIX_C_SOURCE 200809L
#include <inttypes.h>
#include <math.h>
#include <string.h>
#include <unistd.h>

#include "built_with.h"
#include "cli/command_options.h"
#include "cli/commands.h"
#include "cli/json_text.h"
#include "cli/open_device.h"
#include "dynpoint/identify.h"
#include "dynpoint/selftest.h"
#include "simulate/simulate_can.h"
#include "simulate/simulate_serial.h"

static const char help[] =
    "usage: dynpoint device list [--json]\n"
    "       dynpoint device watch NAME [--for S] [--json]\n"
    "       dynpoint device selftest NAME [--move] [--json]\n"
    "       dynpoint device identify NAME [--move] [-o FILE] [--button N] [--json]\n"
    "       dynpoint device simulate serial|can:WHERE [--swing M] [--for S] [--json]\n"
    "\n"
    "Devices: NAME is DRIVER or DRIVER:WHERE, as sim or serial:/dev/ttyACM0.\n"
    "\n"
    "  list      the drivers that are built in, and the devices that they find\n"
    "  watch     what a device says, without force, until it is interrupted; a line a sample\n"
    "            where standard output is no terminal\n"
    "  selftest  whether it keeps the contract: exit status 1 when it does not\n"
    "  identify  its rate, steps and, with --move, mass, damping, friction and delay, with their\n"
    "            95 % intervals; exit status 1 when that failed or something holds it\n"
    "  simulate  the other end, with dynamics, whose name is printed: a device on a pseudo-terminal, or\n"
    "            motor controllers on a CAN interface, by the name that --device takes:\n"
    "            can:vcan0?arm=arm.dpa&gear=8,8,8\n"
    "\n"
    "  --for S   seconds; without it, until it is interrupted\n"
    "  --move    selftest may push the hand, by a twentieth of the greatest force and for 0.05 s\n"
    "            each way; without it nothing is moved. identify may push it by 0.5 N and 10 % of\n"
    "            the greatest force, for about a minute: let go of it. Any key ends that\n"
    "  -o FILE   identify writes what it measured, for run --identified FILE\n"
    "  --button N  identify pushes while button N, as of a pedal, is held\n"
    "  --json    what is told as one JSON object; of watch one a line, each a sample\n"
    "  --swing M how far the simulated hand goes up and down, m; default 0.02\n";

enum device_verb { VERB_LIST, VERB_WATCH, VERB_SELFTEST, VERB_SIMULATE, VERB_IDENTIFY, VERBS };
static const char *const verbs[VERBS + 1] = { "list", "watch", "selftest", "simulate", "identify", NULL };

/* Of each: how it is called, the options that it takes, and what --help says of it. */
static const struct {
    const char *typed, *options, *help;
} verb_defs[VERBS] = {
    { "device list", "--json",
      "usage: dynpoint device list [--json]\n"
      "\n"
      "The drivers that are built in, and the devices that they find.\n"
      "\n"
      "  --json  as one JSON object on standard output\n" },
    { "device watch", "--for --json",
      "usage: dynpoint device watch NAME [--for S] [--json]\n"
      "\n"
      "What a device says, without force, until it is interrupted; a line a sample where standard\n"
      "output is no terminal.\n"
      "\n"
      "  --for S  seconds; without it, until it is interrupted\n"
      "  --json   each sample as one JSON object, in a line\n" },
    { "device selftest", "--move --json",
      "usage: dynpoint device selftest NAME [--move] [--json]\n"
      "\n"
      "Whether a device keeps the contract of drivers: exit status 1 when it does not.\n"
      "\n"
      "  --move  it may push the hand, by a twentieth of the greatest force and for 0.05 s each way;\n"
      "          without it nothing is moved\n"
      "  --json  as one JSON object on standard output\n" },
    { "device simulate", "--swing --for --json",
      "usage: dynpoint device simulate serial|can:WHERE [--swing M] [--for S] [--json]\n"
      "\n"
      "The other end of a line, with dynamics, whose name is printed: a device on a pseudo-terminal, or\n"
      "motor controllers on a CAN interface, by the name that --device takes:\n"
      "can:vcan0?arm=arm.dpa&gear=8,8,8\n"
      "\n"
      "  --swing M  how far the simulated hand goes up and down, m; default 0.02\n"
      "  --for S    seconds; without it, until it is interrupted\n"
      "  --json     its name as one JSON object\n" },
    { "device identify", "--move -o --button --json",
      "usage: dynpoint device identify NAME [--move] [-o FILE] [--button N] [--json]\n"
      "\n"
      "A device's rate, steps and, with --move, mass, damping, friction and delay, with their 95 %\n"
      "intervals; exit status 1 when that failed or something holds it.\n"
      "\n"
      "  --move      it may push the hand by 0.5 N and 10 % of the greatest force, for about a minute:\n"
      "              let go of it. Any key ends that\n"
      "  -o FILE     what was measured, for run --identified FILE\n"
      "  --button N  pushes while button N, as of a pedal, is held\n"
      "  --json      as one JSON object on standard output\n" },
};

static void print_reasons(FILE *file, uint32_t reasons)
{
    const char *between = ": ";
    for (uint32_t left = reasons; left; left &= left - 1, between = ", ")
        fprintf(file, "%s%s", between, dpt_device_reason_name(left));
}

static void print_found(void *user, const dpt_driver *driver, const char *where, const char *about)
{
    (void)user;
    printf("    %s:%s  %s\n", driver->name, where, about);
}

/* user: what comes before it. */
static void print_found_json(void *user, const dpt_driver *driver, const char *where, const char *about)
{
    const char **between = user;
    char name[512];
    snprintf(name, sizeof name, "%s:%s", driver->name, where);
    printf("%s{\"name\":", *between);
    json_write_text(stdout, name);
    fputs(",\"about\":", stdout);
    json_write_text(stdout, about);
    putchar('}');
    *between = ",";
}

static int list_json(void)
{
    const dpt_driver *driver;
    fputs("{\"drivers\":[", stdout);
    for (uint32_t i = 0; (driver = dpt_driver_get(i)); i++) {
        const char *between = "";
        printf("%s{\"name\":\"%s\",\"about\":", i ? "," : "", driver->name);
        json_write_text(stdout, driver->about);
        fputs(",\"devices\":[", stdout);
        if (driver->find)
            driver->find(driver, print_found_json, &between);
        fputs("]}", stdout);
    }
    puts("]}");
    return 0;
}

static int list(void)
{
    const dpt_driver *driver;
    for (uint32_t i = 0; (driver = dpt_driver_get(i)); i++) {
        printf("%-12s %s\n", driver->name, driver->about);
        if (driver->find)
            driver->find(driver, print_found, NULL);
    }
    return 0;
}

/* Print the device dynamics that are known. */
static void print_dynamics(const dpt_device_info *info)
{
    const struct {
        const char *name, *unit;
        double value;
    } numbers[] = { { "mass", "kg", info->mass },
                    { "damping", "Ns/m", info->damping },
                    { "friction", "N", info->friction },
                    { "inertia", "kg m2", info->inertia },
                    { "spin damping", "Nms/rad", info->spin_damping },
                    { "spin friction", "Nm", info->spin_friction },
                    { "delay", "s", info->delay },
                    { "steps of", "m", info->position_step },
                    { "steps of", "rad", info->angle_step } };
    const char *between = "  ";
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
        if (numbers[i].value > 0.0) {
            printf("%s%s %g %s", between, numbers[i].name, numbers[i].value, numbers[i].unit);
            between = ", ";
        }
    if (*between == ',')
        putchar('\n');
}

static void print_info(const dpt_device_info *info)
{
    printf("%s%s%s%s\n", info->name, info->serial[0] ? ", " : "", info->serial,
           info->flags & DPT_DEVICE_FLAG_SIMULATED ? " (simulated)" : "");
    printf("  senses %" PRIu32 " degrees of freedom, gives %" PRIu32 "; %" PRIu32 " joints, %" PRIu32
           " buttons; %g Hz\n",
           info->pose_dofs, info->wrench_dofs, info->joints, info->buttons, info->rate);
    printf("  at most %g N", info->force_max);
    if (info->wrench_dofs == 6)
        printf(", %g Nm", info->torque_max);
    if (info->watchdog > 0.0)
        printf("; stops by itself after %g ms without a command\n", 1e3 * info->watchdog);
    else
        puts("; no watchdog of its own");
    print_dynamics(info);
    printf("  workspace");
    for (int k = 0; k < 3; k++)
        printf(" %c %g to %g%s", "xyz"[k], info -> workspace_min[k], info -> workspace_max[k], k < 2 ? "," : " m\n");
}

/* Print the changing values, one a line. The caller moves the cursor up to overwrite them. */
static void print_table(const dpt_device_info *info, const dpt_device_state *state, const dpt_device_counts *counts)
{
    printf("  status    %s", dpt_device_status_name(state->status));
    print_reasons(stdout, state->reasons);
    printf("\033[K\n  position  %10.5f %10.5f %10.5f m\033[K\n", state->pose.position[0], state->pose.position[1],
           state->pose.position[2]);
    printf("  turned    %10.5f %10.5f %10.5f %10.5f\033[K\n", state->pose.orientation[0], state->pose.orientation[1],
           state->pose.orientation[2], state->pose.orientation[3]);
    printf("  velocity  %10.5f %10.5f %10.5f m/s\033[K\n", state->velocity[0], state->velocity[1], state->velocity[2]);
    printf("  joints   ");
    for (uint32_t i = 0; i < info->joints; i++)
        printf(" %9.5f", state->joint[i]);
    printf("\033[K\n  buttons   ");
    for (uint32_t i = 0; i < info->buttons; i++)
        putchar(state->buttons >> i & 1 ? '#' : '.');
    printf("\033[K\n  samples   %" PRIu64 ", %" PRIu64 " lost, %" PRIu64 " damaged\033[K\n", counts->samples,
           counts->lost, counts->damaged);
}

enum { TABLE_LINES = 7 };

static void print_line(const dpt_device_state *state)
{
    printf("%" PRIu64 ",%s", state->sequence, dpt_device_status_name(state->status));
    for (int k = 0; k < 3; k++)
        printf(",%.9g", state->pose.position[k]);
    for (int k = 0; k < 4; k++)
        printf(",%.9g", state->pose.orientation[k]);
    printf(",%" PRIu32 "\n", state->buttons);
}

static void print_numbers(const char *before, const double *value, uint32_t count)
{
    printf("%s[", before);
    for (uint32_t i = 0; i < count; i++)
        printf("%s%.9g", i ? "," : "", value[i]);
    putchar(']');
}

static void print_sample_json(const dpt_device_info *info, const dpt_device_state *state)
{
    printf("{\"sequence\":%" PRIu64 ",\"status\":\"%s\"", state->sequence, dpt_device_status_name(state->status));
    print_numbers(",\"position\":", state->pose.position, 3);
    print_numbers(",\"orientation\":", state->pose.orientation, 4);
    print_numbers(",\"velocity\":", state->velocity, 3);
    print_numbers(",\"joints\":", state->joint, info->joints);
    printf(",\"buttons\":%" PRIu32 "}\n", state->buttons);
}

static int watch(dpt_device *device, double seconds, int json)
{
    dpt_device_info info = { .size = sizeof info };
    dpt_device_state state = { .size = sizeof state };
    dpt_device_counts counts = { .size = sizeof counts };
    const int is_terminal = !json && isatty(STDOUT_FILENO);
    dpt_device_get_info(device, &info);
    const double begin = seconds_now(), period = 1.0 / (info.rate > 0.0 ? info.rate : 1000.0);
    double shown_at = 0.0;
    int is_shown = 0;
    if (is_terminal)
        print_info(&info);
    else if (!json)
        puts("sequence,status,x,y,z,qw,qx,qy,qz,buttons");
    stop_watch(NULL, seconds);
    for (;;) {
        double now = seconds_now() - begin;
        dpt_result result = dpt_device_read(device, &state);
        int is_over = result == DPT_E_LOST || stop_requested();
        if (json && state.fresh)
            print_sample_json(&info, &state);
        else if (!is_terminal && state.fresh)
            print_line(&state);
        if (is_terminal && (is_over || now - shown_at > 0.05 || !is_shown)) {
            dpt_device_get_counts(device, &counts);
            if (is_shown)
                printf("\033[%dA", TABLE_LINES);
            print_table(&info, &state, &counts);
            fflush(stdout);
            is_shown = 1;
            shown_at = now;
        }
        if (result == DPT_E_LOST)
            return complain("device", "the device is lost");
        if (is_over)
            return 0;
        sleep_seconds(period);
    }
}

static int print_verdict(void *user, const dpt_selftest_line *line)
{
    (void)user;
    if (line->verdict == DPT_SELFTEST_NOTE)
        printf("  --   %s\n", line->what);
    else
        printf("  %s %-44s %.4g %s\n", line->verdict == DPT_SELFTEST_PASSED ? "ok  " : "FAIL", line->what,
               line->measured, line->unit);
    return stop_requested();
}

/* user: how many lines there were. */
static int print_verdict_json(void *user, const dpt_selftest_line *line)
{
    static const char *const words[] = {
        [DPT_SELFTEST_PASSED] = "passed", [DPT_SELFTEST_FAILED] = "failed", [DPT_SELFTEST_NOTE] = "note"
    };
    unsigned *count = user;
    printf("%s{\"verdict\":\"%s\",\"what\":", *count ? "," : "", words[line->verdict]);
    json_write_text(stdout, line->what);
    if (line->verdict != DPT_SELFTEST_NOTE && isfinite(line->measured))
        printf(",\"measured\":%.17g,\"unit\":\"%s\"", line->measured, line->unit);
    putchar('}');
    *count += 1;
    return stop_requested();
}

static int selftest(dpt_device *device, int may_move, int json)
{
    dpt_device_info info = { .size = sizeof info };
    dpt_selftest_def def;
    dpt_selftest_counts counts = { .size = sizeof counts };
    stop_watch(NULL, HUGE_VAL);
    dpt_device_get_info(device, &info);
    unsigned lines = 0;
    dpt_selftest_def_init(&def);
    def.may_move = may_move != 0;
    def.report = json ? print_verdict_json : print_verdict;
    def.user = &lines;
    if (json) {
        fputs("{\"name\":", stdout);
        json_write_text(stdout, info.name);
        fputs(",\"checks\":[", stdout);
    } else {
        print_info(&info);
    }
    const dpt_result result = dpt_device_selftest(device, &def, &counts);
    if (json)
        printf("],\"passed\":%" PRIu32 ",\"failed\":%" PRIu32 ",\"is_whole\":%s}\n", counts.passed, counts.failed,
               result == DPT_OK ? "true" : "false");
    if (result != DPT_OK && result != DPT_E_CANCELLED)
        return complain("device", "%s", dpt_result_text(result));
    return result != DPT_OK || counts.failed ? 1 : 0;
}

int command_device(int argc, char **argv)
{
    const char *operand[2];
    double seconds = HUGE_VAL, swing = 0.02;
    const char *output = NULL;
    int may_move = 0, json = 0;
    uint64_t button = DPT_IDENTIFY_NO_BUTTON;
    size_t operands;
    const struct option_def options[] = {
        { .name = "--for", .number = &seconds },  { .name = "--swing", .number = &swing },
        { .name = "--move", .flag = &may_move },  { .name = "-o", .text = &output, .kind = VALUE_FILE },
        { .name = "--button", .count = &button }, { .name = "--json", .flag = &json }
    };
    static const struct operand_def taken[] = { { .words = verbs }, { .kind = VALUE_DEVICE } };
    enum { OPTIONS = sizeof options / sizeof *options };
    struct option_def own[OPTIONS];
    int verb = find_word(argc, argv, verbs);
    struct command_syntax syntax = *COMMAND_SYNTAX(options, verb < 0 ? help : verb_defs[verb].help, taken);
    if (verb >= 0) {
        syntax.options = own;
        syntax.option_count = choose_options(options, OPTIONS, verb_defs[verb].options, own);
        complain_as("device", verb_defs[verb].typed);
    }
    int status = parse_options(argc, argv, &syntax, operand, 2, &operands);
    if (status >= 0)
        return status;
    verb = operands ? word_index(operand[0], verbs) : -1;
    if (operands && verb < 0)
        return complain_of_word("device", "what to do", operand[0], verbs);
    if (operands == 1 && verb != VERB_LIST)
        return complain("device", "%s is needed (see --help)",
                        verb == VERB_SIMULATE ? "serial, or can:WHERE," : "the NAME of a device");
    if (verb < 0 || operands != (verb == VERB_LIST ? 1u : 2u))
        return complain("device", "list, watch NAME, selftest NAME, identify NAME or simulate serial "
                                  "is needed (see --help)");
    if (!(seconds > 0.0) || !(swing >= 0.0 && swing <= 1.0))
        return complain("device", "--for must be positive, --swing 0 to 1");
    if (button != DPT_IDENTIFY_NO_BUTTON && button > 31)
        return complain("device", "--button must be 0 to 31");
    if (verb == VERB_LIST)
        return json ? list_json() : list();
    if (verb == VERB_SIMULATE)
        return device_simulate(operand[1], swing, seconds, json);
    if (verb == VERB_IDENTIFY)
        return device_identify(&(struct identify_request){
            .name = operand[1], .output = output, .button = (uint32_t)button, .may_move = may_move, .json = json });
    dpt_device *device;
    status = open_device("device", operand[1], &device);
    if (status)
        return status;
    if (verb == VERB_SELFTEST)
        end_fault("device", operand[1], device);
    status = verb == VERB_WATCH ? watch(device, seconds, json) : selftest(device, may_move, json);
    dpt_device_close(device);
    return status;
}

/* dynpoint device simulate: a simulated device at the other end of a line, so that the loop closes on one machine. */

#define LEFT_OUT "simulate: this build has no back end '%s': run make again with it among DRIVERS"

#if defined(DPT_HAS_SERIAL) || defined(DPT_HAS_CAN)

static void print_name(const char *driver, const char *where, int json)
{
    char name[512];
    snprintf(name, sizeof name, "%s:%s", driver, where);
    if (json)
        fputs("{\"name\":", stdout);
    if (json)
        json_write_text(stdout, name);
    puts(json ? "}" : name);
    fflush(stdout);
}

#endif

#ifdef DPT_HAS_SERIAL

static int simulate_serial(double swing, double seconds, int json)
{
    static struct simulate_serial simulated;
    int reason = simulate_serial_start(&simulated, NULL);
    if (reason)
        return complain("device", "simulate: no pseudo-terminal: %s", strerror(reason));
    simulated.swing = swing;
    print_name("serial", simulated.path, json);
    stop_watch(NULL, seconds);
    simulate_serial_run(&simulated, stop_flag());
    simulate_serial_end(&simulated);
    return 0;
}

#else

static int simulate_serial(double swing, double seconds, int json)
{
    (void)swing, (void)seconds, (void)json;
    return complain("device", LEFT_OUT, "serial");
}

#endif

#ifdef DPT_HAS_CAN

static int simulate_can(const char *where, double swing, double seconds, int json)
{
    static struct simulate_can simulated;
    dpt_device_error error = { .size = sizeof error };
    if (simulate_can_start(&simulated, where, &error) != DPT_OK)
        return complain("device", "simulate: can:%s: %s", where, error.text);
    simulated.swing = swing;
    print_name("can", where, json);
    stop_watch(NULL, seconds);
    simulate_can_run(&simulated, stop_flag());
    simulate_can_end(&simulated);
    return 0;
}

#else

static int simulate_can(const char *where, double swing, double seconds, int json)
{
    (void)where, (void)swing, (void)seconds, (void)json;
    return complain("device", LEFT_OUT, "can");
}

#endif

int device_simulate(const char *what, double swing, double seconds, int json)
{
    if (!strcmp(what, "serial"))
        return simulate_serial(swing, seconds, json);
    if (!strncmp(what, "can:", 4))
        return simulate_can(what + 4, swing, seconds, json);
    return complain("device", "simulate: there is no '%s', only serial and can:INTERFACE?arm=...", what);
}
