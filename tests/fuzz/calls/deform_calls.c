/* SPDX-License-Identifier: BSD-3-Clause */
/* Deformable bodies: added, moved vertex by vertex, asked for vertices and loads; well and badly. */
#include "fuzz/calls/deform_model.h"
#include "fuzz/calls/rules.h"

enum { LOADS_MAX = 1024, TRUE_SLOT = 0, GIVEN_SLOT = 2, LIST_SLOT = 3 };

/* ---- defs ---- */

/* A def as it is handed over, and what it means. */
struct given_def {
    const void *given;
    const struct subject *subject;
    dpt_pose pose;
    int has_pose;
    dpt_deformable_def def;
    struct soft soft; /* its box */
    struct codes codes;
};

/* The caller's own, or none: then vertices go as far as half of the mesh's diagonal, or many, and might farther. */
static void draw_box(struct given_def *of)
{
    dpt_mesh_info info = { .size = sizeof info };
    dpt_mesh_get_info(of->subject->mesh, &info);
    const double wider = (draw_one_in(3) ? 20.0 : 0.5) * apart(info.box_min, info.box_max);
    const int has_box = draw_one_in(2);
    for (int k = 0; k < 3; k++) {
        const double low = info.box_min[k] - (has_box ? draw_in(0.0, 0.1) : wider);
        const double high = info.box_max[k] + (has_box ? draw_in(0.0, 0.1) : wider);
        of->soft.low[k] = (float)low;
        of->soft.high[k] = (float)high;
        of->soft.wall_low[k] = has_box ? (float)low : -(float)DPT_COORDINATE_MAX;
        of->soft.wall_high[k] = has_box ? (float)high : (float)DPT_COORDINATE_MAX;
        of->def.box_min[k] = has_box ? low : 0.0;
        of->def.box_max[k] = has_box ? high : 0.0;
    }
}

static void draw_good_def(struct given_def *of)
{
    static const double periods[] = { 0.0005, 0.001, 0.004, 0.0105, 0.02 };
    CALL(dpt_deformable_def_defaults, &of->def, sizeof of->def);
    of->def.mesh = of->subject->mesh;
    if (draw_one_in(3))
        of->def.max_points = draw_one_in(40) ? 65535 : draw_one_in(2) ? 1000 : 1 + draw_below(40);
    draw_box(of);
    if (draw_one_in(3))
        of->def.period = periods[draw_below(5)];
    if (draw_one_in(2))
        of->def.load_radius = draw_in(0.0, 0.1);
    if (draw_one_in(3)) {
        of->def.response = DPT_RESPONSE_DISPLACE;
        of->def.passes = draw_one_in(8) ? 1024 : 1 + draw_below(20);
    }
}

/* One field, to what it may not be. */
static void spoil_def(struct given_def *of)
{
    const double odd[] = { NAN, -NAN, -1e-9, -1.0, -INFINITY, INFINITY };
    dpt_deformable_def *def = &of->def;
    const int k = (int)draw_below(3), is_high = draw_one_in(2);
    switch (draw_below(8)) {
    case 0:
        def->max_points = draw_one_in(2) ? 0 : 65536;
        break;
    case 1:
        def->mesh = NULL;
        break;
    case 2:
        def->period = odd[draw_below(6)];
        break;
    case 3:
        def->load_radius = odd[draw_below(6)];
        break;
    case 4:
        def->response = 2 + draw_below(3);
        break;
    case 5:
        def->passes = draw_one_in(2) ? 0 : 1025;
        break;
    case 6: /* what is not finite holds nothing either */
        (is_high ? def->box_max : def->box_min)[k] = odd[is_high ? 4 : draw_below(2)];
        may_fail(&of->codes, 1, DPT_E_FINITE);
        break;
    default: /* a box that does not hold the mesh, on one side */
        for (int i = 0; i < 3; i++) {
            def->box_min[i] = (double)of->soft.low[i];
            def->box_max[i] = (double)of->soft.high[i];
        }
        *(is_high ? &def->box_max[k] : &def->box_min[k]) =
            (double)of->subject->positions[draw_below(of->subject->vertices) * 3 + (uint32_t)k] +
            (is_high ? -0.001 : 0.001);
    }
    may_fail(&of->codes, 1, DPT_E_ARGUMENT);
}

static void draw_def(struct given_def *of, const struct subject *subject, int may_be_wrong)
{
    *of = (struct given_def){ .subject = subject };
    draw_good_def(of);
    of->has_pose = draw_one_in(2);
    of->pose = draw_pose(NULL);
    if (may_be_wrong && draw_one_in(4))
        spoil_def(of);
    of->def.pose = of->has_pose ? &of->pose : NULL;
    const uint32_t first = offsetof(dpt_deformable_def, compliance), today = sizeof of->def;
    const uint32_t size = may_be_wrong ? draw_size(first, today) : today;
    of->given = draw_input(LIST_SLOT, &of->def, size, first, today, &of->codes);
}

/* ---- added ---- */

/* How an add may go wrong but for its def. */
struct add_faults {
    int no_world, no_block, no_out, is_off, is_small;
};

static void has_soft(struct scene *scene, const struct given_def *of, struct soft *soft, dpt_body id)
{
    const dpt_pose identity = DPT_POSE_IDENTITY;
    const struct subject *subject = of->subject;
    HOLDS(scene->body_count < BODIES_MAX, "more than the model holds");
    scene_takes_id(scene, &scene->removed_bodies, id);
    soft->def = of->def;
    soft->def.pose = NULL;
    soft->is_affine = 1;
    memcpy(soft->now, subject->positions, 3 * sizeof *soft->now * subject->vertices);
    memcpy(soft->begin, soft->now, sizeof soft->begin);
    memcpy(soft->end, soft->now, sizeof soft->end);
    struct model_body *body = &scene->body[scene->body_count++];
    *body = (struct model_body){ .id = id,
                                 .is_usable = 1,
                                 .pose = of->has_pose ? of->pose : identity,
                                 .side_limit = scene->def.side_limit,
                                 .subject = subject,
                                 .soft = soft };
    if (scene->least.bodies < scene->body_count)
        scene->least.bodies = scene->body_count;
    scene->is_as_stepped = 0;
    soft_must_be_there(scene, body);
}

static void add_one(struct scene *scene, struct given_def *of, const struct add_faults *faults)
{
    dpt_body id[2] = { 0x5a5a5a5a, 0x5a5a5a5a };
    dpt_result result = DPT_OK;
    const size_t bytes = CALL(dpt_deformable_bytes, of->given);
    HOLDS((bytes == 0) == (of->codes.count > 0), "%zu bytes", bytes);
    struct codes codes = of->codes;
    if (of->has_pose)
        pose_codes(&of->pose, &codes);
    may_fail(&codes, faults->no_world || faults->no_block || faults->no_out, DPT_E_ARGUMENT);
    may_fail(&codes, faults->is_off, DPT_E_ALIGN);
    may_fail(&codes, faults->is_small, DPT_E_MEMORY);
    may_fail(&codes, scene->body_count == scene->def.max_bodies, DPT_E_FULL);
    struct soft *soft = malloc(sizeof *soft);
    HOLDS(soft, "memory ran out");
    *soft = of->soft;
    const size_t less = faults->is_small ? 1 + draw_below(bytes > 8 ? 8 : 1) : 0;
    const size_t room = bytes > less ? bytes - less : 64;
    soft_takes_blocks(soft, room, faults->is_off ? 1 + draw_below(7) : 0, scene->world_count);
    call_with("scene %llu, a block of %llu bytes, %llu vertices, response %llu", (uint64_t)(scene - scenes), room,
              of->subject->vertices, of->def.response);
    EACH_WORLD(scene, i)
    SAME_RESULT(i, result,
                RESULT(dpt_body_add_deformable, world_or_null(scene, i, faults->no_world),
                       faults->no_block ? NULL : soft_block(soft, i), room, of->given, faults->no_out ? NULL : &id[i]));
    expect(result, &codes);
    outputs_are_guarded(LIST_SLOT, 1);
    if (result != DPT_OK) {
        HOLDS(id[0] == 0x5a5a5a5a || id[0] == 0, "an id %x on an error", id[0]);
        soft_is_gone(soft);
        return;
    }
    HOLDS(scene->world_count < 2 || id[0] == id[1], "the twin has id %x, and not %x", id[1], id[0]);
    has_soft(scene, of, soft, id[0]);
}

void scene_gets_soft(struct scene *scene, const struct subject *subject)
{
    static const struct add_faults none;
    struct given_def of;
    draw_def(&of, subject, 0);
    add_one(scene, &of, &none);
}

static void add(void)
{
    struct scene *scene = draw_scene();
    const struct add_faults faults = { draw_one_in(60), draw_one_in(60), draw_one_in(60), draw_one_in(30),
                                       draw_one_in(30) };
    struct given_def of;
    if (!scene)
        return;
    draw_def(&of, draw_subject(), 1);
    if (draw_one_in(60)) {
        of.given = NULL;
        may_fail(&of.codes, 1, DPT_E_ARGUMENT);
    }
    add_one(scene, &of, &faults);
}

static void defaults(void)
{
    dpt_deformable_def whole;
    const uint32_t size = draw_size(sizeof whole, sizeof whole);
    const int is_null = draw_one_in(20);
    void *out = output_of_defaults(0, size);
    call_with("size %llu", size, 0, 0, 0);
    CALL(dpt_deformable_def_defaults, is_null ? NULL : out, size);
    CALL(dpt_deformable_def_defaults, &whole, sizeof whole);
    defaults_must_hold(0, size, is_null, &whole, sizeof whole);
}

/* ---- vertices move ---- */

/* Where all vertices are to be: `is_affine` tells that they are an image of the mesh that is not mirrored. */
struct goal {
    float positions[3 * VERTICES_MOST];
    int is_affine;
};

static float clamped(const struct soft *soft, double x, uint32_t axis)
{
    return fminf(fmaxf((float)x, soft->low[axis]), soft->high[axis]);
}

/* As a whole: stretched, sheared and shifted a little. */
static void draw_affine(const struct model_body *body, struct goal *goal)
{
    double map[9], shift[3];
    for (int k = 0; k < 9; k++)
        map[k] = (k % 4 ? 0.0 : 1.0) + draw_in(-0.15, 0.15);
    for (int k = 0; k < 3; k++)
        shift[k] = draw_in(-0.01, 0.01);
    goal->is_affine = 1;
    for (uint32_t v = 0; v < body->subject->vertices; v++)
        for (uint32_t k = 0; k < 3; k++) {
            const float *x = body->subject->positions + 3 * (size_t)v;
            const double to =
                map[3 * k] * (double)x[0] + map[3 * k + 1] * (double)x[1] + map[3 * k + 2] * (double)x[2] + shift[k];
            goal->positions[3 * v + k] = clamped(body->soft, to, k);
            goal->is_affine &= (double)fabsf(goal->positions[3 * v + k] - (float)to) < 1e-9;
        }
}

/* Vertex by vertex: a little, anywhere in the box, onto a plane, a line or a point, or nowhere. */
static void draw_scattered(const struct model_body *body, struct goal *goal)
{
    static const double steps[] = { 0.0002, 0.002, 0.002, 0.01 };
    const struct soft *soft = body->soft;
    const uint32_t kind = draw_below(24), flat = kind == 22 ? 1 + draw_below(3) : 0;
    const double step = steps[draw_below(4)];
    goal->is_affine = 0;
    for (uint32_t k = 0; k < 3 * body->subject->vertices; k++) {
        const double low = (double)soft->low[k % 3], high = (double)soft->high[k % 3];
        const double to = k % 3 < flat ? 0.5 * (low + high)
                          : kind == 23 ? (double)soft->now[k]
                          : kind == 21 ? draw_in(low, high)
                                       : (double)soft->now[k] + draw_in(-step, step);
        goal->positions[k] = clamped(soft, to, k % 3);
    }
}

static void draw_goal(const struct model_body *body, struct goal *goal)
{
    const uint32_t kind = draw_below(8);
    if (kind == 0) {
        memcpy(goal->positions, body->subject->positions, 3 * sizeof(float) * body->subject->vertices);
        goal->is_affine = 1;
    } else if (kind < 4) {
        draw_affine(body, goal);
    } else {
        draw_scattered(body, goal);
    }
}

/* An update as it is handed over: of vertices from `first` on, or of a list. */
struct update {
    struct scene *scene;
    struct model_body *body;
    uint32_t id, first, count;
    int is_list, no_world, no_positions, no_list;
    float *positions;
    uint32_t *list;
    double bound;
    struct goal goal;
    struct codes codes;
};

static uint32_t vertex_of(const struct update *of, uint32_t i)
{
    return of->is_list ? of->list[i] : of->first + i;
}

/* Which vertices; of no body, or too large. */
static void draw_vertices(struct update *of)
{
    const uint32_t vertices = of->body && of->body->soft ? of->body->subject->vertices : 4;
    const int is_all = draw_one_in(2);
    of->count = is_all ? vertices : draw_below(draw_one_in(2) ? 4 : vertices + 1);
    of->first = draw_below(vertices - of->count + 1);
    of->list = output_of(LIST_SLOT, of->count * sizeof *of->list);
    of->positions = output_of(GIVEN_SLOT, 3 * of->count * sizeof *of->positions);
    for (uint32_t i = 0; i < of->count; i++)
        of->list[i] = draw_one_in(2) ? draw_below(vertices) : of->first + i;
    if (draw_one_in(40)) {
        may_fail(&of->codes, !of->is_list || of->count, DPT_E_ARGUMENT);
        of->first = draw_one_in(2) ? UINT32_MAX - draw_below(3) : vertices - of->count + 1;
        for (uint32_t i = 0; of->count && i < 1; i++)
            of->list[draw_below(of->count)] = draw_one_in(2) ? vertices : (uint32_t)draw_bits() | 1u << 31;
    }
}

/* Positions of the goal, at times one that is none. */
static void draw_positions(struct update *of)
{
    const struct soft *soft = of->body->soft;
    const uint32_t vertices = of->body->subject->vertices;
    for (uint32_t i = 0; i < of->count; i++)
        for (uint32_t k = 0; k < 3; k++) {
            const uint32_t vertex = vertex_of(of, i) % vertices;
            of->positions[3 * i + k] = of->goal.positions[3 * vertex + k];
        }
    if (!of->count || !draw_one_in(24))
        return;
    const uint32_t at = draw_below(3 * of->count), axis = at % 3;
    const float width = soft->wall_high[axis] - soft->wall_low[axis];
    const float wrong[] = { NAN,
                            -NAN,
                            INFINITY,
                            -INFINITY,
                            3e38f,
                            nextafterf(soft->wall_high[axis], INFINITY),
                            nextafterf(soft->wall_low[axis], -INFINITY),
                            soft->wall_high[axis] + 0.1f * width + 1e-3f };
    of->positions[at] = wrong[draw_below(8)];
    may_fail(&of->codes, 1, DPT_E_FINITE);
}

/* Measured, or at least the path of each vertex; at times what is no bound. */
static void draw_bound(struct update *of)
{
    double most = 0.0;
    static double path[VERTICES_MOST];
    static float last[3 * VERTICES_MOST];
    const uint32_t vertices = of->body->subject->vertices;
    memset(path, 0, sizeof path);
    memcpy(last, of->body->soft->now, sizeof last);
    for (uint32_t i = 0; i < of->count; i++) {
        double square = 0.0;
        const uint32_t vertex = vertex_of(of, i) % vertices;
        for (uint32_t k = 0; k < 3; k++) {
            const double way = (double)of->positions[3 * i + k] - (double)last[3 * vertex + k];
            square += way * way;
            last[3 * vertex + k] = of->positions[3 * i + k];
        }
        path[vertex] += sqrt(square);
        most = fmax(most, path[vertex]);
    }
    const int is_measured = draw_one_in(2) || !(most <= 1.0); /* a path to nowhere has no bound */
    of->bound = is_measured ? -1.0 : most * (draw_one_in(2) ? 1.0 + 1e-9 : draw_in(1.0, 4.0));
    if (draw_one_in(40)) {
        const double odd[] = { NAN, -INFINITY, -1e300, -1e-310, INFINITY, 1e300 };
        const uint32_t kind = draw_below(6);
        of->bound = odd[kind];
        /* Nothing is said of what is no number, or beyond all lengths. */
        of->codes.or_done = !of->codes.count && (kind == 0 || kind > 3);
        may_fail(&of->codes, kind == 0 || kind > 3, DPT_E_ARGUMENT);
    }
}

static void vertices_have_moved(const struct update *of)
{
    struct soft *soft = of->body->soft;
    const uint32_t vertices = of->body->subject->vertices;
    const int waits = soft->def.period > 0.0;
    float *to = waits ? soft->end : soft->now;
    if (!of->count)
        return;
    met[MET_DEFORMED]++;
    soft->is_affine = of->goal.is_affine && !of->is_list && of->count == vertices && !waits;
    if (waits) {
        met[MET_ON_ITS_WAY]++;
        memcpy(soft->begin, soft->now, sizeof soft->begin);
        soft->is_on_its_way = 1;
        soft->way = 0.0;
    }
    for (uint32_t i = 0; i < of->count; i++)
        memcpy(to + 3 * (size_t)vertex_of(of, i), of->positions + 3 * (size_t)i, 3 * sizeof *to);
}

static dpt_result call_one(const struct update *of, int i)
{
    dpt_world *world = world_or_null(of->scene, i, of->no_world);
    const float *positions = of->no_positions ? NULL : of->positions;
    if (!of->is_list)
        return RESULT(dpt_body_set_vertices, world, of->id, of->first, of->count, positions, of->bound);
    return RESULT(dpt_body_set_vertex_list, world, of->id, of->no_list ? NULL : of->list, of->count, positions,
                  of->bound);
}

static void set_some(struct update *of)
{
    dpt_result result = DPT_OK;
    struct model_body *body = of->body && of->body->soft ? of->body : NULL;
    may_fail(&of->codes, of->no_world || (of->count && (of->no_positions || of->no_list)), DPT_E_ARGUMENT);
    may_fail(&of->codes, !body, DPT_E_HANDLE);
    call_with("scene %llu, id %llx, %llu vertices, list %llu", (uint64_t)(of->scene - scenes), of->id, of->count,
              (uint64_t)of->is_list);
    EACH_WORLD(of->scene, i)
    SAME_RESULT(i, result, call_one(of, i));
    expect(result, &of->codes);
    outputs_are_guarded(GIVEN_SLOT, 2);
    if (result == DPT_OK)
        vertices_have_moved(of);
    if (body)
        soft_must_be_there(of->scene, body);
}

/* Mostly a deformable body's. */
static uint32_t draw_soft_id(struct scene *scene)
{
    uint32_t at = scene->body_count ? draw_below(scene->body_count) : 0;
    for (uint32_t i = 0; i < scene->body_count && !draw_one_in(20); i++, at++)
        if (scene->body[at % scene->body_count].soft)
            return scene->body[at % scene->body_count].id;
    return draw_body_id(scene);
}

static void set_vertices(void)
{
    static struct update of;
    struct scene *scene = draw_scene();
    if (!scene)
        return;
    memset(&of, 0, sizeof of);
    of.scene = scene;
    of.id = draw_soft_id(scene);
    of.body = scene_body(scene, of.id);
    of.is_list = draw_one_in(2);
    of.no_world = draw_one_in(60);
    of.no_positions = draw_one_in(60);
    of.no_list = of.is_list && draw_one_in(60);
    of.bound = -1.0;
    draw_vertices(&of);
    if (of.body && of.body->soft) {
        draw_goal(of.body, &of.goal);
        draw_positions(&of);
        draw_bound(&of);
    }
    set_some(&of);
}

/* Some ticks in which a surface comes to a tool, or goes from it: contacts and loads of what moves. */
static void press(void)
{
    static struct update of;
    struct scene *scene = draw_scene();
    dpt_hit hit = DPT_HIT_INIT;
    struct model_tool *tool = scene && scene->tool_count ? &scene->tool[draw_below(scene->tool_count)] : NULL;
    if (!tool || tool->answers != ANSWERS_THERE)
        return;
    HOLDS(RESULT(dpt_tool_get_hit, scene->world[0], tool->id, &hit) == DPT_OK, "no hit");
    struct model_body *body = scene_body(scene, hit.body);
    if (hit.status == DPT_STATUS_STALE || !body || !body->soft || !body->is_usable)
        return;
    const uint32_t id = body->id, ticks = 1 + draw_below(6), is_whole = draw_below(2);
    double p[3], q[3];
    to_frame(&body->pose, hit.p, p);
    to_frame(&body->pose, hit.q, q);
    const double reach = is_whole ? 1e3 : draw_in(0.005, 0.06), share = draw_in(-0.3, 1.4) / ticks;
    for (uint32_t tick = 0; tick < ticks && scene_body(scene, id); tick++) {
        memset(&of, 0, sizeof of);
        of.scene = scene;
        of.id = id;
        of.body = scene_body(scene, id);
        of.bound = -1.0;
        of.count = of.body->subject->vertices;
        of.positions = output_of(GIVEN_SLOT, 3 * of.count * sizeof *of.positions);
        output_of(LIST_SLOT, 0);
        for (uint32_t k = 0; k < 3 * of.count; k++) {
            double at[3];
            for (uint32_t i = 0; i < 3; i++)
                at[i] = (double)of.body->soft->now[k - k % 3 + i];
            const double near = fmax(0.0, 1.0 - apart(at, q) / reach);
            of.positions[k] = clamped(of.body->soft, at[k % 3] + near * share * (p[k % 3] - q[k % 3]), k % 3);
        }
        set_some(&of);
        scene_steps(scene);
    }
}

/* ---- what is told ---- */

static void get_vertices(void)
{
    struct scene *scene = draw_scene();
    if (!scene)
        return;
    const uint32_t id = draw_soft_id(scene);
    const struct model_body *body = scene_body(scene, id);
    const int no_world = draw_one_in(40), no_out = draw_one_in(40), no_count = draw_one_in(40);
    const float *positions = (const float *)(const void *)&scenes;
    uint32_t count = 77;
    struct codes codes = { .count = 0 };
    may_fail(&codes, no_world || no_out || no_count, DPT_E_ARGUMENT);
    may_fail(&codes, !body || !body->soft, DPT_E_HANDLE);
    call_with("scene %llu, id %llx", (uint64_t)(scene - scenes), id, 0, 0);
    const dpt_result result = RESULT(dpt_body_get_vertices, world_or_null(scene, 0, no_world), id,
                                     no_out ? NULL : &positions, no_count ? NULL : &count);
    expect(result, &codes);
    HOLDS(result == DPT_OK || count == 77 || (!count && !positions), "%u vertices on an error", count);
    if (result != DPT_OK)
        return;
    HOLDS(count == body->subject->vertices, "%u vertices", count);
    soft_must_be_there(scene, body);
    game_digest(positions, 3 * sizeof *positions * count);
}

/* Where there was no room for any point of a tool, the call fails with any capacity. */
static int has_lost_tool(const struct scene *scene, uint32_t id, const struct model_body *body)
{
    static dpt_load loads[1 << 16];
    uint32_t count;
    const int is_full =
        dpt_body_get_loads(scene->world[0], id, loads, 1 << 16, &count) == DPT_E_FULL && count <= 1 << 16;
    HOLDS(!is_full || body->soft->def.max_points < 6 * SEGMENTS_MAX, "%u points are too few",
          body->soft->def.max_points);
    return is_full;
}

static void get_loads(void)
{
    struct scene *scene = draw_scene();
    if (!scene)
        return;
    const uint32_t id = draw_soft_id(scene);
    const struct model_body *body = scene_body(scene, id);
    const int no_world = draw_one_in(60), no_count = draw_one_in(60), no_array = draw_one_in(30);
    uint32_t all = 0, count[2] = { 77, 77 };
    dpt_result result = DPT_OK;
    const int is_soft = body && body->soft;
    if (is_soft)
        dpt_body_get_loads(scene->world[0], id, NULL, 0, &all);
    HOLDS(all <= 1 << 24, "%u loads", all);
    uint32_t capacity = draw_one_in(3) ? draw_below(all + 2) : all + draw_below(4);
    capacity = capacity < LOADS_MAX ? capacity : LOADS_MAX;
    struct codes codes = { .count = 0 };
    may_fail(&codes, no_world || no_count || (no_array && capacity), DPT_E_ARGUMENT);
    may_fail(&codes, !is_soft, DPT_E_HANDLE);
    may_fail(&codes, all > capacity || (is_soft && has_lost_tool(scene, id, body)), DPT_E_FULL);
    call_with("scene %llu, id %llx, %llu loads, capacity %llu", (uint64_t)(scene - scenes), id, all, capacity);
    EACH_WORLD(scene, i)
    {
        dpt_load *out = output_of(i, capacity * sizeof *out);
        SAME_RESULT(i, result,
                    RESULT(dpt_body_get_loads, world_or_null(scene, i, no_world), id, no_array ? NULL : out, capacity,
                           no_count ? NULL : &count[i]));
    }
    expect(result, &codes);
    outputs_are_guarded(0, scene->world_count);
    HOLDS(count[0] == 77 || count[0] == (result == DPT_OK || result == DPT_E_FULL ? all : 0),
          "%u loads, and there are %u", count[0], all);
    if (result != DPT_OK)
        return;
    HOLDS(output_is_untouched(TRUE_SLOT, all * sizeof(dpt_load)), "written behind the last");
    if (scene->world_count == 2)
        outputs_agree(1);
    game_digest(output_at(TRUE_SLOT), all * sizeof(dpt_load));
    loads_must_hold(scene);
}

static const struct move moves[] = {
    { "add", add, 8 },      { "defaults", defaults, 1 },         { "set vertices", set_vertices, 24 },
    { "press", press, 12 }, { "get vertices", get_vertices, 4 }, { "get loads", get_loads, 16 },
    { NULL, NULL, 0 }
};

const struct noun deform_noun = { "deform", NULL, NULL, moves };
