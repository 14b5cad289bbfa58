/* SPDX-License-Identifier: BSD-3-Clause */
#include "plot/run_curves.h"

#include <inttypes.h>
#include <math.h>

#include "cli/command_options.h"
#include "dynpoint/device.h"
#include "record/recording_file.h"

/* Beyond it the ticks of a millisecond are no longer told apart well, s. */
static const double TIME_MAX = 1e12;

double run_curves_length(const double v[3])
{
    const double max = fmax(fmax(fabs(v[0]), fabs(v[1])), fabs(v[2]));
    if (max == 0.0 || isnan(v[0] + v[1] + v[2]))
        return v[0] + v[1] + v[2];
    const double x = v[0] / max, y = v[1] / max, z = v[2] / max;
    return max * sqrt(x * x + y * y + z * z);
}

static void break_all(struct run_curves *curves)
{
    for (int i = 0; i < CURVES; i++)
        plot_line_break(&curves->line[i]);
}

const char *run_curves_take(struct run_curves *curves, const struct curve_tick *tick)
{
    const int follows = curves->has_begun && tick->number == curves->number + 1;
    if (curves->has_begun && tick->time < curves->now)
        return "time goes back";
    if (!(tick->time <= TIME_MAX))
        return "the time is more than 1e12 s after the first tick";
    curves->has_begun = 1;
    curves->number = tick->number;
    curves->now = tick->time;
    if (!follows)
        break_all(curves);
    if (tick->time < curves->from || tick->time > curves->to)
        return NULL;
    if (curves->ticks++ == 0)
        curves->first = tick->time;
    else
        curves->gaps += !follows;
    curves->last = tick->time;
    for (int i = 0; i < CURVES; i++)
        plot_line_add(&curves->line[i], tick->time, tick->value[i]);
    return NULL;
}

const char *run_curves_take_record(struct run_curves *curves, const dpt_record *record)
{
    struct curve_tick tick = { .number = record->number,
                               .value = { NAN, NAN, NAN, NAN, 1e-9 * (double)record->late_ns } };
    if (!curves->has_a_device)
        curves->device = record->device;
    curves->has_a_device = 1;
    if (record->device != curves->device) {
        curves->of_others++;
        return NULL;
    }
    if (record->status == DPT_DEVICE_STATUS_LOST) { /* no sample, and so no time of one */
        curves->number = record->number;
        break_all(curves);
        return NULL;
    }
    if (!curves->has_begun)
        curves->begin_ns = record->time_ns;
    tick.time = 1e-9 * (double)(int64_t)(record->time_ns - curves->begin_ns);
    if (record->flags & DPT_RECORD_FLAG_FELT) {
        tick.value[CURVE_FORCE] = run_curves_length(record->asked.force);
        tick.value[CURVE_ENERGY] = record->energy;
        if (record->hit_flags & DPT_HIT_FLAG_GAP) {
            tick.value[CURVE_GAP] = record->gap;
            tick.value[CURVE_DEPTH] = record->gap > 0.0 ? 0.0 : -record->gap;
        }
    }
    curves->is_timed |= record->late_ns || record->took_ns;
    return run_curves_take(curves, &tick);
}

static int read_recording(struct run_curves *curves)
{
    struct recording_file recording;
    dpt_record record;
    int status = recording_open(&recording, curves->command, curves->path);
    while (status == 0) {
        const enum recording_item item = recording_next(&recording, &record);
        if (item == RECORDING_END || item == RECORDING_CUT)
            break;
        const char *wrong = item == RECORDING_RECORD ? run_curves_take_record(curves, &record) : NULL;
        if (wrong)
            status = complain(curves->command, "%s: record %" PRIu64 ": %s", curves->path, record.number, wrong);
        if (item == RECORDING_DAMAGED && curves->damages++ == 0)
            curves->first_damage = recording.byte;
        if (item == RECORDING_DAMAGED)
            curves->damaged += recording.damaged;
    }
    recording_close(&recording);
    return status;
}

static int read_csv(struct run_curves *curves)
{
    struct csv_rows rows;
    int status = csv_rows_open(&rows, curves->command, curves->path);
    if (status == 0)
        status = run_curves_read_csv(curves, &rows);
    csv_rows_close(&rows);
    return status;
}

int run_curves_read(struct run_curves *curves)
{
    for (int i = 0; i < CURVES; i++)
        if (!plot_line_init(&curves->line[i]))
            return complain(curves->command, "memory ran out");
    const int status = is_recording(curves->path) ? read_recording(curves) : read_csv(curves);
    if (status)
        return status;
    if (!curves->has_begun)
        return complain(curves->command, "%s: there are no ticks", curves->path);
    if (!curves->ticks)
        return complain(curves->command, "%s: it has no tick from %g s to %g s: it ends at %g s", curves->path,
                        curves->from, curves->to, curves->now);
    if (!curves->is_timed)
        curves->line[CURVE_LATENESS].count = 0;
    return 0;
}

void run_curves_free(struct run_curves *curves)
{
    for (int i = 0; i < CURVES; i++)
        plot_line_free(&curves->line[i]);
}
