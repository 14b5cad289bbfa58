/* SPDX-License-Identifier: BSD-3-Clause */
#include "proxy/proxy_solve.h"

/* Of the clearance: by how much a constraint may be missed. */
#define TOLERANCE 1e-6

/* Of the clearance: the gap that is left where walls on both sides leave no room for more. */
#define GAP_SPARED 0.5

/*
 * How much longer a motion may become than the bounds that it makes good. Walls that are all but parallel, on both
 * sides, would be left by a way of meters along them.
 */
#define LENGTHENED_MAX 100.0

/* Without bounds above 0 a motion is at most twice as long as the wanted one. */
static int is_short(const struct proxy_tick *tick, const struct half_spaces_result *solved, const double *wanted)
{
    const uint32_t n = proxy_unknowns(tick->proxy);
    double largest = 0.0;
    for (uint32_t i = 0; i < tick->space_count; i++)
        largest = max_of(largest, tick->spaces[i].bound);
    return norm_of(solved->y, n) <= 2.0 * norm_of(wanted, n) + LENGTHENED_MAX * largest;
}

static int nearest(struct proxy_tick *tick, const double *wanted)
{
    return dpti_half_spaces_nearest(tick->spaces, tick->space_count, proxy_unknowns(tick->proxy), wanted,
                                    TOLERANCE * tick->clearance, &tick->solved);
}

int dpti_proxy_solve_stuck(struct proxy_tick *tick, const double *wanted, const struct half_space *planes,
                           uint32_t plane_count, double *held)
{
    struct half_spaces_result solved;
    if (!dpti_half_spaces_nearest_on(planes, plane_count, held, tick->spaces, tick->space_count,
                                     proxy_unknowns(tick->proxy), wanted, TOLERANCE * tick->clearance, &solved) ||
        !is_short(tick, &solved, wanted))
        return 0;
    tick->solved = solved;
    return 1;
}

int dpti_proxy_solve(struct proxy_tick *tick, const double *wanted)
{
    double spare[HALF_SPACES_MAX];
    if (nearest(tick, wanted) && is_short(tick, &tick->solved, wanted))
        return 1;
    for (uint32_t i = 0; i < tick->space_count; i++) {
        struct half_space *space = &tick->spaces[i];
        const double pushed = dot(vec3_of(space->normal), tick->sources[i].carried);
        spare[i] = max_of(0.0, (1.0 - GAP_SPARED) * tick->clearance - (space->bound - pushed));
        space->bound = min_of(space->bound, pushed);
    }
    if (nearest(tick, wanted))
        return 1;
    /* Walls that are all but parallel, on both sides: rounding alone decides whether there is a way between them. */
    for (uint32_t i = 0; i < tick->space_count; i++)
        tick->spaces[i].bound -= spare[i];
    return nearest(tick, wanted);
}
