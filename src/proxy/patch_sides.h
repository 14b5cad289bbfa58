/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Which segments and tips of a tool are beside which bodies, and the patch of each such pair, which is kept from tick to tick:
 * docs/algorithms/patch.md.
 */
#ifndef DPT_PATCH_SIDES_H
#define DPT_PATCH_SIDES_H

#include "proxy/proxy_patch.h"

/* Its share of dpt_world_bytes. */
uint64_t dpti_patch_bytes(const dpt_world_def *def);

/* Those of a segment; of a tool its first segment's are the first. */
static inline struct proxy_patch *patches_of(const struct dpt_world *world, uint32_t segment)
{
    return &world->patches[PATCH_BODIES * (size_t)segment];
}

/* Those of a segment or tip. */
static inline struct proxy_patch *patches_of_part(const struct dpt_world *world, struct part part)
{
    return patches_of(world, part.tip ? world->def.max_segments + (uint32_t)(part.tip - world->tips)
                                      : (uint32_t)(part.segment - world->segments));
}

/* Those of a tool begin anew, as if they had never been used. */
void dpti_patches_forget(const struct dpt_world *world, const struct tool *tool);

/*
 * The sides of the view within `reach` m, as its axes are, each with a patch of all triangles whose gaps are at most
 * that. Where a patch has no room for these, they are of a smaller reach, but not much below `least`; returns it. 0: there
 * are too many bodies, or triangles, or the work is spent.
 *   others   m: bodies that have no side have no gap below that
 */
double dpti_patch_find_sides(struct dpt_world *world, struct patch_view *view, double reach, double least,
                             double *others);

/* Put the axis of a side, and its tip, in the body's frame where the view has it. Returns how far it moved, m. */
double dpti_patch_place_side(const struct patch_view *view, struct patch_side *side);

/* m: how far the axis is from that about which the patch lies. */
static inline double patch_off_centre(const struct patch_side *side)
{
    return max_of(length(sub(side->a, side->patch->a)), length(sub(add(side->a, side->u), side->patch->b)));
}

#endif
