/* SPDX-License-Identifier: BSD-3-Clause */
#include "plan/plan_scene.h"

#include <inttypes.h>
#include <math.h>

#include "base/crc32.h"
#include "cli/command_options.h"

void plan_scene_def(const struct plan *plan, struct scene_def *def)
{
    def->path = plan->scene;
    if (isnan(def->length))
        def->length = plan->length;
    if (isnan(def->radius))
        def->radius = plan->radius;
    if (isnan(def->force.friction))
        def->force.friction = plan->setting.friction;
    if (def->force.damping == 0.0)
        def->force.damping = plan->setting.damping;
}

void plan_meshes_of(struct plan *plan, const struct scene *scene)
{
    plan->mesh_count = scene->bodies.count;
    for (uint32_t i = 0; i < plan->mesh_count; i++) {
        const dpt_mesh *mesh = scene->bodies.body[i].mesh;
        const float *vertices;
        const uint32_t *corners, *numbers;
        uint32_t count;
        struct crc32 crc;
        crc32_init(&crc);
        dpt_mesh_get_vertices(mesh, &vertices, &count);
        plan->mesh[i].crc32 = crc32_more(&crc, 0, vertices, (size_t)count * 3 * sizeof *vertices);
        dpt_mesh_get_triangles(mesh, &corners, &numbers, &count);
        plan->mesh[i].crc32 = crc32_more(&crc, plan->mesh[i].crc32, corners, (size_t)count * 3 * sizeof *corners);
        plan->mesh[i].triangles = count;
    }
}

int plan_scene_check(const struct plan *plan, const struct scene *scene, const char *path)
{
    struct plan here = { .mesh_count = 0 };
    plan_meshes_of(&here, scene);
    if (here.mesh_count != plan->mesh_count)
        return complain(scene->command, "%s: its scene has %" PRIu32 " bodies, and %s has %" PRIu32, path,
                        plan->mesh_count, plan->scene, here.mesh_count);
    for (uint32_t i = 0; i < here.mesh_count; i++)
        if (here.mesh[i].crc32 != plan->mesh[i].crc32)
            return complain(scene->command, "%s: meshes[%" PRIu32 "]: another mesh than now in %s: plan again", path, i,
                            plan->scene);
    if (scene->file.bytes != plan->identity.bytes || scene->file.crc32 != plan->identity.crc32)
        return complain(scene->command, "%s: %s or its meshes have changed since: plan again", path, plan->scene);
    return 0;
}
