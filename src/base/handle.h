/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Ids: kind 4 bits | generation 12 | slot 16. Any 32 bits can be asked about; an id of another kind, or
 * of a thing that was removed, finds nothing. A slot whose generations are used up retires.
 */
#ifndef DPT_HANDLE_H
#define DPT_HANDLE_H

#include <stdint.h>

enum { HANDLE_BODY = 1, HANDLE_TOOL = 2 };
enum { HANDLE_GENERATION_MAX = 0xfff };

/* In each slot; `generation` is that of the next thing to live there while the slot is free. */
struct slot {
    uint16_t generation; /* from 1 */
    uint16_t used;
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

static inline int slot_is_free(const struct slot *slot)
{
    return !slot->used && slot->generation <= HANDLE_GENERATION_MAX;
}

static inline void slot_release(struct slot *slot)
{
    slot->used = 0;
    slot->generation++;
}

#endif
