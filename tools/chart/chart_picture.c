/* SPDX-License-Identifier: BSD-3-Clause */
#include "chart/chart_picture.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "plot/plot_axis.h"
#include "plot/plot_scatter.h"

enum { TITLE = 256, DESCRIPTION = 4096 };

/* N: less is not felt. */
#define FELT 1e-3

/* A jump that differs by this share from that of its law alone has a name of its own. */
#define OTHER_JUMP 0.05

/* How high a row stands in a panel. */
typedef double row_error(const struct chart_row *row);

static double distance_error(const struct chart_row *row)
{
    return row->judged.distance_error;
}

static double contact_error(const struct chart_row *row)
{
    const struct judgement *judged = &row->judged;
    return 100.0 * (double)(judged->missed + judged->invented + judged->unknown) / (double)judged->ticks;
}

static double wrench_error(const struct chart_row *row)
{
    return row->judged.wrench.max;
}

static double jump(const struct chart_row *row)
{
    return row->judged.jump;
}

struct picture {
    struct plot_scatter chart;
    char titles[SCATTER_PANELS_MAX][SCATTER_MARKS_MAX][TITLE];
    char description[DESCRIPTION];
    char x_name[TITLE];
};

static enum scatter_kind kind_of(const struct chart_row *row)
{
    static const enum scatter_kind of_methods[] = { SCATTER_CIRCLE, SCATTER_SQUARE, SCATTER_TRIANGLE, SCATTER_DIAMOND };
    static const enum scatter_kind of_laws[] = { SCATTER_TRIANGLE, SCATTER_SQUARE, SCATTER_CIRCLE };
    if (row->is_peer)
        return SCATTER_CROSS;
    return row->part == CHART_FORCE && row->setting.world.method != DPT_METHOD_PAPER
               ? of_laws[row->setting.world.law]
               : of_methods[row->setting.world.method];
}

static void name_kinds(struct scatter_panel *panel, enum chart_part part)
{
    static const char *const methods[] = { "exact", "tree", "brute force", "paper", "peers" };
    static const char *const laws[] = { "proxy", "bed", "point", "paper", NULL };
    static const enum scatter_kind kinds[] = { SCATTER_CIRCLE, SCATTER_SQUARE, SCATTER_TRIANGLE, SCATTER_DIAMOND,
                                               SCATTER_CROSS };
    for (int i = 0; i < SCATTER_KINDS; i++)
        for (int k = 0; k < panel->count; k++)
            if (panel->mark[k].kind == kinds[i])
                panel->kind_name[kinds[i]] = (part == CHART_FORCE ? laws : methods)[i];
}

/* Of ns; with how far repeats lie apart, where they do. */
static void write_time(char text[TITLE / 4], double ns, double min, double max)
{
    char middle[PLOT_NUMBER_ROOM], ends[2][PLOT_NUMBER_ROOM];
    plot_quantity(ns * 1e-9, 3, "s", middle);
    plot_quantity(min * 1e-9, 3, "s", ends[0]);
    plot_quantity(max * 1e-9, 3, "s", ends[1]);
    if (max > min)
        snprintf(text, TITLE / 4, "%.12s (%.12s to %.12s)", middle, ends[0], ends[1]);
    else
        snprintf(text, TITLE / 4, "%s", middle);
}

static void add_mark(struct picture *picture, struct scatter_panel *panel, const struct chart_row *row,
                     row_error *error)
{
    char *title = picture->titles[panel - picture->chart.panel][panel->count];
    const struct judgement *judged = &row->judged;
    const struct judgement_spread *min = &row->min[CHART_WHOLE], *max = &row->max[CHART_WHOLE];
    char text[TITLE], times[2][TITLE / 4], height[PLOT_NUMBER_ROOM];
    write_time(times[0], judged->whole_ns.median, min->median, max->median);
    write_time(times[1], judged->whole_ns.p99, min->p99, max->p99);
    plot_quantity(error(row), 3, panel->y_unit, height);
    snprintf(text, sizeof text, "%s: %s, 99 %% %s; error %s", row->name, times[0], times[1],
             panel->band && error(row) <= panel->band_max ? panel->band : height);
    memcpy(title, text, sizeof text);
    panel->mark[panel->count++] = (struct scatter_mark){ .cost = fmax(1e-9 * judged->whole_ns.median, 1e-9),
                                                         .worse_cost = 1e-9 * judged->whole_ns.p99,
                                                         .cost_range = { 1e-9 * min->median, 1e-9 * max->median },
                                                         .worse_range = { 1e-9 * min->p99, 1e-9 * max->p99 },
                                                         .error = error(row),
                                                         .kind = kind_of(row),
                                                         .name = row->name,
                                                         .title = title };
}

static int has_physics(const struct chart_rows *rows)
{
    int is_soft = 0;
    for (int i = 0; i < rows->count; i++)
        is_soft |= rows->row[i].judged.soft_ns.max > 0.0;
    return is_soft;
}

/* Add the panel unless it has no rows. */
static struct scatter_panel *add_panel(struct picture *picture, const struct chart_rows *rows, enum chart_part part,
                                       const struct scatter_panel *like, row_error *error)
{
    struct scatter_panel *panel = &picture->chart.panel[picture->chart.panel_count];
    *panel = *like;
    panel->x_name = picture->x_name;
    panel->x_unit = "s";
    for (int i = 0; i < rows->count; i++) {
        const struct chart_row *row = &rows->row[i];
        if (row->part == part && row->failure == DPT_OK && !isnan(error(row)) && panel->count < SCATTER_MARKS_MAX)
            add_mark(picture, panel, row, error);
    }
    name_kinds(panel, part);
    picture->chart.panel_count += panel->count > 0;
    return panel->count ? panel : NULL;
}

/* Settings of a law that jump as the law does have no name: they stand at one height. */
static void thin_names(struct scatter_panel *panel)
{
    double first[SCATTER_KINDS] = { 0.0 };
    for (int i = 0; i < panel->count; i++) {
        struct scatter_mark *mark = &panel->mark[i];
        double *of_law = &first[mark->kind];
        if (mark->kind == SCATTER_DIAMOND)
            continue;
        if (*of_law > 0.0 && fabs(mark->error - *of_law) <= OTHER_JUMP * *of_law)
            mark->name = NULL;
        else if (!(*of_law > 0.0))
            *of_law = mark->error;
    }
}

/* A logarithmic axis has no place for a row that never feels anything. */
static void drop_zeros(struct scatter_panel *panel)
{
    int kept = 0;
    for (int i = 0; i < panel->count; i++)
        if (panel->mark[i].error > 0.0)
            panel->mark[kept++] = panel->mark[i];
    panel->count = kept;
}

static void describe(struct picture *picture)
{
    size_t length = 0;
    for (int i = 0; i < picture->chart.panel_count; i++) {
        const struct scatter_panel *panel = &picture->chart.panel[i];
        for (int k = 0; k < panel->count && length + TITLE < DESCRIPTION; k++)
            length += (size_t)snprintf(picture->description + length, DESCRIPTION - length, "%s%s: %s.",
                                       length ? " " : "", panel->name, panel->mark[k].title);
    }
    picture->chart.description = picture->description;
}

int chart_picture_write(FILE *file, const struct chart_rows *rows, uint32_t repeats, const char *title,
                        const char *subtitle)
{
    char apart[TITLE / 4] = "";
    struct picture *picture = calloc(1, sizeof *picture);
    if (!picture)
        return -1;
    picture->chart.title = title;
    picture->chart.subtitle = subtitle;
    if (repeats > 1)
        snprintf(apart, sizeof apart, ", pale: least to most of %u repeats", (unsigned)repeats);
    snprintf(picture->x_name, sizeof picture->x_name, "Time of a tick%s: median, line to the 99 %%%s",
             has_physics(rows) ? " with its physics" : "", apart);
    add_panel(picture, rows, CHART_PAIR,
              &(struct scatter_panel){ .name = "Nearest pair:",
                                       .y_name = "the largest error of the distance",
                                       .y_unit = "m",
                                       .band = "none",
                                       .band_max = rows->truth.check.tolerance },
              distance_error);
    add_panel(picture, rows, CHART_CONTACT,
              &(struct scatter_panel){ .name = "Contact:",
                                       .y_name = "ticks in which it is missed, invented or unknown",
                                       .y_unit = "%",
                                       .band = "none",
                                       .band_max = 0.0 },
              contact_error);
    add_panel(picture, rows, CHART_FORCE,
              &(struct scatter_panel){ .name = "Force:",
                                       .y_name = "the largest error beside the same law at its richest, folds apart",
                                       .y_unit = "N",
                                       .band = "< 1 mN",
                                       .band_max = FELT },
              wrench_error);
    struct scatter_panel *jumps = add_panel(
        picture, rows, CHART_FORCE,
        &(struct scatter_panel){ .name = "Force:", .y_name = "the largest jump from tick to tick", .y_unit = "N" },
        jump);
    if (jumps) {
        thin_names(jumps);
        drop_zeros(jumps);
        picture->chart.panel_count -= jumps->count == 0;
    }
    describe(picture);
    plot_scatter_write(file, &picture->chart);
    free(picture);
    return 0;
}
