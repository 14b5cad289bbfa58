/* SPDX-License-Identifier: BSD-3-Clause */
/* Which triangles of a patch hold a proxy, and that the others are in nobody's way: docs/algorithms/patch.md. */
#ifndef DPT_PATCH_CONSTRAINTS_H
#define DPT_PATCH_CONSTRAINTS_H

#include "proxy/proxy_patch.h"

/*
 * Make a triangle of the list a constraint of the motions up to `reach`, m. `motion`, m in the world, is where the tool
 * may go. Returns 0 if there is no room for it, or it touches the axis.
 */
int dpti_patch_hold(struct proxy_tick *tick, struct patch_view *view, uint32_t i, double reach, vec3 motion);

/*
 * Where triangles are held by the planes of their faces, and these hold the tool where the triangles are not: by their
 * pairs' planes from now on. Returns 0 if there is none of that kind.
 */
int dpti_patch_prefer_pairs(struct proxy_tick *tick, struct patch_view *view);

enum patch_proof {
    PATCH_FREE,    /* nothing is in the way */
    PATCH_ADDED,   /* some of what may be in the way has become a constraint */
    PATCH_CROWDED, /* there is no room for it */
    PATCH_UNPROVEN /* a triangle that is a constraint already is not proven to stay out of the way */
};

/*
 * Whether the tool may go straight from tick->at to a pose, within the reach of the view. In nobody's way are triangles
 * behind the plane of a constraint that holds, or that of their own nearest pair, which the tool stays in front of.
 *   met   PATCH_UNPROVEN: the share of the way up to which that triangle is not met; 0: it is not known
 */
enum patch_proof dpti_patch_prove(struct proxy_tick *tick, struct patch_view *view, const struct proxy_pose *to,
                                  double reach, double *met);

#endif
