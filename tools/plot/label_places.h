/* SPDX-License-Identifier: BSD-3-Clause */
/* Where the labels of a picture go, so that they cover nothing. Pixels; y grows downward. */
#ifndef DPT_TOOLS_LABEL_PLACES_H
#define DPT_TOOLS_LABEL_PLACES_H

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

/*
 * Find room for a label of this width and height near the mark at x, y, which has this radius, and take it. Beside it is
 * best, farther away is worse.
 *   leader   where a line from the mark ends at the label; equal to x, y if the label is beside it, and needs none
 *
 * Returns 0 if there is none within 120 pixels.
 */
int label_places_find(struct label_places *places, double x, double y, double radius, double width, double height,
                      struct label_box *box, double leader[2]);

#endif
