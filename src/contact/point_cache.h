/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * With a budget: what searches have found at single points of rigid bodies. A tool that rests asks for the same points
 * in every tick, so that a contact which one tick's budget does not reach for is there after some
 * (docs/algorithms/budget.md). A cache: what is not in it is searched for.
 */
#ifndef DPT_POINT_CACHE_H
#define DPT_POINT_CACHE_H

#include "nearest/bvh.h"

enum { POINT_CACHE_WAYS = 4 };

/* A point of a body, exactly, and what is known of it. */
struct cached_point {
    vec3 x;            /* in the body's frame */
    uint32_t body;     /* its slot + 1; 0: the entry is empty */
    uint32_t triangle; /* the nearest, or DPT_NONE: not known */
    uint32_t descent;  /* where one came to, or DPT_NONE */
    int32_t side;      /* +1 outside, -1 inside, 0: not known */
    uint32_t tick;     /* in which it was last asked for */
    uint32_t reserved;
};

struct point_cache {
    struct cached_point *entries; /* POINT_CACHE_WAYS a set, the newest first */
    uint32_t sets;
    uint32_t tick; /* this one */
    /* The search that the budget ended last. */
    uint32_t body;     /* slot + 1; 0: there is none */
    uint32_t triangle; /* the nearest so far */
    vec3 x;
    struct bvh_traversal traversal;
};

/* What is known of x, or NULL. */
const struct cached_point *dpti_point_cache_find(const struct point_cache *cache, uint32_t body,
                                                 vec3 x);

/*
 * Its entry, to be filled in: a new one takes the place of its set's oldest, but of none that this tick asked for, or what a
 * tick begins with would make room for what it ends with. NULL: there is no room.
 */
struct cached_point *dpti_point_cache_put(const struct point_cache *cache, uint32_t body, vec3 x);

/* Take up the search for x where it was ended, with the nearest so far; 0 if it is not that one. */
int dpti_point_cache_resume(const struct point_cache *cache, uint32_t body, vec3 x,
                            uint32_t *triangle, struct bvh_traversal *traversal);

/* A search was ended. */
void dpti_point_cache_suspend(struct point_cache *cache, uint32_t body, vec3 x, uint32_t triangle,
                              const struct bvh_traversal *traversal);

/* All of a body, or with DPT_NONE everything: before its slot means another. */
void dpti_point_cache_forget(struct point_cache *cache, uint32_t body);

#endif
