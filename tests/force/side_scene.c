/* SPDX-License-Identifier: BSD-3-Clause */
#include "force/side_scene.h"

#define HALF 1.0 /* m */

enum { ROWS = 3, SAMPLES = 9 };

static const struct {
    const char *name;
    double line[SIDE_KNOTS][2]; /* ends with 0, 0 */
    int is_closed, is_moving, is_soft;
} shapes[SIDE_SHAPES] = {
    { .name = "sheet", .line = { { -HALF, 0 }, { -0.3, 0 }, { -0.1, 0 }, { 0.1, 0 }, { 0.3, 0 }, { HALF, 0 } } },
    /* tan 60 degrees is 1.732: its walls are 60 degrees apart */
    { .name = "groove of 60 degrees",
      .line = { { -HALF, 0.5196 }, { -0.3, 0.5196 }, { 0, 1e-9 }, { 0.3, 0.5196 }, { HALF, 0.5196 } } },
    { .name = "wedge", .line = { { -HALF, -0.4 }, { -0.4, -0.4 }, { 0, 1e-9 }, { 0.4, -0.4 }, { HALF, -0.4 } } },
    { .name = "slot",
      .line = { { -HALF, 0 }, { -0.005, 1e-9 }, { -0.005, -0.06 }, { 0.005, -0.06 }, { 0.005, 1e-9 }, { HALF, 0 } } },
    { .name = "thin wall", .line = { { -HALF, 0 }, { HALF, 0 } }, .is_closed = 1 },
    { .name = "sheet that moves",
      .line = { { -HALF, 0 }, { -0.3, 0 }, { -0.1, 0 }, { 0.1, 0 }, { 0.3, 0 }, { HALF, 0 } },
      .is_moving = 1 },
    { .name = "soft sheet",
      .line = { { -HALF, 0 }, { -0.6, 0 },  { -0.4, 0 },  { -0.3, 0 },  { -0.25, 0 }, { -0.2, 0 },
                { -0.16, 0 }, { -0.12, 0 }, { -0.09, 0 }, { -0.06, 0 }, { -0.03, 0 }, { 1e-9, 0 },
                { 0.03, 0 },  { 0.06, 0 },  { 0.09, 0 },  { 0.12, 0 },  { 0.16, 0 },  { 0.2, 0 },
                { 0.25, 0 },  { 0.3, 0 },   { 0.4, 0 },   { 0.6, 0 },   { HALF, 0 } },
      .is_soft = 1 },
};

int side_shape_moves(int shape)
{
    return shapes[shape].is_moving || shapes[shape].is_soft;
}

static double net_line[SIDE_KNOTS][2];
static uint32_t net_knots;

static void place(double u, double v, double x[3])
{
    const uint32_t k = (uint32_t)(v * (net_knots - 1) + 0.5);
    x[0] = net_line[k][0];
    x[1] = HALF * (2 * u - 1);
    x[2] = net_line[k][1];
}

/* The box from z = -0.1 mm to 0. */
static int make_wall(struct side_scene *scene)
{
    static const uint32_t corners[36] = { 0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                                          2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5 };
    double vertices[24];
    for (int i = 0; i < 8; i++) {
        vertices[3 * i] = i & 1 ? HALF : -HALF;
        vertices[3 * i + 1] = i & 2 ? HALF : -HALF;
        vertices[3 * i + 2] = i & 4 ? 0 : -1e-4;
    }
    return solid_from_arrays(&scene->solid, scene->name, vertices, 8, corners, 12);
}

static int make_mesh(struct side_scene *scene, int shape)
{
    for (uint32_t k = 0; k == 0 || scene->rest[k - 1][0] < HALF; k++) {
        for (int c = 0; c < 2; c++)
            scene->rest[k][c] = net_line[k][c] = (double)(float)shapes[shape].line[k][c];
        scene->knots = net_knots = k + 1;
    }
    memcpy(scene->now, scene->rest, sizeof scene->now);
    return shapes[shape].is_closed ? make_wall(scene)
                                   : solid_from_net(&scene->solid, scene->name, ROWS, net_knots - 1, 0, place);
}

/* A body whose vertices are its knots. */
static int add_soft(struct side_scene *scene)
{
    dpt_deformable_def def;
    const float *rest;
    dpt_deformable_def_init(&def);
    def.mesh = scene->solid.mesh;
    scene->rig.body = rig_add_deformable(&scene->rig, &def);
    dpt_mesh_get_vertices(scene->solid.mesh, &rest, &scene->vertices);
    scene->positions = malloc(3 * (size_t)scene->vertices * sizeof *scene->positions);
    scene->knot_of = malloc(scene->vertices * sizeof *scene->knot_of);
    if (!scene->positions || !scene->knot_of)
        return 0;
    memcpy(scene->positions, rest, 3 * (size_t)scene->vertices * sizeof *rest);
    for (uint32_t v = 0; v < scene->vertices; v++)
        for (uint32_t k = 0; k < scene->knots; k++)
            if ((double)rest[3 * v] == scene->rest[k][0])
                scene->knot_of[v] = k;
    return scene->rig.body != 0;
}

int side_scene_open(struct side_scene *scene, int shape, const dpt_world_def *def, const dpt_segment *segments,
                    uint32_t count, uint64_t seed)
{
    *scene = (struct side_scene){ .name = shapes[shape].name, .seed = seed, .body = DPT_POSE_IDENTITY };
    scene->is_moving = shapes[shape].is_moving;
    scene->is_soft = shapes[shape].is_soft;
    for (int k = 0; k < 3; k++) {
        scene->shift[k] = random_in(&scene->seed, 0, 0.02);
        scene->tilt[k] = random_in(&scene->seed, -1, 1);
        scene->pace[k] = random_in(&scene->seed, 1, 12);
    }
    unit3(scene->tilt);
    scene->height = random_in(&scene->seed, 0.002, 0.02);
    return make_mesh(scene, shape) &&
           rig_open(&scene->rig, def, scene->is_soft ? NULL : scene->solid.mesh, segments, count) &&
           (!scene->is_soft || add_soft(scene));
}

void side_scene_close(struct side_scene *scene)
{
    rig_close(&scene->rig);
    solid_close(&scene->solid);
    free(scene->positions);
    free(scene->knot_of);
}

void side_scene_move(struct side_scene *scene)
{
    const double time = RIG_DT * (double)scene->tick++;
    if (scene->is_moving) {
        for (int k = 0; k < 3; k++)
            scene->body.position[k] = scene->shift[k] * sin(scene->pace[k] * time);
        pose_orient(&scene->body, scene->tilt, 0.2 * sin(scene->pace[0] * time));
        dpt_body_set_pose(scene->rig.world, scene->rig.body, &scene->body);
    }
    if (!scene->is_soft)
        return;
    for (uint32_t k = 0; k < scene->knots; k++) {
        const double x = scene->rest[k][0], fades = 1 / (1 + 20 * x * x);
        scene->now[k][1] = (double)(float)(fades * scene->height * sin(40 * x + scene->pace[0] * time));
    }
    for (uint32_t v = 0; v < scene->vertices; v++)
        scene->positions[3 * v + 2] = (float)scene->now[scene->knot_of[v]][1];
    dpt_body_set_vertices(scene->rig.world, scene->rig.body, 0, scene->vertices, scene->positions, -1.0);
}

double side_scene_top(const struct side_scene *scene)
{
    double top = 0;
    for (uint32_t k = 0; k < scene->knots; k++)
        if (fabs(scene->now[k][0]) < 0.35)
            top = fmax(top, scene->now[k][1]);
    return top;
}

int side_scene_is_front(const struct side_scene *scene, const double x[3])
{
    double p[3];
    int above = 0;
    pose_local(&scene->body, x, p);
    for (uint32_t k = 0; k + 1 < scene->knots; k++) {
        const double *a = scene->now[k], *b = scene->now[k + 1];
        if ((a[0] > p[0]) != (b[0] > p[0]))
            above ^= a[1] + (p[0] - a[0]) / (b[0] - a[0]) * (b[1] - a[1]) > p[2];
    }
    return !above;
}

int side_scene_judge(struct side_scene *scene)
{
    int is_front = 1;
    for (uint32_t i = 0; i < scene->rig.count; i++) {
        double world[6], ends[6], x[3];
        rig_proxy_ends(&scene->rig, i, world);
        for (int n = 0; n < SAMPLES; n++) {
            for (int k = 0; k < 3; k++)
                x[k] = world[k] + n / (SAMPLES - 1.0) * (world[3 + k] - world[k]);
            is_front &= side_scene_is_front(scene, x);
        }
        pose_local(&scene->body, world, ends);
        pose_local(&scene->body, world + 3, ends + 3);
        const double gap =
            scene->is_soft ? 0 : oracle_brute(scene->solid.brute, ends, NULL) - scene->rig.segments[i].radius;
        CHECK(scene->is_soft || gap > 0, "%s, tick %llu: gap %g", scene->name, scene->tick, gap);
        is_front &= gap >= 0;
    }
    CHECK(is_front, "%s, tick %llu: it is behind; reason %u, flags %u", scene->name, scene->tick,
          scene->rig.force.reason, scene->rig.force.flags);
    return is_front;
}
