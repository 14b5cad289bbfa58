/* SPDX-License-Identifier: BSD-3-Clause */
#include "world/deform_scene.h"

#include "mesh/mesh_format.h"

static void measure(struct deform_scene *scene)
{
    dpt_mesh_info info = { .size = sizeof info };
    double square = 0.0;
    dpt_mesh_get_info(scene->fixture.mesh, &info);
    for (int k = 0; k < 3; k++) {
        scene->low[k] = info.box_min[k];
        scene->high[k] = info.box_max[k];
        square += (info.box_max[k] - info.box_min[k]) * (info.box_max[k] - info.box_min[k]);
    }
    scene->diagonal = sqrt(square);
}

/* Room for all that the motions reach: a fold turns half of the body about its middle. */
static void set_box(const struct deform_scene *scene, dpt_deformable_def *def)
{
    for (int k = 0; k < 3; k++) {
        def->box_min[k] = 0.5 * (scene->low[k] + scene->high[k]) - scene->diagonal;
        def->box_max[k] = 0.5 * (scene->low[k] + scene->high[k]) + scene->diagonal;
    }
}

static int open_world(struct deform_scene *scene, const dpt_world_def *given, const dpt_deformable_def *deform)
{
    dpt_deformable_def def;
    dpt_deformable_def_init(&def);
    if (deform)
        def = *deform;
    else
        set_box(scene, &def);
    def.mesh = scene->fixture.mesh;
    return rig_open(&scene->rig, given, NULL, NULL, 0) && rig_add_deformable(&scene->rig, &def);
}

int deform_scene_open_mesh(struct deform_scene *scene, const dpt_world_def *def, const dpt_deformable_def *deform)
{
    dpt_mesh_get_vertices(scene->fixture.mesh, &scene->rest, &scene->vertices);
    measure(scene);
    const size_t floats = 3 * (size_t)scene->vertices;
    scene->positions = malloc(floats * sizeof *scene->positions);
    scene->next = malloc(floats * sizeof *scene->next);
    scene->changed = malloc(2 * floats * sizeof *scene->changed);
    scene->list = malloc(floats * sizeof *scene->list);
    memcpy(scene->positions, scene->rest, floats * sizeof *scene->positions);
    memcpy(scene->next, scene->rest, floats * sizeof *scene->next);
    scene->step = 1e-3 * scene->diagonal;
    scene->random = 7;
    for (int k = 0; k < 6; k++)
        scene->phase[k] = random_in(&scene->random, 0.0, 6.0);
    return open_world(scene, def, deform);
}

int deform_scene_open(struct deform_scene *scene, const char *shape, uint64_t triangles, const dpt_world_def *def,
                      const dpt_deformable_def *deform)
{
    memset(scene, 0, sizeof *scene);
    return fixture_from_shape(&scene->fixture, shape, triangles) && deform_scene_open_mesh(scene, def, deform);
}

int deform_scene_open_file(struct deform_scene *scene, const char *path, double scale, const dpt_world_def *def)
{
    dpt_compile_def compile;
    dpt_diag diag = { .size = sizeof diag };
    dpt_compile_def_init(&compile);
    compile.scale = scale;
    memset(scene, 0, sizeof *scene);
    dpt_result result = dpt_compile_file(path, &compile, &scene->fixture.compiled, &diag);
    if (result == DPT_OK)
        result = dpt_mesh_open(scene->fixture.compiled.bytes, scene->fixture.compiled.size, &scene->fixture.mesh);
    CHECK(result == DPT_OK, "%s: %s", path, diag.text);
    return result == DPT_OK && deform_scene_open_mesh(scene, def, NULL);
}

void deform_scene_close(struct deform_scene *scene)
{
    free(scene->positions);
    free(scene->next);
    free(scene->changed);
    free(scene->list);
    rig_close(&scene->rig);
    fixture_free(&scene->fixture);
}

/* Displacements in units of the diagonal, of a place in the same units from the middle. */
static void modes_at(const struct deform_scene *scene, const double x[3], double amplitude, double moved[3])
{
    const double *p = scene->phase, t = scene->time;
    moved[0] = amplitude * sin(p[0] + t + 7.0 * x[0] + 3.0 * x[1]);
    moved[1] = amplitude * sin(p[1] + t + 5.0 * x[2]);
    moved[2] = amplitude * sin(p[2] + t + 6.0 * x[1] + 2.0 * x[0]);
}

static void dent_at(const struct deform_scene *scene, const double x[3], double amplitude, double moved[3])
{
    const double *p = scene->phase, t = scene->time;
    const double at[3] = { 0.3 * sin(p[0] + 0.1 * t), 0.3 * sin(p[1] + 0.13 * t), 0.2 * sin(p[2] + 0.07 * t) };
    double square = 0.0;
    for (int k = 0; k < 3; k++)
        square += (x[k] - at[k]) * (x[k] - at[k]);
    for (int k = 0; k < 3; k++)
        moved[k] = square < 0.04 ? amplitude * (1.0 - 25.0 * square) * sin(t + p[k + 3]) : 0.0;
}

/* The part beyond the middle turns about it, by any angle. */
static void fold_at(const struct deform_scene *scene, const double x[3], double amplitude, double moved[3])
{
    const double angle = 6.0 * amplitude * scene->time * (x[0] > 0.0 ? 1.0 : 0.0);
    moved[0] = x[0] * cos(angle) - x[2] * sin(angle) - x[0];
    moved[1] = 0.0;
    moved[2] = x[0] * sin(angle) + x[2] * cos(angle) - x[2];
}

void deform_scene_advance(struct deform_scene *scene)
{
    /* The phase grows by so little that speeds are `step` a tick for an amplitude of 20 steps. */
    const double turn = 0.05, amplitude = scene->step / turn / scene->diagonal;
    scene->time += turn;
    for (uint32_t v = 0; v < scene->vertices; v++) {
        double x[3], moved[3] = { 0.0, 0.0, 0.0 };
        for (int k = 0; k < 3; k++)
            x[k] =
                ((double)scene->rest[3 * v + (uint32_t)k] - 0.5 * (scene->low[k] + scene->high[k])) / scene->diagonal;
        if (scene->kind == DEFORM_MODES)
            modes_at(scene, x, amplitude, moved);
        else if (scene->kind == DEFORM_DENT)
            dent_at(scene, x, amplitude, moved);
        else if (scene->kind == DEFORM_FOLD)
            fold_at(scene, x, amplitude, moved);
        else
            for (int k = 0; k < 3; k++)
                moved[k] = 2.0 * amplitude * sin(scene->time) * x[k];
        for (int k = 0; k < 3; k++)
            scene->next[3 * v + (uint32_t)k] =
                (float)((double)scene->rest[3 * v + (uint32_t)k] + scene->diagonal * moved[k]);
    }
}

/* The largest motion of any vertex. */
static double largest_motion(const struct deform_scene *scene)
{
    double largest = 0.0;
    for (uint32_t v = 0; v < scene->vertices; v++) {
        double square = 0.0;
        for (uint32_t k = 0; k < 3; k++) {
            const double moved = (double)scene->next[3 * v + k] - (double)scene->positions[3 * v + k];
            square += moved * moved;
        }
        largest = fmax(largest, sqrt(square));
    }
    return largest;
}

/* Only those that moved, in the order of a shuffle, some of them twice. */
static dpt_result set_list(struct deform_scene *scene)
{
    uint32_t count = 0;
    for (uint32_t v = 0; v < scene->vertices; v++)
        if (memcmp(scene->next + 3 * v, scene->positions + 3 * v, 3 * sizeof(float)))
            scene->list[count++] = v;
    for (uint32_t i = count; i > 1; i--) {
        const uint32_t j = (uint32_t)(random_bits(&scene->random) % i), swapped = scene->list[j];
        scene->list[j] = scene->list[i - 1];
        scene->list[i - 1] = swapped;
    }
    for (uint32_t i = 0; i < count / 8; i++)
        scene->list[count + i] = scene->list[i];
    count += count / 8;
    for (uint32_t i = 0; i < count; i++)
        memcpy(scene->changed + 3 * (size_t)i, scene->next + 3 * (size_t)scene->list[i], 3 * sizeof(float));
    return dpt_body_set_vertex_list(scene->rig.world, scene->rig.body, scene->list, count, scene->changed, -1.0);
}

/* Three ranges, of which the second goes somewhere else first. */
static dpt_result set_ranges(struct deform_scene *scene)
{
    const uint32_t third = scene->vertices / 3, from[4] = { 0, third, 2 * third, scene->vertices };
    dpt_result result =
        dpt_body_set_vertices(scene->rig.world, scene->rig.body, from[1], from[2] - from[1], scene->rest, -1.0);
    for (int k = 0; k < 3 && result == DPT_OK; k++)
        result = dpt_body_set_vertices(scene->rig.world, scene->rig.body, from[k], from[k + 1] - from[k],
                                       scene->next + 3 * (size_t)from[k], -1.0);
    return result;
}

void deform_scene_set(struct deform_scene *scene, enum deform_form form)
{
    dpt_result result;
    if (form == DEFORM_LIST)
        result = set_list(scene);
    else if (form == DEFORM_RANGES)
        result = set_ranges(scene);
    else
        result = dpt_body_set_vertices(scene->rig.world, scene->rig.body, 0, scene->vertices, scene->next,
                                       form == DEFORM_BOUNDED ? largest_motion(scene) : -1.0);
    CHECK(result == DPT_OK, "%s, form %d", dpt_result_name(result), form);
    memcpy(scene->positions, scene->next, 3 * sizeof(float) * (size_t)scene->vertices);
}

int deform_scene_triangle(const struct deform_scene *scene, uint32_t number, double corners[9])
{
    const struct dpt_mesh *mesh = scene->fixture.mesh;
    const uint32_t place = mesh_words(mesh, MESH_PLACES)[number];
    if (place >= mesh->triangles)
        return 0;
    for (uint32_t k = 0; k < 9; k++)
        corners[k] =
            (double)scene->positions[3 * (size_t)mesh_words(mesh, MESH_TRIANGLES)[3 * (size_t)place + k / 3] + k % 3];
    return 1;
}
