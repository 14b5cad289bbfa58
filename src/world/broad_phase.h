/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Which bodies are near an axis, so that a tick costs what is near and not what is there
 * (docs/algorithms/near.md). Around the axis lies a home, a box with room to move in. Bodies whose own
 * boxes touch it are listed; all others are at least as far away as the home's faces.
 */
#ifndef DPT_BROAD_PHASE_H
#define DPT_BROAD_PHASE_H

#include "base/frame.h"

struct box {
    vec3 low, high;
};

/* A home, in the world, and how many bodies are on its list. */
struct home {
    struct box box;
    double room;     /* from the axis to the faces, when it was made; 0: there is none */
    uint32_t listed; /* bodies */
    uint32_t which;  /* of the segment's two lists */
};

/* One axis' surroundings. While a new home's list is made, the old one serves. */
struct near {
    struct home now, next;
    vec3 a, b;         /* where the axis was last tick */
    double speed;      /* of the faster end, m a tick; slowly forgotten */
    uint32_t known;    /* 0: it was nowhere */
    uint32_t scanning; /* there is a `next`; body slots from `scanned` on were not looked at */
    uint32_t scanned;
    uint32_t reserved;
};

/* The box of an axis. */
static inline struct box box_of_axis(vec3 a, vec3 b)
{
    return (struct box){ { smaller(a.x, b.x), smaller(a.y, b.y), smaller(a.z, b.z) },
                         { larger(a.x, b.x), larger(a.y, b.y), larger(a.z, b.z) } };
}

/* The box, in the world, of a box in a body's frame; a little larger than rounding may make it. */
struct box dpti_box_in_world(vec3 low, vec3 high, const struct frame *frame);

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
void dpti_near_move(struct near *near, vec3 a, vec3 b);

/* All that is not on the list is at least so far away. */
double dpti_near_reach(const struct near *near);

/* The home is far larger than it would be made now. */
int dpti_near_is_wide(const struct near *near, double distance);

/* Begin a new home, for an axis whose nearest body is at `distance`. */
void dpti_near_settle(struct near *near, double distance);

/* All slots are scanned: move. */
void dpti_near_arrive(struct near *near);

#endif
