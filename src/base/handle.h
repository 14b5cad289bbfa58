/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Ids: kind 4 bits | generation 12 | slot 16. Any 32 bits can be asked about; an id of another kind, or
 * of a thing that was removed, finds nothing. A slot's generations come round again, so the slot that was freed longest
 * ago is used first: a removed thing's id is not given again for HANDLE_GENERATION_MAX - 1 more uses of its slot.
 */
#ifndef DPT_HANDLE_H
#define DPT_HANDLE_H

#include <stddef.h>
#include <stdint.h>

enum { HANDLE_BODY = 1, HANDLE_TOOL = 2 };
enum { HANDLE_GENERATION_MAX = 0xfff };

/* In each slot; `generation` is that of the next thing to live there while the slot is free. */
struct slot {
    uint32_t freed_order; /* as the how manieth of its world; may wrap */
    uint16_t generation;  /* 1..HANDLE_GENERATION_MAX */
    uint8_t used;
    uint8_t valid; /* what lives there has a pose, or segments, that can be used */
};

static inline uint32_t handle_make(uint32_t kind, const struct slot *slot, uint32_t index)
{
    return kind << 28 | (uint32_t)slot->generation << 16 | index;
}

static inline uint32_t handle_index(uint32_t handle)
{
    return handle & 0xffff;
}

static inline int handle_fits(uint32_t handle, uint32_t kind, const struct slot *slot)
{
    return handle >> 28 == kind && slot->used && (handle >> 16 & 0xfff) == slot->generation;
}

/* Of `count` slots, `stride` bytes apart, the free one that was freed longest ago; `count` where none is free. */
static inline uint32_t slot_to_use(const struct slot *first, size_t stride, uint32_t count,
                                   uint32_t freed_count)
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

/* `freed` counts the slots that were freed in its world. */
static inline void slot_release(struct slot *slot, uint32_t *freed_count)
{
    slot->used = 0;
    slot->generation =
        (uint16_t)(slot->generation == HANDLE_GENERATION_MAX ? 1 : slot->generation + 1);
    slot->freed_order = ++*freed_count;
}

#endif
