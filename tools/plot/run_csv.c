/* SPDX-License-Identifier: BSD-3-Clause */
/* The rows of `replay -o` and of `record csv` as ticks of a run. Columns are found by their names, in any order. */
#include <math.h>
#include <stddef.h>
#include <string.h>
#include <strings.h>

#include "plot/run_curves.h"
#include "text/parse_number.h"

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
