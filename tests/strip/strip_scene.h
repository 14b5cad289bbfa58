/* SPDX-License-Identifier: BSD-3-Clause */
/* For the tests of shadows: a mesh placed in the world, questions about it, and what the oracle says. */
#ifndef DPT_TESTS_STRIP_SCENE_H
#define DPT_TESTS_STRIP_SCENE_H

#include "lib/solid.h"
#include "lib/strip_subject.h"
#include "oracle/shadow.h"

struct scene {
    const struct subject *subject;
    const dpt_pose *pose; /* NULL, or &held */
    dpt_pose held_pose;
    long double (*place)[3];     /* of a vertex, in the world */
    unsigned char *mark;         /* of a triangle */
    struct oracle_shadow shadow; /* that was asked last */
    struct oracle_sheet sheet;
};

/* A unit quaternion turns x: v + 2 w (q x v) + 2 q x (q x v). */
void turn_by(const long double q[4], const double x[3], long double out[3]);

/* NULL: where it is. */
void scene_place(struct scene *scene, const dpt_pose *pose);

void scene_open(struct scene *scene, const struct subject *subject);

static inline void scene_close(struct scene *scene)
{
    free(scene->place);
    free(scene->mark);
    free(scene->sheet.in);
    free(scene->sheet.queue);
}

/* The corners of a triangle in the world, to double. */
void scene_triangle(const struct scene *scene, uint32_t triangle, double corners[9]);

static inline void ends_of(const dpt_segment *segment, double ends[6])
{
    memcpy(ends, segment->a, sizeof segment->a);
    memcpy(ends + 3, segment->b, sizeof segment->b);
}

dpt_hit nearest_of(const struct scene *scene, const double ends[6], double radius);

void oracle_shadow_of(const struct scene *scene, const dpt_shadow *shadow, struct oracle_shadow *oracle);

/* The shadow of a tool from its nearest point on: along P to Q, where it does not cross along the triangle's normal. */
void shadow_below(const struct scene *scene, const double ends[6], double radius, dpt_shadow *shadow);

/*
 * A tool at the surface: through a point at `height` above a random point of a random triangle, lying `flat` (0: any
 * way, 1: in its plane).
 */
void tool_at(const struct scene *scene, uint64_t *seed, double length, double height, double flat, double ends[6]);

#endif
