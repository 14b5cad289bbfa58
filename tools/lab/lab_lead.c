/* SPDX-License-Identifier: BSD-3-Clause */
#include "lab/lab_lead.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/vec3.h"
#include "scene/force_options.h"
#include "shape/mesh_size.h"

/* Where the wrench is at most K times this share of the radius, |dW| is bounded by the motion alone. */
#define SMALL_DEPTH 0.2

static const uint32_t laws[LAB_METHODS] = { DPT_LAW_POINT, DPT_LAW_BED, DPT_LAW_PROXY, DPT_LAW_PROXY };

static int add_bodies(struct lab_lead *lead, const struct lab_lead_def *def)
{
    dpt_pose pose = DPT_POSE_IDENTITY;
    dpt_body body;
    for (int i = 0; i < LAB_BODIES && def->meshes[i]; i++) {
        dpt_mesh_info info = { .size = sizeof info };
        dpt_body_settings settings = { .size = sizeof settings };
        memcpy(pose.position, lead->middle, sizeof lead->middle);
        dpt_mesh_get_info(def->meshes[i], &info);
        lead->meshes[i] = def->meshes[i];
        lead->slack = fmax(lead->slack, 2e-6 * box_diagonal(&info));
        if (dpt_body_add(lead->lead.stage.world, def->meshes[i], &pose, &body) != DPT_OK ||
            dpt_body_get_settings(lead->lead.stage.world, body, &settings) != DPT_OK)
            return 0;
        settings.side_limit = def->side_limit;
        if (dpt_body_set_settings(lead->lead.stage.world, body, &settings) != DPT_OK)
            return 0;
    }
    return 1;
}

/* Segments that follow each other along x, the middle at the origin. */
static int add_tool(struct lab_lead *lead, uint32_t pieces, int lock_rotation)
{
    const struct force_options force = { .law = lead->def.law, .stiffness = LAB_STIFFNESS };
    const double half = 0.5 * lead->def.length;
    dpt_segment segments[LAB_PIECES_MAX];
    memset(segments, 0, sizeof segments);
    for (uint32_t i = 0; i < pieces; i++) {
        segments[i].a[0] = half * (2.0 * i / pieces - 1.0);
        segments[i].b[0] = half * (2.0 * (i + 1) / pieces - 1.0);
        segments[i].radius = lead->def.radius;
    }
    return scene_stage_add_tool(&lead->lead.stage, segments, pieces, &force, (uint32_t)lock_rotation) == DPT_OK;
}

int lab_lead_open(struct lab *lab, struct lab_lead *lead, const struct lab_lead_def *def)
{
    const dpt_pose identity = DPT_POSE_IDENTITY;
    const int is_ball = def->method == LAB_BALL;
    const double length = def->length > 0.0 ? def->length : LAB_LENGTH;
    const uint32_t pieces = def->pieces && !is_ball ? def->pieces : 1;
    dpt_world_def world;
    dpt_world_def_init(&world);
    world.max_contacts = LAB_CONTACTS;
    world.max_bodies = LAB_BODIES;
    world.max_tools = 1;
    world.max_segments = LAB_PIECES_MAX;
    world.budget = def->budget;
    *lead = (struct lab_lead){ .def = { .law = laws[def->method],
                                        .stiffness = LAB_STIFFNESS,
                                        .length = is_ball ? 0.0 : length,
                                        .radius = def->radius > 0.0 ? def->radius : LAB_RADIUS },
                               .method = def->method };
    lead->lead = (struct force_lead){ .def = &lead->def, .device = identity, .seed = 1 };
    lead->lead.force.size = sizeof lead->lead.force;
    lead->lead.rho = lead->def.length / sqrt(12.0);
    if (def->middle)
        memcpy(lead->middle, def->middle, sizeof lead->middle);
    if (scene_stage_open(&lead->lead.stage, &world) == DPT_OK && add_bodies(lead, def) &&
        add_tool(lead, pieces, def->lock_rotation))
        return 1;
    lab->is_out_of_memory = 1;
    return 0;
}

void lab_lead_close(struct lab_lead *lead)
{
    scene_stage_close(&lead->lead.stage);
}

void lab_lead_aim(struct lab_lead *lead, const double *x, const double *axis)
{
    dpt_pose *device = &lead->lead.device;
    double unit[3] = { axis[0], axis[1], axis[2] };
    vec3_normalise(unit);
    lead->lead.before = *device;
    point_along(unit, device->orientation);
    for (int k = 0; k < 3; k++)
        device->position[k] = lead->middle[k] + x[k] + 0.5 * lead->def.length * unit[k] + lead->lead.tremor[k];
}

void lab_lead_shake(struct lab_lead *lead)
{
    force_lead_tremor(&lead->lead);
}

void lab_lead_calm(struct lab_lead *lead)
{
    memset(lead->lead.tremor, 0, sizeof lead->lead.tremor);
}

static void take_step(struct lab_lead *lab)
{
    struct force_lead *lead = &lab->lead;
    dpt_step step = { .size = sizeof step };
    lead->last = lead->force;
    dpt_tool_set_pose(lead->stage.world, lead->stage.tool, &lead->device);
    dpt_world_step(lead->stage.world, LEAD_DT, &step);
    dpt_tool_get_force_info(lead->stage.world, lead->stage.tool, &lead->force);
    force_lead_note_fold(lead);
    lab->work = step.work;
}

void lab_lead_start(struct lab_lead *lead)
{
    dpt_tool_teleport(lead->lead.stage.world, lead->lead.stage.tool, &lead->lead.device);
    lead->lead.before = lead->lead.device;
    take_step(lead);
    take_step(lead);
    lead->lead.is_folding = 0;
    lead->tally = (struct lab_tally){ .gap_min = HUGE_VAL };
}

static double proxy_gap(struct lab_lead *lead)
{
    double min = HUGE_VAL;
    dpt_pose proxy;
    dpt_tool_get_proxy(lead->lead.stage.world, lead->lead.stage.tool, &proxy);
    for (int k = 0; k < 3; k++)
        proxy.position[k] -= lead->middle[k];
    for (int i = 0; i < LAB_BODIES && lead->meshes[i]; i++) {
        lead->def.mesh = lead->meshes[i];
        min = fmin(min, force_lead_gap(&lead->lead, &proxy));
    }
    return min;
}

static void judge_proxy(struct lab_lead *lead)
{
    struct lab_tally *tally = &lead->tally;
    const double gap = proxy_gap(lead), force = vec3_length(lab_lead_force(lead));
    tally->gap_min = fmin(tally->gap_min, gap);
    tally->in_mesh += gap < 0.0;
    tally->lagging += force > SMALL_FORCE && lead->lead.force.lag > 0.01 * force / LAB_STIFFNESS;
}

/* A wrench as a length: what |p - d|_M would be. */
static double depth_of(const struct lab_lead *lead, const dpt_wrench *wrench)
{
    const double rho = lead->lead.rho, turning = rho > 0.0 ? vec3_length(wrench->torque) / rho : 0.0;
    return sqrt(vec3_dot(wrench->force, wrench->force) + turning * turning) / LAB_STIFFNESS;
}

static void judge_change(struct lab_lead *lead)
{
    struct lab_tally *tally = &lead->tally;
    const dpt_force_info *now = &lead->lead.force, *was = &lead->lead.last;
    const double moved = force_lead_moved(&lead->lead), change = force_lead_change(&lead->lead);
    const double small = SMALL_DEPTH * lead->def.radius;
    double force[3], torque[3];
    for (int k = 0; k < 3; k++) {
        force[k] = now->wrench.force[k] - was->wrench.force[k];
        torque[k] = now->wrench.torque[k] - was->wrench.torque[k];
    }
    tally->jump = fmax(tally->jump, vec3_length(force));
    tally->torque_jump = fmax(tally->torque_jump, vec3_length(torque));
    tally->drop = fmax(tally->drop, vec3_length(was->wrench.force) - vec3_length(now->wrench.force));
    tally->share = fmax(tally->share, change / (LAB_STIFFNESS * (3.0 * moved + PROXY_SPEED * LEAD_DT)));
    if (fmax(depth_of(lead, &now->wrench), depth_of(lead, &was->wrench)) > small)
        return;
    tally->shallow += now->reason == DPT_FORCE_ACTS;
    tally->gain = fmax(tally->gain, change / (LAB_STIFFNESS * (moved + lead->slack)));
}

void lab_lead_step(struct lab_lead *lead)
{
    struct lab_tally *tally = &lead->tally;
    const dpt_force_info *now = &lead->lead.force;
    take_step(lead);
    const double force = vec3_length(now->wrench.force), torque = vec3_length(now->wrench.torque);
    tally->ticks++;
    tally->acting += now->reason == DPT_FORCE_ACTS;
    tally->unknown += now->reason == DPT_FORCE_UNDECIDED;
    tally->folds += (now->flags & DPT_FORCE_FLAG_FOLD) != 0;
    tally->replaced += (now->flags & DPT_FORCE_FLAG_REPLACED) != 0;
    tally->not_finite += !isfinite(force) || !isfinite(torque);
    tally->largest = fmax(tally->largest, force);
    tally->largest_torque = fmax(tally->largest_torque, torque);
    const double angle = lead->lead.is_folding ? 0.0 : force_lead_turned(&lead->lead, tally->largest);
    tally->turning += angle;
    tally->turns += angle > 30.0 * LAB_DEGREE;
    tally->reversals += angle > 90.0 * LAB_DEGREE;
    judge_change(lead);
    if (lab_has_proxy(lead->method))
        judge_proxy(lead);
}

struct force_trial_def lab_trial_def(int method, const dpt_mesh *mesh)
{
    return (struct force_trial_def){ .mesh = mesh,
                                     .law = laws[method],
                                     .stiffness = LAB_STIFFNESS,
                                     .length = method == LAB_BALL ? 0.0 : LAB_LENGTH,
                                     .radius = LAB_RADIUS,
                                     .depth = 0.005,
                                     .through = 0.027,
                                     .speed = 0.1,
                                     .seed = 1 };
}

double lab_per_cent(uint64_t part, uint64_t whole)
{
    return whole ? 100.0 * (double)part / (double)whole : 0.0;
}

void lab_tally_add(struct lab_tally *sum, const struct lab_tally *tally)
{
    if (!sum->ticks)
        sum->gap_min = HUGE_VAL;
    sum->ticks += tally->ticks;
    sum->acting += tally->acting;
    sum->turning += tally->turning;
    sum->turns += tally->turns;
    sum->reversals += tally->reversals;
    sum->folds += tally->folds;
    sum->replaced += tally->replaced;
    sum->unknown += tally->unknown;
    sum->in_mesh += tally->in_mesh;
    sum->lagging += tally->lagging;
    sum->not_finite += tally->not_finite;
    sum->jump = fmax(sum->jump, tally->jump);
    sum->torque_jump = fmax(sum->torque_jump, tally->torque_jump);
    sum->drop = fmax(sum->drop, tally->drop);
    sum->share = fmax(sum->share, tally->share);
    sum->shallow += tally->shallow;
    sum->gain = fmax(sum->gain, tally->gain);
    sum->largest = fmax(sum->largest, tally->largest);
    sum->largest_torque = fmax(sum->largest_torque, tally->largest_torque);
    sum->gap_min = fmin(sum->gap_min, tally->gap_min);
}

void lab_tally_note(struct lab *lab, int method, const struct lab_tally *tally)
{
    const char *name = lab_method_name(method);
    lab_at_most(lab, name, "ticks that turn the force by over 30 degrees, folds apart",
                lab_per_cent(tally->turns, tally->acting), "%", 0.0);
    lab_at_most(lab, name, "largest |dW| in a tick, of K (3 |motion| + 1 mm)", tally->share, "", LEAD_SHARE_MAX);
    lab_note(lab, name, "largest change of force in a tick", tally->jump, "N");
    if (!lab_has_proxy(method))
        return;
    lab_at_most(lab, name, "ticks whose proxy is in a body", (double)tally->in_mesh, "", 0.0);
    lab_note(lab, name, "ticks with a fold", lab_per_cent(tally->folds, tally->acting), "%");
}

void lab_tally_note_convex(struct lab *lab, int method, const struct lab_tally *tally)
{
    if (tally->shallow)
        lab_at_most(lab, lab_method_name(method), "|dW| over K |motion|, up to a fifth of the radius deep", tally->gain,
                    "", 1.25);
}
