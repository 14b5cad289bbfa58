/* SPDX-License-Identifier: BSD-3-Clause */
/* dynpoint device: what devices there are, what one says, and whether it keeps its promises. */
#define _POSIX_C_SOURCE 200809L
#include <inttypes.h>
#include <math.h>
#include <string.h>
#include <unistd.h>

#include "command_options.h"
#include "commands.h"
#include "dynpoint/driver.h"
#include "open_device.h"
#include "stop.h"

static const char help[] =
    "usage: dynpoint device list\n"
    "       dynpoint device watch NAME [--for S]\n"
    "       dynpoint device selftest NAME [--move]\n"
    "       dynpoint device simulate serial|can:WHERE [--swing M] [--for S]\n"
    "\n"
    "Devices: NAME is DRIVER or DRIVER:WHERE, as sim or serial:/dev/ttyACM0.\n"
    "\n"
    "  list      the drivers that are built in, and the devices that they find\n"
    "  watch     what a device says, without force, until it is interrupted; a line a sample\n"
    "            where standard output is no terminal\n"
    "  selftest  whether it keeps the contract: exit status 1 when it does not\n"
    "  simulate  the other end, with dynamics, whose name is printed: a device on a "
    "pseudo-terminal, or\n"
    "            motor controllers on a CAN interface, by the name that --device takes:\n"
    "            can:vcan0?arm=arm.dpa&gear=8,8,8\n"
    "\n"
    "  --for S   seconds; without it, until it is interrupted\n"
    "  --move    selftest may push the hand, by a twentieth of the greatest force and for 0.05 s\n"
    "            each way; without it nothing is moved\n"
    "  --swing M how far the simulated hand goes up and down, m; default 0.02\n";

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

static int list(void)
{
    const dpt_driver *driver;
    for (uint32_t i = 0; (driver = dpt_driver_at(i)) != NULL; i++) {
        printf("%-12s %s\n", driver->name, driver->about);
        if (driver->find)
            driver->find(driver, print_found, NULL);
    }
    return 0;
}

static void print_info(const dpt_device_info *info)
{
    printf("%s%s%s%s\n", info->name, info->serial[0] ? ", " : "", info->serial,
           info->flags & DPT_DEVICE_FLAG_SIMULATED ? " (simulated)" : "");
    printf("  senses %" PRIu32 " degrees of freedom, gives %" PRIu32 "; %" PRIu32
           " joints, %" PRIu32 " buttons; %g Hz\n",
           info->pose_dofs, info->wrench_dofs, info->joints, info->buttons, info->rate);
    printf("  at most %g N", info->force_max);
    if (info->wrench_dofs == 6)
        printf(", %g Nm", info->torque_max);
    if (info->watchdog > 0.0)
        printf("; stops by itself after %g ms without a command\n", 1e3 * info->watchdog);
    else
        puts("; no watchdog of its own");
    printf("  workspace");
    for (int k = 0; k < 3; k++)
        printf(" %c %g to %g%s", "xyz"[k], info -> workspace_min[k], info -> workspace_max[k],
               k < 2 ? "," : " m\n");
}

/* Values that change, one under the other; the cursor goes back up for the next ones. */
static void print_table(const dpt_device_info *info, const dpt_device_state *state,
                        const dpt_device_counts *counts)
{
    printf("  status    %s", dpt_device_status_name(state->status));
    print_reasons(stdout, state->reasons);
    printf("\033[K\n  position  %10.5f %10.5f %10.5f m\033[K\n", state->pose.position[0],
           state->pose.position[1], state->pose.position[2]);
    printf("  turned    %10.5f %10.5f %10.5f %10.5f\033[K\n", state->pose.orientation[0],
           state->pose.orientation[1], state->pose.orientation[2], state->pose.orientation[3]);
    printf("  velocity  %10.5f %10.5f %10.5f m/s\033[K\n", state->velocity[0], state->velocity[1],
           state->velocity[2]);
    printf("  joints   ");
    for (uint32_t i = 0; i < info->joints; i++)
        printf(" %9.5f", state->joint[i]);
    printf("\033[K\n  buttons   ");
    for (uint32_t i = 0; i < info->buttons; i++)
        putchar(state->buttons >> i & 1 ? '#' : '.');
    printf("\033[K\n  samples   %" PRIu64 ", %" PRIu64 " lost, %" PRIu64 " damaged\033[K\n",
           counts->samples, counts->lost, counts->damaged);
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

static int watch(dpt_device *device, double seconds)
{
    dpt_device_info info = { .size = sizeof info };
    dpt_device_state state = { .size = sizeof state };
    dpt_device_counts counts = { .size = sizeof counts };
    const int is_terminal = isatty(STDOUT_FILENO);
    dpt_device_get_info(device, &info);
    const double begin = seconds_now(), period = 1.0 / (info.rate > 0.0 ? info.rate : 1000.0);
    double shown = 0.0;
    int lines = 0;
    if (is_terminal)
        print_info(&info);
    else
        puts("sequence,status,x,y,z,qw,qx,qy,qz,buttons");
    stop_watch(NULL, seconds);
    for (;;) {
        double now = seconds_now() - begin;
        dpt_result result = dpt_device_read(device, &state);
        int over = result == DPT_E_LOST || stop_asked();
        if (!is_terminal && state.fresh)
            print_line(&state);
        if (is_terminal && (over || now - shown > 0.05 || !lines)) {
            dpt_device_get_counts(device, &counts);
            if (lines)
                printf("\033[%dA", TABLE_LINES);
            print_table(&info, &state, &counts);
            fflush(stdout);
            lines = 1;
            shown = now;
        }
        if (result == DPT_E_LOST)
            return complain("device", "the device is lost");
        if (over)
            return 0;
        sleep_seconds(period);
    }
}

/* What a self-test found, one line each. */
struct verdicts {
    int failed;
};

static void verdict(struct verdicts *verdicts, int is_so, const char *what, double value,
                    const char *unit)
{
    printf("  %s %-44s %.4g %s\n", is_so ? "ok  " : "FAIL", what, value, unit);
    verdicts->failed += !is_so;
}

struct observed {
    dpt_device_state last;
    uint64_t reads, fresh, skipped;
    double seconds, farthest; /* of the way from the first sample */
    double first[3];
    int is_finite, is_ready;
};

/* Read for a while, and give a force meanwhile; zero before it returns. */
static dpt_result observe(dpt_device *device, const dpt_device_info *info, double seconds,
                          const dpt_wrench *wrench, struct observed *observed)
{
    const dpt_wrench zero = { { 0.0, 0.0, 0.0 }, { 0.0, 0.0, 0.0 } };
    const int waits = !(info->flags & DPT_DEVICE_FLAG_DETERMINISTIC);
    const double period = 1.0 / info->rate, begin = seconds_now();
    dpt_result result = DPT_OK;
    double now = 0.0;
    *observed = (struct observed){ .is_finite = 1, .is_ready = 1 };
    observed->last.size = sizeof observed->last;
    while (now < seconds && result == DPT_OK && !stop_asked()) {
        dpt_device_state *state = &observed->last;
        result = dpt_device_read(device, state);
        if (!observed->fresh && state->fresh)
            memcpy(observed->first, state->pose.position, sizeof observed->first);
        double way = 0.0;
        for (int k = 0; k < 3; k++) {
            way += pow(state->pose.position[k] - observed->first[k], 2.0);
            observed->is_finite &= isfinite(state->pose.position[k]) != 0;
        }
        observed->reads++;
        observed->fresh += state->fresh > 0;
        observed->skipped += state->fresh > 1 && observed->fresh > 1 ? state->fresh - 1 : 0;
        if (state->fresh && observed->fresh > 1)
            observed->farthest = fmax(observed->farthest, sqrt(way));
        observed->is_ready &= state->status == DPT_DEVICE_STATUS_READY;
        if (result == DPT_OK)
            result = dpt_device_write(device, wrench);
        result = result == DPT_E_BUSY ? DPT_OK : result;
        if (waits)
            sleep_seconds(0.5 * period);
        now = waits ? seconds_now() - begin : now + period;
    }
    dpt_device_write(device, &zero);
    observed->seconds = now;
    return result;
}

static int is_inside(const dpt_device_info *info, const dpt_device_state *state)
{
    int inside = 1;
    for (int k = 0; k < 3; k++) {
        double slack = 0.1 * (info->workspace_max[k] - info->workspace_min[k]);
        inside &= state->pose.position[k] >= info->workspace_min[k] - slack &&
                  state->pose.position[k] <= info->workspace_max[k] + slack;
    }
    return inside;
}

/* About z: no turn with w last. */
static int is_half_a_turn(const double *q)
{
    return fabs(q[0]) < 1e-6 && fabs(q[1]) < 1e-6 && fabs(q[2]) < 1e-6;
}

/* Gentle: of the greatest force so much, for so long. */
static const double PUSH = 0.05, PUSH_SECONDS = 0.05;

static void test_force(dpt_device *device, const dpt_device_info *info, struct verdicts *verdicts)
{
    for (int k = 0; k < 3; k++)
        for (double sign = 1.0; sign >= -1.0; sign -= 2.0) {
            dpt_wrench push = { { 0.0, 0.0, 0.0 }, { 0.0, 0.0, 0.0 } };
            struct observed still, pushed;
            char what[64];
            push.force[k] = sign * PUSH * info->force_max;
            const dpt_wrench zero = { { 0.0, 0.0, 0.0 }, { 0.0, 0.0, 0.0 } };
            observe(device, info, 0.2, &zero, &still);
            dpt_result result = observe(device, info, PUSH_SECONDS, &push, &pushed);
            double way = sign * (pushed.last.pose.position[k] - pushed.first[k]);
            snprintf(what, sizeof what, "%.2g N along %c%c moves the hand that way",
                     PUSH * info->force_max, sign > 0.0 ? '+' : '-', "xyz"[k]);
            verdict(verdicts, result == DPT_OK && way > 0.0, what, 1e3 * way, "mm");
        }
}

static int selftest(dpt_device *device, int may_move)
{
    const dpt_wrench zero = { { 0.0, 0.0, 0.0 }, { 0.0, 0.0, 0.0 } };
    dpt_wrench bad = zero;
    dpt_device_info info = { .size = sizeof info };
    dpt_device_counts counts = { .size = sizeof counts };
    struct verdicts verdicts = { 0 };
    struct observed observed;
    stop_watch(NULL, HUGE_VAL);
    dpt_device_get_info(device, &info);
    print_info(&info);
    verdict(&verdicts,
            (info.pose_dofs == 3 || info.pose_dofs == 6) &&
                (info.wrench_dofs == 0 || info.wrench_dofs == 3 || info.wrench_dofs == 6),
            "degrees of freedom are 3 or 6", info.pose_dofs, "");
    verdict(&verdicts, info.rate >= 100.0 && info.rate <= 1e5, "a rate of a haptic loop", info.rate,
            "Hz");
    if (verdicts.failed)
        return 1;
    dpt_result result = observe(device, &info, 1.0, &zero, &observed);
    verdict(&verdicts, result == DPT_OK, "reads and writes for a second", observed.seconds, "s");
    verdict(&verdicts, observed.is_ready, "ready all the time", (double)observed.last.reasons,
            "reasons");
    double rate = (double)(observed.fresh + observed.skipped) / observed.seconds;
    verdict(&verdicts, rate > 0.9 * info.rate && rate < 1.1 * info.rate, "samples at its rate",
            rate, "Hz");
    verdict(&verdicts, observed.is_finite && is_inside(&info, &observed.last),
            "within its workspace", observed.last.pose.position[0], "m in x");
    dpt_device_get_counts(device, &counts);
    verdict(&verdicts, counts.damaged == 0, "no frame damaged", (double)counts.damaged, "frames");
    verdict(&verdicts, counts.lost * 100 <= counts.samples, "at most 1 % of samples lost",
            (double)counts.lost, "samples");
    bad.force[1] = NAN;
    result = dpt_device_write(device, &bad);
    verdict(&verdicts, result == DPT_E_FINITE, "a force that is not finite is refused", result,
            "(code)");
    if (is_half_a_turn(observed.last.pose.orientation))
        puts("  --   turned by half a turn about z: is it sent as x, y, z, w? The order is w, x, "
             "y, z");
    if (info.wrench_dofs && may_move)
        test_force(device, &info, &verdicts);
    else
        puts(info.wrench_dofs ? "  --   its forces are not tested without --move"
                              : "  --   it gives no force");
    return verdicts.failed ? 1 : 0;
}

int command_device(int argc, char **argv)
{
    const char *operand[2];
    double seconds = HUGE_VAL, swing = 0.02;
    int may_move = 0;
    size_t operands;
    const struct option_def options[] = { { .name = "--for", .number = &seconds },
                                          { .name = "--swing", .number = &swing },
                                          { .name = "--move", .flag = &may_move } };
    static const char *const verbs[] = { "list", "watch", "selftest", "simulate", NULL };
    int status = parse_options(argc, argv, options, sizeof options / sizeof *options, help, operand,
                               2, &operands);
    if (status >= 0)
        return status;
    int verb = operands ? word_index(operand[0], verbs) : -1;
    if (verb < 0 || operands != (verb == 0 ? 1u : 2u))
        return complain(
            "device", "list, watch NAME, selftest NAME or simulate serial is needed (see --help)");
    if (!(seconds > 0.0) || !(swing >= 0.0 && swing <= 1.0))
        return complain("device", "--for must be positive, --swing 0 to 1");
    if (verb == 0)
        return list();
    if (verb == 3)
        return device_simulate(operand[1], swing, seconds);
    dpt_device *device;
    status = open_device("device", operand[1], &device);
    if (status)
        return status;
    if (verb == 2)
        end_fault("device", operand[1], device);
    status = verb == 1 ? watch(device, seconds) : selftest(device, may_move);
    dpt_device_close(device);
    return status;
}
