/* SPDX-License-Identifier: BSD-3-Clause */
/* What a patch knows of tips: the planes of their sides, their pairs and motions (docs/algorithms/patch.md). */
#ifndef DPT_PATCH_TIPS_H
#define DPT_PATCH_TIPS_H

#include "proxy/proxy_patch.h"

/* m: no corner of a tip is farther from where it is with the tool's frame at `from`, where that is at `to`. */
double dpti_patch_tip_moved(const struct tip *tip, const struct frame *from, const struct frame *to);

/* Put the corners of a side's tip where the tool's frame is. Returns how far they moved, m. */
double dpti_patch_tip_place(struct patch_side *side, const struct frame *tool);

/* Its corners where the tool's frame is at the end of a motion. Returns how far they go, m. */
double dpti_patch_tip_lead(const struct patch_side *side, const struct frame *to);

/* Choose the planes of a side. */
void dpti_patch_tip_planes(struct patch_side *side, const struct frame *tool);

/*
 * Begin a triangle of the list: which of these planes tells the most of its gap. Returns 0 if that is more than `within`,
 * m.
 */
int dpti_patch_tip_list(const struct patch_side *side, struct patch_triangle *triangle, double within);

/* The pairs of those near a tip's side, and its nearest. */
void dpti_patch_tip_find_near(struct proxy_tick *tick, struct patch_view *view, uint32_t number);

/* The nearest triangle of a side becomes the tip's answer. */
void dpti_patch_tip_answer(const struct dpt_world *world, const struct patch_side *side, const struct frame *tool,
                           const struct patch_triangle *nearest);

#endif
