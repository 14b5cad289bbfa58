/* SPDX-License-Identifier: BSD-3-Clause */
#include "measure/measure_setting.h"

#include <math.h>

/* Of all tools together: more than any motion needs that a hand can make. */
enum { CONTACTS_OF_RICHEST = 1024 };

#define STIFFNESS          500.0
#define CERTIFICATES_BYTES ((uint64_t)64 << 20)

void measure_setting_init(struct measure_setting *setting, const struct scene *scene)
{
    *setting = (struct measure_setting){
        .parts = 1,
        .friction = scene->force.friction,
        .damping = scene->force.damping,
        .integrator = -1,
        .sleep_speed = NAN,
        .physics = scene->physics_rate,
        .dt = 1e-3,
    };
    dpt_world_def_init(&setting->world);
    setting->world.sweep_budget = 0;
    setting->world.max_contacts = SCENE_CONTACTS;
    setting->world.law = scene->force.law;
    setting->world.stiffness = scene->force.stiffness > 0.0 ? scene->force.stiffness : STIFFNESS;
    if (scene_bodies_displace(&scene->bodies))
        setting->world.strip = DPT_STRIP_KIND_SHADOW;
}

struct measure_setting measure_setting_richest(const struct measure_setting *setting, const struct scene *scene)
{
    struct measure_setting richest;
    measure_setting_init(&richest, scene);
    richest.world.law = setting->world.law;
    if (setting->world.method == DPT_METHOD_PAPER && richest.world.law == DPT_LAW_PROXY)
        richest.world.law = DPT_LAW_POINT;
    richest.world.stiffness = setting->world.stiffness;
    richest.world.margin = setting->world.margin;
    richest.world.onset = setting->world.onset;
    richest.world.side_limit = setting->world.side_limit;
    richest.world.fade = setting->world.fade;
    richest.world.smooth_normals = setting->world.smooth_normals;
    richest.world.kernel = setting->world.kernel;
    richest.world.max_contacts = CONTACTS_OF_RICHEST;
    richest.world.certificate_bytes = CERTIFICATES_BYTES;
    richest.friction = setting->friction;
    richest.damping = setting->damping;
    richest.lock_rotation = setting->lock_rotation;
    richest.dt = setting->dt;
    return richest;
}

const char *measure_setting_fault(const struct measure_setting *setting, const struct scene *scene)
{
    const dpt_world_def *world = &setting->world;
    const int is_proxy = world->law == DPT_LAW_PROXY && world->until == DPT_UNTIL_RESPOND;
    if (world->method == DPT_METHOD_PAPER && is_proxy)
        return "the paper's method has no proxy";
    if (world->method != DPT_METHOD_EXACT && (world->budget || world->sweep_budget))
        return "budgets are for the exact method";
    if (scene->tips.count && !is_proxy)
        return "tips are felt by a proxy alone";
    if (scene_bodies_displace(&scene->bodies) && is_proxy)
        return "what a tool moves out of its way is felt by the laws point and bed";
    return NULL;
}

void measure_setting_change(const struct measure_setting *setting, struct scene_bodies *bodies)
{
    for (uint32_t i = 0; i < bodies->count; i++) {
        struct scene_body *body = &bodies->body[i];
        if (setting->rigid >> i & 1)
            body->is_rigid = 1;
        if (setting->integrator >= 0)
            body->integrator = (uint32_t)setting->integrator;
        if (setting->iterations)
            body->iterations = setting->iterations;
        if (!isnan(setting->sleep_speed))
            body->sleep_speed = setting->sleep_speed > 0.0 ? setting->sleep_speed : -1.0;
    }
}
