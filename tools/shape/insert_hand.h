/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A hand inserts a needle into a mesh, pauses, and draws it out on the same line; then it rests, and does so again. The
 * needle's tip is end a. It enters at a place of the surface against the normal there. On the way the speed is constant, but
 * for a ramp at either end. Only arithmetic is used, so a seed gives the same bits on every machine.
 */
#ifndef DPT_TOOLS_INSERT_HAND_H
#define DPT_TOOLS_INSERT_HAND_H

#include "shape/trace_hand.h"

struct insert_hand {
    vec3 entry, normal; /* of the surface, in the mesh's frame */
    double length, depth, speed, height;
    uint64_t ticks; /* so far */
};

/*
 * Begin above the surface, where another hand begins that has the default length.
 *   length   of the needle, m; 0: 0.1 m for a mesh with a diagonal of 0.35 m, scaled with it
 *   depth    of the tip beneath the surface where it pauses, m; 0: 0.03, scaled
 *   speed    on the way, m/s; 0: 0.02, scaled
 */
void insert_hand_begin(struct insert_hand *hand, const struct trace_hand *place, double length, double depth,
                       double speed);

/* Ticks of one insertion, from rest to rest; at most so many, which is none that anybody waits for. */
#define INSERT_TICKS_MAX 1000000000u
uint64_t insert_hand_ticks(const struct insert_hand *hand);

/* The needle's ends in the next tick of 1 ms, in the mesh's frame: ax, ay, az, bx, by, bz. */
void insert_hand_move(struct insert_hand *hand, double ends[6]);

#endif
