/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Searches of the box tree: the exact nearest pair of one axis and one mesh, which brute force finds too, the triangle
 * nearest to a point, and all triangles within reach of an axis.
 */
#ifndef DPT_BVH_H
#define DPT_BVH_H

#include "base/work.h"
#include "nearest/filter_segment.h"
#include "nearest/nearest_pair.h"
#include "nearest/plane_cache.h"

/* A node on the path of a traversal. Bounds are distances in the filter's frame, too large by at most its margin. */
struct path_entry {
    float bound[LANES]; /* lower bounds of the children */
    uint32_t lanes;     /* children that are still to be visited, as bits */
    uint32_t node;      /* index in its level */
    uint32_t has_open;  /* 1: something below this node could not be closed by a plane */
    float lower_bound;  /* of the whole node, from the nodes above; 0: none */
};

/* The state of a traversal: the path of nodes from the root, path[surface->levels], down to path[level]. */
struct bvh_traversal {
    struct path_entry path[MESH_LEVELS_MAX + 1]; /* by level; level 1: parents of leaves */
    uint32_t level;                              /* level of the node being visited; 0: not begun */
};

/*
 * A search for the triangle nearest to the axis a + s u, in the mesh's frame, in m. It spends one unit of work a block
 * of 16 lanes.
 */
struct bvh_search {
    /* To be set before. */
    const struct surface *surface;
    const struct kernel *kernel;
    vec3 a, u;
    double slack;                  /* m; with slack > 0 a triangle that is nearer by less need not be found */
    struct plane_cache_view cache; /* planes of earlier searches; those of this search are added. count 0: none */
    struct work *work;
    struct bvh_traversal *traversal;
    /*
     * In: a pair to beat; its triangle is DPT_NONE if distance2 is only a limit. Out: the nearest pair that is nearer,
     * or as near with a lower source number. If there is none, pair and triangle are unchanged. The search stops at the
     * first pair of distance 0.
     */
    struct pair_search *nearest;
    /* The search's own. */
    vec3 x; /* the unit vector along the axis */
    struct filter_segment segment;
    int has_frame; /* 1: segment.y and z are set; they are made when first needed */
    int has_plane; /* 1: segment.normal and height are those of the plane through the best pair */
};

/*
 * Search until the end, or until the work is spent. Returns 1 when it is done; then traversal->level is 0. Returns 0
 * when the work is spent: the next call continues there, for the same axis, or for a moved one after
 * dpti_bvh_weaken_bounds.
 */
int dpti_bvh_traverse(struct bvh_search *search);

/*
 * A search from nothing: without slack and cache, in one part. Returns 0, with the best pair so far, if the work was
 * spent before the end.
 */
int dpti_bvh_search(const struct surface *surface, const struct kernel *kernel, vec3 a, vec3 u, struct work *work,
                    struct pair_search *nearest);

/* Lower the bounds of a suspended traversal: each end of the axis has moved by at most `motion`, in m, since. */
void dpti_bvh_weaken_bounds(struct bvh_traversal *traversal, const struct surface *surface, double motion);

/*
 * A lower bound, in m, of the distance from the axis a + s u to all triangles that a suspended traversal has not
 * visited yet. The traversal must have begun. HUGE_VAL if none are left.
 */
double dpti_bvh_unvisited_bound(const struct bvh_traversal *traversal, const struct surface *surface, vec3 a, vec3 u);

/* dpti_bvh_search without the tree: every triangle in double, without filter or slack. It never stops early. */
void dpti_brute_search(const struct surface *surface, vec3 a, vec3 u, struct work *work, struct pair_search *nearest);

/*
 * Find the triangle nearest to the point x, in the mesh's frame: dpti_bvh_traverse for an axis without length, without
 * a cache. `nearest` is as in struct bvh_search: a triangle must be nearer than nearest->pair.distance2, or as near
 * with a lower source number; a pair of distance 0 ends the search.
 *
 * traversal->level 0: begin at the root. Returns 1 when done. Returns 0 when the work is spent: the next call may
 * continue the traversal, with a pair that is no farther.
 */
int dpti_point_search(const struct surface *surface, const struct kernel *kernel, vec3 x,
                      struct bvh_traversal *traversal, struct work *work, struct pair_search *nearest);

/* A traversal that returns all triangles that may be within reach of an axis, one after another. */
struct range {
    const struct surface *surface;
    const struct kernel *kernel;
    struct filter_segment segment;
    float directions[4][3]; /* unit, across the axis, a quarter turn about it apart */
    float limits[4];        /* what is farther along that direction is out of reach */
    uint32_t level;         /* of the node being visited, 0: a leaf; above surface->levels: done */
    /* The path to it, by level: the index of a node in its level, and its children that are still to be visited. */
    uint32_t node[MESH_LEVELS_MAX + 1];
    uint32_t lanes[MESH_LEVELS_MAX + 1];
    float bound[LANES]; /* lower bounds of the leaf's triangles, in the filter's frame */
    struct work *work;
};

/*
 * Begin with the axis a + s u, in the mesh's frame, and a reach >= 0, in m. It takes a unit of work, even if none is
 * left.
 */
void dpti_range_begin(struct range *range, const struct surface *surface, const struct kernel *kernel, vec3 a, vec3 u,
                      double reach, struct work *work);

/*
 * Returns the next triangle, by its place, or DPT_NONE if there is none. It also returns DPT_NONE if the work is spent:
 * then there may be more, which come when there is work again. No triangle within reach is left out; some out of reach may be returned. may_touch: 0 if the
 * triangle is certainly not at distance 0.
 */
uint32_t dpti_range_next(struct range *range, int *may_touch);

/* 1 if all were returned. */
static inline int dpti_range_is_over(const struct range *range)
{
    return range->level > range->surface->levels;
}

/* Instead: the next leaf of which a triangle may be within reach, or DPT_NONE likewise. They come in their order. */
uint32_t dpti_range_next_leaf(struct range *range);

#endif
