/* SPDX-License-Identifier: BSD-3-Clause */
#include "plot/label_places.h"

#include <math.h>

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
static struct label_box box_towards(double x, double y, const double way[2], double away, double width, double height)
{
    const double middle_x = x + way[0] * (away + 0.5 * width);
    const double middle_y = y + way[1] * (away + 0.5 * height);
    return (struct label_box){ middle_x - 0.5 * width, middle_y - 0.5 * height, middle_x + 0.5 * width,
                               middle_y + 0.5 * height };
}

static double clamp(double value, double low, double high)
{
    return fmax(low, fmin(high, value));
}

int label_places_find(struct label_places *places, double x, double y, double radius, double width, double height,
                      struct label_box *box, double leader[2])
{
    const double beside = radius + 4.0, turn = 2.0 * 3.14159265358979323846 / DIRECTIONS;
    const double mark[2] = { x, y };
    for (double away = beside; away <= FARTHEST; away += AWAY_STEP)
        for (int i = 0; i < DIRECTIONS; i++) {
            /* 0, 1, -1, 2, -2, ...: to the right first. */
            const double angle = turn * (i % 2 ? (i + 1) / 2 : -(i / 2));
            const double way[2] = { cos(angle), sin(angle) };
            *box = box_towards(x, y, way, away, width, height);
            leader[0] = x;
            leader[1] = y;
            if (!is_free(places, box))
                continue;
            if (away > beside) {
                leader[0] = clamp(x, box->left, box->right);
                leader[1] = clamp(y, box->top, box->bottom);
                if (!is_free_line(places, mark, leader, radius))
                    continue;
                label_places_take_line(places, x, y, leader[0], leader[1]);
            }
            label_places_take(places, *box);
            return 1;
        }
    return 0;
}
