/* SPDX-License-Identifier: BSD-3-Clause */
#include "compile/soup.h"

#include <math.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/return_if_error.h"
#include "base/vec3.h"
#include "compile/compile_context.h"
#include "mesh/mesh_format.h"

void soup_init(soup *source, const struct compile_context *context)
{
    memset(source, 0, sizeof *source);
    source->context = context;
}

void soup_free(soup *source)
{
    free(source->positions);
    free(source->exact);
    free(source->corners);
    free(source->polygons);
    memset(source, 0, sizeof *source);
}

static dpt_result no_memory(soup *source, source_location location)
{
    return compile_fail(source->context, DPT_E_MEMORY, location, "memory ran out after %zu vertices and %zu triangles",
                        source->vertex_count, source->triangle_count);
}

/* Round a coordinate, and keep account of it. */
static float rounded(soup *source, double value)
{
    float stored = (float)value;
    if (stored == 0.0f)
        stored = 0.0f; /* -0 becomes 0: positions are compared by their bits later */
    source->rounding = fmax(source->rounding, fabs((double)stored - value));
    return stored;
}

dpt_result soup_add_vertex(soup *source, double x, double y, double z, source_location location)
{
    const double source_xyz[3] = { x, y, z }, scale = source->context->scale;
    const int is_moved = source->context->recentre;
    const double max = is_moved ? MESH_ORIGIN_MAX : DPT_COORDINATE_MAX;
    if (source->vertex_count >= COUNT_MAX)
        return compile_fail(source->context, DPT_E_LIMIT, location, "more than %zu vertices", COUNT_MAX);
    if (source->vertex_count == source->vertex_capacity) {
        float *bigger =
            grow_array(source->positions, &source->vertex_capacity, source->vertex_count + 1, 3 * sizeof *bigger);
        if (!bigger)
            return no_memory(source, location);
        source->positions = bigger;
    }
    if (is_moved && source->vertex_count == source->exact_capacity) {
        double *bigger =
            grow_array(source->exact, &source->exact_capacity, source->vertex_count + 1, 3 * sizeof *bigger);
        if (!bigger)
            return no_memory(source, location);
        source->exact = bigger;
    }
    float *position = source->positions + 3 * source->vertex_count;
    for (int i = 0; i < 3; i++) {
        double product = scale * source_xyz[i];
        if (!(fabs(product) <= max))
            return compile_fail(source->context, DPT_E_FINITE, location,
                                "%c is %.9g (times %.9g): not finite, or beyond %.0f m", "xyz"[i], source_xyz[i], scale,
                                max);
        if (is_moved)
            source->exact[3 * source->vertex_count + (size_t)i] = product;
        else
            position[i] = rounded(source, product);
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

/* ---- far from the origin ---- */

/* The box of all corners, in the scaled source's frame. */
static void exact_box(const soup *source, double low[3], double high[3])
{
    for (size_t c = 0; c < 3 * source->triangle_count; c++)
        for (size_t i = 0; i < 3; i++) {
            const double x = source->exact[3 * (size_t)source->corners[c] + i];
            low[i] = c == 0 || x < low[i] ? x : low[i];
            high[i] = c == 0 || x > high[i] ? x : high[i];
        }
}

/* The power of ten that is nearest below a size; 0 for 0. */
static double digit_of(double size)
{
    double digit = size > 0.0 ? 1.0 : 0.0;
    while (digit > size)
        digit /= 10.0;
    while (digit > 0.0 && digit * 10.0 <= size)
        digit *= 10.0;
    return digit;
}

dpt_result soup_recentre(soup *source)
{
    double low[3] = { 0.0 }, high[3] = { 0.0 }, size = 0.0;
    if (!source->exact)
        return DPT_OK;
    exact_box(source, low, high);
    for (int i = 0; i < 3; i++)
        size = fmax(size, high[i] - low[i]);
    if (!(size <= DPT_COORDINATE_MAX))
        return compile_fail(source->context, DPT_E_FINITE, (source_location){ 0, 0 },
                            "the mesh is %.9g m large: at most %.0f m, also where it is moved", size,
                            DPT_COORDINATE_MAX);
    const double digit = digit_of(size);
    for (int i = 0; i < 3; i++) {
        const double centre = 0.5 * (low[i] + high[i]);
        source->origin[i] = digit > 0.0 ? digit * floor(centre / digit + 0.5) : centre;
    }
    for (size_t v = 0; v < 3 * source->vertex_count; v++) {
        const double moved = source->exact[v] - source->origin[v % 3];
        /* Only what no polygon uses can still be far away. */
        source->positions[v] = fabs(moved) <= DPT_COORDINATE_MAX ? rounded(source, moved) : 0.0f;
    }
    return DPT_OK;
}

/* Positive floats are in the order of their bits. */
static uint32_t edge_bits(const soup *source, size_t side)
{
    const uint32_t *corner = source->corners + side / 3 * 3;
    const float *a = source->positions + 3 * (size_t)corner[side % 3];
    const float *b = source->positions + 3 * (size_t)corner[(side + 1) % 3];
    const float length_of = (float)length(sub(vec3_of_float(a), vec3_of_float(b)));
    uint32_t bits;
    memcpy(&bits, &length_of, sizeof bits);
    return bits;
}

/*
 * Count the sides by 16 of their bits: by the upper ones, or, of the sides whose upper ones are `upper`, by the lower
 * ones. Sides of length 0 do not count. Returns how many do.
 */
static size_t count_sides(const soup *source, int upper, uint32_t *counts)
{
    size_t total = 0;
    memset(counts, 0, 0x10000 * sizeof *counts);
    for (size_t side = 0; side < 3 * source->triangle_count; side++) {
        const uint32_t bits = edge_bits(source, side);
        if (bits == 0 || (upper >= 0 && bits >> 16 != (uint32_t)upper))
            continue;
        counts[upper < 0 ? bits >> 16 : bits & 0xffff]++;
        total++;
    }
    return total;
}

/* Where in the counts the one of this rank is; *rank becomes its rank there. */
static uint32_t find_rank(const uint32_t *counts, size_t *rank)
{
    uint32_t found = 0;
    while (*rank >= counts[found])
        *rank -= counts[found++];
    return found;
}

/*
 * The median edge of the triangles, without edges of length 0: what rounding leaves of an edge is still compared with
 * rounding. 0 if there is none. In linear time, without a list. Returns DPT_OK or DPT_E_MEMORY.
 */
static dpt_result median_edge(const soup *source, double *median)
{
    uint32_t *counts = compile_alloc(source->context, 0x10000, sizeof *counts);
    *median = 0.0;
    if (!counts)
        return DPT_E_MEMORY;
    const size_t total = count_sides(source, -1, counts);
    if (total > 0) {
        size_t rank = total / 2;
        const uint32_t upper = find_rank(counts, &rank);
        count_sides(source, (int)upper, counts);
        const uint32_t bits = upper << 16 | find_rank(counts, &rank);
        float edge;
        memcpy(&edge, &bits, sizeof edge);
        *median = (double)edge;
    }
    free(counts);
    return DPT_OK;
}

dpt_result soup_check_rounding(const soup *source)
{
    double median;
    if (!(source->rounding > 0.0) || source->triangle_count == 0)
        return DPT_OK;
    DPT_TRY(median_edge(source, &median));
    if (median > 0.0 && source->rounding > 0.1 * median && !source->context->recentre)
        return compile_fail(
            source->context, DPT_E_FINITE, (source_location){ 0, 0 },
            "rounded by up to %.3g m, with a median edge of %.3g m: too far from the origin; --recentre moves it",
            source->rounding, median);
    if (source->rounding > 0.001 * median)
        compile_note(source->context, (source_location){ 0, 0 },
                     "rounded by up to %.3g m, with a median edge of %.3g m: far from the origin%s", source->rounding,
                     median, source->context->recentre ? ", or very fine" : "; --recentre moves it");
    return DPT_OK;
}
