/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Which bodies are near an axis, so that a tick costs what is near and not what is there
 * (docs/algorithms/broad_phase.md). Around the axis lies a home, a box with room to move in. Bodies whose own
 * boxes touch it are listed; all others are at least as far away as the home's faces.
 */
#ifndef DPT_BROAD_PHASE_H
#define DPT_BROAD_PHASE_H

#include "base/frame.h"
#include "dynpoint/world.h"

struct box {
    vec3 low, high;
};

/* A home, in the world, and how many bodies are on its list. */
struct fat_box {
    struct box box;
    double margin;  /* from the axis to the faces, when it was made; 0: there is none */
    uint32_t count; /* bodies */
    uint32_t list;  /* of the segment's two lists */
};

/* One axis' surroundings. While a new home's list is made, the old one serves. */
struct broad_phase {
    struct fat_box current, rebuilt;
    vec3 a, b;            /* where the axis was last tick */
    double speed;         /* of the faster end, m a tick; slowly forgotten */
    uint32_t has_axis;    /* 0: it was nowhere */
    uint32_t is_scanning; /* there is a `next`; body slots from `scanned` on were not looked at */
    uint32_t next_slot;
    uint32_t reserved;
};

/* So few bodies are all near: a list of them would cost more than it saves. */
enum { UNLISTED_BODIES_MAX = 4 };

/* Bodies that may be within reach of a segment. */
struct near_bodies {
    const uint32_t *slots; /* of their slots, in order; or NULL: all of so many */
    uint32_t count;
    uint32_t reserved;
    double reach; /* negative: not looked for yet */
};

/* The box of an axis. */
static inline struct box box_of_axis(vec3 a, vec3 b)
{
    return (struct box){ { min_of(a.x, b.x), min_of(a.y, b.y), min_of(a.z, b.z) },
                         { max_of(a.x, b.x), max_of(a.y, b.y), max_of(a.z, b.z) } };
}

/* A lower bound of the distance of what the boxes hold. */
static inline double box_distance(const struct box *a, const struct box *b)
{
    vec3 gap = { max_of(0.0, max_of(a->low.x - b->high.x, b->low.x - a->high.x)),
                 max_of(0.0, max_of(a->low.y - b->high.y, b->low.y - a->high.y)),
                 max_of(0.0, max_of(a->low.z - b->high.z, b->low.z - a->high.z)) };
    return length(gap);
}

/* Both touch, or overlap. */
static inline int box_meets(const struct box *a, const struct box *b)
{
    return a->low.x <= b->high.x && b->low.x <= a->high.x && a->low.y <= b->high.y &&
           b->low.y <= a->high.y && a->low.z <= b->high.z && b->low.z <= a->high.z;
}

/* Its share of dpt_world_bytes: each segment's two lists of bodies. */
uint64_t dpti_broad_phase_bytes(const dpt_world_def *def);

/* Place its memory at `at`; returns where it ends. */
char *dpti_broad_phase_place(struct dpt_world *world, char *at);

/* Forget what is near a segment. */
void dpti_broad_phase_forget(struct dpt_world *world, uint32_t segment_index);

/* Remove the segments from `first` up to, not including, `end`: those behind them move up. */
void dpti_broad_phase_remove(struct dpt_world *world, uint32_t first, uint32_t end);

/* A body is there, or its pose has changed: its box, and the lists that it belongs on. */
void dpti_broad_phase_put_body(struct dpt_world *world, uint32_t slot);

/* A tick begins: the axis is here now. */
void dpti_broad_phase_move(struct broad_phase *broad_phase, vec3 a, vec3 b);

/*
 * List the bodies that may be as near to a segment as `distance`, that of the nearest so far, within the budget.
 * Returns how near those that are not listed may be.
 */
double dpti_broad_phase_update(struct dpt_world *world, uint32_t segment_index, double distance);

/*
 * All is proven: where a list is far longer than it need be, and there is work left for a whole scan, make it anew.
 */
void dpti_broad_phase_shrink(struct dpt_world *world, uint32_t segment_index, double distance);

/*
 * The bodies whose boxes may be within reach of a segment, after its nearest pair was searched for. They are looked
 * for once: with the first reach that is asked for, or that of its contact, whichever is larger. world->nearby.reach
 * is negative before.
 */
const struct near_bodies *dpti_broad_phase_within(struct dpt_world *world, uint32_t segment_index,
                                                  double reach);

#endif
