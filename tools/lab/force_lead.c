/* SPDX-License-Identifier: BSD-3-Clause */
#include "lab/force_lead.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/vec3.h"
#include "platform/clock.h"
#include "scene/force_options.h"

double uniform(uint64_t *seed, double low, double high)
{
    uint64_t z = (*seed += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return low + (high - low) * ((double)((z ^ (z >> 31)) >> 11) * 0x1p-53);
}

int force_lead_open(struct force_lead *lead, const struct force_trial_def *def)
{
    const dpt_pose identity = DPT_POSE_IDENTITY;
    const dpt_segment segment = { { -0.5 * def->length, 0.0, 0.0 }, { 0.5 * def->length, 0.0, 0.0 }, def->radius };
    dpt_world_def world;
    dpt_body body;
    dpt_world_def_init(&world);
    world.law = def->law;
    world.stiffness = def->stiffness;
    world.max_contacts = (uint32_t)def->contacts;
    world.max_bodies = world.max_tools = world.max_segments = 1;
    *lead = (struct force_lead){ .def = def, .device = identity, .before = identity, .seed = def->seed };
    lead->rho = def->length / sqrt(12.0);
    lead->force.size = sizeof lead->force;
    const struct force_options force = { .friction = def->friction };
    return scene_stage_open(&lead->stage, &world) == DPT_OK &&
           dpt_body_add(lead->stage.world, def->mesh, NULL, &body) == DPT_OK &&
           force_options_set_body(&force, lead->stage.world, body) == DPT_OK &&
           scene_stage_add_tool(&lead->stage, &segment, 1, NULL, 0) == DPT_OK;
}

void force_lead_close(struct force_lead *lead)
{
    free(lead->us);
    scene_stage_close(&lead->stage);
}

/* Without memory the tick is left out. */
static void note_time(struct force_lead *lead, double us)
{
    if (lead->us_count == lead->us_room) {
        const size_t room = lead->us_room ? 2 * lead->us_room : 1024;
        double *grown = realloc(lead->us, room * sizeof *grown);
        if (!grown)
            return;
        lead->us = grown;
        lead->us_room = room;
    }
    lead->us[lead->us_count++] = us;
}

/* A low-pass of first order, as a driver may have one. */
static void pass_low(struct force_lead *lead)
{
    const double share = 1.0 - exp(-LEAD_DT / lead->def->low_pass);
    dpt_wrench *now = &lead->force.wrench;
    const dpt_wrench *was = &lead->last.wrench;
    for (int k = 0; k < 3; k++) {
        now->force[k] = was->force[k] + share * (now->force[k] - was->force[k]);
        now->torque[k] = was->torque[k] + share * (now->torque[k] - was->torque[k]);
    }
}

static void note_result(const struct force_lead *lead, dpt_result result)
{
    if (lead->def->failure && *lead->def->failure == DPT_OK)
        *lead->def->failure = result;
}

int force_lead_lags(const struct force_lead *lead, const dpt_force_info *force)
{
    return force->lag > 0.01 * vec3_length(force->wrench.force) / lead->def->stiffness;
}

void force_lead_note_fold(struct force_lead *lead)
{
    const int goes_on = lead->is_folding && force_lead_lags(lead, &lead->last);
    lead->is_folding = goes_on || (lead->force.flags & DPT_FORCE_FLAG_FOLD) != 0;
}

void force_lead_step(struct force_lead *lead)
{
    lead->last = lead->force;
    note_result(lead, dpt_tool_set_pose(lead->stage.world, lead->stage.tool, &lead->device));
    const uint64_t begin = clock_now();
    const dpt_result result = dpt_world_step(lead->stage.world, LEAD_DT, NULL);
    const uint64_t ns = clock_now() - begin;
    note_result(lead, result);
    dpt_tool_get_force_info(lead->stage.world, lead->stage.tool, &lead->force);
    if (lead->force.reason == DPT_FORCE_ACTS)
        note_time(lead, 1e-3 * (double)ns);
    if (lead->def->low_pass > 0.0)
        pass_low(lead);
    force_lead_note_fold(lead);
}

void force_lead_start(struct force_lead *lead)
{
    note_result(lead, dpt_tool_teleport(lead->stage.world, lead->stage.tool, &lead->device));
    note_result(lead, dpt_world_step(lead->stage.world, LEAD_DT, NULL));
    lead->before = lead->device;
    memset(&lead->force.wrench, 0, sizeof lead->force.wrench);
    lead->is_folding = 0;
    force_lead_step(lead);
    lead->last = lead->force;
}

void point_along(const double *axis, double *orientation)
{
    const double x[3] = { 1.0, 0.0, 0.0 };
    double v[3];
    vec3_cross(x, axis, v);
    const double w = 1.0 + axis[0];
    if (w > 1e-9) {
        const double size = sqrt(w * w + vec3_dot(v, v));
        orientation[0] = w / size;
        for (int k = 0; k < 3; k++)
            orientation[1 + k] = v[k] / size;
        return;
    }
    orientation[0] = orientation[1] = orientation[3] = 0.0;
    orientation[2] = 1.0;
}

/* Where the tool points. */
static void axis_of(const double *q, double *axis)
{
    axis[0] = 1.0 - 2.0 * (q[2] * q[2] + q[3] * q[3]);
    axis[1] = 2.0 * (q[1] * q[2] + q[0] * q[3]);
    axis[2] = 2.0 * (q[1] * q[3] - q[0] * q[2]);
}

void force_lead_motion(const struct force_lead *lead, double *shift, double *turn)
{
    double before[3], now[3];
    axis_of(lead->before.orientation, before);
    axis_of(lead->device.orientation, now);
    vec3_cross(before, now, turn);
    for (int k = 0; k < 3; k++)
        shift[k] = lead->device.position[k] - lead->before.position[k];
}

double force_lead_moved(const struct force_lead *lead)
{
    double shift[3], turn[3];
    force_lead_motion(lead, shift, turn);
    return sqrt(vec3_dot(shift, shift) + lead->rho * lead->rho * vec3_dot(turn, turn));
}

/* |W|, N */
static double size_of(const struct force_lead *lead, const double *force, const double *torque)
{
    const double turning = lead->rho > 0.0 ? vec3_length(torque) / lead->rho : 0.0;
    return sqrt(vec3_dot(force, force) + turning * turning);
}

double force_lead_change(const struct force_lead *lead)
{
    const dpt_wrench *now = &lead->force.wrench, *was = &lead->last.wrench;
    double force[3], torque[3];
    for (int k = 0; k < 3; k++) {
        force[k] = now->force[k] - was->force[k];
        torque[k] = now->torque[k] - was->torque[k];
    }
    return size_of(lead, force, torque);
}

double force_lead_growth(const struct force_lead *lead)
{
    const dpt_wrench *now = &lead->force.wrench, *was = &lead->last.wrench;
    return size_of(lead, now->force, now->torque) - size_of(lead, was->force, was->torque);
}

double force_lead_turned(const struct force_lead *lead, double largest)
{
    const double *force = lead->force.wrench.force, *before = lead->last.wrench.force;
    const double now = vec3_length(force), was = vec3_length(before);
    const double small = fmax(SMALL_FORCE, SMALL_SHARE * largest);
    if (!(now > small && was > small))
        return 0.0;
    return acos(fmax(-1.0, fmin(1.0, vec3_dot(force, before) / (now * was))));
}

void force_lead_tremor(struct force_lead *lead)
{
    for (int k = 0; k < 3; k++)
        lead->tremor[k] = 0.9 * lead->tremor[k] + uniform(&lead->seed, -6e-5, 6e-5);
}

int force_lead_place(struct force_lead *lead, struct place *place)
{
    dpt_mesh_info info = { .size = sizeof info };
    dpt_mesh_get_info(lead->def->mesh, &info);
    for (int tries = 0; tries < 1000; tries++) {
        double corners[9], u[3], v[3], other[3];
        const uint32_t number = (uint32_t)uniform(&lead->seed, 0.0, (double)info.source_triangles);
        if (dpt_mesh_get_triangle(lead->def->mesh, number, corners) != DPT_OK)
            continue;
        for (int k = 0; k < 3; k++) {
            place->x[k] = (corners[k] + corners[3 + k] + corners[6 + k]) / 3.0;
            u[k] = corners[3 + k] - corners[k];
            v[k] = corners[6 + k] - corners[k];
        }
        vec3_cross(u, v, place->normal);
        vec3_normalise(place->normal);
        if (!(vec3_length(place->normal) > 0.5))
            continue;
        for (int k = 0; k < 3; k++)
            other[k] = uniform(&lead->seed, -1.0, 1.0);
        vec3_cross(place->normal, other, place->side);
        vec3_normalise(place->side);
        vec3_cross(place->normal, place->side, place->across);
        return 1;
    }
    return 0;
}

double force_lead_gap(const struct force_lead *lead, const dpt_pose *pose)
{
    const double half = 0.5 * lead->def->length;
    double x[3];
    axis_of(pose->orientation, x);
    double ends[6];
    dpt_hit hit = DPT_HIT_INIT;
    for (int k = 0; k < 3; k++) {
        ends[k] = pose->position[k] - half * x[k];
        ends[3 + k] = pose->position[k] + half * x[k];
    }
    dpt_query_segments(lead->def->mesh, NULL, ends, NULL, 1, &hit, NULL);
    return hit.distance - lead->def->radius;
}

void force_lead_hold(struct force_lead *lead, const struct place *place, double tilt, double height, double along)
{
    lead->before = lead->device;
    double axis[3];
    for (int k = 0; k < 3; k++)
        axis[k] = cos(tilt) * place->normal[k] + sin(tilt) * place->side[k];
    point_along(axis, lead->device.orientation);
    for (int k = 0; k < 3; k++)
        lead->device.position[k] = place->x[k] + height * place->normal[k] + 0.5 * lead->def->length * axis[k] +
                                   along * place->side[k] + lead->tremor[k];
}
