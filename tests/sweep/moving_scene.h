/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Segments and triangles that both move, for the tests of the sweep: made to touch, to graze and to miss by little.
 * Lengths are in m: triangles of 1 mm to 50 mm at coordinates up to 1 m, segments of 1 mm to 0.3 m, and motions of
 * about 0.1 mm, 1 mm, 10 mm or 1 m a tick. Half of them without a radius.
 */
#ifndef DPT_TESTS_MOVING_SCENE_H
#define DPT_TESTS_MOVING_SCENE_H

#include "sweep/sweep_scene.h"

struct moving_scene {
    struct motion motion;
    vec3 corner[3], shift[3]; /* at time 0, and the change per tick */
    double radius;
};

struct moving_family {
    const char *name;
    void (*make)(uint64_t *random, int kind, struct moving_scene *scene);
    int kind;
};

enum { MOVING_ANY, MOVING_FLAT, MOVING_POINT, MOVING_NEEDLE, MOVING_TOGETHER, MOVING_EQUAL };

/*
 * Small whole numbers: touches in one point at one instant do occur. FLAT: all in one plane that moves. POINT: a
 * segment without length. NEEDLE: a triangle without area at time 0. TOGETHER: the triangle has one motion for all
 * corners. EQUAL: the segment has it too.
 */
void make_moving_lattice(uint64_t *random, int kind, struct moving_scene *scene);

/*
 * Built around a time of k / 8 at which a point of the segment lies on a corner, on an edge or in the face, without a
 * radius. MEET_TANGENT: it moves along these there, so that it may touch for one instant. All numbers are exact in
 * double. The kinds are those of make_meeting.
 */
void make_moving_instant(uint64_t *random, int kind, struct moving_scene *scene);

/*
 * Built around a time at which a point of the segment is opposite a corner, a point of an edge or of the face, with the
 * radius between them. MEET_TANGENT: they then part at no speed, and stay apart by 1e-9 to 1e-3 of the size, or are
 * that much too near. The kinds are the same.
 */
void make_moving_meeting(uint64_t *random, int kind, struct moving_scene *scene);

enum {
    TURN_CORNER, /* about a corner, or */
    TURN_EDGE,   /* an edge near the segment, while what is far from it is fast */
    INVERT,      /* a corner goes through the opposite edge */
    SHRINK,      /* to a point, or through it */
    NEEDLES,     /* slivers, down to rounding */
    IN_PLANE,    /* everything in one plane, some of it in parallel */
    SPECK,       /* a segment without length */
    TOGETHER,    /* one motion for all, or nearly */
    EDGE_ON,     /* the triangle goes by in its own plane, edge first, and a corner leaves a gap, or not */
    AWAY,        /* far from the origin, by 1000 m */
    LOOSE        /* none of these */
};
void make_moving_any(uint64_t *random, int kind, struct moving_scene *scene);

/* The largest of all coordinates, at both ends of the tick. */
double moving_extent(const struct moving_scene *scene);

/* How far apart things are. */
double moving_size(const struct moving_scene *scene);

/* As exact numbers, to paste. */
const char *moving_text(const struct moving_scene *scene);

#endif
