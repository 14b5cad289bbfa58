/* SPDX-License-Identifier: BSD-3-Clause */
#include "chart/chart_csv.h"

#include <inttypes.h>
#include <math.h>
#include <stddef.h>
#include <string.h>

#include "cli/law_name.h"
#include "plot/plot_axis.h"
#include "run/replay_report.h"

static const char *const methods[] = { "exact", "tree", "brute", "paper" };
static const char *const parts[] = { "pair", "contact", "force" };

static const char setting_columns[] =
    "name,part,method,kernel,law,parts,contacts,budget_units,sweep_units,cache_bytes,rigid,failure";
static const char result_columns[] =
    ",ticks,exact,bounded,local,median_us,p99_us,p999_us,max_us,first_us,crossing_median_us,crossing_p99_us"
    ",other_median_us,other_p99_us,whole_median_us"
    ",whole_p99_us,median_units,p99_units,max_units,wrong,wrong_exact,missed_crossings,distance_error_m"
    ",missed,invented,unknown,wrench_median_N,wrench_p99_N,wrench_p999_N,wrench_max_N"
    ",wrench_peak_N,jump_N,calm_jump_N,folds,world_bytes,body_bytes"
    ",median_least_us,median_most_us,p99_least_us,p99_most_us"
    ",crossing_median_least_us,crossing_median_most_us,crossing_p99_least_us,crossing_p99_most_us"
    ",other_median_least_us,other_median_most_us,other_p99_least_us,other_p99_most_us"
    ",whole_median_least_us,whole_median_most_us,whole_p99_least_us,whole_p99_most_us";

/* A number, or nothing. */
static void write_number(FILE *file, int is_there, double value)
{
    if (is_there)
        fprintf(file, ",%.9g", value);
    else
        fputc(',', file);
}

static void write_spread(FILE *file, const struct judgement_spread *spread, double scale)
{
    fprintf(file, ",%.4g,%.4g,%.4g,%.4g", spread->median * scale, spread->p99 * scale, spread->p999 * scale,
            spread->max * scale);
}

/* Of the repeats' medians and 99 % in us, the least and the largest, or nothing. */
static void write_range(FILE *file, const struct judgement_spread *min, const struct judgement_spread *max)
{
    if (max->max > 0.0)
        fprintf(file, ",%.4g,%.4g,%.4g,%.4g", min->median * 1e-3, max->median * 1e-3, min->p99 * 1e-3, max->p99 * 1e-3);
    else
        fputs(",,,,", file);
}

/* Median and 99 % of times in us, or nothing where there were no such ticks. */
static void write_pair(FILE *file, const struct judgement_spread *ns)
{
    if (ns->max > 0.0)
        fprintf(file, ",%.4g,%.4g", ns->median * 1e-3, ns->p99 * 1e-3);
    else
        fputs(",,", file);
}

static void write_knobs(FILE *file, const struct chart_row *row)
{
    const dpt_world_def *world = &row->setting.world;
    const int is_force = row->part == CHART_FORCE;
    if (row->is_peer) {
        fprintf(file, "%s,%s,peer,,,,,,,,", row->name, parts[row->part]);
        return;
    }
    fprintf(file, "%s,%s,%s,%s,%s", row->name, parts[row->part], methods[world->method],
            dpt_kernel_name(world->kernel == DPT_KERNEL_AUTO ? dpt_kernel_best() : world->kernel),
            is_force ? law_name(world->law) : "");
    write_number(file, world->method == DPT_METHOD_PAPER, row->setting.parts);
    write_number(file, row->part != CHART_PAIR, world->max_contacts);
    write_number(file, world->budget != 0, world->budget);
    write_number(file, world->sweep_budget != 0, world->sweep_budget);
    write_number(file, world->method == DPT_METHOD_EXACT, (double)world->certificate_bytes);
    write_number(file, 1, row->setting.rigid ? 1.0 : 0.0);
}

static void write_row(FILE *file, const struct chart_row *row)
{
    const struct judgement *judged = &row->judged;
    const int has_contact = judged->has_contact, has_wrench = judged->has_wrench;
    write_knobs(file, row);
    if (row->failure != DPT_OK) {
        fprintf(file, ",%s", dpt_result_name(row->failure));
        for (const char *c = result_columns; *c; c++)
            if (*c == ',')
                fputc(',', file);
        fputc('\n', file);
        return;
    }
    fprintf(file, ",,%zu,%zu,%zu,%zu", judged->ticks, judged->exact, judged->bounded, judged->local);
    write_spread(file, &judged->ns, 1e-3);
    fprintf(file, ",%.4g", judged->first_ns * 1e-3);
    write_pair(file, &judged->crossing_ns);
    write_pair(file, &judged->other_ns);
    write_pair(file, &judged->whole_ns);
    write_number(file, !row->is_peer, judged->work.median);
    write_number(file, !row->is_peer, judged->work.p99);
    write_number(file, !row->is_peer, judged->work.max);
    fprintf(file, ",%zu,%zu,%zu", judged->wrong, judged->wrong_exact, judged->missed_crossings);
    write_number(file, !isnan(judged->distance_error), judged->distance_error);
    write_number(file, has_contact, (double)judged->missed);
    write_number(file, has_contact, (double)judged->invented);
    write_number(file, has_contact, (double)judged->unknown);
    write_number(file, has_wrench, judged->wrench.median);
    write_number(file, has_wrench, judged->wrench.p99);
    write_number(file, has_wrench, judged->wrench.p999);
    write_number(file, has_wrench, judged->wrench.max);
    write_number(file, has_wrench, judged->wrench_peak);
    write_number(file, has_wrench, judged->jump);
    write_number(file, has_wrench, judged->calm_jump);
    write_number(file, has_wrench, (double)judged->folds);
    write_number(file, !row->is_peer, (double)row->world_bytes);
    write_number(file, !row->is_peer, (double)row->body_bytes);
    for (int time = 0; time < CHART_TIMES; time++)
        write_range(file, &row->min[time], &row->max[time]);
    fputc('\n', file);
}

static void write_apart(FILE *file, uint32_t repeats, const struct chart_rows *rows)
{
    const struct chart_apart apart = chart_repeats_apart(rows);
    fprintf(file,
            "times are the middle of %u repeats; in the middle row the largest median is %.3g times "
            "the least, in the worst %.3g; of the 99 %% %.3g and %.3g\n",
            (unsigned)repeats, apart.median_middle, apart.median_max, apart.p99_middle, apart.p99_max);
}

static void write_head(FILE *file, const struct chart_head *head, const struct chart_rows *rows)
{
    const struct measure_machine *machine = &head->machine;
    const struct measure_check *check = &rows->truth.check;
    fprintf(file, "# dynpoint chart %s: %zu ticks", head->scene, head->ticks);
    if (head->trace)
        fprintf(file, " of %s", head->trace);
    else
        fprintf(file, " of a trace that was made, seed %" PRIu64, head->seed);
    fprintf(file, ", %.1f %% cross; times are the least of %u passes\n",
            100.0 * (double)rows->truth.crossings / (double)head->ticks, (unsigned)head->passes);
    if (head->repeats > 1) {
        fputs("# ", file);
        write_apart(file, head->repeats, rows);
    }
    fprintf(file, "# machine: %s, %s; %s; dynpoint %s, kernel %s\n", machine->processor, machine->system,
            machine->compiler, machine->version, machine->kernel);
    if (check->every)
        fprintf(file,
                "# truth: the exact method; brute force in double on one tick in %zu: %zu of %zu "
                "wrong, largest difference %.3g m, beyond %.3g m is wrong\n",
                check->every, check->wrong, check->ticks, check->error, check->tolerance);
    else
        fputs("# truth: the exact method; not held against brute force, as the tool moves triangles in each step\n",
              file);
    for (uint32_t i = 0; i < head->body_count; i++) {
        const struct chart_body *body = &head->body[i];
        fprintf(file,
                "# body %u: %u triangles, %" PRIu64
                " bytes; compiled in %.3g ms, added in %.3g us; as one whose vertices move %zu "
                "bytes more, refit and search %.3g us\n",
                (unsigned)i, (unsigned)body->triangles, body->mesh_bytes, 1e3 * body->compile, 1e6 * body->add,
                body->deform_bytes, 1e6 * body->refit);
    }
    for (int i = 0; i < rows->count; i++)
        if (rows->row[i].is_peer)
            fprintf(file, "# peer %s: takes the mesh in in %.3g ms\n", rows->row[i].name, 1e-6 * rows->row[i].build_ns);
}

void chart_csv_write(FILE *file, const struct chart_head *head, const struct chart_rows *rows)
{
    write_head(file, head, rows);
    fprintf(file, "%s%s\n", setting_columns, result_columns);
    for (int i = 0; i < rows->count; i++)
        write_row(file, &rows->row[i]);
}

static void write_histogram(FILE *file, const struct chart_row *row, enum tick_histogram_of of)
{
    double edges[TICK_HISTOGRAM_EDGES];
    const int count = tick_histogram_edges(of, edges);
    for (int i = 0; i <= count; i++) {
        const uint32_t ticks = row->judged.histogram[of].bin[i];
        if (!ticks)
            continue;
        fprintf(file, "%s,%s,%s,%.0f,", row->name, parts[row->part], tick_histogram_words[of], i ? edges[i - 1] : 0.0);
        if (i < count)
            fprintf(file, "%.0f", edges[i]);
        fprintf(file, ",%" PRIu32 "\n", ticks);
    }
}

void chart_histograms_write(FILE *file, const struct chart_rows *rows)
{
    fputs("name,part,of,from,to,ticks\n", file);
    for (int i = 0; i < rows->count; i++)
        for (int of = 0; of < TICK_HISTOGRAMS; of++)
            write_histogram(file, &rows->row[i], (enum tick_histogram_of)of);
}

/* A count or a size, or a blank. */
static void print_cell(FILE *file, int is_there, const char *format, double value)
{
    char text[32] = "";
    if (is_there)
        snprintf(text, sizeof text, format, value);
    fprintf(file, " %8s", text);
}

/* Of two digits, or a blank. What is at most `none` is rounding. */
static void print_error(FILE *file, int is_there, double value, double none)
{
    char text[PLOT_NUMBER_ROOM] = "";
    if (is_there && value > 0.0 && value <= none)
        snprintf(text, sizeof text, "none");
    else if (is_there)
        plot_number(value, 2, text);
    fprintf(file, " %8s", text);
}

void chart_table_print(FILE *file, const struct chart_head *head, const struct chart_rows *rows)
{
    fprintf(file, "  %-8s%-22s %8s %8s %8s %8s %8s %8s %8s %8s %8s %8s\n", "", "", "median", "99 % us", "worst",
            "wrong", "error mm", "missed", "invented", "unknown", "error N", "jump N");
    for (int i = 0; i < rows->count; i++) {
        const struct chart_row *row = &rows->row[i];
        const struct judgement *judged = &row->judged;
        const int is_new = i == 0 || row->part != rows->row[i - 1].part;
        fprintf(file, "  %-8s%-22s", is_new ? parts[row->part] : "", row->name);
        if (row->failure != DPT_OK) {
            fprintf(file, " %s\n", dpt_result_text(row->failure));
            continue;
        }
        fprintf(file, " %8.2f %8.2f %8.1f %8zu", 1e-3 * judged->ns.median, 1e-3 * judged->ns.p99, 1e-3 * judged->ns.max,
                judged->wrong);
        print_error(file, !isnan(judged->distance_error), 1e3 * judged->distance_error,
                    1e3 * rows->truth.check.tolerance);
        print_cell(file, judged->has_contact, "%.0f", (double)judged->missed);
        print_cell(file, judged->has_contact, "%.0f", (double)judged->invented);
        print_cell(file, judged->has_contact, "%.0f", (double)judged->unknown);
        print_error(file, judged->has_wrench, judged->wrench.max, 0.0);
        print_error(file, judged->has_wrench, judged->jump, 0.0);
        fputc('\n', file);
    }
    if (head->repeats > 1) {
        fputs("  ", file);
        write_apart(file, head->repeats, rows);
    }
}

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
            *number_of(&row->min[time], n) = values[0];
            *number_of(&row->max[time], n) = values[count - 1];
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
        struct judgement_spread min = rows->row[i].min[CHART_WHOLE], max = rows->row[i].max[CHART_WHOLE];
        if (*number_of(&min, number) > 0.0)
            values[count++] = *number_of(&max, number) / *number_of(&min, number);
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
    apart.median_max = fmax(1.0, percentile(values, count, 1.0));
    count = (size_t)ratios(rows, 1, values);
    apart.p99_middle = fmax(1.0, percentile(values, count, 0.5));
    apart.p99_max = fmax(1.0, percentile(values, count, 1.0));
    return apart;
}
