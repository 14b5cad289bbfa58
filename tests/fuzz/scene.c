/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Scene files: refused with a line or a place and a reason, or numbers that are all in their ranges. Of a scene of few
 * triangles a world is made, which refuses none of them, and takes some steps.
 */
#include "scene/scene_file.h"

#include <math.h>
#include <string.h>

#include "fuzz/fault_check.h"
#include "scene/scene_bodies.h"
#include "scene/shape.h"

/* What is quick enough. */
enum { FEW_TRIANGLES = 300, FEW_REGIONS = 64, STEPS = 3 };

static int is_in(double x, double least, double most)
{
    return x >= least && x <= most;
}

static void check_body(const struct scene_file_body *body)
{
    const struct listed_body *listed = &body->listed;
    const dpt_body_settings *settings = &body->settings;
    const dpt_spring_net_def *springs = &listed->springs;
    double square = 0.0;
    MUST(!body->mesh != !listed->shape);
    MUST(!body->mesh || !springs->kind);
    for (int k = 0; k < 4; k++)
        square += listed->pose.orientation[k] * listed->pose.orientation[k];
    MUST(fabs(square - 1.0) <= 1e-8);
    for (int k = 0; k < 3; k++)
        MUST(fabs(listed->pose.position[k]) <= DPT_COORDINATE_MAX);
    MUST(listed->integrator <= DPT_INTEGRATOR_IMPLICIT && listed->iterations <= 1024);
    MUST(listed->response <= DPT_RESPONSE_DISPLACE && is_in(listed->period, 0.0, 1000.0));
    MUST(listed->response == DPT_RESPONSE_LOAD || springs->kind != DPT_NET_VOLUME);
    MUST(is_in(listed->load_radius, 0.0, DPT_COORDINATE_MAX));
    MUST(is_in(listed->sleep_speed, LISTED_SLEEPS_NEVER, 1e6));
    MUST(is_in(settings->static_friction, 0.0, 10.0));
    MUST(is_in(settings->kinetic_friction, 0.0, settings->static_friction));
    MUST(is_in(settings->stiffness, 0.0, 1e9) && settings->unfelt <= 1);
    MUST(is_in(settings->side_limit, 0.0, DPT_COORDINATE_MAX));
    MUST(is_in(springs->young, 0.0, 1e12) && is_in(springs->density, 0.0, 1e9));
    MUST(is_in(springs->drag, 0.0, 1e9) && is_in(springs->viscosity, 0.0, 1e9));
    MUST(is_in(springs->thickness, 0.0, 1e6) && is_in(springs->bending, 0.0, 1e12));
    MUST(is_in(springs->spacing, 0.0, 1e6) && is_in(springs->poisson, 0.0, 0.45));
}

/* A hull can be made of it. */
static void check_tip(const struct tip_shape *tip)
{
    void *block;
    const dpt_hull *hull;
    for (int k = 0; k < 3; k++) {
        MUST(is_in(tip->extent[k], 0.0, TIP_EXTENT_MAX));
        MUST(is_in(tip->pose.position[k], -TIP_EXTENT_MAX, TIP_EXTENT_MAX));
    }
    MUST(is_in(tip->radius, 0.0, TIP_RADIUS_MAX));
    MUST(!tip_is_round(tip->kind) || !tip->extent[1] || tip->extent[1] == tip->extent[0]);
    MUST(!tip_is_curved(tip->kind) || !tip->radius);
    MUST(is_in(tip_shape_error(tip), 0.0, TIP_EXTENT_MAX));
    MUST(tip_shape_make(tip, &block, &hull) == DPT_OK);
    free(block);
}

static void check_numbers(const struct scene_file *file)
{
    MUST(file->body_count >= 1 && file->body_count <= DPT_ARM_BODIES_MAX);
    MUST(file->segment_count <= DPT_ARM_SEGMENTS_MAX);
    MUST(file->gravity >= 0.0 && file->gravity <= 1000.0);
    MUST(isnan(file->zoom) || (file->zoom > 0.0 && file->zoom <= 1000.0));
    MUST(isnan(file->force_scale) || (file->force_scale >= 1e-3 && file->force_scale <= 1000.0));
    MUST(isnan(file->length) || (file->length >= 0.0 && file->length <= 10.0));
    MUST(isnan(file->radius) || (file->radius >= 0.0 && file->radius <= 1.0));
    MUST(file->tips.count <= TIP_SHAPES_MAX);
    for (uint32_t i = 0; i < file->tips.count; i++)
        check_tip(&file->tips.shape[i]);
    MUST(file->law >= -1 && file->law <= DPT_LAW_PROXY);
    MUST(file->clutch >= -1 && file->clutch <= 31);
    for (int k = 0; k < 3; k++)
        MUST(fabs(file->origin[k]) <= DPT_COORDINATE_MAX);
    for (uint32_t i = 0; i < file->body_count; i++)
        check_body(&file->bodies[i]);
}

static int is_small(const struct scene_file *file)
{
    uint64_t triangles = 0;
    for (uint32_t i = 0; i < file->body_count; i++) {
        const struct listed_body *listed = &file->bodies[i].listed;
        if (!listed->shape || !listed->triangles || listed->springs.kind == DPT_NET_VOLUME ||
            listed->springs.region_count > FEW_REGIONS || listed->iterations > 16)
            return 0;
        triangles += listed->triangles;
    }
    return triangles <= FEW_TRIANGLES;
}

/* Returns 0 for a shape or a material that cannot be had with these numbers. */
static int make_body(struct scene_body *body, const struct scene_file_body *from)
{
    const struct listed_body *listed = &from->listed;
    struct shape shape;
    shape_reason reason;
    dpt_diag diag = { .size = sizeof diag };
    const dpt_compile_def def = { .size = sizeof def, .springs = listed->springs.kind ? &listed->springs : NULL };
    if (shape_make(listed->shape, listed->triangles, 0, &shape, reason))
        return 0;
    const dpt_result result = dpt_compile_arrays(shape.vertices, shape.vertex_count, shape.corners,
                                                 shape.triangle_count, &def, &body->compiled, &diag);
    shape_free(&shape);
    MUST(result == DPT_OK || result == DPT_E_FINITE || result == DPT_E_LIMIT ||
         (result == DPT_E_ARGUMENT &&
          (strstr(diag.text, "holds nothing") || strstr(diag.text, "all of the body is fixed"))));
    if (result != DPT_OK)
        return 0;
    MUST(dpt_mesh_open(body->compiled.bytes, body->compiled.size, &body->mesh) == DPT_OK);
    body->pose = listed->pose;
    body->integrator = listed->integrator;
    body->iterations = listed->iterations;
    body->response = listed->response;
    body->sleep_speed = listed->sleep_speed;
    body->load_radius = listed->load_radius;
    body->period = listed->period;
    body->settings = from->settings;
    return 1;
}

/* Give the tool the file's tips; `blocks` holds them. */
static void add_tips(dpt_world *world, dpt_tool tool, const struct scene_file *file, void *blocks[TIP_SHAPES_MAX])
{
    dpt_tip tips[TIP_SHAPES_MAX];
    for (uint32_t i = 0; i < file->tips.count; i++) {
        tips[i] = (dpt_tip){ .size = sizeof tips[i] };
        MUST(tip_shape_make(&file->tips.shape[i], &blocks[i], &tips[i].hull) == DPT_OK);
    }
    MUST(dpt_tool_set_tips(world, tool, tips, file->tips.count) == DPT_OK);
}

static void take_steps(struct scene_bodies *bodies, const struct scene_file *file)
{
    const uint32_t law = file->tips.count ? DPT_LAW_PROXY : DPT_LAW_BED;
    const struct force_options force = { .law = law, .friction = NAN };
    void *tips[TIP_SHAPES_MAX] = { NULL };
    const dpt_segment stylus = { { 0.0, 0.01, 0.0 }, { 0.0, 0.1, 0.0 }, 0.002 };
    dpt_world_def def;
    dpt_world *world;
    dpt_tool tool;
    dpt_world_def_init(&def);
    def.max_contacts = 32;
    def.max_bodies = bodies->count;
    def.max_tools = 1;
    def.max_segments = file->segment_count ? file->segment_count : 1;
    def.budget = 1000;
    def.law = law;
    def.max_tips = file->tips.count;
    def.strip = scene_bodies_displace(bodies) ? DPT_STRIP_KIND_SHADOW : DPT_STRIP_KIND_NONE;
    void *block = malloc(dpt_world_bytes(&def));
    MUST(block && dpt_world_create(block, dpt_world_bytes(&def), &def, &world) == DPT_OK);
    MUST(scene_bodies_add(bodies, world, &force) == DPT_OK);
    MUST(dpt_tool_add(world, file->segment_count ? file->segments : &stylus, def.max_segments, &tool) == DPT_OK);
    add_tips(world, tool, file, tips);
    for (int i = 0; i < STEPS; i++) {
        MUST(dpt_world_step(world, 1e-3, NULL) == DPT_OK);
        const dpt_result stepped = scene_bodies_step(bodies, world, 1e-3);
        MUST(stepped == DPT_OK || stepped == DPT_E_UNSTABLE || stepped == DPT_E_FINITE);
    }
    free(block);
    for (uint32_t i = 0; i < file->tips.count; i++)
        free(tips[i]);
}

FUZZ_TARGET(scene)
{
    struct scene_file file;
    struct json_fault fault;
    if (!scene_file_parse(&file, "folder/scene.json", (const char *)bytes, size, &fault)) {
        check_fault(&fault, bytes, size);
        scene_file_free(&file);
        return 0;
    }
    fuzz_accepted++;
    MUST(!fault.reason[0]);
    check_numbers(&file);
    if (is_small(&file)) {
        static struct scene_bodies bodies;
        int is_made = 1;
        memset(&bodies, 0, sizeof bodies);
        bodies.gravity = file.gravity;
        for (uint32_t i = 0; i < file.body_count && is_made; i++)
            is_made = make_body(&bodies.body[bodies.count++], &file.bodies[i]);
        if (is_made)
            take_steps(&bodies, &file);
        scene_bodies_close(&bodies);
    }
    scene_file_free(&file);
    return 0;
}
