/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What was proven stays true: a plane that lies between the tool and a piece of the mesh is kept, and next
 * tick its bound costs three dot products instead of a search (docs/algorithms/certificate.md).
 *
 * A cache of fixed size. A block holds the planes of one tree node's 16 children, or of one leaf's 16
 * triangles, for one axis and one body. A block that is not there, or was given to another, costs time,
 * never truth: its planes are made anew.
 */
#ifndef DPT_PLANE_CACHE_H
#define DPT_PLANE_CACHE_H

#include "kernel/kernel_ops.h"

struct plane_block {
    uint64_t key;  /* whose it is: owner << 32 | node; 0 is nobody's */
    uint32_t open; /* lanes that new planes did not close when they were last made */
    uint16_t retry_after,
        retry_interval; /* visits until one plane for all of it is tried again; the next wait */
    struct planes planes;
};

/* The caller's memory, shared by all axes and bodies of a world. */
struct plane_cache {
    struct plane_block *blocks;
    uint32_t count;
};

/* One axis' and body's view of it. `owner` is not 0. */
struct plane_cache_view {
    struct plane_block *blocks;
    uint32_t count; /* of blocks; 0: nothing is kept */
    uint32_t owner;
    uint32_t first;    /* the block of its node 0 */
    int is_write_only; /* planes are made and kept, but those of before are not asked */
};

static inline struct plane_cache_view plane_cache_view_of(const struct plane_cache *cache,
                                                          uint32_t owner, int is_write_only)
{
    uint32_t count = cache->count, hash = owner * 0x9e3779b1u;
    return (struct plane_cache_view){ cache->blocks, count, owner, count ? hash % count : 0,
                                      is_write_only };
}

/*
 * The block of a node, by its number in the tree; nodes that lie close together do not displace each other.
 * It may be another's, whose key differs. NULL where nothing is kept.
 */
static inline struct plane_block *plane_cache_block(const struct plane_cache_view *cache,
                                                    uint32_t node)
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

static inline uint64_t plane_cache_key(const struct plane_cache_view *cache, uint32_t node)
{
    return (uint64_t)cache->owner << 32 | node;
}

/* Only if it is the node's own. */
static inline struct plane_block *plane_cache_own_block(const struct plane_cache_view *cache,
                                                        uint32_t node)
{
    struct plane_block *block = plane_cache_block(cache, node);
    return block && block->key == plane_cache_key(cache, node) ? block : NULL;
}

static inline void planes_put(struct planes *planes, uint32_t lane, const float normal[3],
                              float support)
{
    planes->x[lane] = normal[0];
    planes->y[lane] = normal[1];
    planes->z[lane] = normal[2];
    planes->support[lane] = support;
}

#endif
