/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The plane cache keeps separating planes from tick to tick. A plane belongs to a piece of the mesh, in its frame: all
 * of the piece lies behind it, wherever the tool is. Each tick computes the bound that it gives for the axis as it is now
 * (kernel_cached, kernel_ops.h), three dot products instead of a search, and looks into the piece where that bound is
 * not above the best distance (bvh_planes.h; docs/algorithms/certificate.md).
 *
 * The cache has a fixed size. A block holds the planes of a tree node's 16 children, or of a leaf's 16 triangles, for
 * one axis and one body. If a block is missing or another owner took it, its planes are made again: that costs time and
 * never changes an answer.
 */
#ifndef DPT_PLANE_CACHE_H
#define DPT_PLANE_CACHE_H

#include "kernel/kernel_ops.h"

struct plane_block {
    uint64_t key;  /* owner << 32 | node's number; 0: the block is free */
    uint32_t open; /* lanes that the newest planes did not close */
    /* Visits until the parent tries again to close this node or leaf with one plane; and the wait after that. */
    uint16_t retry_after, retry_interval;
    struct planes planes;
};

/* The caller's memory, shared by all axes and bodies of a world. */
struct plane_cache {
    struct plane_block *blocks;
    uint32_t count;
};

/* The cache as one axis and one body see it. */
struct plane_cache_view {
    struct plane_block *blocks;
    uint32_t count;    /* number of blocks; 0: nothing is kept */
    uint32_t owner;    /* identifies the axis and the body; not 0 */
    uint32_t first;    /* index of the block of the owner's node 0 */
    int is_write_only; /* 1: planes cached already are not used; new ones go into blocks without any */
};

static inline struct plane_cache_view plane_cache_view_of(const struct plane_cache *cache, uint32_t owner,
                                                          int is_write_only)
{
    uint32_t count = cache->count, hash = owner * 0x9e3779b1u;
    return (struct plane_cache_view){ cache->blocks, count, owner, count ? hash % count : 0, is_write_only };
}

/*
 * The block in which a node's planes belong, by the node's number in the tree. The block may hold planes of another
 * node: then its key differs. Nodes with neighbouring numbers have different blocks. NULL if the cache has no blocks.
 */
static inline struct plane_block *plane_cache_block(const struct plane_cache_view *cache, uint32_t node)
{
    uint64_t index = (uint64_t)cache->first + node;
    index -= index >= cache->count ? cache->count : 0;
    if (index >= cache->count) {
        if (!cache->count)
            return NULL;
        index %= cache->count;
    }
    return &cache->blocks[index];
}

/* The key of a block that holds this node's planes for the view's owner. */
static inline uint64_t plane_cache_key(const struct plane_cache_view *cache, uint32_t node)
{
    return (uint64_t)cache->owner << 32 | node;
}

/* The node's block if it holds the node's own planes, else NULL. */
static inline struct plane_block *plane_cache_own_block(const struct plane_cache_view *cache, uint32_t node)
{
    struct plane_block *block = plane_cache_block(cache, node);
    return block && block->key == plane_cache_key(cache, node) ? block : NULL;
}

/* Set one lane's plane: n.v >= support for all v of the lane. In the filter's frame. */
static inline void planes_put(struct planes *planes, uint32_t lane, const float normal[3], float support)
{
    planes->x[lane] = normal[0];
    planes->y[lane] = normal[1];
    planes->z[lane] = normal[2];
    planes->support[lane] = support;
}

#endif
