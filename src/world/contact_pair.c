/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The profile of a segment over a body gives regions; they take over the numbers, the sides and the samples of those of
 * the last tick that cover the same stretch of the tool.
 */
#include "world/contact_pair.h"

#include "world/sheet_sides.h"

/* Sides that are kept, and where the samples of the last tick were. */
static uint32_t recall(struct meeting *meeting, struct seed seeds[PROFILE_SEEDS])
{
    const struct holds *before = holds_before(meeting->world);
    uint32_t count = 0;
    meeting->sides.count = 0;
    for (uint32_t i = 0; i < before->count; i++) {
        const struct hold *hold = &before->hold[i];
        if (!hold_is_of(hold, meeting->segment, meeting->body))
            continue;
        for (uint32_t k = 0; k < hold->seed_count && count < PROFILE_SEEDS; k++)
            seeds[count++] = hold->seed[k];
        /* What was in front, and went through nothing, is in front now, wherever it is, and if it went round a border. */
        if (hold->side && !hold->front)
            dpti_sides_put(&meeting->sides, hold->part, hold->side);
    }
    return count;
}

static double shared(const struct hold *hold, const struct region *region)
{
    return smaller(hold->contact.s1, region->to) - larger(hold->contact.s0, region->from);
}

/* Of the last tick's, the one that has most of the same stretch on the same part, and is not taken by another. */
static const struct hold *same_region(const struct meeting *meeting, const struct region *region)
{
    const struct holds *before = holds_before(meeting->world), *now = holds_now(meeting->world);
    const struct hold *best = NULL;
    for (uint32_t i = 0; i < before->count; i++) {
        const struct hold *hold = &before->hold[i];
        int taken = !hold_is_of(hold, meeting->segment, meeting->body) ||
                    hold->part != region->part || shared(hold, region) < 0.0;
        for (uint32_t k = 0; k < now->count && !taken; k++)
            taken = now->hold[k].contact.id == hold->contact.id;
        if (!taken && (!best || shared(hold, region) > shared(best, region)))
            best = hold;
    }
    return best;
}

static int goes_through(const struct profile *profile, const struct region *region)
{
    for (uint32_t k = 0; k < profile->crossings; k++)
        if (profile->crossing[k].s >= region->from && profile->crossing[k].s <= region->to)
            return 1;
    return 0;
}

/* As users see it. */
static void write_contact(const struct meeting *meeting, const struct region *region,
                          const struct hold *hold, dpt_contact *contact)
{
    const struct frame *frame = &meeting->body->frame;
    const struct axis *axis = &meeting->axis;
    const struct sample *deepest = &meeting->profile->sample[region->deepest];
    const struct segment *segment = &meeting->world->segments[meeting->segment];
    vec3 p = along(axis->a, deepest->s, sub(axis->b, axis->a));
    contact->size = sizeof *contact;
    contact->body = meeting->body->id;
    contact->segment = meeting->segment - meeting->world->tools[segment->tool].first;
    contact->triangle = meeting->body->surface.sources[deepest->triangle];
    contact->gap = deepest->height - meeting->radius;
    contact->contact = dpti_contact_of_gap(contact->gap, axis->error);
    contact->flags = (goes_through(meeting->profile, region) ? DPT_CONTACT_FLAG_CROSSING : 0u) |
                     (hold->side ? DPT_CONTACT_FLAG_SIDED : 0u) |
                     (meeting->profile->coarse ? DPT_CONTACT_FLAG_COARSE : 0u);
    contact->s0 = region->from;
    contact->s1 = region->to;
    contact->s = deepest->s;
    vec3_store(p, contact->p);
    vec3_store(sub(p, frame_turn(frame, deepest->gap)), contact->q);
    uint32_t smooth = meeting->world->def.smooth_normals;
    vec3_store(frame_turn(frame, dpti_contact_normal(meeting->profile, deepest, smooth)),
               contact->normal);
    memcpy(contact->weight, deepest->weight, sizeof contact->weight);
    contact->overlap = region->overlap;
    contact->moment = region->moment;
    vec3_store(frame_turn(frame, region->thrust), contact->thrust);
    vec3_store(frame_turn(frame, region->thrust_moment), contact->thrust_moment);
}

/* With a budget: the axis has not moved in the frame of the body, as far as is known. */
static int rests(const struct meeting *meeting)
{
    const struct dpt_world *world = meeting->world;
    uint32_t nearest = world->segments[meeting->segment].last_body;
    if (!world->def.budget ||
        world_distance_bound(world, meeting->segment, nearest)->rested != world->ticks)
        return 0;
    const struct body *body = &world->bodies[nearest];
    return meeting->body == body ||
           (body->moved != world->ticks && meeting->body->moved != world->ticks);
}

/*
 * What the next tick begins with. An axis that rests begins as before: it asks for the same points then, of which the memo
 * knows more in each tick.
 */
static void put_seeds(const struct meeting *meeting, const struct region *region,
                      const struct hold *before, struct hold *hold)
{
    if (!rests(meeting)) {
        hold->seed_count = dpti_region_seeds(meeting->profile, region, hold->seed, HOLD_SEEDS);
    } else if (before) {
        hold->seed_count = before->seed_count;
        memcpy(hold->seed, before->seed, sizeof hold->seed);
    }
}

static void hold_region(struct meeting *meeting, const struct region *region)
{
    const struct hold *before = same_region(meeting, region);
    struct hold *hold = dpti_contacts_put(meeting->world);
    if (!hold)
        return;
    memset(hold, 0, sizeof *hold);
    hold->segment = meeting->segment;
    hold->part = region->part;
    hold->front = meeting->profile->sample[region->deepest].height > 0.0;
    hold->side = dpti_sheet_side_of_region(
        meeting, region, meeting->profile->sample[region->deepest].height - meeting->radius);
    put_seeds(meeting, region, before, hold);
    hold->contact.id = before ? before->contact.id : dpti_contacts_new_id(meeting->world);
    write_contact(meeting, region, hold, &hold->contact);
}

/*
 * And it goes on with the samples of the region that it may have become or, where the budget ended before there are regions,
 * with the lowest first. Else the tool would be looked for where it once was: a search that does not come to its end begins
 * no better in the next tick, and behind a sheet what is there would in the end not be found.
 */
static void take_seeds(const struct meeting *meeting, const struct region *regions, uint32_t count,
                       struct hold *hold)
{
    const struct sample *lowest = dpti_profile_lowest_on(meeting->profile, hold->part);
    const struct region *best = NULL;
    for (uint32_t k = 0; k < count; k++)
        if (regions[k].part == hold->part &&
            (!best || shared(hold, &regions[k]) > shared(hold, best)))
            best = &regions[k];
    if (best)
        hold->seed_count = dpti_region_seeds(meeting->profile, best, hold->seed, HOLD_SEEDS);
    else if (lowest)
        dpti_hold_put_seed(hold, &(struct seed){ lowest->s, lowest->triangle, 1.0f });
}

static void keep_undecided(struct meeting *meeting, const struct region *regions, uint32_t count,
                           int dropped)
{
    const struct holds *before = holds_before(meeting->world);
    for (uint32_t i = 0; i < before->count; i++) {
        struct hold *hold = &before->hold[i];
        if (!hold_is_of(hold, meeting->segment, meeting->body))
            continue;
        if (dropped && !dpti_sides_get(&meeting->sides, hold->part))
            hold->side = 0;
        dpti_sheet_keep_side(meeting, hold);
        if (!rests(meeting))
            take_seeds(meeting, regions, count, hold);
        dpti_contacts_keep_one(meeting->world, hold);
    }
}

/* Where sides are each sample's own, what is between those that the depth had may be deeper: regions have more. */
static void take_deepest(struct meeting *meeting, const struct region *regions, uint32_t count,
                         double *gap)
{
    struct profile *profile = meeting->profile;
    for (uint32_t i = 0; i < count; i++) {
        const struct sample *deepest = &profile->sample[regions[i].deepest];
        if (deepest->height < 0.0 && deepest->exact && deepest->height - meeting->radius < *gap) {
            profile->deepest = regions[i].deepest;
            *gap = deepest->height - meeting->radius;
        }
    }
}

/* Gap and regions with the sides that are kept; CONTACT_... */
static int look(struct meeting *meeting, const struct seed *seeds, uint32_t seed_count,
                struct region regions[REGION_MOST], uint32_t *count, double *gap)
{
    struct dpt_world *world = meeting->world;
    struct profile *profile = meeting->profile;
    profile->work = work_of(work_left(&world->work));
    int found =
        dpti_contact_find(profile, &meeting->nearest, seeds, seed_count, meeting->radius, gap);
    *count = 0;
    if (found == CONTACT_PROFILE && world->def.max_contacts) {
        /* Integrals leave half to the segments that come after: their gaps count for more. */
        if (world->def.budget && world->segment_count > 1)
            profile->work.limit -= work_left(&profile->work) / 2;
        *count = dpti_region_all(profile, regions);
        take_deepest(meeting, regions, *count, gap);
        /* Where each sample has a side of its own, what is deepest is found with the regions. */
        if (profile->cut && profile_by_sample(profile))
            found = CONTACT_UNKNOWN;
    }
    work_spend(&world->work, profile->work.done);
    return found;
}

int dpti_contact_pair_meet(struct meeting *meeting, double *gap)
{
    struct dpt_world *world = meeting->world;
    struct profile *profile = meeting->profile;
    struct seed seeds[PROFILE_SEEDS];
    struct region regions[REGION_MOST];
    uint32_t seed_count = recall(meeting, seeds), count;
    profile->surface = &meeting->body->surface;
    profile->kernel = &world->kernel;
    profile->axis = &meeting->axis;
    profile->sides = &meeting->sides;
    profile->point_cache = world->def.budget ? &world->point_cache : NULL;
    profile->regions = world->def.max_contacts && !world->def.budget;
    profile->body = handle_index(meeting->body->id);
    profile->reach = meeting->radius + (world->def.max_contacts ? world->def.margin : 0.0);
    profile->tolerance = PROFILE_DEPTH_SHARE * dpti_surface_diagonal(profile->surface);
    int found = look(meeting, seeds, seed_count, regions, &count, gap);
    int dropped = found == CONTACT_PROFILE && dpti_sheet_drop_sides(meeting, regions, count);
    if (dropped)
        found = look(meeting, seeds, seed_count, regions, &count, gap);
    if (found == CONTACT_UNKNOWN)
        keep_undecided(meeting, regions, count, dropped);
    for (uint32_t i = 0; i < count && found != CONTACT_UNKNOWN; i++)
        hold_region(meeting, &regions[i]);
    return found;
}
