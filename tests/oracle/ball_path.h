/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Where a ball comes to rest that is pulled to a device and slides without friction, by steps of 1 um: a local minimum of
 * its distance from the device, reached by going downhill. It looks at every triangle near and shares nothing with the
 * library.
 *
 * In each step the pull is projected on what the triangles that it touches leave free: the longest of the projections on
 * all sets of at most two of their planes that violates none. Then it goes 1 um along that, or half of its radius where
 * that is less, and is pushed out of what it is in. It rests where no such step comes nearer to the device, nor a 16th of
 * one.
 */
#ifndef DPT_TESTS_ORACLE_BALL_PATH_H
#define DPT_TESTS_ORACLE_BALL_PATH_H

#include <stdint.h>

struct ball_path {
    const float *corners; /* 9 a triangle */
    uint32_t count;
    double radius; /* m: it touches where a triangle is so near to its centre */
    double at[3];
    uint64_t steps;
    /* What is near: all that is within `listed_reach` of `listed_at`. */
    double listed_at[3], listed_reach;
    uint32_t *listed, listed_count;
};

/* `corners` must live as long. 0 when there is no memory. `at` must be in the open. */
int ball_path_open(struct ball_path *path, const float *corners, uint32_t count, double radius, const double at[3]);
void ball_path_close(struct ball_path *path);

/* Go to where it rests, by a way of at most `longest`, m. Returns whether it rests there. */
int ball_path_follow(struct ball_path *path, const double device[3], double longest);

#endif
