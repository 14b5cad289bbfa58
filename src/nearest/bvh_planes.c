/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Make separating planes for lanes of nodes and leaves whose old planes no longer close them
 * (docs/algorithms/certificate.md).
 */
#include "nearest/bvh_planes.h"

uint32_t dpti_bvh_lower_bounds(const struct bvh_search *search, const struct cached_planes *cached, float *bound)
{
    uint32_t open = 0;
    for (uint32_t i = 0; i < LANES; i++) {
        bound[i] -= cached->travel[i * cached->travel_stride];
        open |= (uint32_t) !(bound[i] > search->segment.limit) << i;
    }
    return open;
}

/* New planes as they are cached. */
static void add_travels(const struct cached_planes *cached, struct planes *planes)
{
    for (uint32_t i = 0; cached->travel && i < LANES; i++)
        planes->support[i] = bvh_cached_support(cached, i, planes->support[i]);
}

/* Make 16 new planes, and store each where there is none or where it is better. Returns the lanes still open. */
static uint32_t renew_planes(struct bvh_search *search, kernel_new_planes *make, const float *rows,
                             const struct cached_planes *cached, uint32_t lanes, float *bound)
{
    struct planes made;
    float made_bound[LANES];
    work_spend(search->work, 1);
    if (cached->is_empty) {
        lanes &= make(rows, &search->segment, cached->block ? &cached->block->planes : &made, bound);
        if (cached->block) {
            add_travels(cached, &cached->block->planes);
            cached->block->key = plane_cache_key(&search->cache, cached->node);
            cached->block->retry_after = 1; /* the parent's planes are as new as these */
            cached->block->retry_interval = 0;
        }
    } else {
        uint32_t open = make(rows, &search->segment, &made, made_bound);
        add_travels(cached, &made);
        search->kernel->better(&made, made_bound, &cached->block->planes, bound);
        lanes &= open;
    }
    return lanes;
}

static float lanes_min(const float *value)
{
    float min[8];
    for (int i = 0; i < 8; i++)
        min[i] = value[i] < value[i + 8] ? value[i] : value[i + 8];
    for (int i = 0; i < 4; i++)
        min[i] = min[i] < min[i + 4] ? min[i] : min[i + 4];
    min[0] = min[0] < min[2] ? min[0] : min[2];
    min[1] = min[1] < min[3] ? min[1] : min[3];
    return min[0] < min[1] ? min[0] : min[1];
}

static void store_plane(const struct cached_planes *cached, uint32_t lane, const float normal[3], float support)
{
    planes_put(&cached->block->planes, lane, normal, bvh_cached_support(cached, lane, support));
    cached->block->open &= ~(1u << lane);
}

/* The planes of a node, or of a leaf (level 0), if the cache has any of it; else `block` is NULL. */
static struct cached_planes own_planes(const struct bvh_search *search, uint32_t level, uint32_t index)
{
    struct cached_planes cached = bvh_cached_planes(search, level, index);
    cached.block = plane_cache_own_block(&search->cache, cached.node);
    return cached;
}

/*
 * On a deformable body: fill those leaves of a node again whose boxes keep a plane from closing the node, or leave it
 * less than they would gain. support: of the leaves' boxes along the plane's normal; needed: what closes the node.
 * Returns 1 if a leaf was filled.
 */
static int fill_leaves(struct bvh_search *search, uint32_t node, const float *support, float needed)
{
    const struct surface *surface = search->surface;
    const struct surface_motion *motion = surface->motion;
    const uint32_t count = surface->count[0] - node * LANES;
    int has_filled = 0;
    for (uint32_t i = 0; i < LANES && i < count && !work_is_spent(search->work); i++) {
        const uint32_t leaf = node * LANES + i;
        const float gain = motion->travel[leaf] - motion->followed[leaf];
        if (!(gain > 0.0f) || !(support[i] < needed + gain))
            continue;
        surface_leaf(surface, leaf, search->work);
        has_filled = 1;
    }
    return has_filled;
}

/*
 * The support along n of a child of a node of this level: the least n.v of a leaf's triangles, or of the boxes of a
 * node's children. A support above `needed` is enough.
 */
static float child_support(struct bvh_search *search, uint32_t level, uint32_t child, const float n[3], float needed)
{
    const struct surface *surface = search->surface;
    const struct kernel *kernel = search->kernel;
    float support[LANES];
    work_spend(search->work, 1);
    if (level == 1)
        kernel->common_triangles(surface_leaf(surface, child, search->work), n, 0.0f, support);
    else
        kernel->common_boxes(surface_node(surface, level - 1, child, search->work), n, 0.0f, support);
    if (level == 2 && surface->motion && fill_leaves(search, child, support, needed))
        kernel->common_boxes(surface_node(surface, 1, child, search->work), n, 0.0f, support);
    return lanes_min(support);
}

/*
 * Make one plane for a lane of a node, in the direction that the loop `boxes` takes, with the child's own support: such
 * a plane lasts longer than one with the support of the child's box. If it closes the lane, store it and return 1.
 */
static int close_child(struct bvh_search *search, uint32_t level, uint32_t node, uint32_t lane,
                       const struct cached_planes *cached)
{
    const struct filter_segment *segment = &search->segment;
    const float *box = search->surface->level[level] + (size_t)node * MESH_BOX_WORDS + lane;
    float n[3], s = 0.0f, square = 0.0f;
    for (int k = 0; k < 3; k++)
        s += (box[k * LANES] - segment->a[k]) * segment->x[k];
    s = s > 0.0f ? s : 0.0f;
    s = s < segment->length ? s : segment->length;
    for (int k = 0; k < 3; k++) {
        n[k] = box[k * LANES] - segment->a[k] - s * segment->x[k];
        square += n[k] * n[k];
    }
    if (!(square > 0x1p-100f))
        return 0;
    float unit = 1.0f / sqrtf(square);
    for (int k = 0; k < 3; k++)
        n[k] *= unit;
    const float needed = filter_segment_support(segment, n) + segment->limit;
    float support = child_support(search, level, node * LANES + lane, n, needed);
    if (!(support - filter_segment_support(segment, n) > segment->limit))
        return 0;
    store_plane(cached, lane, n, support);
    return 1;
}

/* Try the normal of the best pair on each of these leaves; it closes three of four. Returns the lanes closed. */
static uint32_t close_leaves(struct bvh_search *search, uint32_t node, uint32_t lanes,
                             const struct cached_planes *cached)
{
    const struct filter_segment *segment = &search->segment;
    uint32_t closed = 0;
    for (uint32_t rest = lanes; rest && !work_is_spent(search->work); rest &= rest - 1) {
        uint32_t lane = first_lane(rest);
        float support = child_support(search, 1, node * LANES + lane, segment->normal, 0.0f);
        if (support - segment->height > segment->limit) {
            store_plane(cached, lane, segment->normal, support);
            closed |= 1u << lane;
        }
    }
    return closed;
}

void dpti_bvh_close_in_parent(struct bvh_search *search, struct plane_block *block, uint32_t level, uint32_t child)
{
    enum { RETRY_INTERVAL_MAX = 15 };
    if (search->cache.is_write_only || work_is_spent(search->work))
        return;
    if (block->retry_after) {
        block->retry_after--;
        return;
    }
    uint32_t node = child / LANES, lane = child % LANES;
    const struct cached_planes parent = own_planes(search, level, node);
    if (!parent.block || !(parent.block->open >> lane & 1))
        return;
    uint32_t interval = 2u * block->retry_interval + 1;
    if (close_child(search, level, node, lane, &parent))
        interval = 0;
    block->retry_interval = block->retry_after =
        (uint16_t)(interval < RETRY_INTERVAL_MAX ? interval : RETRY_INTERVAL_MAX);
}

/* Store the plane with the best pair's normal in the parent, for a whole leaf. support: of the leaf's triangles. */
static void store_leaf_plane(const struct bvh_search *search, uint32_t leaf, const float *support)
{
    const struct cached_planes parent = own_planes(search, 1, leaf / LANES);
    if (parent.block)
        store_plane(&parent, leaf % LANES, search->segment.normal, lanes_min(support));
}

void dpti_bvh_close_triangle(const struct bvh_search *search, uint32_t leaf, uint32_t lane, const pair *found)
{
    const struct cached_planes cached = own_planes(search, 0, leaf);
    const float *rows = search->surface->leaves + (size_t)leaf * MESH_LEAF_WORDS + lane;
    float n[3], support = HUGE_VALF;
    if (!cached.block)
        return;
    put_float(scaled(found->gap, -1.0 / sqrt(found->distance2)), n);
    for (int k = 0; k < 9; k += 3) {
        float corner_support = n[0] * rows[k * LANES] + n[1] * rows[(k + 1) * LANES] + n[2] * rows[(k + 2) * LANES];
        support = corner_support < support ? corner_support : support;
    }
    if (support - filter_segment_support(&search->segment, n) > search->segment.limit)
        store_plane(&cached, lane, n, support);
}

uint32_t dpti_bvh_open_triangles(struct bvh_search *search, uint32_t leaf, const struct cached_planes *cached,
                                 uint32_t lanes, int parent_needs_plane, float *bound)
{
    const float *rows = surface_leaf(search->surface, leaf, search->work);
    const struct filter_segment *segment = &search->segment;
    float support[LANES];
    if (!cached->is_empty) {
        lanes &= bvh_test_planes(search, search->kernel->cached_triangles, rows, cached, bound);
        parent_needs_plane = parent_needs_plane && !cached->block->retry_after;
        if (!lanes && !parent_needs_plane)
            return 0;
    }
    if (search->has_plane && !search->cache.is_write_only && work_left(search->work) > 1) {
        work_spend(search->work, 1);
        uint32_t open =
            search->kernel->common_triangles(rows, segment->normal, segment->height + segment->limit, support);
        if (!open && parent_needs_plane)
            store_leaf_plane(search, leaf, support);
        for (uint32_t rest = cached->is_empty ? 0 : lanes & ~open; rest; rest &= rest - 1) {
            uint32_t i = first_lane(rest);
            store_plane(cached, i, segment->normal, support[i]);
        }
        lanes &= open;
        if (!lanes)
            return 0;
    }
    if (cached->is_empty || lanes & ~cached->block->open) {
        if (!search->has_frame)
            filter_segment_set_frame(&search->segment, search->x);
        search->has_frame = 1;
        lanes = renew_planes(search, search->kernel->triangles, rows, cached, lanes, bound);
    }
    if (cached->block)
        cached->block->open = lanes;
    return lanes;
}

uint32_t dpti_bvh_close_boxes(struct bvh_search *search, uint32_t level, uint32_t node,
                              const struct cached_planes *cached, uint32_t lanes, float *bound)
{
    const float *rows = search->surface->level[level] + (size_t)node * MESH_BOX_WORDS;
    uint32_t lost = cached->is_empty ? lanes : lanes & ~cached->block->open;
    uint32_t all_but_one = lost & (lost - 1);
    int has_few = !(all_but_one & (all_but_one - 1));
    if (cached->is_empty || !has_few)
        return renew_planes(search, search->kernel->boxes, rows, cached, lanes, bound);
    if (level == 1 && search->has_plane) {
        uint32_t closed = close_leaves(search, node, lost, cached);
        lanes &= ~closed;
        lost &= ~closed;
    }
    for (; lost && !work_is_spent(search->work); lost &= lost - 1) {
        uint32_t lane = first_lane(lost);
        if (close_child(search, level, node, lane, cached))
            lanes &= ~(1u << lane);
    }
    return lanes;
}
