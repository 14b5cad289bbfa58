/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The body that was nearest last tick is followed first: how far it is bounds all that comes after. Then
 * each body that may be as near is asked for a proof. A budget may end that; the next tick goes on where
 * this one stopped, and what was proven stays proven, less what the axis moved (docs/algorithms/budget.md).
 */
#include "world/body_search.h"

#include "world/distance_bounds.h"

/*
 * A share of dpt_world_bytes: the last answers of each segment's parts on each body, and the planes that are kept of all
 * of them, in whole blocks.
 */
static uint64_t bytes_last(const dpt_world_def *def)
{
    return mesh_aligned(4 * (uint64_t)def->max_segments * def->max_bodies * def->baseline->parts);
}

uint64_t dpti_bodies_bytes(const dpt_world_def *def)
{
    return bytes_last(def) + mesh_aligned(def->certificate_bytes);
}

char *dpti_bodies_place(struct dpt_world *world, char *at)
{
    world->last = (void *)at;
    at += bytes_last(&world->def);
    world->plane_cache.blocks = (void *)at;
    world->plane_cache.count =
        (uint32_t)(world->def.certificate_bytes / sizeof(struct plane_block));
    return at + mesh_aligned(world->def.certificate_bytes);
}

void dpti_bodies_forget_planes(struct dpt_world *world, uint32_t first, uint32_t end, uint32_t body)
{
    const struct plane_cache *c = &world->plane_cache;
    for (uint32_t i = 0; i < c->count; i++) {
        uint32_t owner = (uint32_t)(c->blocks[i].key >> 32);
        if (!owner)
            continue;
        uint32_t segment = (owner - 1) / world->def.max_bodies;
        if (segment >= first && segment < end &&
            (body == DPT_NONE || (owner - 1) % world->def.max_bodies == body))
            c->blocks[i].key = 0;
    }
}

void dpti_bodies_forget(struct dpt_world *world, uint32_t segment)
{
    struct segment *s = &world->segments[segment];
    memset(world_last(world, segment, 0), 0xff, world_lasts(world) * sizeof *world->last);
    s->last_body = DPT_NONE;
}

void dpti_bodies_forget_body(struct dpt_world *world, uint32_t body)
{
    for (uint32_t s = 0; s < world->segment_count; s++) {
        memset(world_last(world, s, body), 0xff, world->def.baseline->parts * sizeof *world->last);
        if (world->segments[s].last_body == body)
            world->segments[s].last_body = DPT_NONE;
    }
    dpti_bodies_forget_planes(world, 0, world->segment_count, body);
}

void dpti_bodies_remove(struct dpt_world *world, uint32_t first, uint32_t end)
{
    size_t moved = world->segment_count - end;
    dpti_bodies_forget_planes(world, first, world->segment_count, DPT_NONE);
    memmove(world_last(world, first, 0), world_last(world, end, 0),
            moved * world_lasts(world) * sizeof *world->last);
}

struct body_search {
    struct dpt_world *world;
    uint32_t segment;
    const vec3 *a, *b; /* the axis */
    struct box box;    /* of it */
    struct body_answer *best;
    double distance;   /* of the best */
    uint32_t followed; /* body whose dynamic point was followed */
    double moved;      /* the axis, in its frame */
    uint32_t is_new;   /* there was no last tick: planes of the past are another place's */
    uint32_t next;     /* body that the budget did not reach, or DPT_NONE */
};

static void axis_in(const struct body_search *search, const struct body *body, struct axis *axis)
{
    axis_of(&body->surface, &body->frame, *search->a, *search->b, axis);
}

/* What a search of a body found, if it is nearer than the rest. */
static void take(struct body_search *search, const struct body *body, const struct track *track)
{
    struct body_answer *best = search->best;
    if (track->nearest.triangle == DPT_NONE)
        return;
    if (track != &best->track && best->body &&
        track->nearest.pair.distance2 >= best->track.nearest.pair.distance2)
        return;
    *world_last(search->world, search->segment, handle_index(body->id)) = track->nearest.triangle;
    if (track != &best->track)
        best->track = *track;
    best->body = body;
    search->distance = sqrt(track->nearest.pair.distance2);
}

/* Methods without memory: every body, in full. */
static void ask_plainly(struct body_search *search, uint32_t index)
{
    struct dpt_world *world = search->world;
    const struct body *body = &world->bodies[index];
    struct body_answer *best = search->best;
    double limit2 = best->body ? best->track.nearest.pair.distance2 : HUGE_VAL;
    struct track track;
    axis_in(search, body, &track.axis);
    if (world->def.method == DPT_METHOD_BRUTE) {
        track.nearest =
            (struct pair_search){ .pair = { .distance2 = limit2 }, .triangle = DPT_NONE };
        dpti_brute_search(&body->surface, track.axis.local_a, track.axis.u, &world->work,
                          &track.nearest);
    } else {
        struct bvh_traversal walk;
        walk.depth = 0;
        dpti_track_begin(&track, &body->surface, *world_last(world, search->segment, index), limit2,
                         TRACK_STAYS, &world->work);
        dpti_track_prove(&track, &body->surface, &world->kernel, NULL, &walk, &world->work);
        dpti_track_settle(&track);
    }
    best->error = max_of(best->error, track.axis.error);
    take(search, body, &track);
}

/* Of what is left, the dynamic point may take half; its proof needs the rest. */
static uint32_t descent_share(const struct dpt_world *world)
{
    return work_left(&world->work) / 2;
}

static void begin_track(struct body_search *search, uint32_t index, double limit2,
                        enum descent_mode mode, struct track *track)
{
    struct dpt_world *world = search->world;
    struct work share = work_of(descent_share(world));
    dpti_track_begin(track, &world->bodies[index].surface,
                     *world_last(world, search->segment, index), limit2, mode, &share);
    work_spend(&world->work, share.done);
}

/* The dynamic point on the body that was nearest. A resting one has nowhere to go. */
static void follow(struct body_search *search, uint32_t index)
{
    struct dpt_world *world = search->world;
    const struct body *body = &world->bodies[index];
    struct track *track = &search->best->track;
    axis_in(search, body, &track->axis);
    search->followed = index;
    search->moved = 1.0;
    if (world->def.budget)
        search->moved = dpti_bounds_update(world, search->segment, index, &track->axis);
    enum descent_mode mode = TRACK_STAYS;
    if (search->moved > 0.0 && descent_share(world))
        mode = track->nearest.pair.distance2 == 0.0 ? TRACK_CROSSED : TRACK_DESCENDS;
    begin_track(search, index, HUGE_VAL, mode, track);
    search->is_new = track->last == DPT_NONE;
    search->best->error = track->axis.error;
    take(search, body, track);
}

/* Nothing is nearer than the best, but for what the error bound allows. */
static int is_proven(const struct body_search *search, double floor)
{
    return floor >= search->distance - DISTANCE_ERROR_HISTORY * search->best->track.axis.error;
}

/* Search a body; what was visited is no nearer than `floor`. 0 if the budget ended that. */
static int prove(struct body_search *search, uint32_t index, struct track *track, int slide,
                 int anew, struct bvh_traversal *walk, double *floor)
{
    struct dpt_world *world = search->world;
    const struct body *body = &world->bodies[index];
    if (track != &search->best->track)
        begin_track(search, index, search->best->track.nearest.pair.distance2,
                    slide ? TRACK_DESCENDS : TRACK_STAYS, track);
    const struct plane_cache_view cache =
        plane_cache_view_of(&world->plane_cache, world_owner(world, search->segment, index), anew);
    int done = dpti_track_prove(track, &body->surface, &world->kernel, &cache, walk, &world->work);
    *floor = sqrt(track->nearest.pair.distance2);
    dpti_track_settle(track);
    take(search, body, track);
    return done;
}

/* Prove as much as the budget allows, unless enough is proven; note what is. The boxes are `apart`. */
static void ask_in_pieces(struct body_search *search, uint32_t index, double apart,
                          struct track *track)
{
    struct dpt_world *world = search->world;
    struct distance_bound *bound = world_distance_bound(world, search->segment, index);
    double moved = search->moved;
    int done = 0;
    if (index != search->followed)
        moved = dpti_bounds_update(world, search->segment, index, &track->axis);
    int anew = moved == 0.0 || search->is_new;
    struct suspended_search *suspended = world_suspended_search(world, search->segment, anew);
    bound->lower_bound = max_of(bound->lower_bound, apart);
    if (!is_proven(search, dpti_bounds_proven(world, search->segment, index)) &&
        !work_is_spent(&search->world->work)) {
        double floor;
        if (suspended->body != index || !suspended->traversal.depth) {
            dpti_bounds_give_up(world, search->segment, suspended);
            suspended->body = index;
            suspended->lower_bound = HUGE_VAL;
        }
        done = prove(search, index, track, moved > 0.0 && descent_share(world), anew,
                     &suspended->traversal, &floor);
        suspended->lower_bound = min_of(suspended->lower_bound, floor);
        if (done)
            bound->lower_bound = max_of(bound->lower_bound, suspended->lower_bound);
    }
    double floor = dpti_bounds_proven(world, search->segment, index);
    if (!done && search->next == DPT_NONE && !is_proven(search, floor))
        search->next = index;
    search->best->lower = min_of(search->best->lower, floor);
}

static void ask(struct body_search *search, uint32_t index)
{
    struct dpt_world *world = search->world;
    const struct body *body = &world->bodies[index];
    struct body_answer *best = search->best;
    int is_best = body == best->body;
    struct track other, *track = is_best ? &best->track : &other;
    if (!body->slot.used || search->distance == 0.0)
        return;
    double apart = is_best ? 0.0 : box_distance(&search->box, &world->boxes[index]);
    if (apart >= search->distance)
        return;
    if (!is_best)
        axis_in(search, body, &other.axis);
    best->error = max_of(best->error, track->axis.error);
    if (world->def.budget) {
        ask_in_pieces(search, index, apart, track);
    } else {
        struct bvh_traversal walk;
        double floor;
        walk.depth = 0;
        prove(search, index, track, 1, (int)search->is_new, &walk, &floor);
    }
}

/* The bodies that may be near, by place on the list. */
static uint32_t near_count(const struct body_search *search)
{
    const struct dpt_world *world = search->world;
    return world->body_end <= NEAR_FEW ? world->body_end
                                       : world->segments[search->segment].near.now.listed;
}

static uint32_t near_at(const struct body_search *search, uint32_t place)
{
    const struct dpt_world *world = search->world;
    uint32_t which = world->segments[search->segment].near.now.which;
    return world->body_end <= NEAR_FEW ? place : world_near(world, search->segment, which)[place];
}

/* Where nothing is known, the body whose box is nearest is the best to begin with. */
static uint32_t nearest_box(const struct body_search *search)
{
    uint32_t best = DPT_NONE;
    double least = HUGE_VAL;
    for (uint32_t i = 0; i < near_count(search); i++) {
        uint32_t index = near_at(search, i);
        double apart = box_distance(&search->box, &search->world->boxes[index]);
        if (search->world->bodies[index].slot.used && apart < least) {
            least = apart;
            best = index;
        }
    }
    return best;
}

/* Each of them, from `first` on. */
static void ask_near(struct body_search *search, uint32_t first)
{
    uint32_t count = near_count(search), begin = 0;
    while (begin < count && near_at(search, begin) != first)
        begin++;
    for (uint32_t i = 0; i < count; i++)
        ask(search, near_at(search, begin + i < count ? begin + i : begin + i - count));
}

static void find_exact(struct body_search *search)
{
    struct dpt_world *world = search->world;
    struct segment *segment = &world->segments[search->segment];
    uint32_t first = segment->last_body;
    for (uint32_t i = 0; first == DPT_NONE && i < world->body_end; i++)
        if (world->bodies[i].slot.used)
            first = i;
    if (first == DPT_NONE)
        return;
    int many = world->body_end > NEAR_FEW;
    if (many)
        dpti_near_move(&segment->near, *search->a, *search->b);
    follow(search, first);
    if (search->distance == 0.0)
        return; /* nothing is nearer */
    search->box = box_of_axis(*search->a, *search->b);
    if (many) {
        double reach = dpti_near_list(world, search->segment, search->distance);
        if (reach < search->distance)
            search->best->lower = reach;
    }
    /* In motion all bodies get their turn; a first search, and one at rest, begins where it costs least. */
    uint32_t begin = search->is_new ? nearest_box(search) : first;
    if (world->def.budget) {
        uint32_t *next = &world_suspended_search(world, search->segment, 0)->next;
        int goes_on = search->moved > 0.0 ||
                      world_suspended_search(world, search->segment, 1)->traversal.depth;
        if (*next != DPT_NONE && goes_on)
            begin = *next;
        else if (search->moved == 0.0)
            begin = nearest_box(search);
        ask_near(search, begin);
        *next = search->next;
    } else {
        ask_near(search, begin);
    }
    if (many && search->moved > 0.0 && is_proven(search, search->best->lower))
        dpti_near_tidy(world, search->segment, search->distance);
}

void dpti_bodies_find(struct dpt_world *world, uint32_t segment, const vec3 *a, const vec3 *b,
                      struct body_answer *best)
{
    struct body_search search = {
        .world = world, .segment = segment, .a = a, .b = b, .best = best, .next = DPT_NONE
    };
    best->body = NULL;
    best->lower = HUGE_VAL;
    best->error = 0.0;
    const uint32_t before = world->work.done;
    if (world->def.method == DPT_METHOD_EXACT) {
        find_exact(&search);
    } else {
        for (uint32_t i = 0; i < world->body_end; i++)
            if (world->bodies[i].slot.used)
                ask_plainly(&search, i);
    }
    best->exact = best->body && is_proven(&search, best->lower);
    best->work = world->work.done - before;
}

void dpti_bodies_result(const struct body_answer *best, struct segment_result *result)
{
    dpti_segment_result_of_pair(&best->track.axis, &best->track.nearest.pair, result);
    result->work = best->work;
    result->error_bound = best->error;
    result->lower_bound = max_of(0.0, result->distance - best->error);
    if (!best->exact) {
        result->status = DPT_STATUS_BOUNDED;
        result->lower_bound = max_of(0.0, best->lower - best->error);
        result->error_bound = result->distance - result->lower_bound;
    }
}
