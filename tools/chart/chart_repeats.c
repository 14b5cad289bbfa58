/* SPDX-License-Identifier: BSD-3-Clause */
#include "chart/chart_repeats.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "run/replay_report.h"

/* The numbers of a spread. */
static const size_t numbers[] = { offsetof(struct judgement_spread, median), offsetof(struct judgement_spread, p99),
                                  offsetof(struct judgement_spread, p999), offsetof(struct judgement_spread, max) };

static struct judgement_spread *time_of(struct judgement *judged, enum chart_time time)
{
    struct judgement_spread *const times[CHART_TIMES] = { &judged->ns, &judged->crossing_ns, &judged->other_ns,
                                                          &judged->whole_ns };
    return times[time];
}

static double *number_of(struct judgement_spread *spread, size_t number)
{
    return (double *)(void *)((char *)spread + numbers[number]);
}

static double middle(double *values, uint32_t count)
{
    sort_numbers(values, count);
    return percentile(values, count, 0.5);
}

/* NULL if it is not there. */
static struct chart_row *find(struct chart_rows *rows, const struct chart_row *like)
{
    for (int i = 0; i < rows->count; i++)
        if (rows->row[i].part == like->part && !strcmp(rows->row[i].name, like->name))
            return &rows->row[i];
    return NULL;
}

/* `row` has what is the same in all. */
static void join_row(struct chart_row *row, struct chart_row *const *again, uint32_t count)
{
    double values[CHART_REPEATS_MAX];
    for (int time = 0; time < CHART_TIMES; time++)
        for (size_t n = 0; n < sizeof numbers / sizeof *numbers; n++) {
            for (uint32_t i = 0; i < count; i++)
                values[i] = *number_of(time_of(&again[i]->judged, (enum chart_time)time), n);
            *number_of(time_of(&row->judged, (enum chart_time)time), n) = middle(values, count);
            *number_of(&row->least[time], n) = values[0];
            *number_of(&row->most[time], n) = values[count - 1];
        }
    for (uint32_t i = 0; i < count; i++) {
        values[i] = again[i]->judged.first_ns;
        if (again[i]->judged.ns.median == row->judged.ns.median)
            memcpy(row->judged.histogram, again[i]->judged.histogram, sizeof row->judged.histogram);
    }
    row->judged.first_ns = middle(values, count);
}

void chart_repeats_join(struct chart_rows *repeats, uint32_t count)
{
    int kept = 0;
    for (int i = 0; i < repeats->count; i++) {
        struct chart_row row = repeats->row[i], *again[CHART_REPEATS_MAX] = { &repeats->row[i] };
        uint32_t found = 1;
        while (found < count && (again[found] = find(&repeats[found], &row)))
            found++;
        if (found < count)
            continue;
        join_row(&row, again, count);
        repeats->row[kept++] = row;
    }
    repeats->count = kept;
}

/* Largest by least of one number in each row that has it, sorted. */
static int ratios(const struct chart_rows *rows, size_t number, double values[CHART_ROWS_MAX])
{
    int count = 0;
    for (int i = 0; i < rows->count; i++) {
        struct judgement_spread least = rows->row[i].least[CHART_WHOLE], most = rows->row[i].most[CHART_WHOLE];
        if (*number_of(&least, number) > 0.0)
            values[count++] = *number_of(&most, number) / *number_of(&least, number);
    }
    sort_numbers(values, (size_t)count);
    return count;
}

struct chart_apart chart_repeats_apart(const struct chart_rows *rows)
{
    double values[CHART_ROWS_MAX];
    struct chart_apart apart;
    size_t count = (size_t)ratios(rows, 0, values);
    apart.median_middle = fmax(1.0, percentile(values, count, 0.5));
    apart.median_most = fmax(1.0, percentile(values, count, 1.0));
    count = (size_t)ratios(rows, 1, values);
    apart.p99_middle = fmax(1.0, percentile(values, count, 0.5));
    apart.p99_most = fmax(1.0, percentile(values, count, 1.0));
    return apart;
}
