/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Pseudo-random numbers of the simulated device: those of splitmix64 (Steele, Lea, Flood, "Fast splittable pseudorandom
 * number generators", OOPSLA 2014). Each is computed from the seed and its own number alone.
 */
#ifndef DPT_DRIVERS_SIM_RANDOM_H
#define DPT_DRIVERS_SIM_RANDOM_H

#include <stdint.h>

/* The numbers of each period, in their order. */
enum sim_draw { DRAW_JITTER, DRAW_COMMAND_LOST, DRAW_SAMPLE_LOST, DRAW_SAMPLE_DOUBLED, DRAWS };

/* One number of a period: uniform in 0 <= u < 1, a multiple of 2^-53. */
static inline double sim_random(uint64_t seed, uint64_t period, enum sim_draw draw)
{
    uint64_t z = seed + (DRAWS * period + (uint64_t)draw + 1u) * 0x9e3779b97f4a7c15u;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    z ^= z >> 31;
    return (double)(z >> 11) * 0x1p-53;
}

#endif
