/* SPDX-License-Identifier: BSD-3-Clause */
#include "world/contacts.h"

#include "world/contact_pair.h"
#include "world/persistent_contacts.h"
#include "world/sheet_sides.h"

/* The nearest pair with another body than the nearest: in full, as it is needed rarely. 0: the budget ended that. */
static int search_other(struct contact_pair *contact_pair, vec3 a, vec3 b)
{
    struct dpt_world *world = contact_pair->world;
    const struct surface *surface = &contact_pair->body->surface;
    const struct axis *axis = &contact_pair->axis;
    struct pair_search *nearest = &contact_pair->nearest;
    uint32_t *last = world_last(world, contact_pair->segment, handle_index(contact_pair->body->id));
    struct bvh_traversal walk;
    walk.depth = 0;
    if (work_is_spent(&world->work))
        return 0;
    axis_of(surface, &contact_pair->body->frame, a, b, &contact_pair->axis);
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
struct force_sum {
    struct penetration push; /* of the least gap */
    struct penetration felt; /* of the least as it counts */
    struct pushing_part pusher;
    double gap;
    double least; /* its gap */
    int known;
    int keeps; /* whose push it was in the last tick, behind a sheet, is met, and its side still counts */
};

static struct pushing_part pushing_part_of(const struct contact_pair *contact_pair)
{
    const struct distance_profile *profile = contact_pair->profile;
    const struct profile_sample *deepest = &profile->sample[profile->deepest];
    const uint32_t part = surface_part(profile->surface, deepest->triangle);
    return (struct pushing_part){ contact_pair->body->id, part,
                                  deepest->height <= 0.0 &&
                                      dpti_sides_get(&contact_pair->sides, part) };
}

/*
 * The next tick begins at the point that is pushed, too: beside a border the deepest points are the next to be in
 * front, and what is behind between two that are would not be seen.
 */
static void carry_over_penetration(const struct contact_pair *contact_pair, uint32_t part,
                                   const struct warm_start *warm_start)
{
    struct persistent_contacts *holds = contacts_now(contact_pair->world);
    for (uint32_t i = 0; i < holds->count; i++) {
        struct persistent_contact *persistent = &holds->at[i];
        if (persistent_contact_is_of(persistent, contact_pair->segment, contact_pair->body) &&
            persistent->part == part && warm_start->s >= persistent->contact.s0 &&
            warm_start->s <= persistent->contact.s1)
            dpti_persistent_contact_put_warm_start(persistent, warm_start);
    }
}

static void find_contacts(struct contact_pair *contact_pair, const struct body_answer *best,
                          struct force_sum *sum)
{
    int found = CONTACT_UNKNOWN;
    double gap = HUGE_VAL;
    int ready = contact_pair->body == best->body;
    if (ready) {
        contact_pair->axis = best->track.axis;
        contact_pair->nearest = best->track.nearest;
    } else {
        ready = search_other(contact_pair, best->track.axis.a, best->track.axis.b);
    }
    if (ready) {
        found = dpti_contact_pair_find(contact_pair, &gap);
    } else {
        dpti_contacts_carry_over_body(contact_pair->world, contact_pair->segment,
                                      contact_pair->body);
    }
    struct segment *own = &contact_pair->world->segments[contact_pair->segment];
    sum->known &= found != CONTACT_UNKNOWN;
    if (found == CONTACT_PROFILE && own->previous_pushing_part.body == contact_pair->body->id)
        sum->keeps = dpti_sheet_keeps_push(contact_pair, own->previous_pushing_part.part);
    if (found != CONTACT_PROFILE)
        return;
    const uint32_t smooth = contact_pair->world->def.smooth_normals;
    const struct pushing_part pusher = pushing_part_of(contact_pair);
    struct penetration penetration =
        dpti_contact_penetration(contact_pair->profile, &contact_pair->body->frame, gap, smooth);
    double least = gap;
    if (gap < sum->gap) {
        sum->push = penetration;
        sum->gap = gap;
    }
    if (pusher.behind && !(penetration.depth <= -sum->least)) {
        struct warm_start point;
        if (dpti_sheet_border_reduce(contact_pair->profile, &contact_pair->body->frame, pusher.body,
                                     contact_pair->radius, smooth, &own->border, &penetration,
                                     &point))
            carry_over_penetration(contact_pair, pusher.part, &point);
        least = -penetration.depth;
    }
    if (least < sum->least) {
        sum->felt = penetration;
        sum->pusher = pusher;
        sum->least = least;
    }
}

void dpti_contacts_find(struct dpt_world *world, uint32_t segment, const struct body_answer *best,
                        struct segment_result *result, struct penetration *penetration)
{
    struct segment *own = &world->segments[segment];
    struct contact_pair contact_pair = {
        .world = world, .segment = segment, .radius = own->radius, .profile = &world->profile
    };
    dpti_contacts_note_motion(world, segment);
    struct box box = box_of_axis(best->track.axis.a, best->track.axis.b);
    double reach = contact_pair.radius + world->def.margin;
    struct force_sum sum = { .gap = HUGE_VAL, .least = HUGE_VAL, .known = 1 };
    const struct nearby *nearby = dpti_near_within(world, segment, reach);
    for (uint32_t i = 0; i < nearby->count; i++) {
        uint32_t slot = nearby->list ? nearby->list[i] : i;
        contact_pair.body = &world->bodies[slot];
        int near =
            contact_pair.body == best->body || box_distance(&box, &world->boxes[slot]) <= reach;
        if (contact_pair.body->slot.used && near)
            find_contacts(&contact_pair, best, &sum);
    }
    if (!sum.known)
        return;
    dpti_segment_result_set_gap(result, min_of(sum.gap, result->distance - contact_pair.radius),
                                result->error_bound);
    *penetration = sum.push;
    own->felt_penetration = sum.felt;
    own->pushing_part = sum.pusher;
    own->given_up = own->previous_pushing_part.behind && !sum.keeps;
}
