/* SPDX-License-Identifier: BSD-3-Clause */
#include "world/busy_world.h"

#include <math.h>

#include "dynpoint/baseline.h"
#include "lib/fixture.h"
#include "lib/rig.h"

enum { RIGID = 3, SEGMENTS = RIGID + 2, QUERIES = 4 };

/* Made before the ticks, as an application would: the bytes of the meshes and room for a world. */
static struct fixture meshes[BUSY_BODIES];
static void *block;
static size_t block_bytes;

const struct busy_scene busy_scenes[BUSY_SCENES] = {
    { DPT_METHOD_EXACT, DPT_UNTIL_RESPOND, 1, 0, 1 << 20, 2000, DPT_STRIP_KIND_SHADOW },
    { DPT_METHOD_EXACT, DPT_UNTIL_CONTACT, 1, 0, 3 * 264, 1000, 0 }, /* planes push each other out */
    { DPT_METHOD_EXACT, DPT_UNTIL_TRACK, 1, 0, 0, 1000, 0 },
    { DPT_METHOD_TREE, DPT_UNTIL_RESPOND, 1, 0, 0, 1000, DPT_STRIP_KIND_ROUTES },
    { DPT_METHOD_PAPER, DPT_UNTIL_RESPOND, 1, 1, 0, 1000, DPT_STRIP_KIND_ROUTES },
    { DPT_METHOD_PAPER, DPT_UNTIL_CONTACT, 7, 0, 0, 200, DPT_STRIP_KIND_SHADOW },
    { DPT_METHOD_BRUTE, DPT_UNTIL_RESPOND, 1, 0, 0, 20, 0 },
};

static double random_number(struct busy_world *busy)
{
    return random_in(&busy->random, -1.0, 1.0);
}

/* A code that is not DPT_OK: some are asked for, and the tally tells how many. */
static void result_is(struct busy_world *busy, dpt_result result)
{
    busy->tally.refused += result != DPT_OK && dpt_result_text(result) != NULL;
}

static void answer_is(struct busy_world *busy, const void *answer, size_t size)
{
    for (size_t i = 0; i < size; i++)
        busy->tally.answers = (busy->tally.answers ^ ((const unsigned char *)answer)[i]) * 0x100000001b3u;
}

static dpt_pose pose_now(struct busy_world *busy)
{
    dpt_pose pose;
    double size = 0.0;
    for (int k = 0; k < 4; k++)
        size += busy->turn[k] * busy->turn[k];
    for (int k = 0; k < 4; k++)
        pose.orientation[k] = busy->turn[k] / sqrt(size);
    memcpy(pose.position, busy->centre, sizeof pose.position);
    return pose;
}

static dpt_segment segment_now(struct busy_world *busy, double length)
{
    dpt_segment segment = { .radius = 0.002 };
    for (int k = 0; k < 3; k++) {
        segment.a[k] = busy->centre[k] - length * busy->turn[k];
        segment.b[k] = busy->centre[k] + length * busy->turn[k];
    }
    return segment;
}

/* A rigid tool of three parts, a free line, a ball. */
static void add_tool(struct busy_world *busy, int which)
{
    static const dpt_segment rigid[RIGID] = { { { -0.08, 0, 0 }, { 0.08, 0, 0 }, 0.004 },
                                              { { 0.08, 0, 0 }, { 0.1, 0.02, 0 }, 0.002 },
                                              { { 0.08, 0, 0 }, { 0.1, -0.02, 0 }, 0 } };
    static const dpt_segment line = { { -0.1, 0, 0 }, { 0.1, 0, 0 }, 0 };
    static const dpt_segment ball = { { 0, 0, 0.03 }, { 0, 0, 0.03 }, 0.01 };
    const dpt_segment *segments = which == 0 ? rigid : which == 1 ? &line : &ball;
    result_is(busy, dpt_tool_add(busy->world, segments, which == 0 ? RIGID : 1, &busy->tool[which]));
}

int busy_world_open(struct busy_world *busy, const struct busy_scene *scene, uint32_t kernel)
{
    dpt_world_def def = rig_def(DPT_LAW_POINT);
    dpt_baseline_def baseline;
    dpt_baseline_def_init(&baseline);
    def.max_bodies = BUSY_BODIES;
    def.max_tools = BUSY_TOOLS;
    def.max_segments = SEGMENTS;
    def.method = scene->method;
    def.kernel = kernel;
    def.until = scene->until;
    baseline.parts = scene->parts;
    baseline.one_step = scene->one_step;
    def.baseline = &baseline;
    def.certificate_bytes = scene->certificate_bytes;
    def.strip = scene->strip;
    def.margin = 0.01;
    busy->scene = scene;
    dpt_result result = dpt_world_create(block, block_bytes, &def, &busy->world);
    busy->tally.unmade += result != DPT_OK && result != DPT_E_UNSUPPORTED;
    if (result != DPT_OK)
        return 0;
    busy->random = 1;
    for (int k = 0; k < 3; k++)
        busy->centre[k] = busy->way[k] = 0.1 * random_number(busy);
    for (int k = 0; k < 4; k++)
        busy->turn[k] = random_number(busy);
    for (int i = 0; i < BUSY_BODIES; i++) {
        dpt_pose pose = { { 0.1 * i, 0.03 * i, 0.0 }, { 1.0, 0.0, 0.0, 0.0 } };
        const dpt_mesh *mesh = NULL;
        result_is(busy, dpt_mesh_open(meshes[i].compiled.bytes, meshes[i].compiled.size, &mesh));
        result_is(busy, dpt_body_add(busy->world, mesh, &pose, &busy->body[i]));
    }
    for (int i = 0; i < BUSY_TOOLS; i++)
        add_tool(busy, i);
    return 1;
}

/* Through the meshes, which stand about the origin, and out on the other side. */
static void move(struct busy_world *busy, uint32_t tick)
{
    for (int k = 0; k < 3; k++) {
        busy->way[k] += 0.2 * random_number(busy) - 0.02 * busy->way[k] - 0.3 * busy->centre[k];
        busy->centre[k] += 1e-3 * busy->way[k];
    }
    for (int k = 0; k < 4; k++)
        busy->turn[k] = 0.999 * busy->turn[k] + 0.03 * random_number(busy);
    dpt_pose pose = pose_now(busy), body_pose = { { 0.2, 0.06, 0.0 }, { 1.0, 0.0, 0.0, 0.0 } };
    dpt_segment line = segment_now(busy, 0.2);
    body_pose.position[2] = 1e-4 * (double)(tick % 500);
    result_is(busy, dpt_body_set_pose(busy->world, busy->body[2], &body_pose));
    result_is(busy, dpt_tool_set_pose(busy->world, busy->tool[0], &pose));
    result_is(busy, dpt_tool_set_segments(busy->world, busy->tool[1], &line, 1));
    result_is(busy, dpt_tool_set_pose(busy->world, busy->tool[2], &pose));
}

/* What does not happen each tick, or should not. */
static void disturb(struct busy_world *busy, uint32_t tick)
{
    const dpt_pose identity = DPT_POSE_IDENTITY;
    dpt_pose bad = identity;
    dpt_segment line = segment_now(busy, 0.1);
    bad.position[1] = NAN;
    line.b[2] = INFINITY;
    if (tick % 61 == 1)
        result_is(busy, dpt_tool_set_pose(busy->world, busy->tool[0], &bad));
    if (tick % 61 == 2)
        result_is(busy, dpt_tool_set_segments(busy->world, busy->tool[1], &line, 1));
    if (tick % 61 == 3)
        result_is(busy, dpt_body_set_pose(busy->world, busy->body[2], tick % 2 ? &bad : NULL));
    if (tick % 61 == 4)
        result_is(busy, dpt_body_set_pose(busy->world, busy->tool[0], &identity));
    if (tick % 97 == 50)
        result_is(busy, dpt_tool_teleport(busy->world, busy->tool[tick % BUSY_TOOLS], &identity));
    if (tick % 101 == 50) {
        dpt_body *body = &busy->body[tick % BUSY_BODIES];
        result_is(busy, dpt_body_remove(busy->world, *body));
        result_is(busy, dpt_body_set_pose(busy->world, *body, &identity));
        result_is(busy, dpt_body_add(busy->world, meshes[tick % BUSY_BODIES].mesh, &identity, body));
    }
    if (tick % 103 == 50) {
        int which = (int)(tick % BUSY_TOOLS);
        result_is(busy, dpt_tool_remove(busy->world, busy->tool[which]));
        add_tool(busy, which);
    }
    if (tick % 301 == 300)
        result_is(busy, dpt_world_reset(busy->world));
}

static void read_answers(struct busy_world *busy)
{
    for (uint32_t i = 0; i < BUSY_TOOLS; i++) {
        dpt_hit hit = DPT_HIT_INIT, part = DPT_HIT_INIT;
        dpt_wrench wrench;
        dpt_overlap overlaps[4] = { { .size = sizeof *overlaps } };
        uint32_t count;
        result_is(busy, dpt_tool_get_hit(busy->world, busy->tool[i], &hit));
        result_is(busy, dpt_tool_get_segment_hit(busy->world, busy->tool[i], i == 0 ? 2 : 0, &part));
        result_is(busy, dpt_tool_get_wrench(busy->world, busy->tool[i], &wrench));
        answer_is(busy, &hit, sizeof hit);
        answer_is(busy, &part, sizeof part);
        result_is(busy, dpt_tool_get_strip(busy->world, busy->tool[i], 0, overlaps, 4, &count, NULL));
        answer_is(busy, &wrench, sizeof wrench);
        answer_is(busy, overlaps, sizeof overlaps);
        busy->tally.strips += count > 4;
        busy->tally.stale += hit.status == DPT_STATUS_STALE;
        busy->tally.local += hit.status == DPT_STATUS_LOCAL;
        busy->tally.exact += hit.status == DPT_STATUS_EXACT;
        busy->tally.crossing += (hit.flags & DPT_HIT_FLAG_CROSSING) != 0;
        busy->tally.forces += wrench.force[0] != 0.0;
    }
}

/* The calls without a world: of every method, the last of which they refuse. */
static void query(struct busy_world *busy, uint32_t tick)
{
    static const double radii[QUERIES] = { 0.0, 0.001, 0.01, 0.1 };
    const dpt_query_def def = { .size = sizeof def, .method = tick / 8 % 4 };
    const dpt_mesh *mesh = meshes[tick / 32 % BUSY_BODIES].mesh;
    dpt_pose pose = pose_now(busy);
    dpt_hit hits[QUERIES] = { DPT_HIT_INIT };
    double ends[6 * QUERIES], corners[9], s, p[3], q[3];
    for (int i = 0; i < 6 * QUERIES; i++)
        ends[i] = 0.3 * random_number(busy);
    ends[7] = tick % 3 ? ends[7] : NAN;
    result_is(busy,
              dpt_query_segments(mesh, tick % 5 ? &pose : NULL, ends, tick % 7 ? radii : NULL, QUERIES, hits, &def));
    answer_is(busy, hits, sizeof hits);
    result_is(busy, dpt_mesh_get_triangle(mesh, tick, corners));
    double distance = dpt_segment_triangle(ends, ends + 9, &s, p, q);
    answer_is(busy, &distance, sizeof distance);
}

void busy_world_run(struct busy_world *busy, uint32_t begin, uint32_t end)
{
    for (uint32_t tick = begin; tick < end; tick++) {
        dpt_step step = { .size = tick % 59 == 58 ? 4 : sizeof step };
        move(busy, tick);
        disturb(busy, tick);
        if (busy->interrupt && busy->tally.ticks == busy->interrupt_at)
            busy->interrupt(&busy->tally);
        result_is(busy, dpt_world_step(busy->world, tick % 53 == 52 ? NAN : 1e-3, &step));
        read_answers(busy);
        if (tick % 8 == 0)
            query(busy, tick);
        busy->tally.ticks++;
    }
}

int busy_worlds_prepare(void)
{
    static const struct {
        const char *name;
        uint64_t triangles;
    } shapes[BUSY_BODIES] = { { "torus", 1000 }, { "liver", 2000 }, { "membrane", 0 } };
    dpt_world_def def;
    dpt_baseline_def baseline;
    dpt_world_def_init(&def); /* larger in all but the parts */
    def.law = DPT_LAW_POINT;
    dpt_baseline_def_init(&baseline);
    def.method = DPT_METHOD_PAPER;
    def.baseline = &baseline;
    baseline.parts = 16;
    def.strip = DPT_STRIP_KIND_ROUTES;
    block_bytes = dpt_world_bytes(&def);
    block = malloc(block_bytes);
    for (int i = 0; i < BUSY_BODIES; i++)
        if (!fixture_from_shape(&meshes[i], shapes[i].name, shapes[i].triangles))
            return 0;
    return block != NULL;
}

void busy_worlds_free(void)
{
    for (int i = 0; i < BUSY_BODIES; i++)
        fixture_free(&meshes[i]);
    free(block);
}
