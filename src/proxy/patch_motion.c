/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What holds the tool is solved for; each other triangle within reach must lie behind a plane that the straight motion
 * stays in front of. One that does not joins the problem. So the motion is proven without a sweep, and its end needs no
 * search: the next motion looks at the same triangles.
 */
#include "proxy/patch_motion.h"

#include "proxy/proxy_constraints.h"
#include "proxy/proxy_friction.h"
#include "proxy/proxy_motion.h"
#include "proxy/proxy_patch.h"

enum { MOTIONS_MAX = 8, SOLVES_MAX = 8 };

/* A motion may be so much shorter than the view reaches, as a multiple of the clearance. */
#define SHORTER 2.0

enum { MOTION_DONE, MOTION_MADE, MOTION_NONE };

/* Whether the solution leaves no motion that is worth making. */
static int is_arrived(const struct proxy_tick *tick, double size, double left)
{
    return left == 0.0 || size < PROXY_MOTION_SMALL * tick->clearance ||
           (size < PROXY_CONVERGED * left && tick->gap > PROXY_GAP_KEPT * tick->clearance);
}

/* Look around, and begin with the nearest triangle alone: the others join where it does not hold the tool off them. */
static int look(struct proxy_tick *tick, struct patch_view *view, double reach, vec3 hint)
{
    tick->space_count = tick->triangle_count = 0;
    return dpti_patch_look(tick, view, reach) &&
           (view->nearest == PATCH_TRIANGLES_MAX || dpti_patch_hold(tick, view, view->nearest, hint));
}

/* Make the share of the motion that was solved for. */
static void move(struct proxy_tick *tick, double share, double *allowed)
{
    struct proxy *proxy = tick->proxy;
    const struct proxy_pose from = tick->at;
    if (tick->solved.active_count == 0 && share == 1.0) {
        tick->at = tick->goal;
    } else {
        double y[HALF_SPACE_DIMENSIONS];
        for (uint32_t k = 0; k < proxy_unknowns(proxy); k++)
            y[k] = share * tick->solved.y[k];
        const struct displacement motion = dpti_proxy_of_unknowns(proxy, tick->axes, y);
        tick->at = dpti_proxy_moved(proxy, &from, &motion);
    }
    /* Until the next look. */
    tick->gap = -HUGE_VAL;
    tick->made = share;
    tick->is_moved = 1;
    const struct displacement moved = dpti_proxy_displacement(proxy, &from, &tick->at);
    dpti_proxy_note_slip(tick, moved.shift, proxy_whole_turn(&moved, &from));
    proxy->last_motion = displacement_norm(&proxy->coupling, &moved);
    proxy->trust = 4.0 * max_of(proxy->trust, proxy->last_motion);
    *allowed = max_of(0.0, *allowed - proxy->last_motion);
}

static int follow_once(struct proxy_tick *tick, double *allowed, double *reach, struct patch_view *view)
{
    struct proxy *proxy = tick->proxy;
    const double near = PATCH_NEAR * tick->clearance;
    const struct displacement way = dpti_proxy_displacement(proxy, &tick->at, &tick->goal);
    double wanted[HALF_SPACE_DIMENSIONS] = { 0.0 }, share;
    int has_widened = 0;
    dpti_proxy_turn_axes(proxy, &tick->at, tick->axes);
    dpti_proxy_to_unknowns(proxy, tick->axes, &way, wanted);
    const double left = displacement_norm(&proxy->coupling, &way);
    const vec3 hint = scaled(way.shift, left > 0.0 ? min_of(1.0, *reach / left) : 0.0);
    if (!look(tick, view, *reach, hint))
        return MOTION_NONE;
    for (int solves = 0;; solves++) {
        if (solves == SOLVES_MAX || !dpti_proxy_solve_rubbing(tick, wanted))
            return MOTION_NONE;
        work_spend(&tick->world->work, 1 + tick->triangle_count / 2);
        const double size = norm_of(tick->solved.y, proxy_unknowns(proxy));
        proxy->lag = size;
        if (is_arrived(tick, size, left)) {
            if (left > 0.0 && dpti_patch_prefer_pairs(tick, view))
                continue;
            dpti_proxy_remember_active(tick);
            return MOTION_DONE;
        }
        share = size > *allowed ? *allowed / size : 1.0;
        const double longest = view->reach - SHORTER * tick->clearance;
        if (share * size > longest && !has_widened) {
            *reach = 1.5 * share * size + near;
            has_widened = 1;
            if (!look(tick, view, *reach, hint))
                return MOTION_NONE;
            continue;
        }
        share = min_of(share, longest / size);
        const uint32_t added = dpti_patch_hold_obstacles(tick, view, scaled(vec3_of(tick->solved.y), share));
        if (added == HALF_SPACES_MAX)
            return MOTION_NONE;
        if (!added)
            break;
    }
    dpti_proxy_remember_active(tick);
    move(tick, share, allowed);
    *reach = near;
    return MOTION_MADE;
}

int dpti_patch_follow(struct proxy_tick *tick, double *allowed)
{
    struct proxy *proxy = tick->proxy;
    struct patch_view view;
    const struct displacement way = dpti_proxy_displacement(proxy, &tick->at, &tick->goal);
    if (tick->gap - length(way.shift) > tick->clearance || !dpti_patch_begin(tick, &view))
        return 0;
    double reach = proxy->last_motion + PATCH_NEAR * tick->clearance;
    proxy->owed = 0.0;
    tick->is_waiting = 0;
    for (int i = 0; i < MOTIONS_MAX; i++) {
        const int result = follow_once(tick, allowed, &reach, &view);
        if (result == MOTION_NONE)
            return 0;
        tick->is_settled = result == MOTION_DONE;
        if (tick->is_settled || *allowed <= PROXY_MOTION_SMALL * tick->clearance)
            break;
    }
    /* Where it ended: what the view tells; else a search does. The last constraints are kept. */
    if (tick->world->body_slot_end > UNLISTED_BODIES_MAX ||
        !(tick->is_settled || dpti_patch_look(tick, &view, PATCH_NEAR * tick->clearance)) ||
        !dpti_patch_answer(tick, &view))
        dpti_proxy_find_nearest(tick);
    return 1;
}
