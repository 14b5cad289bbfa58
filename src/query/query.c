/* SPDX-License-Identifier: BSD-3-Clause */
#include "dynpoint/query.h"

#include "base/return_if_error.h"
#include "base/sized.h"
#include "contact/gap.h"
#include "hull/hull_search.h"
#include "nearest/bvh.h"
#include "nearest/pair_features.h"

/* The arithmetic forms fourth powers of lengths. */
#define PAIR_COORDINATE_MAX 1e60
#define PAIR_LENGTH_MIN     1e-60

#define SEGMENTS_MAX ((size_t)INT32_MAX)

static int pair_is_usable(const double *segment, const double *triangle)
{
    return segment && triangle && vec3_within(segment, PAIR_COORDINATE_MAX) &&
           vec3_within(segment + 3, PAIR_COORDINATE_MAX) && vec3_within(triangle, PAIR_COORDINATE_MAX) &&
           vec3_within(triangle + 3, PAIR_COORDINATE_MAX) && vec3_within(triangle + 6, PAIR_COORDINATE_MAX);
}

double dpt_segment_triangle(const double segment[6], const double triangle[9], double *s, double p[3], double q[3])
{
    pair found = { .distance2 = HUGE_VAL };
    vec3 at_p = { 0.0, 0.0, 0.0 };
    if (pair_is_usable(segment, triangle)) {
        vec3 a = vec3_of(segment), u = sub(vec3_of(segment + 3), a);
        found = segment_triangle(a, u, vec3_of(triangle), vec3_of(triangle + 3), vec3_of(triangle + 6));
        at_p = along(a, found.s, u);
    }
    if (s)
        *s = found.s;
    if (p)
        vec3_store(at_p, p);
    if (q)
        vec3_store(sub(at_p, found.gap), q);
    return sqrt(found.distance2);
}

uint32_t dpt_segment_triangle_pairs(const double segment[6], const double triangle[9], dpt_segment_pair *pairs)
{
    uint32_t count = 0;
    if (!pairs || !pair_is_usable(segment, triangle))
        return 0;
    const vec3 a = vec3_of(segment), u = sub(vec3_of(segment + 3), a);
    const vec3 v[3] = { vec3_of(triangle), vec3_of(triangle + 3), vec3_of(triangle + 6) };
    const int features = dot(u, u) > PAIR_LENGTH_MIN * PAIR_LENGTH_MIN ? PAIR_FEATURES : 1;
    for (int feature = 0; feature < features; feature++) {
        pair found;
        if (!pair_of_feature(feature, a, u, v, &found))
            continue;
        dpt_segment_pair *made = &pairs[count++];
        const vec3 p = along(a, found.s, u);
        made->s = found.s;
        made->distance = sqrt(found.distance2);
        vec3_store(p, made->p);
        vec3_store(sub(p, found.gap), made->q);
    }
    return count;
}

/* What all segments of one call share. */
struct query {
    struct surface surface;
    struct frame body_frame;
    struct kernel kernel;
    uint32_t method;
    int pair_only;
};

/* Check a call's def and set up what its `n` segments share. */
static dpt_result prepare(struct query *query, const dpt_mesh *mesh, const dpt_pose *pose, size_t n,
                          const dpt_query_def *def)
{
    dpt_query_def own = { .method = DPT_METHOD_EXACT, .kernel = DPT_KERNEL_AUTO };
    if (def)
        DPT_TRY(sized_read(def, sizeof *def, &own, sizeof own));
    if (own.pair > 1)
        return DPT_E_ARGUMENT;
    query->pair_only = (int)own.pair;
    uint32_t method = own.method, kernel = own.kernel, chosen;
    if (method > DPT_METHOD_BRUTE)
        return DPT_E_ARGUMENT;
    /* Detecting the processor takes longer than a query: a few queries use the kernel that every build has. */
    if (kernel == DPT_KERNEL_AUTO && n < LANES)
        kernel = DPT_KERNEL_ALWAYS;
    if (!dpti_kernel_get(kernel, &query->kernel, &chosen))
        return DPT_E_UNSUPPORTED;
    DPT_TRY(frame_of_pose(pose, &query->body_frame));
    query->method = method == DPT_METHOD_BRUTE ? method : DPT_METHOD_TREE;
    dpti_surface_of_mesh(mesh, &query->surface);
    return DPT_OK;
}

/* Answer one segment. `hint` is the place of the triangle of the answer before, and gets that of this one. */
static dpt_result answer_segment(const struct query *query, const double *ends, double radius, uint32_t *hint,
                                 dpt_hit *hit)
{
    *hit = (dpt_hit){ .status = DPT_STATUS_STALE, .triangle = DPT_NONE };
    if (!vec3_within(ends, DPT_COORDINATE_MAX) || !vec3_within(ends + 3, DPT_COORDINATE_MAX) ||
        !(radius >= 0.0 && radius <= DPT_COORDINATE_MAX))
        return DPT_E_FINITE;
    struct axis axis;
    struct pair_search nearest;
    struct segment_result result;
    struct work work = work_of(WORK_UNLIMITED);
    axis_of(&query->surface, &query->body_frame, vec3_of(ends), vec3_of(ends + 3), &axis);
    dpti_dynamic_point_once(&query->surface, &query->kernel, query->method, &axis, *hint, &work, &nearest);
    if (nearest.triangle == DPT_NONE)
        return DPT_E_LAYOUT;
    dpti_segment_result_of_pair(&axis, &nearest.pair, &result);
    result.work = work.done;
    if (!query->pair_only)
        dpti_contact_of(&query->surface, &query->kernel, &axis, &nearest, radius, &result);
    dpti_segment_result_write(&result, &query->surface, &query->body_frame, 0, &nearest, hit);
    *hint = nearest.triangle;
    return DPT_OK;
}

dpt_result dpt_query_segments(const dpt_mesh *mesh, const dpt_pose *pose, const double *ends, const double *radii,
                              size_t n, dpt_hit *hits, const dpt_query_def *def)
{
    struct query query;
    if (n == 0)
        return mesh ? DPT_OK : DPT_E_ARGUMENT;
    if (!mesh || !ends || !hits)
        return DPT_E_ARGUMENT;
    if (n > SEGMENTS_MAX)
        return DPT_E_LIMIT;
    DPT_TRY(sized_check(hits, sizeof *hits, 1));
    const uint32_t size = hits[0].size;
    DPT_TRY(prepare(&query, mesh, pose, n, def));
    dpt_result result = DPT_OK;
    uint32_t hint = DPT_NONE;
    for (size_t i = 0; i < n; i++) {
        dpt_hit hit;
        dpt_result one = answer_segment(&query, ends + 6 * i, radii ? radii[i] : 0.0, &hint, &hit);
        sized_write((char *)hits + i * size, size, &hit, sizeof hit);
        result = one == DPT_OK ? result : one;
    }
    return result;
}

/* ---- hulls and ranges ---- */

static dpt_result place_mesh(const dpt_mesh *mesh, const dpt_pose *pose, struct surface *surface, struct kernel *kernel,
                             struct frame *body)
{
    uint32_t chosen;
    if (!dpti_kernel_get(DPT_KERNEL_ALWAYS, kernel, &chosen))
        return DPT_E_UNSUPPORTED;
    DPT_TRY(frame_of_pose(pose, body));
    dpti_surface_of_mesh(mesh, surface);
    return DPT_OK;
}

static void write_hit(const struct surface *surface, const struct frame *body, double radius,
                      const struct hull_nearest *nearest, uint32_t work, dpt_hit *hit)
{
    const pair *found = &nearest->found.pair;
    const vec3 q = surface_point(surface, nearest->triangle, found->weight);
    const double gap = nearest->distance - radius;
    hit->status = DPT_STATUS_EXACT;
    hit->triangle = surface->sources[nearest->triangle];
    hit->work = work;
    hit->distance = nearest->distance;
    hit->error_bound = nearest->error_bound;
    hit->lower_bound = max_of(0.0, nearest->distance - nearest->error_bound);
    vec3_store(frame_to_world(body, q), hit->q);
    vec3_store(frame_to_world(body, add(q, found->gap)), hit->p);
    hit->contact = DPT_CONTACT_PENETRATING;
    hit->flags = DPT_HIT_FLAG_CROSSING;
    if (!(nearest->distance > 0.0))
        return;
    hit->contact = dpti_contact_of_gap(gap, nearest->error_bound);
    hit->flags = DPT_HIT_FLAG_GAP;
    hit->gap = gap;
    hit->depth = max_of(0.0, -gap);
}

dpt_result dpt_query_hull(const dpt_mesh *mesh, const dpt_pose *pose, const dpt_hull *hull, const dpt_pose *hull_pose,
                          dpt_hit *hit)
{
    struct surface surface;
    struct kernel kernel;
    struct frame body, tool;
    struct hull_place place;
    struct hull_nearest nearest;
    struct work work = work_of(WORK_UNLIMITED);
    dpt_hit found = { .status = DPT_STATUS_STALE, .triangle = DPT_NONE };
    if (!mesh || !hull || !hit)
        return DPT_E_ARGUMENT;
    DPT_TRY(sized_check(hit, sizeof found, 0));
    sized_write(hit, hit->size, &found, sizeof found);
    DPT_TRY(place_mesh(mesh, pose, &surface, &kernel, &body));
    DPT_TRY(frame_of_pose(hull_pose, &tool));
    hull_place_set(&place, hull, &tool, &body);
    dpti_hull_search(&surface, &kernel, &place, DPT_NONE, HUGE_VAL, &work, &nearest);
    if (nearest.triangle == DPT_NONE)
        return DPT_E_LAYOUT;
    nearest.error_bound = dpti_hull_error(&place, &surface, &tool, &body);
    write_hit(&surface, &body, hull->radius, &nearest, work.done, &found);
    sized_write(hit, hit->size, &found, sizeof found);
    return DPT_OK;
}

dpt_result dpt_query_triangles(const dpt_mesh *mesh, const dpt_pose *pose, const double ends[6], double reach,
                               uint32_t *triangles, uint32_t capacity, uint32_t *count)
{
    struct surface surface;
    struct kernel kernel;
    struct frame body;
    struct range range;
    struct work work = work_of(WORK_UNLIMITED);
    uint32_t triangle;
    int may_touch;
    if (count)
        *count = 0;
    if (!mesh || !ends || !count || (!triangles && capacity))
        return DPT_E_ARGUMENT;
    if (!vec3_within(ends, DPT_COORDINATE_MAX) || !vec3_within(ends + 3, DPT_COORDINATE_MAX) ||
        !(reach >= 0.0 && reach <= DPT_COORDINATE_MAX))
        return DPT_E_FINITE;
    DPT_TRY(place_mesh(mesh, pose, &surface, &kernel, &body));
    const vec3 a = frame_to_local(&body, vec3_of(ends));
    const vec3 u = sub(frame_to_local(&body, vec3_of(ends + 3)), a);
    dpti_range_begin(&range, &surface, &kernel, a, u, reach, &work);
    while ((triangle = dpti_range_next(&range, &may_touch)) != DPT_NONE) {
        if (*count < capacity)
            triangles[*count] = surface.sources[triangle];
        ++*count;
    }
    return DPT_OK;
}
