/* SPDX-License-Identifier: BSD-3-Clause */
/* dynpoint plot: force, depth, gap, energy and lateness of one or two runs against time. */
#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "cli/command_options.h"
#include "cli/commands.h"
#include "cli/json_text.h"
#include "plot/plot_axis.h"
#include "plot/plot_chart.h"
#include "plot/run_curves.h"

static const char help[] =
    "usage: dynpoint plot RUN [SECOND] -o FILE.svg [options]\n"
    "\n"
    "Draws force, depth, gap, energy and lateness against time, of one run or of two. A run is\n"
    "what dynpoint replay -o or record csv wrote (- is standard input), or a recording. Two are\n"
    "drawn one over the other, in what both have (docs/plot.md).\n"
    "\n"
    "  -o FILE.svg   - is standard output\n"
    "  --from S      leave out what is earlier, s from the run's first tick on\n"
    "  --to S        leave out what is later\n"
    "  --title TEXT  above the picture; the names of the runs if not given\n"
    "  --dt S        length of a tick of replay -o, which has no times; default 0.001\n"
    "  --json        lowest and highest of what was drawn, as one JSON object on standard output\n"
    "\n"
    "Exit status 1: a recording is damaged, and what could be read was drawn.\n";

enum { RUNS_MAX = PLOT_SERIES_MAX, DETAIL_ROOM = 64, MISSING_ROOM = 256, DESCRIPTION_ROOM = 4096 };

static const struct {
    const char *name, *unit;
    double min; /* length of the axis if all is 0 */
} curves_of[CURVES] = { { "Force", "N", 1.0 },
                        { "Depth", "m", 1e-3 },
                        { "Gap", "m", 1e-3 },
                        { "Energy", "J", 1e-3 },
                        { "Lateness", "s", 1e-6 } };

struct plot {
    struct run_curves run[RUNS_MAX];
    int runs;
    const char *title; /* or NULL */
    char detail[RUNS_MAX][DETAIL_ROOM];
    char own_title[DESCRIPTION_ROOM], description[DESCRIPTION_ROOM];
    struct plot_chart chart;
};

/* Append to the text, as far as there is room. */
#ifdef __GNUC__
__attribute__((format(printf, 3, 4)))
#endif
static void
append(char *text, size_t room, const char *format, ...)
{
    const size_t length = strlen(text);
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text + length, room - length, format, arguments);
    va_end(arguments);
}

static const char *file_name(const struct run_curves *run)
{
    const char *slash = strrchr(run->path, '/');
    return strcmp(run->path, "-") == 0 ? "standard input" : slash && slash[1] ? slash + 1 : run->path;
}

static int is_zero(const struct plot *plot, int curve)
{
    for (int i = 0; i < plot->runs; i++) {
        const struct plot_line *line = &plot->run[i].line[curve];
        if (line->count && plot_line_extremes(line).high.y > 0.0)
            return 0;
    }
    return 1;
}

/* A run alone without a lateness was replayed, or its device has a time of its own. No depth: the gap tells the same. */
static int is_told(const struct plot *plot, int curve, int count)
{
    return (curve != CURVE_LATENESS || count) && (curve != CURVE_DEPTH || !is_zero(plot, curve));
}

/* Add the panels of the curves that all runs have, and say what is left out. */
static void choose_panels(struct plot *plot)
{
    struct plot_chart *chart = &plot->chart;
    char missing[MISSING_ROOM] = "";
    for (int curve = 0; curve < CURVES; curve++) {
        struct plot_panel panel = { .name = curves_of[curve].name,
                                    .unit = curves_of[curve].unit,
                                    .high_min = curves_of[curve].min };
        const char *without = NULL;
        int count = 0;
        for (int i = 0; i < plot->runs; i++) {
            panel.line[i] = &plot->run[i].line[curve];
            if (panel.line[i]->count)
                count++;
            else
                without = plot->run[i].path;
        }
        if (!is_told(plot, curve, count))
            continue;
        if (count == plot->runs)
            chart->panel[chart->panel_count++] = panel;
        else
            append(missing, sizeof missing, "%s%s (%s%s)", *missing ? ", " : "", panel.name,
                   count ? "none in " : "no numbers", count ? without : "");
    }
    if (chart->panel_count && *missing)
        complain("plot", "not drawn: %s", missing);
}

/* What a legend says behind the name of a run. */
static void describe_run(const struct run_curves *run, char *text, size_t room)
{
    append(text, room, "%" PRIu64 " %s", run->ticks, run->ticks == 1 ? "tick" : "ticks");
    if (run->gaps)
        append(text, room, ", %" PRIu64 " %s", run->gaps, run->gaps == 1 ? "gap" : "gaps");
    if (run->damages)
        append(text, room, ", damaged");
}

static void describe_line(struct plot *plot, const struct plot_panel *panel, int series)
{
    const struct plot_group all = plot_line_extremes(panel->line[series]);
    char low[PLOT_NUMBER_ROOM], high[PLOT_NUMBER_ROOM];
    plot_quantity(all.low.y, 6, panel->unit, low);
    plot_quantity(all.high.y, 6, panel->unit, high);
    append(plot->description, sizeof plot->description, " %s of %s: lowest %s at %.6g s, highest %s at %.6g s.",
           panel->name, file_name(&plot->run[series]), low, all.low.x, high, all.high.x);
}

static void fill_chart(struct plot *plot)
{
    struct plot_chart *chart = &plot->chart;
    const int is_named_by_title = plot->runs == 1 && !plot->title;
    chart->series_count = plot->runs;
    chart->x_name = "Time";
    chart->x_unit = "s";
    chart->x_low = plot->run[0].first;
    chart->x_high = plot->run[0].last;
    for (int i = 0; i < plot->runs; i++) {
        const char *name = file_name(&plot->run[i]);
        append(plot->detail[i], DETAIL_ROOM, is_named_by_title ? "" : ": ");
        describe_run(&plot->run[i], plot->detail[i], DETAIL_ROOM);
        chart->series[i] = (struct plot_series){ is_named_by_title ? "" : name, plot->detail[i] };
        chart->x_low = fmin(chart->x_low, plot->run[i].first);
        chart->x_high = fmax(chart->x_high, plot->run[i].last);
        append(plot->own_title, sizeof plot->own_title, "%s%s", i ? " and " : "", name);
    }
    chart->title = plot->title ? plot->title : plot->own_title;
    append(plot->description, sizeof plot->description, "Lines against time, from %.6g s to %.6g s.", chart->x_low,
           chart->x_high);
    for (int i = 0; i < chart->panel_count; i++)
        for (int series = 0; series < chart->series_count; series++)
            describe_line(plot, &chart->panel[i], series);
    chart->description = plot->description;
}

static void print_json(const struct plot *plot)
{
    const struct plot_chart *chart = &plot->chart;
    printf("{\"from\":%.17g,\"to\":%.17g,\"runs\":[", chart->x_low, chart->x_high);
    for (int i = 0; i < plot->runs; i++) {
        const struct run_curves *run = &plot->run[i];
        fputs(i ? ",{\"path\":" : "{\"path\":", stdout);
        json_write_text(stdout, run->path);
        printf(",\"ticks\":%" PRIu64 ",\"gaps\":%" PRIu64 ",\"damaged_bytes\":%" PRIu64, run->ticks, run->gaps,
               run->damaged);
        fputs(",\"curves\":[", stdout);
        for (int k = 0; k < chart->panel_count; k++) {
            const struct plot_panel *panel = &chart->panel[k];
            const struct plot_group all = plot_line_extremes(panel->line[i]);
            printf("%s{\"name\":\"%s\",\"unit\":\"%s\",\"lowest\":%.17g,\"lowest_at\":%.17g,\"highest\":%.17g,"
                   "\"highest_at\":%.17g}",
                   k ? "," : "", panel->name, panel->unit, all.low.y, all.low.x, all.high.y, all.high.x);
        }
        fputs("]}", stdout);
    }
    puts("]}");
}

/* Returns the exit status. */
static int write_chart(const struct plot *plot, const char *out, int json)
{
    struct output output;
    int status = output_open(&output, "plot", out);
    if (status)
        return status;
    plot_chart_write(output.file, &plot->chart);
    status = output_complete(&output, "plot");
    if (status)
        return status;
    if (json)
        print_json(plot);
    status = output_keep(&output, "plot");
    for (int i = 0; i < plot->runs && status < 2; i++) {
        const struct run_curves *run = &plot->run[i];
        if (!run->damages)
            continue;
        complain("plot", "%s: byte %" PRIu64 ": damaged; %" PRIu64 " bytes were left out", run->path, run->first_damage,
                 run->damaged);
        status = 1;
    }
    return status;
}

static int draw(struct plot *plot, const char *out, int json)
{
    for (int i = 0; i < plot->runs; i++) {
        const int status = run_curves_read(&plot->run[i]);
        if (status)
            return status;
        if (plot->run[i].of_others)
            complain("plot", "%s: device %" PRIu32 " is drawn; other devices have %" PRIu64 " records",
                     plot->run[i].path, plot->run[i].device, plot->run[i].of_others);
    }
    choose_panels(plot);
    if (!plot->chart.panel_count)
        return complain("plot", "%s: no numbers to draw%s", plot->run[0].path,
                        plot->runs == 1 ? "" : " that the other run has too");
    fill_chart(plot);
    return write_chart(plot, out, json);
}

/* Returns 0, or 2 after a message. */
static int check_request(const struct plot *plot, const char *out, double from, double to, double dt)
{
    if (!plot->runs || !out)
        return complain("plot", "RUN and -o FILE.svg are needed (see --help)");
    if (!(dt > 0.0 && dt <= 1e3))
        return complain("plot", "--dt must be above 0, and at most 1000");
    if (!(from >= 0.0 && from < to))
        return complain("plot", "--from must be at least 0, and below --to");
    const char *const inputs[] = { plot->run[0].path, plot->run[1].path, NULL };
    if (plot->runs == 2 && !strcmp(inputs[0], "-") && !strcmp(inputs[1], "-"))
        return complain("plot", "standard input can be one run only");
    return output_check("plot", out, inputs) || output_check_name("plot", out, ".svg", "a picture in SVG") ? 2 : 0;
}

int command_plot(int argc, char **argv)
{
    const char *operand[RUNS_MAX] = { NULL }, *out = NULL, *title = NULL;
    double from = 0.0, to = INFINITY, dt = 1e-3;
    int json = 0;
    size_t operands;
    const struct option_def options[] = { { .name = "-o", .text = &out, .kind = VALUE_FILE },
                                          { .name = "--from", .number = &from },
                                          { .name = "--to", .number = &to },
                                          { .name = "--title", .text = &title },
                                          { .name = "--dt", .number = &dt },
                                          { .name = "--json", .flag = &json } };
    static const struct operand_def taken[] = { { .kind = VALUE_FILE }, { .kind = VALUE_FILE } };
    int status = parse_options(argc, argv, COMMAND_SYNTAX(options, help, taken), operand, RUNS_MAX, &operands);
    if (status >= 0)
        return status;
    if (json && out && !strcmp(out, "-"))
        return complain("plot", "--json and -o - both want standard output");
    struct plot *plot = calloc(1, sizeof *plot);
    if (!plot)
        return complain("plot", "memory ran out");
    plot->runs = (int)operands;
    plot->title = title;
    for (int i = 0; i < plot->runs; i++)
        plot->run[i] = (struct run_curves){ .command = "plot", .path = operand[i], .tick = dt, .from = from, .to = to };
    status = check_request(plot, out, from, to, dt);
    if (status == 0)
        status = draw(plot, out, json);
    for (int i = 0; i < plot->runs; i++)
        run_curves_free(&plot->run[i]);
    free(plot);
    return status;
}
