/* SPDX-License-Identifier: BSD-3-Clause */
#include "record/plan_text.h"

#include <math.h>

void plan_text_note(struct scene_text *text, const struct measure_setting *setting)
{
    const dpt_world_def *world = &setting->world;
    text->planned = 1;
    text->plan_until = world->until;
    text->plan_certificate_bytes = world->certificate_bytes;
    text->plan_margin = world->margin;
    text->plan_max_contacts = world->max_contacts;
    text->plan_smooth_normals = world->smooth_normals;
    text->plan_sweep_budget = world->sweep_budget;
    text->plan_strip_capacity = world->strip_capacity;
    text->plan_rigid_low = setting->rigid & UINT32_MAX;
    text->plan_rigid_high = setting->rigid >> 32;
    text->plan_integrator = (uint64_t)(setting->integrator + 1);
    text->plan_iterations = setting->iterations;
}

struct measure_setting plan_text_setting(const struct scene_text *text)
{
    struct measure_setting setting = { .parts = 1,
                                       .friction = NAN,
                                       .rigid = text->plan_rigid_low | text->plan_rigid_high << 32,
                                       .integrator = (int32_t)text->plan_integrator - 1,
                                       .iterations = (uint32_t)text->plan_iterations,
                                       .sleep_speed = NAN };
    dpt_world_def *world = &setting.world;
    dpt_world_def_init(world);
    world->until = (uint32_t)text->plan_until;
    world->certificate_bytes = text->plan_certificate_bytes;
    world->margin = text->plan_margin;
    world->max_contacts = (uint32_t)text->plan_max_contacts;
    world->smooth_normals = (uint32_t)text->plan_smooth_normals;
    world->sweep_budget = (uint32_t)text->plan_sweep_budget;
    world->strip_capacity = (uint32_t)text->plan_strip_capacity;
    return setting;
}
