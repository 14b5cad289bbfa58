/* SPDX-License-Identifier: BSD-3-Clause */
#include "lab/hum_scene.h"

#include <string.h>

#include "base/quaternion.h"
#include "cli/command_options.h"
#include "scene/scene_list.h"

/* m: of the surface of a tool above what it comes down on. */
#define ABOVE 0.002

/* Of an organ: m in its unit, and the share of its height that is fixed. */
#define MILLIMETRE 1e-3
#define FIXED      0.3

static double mean_edge(const dpt_mesh *mesh)
{
    const float *vertices;
    const uint32_t *corners;
    uint32_t vertex_count, triangles = 0;
    double sum = 0.0;
    dpt_mesh_get_vertices(mesh, &vertices, &vertex_count);
    dpt_mesh_get_triangles(mesh, &corners, NULL, &triangles);
    for (size_t i = 0; i < 3 * (size_t)triangles; i++) {
        const size_t from = corners[i], to = corners[i % 3 < 2 ? i + 1 : i - 2];
        sum += length(sub(vec3_of_float(vertices + 3 * to), vec3_of_float(vertices + 3 * from)));
    }
    return sum / (3.0 * (double)triangles);
}

/* An organ lies with its thinnest side up: what turns x, y and z there. */
static const double upwards[3][4] = { { 0.70710678118654752, 0.0, 0.0, 0.70710678118654752 },
                                      { 1.0, 0.0, 0.0, 0.0 },
                                      { 0.70710678118654752, -0.70710678118654752, 0.0, 0.0 } };

static int thinnest_of(const dpt_mesh_info *info)
{
    int thinnest = 0;
    for (int k = 1; k < 3; k++)
        if (info->box_max[k] - info->box_min[k] < info->box_max[thinnest] - info->box_min[thinnest])
            thinnest = k;
    return thinnest;
}

/* Where an organ that lies so is highest. */
static void highest(const struct scene_body *body, int up, double place[3])
{
    const float *vertices;
    uint32_t count, best = 0;
    dpt_mesh_get_vertices(body->mesh, &vertices, &count);
    for (uint32_t v = 0; v < count; v++)
        if (vertices[3 * v + (uint32_t)up] > vertices[3 * best + (uint32_t)up])
            best = v;
    vec3_store(vec3_of_float(vertices + 3 * (size_t)best), place);
    quaternion_rotate(body->pose.orientation, place, place);
}

static void settle(struct hum_scene *scene)
{
    scene->is_soft = scene_body_is_soft(&scene->bodies.body[0]);
    scene->integrator = scene->bodies.body[0].integrator;
    scene->edge = mean_edge(scene->bodies.body[0].mesh);
}

int hum_scene_open(struct hum_scene *scene, const char *name)
{
    const struct listed_scene *listed = scene_listed(name);
    struct file_identity identity = { .bytes = 0 };
    dpt_host_error error = { .size = sizeof error };
    memset(scene, 0, sizeof *scene);
    if (complain_of("stability", scene_bodies_of_list(&scene->bodies, listed, &identity, &error), &error))
        return 0;
    settle(scene);
    scene->length = listed->length;
    scene->radius = listed->radius;
    scene->is_below = listed->gravity > 0.0;
    scene->is_needle = listed->is_needle != 0;
    scene_bodies_top(&scene->bodies, scene->start);
    scene->start[1] += ABOVE;
    if (listed->has_origin && !scene->is_below) {
        memcpy(scene->start, listed->origin, sizeof scene->start);
        scene->start[1] -= listed->radius;
    }
    if (scene->is_below)
        scene->start[1] = listed->origin[1] + listed->radius;
    return 1;
}

/* Compile with springs, or without any for the box alone. */
static int compile(struct scene_body *body, const char *path, const dpt_spring_net_def *springs)
{
    dpt_compile_def def;
    dpt_compile_def_init(&def);
    def.scale = MILLIMETRE;
    def.springs = springs;
    return dpt_compile_file(path, &def, &body->compiled, NULL) == DPT_OK &&
           dpt_mesh_open(body->compiled.bytes, body->compiled.size, &body->mesh) == DPT_OK;
}

int hum_scene_open_organ(struct hum_scene *scene, const char *path)
{
    const struct listed_scene *like = scene_listed("soft-liver");
    struct scene_body *body = &scene->bodies.body[0];
    dpt_spring_region bed = { .kind = DPT_REGION_BOX, .fixed = 1 };
    dpt_spring_net_def springs = like->bodies[0].springs;
    dpt_mesh_info info = { .size = sizeof info };
    memset(scene, 0, sizeof *scene);
    scene->bodies.count = 1;
    body->pose = (dpt_pose)DPT_POSE_IDENTITY;
    body->load_radius = like->bodies[0].load_radius;
    if (!compile(body, path, NULL))
        return 0;
    dpt_mesh_get_info(body->mesh, &info);
    dpt_compiled_free(&body->compiled);
    for (int k = 0; k < 3; k++) {
        bed.box[k] = info.box_min[k] - ABOVE;
        bed.box[k + 3] = info.box_max[k] + ABOVE;
    }
    const int up = thinnest_of(&info);
    bed.box[up + 3] = info.box_min[up] + FIXED * (info.box_max[up] - info.box_min[up]);
    memcpy(body->pose.orientation, upwards[up], sizeof upwards[up]);
    springs.regions = &bed;
    springs.region_count = 1;
    if (!compile(body, path, &springs))
        return 0;
    settle(scene);
    scene->length = like->length;
    scene->radius = like->radius;
    highest(body, up, scene->start);
    scene->start[1] += ABOVE;
    return 1;
}

void hum_scene_close(struct hum_scene *scene)
{
    scene_bodies_close(&scene->bodies);
}
