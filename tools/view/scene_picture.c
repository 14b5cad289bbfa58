/* SPDX-License-Identifier: BSD-3-Clause */
#include "view/scene_picture.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "view/view_scene.h"

enum { NAME_BYTES = 24 };

/* The box round the device's workspace, as it lies in the scene. */
static void map_workspace(const struct scene *scene, double box[6])
{
    for (int k = 0; k < 3; k++) {
        box[k] = HUGE_VAL;
        box[3 + k] = -HUGE_VAL;
    }
    for (int corner = 0; corner < 8; corner++) {
        double at[3];
        for (int k = 0; k < 3; k++)
            at[k] = corner >> k & 1 ? scene->device.workspace_max[k] : scene->device.workspace_min[k];
        scene_of_device(scene, at, at);
        for (int k = 0; k < 3; k++) {
            box[k] = fmin(box[k], at[k]);
            box[3 + k] = fmax(box[3 + k], at[k]);
        }
    }
}

static int has_workspace(const struct scene *scene)
{
    for (int k = 0; k < 3; k++)
        if (!(scene->device.workspace_min[k] < scene->device.workspace_max[k]))
            return 0;
    return 1;
}

void *scene_picture_message(const struct scene *scene, const struct scene_picture *picture, size_t *size)
{
    const struct scene_bodies *bodies = &scene->bodies;
    struct view_scene_body *list = calloc(bodies->count, sizeof *list);
    char(*names)[NAME_BYTES] = calloc(bodies->count, sizeof *names);
    void *message = NULL;
    struct view_scene told = { .title = picture->title,
                               .mode = picture->mode,
                               .device = picture->device,
                               .is_simulated = (scene->device.flags & DPT_DEVICE_FLAG_SIMULATED) != 0,
                               .has_workspace = has_workspace(scene),
                               .rate = picture->rate,
                               .has_control = picture->has_control,
                               .up = scene->arm ? "z" : "y",
                               .camera = scene->has_camera ? scene->camera : NULL,
                               .force_max = picture->force_max,
                               .bodies = list,
                               .body_count = bodies->count };
    map_workspace(scene, told.workspace);
    for (uint32_t i = 0; list && names && i < bodies->count; i++) {
        const struct scene_body *body = &bodies->body[i];
        snprintf(names[i], sizeof names[i], "body %u", (unsigned)i);
        list[i] = (struct view_scene_body){ .name = body->name ? body->name : names[i],
                                            .mesh = body->mesh,
                                            .id = body->id,
                                            .pose = body->pose,
                                            .colour = body->has_colour ? body->colour : NULL };
    }
    if (list && names)
        message = view_scene_message(&told, size);
    free(list);
    free(names);
    return message;
}

uint32_t scene_picture_vertices(const struct scene *scene)
{
    uint32_t sum = 0;
    for (uint32_t i = 0; i < scene->bodies.count; i++) {
        dpt_mesh_info info = { .size = sizeof info };
        if (scene->bodies.body[i].springs && !dpt_mesh_get_info(scene->bodies.body[i].mesh, &info))
            sum += info.vertices;
    }
    return sum;
}

struct view_tick scene_picture_tick(const struct scene *scene, const dpt_loop_sample *sample, double time, double took)
{
    dpt_force_info report = { .size = sizeof report };
    dpt_hit hit = DPT_HIT_INIT;
    double square = 0.0;
    scene_get_force_info(scene, &report);
    scene_get_hit(scene, &hit);
    for (int k = 0; k < 3; k++)
        square += report.wrench.force[k] * report.wrench.force[k];
    return (struct view_tick){ .time = time,
                               .force = (float)sqrt(square),
                               .depth = (float)scene_depth(scene, sqrt(square), hit.depth),
                               .energy = (float)report.energy,
                               .late = (float)sample->late,
                               .took = (float)took,
                               .contact = hit.contact,
                               .reason = report.reason };
}
