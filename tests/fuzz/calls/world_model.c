/* SPDX-License-Identifier: BSD-3-Clause */
#include "fuzz/calls/deform_model.h"

struct scene scenes[SCENES];

struct scene *draw_scene(void)
{
    struct scene *scene = &scenes[draw_below(SCENES)];
    return scene->world_count ? scene : NULL;
}

struct model_body *scene_body(struct scene *scene, uint32_t id)
{
    for (uint32_t i = 0; i < scene->body_count; i++)
        if (scene->body[i].id == id)
            return &scene->body[i];
    return NULL;
}

struct model_tool *scene_tool(struct scene *scene, uint32_t id)
{
    for (uint32_t i = 0; i < scene->tool_count; i++)
        if (scene->tool[i].id == id)
            return &scene->tool[i];
    return NULL;
}

const struct body_then *scene_body_then(const struct scene *scene, uint32_t id)
{
    for (uint32_t i = 0; i < scene->then_count; i++)
        if (scene->then[i].id == id)
            return &scene->then[i];
    return NULL;
}

static uint32_t draw_removed(const struct removed *removed)
{
    const uint64_t kept = removed->count < REMEMBERED_FOR ? removed->count : REMEMBERED_FOR;
    const uint64_t back = kept ? draw_bits() % (draw_one_in(2) && kept > 4 ? 4 : kept) : 0;
    return kept ? removed->id[(removed->count - 1 - back) % REMEMBERED_FOR] : 0;
}

/* Neither a live body nor a live tool, mostly. */
static uint32_t draw_strange_id(const struct removed *removed)
{
    struct scene *other = &scenes[draw_below(SCENES)];
    switch (draw_below(5)) {
    case 0:
        return other->body_count ? other->body[draw_below(other->body_count)].id : 1;
    case 1:
        return other->tool_count ? other->tool[draw_below(other->tool_count)].id : 2;
    case 2:
        return (uint32_t)draw_bits();
    case 3:
        return draw_one_in(2) ? 0 : draw_below(3) - 1;
    default:
        return draw_removed(removed) ^ (draw_one_in(4) ? 1u << draw_below(32) : 0u);
    }
}

uint32_t draw_body_id(struct scene *scene)
{
    const uint32_t kind = draw_below(20);
    if (scene->body_count && kind < 17)
        return scene->body[draw_below(scene->body_count)].id;
    if (kind == 17 && scene->tool_count)
        return scene->tool[draw_below(scene->tool_count)].id;
    return kind == 18 ? draw_removed(&scene->removed_bodies) : draw_strange_id(&scene->removed_bodies);
}

uint32_t draw_tool_id(struct scene *scene)
{
    const uint32_t kind = draw_below(20);
    if (scene->tool_count && kind < 17)
        return scene->tool[draw_below(scene->tool_count)].id;
    if (kind == 17 && scene->body_count)
        return scene->body[draw_below(scene->body_count)].id;
    return kind == 18 ? draw_removed(&scene->removed_tools) : draw_strange_id(&scene->removed_tools);
}

void scene_takes_id(struct scene *scene, struct removed *removed, uint32_t id)
{
    HOLDS(id != 0, "a null id");
    HOLDS(!scene_body(scene, id) && !scene_tool(scene, id), "id %x is another's", id);
    const uint64_t kept = removed->count < REMEMBERED_FOR ? removed->count : REMEMBERED_FOR;
    for (uint64_t i = 0; i < kept; i++) {
        met[MET_REUSED] += removed->id[i] == id;
        HOLDS(removed->id[i] != id || removed->adds - removed->adds_then[i] >= REFUSED_FOR,
              "id %x was removed %llu adds ago", id, (unsigned long long)(removed->adds - removed->adds_then[i]));
    }
    removed->adds++;
}

void scene_removes_id(struct removed *removed, uint32_t id)
{
    removed->id[removed->count % REMEMBERED_FOR] = id;
    removed->adds_then[removed->count % REMEMBERED_FOR] = removed->adds;
    removed->count++;
}

void scene_forgets(struct scene *scene)
{
    for (uint32_t i = 0; i < scene->body_count; i++)
        soft_is_gone(scene->body[i].soft);
    scene->body_count = scene->tool_count = scene->segment_count = scene->then_count = 0;
    scene->removed_bodies.adds = scene->removed_bodies.count = 0;
    scene->removed_tools.adds = scene->removed_tools.count = 0;
    scene->is_as_stepped = 0;
    scene->contacts_then = 0;
    memset(&scene->least, 0, sizeof scene->least);
    scene->due = (struct due_loads){ .is_none = 1 };
}

void scene_is_stale(struct scene *scene)
{
    for (uint32_t i = 0; i < scene->tool_count; i++)
        scene->tool[i].answers = ANSWERS_NONE;
    scene->then_count = 0;
    scene->contacts_then = 0;
    scene->is_as_stepped = 0;
    scene->due = (struct due_loads){ .is_none = 1 };
}

/* v + 2 w (u x v) + 2 u x (u x v), of the unit quaternion (w, u) or its conjugate. */
static void turn(const dpt_pose *pose, double sign, const double v[3], double out[3])
{
    const double *q = pose->orientation;
    double size = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    const double w = q[0] / size;
    const double u[3] = { sign * q[1] / size, sign * q[2] / size, sign * q[3] / size };
    const double t[3] = { 2.0 * (u[1] * v[2] - u[2] * v[1]), 2.0 * (u[2] * v[0] - u[0] * v[2]),
                          2.0 * (u[0] * v[1] - u[1] * v[0]) };
    const double x = v[0] + w * t[0] + (u[1] * t[2] - u[2] * t[1]);
    const double y = v[1] + w * t[1] + (u[2] * t[0] - u[0] * t[2]);
    out[2] = v[2] + w * t[2] + (u[0] * t[1] - u[1] * t[0]);
    out[0] = x;
    out[1] = y;
}

void to_world(const dpt_pose *pose, const double x[3], double out[3])
{
    turn(pose, 1.0, x, out);
    for (int k = 0; k < 3; k++)
        out[k] += pose->position[k];
}

void to_frame(const dpt_pose *pose, const double x[3], double out[3])
{
    const double apart[3] = { x[0] - pose->position[0], x[1] - pose->position[1], x[2] - pose->position[2] };
    turn(pose, -1.0, apart, out);
}

/* Where the proxy is said to be. A free tool's may be smaller than what was given, if that has grown. */
static void take_proxy(struct scene *scene, struct model_tool *tool)
{
    const dpt_segment given = tool->segment[0];
    dpt_segment along[1] = { { .radius = given.radius } };
    dpt_tool_get_proxy(scene->world[0], tool->id, &tool->proxy);
    if (tool->is_free) {
        const double length = sqrt((given.b[0] - given.a[0]) * (given.b[0] - given.a[0]) +
                                   (given.b[1] - given.a[1]) * (given.b[1] - given.a[1]) +
                                   (given.b[2] - given.a[2]) * (given.b[2] - given.a[2]));
        if (tool->is_placed_anew) {
            tool->least = (dpt_segment){ .b = { length, 0.0, 0.0 }, .radius = given.radius };
            tool->has_grown = 0;
        }
        tool->has_grown |= length > tool->least.b[0] || given.radius > tool->least.radius;
        tool->least.b[0] = fmin(tool->least.b[0], length);
        tool->least.radius = fmin(tool->least.radius, given.radius);
        along[0] = tool->least;
    }
    tool->has_grown &= tool->is_free;
    tool->is_placed_anew = 0;
    for (uint32_t i = 0; i < tool->count; i++) {
        const dpt_segment *segment = tool->is_free ? along : &tool->segment[i];
        to_world(&tool->proxy, segment->a, tool->proxy_at[i].a);
        to_world(&tool->proxy, segment->b, tool->proxy_at[i].b);
        tool->proxy_at[i].radius = segment->radius;
    }
}

void scene_has_stepped(struct scene *scene, double dt)
{
    int is_usable = 1;
    scene->then_count = 0;
    scene->due = (struct due_loads){ .is_none = 0 };
    for (uint32_t i = 0; i < scene->body_count; i++) {
        const struct model_body *body = &scene->body[i];
        is_usable &= body->is_usable || body->unfelt;
        if (!body->unfelt)
            scene->then[scene->then_count++] =
                (struct body_then){ .id = body->id, .pose = body->pose, .subject = body->subject };
    }
    softs_have_stepped(scene, dt);
    is_usable &= scene->then_count > 0;
    for (uint32_t t = 0; t < scene->tool_count; t++) {
        struct model_tool *tool = &scene->tool[t];
        tool->answers = is_usable && tool->is_usable ? ANSWERS_THERE : ANSWERS_NONE;
        tool->stiffness_then = tool->stiffness;
        tool->law_then = tool->law;
        tool->near_only_then = tool->near_only;
        tool->was_shaped = tool->is_shaped;
        for (uint32_t i = 0; i < tool->count; i++) {
            to_world(&tool->pose, tool->segment[i].a, tool->at[i].a);
            to_world(&tool->pose, tool->segment[i].b, tool->at[i].b);
            tool->at[i].radius = tool->segment[i].radius;
        }
        if (has_proxy(scene, tool->law))
            take_proxy(scene, tool);
        memcpy(tool->origin, tool->is_free ? tool->at[0].a : tool->pose.position, sizeof tool->origin);
    }
    scene->is_as_stepped = 1;
}

void scene_remove_body(struct scene *scene, struct model_body *body)
{
    scene_removes_id(&scene->removed_bodies, body->id);
    soft_is_gone(body->soft);
    *body = scene->body[--scene->body_count];
    scene->is_as_stepped = 0;
}

void scene_remove_tool(struct scene *scene, struct model_tool *tool)
{
    scene_removes_id(&scene->removed_tools, tool->id);
    scene->segment_count -= tool->count;
    *tool = scene->tool[--scene->tool_count];
    scene->is_as_stepped = 0;
}

void segments_codes(const struct scene *scene, const struct model_tool *tool, const dpt_segment *segments,
                    uint32_t count, struct codes *codes)
{
    may_fail(codes, !segments || (tool && count != tool->count), DPT_E_ARGUMENT);
    may_fail(codes, !tool, DPT_E_HANDLE);
    may_fail(codes, tool && tool->count > 1 && has_proxy(scene, tool->law), DPT_E_UNSUPPORTED);
    for (uint32_t i = 0; segments && i < count; i++)
        segment_codes(&segments[i], codes);
}

void tool_has_pose(struct scene *scene, struct model_tool *tool, const dpt_pose *pose)
{
    tool->is_usable = pose != NULL;
    scene->is_as_stepped = 0;
    if (!pose)
        return;
    if (tool->is_free)
        tool->is_placed_anew = 1;
    tool->is_free = 0;
    tool->pose = *pose;
}

void tool_has_segments(struct scene *scene, struct model_tool *tool, const dpt_segment *segments)
{
    const dpt_pose identity = DPT_POSE_IDENTITY;
    tool->is_usable = segments != NULL;
    scene->is_as_stepped = 0;
    if (!segments)
        return;
    if (!tool->is_free)
        tool->is_placed_anew = 1;
    tool->is_free = 1;
    tool->pose = identity;
    memcpy(tool->segment, segments, tool->count * sizeof *segments);
}
