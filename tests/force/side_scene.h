/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Surfaces whose side needs no library: a line of knots in x and z, drawn out along y. A point is in front if a ray
 * upwards from it, in the body's frame, meets the line an even number of times. The body may be moved, and its knots may
 * be raised and lowered. Tools stay away from the ends, which are a metre off.
 */
#ifndef DPT_TESTS_SIDE_SCENE_H
#define DPT_TESTS_SIDE_SCENE_H

#include "lib/rig.h"
#include "lib/solid.h"

enum { SIDE_KNOTS = 40, SIDE_SHAPES = 7 };

struct side_scene {
    const char *name;
    struct solid solid;
    struct rig rig;
    uint64_t seed;
    uint32_t knots;
    double rest[SIDE_KNOTS][2], now[SIDE_KNOTS][2]; /* x, z, in the body's frame */
    int is_moving, is_soft;
    dpt_pose body;
    double shift[3], tilt[3], pace[3], height; /* of its motion */
    uint32_t vertices;
    float *positions;
    uint32_t *knot_of; /* of each vertex */
    unsigned long long tick;
};

/* Whether its body or its vertices move. */
int side_shape_moves(int shape);

/* One of SIDE_SHAPES, with a tool. 0 after a failed check; close it in any case. */
int side_scene_open(struct side_scene *scene, int shape, const dpt_world_def *def, const dpt_segment *segments,
                    uint32_t count, uint64_t seed);
void side_scene_close(struct side_scene *scene);

/* Move the body, or its vertices, as they move before the next step. */
void side_scene_move(struct side_scene *scene);

/* m: the height of the highest knot that is near the middle, in the body's frame. */
double side_scene_top(const struct side_scene *scene);

/* 1 if a point of the world is in front. */
int side_scene_is_front(const struct side_scene *scene, const double x[3]);

/* Judge the proxy: all of it is in front, and meets nothing. Returns 0 after a failed check. */
int side_scene_judge(struct side_scene *scene);

#endif
