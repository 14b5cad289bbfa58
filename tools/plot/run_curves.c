/* SPDX-License-Identifier: BSD-3-Clause */
#include "plot/run_curves.h"

#include <inttypes.h>
#include <math.h>
#include <stddef.h>
#include <string.h>
#include <strings.h>

#include "cli/command_options.h"
#include "dynpoint/device.h"
#include "record/recording_file.h"
#include "text/parse_number.h"

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

/* The rows of `replay -o` and of `record csv` as ticks of a run. Columns are found by their names, in any order. */

enum { COLUMNS_MAX = 16, NO_COLUMN = CSV_CELLS_MAX };

/* Of `replay -o`. */
enum { TICK, GAP, DEPTH, FX, FY, FZ, ENERGY };
static const char *const replay_names[] = { "tick", "gap", "depth", "fx", "fy", "fz", "energy", NULL };

/* Of `record csv`: whole numbers, then others. */
enum { NUMBER, TIME_NS, FLAGS, STATUS, DEVICE, HIT_FLAGS, LATE_NS, TOOK_NS, WHOLE };
enum { ASKED_FX = WHOLE, ASKED_FY, ASKED_FZ, RECORD_ENERGY, RECORD_GAP };
static const char *const record_names[] = { "number",    "time_ns", "flags",   "status",   "device",
                                            "hit_flags", "late_ns", "took_ns", "asked_fx", "asked_fy",
                                            "asked_fz",  "energy",  "gap",     NULL };
enum { REPLAY_NEEDED = TICK + 1, RECORD_NEEDED = STATUS + 1 };

/* Where the columns of one kind of file are. */
struct layout {
    const char *const *names;
    size_t at[COLUMNS_MAX]; /* or NO_COLUMN */
    size_t cells;
};

/* Returns 1, 0 if one of the first `needed` columns is not there, or -1 after a message. */
static int find_columns(const struct csv_rows *rows, const char *const *names, size_t needed, struct layout *layout)
{
    *layout = (struct layout){ .names = names, .cells = rows->cells };
    for (size_t i = 0; names[i]; i++) {
        layout->at[i] = NO_COLUMN;
        for (size_t cell = 0; cell < rows->cells; cell++) {
            if (!csv_cell_is(&rows->cell[cell], names[i]))
                continue;
            if (layout->at[i] != NO_COLUMN)
                return csv_rows_fail(rows, "there are two columns %s", names[i]);
            layout->at[i] = cell;
        }
    }
    for (size_t i = 0; i < needed; i++)
        if (layout->at[i] == NO_COLUMN)
            return 0;
    return 1;
}

static int fail_cell(const struct csv_rows *rows, const char *name, const struct csv_cell *cell, const char *what)
{
    char text[32];
    size_t length = (size_t)(cell->end - cell->begin);
    if (length > sizeof text - 1)
        length = sizeof text - 1;
    for (size_t i = 0; i < length; i++)
        text[i] = cell->begin[i] >= 0x20 && cell->begin[i] < 0x7f ? cell->begin[i] : '?';
    text[length] = '\0';
    return csv_rows_fail(rows, "%s: '%s' is not %s", name, text, what);
}

/* What C prints for a number that is not finite. */
static int is_not_finite(const struct csv_cell *cell)
{
    static const char *const words[] = { "nan", "inf", "infinity", NULL };
    const char *at = cell->begin + (cell->begin < cell->end && strchr("+-", *cell->begin));
    for (int i = 0; words[i]; i++)
        if ((size_t)(cell->end - at) == strlen(words[i]) && !strncasecmp(at, words[i], strlen(words[i])))
            return 1;
    return 0;
}

/* An empty cell, a column that is not there, and what is not finite are NaN. Returns 1, or -1 after a message. */
static int read_number(const struct csv_rows *rows, const struct layout *layout, size_t column, double *value)
{
    *value = NAN;
    if (layout->at[column] == NO_COLUMN)
        return 1;
    const struct csv_cell *cell = &rows->cell[layout->at[column]];
    if (cell->begin == cell->end || parse_double(cell->begin, cell->end, value) == cell->end)
        return 1;
    *value = NAN;
    return is_not_finite(cell) ? 1 : fail_cell(rows, layout->names[column], cell, "a number");
}

/* A column that is not there is 0. */
static int read_whole(const struct csv_rows *rows, const struct layout *layout, size_t column, int64_t *value)
{
    *value = 0;
    if (layout->at[column] == NO_COLUMN)
        return 1;
    const struct csv_cell *cell = &rows->cell[layout->at[column]];
    if (parse_int(cell->begin, cell->end, value) == cell->end)
        return 1;
    return fail_cell(rows, layout->names[column], cell, "a whole number");
}

/* A row of `replay -o`. Returns 1, or -1 after a message. */
static int take_replayed(struct run_curves *curves, const struct csv_rows *rows, const struct layout *layout)
{
    int64_t number;
    double value[COLUMNS_MAX];
    if (read_whole(rows, layout, TICK, &number) < 0)
        return -1;
    for (size_t i = GAP; i <= ENERGY; i++)
        if (read_number(rows, layout, i, &value[i]) < 0)
            return -1;
    if (curves->has_begun && number <= (int64_t)curves->number)
        return csv_rows_fail(rows, "the tick does not increase");
    if (!curves->has_begun)
        curves->begin_ns = (uint64_t)number;
    const struct curve_tick tick = { .number = (uint64_t)number,
                                     .time = (double)((uint64_t)number - curves->begin_ns) * curves->tick,
                                     .value = { run_curves_length(&value[FX]), value[DEPTH], value[GAP], value[ENERGY],
                                                NAN } };
    const char *wrong = run_curves_take(curves, &tick);
    return wrong ? csv_rows_fail(rows, "%s", wrong) : 1;
}

/* A row of `record csv`. Returns 1, or -1 after a message. */
static int take_recorded(struct run_curves *curves, const struct csv_rows *rows, const struct layout *layout)
{
    int64_t whole[WHOLE];
    dpt_record record = { .size = sizeof record };
    double *const numbers[] = { &record.asked.force[0], &record.asked.force[1], &record.asked.force[2], &record.energy,
                                &record.gap };
    for (size_t i = 0; i < WHOLE; i++) {
        if (read_whole(rows, layout, i, &whole[i]) < 0)
            return -1;
        if (whole[i] < 0)
            return csv_rows_fail(rows, "%s is below 0", layout->names[i]);
    }
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
        if (read_number(rows, layout, WHOLE + i, numbers[i]) < 0)
            return -1;
    record.number = (uint64_t)whole[NUMBER];
    record.time_ns = (uint64_t)whole[TIME_NS];
    record.flags = (uint32_t)whole[FLAGS];
    record.status = (uint32_t)whole[STATUS];
    record.device = (uint32_t)whole[DEVICE];
    record.hit_flags = (uint32_t)whole[HIT_FLAGS];
    record.late_ns = (uint64_t)whole[LATE_NS];
    /* Without a lateness there is none to be drawn. */
    record.took_ns = layout->at[LATE_NS] == NO_COLUMN ? 0 : (uint64_t)whole[TOOK_NS];
    const char *wrong = run_curves_take_record(curves, &record);
    return wrong ? csv_rows_fail(rows, "%s", wrong) : 1;
}

int run_curves_read_csv(struct run_curves *curves, struct csv_rows *rows)
{
    struct layout layout;
    int is_record = 0;
    int found = csv_rows_next(rows);
    if (found > 0) {
        found = find_columns(rows, replay_names, REPLAY_NEEDED, &layout);
        if (found == 0) {
            is_record = 1;
            found = find_columns(rows, record_names, RECORD_NEEDED, &layout);
        }
        if (found == 0)
            found = csv_rows_fail(rows, "neither a column tick, as of replay -o, nor number, "
                                        "time_ns, flags and status, as of record csv");
    }
    while (found > 0 && (found = csv_rows_next(rows)) > 0) {
        if (rows->cells != layout.cells)
            found = csv_rows_fail(rows, "there are %zu cells, and the header has %zu", rows->cells, layout.cells);
        else
            found = (is_record ? take_recorded : take_replayed)(curves, rows, &layout);
    }
    return found < 0 ? 2 : 0;
}
