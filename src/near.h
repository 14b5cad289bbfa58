/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Which bodies are near an axis, so that a tick costs what is near and not what is there
 * (docs/algorithms/near.md). Around the axis lies a home, a box with room to move in. Bodies whose own
 * boxes touch it are listed; all others are at least as far away as the home's faces.
 */
#ifndef DPT_NEAR_H
#define DPT_NEAR_H

#include "pose.h"

struct box {
    vec3 low, high;
};

/* One axis' home, in the world. */
struct near {
    struct box home;
    double room;      /* from the axis to the home's faces, when it was made; 0: there is none */
    double speed;     /* of the faster end, m a tick; slowly forgotten */
    vec3 a, b;        /* where the axis was last tick */
    uint32_t known;   /* 0: it was nowhere */
    uint32_t listed;  /* bodies on the list */
    uint32_t scanned; /* body slots from here on were not looked at */
};

/* The box of an axis. */
static inline struct box box_of_axis(vec3 a, vec3 b)
{
    return (struct box){ { smaller(a.x, b.x), smaller(a.y, b.y), smaller(a.z, b.z) },
                         { larger(a.x, b.x), larger(a.y, b.y), larger(a.z, b.z) } };
}

/* The box, in the world, of a box in a body's frame; a little larger than rounding may make it. */
struct box box_in_world(vec3 low, vec3 high, const struct frame *frame);

/* A lower bound of the distance of what the boxes hold. */
static inline double box_distance(const struct box *a, const struct box *b)
{
    vec3 gap = { larger(0.0, larger(a->low.x - b->high.x, b->low.x - a->high.x)),
                 larger(0.0, larger(a->low.y - b->high.y, b->low.y - a->high.y)),
                 larger(0.0, larger(a->low.z - b->high.z, b->low.z - a->high.z)) };
    return length(gap);
}

/* Both touch, or overlap. */
static inline int box_meets(const struct box *a, const struct box *b)
{
    return a->low.x <= b->high.x && b->low.x <= a->high.x && a->low.y <= b->high.y &&
           b->low.y <= a->high.y && a->low.z <= b->high.z && b->low.z <= a->high.z;
}

/* A tick begins: the axis is here now. */
void near_move(struct near *near, vec3 a, vec3 b);

/* All that is not listed is at least so far away, once all slots are scanned. */
double near_reach(const struct near *near);

/* The home serves an axis whose nearest body is at `distance`: it is not left, and not far too large. */
int near_serves(const struct near *near, double distance);

/* A new home for that distance, and an empty list. */
void near_settle(struct near *near, double distance);

#endif
