/* SPDX-License-Identifier: BSD-3-Clause */
#include "scene_bodies.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "command_options.h"
#include "shape.h"

void scene_bodies_of_mesh(struct scene_bodies *bodies, const dpt_mesh *mesh)
{
    memset(bodies, 0, sizeof *bodies);
    bodies->body[0] = (struct scene_body){ .mesh = mesh, .pose = DPT_POSE_IDENTITY };
    bodies->count = 1;
}

void scene_bodies_of_arm(struct scene_bodies *bodies, const dpt_arm *arm)
{
    dpt_arm_body from = { .size = sizeof from };
    memset(bodies, 0, sizeof *bodies);
    while (dpt_arm_get_body(arm, bodies->count, &from) == DPT_OK)
        bodies->body[bodies->count++] = (struct scene_body){ .mesh = from.mesh, .pose = from.pose };
}

static int make_body(struct scene_body *body, const char *command, const struct listed_body *listed)
{
    struct shape shape;
    shape_reason reason;
    dpt_compile_def def;
    dpt_compile_def_init(&def);
    def.springs = listed->springs.kind ? &listed->springs : NULL;
    if (shape_make(listed->shape, listed->triangles, 0, &shape, reason))
        return complain(command, "%s", reason);
    dpt_result result = dpt_compile_arrays(shape.vertices, shape.vertex_count, shape.corners,
                                           shape.triangle_count, &def, &body->compiled, NULL);
    shape_free(&shape);
    if (result == DPT_OK)
        result = dpt_mesh_open(body->compiled.bytes, body->compiled.size, &body->mesh);
    body->pose = listed->pose;
    body->integrator = listed->integrator;
    body->load_radius = listed->load_radius;
    return result == DPT_OK ? 0
                            : complain(command, "%s: %s", listed->shape, dpt_result_text(result));
}

int scene_bodies_of_list(struct scene_bodies *bodies, const char *command,
                         const struct listed_scene *listed)
{
    memset(bodies, 0, sizeof *bodies);
    bodies->gravity = listed->gravity;
    for (const struct listed_body *body = listed->bodies; body->shape; body++)
        if (make_body(&bodies->body[bodies->count++], command, body))
            return 2;
    return 0;
}

void scene_bodies_close(struct scene_bodies *bodies)
{
    for (uint32_t i = 0; i < bodies->count; i++) {
        dpt_compiled_free(&bodies->body[i].compiled);
        free(bodies->body[i].block);
        free(bodies->body[i].springs_block);
    }
    bodies->count = 0;
}

/* Row k of a rotation. */
static void row_of(const double q[4], int k, double row[3])
{
    const double w = q[0], x = q[1], y = q[2], z = q[3];
    const double rows[3][3] = {
        { 1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y) },
        { 2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x) },
        { 2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y) }
    };
    memcpy(row, rows[k], sizeof rows[k]);
}

/* Where the box of a body's vertices begins and ends along an axis of the scene. */
static void extent_of(const struct scene_body *body, int k, double *low, double *high)
{
    const float *vertices;
    uint32_t count;
    double row[3];
    row_of(body->pose.orientation, k, row);
    dpt_mesh_get_vertices(body->mesh, &vertices, &count);
    for (size_t v = 0; v < count; v++) {
        const double x = body->pose.position[k] + row[0] * (double)vertices[3 * v] +
                         row[1] * (double)vertices[3 * v + 1] +
                         row[2] * (double)vertices[3 * v + 2];
        *low = fmin(*low, x);
        *high = fmax(*high, x);
    }
}

void scene_bodies_top(const struct scene_bodies *bodies, double top[3])
{
    for (int k = 0; k < 3; k++) {
        double low = HUGE_VAL, high = -HUGE_VAL;
        extent_of(&bodies->body[0], k, &low, &high);
        top[k] = k == 1 ? high : 0.5 * (low + high);
    }
}

/* Of a mesh of this extent: what a load is spread over, where the scene does not say. */
#define LOAD_SHARE 0.05

static double default_radius(const dpt_mesh *mesh)
{
    dpt_mesh_info info = { .size = sizeof info };
    double square = 0.0;
    dpt_mesh_get_info(mesh, &info);
    for (int k = 0; k < 3; k++)
        square += (info.box_max[k] - info.box_min[k]) * (info.box_max[k] - info.box_min[k]);
    return LOAD_SHARE * sqrt(square);
}

static dpt_result add_soft(struct scene_bodies *bodies, struct scene_body *body, dpt_world *world)
{
    dpt_deform_def deform;
    dpt_springs_def springs;
    dpt_deform_def_init(&deform);
    dpt_springs_def_init(&springs);
    deform.mesh = springs.mesh = body->mesh;
    deform.pose = &body->pose;
    deform.load_radius = body->load_radius > 0.0 ? body->load_radius : default_radius(body->mesh);
    springs.integrator = body->integrator;
    for (int k = 0; k < 3; k++) {
        double row[3];
        row_of(body->pose.orientation, 1, row);
        springs.gravity[k] = -bodies->gravity * row[k];
    }
    body->block = malloc(dpt_deform_bytes(&deform));
    body->springs_block = malloc(dpt_springs_bytes(&springs));
    if (!body->block || !body->springs_block)
        return DPT_E_MEMORY;
    const dpt_result result =
        dpt_deform_add(world, body->block, dpt_deform_bytes(&deform), &deform, &body->id);
    return result == DPT_OK ? dpt_springs_create(body->springs_block, dpt_springs_bytes(&springs),
                                                 &springs, &body->springs)
                            : result;
}

dpt_result scene_bodies_add(struct scene_bodies *bodies, dpt_world *world,
                            const struct force_options *options)
{
    dpt_result result = DPT_OK;
    for (uint32_t i = 0; result == DPT_OK && i < bodies->count; i++) {
        struct scene_body *body = &bodies->body[i];
        dpt_mesh_info info = { .size = sizeof info };
        dpt_mesh_get_info(body->mesh, &info);
        result = info.springs ? add_soft(bodies, body, world)
                              : dpt_body_add(world, body->mesh, &body->pose, &body->id);
        if (result == DPT_OK)
            result = force_options_set_body(options, world, body->id);
    }
    return result;
}

dpt_result scene_bodies_step(struct scene_bodies *bodies, dpt_world *world, double dt)
{
    dpt_result result = DPT_OK;
    for (uint32_t i = 0; result == DPT_OK && i < bodies->count; i++) {
        const struct scene_body *body = &bodies->body[i];
        dpt_springs_report report = { .size = sizeof report };
        if (!body->springs)
            continue;
        result = dpt_deform_step_springs(world, body->id, body->springs, dt, &report);
        bodies->nodes += report.nodes;
        bodies->active += report.active;
    }
    return result;
}
