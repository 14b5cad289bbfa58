/* SPDX-License-Identifier: BSD-3-Clause */
#include "nearest/bvh.h"

void dpti_brute_search(const struct surface *surface, vec3 a, vec3 u, struct work *work, struct pair_search *nearest)
{
    for (uint32_t t = 0; t < surface_triangles(surface); t++) {
        pair found = dpti_triangle_pair(surface, t, a, u);
        pair_search_improve(surface, t, &found, nearest);
    }
    work_spend(work, surface->mesh->leaves);
}
