/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The bodies near a segment, so that the cost of a tick grows with the near bodies and not with all bodies
 * (docs/algorithms/broad_phase.md). Each segment has a fat box in the world: the box of its axis with a margin. The
 * bodies whose boxes touch it are on the segment's list. All other bodies are at least as far from the axis as the
 * faces of the fat box.
 */
#ifndef DPT_BROAD_PHASE_H
#define DPT_BROAD_PHASE_H

#include "base/box.h"
#include "base/frame.h"
#include "dynpoint/world.h"

/* A fat box and its list of bodies. */
struct fat_box {
    struct box box;
    double margin;  /* m, around the axis when the box was made; 0: there is none */
    uint32_t count; /* bodies on the list */
    uint32_t list;  /* which of the segment's two near lists: 0 or 1 */
};

/* The fat boxes of one segment. The current one stays in use while a scan makes the list of a new one. */
struct broad_phase {
    struct fat_box current;
    struct fat_box rebuilt; /* only while is_scanning */
    vec3 a, b;              /* the ends of the axis in the world, as last given */
    double speed;           /* m per tick, of the faster end; a peak fades slowly */
    uint32_t has_axis;      /* 0: `a` and `b` were never given */
    uint32_t is_scanning;
    uint32_t next_slot; /* of the scan: bodies in lower slots were compared with `rebuilt` */
    uint32_t reserved;
};

/* Up to that many bodies, all count as near: a list would cost more than it saves. */
enum { UNLISTED_BODIES_MAX = 4 };

/* The bodies that may be within reach of a segment. */
struct near_bodies {
    const uint32_t *slots; /* in ascending order; NULL: all slots below `count` */
    uint32_t count;
    uint32_t reserved;
    double reach; /* m; negative: not determined yet */
};

/* Another segment, or the same at another place, comes next: the bodies near it are to be determined anew. */
static inline void near_bodies_forget(struct near_bodies *near_bodies)
{
    near_bodies->reach = -1.0;
}

/* Its share of dpt_world_bytes: two near lists for each segment. */
uint64_t dpti_broad_phase_bytes(const dpt_world_def *def);

/* Place its memory at `at`; returns where it ends. */
char *dpti_broad_phase_place(struct dpt_world *world, char *at);

/* Forget a segment's fat boxes, lists and motion. */
void dpti_broad_phase_forget(struct dpt_world *world, uint32_t segment_index);

/* Remove the lists of the segments from `first` up to, not including, `end`; those of later segments move up. */
void dpti_broad_phase_remove(struct dpt_world *world, uint32_t first, uint32_t end);

/*
 * After a body is added or its pose changes: set its box, and put it on the lists of the fat boxes that it touches.
 */
void dpti_broad_phase_put_body(struct dpt_world *world, uint32_t slot);

/* Begin a tick with the axis from `a` to `b` (world). */
void dpti_broad_phase_move(struct broad_phase *broad_phase, vec3 a, vec3 b);

/*
 * Bring a segment's list up to date, within the budget, so that it has all bodies within `distance` (m, that of the
 * nearest pair so far). Returns the reach: no unlisted body is nearer. It is below `distance` if the budget ended the
 * scan.
 */
double dpti_broad_phase_update(struct dpt_world *world, uint32_t segment_index, double distance);

/*
 * Replace a list whose fat box is far larger than `distance` (m) requires, if work is left for a whole scan. For
 * ticks in which everything is proven.
 */
void dpti_broad_phase_shrink(struct dpt_world *world, uint32_t segment_index, double distance);

/*
 * The bodies whose boxes may be within `reach` (m) of a segment. Call it after the search for the nearest pair, and
 * near_bodies_forget before the first call for a segment in a tick. The answer is kept, and given again for a smaller
 * reach; the first call uses at least the reach of the segment's contact.
 */
const struct near_bodies *dpti_broad_phase_within(struct dpt_world *world, uint32_t segment_index, double reach);

#endif
