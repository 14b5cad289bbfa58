/* SPDX-License-Identifier: BSD-3-Clause */
#include "proxy/solved_motion.h"

#include "proxy/proxy_constraints.h"
#include "proxy/proxy_friction.h"

enum { CORRECTIONS_MAX = 2 };

/* The smallest share that is left of a shortened motion. */
#define SHARE_MIN 0.01

/* rad: the largest turn of one motion. */
#define TURN_MAX 0.3

double dpti_solved_wanted(const struct proxy_tick *tick, const struct displacement *left, double *wanted)
{
    const struct displacement pulled = dpti_proxy_pulled(left);
    dpti_proxy_to_unknowns(tick->proxy, tick->axes, &pulled, wanted);
    return displacement_norm(&tick->proxy->coupling, &pulled);
}

/* By how much a motion is to be shortened: not beyond `longest`, and not turned too far at once. */
static double share_allowed(const struct proxy_tick *tick, double longest)
{
    const uint32_t n = proxy_unknowns(tick->proxy);
    const double *y = tick->solved.y, size = norm_of(y, n);
    double turn2 = 0.0;
    for (uint32_t k = 3; k < n; k++)
        turn2 += y[k] * y[k] / (proxy_rho_of(tick->proxy, k) * proxy_rho_of(tick->proxy, k));
    const double turn = sqrt(turn2);
    double share = size > longest ? longest / size : 1.0;
    return turn * share > TURN_MAX ? TURN_MAX / turn : share;
}

struct proxy_pose dpti_solved_pose(const struct proxy_tick *tick, const double *straight, double share)
{
    double y[HALF_SPACE_DIMENSIONS];
    for (uint32_t k = 0; k < proxy_unknowns(tick->proxy); k++)
        y[k] = share * (straight[k] + share * (tick->solved.y[k] - straight[k]));
    const struct displacement motion = dpti_proxy_of_unknowns(tick->proxy, tick->axes, y);
    return dpti_proxy_moved(tick->proxy, &tick->at, &motion);
}

/* m: no point of the tool is farther from where it was at a pose. Of tips it is not known. */
static double farthest_to(const struct proxy_tick *tick, const struct proxy_pose *to)
{
    double farthest = 0.0;
    if (tick->tool->tip_count)
        return HUGE_VAL;
    for (uint32_t i = 0; i < tick->tool->segment_count; i++) {
        const struct segment *segment = &tick->world->segments[tick->tool->first_segment + i];
        const vec3 a = sub(frame_to_world(&to->frame, segment->a), frame_to_world(&tick->at.frame, segment->a));
        const vec3 b = sub(frame_to_world(&to->frame, segment->b), frame_to_world(&tick->at.frame, segment->b));
        farthest = max_of(farthest, max_of(dot(a, a), dot(b, b)));
    }
    return sqrt(farthest);
}

struct proxy_pose dpti_solved_correct(struct proxy_tick *tick, const double *wanted, const double *straight,
                                      double longest, double *share)
{
    struct proxy_pose to;
    for (int k = 0;; k++) {
        int is_low = 0;
        *share = share_allowed(tick, longest);
        to = dpti_solved_pose(tick, straight, *share);
        const double far = farthest_to(tick, &to);
        for (uint32_t i = 0; i < tick->space_count && k < CORRECTIONS_MAX; i++) {
            if (tick->sources[i].gap - far >= PROXY_GAP_KEPT * tick->clearance)
                continue;
            const double gap = dpti_proxy_gap_of(tick, i, &to);
            if (gap >= PROXY_GAP_KEPT * tick->clearance)
                continue;
            tick->spaces[i].bound += tick->clearance - gap;
            is_low = 1;
        }
        if (!is_low || !dpti_proxy_solve_rubbing(tick, wanted))
            return to;
    }
}

/* m^2: what friction gives to a motion that it drives, as by a body that moves under the tool; 0 where it takes. */
static double driven(const struct proxy_tick *tick, const double *motion)
{
    double pulled[HALF_SPACE_DIMENSIONS] = { 0.0 };
    for (uint32_t i = 0; i < tick->contact_count; i++)
        dpti_friction_add(&tick->contacts[i], 1.0, pulled);
    return max_of(0.0, product_of(pulled, motion, proxy_unknowns(tick->proxy)));
}

double dpti_solved_best_share(const struct proxy_tick *tick, const struct proxy_pose *to,
                              const struct displacement *now, const double *wanted, const double *straight, double left,
                              double share)
{
    const struct coupling *coupling = &tick->proxy->coupling;
    const struct displacement then = dpti_proxy_displacement(tick->proxy, to, &tick->goal);
    const struct displacement pulled = dpti_proxy_pulled(&then);
    const double beyond = dpti_proxy_stored_beyond(&then) - dpti_proxy_stored_beyond(now);
    const double far = displacement_norm(coupling, &pulled);
    /* So much may be lost to regain the clearance, and to what friction drives. */
    const double slack = 1.5 * left * max_of(0.0, tick->clearance - tick->gap) + driven(tick, straight);
    double slope = -slack;
    for (uint32_t k = 0; k < proxy_unknowns(tick->proxy); k++)
        slope -= wanted[k] * straight[k];
    const double rise = 0.5 * (far * far - left * left) + coupling->rho * coupling->rho * beyond, spare = slack * share;
    if (slope >= 0.0)
        return rise > spare ? share * max_of(SHARE_MIN, spare / rise) : share;
    const double bend = (rise - spare - slope * share) / (share * share);
    return -slope < 2.0 * share * bend ? max_of(SHARE_MIN * share, -0.5 * slope / bend) : share;
}
