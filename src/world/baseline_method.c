/* SPDX-License-Identifier: BSD-3-Clause */
#include "world/baseline_method.h"

#include "contact/gap.h"
#include "nearest/dynamic_point.h"
#include "track/tool_parts.h"

/* How many part triangles one segment has. */
static size_t triangles_a_segment(const dpt_world_def *def)
{
    return (size_t)def->max_bodies * def->baseline->parts;
}

/* Those of a segment on the body in a slot: one for each part. */
static uint32_t *part_triangles(const struct dpt_world *world, uint32_t segment_index, uint32_t slot)
{
    return world->part_triangles + triangles_a_segment(&world->def) * segment_index +
           (size_t)slot * world->def.baseline->parts;
}

uint64_t dpti_baseline_bytes(const dpt_world_def *def)
{
    const uint64_t triangles = (uint64_t)def->max_segments * def->max_bodies * def->baseline->parts;
    return def->method == DPT_METHOD_PAPER ? mesh_aligned(sizeof(uint32_t) * triangles) : 0;
}

char *dpti_baseline_place(struct dpt_world *world, char *at)
{
    world->part_triangles = (void *)at;
    return at + dpti_baseline_bytes(&world->def);
}

void dpti_baseline_forget(struct dpt_world *world, uint32_t first, uint32_t end, uint32_t slot)
{
    const size_t triangles = slot == DPT_NONE ? triangles_a_segment(&world->def) : world->def.baseline->parts;
    for (uint32_t s = first; world->def.method == DPT_METHOD_PAPER && s < end; s++)
        memset(part_triangles(world, s, slot == DPT_NONE ? 0 : slot), 0xff, triangles * sizeof *world->part_triangles);
}

void dpti_baseline_remove(struct dpt_world *world, uint32_t first, uint32_t end)
{
    if (world->def.method == DPT_METHOD_PAPER)
        memmove(part_triangles(world, first, 0), part_triangles(world, end, 0),
                (world->segment_count - end) * triangles_a_segment(&world->def) * sizeof *world->part_triangles);
}

/* What the parts of one segment found, over all bodies. */
struct baseline_sum {
    struct penetration penetration;   /* of the part with the smallest gap */
    struct pushing_part pushing_part; /* where that is */
    int has_answer;
    double min_gap;
    struct body_answer *answer;
    struct segment_result *result;
};

/* Move a part's dynamic point on one body by descent; without a last triangle, find it by a full search. */
static void step_dynamic_point(const struct dpt_world *world, const struct surface *surface, const struct axis *part,
                               uint32_t *last_triangle, struct work *work, struct pair_search *nearest)
{
    *nearest = (struct pair_search){ .pair = { .distance2 = HUGE_VAL }, .triangle = *last_triangle };
    if (*last_triangle == DPT_NONE)
        dpti_bvh_search(surface, &world->kernel, part->local_a, part->u, work, nearest);
    else
        dpti_paper_descend(surface, &world->kernel, part->local_a, part->u, world->def.baseline->one_step != 0, work,
                           nearest);
    *last_triangle = nearest->triangle;
}

static void add_part(struct baseline_sum *sum, const struct dpt_world *world, const struct body *body,
                     uint32_t part_index, const struct axis *part, const struct pair_search *nearest, double radius)
{
    struct penetration penetration;
    double gap = dpti_contact_paper(&body->surface, &body->frame, part, nearest, radius, &penetration);
    double distance = sqrt(nearest->pair.distance2);
    int is_lower = gap < sum->min_gap;
    if (!sum->has_answer || distance < sum->result->distance || (distance == sum->result->distance && is_lower)) {
        dpti_segment_result_of_pair(part, &nearest->pair, sum->result);
        sum->result->s = (part_index + nearest->pair.s) / world->def.baseline->parts;
        sum->answer->body = body;
        sum->answer->track.nearest = *nearest;
    }
    if (!sum->has_answer || is_lower) {
        sum->min_gap = gap;
        sum->penetration = penetration;
        sum->pushing_part =
            (struct pushing_part){ .body_id = penetration.depth > 0.0 ? body->id : 0, .triangle = nearest->triangle };
        sum->has_answer = 1;
    }
}

static void add_body(struct baseline_sum *sum, struct dpt_world *world, uint32_t segment_index, const struct body *body,
                     vec3 a, vec3 u)
{
    uint32_t parts = world->def.baseline->parts;
    uint32_t *last_triangle = part_triangles(world, segment_index, handle_index(body->id));
    for (uint32_t k = 0; k < parts; k++) {
        struct axis part;
        struct pair_search nearest;
        axis_of(&body->surface, &body->frame, along(a, (double)k / parts, u), along(a, (double)(k + 1) / parts, u),
                &part);
        step_dynamic_point(world, &body->surface, &part, &last_triangle[k], &world->work, &nearest);
        if (nearest.triangle != DPT_NONE)
            add_part(sum, world, body, k, &part, &nearest, world->segments[segment_index].radius);
    }
}

/* The penetration (world) of the part with the smallest gap; zero without a body. */
static struct penetration find(struct dpt_world *world, uint32_t segment_index, vec3 a, vec3 b)
{
    struct segment *segment = &world->segments[segment_index];
    struct body_answer *answer = &segment->answer;
    struct segment_result *result = &segment->result;
    struct baseline_sum sum = { .answer = answer, .result = result };
    const uint32_t work_before = world->work.done;
    vec3 u = sub(b, a);
    for (uint32_t i = 0; i < world->body_slot_end; i++)
        if (body_is_there(&world->bodies[i]))
            add_body(&sum, world, segment_index, &world->bodies[i], a, u);
    if (!sum.has_answer)
        return sum.penetration;

    axis_of(&answer->body->surface, &answer->body->frame, a, b, &answer->track.axis);
    /* A search without proof knows only that the distance lies between 0 and what was found. */
    double rounding = result->error_bound;
    result->work = world->work.done - work_before;
    result->status = DPT_STATUS_LOCAL;
    result->error_bound = result->distance + rounding;
    result->lower_bound = 0.0;
    if (world->def.until != DPT_UNTIL_TRACK)
        dpti_segment_result_set_gap(result, sum.min_gap, rounding);
    segment->pushing_part = sum.pushing_part;
    return sum.penetration;
}

void dpti_baseline_track(struct dpt_world *world, uint32_t segment_index)
{
    struct segment *segment = &world->segments[segment_index];
    const struct frame *frame = &world->tools[segment->tool_slot].felt_frame;
    if (!dpti_track_begin(world, segment_index))
        return;
    segment->felt_penetration = segment->penetration =
        find(world, segment_index, frame_to_world(frame, segment->a), frame_to_world(frame, segment->b));
}
