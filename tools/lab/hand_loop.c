/* SPDX-License-Identifier: BSD-3-Clause */
#include "lab/hand_loop.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/quaternion.h"
#include "host/host_coupling.h"

/* m: from where a tool is lowered, beside half its length, and by what steps. */
#define ABOVE  0.03
#define COARSE 2e-4
#define FINE   1e-5

/* Of places that are drawn; ticks of tissue that comes to rest. */
enum { TRIES = 100, TISSUE_SETTLING = 1000 };

static double or_one(double value)
{
    return value > 0.0 ? value : 1.0;
}

/* The quaternion of the rotation that turns the axes into the columns `along`, `out` and their cross product. */
static void axes_of(const struct hand_place *place, double q[4])
{
    const double *x = place->along, *y = place->out;
    double z[3];
    vec3_cross(x, y, z);
    const double squares[4] = { 1.0 + x[0] + y[1] + z[2], 1.0 + x[0] - y[1] - z[2], 1.0 - x[0] + y[1] - z[2],
                                1.0 - x[0] - y[1] + z[2] };
    /* Twice the products of two components; the greatest component divides them. */
    const double twice[4][4] = { { squares[0], y[2] - z[1], z[0] - x[2], x[1] - y[0] },
                                 { y[2] - z[1], squares[1], y[0] + x[1], z[0] + x[2] },
                                 { z[0] - x[2], y[0] + x[1], squares[2], z[1] + y[2] },
                                 { x[1] - y[0], z[0] + x[2], z[1] + y[2], squares[3] } };
    int best = 0;
    for (int k = 1; k < 4; k++)
        if (squares[k] > squares[best])
            best = k;
    for (int k = 0; k < 4; k++)
        q[k] = twice[best][k] / (2.0 * sqrt(squares[best]));
}

double hand_loop_rho(const struct hand_loop *loop)
{
    return loop->tool.length / sqrt(12.0) / or_one(loop->zoom);
}

static dpt_segment segment_of(const struct hand_loop *loop)
{
    const struct hand_tool *tool = &loop->tool;
    const double half[3] = { 0.5 * tool->length * cos(tool->tilt), 0.5 * tool->length * sin(tool->tilt), 0.0 };
    dpt_segment segment = { .radius = tool->radius };
    for (int k = 0; k < 3; k++) {
        segment.a[k] = -half[k];
        segment.b[k] = loop->method == LAB_BALL ? -half[k] : half[k];
    }
    return segment;
}

static void set_tool(struct hand_loop *loop)
{
    dpt_tool_settings settings = { .size = sizeof settings };
    dpt_tool_get_settings(loop->stage.world, loop->stage.tool, &settings);
    settings.stiffness = loop->stiffness;
    settings.rotational_stiffness = loop->rotational_stiffness;
    settings.damping = loop->damping;
    settings.lock_rotation = loop->device.dofs < HAND_AXES;
    dpt_tool_set_settings(loop->stage.world, loop->stage.tool, &settings);
}

static int add_body(struct hand_loop *loop)
{
    if (loop->springs) {
        const int is_open = spring_body_open(loop->springs, loop->stage.world);
        loop->body = loop->springs->body;
        return is_open;
    }
    if (!loop->tissue)
        return dpt_body_add(loop->stage.world, loop->place->mesh->mesh, NULL, &loop->body) == DPT_OK;
    if (!tissue_open(loop->tissue, loop->stage.world))
        return 0;
    loop->body = loop->tissue->body;
    return 1;
}

int hand_loop_open(struct hand_loop *loop)
{
    const dpt_segment segment = segment_of(loop);
    dpt_world_def def;
    if (!loop->place)
        return 1;
    dpt_world_def_init(&def);
    def.law = loop->method == LAB_POINT ? DPT_LAW_POINT : loop->method == LAB_BED ? DPT_LAW_BED : DPT_LAW_PROXY;
    def.max_contacts = LAB_CONTACTS;
    def.max_bodies = def.max_tools = def.max_segments = 1;
    loop->body_pose = (dpt_pose)DPT_POSE_IDENTITY;
    if (scene_stage_open(&loop->stage, &def) != DPT_OK || !add_body(loop) ||
        scene_stage_add_tool(&loop->stage, &segment, 1, NULL, 0) != DPT_OK)
        return 0;
    set_tool(loop);
    return 1;
}

void hand_loop_close(struct hand_loop *loop)
{
    if (loop->tissue)
        tissue_close(loop->tissue);
    if (loop->springs)
        spring_body_close(loop->springs);
    scene_stage_close(&loop->stage);
    free(loop->track);
    loop->track = NULL;
}

void hand_loop_stiffen(struct hand_loop *loop, double stiffness, double rotational_stiffness, double damping)
{
    loop->stiffness = stiffness;
    loop->rotational_stiffness = rotational_stiffness;
    loop->damping = damping;
    if (loop->place)
        set_tool(loop);
}

/* The pose that has these coordinates. */
static dpt_pose pose_at(const double at[HAND_AXES])
{
    const double angle = length(vec3_of(at + 3));
    const double share = angle > 1e-9 ? sin(0.5 * angle) / angle : 0.5;
    return (dpt_pose){ { at[0], at[1], at[2] }, { cos(0.5 * angle), share * at[3], share * at[4], share * at[5] } };
}

static dpt_pose tool_pose(const struct hand_loop *loop, const dpt_pose *hand)
{
    dpt_pose pose;
    quaternion_rotate(loop->axes, hand->position, pose.position);
    for (int k = 0; k < 3; k++)
        pose.position[k] = loop->origin[k] + or_one(loop->zoom) * pose.position[k];
    quaternion_multiply(loop->axes, hand->orientation, pose.orientation);
    quaternion_normalise(pose.orientation);
    return pose;
}

/* The report of the last step, with the wrench in the hand's axes and scale. */
static dpt_force_info felt(const struct hand_loop *loop)
{
    const double scale = or_one(loop->force_scale), share = scale / or_one(loop->zoom);
    dpt_force_info report = { .size = sizeof report };
    dpt_tool_get_force_info(loop->stage.world, loop->stage.tool, &report);
    quaternion_rotate_back(loop->axes, report.wrench.force, report.wrench.force);
    quaternion_rotate_back(loop->axes, report.wrench.torque, report.wrench.torque);
    for (int k = 0; k < 3; k++) {
        report.wrench.force[k] *= scale;
        report.wrench.torque[k] = loop->device.dofs < HAND_AXES ? 0.0 : share * report.wrench.torque[k];
    }
    report.energy *= share;
    report.body_work *= share;
    return report;
}

/*
 * The simulated device takes torque as what acts on the components of its rotation vector. That does the torque's work
 * if it is J' torque; J makes a turn's rate of the vector's.
 */
static void to_components(const double turn[3], double torque[3])
{
    const double angle = length(vec3_of(turn));
    const double f = angle > 1e-4 ? (1.0 - cos(angle)) / (angle * angle) : 0.5;
    const double g = angle > 1e-4 ? (angle - sin(angle)) / (angle * angle * angle) : 1.0 / 6.0;
    double once[3], twice[3];
    vec3_cross(torque, turn, once);
    vec3_cross(once, turn, twice);
    for (int k = 0; k < 3; k++)
        torque[k] += f * once[k] + g * twice[k];
}

static dpt_force_info step_to(struct hand_loop *loop, const double at[HAND_AXES], double dt)
{
    const dpt_pose hand = pose_at(at), pose = tool_pose(loop, &hand);
    dpt_tool_set_pose(loop->stage.world, loop->stage.tool, &pose);
    if (loop->tissue)
        tissue_advance(loop->tissue);
    dpt_world_step(loop->stage.world, dt, NULL);
    if (loop->springs)
        spring_body_step(loop->springs, dt);
    dpt_force_info report = felt(loop);
    to_components(at + 3, report.wrench.torque);
    return report;
}

void hand_loop_ask(struct hand_loop *loop, const double at[HAND_AXES], double dt, double wrench[HAND_AXES])
{
    const dpt_force_info report = step_to(loop, at, dt);
    memcpy(wrench, report.wrench.force, sizeof report.wrench.force);
    memcpy(wrench + 3, report.wrench.torque, sizeof report.wrench.torque);
}

/* Put the tool at coordinates without a way there: it is outside, so the second step has it outside, too. */
static void jump_to(struct hand_loop *loop, const double at[HAND_AXES])
{
    const dpt_pose hand = pose_at(at), pose = tool_pose(loop, &hand);
    uint32_t steps = 2;
    dpt_tool_teleport(loop->stage.world, loop->stage.tool, &pose);
    if (loop->tissue) {
        tissue_rest(loop->tissue);
        loop->tissue->is_held = 1;
        steps += loop->tissue->ticks;
    }
    for (uint32_t i = 0; i < steps; i++)
        dpt_world_step(loop->stage.world, 1e-3, NULL);
}

/* The height from which the tool is lowered, m of the hand. */
static double height_of(const struct hand_loop *loop)
{
    return (ABOVE + 0.5 * loop->tool.length) / or_one(loop->zoom);
}

int hand_loop_lower(struct hand_loop *loop, double force)
{
    const struct hand_place *place = loop->place;
    const dpt_segment segment = segment_of(loop);
    const double zoom = or_one(loop->zoom), height = height_of(loop);
    double at[HAND_AXES] = { 0.0 }, wrench[HAND_AXES] = { 0.0 }, foot[3];
    axes_of(place, loop->axes);
    quaternion_rotate(loop->axes, loop->tool.tilt > 0.0 ? segment.a : (double[3]){ 0.0 }, foot);
    for (int k = 0; k < 3; k++)
        loop->origin[k] = place->at[k] - foot[k];
    at[1] = height;
    jump_to(loop, at);
    while (at[1] > -height && wrench[1] <= 0.0) {
        at[1] -= COARSE / zoom;
        hand_loop_ask(loop, at, 1e-3, wrench);
    }
    at[1] += COARSE / zoom;
    while (at[1] > -2.0 * height && wrench[1] < force) {
        at[1] -= FINE / zoom;
        hand_loop_ask(loop, at, 1e-3, wrench);
    }
    for (int k = 0; k < 3; k++)
        loop->origin[k] += zoom * at[1] * place->out[k];
    hand_loop_return(loop);
    return wrench[1] >= force && wrench[1] > 0.7 * length(vec3_of(wrench));
}

int hand_loop_seek(struct hand_loop *loop, const struct hand_mesh *mesh, uint64_t *seed, double force,
                   struct hand_place *place)
{
    loop->place = place;
    for (int i = 0; i < TRIES; i++) {
        hand_place_draw(mesh, seed, place);
        if (hand_loop_lower(loop, force))
            return 1;
    }
    return 0;
}

void hand_loop_return(struct hand_loop *loop)
{
    double at[HAND_AXES] = { 0.0 };
    if (!loop->place)
        return;
    at[1] = height_of(loop);
    jump_to(loop, at);
    for (const double by = COARSE / or_one(loop->zoom); at[1] > by;) {
        at[1] -= by;
        hand_loop_ask(loop, at, 1e-3, loop->first);
    }
    at[1] = 0.0;
    for (int i = 0; i < 4; i++)
        hand_loop_ask(loop, at, 1e-3, loop->first);
    if (loop->tissue)
        loop->tissue->is_held = 0;
    if (loop->springs)
        loop->springs->is_free = 1;
    const int gives_way = loop->springs || (loop->tissue && loop->tissue->matter.foundation > 0.0);
    for (int i = 0; gives_way && i < TISSUE_SETTLING; i++)
        hand_loop_ask(loop, at, 1e-3, loop->first);
}

void hand_loop_lift(struct hand_loop *loop, double height)
{
    const double zero[HAND_AXES] = { 0.0 };
    for (int k = 0; k < 3; k++)
        loop->origin[k] += or_one(loop->zoom) * height * loop->place->out[k];
    hand_loop_ask(loop, zero, 1e-3, loop->first);
}

static dpt_device *open_device(const struct hand_device *device, double step, double turn_step)
{
    const struct {
        const char *name;
        double value;
    } settings[] = { { "mass", device->mass },
                     { "damping", device->damping },
                     { "friction", device->friction },
                     { "step", step },
                     { "inertia", device->inertia },
                     { "turn_damping", device->turn_damping },
                     { "turn_friction", device->turn_friction },
                     { "turn_step", turn_step },
                     { "rate", device->rate },
                     { "delay", device->delay },
                     { "jitter", device->jitter },
                     { "loss", device->loss },
                     { "double", device->doubled },
                     { "seed", device->seed },
                     { "force", device->force },
                     { "torque", device->torque },
                     { "hand_damping", device->hand_damping },
                     { "reach", device->reach },
                     { "cycle", device->cycle } };
    char name[2048];
    dpt_device *opened = NULL;
    int at = snprintf(name, sizeof name, "sim:?dofs=%d&gravity=%.17g", device->dofs, device->weight / device->mass);
    for (size_t i = 0; i < sizeof settings / sizeof *settings; i++)
        if (settings[i].value > 0.0)
            at += snprintf(name + at, sizeof name - (size_t)at, "&%s=%.17g", settings[i].name, settings[i].value);
    if (device->script)
        snprintf(name + at, sizeof name - (size_t)at, "&hand=%s&grip=%.17g&turn_grip=%.17g", device->script,
                 device->grip, device->turn_grip);
    return dpt_device_open(name, &opened, NULL) == DPT_OK ? opened : NULL;
}

dpt_coupling hand_loop_choose(const struct hand_loop *loop, double margin)
{
    const struct coupled_tool tool = { .rho = loop->tool.length / sqrt(12.0),
                                       .zoom = or_one(loop->zoom),
                                       .force_scale = or_one(loop->force_scale) };
    struct coupling_options options = { .stiffness = NAN, .gain_margin = margin };
    dpt_coupling coupling = { .size = sizeof coupling };
    dpt_device_info info = { .size = sizeof info };
    dpt_host_error error = { .size = sizeof error };
    dpt_device *device = open_device(&loop->device, loop->device.step, loop->device.turn_step);
    if (!device)
        return coupling;
    dpt_device_get_info(device, &info);
    dpt_device_close(device);
    options.rate = info.rate;
    if (loop->tissue && loop->tissue->is_interpolated && !loop->is_uncounted)
        options.loop_delay = tissue_period(loop->tissue);
    host_coupling_find(&tool, &info, &options, &coupling, &error);
    return coupling;
}

static double in_steps(double value, double step)
{
    return step > 0.0 ? step * floor(value / step + 0.5) : value;
}

/* The linear spring and damper, of each coordinate; the damper is on the difference of two samples. */
static dpt_force_info spring(struct hand_loop *loop, const double at[HAND_AXES], double dt)
{
    dpt_force_info report = { .size = sizeof report };
    const double part = loop->stiffness > 0.0 ? loop->damping / loop->stiffness : 0.0;
    double wrench[HAND_AXES];
    for (int k = 0; k < HAND_AXES; k++) {
        const double stiffness = k < 3 ? loop->stiffness : loop->rotational_stiffness;
        const double speed = loop->has_begun ? (at[k] - loop->before[k]) / dt : 0.0;
        wrench[k] = -stiffness * (at[k] + part * speed);
        report.energy += 0.5 * stiffness * at[k] * at[k];
    }
    memcpy(loop->before, at, sizeof loop->before);
    memcpy(report.wrench.force, wrench, sizeof report.wrench.force);
    memcpy(report.wrench.torque, wrench + 3, sizeof report.wrench.torque);
    return report;
}

static int is_astray(const double at[HAND_AXES])
{
    return dot(vec3_of(at), vec3_of(at)) > 0.01 || dot(vec3_of(at + 3), vec3_of(at + 3)) > 4.0;
}

static void note(struct hand_loop *loop, const dpt_loop_sample *sample, double time, const dpt_force_info *report)
{
    const dpt_device_state *state = sample->state;
    if (loop->count == loop->room)
        return;
    struct hand_moment *moment = &loop->track[loop->count++];
    moment->time = time;
    moment->energy = report->energy;
    moment->body_work = report->body_work;
    moment->tissue_work = loop->tissue ? tissue_work(loop->tissue) : 0.0;
    memcpy(moment->at, state->joint, sizeof moment->at);
    memcpy(moment->speed, state->velocity, sizeof state->velocity);
    memcpy(moment->speed + 3, state->spin, sizeof state->spin);
    memcpy(moment->sent, sample->sent.force, sizeof sample->sent.force);
    memcpy(moment->sent + 3, sample->sent.torque, sizeof sample->sent.torque);
}

static dpt_result feel(void *user, const dpt_loop_sample *sample, dpt_wrench *wrench)
{
    struct hand_loop *loop = user;
    const double time = 1e-9 * (double)sample->state->time_ns;
    const struct hand_device *device = &loop->device;
    double at[HAND_AXES];
    for (int k = 0; k < HAND_AXES; k++)
        at[k] = in_steps(sample->state->joint[k], k < 3 ? device->step : device->turn_step);
    if (loop->move)
        loop->move(loop, time);
    const dpt_force_info report = loop->place ? step_to(loop, at, sample->dt) : spring(loop, at, sample->dt);
    *wrench = report.wrench;
    if (loop->passivity) {
        /* It knows of the device what the encoders tell. */
        dpt_device_state state = *sample->state;
        dpt_loop_sample seen = *sample;
        state.pose = pose_at(at);
        seen.state = &state;
        scene_passivity_go_on(&loop->observer, &seen, report.energy, loop->is_uncredited ? 0.0 : report.body_work,
                              wrench);
    }
    note(loop, sample, time, &report);
    const double tapped = loop->has_begun ? 0.0 : sample->info->rate;
    for (int k = 0; k < 3; k++) {
        wrench->force[k] += loop->push[k] + tapped * loop->tap[k];
        wrench->torque[k] += loop->push[3 + k] + tapped * loop->tap[3 + k];
    }
    loop->has_begun = 1;
    if (is_astray(sample->state->joint))
        dpt_loop_stop(loop->running);
    return DPT_OK;
}

static int make_room(struct hand_loop *loop, uint64_t ticks)
{
    loop->count = 0;
    if (ticks <= loop->room)
        return 1;
    struct hand_moment *track = realloc(loop->track, ticks * sizeof *track);
    if (!track)
        return 0;
    loop->track = track;
    loop->room = ticks;
    return 1;
}

int hand_loop_run(struct hand_loop *loop, uint64_t ticks)
{
    dpt_guard_def open;
    dpt_loop_def def;
    dpt_device *device = open_device(&loop->device, 0.0, 0.0);
    dpt_guard_def_init(&open);
    open.force_max = open.torque_max = 1000.0;
    open.force_slew = open.torque_slew = open.start = 0.0;
    open.hold = 10.0;
    dpt_loop_def_init(&def);
    def.ticks = ticks;
    def.tick = feel;
    def.user = loop;
    def.guard = loop->guard ? loop->guard : &open;
    loop->has_begun = 0;
    scene_passivity_begin(&loop->observer, loop->passivity);
    const int is_run = device && make_room(loop, ticks) && dpt_loop_open(device, &def, &loop->running) == DPT_OK;
    if (is_run)
        dpt_loop_run(loop->running, NULL);
    dpt_loop_close(loop->running);
    dpt_device_close(device);
    loop->running = NULL;
    return is_run;
}

double hand_max(double a, double b)
{
    return isnan(a) || b <= a ? a : b;
}

double hand_min(double a, double b)
{
    return isnan(a) || b >= a ? a : b;
}

dpt_passivity_info hand_loop_account(const struct hand_loop *loop)
{
    return scene_passivity_info(&loop->observer);
}
