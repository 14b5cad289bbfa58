/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * For long runs: how near a segment is to a mesh, and on which side of a closed one a point is, by looking at every
 * triangle. A triangle is passed over only where its bounding ball is out of reach; the rest is oracle/brute.h.
 *
 * Sides are counts of crossings, by signs of volumes in plain double. A piece through an edge or a corner may be
 * counted wrongly, so a count that matters is asked of three rays.
 */
#ifndef DPT_TESTS_SOAK_ORACLE_H
#define DPT_TESTS_SOAK_ORACLE_H

#include "lib/solid.h"

struct soak_oracle {
    const struct solid *solid;
    double *balls; /* x, y, z, radius: one array of `room` after the other */
    uint32_t *near;
    uint32_t count, room;
    int is_closed; /* a path between two points outside goes through its triangles an even number of times */
};

/* `solid` must live as long. 0 when there is no memory. */
int soak_oracle_open(struct soak_oracle *oracle, const struct solid *solid);
void soak_oracle_close(struct soak_oracle *oracle);

/* The distance of a segment, or `limit` if that is less. */
double soak_distance(struct soak_oracle *oracle, const double ends[6], double limit);

/* How many triangles the straight way between two points goes through. */
uint32_t soak_crossings(struct soak_oracle *oracle, const double ends[6]);

/* Of a closed mesh, by the most of three rays. */
int soak_is_inside(struct soak_oracle *oracle, const double x[3], uint64_t *seed);

#endif
