/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What a compiled mesh must hold, worked out anew from the source by comparing all with all, and
 * compared with the bytes of the file. Shares nothing with the compiler but the layout of the file.
 */
#ifndef DPT_TESTS_COMPILED_H
#define DPT_TESTS_COMPILED_H

#include <math.h>

#include "lib/dpa.h"

struct source {
    const double *vertices;
    const uint32_t *corners;
    uint32_t vertex_count, triangle_count;
    double scale;
};

/* The sections, found through the public call. */
struct sections {
    struct file file;
    const dpt_mesh *mesh;
    dpt_mesh_info info;
    const float *vertices, *boxes, *leaves;
    const uint32_t *triangles, *neighbours, *fan_first, *fans, *parts, *part_table, *sources, *places, *vertex_sources;
};

/* A copy of what was compiled, open; 0 when it does not open. */
int sections_open(struct sections *s, const dpt_compiled *compiled);

static inline void sections_close(struct sections *s)
{
    free(s->file.bytes);
}

static inline float rounded(const struct source *source, uint32_t vertex, int axis)
{
    return (float)(source->scale * source->vertices[3 * (size_t)vertex + (size_t)axis]);
}

/* Every corner of the one is at a corner of the other, for triangles that are not degenerate. */
int same_corners(const struct source *source, uint32_t a, uint32_t b);

/* Which triangles there are, by number; `turned` gets each place's round, as round_of. */
void check_triangles(const struct source *source, const struct sections *s, int *turned);

void check_fans(const struct sections *s);

/* Leaf lanes hold the triangles in their order, the last one again where there are no more. */
void check_leaves(const struct sections *s);

/* Every box holds the corners of all triangles below it; a node's lanes are the next nodes down. */
void check_boxes(const struct sections *s);

/* All of it; quadratic in the triangles. */
void check_compiled(const struct source *source, const dpt_compiled *compiled);

#endif
