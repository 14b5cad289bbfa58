/* SPDX-License-Identifier: BSD-3-Clause */
#include "track/contacts.h"

#include "track/contact_pair.h"
#include "track/persistent_contacts.h"
#include "track/sheet_sides.h"

/*
 * Search the pair's body for its nearest pair with the axis from `a` to `b` (world), and set the pair's `axis` and
 * `nearest`. For a body that is not the nearest one; this is rare, so the search keeps no planes and is never
 * suspended. Returns 0 if the budget ended before the pair was proven, else 1.
 */
static int find_nearest_pair(struct contact_pair *contact_pair, vec3 a, vec3 b)
{
    struct dpt_world *world = contact_pair->world;
    const struct surface *surface = &contact_pair->body->surface;
    const struct axis *axis = &contact_pair->axis;
    struct pair_search *nearest = &contact_pair->nearest;
    uint32_t *last_triangle =
        world_last_triangles(world, contact_pair->segment_index, handle_index(contact_pair->body->id));
    struct bvh_traversal traversal;
    traversal.level = 0;
    if (work_is_spent(&world->work))
        return 0;
    axis_of(surface, &contact_pair->body->frame, a, b, &contact_pair->axis);
    *nearest =
        (struct pair_search){ .pair = dpti_triangle_pair(surface, *last_triangle == DPT_NONE ? 0 : *last_triangle,
                                                         axis->local_a, axis->u),
                              .triangle = *last_triangle == DPT_NONE ? 0 : *last_triangle };
    int is_done = dpti_bvh_traverse(surface, &world->kernel, NULL, axis->local_a, axis->u, 0.0, &traversal,
                                    &world->work, nearest);
    *last_triangle = nearest->triangle;
    return is_done;
}

/* The contact of one segment, summed up over the bodies that are near. */
struct contact_sum {
    struct penetration penetration;      /* at the smallest gap */
    struct penetration felt_penetration; /* at the smallest gap that the force counts */
    struct pushing_part pushing_part;    /* where `felt_penetration` is */
    double min_gap;                      /* m */
    double min_felt_gap;                 /* m; as min_gap, but reduced depths near a sheet's border */
    int is_known;                        /* 0: contact with at least one body is unknown */
    uint32_t unknown;                    /* DPT_HIT_FLAG_...: why */
    int previous_part_pushes;            /* last tick's pushing part still pushes, or motion ended its push */
};

/* The part at the profile's deepest sample. */
static struct pushing_part pushing_part_of(const struct contact_pair *contact_pair)
{
    const struct distance_profile *profile = contact_pair->profile;
    const struct profile_sample *deepest = &profile->sample[profile->deepest];
    const uint32_t part = surface_part(profile->surface, deepest->triangle);
    return (struct pushing_part){ contact_pair->body->id, part,
                                  deepest->height <= 0.0 && dpti_sides_get(&contact_pair->sides, part),
                                  deepest->triangle };
}

/*
 * Make the pushed point a warm start of the next tick. Near a sheet's border the deepest points are the first to come
 * in front of the sheet. Without this sample, all samples may be in front, and the search misses the stretch behind
 * between them.
 */
static void carry_over_pushed_point(const struct contact_pair *contact_pair, uint32_t part,
                                    const struct warm_start *warm_start)
{
    struct persistent_contacts *current = contacts_this_tick(contact_pair->world);
    for (uint32_t i = 0; i < current->count; i++) {
        struct persistent_contact *persistent = &current->items[i];
        if (persistent_contact_is_of(persistent, contact_pair->segment_index, contact_pair->body) &&
            persistent->part == part && warm_start->s >= persistent->contact.s0 &&
            warm_start->s <= persistent->contact.s1)
            dpti_persistent_contact_put_warm_start(persistent, warm_start);
    }
}

/*
 * Find the contacts with the pair's body and add them to `sum`. `best` is the segment's nearest pair over all bodies.
 */
static void add_body(struct contact_pair *contact_pair, const struct body_answer *best, struct contact_sum *sum)
{
    int status = CONTACT_UNKNOWN;
    double gap = HUGE_VAL;
    int has_pair = contact_pair->body == best->body;
    if (has_pair) {
        contact_pair->axis = best->track.axis;
        contact_pair->nearest = best->track.nearest;
    } else {
        has_pair = find_nearest_pair(contact_pair, best->track.axis.a, best->track.axis.b);
    }
    if (has_pair) {
        status = dpti_contact_pair_find(contact_pair, &gap);
        if (status == CONTACT_UNKNOWN)
            sum->unknown |= dpti_contact_why_unknown(contact_pair->profile);
    } else {
        sum->unknown |= DPT_HIT_FLAG_BUDGET;
        dpti_persistent_contacts_carry_over_body(contact_pair->world, contact_pair->segment_index, contact_pair->body);
    }
    struct segment *segment = &contact_pair->world->segments[contact_pair->segment_index];
    sum->is_known &= status != CONTACT_UNKNOWN;
    if (status == CONTACT_PROFILE && segment->previous_pushing_part.body_id == contact_pair->body->id)
        sum->previous_part_pushes = dpti_sheet_still_pushes(contact_pair, segment->previous_pushing_part.part);
    if (status != CONTACT_PROFILE)
        return;
    const uint32_t smooth = contact_pair->world->def.smooth_normals;
    const struct pushing_part pushing_part = pushing_part_of(contact_pair);
    struct penetration penetration =
        dpti_contact_penetration(contact_pair->profile, &contact_pair->body->frame, gap, smooth);
    double felt_gap = gap;
    if (gap < sum->min_gap) {
        sum->penetration = penetration;
        sum->min_gap = gap;
    }
    if (pushing_part.is_behind_sheet && !(penetration.depth <= -sum->min_felt_gap)) {
        struct warm_start warm_start;
        if (dpti_sheet_border_reduce(contact_pair->profile, &contact_pair->body->frame, pushing_part.body_id,
                                     contact_pair->radius, smooth, &segment->border, &penetration, &warm_start))
            carry_over_pushed_point(contact_pair, pushing_part.part, &warm_start);
        felt_gap = -penetration.depth;
    }
    if (felt_gap < sum->min_felt_gap) {
        sum->felt_penetration = penetration;
        sum->pushing_part = pushing_part;
        sum->min_felt_gap = felt_gap;
    }
}

void dpti_contacts_set_none(struct segment *segment)
{
    segment->result.contact = DPT_CONTACT_SEPARATED;
    segment->bed_depth = (struct bed_depth){ .square = 0.0 };
    segment->contact_work = 0;
}

void dpti_contacts_find(struct dpt_world *world, uint32_t segment_index, const struct body_answer *best,
                        struct segment_result *result, struct penetration *penetration)
{
    struct segment *segment = &world->segments[segment_index];
    struct contact_pair contact_pair = {
        .world = world, .segment_index = segment_index, .radius = segment->radius, .profile = &world->profile
    };
    const uint32_t work_before = world->work.done;
    segment->bed_depth = (struct bed_depth){ .square = 0.0 };
    if (world->tools[segment->tool_slot].law == DPT_LAW_BED && world->def.until == DPT_UNTIL_RESPOND)
        contact_pair.bed_depth = &segment->bed_depth;
    dpti_persistent_contacts_note_motion(world, segment_index);
    struct box box = box_of_axis(best->track.axis.a, best->track.axis.b);
    double reach = contact_pair.radius + world->def.margin;
    struct contact_sum sum = { .min_gap = HUGE_VAL, .min_felt_gap = HUGE_VAL, .is_known = 1 };
    const struct near_bodies *near_bodies = dpti_broad_phase_within(world, segment_index, reach);
    for (uint32_t i = 0; i < near_bodies->count; i++) {
        uint32_t slot = near_bodies->slots ? near_bodies->slots[i] : i;
        contact_pair.body = &world->bodies[slot];
        int is_near = contact_pair.body == best->body || box_distance(&box, &world->boxes[slot]) <= reach;
        if (body_is_there(contact_pair.body) && is_near)
            add_body(&contact_pair, best, &sum);
    }
    segment->contact_work = sum.is_known ? world->work.done - work_before : 0;
    if (!sum.is_known) {
        result->unknown = sum.unknown;
        return;
    }
    dpti_segment_result_set_gap(result, min_of(sum.min_gap, result->distance - contact_pair.radius),
                                result->error_bound);
    *penetration = sum.penetration;
    segment->felt_penetration = sum.felt_penetration;
    segment->pushing_part = sum.pushing_part;
    segment->has_given_up_push = segment->previous_pushing_part.is_behind_sheet && !sum.previous_part_pushes;
}
