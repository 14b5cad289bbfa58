/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Over which vertices a body with a load_radius spreads the load of a touch, found by looking at all triangles again and again.
 */
#ifndef DPT_TESTS_TISSUE_PATCH_H
#define DPT_TESTS_TISSUE_PATCH_H

#include "world/tissue_rig.h"

enum { PATCH_VERTICES = 4096 };

/* A vertex of a patch: from the pair's point, and across its normal. */
struct patch_vertex {
    double at[3], across[2], weight;
    int is_in;
};

/*
 * All vertices of the body, those of the patch at q with their shares: q is on a triangle of these corners, and the shares' mean
 * lies beside it along n. NULL: it is the triangle's corners alone.
 */
const struct patch_vertex *patch_at(const struct tissue_rig *tissue, const struct tissue_body *body, const double q[3],
                                    const double n[3], const uint32_t *corners);

#endif
