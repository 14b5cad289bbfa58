/* SPDX-License-Identifier: BSD-3-Clause */
/* Routes over a mesh, and the oracle's for the same pairs of triangles. */
#ifndef DPT_TESTS_ROUTE_WALK_H
#define DPT_TESTS_ROUTE_WALK_H

#include "dynpoint/baseline.h"
#include "lib/strip_subject.h"
#include "oracle/route.h"

/* A strip, and the oracle's room, for routes over a mesh. */
struct route_scene {
    const struct subject *subject;
    struct guarded_strip block;
    dpt_strip *strip;
    uint32_t *tau, *route, *back;
};

void route_scene_open(struct route_scene *scene, const struct subject *subject);

static inline void route_scene_close(struct route_scene *scene)
{
    guarded_strip_close(&scene->block);
    free(scene->tau);
    free(scene->route);
    free(scene->back);
}

static inline int is_there(const struct subject *subject, uint32_t triangle)
{
    return subject->surface.corner[triangle][0] != ORACLE_NONE;
}

/* The code that is due for a pair, with tau towards `to`. */
static inline dpt_result expected_result(const struct route_scene *scene, uint32_t from, uint32_t to)
{
    if (!is_there(scene->subject, from) || !is_there(scene->subject, to))
        return DPT_E_DROPPED;
    return scene->tau[from] == ORACLE_NONE ? DPT_E_UNREACHABLE : DPT_OK;
}

/* A strip holds just these, in this order. */
static inline int strip_is(const dpt_strip *strip, const uint32_t *route, uint32_t length)
{
    uint32_t count = 0, flags = 0;
    const uint32_t *triangles = dpt_strip_get_triangles(strip, &count, &flags);
    return count == length && flags == 0 && (!length || memcmp(triangles, route, length * sizeof *route) == 0);
}

const char *strip_text(const dpt_strip *strip);

/* An answer of the library for a pair whose tau is in the walk; by whichever call. */
void check_answer(const struct route_scene *scene, uint32_t from, uint32_t to, dpt_result result, const char *by);

static inline uint32_t length_of(const struct route_scene *scene, uint32_t from, uint32_t to)
{
    uint32_t count = 0;
    const dpt_result result = dpt_strip_route(scene->strip, scene->subject->mesh, from, to);
    dpt_strip_get_triangles(scene->strip, &count, NULL);
    return result == DPT_OK ? count : 0;
}

/* A triangle a few steps away. */
uint32_t triangle_nearby(const struct oracle_surface *surface, uint32_t from, uint64_t *seed);

/*
 * A fan about one vertex, and a straight strip of `tail` squares at two opposite edges of its rim: every way from one
 * to the other leads through the fan.
 */
int subject_with_hub(struct subject *subject, uint32_t fan, uint32_t tail);

#endif
