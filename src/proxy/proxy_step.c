/* SPDX-License-Identifier: BSD-3-Clause */
#include "proxy/proxy.h"

#include "proxy/patch_motion.h"
#include "proxy/proxy_channel.h"
#include "proxy/proxy_constraints.h"
#include "proxy/proxy_force.h"
#include "proxy/proxy_friction.h"
#include "proxy/proxy_motion.h"
#include "proxy/proxy_put.h"
#include "proxy/solved_motion.h"
#include "proxy/tip_pose.h"
#include "proxy/tool_loads.h"
#include "track/tool_parts.h"

enum { ITERATIONS_MAX = 8 };

/* How often a moving body may push a proxy away. After that the body takes it along. */
enum { PUSHES_MAX = 4 };

/* As a share of the clearance. */
#define GAP_SHARE 0.375

/*
 * After the proxy has met a moving body, contacts are left wider than the clearance: by this share of the motion, and
 * by twice as much each further time. A straight motion beside a turning surface comes nearer to it in between.
 */
#define LIFT_SHARE 0.05

/*
 * The share of a tool's radius that surfaces may dent: on the way to the end of a step together with tissue, and where
 * tissue leaves no room there.
 */
#define DENTED      0.1
#define DENTED_MOST 0.5

/*
 * rad: how far friction can hold the spin back, at the start of a tick and at its end. The second is larger: a tool
 * that rolls far within a tick was solved for with its friction, and is left as it is.
 */
#define SPIN_MAX        1.0
#define SPIN_ROLLED_MAX 1.5

/* As a share of the minimum gap: a proxy that is nearer to its device than that counts as being there. */
#define HELD 1e-3

/*
 * What is felt of a turn by t is the least turn: where the axis moves aside, that moves by t / sin(t) as much. So much more, at
 * most, for each rad^2 up to 1 rad.
 */
#define BENT 0.2

/*
 * The reach of the motion must be guessed before there are constraints to solve for it. If it was too short: once more.
 */
static int gather_and_solve(struct proxy_tick *tick, const double *wanted, double left)
{
    const uint32_t n = proxy_unknowns(tick->proxy);
    const double bodies_moved = tick->is_before ? world_body_motion(tick->world) : 0.0;
    double reach = 2.0 * tick->proxy->last_motion + 20.0 * tick->clearance + 2.0 * bodies_moved;
    for (int again = 0;; again++) {
        dpti_proxy_turn_axes(tick->proxy, &tick->at, tick->axes);
        dpti_proxy_gather(tick, reach);
        if (!dpti_proxy_solve_rubbing(tick, wanted))
            return 0;
        const double size = norm_of(tick->solved.y, n);
        if (again || size + bodies_moved <= 0.5 * reach)
            return 1;
        reach = max_of(4.0 * (size + bodies_moved), left);
    }
}

/* Whether the motion leads to the device itself. Then the proxy takes the device's pose, bit for bit. */
static int is_goal(const struct proxy_tick *tick, double share)
{
    return tick->solved.active_count == 0 && share == 1.0 && !(tick->is_before && tick->only_aside);
}

/* In the open, where nothing can be met on any path, the proxy goes to the device at once. */
static int go_to_goal(struct proxy_tick *tick, const struct displacement *left, double allowed)
{
    struct proxy *proxy = tick->proxy;
    const double longest = length(left->shift) + proxy->extent * length(left->turn);
    const double gap = tick->gap - longest;
    if (tick->is_before || !(gap > tick->clearance) || displacement_norm(&proxy->coupling, left) > allowed)
        return 0;
    proxy->lag = 0.0;
    if (!memcmp(&tick->at.pose, &tick->goal.pose, sizeof tick->at.pose))
        return 1;
    tick->at = tick->goal;
    dpti_proxy_find_nearest(tick);
    tick->gap = max_of(tick->gap, gap);
    proxy->last_motion = longest;
    return 1;
}

/* Whether no motion can be swept any more in this tick. */
static int is_spent(const struct proxy_tick *tick)
{
    const struct dpt_world *world = tick->world;
    return work_is_spent(&world->work) || (!tick->is_before && !world->sweep_work_left);
}

/*
 * m: the longest motion to try next. The last one, of length `motion`, was free up to the share `met`, and the share
 * `made` of it was made. One that had only the rest of a budget is tried once more with a whole one.
 */
static double next_trust(const struct proxy_tick *tick, double met, double made, double motion)
{
    const double min_trust = tick->clearance;
    if (is_spent(tick) && !(made > 0.0))
        return max_of(min_trust, tick->is_moved ? motion : 0.25 * motion);
    if (is_spent(tick) || met < 0.25)
        return max_of(min_trust, 2.0 * max_of(met, 0.1) * motion);
    return 4.0 * max_of(tick->proxy->trust, motion);
}

enum { FOLLOW_DONE, FOLLOW_MOVED, FOLLOW_STUCK };

/* A motion that is to be tried: where it leads, and its length, m. */
struct proxy_motion {
    struct proxy_pose to;
    double size;
};

/* Choose the next motion. FOLLOW_MOVED: there is one. FOLLOW_DONE: none is left. FOLLOW_STUCK: none is allowed. */
static int choose_motion(struct proxy_tick *tick, const struct displacement *displacement, double allowed,
                         struct proxy_motion *motion)
{
    struct proxy *proxy = tick->proxy;
    const uint32_t n = proxy_unknowns(proxy);
    double wanted[HALF_SPACE_DIMENSIONS] = { 0.0 }, straight[HALF_SPACE_DIMENSIONS], share;
    dpti_proxy_turn_axes(proxy, &tick->at, tick->axes);
    const double left = dpti_solved_wanted(tick, displacement, wanted);
    proxy->lag = left;
    if (left == 0.0 && !tick->is_before)
        return FOLLOW_DONE;
    if (tick->is_before && tick->only_aside)
        memset(wanted, 0, sizeof wanted);
    if (!gather_and_solve(tick, wanted, left)) {
        proxy->flags |= DPT_FORCE_FLAG_SQUEEZED;
        return FOLLOW_STUCK;
    }
    const double size = norm_of(tick->solved.y, n);
    proxy->lag = size;
    dpti_proxy_remember_active(tick);
    if (!tick->is_before && proxy_has_arrived(tick, size, left))
        return FOLLOW_DONE;
    /* While a body pushes, the proxy does not wait for trust to grow. */
    const double longest = tick->is_before ? allowed : min_of(proxy->trust, allowed);
    if (size > longest) {
        for (uint32_t k = 0; k < n; k++)
            wanted[k] *= longest / size;
        if (!dpti_proxy_solve_rubbing(tick, wanted))
            return FOLLOW_STUCK;
    }
    memcpy(straight, tick->solved.y, sizeof straight);
    motion->to = dpti_solved_correct(tick, wanted, straight, tick->is_before ? HUGE_VAL : longest, &share);
    if (size <= longest && is_goal(tick, share)) {
        motion->to = tick->goal;
    } else if (!tick->is_before && share > 0.0) {
        share = dpti_solved_best_share(tick, &motion->to, displacement, wanted, straight, left, share);
        motion->to = dpti_solved_pose(tick, straight, share);
    }
    dpti_proxy_remember_active(tick);
    motion->size = norm_of(tick->solved.y, n) * share;
    return FOLLOW_MOVED;
}

/*
 * In a step together with tissue (src/tissue) the surface has gone to where the tool ended: there it is free. Surfaces that
 * pass it by on the way may dent its skin, and no more.
 */
static int choose_end(struct proxy_tick *tick, double allowed, struct proxy_motion *motion)
{
    if (!tick->is_before || !tick->has_end)
        return 0;
    tick->has_end = 0;
    motion->to = dpti_proxy_pose_of(tick->proxy, &tick->end);
    const struct displacement way = dpti_proxy_displacement(tick->proxy, &tick->at, &motion->to);
    motion->size = displacement_norm(&tick->proxy->coupling, &way);
    return motion->size <= allowed;
}

/* The share of its radius by which a tool may be dented on its next motion. One that is dented already may stay so. */
static double dent_allowed(const struct proxy_tick *tick, int goes_to_end)
{
    if (tick->proxy->gap < 0.0)
        return DENTED_MOST;
    return goes_to_end ? DENTED : 0.0;
}

/* m: of the thinnest part of the tool. */
static double least_radius(const struct proxy_tick *tick)
{
    double least = HUGE_VAL;
    for (uint32_t i = 0; i < tool_part_count(tick->tool); i++)
        least = min_of(least, part_radius(tool_part(tick->world, tick->tool, i)));
    return least;
}

/*
 * Tissue that leaves no room, as a sheet that is wrapped round the tool, dents it: the proxy goes where the step with the
 * tissue ended, on the side of all surfaces on which it was. Returns 0 if it cannot.
 */
static int give_way(struct proxy_tick *tick)
{
    double met;
    if (!tick->has_ended)
        return 0;
    tick->dented = DENTED_MOST;
    tick->spare = DENTED_MOST * least_radius(tick);
    if (tick->is_before) {
        const struct proxy_pose end = dpti_proxy_pose_of(tick->proxy, &tick->end);
        tick->is_before = !(dpti_proxy_move(tick, &end, &met) == 1.0);
    }
    const int has_given = !tick->is_before && tick->gap > -tick->spare;
    tick->spare = 0.0;
    return has_given;
}

/* One motion. *allowed is how far the proxy may still move in this tick. */
static int follow_once(struct proxy_tick *tick, double *allowed)
{
    struct proxy *proxy = tick->proxy;
    const struct proxy_pose from = tick->at;
    struct proxy_motion motion;
    double met;
    const struct displacement left = dpti_proxy_displacement(proxy, &from, &tick->goal);
    if (go_to_goal(tick, &left, *allowed))
        return FOLLOW_DONE;
    const int goes_to_end = choose_end(tick, *allowed, &motion);
    const int choice = goes_to_end ? FOLLOW_MOVED : choose_motion(tick, &left, *allowed, &motion);
    tick->dented = dent_allowed(tick, goes_to_end);
    if (choice != FOLLOW_MOVED)
        return choice;
    const double made = dpti_proxy_move(tick, &motion.to, &met);
    if (tick->is_before && made < 1.0)
        tick->lift = max_of(2.0 * tick->lift, LIFT_SHARE * motion.size + tick->clearance);
    if (!tick->is_before)
        proxy->trust = next_trust(tick, met, made, motion.size);
    if (!(made > 0.0))
        return tick->is_before ? FOLLOW_MOVED : FOLLOW_STUCK;
    tick->made = made;
    tick->is_moved = 1;
    const struct displacement moved = dpti_proxy_displacement(proxy, &from, &tick->at);
    dpti_proxy_note_slip(tick, moved.shift, proxy_whole_turn(&moved, &from));
    tick->is_before = tick->is_before && made < 1.0;
    proxy->last_motion = displacement_norm(&proxy->coupling, &moved);
    *allowed = max_of(0.0, *allowed - proxy->last_motion);
    return FOLLOW_MOVED;
}

/* Whether the motion of bodies before this tick may have brought one near. */
static int bodies_came_near(const struct proxy_tick *tick)
{
    const struct dpt_world *world = tick->world;
    return world->bodies_moved_tick == world->ticks && tick->gap <= world->body_motion_max + 2.0 * tick->clearance;
}

/*
 * The nearest pairs where the proxy was left. What was proven of its gap holds; before its first motion, less what bodies
 * moved.
 */
static void find_again(struct proxy_tick *tick)
{
    const double proven = tick->gap - (tick->is_moved ? 0.0 : world_body_motion(tick->world));
    dpti_proxy_find_nearest(tick);
    tick->gap = max_of(tick->gap, proven);
}

/* From now on, motions lead out of the way of bodies alone: they are shorter, and seldom meet anything. */
static void step_aside(struct proxy_tick *tick)
{
    tick->only_aside = 1;
    tick->lift = tick->clearance;
}

/* Make motions until `most`, work or `*allowed` end: how far the proxy may still move. 0: there may be more to make. */
static int follow_some(struct proxy_tick *tick, int most, double *allowed)
{
    const struct work *work = &tick->world->work;
    tick->proxy->owed = 0.0;
    tick->is_waiting = 0;
    for (int i = 0; i < most; i++) {
        int result = follow_once(tick, allowed);
        if (tick->is_before && (i + 1 >= PUSHES_MAX || work_is_spent(work)) && dpti_proxy_carry(tick))
            result = FOLLOW_MOVED;
        if (tick->is_before && i + 1 == PUSHES_MAX)
            step_aside(tick);
        if (result == FOLLOW_DONE) {
            tick->is_settled = 1;
            return 1;
        }
        if (is_spent(tick)) {
            tick->is_waiting = 1;
            tick->proxy->owed = *allowed;
            return 1;
        }
        if (!tick->is_before && *allowed <= PROXY_MOTION_SMALL * tick->clearance)
            return 1;
    }
    return 0;
}

/*
 * Follow the device: within patches where that is possible. A tool that was left where it stayed, and is taken along,
 * goes on with them after one motion.
 */
static void follow_all(struct proxy_tick *tick, double *allowed)
{
    if (dpti_patch_follow(tick, allowed))
        return;
    if (!tick->is_before)
        find_again(tick);
    if (tick->is_left && !tick->is_before) {
        if (follow_some(tick, 1, allowed) || dpti_patch_follow(tick, allowed))
            return;
        find_again(tick);
    }
    follow_some(tick, ITERATIONS_MAX, allowed);
}

/* m: how far a proxy may move, so that what is felt changes by no more than proxy->pace. */
static double motion_allowed(const struct proxy_tick *tick, double device_moved, double dt)
{
    const struct displacement left = dpti_proxy_displacement(tick->proxy, &tick->at, &tick->device);
    const double bent = 1.0 + BENT * min_of(1.0, dot(left.turn, left.turn));
    return (3.0 * device_moved + PROXY_FOLD_SPEED * dt) / bent - device_moved;
}

static void follow(struct proxy_tick *tick, double device_moved, double dt)
{
    struct proxy *proxy = tick->proxy;
    const struct proxy_pose from = tick->at;
    const double others_moved = world_body_motion(tick->world) + proxy->tip_motion;
    const int is_alone = tick->world->body_count == tick->world->unfelt_body_count;
    const int is_released = proxy->is_released || is_alone;
    const double owed = proxy->owed;
    double allowed = is_released ? HUGE_VAL : motion_allowed(tick, device_moved, dt) + others_moved + owed;
    const double cap = allowed;
    tick->is_fast = device_moved > 0.5 * PROXY_FOLD_SPEED * dt;
    proxy->pace = is_released ? HUGE_VAL : 3.0 * device_moved + PROXY_FOLD_SPEED * dt + others_moved;
    if (is_released)
        proxy->trust = HUGE_VAL;
    proxy->is_released = 0;
    tick->is_before = !is_alone && bodies_came_near(tick);
    if (tool_is_inserted(tick->world, tick->tool)) {
        dpti_proxy_follow_channel(tick, allowed, dt);
        return;
    }
    follow_all(tick, &allowed);
    if (tick->is_before || tick->gap < 0.0) {
        proxy->flags |= DPT_FORCE_FLAG_SQUEEZED;
        if (!give_way(tick)) {
            dpti_proxy_put_again(tick);
            return;
        }
    }
    if (tick->world->channels && dpti_proxy_enter_channel(tick, allowed, dt))
        return;
    const struct displacement moved = dpti_proxy_displacement(proxy, &from, &tick->at);
    const struct displacement left = dpti_proxy_displacement(proxy, &tick->at, &tick->device);
    const double motion = displacement_norm(&proxy->coupling, &moved);
    const double far = displacement_norm(&proxy->coupling, &left);
    proxy->owed = min_of(proxy->owed, 2.0 * far);
    /* The next tick's first motion will be about as long as all of this one's. */
    proxy->last_motion = max_of(proxy->last_motion, 1.5 * motion);
    const int is_capped = cap > 0.0 && allowed <= PROXY_MOTION_SMALL * tick->clearance;
    const double expected = 2.0 * (device_moved + others_moved) + owed;
    if (!is_released && (is_capped || motion > expected + 0.1 * far)) {
        proxy->flags |= DPT_FORCE_FLAG_FOLD;
        proxy->folds++;
    }
    if (length(left.turn) > PROXY_TURN_MAX && !dpti_proxy_is_near_free_turn(tick)) {
        proxy->flags |= DPT_FORCE_FLAG_REPLACED;
        dpti_proxy_put_again(tick);
    }
}

/*
 * What the proxy follows. Where friction held the tool in its last step with tissue, that is where it was then, and as far
 * again as it went: it will not be far from there.
 */
static void find_goal(struct proxy_tick *tick)
{
    struct proxy *proxy = tick->proxy;
    tick->device = tick->goal = dpti_proxy_pose_of(proxy, &tick->tool->pose);
    tick->is_led = proxy->is_ended && proxy->is_led;
    tick->has_end = tick->has_ended = proxy->is_ended != 0;
    tick->end = proxy->end;
    if (tick->is_led) {
        const struct proxy_pose end = dpti_proxy_pose_of(proxy, &proxy->end);
        tick->goal = dpti_proxy_moved(proxy, &end, &proxy->end_motion);
    }
    if (!proxy->is_ended && !proxy->has_home) {
        proxy->end = proxy->pose;
        memset(&proxy->end_motion, 0, sizeof proxy->end_motion);
        proxy->is_sliding = 0;
    }
    proxy->is_ended = proxy->is_led = 0;
}

/* Whether a tick left a proxy as it was. */
static int stood_still(const struct proxy *before, const struct proxy *now)
{
    return !memcmp(before, now, offsetof(struct proxy, last_felt));
}

/* What is felt of a proxy in the open, and what bodies do to it. */
static void feel_contacts(struct proxy_tick *tick)
{
    dpti_proxy_yield(tick);
    if (tick->is_waiting)
        dpti_proxy_wait(tick);
    tick->proxy->body_work = dpti_proxy_body_work(tick);
    dpti_loads_note_proxy(tick);
}

void dpti_proxy_step(struct dpt_world *world, struct tool *tool, double dt)
{
    struct proxy *proxy = proxy_of(world, tool);
    const int is_unchanged = !tool_has_changed(world, tool);
    struct proxy before;
    if (is_unchanged)
        before = *proxy;
    struct proxy_tick tick;
    memset(&tick, 0, offsetof(struct proxy_tick, triangles));
    tick.world = world;
    tick.tool = tool;
    tick.proxy = proxy;
    const uint32_t work_before = world->work.done;
    dpti_proxy_doubt_unseen_motion(world, proxy);
    if (tool->is_free)
        dpti_proxy_follow_size(world, tool, proxy);
    const int was_spin_felt = proxy->coupling.spin_rho > 0.0;
    dpti_proxy_measure(world, tool, proxy);
    tick.clearance = dpti_proxy_clearance(world);
    tick.min_gap = GAP_SHARE * tick.clearance;
    tick.edge = tool->tip_count ? HUGE_VAL : least_radius(&tick) + tick.clearance;
    proxy->flags = 0;
    proxy->last_felt = proxy->felt;
    proxy->last_pushed = proxy->is_ended ? proxy->pushed : proxy->felt;
    proxy->last_stored = proxy->is_ended ? proxy->stored : proxy->yielded_energy;
    proxy->last_device_pose = proxy->device_pose;
    find_goal(&tick);
    if (proxy->state < PROXY_DOUBTED) {
        proxy->pace = PROXY_FOLD_SPEED * dt;
        dpti_tips_put_all(world, tool);
        dpti_proxy_put(&tick);
    } else {
        const struct proxy_pose device = dpti_proxy_pose_of(proxy, &proxy->device_pose);
        const struct displacement moved = dpti_proxy_displacement(proxy, &device, &tick.device);
        const int is_spin_felt = proxy->coupling.spin_rho > 0.0;
        tick.at = dpti_proxy_pose_of(proxy, &proxy->pose);
        if (is_spin_felt && !was_spin_felt)
            tick.at = dpti_proxy_spun_as(proxy, &tick.at, &device, 0.0);
        if (is_spin_felt)
            tick.at = dpti_proxy_spun_as(proxy, &tick.at, &tick.device, SPIN_MAX);
        tick.gap = proxy->gap;
        follow(&tick, displacement_norm(&proxy->coupling, &moved), dt);
        if (is_spin_felt)
            tick.at = dpti_proxy_spun_as(proxy, &tick.at, &tick.device, SPIN_ROLLED_MAX);
    }
    dpti_proxy_keep_contacts(&tick);
    if (tool_is_inserted(world, tool))
        dpti_proxy_feel_channel(&tick);
    else
        feel_contacts(&tick);
    if (world->channels)
        dpti_proxy_pierce(&tick);
    const int is_done = dpti_tips_follow(&tick);
    proxy->pose = tick.at.pose;
    proxy->device_pose = tool->pose;
    proxy->tick = world->ticks;
    proxy->body_path = world_body_path(world);
    proxy->gap = tick.gap;
    proxy->min_gap = tick.min_gap;
    /* All work counts for the tool's first segment. */
    for (uint32_t i = 0; i < tool->segment_count; i++)
        world->segments[tool->first_segment + i].result.work = 0;
    world->segments[tool->first_segment].result.work = world->work.done - work_before;
    const struct displacement away = dpti_proxy_displacement(proxy, &tick.device, &tick.at);
    proxy->is_held = displacement_norm(&proxy->coupling, &away) > HELD * tick.min_gap;
    if (!proxy->is_held)
        dpti_proxy_note_free_turn(proxy, &tool->pose);
    proxy->is_still =
        is_unchanged && is_done && !proxy->is_behind && proxy->tip_motion == 0.0 && stood_still(&before, proxy);
}
