/* SPDX-License-Identifier: BSD-3-Clause */
#include "world/proxy_solve.h"

/* Of the clearance: by how much a constraint may be missed. */
#define TOLERANCE 1e-6

int dpti_proxy_solve(struct proxy_tick *tick, const double *wanted)
{
    const uint32_t n = proxy_unknowns(tick->proxy);
    const double tolerance = TOLERANCE * tick->clearance;
    if (dpti_half_spaces_nearest(tick->spaces, tick->space_count, n, wanted, tolerance,
                                 &tick->solved))
        return 1;
    for (uint32_t i = 0; i < tick->space_count; i++)
        tick->spaces[i].bound = min_of(tick->spaces[i].bound, 0.0);
    return dpti_half_spaces_nearest(tick->spaces, tick->space_count, n, wanted, tolerance,
                                    &tick->solved);
}
