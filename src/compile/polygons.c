/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Polygons of more than three corners. Readers store each as the fan of its first corner. That is right for a convex one,
 * and stays. A concave one is cut by its ears (ear_cut.h), seen along the axis that is nearest to the normal of its best
 * plane: so coordinates stay as they are, and signs are exact.
 */
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "base/angle.h"
#include "base/return_if_error.h"
#include "compile/ear_cut.h"
#include "compile/soup.h"

/* A polygon is planar if no corner is farther from its best plane than this share of its box's diagonal. */
#define PLANAR_MAX 0.1

/* Why polygons were left as fans. */
enum { CROSSING, NOT_PLANAR, TOO_LONG, REASON_COUNT };

struct left_out {
    uint64_t count;
    source_location first;
    uint32_t corners; /* of the first */
};

struct polygon_work {
    soup *source;
    struct ear_cutter cutter;
    uint32_t *corners; /* of a polygon, as the file lists them */
    uint32_t *triangles;
    double (*flat)[2];
    size_t corner_capacity, triangle_capacity, flat_capacity;
    struct left_out left_out[REASON_COUNT];
};

/* What the shape of a polygon is judged by. */
struct outline {
    const float *positions;
    const uint32_t *corners;
    uint32_t n;
    vec3 normal;     /* twice the area vector */
    double rounding; /* of a coordinate: after it, a straight corner turns a little in either direction */
};

static vec3 corner_at(const struct outline *outline, uint32_t k)
{
    return vec3_of_float(outline->positions + 3 * (size_t)outline->corners[k < outline->n ? k : k - outline->n]);
}

static double sum_of_sizes(vec3 a)
{
    return fabs(a.x) + fabs(a.y) + fabs(a.z);
}

static void measure(struct outline *outline)
{
    const vec3 origin = corner_at(outline, 0);
    double max_coordinate = extent_of(origin);
    vec3 a = { 0.0, 0.0, 0.0 };
    outline->normal = a;
    for (uint32_t k = 1; k < outline->n; k++) {
        const vec3 corner = corner_at(outline, k), b = sub(corner, origin);
        outline->normal = add(outline->normal, cross(a, b));
        max_coordinate = max_of(max_coordinate, extent_of(corner));
        a = b;
    }
    outline->rounding = 4.0 * 0x1p-24 * max_coordinate;
}

/* Does a corner turn against the mean normal? */
static int is_concave(const struct outline *outline)
{
    const vec3 normal = outline->normal;
    vec3 before = corner_at(outline, outline->n - 1), here = corner_at(outline, 0);
    for (uint32_t k = 0; k < outline->n; k++) {
        const vec3 after = corner_at(outline, k + 1);
        const vec3 in = sub(here, before), out = sub(after, here);
        const double turn_along_normal = dot(cross(in, out), normal);
        const double tolerance = outline->rounding * (sum_of_sizes(in) + sum_of_sizes(out));
        if (turn_along_normal < 0.0 &&
            turn_along_normal * turn_along_normal > tolerance * tolerance * dot(normal, normal))
            return 1;
        before = here;
        here = after;
    }
    return 0;
}

/* All corners turn one way: do they turn more than once in all? A star of five lines turns twice. */
static int winds_twice(const struct outline *outline)
{
    double sum = 0.0;
    vec3 in = { 0.0, 0.0, 0.0 };
    if (outline->n < 5)
        return 0;
    for (uint32_t k = 0; k <= outline->n; k++) {
        const vec3 out = unit_of(sub(corner_at(outline, k + 1), corner_at(outline, k)));
        if (!(dot(out, out) > 0.0))
            continue;
        if (dot(in, in) > 0.0)
            sum += angle_between(in, out);
        in = out;
    }
    return sum > 1.5 * ANGLE_TURN;
}

/* Has it area, but of both signs, which cancel? */
static int has_no_normal(const struct outline *outline)
{
    const vec3 origin = corner_at(outline, 0);
    double perimeter = 0.0, max_area = 0.0;
    vec3 a = { 0.0, 0.0, 0.0 };
    for (uint32_t k = 1; k <= outline->n; k++) {
        const vec3 b = sub(corner_at(outline, k), origin);
        max_area = max_of(max_area, length(cross(a, b)));
        perimeter += sum_of_sizes(sub(b, a));
        a = b;
    }
    const double tolerance = outline->rounding * perimeter;
    return length(outline->normal) <= tolerance && max_area > 2.0 * tolerance;
}

static int is_planar(const struct outline *outline)
{
    const vec3 normal = unit_of(outline->normal);
    vec3 low = corner_at(outline, 0), high = low, sum = { 0.0, 0.0, 0.0 };
    for (uint32_t k = 0; k < outline->n; k++) {
        const vec3 corner = corner_at(outline, k);
        low = (vec3){ min_of(low.x, corner.x), min_of(low.y, corner.y), min_of(low.z, corner.z) };
        high = (vec3){ max_of(high.x, corner.x), max_of(high.y, corner.y), max_of(high.z, corner.z) };
        sum = add(sum, sub(corner, corner_at(outline, 0)));
    }
    const vec3 middle = along(corner_at(outline, 0), 1.0 / outline->n, sum);
    const double max_distance = PLANAR_MAX * length(sub(high, low));
    for (uint32_t k = 0; k < outline->n; k++)
        if (fabs(dot(normal, sub(corner_at(outline, k), middle))) > max_distance)
            return 0;
    return 1;
}

/* Look at the polygon along an axis, so that it turns counterclockwise. */
static void flatten(const struct outline *outline, double (*flat)[2])
{
    const vec3 normal = outline->normal;
    const double x = fabs(normal.x), y = fabs(normal.y), z = fabs(normal.z);
    const int axis = x >= y && x >= z ? 0 : y >= z ? 1 : 2;
    const int is_turned = (axis == 0 ? normal.x : axis == 1 ? normal.y : normal.z) < 0.0;
    for (uint32_t k = 0; k < outline->n; k++) {
        const float *position = outline->positions + 3 * (size_t)outline->corners[k];
        flat[k][is_turned] = (double)position[(axis + 1) % 3];
        flat[k][!is_turned] = (double)position[(axis + 2) % 3];
    }
}

static int reserve(struct polygon_work *work, uint32_t n)
{
    uint32_t *corners = work->corners, *triangles = work->triangles;
    double(*flat)[2] = work->flat;
    if (n > work->corner_capacity && (corners = grow_array(corners, &work->corner_capacity, n, sizeof *corners)))
        work->corners = corners;
    if (n > work->triangle_capacity &&
        (triangles = grow_array(triangles, &work->triangle_capacity, n, 3 * sizeof *triangles)))
        work->triangles = triangles;
    if (n > work->flat_capacity && (flat = grow_array(flat, &work->flat_capacity, n, sizeof *flat)))
        work->flat = flat;
    return corners && triangles && flat;
}

/* The corners of a polygon, from its fan. */
static void take_corners(const soup *source, const soup_polygon_span *span, uint32_t *corners)
{
    const uint32_t *fan = source->corners + 3 * (size_t)span->first_triangle;
    corners[0] = fan[0];
    corners[1] = fan[1];
    for (uint32_t k = 2; k < span->corners; k++)
        corners[k] = fan[3 * (size_t)(k - 2) + 2];
}

static void leave_out(struct polygon_work *work, const soup_polygon_span *span, int reason)
{
    struct left_out *left_out = &work->left_out[reason];
    if (left_out->count++ == 0) {
        left_out->first = span->location;
        left_out->corners = span->corners;
    }
}

static dpt_result cut_concave(struct polygon_work *work, const soup_polygon_span *span, const struct outline *outline)
{
    uint32_t *triangles = work->source->corners + 3 * (size_t)span->first_triangle;
    if (!is_planar(outline)) {
        leave_out(work, span, NOT_PLANAR);
        return DPT_OK;
    }
    flatten(outline, work->flat);
    switch (ear_cut(&work->cutter, (const double(*)[2])work->flat, span->corners, outline->rounding, work->triangles)) {
    case EAR_DONE:
        for (size_t k = 0; k < 3 * (size_t)(span->corners - 2); k++)
            triangles[k] = work->corners[work->triangles[k]];
        return DPT_OK;
    case EAR_CROSSING:
        leave_out(work, span, CROSSING);
        return DPT_OK;
    case EAR_TOO_LONG:
        leave_out(work, span, TOO_LONG);
        return DPT_OK;
    default:
        return DPT_E_MEMORY;
    }
}

static dpt_result cut_polygon(struct polygon_work *work, const soup_polygon_span *span)
{
    if (!reserve(work, span->corners))
        return DPT_E_MEMORY;
    take_corners(work->source, span, work->corners);
    struct outline outline = { .positions = work->source->positions, .corners = work->corners, .n = span->corners };
    measure(&outline);
    if (is_concave(&outline)) {
        work->source->concave_polygons++;
        return cut_concave(work, span, &outline);
    }
    if (winds_twice(&outline) || has_no_normal(&outline))
        leave_out(work, span, CROSSING);
    return DPT_OK;
}

static void note_left_out(const struct polygon_work *work)
{
    static const char *const reasons[REASON_COUNT] = { "crosses itself",
                                                       "is not planar, by more than a tenth of its size",
                                                       "takes too long to cut by its ears" };
    for (int reason = 0; reason < REASON_COUNT; reason++) {
        const struct left_out *left_out = &work->left_out[reason];
        if (left_out->count == 1)
            compile_note(work->source->context, left_out->first,
                         "a polygon of %" PRIu32 " corners %s: left a fan of its first corner", left_out->corners,
                         reasons[reason]);
        else if (left_out->count > 1)
            compile_note(work->source->context, left_out->first,
                         "a polygon of %" PRIu32 " corners %s: left a fan of its first corner, and %" PRIu64
                         " more like it",
                         left_out->corners, reasons[reason], left_out->count - 1);
    }
}

dpt_result soup_cut_polygons(soup *source)
{
    struct polygon_work work = { .source = source };
    dpt_result result = DPT_OK;
    source->concave_polygons = 0;
    for (size_t i = 0; result == DPT_OK && i < source->polygon_count; i++) {
        if (i % 65536 == 0)
            result = compile_report_progress(source->context, "polygons", (double)i / (double)source->polygon_count);
        if (result == DPT_OK)
            result = cut_polygon(&work, &source->polygons[i]);
    }
    if (result == DPT_OK)
        note_left_out(&work);
    if (result == DPT_E_MEMORY)
        compile_fail(source->context, result, (source_location){ 0, 0 }, "memory ran out");
    ear_cutter_free(&work.cutter);
    free(work.corners);
    free(work.triangles);
    free(work.flat);
    return result;
}
