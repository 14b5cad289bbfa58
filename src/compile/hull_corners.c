/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The corners of a hull for many points. The hull grows: the point that stands out farthest is the next corner, until
 * none does or there are as many corners as a hull may have. Points that remain outside give its radius. A flat set is
 * treated in its plane.
 */
#include <stdlib.h>

#include "base/return_if_error.h"
#include "base/vec3.h"
#include "compile/model.h"
#include "dynpoint/compile.h"
#include "nearest/segment_triangle.h"

/* A point stands out if it does so by more than this share of the points' size. */
#define STANDS_OUT 1e-8

/* What is thinner than this share of the points' size becomes flat: its faces could not be told apart. */
#define FLAT 1e-3

/* Of the points' size: of two that stand out as far, within that, the one that is farther from the middle is a corner. */
#define AS_FAR 1e-12

/* Covers rounding of the radius. */
#define ROUNDED_UP 1.000000001

enum { CORNERS_MAX = DPT_HULL_CORNERS_MAX, FACES_MAX = 2 * CORNERS_MAX };

struct growing {
    const double *points;
    size_t point_count;
    uint32_t *outside; /* points that may stand out */
    size_t outside_count;
    double size; /* m */
    vec3 plane;  /* of a flat set: the normal of its plane, which goes through its first corner; else 0 */
    vec3 corner[CORNERS_MAX];
    uint32_t corner_count;
    void *block; /* of the hull */
    const dpt_hull *hull;
    vec3 normal[FACES_MAX]; /* unit, out of each face */
    double height[FACES_MAX];
    uint32_t face_count;
    vec3 middle; /* of the corners */
};

/* A point; of a flat set, its place in the plane. */
static vec3 point_of(const struct growing *growing, size_t i)
{
    const vec3 point = vec3_of(growing->points + 3 * i);
    return along(point, -dot(growing->plane, sub(point, growing->corner[0])), growing->plane);
}

/* The corners of a face; returns how many. */
static uint32_t face_of(const struct growing *growing, uint32_t face, vec3 corner[CORNERS_MAX])
{
    uint32_t numbers[CORNERS_MAX], count = 0;
    double at[3];
    dpt_hull_get_face(growing->hull, face, numbers, CORNERS_MAX, &count);
    for (uint32_t i = 0; i < count; i++) {
        dpt_hull_get_corner(growing->hull, numbers[i], at);
        corner[i] = vec3_of(at);
    }
    return count;
}

/* Make the hull of the corners so far, and drop those that are none. Returns 0 if there is no hull of them. */
static int make_hull(struct growing *growing)
{
    double corners[3 * CORNERS_MAX];
    dpt_hull_def def = { .size = sizeof def, .corner_count = growing->corner_count, .corners = corners };
    dpt_hull_info info = { .size = sizeof info };
    vec3 face[CORNERS_MAX];
    for (uint32_t i = 0; i < growing->corner_count; i++)
        vec3_store(growing->corner[i], corners + 3 * (size_t)i);
    if (dpt_hull_create(growing->block, dpt_hull_bytes(&def), &def, &growing->hull) != DPT_OK)
        return 0;
    dpt_hull_get_info(growing->hull, &info);
    growing->corner_count = info.corners;
    growing->middle = (vec3){ 0.0, 0.0, 0.0 };
    for (uint32_t i = 0; i < info.corners; i++) {
        dpt_hull_get_corner(growing->hull, i, corners);
        growing->corner[i] = vec3_of(corners);
        growing->middle = along(growing->middle, 1.0 / info.corners, growing->corner[i]);
    }
    growing->face_count = info.faces;
    for (uint32_t f = 0; f < info.faces; f++) {
        const uint32_t count = face_of(growing, f, face);
        vec3 normal = { 0.0, 0.0, 0.0 };
        for (uint32_t i = 2; i < count; i++)
            normal = add(normal, cross(sub(face[i - 1], face[0]), sub(face[i], face[0])));
        growing->normal[f] = unit_of(normal);
        growing->height[f] = dot(growing->normal[f], face[0]);
    }
    return 1;
}

/* m: how far a point is from the hull's surface. */
static double distance_of(const struct growing *growing, vec3 point)
{
    vec3 face[CORNERS_MAX];
    double least2 = HUGE_VAL;
    for (uint32_t f = 0; f < growing->face_count; f++) {
        const uint32_t count = face_of(growing, f, face);
        for (uint32_t i = 2; i < count; i++) {
            const vec3 triangle[3] = { face[0], face[i - 1], face[i] };
            pair found;
            point_triangle(point, triangle, &found);
            least2 = min_of(least2, found.distance2);
        }
    }
    return sqrt(least2);
}

/* m: how far a point stands out of a face at most. Beyond a sharp edge that is less than it is away. */
static double excess_of(const struct growing *growing, vec3 point)
{
    double max = -HUGE_VAL;
    for (uint32_t f = 0; f < growing->face_count; f++)
        max = max_of(max, dot(growing->normal[f], point) - growing->height[f]);
    return max;
}

/* The farthest of the points that may stand out by a measure, or DPT_NONE. */
static uint32_t farthest_by(const struct growing *growing, double measure(const struct growing *growing, vec3 point))
{
    const double same = AS_FAR * growing->size;
    uint32_t farthest = DPT_NONE;
    double max = STANDS_OUT * growing->size, max_off = 0.0;
    for (size_t i = 0; i < growing->outside_count; i++) {
        const vec3 point = point_of(growing, growing->outside[i]);
        const double out = measure(growing, point);
        const double off = length(sub(point, growing->middle));
        if (!(out > max - same) || (out < max + same && off <= max_off))
            continue;
        max = max_of(max, out);
        max_off = off;
        farthest = growing->outside[i];
    }
    return farthest;
}

/* The next corner, or DPT_NONE. Points inside are not looked at again. */
static uint32_t farthest_out(struct growing *growing)
{
    const int is_flat = length(growing->plane) > 0.0;
    uint32_t farthest = DPT_NONE;
    size_t kept = 0;
    for (size_t i = 0; i < growing->outside_count && !is_flat; i++)
        if (excess_of(growing, point_of(growing, growing->outside[i])) > 0.0)
            growing->outside[kept++] = growing->outside[i];
    growing->outside_count = is_flat ? growing->outside_count : kept;
    if (!is_flat)
        farthest = farthest_by(growing, excess_of);
    return farthest != DPT_NONE ? farthest : farthest_by(growing, distance_of);
}

static void add_corner(struct growing *growing, uint32_t point)
{
    growing->corner[growing->corner_count++] = point_of(growing, point);
}

/* How far a point is from what its first `count` corners span: a point, a line, a plane. */
static double distance_from(const struct growing *growing, uint32_t count, vec3 point)
{
    const vec3 *corner = growing->corner, off = sub(point, corner[0]);
    if (count == 1)
        return length(off);
    const vec3 along_line = unit_of(sub(corner[1], corner[0]));
    if (count == 2)
        return length(cross(off, along_line));
    return fabs(dot(off, unit_of(cross(along_line, sub(corner[2], corner[0])))));
}

/* The point that is farthest from what the first `count` corners span, and how far that is. */
static uint32_t farthest_from(const struct growing *growing, uint32_t count, double *max)
{
    uint32_t farthest = 0;
    *max = 0.0;
    for (size_t i = 0; i < growing->point_count; i++) {
        const double distance = distance_from(growing, count, point_of(growing, i));
        if (distance > *max) {
            *max = distance;
            farthest = (uint32_t)i;
        }
    }
    return farthest;
}

/* Three or four points that are far from each other. Returns 0 if all lie on one line. */
static int begin(struct growing *growing)
{
    double max;
    growing->corner[0] = point_of(growing, 0);
    growing->corner[0] = point_of(growing, farthest_from(growing, 1, &growing->size));
    growing->corner_count = 1;
    for (uint32_t count = 1; count < 4; count++) {
        const uint32_t farthest = farthest_from(growing, count, &max);
        if (count < 3 && !(max > FLAT * growing->size))
            return 0;
        if (count == 3 && !(max > FLAT * growing->size)) {
            const vec3 *corner = growing->corner;
            growing->plane = unit_of(cross(sub(corner[1], corner[0]), sub(corner[2], corner[0])));
            break;
        }
        add_corner(growing, farthest);
    }
    return make_hull(growing);
}

static dpt_result grow(struct growing *growing, uint32_t capacity, double *radius)
{
    if (!begin(growing))
        return DPT_E_ARGUMENT;
    for (size_t i = 0; i < growing->point_count; i++)
        growing->outside[growing->outside_count++] = (uint32_t)i;
    uint32_t next = farthest_out(growing);
    for (; next != DPT_NONE && growing->corner_count < capacity; next = farthest_out(growing)) {
        add_corner(growing, next);
        if (make_hull(growing))
            continue;
        growing->corner_count--;
        make_hull(growing);
        break;
    }
    *radius = 0.0;
    for (size_t i = 0; i < growing->outside_count; i++) {
        const vec3 point = vec3_of(growing->points + 3 * (size_t)growing->outside[i]);
        *radius = max_of(*radius, ROUNDED_UP * distance_of(growing, point));
    }
    if (*radius <= STANDS_OUT * growing->size)
        *radius = 0.0;
    return DPT_OK;
}

static dpt_result check_points(const double *points, size_t count)
{
    for (size_t i = 0; i < 3 * count; i++)
        if (!within(points[i], DPT_COORDINATE_MAX))
            return DPT_E_FINITE;
    return DPT_OK;
}

dpt_result dpt_compile_hull(const double *points, size_t point_count, double *corners, uint32_t capacity,
                            uint32_t *corner_count, double *radius)
{
    struct growing growing = { .points = points, .point_count = point_count };
    double any[3 * CORNERS_MAX] = { 0.0 };
    const dpt_hull_def largest = { .size = sizeof largest, .corner_count = CORNERS_MAX, .corners = any };
    if (!points || !corners || !corner_count || !radius || point_count < 3 || point_count > COUNT_MAX || capacity < 4 ||
        capacity > CORNERS_MAX)
        return DPT_E_ARGUMENT;
    DPT_TRY(check_points(points, point_count));
    growing.block = malloc(dpt_hull_bytes(&largest));
    growing.outside = malloc(point_count * sizeof *growing.outside);
    dpt_result result = growing.block && growing.outside ? grow(&growing, capacity, radius) : DPT_E_MEMORY;
    if (result == DPT_OK) {
        *corner_count = 0;
        while (dpt_hull_get_corner(growing.hull, *corner_count, corners + 3 * (size_t)*corner_count) == DPT_OK)
            ++*corner_count;
    }
    free(growing.block);
    free(growing.outside);
    return result;
}
