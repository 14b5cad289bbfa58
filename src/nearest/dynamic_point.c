/* SPDX-License-Identifier: BSD-3-Clause */
#include "nearest/dynamic_point.h"

#include "mesh/corners.h"
#include "nearest/bvh.h"
#include "nearest/filter_segment.h"

void dpti_dynamic_point_once(const struct surface *surface, const struct kernel *kernel, uint32_t method,
                             const struct axis *axis, uint32_t hint, struct work *work, struct pair_search *nearest)
{
    *nearest = (struct pair_search){ .pair = { .distance2 = HUGE_VAL }, .triangle = DPT_NONE };
    if (method == DPT_METHOD_BRUTE) {
        dpti_brute_search(surface, axis->local_a, axis->u, work, nearest);
        return;
    }
    if (hint != DPT_NONE)
        nearest->pair.distance2 = dpti_triangle_pair(surface, hint, axis->local_a, axis->u).distance2;
    if (extent_of(axis->u) > 0.0) {
        dpti_bvh_search(surface, kernel, axis->local_a, axis->u, work, nearest);
        return;
    }
    struct bvh_traversal traversal;
    traversal.level = 0;
    dpti_point_search(surface, kernel, axis->local_a, &traversal, work, nearest);
}

/* The most triangles that are tried around a vertex: hubs have thousands. */
enum { FAN_TRIED_MAX = 16 };

/* Where the list is full, the search evaluates the triangle again. */
static void exclude_triangle(struct pair_search *nearest, uint32_t triangle)
{
    if (nearest->excluded_count < EXCLUDED_MAX)
        nearest->excluded[nearest->excluded_count++] = triangle;
}

/* Move to this triangle and return 1 if it is nearer; else exclude it and return 0. */
static int try_neighbour(const struct surface *surface, const struct axis *axis, uint32_t triangle,
                         struct pair_search *nearest)
{
    if (triangle >= surface_triangles(surface) || triangle == nearest->triangle)
        return 0;
    if (!dpti_triangle_is_beyond(surface, &nearest->plane, triangle)) {
        pair found = dpti_triangle_pair(surface, triangle, axis->local_a, axis->u);
        if (found.distance2 < nearest->pair.distance2) {
            exclude_triangle(nearest, nearest->triangle);
            nearest->pair = found;
            nearest->triangle = triangle;
            __builtin_prefetch(&surface->sources[triangle]);
            return 1;
        }
    }
    exclude_triangle(nearest, triangle);
    return 0;
}

/* Move to the first triangle around a vertex that is nearer, and return 1; 0 if none is. */
static int try_fan(const struct surface *surface, const struct axis *axis, uint32_t vertex, struct pair_search *nearest)
{
    const uint32_t *first, *fans = surface_fans(surface, &first);
    uint32_t begin = first[vertex], end = first[vertex + 1];
    end = end - begin > FAN_TRIED_MAX ? begin + FAN_TRIED_MAX : end;
    for (uint32_t i = begin; i < end; i++)
        if (try_neighbour(surface, axis, fans[i], nearest))
            return 1;
    return 0;
}

void dpti_dynamic_point_descend(const struct surface *surface, const struct axis *axis, struct work *work,
                                struct pair_search *nearest)
{
    int has_moved = 1;
    while (has_moved && nearest->pair.distance2 > 0.0 && !work_is_spent(work)) {
        const double *weight = nearest->pair.weight;
        size_t here = nearest->triangle;
        int zeros = (weight[0] <= 0.0) + (weight[1] <= 0.0) + (weight[2] <= 0.0);
        if (!zeros)
            return;
        dpti_pair_search_update_plane(nearest, axis->local_a, axis->u, DISTANCE_ERROR_SLACK * axis->error);
        work_spend(work, 1);
        if (zeros == 1) {
            uint32_t edge = weight[0] <= 0.0 ? 1 : weight[1] <= 0.0 ? 2 : 0;
            uint32_t neighbour = surface_neighbours(surface)[3 * here + edge];
            has_moved = try_neighbour(surface, axis, neighbour, nearest);
        } else {
            uint32_t corner = weight[0] > 0.0 ? 0 : weight[1] > 0.0 ? 1 : 2;
            has_moved = try_fan(surface, axis, surface->corners[3 * here + corner], nearest);
        }
    }
}

/*
 * Look for a triangle that the axis goes through. Begin at `triangle`; while the axis passes it, go on over the edge
 * beside which it passes. Returns 1 and sets `nearest` if there is one. As a rule no distance is computed.
 */
static int find_crossed(const struct surface *surface, const struct axis *axis, uint32_t triangle, struct work *work,
                        struct pair_search *nearest)
{
    enum { CROSSED_TRIED_MAX = 8 };
    const uint32_t *neighbours = surface_neighbours(surface);
    for (int i = 0; i < CROSSED_TRIED_MAX && triangle < surface_triangles(surface); i++) {
        __builtin_prefetch(&neighbours[3 * (size_t)triangle]);
        __builtin_prefetch(&surface->sources[triangle]);
        struct pierce pierce = triangle_pierce(surface, triangle, axis->local_a, axis->u);
        int is_beside = pierce_misses(&pierce);
        pair found;
        if (!is_beside && !pair_on_pierced(&found, &pierce))
            /* Triple products leave it open, as on a sliver. */
            found = dpti_triangle_pair(surface, triangle, axis->local_a, axis->u);
        if (!is_beside && found.distance2 == 0.0) {
            nearest->pair = found;
            nearest->triangle = triangle;
            return 1;
        }
        if (!is_beside || work_is_spent(work))
            return 0;
        const double *side = pierce.side;
        uint32_t edge_passed = side[0] < side[1] ? 0u : 1u;
        edge_passed = side[2] < side[edge_passed] ? 2 : edge_passed;
        triangle = neighbours[3 * (size_t)triangle + (edge_passed + 1) % 3];
        work_spend(work, 1);
    }
    return 0;
}

void dpti_dynamic_point_begin(struct dynamic_point *track, const struct surface *surface, uint32_t last, double limit2,
                              enum descent_mode mode, struct work *work)
{
    struct pair_search *nearest = &track->nearest;
    const struct axis *axis = &track->axis;
    nearest->pair.distance2 = limit2;
    nearest->triangle = DPT_NONE;
    nearest->excluded_count = nearest->plane_owner = 0;
    track->last = last;
    if (last == DPT_NONE && limit2 < HUGE_VAL)
        return;
    uint32_t triangle = last == DPT_NONE ? 0 : last;
    if (mode == DESCENT_CROSSED && last != DPT_NONE && find_crossed(surface, axis, last, work, nearest)) {
        track->last_pair = (pair){ .distance2 = HUGE_VAL };
        return;
    }
    __builtin_prefetch(&surface_neighbours(surface)[3 * (size_t)triangle]);
    track->last_pair = dpti_triangle_pair(surface, triangle, axis->local_a, axis->u);
    if (!(track->last_pair.distance2 < limit2)) {
        track->last = DPT_NONE;
        return;
    }
    nearest->pair = track->last_pair;
    nearest->triangle = triangle;
    if (mode != DESCENT_NONE && last != DPT_NONE)
        dpti_dynamic_point_descend(surface, axis, work, nearest);
}

int dpti_dynamic_point_prove(struct dynamic_point *track, const struct surface *surface, const struct kernel *kernel,
                             const struct plane_cache_view *cache, struct bvh_traversal *traversal, struct work *work)
{
    if (track->nearest.pair.distance2 == 0.0)
        return 1;
    struct bvh_search search;
    search.surface = surface;
    search.kernel = kernel;
    search.a = track->axis.local_a;
    search.u = track->axis.u;
    search.slack = track->last == DPT_NONE ? 0.0 : DISTANCE_ERROR_SLACK * track->axis.error;
    search.cache = cache ? *cache : (struct plane_cache_view){ .count = 0 };
    search.work = work;
    search.traversal = traversal;
    search.nearest = &track->nearest;
    return dpti_bvh_traverse(&search);
}

void dpti_dynamic_point_settle(struct dynamic_point *track)
{
    struct pair_search *nearest = &track->nearest;
    if (track->last == DPT_NONE || nearest->triangle == track->last || nearest->triangle == DPT_NONE)
        return;
    if (sqrt(track->last_pair.distance2) <=
        sqrt(nearest->pair.distance2) + DISTANCE_ERROR_HISTORY * track->axis.error) {
        nearest->pair = track->last_pair;
        nearest->triangle = track->last;
    }
}

/* ---- the paper's descent ---- */

/*
 * The triangles of a ring go 16 at a time through the tree's filter (kernel_ops.h). Those that its bounds leave open
 * are evaluated in double: all that could be as near as the best, so that ties are decided among the same triangles as
 * without a filter.
 */
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

static void evaluate_neighbour(struct descent *d, uint32_t neighbour)
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
        evaluate_neighbour(d, d->block_places[lane]);
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
