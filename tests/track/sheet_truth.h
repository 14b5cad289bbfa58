/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The oracle of the sweep: what a tool met between two ticks, from the triangles alone. The motion is as tool.h states
 * it; it is halved until nothing between two times can be a touch. Of the library it uses the distance of one segment
 * and one triangle. A touch that comes within 1e-7 of the diagonal and goes no farther is TRUTH_NEAR: that it cannot
 * judge.
 */
#ifndef DPT_TESTS_SHEET_TRUTH_H
#define DPT_TESTS_SHEET_TRUTH_H

#include "lib/fixture.h"
#include "lib/rig.h"

#define COUNT(array) (sizeof(array) / sizeof((array)[0]))

/* a + t v */
static inline void add_scaled(double out[3], const double a[3], double t, const double v[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = a[k] + t * v[k];
}

/* To length 1; of no length: z. */
static inline void unit_or_z(double v[3])
{
    double size = length3(v);
    for (int k = 0; k < 3; k++)
        v[k] = size > 0.0 ? v[k] / size : k == 2;
}

/* Straight in position, the shorter turn in orientation, at even speed. */
dpt_pose pose_between(const dpt_pose *from, const dpt_pose *to, double t);

/* A tool of one segment and a body, at one tick. */
struct state {
    int free;         /* the ends are in the world, and the tool's pose does not count */
    double end[2][3]; /* else in the tool's frame */
    double radius;
    dpt_pose tool, body;
};

/* In the body's frame. */
struct ends3 {
    double end[2][3];
};

/* The distance of the axis to a triangle; s and q as of dpt_segment_triangle. */
static inline double to_triangle(const struct ends3 *axis, const double corners[9], double *s, double q[3])
{
    double six[6];
    memcpy(six, axis->end, sizeof six);
    return dpt_segment_triangle(six, corners, s, NULL, q);
}

/* The tool's ends in the body's frame at the time t of the motion, 0 to 1. */
struct ends3 ends_between(const struct state *from, const struct state *to, double t);

/* No point of the axis is faster than that, per tick and in the body's frame. */
double most_speed(const struct state *from, const struct state *to);

/* A mesh as the truth sees it: triangles that count, in the order of their numbers. */
struct sheet {
    const char *name;
    struct fixture fixture;
    uint32_t count;
    double *corners; /* 9 each */
    double *balls;   /* about each: centre and radius */
    uint32_t *numbers;
    uint32_t *near;   /* room for lists */
    int search_steps; /* that the truth may take */
    double diagonal;
    double unit;    /* what one metre is worth in a scene of 0.3 m */
    double *border; /* edges of one triangle, 9 each: two corners and the second again */
    uint32_t borders;
    unsigned char *edgy; /* of a triangle: a corner of it is on the border */
    double flat;         /* half the side of a flat square in z = 0; 0 for others */
    dpt_mesh_info info;
};

/* Fill in the rest of a sheet whose fixture is open; 0 without memory or triangles. */
int sheet_of(struct sheet *sheet, const char *name);

/* 0 where the file does not compile. */
int sheet_from_file(struct sheet *sheet, const char *path, const char *name);

void sheet_free(struct sheet *sheet);

static inline double border_distance(const struct sheet *sheet, const struct ends3 *axis)
{
    double least = HUGE_VAL;
    for (uint32_t i = 0; i < sheet->borders; i++)
        least = fmin(least, to_triangle(axis, sheet->border + 9 * (size_t)i, NULL, NULL));
    return least;
}

/* The triangles that may be within `reach` of the axis, into sheet->near. */
uint32_t near_axis(const struct sheet *sheet, const struct ends3 *axis, double reach);

/* The nearest triangle of some, and where on the axis. */
struct close {
    double distance, s;
    uint32_t triangle; /* its place in the arrays */
};

struct close closest(const struct sheet *sheet, const uint32_t *list, uint32_t count, const struct ends3 *axis);

/* Of all triangles. */
struct close closest_of_all(const struct sheet *sheet, const struct ends3 *axis);

/* Nothing came within the radius; something came as near as rounding; something did; the steps ended. */
enum { TRUTH_CLEAR, TRUTH_NEAR, TRUTH_MET, TRUTH_UNDECIDED };

/* What happened first in a motion. */
struct truth {
    int met;      /* TRUTH_... */
    double clear; /* nothing is within the radius before that time */
    double by;    /* MET: something is by that time */
    double s;     /* of the axis, about where */
    int sure;     /* so is the touch: clear, s and triangle are of it */
    uint32_t triangle;
};

static inline void axis_point(double out[3], const struct ends3 *axis, double s)
{
    for (int k = 0; k < 3; k++)
        out[k] = (1.0 - s) * axis->end[0][k] + s * axis->end[1][k];
}

/* When is something first within `radius` of the axis? */
struct truth truth_of(const struct sheet *sheet, const struct state *from, const struct state *to, double radius);

#endif
