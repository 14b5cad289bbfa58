/* SPDX-License-Identifier: BSD-3-Clause */
#include "proxy/proxy_put.h"

#include "hull/hull_sweep.h"
#include "proxy/proxy.h"
#include "proxy/proxy_force.h"
#include "proxy/proxy_motion.h"

/* Tissue dents a tool by up to half of its radius. So much of it must have a free way. */
#define RADIUS_SHARE 0.5

void dpti_proxy_put(struct proxy_tick *tick)
{
    tick->at = tick->goal = tick->device;
    tick->is_led = 0;
    tick->is_before = tick->is_waiting = 0;
    tick->proxy->state = PROXY_PLACED;
    tick->proxy->is_behind = 0;
    dpti_proxy_find_nearest(tick);
    tick->proxy->trust = HUGE_VAL;
    tick->proxy->last_motion = 0.0;
    tick->proxy->owed = 0.0;
    tick->proxy->lag = 0.0;
}

void dpti_proxy_put_again(struct proxy_tick *tick)
{
    dpti_proxy_leave(tick->proxy);
    dpti_proxy_put(tick);
    tick->contact_count = 0;
    tick->proxy->fade.time_left = tick->world->def.fade;
}

void dpti_proxy_doubt_unseen_motion(const struct dpt_world *world, struct proxy *proxy)
{
    const int was_stepped = world_was_last_tick(world, proxy->tick);
    if (!was_stepped)
        dpti_proxy_end_force(proxy);
    if (proxy->state < PROXY_DOUBTED || was_stepped || (int32_t)(world->bodies_moved_tick - proxy->tick) <= 0)
        return;
    /* Its last tick's motion is swept. */
    const double unseen = world_body_path(world) - world_body_motion(world) - proxy->body_path;
    if (proxy->gap > unseen + proxy->min_gap) {
        proxy->gap -= unseen;
        return;
    }
    dpti_proxy_leave(proxy);
    proxy->state = PROXY_DOUBTED;
    proxy->gap = -HUGE_VAL;
}

void dpti_proxy_note_free_turn(struct proxy *proxy, const dpt_pose *device)
{
    const double *turn = device->orientation, sign = turn[0] < 0.0 ? -1.0 : 1.0;
    for (int k = 0; k < 3; k++)
        proxy->free_turn[k] = (float)(sign * turn[1 + k]);
}

int dpti_proxy_is_near_free_turn(const struct proxy_tick *tick)
{
    const struct proxy *proxy = tick->proxy;
    dpt_pose pose = tick->device.pose;
    const vec3 v = vec3_of_float(proxy->free_turn);
    quaternion_store((struct quaternion){ sqrt(max_of(0.0, 1.0 - dot(v, v))), v }, pose.orientation);
    const struct proxy_pose last = dpti_proxy_pose_of(proxy, &pose);
    const struct displacement turned = dpti_proxy_displacement(proxy, &last, &tick->device);
    return length(turned.turn) < PROXY_TURN_MAX;
}

/* The way of a proxy that was put, past one body. */
struct way {
    struct dpt_world *world;
    const struct tool *tool;
    const dpt_pose *from, *to;
    const struct body *body;
};

static int segment_is_free(const struct way *way, const struct segment *segment)
{
    struct placement from = { *way->from, way->body->pose, segment->a, segment->b };
    struct placement to = { *way->to, way->body->pose, segment->a, segment->b };
    struct rigid_sweep_progress progress;
    rigid_sweep_restart(&progress);
    struct rigid_sweep sweep = { .surface = &way->body->surface,
                                 .kernel = &way->world->kernel,
                                 .radius = RADIUS_SHARE * segment->radius,
                                 .tolerance =
                                     0.5 * RIGID_SWEEP_TOLERANCE * min_of(way->body->diagonal, PROXY_SCALE_MAX),
                                 .hint = DPT_NONE,
                                 .work = &way->world->work,
                                 .progress = &progress };
    return dpti_rigid_sweep_find(&sweep, &from, &to) == SWEEP_FREE;
}

static int tip_is_free(const struct way *way, const struct tip *tip)
{
    const struct placement from = { .tool = *way->from, .body = way->body->pose };
    const struct placement to = { .tool = *way->to, .body = way->body->pose };
    struct hull_sweep sweep = { .surface = &way->body->surface,
                                .kernel = &way->world->kernel,
                                .hull = tip->hull,
                                .clearance = (RADIUS_SHARE - 1.0) * tip->hull->radius,
                                .tolerance = 0.5 * RIGID_SWEEP_TOLERANCE * min_of(way->body->diagonal, PROXY_SCALE_MAX),
                                .work = &way->world->work,
                                .triangle = DPT_NONE };
    return dpti_hull_sweep(&sweep, &from, &to) == SWEEP_FREE;
}

static int way_is_free(const struct way *way)
{
    const struct work before = world_begin_sweep(way->world);
    int is_free = 1;
    for (uint32_t i = 0; is_free && i < tool_part_count(way->tool); i++) {
        const struct part part = tool_part(way->world, way->tool, i);
        is_free = !work_is_spent(&way->world->work) &&
                  (part.tip ? tip_is_free(way, part.tip) : segment_is_free(way, part.segment));
    }
    world_end_sweep(way->world, &before);
    return is_free;
}

/* Whether a body is so far away that no side of it counts: farther than the tool is long. */
static int is_clear_of(const struct dpt_world *world, const struct tool *tool, const struct body *body)
{
    const struct proxy *proxy = proxy_of(world, tool);
    struct frame frame;
    frame_of_pose(&proxy->pose, &frame);
    for (uint32_t i = 0; i < tool_part_count(tool); i++) {
        const struct part part = tool_part(world, tool, i);
        const struct box box = dpti_part_box(part, &frame);
        if (!(box_distance(&box, &world->boxes[handle_index(body->id)]) > 2.0 * proxy->extent + part_radius(part)))
            return 0;
    }
    return 1;
}

/* Whether each part of a surface has an inside, so that contact tells the side. */
static int has_inside(const struct surface *surface)
{
    for (uint32_t part = 0; part < surface->mesh->parts; part++)
        if (!(mesh_part_flags(surface->mesh, part) & MESH_PART_SOLID))
            return 0;
    return 1;
}

static int is_after(uint32_t tick, uint32_t other)
{
    return tick && (int32_t)(tick - other) > 0;
}

/* What is known of the side of a body on which the proxy is: that of home; only what contact tells; not that of home. */
enum { SIDE_KEPT, SIDE_ASKED, SIDE_LOST };

/*
 * On a body that was added since, home had no side. One that has moved since may have passed by. Of one with an inside contact
 * tells then; and of one in the way from home, once the tool has been inside.
 */
static int side_of_body(struct dpt_world *world, const struct tool *tool, const struct body *body)
{
    const struct proxy *proxy = proxy_of(world, tool);
    if (is_clear_of(world, tool, body))
        return SIDE_KEPT;
    if (is_after(body->added_tick, proxy->home_tick))
        return SIDE_ASKED;
    const int has_moved = is_after(body->moved_tick, proxy->home_tick);
    const struct way way = { world, tool, &proxy->end, &proxy->pose, body };
    if (!has_moved && (proxy->state == PROXY_DOUBTED || way_is_free(&way)))
        return SIDE_KEPT;
    return (has_moved || proxy->has_been_inside) && has_inside(&body->surface) ? SIDE_ASKED : SIDE_LOST;
}

/* The same of all bodies. */
static int side_kept(struct dpt_world *world, const struct tool *tool)
{
    int side = proxy_of(world, tool)->has_home ? SIDE_KEPT : SIDE_ASKED;
    for (uint32_t i = 0; proxy_of(world, tool)->has_home && i < world->body_slot_end && side != SIDE_LOST; i++) {
        const int other = body_is_there(&world->bodies[i]) ? side_of_body(world, tool, &world->bodies[i]) : SIDE_KEPT;
        side = other > side ? other : side;
    }
    return side;
}

/* Whether contact tells of all parts of a tool on which side they are, and whether they are outside. */
struct contact_side {
    int is_known, is_outside;
};

static struct contact_side contact_side_of(const struct dpt_world *world, const struct tool *tool)
{
    struct contact_side side = { 1, 1 };
    for (uint32_t i = 0; i < tool->segment_count; i++) {
        const struct segment *segment = &world->segments[tool->first_segment + i];
        if (!segment->answer.body)
            continue;
        side.is_known &= segment->answer.is_exact && segment->result.has_gap;
        side.is_outside &= segment->result.gap > 0.0;
    }
    for (uint32_t i = 0; i < tool->tip_count; i++) {
        const struct tip *tip = tool_tip(world, tool, i);
        if (!tip->answer.body)
            continue;
        side.is_known &= tip->answer.is_exact != 0;
        side.is_outside &=
            tip->answer.is_exact && tip->answer.nearest.distance > tip->hull->radius && dpti_tip_is_outside(tip);
    }
    return side;
}

void dpti_proxy_settle(struct dpt_world *world, struct tool *tool)
{
    struct proxy *proxy = proxy_of(world, tool);
    if (proxy->state != PROXY_PLACED && proxy->state != PROXY_DOUBTED)
        return;
    const int side = side_kept(world, tool);
    const struct contact_side contact = contact_side_of(world, tool);
    proxy->has_been_inside |= contact.is_known && !contact.is_outside;
    if (side == SIDE_ASKED && !contact.is_known)
        return;
    const int is_outside = side == SIDE_KEPT || (side == SIDE_ASKED && contact.is_outside);
    if (is_outside && (proxy->state == PROXY_DOUBTED || proxy->gap >= proxy->min_gap)) {
        proxy->state = PROXY_OUTSIDE;
        if (proxy->has_home)
            proxy->end = proxy->pose;
        proxy->has_home = 0;
    } else if (!is_outside) {
        proxy->state = PROXY_PLACED;
    }
}
