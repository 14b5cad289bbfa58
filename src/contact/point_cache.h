/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The point cache: what searches found at single points of rigid bodies. Only worlds with a budget have one. A tool at
 * rest needs the same points in every tick, so a contact that is too much work for the budget of one tick is complete
 * after a few ticks (docs/algorithms/budget.md). What the cache does not hold is searched for.
 */
#ifndef DPT_POINT_CACHE_H
#define DPT_POINT_CACHE_H

#include "nearest/bvh.h"

/* Entries of a set. */
enum { POINT_CACHE_WAYS = 4 };

/* A point of a body and what is known of it. Coordinates must match exactly. */
struct cached_point {
    vec3 x;            /* in the body's frame */
    uint32_t body;     /* slot + 1; 0: the entry is empty */
    uint32_t triangle; /* place of the nearest triangle, or DPT_NONE: not known */
    uint32_t descent;  /* place of the triangle at which a descent ended, or DPT_NONE: not known */
    int32_t winding;   /* the winding number, rounded */
    uint32_t has_winding;
    uint32_t tick; /* in which it was last used */
};

struct point_cache {
    struct cached_point *entries; /* POINT_CACHE_WAYS a set, the newest first */
    uint32_t sets;                /* number of sets */
    uint32_t tick;                /* the current one */
    /* The search that the budget suspended last. */
    uint32_t body;     /* slot + 1; 0: there is none */
    uint32_t triangle; /* place of the nearest triangle so far */
    vec3 x;            /* in the body's frame */
    struct bvh_traversal traversal;
};

/* The entry of point x, in the frame of the body at slot `body`; NULL if there is none. */
const struct cached_point *dpti_point_cache_find(const struct point_cache *cache, uint32_t body, vec3 x);

/*
 * The entry of point x, for the caller to fill in. A new entry replaces the oldest of its set, unless the current tick
 * has used that one: otherwise a tick's last points would evict its first. Returns NULL then.
 */
struct cached_point *dpti_point_cache_put(const struct point_cache *cache, uint32_t body, vec3 x);

/*
 * Resume the suspended search if it was for x: *triangle gets the place of the nearest triangle so far, *traversal
 * where the search stopped. Returns 0 if there is none or it was for another point.
 */
int dpti_point_cache_resume(const struct point_cache *cache, uint32_t body, vec3 x, uint32_t *triangle,
                            struct bvh_traversal *traversal);

/* Store a search that the budget stopped, in place of the one stored before. */
void dpti_point_cache_suspend(struct point_cache *cache, uint32_t body, vec3 x, uint32_t triangle,
                              const struct bvh_traversal *traversal);

/* Forget all points of the body at a slot, or everything if `body` is DPT_NONE. Call it before a slot is reused. */
void dpti_point_cache_forget(struct point_cache *cache, uint32_t body);

#endif
