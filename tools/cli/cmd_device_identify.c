/* SPDX-License-Identifier: BSD-3-Clause */
/* dynpoint device identify: measure a device by small known pushes. */
#include <inttypes.h>
#include <math.h>
#include <string.h>

#include "cli/command_options.h"
#include "cli/commands.h"
#include "cli/open_device.h"
#include "dynpoint/identify.h"
#include "platform/program.h"

/* ---- any key stops it ---- */

static int must_stop(void *user, const dpt_identify_progress *progress)
{
    const struct keyboard *keyboard = user;
    (void)progress;
    return stop_requested() || keyboard_is_pressed(keyboard);
}

/* ---- what is said ---- */

/* The values with intervals, by the names of the settings. */
struct row {
    const char *name, *unit;
    uint32_t bit;
    dpt_identified value;
};

enum { INTERVALS = 7, STEPS = 2, ROWS = INTERVALS + STEPS };

static void fill_rows(const dpt_identify_result *result, struct row *rows)
{
    const dpt_identified position_step = { .value = result->position_step };
    const dpt_identified angle_step = { .value = result->angle_step };
    const struct row all[ROWS] = {
        { "mass", "kg", DPT_IDENTIFIED_MASS, result->mass },
        { "damping", "Ns/m", DPT_IDENTIFIED_DAMPING, result->damping },
        { "friction", "N", DPT_IDENTIFIED_FRICTION, result->friction },
        { "inertia", "kg m2", DPT_IDENTIFIED_INERTIA, result->inertia },
        { "spin_damping", "Nms/rad", DPT_IDENTIFIED_SPIN_DAMPING, result->spin_damping },
        { "spin_friction", "Nm", DPT_IDENTIFIED_SPIN_FRICTION, result->spin_friction },
        { "delay", "s", DPT_IDENTIFIED_DELAY, result->delay },
        { "position_step", "m", DPT_IDENTIFIED_POSITION_STEP, position_step },
        { "angle_step", "rad", DPT_IDENTIFIED_ANGLE_STEP, angle_step },
    };
    memcpy(rows, all, sizeof all);
}

static void print_row(const struct row *row, const dpt_identify_result *result)
{
    printf("  %-14s", row->name);
    if (!(result->measured & row->bit))
        puts("not measured");
    else if (row->value.high > 0.0)
        printf("%.4g %s  (%.4g to %.4g)\n", row->value.value, row->unit, row->value.low, row->value.high);
    else
        printf("%.4g %s\n", row->value.value, row->unit);
}

static void print_direction(const char *what, const double *direction)
{
    if (direction[0] != 0.0 || direction[1] != 0.0 || direction[2] != 0.0)
        printf("  the least %s is along (%.2f, %.2f, %.2f)\n", what, direction[0], direction[1], direction[2]);
}

static void print_text(const dpt_device_info *info, const dpt_identify_result *result, int may_move)
{
    struct row rows[ROWS];
    fill_rows(result, rows);
    printf("%s%s%s\n", info->name, info->serial[0] ? ", " : "", info->serial);
    printf("  at (%.4f, %.4f, %.4f) m\n", result->pose.position[0], result->pose.position[1], result->pose.position[2]);
    if (result->measured & DPT_IDENTIFIED_RATE)
        printf("  %-14s%.5g Hz, jitter %.3g us, at worst %.3g us\n", "rate", result->rate, 1e6 * result->jitter,
               1e6 * result->jitter_max);
    printf("  %-14s%" PRIu64 ", %" PRIu64 " lost, %" PRIu64 " late, %" PRIu64 " doubled\n", "samples", result->samples,
           result->lost, result->late, result->doubled);
    for (int i = 0; i < ROWS; i++)
        print_row(&rows[i], result);
    print_direction("mass", result->mass_direction);
    print_direction("damping", result->damping_direction);
    print_direction("inertia", result->inertia_direction);
    print_direction("spin damping", result->spin_damping_direction);
    if (may_move && result->force_bound > 0.0 && result->end != DPT_IDENTIFY_END_NO_WATCHDOG)
        printf("  pushed by at most %.3g N; it moved by up to %.1f mm, %.3f m/s\n", result->force_bound,
               1e3 * result->displacement_max, result->speed_max);
    else
        puts(!(result->force_bound > 0.0) ? "  it gives no force: it was not pushed"
             : may_move                   ? "  it was not pushed"
                                          : "  not pushed: --move allows it");
}

static void print_json_array(const char *name, const double *values, int count)
{
    printf(",\"%s\":[", name);
    for (int i = 0; i < count; i++)
        printf("%s%.9g", i ? "," : "", values[i]);
    putchar(']');
}

static void print_json(const dpt_identify_result *result)
{
    struct row rows[ROWS];
    fill_rows(result, rows);
    printf("{\"end\":\"%s\",\"held\":%d,\"stuck\":%d,\"turn_stuck\":%d,\"rate\":%.9g,"
           "\"jitter\":%.9g,\"jitter_max\":%.9g,\"samples\":%" PRIu64 ",\"lost\":%" PRIu64 ",\"late\":%" PRIu64
           ",\"doubled\":%" PRIu64,
           dpt_identify_end_text(result->end), (result->flags & DPT_IDENTIFY_FLAG_HELD) != 0,
           (result->flags & DPT_IDENTIFY_FLAG_STUCK) != 0, (result->flags & DPT_IDENTIFY_FLAG_TURN_STUCK) != 0,
           result->rate, result->jitter, result->jitter_max, result->samples, result->lost, result->late,
           result->doubled);
    for (int i = 0; i < ROWS; i++) {
        if (!(result->measured & rows[i].bit))
            continue;
        printf(",\"%s\":%.9g", rows[i].name, rows[i].value.value);
        if (i < INTERVALS)
            printf(",\"%s_low\":%.9g,\"%s_high\":%.9g", rows[i].name, rows[i].value.low, rows[i].name,
                   rows[i].value.high);
    }
    if (result->measured & DPT_IDENTIFIED_MASS) {
        print_json_array("mass_matrix", result->mass_matrix, 9);
        print_json_array("damping_matrix", result->damping_matrix, 9);
        printf(",\"stiffness\":%.9g", result->stiffness);
    }
    if (result->measured & DPT_IDENTIFIED_INERTIA) {
        print_json_array("inertia_matrix", result->inertia_matrix, 9);
        print_json_array("spin_damping_matrix", result->spin_damping_matrix, 9);
        printf(",\"turn_stiffness\":%.9g", result->turn_stiffness);
    }
    print_json_array("position", result->pose.position, 3);
    printf(",\"force_bound\":%.9g,\"speed_max\":%.9g,\"displacement_max\":%.9g}\n", result->force_bound,
           result->speed_max, result->displacement_max);
}

/* ---- the file ---- */

static int write_file(const char *path, const char *name, const dpt_device_info *info,
                      const dpt_identify_result *result)
{
    struct output output;
    struct row rows[ROWS];
    const double *p = result->pose.position, *q = result->pose.orientation;
    if (output_open(&output, "device", path))
        return 2;
    fill_rows(result, rows);
    fputs("# Device dynamics, as dynpoint device identify measured them. NAME_low and NAME_high: "
          "95 % interval\n# device: ",
          output.file);
    for (; *name; name++)
        fputc((unsigned char)*name < ' ' ? '?' : *name, output.file);
    fprintf(output.file, "\n# kind: %s%s%s\n# at: %.5f %.5f %.5f m, turned %.5f %.5f %.5f %.5f\n", info->name,
            info->serial[0] ? ", " : "", info->serial, p[0], p[1], p[2], q[0], q[1], q[2], q[3]);
    for (int i = 0; i < ROWS; i++) {
        if (!(result->measured & rows[i].bit))
            continue;
        fprintf(output.file, "# %s\n%s=%.9g\n", rows[i].unit, rows[i].name, rows[i].value.value);
        if (i < INTERVALS)
            fprintf(output.file, "%s_low=%.9g\n%s_high=%.9g\n", rows[i].name, rows[i].value.low, rows[i].name,
                    rows[i].value.high);
    }
    return output_close(&output, "device");
}

/* What helps where samples or commands did not come in time. */
static const char *cure_of_lateness(const dpt_device_info *info)
{
    const uint32_t by_clock = DPT_DEVICE_FLAG_SIMULATED | DPT_DEVICE_FLAG_DETERMINISTIC;
    return (info->flags & by_clock) == DPT_DEVICE_FLAG_SIMULATED
               ? "this machine was busy: measure again, or leave live=1 out of a simulated device's name"
               : "this machine was busy, or the line loses them: measure again with less beside it, and with real-time "
                 "priority";
}

/* Say what is wrong. Returns the exit status. */
static int judge(const dpt_identify_result *result, const dpt_device_info *info)
{
    if (result->end == DPT_IDENTIFY_END_SAMPLES)
        complain("device",
                 "ended before its time, as more than 4 in a row of %" PRIu64 " samples or commands were lost or "
                 "late; %s",
                 result->samples, cure_of_lateness(info));
    else if (result->end != DPT_IDENTIFY_END_COMPLETE)
        complain("device", "ended before its time: %s", dpt_identify_end_text(result->end));
    else if (result->flags & DPT_IDENTIFY_FLAG_STUCK)
        complain("device", "%.3g N do not move it along each axis: it is locked, held, or has more friction than that",
                 result->force_bound);
    else if (result->flags & DPT_IDENTIFY_FLAG_TURN_STUCK)
        complain("device", "%.3g Nm do not turn it about each axis: it is locked, held, or has more friction than that",
                 result->torque_bound);
    else if (result->flags & DPT_IDENTIFY_FLAG_HELD)
        complain("device", "a hand holds it, a spring, or its weight: these are values of the "
                           "device and of what holds it. Let go, and measure again");
    else
        return 0;
    return 1;
}

int device_identify(const struct identify_request *request)
{
    dpt_device *device;
    dpt_device_info info = { .size = sizeof info };
    dpt_identify_def def;
    dpt_identify_result measured = { .size = sizeof measured };
    struct keyboard keyboard;
    if (request->output && (output_check_name("device", request->output, ".txt", "text, a setting a line") ||
                            device_output_check("device", request->output, request->name)))
        return 2;
    if (open_device("device", request->name, &device))
        return 2;
    end_fault("device", request->name, device);
    dpt_device_get_info(device, &info);
    dpt_identify_def_init(&def);
    def.may_move = request->may_move != 0;
    def.button = request->button;
    def.report = must_stop;
    def.user = &keyboard;
    stop_watch(NULL, HUGE_VAL);
    if (def.may_move && !(info.flags & DPT_DEVICE_FLAG_SIMULATED))
        complain("device", "let go of the device; any key ends the pushes");
    keyboard_open(&keyboard);
    const dpt_result result = dpt_device_identify(device, &def, &measured);
    keyboard_close(&keyboard);
    dpt_device_close(device);
    if (result != DPT_OK)
        return complain("device", "%s: %s", request->name, dpt_result_text(result));
    if (request->json)
        print_json(&measured);
    else
        print_text(&info, &measured, request->may_move);
    int status = judge(&measured, &info);
    if (request->output && status == 0)
        status = write_file(request->output, request->name, &info, &measured);
    else if (request->output)
        complain("device", "%s is not written", request->output);
    return status;
}
