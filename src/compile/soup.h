/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What a reader hands over: corner positions and polygons in the order of the file, nothing mended.
 *
 * The mesh that is the truth begins here: a vertex is stored once, as (float)(scale * source), the
 * product in double. soup_add_vertex is the only place that rounds, and that refuses coordinates which
 * are not finite or beyond DPT_COORDINATE_MAX.
 */
#ifndef DPT_COMPILE_SOUP_H
#define DPT_COMPILE_SOUP_H

#include <stddef.h>
#include <stdint.h>

#include "dynpoint/compile.h"

#define CREASE_DEFAULT 1.0471975511965976 /* pi / 3 */

/* A place in the source: a line from 1, or (line 0) a byte offset from 0. */
typedef struct source_location {
    uint64_t line;
    uint64_t byte;
} source_location;

/* A polygon of more than three corners: its fan's first triangle, and how many corners it has. */
typedef struct soup_polygon_span {
    uint32_t first_triangle;
    uint32_t corners;
} soup_polygon_span;

typedef struct soup {
    float *positions;  /* 3 per vertex */
    uint32_t *corners; /* 3 per triangle: numbers of vertices */
    soup_polygon_span *polygons;
    size_t vertex_count, vertex_capacity;
    size_t triangle_count, triangle_capacity;
    size_t polygon_count, polygon_capacity;
    double scale;
    double crease;                    /* rad */
    uint32_t threads;                 /* 1..PARALLEL_MAX */
    double rounding;                  /* largest |stored - scale * source| of a coordinate */
    uint32_t highest_corner;          /* the highest vertex number that a polygon named */
    source_location highest_location; /* and where: to name the line if there is no such vertex */
    uint32_t base;                    /* what the source calls its first vertex */
    const dpt_compile_def *def;       /* for its progress callback */
    dpt_diag *diag;                   /* never NULL in here */
} soup;

/* All return DPT_OK or fill the diag and return its code. `corners` of soup_add_polygon: n >= 3 numbers. */
void soup_init(soup *soup, const dpt_compile_def *def, dpt_diag *diag);
void soup_free(soup *soup);
dpt_result soup_add_vertex(soup *soup, double x, double y, double z, source_location location);
dpt_result soup_add_polygon(soup *soup, const uint32_t *corners, size_t n,
                            source_location location);

/* After the last polygon: refuse corners beyond the last vertex, by the place of the highest. */
dpt_result soup_check_corners(soup *soup);

/* How many polygons are concave: a corner of the fan turns against the polygon's mean normal. */
uint32_t soup_concave_polygons(const soup *soup);

/* Fill the diag (printf-like text, cut to fit) and return `code`. */
dpt_result soup_fail(soup *soup, dpt_result code, source_location location, const char *format, ...)
#ifdef __GNUC__
    __attribute__((format(printf, 4, 5)))
#endif
    ;

/* Report progress of a step; DPT_OK or DPT_E_CANCELLED. */
dpt_result soup_report_progress(soup *soup, const char *step, double done);

/*
 * The readers: all of a file's bytes in, vertices and polygons out. Time and memory linear in `size`;
 * nothing is taken by a count that the file announces. The text formats take LF, CR LF and CR.
 */
dpt_result read_obj(soup *soup, const unsigned char *bytes, size_t size);
dpt_result read_stl(soup *soup, const unsigned char *bytes, size_t size);
dpt_result read_ply(soup *soup, const unsigned char *bytes, size_t size);
dpt_result read_off(soup *soup, const unsigned char *bytes, size_t size);

/*
 * Which format the bytes are in: by content where it tells (ply, OFF, an STL whose length fits its
 * count, "solid" followed by "facet"), else by the ending of `path` (may be NULL), else OBJ when a line
 * begins with `v `. DPT_FORMAT_AUTO when nothing fits, or it is a .dpa.
 */
uint32_t source_format(const char *path, const unsigned char *bytes, size_t size);

/* By the reader of a format; DPT_E_EMPTY or DPT_E_FORMAT for DPT_FORMAT_AUTO. */
dpt_result read_source(soup *soup, uint32_t format, const unsigned char *bytes, size_t size);

#endif
