/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The distance profile of a segment over a body gives regions. Each becomes a contact, and takes over the id, the
 * side and the samples of last tick's contact that covers the same stretch of the tool.
 */
#include "track/contacts.h"

#include "track/persistent_contacts.h"

/* Regions are for users, and for the force of a bed. */
static int has_regions(const struct contact_pair *contact_pair)
{
    return contact_pair->world->def.max_contacts || contact_pair->bed_depth;
}

static struct depth_samples *depth_samples_of(const struct contact_pair *contact_pair)
{
    return &contact_pair->world->segments[contact_pair->segment_index].depth_samples;
}

static uint32_t load_depth_samples(const struct contact_pair *contact_pair,
                                   struct warm_start warm_starts[PROFILE_WARM_STARTS])
{
    const struct depth_samples *samples = depth_samples_of(contact_pair);
    if (samples->body_id != contact_pair->body->id)
        return 0;
    memcpy(warm_starts, samples->at, samples->count * sizeof *warm_starts);
    return samples->count;
}

/*
 * Read last tick's contacts of the pair: set the sides of its sheets, and fill in where the profile's samples begin.
 * Returns how many warm starts there are.
 */
static uint32_t load_warm_starts(struct contact_pair *contact_pair, struct warm_start warm_starts[PROFILE_WARM_STARTS])
{
    const struct persistent_contacts *last_tick = contacts_last_tick(contact_pair->world);
    uint32_t count = 0;
    contact_pair->sides.count = 0;
    if (!has_regions(contact_pair))
        return load_depth_samples(contact_pair, warm_starts);
    for (uint32_t i = 0; i < last_tick->count; i++) {
        const struct persistent_contact *persistent = &last_tick->items[i];
        if (!persistent_contact_is_of(persistent, contact_pair->segment_index, contact_pair->body))
            continue;
        for (uint32_t k = 0; k < persistent->warm_start_count && count < PROFILE_WARM_STARTS; k++)
            warm_starts[count++] = persistent->warm_starts[k];
        /*
         * An axis that was in front and has crossed nothing is still in front, also if it went round a border: its
         * side is taken anew.
         */
        if (persistent->side && !persistent->is_in_front)
            dpti_sides_put(&contact_pair->sides, persistent->part, persistent->side);
    }
    return count;
}

/* The length, in s, that a contact and a region have in common; negative if there is a gap between them. */
static double shared_length(const struct persistent_contact *persistent, const struct region *region)
{
    return min_of(persistent->contact.s1, region->to) - max_of(persistent->contact.s0, region->from);
}

/*
 * The contact of the last tick that a region continues: the one on the same part that shares the longest stretch with
 * it, and that no other region of this tick continues. NULL if there is none.
 */
static const struct persistent_contact *find_previous(const struct contact_pair *contact_pair,
                                                      const struct region *region)
{
    const struct persistent_contacts *last_tick = contacts_last_tick(contact_pair->world),
                                     *this_tick = contacts_this_tick(contact_pair->world);
    const struct persistent_contact *best = NULL;
    for (uint32_t i = 0; i < last_tick->count; i++) {
        const struct persistent_contact *persistent = &last_tick->items[i];
        int is_excluded = !persistent_contact_is_of(persistent, contact_pair->segment_index, contact_pair->body) ||
                          persistent->part != region->part || shared_length(persistent, region) < 0.0;
        for (uint32_t k = 0; k < this_tick->count && !is_excluded; k++)
            is_excluded = this_tick->items[k].contact.id == persistent->contact.id;
        if (!is_excluded && (!best || shared_length(persistent, region) > shared_length(best, region)))
            best = persistent;
    }
    return best;
}

/* Whether the axis crosses the surface within a region. */
static int has_crossing(const struct distance_profile *profile, const struct region *region)
{
    for (uint32_t k = 0; k < profile->crossing_count; k++)
        if (profile->crossing[k].s >= region->from && profile->crossing[k].s <= region->to)
            return 1;
    return 0;
}

/* Fill in a contact as users get it: in the world, with source numbers. */
static void write_contact(const struct contact_pair *contact_pair, const struct region *region,
                          const struct persistent_contact *persistent, dpt_contact *contact)
{
    const struct frame *frame = &contact_pair->body->frame;
    const struct axis *axis = &contact_pair->axis;
    const struct profile_sample *deepest = &contact_pair->profile->sample[region->deepest];
    const struct segment *segment = &contact_pair->world->segments[contact_pair->segment_index];
    vec3 p = along(axis->a, deepest->s, sub(axis->b, axis->a));
    contact->size = sizeof *contact;
    contact->body = contact_pair->body->id;
    contact->segment = contact_pair->segment_index - contact_pair->world->tools[segment->tool_slot].first_segment;
    contact->triangle = contact_pair->body->surface.sources[deepest->triangle];
    contact->gap = deepest->height - contact_pair->radius;
    contact->contact = dpti_contact_of_gap(contact->gap, axis->error);
    contact->flags = (has_crossing(contact_pair->profile, region) ? DPT_CONTACT_FLAG_CROSSING : 0u) |
                     (persistent->side ? DPT_CONTACT_FLAG_SIDED : 0u) |
                     (contact_pair->profile->is_coarse ? DPT_CONTACT_FLAG_COARSE : 0u);
    contact->s0 = region->from;
    contact->s1 = region->to;
    contact->s = deepest->s;
    vec3_store(p, contact->p);
    vec3_store(sub(p, frame_turn(frame, deepest->gap)), contact->q);
    uint32_t smooth = contact_pair->world->def.smooth_normals;
    vec3_store(frame_turn(frame, dpti_contact_normal(contact_pair->profile, deepest, smooth)), contact->normal);
    memcpy(contact->weight, deepest->weight, sizeof contact->weight);
    contact->square = region->beyond_onset.square;
    for (int e = 0; e < 2; e++) {
        /* Between two samples it is an estimate; nothing of the region is deeper than its deepest sample. */
        contact->end_gap[e] = max_of(contact->gap, contact_pair->profile->margin - region->end_within[e]);
        vec3_store(frame_turn(frame, region->end_normal[e]), contact->end_normal[e]);
    }
    contact->overlap = region->beyond_onset.overlap;
    contact->moment = region->beyond_onset.moment;
    vec3_store(frame_turn(frame, region->beyond_onset.thrust), contact->thrust);
    vec3_store(frame_turn(frame, region->beyond_onset.thrust_moment), contact->thrust_moment);
}

/* With a budget: whether the axis is known to rest in the frame of the body. */
static int is_resting(const struct contact_pair *contact_pair)
{
    const struct dpt_world *world = contact_pair->world;
    uint32_t last_body_slot = world->segments[contact_pair->segment_index].last_body_slot;
    if (!world->def.budget ||
        world_distance_bound(world, contact_pair->segment_index, last_body_slot)->rest_tick != world->ticks)
        return 0;
    const struct body *body = &world->bodies[last_body_slot];
    return contact_pair->body == body ||
           (body->moved_tick != world->ticks && contact_pair->body->moved_tick != world->ticks);
}

/*
 * Set the samples with which the next tick begins. A resting axis keeps those of last tick: then it asks for the same
 * points, and the point cache knows more of them in each tick.
 */
static void put_warm_starts(const struct contact_pair *contact_pair, const struct region *region,
                            const struct persistent_contact *previous, struct persistent_contact *persistent)
{
    if (!is_resting(contact_pair)) {
        persistent->warm_start_count =
            dpti_contact_region_warm_starts(contact_pair->profile, region, persistent->warm_starts, WARM_STARTS_MAX);
    } else if (previous) {
        persistent->warm_start_count = previous->warm_start_count;
        memcpy(persistent->warm_starts, previous->warm_starts, sizeof persistent->warm_starts);
    }
}

/* Add a region to this tick's contacts. */
static void put_persistent_contact(struct contact_pair *contact_pair, const struct region *region)
{
    const struct persistent_contact *previous = find_previous(contact_pair, region);
    struct persistent_contact *persistent = dpti_persistent_contacts_add(contact_pair->world);
    if (!persistent)
        return;
    memset(persistent, 0, sizeof *persistent);
    persistent->segment_index = contact_pair->segment_index;
    persistent->part = region->part;
    persistent->is_in_front = contact_pair->profile->sample[region->deepest].height > 0.0;
    persistent->side = dpti_sheet_side_to_keep(
        contact_pair, region, contact_pair->profile->sample[region->deepest].height - contact_pair->radius);
    put_warm_starts(contact_pair, region, previous, persistent);
    persistent->contact.id = previous ? previous->contact.id : dpti_persistent_contacts_new_id(contact_pair->world);
    write_contact(contact_pair, region, persistent, &persistent->contact);
}

/*
 * Update the samples of a contact that is carried over: those of the region that it may have become. Where the budget
 * ended before there were regions, the lowest sample is put first. With the old samples, the search would begin where
 * the tool once was. If the budget ends it each time, it would never come to where the tool is now, and behind a
 * sheet the surface would not be found at all.
 */
static void update_warm_starts(const struct contact_pair *contact_pair, const struct region *regions, uint32_t count,
                               struct persistent_contact *persistent)
{
    const struct profile_sample *lowest = dpti_profile_lowest_on(contact_pair->profile, persistent->part);
    const struct region *best = NULL;
    for (uint32_t k = 0; k < count; k++)
        if (regions[k].part == persistent->part &&
            (!best || shared_length(persistent, &regions[k]) > shared_length(persistent, best)))
            best = &regions[k];
    if (best)
        persistent->warm_start_count =
            dpti_contact_region_warm_starts(contact_pair->profile, best, persistent->warm_starts, WARM_STARTS_MAX);
    else if (lowest) {
        const struct warm_start start = { lowest->s, lowest->triangle, 1.0f };
        dpti_persistent_contact_put_warm_start(persistent, &start);
    }
}

/* Carry over last tick's contacts of a pair whose contact is unknown in this tick. */
static void carry_over_undecided(struct contact_pair *contact_pair, const struct region *regions, uint32_t count,
                                 int has_dropped_side)
{
    const struct persistent_contacts *last_tick = contacts_last_tick(contact_pair->world);
    for (uint32_t i = 0; i < last_tick->count; i++) {
        struct persistent_contact *persistent = &last_tick->items[i];
        if (!persistent_contact_is_of(persistent, contact_pair->segment_index, contact_pair->body))
            continue;
        if (has_dropped_side && !dpti_sides_get(&contact_pair->sides, persistent->part))
            persistent->side = 0;
        dpti_sheet_update_side(contact_pair, persistent);
        if (!is_resting(contact_pair))
            update_warm_starts(contact_pair, regions, count, persistent);
        dpti_persistent_contacts_carry_over_one(contact_pair->world, persistent);
    }
}

/*
 * Lower the gap to the deepest sample of the regions. Where each sample has a side of its own, surface between the
 * samples of the depth may be deeper, and the regions have more samples.
 */
static void update_deepest(struct contact_pair *contact_pair, const struct region *regions, uint32_t count, double *gap)
{
    struct distance_profile *profile = contact_pair->profile;
    for (uint32_t i = 0; i < count; i++) {
        const struct profile_sample *deepest = &profile->sample[regions[i].deepest];
        if (deepest->height < 0.0 && deepest->is_exact && deepest->height - contact_pair->radius < *gap) {
            profile->deepest = regions[i].deepest;
            *gap = deepest->height - contact_pair->radius;
        }
    }
}

/* Add a region to what the tool's law needs. */
static void add_bed_depth(const struct contact_pair *contact_pair, const struct region *region)
{
    struct bed_depth *depth = contact_pair->bed_depth;
    const struct frame *frame = &contact_pair->body->frame;
    if (!depth)
        return;
    const vec3 u = frame_turn(frame, contact_pair->axis.u);
    depth->square += region->depth.square;
    depth->thrust = add(depth->thrust, frame_turn(frame, region->depth.thrust));
    depth->moment = add(depth->moment, cross(u, frame_turn(frame, region->depth.thrust_moment)));
}

/* Add the depth at the segment's ends, where samples are if they are within reach. */
static void add_bed_ends(const struct contact_pair *contact_pair)
{
    struct bed_depth *depth = contact_pair->bed_depth;
    const struct distance_profile *profile = contact_pair->profile;
    for (int e = 0; e < 2 && depth; e++) {
        const struct profile_sample *sample = &profile->sample[e ? profile->sample_count - 1 : 0];
        const double w = contact_pair->radius - sample->height;
        if (sample->s != (double)e || sample->triangle == DPT_NONE || !(w > 0.0))
            continue;
        depth->end_square[e] += w * w;
        depth->end_thrust[e] = along(depth->end_thrust[e], w, frame_turn(&contact_pair->body->frame, sample->normal));
    }
}

/*
 * Keep the samples inside. One between two others with its own triangle tells nothing: the distance to a triangle is
 * convex along the axis. Those at crossings are found with the crossings.
 */
static void keep_depth_samples(const struct contact_pair *contact_pair)
{
    const struct distance_profile *profile = contact_pair->profile;
    struct depth_samples *samples = depth_samples_of(contact_pair);
    samples->body_id = contact_pair->body->id;
    samples->count = 0;
    for (uint32_t i = 0; i < profile->sample_count && samples->count < DEPTH_SAMPLES_MAX; i++) {
        const struct profile_sample *sample = &profile->sample[i];
        const int is_between = i && i + 1 < profile->sample_count && sample[-1].triangle == sample->triangle &&
                               sample[1].triangle == sample->triangle;
        if (sample->height < 0.0 && !is_between)
            samples->at[samples->count++] = (struct warm_start){ sample->s, sample->triangle, 0.0f };
    }
}

/* Find gap (m) and regions with the pair's present sides. Returns CONTACT_...; regions need a profile. */
static int find_gap_and_regions(struct contact_pair *contact_pair, const struct warm_start *warm_starts,
                                uint32_t warm_start_count, struct region regions[REGION_MAX], uint32_t *count,
                                double *gap)
{
    struct dpt_world *world = contact_pair->world;
    struct distance_profile *profile = contact_pair->profile;
    profile->work = work_of(work_left(&world->work));
    int status =
        dpti_contact_find(profile, &contact_pair->nearest, warm_starts, warm_start_count, contact_pair->radius, gap);
    *count = 0;
    if (status == CONTACT_PROFILE && has_regions(contact_pair)) {
        /* Leave half of the work to the segments that come after: their gaps matter more than these integrals. */
        if (world->def.budget && world->segment_count > 1)
            profile->work.limit -= work_left(&profile->work) / 2;
        *count = dpti_contact_regions(profile, regions);
        update_deepest(contact_pair, regions, *count, gap);
        /* With sides by sample, the deepest one is found with the regions: without all regions it is not known. */
        if (profile->is_cut && profile_has_side_per_sample(profile))
            status = CONTACT_UNKNOWN;
    }
    work_spend(&world->work, profile->work.done);
    return status;
}

/*
 * Whether the work left is twice what the last tick took: then this one is done at once. Otherwise the depth goes
 * first, and the point cache keeps what is found for later ticks. At rest these continue there.
 */
static int has_ample_work(const struct contact_pair *contact_pair)
{
    const struct dpt_world *world = contact_pair->world;
    const uint32_t last = world->segments[contact_pair->segment_index].contact_work;
    return !world->def.budget || (last && !is_resting(contact_pair) && 2 * (uint64_t)last <= work_left(&world->work));
}

/*
 * Find the contact of a pair whose `world`, `body`, `segment_index`, `radius`, `axis`, `nearest` and `profile` are
 * set. Puts its contacts into the world's list for this tick, or carries over last tick's where the contact is
 * unknown. Returns CONTACT_...; with CONTACT_PROFILE, `*gap` is the segment's gap over this body, in m.
 */
static int find_pair_contacts(struct contact_pair *contact_pair, double *gap)
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
    const int is_ample = has_ample_work(contact_pair);
    profile->point_cache = is_ample ? NULL : &world->point_cache;
    profile->contacts_wanted = has_regions(contact_pair) && is_ample;
    profile->ends_wanted = contact_pair->bed_depth != NULL;
    profile->body = handle_index(contact_pair->body->id);
    profile->margin = has_regions(contact_pair) ? world->def.margin : 0.0;
    profile->inset = world->def.onset >= 0.0 ? max_of(0.0, profile->margin - world->def.onset) : 0.0;
    profile->reach = contact_pair->radius + profile->margin;
    profile->tolerance = PROFILE_DEPTH_SHARE * surface_diagonal(profile->surface);
    int status = find_gap_and_regions(contact_pair, warm_starts, warm_start_count, regions, &count, gap);
    int has_dropped_side = status == CONTACT_PROFILE && dpti_sheet_drop_sides(contact_pair, regions, count);
    if (has_dropped_side)
        status = find_gap_and_regions(contact_pair, warm_starts, warm_start_count, regions, &count, gap);
    if (status == CONTACT_UNKNOWN)
        carry_over_undecided(contact_pair, regions, count, has_dropped_side);
    for (uint32_t i = 0; i < count && status != CONTACT_UNKNOWN; i++) {
        put_persistent_contact(contact_pair, &regions[i]);
        add_bed_depth(contact_pair, &regions[i]);
    }
    if (count && status != CONTACT_UNKNOWN)
        add_bed_ends(contact_pair);
    if (!has_regions(contact_pair) && status == CONTACT_PROFILE && !is_resting(contact_pair))
        keep_depth_samples(contact_pair);
    return status;
}

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
        world_last_triangle(world, contact_pair->segment_index, handle_index(contact_pair->body->id));
    if (work_is_spent(&world->work))
        return 0;
    axis_of(surface, &contact_pair->body->frame, a, b, &contact_pair->axis);
    *nearest =
        (struct pair_search){ .pair = dpti_triangle_pair(surface, *last_triangle == DPT_NONE ? 0 : *last_triangle,
                                                         axis->local_a, axis->u),
                              .triangle = *last_triangle == DPT_NONE ? 0 : *last_triangle };
    int is_done = dpti_bvh_search(surface, &world->kernel, axis->local_a, axis->u, &world->work, nearest);
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
        status = find_pair_contacts(contact_pair, &gap);
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
    struct distance_profile *profile = contact_pair->profile;
    const struct frame *frame = &contact_pair->body->frame;
    double depth = max_of(0.0, -gap);
    struct penetration penetration =
        dpti_contact_penetration(profile, frame, &profile->sample[profile->deepest], depth, smooth);
    double felt_gap = gap;
    if (gap < sum->min_gap) {
        sum->penetration = penetration;
        sum->min_gap = gap;
    }
    if (pushing_part.is_behind_sheet && !(penetration.depth <= -sum->min_felt_gap)) {
        struct profile_sample pushed;
        if (dpti_sheet_border_reduce(profile, pushing_part.body_id, contact_pair->radius, &segment->border, &depth,
                                     &pushed)) {
            const struct warm_start warm_start = { pushed.s, pushed.triangle, 1.0f };
            penetration = dpti_contact_penetration(profile, frame, &pushed, depth, smooth);
            carry_over_pushed_point(contact_pair, pushing_part.part, &warm_start);
        }
        felt_gap = -depth;
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
