/* SPDX-License-Identifier: BSD-3-Clause */
#include "contact/point_cache.h"

#include <string.h>

/* The set of a point. The same on every machine: it decides what is still known, and so the work. */
static struct memo_entry *set_of(const struct memo *memo, uint32_t body, vec3 x)
{
    const double at[3] = { x.x, x.y, x.z };
    uint64_t hash = body;
    for (int k = 0; k < 3; k++) {
        uint64_t bits;
        memcpy(&bits, &at[k], sizeof bits);
        hash = (hash ^ bits) * 0x9e3779b97f4a7c15u;
        hash ^= hash >> 32;
    }
    return memo->entries + MEMO_WAYS * (size_t)(hash % memo->sets);
}

static int is_same(vec3 x, vec3 y)
{
    return x.x == y.x && x.y == y.y && x.z == y.z;
}

static int is_at(const struct memo_entry *entry, uint32_t body, vec3 x)
{
    return entry->body == body + 1 && is_same(entry->x, x);
}

/* The entry behind its set's first `count` moves to the front, those up. */
static struct memo_entry *bring_forward(const struct memo *memo, struct memo_entry *set, int count)
{
    struct memo_entry entry = set[count];
    memmove(set + 1, set, (size_t)count * sizeof *set);
    entry.tick = memo->tick;
    set[0] = entry;
    return set;
}

const struct memo_entry *dpti_memo_find(const struct memo *memo, uint32_t body, vec3 x)
{
    struct memo_entry *set = set_of(memo, body, x);
    for (int i = 0; i < MEMO_WAYS; i++)
        if (is_at(&set[i], body, x))
            return bring_forward(memo, set, i);
    return NULL;
}

struct memo_entry *dpti_memo_put(const struct memo *memo, uint32_t body, vec3 x)
{
    struct memo_entry *set = set_of(memo, body, x);
    for (int i = 0; i < MEMO_WAYS; i++)
        if (is_at(&set[i], body, x))
            return bring_forward(memo, set, i);
    const struct memo_entry *oldest = &set[MEMO_WAYS - 1];
    if (oldest->body && oldest->tick == memo->tick)
        return NULL;
    bring_forward(memo, set, MEMO_WAYS - 1);
    set[0] = (struct memo_entry){
        .x = x, .body = body + 1, .triangle = DPT_NONE, .descent = DPT_NONE, .tick = memo->tick
    };
    return set;
}

int dpti_memo_resume(const struct memo *memo, uint32_t body, vec3 x, uint32_t *triangle,
                     struct walk *walk)
{
    if (memo->body != body + 1 || !is_same(memo->x, x))
        return 0;
    *triangle = memo->triangle;
    *walk = memo->walk;
    return 1;
}

void dpti_memo_pause(struct memo *memo, uint32_t body, vec3 x, uint32_t triangle,
                     const struct walk *walk)
{
    memo->body = body + 1;
    memo->x = x;
    memo->triangle = triangle;
    memo->walk = *walk;
}

void dpti_memo_forget(struct memo *memo, uint32_t body)
{
    for (size_t i = 0; i < MEMO_WAYS * (size_t)memo->sets; i++)
        if (body == DPT_NONE || memo->entries[i].body == body + 1)
            memo->entries[i].body = 0;
    if (body == DPT_NONE || memo->body == body + 1)
        memo->body = 0;
}
