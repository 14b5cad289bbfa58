/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What holds the tool is solved for; each other triangle within reach must lie behind a plane that the straight motion
 * stays in front of. One that does not joins the problem. So the motion is proven without a sweep, and its end needs no
 * search: the next motion looks at the same triangles.
 */
#include "proxy/patch_motion.h"

#include "proxy/patch_constraints.h"
#include "proxy/proxy_constraints.h"
#include "proxy/proxy_friction.h"
#include "proxy/proxy_motion.h"
#include "proxy/solved_motion.h"

enum { MOTIONS_MAX = 10, SOLVES_MAX = 12, SHORTER_MAX = 3, AGAIN_MAX = 2 };

/*
 * A tick's first look reaches so many times as far as is expected of its motions together. That of a line is less
 * cheap, and shall serve all of them.
 */
#define LOOK_AHEAD      1.0
#define LOOK_AHEAD_LINE 1.5

/* As a share of a motion: where the patch has less than that of it, it is left to a sweep. */
#define LONG_WAY 0.02

/*
 * A motion of a fast tick is at most so many times as long as the last one, or as long as the longest one, or, as a
 * multiple of the clearance, that long: what is solved for holds for short ways, and the proof of a way that ends early
 * is in vain.
 */
#define TRUST       2.0
#define TRUST_LEAST 1000.0

/* As a share of a motion that could not be proven: so long is the next one. What is too short for that, in clearances. */
#define AGAIN       0.2
#define AGAIN_LEAST 10.0

/*
 * Units of work after which a fast tick makes no more motions, and as a share of the way that was left: where the proxy
 * is that near to where it is held, it goes on.
 */
#define WORK_LONG 600
#define ARRIVING  0.02

/* As a multiple of the clearance: a motion is so much shorter than the view reaches. */
#define SHORTER 2.0

/* As a share of a motion: it ends so much before what it meets. */
#define SHORTER_THAN_MET 0.9

/* As a share of the clearance: gaps that differ by less are the same. */
#define AS_NEAR 0.01

enum { MOTION_DONE, MOTION_MADE, MOTION_AGAIN, MOTION_NONE };

/* m: no point of the axis goes farther by the motion that was solved for. */
static double farthest(const struct proxy_tick *tick)
{
    const struct displacement motion = dpti_proxy_of_unknowns(tick->proxy, tick->axes, tick->solved.y);
    return length(motion.shift) + tick->proxy->extent * length(motion.turn);
}

/*
 * Hold what a line begins with at a side: those near that the proxy remembers, and the nearest where it is nearer than
 * these. A line that lies on a surface is held by its ends; what touches it between these would hold it as well, but at
 * one place.
 */
static int hold_along(struct proxy_tick *tick, struct patch_view *view, uint32_t number, double reach, vec3 hint)
{
    const struct patch_side *side = &view->sides[number];
    double least = HUGE_VAL;
    for (uint32_t i = 0; i < view->count; i++) {
        const struct patch_triangle *triangle = &view->list[i];
        if (triangle->side != number || !triangle->is_found || triangle->gap > view->near ||
            !patch_is_remembered(tick->proxy, side, triangle->triangle))
            continue;
        if (!dpti_patch_hold(tick, view, i, reach, hint))
            return 0;
        least = min_of(least, triangle->gap);
    }
    return view->list[side->nearest].gap > least - AS_NEAR * tick->clearance ||
           dpti_patch_hold(tick, view, side->nearest, reach, hint);
}

/* Look around, and begin with what is nearest: others join where those that hold the tool do not hold it off them. */
static int look(struct proxy_tick *tick, struct patch_view *view, double reach, vec3 hint)
{
    tick->space_count = tick->triangle_count = 0;
    tick->is_begun = 0;
    if (!dpti_patch_look(tick, view, reach))
        return 0;
    for (uint32_t i = 0; i < view->side_count; i++) {
        const uint32_t nearest = view->sides[i].nearest;
        if (nearest != PATCH_TRIANGLES_MAX && !(view->is_ball ? dpti_patch_hold(tick, view, nearest, reach, hint)
                                                              : hold_along(tick, view, i, reach, hint)))
            return 0;
    }
    return 1;
}

/*
 * The nearest pairs at tick->at, as searches leave them: what the view tells; where nothing is near, a search does. One
 * that a budget ends knows less of the gap than the view.
 */
static void settle(struct proxy_tick *tick, const struct patch_view *view, int is_known)
{
    const double proven = min_of(tick->gap, view->covered);
    if (is_known && tick->world->body_slot_end <= UNLISTED_BODIES_MAX && dpti_patch_answer(tick, view))
        return;
    dpti_proxy_find_nearest(tick);
    tick->gap = max_of(tick->gap, proven);
}

/* A motion was made, so far as that share. */
static void note_motion(struct proxy_tick *tick, const struct proxy_pose *from, double share, double *allowed)
{
    struct proxy *proxy = tick->proxy;
    const struct displacement moved = dpti_proxy_displacement(proxy, from, &tick->at);
    tick->made = share;
    tick->is_moved = 1;
    dpti_proxy_note_slip(tick, moved.shift, proxy_whole_turn(&moved, from));
    proxy->last_motion = displacement_norm(&proxy->coupling, &moved);
    *allowed = max_of(0.0, *allowed - proxy->last_motion);
}

/* A motion that is to be tried. */
struct patch_motion {
    double straight[HALF_SPACE_DIMENSIONS]; /* what was solved for before corrections */
    struct proxy_pose to;
    double share; /* of it */
    int is_to_goal;
};

/* Whether nothing holds the tool. Friction that did not settle may leave a solution that nothing holds, but short. */
static int is_free(const struct proxy_tick *tick, const double *wanted)
{
    for (uint32_t k = 0; k < proxy_unknowns(tick->proxy); k++)
        if (tick->solved.y[k] != wanted[k])
            return 0;
    return tick->solved.active_count == 0;
}

/* The pose to which the solution leads, by motions not longer than `longest`, m. aims_at_goal: it is of the whole way. */
static void choose(struct proxy_tick *tick, const struct patch_view *view, const double *wanted, double longest,
                   int aims_at_goal, struct patch_motion *motion)
{
    memcpy(motion->straight, tick->solved.y, sizeof motion->straight);
    if (view->is_ball) {
        const double size = norm_of(motion->straight, proxy_unknowns(tick->proxy));
        motion->share = size > longest ? longest / size : 1.0;
        motion->to = dpti_solved_pose(tick, motion->straight, motion->share);
    } else {
        motion->to = dpti_solved_correct(tick, wanted, motion->straight, longest, &motion->share);
    }
    motion->is_to_goal = aims_at_goal && motion->share == 1.0 && is_free(tick, wanted);
    if (motion->is_to_goal)
        motion->to = tick->goal;
}

static void shorten(const struct proxy_tick *tick, double share, struct patch_motion *motion)
{
    motion->share = share;
    motion->to = dpti_solved_pose(tick, motion->straight, share);
}

/*
 * Prove a motion. That of a line is shortened if it comes nearer to the goal then, but not before all that is in its
 * way is known. Where a triangle that holds the line is met on the way, as a turn bends it towards one: a shorter one
 * that ends before that; where that does not help either, the motion is as it was.
 */
static enum patch_proof prove(struct proxy_tick *tick, struct patch_view *view, const struct displacement *way,
                              const double *wanted, double left, double reach, struct patch_motion *motion)
{
    double met;
    enum patch_proof proof = dpti_patch_prove(tick, view, &motion->to, reach, &met);
    if (view->is_ball || proof == PATCH_ADDED || proof == PATCH_CROWDED)
        return proof;
    const double best = motion->is_to_goal ? motion->share
                                           : dpti_solved_best_share(tick, &motion->to, way, wanted, motion->straight,
                                                                    left, motion->share);
    if (best < motion->share) {
        shorten(tick, best, motion);
        proof = dpti_patch_prove(tick, view, &motion->to, reach, &met);
    }
    struct patch_motion shorter = *motion;
    for (int k = 0; k < SHORTER_MAX && proof == PATCH_UNPROVEN && met > 0.0; k++) {
        shorten(tick, SHORTER_THAN_MET * met * shorter.share, &shorter);
        proof = dpti_patch_prove(tick, view, &shorter.to, reach, &met);
        if (proof == PATCH_FREE)
            *motion = shorter;
    }
    return proof;
}

/* Make a motion. is_proven 0: as far as a sweep proves it free. Returns 0 if that is nowhere. */
static int make(struct proxy_tick *tick, const struct patch_view *view, struct patch_motion *motion, int is_proven,
                double *allowed)
{
    const struct proxy_pose from = tick->at;
    double met;
    dpti_proxy_remember_active(tick);
    if (is_proven) {
        tick->at = motion->to;
        tick->proxy->trust = HUGE_VAL;
        /* Until the next look: so much is kept, and the pairs are those of where it began. */
        tick->gap = min_of(tick->gap, tick->min_gap);
        tick->is_lost = 1;
    } else {
        settle(tick, view, 1);
        motion->share *= dpti_proxy_move(tick, &motion->to, &met);
    }
    if (!(motion->share > 0.0))
        return 0;
    note_motion(tick, &from, motion->share, allowed);
    return 1;
}

/* A motion was not proven: a shorter one may be. */
static int try_shorter(const struct proxy_tick *tick, struct patch_view *view, const struct patch_motion *motion)
{
    if (view->is_listed || view->again_count == AGAIN_MAX)
        return MOTION_NONE;
    const double size = motion->share * norm_of(motion->straight, proxy_unknowns(tick->proxy));
    if (!(size > AGAIN_LEAST * tick->clearance))
        return MOTION_NONE;
    view->again_count++;
    view->trust = AGAIN * size;
    return MOTION_AGAIN;
}

/* What a motion is solved for. */
struct patch_aim {
    double wanted[HALF_SPACE_DIMENSIONS];
    double share;   /* of the way to the goal */
    double longest; /* m: the motion may be so long */
    double reach;   /* m: what joins is held as far as that */
    int has_widened;
};

static void bring_nearer(struct patch_aim *aim, double share)
{
    aim->share *= share;
    for (int k = 0; k < HALF_SPACE_DIMENSIONS; k++)
        aim->wanted[k] *= share;
}

enum { AIM_HOLDS, AIM_CHANGED, AIM_TOO_FAR };

/*
 * How long the motion that was solved for may be. Where it is longer than what was looked at, look once farther; where it
 * may not be so long, bring the goal nearer: what holds a tool that goes far tells little of where it begins to go.
 */
static int limit_aim(struct proxy_tick *tick, struct patch_view *view, double allowed, double *reach, vec3 hint,
                     struct patch_aim *aim)
{
    const double size = norm_of(tick->solved.y, proxy_unknowns(tick->proxy));
    const double trusted = min_of(allowed, view->trust);
    const double far = min_of(1.0, trusted / size) * farthest(tick);
    const double farthest_allowed = view->covered - SHORTER * tick->clearance;
    const double gathered = max_of(*reach, view->reach - SHORTER * tick->clearance);
    if (far > min_of(gathered, farthest_allowed) && !aim->has_widened) {
        *reach = 1.5 * far + view->near;
        aim->has_widened = 1;
        if (!look(tick, view, *reach, hint))
            return AIM_TOO_FAR;
        if (size > trusted)
            bring_nearer(aim, trusted / size);
        return AIM_CHANGED;
    }
    /* The tree is made for ways as long as this. */
    if (farthest_allowed < LONG_WAY * far)
        return AIM_TOO_FAR;
    aim->longest = min_of(1.0, farthest_allowed / far) * min_of(size, trusted);
    if (aim->share == 1.0 && size > aim->longest) {
        bring_nearer(aim, aim->longest / size);
        return AIM_CHANGED;
    }
    /* The motion may be longer than the reach was guessed. */
    aim->reach = max_of(*reach, far + view->near);
    return AIM_HOLDS;
}

static int follow_once(struct proxy_tick *tick, double *allowed, double *reach, struct patch_view *view)
{
    struct proxy *proxy = tick->proxy;
    const struct displacement way = dpti_proxy_displacement(proxy, &tick->at, &tick->goal);
    struct patch_aim aim = { .share = 1.0 };
    struct patch_motion motion = { .share = 0.0 };
    enum patch_proof proof = PATCH_ADDED;
    dpti_proxy_turn_axes(proxy, &tick->at, tick->axes);
    const double left = dpti_solved_wanted(tick, &way, aim.wanted);
    const vec3 hint = scaled(way.shift, left > 0.0 ? min_of(1.0, *reach / left) : 0.0);
    if (!look(tick, view, *reach, hint))
        return MOTION_NONE;
    for (int solves = 0; proof == PATCH_ADDED; solves++) {
        if (solves == SOLVES_MAX) {
            proof = PATCH_CROWDED;
            break;
        }
        if (work_left(&tick->world->work) < PATCH_WORK || !dpti_proxy_solve_rubbing(tick, aim.wanted))
            return MOTION_NONE;
        work_spend(&tick->world->work, 1 + tick->triangle_count / 2);
        const double size = norm_of(tick->solved.y, proxy_unknowns(proxy));
        proxy->lag = min_of(left, size / aim.share);
        if (left == 0.0 || proxy_has_arrived(tick, size, aim.share * left)) {
            if (left > 0.0 && dpti_patch_prefer_pairs(tick, view))
                continue;
            dpti_proxy_remember_active(tick);
            return MOTION_DONE;
        }
        const int limited = limit_aim(tick, view, *allowed, reach, hint, &aim);
        if (limited == AIM_TOO_FAR)
            return MOTION_NONE;
        if (limited == AIM_CHANGED)
            continue;
        choose(tick, view, aim.wanted, aim.longest, aim.share == 1.0, &motion);
        proof = prove(tick, view, &way, aim.wanted, left, aim.reach, &motion);
    }
    *reach = view->near;
    if (proof != PATCH_FREE && try_shorter(tick, view, &motion) == MOTION_AGAIN)
        return MOTION_AGAIN;
    if (proof == PATCH_CROWDED || !make(tick, view, &motion, proof == PATCH_FREE, allowed))
        return MOTION_NONE;
    view->longest = max_of(view->longest, proxy->last_motion);
    view->trust = tick->is_fast
                      ? max_of(max_of(TRUST_LEAST * tick->clearance, view->longest), TRUST * proxy->last_motion)
                      : HUGE_VAL;
    return MOTION_MADE;
}

/* How a tick began, before the tool went with a body. */
struct start {
    struct proxy_pose at;
    double gap, allowed;
    double carried; /* m: so far it went; 0 once a motion was made from there */
    int is_before;
    int is_past; /* other bodies were near */
    struct proxy_contact contacts[PROXY_CONTACTS_MAX];
};

/* m: the length of the way from one pose to another. */
static double way_between(const struct proxy_tick *tick, const struct proxy_pose *from, const struct proxy_pose *to)
{
    const struct displacement way = dpti_proxy_displacement(tick->proxy, from, to);
    return displacement_norm(&tick->proxy->coupling, &way);
}

static void go_back(struct proxy_tick *tick, const struct start *start, double *allowed)
{
    tick->at = start->at;
    tick->gap = start->gap;
    tick->is_before = start->is_before;
    tick->is_lost = 1;
    tick->is_dragged = 0;
    *allowed = start->allowed;
    memcpy(tick->proxy->contacts, start->contacts, sizeof start->contacts);
}

/*
 * Where bodies have moved, the tool goes with the nearest one: in that one's frame it stays where it is, and follows the
 * device from there. Returns 0, and nothing is changed, where another body may be in the way, or no way back is allowed.
 */
static int carry(struct proxy_tick *tick, const struct body *body, double *allowed, struct start *start)
{
    *start = (struct start){ tick->at, tick->gap, *allowed, 0.0, tick->is_before, 0, { { .body_id = 0 } } };
    memcpy(start->contacts, tick->proxy->contacts, sizeof start->contacts);
    if (!tick->is_before)
        return 1;
    if (tick->has_end)
        return 0;
    start->is_past = !dpti_proxy_carry_alone(tick, body);
    if (start->is_past && !dpti_proxy_carry_past(tick, body))
        return 0;
    start->carried = way_between(tick, &start->at, &tick->at);
    *allowed -= start->carried;
    if (start->carried <= *allowed)
        return 1;
    go_back(tick, start, allowed);
    return 0;
}

/* Whether the tick has taken long, and its proxy is far from where it is held: it goes on in the next tick. */
static int is_enough(const struct proxy_tick *tick, uint32_t done)
{
    const struct proxy *proxy = tick->proxy;
    return tick->is_fast && tick->world->work.done - done >= WORK_LONG &&
           proxy->lag - proxy->last_motion > ARRIVING * way_between(tick, &tick->at, &tick->goal);
}

int dpti_patch_follow(struct proxy_tick *tick, double *allowed)
{
    struct proxy *proxy = tick->proxy;
    struct patch_view view;
    struct start start;
    const uint32_t done = tick->world->work.done;
    const struct displacement way = dpti_proxy_displacement(proxy, &tick->at, &tick->goal);
    const double free = tick->gap - length(way.shift) - proxy->extent * length(way.turn);
    if ((!tick->is_before && free > tick->clearance) || !dpti_patch_begin(tick, &view) ||
        !carry(tick, view.body, allowed, &start))
        return 0;
    const double ahead = proxy->shape == PROXY_BALL ? LOOK_AHEAD : LOOK_AHEAD_LINE;
    double reach = ahead * max_of(proxy->last_motion, start.carried) + view.near;
    /* A sweep past other bodies leaves no gap to them. */
    if (start.is_past && !(dpti_patch_look(tick, &view, reach) && tick->gap >= tick->min_gap)) {
        go_back(tick, &start, allowed);
        return 0;
    }
    proxy->owed = 0.0;
    tick->is_waiting = 0;
    for (int i = 0; i < MOTIONS_MAX; i++) {
        const int result = follow_once(tick, allowed, &reach, &view);
        if (result == MOTION_AGAIN)
            continue;
        if (result == MOTION_NONE && start.is_before && !tick->is_moved)
            go_back(tick, &start, allowed);
        if (result == MOTION_NONE)
            return 0;
        /* The first motion that is made may lead back. */
        if (start.carried > 0.0)
            *allowed = max_of(0.0, start.allowed - way_between(tick, &start.at, &tick->at));
        start.carried = 0.0;
        tick->is_settled = result == MOTION_DONE;
        if (tick->is_settled || *allowed <= PROXY_MOTION_SMALL * tick->clearance || is_enough(tick, done))
            break;
    }
    if (!tick->is_moved)
        dpti_patch_leave(&view);
    /* The last constraints are kept. */
    settle(tick, &view, tick->is_settled || dpti_patch_look(tick, &view, view.near));
    return 1;
}
