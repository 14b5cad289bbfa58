/* SPDX-License-Identifier: BSD-3-Clause */
#include "base/return_if_error.h"
#include "base/sized.h"
#include "world/body_search.h"
#include "world/distance_bounds.h"
#include "world/motion_backlog.h"
#include "world/persistent_contacts.h"
#include "world/proxy_step.h"
#include "world/tool_force.h"
#include "world/tool_strips.h"
#include "world/world_def.h"

/* What the tools' last ticks know of a body. */
static void forget(struct dpt_world *world, uint32_t index)
{
    dpti_contacts_forget(world, 0, world->segment_count, index);
    dpti_point_cache_forget(&world->point_cache, index);
    dpti_strips_forget_body(world, index);
    for (uint32_t s = 0; s < world->segment_count; s++)
        dpti_bounds_forget(world, s, index);
    dpti_backlog_restart(world);
    for (uint32_t s = 0; s < world->segment_count; s++)
        dpti_force_forget_body(&world->segments[s], world->bodies[index].id);
    dpti_proxy_forget_body(world, world->bodies[index].id);
    dpti_bodies_forget_body(world, index);
}

dpt_result dpt_body_add(dpt_world *world, const dpt_mesh *mesh, const dpt_pose *pose,
                        dpt_body *body)
{
    struct frame frame;
    if (!world || !mesh || !body)
        return DPT_E_ARGUMENT;
    DPT_TRY(frame_of_pose(pose, &frame));
    uint32_t index =
        slot_to_use(&world->bodies->slot, sizeof *world->bodies, world->body_end, world->freed[0]);
    if (index == world->def.max_bodies)
        return DPT_E_FULL;
    struct body *made = &world->bodies[index];
    if (index == world->body_end) {
        world->body_end++;
        made->slot.generation = 1;
    }
    made->slot.used = 1;
    made->id = handle_make(HANDLE_BODY, &made->slot, index);
    const dpt_pose identity = DPT_POSE_IDENTITY;
    made->frame = frame;
    made->pose = pose ? *pose : identity;
    made->user = 0;
    made->side_limit = world->def.side_limit;
    made->static_friction = made->kinetic_friction = 0.0;
    made->moved = 0;
    made->added = world->ticks + 1;
    made->slot.valid = 1;
    world_note_max(&world->usage.bodies, ++world->body_count);
    dpti_surface_of_mesh(mesh, &made->surface);
    made->diagonal = dpti_surface_diagonal(&made->surface);
    dpti_near_put_body(world, index);
    *body = made->id;
    return DPT_OK;
}

dpt_result dpt_body_remove(dpt_world *world, dpt_body body)
{
    struct body *old = world ? world_find_body(world, body) : NULL;
    if (!old)
        return world ? DPT_E_HANDLE : DPT_E_ARGUMENT;
    slot_release(&old->slot, &world->freed[0]);
    world->body_count--;
    world->invalid -= !old->slot.valid;
    forget(world, handle_index(body));
    return DPT_OK;
}

/*
 * At most so far has any point of it moved: with the origin, and by the angle around that, which is 4 asin(c / 2), c
 * being how far the quaternions are apart.
 */
static double displacement_of(const struct body *body)
{
    const double *from = body->before.orientation, *to = body->pose.orientation;
    vec3 low = body->surface.box_min, high = body->surface.box_max;
    double farthest = 0.5 * (length(add(low, high)) + length(sub(high, low)));
    double same = 0.0, opposite = 0.0;
    for (int k = 0; k < 4; k++) {
        same += (to[k] - from[k]) * (to[k] - from[k]);
        opposite += (to[k] + from[k]) * (to[k] + from[k]);
    }
    double square = min_of(same, opposite);
    /* Quaternions may be off unit length by 1e-6. */
    double angle = sqrt(square) * (2.0 + 0.3 * square) + 1e-5;
    return length(sub(vec3_of(body->pose.position), vec3_of(body->before.position))) +
           angle * farthest;
}

static void put_body(struct dpt_world *world, struct body *body, const dpt_pose *pose,
                     const struct frame *frame)
{
    body->pose = *pose;
    body->frame = *frame;
    dpti_near_put_body(world, handle_index(body->id));
}

/* Where the body was in the last tick stays known until the next one. */
static void move_body(struct dpt_world *world, struct body *body, const dpt_pose *pose,
                      const struct frame *frame)
{
    if (body->moved != world->ticks + 1)
        body->before = body->pose;
    body->moved = world->ticks + 1;
    put_body(world, body, pose, frame);
    body->travelled = displacement_of(body);
    if (world->travelled_at != body->moved)
        world->travelled = 0.0;
    world->travelled_at = body->moved;
    world->travelled = max_of(world->travelled, body->travelled);
}

/* While a body has no pose that can be used, every answer of the world is stale. */
static dpt_result take_pose(struct dpt_world *world, struct body *body, const dpt_pose *pose,
                            struct frame *frame)
{
    dpt_result result = pose ? frame_of_pose(pose, frame) : DPT_E_ARGUMENT;
    world->invalid -= !body->slot.valid;
    body->slot.valid = result == DPT_OK;
    world->invalid += !body->slot.valid;
    return result;
}

dpt_result dpt_body_set_pose(dpt_world *world, dpt_body body, const dpt_pose *pose)
{
    struct body *moved = world ? world_find_body(world, body) : NULL;
    struct frame frame;
    if (!moved)
        return world ? DPT_E_HANDLE : DPT_E_ARGUMENT;
    DPT_TRY(take_pose(world, moved, pose, &frame));
    if (!pose_is_same(&moved->pose, pose))
        move_body(world, moved, pose, &frame);
    return DPT_OK;
}

dpt_result dpt_body_teleport(dpt_world *world, dpt_body body, const dpt_pose *pose)
{
    struct body *moved = world ? world_find_body(world, body) : NULL;
    struct frame frame;
    if (!moved)
        return world ? DPT_E_HANDLE : DPT_E_ARGUMENT;
    DPT_TRY(take_pose(world, moved, pose, &frame));
    put_body(world, moved, pose, &frame);
    forget(world, handle_index(body));
    moved->moved = 0;
    moved->travelled = 0.0;
    moved->added = world->ticks + 1;
    return DPT_OK;
}

int dpt_body_is_valid(const dpt_world *world, dpt_body body)
{
    return world && world_find_body(world, body) != NULL;
}

dpt_result dpt_body_get_pose(const dpt_world *world, dpt_body body, dpt_pose *pose)
{
    const dpt_pose identity = DPT_POSE_IDENTITY;
    if (!world || !pose)
        return DPT_E_ARGUMENT;
    const struct body *asked = world_find_body(world, body);
    *pose = asked ? asked->pose : identity;
    return asked ? DPT_OK : DPT_E_HANDLE;
}

dpt_result dpt_body_set_user(dpt_world *world, dpt_body body, uint64_t user)
{
    struct body *asked = world ? world_find_body(world, body) : NULL;
    if (!asked)
        return world ? DPT_E_HANDLE : DPT_E_ARGUMENT;
    asked->user = user;
    return DPT_OK;
}

dpt_result dpt_body_get_user(const dpt_world *world, dpt_body body, uint64_t *user)
{
    if (!world || !user)
        return DPT_E_ARGUMENT;
    const struct body *asked = world_find_body(world, body);
    *user = asked ? asked->user : 0;
    return asked ? DPT_OK : DPT_E_HANDLE;
}

dpt_result dpt_body_set_settings(dpt_world *world, dpt_body body, const dpt_body_settings *given)
{
    if (!world || !given)
        return DPT_E_ARGUMENT;
    struct body *asked = world_find_body(world, body);
    if (!asked)
        return DPT_E_HANDLE;
    dpt_body_settings settings = { .size = sizeof settings,
                                   .side_limit = asked->side_limit,
                                   .static_friction = asked->static_friction,
                                   .kinetic_friction = asked->kinetic_friction };
    DPT_TRY(sized_read(given, sizeof settings, &settings, sizeof settings));
    if (settings.reserved || !dpti_side_limit_is_valid(settings.side_limit) ||
        !dpti_friction_is_valid(settings.static_friction, settings.kinetic_friction))
        return DPT_E_ARGUMENT;
    asked->side_limit = settings.side_limit;
    asked->static_friction = settings.static_friction;
    asked->kinetic_friction = settings.kinetic_friction;
    return DPT_OK;
}

dpt_result dpt_body_get_settings(const dpt_world *world, dpt_body body, dpt_body_settings *settings)
{
    if (!world || !settings)
        return DPT_E_ARGUMENT;
    dpt_body_settings now = { .size = sizeof now };
    DPT_TRY(sized_check(settings, sizeof now, 0));
    const struct body *asked = world_find_body(world, body);
    if (asked) {
        now.side_limit = asked->side_limit;
        now.static_friction = asked->static_friction;
        now.kinetic_friction = asked->kinetic_friction;
    }
    sized_write(settings, settings->size, &now, sizeof now);
    return asked ? DPT_OK : DPT_E_HANDLE;
}
