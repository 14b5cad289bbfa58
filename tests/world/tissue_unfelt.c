/* SPDX-License-Identifier: BSD-3-Clause */
#include "world/tissue_unfelt.h"

#include "tissue/tissue_state.h"
#include "track/deform_state.h"

double tissue_unfelt(const dpt_world *world, dpt_body body)
{
    const struct deform *deform = deform_of(world_find_body(world, body));
    const struct tissue_solve *solve = deform ? deform->solve : NULL;
    double most = 0.0;
    for (uint32_t i = 0; solve && i < solve->spread_count; i++)
        most = max_of(most, solve->spread_touches[i].unfelt);
    return most;
}
