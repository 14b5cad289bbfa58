/* SPDX-License-Identifier: BSD-3-Clause */
#include "world/contacts.h"

#include "world/contact_pair.h"
#include "world/persistent_contacts.h"
#include "world/sheet_sides.h"

/* The nearest pair with another body than the nearest: in full, as it is needed rarely. 0: the budget ended that. */
static int search_other(struct meeting *meeting, vec3 a, vec3 b)
{
    struct dpt_world *world = meeting->world;
    const struct surface *surface = &meeting->body->surface;
    const struct axis *axis = &meeting->axis;
    struct pair_search *nearest = &meeting->nearest;
    uint32_t *last = world_last(world, meeting->segment, handle_index(meeting->body->id));
    struct bvh_traversal walk;
    walk.depth = 0;
    if (work_is_spent(&world->work))
        return 0;
    axis_of(surface, &meeting->body->frame, a, b, &meeting->axis);
    *nearest =
        (struct pair_search){ .pair = dpti_triangle_pair(surface, *last == DPT_NONE ? 0 : *last,
                                                         axis->local_a, axis->u),
                              .triangle = *last == DPT_NONE ? 0 : *last };
    int done = dpti_bvh_traverse(surface, &world->kernel, NULL, axis->local_a, axis->u, 0.0, &walk,
                                 &world->work, nearest);
    *last = nearest->triangle;
    return done;
}

/* What a segment meets, over all bodies. */
struct sum {
    struct push push; /* of the least gap */
    struct push felt; /* of the least as it counts */
    struct pusher pusher;
    double gap;
    double least; /* its gap */
    int known;
    int keeps; /* whose push it was in the last tick, behind a sheet, is met, and its side still counts */
};

static struct pusher pusher_of(const struct meeting *meeting)
{
    const struct profile *profile = meeting->profile;
    const struct sample *deepest = &profile->sample[profile->deepest];
    const uint32_t part = surface_part(profile->surface, deepest->triangle);
    return (struct pusher){ meeting->body->id, part,
                            deepest->height <= 0.0 && dpti_sides_get(&meeting->sides, part) };
}

/*
 * The next tick begins at the point that is pushed, too: beside a border the deepest points are the next to be in
 * front, and what is behind between two that are would not be seen.
 */
static void keep_point(const struct meeting *meeting, uint32_t part, const struct seed *seed)
{
    struct holds *holds = holds_now(meeting->world);
    for (uint32_t i = 0; i < holds->count; i++) {
        struct hold *hold = &holds->hold[i];
        if (hold_is_of(hold, meeting->segment, meeting->body) && hold->part == part &&
            seed->s >= hold->contact.s0 && seed->s <= hold->contact.s1)
            dpti_hold_put_seed(hold, seed);
    }
}

static void meet_body(struct meeting *meeting, const struct body_answer *best, struct sum *sum)
{
    int found = CONTACT_UNKNOWN;
    double gap = HUGE_VAL;
    int ready = meeting->body == best->body;
    if (ready) {
        meeting->axis = best->track.axis;
        meeting->nearest = best->track.nearest;
    } else {
        ready = search_other(meeting, best->track.axis.a, best->track.axis.b);
    }
    if (ready) {
        found = dpti_contact_pair_meet(meeting, &gap);
    } else {
        dpti_contacts_keep_body(meeting->world, meeting->segment, meeting->body);
    }
    struct segment *own = &meeting->world->segments[meeting->segment];
    sum->known &= found != CONTACT_UNKNOWN;
    if (found == CONTACT_PROFILE && own->pusher_before.body == meeting->body->id)
        sum->keeps = dpti_sheet_keeps_push(meeting, own->pusher_before.part);
    if (found != CONTACT_PROFILE)
        return;
    const uint32_t smooth = meeting->world->def.smooth_normals;
    const struct pusher pusher = pusher_of(meeting);
    struct push push = dpti_contact_push(meeting->profile, &meeting->body->frame, gap, smooth);
    double least = gap;
    if (gap < sum->gap) {
        sum->push = push;
        sum->gap = gap;
    }
    if (pusher.behind && !(push.depth <= -sum->least)) {
        struct seed point;
        if (dpti_sheet_border_weigh(meeting->profile, &meeting->body->frame, pusher.body,
                                    meeting->radius, smooth, &own->border, &push, &point))
            keep_point(meeting, pusher.part, &point);
        least = -push.depth;
    }
    if (least < sum->least) {
        sum->felt = push;
        sum->pusher = pusher;
        sum->least = least;
    }
}

void dpti_contacts_find(struct dpt_world *world, uint32_t segment, const struct body_answer *best,
                        struct segment_result *result, struct push *push)
{
    struct segment *own = &world->segments[segment];
    struct meeting meeting = {
        .world = world, .segment = segment, .radius = own->radius, .profile = &world->profile
    };
    dpti_contacts_take_way(world, segment);
    struct box box = box_of_axis(best->track.axis.a, best->track.axis.b);
    double reach = meeting.radius + world->def.margin;
    struct sum sum = { .gap = HUGE_VAL, .least = HUGE_VAL, .known = 1 };
    const struct nearby *nearby = dpti_near_within(world, segment, reach);
    for (uint32_t i = 0; i < nearby->count; i++) {
        uint32_t slot = nearby->list ? nearby->list[i] : i;
        meeting.body = &world->bodies[slot];
        int near = meeting.body == best->body || box_distance(&box, &world->boxes[slot]) <= reach;
        if (meeting.body->slot.used && near)
            meet_body(&meeting, best, &sum);
    }
    if (!sum.known)
        return;
    dpti_segment_result_set_gap(result, smaller(sum.gap, result->distance - meeting.radius),
                                result->error_bound);
    *push = sum.push;
    own->felt = sum.felt;
    own->pusher = sum.pusher;
    own->given_up = own->pusher_before.behind && !sum.keeps;
}
