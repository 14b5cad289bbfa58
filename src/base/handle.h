/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Ids: kind 4 bits | generation 12 | slot 16. Any 32 bits may be looked up; an id of another kind, or of a removed
 * thing, finds nothing. The generations of a slot repeat. So the slot that was freed longest ago is used first, and
 * the id of a removed thing is not given again for HANDLE_GENERATION_MAX - 1 more uses of its slot.
 */
#ifndef DPT_HANDLE_H
#define DPT_HANDLE_H

#include <stddef.h>
#include <stdint.h>

enum { HANDLE_BODY = 1, HANDLE_TOOL = 2 };
enum { HANDLE_GENERATION_MAX = 0xfff };

/* What each slot holds. While a slot is free, `generation` is that of the next thing to use it. */
struct slot {
    uint32_t freed_order; /* the world's count of freed slots when it was freed; may wrap */
    uint16_t generation;  /* 1..HANDLE_GENERATION_MAX */
    uint8_t used;
    uint8_t valid; /* the body or tool in it has a valid pose, or valid segments */
};

/* The id of what is in a slot; `index` is the slot's. */
static inline uint32_t handle_make(uint32_t kind, const struct slot *slot, uint32_t index)
{
    return kind << 28 | (uint32_t)slot->generation << 16 | index;
}

/* The slot of an id; not checked. */
static inline uint32_t handle_index(uint32_t handle)
{
    return handle & 0xffff;
}

/* 1 if an id of this kind names what is in the slot now. */
static inline int handle_fits(uint32_t handle, uint32_t kind, const struct slot *slot)
{
    return handle >> 28 == kind && slot->used && (handle >> 16 & 0xfff) == slot->generation;
}

/*
 * The index of the free slot, of `count` that are `stride` bytes apart, that was freed longest ago; `count` if none
 * is free.
 */
static inline uint32_t slot_to_use(const struct slot *first, size_t stride, uint32_t count, uint32_t freed_count)
{
    uint32_t best = count, longest = 0;
    for (uint32_t i = 0; i < count; i++) {
        const struct slot *slot = (const void *)((const char *)first + i * stride);
        if (!slot->used && (best == count || freed_count - slot->freed_order > longest)) {
            best = i;
            longest = freed_count - slot->freed_order;
        }
    }
    return best;
}

/* Free a slot. `freed_count` is how many slots of its kind the world has freed. */
static inline void slot_release(struct slot *slot, uint32_t *freed_count)
{
    slot->used = 0;
    slot->generation = (uint16_t)(slot->generation == HANDLE_GENERATION_MAX ? 1 : slot->generation + 1);
    slot->freed_order = ++*freed_count;
}

#endif
