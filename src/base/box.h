/* SPDX-License-Identifier: BSD-3-Clause */
/* Axis-aligned boxes, in any one frame. Lengths are in m. */
#ifndef DPT_BOX_H
#define DPT_BOX_H

#include "base/vec3.h"

struct box {
    vec3 low, high;
};

/* The box of an axis. */
static inline struct box box_of_axis(vec3 a, vec3 b)
{
    return (struct box){ { min_of(a.x, b.x), min_of(a.y, b.y), min_of(a.z, b.z) },
                         { max_of(a.x, b.x), max_of(a.y, b.y), max_of(a.z, b.z) } };
}

/* The distance between two boxes, 0 if they overlap: a lower bound for what they hold. */
static inline double box_distance(const struct box *a, const struct box *b)
{
    vec3 gap = { max_of(0.0, max_of(a->low.x - b->high.x, b->low.x - a->high.x)),
                 max_of(0.0, max_of(a->low.y - b->high.y, b->low.y - a->high.y)),
                 max_of(0.0, max_of(a->low.z - b->high.z, b->low.z - a->high.z)) };
    return length(gap);
}

/* 1 if two boxes touch or overlap. */
static inline int box_meets(const struct box *a, const struct box *b)
{
    return a->low.x <= b->high.x && b->low.x <= a->high.x && a->low.y <= b->high.y && b->low.y <= a->high.y &&
           a->low.z <= b->high.z && b->low.z <= a->high.z;
}

/* The least box that holds both. */
static inline struct box box_joined(const struct box *a, const struct box *b)
{
    const struct box low = box_of_axis(a->low, b->low), high = box_of_axis(a->high, b->high);
    return (struct box){ low.low, high.high };
}

/* The length of its diagonal. */
static inline double box_diagonal(const struct box *box)
{
    return length(sub(box->high, box->low));
}

#endif
