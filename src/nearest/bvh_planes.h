/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A search of the box tree, and the planes that it keeps for the next one: what bvh_search.c and bvh_planes.c share.
 * docs/algorithms/certificate.md.
 */
#ifndef DPT_BVH_PLANES_H
#define DPT_BVH_PLANES_H

#include "nearest/bvh.h"
#include "nearest/filter_segment.h"

/* A node's 16 planes, empty unless they are its own. */
struct cached_planes {
    struct plane_block *block; /* NULL: nothing is kept */
    uint32_t node;             /* of the node */
    int is_empty;
};

struct bvh_search {
    const struct surface *surface;
    const struct kernel *kernel;
    struct plane_cache_view cache;
    struct pair_search *nearest;
    struct work *work;
    vec3 a, u, x; /* x: unit, along u */
    double slack;
    struct filter_segment segment;
    int has_frame; /* the probe's y and z, made when first needed */
    int has_plane;
    struct bvh_traversal *traversal;
};

/* With one block left to look at, what is kept is left alone. */
static inline struct cached_planes bvh_cached_planes(const struct bvh_search *search, uint32_t node)
{
    const struct plane_cache_view *cache = &search->cache;
    struct plane_block *block = work_left(search->work) > 1 ? plane_cache_block(cache, node) : NULL;
    int is_empty = !block || block->key != plane_cache_key(cache, node);
    if (!is_empty && cache->is_write_only)
        return (struct cached_planes){ NULL, node, 1 };
    return (struct cached_planes){ block, node, is_empty };
}

/* By now. */
static inline int bvh_owns_block(const struct bvh_search *search,
                                 const struct cached_planes *cached)
{
    return cached->block && cached->block->key == plane_cache_key(&search->cache, cached->node);
}

static inline uint32_t bvh_test_planes(struct bvh_search *search, kernel_cached *test,
                                       const float *rows, const struct cached_planes *cached,
                                       float *bound)
{
    work_spend(search->work, 1);
    return test(rows, &search->segment, &cached->block->planes, bound);
}

/*
 * The triangles of a leaf that may be nearer: those that neither their own planes nor the plane through the best
 * pair rules out. `wanted`: where that plane rules out all of them, the parent is to have it.
 */
uint32_t dpti_bvh_open_triangles(struct bvh_search *search, uint32_t leaf,
                                 const struct cached_planes *cached, uint32_t lanes,
                                 int parent_needs_plane, float *bound);

/* A triangle was evaluated and is farther: the plane across its own connection is the best there is. */
void dpti_bvh_close_triangle(const struct bvh_search *search, uint32_t leaf, uint32_t lane,
                             const pair *found);

/* New planes for those of these lanes that lost theirs: for a few, better ones. Returns all that are still open. */
uint32_t dpti_bvh_close_boxes(struct bvh_search *search, uint32_t level, uint32_t node,
                              const struct cached_planes *cached, uint32_t lanes, float *bound);

/*
 * A node or leaf, the child of a lane of a node of this level, was looked into and nothing in it was open: that
 * lane's plane is lost, or was too weak. Try another; after each failure wait longer. `block` is the child's own.
 */
void dpti_bvh_close_in_parent(struct bvh_search *search, struct plane_block *block, uint32_t level,
                              uint32_t child);

#endif
