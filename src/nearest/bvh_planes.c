/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Planes that close lanes of nodes and leaves, made anew where the axis has passed the old ones
 * (docs/algorithms/certificate.md).
 */
#include "nearest/bvh_planes.h"

/* New planes where there are none, or where they are better. Returns those still open. */
static uint32_t renew(struct bvh_search *search, kernel_new_planes *make, const float *rows,
                      const struct cached_planes *cached, uint32_t lanes, float *bound)
{
    struct planes made;
    float made_bound[LANES];
    work_spend(search->work, 1);
    if (cached->empty) {
        lanes &=
            make(rows, &search->segment, cached->block ? &cached->block->planes : &made, bound);
        if (cached->block) {
            cached->block->key = plane_cache_key(&search->cache, cached->number);
            cached->block->wait = 1; /* its parent's planes are as new */
            cached->block->pause = 0;
        }
    } else {
        uint32_t open = make(rows, &search->segment, &made, made_bound);
        search->kernel->better(&made, made_bound, &cached->block->planes, bound);
        lanes &= open;
    }
    return lanes;
}

static float least_of(const float *low)
{
    float m[8];
    for (int i = 0; i < 8; i++)
        m[i] = low[i] < low[i + 8] ? low[i] : low[i + 8];
    for (int i = 0; i < 4; i++)
        m[i] = m[i] < m[i + 4] ? m[i] : m[i + 4];
    m[0] = m[0] < m[2] ? m[0] : m[2];
    m[1] = m[1] < m[3] ? m[1] : m[3];
    return m[0] < m[1] ? m[0] : m[1];
}

static void put_plane(struct plane_block *block, uint32_t lane, const float normal[3],
                      float support)
{
    planes_put(&block->planes, lane, normal, support);
    block->open &= ~(1u << lane);
}

/* The support along n of what lies below a lane of a node: of its triangles, or of its children's boxes. */
static float support_below(struct bvh_search *search, uint32_t level, size_t child,
                           const float n[3])
{
    const struct surface *surface = search->surface;
    const struct kernel *kernel = search->kernel;
    float low[LANES];
    work_spend(search->work, 1);
    if (level == 1)
        kernel->common_triangles(surface->leaves + child * MESH_LEAF_WORDS, n, 0.0f, low);
    else
        kernel->common_boxes(surface->level[level - 1] + child * MESH_BOX_WORDS, n, 0.0f, low);
    return least_of(low);
}

/*
 * One plane for a lane of a node, in the direction that `boxes` takes, with the support of what lies below. Such a
 * plane lasts longer than that of a box. Returns 1 when it closes the lane.
 */
static int refine(struct bvh_search *search, uint32_t level, uint32_t node, uint32_t lane,
                  struct plane_block *block)
{
    const struct filter_segment *p = &search->segment;
    const float *box = search->surface->level[level] + (size_t)node * MESH_BOX_WORDS + lane;
    float n[3], s = 0.0f, square = 0.0f;
    for (int k = 0; k < 3; k++)
        s += (box[k * LANES] - p->a[k]) * p->x[k];
    s = s > 0.0f ? s : 0.0f;
    s = s < p->length ? s : p->length;
    for (int k = 0; k < 3; k++) {
        n[k] = box[k * LANES] - p->a[k] - s * p->x[k];
        square += n[k] * n[k];
    }
    if (!(square > 0x1p-100f))
        return 0;
    float unit = 1.0f / sqrtf(square);
    for (int k = 0; k < 3; k++)
        n[k] *= unit;
    float support = support_below(search, level, (size_t)node * LANES + lane, n);
    if (!(support - filter_segment_support(p, n) > p->limit))
        return 0;
    put_plane(block, lane, n, support);
    return 1;
}

/* For leaves, along the normal of the best pair, which closes three of four. Returns those that it closes. */
static uint32_t refine_leaves(struct bvh_search *search, uint32_t node, uint32_t lanes,
                              struct plane_block *block)
{
    const struct filter_segment *p = &search->segment;
    uint32_t closed = 0;
    for (uint32_t rest = lanes; rest && !work_is_spent(search->work); rest &= rest - 1) {
        uint32_t lane = first_lane(rest);
        float support = support_below(search, 1, (size_t)node * LANES + lane, p->normal);
        if (support - p->height > p->limit) {
            put_plane(block, lane, p->normal, support);
            closed |= 1u << lane;
        }
    }
    return closed;
}

void dpti_bvh_close_whole(struct bvh_search *search, struct plane_block *block, uint32_t level,
                          uint32_t child)
{
    enum { PAUSE_MAX = 15 };
    if (search->cache.anew || work_is_spent(search->work))
        return;
    if (block->wait) {
        block->wait--;
        return;
    }
    uint32_t node = child / LANES, lane = child % LANES;
    struct plane_block *parent =
        plane_cache_own_block(&search->cache, search->surface->first[level] + node);
    if (!parent || !(parent->open >> lane & 1))
        return;
    uint32_t pause = 2u * block->pause + 1;
    if (refine(search, level, node, lane, parent))
        pause = 0;
    block->pause = block->wait = (uint16_t)(pause < PAUSE_MAX ? pause : PAUSE_MAX);
}

/* The plane through the best pair, for a whole leaf: its parent keeps it. */
static void close_leaf(const struct bvh_search *search, uint32_t leaf, const float *low)
{
    struct plane_block *parent =
        plane_cache_own_block(&search->cache, search->surface->first[1] + leaf / LANES);
    if (parent)
        put_plane(parent, leaf % LANES, search->segment.normal, least_of(low));
}

void dpti_bvh_close_triangle(const struct bvh_search *search, uint32_t leaf, uint32_t lane,
                             const pair *found)
{
    struct plane_block *block = plane_cache_own_block(&search->cache, leaf);
    const float *rows = search->surface->leaves + (size_t)leaf * MESH_LEAF_WORDS + lane;
    float n[3], low = HUGE_VALF;
    if (!block)
        return;
    put_float(scaled(found->gap, -1.0 / sqrt(found->distance2)), n);
    for (int k = 0; k < 9; k += 3) {
        float at =
            n[0] * rows[k * LANES] + n[1] * rows[(k + 1) * LANES] + n[2] * rows[(k + 2) * LANES];
        low = at < low ? at : low;
    }
    if (low - filter_segment_support(&search->segment, n) > search->segment.limit)
        put_plane(block, lane, n, low);
}

uint32_t dpti_bvh_open_triangles(struct bvh_search *search, uint32_t leaf,
                                 const struct cached_planes *cached, uint32_t lanes, int wanted,
                                 float *bound)
{
    const float *rows = search->surface->leaves + (size_t)leaf * MESH_LEAF_WORDS;
    const struct filter_segment *segment = &search->segment;
    float low[LANES];
    if (!cached->empty) {
        lanes &= bvh_look_at_planes(search, search->kernel->cached_triangles, rows, cached, bound);
        wanted = wanted && !cached->block->wait;
        if (!lanes && !wanted)
            return 0;
    }
    if (search->has_plane && !search->cache.anew && work_left(search->work) > 1) {
        work_spend(search->work, 1);
        uint32_t open = search->kernel->common_triangles(rows, segment->normal,
                                                         segment->height + segment->limit, low);
        if (!open && wanted)
            close_leaf(search, leaf, low);
        for (uint32_t rest = cached->empty ? 0 : lanes & ~open; rest; rest &= rest - 1) {
            uint32_t i = first_lane(rest);
            put_plane(cached->block, i, segment->normal, low[i]);
        }
        lanes &= open;
        if (!lanes)
            return 0;
    }
    if (cached->empty || lanes & ~cached->block->open) {
        if (!search->has_frame)
            filter_segment_set_frame(&search->segment, search->x);
        search->has_frame = 1;
        lanes = renew(search, search->kernel->triangles, rows, cached, lanes, bound);
    }
    if (cached->block)
        cached->block->open = lanes;
    return lanes;
}

uint32_t dpti_bvh_close_boxes(struct bvh_search *search, uint32_t level, uint32_t node,
                              const struct cached_planes *cached, uint32_t lanes, float *bound)
{
    const float *rows = search->surface->level[level] + (size_t)node * MESH_BOX_WORDS;
    uint32_t lost = cached->empty ? lanes : lanes & ~cached->block->open;
    uint32_t but_one = lost & (lost - 1);
    int few = !(but_one & (but_one - 1));
    if (cached->empty || !few)
        return renew(search, search->kernel->boxes, rows, cached, lanes, bound);
    if (level == 1 && search->has_plane) {
        uint32_t closed = refine_leaves(search, node, lost, cached->block);
        lanes &= ~closed;
        lost &= ~closed;
    }
    for (; lost && !work_is_spent(search->work); lost &= lost - 1) {
        uint32_t lane = first_lane(lost);
        if (refine(search, level, node, lane, cached->block))
            lanes &= ~(1u << lane);
    }
    return lanes;
}
