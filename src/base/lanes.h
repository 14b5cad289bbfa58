/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Blocks of 16 lanes: the boxes or triangles that a kernel handles at once and the file stores together. A set of
 * lanes is a word with a bit for each lane.
 */
#ifndef DPT_LANES_H
#define DPT_LANES_H

#include <stdint.h>

#define LANES 16

/* The set of the first `count` lanes; of all 16 if count is larger. */
static inline uint32_t lanes_of(uint32_t count)
{
    return count < LANES ? (1u << count) - 1 : (1u << LANES) - 1;
}

/* The lowest lane of a set, which must not be empty. */
static inline uint32_t first_lane(uint32_t lanes)
{
    return (uint32_t)__builtin_ctz(lanes);
}

/* The lane with the smallest bound of a set, which must not be empty. A NaN bound comes first. */
static inline uint32_t lowest_lane(const float *bound, uint32_t lanes)
{
    uint32_t best = first_lane(lanes);
    for (uint32_t rest = lanes & (lanes - 1); rest; rest &= rest - 1) {
        uint32_t lane = first_lane(rest);
        if (bound[lane] < bound[best] || bound[lane] != bound[lane])
            best = lane;
    }
    return best;
}

#endif
