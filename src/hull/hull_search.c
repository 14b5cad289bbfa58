/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Triangles come from a range search about the hull's axis, and most are ruled out by planes: first in float, a leaf at a
 * time, along the best pair and the faces that look the same way; then one by one in double. What is left is evaluated.
 */
#include "hull/hull_search.h"

#include "hull/hull_range.h"
#include "hull/hull_triangle.h"

#include <string.h>

enum { DIRECTIONS = HULL_PLANES };
typedef char planes_fit[(int)HULL_PLANES == (int)HULL_RANGE_PLANES ? 1 : -1];

struct hull_query {
    const struct surface *surface;
    const struct kernel *kernel;
    const struct hull_place *place;
    struct work *work;
    struct hull_nearest *nearest;
    struct range range;
    vec3 planes[DIRECTIONS];     /* unit, from the hull to the surface */
    double supports[DIRECTIONS]; /* of the hull */
    vec3 last;                   /* the direction that last parted a triangle from the hull */
    double slack;                /* m: what is nearer by less counts as no nearer */
    int has_planes;
};

double dpti_hull_error(const struct hull_place *place, const struct surface *surface, const struct frame *tool,
                       const struct frame *body)
{
    const vec3 middle = scaled(add(place->hull->axis_a, place->hull->axis_b), 0.5);
    const double size = length(sub(place->hull->axis_b, middle)) + place->hull->reach;
    double extent = extent_of(frame_to_world(tool, middle)) + size;
    extent = max_of(extent, max_of(extent_of(body->origin), extent_of(tool->origin)));
    extent = max_of(extent, extent_of(along(place->a, 0.5, place->u)) + size);
    return DISTANCE_ERROR * max_of(extent, dpti_surface_extent(surface));
}

void dpti_hull_planes(const struct hull_place *place, vec3 toward, vec3 planes[HULL_PLANES],
                      double supports[HULL_PLANES])
{
    const struct dpt_hull *hull = place->hull;
    uint32_t face[HULL_PLANES] = { DPT_NONE, DPT_NONE, DPT_NONE, DPT_NONE };
    planes[0] = unit_of(toward);
    for (int i = 1; i < HULL_PLANES; i++) {
        double max = -HUGE_VAL;
        for (uint32_t f = 0; f < hull->face_count; f++) {
            const int is_used = f == face[1] || f == face[2];
            const double along_it = dot(place->normal[f], toward);
            if (!is_used && along_it > max) {
                max = along_it;
                face[i] = f;
            }
        }
        planes[i] = face[i] == DPT_NONE ? planes[0] : place->normal[face[i]];
    }
    for (int i = 0; i < HULL_PLANES; i++)
        supports[i] = support_of(place->corner, hull->corner_count, planes[i]);
}

/* Planes across the best pair, and along the hull's faces that face the surface most. */
static void set_planes(struct hull_query *query)
{
    dpti_hull_planes(query->place, scaled(query->nearest->found.pair.gap, -1.0), query->planes, query->supports);
    query->has_planes = 1;
}

/* What is farther along a plane's normal than the hull and the best distance is no nearer. */
static void set_leaf_planes(struct hull_query *query)
{
    const double distance = query->nearest->distance;
    const double size = length(sub(query->place->a, query->surface->filter_centre)) + length(query->place->u) +
                        query->place->hull->reach + distance;
    for (uint32_t i = 0; i < DIRECTIONS; i++)
        hull_range_set_plane(&query->range, i, query->planes[i], query->supports[i] + distance, size);
}

/* Whether a plane parts a triangle from the hull by more than the best distance. */
static int is_beyond(struct hull_query *query, const vec3 v[3])
{
    const double distance = query->nearest->distance - query->slack;
    for (int i = 0; i < DIRECTIONS; i++)
        if (-support_of(v, 3, scaled(query->planes[i], -1.0)) - query->supports[i] > distance)
            return 1;
    return dpti_separate(query->place->corner, query->place->hull->corner_count, v, 3, max_of(0.0, distance),
                         &query->last);
}

static int take(struct hull_query *query, uint32_t triangle)
{
    struct hull_nearest *nearest = query->nearest;
    struct hull_pair found;
    vec3 v[3];
    surface_corners(query->surface, triangle, v);
    if (nearest->triangle == triangle || (query->has_planes && is_beyond(query, v)) ||
        !dpti_hull_triangle(query->place, v, nearest->distance, &found))
        return 0;
    nearest->found = found;
    nearest->triangle = triangle;
    nearest->distance = sqrt(found.pair.distance2);
    return 1;
}

/* The triangle nearest to the hull's axis is a good start. */
static int find_start(struct hull_query *query)
{
    const struct hull_place *place = query->place;
    const double limit = query->nearest->distance + place->hull->reach;
    struct pair_search start;
    pair_search_begin(&start, DPT_NONE);
    start.pair.distance2 = limit * limit;
    const int is_done = dpti_bvh_search(query->surface, query->kernel, place->a, place->u, query->work, &start);
    if (start.triangle != DPT_NONE)
        take(query, start.triangle);
    return is_done;
}

static void begin_range(struct hull_query *query)
{
    const struct hull_place *place = query->place;
    dpti_range_begin(&query->range, query->surface, query->kernel, place->a, place->u,
                     query->nearest->distance + place->hull->reach, query->work);
    set_planes(query);
    set_leaf_planes(query);
}

int dpti_hull_search(const struct surface *surface, const struct kernel *kernel, const struct hull_place *place,
                     uint32_t hint, double limit, struct work *work, struct hull_nearest *nearest)
{
    struct hull_query query = {
        .surface = surface, .kernel = kernel, .place = place, .work = work, .nearest = nearest
    };
    query.slack = DISTANCE_ERROR * DISTANCE_ERROR_SLACK * max_of(extent_of(place->a), dpti_surface_extent(surface));
    memset(&nearest->found, 0, sizeof nearest->found);
    nearest->triangle = DPT_NONE;
    nearest->distance = limit;
    if (hint != DPT_NONE)
        take(&query, hint);
    if (nearest->triangle == DPT_NONE || nearest->distance > place->hull->reach)
        if (!find_start(&query))
            return 0;
    if (nearest->triangle == DPT_NONE && limit == HUGE_VAL)
        return 1;
    begin_range(&query);
    while (nearest->distance > 0.0) {
        int may_touch;
        const uint32_t triangle = dpti_range_next(&query.range, &may_touch);
        if (triangle == DPT_NONE)
            return query.range.level > surface->levels;
        work_spend(work, 1);
        if (take(&query, triangle)) {
            set_planes(&query);
            set_leaf_planes(&query);
            filter_segment_set_limit(&query.range.segment, surface, nearest->distance + place->hull->reach);
        }
    }
    return 1;
}
