/* SPDX-License-Identifier: BSD-3-Clause */
#include "host/host_session.h"

#include <math.h>
#include <stdio.h>

#include "base/return_if_error.h"
#include "scene/setting_words.h"

/*
 * The default budget in units of work a second (docs/drivers.md has the time of a unit), and its minimum a tick: with
 * less, a tool at rest may stay undecided.
 */
#define BUDGET_RATE 3e6
#define BUDGET_MIN  200.0

dpt_result host_device_end_fault(dpt_device *device, const char *name, dpt_host_error *error)
{
    dpt_device_info info = { .size = sizeof info };
    dpt_device_state state = { .size = sizeof state };
    dpt_device_get_info(device, &info);
    if (info.flags & DPT_DEVICE_FLAG_DETERMINISTIC || dpt_device_read(device, &state) != DPT_OK ||
        state.status != DPT_DEVICE_STATUS_FAULT)
        return DPT_OK;
    const char *reason = dpt_device_reason_name(state.reasons);
    reason = reason ? reason : "no reason";
    const dpt_result result = dpt_device_clear(device);
    if (result != DPT_OK)
        return host_refuse(error, result, "%s: it has stopped itself (%s): end the cause first", name, reason);
    host_note(error, "%s: it had stopped itself (%s): that is over", name, reason);
    return DPT_OK;
}

/* s: by how much later vertices arrive than physics hands them over: the longest period of what gives way. */
static double physics_delay(const struct scene *scene)
{
    double delay = 0.0;
    for (uint32_t i = 0; i < scene->bodies.count; i++)
        if (scene_body_is_soft(&scene->bodies.body[i]))
            delay = fmax(delay, scene->bodies.body[i].period);
    return delay;
}

/* The controller stands before the guard, and knows what that will let through. */
static void observe(struct host_session *session, const dpt_device_info *device)
{
    const dpt_guard_def *guard = &session->guard;
    dpt_passivity_def def;
    dpt_passivity_def_init(&def);
    def.damping = device->damping;
    def.spin_damping = device->spin_damping;
    def.force_max = fmin(guard->force_max, device->force_max);
    def.torque_max = fmin(guard->torque_max, device->torque_max);
    def.force_slew = guard->force_slew;
    def.torque_slew = guard->torque_slew;
    def.delay = device->delay;
    scene_passivity_begin(&session->scene.passivity, &def);
}

dpt_result host_session_couple(struct host_session *session, const struct host_settings *settings,
                               const dpt_device_info *device, const char *path, dpt_host_error *error)
{
    struct scene *scene = &session->scene;
    struct coupling_options coupling = settings->coupling;
    const double rate = settings->rate > 0.0 ? settings->rate : device->rate;
    const int is_by_clock = !(device->flags & DPT_DEVICE_FLAG_DETERMINISTIC);
    session->rate = rate;
    coupling.rate = rate;
    coupling.loop_delay = (is_by_clock ? HOST_LOOP_DELAY_PERIODS / rate : 0.0) + physics_delay(scene);
    session->budget = settings->budget == HOST_BUDGET_BY_RATE ? (uint32_t)fmax(BUDGET_RATE / rate, BUDGET_MIN)
                                                              : (uint32_t)settings->budget;
    scene->shows_contacts = settings->shows_contacts || scene->force.law != DPT_LAW_PROXY;
    if (scene->physics_rate > 0.0 && !is_by_clock)
        DPT_TRY(scene_physics_check_loop(setting_names_for(scene->command)->physics, scene->physics_rate, device->rate,
                                         error));
    DPT_TRY(host_coupling_choose(scene, device, &coupling, &session->coupling, error));
    DPT_TRY(scene_make_world(scene, device, session->budget, error));
    DPT_TRY(scene_bodies_check_step(&scene->bodies, path,
                                    1.0 / (scene->physics_rate > 0.0 ? scene->physics_rate : rate), error));
    dpt_guard_def_init(&session->guard);
    session->guard.hold = fmax(session->guard.hold, 3.0 / rate);
    if (!isnan(settings->force_max))
        session->guard.force_max = settings->force_max;
    if (!settings->is_active)
        observe(session, device);
    return DPT_OK;
}

static dpt_passivity_def passivity_of_text(const struct scene_text *text)
{
    dpt_passivity_def def;
    dpt_passivity_def_init(&def);
    def.damping = text->passive_damping;
    def.spin_damping = text->passive_spin_damping;
    def.force_max = text->passive_force_max;
    def.torque_max = text->passive_torque_max;
    def.force_slew = text->passive_force_slew;
    def.torque_slew = text->passive_torque_slew;
    def.delay = text->passive_delay;
    return def;
}

dpt_result host_session_restore(struct host_session *session, const struct scene_text *text, dpt_host_error *error)
{
    const dpt_device_info device = { .size = sizeof device,
                                     .flags = (uint32_t)text->device_flags,
                                     .pose_dofs = (uint32_t)text->pose_dofs,
                                     .wrench_dofs = (uint32_t)text->wrench_dofs,
                                     .joints = (uint32_t)text->joints };
    const dpt_passivity_def passivity = passivity_of_text(text);
    struct scene *scene = &session->scene;
    session->budget = (uint32_t)text->budget;
    scene->sweep_budget = (uint32_t)text->sweep_budget;
    DPT_TRY(scene_make_world(scene, &device, session->budget, error));
    scene_passivity_begin(&scene->passivity, text->passivity ? &passivity : NULL);
    return DPT_OK;
}

void host_session_text(const struct host_session *session, const struct scene_def *def, const char *device,
                       struct scene_text *text)
{
    scene_text_of(text, &session->scene, def);
    snprintf(text->device, sizeof text->device, "%s", device);
    text->force_max = session->guard.force_max;
    text->budget = session->budget;
}

dpt_result host_session_start(struct host_session *session, dpt_host_error *error)
{
    struct scene *scene = &session->scene;
    if (!scene->stage.physics || scene->device.flags & DPT_DEVICE_FLAG_DETERMINISTIC ||
        scene_physics_start(scene->stage.physics, session->rate) == DPT_OK)
        return DPT_OK;
    return host_refuse(error, DPT_E_SYSTEM, "%s: there is no thread for it",
                       setting_names_for(scene->command)->physics);
}

void host_session_stop(struct host_session *session)
{
    scene_physics_stop(session->scene.stage.physics);
}

static void count_puts(struct host_puts *puts, const struct scene *scene)
{
    const dpt_force_info *force = &scene->force_info;
    if (scene->force.law != DPT_LAW_PROXY)
        return;
    puts->squeezed += force->reason == DPT_FORCE_INSIDE && (force->flags & DPT_FORCE_FLAG_SQUEEZED);
    puts->turned += (force->flags & DPT_FORCE_FLAG_REPLACED) != 0;
    puts->inside += force->reason == DPT_FORCE_INSIDE || force->reason == DPT_FORCE_UNDECIDED;
}

static void count_needle(struct host_counts *counts, const struct scene *scene)
{
    const struct scene_needle needle = scene_get_needle(scene);
    if (needle.ruptures > counts->open_walls && (scene->force_info.flags & DPT_FORCE_FLAG_RUPTURE))
        counts->ruptures += needle.ruptures - counts->open_walls;
    counts->open_walls = needle.ruptures;
    counts->needle_depth_max = fmax(counts->needle_depth_max, needle.depth);
}

static void count(struct host_session *session, const dpt_loop_sample *sample, const dpt_wrench *wrench)
{
    struct host_counts *counts = &session->counts;
    const struct scene *scene = &session->scene;
    dpt_hit hit = DPT_HIT_INIT;
    double square = 0.0;
    count_puts(&counts->puts, scene);
    count_needle(counts, scene);
    scene_get_hit(scene, &hit);
    counts->reasons |= sample->state->reasons;
    counts->contacts += hit.contact != DPT_CONTACT_SEPARATED;
    counts->penetrating += hit.contact == DPT_CONTACT_PENETRATING;
    counts->unknown += hit.contact == DPT_CONTACT_UNKNOWN;
    for (int k = 0; k < 3; k++)
        square += wrench->force[k] * wrench->force[k];
    counts->depth_max = fmax(counts->depth_max, scene_depth(scene, sqrt(square) / scene->force_scale, hit.depth));
    counts->force_max = fmax(counts->force_max, sqrt(square));
}

dpt_result host_session_feel(struct host_session *session, const dpt_loop_sample *sample, dpt_wrench *wrench)
{
    struct scene *scene = &session->scene;
    const dpt_result result = scene_feel(scene, sample, wrench);
    scene_trouble_note(&session->counts.trouble, scene, sample, result);
    session->counts.clutched += (uint64_t)scene->is_clutched;
    session->counts.stopped += sample->state->status == DPT_DEVICE_STATUS_FAULT;
    if (result == DPT_OK)
        count(session, sample, wrench);
    return result;
}
