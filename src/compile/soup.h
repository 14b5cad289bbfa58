/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A soup is what a reader delivers: vertices and polygons in the order of the file. Nothing is repaired yet.
 *
 * Every later answer refers to these positions. A vertex is stored as (float)(scale * source), the product in double.
 * soup_add_vertex rounds, and refuses coordinates that are not finite or beyond DPT_COORDINATE_MAX; soup_recentre does it
 * of a mesh that is moved.
 */
#ifndef DPT_COMPILE_SOUP_H
#define DPT_COMPILE_SOUP_H

#include "compile/compile_context.h"

/* A polygon of more than three corners. It is stored as corners - 2 triangles, a fan of its first corner at first. */
typedef struct soup_polygon_span {
    source_location location;
    uint32_t first_triangle; /* by source number */
    uint32_t corners;
} soup_polygon_span;

typedef struct soup {
    float *positions;            /* 3 per vertex, m */
    uint32_t *corners;           /* 3 per triangle: vertices by source number, from 0 */
    soup_polygon_span *polygons; /* those of more than three corners */
    size_t vertex_count, vertex_capacity, exact_capacity;
    size_t triangle_count, triangle_capacity;
    size_t polygon_count, polygon_capacity;
    double rounding;                  /* largest |stored - (scale * source - origin)| of a coordinate, m */
    double *exact;                    /* 3 per vertex, scale * source, m: of a mesh that will be moved; else NULL */
    double origin[3];                 /* m; of soup_recentre */
    uint32_t highest_corner;          /* the highest vertex number in any polygon */
    source_location highest_location; /* of that polygon, for the message if there is no such vertex */
    uint32_t concave_polygons;        /* of soup_cut_polygons */
    uint32_t base;                    /* number of the first vertex in the file's own counting, 0 or 1 */
    const struct compile_context *context;
} soup;

/* Make an empty soup. The context must stay valid: it holds the scale and the diag. */
void soup_init(soup *soup, const struct compile_context *context);
void soup_free(soup *soup);

/* Add a vertex, in units of the source. Returns DPT_OK, or fills the diag and returns its code. */
dpt_result soup_add_vertex(soup *soup, double x, double y, double z, source_location location);

/* Add a polygon of n >= 3 corners, vertex numbers from 0. Returns as soup_add_vertex. */
dpt_result soup_add_polygon(soup *soup, const uint32_t *corners, size_t n, source_location location);

/*
 * Call after the last polygon. DPT_E_INDEX if a corner names no vertex; the diag gives the location of the highest one.
 */
dpt_result soup_check_corners(soup *soup);

/*
 * Call after soup_check_corners. If the def asks for it, moves the mesh: the origin becomes the centre of the box of all
 * that polygons use, in few digits. DPT_E_FINITE if a coordinate is beyond DPT_COORDINATE_MAX then.
 */
dpt_result soup_recentre(soup *soup);

/*
 * Compare the rounding with the median edge of the triangles. More than a thousandth of it is noted; more than a tenth is
 * DPT_E_FINITE, unless the mesh was moved.
 */
dpt_result soup_check_rounding(const soup *soup);

/*
 * Call after soup_recentre, once. Concave polygons are cut by their ears, in place and into as many triangles; all
 * others stay fans. Fills in concave_polygons: those with a corner that turns against the polygon's mean normal. Notes
 * what cannot be cut, and stays a fan: polygons that cross themselves, or are not planar. Returns as soup_add_vertex.
 */
dpt_result soup_cut_polygons(soup *soup);

/*
 * The readers: parse all bytes of a file into vertices and polygons. Time and memory are linear in `size`; no count in
 * the file decides how much is allocated. In text, LF, CR LF and CR end a line.
 */
dpt_result read_obj(soup *soup, const unsigned char *bytes, size_t size);
dpt_result read_stl(soup *soup, const unsigned char *bytes, size_t size);
dpt_result read_ply(soup *soup, const unsigned char *bytes, size_t size);
dpt_result read_off(soup *soup, const unsigned char *bytes, size_t size);

/*
 * Find out which format the bytes are in: DPT_FORMAT_...
 *
 *   1. by content: "ply", "OFF", an STL whose length fits its count, or "solid" followed by "facet"
 *   2. by the file name extension of `path`, which may be NULL
 *   3. OBJ if a line begins with `v `
 *
 * DPT_FORMAT_AUTO if nothing fits, or if the file is a .dpa or in a foreign format (foreign.h).
 */
uint32_t source_format(const char *path, const unsigned char *bytes, size_t size);

/* Read a file with the reader of `format`. DPT_FORMAT_AUTO gives DPT_E_EMPTY or DPT_E_FORMAT. */
dpt_result read_source(soup *soup, uint32_t format, const unsigned char *bytes, size_t size);

#endif
