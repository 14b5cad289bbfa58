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
struct node_planes {
    struct block *block; /* NULL: nothing is kept */
    uint32_t number;     /* of the node */
    int empty;
};

struct bvh_search {
    const struct surface *surface;
    const struct kernel *kernel;
    struct keeper keeper;
    struct nearest *nearest;
    struct work *work;
    vec3 a, u, x; /* x: unit, along u */
    double slack;
    struct probe probe;
    int has_frame; /* the probe's y and z, made when first needed */
    int has_plane;
    struct walk *walk;
};

/* With one block left to look at, what is kept is left alone. */
static inline struct node_planes bvh_planes_of(const struct bvh_search *search, uint32_t number)
{
    const struct keeper *keeper = &search->keeper;
    struct block *block = work_left(search->work) > 1 ? keeper_block(keeper, number) : NULL;
    int empty = !block || block->key != keeper_key(keeper, number);
    if (!empty && keeper->anew)
        return (struct node_planes){ NULL, number, 1 };
    return (struct node_planes){ block, number, empty };
}

/* By now. */
static inline int bvh_is_own(const struct bvh_search *search, const struct node_planes *kept)
{
    return kept->block && kept->block->key == keeper_key(&search->keeper, kept->number);
}

static inline uint32_t bvh_look_at_planes(struct bvh_search *search, kernel_held *held,
                                          const float *rows, const struct node_planes *kept,
                                          float *bound)
{
    work_spend(search->work, 1);
    return held(rows, &search->probe, &kept->block->planes, bound);
}

/*
 * The triangles of a leaf that may be nearer: those that neither their own planes nor the plane through the best
 * pair rules out. `wanted`: where that plane rules out all of them, the parent is to have it.
 */
uint32_t dpti_bvh_open_triangles(struct bvh_search *search, uint32_t leaf,
                                 const struct node_planes *kept, uint32_t lanes, int wanted,
                                 float *bound);

/* A triangle was evaluated and is farther: the plane across its own connection is the best there is. */
void dpti_bvh_close_triangle(const struct bvh_search *search, uint32_t leaf, uint32_t lane,
                             const pair *found);

/* New planes for those of these lanes that lost theirs: for a few, better ones. Returns all that are still open. */
uint32_t dpti_bvh_close_boxes(struct bvh_search *search, uint32_t level, uint32_t node,
                              const struct node_planes *kept, uint32_t lanes, float *bound);

/*
 * A node or leaf, the child of a lane of a node of this level, was looked into and nothing in it was open: that
 * lane's plane is lost, or was too weak. Try another; after each failure wait longer. `block` is the child's own.
 */
void dpti_bvh_close_whole(struct bvh_search *search, struct block *block, uint32_t level,
                          uint32_t child);

#endif
