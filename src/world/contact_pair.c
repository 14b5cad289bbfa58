/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The profile of a segment over a body gives regions; they take over the numbers, the sides and the samples of those of
 * the last tick that cover the same stretch of the tool.
 */
#include "world/contact_pair.h"

#include "world/sheet_sides.h"

/* Sides that are kept, and where the samples of the last tick were. */
static uint32_t load_warm_starts(struct contact_pair *contact_pair,
                                 struct warm_start warm_starts[PROFILE_WARM_STARTS])
{
    const struct persistent_contacts *before = contacts_before(contact_pair->world);
    uint32_t count = 0;
    contact_pair->sides.count = 0;
    for (uint32_t i = 0; i < before->count; i++) {
        const struct persistent_contact *persistent = &before->at[i];
        if (!persistent_contact_is_of(persistent, contact_pair->segment, contact_pair->body))
            continue;
        for (uint32_t k = 0; k < persistent->warm_start_count && count < PROFILE_WARM_STARTS; k++)
            warm_starts[count++] = persistent->warm_start[k];
        /* What was in front, and went through nothing, is in front now, wherever it is, and if it went round a border. */
        if (persistent->side && !persistent->front)
            dpti_sides_put(&contact_pair->sides, persistent->part, persistent->side);
    }
    return count;
}

static double shared(const struct persistent_contact *persistent, const struct region *region)
{
    return min_of(persistent->contact.s1, region->to) -
           max_of(persistent->contact.s0, region->from);
}

/* Of the last tick's, the one that has most of the same stretch on the same part, and is not taken by another. */
static const struct persistent_contact *same_region(const struct contact_pair *contact_pair,
                                                    const struct region *region)
{
    const struct persistent_contacts *before = contacts_before(contact_pair->world),
                                     *now = contacts_now(contact_pair->world);
    const struct persistent_contact *best = NULL;
    for (uint32_t i = 0; i < before->count; i++) {
        const struct persistent_contact *persistent = &before->at[i];
        int taken =
            !persistent_contact_is_of(persistent, contact_pair->segment, contact_pair->body) ||
            persistent->part != region->part || shared(persistent, region) < 0.0;
        for (uint32_t k = 0; k < now->count && !taken; k++)
            taken = now->at[k].contact.id == persistent->contact.id;
        if (!taken && (!best || shared(persistent, region) > shared(best, region)))
            best = persistent;
    }
    return best;
}

static int goes_through(const struct distance_profile *profile, const struct region *region)
{
    for (uint32_t k = 0; k < profile->crossing_count; k++)
        if (profile->crossing[k].s >= region->from && profile->crossing[k].s <= region->to)
            return 1;
    return 0;
}

/* As users see it. */
static void write_contact(const struct contact_pair *contact_pair, const struct region *region,
                          const struct persistent_contact *persistent, dpt_contact *contact)
{
    const struct frame *frame = &contact_pair->body->frame;
    const struct axis *axis = &contact_pair->axis;
    const struct profile_sample *deepest = &contact_pair->profile->sample[region->deepest];
    const struct segment *segment = &contact_pair->world->segments[contact_pair->segment];
    vec3 p = along(axis->a, deepest->s, sub(axis->b, axis->a));
    contact->size = sizeof *contact;
    contact->body = contact_pair->body->id;
    contact->segment = contact_pair->segment - contact_pair->world->tools[segment->tool].first;
    contact->triangle = contact_pair->body->surface.sources[deepest->triangle];
    contact->gap = deepest->height - contact_pair->radius;
    contact->contact = dpti_contact_of_gap(contact->gap, axis->error);
    contact->flags =
        (goes_through(contact_pair->profile, region) ? DPT_CONTACT_FLAG_CROSSING : 0u) |
        (persistent->side ? DPT_CONTACT_FLAG_SIDED : 0u) |
        (contact_pair->profile->is_coarse ? DPT_CONTACT_FLAG_COARSE : 0u);
    contact->s0 = region->from;
    contact->s1 = region->to;
    contact->s = deepest->s;
    vec3_store(p, contact->p);
    vec3_store(sub(p, frame_turn(frame, deepest->gap)), contact->q);
    uint32_t smooth = contact_pair->world->def.smooth_normals;
    vec3_store(frame_turn(frame, dpti_contact_normal(contact_pair->profile, deepest, smooth)),
               contact->normal);
    memcpy(contact->weight, deepest->weight, sizeof contact->weight);
    contact->overlap = region->overlap;
    contact->moment = region->moment;
    vec3_store(frame_turn(frame, region->thrust), contact->thrust);
    vec3_store(frame_turn(frame, region->thrust_moment), contact->thrust_moment);
}

/* With a budget: the axis has not moved in the frame of the body, as far as is known. */
static int rests(const struct contact_pair *contact_pair)
{
    const struct dpt_world *world = contact_pair->world;
    uint32_t nearest = world->segments[contact_pair->segment].last_body;
    if (!world->def.budget ||
        world_distance_bound(world, contact_pair->segment, nearest)->rested != world->ticks)
        return 0;
    const struct body *body = &world->bodies[nearest];
    return contact_pair->body == body ||
           (body->moved != world->ticks && contact_pair->body->moved != world->ticks);
}

/*
 * What the next tick begins with. An axis that rests begins as before: it asks for the same points then, of which the memo
 * knows more in each tick.
 */
static void put_warm_starts(const struct contact_pair *contact_pair, const struct region *region,
                            const struct persistent_contact *before,
                            struct persistent_contact *persistent)
{
    if (!rests(contact_pair)) {
        persistent->warm_start_count = dpti_contact_region_warm_starts(
            contact_pair->profile, region, persistent->warm_start, WARM_STARTS_MAX);
    } else if (before) {
        persistent->warm_start_count = before->warm_start_count;
        memcpy(persistent->warm_start, before->warm_start, sizeof persistent->warm_start);
    }
}

static void put_persistent_contact(struct contact_pair *contact_pair, const struct region *region)
{
    const struct persistent_contact *before = same_region(contact_pair, region);
    struct persistent_contact *persistent = dpti_contacts_put(contact_pair->world);
    if (!persistent)
        return;
    memset(persistent, 0, sizeof *persistent);
    persistent->segment = contact_pair->segment;
    persistent->part = region->part;
    persistent->front = contact_pair->profile->sample[region->deepest].height > 0.0;
    persistent->side = dpti_sheet_side_of_region(
        contact_pair, region,
        contact_pair->profile->sample[region->deepest].height - contact_pair->radius);
    put_warm_starts(contact_pair, region, before, persistent);
    persistent->contact.id =
        before ? before->contact.id : dpti_contacts_new_id(contact_pair->world);
    write_contact(contact_pair, region, persistent, &persistent->contact);
}

/*
 * And it goes on with the samples of the region that it may have become or, where the budget ended before there are regions,
 * with the lowest first. Else the tool would be looked for where it once was: a search that does not come to its end begins
 * no better in the next tick, and behind a sheet what is there would in the end not be found.
 */
static void take_warm_starts(const struct contact_pair *contact_pair, const struct region *regions,
                             uint32_t count, struct persistent_contact *persistent)
{
    const struct profile_sample *lowest =
        dpti_profile_lowest_on(contact_pair->profile, persistent->part);
    const struct region *best = NULL;
    for (uint32_t k = 0; k < count; k++)
        if (regions[k].part == persistent->part &&
            (!best || shared(persistent, &regions[k]) > shared(persistent, best)))
            best = &regions[k];
    if (best)
        persistent->warm_start_count = dpti_contact_region_warm_starts(
            contact_pair->profile, best, persistent->warm_start, WARM_STARTS_MAX);
    else if (lowest)
        dpti_persistent_contact_put_warm_start(
            persistent, &(struct warm_start){ lowest->s, lowest->triangle, 1.0f });
}

static void carry_over_undecided(struct contact_pair *contact_pair, const struct region *regions,
                                 uint32_t count, int dropped)
{
    const struct persistent_contacts *before = contacts_before(contact_pair->world);
    for (uint32_t i = 0; i < before->count; i++) {
        struct persistent_contact *persistent = &before->at[i];
        if (!persistent_contact_is_of(persistent, contact_pair->segment, contact_pair->body))
            continue;
        if (dropped && !dpti_sides_get(&contact_pair->sides, persistent->part))
            persistent->side = 0;
        dpti_sheet_keep_side(contact_pair, persistent);
        if (!rests(contact_pair))
            take_warm_starts(contact_pair, regions, count, persistent);
        dpti_contacts_carry_over_one(contact_pair->world, persistent);
    }
}

/* Where sides are each sample's own, what is between those that the depth had may be deeper: regions have more. */
static void take_deepest(struct contact_pair *contact_pair, const struct region *regions,
                         uint32_t count, double *gap)
{
    struct distance_profile *profile = contact_pair->profile;
    for (uint32_t i = 0; i < count; i++) {
        const struct profile_sample *deepest = &profile->sample[regions[i].deepest];
        if (deepest->height < 0.0 && deepest->is_exact &&
            deepest->height - contact_pair->radius < *gap) {
            profile->deepest = regions[i].deepest;
            *gap = deepest->height - contact_pair->radius;
        }
    }
}

/* Gap and regions with the sides that are kept; CONTACT_... */
static int find_regions(struct contact_pair *contact_pair, const struct warm_start *warm_starts,
                        uint32_t warm_start_count, struct region regions[REGION_MAX],
                        uint32_t *count, double *gap)
{
    struct dpt_world *world = contact_pair->world;
    struct distance_profile *profile = contact_pair->profile;
    profile->work = work_of(work_left(&world->work));
    int found = dpti_contact_find(profile, &contact_pair->nearest, warm_starts, warm_start_count,
                                  contact_pair->radius, gap);
    *count = 0;
    if (found == CONTACT_PROFILE && world->def.max_contacts) {
        /* Integrals leave half to the segments that come after: their gaps count for more. */
        if (world->def.budget && world->segment_count > 1)
            profile->work.limit -= work_left(&profile->work) / 2;
        *count = dpti_contact_regions(profile, regions);
        take_deepest(contact_pair, regions, *count, gap);
        /* Where each sample has a side of its own, what is deepest is found with the regions. */
        if (profile->is_cut && profile_has_side_per_sample(profile))
            found = CONTACT_UNKNOWN;
    }
    work_spend(&world->work, profile->work.done);
    return found;
}

int dpti_contact_pair_find(struct contact_pair *contact_pair, double *gap)
{
    struct dpt_world *world = contact_pair->world;
    struct distance_profile *profile = contact_pair->profile;
    struct warm_start warm_starts[PROFILE_WARM_STARTS];
    struct region regions[REGION_MAX];
    uint32_t warm_start_count = load_warm_starts(contact_pair, warm_starts), count;
    profile->surface = &contact_pair->body->surface;
    profile->kernel = &world->kernel;
    profile->axis = &contact_pair->axis;
    profile->sides = &contact_pair->sides;
    profile->point_cache = world->def.budget ? &world->point_cache : NULL;
    profile->contacts_wanted = world->def.max_contacts && !world->def.budget;
    profile->body = handle_index(contact_pair->body->id);
    profile->reach = contact_pair->radius + (world->def.max_contacts ? world->def.margin : 0.0);
    profile->tolerance = PROFILE_DEPTH_SHARE * dpti_surface_diagonal(profile->surface);
    int found = find_regions(contact_pair, warm_starts, warm_start_count, regions, &count, gap);
    int dropped = found == CONTACT_PROFILE && dpti_sheet_drop_sides(contact_pair, regions, count);
    if (dropped)
        found = find_regions(contact_pair, warm_starts, warm_start_count, regions, &count, gap);
    if (found == CONTACT_UNKNOWN)
        carry_over_undecided(contact_pair, regions, count, dropped);
    for (uint32_t i = 0; i < count && found != CONTACT_UNKNOWN; i++)
        put_persistent_contact(contact_pair, &regions[i]);
    return found;
}
