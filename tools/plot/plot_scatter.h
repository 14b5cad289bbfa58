/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A chart of speed against accuracy as an SVG: panels below each other, in each a mark for everything that was measured. A
 * mark stands at its cost, and a line leads on to its worse cost; a pale bar behind either says from where to where it was
 * when it was measured again. It stands as high as its error. Both axes are logarithmic; an error of 0, or below what can
 * be told from it, has no place there: such marks lie in a band below, each in a lane of its own, the cheapest on top.
 * Steps show the frontier: nothing is both cheaper and more accurate than what lies on it.
 *
 * Marks are told apart by shape and by the colours of Okabe and Ito, so also in grey. Each has its name beside it, at the
 * end of a thin line where there is no room, and in a <title>; names cover nothing: one for which there is no place has a
 * number there, and stands below the axis. All is on an opaque white ground.
 */
#ifndef DPT_TOOLS_PLOT_SCATTER_H
#define DPT_TOOLS_PLOT_SCATTER_H

#include <stdio.h>

enum { SCATTER_PANELS_MAX = 4, SCATTER_MARKS_MAX = 64 };

enum scatter_kind { SCATTER_CIRCLE, SCATTER_SQUARE, SCATTER_TRIANGLE, SCATTER_DIAMOND, SCATTER_CROSS, SCATTER_KINDS };

struct scatter_mark {
    double cost, worse_cost; /* above 0, in the unit of x */
    /* From the least to the largest of these when measured again; equal, or 0: no bar. */
    double cost_range[2], worse_range[2];
    double error; /* in the unit of y; at most the panel's `band_max`: it lies in the band */
    enum scatter_kind kind;
    const char *name;  /* beside it; NULL: in its title alone */
    const char *title; /* all that is to be said of it */
};

struct scatter_panel {
    const char *name;
    const char *x_name, *x_unit; /* "Time of a tick", "s"; units without prefix */
    const char *y_name, *y_unit;
    const char *band;                     /* what lies in it: "0"; NULL: there is none */
    double band_max;                      /* errors up to this lie in the band */
    const char *kind_name[SCATTER_KINDS]; /* for the legend; NULL: not there */
    struct scatter_mark mark[SCATTER_MARKS_MAX];
    int count;
};

struct plot_scatter {
    const char *title, *description, *subtitle; /* of any bytes */
    struct scatter_panel panel[SCATTER_PANELS_MAX];
    int panel_count;
};

/* 760 pixels wide. The same chart gives the same bytes. Call ferror for what failed. */
void plot_scatter_write(FILE *file, const struct plot_scatter *chart);

/* Where the labels of a picture go, so that they cover nothing. Pixels; y grows downward. */

struct label_box {
    double left, top, right, bottom;
};

enum { LABEL_BOXES_MAX = 1024 };

/* What is taken: marks, lines and labels; all labels lie within `room`. */
struct label_places {
    struct label_box room;
    struct label_box taken[LABEL_BOXES_MAX];
    int count;
};

/* Take a box; what is beyond LABEL_BOXES_MAX is not seen. A line is taken as boxes along it. */
void label_places_take(struct label_places *places, struct label_box box);
void label_places_take_line(struct label_places *places, double x0, double y0, double x1, double y1);

/* A round mark, and the size of the label that it gets; pixels. */
struct label_mark {
    double x, y, radius;
    double width, height; /* of the label */
};

/*
 * Find room for the label of a mark near it, and take it. Beside it is best, farther away is worse.
 *   leader   where a line from the mark ends at the label; equal to x, y if the label is beside it, and needs none
 *
 * Returns 0 if there is none within 120 pixels.
 */
int label_places_find(struct label_places *places, const struct label_mark *mark, struct label_box *box,
                      double leader[2]);

#endif
