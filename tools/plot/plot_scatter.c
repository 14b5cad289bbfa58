/* SPDX-License-Identifier: BSD-3-Clause */
#include "plot/plot_scatter.h"

#include <math.h>
#include <stdlib.h>

#include "plot/plot_axis.h"
#include "plot/svg_draw.h"

/* Pixels. */
enum {
    SUBTITLE_AT = 50,
    FIRST_PANEL = 66,
    NAME = 24,   /* a panel's name */
    LEGEND = 22, /* below it */
    PLOT = 200,  /* where errors are above 0 */
    EASY = 10,   /* so many marks there have room for their names; each more makes it higher */
    HIGHER = 8,
    LANE = 17, /* of the band */
    BAND_PAD = 8,
    X_AXIS = 42,
    BELOW = 16, /* each panel */
    KEYS = 3,   /* names of numbers in a line below the axis */
    KEY_WIDTH = 220,
    KEY_LINE = 15,
    TOP_PAD = 26, /* above the largest error, for its name */
    RADIUS = 5,
    X_ROOM = 52, /* of a mark of an axis */
    Y_ROOM = 22
};

/* Than estimated: a name that is cut off or covered is worse than a gap. */
#define WIDER 1.08

static const char *const colours[SCATTER_KINDS] = { "#0072b2", "#009e73", "#d55e00", "#e69f00", "#000000" };

/* A mark where it is drawn. */
struct placed {
    const struct scatter_mark *mark;
    double x, worse_x, y;
    double left, right; /* of its line and its bars */
    int in_band;
};

/* A panel as it is laid out. */
struct layout {
    const struct scatter_panel *panel;
    struct placed placed[SCATTER_MARKS_MAX]; /* by cost */
    struct plot_log_axis x, y;
    double top, bottom; /* of all that is plotted; the band is at its lower end */
    double band;        /* where it begins; equal to the bottom if there is none */
    int lanes;
    int key_lines; /* below its axis */
};

static int by_cost(const void *a, const void *b)
{
    const struct scatter_mark *x = ((const struct placed *)a)->mark;
    const struct scatter_mark *y = ((const struct placed *)b)->mark;
    if (x->cost != y->cost)
        return x->cost < y->cost ? -1 : 1;
    return (x > y) - (x < y);
}

static double cost_min(const struct scatter_mark *mark)
{
    return mark->cost_range[0] > 0.0 ? fmin(mark->cost, mark->cost_range[0]) : mark->cost;
}

static double cost_max(const struct scatter_mark *mark)
{
    return fmax(fmax(mark->cost, mark->worse_cost), fmax(mark->cost_range[1], mark->worse_range[1]));
}

static void lay_out(struct layout *layout, const struct scatter_panel *panel, double top)
{
    double low_x = HUGE_VAL, high_x = 0.0, low_y = HUGE_VAL, high_y = 0.0;
    *layout = (struct layout){ .panel = panel, .top = top };
    for (int i = 0; i < panel->count; i++) {
        const struct scatter_mark *mark = &panel->mark[i];
        const int in_band = panel->band && mark->error <= panel->band_max;
        layout->placed[i] = (struct placed){ .mark = mark, .in_band = in_band };
        layout->lanes += in_band;
        low_x = fmin(low_x, cost_min(mark));
        high_x = fmax(high_x, cost_max(mark));
        if (!in_band) {
            low_y = fmin(low_y, mark->error);
            high_y = fmax(high_y, mark->error);
        }
    }
    qsort(layout->placed, (size_t)panel->count, sizeof *layout->placed, by_cost);
    const int above = panel->count - layout->lanes;
    layout->key_lines = above > EASY ? 2 : 1;
    layout->band = top + (above ? PLOT + HIGHER * (above > EASY ? above - EASY : 0) : 0);
    layout->bottom = layout->band + (layout->lanes ? LANE * layout->lanes + 2 * BAND_PAD : 0);
    layout->x = plot_log_axis_make(low_x, high_x, SVG_LEFT + 12, SVG_WIDTH - SVG_RIGHT - 12, X_ROOM);
    if (high_y > 0.0)
        layout->y = plot_log_axis_make(low_y, high_y, layout->band - 12, top + TOP_PAD, Y_ROOM);
    for (int i = 0, lane = 0; i < panel->count; i++) {
        struct placed *placed = &layout->placed[i];
        placed->x = plot_log_axis_at(&layout->x, placed->mark->cost);
        placed->worse_x = plot_log_axis_at(&layout->x, fmax(placed->mark->cost, placed->mark->worse_cost));
        placed->left = plot_log_axis_at(&layout->x, cost_min(placed->mark));
        placed->right = plot_log_axis_at(&layout->x, cost_max(placed->mark));
        placed->y = placed->in_band ? layout->band + BAND_PAD + LANE * (0.5 + lane++)
                                    : plot_log_axis_at(&layout->y, placed->mark->error);
    }
}

static void write_shape(FILE *file, enum scatter_kind kind, double x, double y)
{
    const double r = RADIUS;
    fprintf(file, "<path fill=\"%s\" stroke=\"%s\" stroke-width=\"%s\" d=\"",
            kind == SCATTER_CROSS ? "none" : colours[kind], kind == SCATTER_CROSS ? "#000" : "#fff",
            kind == SCATTER_CROSS ? "2" : "0.8");
    switch (kind) {
    case SCATTER_SQUARE:
        svg_place(file, 'M', x - 0.9 * r, y - 0.9 * r);
        fputs("h9v9h-9z", file);
        break;
    case SCATTER_TRIANGLE:
        svg_place(file, 'M', x, y - 1.2 * r);
        svg_place(file, 'L', x + 1.15 * r, y + 0.8 * r);
        svg_place(file, 'L', x - 1.15 * r, y + 0.8 * r);
        fputc('z', file);
        break;
    case SCATTER_DIAMOND:
        svg_place(file, 'M', x, y - 1.3 * r);
        svg_place(file, 'L', x + 1.3 * r, y);
        svg_place(file, 'L', x, y + 1.3 * r);
        svg_place(file, 'L', x - 1.3 * r, y);
        fputc('z', file);
        break;
    case SCATTER_CROSS:
        svg_place(file, 'M', x - 0.8 * r, y - 0.8 * r);
        fputs("l8 8m0 -8l-8 8", file);
        break;
    default:
        svg_place(file, 'M', x - r, y);
        fputs("a5 5 0 1 0 10 0a5 5 0 1 0 -10 0z", file);
    }
    fputs("\"/>", file);
}

/* Of measuring again, behind the mark. */
static void write_range(FILE *file, const struct layout *layout, const struct placed *placed, const double range[2])
{
    if (!(range[0] > 0.0 && range[1] > range[0]))
        return;
    fprintf(file, "<path class=\"range\" stroke=\"%s\" stroke-width=\"8\" stroke-opacity=\"0.3\" d=\"",
            colours[placed->mark->kind]);
    svg_place(file, 'M', plot_log_axis_at(&layout->x, range[0]), placed->y);
    fputc('H', file);
    svg_pixel(file, plot_log_axis_at(&layout->x, range[1]));
    fputs("\"/>", file);
}

static void write_mark(FILE *file, const struct layout *layout, const struct placed *placed)
{
    fputs("<g class=\"mark\"><title>", file);
    svg_write(file, placed->mark->title);
    fputs("</title>", file);
    write_range(file, layout, placed, placed->mark->cost_range);
    write_range(file, layout, placed, placed->mark->worse_range);
    if (placed->worse_x > placed->x) {
        fprintf(file, "<path stroke=\"%s\" stroke-width=\"1.4\" d=\"", colours[placed->mark->kind]);
        svg_place(file, 'M', placed->x, placed->y);
        fputc('H', file);
        svg_pixel(file, placed->worse_x);
        svg_place(file, 'M', placed->worse_x, placed->y - 3.0);
        fputs("v6\"/>", file);
    }
    write_shape(file, placed->mark->kind, placed->x, placed->y);
    fputs("</g>\n", file);
}

/* The steps from place to place of the frontier. */
static void write_frontier(FILE *file, const struct layout *layout, struct label_places *places)
{
    double y = layout->top, best = HUGE_VAL;
    double x = layout->placed[0].x;
    fputs("<path class=\"frontier\" fill=\"none\" stroke=\"#999\" stroke-width=\"1.5\" d=\"", file);
    svg_place(file, 'M', x, y);
    for (int i = 0; i < layout->panel->count; i++) {
        const struct placed *placed = &layout->placed[i];
        const double error = placed->in_band ? -1.0 : placed->mark->error;
        if (!(error < best))
            continue;
        best = error;
        label_places_take_line(places, x, y, placed->x, y);
        label_places_take_line(places, placed->x, y, placed->x, placed->y);
        fputc('H', file);
        svg_pixel(file, placed->x);
        fputc('V', file);
        svg_pixel(file, placed->y);
        x = placed->x;
        y = placed->y;
    }
    fputs("\"/>\n", file);
}

static void write_axes(FILE *file, const struct layout *layout)
{
    const struct scatter_panel *panel = layout->panel;
    const double right = SVG_WIDTH - SVG_RIGHT;
    char text[PLOT_MARK_ROOM];
    if (layout->lanes) {
        fputs("<path class=\"band\" fill=\"#f0f0f0\" d=\"", file);
        svg_place(file, 'M', SVG_LEFT, layout->band);
        fputc('H', file);
        svg_pixel(file, right);
        fputc('V', file);
        svg_pixel(file, layout->bottom);
        fprintf(file, "H%dz\"/>\n", SVG_LEFT);
        svg_text_at(file, SVG_LEFT - 8, 0.5 * (layout->band + layout->bottom) + 4, SVG_LABEL_SIZE, "end", panel->band);
    }
    fputs("<path fill=\"none\" stroke=\"#ddd\" d=\"", file);
    for (double i = 0.0; (i = plot_log_axis_next(&layout->x, i)) > 0.0;) {
        svg_place(file, 'M', plot_log_axis_at(&layout->x, i), layout->top);
        fputc('V', file);
        svg_pixel(file, layout->bottom);
    }
    for (double i = 0.0; layout->y.low > 0.0 && (i = plot_log_axis_next(&layout->y, i)) > 0.0;) {
        svg_place(file, 'M', SVG_LEFT, plot_log_axis_at(&layout->y, i));
        fputc('H', file);
        svg_pixel(file, right);
    }
    fputs("\"/>\n<path fill=\"none\" stroke=\"#888\" d=\"", file);
    svg_place(file, 'M', SVG_LEFT, layout->top);
    fputc('V', file);
    svg_pixel(file, layout->bottom);
    fputc('H', file);
    svg_pixel(file, right);
    fputs("\"/>\n", file);
    for (double i = 0.0; (i = plot_log_axis_next(&layout->x, i)) > 0.0;) {
        plot_log_axis_label(i, panel->x_unit, text);
        svg_text_at(file, plot_log_axis_at(&layout->x, i), layout->bottom + 16, SVG_LABEL_SIZE, "middle", text);
    }
    for (double i = 0.0; layout->y.low > 0.0 && (i = plot_log_axis_next(&layout->y, i)) > 0.0;) {
        plot_log_axis_label(i, panel->y_unit, text);
        svg_text_at(file, SVG_LEFT - 8, plot_log_axis_at(&layout->y, i) + 4, SVG_LABEL_SIZE, "end", text);
    }
    svg_text_at(file, 0.5 * (SVG_LEFT + right), layout->bottom + 34, SVG_TEXT_SIZE, "middle", panel->x_name);
}

static void write_legend(FILE *file, const struct scatter_panel *panel, double y)
{
    double x = SVG_LEFT + RADIUS;
    for (int kind = 0; kind < SCATTER_KINDS; kind++) {
        if (!panel->kind_name[kind])
            continue;
        fputs("<g class=\"legend\">", file);
        write_shape(file, (enum scatter_kind)kind, x, y - 4.5);
        svg_text_at(file, x + RADIUS + 6, y, SVG_LABEL_SIZE, "start", panel->kind_name[kind]);
        fputs("</g>\n", file);
        x += 2 * RADIUS + 26 + svg_width(panel->kind_name[kind], SVG_LABEL_SIZE);
    }
}

static void take_mark(struct label_places *places, const struct placed *placed)
{
    const double r = RADIUS + 2.0;
    label_places_take(places, (struct label_box){ placed->x - r, placed->y - r, placed->x + r, placed->y + r });
    if (placed->right > placed->left)
        label_places_take(
            places, (struct label_box){ placed->left - 1.0, placed->y - 4.0, placed->right + 1.0, placed->y + 4.0 });
}

/* In its lane: behind the whisker, or before the mark. */
static int find_in_lane(struct label_places *places, const struct placed *placed, double width, double height,
                        struct label_box *box)
{
    const double lefts[] = { placed->right + 6.0, fmin(placed->left, placed->x - RADIUS) - 6.0 - width };
    for (int i = 0; i < 2; i++) {
        *box = (struct label_box){ lefts[i], placed->y - 0.5 * height, lefts[i] + width, placed->y + 0.5 * height };
        if (box->left < places->room.left || box->right > places->room.right)
            continue;
        label_places_take(places, *box);
        return 1;
    }
    return 0;
}

/* Text beside a mark, or at the end of a leader. Returns 0 if there is no room. */
static int write_beside(FILE *file, const struct placed *placed, struct label_places *places, const char *class,
                        const char *text)
{
    const struct label_mark mark = { .x = placed->x,
                                     .y = placed->y,
                                     .radius = RADIUS,
                                     .width = WIDER * svg_width(text, SVG_LABEL_SIZE),
                                     .height = SVG_LABEL_SIZE + 1.0 };
    struct label_box box;
    double leader[2] = { placed->x, placed->y };
    if (!(placed->in_band ? find_in_lane(places, placed, mark.width, mark.height, &box)
                          : label_places_find(places, &mark, &box, leader)))
        return 0;
    fprintf(file, "<g class=\"%s\">", class);
    if (leader[0] != placed->x || leader[1] != placed->y) {
        fputs("<path stroke=\"#777\" stroke-width=\"0.7\" d=\"", file);
        svg_place(file, 'M', placed->x, placed->y);
        svg_place(file, 'L', leader[0], leader[1]);
        fputs("\"/>", file);
    }
    svg_text_at(file, box.left, box.bottom - 3.0, SVG_LABEL_SIZE, "start", text);
    fputs("</g>\n", file);
    return 1;
}

/* Where a name has no room, a number may; what it means stands below the axis. */
static void write_number(FILE *file, const struct layout *layout, const struct placed *placed,
                         struct label_places *places, int *numbered)
{
    const int at = *numbered;
    char number[16];
    snprintf(number, sizeof number, "%d", at + 1);
    if (at == KEYS * layout->key_lines || !write_beside(file, placed, places, "number", number))
        return;
    fputs("<g class=\"key\">", file);
    svg_begin_text(file, SVG_LEFT + at % KEYS * KEY_WIDTH, layout->bottom + X_AXIS + KEY_LINE * (at / KEYS) + 10,
                   SVG_LABEL_SIZE, "start");
    fprintf(file, "%s ", number);
    svg_write(file, placed->mark->name);
    fputs("</text></g>\n", file);
    ++*numbered;
}

static void write_names(FILE *file, const struct layout *layout, struct label_places *places)
{
    int has_name[SCATTER_MARKS_MAX] = { 0 }, numbered = 0;
    for (int i = 0; i < layout->panel->count; i++) {
        const struct placed *placed = &layout->placed[i];
        has_name[i] = !placed->mark->name || write_beside(file, placed, places, "name", placed->mark->name);
    }
    for (int i = 0; i < layout->panel->count; i++)
        if (!has_name[i])
            write_number(file, layout, &layout->placed[i], places, &numbered);
}

static void write_panel(FILE *file, const struct layout *layout, double name_at)
{
    struct label_places *places = calloc(1, sizeof *places);
    const int count = layout->panel->count;
    fputs("<g class=\"panel\">\n", file);
    svg_begin_text(file, SVG_LEFT, name_at, SVG_TEXT_SIZE, "start");
    fputs("<tspan font-weight=\"bold\">", file);
    svg_write(file, layout->panel->name);
    fputs("</tspan> ", file);
    svg_write(file, layout->panel->y_name);
    fputs("</text>\n", file);
    write_legend(file, layout->panel, name_at + LEGEND);
    write_axes(file, layout);
    if (places) {
        places->room = (struct label_box){ SVG_LEFT + 2, layout->top, SVG_WIDTH - SVG_RIGHT, layout->band };
        for (int i = 0; i < count; i++)
            take_mark(places, &layout->placed[i]);
        write_frontier(file, layout, places);
        write_names(file, layout, places);
    }
    for (int i = 0; i < count; i++)
        write_mark(file, layout, &layout->placed[i]);
    fputs("</g>\n", file);
    free(places);
}

void plot_scatter_write(FILE *file, const struct plot_scatter *chart)
{
    struct layout *layouts = calloc(SCATTER_PANELS_MAX, sizeof *layouts);
    double at = FIRST_PANEL;
    if (!layouts)
        return;
    for (int i = 0; i < chart->panel_count; i++) {
        lay_out(&layouts[i], &chart->panel[i], at + NAME + LEGEND + 6);
        at = layouts[i].bottom + X_AXIS + KEY_LINE * layouts[i].key_lines + BELOW;
    }
    svg_begin(file, (int)at, chart->title, chart->description);
    svg_begin_text(file, SVG_LEFT, SUBTITLE_AT, SVG_LABEL_SIZE, "start");
    svg_write_cut(file, chart->subtitle, SVG_WIDTH - SVG_RIGHT - SVG_LEFT, SVG_LABEL_SIZE, 0);
    fputs("</text>\n", file);
    for (int i = 0; i < chart->panel_count; i++)
        write_panel(file, &layouts[i], layouts[i].top - LEGEND - 6 - 6);
    svg_end(file);
    free(layouts);
}

/* Pixels: boxes along a line; how far labels go, and in which steps; half of what a leader is wide; marks side by side. */
#define LINE_STEP 4.0
#define CROWD     24.0
#define FARTHEST  120.0
#define AWAY_STEP 7.0
#define THIN      1.0

enum { DIRECTIONS = 24 };

static int overlaps(const struct label_box *a, const struct label_box *b)
{
    return a->left < b->right && b->left < a->right && a->top < b->bottom && b->top < a->bottom;
}

static int is_within(const struct label_box *box, const struct label_box *room)
{
    return box->left >= room->left && box->right <= room->right && box->top >= room->top && box->bottom <= room->bottom;
}

static int is_free(const struct label_places *places, const struct label_box *box)
{
    for (int i = 0; i < places->count; i++)
        if (overlaps(&places->taken[i], box))
            return 0;
    return is_within(box, &places->room);
}

void label_places_take(struct label_places *places, struct label_box box)
{
    if (places->count < LABEL_BOXES_MAX)
        places->taken[places->count++] = box;
}

/* The box at a place of a line. */
static struct label_box box_on(const double from[2], const double to[2], double share)
{
    const double x = from[0] + share * (to[0] - from[0]);
    const double y = from[1] + share * (to[1] - from[1]);
    return (struct label_box){ x - THIN, y - THIN, x + THIN, y + THIN };
}

void label_places_take_line(struct label_places *places, double x0, double y0, double x1, double y1)
{
    const double from[2] = { x0, y0 }, to[2] = { x1, y1 };
    const double length = hypot(x1 - x0, y1 - y0);
    for (double at = 0.0; at <= length; at += LINE_STEP)
        label_places_take(places, box_on(from, to, length > 0.0 ? at / length : 0.0));
}

/* A leader begins among marks that lie close together; once it has left them it meets nothing. */
static int is_free_line(const struct label_places *places, const double from[2], const double to[2], double radius)
{
    const double length = hypot(to[0] - from[0], to[1] - from[1]);
    int is_out = 0;
    for (double at = radius; at < length; at += 0.5 * LINE_STEP) {
        const struct label_box box = box_on(from, to, at / length);
        const int is_here_free = is_free(places, &box);
        if (!is_here_free && (is_out || at > radius + CROWD))
            return 0;
        is_out |= is_here_free;
    }
    return 1;
}

/* A label in a direction from the mark, its nearest edge so far away. */
static struct label_box box_towards(const struct label_mark *mark, const double direction[2], double away)
{
    const double half[2] = { 0.5 * mark->width, 0.5 * mark->height };
    const double x = mark->x + direction[0] * (away + half[0]), y = mark->y + direction[1] * (away + half[1]);
    return (struct label_box){ x - half[0], y - half[1], x + half[0], y + half[1] };
}

static double clamp(double value, double low, double high)
{
    return fmax(low, fmin(high, value));
}

int label_places_find(struct label_places *places, const struct label_mark *mark, struct label_box *box,
                      double leader[2])
{
    const double beside = mark->radius + 4.0, turn = 2.0 * 3.14159265358979323846 / DIRECTIONS;
    const double middle[2] = { mark->x, mark->y };
    for (double away = beside; away <= FARTHEST; away += AWAY_STEP)
        for (int i = 0; i < DIRECTIONS; i++) {
            /* 0, 1, -1, 2, -2, ...: to the right first. */
            const double angle = turn * (i % 2 ? (i + 1) / 2 : -(i / 2));
            const double direction[2] = { cos(angle), sin(angle) };
            *box = box_towards(mark, direction, away);
            leader[0] = mark->x;
            leader[1] = mark->y;
            if (!is_free(places, box))
                continue;
            if (away > beside) {
                leader[0] = clamp(mark->x, box->left, box->right);
                leader[1] = clamp(mark->y, box->top, box->bottom);
                if (!is_free_line(places, middle, leader, mark->radius))
                    continue;
                label_places_take_line(places, mark->x, mark->y, leader[0], leader[1]);
            }
            label_places_take(places, *box);
            return 1;
        }
    return 0;
}
