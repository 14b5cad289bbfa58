/* SPDX-License-Identifier: BSD-3-Clause */
/* Regions of contact that live from tick to tick, of one segment with all bodies. docs/algorithms/regions.md. */
#ifndef DPT_CONTACTS_H
#define DPT_CONTACTS_H

#include "contact/gap.h"
#include "world/body_search.h"

/* A tick begins: what was now is before. */
void contacts_turn(struct dpt_world *world);

/*
 * Contact, gap and depth of a segment whose nearest pair `best` is exact, into `hit`, and the push at its deepest point;
 * its regions into the world.
 */
void contacts_find(struct dpt_world *world, uint32_t segment, const struct found *best,
                   dpt_hit *hit, struct push *push);

/* A segment of which nothing is known this tick: its regions live on, unseen. */
void contacts_keep(struct dpt_world *world, uint32_t segment);

/* The motion met a sheet from this side: it is kept where none is of that part. Before contacts_find or contacts_keep. */
void contacts_meet(struct dpt_world *world, uint32_t segment, const struct body *body,
                   uint32_t part, int side, const struct seed *seed);

/* As by a teleport: the sides of a segment's regions of the last tick. */
void contacts_forget_sides(struct dpt_world *world, uint32_t segment);

/* Forget those of the segments from `first` to before `end`, and of a body or, with DPT_NONE, of all. */
void contacts_forget(struct dpt_world *world, uint32_t first, uint32_t end, uint32_t body);

/* The same, and the segments behind them move up. */
void contacts_remove(struct dpt_world *world, uint32_t first, uint32_t end);

#endif
