/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The body that was nearest last tick is followed first: how far it is bounds all that comes after. Then
 * each body that may be as near is asked for a proof. A budget may end that; the next tick goes on where
 * this one stopped, and what was proven stays proven, less what the axis moved (docs/algorithms/budget.md).
 */
#include "bodies.h"

/* So few bodies are all near: a list of them would cost more than it saves. */
enum { BODIES_FEW = 4 };

struct hunt {
    struct dpt_world *world;
    uint32_t segment;
    vec3 a, b;
    struct box box; /* of the axis */
    struct found *best;
    double distance; /* of the best */
    uint32_t next;   /* body that the budget did not reach, or DPT_NONE */
};

static int is_spent(const struct hunt *hunt)
{
    return hunt->world->def.budget && !hunt->world->left;
}

static void charge(struct hunt *hunt, struct nearest *nearest)
{
    hunt->best->work += nearest->work;
    if (hunt->world->def.budget)
        hunt->world->left -= nearest->work;
    nearest->work = 0;
}

static void axis_in(const struct hunt *hunt, const struct body *body, struct axis *axis)
{
    axis_of(&body->tree, &body->frame, hunt->a, hunt->b, axis);
}

/* What a search of a body found, if it is nearer than the rest. */
static void take(struct hunt *hunt, const struct body *body, const struct track *track)
{
    struct found *best = hunt->best;
    if (track->nearest.triangle == DPT_NONE)
        return;
    if (track != &best->track && best->body &&
        track->nearest.pair.distance2 >= best->track.nearest.pair.distance2)
        return;
    *world_last(hunt->world, hunt->segment, handle_index(body->id)) = track->nearest.triangle;
    if (track != &best->track)
        best->track = *track;
    best->body = body;
    hunt->distance = sqrt(track->nearest.pair.distance2);
}

/* Methods without memory: every body, in full. */
static void ask_plainly(struct hunt *hunt, uint32_t index)
{
    struct dpt_world *world = hunt->world;
    const struct body *body = &world->bodies[index];
    struct found *best = hunt->best;
    double limit2 = best->body ? best->track.nearest.pair.distance2 : HUGE_VAL;
    struct track track;
    axis_in(hunt, body, &track.axis);
    if (world->def.method == DPT_METHOD_BRUTE) {
        track.nearest = (struct nearest){ .pair = { .distance2 = limit2 }, .triangle = DPT_NONE };
        tree_brute(&body->tree, track.axis.local_a, track.axis.u, &track.nearest);
    } else {
        struct walk walk;
        walk.at = 0;
        track_begin(&track, &body->tree, *world_last(world, hunt->segment, index), limit2, 0, 0);
        track_prove(&track, &body->tree, &world->kernel, NULL, &walk);
        track_settle(&track);
    }
    best->error = larger(best->error, track.axis.error);
    charge(hunt, &track.nearest);
    take(hunt, body, &track);
}

/* How far the ends moved, in the body's frame; exactly 0 for nothing. */
static double moved_since(const struct proof *proof, const struct axis *axis)
{
    vec3 b = add(axis->local_a, axis->u);
    double moved = larger(length(sub(axis->local_a, proof->a)), length(sub(b, proof->b)));
    return moved > 0.0 ? moved + axis->error : 0.0;
}

/* The dynamic point on the body that was nearest. A resting one has nowhere to go. */
static void follow(struct hunt *hunt, uint32_t index)
{
    struct dpt_world *world = hunt->world;
    const struct body *body = &world->bodies[index];
    struct track *track = &hunt->best->track;
    int slide = !is_spent(hunt);
    axis_in(hunt, body, &track->axis);
    if (world->def.budget)
        slide &= moved_since(world_proof(world, hunt->segment, index), &track->axis) > 0.0;
    track_begin(track, &body->tree, *world_last(world, hunt->segment, index), HUGE_VAL, slide,
                world->left);
    charge(hunt, &track->nearest);
    take(hunt, body, track);
}

/* Nothing is nearer than the best, but for what the error bound allows. */
static int is_proven(const struct hunt *hunt, double floor)
{
    return floor >= hunt->distance - TREE_HISTORY * hunt->best->track.axis.error;
}

/* Search a body; what was visited is no nearer than `floor`. 0 if the budget ended that. */
static int prove(struct hunt *hunt, uint32_t index, struct track *track, int slide,
                 struct walk *walk, double *floor)
{
    struct dpt_world *world = hunt->world;
    const struct body *body = &world->bodies[index];
    const struct keeper keeper = { &world->certificate, world_owner(world, hunt->segment, index) };
    if (track == &hunt->best->track)
        track->nearest.most = world->left;
    else
        track_begin(track, &body->tree, *world_last(world, hunt->segment, index),
                    hunt->best->track.nearest.pair.distance2, slide, world->left);
    int done = track_prove(track, &body->tree, &world->kernel, &keeper, walk);
    *floor = sqrt(track->nearest.pair.distance2);
    charge(hunt, &track->nearest);
    track_settle(track);
    take(hunt, body, track);
    return done;
}

/*
 * Bring what is proven up to date. A search that was stopped stays valid when the axis moves, but its answer
 * will only be bounded: when the axis then rests, it begins again.
 */
static double update(struct proof *proof, struct pause *pause, const struct tree *tree,
                     const struct axis *axis)
{
    double moved = moved_since(proof, axis);
    proof->floor = larger(0.0, proof->floor - moved);
    proof->a = axis->local_a;
    proof->b = add(axis->local_a, axis->u);
    if (pause && moved > 0.0) {
        walk_drift(&pause->walk, tree, moved);
        pause->floor -= moved;
        pause->moved = 1;
    } else if (pause && pause->moved) {
        pause->walk.at = 0;
    }
    return moved;
}

/* What a search that was stopped has proven. */
static double floor_so_far(const struct pause *pause, const struct tree *tree,
                           const struct axis *axis)
{
    if (!pause->walk.at)
        return 0.0;
    return smaller(pause->floor, walk_ahead(&pause->walk, tree, axis->local_a, axis->u));
}

/* Prove as much as the budget allows, unless enough is proven; note what is. */
static void ask_in_pieces(struct hunt *hunt, uint32_t index, struct track *track)
{
    struct dpt_world *world = hunt->world;
    const struct tree *tree = &world->bodies[index].tree;
    const struct axis axis = track->axis;
    struct proof *proof = world_proof(world, hunt->segment, index);
    struct pause *pause = &world->pauses[hunt->segment];
    double moved = update(proof, pause->body == index ? pause : NULL, tree, &axis);
    int done = 0;
    if (is_proven(hunt, proof->floor))
        return;
    if (!is_spent(hunt)) {
        double floor;
        if (pause->body != index || !pause->walk.at) {
            pause->body = index;
            pause->walk.at = 0;
            pause->floor = HUGE_VAL;
            pause->moved = 0;
        }
        done = prove(hunt, index, track, moved > 0.0, &pause->walk, &floor);
        pause->floor = smaller(pause->floor, floor);
        if (done)
            proof->floor = larger(proof->floor, pause->floor);
    }
    double floor = proof->floor;
    if (!done && pause->body == index)
        floor = larger(floor, floor_so_far(pause, tree, &axis));
    if (!done && hunt->next == DPT_NONE)
        hunt->next = index;
    hunt->best->lower = smaller(hunt->best->lower, floor);
}

static void ask(struct hunt *hunt, uint32_t index)
{
    struct dpt_world *world = hunt->world;
    const struct body *body = &world->bodies[index];
    struct found *best = hunt->best;
    int is_best = body == best->body;
    struct track other, *track = is_best ? &best->track : &other;
    if (!body->slot.used || hunt->distance == 0.0)
        return;
    if (!is_best) {
        if (box_distance(&hunt->box, &world->boxes[index]) >= hunt->distance)
            return;
        axis_in(hunt, body, &other.axis);
    }
    best->error = larger(best->error, track->axis.error);
    if (world->def.budget) {
        ask_in_pieces(hunt, index, track);
    } else {
        struct walk walk;
        double floor;
        walk.at = 0;
        prove(hunt, index, track, 1, &walk, &floor);
    }
}

/* All bodies that may be near are listed, or, where the budget ended that, nothing is known of the rest. */
static void list_near(struct hunt *hunt)
{
    struct dpt_world *world = hunt->world;
    struct near *near = &world->segments[hunt->segment].near;
    uint32_t *list = world_near(world, hunt->segment);
    if (!near_serves(near, hunt->distance))
        near_settle(near, hunt->distance);
    while (near->scanned < world->body_end && !is_spent(hunt)) {
        struct nearest unit = { .work = 1 };
        charge(hunt, &unit);
        for (int i = 0; i < LANES && near->scanned < world->body_end; i++) {
            uint32_t index = near->scanned++;
            if (world->bodies[index].slot.used && box_meets(&near->home, &world->boxes[index]))
                list[near->listed++] = index;
        }
    }
    if (near->scanned < world->body_end)
        hunt->best->lower = 0.0;
}

/* Each of them, from `first` on. */
static void ask_near(struct hunt *hunt, uint32_t first)
{
    struct dpt_world *world = hunt->world;
    int few = world->body_end <= BODIES_FEW;
    const uint32_t *list = world_near(world, hunt->segment);
    uint32_t count = few ? world->body_end : world->segments[hunt->segment].near.listed;
    uint32_t begin = few ? first : 0;
    for (uint32_t i = 0; !few && i < count; i++)
        begin = list[i] == first ? i : begin;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t at = begin + i < count ? begin + i : begin + i - count;
        ask(hunt, few ? at : list[at]);
    }
}

static void find_exact(struct hunt *hunt)
{
    struct dpt_world *world = hunt->world;
    struct segment *segment = &world->segments[hunt->segment];
    uint32_t first = segment->last_body;
    for (uint32_t i = 0; first == DPT_NONE && i < world->body_end; i++)
        if (world->bodies[i].slot.used)
            first = i;
    if (first == DPT_NONE)
        return;
    hunt->box = box_of_axis(hunt->a, hunt->b);
    follow(hunt, first);
    if (world->body_end > BODIES_FEW) {
        near_move(&segment->near, hunt->a, hunt->b);
        list_near(hunt);
    }
    if (world->def.budget) {
        struct pause *pause = &world->pauses[hunt->segment];
        ask_near(hunt, pause->next != DPT_NONE ? pause->next : first);
        pause->next = hunt->next;
    } else {
        ask_near(hunt, first);
    }
}

void bodies_find(struct dpt_world *world, uint32_t segment, vec3 a, vec3 b, struct found *best)
{
    struct hunt hunt = {
        .world = world, .segment = segment, .a = a, .b = b, .best = best, .next = DPT_NONE
    };
    best->body = NULL;
    best->lower = HUGE_VAL;
    best->error = 0.0;
    best->work = 0;
    if (world->def.method == DPT_METHOD_EXACT) {
        find_exact(&hunt);
    } else {
        for (uint32_t i = 0; i < world->body_end; i++)
            if (world->bodies[i].slot.used)
                ask_plainly(&hunt, i);
    }
    best->exact = best->body && is_proven(&hunt, best->lower);
}

void bodies_hit(const struct found *best, dpt_hit *hit)
{
    const struct body *body = best->body;
    track_hit(&body->tree, &best->track.axis, &body->frame, &best->track.nearest, hit);
    hit->body = body->id;
    hit->work = best->work;
    hit->error_bound = best->error;
    hit->lower_bound = larger(0.0, smaller(best->lower, hit->distance) - best->error);
    if (!best->exact) {
        hit->status = DPT_STATUS_BOUNDED;
        hit->error_bound = hit->distance - hit->lower_bound;
    }
}

void bodies_place(struct dpt_world *world, uint32_t index)
{
    const struct body *body = &world->bodies[index];
    const struct dpt_mesh *mesh = body->tree.mesh;
    struct box *box = &world->boxes[index];
    *box = box_in_world(vec3_of(mesh->box_min), vec3_of(mesh->box_max), &body->frame);
    for (uint32_t s = 0; world->body_end > BODIES_FEW && s < world->segment_count; s++) {
        struct near *near = &world->segments[s].near;
        uint32_t *list = world_near(world, s), i = 0;
        if (!(near->room > 0.0) || index >= near->scanned || !box_meets(&near->home, box))
            continue;
        while (i < near->listed && list[i] != index)
            i++;
        if (i == near->listed)
            list[near->listed++] = index;
    }
}
