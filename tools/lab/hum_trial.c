/* SPDX-License-Identifier: BSD-3-Clause */
#include "lab/hum_trial.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/sincos.h"
#include "base/vec3.h"
#include "measure/hum.h"

enum { CONTACTS = 32, APPROACH_MAX = 4000, FALLING = 1500, SETTLING = 1000, ONSET = 60, PAUSE = 100, ROOM = 8192 };

#define SPEED    5e-5 /* m a tick: the fastest device, and one that presses */
#define PRESSING 2e-5
#define ACROSS   0.016 /* m: of a wipe */
#define LYING    89.0  /* degrees: from here on a tool lies on its middle */
#define SUBSTEPS 0.9   /* of the stable step, that a substep takes at most */

/* Ticks in which a way of this length is gone once, or to and fro, at no more than a speed. */
static size_t ticks_once(double way)
{
    return (size_t)ceil(2.0 * way / SPEED);
}

static size_t ticks_to_and_fro(double way, double speed)
{
    return (size_t)ceil(3.15 * way / speed);
}

/* From 0 to 1 without a jerk; from 0 to 1 and back. */
static double once(size_t tick, size_t ticks)
{
    double sine, cosine;
    if (tick >= ticks)
        return 1.0;
    const double share = (double)tick / (double)ticks;
    turn_sincos(share, &sine, &cosine);
    return share - sine / 6.283185307179586;
}

static double to_and_fro(size_t tick, size_t ticks)
{
    double sine, cosine;
    turn_sincos(tick < ticks ? (double)tick / (double)ticks : 0.0, &sine, &cosine);
    return 0.5 * (1.0 - cosine);
}

/* What follows the touch; ticks of all of it, and where the device is: m down, and m across. */
static size_t path_of(const struct hum_trial *trial, size_t tick, double *down, double *across)
{
    const int is_below = trial->scene->is_below;
    const double way = is_below ? -trial->depth : trial->depth;
    const size_t sinking = is_below ? FALLING : ticks_once(trial->depth),
                 pressing = ticks_to_and_fro(trial->depth, PRESSING);
    const size_t wiping = ticks_to_and_fro(ACROSS, SPEED), waited = is_below ? FALLING : 0, still = sinking + PAUSE;
    *across = 0.0;
    *down = is_below ? 0.0 : trial->depth * once(tick, sinking);
    if (trial->hand == HUM_STILL)
        return sinking + SETTLING + trial->still_ticks;
    if (trial->hand == HUM_WIPE) {
        *across = tick > still ? ACROSS * to_and_fro(tick - still, wiping) : 0.0;
        return still + wiping;
    }
    *down = tick > waited ? way * to_and_fro(tick - waited, pressing) : 0.0;
    return waited + pressing;
}

static dpt_result add_bodies(struct hum_trial *trial)
{
    const struct force_options options = { .law = DPT_LAW_PROXY, .friction = NAN };
    struct scene_bodies *bodies = &trial->scene->bodies;
    dpt_body_settings settings = { .size = sizeof settings };
    bodies->body[0].integrator = trial->integrator;
    dpt_result result = scene_stage_add_bodies(&trial->stage, bodies, &options, 0.0);
    for (uint32_t i = 0; result == DPT_OK && i < bodies->count; i++) {
        dpt_body_get_settings(trial->stage.world, bodies->body[i].id, &settings);
        settings.unfelt = i > 0 && !trial->is_usual;
        if (i == 0 && trial->static_friction > 0.0) {
            settings.static_friction = trial->static_friction;
            settings.kinetic_friction = trial->kinetic_friction;
        }
        result = dpt_body_set_settings(trial->stage.world, bodies->body[i].id, &settings);
    }
    return result;
}

static dpt_result add_tool(struct hum_trial *trial)
{
    const double half = 0.5 * trial->scene->length, turn = trial->lean / 360.0;
    const int is_held_in_middle = (trial->lean > LYING && !trial->is_usual) || trial->scene->is_below;
    dpt_tool_settings settings = { .size = sizeof settings };
    dpt_segment segment = { .radius = trial->radius };
    double sine, cosine;
    turn_sincos(turn, &sine, &cosine);
    trial->rise = half * cosine;
    segment.a[1] = is_held_in_middle ? -half * cosine : 0.0;
    segment.a[2] = is_held_in_middle ? -half * sine : 0.0;
    segment.b[1] = segment.a[1] + 2.0 * half * cosine;
    segment.b[2] = segment.a[2] + 2.0 * half * sine;
    dpt_result result = scene_stage_add_tool(&trial->stage, &segment, 1, NULL, 0);
    if (result == DPT_OK)
        result = dpt_tool_get_settings(trial->stage.world, trial->stage.tool, &settings);
    settings.stiffness = trial->stiffness;
    settings.lock_rotation = !trial->turns;
    settings.piercing = trial->scene->is_needle ? DPT_PIERCING_A : DPT_PIERCING_NONE;
    return result == DPT_OK ? dpt_tool_set_settings(trial->stage.world, trial->stage.tool, &settings) : result;
}

/* Returns 0 if memory ran out. */
static int open_trial(struct hum_trial *trial)
{
    struct scene_bodies *bodies = &trial->scene->bodies;
    dpt_world_def def;
    dpt_springs_def usual;
    dpt_world_def_init(&def);
    dpt_springs_def_init(&usual);
    def.max_contacts = CONTACTS;
    def.max_bodies = bodies->count;
    def.max_channels = scene_bodies_channels(bodies);
    def.max_tools = def.max_segments = 1;
    trial->tick = malloc(ROOM * sizeof *trial->tick);
    if (!trial->tick || scene_stage_open(&trial->stage, &def) != DPT_OK || add_bodies(trial) != DPT_OK ||
        add_tool(trial) != DPT_OK)
        return 0;
    trial->is_refused =
        bodies->body[0].springs &&
        !(HUM_TICK <= SUBSTEPS * usual.max_substeps * dpt_springs_get_stable_step(bodies->body[0].springs));
    return 1;
}

/* Move the device, and note what it felt. Returns the size of the force, N. */
static double feel(struct hum_trial *trial, double down, double across, int is_first)
{
    const struct hum_scene *scene = trial->scene;
    const double begin = scene->is_below ? -trial->radius - trial->rise : trial->radius;
    dpt_pose pose = DPT_POSE_IDENTITY, before;
    dpt_force_info info = { .size = sizeof info };
    struct hum_tick *tick = &trial->tick[trial->count];
    dpt_tool_get_pose(trial->stage.world, trial->stage.tool, &before);
    vec3_store(vec3_of(scene->start), pose.position);
    pose.position[0] += 0.8660254037844386 * across;
    pose.position[1] += begin - down;
    pose.position[2] += 0.5 * across;
    if (is_first)
        before = pose;
    dpt_result result = is_first ? dpt_tool_teleport(trial->stage.world, trial->stage.tool, &pose)
                                 : dpt_tool_set_pose(trial->stage.world, trial->stage.tool, &pose);
    scene_bodies_begin_tick(&trial->scene->bodies, trial->count);
    if (result == DPT_OK)
        result = scene_stage_step_world(&trial->stage, HUM_TICK, NULL);
    if (result == DPT_OK)
        result = scene_stage_step_soft(&trial->stage, HUM_TICK);
    if (result == DPT_OK)
        result = dpt_tool_get_force_info(trial->stage.world, trial->stage.tool, &info);
    trial->has_failed |= result != DPT_OK || trial->scene->bodies.is_held || trial->count + 1 == ROOM;
    memcpy(tick->force, info.wrench.force, sizeof tick->force);
    tick->motion = length(sub(vec3_of(pose.position), vec3_of(before.position)));
    tick->flags = info.flags;
    tick->sticking = info.sticking;
    tick->slipping = info.slipping;
    trial->count += !trial->has_failed;
    return length(vec3_of(tick->force));
}

/* From where the tool is lowered, or waits, to its first force. Returns how far down that is; the count begins there. */
static double approach(struct hum_trial *trial)
{
    double down = 0.0;
    for (int i = 0; i < APPROACH_MAX && !trial->has_failed; i++) {
        down = trial->scene->is_below ? 0.0 : SPEED * i;
        trial->count = 0;
        if (feel(trial, down, 0.0, i == 0) > 0.0)
            return down;
    }
    trial->has_failed = 1;
    return down;
}

int hum_trial_run(struct hum_trial *trial)
{
    double down, across;
    trial->count = trial->judged = 0;
    if (!open_trial(trial))
        return 0;
    if (trial->is_refused)
        return 1;
    const double touch = approach(trial);
    for (size_t i = 0, ticks = path_of(trial, 0, &down, &across); i < ticks && !trial->has_failed; i++) {
        path_of(trial, i, &down, &across);
        feel(trial, touch + down, across, 0);
    }
    if (trial->scene->is_needle && trial->count > 0)
        trial->has_failed |= !(trial->tick[trial->count - 1].flags & DPT_FORCE_FLAG_INSERTED);
    while (trial->hand != HUM_STILL && trial->count > 0 &&
           !(length(vec3_of(trial->tick[trial->count - 1].force)) > 0.0))
        trial->count--;
    const size_t onset = trial->hand == HUM_STILL ? trial->count - trial->still_ticks
                         : trial->scene->is_below ? FALLING
                                                  : ONSET;
    trial->judged = onset < trial->count ? onset : trial->count;
    return 1;
}

void hum_trial_close(struct hum_trial *trial)
{
    scene_stage_close(&trial->stage);
    free(trial->tick);
    trial->tick = NULL;
    scene_bodies_leave(&trial->scene->bodies);
}
