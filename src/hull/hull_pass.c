/* SPDX-License-Identifier: BSD-3-Clause */
#include "hull/hull_pass.h"

/* A pair that is farther apart than that many times the motion tells nothing of it. */
#define PAIR_REACH 4.0

/* Directions at both ends whose cosine is less would make a short one between them. */
#define COSINE_MIN 0.5

/* The direction from triangle to hull where its frame is at `tool`; 0: they meet, or are far from each other. */
static vec3 direction_at(const struct hull_pass *pass, const struct frame *tool, const vec3 v[3])
{
    struct hull_place place;
    struct hull_pair found;
    hull_place_set(&place, pass->hull, tool, pass->body);
    return dpti_hull_triangle(&place, v, pass->apart + PAIR_REACH * pass->moved, &found) ? unit_of(found.pair.gap)
                                                                                         : (vec3){ 0.0, 0.0, 0.0 };
}

struct hull_turn dpti_hull_turn_of(const struct hull_pass *pass, vec3 from, vec3 to)
{
    const uint32_t count = pass->hull->corner_count;
    struct hull_turn turn = { from, to, { HUGE_VAL, HUGE_VAL, HUGE_VAL } };
    for (uint32_t i = 0; i < count; i++) {
        const vec3 first = pass->corner[i], last = pass->corner[count + i];
        turn.low[0] = min_of(turn.low[0], dot(from, first));
        turn.low[1] = min_of(turn.low[1], 0.5 * (dot(from, last) + dot(to, first)));
        turn.low[2] = min_of(turn.low[2], dot(to, last));
    }
    return turn;
}

int dpti_hull_turn_parts(const struct hull_turn *turn, const vec3 v[3], double apart)
{
    double high[HULL_TURN_DEGREES] = { -HUGE_VAL, -HUGE_VAL, -HUGE_VAL };
    for (int k = 0; k < 3; k++) {
        const double from = dot(turn->from, v[k]), to = dot(turn->to, v[k]);
        high[0] = max_of(high[0], from);
        high[1] = max_of(high[1], 0.5 * (from + to));
        high[2] = max_of(high[2], to);
    }
    return turn->low[0] - high[0] > apart && turn->low[1] - high[1] > apart && turn->low[2] - high[2] > apart;
}

int dpti_hull_ends_apart(const struct hull_pass *pass, const vec3 v[3], vec3 *n)
{
    const uint32_t count = pass->hull->corner_count;
    return dpti_separate(pass->corner + count, count, v, 3, pass->apart, n);
}

int dpti_hull_passes(const struct hull_pass *pass, const vec3 v[3], vec3 *n)
{
    if (hull_height(pass->corner, 2 * pass->hull->corner_count, scaled(*n, -1.0), v) > pass->apart)
        return 1;
    if (dpti_separate(pass->corner, 2 * pass->hull->corner_count, v, 3, pass->apart, n))
        return 1;
    *n = (vec3){ 0.0, 0.0, 0.0 };
    const vec3 from = direction_at(pass, pass->from, v);
    if (!(dot(from, from) > 0.0))
        return 0;
    const vec3 to = direction_at(pass, pass->to, v);
    if (!(dot(from, to) > COSINE_MIN))
        return 0;
    const struct hull_turn turn = dpti_hull_turn_of(pass, from, to);
    return dpti_hull_turn_parts(&turn, v, pass->apart);
}
