/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef DPT_TESTS_RANDOM_H
#define DPT_TESTS_RANDOM_H

#include <math.h>
#include <stdint.h>

/* A small generator for tests (SplitMix64), so that a seed names a run on every machine. */
static inline uint64_t random_bits(uint64_t *state)
{
    uint64_t z = (*state += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

/* Uniform in [low, high). */
static inline double random_in(uint64_t *state, double low, double high)
{
    return low + (high - low) * ((double)(random_bits(state) >> 11) * 0x1p-53);
}

/* A unit quaternion; not uniform over the turns. */
static inline void random_turn(uint64_t *state, double q[4])
{
    double square = 0;
    for (int k = 0; k < 4; k++) {
        q[k] = random_in(state, -1, 1);
        square += q[k] * q[k];
    }
    for (int k = 0; k < 4; k++)
        q[k] /= sqrt(square);
}

#endif
