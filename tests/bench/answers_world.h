/* SPDX-License-Identifier: BSD-3-Clause */
/* What worlds of moving bodies and tools answer. A part of answers.c, which alone includes it. */
#ifndef DPT_BENCH_ANSWERS_WORLD_H
#define DPT_BENCH_ANSWERS_WORLD_H

#include "bench/answers_mesh.h"

enum { BODIES_MAX = 6, TOOLS_MAX = 4, SEGMENTS_MAX = 3, CONTACTS_MAX = 48 };

struct moving_body {
    dpt_body id;
    const struct subject *subject;
    dpt_pose pose;
    double velocity[3], spin[3]; /* of a tick */
    int there;
};

struct moving_tool {
    dpt_tool id;
    uint32_t count;
    int there, rigid;
    dpt_segment segments[SEGMENTS_MAX];
    dpt_pose pose, from, to;
    uint32_t tick, ticks; /* of the way */
};

struct scene {
    dpt_world_def def;
    dpt_world *world;
    void *block;
    double scale;
    struct moving_body bodies[BODIES_MAX];
    struct moving_tool tools[TOOLS_MAX];
};

static struct {
    uint64_t worlds, ticks, crossing, contacts, swept, stale, bounded, strips;
} met;

static dpt_world_def draw_def(double scale, int small)
{
    static const uint32_t methods[] = { DPT_METHOD_EXACT, DPT_METHOD_EXACT, DPT_METHOD_EXACT, DPT_METHOD_EXACT,
                                        DPT_METHOD_EXACT, DPT_METHOD_EXACT, DPT_METHOD_EXACT, DPT_METHOD_TREE,
                                        DPT_METHOD_TREE,  DPT_METHOD_PAPER, DPT_METHOD_BRUTE };
    static const uint32_t budgets[] = { 0, 0, 0, 20, 100, 500, 500 };
    static const uint32_t contacts[] = { 0, 1, 4, 32, 32, 32 };
    static const uint32_t untils[] = { DPT_UNTIL_RESPOND, DPT_UNTIL_RESPOND, DPT_UNTIL_RESPOND, DPT_UNTIL_RESPOND,
                                       DPT_UNTIL_RESPOND, DPT_UNTIL_CONTACT, DPT_UNTIL_TRACK };
    static const uint32_t strips[] = { DPT_STRIP_KIND_NONE, DPT_STRIP_KIND_NONE, DPT_STRIP_KIND_SHADOW,
                                       DPT_STRIP_KIND_SHADOW, DPT_STRIP_KIND_ROUTES };
    static const uint32_t capacities[] = { 5, 64, 1024, 1024 };
    static const uint64_t memories[] = { 0, 2720, 272 * 64, 1 << 20, 1 << 20, 1 << 20 };
    static const double margins[] = { 0.0, 0.003, 0.01, 0.03 };
    dpt_world_def def;
    dpt_baseline_def baseline;
    dpt_world_def_init(&def);
    def.law = DPT_LAW_POINT;
    def.max_bodies = BODIES_MAX;
    def.max_tools = TOOLS_MAX;
    def.max_segments = TOOLS_MAX * SEGMENTS_MAX;
    def.method = ONE_OF(methods);
    if (def.method == DPT_METHOD_BRUTE && !small)
        def.method = DPT_METHOD_EXACT;
    def.kernel = kernels[below(kernel_count)];
    def.until = ONE_OF(untils);
    if (def.method == DPT_METHOD_PAPER) {
        const uint32_t parts = 1 + below(4);
        set_baseline(&def, &baseline, parts, below(2));
    }
    if (def.method == DPT_METHOD_EXACT)
        def.budget = ONE_OF(budgets);
    def.stiffness = once_in(4) ? in(0.0, 2000.0) : 500.0;
    def.certificate_bytes = ONE_OF(memories);
    def.margin = scale * ONE_OF(margins);
    def.side_limit = once_in(3) ? scale * in(0.01, 0.3) : 0.0;
    def.max_contacts = ONE_OF(contacts);
    def.smooth_normals = below(2);
    def.strip = ONE_OF(strips);
    def.strip_capacity = ONE_OF(capacities);
    def.strip_search = once_in(4) ? 100 : 16384;
    def.strip_width = once_in(2) ? 0.0 : scale * in(0.0, 0.02);
    def.strip_depth = once_in(2) ? 0.0 : scale * in(0.0, 0.2);
    return def;
}

static void body_add(struct scene *scene, struct moving_body *body, int first, int small)
{
    do
        body->subject = &subjects[below(subject_count)];
    while (small && body->subject->info.triangles > 2500);
    if (first)
        scene->scale = body->subject->diagonal;
    body->pose = draw_pose(first ? 0.0 : 0.6 * scene->scale);
    if (first && once_in(2))
        body->pose = (dpt_pose)DPT_POSE_IDENTITY;
    const double speed = once_in(2) ? 0.0 : scene->scale * pow(10.0, in(-4.0, -2.0));
    for (int i = 0; i < 3; i++) {
        body->velocity[i] = speed * in(-1.0, 1.0);
        body->spin[i] = once_in(2) ? speed / scene->scale * in(-2.0, 2.0) : 0.0;
    }
    dpt_result result = dpt_body_add(scene->world, body->subject->mesh, once_in(4) ? NULL : &body->pose, &body->id);
    put_result("body_add", result);
    body->there = result == DPT_OK;
    if (body->there) /* also where it was added at the identity */
        put_result("body_set_pose", dpt_body_set_pose(scene->world, body->id, &body->pose));
}

static void body_move(struct scene *scene, struct moving_body *body, uint32_t tick)
{
    const double *w = body->spin;
    double *q = body->pose.orientation;
    const double rate[4] = { -w[0] * q[1] - w[1] * q[2] - w[2] * q[3], w[0] * q[0] + w[1] * q[3] - w[2] * q[2],
                             w[1] * q[0] + w[2] * q[1] - w[0] * q[3], w[2] * q[0] + w[0] * q[2] - w[1] * q[1] };
    const double sense = tick / 40 % 2 ? -1.0 : 1.0; /* there and back */
    for (int i = 0; i < 4; i++)
        q[i] += 0.5 * sense * rate[i];
    make_unit(q);
    for (int i = 0; i < 3; i++)
        body->pose.position[i] += sense * body->velocity[i];
    dpt_pose given = body->pose;
    if (once_in(2000))
        given.orientation[0] = NAN;
    if (w[0] != 0.0 || body->velocity[0] != 0.0) {
        put_result("body_set_pose", dpt_body_set_pose(scene->world, body->id, &given));
        if (given.orientation[0] != body->pose.orientation[0] && once_in(2))
            put_result("body_set_pose", dpt_body_set_pose(scene->world, body->id, &body->pose));
    }
}

/* How far a tool of an orientation reaches along a direction. */
static double reach(const struct moving_tool *tool, const double orientation[4], const double along[3])
{
    double tip[3], least = 0.0;
    for (uint32_t i = 0; i < tool->count; i++) {
        turn(orientation, tool->segments[i].b, tip);
        least = fmin(least, tip[0] * along[0] + tip[1] * along[1] + tip[2] * along[2]);
    }
    return least;
}

/* Where the tool goes next: a point of it to a place at some body's surface, most often from above. */
static void tool_aim(struct scene *scene, struct moving_tool *tool)
{
    double corners[9], point[3], normal[3], up[3], to[3], anchor[3], turned[3];
    uint32_t number;
    const struct moving_body *body = &scene->bodies[below(BODIES_MAX)];
    tool->from = tool->pose;
    tool->tick = 0;
    tool->ticks = once_in(6) ? 1 + below(3) : 4 + below(50);
    if (once_in(6)) /* at rest, for budgets to catch up */
        return;
    tool->to = draw_pose(0.5 * scene->scale);
    for (int i = 0; i < 10 && !body->there; i++)
        body = &scene->bodies[below(BODIES_MAX)];
    if (!body->there || !draw_triangle(body->subject, &number, corners))
        return;
    const int dips = once_in(6);
    over_triangle(corners, scene->scale * (dips ? in(-0.08, 0.0) : in(-0.004, 0.06)), point, normal);
    apply(&body->pose, point, to);
    turn(body->pose.orientation, normal, up);
    for (int i = 0; i < 8 && !dips; i++) {
        double other[4];
        draw_unit(other, 4);
        if (reach(tool, other, up) > reach(tool, tool->to.orientation, up))
            memcpy(tool->to.orientation, other, sizeof other);
    }
    const double share = once_in(6) ? in(0.0, 1.0) : 0.0;
    for (int i = 0; i < 3; i++)
        anchor[i] = tool->segments[0].a[i] + share * (tool->segments[0].b[i] - tool->segments[0].a[i]);
    turn(tool->to.orientation, anchor, turned);
    for (int i = 0; i < 3; i++)
        tool->to.position[i] = to[i] - turned[i];
}

static void tool_add(struct scene *scene, struct moving_tool *tool)
{
    const double radius = once_in(3) ? 0.0 : scene->scale * in(0.0, 0.02);
    const double size = once_in(3) ? 0.6 : 0.15;
    double at[3] = { 0, 0, 0 };
    tool->count = 1 + below(SEGMENTS_MAX);
    tool->rigid = !once_in(3);
    for (uint32_t i = 0; i < tool->count; i++) { /* a chain */
        double along[3];
        const double length = once_in(15) ? 0.0 : scene->scale * size * in(0.2, 1.0);
        draw_unit(along, 3);
        memcpy(tool->segments[i].a, at, sizeof at);
        for (int k = 0; k < 3; k++)
            at[k] += length * along[k];
        memcpy(tool->segments[i].b, at, sizeof at);
        tool->segments[i].radius = radius;
    }
    dpt_result result = dpt_tool_add(scene->world, tool->segments, tool->count, &tool->id);
    put_result("tool_add", result);
    tool->there = result == DPT_OK;
    tool->pose = tool->to = (dpt_pose)DPT_POSE_IDENTITY;
    tool_aim(scene, tool);
}

static void tool_move(struct scene *scene, struct moving_tool *tool)
{
    if (tool->tick++ >= tool->ticks)
        tool_aim(scene, tool);
    if (tool->tick > tool->ticks)
        tool->tick = tool->ticks;
    tool->pose = between(&tool->from, &tool->to, (double)tool->tick / tool->ticks);
    dpt_pose given = tool->pose;
    if (once_in(300))
        given.position[below(3)] = once_in(2) ? NAN : 1e7;
    if (tool->rigid) {
        const int jumps = once_in(80);
        put_result(jumps ? "teleport" : "set_pose", jumps ? dpt_tool_teleport(scene->world, tool->id, &given)
                                                          : dpt_tool_set_pose(scene->world, tool->id, &given));
        return;
    }
    dpt_segment segments[SEGMENTS_MAX];
    for (uint32_t i = 0; i < tool->count; i++) {
        apply(&given, tool->segments[i].a, segments[i].a);
        apply(&given, tool->segments[i].b, segments[i].b);
        segments[i].radius = tool->segments[i].radius;
        if (once_in(4)) /* it bends and swells */
            segments[i].b[below(3)] += scene->scale * in(-0.01, 0.01);
        if (once_in(50))
            segments[i].radius *= in(0.0, 2.0);
    }
    const uint32_t count = once_in(500) ? tool->count - 1 : tool->count;
    if (once_in(80))
        put_result("teleport", dpt_tool_teleport(scene->world, tool->id, &tool->pose));
    put_result("set_segments", dpt_tool_set_segments(scene->world, tool->id, segments, count));
}

static void put_segment(const struct scene *scene, dpt_tool id, uint32_t segment)
{
    dpt_hit hit = DPT_HIT_INIT;
    dpt_sweep sweep = { .size = sizeof sweep };
    uint32_t count = 0, flags = 0;
    dpt_result result = dpt_tool_get_segment_hit(scene->world, id, segment, &hit);
    put_hit("segment_hit", result, &hit);
    met.bounded += hit.status == DPT_STATUS_BOUNDED;
    result = dpt_tool_get_sweep(scene->world, id, segment, &sweep);
    put_sweep(result, &sweep);
    met.swept += sweep.status == DPT_SWEEP_HIT;
    if (!scene->def.strip)
        return;
    memset(overlaps, 0, 1024 * sizeof overlaps[0]);
    overlaps[0].size = sizeof overlaps[0];
    result = dpt_tool_get_strip(scene->world, id, segment, overlaps, 1024, &count, &flags);
    put_overlaps("strip", result, overlaps, count < 1024 ? count : 1024, count, flags);
    met.strips += count > 0;
}

/* All about a tool; 1 if it touches. */
static int put_tool(const struct scene *scene, const struct moving_tool *tool)
{
    static dpt_contact contacts[CONTACTS_MAX];
    dpt_hit hit = DPT_HIT_INIT;
    dpt_wrench wrench = { { 0 }, { 0 } };
    uint32_t count = 0;
    char *more = place + strlen(place);
    const size_t room = (size_t)(place + sizeof place - more);
    snprintf(more, room, " tool %d", (int)(tool - scene->tools));
    dpt_result result = dpt_tool_get_hit(scene->world, tool->id, &hit);
    put_hit("hit", result, &hit);
    met.stale += hit.status == DPT_STATUS_STALE;
    result = dpt_tool_get_wrench(scene->world, tool->id, &wrench);
    put_wrench("wrench", result, &wrench);
    memset(contacts, 0, sizeof contacts);
    contacts[0].size = sizeof contacts[0];
    result = dpt_tool_get_contacts(scene->world, tool->id, contacts, CONTACTS_MAX, &count);
    begin("contacts");
    put_code("result", (int32_t)result);
    put_count("count", count);
    end();
    for (uint32_t i = 0; i < count && i < CONTACTS_MAX; i++)
        put_contact(&contacts[i]);
    met.contacts += count;
    for (uint32_t i = 0; tool->there && i < tool->count; i++) {
        snprintf(more, room, " tool %d.%d", (int)(tool - scene->tools), (int)i);
        put_segment(scene, tool->id, i);
    }
    *more = 0;
    return (hit.flags & DPT_HIT_FLAG_CROSSING) != 0;
}

static void scene_change(struct scene *scene, uint32_t tick, int small)
{
    for (int i = 0; i < BODIES_MAX; i++) {
        struct moving_body *body = &scene->bodies[i];
        if (body->there && !once_in(150)) {
            body_move(scene, body, tick);
        } else if (body->there) {
            put_result("body_remove", dpt_body_remove(scene->world, body->id));
            body->there = 0;
        } else if (once_in(60)) {
            body_add(scene, body, 0, small);
        }
    }
    for (int i = 0; i < TOOLS_MAX; i++) {
        struct moving_tool *tool = &scene->tools[i];
        if (tool->there && !once_in(120)) {
            tool_move(scene, tool);
        } else if (tool->there) {
            put_result("tool_remove", dpt_tool_remove(scene->world, tool->id));
            tool->there = 0;
        } else if (once_in(25)) {
            tool_add(scene, tool);
        }
    }
    if (once_in(250))
        put_result("reset", dpt_world_reset(scene->world));
}

static void world_run(uint32_t number, uint32_t ticks)
{
    struct scene scene;
    memset(&scene, 0, sizeof scene);
    random_state = 0x5eed0000 + number;
    const int small = once_in(3);
    snprintf(place, sizeof place, "world %u", number);
    const struct subject *first;
    const uint64_t kept = random_state; /* the def is drawn to the first body's size */
    do
        first = &subjects[below(subject_count)];
    while (small && first->info.triangles > 2500);
    scene.def = draw_def(first->diagonal, small);
    const size_t bytes = dpt_world_bytes(&scene.def);
    scene.block = malloc(bytes + 64);
    memset(scene.block, 0xa5, bytes + 64);
    dpt_result result = dpt_world_create(scene.block, bytes, &scene.def, &scene.world);
    dpt_world_info info = { .size = sizeof info };
    if (result == DPT_OK)
        dpt_world_get_info(scene.world, &info);
    begin("create");
    put_code("result", (int32_t)result);
    put_count("bytes", bytes);
    put_count("method", scene.def.method);
    put_count("budget", scene.def.budget);
    put_count("kernel", result == DPT_OK ? info.kernel : DPT_KERNEL_AUTO);
    end();
    if (result != DPT_OK) {
        free(scene.block);
        return;
    }
    const uint64_t drawn = random_state;
    random_state = kept;
    body_add(&scene, &scene.bodies[0], 1, small);
    random_state = drawn;
    const int bodies = 1 + (int)below(4), tools = 1 + (int)below(3);
    for (int i = 1; i < bodies; i++)
        body_add(&scene, &scene.bodies[i], 0, small);
    for (int i = 0; i < tools; i++)
        tool_add(&scene, &scene.tools[i]);
    for (uint32_t tick = 0; tick < ticks; tick++) {
        dpt_step step = { .size = sizeof step };
        const double dt = once_in(400) ? in(-1e-3, 0.0) : once_in(5) ? in(1e-4, 1e-2) : 1e-3;
        int crossing = 0;
        snprintf(place, sizeof place, "world %u tick %u", number, tick);
        scene_change(&scene, tick, small);
        result = dpt_world_step(scene.world, dt, &step);
        put_step(result, &step);
        for (int i = 0; i < TOOLS_MAX; i++)
            if (scene.tools[i].there || once_in(20))
                crossing |= put_tool(&scene, &scene.tools[i]);
        met.ticks++;
        met.crossing += crossing != 0;
    }
    met.worlds++;
    free(scene.block);
}

#endif
