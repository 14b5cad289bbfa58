/* SPDX-License-Identifier: BSD-3-Clause */
#include "world/world_state.h"

static struct box box_in_world(vec3 low, vec3 high, const struct frame *frame)
{
    vec3 half = scaled(sub(high, low), 0.5);
    vec3 centre = frame_to_world(frame, scaled(add(low, high), 0.5));
    double slop = 0x1p-46 * (extent_of(centre) + extent_of(low) + extent_of(high));
    vec3 wide = {
        fabs(frame->x.x) * half.x + fabs(frame->y.x) * half.y + fabs(frame->z.x) * half.z + slop,
        fabs(frame->x.y) * half.x + fabs(frame->y.y) * half.y + fabs(frame->z.y) * half.z + slop,
        fabs(frame->x.z) * half.x + fabs(frame->y.z) * half.y + fabs(frame->z.z) * half.z + slop,
    };
    return (struct box){ sub(centre, wide), add(centre, wide) };
}

void dpti_near_move(struct near *near, vec3 a, vec3 b)
{
    /* Forgotten within some hundred ticks: a list should not be made anew at each stop. */
    near->speed *= 1.0 - 1.0 / 256.0;
    if (near->known) {
        double motion = max_of(length(sub(a, near->a)), length(sub(b, near->b)));
        near->speed = max_of(near->speed, motion);
    }
    near->a = a;
    near->b = b;
    near->known = 1;
}

static double reach_of(const struct near *near)
{
    struct box axis = box_of_axis(near->a, near->b);
    const struct box *home = &near->now.box;
    if (!(near->now.margin > 0.0))
        return 0.0;
    double least = min_of(axis.low.x - home->low.x, home->high.x - axis.high.x);
    least = min_of(least, min_of(axis.low.y - home->low.y, home->high.y - axis.high.y));
    least = min_of(least, min_of(axis.low.z - home->low.z, home->high.z - axis.high.z));
    return max_of(0.0, least);
}

/* Those within `reach` are on the list. Where the axis is not within a home, not even those that it touches. */
static int is_listed(const struct near *near, double reach)
{
    return reach_of(near) > 0.0 && reach_of(near) >= reach;
}

/* Room for 128 ticks of the present motion, and for some that begins from rest. */
static double wanted(const struct near *near, double distance)
{
    double size = length(sub(near->b, near->a));
    return distance + 0.125 * (distance + size) + 128.0 * near->speed;
}

static int is_wide(const struct near *near, double distance)
{
    return near->now.margin > 4.0 * wanted(near, distance);
}

static void begin_rebuild(struct near *near, double distance)
{
    struct box axis = box_of_axis(near->a, near->b);
    double room = wanted(near, distance);
    vec3 all = { room, room, room };
    near->rebuilt = (struct fat_box){ .box = { sub(axis.low, all), add(axis.high, all) },
                                      .margin = room,
                                      .which = 1 - near->now.which };
    near->scanning = 1;
    near->scanned = 0;
}

static void finish_rebuild(struct near *near)
{
    near->now = near->rebuilt;
    near->scanning = 0;
}

uint64_t dpti_near_bytes(const dpt_world_def *def)
{
    return mesh_aligned(8 * (uint64_t)def->max_segments * def->max_bodies);
}

char *dpti_near_place(struct dpt_world *world, char *at)
{
    world->near = (void *)at;
    return at + dpti_near_bytes(&world->def);
}

void dpti_near_forget(struct dpt_world *world, uint32_t segment)
{
    memset(&world->segments[segment].near, 0, sizeof world->segments[segment].near);
}

void dpti_near_remove(struct dpt_world *world, uint32_t first, uint32_t end)
{
    memmove(world_near(world, first, 0), world_near(world, end, 0),
            (world->segment_count - end) * 2 * (size_t)world->def.max_bodies * sizeof *world->near);
}

/* In the order of slots. */
static void put_on_list(const struct dpt_world *world, uint32_t segment, struct fat_box *fat,
                        uint32_t index)
{
    uint32_t *list = world_near(world, segment, fat->which), at = fat->listed;
    while (at > 0 && list[at - 1] > index)
        at--;
    if (at > 0 && list[at - 1] == index)
        return;
    memmove(list + at + 1, list + at, (fat->listed - at) * sizeof *list);
    list[at] = index;
    fat->listed++;
}

/* Go on with the list of the next home. */
static void scan(struct dpt_world *world, uint32_t segment)
{
    struct near *near = &world->segments[segment].near;
    struct fat_box *fat = &near->rebuilt;
    uint32_t *list = world_near(world, segment, fat->which);
    while (near->scanned < world->body_end && !work_is_spent(&world->work)) {
        work_spend(&world->work, 1);
        for (int i = 0; i < LANES && near->scanned < world->body_end; i++) {
            uint32_t index = near->scanned++;
            if (world->bodies[index].slot.used && box_meets(&fat->box, &world->boxes[index]))
                list[fat->listed++] = index;
        }
    }
    if (near->scanned == world->body_end)
        finish_rebuild(near);
}

double dpti_near_list(struct dpt_world *world, uint32_t segment, double distance)
{
    struct near *near = &world->segments[segment].near;
    if (!near->scanning && !(near->now.margin > 0.0 && reach_of(near) >= distance))
        begin_rebuild(near, distance);
    if (near->scanning)
        scan(world, segment);
    return reach_of(near);
}

void dpti_near_tidy(struct dpt_world *world, uint32_t segment, double distance)
{
    struct near *near = &world->segments[segment].near;
    uint32_t units = (world->body_end + LANES - 1) / LANES;
    if (!is_wide(near, distance) || work_left(&world->work) < units)
        return;
    begin_rebuild(near, distance);
    scan(world, segment);
}

const struct nearby *dpti_near_within(struct dpt_world *world, uint32_t segment, double reach)
{
    struct near *near = &world->segments[segment].near;
    struct nearby *nearby = &world->nearby;
    if (nearby->reach >= reach)
        return nearby;
    nearby->reach = max_of(reach, world->segments[segment].radius + world->def.margin);
    nearby->list = NULL;
    nearby->count = world->body_end;
    if (world->body_end <= NEAR_FEW || world->def.method != DPT_METHOD_EXACT)
        return nearby;
    if (!is_listed(near, nearby->reach) && !world->def.budget) {
        begin_rebuild(near, nearby->reach);
        scan(world, segment);
    }
    if (is_listed(near, nearby->reach)) {
        nearby->list = world_near(world, segment, near->now.which);
        nearby->count = near->now.listed;
    }
    return nearby;
}

void dpti_near_put_body(struct dpt_world *world, uint32_t index)
{
    const struct body *body = &world->bodies[index];
    struct box *box = &world->boxes[index];
    *box = box_in_world(body->surface.box_min, body->surface.box_max, &body->frame);
    for (uint32_t s = 0; world->body_end > NEAR_FEW && s < world->segment_count; s++) {
        struct near *near = &world->segments[s].near;
        if (near->now.margin > 0.0 && box_meets(&near->now.box, box))
            put_on_list(world, s, &near->now, index);
        if (near->scanning && index < near->scanned && box_meets(&near->rebuilt.box, box))
            put_on_list(world, s, &near->rebuilt, index);
    }
}
