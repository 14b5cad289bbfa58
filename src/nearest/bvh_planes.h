/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A search of the box tree and the separating planes that it leaves for the next search. bvh_search.c and bvh_planes.c
 * share this. docs/algorithms/certificate.md.
 */
#ifndef DPT_BVH_PLANES_H
#define DPT_BVH_PLANES_H

#include "nearest/bvh.h"

/* The cached planes of a node's 16 children, or of a leaf's 16 triangles. */
struct cached_planes {
    struct plane_block *block; /* where planes are stored; NULL: nowhere */
    uint32_t node;             /* the node's number in the tree */
    int is_empty;              /* 1: the block holds no planes of this node that may be used */
    const float *travel;       /* of a deformable body: the travels of the children, or of the leaf; else NULL */
    uint32_t travel_stride;    /* 1, or 0 for a leaf: its triangles share its travel */
};

/*
 * The cached planes of a node, or of a leaf (level 0), by its index in its level. With one unit of work left, the cache
 * is neither read nor written.
 */
static inline struct cached_planes bvh_cached_planes(const struct bvh_search *search, uint32_t level, uint32_t index)
{
    const struct plane_cache_view *cache = &search->cache;
    const struct surface_motion *motion = search->surface->motion;
    const uint32_t node = search->surface->first[level] + index;
    struct plane_block *block = work_left(search->work) > 1 ? plane_cache_block(cache, node) : NULL;
    struct cached_planes cached = { block, node, 0, NULL, 0 };
    cached.is_empty = !block || block->key != plane_cache_key(cache, node);
    if (!cached.is_empty && cache->is_write_only) {
        cached.block = NULL;
        cached.is_empty = 1;
    }
    if (motion) {
        cached.travel_stride = level > 0;
        cached.travel = motion->travel + (level ? motion->first[level - 1] + index * LANES : index);
    }
    return cached;
}

/*
 * The support that is cached for a plane of a lane. On a deformable body the lane's travel is added: what it travels
 * later is taken away when the plane is tested.
 */
static inline float bvh_cached_support(const struct cached_planes *cached, uint32_t lane, float support)
{
    return cached->travel ? support + cached->travel[lane * cached->travel_stride] : support;
}

/* Lower the bounds by the travels of the lanes. Returns the lanes that are open. */
uint32_t dpti_bvh_lower_bounds(const struct bvh_search *search, const struct cached_planes *cached, float *bound);

/* 1 if the block holds this node's planes now; the search may have stored them since `cached` was made. */
static inline int bvh_owns_block(const struct bvh_search *search, const struct cached_planes *cached)
{
    return cached->block && cached->block->key == plane_cache_key(&search->cache, cached->node);
}

/*
 * Test cached planes, which must not be empty, for one unit of work. rows: the boxes or triangles of the node. Returns
 * the open lanes, and the bounds of all in `bound`.
 */
static inline uint32_t bvh_test_planes(struct bvh_search *search, kernel_cached *test, const float *rows,
                                       const struct cached_planes *cached, float *bound)
{
    work_spend(search->work, 1);
    const uint32_t open = test(rows, &search->segment, &cached->block->planes, bound);
    return cached->travel ? dpti_bvh_lower_bounds(search, cached, bound) : open;
}

/*
 * Returns those of a leaf's `lanes` that may be nearer: neither their own planes nor the plane through the best pair
 * closes them. leaf: the leaf's index. bound: lower bounds of the lanes returned, in the filter's frame. With
 * parent_needs_plane, the parent stores the plane through the best pair if that closes the whole leaf.
 */
uint32_t dpti_bvh_open_triangles(struct bvh_search *search, uint32_t leaf, const struct cached_planes *cached,
                                 uint32_t lanes, int parent_needs_plane, float *bound);

/*
 * Store a plane for a triangle of a leaf that was evaluated and is farther than the best. The plane across its own
 * pair, `found`, gives the greatest bound of all planes.
 */
void dpti_bvh_close_triangle(const struct bvh_search *search, uint32_t leaf, uint32_t lane, const pair *found);

/*
 * Make new planes for those of a node's `lanes` whose planes no longer close them: better planes if there are only one
 * or two. level, node: the node's level (1 or more) and its index there. Returns the lanes that are still open; `bound`
 * is updated.
 */
uint32_t dpti_bvh_close_boxes(struct bvh_search *search, uint32_t level, uint32_t node,
                              const struct cached_planes *cached, uint32_t lanes, float *bound);

/*
 * A child was visited and nothing in it was open: its plane in the parent is lost or was too weak. Try to store a
 * better one there; after each failure wait longer. level: the parent's level; child: the child's index in the level
 * below; block: the child's own block, which counts the visits.
 */
void dpti_bvh_close_in_parent(struct bvh_search *search, struct plane_block *block, uint32_t level, uint32_t child);

#endif
