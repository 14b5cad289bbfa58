/* SPDX-License-Identifier: BSD-3-Clause */
#include "world/world_members.h"

#include "base/return_if_error.h"
#include "base/sized.h"
#include "insertion/region_law.h"
#include "proxy/proxy.h"
#include "track/body_search.h"
#include "track/deform_state.h"
#include "track/persistent_contacts.h"
#include "track/swept_motion.h"
#include "track/tool_parts.h"
#include "world/baseline_method.h"
#include "world/deform_body.h"
#include "world/tool_force.h"
#include "world/tool_strips.h"
#include "world/world_def.h"

/* Forget what earlier ticks know of the body in a slot. */
static void forget_body(struct dpt_world *world, uint32_t slot)
{
    dpti_persistent_contacts_forget(world, 0, world->segment_count, slot);
    dpti_point_cache_forget(&world->point_cache, slot);
    dpti_strips_forget_body(world, slot);
    dpti_backlog_restart(world);
    for (uint32_t s = 0; s < world->segment_count; s++)
        dpti_force_forget_body(&world->segments[s], world->bodies[slot].id);
    dpti_proxy_forget_body(world, world->bodies[slot].id);
    dpti_channels_forget_body(world, world->bodies[slot].id);
    dpti_tips_forget_body(world, world->bodies[slot].id);
    dpti_body_search_forget_body(world, slot);
    dpti_baseline_forget(world, 0, world->segment_count, slot);
    dpti_far_forget_all(world);
}

static uint32_t free_slot(const struct dpt_world *world)
{
    return slot_to_use(&world->bodies->slot, sizeof *world->bodies, world->body_slot_end, world->freed_count[0]);
}

dpt_result dpti_body_can_add(const struct dpt_world *world)
{
    return free_slot(world) == world->def.max_bodies ? DPT_E_FULL : DPT_OK;
}

uint32_t dpti_body_add(struct dpt_world *world, const struct surface *surface, const dpt_pose *pose)
{
    const uint32_t slot = free_slot(world);
    struct body *made = &world->bodies[slot];
    if (slot == world->body_slot_end) {
        world->body_slot_end++;
        made->slot.generation = 1;
    }
    made->slot.used = 1;
    made->id = handle_make(HANDLE_BODY, &made->slot, slot);
    const dpt_pose identity = DPT_POSE_IDENTITY;
    made->pose = pose ? *pose : identity;
    frame_of_pose(&made->pose, &made->frame);
    made->user = 0;
    made->side_limit = world->def.side_limit;
    made->static_friction = made->kinetic_friction = made->stiffness = 0.0;
    made->unfelt = 0;
    made->pierce = (struct pierce_law){ .puncture_force = 0.0 };
    if (world->channels)
        memset(body_regions_of(world, made), 0, sizeof(struct body_regions));
    made->moved_tick = made->held_tick = 0;
    made->added_tick = world->bodies_put_tick = world_coming_tick(world);
    made->slot.valid = 1;
    world_note_max(&world->usage.bodies, ++world->body_count);
    made->surface = *surface;
    made->surface.holes =
        surface->moments && dpti_holes_find(surface, &world->kernel, &made->holes) ? &made->holes : NULL;
    world->deform_count += surface->motion ? 1 : 0;
    made->diagonal = surface_diagonal(&made->surface);
    dpti_broad_phase_put_body(world, slot);
    world->largest_diagonal = max_of(world->largest_diagonal, made->diagonal);
    dpti_proxy_note_body(world, slot);
    dpti_far_forget_all(world);
    world->has_changed = 1;
    return made->id;
}

dpt_result dpt_body_add(dpt_world *world, const dpt_mesh *mesh, const dpt_pose *pose, dpt_body *body)
{
    struct frame frame;
    struct surface surface;
    if (!world || !mesh || !body)
        return DPT_E_ARGUMENT;
    DPT_TRY(frame_of_pose(pose, &frame));
    DPT_TRY(dpti_body_can_add(world));
    dpti_surface_of_mesh(mesh, &surface);
    *body = dpti_body_add(world, &surface, pose);
    return DPT_OK;
}

/* Of the bodies that tools can find. */
static void measure_largest(struct dpt_world *world)
{
    world->largest_diagonal = 0.0;
    for (uint32_t i = 0; i < world->body_slot_end; i++)
        if (body_is_there(&world->bodies[i]))
            world->largest_diagonal = max_of(world->largest_diagonal, world->bodies[i].diagonal);
}

dpt_result dpt_body_remove(dpt_world *world, dpt_body body)
{
    struct body *removed = world ? world_find_body(world, body) : NULL;
    if (!removed)
        return world ? DPT_E_HANDLE : DPT_E_ARGUMENT;
    slot_release(&removed->slot, &world->freed_count[0]);
    world->body_count--;
    world->deform_count -= removed->surface.motion ? 1 : 0;
    world->unfelt_body_count -= removed->unfelt;
    world->invalid_body_count -= !removed->unfelt && !removed->slot.valid;
    measure_largest(world);
    forget_body(world, handle_index(body));
    world->bodies_put_tick = world_coming_tick(world);
    world->has_changed = 1;
    return DPT_OK;
}

/*
 * m: no point of the body has moved farther since the last tick. The bound is the motion of the origin, plus the arc
 * of the farthest point about it. The angle is 4 asin(c / 2), c being the distance of the two quaternions.
 */
static double motion_bound_of(const struct body *body)
{
    const double *from = body->previous_pose.orientation, *to = body->pose.orientation;
    vec3 low = body->surface.box_min, high = body->surface.box_max;
    double farthest_point = 0.5 * (length(add(low, high)) + length(sub(high, low)));
    double square_of_difference = 0.0, square_of_sum = 0.0;
    for (int k = 0; k < 4; k++) {
        square_of_difference += (to[k] - from[k]) * (to[k] - from[k]);
        square_of_sum += (to[k] + from[k]) * (to[k] + from[k]);
    }
    double square = min_of(square_of_difference, square_of_sum);
    /* Quaternions may be off unit length by 1e-6. */
    double angle = sqrt(square) * (2.0 + 0.3 * square) + 1e-5;
    return length(sub(vec3_of(body->pose.position), vec3_of(body->previous_pose.position))) + angle * farthest_point;
}

/* Set a body's pose and its box. */
static void put_body(struct dpt_world *world, struct body *body, const dpt_pose *pose, const struct frame *frame)
{
    body->pose = *pose;
    body->frame = *frame;
    dpti_broad_phase_put_body(world, handle_index(body->id));
}

/* A body is about to move. Its pose in the last tick stays known until the next step. */
static void begin_motion(const struct dpt_world *world, struct body *body)
{
    if (body->moved_tick != world_coming_tick(world))
        body->previous_pose = body->pose;
    body->moved_tick = world_coming_tick(world);
}

/* A body has moved. */
static void note_motion(struct dpt_world *world, struct body *body)
{
    body->motion_bound = (pose_is_same(&body->previous_pose, &body->pose) ? 0.0 : motion_bound_of(body)) +
                         deform_step(body, world_coming_tick(world));
    if (body->unfelt)
        return;
    world->has_changed = 1;
    if (world->bodies_moved_tick != body->moved_tick) {
        world->body_motion_before += world->body_motion_max;
        world->body_motion_max = 0.0;
    }
    world->bodies_moved_tick = body->moved_tick;
    world->body_motion_max = max_of(world->body_motion_max, body->motion_bound);
    if (body->added_tick == body->moved_tick)
        dpti_proxy_note_body(world, handle_index(body->id));
}

/* Nearest pairs, strips and borders of earlier ticks do not hold any more; bounds do, less the motion. */
static void forget_shape(struct dpt_world *world, const struct body *body, double moved)
{
    const uint32_t slot = handle_index(body->id);
    dpti_point_cache_forget(&world->point_cache, slot);
    dpti_strips_note_vertices(world, slot);
    for (uint32_t s = 0; s < world->segment_count; s++) {
        dpti_bounds_note_motion(world, s, slot, moved);
        if (world->segments[s].border.body == body->id)
            world->segments[s].border.clear_radius = 0.0;
    }
}

void dpti_body_note_vertices(struct dpt_world *world, struct body *body, double moved, int has_begun_anew)
{
    if (has_begun_anew)
        dpti_body_search_forget_planes(world, 0, world->segment_count, handle_index(body->id));
    if (!(moved > 0.0))
        return;
    begin_motion(world, body);
    forget_shape(world, body, moved);
    note_motion(world, body);
}

/*
 * Check a new pose and note whether the body has a valid one. While one has not, every answer of the world is stale.
 */
static dpt_result set_validity(struct dpt_world *world, struct body *body, const dpt_pose *pose, struct frame *frame)
{
    dpt_result result = pose ? frame_of_pose(pose, frame) : DPT_E_ARGUMENT;
    world->invalid_body_count -= !body->unfelt && !body->slot.valid;
    body->slot.valid = result == DPT_OK;
    world->invalid_body_count += !body->unfelt && !body->slot.valid;
    return result;
}

dpt_result dpt_body_set_pose(dpt_world *world, dpt_body body, const dpt_pose *pose)
{
    struct body *moved = world ? world_find_body(world, body) : NULL;
    struct frame frame;
    if (!moved)
        return world ? DPT_E_HANDLE : DPT_E_ARGUMENT;
    DPT_TRY(set_validity(world, moved, pose, &frame));
    if (pose_is_same(&moved->pose, pose))
        return DPT_OK;
    begin_motion(world, moved);
    put_body(world, moved, pose, &frame);
    note_motion(world, moved);
    return DPT_OK;
}

void dpti_body_begin_anew(struct dpt_world *world, struct body *body)
{
    forget_body(world, handle_index(body->id));
    world->has_changed = 1;
    body->moved_tick = 0;
    body->motion_bound = 0.0;
    body->added_tick = world->bodies_put_tick = world_coming_tick(world);
    if (!body->unfelt)
        dpti_proxy_note_body(world, handle_index(body->id));
}

dpt_result dpt_body_teleport(dpt_world *world, dpt_body body, const dpt_pose *pose)
{
    struct body *moved = world ? world_find_body(world, body) : NULL;
    struct frame frame;
    if (!moved)
        return world ? DPT_E_HANDLE : DPT_E_ARGUMENT;
    DPT_TRY(set_validity(world, moved, pose, &frame));
    put_body(world, moved, pose, &frame);
    dpti_body_begin_anew(world, moved);
    return DPT_OK;
}

int dpt_body_is_valid(const dpt_world *world, dpt_body body)
{
    return world && world_find_body(world, body);
}

dpt_result dpt_body_get_pose(const dpt_world *world, dpt_body body, dpt_pose *pose)
{
    const dpt_pose identity = DPT_POSE_IDENTITY;
    if (!world || !pose)
        return DPT_E_ARGUMENT;
    const struct body *found = world_find_body(world, body);
    *pose = found ? found->pose : identity;
    return found ? DPT_OK : DPT_E_HANDLE;
}

dpt_result dpt_body_set_user(dpt_world *world, dpt_body body, uint64_t user)
{
    struct body *found = world ? world_find_body(world, body) : NULL;
    if (!found)
        return world ? DPT_E_HANDLE : DPT_E_ARGUMENT;
    found->user = user;
    return DPT_OK;
}

dpt_result dpt_body_get_user(const dpt_world *world, dpt_body body, uint64_t *user)
{
    if (!world || !user)
        return DPT_E_ARGUMENT;
    const struct body *found = world_find_body(world, body);
    *user = found ? found->user : 0;
    return found ? DPT_OK : DPT_E_HANDLE;
}

/* For tools a body goes, or comes to be where it is. */
static void set_unfelt(struct dpt_world *world, struct body *body, uint32_t unfelt)
{
    world->unfelt_body_count += unfelt - body->unfelt;
    if (!body->slot.valid)
        world->invalid_body_count += body->unfelt - unfelt;
    body->unfelt = unfelt;
    measure_largest(world);
    dpti_broad_phase_put_body(world, handle_index(body->id));
    dpti_body_begin_anew(world, body);
}

/* Settings as they are. */
static dpt_body_settings settings_of(const struct body *body)
{
    return (dpt_body_settings){ .size = sizeof(dpt_body_settings),
                                .unfelt = body->unfelt,
                                .side_limit = body->side_limit,
                                .static_friction = body->static_friction,
                                .kinetic_friction = body->kinetic_friction,
                                .stiffness = body->stiffness,
                                .puncture_force = body->pierce.puncture_force,
                                .toughness = body->pierce.toughness,
                                .cutting_force = body->pierce.cutting_force,
                                .shaft_friction = body->pierce.shaft_friction,
                                .shaft_viscosity = body->pierce.shaft_viscosity,
                                .shaft_stiffness = body->pierce.shaft_stiffness };
}

static int is_between(double value, double max)
{
    return value >= 0.0 && value <= max;
}

int dpti_pierce_law_is_valid(const struct pierce_law *law)
{
    return is_between(law->puncture_force, 1e6) && is_between(law->toughness, 1e9) &&
           is_between(law->cutting_force, 1e6) && is_between(law->shaft_friction, 1e6) &&
           is_between(law->shaft_viscosity, 1e6) && is_between(law->shaft_stiffness, 1e12);
}

int dpti_body_can_be_pierced(const struct body *body)
{
    const struct deform *deform = deform_of(body);
    return !deform || (deform->solve && deform->def.response == DPT_RESPONSE_LOAD);
}

dpt_result dpt_body_set_settings(dpt_world *world, dpt_body body, const dpt_body_settings *given)
{
    if (!world || !given)
        return DPT_E_ARGUMENT;
    struct body *found = world_find_body(world, body);
    if (!found)
        return DPT_E_HANDLE;
    dpt_body_settings settings = settings_of(found);
    DPT_TRY(sized_read(given, SIZED_FIRST(dpt_body_settings, puncture_force), &settings, sizeof settings));
    const struct pierce_law pierce = { settings.puncture_force, settings.toughness,       settings.cutting_force,
                                       settings.shaft_friction, settings.shaft_viscosity, settings.shaft_stiffness };
    if (settings.unfelt > 1 || !dpti_side_limit_is_valid(settings.side_limit) ||
        !dpti_friction_is_valid(settings.static_friction, settings.kinetic_friction) ||
        !dpti_stiffness_is_valid(settings.stiffness) || !dpti_pierce_law_is_valid(&pierce))
        return DPT_E_ARGUMENT;
    if (pierce_law_is_any(&pierce) && (!world->channels || !dpti_body_can_be_pierced(found)))
        return DPT_E_UNSUPPORTED;
    found->pierce = pierce;
    found->side_limit = settings.side_limit;
    found->static_friction = settings.static_friction;
    found->kinetic_friction = settings.kinetic_friction;
    found->stiffness = settings.stiffness;
    world->has_changed = 1;
    if (found->unfelt != settings.unfelt) {
        world->bodies_put_tick = world_coming_tick(world);
        set_unfelt(world, found, settings.unfelt);
    }
    return DPT_OK;
}

dpt_result dpt_body_get_settings(const dpt_world *world, dpt_body body, dpt_body_settings *settings)
{
    if (!world || !settings)
        return DPT_E_ARGUMENT;
    dpt_body_settings now = { .size = sizeof now };
    DPT_TRY(sized_check(settings, SIZED_FIRST(dpt_body_settings, puncture_force), 0));
    const struct body *found = world_find_body(world, body);
    if (found)
        now = settings_of(found);
    sized_write(settings, settings->size, &now, sizeof now);
    return found ? DPT_OK : DPT_E_HANDLE;
}
