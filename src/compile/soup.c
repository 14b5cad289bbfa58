/* SPDX-License-Identifier: BSD-3-Clause */
#include "compile/soup.h"

#include <math.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/return_if_error.h"
#include "compile/compile_context.h"

#define COUNT_MAX     ((size_t)INT32_MAX)
#define TRIANGLES_MAX ((size_t)UINT32_MAX / 3) /* half-edges are numbered in 32 bits */

void soup_init(soup *source, const struct compile_context *context)
{
    memset(source, 0, sizeof *source);
    source->context = context;
}

void soup_free(soup *source)
{
    free(source->positions);
    free(source->corners);
    free(source->polygons);
    memset(source, 0, sizeof *source);
}

static dpt_result no_memory(soup *source, source_location location)
{
    return compile_fail(source->context, DPT_E_MEMORY, location, "memory ran out after %zu vertices and %zu triangles",
                        source->vertex_count, source->triangle_count);
}

dpt_result soup_add_vertex(soup *source, double x, double y, double z, source_location location)
{
    const double source_xyz[3] = { x, y, z }, scale = source->context->scale;
    if (source->vertex_count >= COUNT_MAX)
        return compile_fail(source->context, DPT_E_LIMIT, location, "more than %zu vertices", COUNT_MAX);
    if (source->vertex_count == source->vertex_capacity) {
        float *bigger =
            grow_array(source->positions, &source->vertex_capacity, source->vertex_count + 1, 3 * sizeof *bigger);
        if (!bigger)
            return no_memory(source, location);
        source->positions = bigger;
    }
    float *position = source->positions + 3 * source->vertex_count;
    for (int i = 0; i < 3; i++) {
        double product = scale * source_xyz[i];
        if (!(fabs(product) <= DPT_COORDINATE_MAX))
            return compile_fail(source->context, DPT_E_FINITE, location,
                                "%c is %.9g (times %.9g): not finite, or beyond %.0f m", "xyz"[i], source_xyz[i], scale,
                                DPT_COORDINATE_MAX);
        position[i] = (float)product;
        if (position[i] == 0.0f)
            position[i] = 0.0f; /* -0 becomes 0: positions are compared by their bits later */
        double error = fabs((double)position[i] - product);
        if (error > source->rounding)
            source->rounding = error;
    }
    source->vertex_count++;
    return DPT_OK;
}

static dpt_result reserve_polygon(soup *source, size_t added_triangles, source_location location)
{
    if (added_triangles > TRIANGLES_MAX - source->triangle_count)
        return compile_fail(source->context, DPT_E_LIMIT, location, "more than %zu triangles", TRIANGLES_MAX);
    if (added_triangles > source->triangle_capacity - source->triangle_count) {
        uint32_t *bigger = grow_array(source->corners, &source->triangle_capacity,
                                      source->triangle_count + added_triangles, 3 * sizeof *bigger);
        if (!bigger)
            return no_memory(source, location);
        source->corners = bigger;
    }
    if (added_triangles > 1 && source->polygon_count == source->polygon_capacity) {
        soup_polygon_span *bigger =
            grow_array(source->polygons, &source->polygon_capacity, source->polygon_count + 1, sizeof *bigger);
        if (!bigger)
            return no_memory(source, location);
        source->polygons = bigger;
    }
    return DPT_OK;
}

dpt_result soup_add_polygon(soup *source, const uint32_t *corners, size_t n, source_location location)
{
    DPT_TRY(reserve_polygon(source, n - 2, location));
    if (source->triangle_count == 0) {
        source->highest_corner = corners[0];
        source->highest_location = location;
    }
    for (size_t i = 0; i < n; i++) {
        if (corners[i] > source->highest_corner) {
            source->highest_corner = corners[i];
            source->highest_location = location;
        }
    }
    if (n > 3)
        source->polygons[source->polygon_count++] =
            (soup_polygon_span){ location, (uint32_t)source->triangle_count, (uint32_t)n };
    for (size_t i = 1; i + 1 < n; i++) {
        uint32_t *triangle = source->corners + 3 * source->triangle_count++;
        triangle[0] = corners[0];
        triangle[1] = corners[i];
        triangle[2] = corners[i + 1];
    }
    return DPT_OK;
}

dpt_result soup_check_corners(soup *source)
{
    if (source->triangle_count == 0 || source->highest_corner < source->vertex_count)
        return DPT_OK;
    return compile_fail(source->context, DPT_E_INDEX, source->highest_location,
                        "a polygon names vertex %u, counted from %u, and there are only %zu",
                        (unsigned)(source->highest_corner + source->base), (unsigned)source->base,
                        source->vertex_count);
}
