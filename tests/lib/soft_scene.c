/* SPDX-License-Identifier: BSD-3-Clause */
#include "lib/soft_scene.h"

#include <math.h>

#include "scene/scene_list.h"
#include "scene/scene_physics.h"

#define RADIUS 0.004 /* m, of the ball */

static int open_world(struct soft_scene *scene, uint32_t law)
{
    const dpt_segment ball = { { 0.0, 0.0, 0.0 }, { 0.0, 0.0, 0.0 }, RADIUS };
    const struct force_options options = { .law = law, .stiffness = 100.0, .friction = NAN };
    dpt_world_def def = rig_def(law);
    def.max_bodies = scene->bodies.count;
    if (!rig_open(&scene->rig, &def, NULL, &ball, 1))
        return 0;
    dpt_result result = scene_bodies_add(&scene->bodies, scene->rig.world, &options);
    if (result == DPT_OK)
        result = force_options_set_tool(&options, scene->rig.world, scene->rig.tool, 1);
    CHECK(result == DPT_OK, "%s", dpt_result_name(result));
    return result == DPT_OK;
}

int soft_scene_open(struct soft_scene *scene, const char *name, double rate, uint32_t law)
{
    struct file_identity identity = { .bytes = 0 };
    memset(scene, 0, sizeof *scene);
    dpt_host_error error = { .size = sizeof error };
    if (scene_bodies_of_list(&scene->bodies, scene_listed(name), &identity, &error) != DPT_OK ||
        (rate > 0.0 && scene_physics_choose(&scene->bodies, name, "physics", rate, &error) != DPT_OK) ||
        !open_world(scene, law)) {
        CHECK(0, "%s at %g Hz does not open: %s", name, rate, error.text);
        return 0;
    }
    scene_bodies_top(&scene->bodies, scene->top);
    scene->pose = (dpt_pose)DPT_POSE_IDENTITY;
    soft_scene_press(scene, -0.001);
    dpt_tool_teleport(scene->rig.world, scene->rig.tool, &scene->pose);
    return 1;
}

void soft_scene_close(struct soft_scene *scene)
{
    rig_close(&scene->rig);
    scene_bodies_close(&scene->bodies);
}

void soft_scene_press(struct soft_scene *scene, double depth)
{
    memcpy(scene->pose.position, scene->top, sizeof scene->top);
    scene->pose.position[1] += RADIUS - depth;
    if (scene->rig.world)
        dpt_tool_set_pose(scene->rig.world, scene->rig.tool, &scene->pose);
}

void soft_scene_step(struct soft_scene *scene)
{
    rig_tick(&scene->rig);
}

const float *soft_scene_vertices(const struct soft_scene *scene, uint32_t *count)
{
    const float *vertices = NULL;
    dpt_body_get_vertices(scene->rig.world, scene->bodies.body[0].id, &vertices, count);
    return vertices;
}
