/* SPDX-License-Identifier: BSD-3-Clause */
/* Stateless questions beside nearest pairs of segments. */
#include "base/return_if_error.h"
#include "base/sized.h"
#include "contact/segment_result.h"
#include "dynpoint/query.h"
#include "hull/hull_search.h"
#include "nearest/bvh.h"

static dpt_result prepare(const dpt_mesh *mesh, const dpt_pose *pose, struct surface *surface, struct kernel *kernel,
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
    DPT_TRY(prepare(mesh, pose, &surface, &kernel, &body));
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
    DPT_TRY(prepare(mesh, pose, &surface, &kernel, &body));
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
