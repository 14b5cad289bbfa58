/* SPDX-License-Identifier: BSD-3-Clause */
#include "convex/convex_body.h"

#include "base/return_if_error.h"
#include "base/sized.h"

/* The largest ratio of extents, and the least share that a bevel leaves. */
#define RATIO_MAX  1e4
#define LEAST_LEFT 1e-3

static vec3 support_of_cone(const struct convex_body *body, vec3 d)
{
    const double across = sqrt(d.x * d.x + d.y * d.y);
    /* The base's rim, or the point. */
    if (across * body->x + 2.0 * body->z * d.z < 0.0)
        return (vec3){ 0.0, 0.0, -body->z };
    if (!(across > 0.0))
        return (vec3){ 0.0, 0.0, body->z };
    return (vec3){ body->x * (d.x / across), body->x * (d.y / across), body->z };
}

static vec3 support_of_cylinder(const struct convex_body *body, vec3 d)
{
    const double across = sqrt(d.x * d.x + d.y * d.y), z = d.z < 0.0 ? -body->z : body->z;
    if (!(across > 0.0))
        return (vec3){ 0.0, 0.0, z };
    return (vec3){ body->x * (d.x / across), body->x * (d.y / across), z };
}

static vec3 support_of_ellipsoid(const struct convex_body *body, vec3 d)
{
    const vec3 scaled_d = { body->x * d.x, body->y * d.y, body->z * d.z };
    const vec3 u = unit_of(scaled_d);
    return (vec3){ body->x * u.x, body->y * u.y, body->z * u.z };
}

/*
 * Of the part of a capsule in the plane of its bevel. The ball around the axis' point at z meets the plane, whose normal
 * is n, in a disc: its middle is s = n.z z - at off the plane, and its radius is sqrt(r^2 - s^2). What is farthest
 * along d is the greatest of a concave function of s.
 */
static vec3 support_of_section(const struct convex_body *body, vec3 d)
{
    const vec3 n = body->cut;
    vec3 level = along(d, -dot(d, n), n);
    level = along(level, -dot(level, n), n);
    /* Along n all of the section is as far, and what is left of d across n is rounding. */
    if (dot(level, level) < 1e-20 * dot(d, d))
        level = (vec3){ 0.0, 0.0, 0.0 };
    const vec3 e = unit_of(level);
    const double r = body->x, steep = length(level), slope = level.z;
    double z = slope < 0.0 ? -body->z : body->z;
    if (fabs(n.z) > 1e-12) {
        const double rise = slope / n.z, size = sqrt(rise * rise + steep * steep);
        double s = size > 0.0 ? r * (rise / size) : 0.0;
        const double low = max_of(-r, -fabs(n.z) * body->z - body->cut_at);
        const double high = min_of(r, fabs(n.z) * body->z - body->cut_at);
        s = max_of(low, min_of(high, s));
        z = max_of(-body->z, min_of(body->z, (s + body->cut_at) / n.z));
    }
    const double s = n.z * z - body->cut_at;
    const vec3 middle = along((vec3){ 0.0, 0.0, z }, -s, n);
    return along(middle, sqrt(max_of(0.0, r * r - s * s)), e);
}

static vec3 support_of_capsule(const struct convex_body *body, vec3 d)
{
    const vec3 end = { 0.0, 0.0, d.z < 0.0 ? -body->z : body->z };
    const vec3 p = along(end, body->x, unit_of(d));
    return body->is_cut && dot(p, body->cut) > body->cut_at ? support_of_section(body, d) : p;
}

static vec3 support_of_hull(const struct convex_body *body, vec3 d)
{
    return along(convex_farthest(body->corner, body->corner_count, d), body->round, unit_of(d));
}

vec3 dpti_convex_support(const struct convex_body *body, vec3 d)
{
    switch (body->kind) {
    case DPT_CONVEX_KIND_CONE:
        return support_of_cone(body, d);
    case DPT_CONVEX_KIND_CYLINDER:
        return support_of_cylinder(body, d);
    case DPT_CONVEX_KIND_ELLIPSOID:
        return support_of_ellipsoid(body, d);
    case DPT_CONVEX_KIND_CAPSULE:
        return support_of_capsule(body, d);
    default:
        return support_of_hull(body, d);
    }
}

static dpt_result take_hull(const dpt_hull *hull, struct convex_body *body)
{
    dpt_hull_info info = { .size = sizeof info };
    vec3 sum = { 0.0, 0.0, 0.0 };
    DPT_TRY(dpt_hull_get_info(hull, &info));
    if (info.faces < 4 && !(info.radius > 0.0))
        return DPT_E_ARGUMENT;
    for (uint32_t i = 0; i < info.corners; i++) {
        double at[3];
        DPT_TRY(dpt_hull_get_corner(hull, i, at));
        body->corner[i] = vec3_of(at);
        sum = add(sum, body->corner[i]);
    }
    body->corner_count = info.corners;
    body->round = info.radius;
    body->centre = scaled(sum, 1.0 / info.corners);
    for (uint32_t i = 0; i < info.corners; i++)
        body->size = max_of(body->size, length(sub(body->corner[i], body->centre)));
    body->size += info.radius;
    body->axis[0] = vec3_of(info.axis[0]);
    body->axis[1] = vec3_of(info.axis[1]);
    body->reach = info.reach + info.radius;
    return DPT_OK;
}

static int is_extent(double extent)
{
    return extent > 0.0 && extent <= DPT_COORDINATE_MAX;
}

static dpt_result take_extents(const dpt_convex_shape *shape, struct convex_body *body)
{
    const double *extent = shape->extent;
    const int is_capsule = shape->kind == DPT_CONVEX_KIND_CAPSULE;
    const int is_ellipsoid = shape->kind == DPT_CONVEX_KIND_ELLIPSOID;
    if (!vec3_within(extent, DPT_COORDINATE_MAX))
        return DPT_E_FINITE;
    if (!is_extent(extent[0]) || (is_ellipsoid ? !is_extent(extent[1]) : extent[1] != 0.0) ||
        !(is_extent(extent[2]) || (is_capsule && extent[2] == 0.0)))
        return DPT_E_ARGUMENT;
    body->x = 0.5 * extent[0];
    body->y = is_ellipsoid ? 0.5 * extent[1] : body->x;
    body->z = 0.5 * extent[2];
    const double max = max_of(body->x, max_of(body->y, body->z));
    const double min = min_of(min_of(body->x, body->y), is_capsule ? body->x : body->z);
    if (max > RATIO_MAX * min)
        return DPT_E_ARGUMENT;
    body->axis[0].z = -body->z;
    body->axis[1].z = body->z;
    body->reach = body->x;
    switch (shape->kind) {
    case DPT_CONVEX_KIND_CONE:
        body->centre.z = 0.5 * body->z;
        body->size = max_of(1.5 * body->z, sqrt(body->x * body->x + 0.25 * body->z * body->z));
        break;
    case DPT_CONVEX_KIND_CYLINDER:
        body->size = sqrt(body->x * body->x + body->z * body->z);
        break;
    case DPT_CONVEX_KIND_ELLIPSOID:
        /* Within its shorter half of the middle of the axis that is cut off by so much at each end. */
        body->size = max;
        body->reach = max_of(body->x, body->y);
        body->axis[1].z = max_of(0.0, body->z - body->reach);
        body->axis[0].z = -body->axis[1].z;
        break;
    default:
        body->size = body->z + body->x;
    }
    return DPT_OK;
}

static dpt_result take_bevel(const dpt_convex_shape *shape, struct convex_body *body)
{
    const vec3 n = vec3_of(shape->bevel);
    vec3 sum = { 0.0, 0.0, 0.0 };
    if (shape->kind != DPT_CONVEX_KIND_CAPSULE)
        return DPT_E_ARGUMENT;
    if (!vec3_within(shape->bevel, 2.0) || !(fabs(shape->bevel[3]) <= DPT_COORDINATE_MAX))
        return DPT_E_FINITE;
    if (!(fabs(dot(n, n) - 1.0) <= 2e-6))
        return DPT_E_POSE;
    body->cut = unit_of(n);
    body->cut_at = shape->bevel[3];
    const double max = fabs(body->cut.z) * body->z + body->x;
    if (body->cut_at < -max + LEAST_LEFT * 2.0 * max)
        return DPT_E_ARGUMENT;
    body->is_cut = body->cut_at < max;
    if (!body->is_cut)
        return DPT_OK;
    for (int k = 0; k < 8; k++) {
        const vec3 d = k < 6 ? (vec3){ k == 0   ? 1.0
                                       : k == 1 ? -1.0
                                                : 0.0,
                                       k == 2   ? 1.0
                                       : k == 3 ? -1.0
                                                : 0.0,
                                       k == 4   ? 1.0
                                       : k == 5 ? -1.0
                                                : 0.0 }
                             : scaled(body->cut, k == 6 ? 1.0 : -1.0);
        sum = along(sum, 0.125, dpti_convex_support(body, d));
    }
    body->centre = sum;
    /* The capsule's own ball moves with the centre, by no more than it is off. */
    body->size += length(sum);
    return DPT_OK;
}

dpt_result dpti_convex_body_of(const dpt_convex_shape *given, struct convex_body *body)
{
    dpt_convex_shape shape = { .size = sizeof shape };
    const uint32_t flags = DPT_CONVEX_FLAG_BEVEL | DPT_CONVEX_FLAG_OUTSIDE;
    memset(body, 0, sizeof *body);
    if (!given)
        return DPT_E_ARGUMENT;
    DPT_TRY(sized_read(given, sizeof shape, &shape, sizeof shape));
    if (shape.kind > DPT_CONVEX_KIND_HULL || (shape.flags & ~flags) || shape.reserved || shape.reserved_pointer ||
        (shape.kind == DPT_CONVEX_KIND_HULL) != (shape.hull != NULL))
        return DPT_E_ARGUMENT;
    DPT_TRY(frame_of_pose(&shape.pose, &body->frame));
    body->kind = shape.kind;
    if (shape.hull)
        DPT_TRY(take_hull(shape.hull, body));
    else
        DPT_TRY(take_extents(&shape, body));
    if (shape.flags & DPT_CONVEX_FLAG_BEVEL)
        DPT_TRY(take_bevel(&shape, body));
    body->outside = frame_to_world(&body->frame, body->centre);
    if (shape.flags & DPT_CONVEX_FLAG_OUTSIDE) {
        if (!vec3_within(shape.outside, DPT_COORDINATE_MAX))
            return DPT_E_FINITE;
        body->outside = vec3_of(shape.outside);
    }
    return DPT_OK;
}
