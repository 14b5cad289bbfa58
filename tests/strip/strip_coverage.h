/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * How much of what is under a tool a strip holds, at poses where the tool lies on the surface: its surface between 0
 * and `margin` from the mesh. Against every triangle of the mesh. Sizes are of the mesh's diagonal: margin 0.01, radius
 * 0.005, and the length that is asked for; the depth is what a world takes, a quarter of the length, radius and margin.
 */
#ifndef DPT_TESTS_STRIP_RECALL_H
#define DPT_TESTS_STRIP_RECALL_H

#include "strip/strip_scene.h"

/*
 * Sums over poses. `near`: triangles within the margin of the tool; strips: the paper's, and shadows of these widths.
 */
enum { COVERAGE_ROUTES, COVERAGE_NARROW, COVERAGE_WIDE, COVERAGE_STRIPS }; /* width 0 and margin */

struct coverage {
    size_t poses, apart; /* where the paper's has no route, which counts as an empty strip */
    size_t near;
    size_t size[COVERAGE_STRIPS];     /* triangles of the strip */
    size_t found[COVERAGE_STRIPS];    /* of those that are near */
    size_t sheet[COVERAGE_STRIPS];    /* that meet the shadow and hang together over vertices */
    size_t in_strip[COVERAGE_STRIPS]; /* of them in the strip */
};

static inline uint32_t nearest_to(const struct scene *scene, const double at[3])
{
    const double ends[6] = { at[0], at[1], at[2], at[0], at[1], at[2] };
    return nearest_of(scene, ends, 0).triangle;
}

/* Of a tool as long as this share of the diagonal. */
void coverage_of(const struct subject *subject, double share, size_t poses, uint64_t seed, struct coverage *coverage);

static inline double share_of(size_t part, size_t whole)
{
    return whole ? (double)part / (double)whole : 1;
}

#endif
