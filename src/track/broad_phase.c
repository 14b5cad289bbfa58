/* SPDX-License-Identifier: BSD-3-Clause */
#include "track/world_state.h"

/* The world box of a body's box low..high (body's frame), larger than rounding could require. */
static struct box box_in_world(vec3 low, vec3 high, const struct frame *frame)
{
    vec3 half = scaled(sub(high, low), 0.5);
    vec3 centre = frame_to_world(frame, scaled(add(low, high), 0.5));
    double rounding = 0x1p-46 * (extent_of(centre) + extent_of(low) + extent_of(high));
    vec3 half_in_world = {
        fabs(frame->x.x) * half.x + fabs(frame->y.x) * half.y + fabs(frame->z.x) * half.z + rounding,
        fabs(frame->x.y) * half.x + fabs(frame->y.y) * half.y + fabs(frame->z.y) * half.z + rounding,
        fabs(frame->x.z) * half.x + fabs(frame->y.z) * half.y + fabs(frame->z.z) * half.z + rounding,
    };
    return (struct box){ sub(centre, half_in_world), add(centre, half_in_world) };
}

void dpti_broad_phase_move(struct broad_phase *broad_phase, vec3 a, vec3 b)
{
    /* A peak fades over some hundred ticks, so that a short stop does not cause a new list. */
    broad_phase->speed *= 1.0 - 1.0 / 256.0;
    if (broad_phase->has_axis) {
        double motion = max_of(length(sub(a, broad_phase->a)), length(sub(b, broad_phase->b)));
        broad_phase->speed = max_of(broad_phase->speed, motion);
    }
    broad_phase->a = a;
    broad_phase->b = b;
    broad_phase->has_axis = 1;
}

/* The distance from the axis to the nearest face of its fat box; 0 outside of it, or where there is none. */
static double reach_of_fat_box(const struct broad_phase *broad_phase)
{
    struct box axis_box = box_of_axis(broad_phase->a, broad_phase->b);
    const struct box *fat = &broad_phase->current.box;
    if (!(broad_phase->current.margin > 0.0))
        return 0.0;
    double margin = min_of(axis_box.low.x - fat->low.x, fat->high.x - axis_box.high.x);
    margin = min_of(margin, min_of(axis_box.low.y - fat->low.y, fat->high.y - axis_box.high.y));
    margin = min_of(margin, min_of(axis_box.low.z - fat->low.z, fat->high.z - axis_box.high.z));
    return max_of(0.0, margin);
}

/* Whether all bodies within `reach` are on the list. Outside of its fat box an axis may touch bodies that are not. */
static int has_reach(const struct broad_phase *broad_phase, double reach)
{
    return reach_of_fat_box(broad_phase) > 0.0 && reach_of_fat_box(broad_phase) >= reach;
}

/* The margin of a new fat box: 128 ticks of the present motion, and some for a motion that begins from rest. */
static double fat_margin_for(const struct broad_phase *broad_phase, double distance)
{
    double axis_length = length(sub(broad_phase->b, broad_phase->a));
    return distance + 0.125 * (distance + axis_length) + 128.0 * broad_phase->speed;
}

static int is_too_wide(const struct broad_phase *broad_phase, double distance)
{
    return broad_phase->current.margin > 4.0 * fat_margin_for(broad_phase, distance);
}

static void begin_rebuild(struct broad_phase *broad_phase, double distance)
{
    struct box axis_box = box_of_axis(broad_phase->a, broad_phase->b);
    double margin = fat_margin_for(broad_phase, distance);
    vec3 margins = { margin, margin, margin };
    broad_phase->rebuilt = (struct fat_box){ .box = { sub(axis_box.low, margins), add(axis_box.high, margins) },
                                             .margin = margin,
                                             .list = 1 - broad_phase->current.list };
    broad_phase->is_scanning = 1;
    broad_phase->next_slot = 0;
}

static void finish_rebuild(struct broad_phase *broad_phase)
{
    broad_phase->current = broad_phase->rebuilt;
    broad_phase->is_scanning = 0;
}

uint64_t dpti_broad_phase_bytes(const dpt_world_def *def)
{
    return mesh_aligned(8 * (uint64_t)def->max_segments * def->max_bodies);
}

char *dpti_broad_phase_place(struct dpt_world *world, char *at)
{
    world->near_lists = (void *)at;
    return at + dpti_broad_phase_bytes(&world->def);
}

void dpti_broad_phase_forget(struct dpt_world *world, uint32_t segment_index)
{
    memset(&world->segments[segment_index].broad_phase, 0, sizeof world->segments[segment_index].broad_phase);
}

void dpti_broad_phase_remove(struct dpt_world *world, uint32_t first, uint32_t end)
{
    memmove(world_near_list(world, first, 0), world_near_list(world, end, 0),
            (world->segment_count - end) * 2 * (size_t)world->def.max_bodies * sizeof *world->near_lists);
}

/* Put a body on a list, which is in the order of slots; once. */
static void insert_slot(const struct dpt_world *world, uint32_t segment_index, struct fat_box *fat_box, uint32_t slot)
{
    uint32_t *list = world_near_list(world, segment_index, fat_box->list), at = fat_box->count;
    while (at > 0 && list[at - 1] > slot)
        at--;
    if (at > 0 && list[at - 1] == slot)
        return;
    memmove(list + at + 1, list + at, (fat_box->count - at) * sizeof *list);
    list[at] = slot;
    fat_box->count++;
}

/* Continue the list of the rebuilt fat box, within the budget; at its end it becomes the current one. */
static void continue_scan(struct dpt_world *world, uint32_t segment_index)
{
    struct broad_phase *broad_phase = &world->segments[segment_index].broad_phase;
    struct fat_box *fat_box = &broad_phase->rebuilt;
    uint32_t *list = world_near_list(world, segment_index, fat_box->list);
    while (broad_phase->next_slot < world->body_slot_end && !work_is_spent(&world->work)) {
        work_spend(&world->work, 1);
        for (int i = 0; i < LANES && broad_phase->next_slot < world->body_slot_end; i++) {
            uint32_t slot = broad_phase->next_slot++;
            if (body_is_there(&world->bodies[slot]) && box_meets(&fat_box->box, &world->boxes[slot]))
                list[fat_box->count++] = slot;
        }
    }
    if (broad_phase->next_slot == world->body_slot_end)
        finish_rebuild(broad_phase);
}

double dpti_broad_phase_update(struct dpt_world *world, uint32_t segment_index, double distance)
{
    struct broad_phase *broad_phase = &world->segments[segment_index].broad_phase;
    if (!broad_phase->is_scanning && !(broad_phase->current.margin > 0.0 && reach_of_fat_box(broad_phase) >= distance))
        begin_rebuild(broad_phase, distance);
    if (broad_phase->is_scanning)
        continue_scan(world, segment_index);
    return reach_of_fat_box(broad_phase);
}

void dpti_broad_phase_shrink(struct dpt_world *world, uint32_t segment_index, double distance)
{
    struct broad_phase *broad_phase = &world->segments[segment_index].broad_phase;
    uint32_t scan_units = (world->body_slot_end + LANES - 1) / LANES;
    if (!is_too_wide(broad_phase, distance) || work_left(&world->work) < scan_units)
        return;
    begin_rebuild(broad_phase, distance);
    continue_scan(world, segment_index);
}

const struct near_bodies *dpti_broad_phase_within(struct dpt_world *world, uint32_t segment_index, double reach)
{
    struct broad_phase *broad_phase = &world->segments[segment_index].broad_phase;
    struct near_bodies *near_bodies = &world->near_bodies;
    if (near_bodies->reach >= reach)
        return near_bodies;
    near_bodies->reach = max_of(reach, world->segments[segment_index].radius + world->def.margin);
    near_bodies->slots = NULL;
    near_bodies->count = world->body_slot_end;
    if (world->body_slot_end <= UNLISTED_BODIES_MAX || world->def.method != DPT_METHOD_EXACT)
        return near_bodies;
    if (!has_reach(broad_phase, near_bodies->reach) && !world->def.budget) {
        begin_rebuild(broad_phase, near_bodies->reach);
        continue_scan(world, segment_index);
    }
    if (has_reach(broad_phase, near_bodies->reach)) {
        near_bodies->slots = world_near_list(world, segment_index, broad_phase->current.list);
        near_bodies->count = broad_phase->current.count;
    }
    return near_bodies;
}

void dpti_broad_phase_put_body(struct dpt_world *world, uint32_t slot)
{
    const struct body *body = &world->bodies[slot];
    struct box *box = &world->boxes[slot];
    *box = box_in_world(body->surface.box_min, body->surface.box_max, &body->frame);
    for (uint32_t s = 0; world->body_slot_end > UNLISTED_BODIES_MAX && s < world->segment_count; s++) {
        struct broad_phase *broad_phase = &world->segments[s].broad_phase;
        if (broad_phase->current.margin > 0.0 && box_meets(&broad_phase->current.box, box))
            insert_slot(world, s, &broad_phase->current, slot);
        if (broad_phase->is_scanning && slot < broad_phase->next_slot && box_meets(&broad_phase->rebuilt.box, box))
            insert_slot(world, s, &broad_phase->rebuilt, slot);
    }
}
