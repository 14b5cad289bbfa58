/* SPDX-License-Identifier: BSD-3-Clause */
#include "contact/crossings.h"

#include "nearest/bvh.h"

/* Put a crossing of a triangle, a place, into the list, in order of s. Only a crossing of its face has known sides. */
static void put_crossing(struct distance_profile *profile, uint32_t triangle, const pair *found)
{
    uint32_t i = profile->crossing_count;
    if (i == PROFILE_CROSSINGS) {
        profile->is_full = 1;
        return;
    }
    for (; i && profile->crossing[i - 1].s > found->s; i--)
        profile->crossing[i] = profile->crossing[i - 1];
    struct crossing *crossing = &profile->crossing[i];
    *crossing = (struct crossing){ .s = found->s, .triangle = triangle };
    memcpy(crossing->weight, found->weight, sizeof crossing->weight);
    profile->crossing_count++;
    vec3 normal = dpti_profile_exit_direction(profile, triangle, found->weight);
    double along_axis = dot(normal, profile->axis->u);
    int on_face = found->weight[0] > 0.0 && found->weight[1] > 0.0 && found->weight[2] > 0.0;
    if (on_face && fabs(along_axis) > 1e-6 * profile->axis_length) {
        uint32_t flags = surface_part_flags(profile->surface, surface_part(profile->surface, triangle));
        crossing->side_after = along_axis > 0.0 ? 1 : -1;
        crossing->side_before = -crossing->side_after;
        crossing->winding = flags & MESH_PART_SOLID ? -crossing->side_after : 0;
        crossing->is_counted = 1;
        if (flags & MESH_PART_BURIED)
            crossing->side_before = crossing->side_after = -1;
    }
}

/*
 * Join crossings at one place: of both triangles at an edge, or of a vertex' fan. Their sides are unknown then, and so
 * is what they count.
 */
static void join_crossings(struct distance_profile *profile)
{
    double tolerance = 4.0 * profile->axis->error;
    uint32_t joined_count = 0;
    for (uint32_t i = 0; i < profile->crossing_count; i++) {
        const struct crossing *crossing = &profile->crossing[i];
        struct crossing *previous = &profile->crossing[joined_count ? joined_count - 1 : 0];
        if (joined_count && (crossing->s - previous->s) * profile->axis_length <= tolerance) {
            previous->side_before = previous->side_after = 0;
            previous->is_counted = 0;
        } else {
            profile->crossing[joined_count++] = *crossing;
        }
    }
    profile->crossing_count = joined_count;
}

/*
 * Add the stretch of the axis that can be within reach of a triangle, a place, to the reach intervals. Overlapping ones
 * are joined; if there are too many, so are the last ones.
 *
 *   inverse_uu  1 / (u.u), 1/m^2; 0 for an axis without length
 *   reach_s     the reach, in s
 */
static void put_reach_interval(struct distance_profile *profile, uint32_t triangle, double inverse_uu, double reach_s)
{
    const struct surface *surface = profile->surface;
    const struct axis *axis = profile->axis;
    const uint32_t *corner = surface->corners + 3 * (size_t)triangle;
    double from = HUGE_VAL, to = -HUGE_VAL;
    for (int k = 0; k < 3; k++) {
        vec3 c = vec3_of_float(surface->positions + 3 * (size_t)corner[k]);
        double s = dot(sub(c, axis->local_a), axis->u) * inverse_uu;
        from = min_of(from, s);
        to = max_of(to, s);
    }
    from = clamp01(from - reach_s);
    to = to + reach_s < 1.0 ? clamp01(to + reach_s) : 1.0;
    for (uint32_t i = 0; i < profile->reach_interval_count; i++)
        if (profile->reach_from[i] <= from && profile->reach_to[i] >= to)
            return;
    uint32_t kept_count = 0;
    for (uint32_t i = 0; i < profile->reach_interval_count; i++) {
        if (profile->reach_to[i] < from || profile->reach_from[i] > to) {
            profile->reach_from[kept_count] = profile->reach_from[i];
            profile->reach_to[kept_count++] = profile->reach_to[i];
        } else {
            from = min_of(from, profile->reach_from[i]);
            to = max_of(to, profile->reach_to[i]);
        }
    }
    if (kept_count == PROFILE_REACH_INTERVALS) {
        kept_count--;
        from = min_of(from, profile->reach_from[kept_count]);
        to = max_of(to, profile->reach_to[kept_count]);
    }
    profile->reach_from[kept_count] = from;
    profile->reach_to[kept_count] = to;
    profile->reach_interval_count = kept_count + 1;
}

/*
 * 1: at a crossing the axis changes sides. At an edge or a vertex it may come as near as rounding and stay on its
 * side. The sides a little way before and after decide there.
 */
static int goes_through(const struct distance_profile *profile, const struct crossing *crossing)
{
    vec3 u = profile->axis->u;
    double weight[3];
    int corners = 0;
    for (int k = 0; k < 3; k++) {
        weight[k] = crossing->weight[k] > 1e-12 ? crossing->weight[k] : 0.0;
        corners += weight[k] > 0.0;
    }
    if (corners == 3 || profile->axis_length == 0.0)
        return 1;
    return dpti_side_of_arrival(profile->surface, crossing->triangle, weight, u) !=
           dpti_side_of_arrival(profile->surface, crossing->triangle, weight, scaled(u, -1.0));
}

/* 1: the axis goes through an open sheet whose side is not known. */
static int is_sideless(const struct distance_profile *profile)
{
    for (uint32_t k = 0; k < profile->crossing_count; k++) {
        uint32_t part = surface_part(profile->surface, profile->crossing[k].triangle);
        uint32_t flags = surface_part_flags(profile->surface, part);
        if (!(flags & (MESH_PART_SOLID | MESH_PART_BURIED)) && (flags & MESH_PART_MANIFOLD) &&
            !dpti_sides_get(profile->sides, part) && goes_through(profile, &profile->crossing[k]))
            return 1;
    }
    return 0;
}

void dpti_profile_find_crossings(struct distance_profile *profile)
{
    const struct axis *axis = profile->axis;
    struct range range;
    int may_cross;
    if (work_is_spent(&profile->work)) {
        profile->is_cut = 1;
        return;
    }
    double inverse_uu = profile->axis_length > 0.0 ? 1.0 / dot(axis->u, axis->u) : 0.0;
    double reach_s = profile->axis_length > 0.0 ? profile->reach / profile->axis_length : 1.0;
    dpti_range_begin(&range, profile->surface, profile->kernel, axis->local_a, axis->u, profile->reach, &profile->work);
    for (uint32_t triangle; (triangle = dpti_range_next(&range, &may_cross)) != DPT_NONE;) {
        put_reach_interval(profile, triangle, inverse_uu, reach_s);
        if (!may_cross)
            continue;
        pair found = dpti_triangle_pair(profile->surface, triangle, axis->local_a, axis->u);
        if (found.distance2 == 0.0)
            put_crossing(profile, triangle, &found);
    }
    profile->is_cut |= (uint32_t)work_is_spent(&profile->work);
    join_crossings(profile);
    profile->is_sideless = (uint32_t)is_sideless(profile);
}
