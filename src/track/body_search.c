/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The search follows the dynamic point on last tick's nearest body first; that distance limits all further searches.
 * Then it searches each body that may be as near, to prove the pair or to correct it. If a budget ends this, the next
 * tick continues here. Lower bounds stay valid, less the motion of the axis (docs/algorithms/budget.md).
 */
#include "track/body_search.h"

/* Shares of dpt_world_bytes. */
enum { BYTES_SUSPENDED_SEARCHES = 1536, BYTES_DISTANCE_BOUND = 64 };
typedef char suspended_searches_fit[2 * sizeof(struct suspended_search) <= BYTES_SUSPENDED_SEARCHES ? 1 : -1];
typedef char distance_bound_fits[sizeof(struct distance_bound) <= BYTES_DISTANCE_BOUND ? 1 : -1];

static uint64_t bounds_bytes(const dpt_world_def *def)
{
    const uint64_t segments = def->max_segments;
    return def->budget ? (BYTES_SUSPENDED_SEARCHES + BYTES_DISTANCE_BOUND * (uint64_t)def->max_bodies) * segments : 0;
}

static char *place_bounds(struct dpt_world *world, char *at)
{
    world->suspended_searches = (void *)at;
    world->distance_bounds = (void *)(at + BYTES_SUSPENDED_SEARCHES * (size_t)world->def.max_segments);
    return at + bounds_bytes(&world->def);
}

/* Forget a segment's bounds and suspended searches, of the body in `slot` or, with DPT_NONE, of all. */
static void forget_bounds(struct dpt_world *world, uint32_t segment_index, uint32_t slot)
{
    if (!world->def.budget)
        return;
    struct distance_bound *bound = world_distance_bound(world, segment_index, slot == DPT_NONE ? 0 : slot);
    memset(bound, 0, (slot == DPT_NONE ? world->def.max_bodies : 1) * sizeof *bound);
    for (int is_resting = 0; is_resting < 2; is_resting++) {
        struct suspended_search *suspended = world_suspended_search(world, segment_index, is_resting);
        if (slot == DPT_NONE || suspended->body_slot == slot)
            suspended->traversal.level = 0;
        if (slot == DPT_NONE)
            suspended->next_slot = DPT_NONE;
    }
}

/* Remove the data of the segments from `first` up to, not including, `end`; that of later segments moves up. */
static void remove_bounds(struct dpt_world *world, uint32_t first, uint32_t end)
{
    if (!world->def.budget)
        return;
    size_t segments_moved = world->segment_count - end;
    memmove(world_suspended_search(world, first, 0), world_suspended_search(world, end, 0),
            segments_moved * 2 * sizeof *world->suspended_searches);
    memmove(world_distance_bound(world, first, 0), world_distance_bound(world, end, 0),
            segments_moved * world->def.max_bodies * sizeof *world->distance_bounds);
}

/* m: motion of the axis' ends in the body's frame since the last update; exactly 0 at rest. */
static double motion_since(const struct distance_bound *bound, const struct axis *axis)
{
    vec3 b = add(axis->local_a, axis->u);
    double motion =
        max_of(length(sub(axis->local_a, bound->a)), length(sub(b, bound->b))) + (double)bound->surface_motion;
    return motion > 0.0 ? motion + axis->error : 0.0;
}

/* m: what a suspended search has proven about the axis at the last update of its body; 0 if none is suspended. */
static double bound_so_far(const struct suspended_search *suspended, const struct surface *surface,
                           const struct distance_bound *bound)
{
    if (!suspended->traversal.level)
        return 0.0;
    return min_of(suspended->lower_bound,
                  dpti_bvh_unvisited_bound(&suspended->traversal, surface, bound->a, sub(bound->b, bound->a)));
}

void dpti_bounds_note_motion(struct dpt_world *world, uint32_t segment_index, uint32_t slot, double moved)
{
    if (!world->def.budget)
        return;
    struct distance_bound *bound = world_distance_bound(world, segment_index, slot);
    bound->surface_motion = (1.0f + 0x1p-22f) * (bound->surface_motion + (float)moved);
}

/* End a suspended search for good. What it has proven goes into the bound of its body. */
static void give_up(struct dpt_world *world, uint32_t segment_index, struct suspended_search *suspended)
{
    struct distance_bound *bound = world_distance_bound(world, segment_index, suspended->body_slot);
    const struct surface *surface = &world->bodies[suspended->body_slot].surface;
    bound->lower_bound = max_of(bound->lower_bound, bound_so_far(suspended, surface, bound));
    suspended->traversal.level = 0;
}

/*
 * Update a segment's bound of the body in `slot` to this tick's axis. Returns how far the axis' ends have moved in
 * the body's frame since the last update, vertices that moved included (m), exactly 0 at rest.
 *
 * A suspended search of a motion stays valid when the axis moves, but can then only give a bound. A suspended search
 * of a rest is given up when the axis moves. During a rest the search of the motion waits: a device that is slower
 * than the loop moves again in the next tick.
 */
static double update_bound(struct dpt_world *world, uint32_t segment_index, uint32_t slot, const struct axis *axis)
{
    struct distance_bound *bound = world_distance_bound(world, segment_index, slot);
    struct suspended_search *moving = world_suspended_search(world, segment_index, 0),
                            *resting = world_suspended_search(world, segment_index, 1);
    double motion = motion_since(bound, axis);
    if (motion > 0.0 && resting->body_slot == slot && resting->traversal.level)
        give_up(world, segment_index, resting);
    if (motion == 0.0)
        bound->rest_tick = world->ticks;
    bound->lower_bound = max_of(0.0, bound->lower_bound - motion);
    bound->surface_motion = 0.0f;
    bound->a = axis->local_a;
    bound->b = add(axis->local_a, axis->u);
    if (motion > 0.0 && moving->body_slot == slot && moving->traversal.level) {
        dpti_bvh_weaken_bounds(&moving->traversal, &world->bodies[slot].surface, motion);
        moving->lower_bound -= motion;
    }
    return motion;
}

/*
 * The largest proven lower bound of the distance (m) between a segment and the body in `slot`, as of its last update.
 */
static double proven_bound(const struct dpt_world *world, uint32_t segment_index, uint32_t slot)
{
    const struct distance_bound *bound = world_distance_bound(world, segment_index, slot);
    double lower_bound = bound->lower_bound;
    for (int is_resting = 0; is_resting < 2; is_resting++) {
        const struct suspended_search *suspended = world_suspended_search(world, segment_index, is_resting);
        if (suspended->body_slot == slot)
            lower_bound = max_of(lower_bound, bound_so_far(suspended, &world->bodies[slot].surface, bound));
    }
    return lower_bound;
}

/*
 * Shares of dpt_world_bytes: last triangles, which the paper's method does not use, and the blocks of the plane cache.
 */
static uint64_t last_triangles_bytes(const dpt_world_def *def)
{
    return def->method == DPT_METHOD_PAPER ? 0 : mesh_aligned(4 * (uint64_t)def->max_segments * def->max_bodies);
}

uint64_t dpti_body_search_bytes(const dpt_world_def *def)
{
    return bounds_bytes(def) + last_triangles_bytes(def) + mesh_aligned(def->certificate_bytes);
}

char *dpti_body_search_place(struct dpt_world *world, char *at)
{
    at = place_bounds(world, at);
    world->last_triangles = (void *)at;
    at += last_triangles_bytes(&world->def);
    world->plane_cache.blocks = (void *)at;
    world->plane_cache.count = (uint32_t)(world->def.certificate_bytes / sizeof(struct plane_block));
    return at + mesh_aligned(world->def.certificate_bytes);
}

void dpti_body_search_forget_planes(struct dpt_world *world, uint32_t first, uint32_t end, uint32_t slot)
{
    const struct plane_cache *cache = &world->plane_cache;
    for (uint32_t i = 0; i < cache->count; i++) {
        uint32_t owner = (uint32_t)(cache->blocks[i].key >> 32);
        if (!owner)
            continue;
        uint32_t segment_index = (owner - 1) / world->def.max_bodies;
        if (segment_index >= first && segment_index < end &&
            (slot == DPT_NONE || (owner - 1) % world->def.max_bodies == slot))
            cache->blocks[i].key = 0;
    }
}

void dpti_body_search_leave_frame(struct dpt_world *world, uint32_t slot)
{
    dpti_body_search_forget_planes(world, 0, world->segment_count, slot);
    for (uint32_t s = 0; world->def.budget && s < world->segment_count; s++)
        for (int is_resting = 0; is_resting < 2; is_resting++) {
            struct suspended_search *suspended = world_suspended_search(world, s, is_resting);
            if (suspended->traversal.level && suspended->body_slot == slot)
                give_up(world, s, suspended);
        }
}

void dpti_body_search_forget(struct dpt_world *world, uint32_t segment_index)
{
    struct segment *segment = &world->segments[segment_index];
    if (world->def.method != DPT_METHOD_PAPER)
        memset(world_last_triangle(world, segment_index, 0), 0xff,
               world->def.max_bodies * sizeof *world->last_triangles);
    segment->last_body_slot = DPT_NONE;
    segment->answer.body = NULL;
    forget_bounds(world, segment_index, DPT_NONE);
}

void dpti_body_search_forget_body(struct dpt_world *world, uint32_t slot)
{
    for (uint32_t s = 0; s < world->segment_count; s++) {
        forget_bounds(world, s, slot);
        if (world->def.method != DPT_METHOD_PAPER)
            *world_last_triangle(world, s, slot) = DPT_NONE;
        if (world->segments[s].last_body_slot == slot)
            world->segments[s].last_body_slot = DPT_NONE;
        /* A proxy begins its tick with last tick's nearest triangle, which another mesh may not have. */
        if (world->segments[s].answer.body == &world->bodies[slot])
            world->segments[s].answer.body = NULL;
    }
    dpti_body_search_forget_planes(world, 0, world->segment_count, slot);
}

void dpti_body_search_remove(struct dpt_world *world, uint32_t first, uint32_t end)
{
    size_t segments_moved = world->segment_count - end;
    dpti_body_search_forget_planes(world, first, world->segment_count, DPT_NONE);
    remove_bounds(world, first, end);
    if (world->def.method != DPT_METHOD_PAPER)
        memmove(world_last_triangle(world, first, 0), world_last_triangle(world, end, 0),
                segments_moved * world->def.max_bodies * sizeof *world->last_triangles);
}

struct body_search {
    struct dpt_world *world;
    uint32_t segment_index;
    const vec3 *a, *b; /* the ends of the axis, in the world */
    struct box axis_box;
    struct body_answer *best;
    double best_distance;   /* m, of `best` */
    double max_gap;         /* m: the largest distance of the axis' box from that of a body that was searched */
    uint32_t followed_slot; /* the body whose dynamic point was followed */
    double axis_motion;     /* m: motion of the axis in that body's frame since its last update */
    uint32_t is_new;        /* no last tick: cached planes belong to another pose and are not used */
    uint32_t is_jump;       /* the axis moved so far that cached planes are neither used nor renewed */
    uint32_t next_slot;     /* the first body that the budget did not reach, or DPT_NONE */
};

static void transform_axis(const struct body_search *search, const struct body *body, struct axis *axis)
{
    axis_of(&body->surface, &body->frame, *search->a, *search->b, axis);
}

/* Make the pair that a body's search found the best one, if it is nearer. */
static void accept_if_nearer(struct body_search *search, const struct body *body, const struct dynamic_point *track)
{
    struct body_answer *best = search->best;
    if (track->nearest.triangle == DPT_NONE)
        return;
    if (track != &best->track && best->body && track->nearest.pair.distance2 >= best->track.nearest.pair.distance2)
        return;
    *world_last_triangle(search->world, search->segment_index, handle_index(body->id)) = track->nearest.triangle;
    if (track != &best->track)
        best->track = *track;
    best->body = body;
    search->best_distance = sqrt(track->nearest.pair.distance2);
}

/* Methods tree and brute: search one body in full. */
static void search_without_history(struct body_search *search, uint32_t slot)
{
    struct dpt_world *world = search->world;
    const struct body *body = &world->bodies[slot];
    struct body_answer *best = search->best;
    double limit2 = best->body ? best->track.nearest.pair.distance2 : HUGE_VAL;
    struct dynamic_point track;
    transform_axis(search, body, &track.axis);
    if (world->def.method == DPT_METHOD_BRUTE) {
        track.nearest = (struct pair_search){ .pair = { .distance2 = limit2 }, .triangle = DPT_NONE };
        dpti_brute_search(&body->surface, track.axis.local_a, track.axis.u, &world->work, &track.nearest);
    } else {
        struct bvh_traversal traversal;
        traversal.level = 0;
        dpti_dynamic_point_begin(&track, &body->surface, *world_last_triangle(world, search->segment_index, slot),
                                 limit2, DESCENT_NONE, &world->work);
        dpti_dynamic_point_prove(&track, &body->surface, &world->kernel, NULL, &traversal, &world->work);
        dpti_dynamic_point_settle(&track);
    }
    best->error_bound = max_of(best->error_bound, track.axis.error);
    accept_if_nearer(search, body, &track);
}

/* Units that the descent of a dynamic point may take: half of what is left. Its proof needs the rest. */
static uint32_t descent_share(const struct dpt_world *world)
{
    return work_left(&world->work) / 2;
}

/* Begin a body's track from its last triangle; pairs at or beyond `limit2` (m^2) need not be found. */
static void begin_track(struct body_search *search, uint32_t slot, double limit2, enum descent_mode mode,
                        struct dynamic_point *track)
{
    struct dpt_world *world = search->world;
    struct work share = work_of(descent_share(world));
    dpti_dynamic_point_begin(track, &world->bodies[slot].surface,
                             *world_last_triangle(world, search->segment_index, slot), limit2, mode, &share);
    work_spend(&world->work, share.done);
}

/*
 * Of a mesh's diagonal: for an axis that has moved farther in a tick the boxes alone are searched. The planes of the
 * last pose would fail, and to renew them costs more than a search does (docs/algorithms/certificate.md).
 */
#define JUMP_SHARE (1.0 / 64.0)

static int has_jumped(const struct body *body, const struct axis *last, const struct axis *now)
{
    const vec3 moved_a = sub(now->local_a, last->local_a);
    const vec3 moved_b = add(moved_a, sub(now->u, last->u));
    const double jump = JUMP_SHARE * body->diagonal;
    return max_of(dot(moved_a, moved_a), dot(moved_b, moved_b)) > jump * jump;
}

/* Follow the dynamic point on the body that was nearest. At rest it stays where it is. */
static void follow_dynamic_point(struct body_search *search, uint32_t slot)
{
    struct dpt_world *world = search->world;
    const struct body *body = &world->bodies[slot];
    struct dynamic_point *track = &search->best->track;
    const struct axis last = track->axis;
    transform_axis(search, body, &track->axis);
    search->is_jump =
        *world_last_triangle(world, search->segment_index, slot) != DPT_NONE && has_jumped(body, &last, &track->axis);
    search->followed_slot = slot;
    search->axis_motion = 1.0;
    if (world->def.budget)
        search->axis_motion = update_bound(world, search->segment_index, slot, &track->axis);
    enum descent_mode mode = DESCENT_NONE;
    if (search->axis_motion > 0.0 && !search->is_jump && descent_share(world))
        mode = track->nearest.pair.distance2 == 0.0 ? DESCENT_CROSSED : DESCENT_NEIGHBOURS;
    begin_track(search, slot, HUGE_VAL, mode, track);
    search->is_new = track->last == DPT_NONE;
    search->best->error_bound = track->axis.error;
    accept_if_nearer(search, body, track);
}

/* Whether a lower bound (m) proves the best pair: no surface is nearer by more than the error bound allows. */
static int proves_best(const struct body_search *search, double lower_bound)
{
    return lower_bound >= search->best_distance - DISTANCE_ERROR_HISTORY * search->best->track.axis.error;
}

/*
 * Search a body, or continue its suspended search, and accept a nearer pair. `is_fresh`: cached planes are not used.
 * `*excluded_bound` gets the distance (m) beyond which the search excluded boxes and triangles. Returns 0 if the
 * budget ended the search, else 1.
 */
static int search_body(struct body_search *search, uint32_t slot, struct dynamic_point *track, int descends,
                       int is_fresh, struct bvh_traversal *traversal, double *excluded_bound)
{
    struct dpt_world *world = search->world;
    const struct body *body = &world->bodies[slot];
    if (track != &search->best->track)
        begin_track(search, slot, search->best->track.nearest.pair.distance2,
                    descends && !search->is_jump ? DESCENT_NEIGHBOURS : DESCENT_NONE, track);
    const struct plane_cache_view cache =
        plane_cache_view_of(&world->plane_cache, world_plane_owner(world, search->segment_index, slot), is_fresh);
    int is_done = dpti_dynamic_point_prove(track, &body->surface, &world->kernel, search->is_jump ? NULL : &cache,
                                           traversal, &world->work);
    *excluded_bound = sqrt(track->nearest.pair.distance2);
    dpti_dynamic_point_settle(track);
    accept_if_nearer(search, body, track);
    return is_done;
}

/*
 * Search a body as far as the budget allows, unless its lower bound is large enough already, and update that bound.
 * `box_gap`: the distance of the boxes of axis and body, in m.
 */
static void search_within_budget(struct body_search *search, uint32_t slot, double box_gap, struct dynamic_point *track)
{
    struct dpt_world *world = search->world;
    struct distance_bound *bound = world_distance_bound(world, search->segment_index, slot);
    double axis_motion = search->axis_motion;
    int is_done = 0;
    if (slot != search->followed_slot)
        axis_motion = update_bound(world, search->segment_index, slot, &track->axis);
    int is_fresh = axis_motion == 0.0 || search->is_new;
    struct suspended_search *suspended = world_suspended_search(world, search->segment_index, is_fresh);
    bound->lower_bound = max_of(bound->lower_bound, box_gap);
    if (!proves_best(search, proven_bound(world, search->segment_index, slot)) &&
        !work_is_spent(&search->world->work)) {
        double excluded_bound;
        if (suspended->body_slot != slot || !suspended->traversal.level) {
            give_up(world, search->segment_index, suspended);
            suspended->body_slot = slot;
            suspended->lower_bound = HUGE_VAL;
        }
        is_done = search_body(search, slot, track, axis_motion > 0.0 && descent_share(world), is_fresh,
                              &suspended->traversal, &excluded_bound);
        suspended->lower_bound = min_of(suspended->lower_bound, excluded_bound);
        if (is_done)
            bound->lower_bound = max_of(bound->lower_bound, suspended->lower_bound);
    }
    double lower_bound = proven_bound(world, search->segment_index, slot);
    if (!is_done && search->next_slot == DPT_NONE && !proves_best(search, lower_bound))
        search->next_slot = slot;
    search->best->lower_bound = min_of(search->best->lower_bound, lower_bound);
}

/* Search a body unless its box is farther than the best pair. */
static void search_if_near(struct body_search *search, uint32_t slot)
{
    struct dpt_world *world = search->world;
    const struct body *body = &world->bodies[slot];
    struct body_answer *best = search->best;
    int is_best = body == best->body;
    struct dynamic_point other, *track = is_best ? &best->track : &other;
    if (!body_is_there(body) || search->best_distance == 0.0)
        return;
    double box_gap = is_best ? 0.0 : box_distance(&search->axis_box, &world->boxes[slot]);
    if (box_gap >= search->best_distance)
        return;
    if (!is_best)
        transform_axis(search, body, &other.axis);
    best->error_bound = max_of(best->error_bound, track->axis.error);
    search->max_gap = max_of(search->max_gap, box_gap);
    if (world->def.budget) {
        search_within_budget(search, slot, box_gap, track);
    } else {
        struct bvh_traversal traversal;
        double excluded_bound;
        traversal.level = 0;
        search_body(search, slot, track, 1, (int)search->is_new, &traversal, &excluded_bound);
    }
}

/* How many bodies may be near: all of a few, else those on the segment's list. */
static uint32_t candidate_count(const struct body_search *search)
{
    const struct dpt_world *world = search->world;
    return world->body_slot_end <= UNLISTED_BODIES_MAX
               ? world->body_slot_end
               : world->segments[search->segment_index].broad_phase.current.count;
}

/* The slot of one of these, counted from 0. */
static uint32_t candidate_slot(const struct body_search *search, uint32_t candidate)
{
    const struct dpt_world *world = search->world;
    uint32_t list = world->segments[search->segment_index].broad_phase.current.list;
    return world->body_slot_end <= UNLISTED_BODIES_MAX ? candidate
                                                       : world_near_list(world, search->segment_index, list)[candidate];
}

/* The candidate whose box is nearest: where nothing is known, the best one to begin with. */
static uint32_t slot_of_nearest_box(const struct body_search *search)
{
    uint32_t best = DPT_NONE;
    double min_gap = HUGE_VAL;
    for (uint32_t i = 0; i < candidate_count(search); i++) {
        uint32_t slot = candidate_slot(search, i);
        double box_gap = box_distance(&search->axis_box, &search->world->boxes[slot]);
        if (body_is_there(&search->world->bodies[slot]) && box_gap < min_gap) {
            min_gap = box_gap;
            best = slot;
        }
    }
    return best;
}

/* Search each candidate once, from the one in `first_slot` on, and round to the one before it. */
static void search_candidates(struct body_search *search, uint32_t first_slot)
{
    uint32_t count = candidate_count(search), first_candidate = 0;
    while (first_candidate < count && candidate_slot(search, first_candidate) != first_slot)
        first_candidate++;
    for (uint32_t i = 0; i < count; i++)
        search_if_near(search, candidate_slot(search, first_candidate + i < count ? first_candidate + i
                                                                                  : first_candidate + i - count));
}

/* Bodies whose boxes are beyond the pair do not count. Which of them were searched depends on where the search began. */
static void leave_out_far_errors(struct body_search *search)
{
    struct body_answer *best = search->best;
    const int has_changed_body = best->body && handle_index(best->body->id) != search->followed_slot;
    if (!has_changed_body && !(search->max_gap > 0.0 && search->max_gap >= search->best_distance))
        return;
    best->error_bound = best->track.axis.error;
    for (uint32_t i = 0; i < candidate_count(search); i++) {
        const uint32_t slot = candidate_slot(search, i);
        const struct body *body = &search->world->bodies[slot];
        struct axis axis;
        if (!body_is_there(body) ||
            box_distance(&search->axis_box, &search->world->boxes[slot]) >= search->best_distance)
            continue;
        transform_axis(search, body, &axis);
        best->error_bound = max_of(best->error_bound, axis.error);
    }
}

static void find_exact(struct body_search *search)
{
    struct dpt_world *world = search->world;
    struct segment *segment = &world->segments[search->segment_index];
    uint32_t last_slot = segment->last_body_slot;
    for (uint32_t i = 0; last_slot == DPT_NONE && i < world->body_slot_end; i++)
        if (body_is_there(&world->bodies[i]))
            last_slot = i;
    if (last_slot == DPT_NONE)
        return;
    int has_lists = world->body_slot_end > UNLISTED_BODIES_MAX;
    if (has_lists)
        dpti_broad_phase_move(&segment->broad_phase, *search->a, *search->b);
    follow_dynamic_point(search, last_slot);
    if (search->best_distance == 0.0)
        return; /* nothing can be nearer */
    search->axis_box = box_of_axis(*search->a, *search->b);
    if (has_lists) {
        double reach = dpti_broad_phase_update(world, search->segment_index, search->best_distance);
        if (reach < search->best_distance)
            search->best->lower_bound = reach;
    }
    /* In motion the bodies take turns. A first search, and one at rest, begins where it costs least. */
    uint32_t first_slot = search->is_new ? slot_of_nearest_box(search) : last_slot;
    if (world->def.budget) {
        uint32_t *next = &world_suspended_search(world, search->segment_index, 0)->next_slot;
        int continues =
            search->axis_motion > 0.0 || world_suspended_search(world, search->segment_index, 1)->traversal.level;
        if (*next != DPT_NONE && continues)
            first_slot = *next;
        else if (search->axis_motion == 0.0)
            first_slot = slot_of_nearest_box(search);
        search_candidates(search, first_slot);
        *next = search->next_slot;
    } else {
        search_candidates(search, first_slot);
    }
    leave_out_far_errors(search);
    if (has_lists && search->axis_motion > 0.0 && proves_best(search, search->best->lower_bound))
        dpti_broad_phase_shrink(world, search->segment_index, search->best_distance);
}

void dpti_body_search_find(struct dpt_world *world, uint32_t segment_index, const vec3 *a, const vec3 *b,
                           struct body_answer *best)
{
    struct body_search search = {
        .world = world, .segment_index = segment_index, .a = a, .b = b, .best = best, .next_slot = DPT_NONE
    };
    best->body = NULL;
    best->lower_bound = HUGE_VAL;
    best->error_bound = 0.0;
    best->is_far = 0;
    const uint32_t work_before = world->work.done;
    if (world->def.method == DPT_METHOD_EXACT) {
        find_exact(&search);
    } else {
        for (uint32_t i = 0; i < world->body_slot_end; i++)
            if (body_is_there(&world->bodies[i]))
                search_without_history(&search, i);
    }
    best->is_exact = best->body && proves_best(&search, best->lower_bound);
    best->tick = world->ticks;
    best->work = world->work.done - work_before;
}

void dpti_body_search_result(const struct body_answer *best, struct segment_result *result)
{
    dpti_segment_result_of_pair(&best->track.axis, &best->track.nearest.pair, result);
    result->work = best->work;
    result->error_bound = best->error_bound;
    result->lower_bound = max_of(0.0, result->distance - best->error_bound);
    if (!best->is_exact) {
        result->status = DPT_STATUS_BOUNDED;
        result->lower_bound = max_of(0.0, best->lower_bound - best->error_bound);
        result->error_bound = result->distance - result->lower_bound;
    }
}
