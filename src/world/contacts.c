/* SPDX-License-Identifier: BSD-3-Clause */
#include "world/contacts.h"

#include "world/contact_pair.h"
#include "world/persistent_contacts.h"

/* The nearest pair with another body than the nearest: in full, as it is needed rarely. 0: the budget ended that. */
static int search_other(struct meeting *meeting, vec3 a, vec3 b)
{
    struct dpt_world *world = meeting->world;
    const struct surface *surface = &meeting->body->surface;
    const struct axis *axis = &meeting->axis;
    struct nearest *nearest = &meeting->nearest;
    uint32_t *last = world_last(world, meeting->segment, handle_index(meeting->body->id));
    struct walk walk;
    walk.at = 0;
    if (work_is_spent(&world->work))
        return 0;
    axis_of(surface, &meeting->body->frame, a, b, &meeting->axis);
    *nearest = (struct nearest){ .pair = dpti_tree_pair(surface, *last == DPT_NONE ? 0 : *last,
                                                        axis->local_a, axis->u),
                                 .triangle = *last == DPT_NONE ? 0 : *last };
    int done = dpti_tree_walk(surface, &world->kernel, NULL, axis->local_a, axis->u, 0.0, &walk,
                              &world->work, nearest);
    *last = nearest->triangle;
    return done;
}

/* What a segment meets, over all bodies. */
struct sum {
    struct push push;
    double gap;
    int known;
};

static void meet_body(struct meeting *meeting, const struct found *best, struct sum *sum)
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
    sum->known &= found != CONTACT_UNKNOWN;
    if (found == CONTACT_PROFILE && gap < sum->gap) {
        sum->push = dpti_contact_push(meeting->profile, &meeting->body->frame, gap,
                                      meeting->world->def.smooth_normals);
        sum->gap = gap;
    }
}

void dpti_contacts_find(struct dpt_world *world, uint32_t segment, const struct found *best,
                        struct segment_result *result, struct push *push)
{
    struct meeting meeting = { .world = world,
                               .segment = segment,
                               .radius = world->segments[segment].radius,
                               .profile = &world->profile };
    dpti_contacts_take_way(world, segment);
    struct box box = box_of_axis(best->track.axis.a, best->track.axis.b);
    double reach = meeting.radius + world->def.margin;
    struct sum sum = { .gap = HUGE_VAL, .known = 1 };
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
}
