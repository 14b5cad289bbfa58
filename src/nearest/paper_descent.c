/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The triangles of a ring go 16 at a time through the tree's filter (kernel_ops.h). Those that its bounds leave open
 * are evaluated in double: all that could be as near as the best, so that ties are decided among the same triangles as
 * without a filter.
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
    const uint32_t *from_corners; /* corners of the triangle from which this step starts */
    int shared;                   /* number of vertices that the best triangle shares with it */
    struct filter_segment segment;
    /* A block of neighbours that wait for their test: how many, their places, their rows for the kernel. */
    uint32_t block_count;
    uint32_t block_places[LANES];
    float block_rows[MESH_LEAF_WORDS];
};

static void try_neighbour(struct descent *d, uint32_t neighbour)
{
    const struct surface *surface = d->surface;
    struct pair_search *best = d->best;
    pair found = dpti_triangle_pair(surface, neighbour, d->a, d->u);
    if (found.distance2 > best->pair.distance2)
        return;
    int shared = shared_corners(d->from_corners, 3, surface->corners + 3 * (size_t)neighbour);
    if (found.distance2 == best->pair.distance2) {
        if (shared < d->shared)
            return;
        if (shared == d->shared && surface->sources[neighbour] > surface->sources[best->triangle])
            return;
    }
    best->pair = found;
    best->triangle = neighbour;
    d->shared = shared;
    filter_segment_set_limit(&d->segment, surface, sqrt(found.distance2));
}

/* Evaluate the block's triangles. Lanes from block_count on hold old triangles; their bounds are not used. */
static void try_block(struct descent *d)
{
    struct planes planes;
    float bound[LANES];
    uint32_t lanes = (1u << d->block_count) - 1;
    lanes &= d->kernel->triangles(d->block_rows, &d->segment, &planes, bound);
    work_spend(d->work, 1);
    d->block_count = 0;
    while (lanes) {
        uint32_t lane = lowest_lane(bound, lanes);
        lanes &= ~(1u << lane);
        if (bound[lane] > d->segment.limit)
            return;
        try_neighbour(d, d->block_places[lane]);
    }
}

static void put_neighbour(struct descent *d, uint32_t neighbour)
{
    const float *leaf = surface_leaf(d->surface, neighbour / LANES, d->work);
    for (uint32_t row = 0; row < MESH_LEAF_WORDS; row += LANES)
        d->block_rows[row + d->block_count] = leaf[row + neighbour % LANES];
    d->block_places[d->block_count++] = neighbour;
    if (d->block_count == LANES)
        try_block(d);
}

/* Move to the nearest neighbour and return 1 if it is nearer; else 0, as on a triangle that the axis crosses. */
static int move_to_nearest(struct descent *d)
{
    const uint32_t *first, *fans = surface_fans(d->surface, &first);
    uint32_t from = d->best->triangle;
    const uint32_t *from_corners = d->surface->corners + 3 * (size_t)from;
    if (d->best->pair.distance2 == 0.0)
        return 0;
    d->from_corners = from_corners;
    d->shared = 4; /* more than any neighbour shares: staying wins every tie */
    for (int k = 0; k < 3; k++)
        for (uint32_t i = first[from_corners[k]]; i < first[from_corners[k] + 1]; i++) {
            const uint32_t *corners = d->surface->corners + 3 * (size_t)fans[i];
            if (fans[i] == from || shared_corners(from_corners, k, corners))
                continue; /* itself, or in the fan of an earlier corner too */
            put_neighbour(d, fans[i]);
        }
    if (d->block_count)
        try_block(d);
    return d->best->triangle != from;
}

void dpti_paper_descend(const struct surface *surface, const struct kernel *kernel, vec3 a, vec3 u, int one_step,
                        struct work *work, struct pair_search *nearest)
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
    d.block_count = 0;
    memset(d.block_rows, 0, sizeof d.block_rows);
    filter_segment_set_frame(&d.segment, filter_segment_set_axis(&d.segment, surface, a, u));
    filter_segment_set_limit(&d.segment, surface, sqrt(nearest->pair.distance2));
    while (move_to_nearest(&d) && !one_step)
        ;
}
