/* SPDX-License-Identifier: BSD-3-Clause */
#include "nearest/bvh.h"

void dpti_tree_brute(const struct surface *surface, vec3 a, vec3 u, struct work *work,
                     struct nearest *nearest)
{
    for (uint32_t t = 0; t < surface_triangles(surface); t++) {
        pair found = dpti_tree_pair(surface, t, a, u);
        nearest_take(surface, t, &found, nearest);
    }
    work_spend(work, surface->mesh->leaves);
}
