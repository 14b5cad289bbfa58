/* SPDX-License-Identifier: BSD-3-Clause */
#include "plot/plot_chart.h"

#include <math.h>
#include <stdlib.h>

#include "plot/plot_axis.h"
#include "plot/svg_draw.h"

/* Pixels. */
enum {
    LEGEND_AT = 52, /* the first line of the legend */
    LEGEND_LINE = 20,
    SAMPLE = 30, /* of a line, in the legend */
    NAME = 24,   /* a panel's name */
    PANEL = 92,
    BELOW = 14, /* each panel */
    FOOT = 40
};
enum { X_MARKS = 9, Y_MARKS = 4 };
enum { COLUMN_POINTS = 8 }; /* a column with more of them is drawn in its middle */

/* Of the palette of Okabe and Ito: in grey, orange is light (L* 71) and blue dark (L* 46). */
static const struct {
    const char *colour;
    double width;
} styles[PLOT_SERIES_MAX] = { { "#e69f00", 4.0 }, { "#0072b2", 1.4 } };

/* A single series is drawn as the second one of two. */
static int style_of(const struct plot_chart *chart, int series)
{
    return series + PLOT_SERIES_MAX - chart->series_count;
}

/* A pen that draws one line. */
struct pen {
    FILE *file;
    const struct plot_axis *x, *y;
    int places; /* drawn in this stretch */
    double at_x, at_y;
};

/* A stretch of a single place is a dot: the ends of lines are round. */
static void end_stretch(struct pen *pen)
{
    if (pen->places == 1)
        fputs("h0", pen->file);
    pen->places = 0;
}

static void draw_to(struct pen *pen, double x, double y)
{
    if (pen->places && x == pen->at_x && y == pen->at_y)
        return;
    if (pen->places && x == pen->at_x) {
        fputc('V', pen->file);
        svg_pixel(pen->file, y);
    } else {
        svg_place(pen->file, pen->places ? 'L' : 'M', x, y);
    }
    pen->at_x = x;
    pen->at_y = y;
    pen->places++;
}

static double tenth(double pixel)
{
    return floor(pixel * 10.0 + 0.5) / 10.0;
}

/* Draw the points of one column of pixels in the order of x. */
static void draw_column(struct pen *pen, const struct plot_group *column)
{
    const int low_first = column->low.x <= column->high.x;
    const struct plot_point points[] = { column->first, low_first ? column->low : column->high,
                                         low_first ? column->high : column->low, column->last };
    const double middle = floor(plot_axis_at(pen->x, column->first.x)) + 0.5;
    if (column->is_start)
        end_stretch(pen);
    for (int i = 0; i < 4; i++) {
        const double x = column->points > COLUMN_POINTS ? middle : tenth(plot_axis_at(pen->x, points[i].x));
        draw_to(pen, x, tenth(plot_axis_at(pen->y, points[i].y)));
    }
}

static void draw_line(FILE *file, const struct plot_line *line, const struct plot_axis *x, const struct plot_axis *y)
{
    struct pen pen = { .file = file, .x = x, .y = y };
    struct plot_group column = line->groups[0];
    for (size_t i = 1; i < line->count; i++) {
        const struct plot_group *group = &line->groups[i];
        if (floor(plot_axis_at(x, group->first.x)) == floor(plot_axis_at(x, column.first.x))) {
            plot_group_join(&column, group);
            continue;
        }
        draw_column(&pen, &column);
        column = *group;
    }
    draw_column(&pen, &column);
    end_stretch(&pen);
}

static void begin_stroke(FILE *file, const struct plot_chart *chart, int series)
{
    const int style = style_of(chart, series);
    fprintf(file,
            "<path fill=\"none\" stroke-linecap=\"round\" stroke-linejoin=\"round\" stroke=\"%s\" stroke-width=\"",
            styles[style].colour);
    svg_pixel(file, styles[style].width);
    fputs("\" d=\"", file);
}

static struct plot_axis vertical_axis(const struct plot_panel *panel, int series_count, double top)
{
    double low = 0.0, high = 0.0;
    for (int i = 0; i < series_count; i++) {
        const struct plot_group all = plot_line_extremes(panel->line[i]);
        low = fmin(low, all.low.y);
        high = fmax(high, all.high.y);
    }
    if (low == 0.0 && high == 0.0)
        high = panel->high_min;
    return plot_axis_make(low, high, top + PANEL, top, Y_MARKS, 1);
}

static void write_grid(FILE *file, const struct plot_axis *x, const struct plot_axis *y, double top)
{
    fputs("<path stroke=\"#ddd\" d=\"", file);
    for (double i = x->first; i <= x->last; i++) {
        svg_place(file, 'M', plot_axis_at(x, i * x->step * x->scale), top);
        fprintf(file, "v%d", PANEL);
    }
    for (double i = y->first; i <= y->last; i++) {
        svg_place(file, 'M', SVG_LEFT, plot_axis_at(y, i * y->step * y->scale));
        fprintf(file, "H%d", SVG_WIDTH - SVG_RIGHT);
    }
    fputs("\"/>\n<path stroke=\"#888\" d=\"", file);
    svg_place(file, 'M', SVG_LEFT, plot_axis_at(y, 0.0));
    fprintf(file, "H%d\"/>\n", SVG_WIDTH - SVG_RIGHT);
}

static void write_panel(FILE *file, const struct plot_chart *chart, const struct plot_panel *panel,
                        const struct plot_axis *x, double top)
{
    const struct plot_axis y = vertical_axis(panel, chart->series_count, top);
    char label[PLOT_LABEL_ROOM];
    fputs("<g class=\"panel\">\n", file);
    svg_begin_text(file, SVG_LEFT, top - 8, SVG_TEXT_SIZE, "start");
    svg_write(file, panel->name);
    fprintf(file, ", %s%s</text>\n", y.prefix, panel->unit);
    write_grid(file, x, &y, top);
    for (double i = y.first; i <= y.last; i++) {
        plot_axis_label(&y, i, label);
        svg_text_at(file, SVG_LEFT - 8, plot_axis_at(&y, i * y.step * y.scale) + 4, SVG_LABEL_SIZE, "end", label);
    }
    for (int i = 0; i < chart->series_count; i++) {
        begin_stroke(file, chart, i);
        draw_line(file, panel->line[i], x, &y);
        fputs("\"/>\n", file);
    }
    fputs("</g>\n", file);
}

static void write_x_axis(FILE *file, const struct plot_chart *chart, const struct plot_axis *x, double bottom)
{
    char label[PLOT_LABEL_ROOM];
    fputs("<g class=\"x\">\n", file);
    for (double i = x->first; i <= x->last; i++) {
        plot_axis_label(x, i, label);
        svg_text_at(file, plot_axis_at(x, i * x->step * x->scale), bottom + 16, SVG_LABEL_SIZE, "middle", label);
    }
    svg_begin_text(file, (SVG_LEFT + SVG_WIDTH - SVG_RIGHT) / 2.0, bottom + 34, SVG_TEXT_SIZE, "middle");
    svg_write(file, chart->x_name);
    fprintf(file, ", %s%s</text>\n</g>\n", x->prefix, chart->x_unit);
}

static void write_legend(FILE *file, const struct plot_chart *chart)
{
    for (int i = 0; i < chart->series_count; i++) {
        const struct plot_series *series = &chart->series[i];
        const double at = LEGEND_AT + i * LEGEND_LINE;
        const double room = SVG_WIDTH - SVG_RIGHT - SVG_LEFT - SAMPLE - 8 - svg_width(series->detail, SVG_TEXT_SIZE);
        begin_stroke(file, chart, i);
        svg_place(file, 'M', SVG_LEFT, at - 4.5);
        fprintf(file, "h%d\"/>\n", SAMPLE);
        svg_begin_text(file, SVG_LEFT + SAMPLE + 8, at, SVG_TEXT_SIZE, "start");
        svg_write_cut(file, series->name, room, SVG_TEXT_SIZE, 1);
        svg_write(file, series->detail);
        fputs("</text>\n", file);
    }
}

void plot_chart_write(FILE *file, const struct plot_chart *chart)
{
    const int top = LEGEND_AT + (chart->series_count - 1) * LEGEND_LINE + 10;
    const int bottom = top + chart->panel_count * (NAME + PANEL + BELOW) - BELOW;
    const struct plot_axis x = plot_axis_make(chart->x_low, chart->x_high, SVG_LEFT, SVG_WIDTH - SVG_RIGHT, X_MARKS, 0);
    svg_begin(file, bottom + FOOT, chart->title, chart->description);
    write_legend(file, chart);
    for (int i = 0; i < chart->panel_count; i++)
        write_panel(file, chart, &chart->panel[i], &x, top + i * (NAME + PANEL + BELOW) + NAME);
    write_x_axis(file, chart, &x, bottom);
    svg_end(file);
}
