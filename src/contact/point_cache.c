/* SPDX-License-Identifier: BSD-3-Clause */
#include "contact/point_cache.h"

#include <string.h>

/* The set of a point. The hash is the same on every machine: it decides what the cache still holds, and so the work. */
static struct cached_point *set_of(const struct point_cache *cache, uint32_t body, vec3 x)
{
    const double at[3] = { x.x, x.y, x.z };
    uint64_t hash = body;
    for (int k = 0; k < 3; k++) {
        uint64_t bits;
        memcpy(&bits, &at[k], sizeof bits);
        hash = (hash ^ bits) * 0x9e3779b97f4a7c15u;
        hash ^= hash >> 32;
    }
    return cache->entries + POINT_CACHE_WAYS * (size_t)(hash % cache->sets);
}

static int is_same(vec3 a, vec3 b)
{
    return a.x == b.x && a.y == b.y && a.z == b.z;
}

static int is_entry_of(const struct cached_point *entry, uint32_t body, vec3 x)
{
    return entry->body == body + 1 && is_same(entry->x, x);
}

/* Move entry `index` of a set to the front, the ones before it back by one, and mark it as used in this tick. */
static struct cached_point *move_to_front(const struct point_cache *cache, struct cached_point *set, int index)
{
    struct cached_point entry = set[index];
    memmove(set + 1, set, (size_t)index * sizeof *set);
    entry.tick = cache->tick;
    set[0] = entry;
    return set;
}

const struct cached_point *dpti_point_cache_find(const struct point_cache *cache, uint32_t body, vec3 x)
{
    struct cached_point *set = set_of(cache, body, x);
    for (int i = 0; i < POINT_CACHE_WAYS; i++)
        if (is_entry_of(&set[i], body, x))
            return move_to_front(cache, set, i);
    return NULL;
}

struct cached_point *dpti_point_cache_put(const struct point_cache *cache, uint32_t body, vec3 x)
{
    struct cached_point *set = set_of(cache, body, x);
    for (int i = 0; i < POINT_CACHE_WAYS; i++)
        if (is_entry_of(&set[i], body, x))
            return move_to_front(cache, set, i);
    const struct cached_point *oldest = &set[POINT_CACHE_WAYS - 1];
    if (oldest->body && oldest->tick == cache->tick)
        return NULL;
    move_to_front(cache, set, POINT_CACHE_WAYS - 1);
    set[0] = (struct cached_point){
        .x = x, .body = body + 1, .triangle = DPT_NONE, .descent = DPT_NONE, .tick = cache->tick
    };
    return set;
}

int dpti_point_cache_resume(const struct point_cache *cache, uint32_t body, vec3 x, uint32_t *triangle,
                            struct bvh_traversal *traversal)
{
    if (cache->body != body + 1 || !is_same(cache->x, x))
        return 0;
    *triangle = cache->triangle;
    *traversal = cache->traversal;
    return 1;
}

void dpti_point_cache_suspend(struct point_cache *cache, uint32_t body, vec3 x, uint32_t triangle,
                              const struct bvh_traversal *traversal)
{
    cache->body = body + 1;
    cache->x = x;
    cache->triangle = triangle;
    cache->traversal = *traversal;
}

void dpti_point_cache_forget(struct point_cache *cache, uint32_t body)
{
    for (size_t i = 0; i < POINT_CACHE_WAYS * (size_t)cache->sets; i++)
        if (body == DPT_NONE || cache->entries[i].body == body + 1)
            cache->entries[i].body = 0;
    if (body == DPT_NONE || cache->body == body + 1)
        cache->body = 0;
}
