/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A ring's triangles go 16 at a time through the filter of the tree (kernel_ops.h), and only what its bounds
 * leave open is evaluated in double: all that could be as near as the best, so that ties are judged among
 * the same triangles as without a filter.
 */
#include "nearest/paper_descent.h"

#include "mesh/corners.h"
#include "nearest/filter_segment.h"

struct descent {
    const struct surface *surface;
    const struct kernel *kernel;
    struct pair_search *best;
    struct work *work;
    vec3 a, u;
    const uint32_t *here; /* corners of the triangle that is left */
    int shared;           /* vertices that the best has in common with it */
    struct filter_segment probe;
    uint32_t count; /* triangles in the block, and their places */
    uint32_t place[LANES];
    float rows[MESH_LEAF_WORDS];
};

static void try_neighbour(struct descent *d, uint32_t neighbour)
{
    const struct surface *surface = d->surface;
    struct pair_search *best = d->best;
    pair found = dpti_triangle_pair(surface, neighbour, d->a, d->u);
    if (found.distance2 > best->pair.distance2)
        return;
    int shared = shared_corners(d->here, 3, surface->corners + 3 * (size_t)neighbour);
    if (found.distance2 == best->pair.distance2) {
        if (shared < d->shared)
            return;
        if (shared == d->shared && surface->sources[neighbour] > surface->sources[best->triangle])
            return;
    }
    best->pair = found;
    best->triangle = neighbour;
    d->shared = shared;
    filter_segment_set_limit(&d->probe, surface, sqrt(found.distance2));
}

/* Lanes from `count` on hold what was there before: kernels read them, no one asks for their bounds. */
static void try_block(struct descent *d)
{
    struct planes planes;
    float bound[LANES];
    uint32_t lanes = (1u << d->count) - 1;
    lanes &= d->kernel->triangles(d->rows, &d->probe, &planes, bound);
    work_spend(d->work, 1);
    d->count = 0;
    while (lanes) {
        uint32_t lane = lowest_lane(bound, lanes);
        lanes &= ~(1u << lane);
        if (bound[lane] > d->probe.limit)
            return;
        try_neighbour(d, d->place[lane]);
    }
}

static void put_neighbour(struct descent *d, uint32_t neighbour)
{
    const float *leaf = d->surface->leaves + (size_t)(neighbour / LANES) * MESH_LEAF_WORDS;
    for (uint32_t row = 0; row < MESH_LEAF_WORDS; row += LANES)
        d->rows[row + d->count] = leaf[row + neighbour % LANES];
    d->place[d->count++] = neighbour;
    if (d->count == LANES)
        try_block(d);
}

/* To the nearest neighbour, if it is nearer: 1. Nothing is nearer than a triangle that the axis crosses. */
static int move(struct descent *d)
{
    const uint32_t *first, *fans = surface_fans(d->surface, &first);
    uint32_t from = d->best->triangle;
    const uint32_t *here = d->surface->corners + 3 * (size_t)from;
    if (d->best->pair.distance2 == 0.0)
        return 0;
    d->here = here;
    d->shared = 4; /* to stay wins every tie */
    for (int k = 0; k < 3; k++)
        for (uint32_t i = first[here[k]]; i < first[here[k] + 1]; i++) {
            const uint32_t *there = d->surface->corners + 3 * (size_t)fans[i];
            if (fans[i] == from || shared_corners(here, k, there))
                continue; /* itself, or met in the fan of an earlier corner */
            put_neighbour(d, fans[i]);
        }
    if (d->count)
        try_block(d);
    return d->best->triangle != from;
}

void dpti_paper_descend(const struct surface *surface, const struct kernel *kernel, vec3 a, vec3 u,
                        int one_step, struct work *work, struct pair_search *nearest)
{
    nearest->pair = dpti_triangle_pair(surface, nearest->triangle, a, u);
    if (nearest->pair.distance2 == 0.0)
        return;
    struct descent d;
    d.surface = surface;
    d.kernel = kernel;
    d.best = nearest;
    d.work = work;
    d.a = a;
    d.u = u;
    d.count = 0;
    memset(d.rows, 0, sizeof d.rows);
    filter_segment_set_frame(&d.probe, filter_segment_set_axis(&d.probe, surface, a, u));
    filter_segment_set_limit(&d.probe, surface, sqrt(nearest->pair.distance2));
    while (move(&d) && !one_step)
        ;
}
