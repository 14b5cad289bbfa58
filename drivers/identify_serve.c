/* SPDX-License-Identifier: BSD-3-Clause */
#include "identify_serve.h"

#include <math.h>
#include <string.h>

#include "base/return_if_error.h"
#include "base/vec3.h"
#include "base/wrench_limit.h"
#include "rotation.h"

/* ---- how the device moves ---- */

const double identify_speed_max[IDENTIFY_SPACES] = { 0.2, 2.0 };
const double identify_displacement_max[IDENTIFY_SPACES] = { 0.02, 0.35 };

void identify_motion_init(struct identify_motion *motion, const dpt_device_info *info)
{
    const double periods = max_of(4.0, ceil(IDENTIFY_SPEED_TIME * info->rate));
    memset(motion, 0, sizeof *motion);
    motion->spaces = info->pose_dofs == 6 ? 2 : 1;
    motion->window = (uint32_t)min_of(periods, IDENTIFY_WINDOW_MAX - 1);
}

void identify_motion_pause(struct identify_motion *motion)
{
    motion->samples = 0;
}

void identify_motion_add(struct identify_motion *motion, const dpt_device_state *state)
{
    const uint64_t newest = motion->samples, window = motion->window;
    const uint64_t oldest = newest > window ? newest - window : 0;
    const uint64_t to = newest % (window + 1), from = oldest % (window + 1);
    if (!motion->has_start)
        motion->start = state->pose;
    motion->has_start = 1;
    for (int k = 0; k < 3; k++)
        motion->displacement[IDENTIFY_POSITIONS][k] = state->pose.position[k] - motion->start.position[k];
    rotation_between(motion->start.orientation, state->pose.orientation, motion->displacement[IDENTIFY_ANGLES]);
    motion->ring_ns[to] = state->time_ns;
    memcpy(motion->ring[to], motion->displacement, sizeof motion->ring[to]);
    const double dt = (double)(int64_t)(motion->ring_ns[to] - motion->ring_ns[from]) * 1e-9;
    for (uint32_t space = 0; space < motion->spaces; space++) {
        double *speed = motion->speed[space];
        for (int k = 0; k < 3; k++)
            speed[k] =
                newest >= window && dt > 0.0 ? (motion->ring[to][space][k] - motion->ring[from][space][k]) / dt : 0.0;
        motion->fastest[space] = max_of(motion->fastest[space], length(vec3_of(speed)));
        motion->furthest[space] = max_of(motion->furthest[space], length(vec3_of(motion->displacement[space])));
    }
    motion->samples++;
}

/* ---- pushes ---- */

/* The device's speed, and what a command does, are known so much later, s. */
static const double LATENCY = 0.01;

/* Above this part of the speed it is braked with all the force. */
static const double TOO_FAST = 1.2;

/* ---- a trial ---- */

static const double TRIAL_REST = 0.03; /* s */

double identify_trial_force(struct identify_trial *trial, double time, double y, double v, int *is_over)
{
    const double sign = trial->level < 0.0 ? -1.0 : 1.0, t = time;
    const double moved = sign * (y - trial->y0), speed = sign * v;
    *is_over = 0;
    trial->last = moved;
    trial->peak = fmax(trial->peak, moved);
    if (speed > trial->peak_speed) {
        trial->peak_speed = speed;
        trial->peak_time = t;
    }
    if (trial->brake < 0.0) {
        if (t < trial->push_time && !(speed > trial->speed && moved > trial->min_motion) && !(moved > trial->range))
            return trial->level;
        trial->brake = t;
    }
    if (trial->rest < 0.0) {
        if (speed > 0.0 && t < 2.5 * trial->brake)
            return -trial->level;
        trial->rest = t;
    }
    *is_over = t > trial->rest + TRIAL_REST;
    return 0.0;
}

/* ---- random pushes ---- */

/* A number from 0 to 1 (splitmix64). */
static double draw(uint64_t *random)
{
    uint64_t z = *random += 0x9e3779b97f4a7c15u;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return (double)((z ^ z >> 31) >> 11) * 0x1p-53;
}

/*
 * The next push. A whole one more often than a half or none; towards the middle where the device is far from it. One
 * that rests is pushed with all the force, for friction may hold it against less.
 */
static void choose(struct identify_pushes *pushes, double time, double y, double v)
{
    const struct identify_strength *strength = &pushes->strength;
    const double way = draw(&pushes->random), part = draw(&pushes->random);
    const double duration = draw(&pushes->random);
    const double inward = y > 0.0 ? -1.0 : 1.0;
    const int is_out = fabs(y) > 0.4 * strength->range, rests = fabs(v) < 0.1 * strength->speed;
    const double sign = is_out ? (way < 0.85 ? inward : -inward) : way < 0.5 ? 1.0 : -1.0;
    const double scale = rests || part < 0.55 ? 1.0 : part < 0.8 ? 0.5 : 0.0;
    pushes->force = sign * scale * strength->level;
    pushes->until = time + fmax(pushes->dwell_min, fmin(0.15, strength->rise * (0.3 + duration)));
}

/* How hard to brake: friction and damping alone tell more of themselves, the whole force more of the mass. */
static double brake_part(uint64_t *random)
{
    const double part = draw(random);
    return part < 0.4 ? 0.0 : part < 0.6 ? 0.5 : 1.0;
}

/* Whether braking has done what it was for. */
static int has_braked(const struct identify_pushes *pushes, double time, double v)
{
    const struct identify_strength *strength = &pushes->strength;
    const double left = pushes->brake * v; /* negative: it still goes that way */
    return left > (pushes->is_far ? 0.3 : -0.5) * strength->speed ||
           time - pushes->brake_began > 2.0 * strength->rise + 0.05;
}

double identify_pushes_force(struct identify_pushes *pushes, double time, double y, double v)
{
    const struct identify_strength *strength = &pushes->strength;
    const double stop = 0.5 * v * fabs(v) * strength->rise / strength->speed + LATENCY * v;
    const int is_fast = fabs(v) > strength->speed;
    const int is_far = fabs(y + stop) > strength->range && (y + stop) * v > 0.0;
    if (pushes->brake && has_braked(pushes, time, v)) {
        pushes->brake = 0;
        pushes->until = time;
    }
    if (is_far ? !pushes->is_far || !pushes->brake : is_fast && !pushes->brake) {
        pushes->brake = v > 0.0 ? -1 : 1;
        pushes->is_far = is_far;
        pushes->brake_began = time;
        pushes->brake_force = strength->level * (is_far ? 1.0 : brake_part(&pushes->random));
    }
    if (fabs(v) > TOO_FAST * strength->speed)
        pushes->brake_force = strength->level;
    if (pushes->brake)
        return pushes->force = pushes->brake * pushes->brake_force;
    if (time >= pushes->until)
        choose(pushes, time, y, v);
    return pushes->force;
}

/* ---- the loop ---- */

/* At most this many samples or commands in a row may be missing. */
enum { MISSING_MAX = 4 };

/* A device is back within this part of range and speed, for so long, s. */
static const double BACK_RANGE = 0.15, BACK_SPEED = 0.1, BACK_TIME = 0.02;

static const double REPORT_TIME = 0.05; /* s */

static void end(struct identify_server *server, uint32_t why)
{
    if (server->result->end == DPT_IDENTIFY_END_COMPLETE)
        server->result->end = why;
    dpt_loop_stop(server->loop);
}

static void end_stage(struct identify_server *server)
{
    server->is_over = 1;
    dpt_loop_stop(server->loop);
}

/* ---- may it go on? ---- */

static int report(struct identify_server *server, double time)
{
    const dpt_identify_progress progress = {
        .size = sizeof progress,
        .stage = server->stage == IDENTIFY_REST     ? DPT_IDENTIFY_STAGE_REST
                 : server->space == IDENTIFY_ANGLES ? DPT_IDENTIFY_STAGE_TURN
                                                    : DPT_IDENTIFY_STAGE_PUSH,
        .axis = server->axis,
        .done = fmin(1.0, (server->past + time) / server->planned),
    };
    if (!server->def.report || time < server->reported + REPORT_TIME)
        return 0;
    server->reported = time;
    return server->def.report(server->def.user, &progress);
}

/* Samples that come late are seen by their times, or by the commands that were repeated meanwhile. */
static int samples_are_missing(struct identify_server *server, const dpt_loop_sample *sample)
{
    const double gap = (double)(int64_t)(sample->state->time_ns - server->last_ns) * 1e-9;
    if (!server->has_sample)
        return 0;
    server->unsent = sample->commands ? 0 : server->unsent + 1;
    return gap * server->info.rate > MISSING_MAX + 1.5 || server->unsent > MISSING_MAX ||
           sample->commands > MISSING_MAX + 1;
}

/* Why the measurement must end now; DPT_IDENTIFY_END_COMPLETE: it need not. */
static uint32_t reason_to_end(struct identify_server *server, const dpt_loop_sample *sample, double time)
{
    const dpt_device_state *state = sample->state;
    const struct identify_motion *motion = &server->motion;
    if (report(server, time))
        return DPT_IDENTIFY_END_STOPPED;
    if (state->status == DPT_DEVICE_STATUS_LOST)
        return DPT_IDENTIFY_END_LOST;
    if (state->status != DPT_DEVICE_STATUS_READY)
        return DPT_IDENTIFY_END_NOT_READY;
    if (!server->def.may_move)
        return DPT_IDENTIFY_END_COMPLETE;
    if (server->def.button != DPT_IDENTIFY_NO_BUTTON && !(state->buttons >> server->def.button & 1))
        return DPT_IDENTIFY_END_RELEASED;
    if (server->stage != IDENTIFY_REST && samples_are_missing(server, sample))
        return DPT_IDENTIFY_END_SAMPLES;
    for (uint32_t space = 0; space < motion->spaces; space++) {
        if (length(vec3_of(motion->speed[space])) > identify_speed_max[space])
            return DPT_IDENTIFY_END_SPEED;
        if (length(vec3_of(motion->displacement[space])) > identify_displacement_max[space])
            return DPT_IDENTIFY_END_DISPLACEMENT;
    }
    return DPT_IDENTIFY_END_COMPLETE;
}

/* ---- what is recorded ---- */

static void record_sample(struct identify_server *server, uint32_t space, double time)
{
    struct identify_store *store = &server->store[space];
    if (store->sample_count == store->capacity)
        return;
    struct identify_sample *sample = &store->samples[store->sample_count++];
    sample->time = time;
    memcpy(sample->y, server->motion.displacement[space], sizeof sample->y);
}

/* Record the command that the device took last, if it is another one than before. */
static void record_command(struct identify_server *server, const dpt_loop_sample *sample)
{
    struct identify_store *store = &server->store[server->space];
    const double *sent = server->space == IDENTIFY_ANGLES ? sample->sent.torque : sample->sent.force;
    if (!sample->sent_ns || sample->sent_ns == server->sent_ns || store->command_count == store->capacity)
        return;
    server->sent_ns = sample->sent_ns;
    store->commands[store->command_count++] =
        (struct identify_command){ (double)(int64_t)(sample->sent_ns - server->begin_ns) * 1e-9, sent[server->axis] };
}

/* ---- the force of each stage ---- */

static void return_wrench(struct identify_server *server, double time, dpt_wrench *wrench)
{
    const struct identify_motion *motion = &server->motion;
    int is_back = 1;
    for (uint32_t space = 0; space < motion->spaces; space++)
        for (int k = 0; k < 3; k++) {
            const struct identify_return *back = &server->back[space][k];
            const double y = motion->displacement[space][k], v = motion->speed[space][k];
            double *out = space == IDENTIFY_ANGLES ? wrench->torque : wrench->force;
            out[k] = -back->stiffness * y - back->damping * v;
            is_back &= !(back->stiffness > 0.0) ||
                       (fabs(y) < BACK_RANGE * server->range[space] && fabs(v) < BACK_SPEED * server->speed[space]);
        }
    server->settled = !is_back ? -1.0 : server->settled < 0.0 ? time : server->settled;
    if (server->settled >= 0.0 && time > server->settled + BACK_TIME)
        end_stage(server);
}

static void push_wrench(struct identify_server *server, double time, dpt_wrench *wrench)
{
    const double y = server->motion.displacement[server->space][server->axis];
    const double v = server->motion.speed[server->space][server->axis];
    double *out = server->space == IDENTIFY_ANGLES ? wrench->torque : wrench->force;
    int is_over = 0;
    out[server->axis] = server->stage == IDENTIFY_TRIAL ? identify_trial_force(&server->trial, time, y, v, &is_over)
                                                        : identify_pushes_force(&server->pushes, time, y, v);
    if (is_over)
        end_stage(server);
}

static dpt_result tick(void *user, const dpt_loop_sample *sample, dpt_wrench *wrench)
{
    static const dpt_wrench zero;
    struct identify_server *server = user;
    const dpt_device_state *state = sample->state;
    if (!server->has_sample)
        server->begin_ns = state->time_ns;
    const double time = (double)(int64_t)(state->time_ns - server->begin_ns) * 1e-9;
    identify_motion_add(&server->motion, state);
    const uint32_t why = reason_to_end(server, sample, time);
    server->has_sample = 1;
    server->last_ns = state->time_ns;
    if (why != DPT_IDENTIFY_END_COMPLETE || server->result->end != DPT_IDENTIFY_END_COMPLETE) {
        end(server, why);
        return DPT_OK;
    }
    server->result->samples++;
    if (server->stage == IDENTIFY_REST)
        for (uint32_t space = 0; space < server->motion.spaces; space++)
            record_sample(server, space, time);
    if (server->stage == IDENTIFY_BLOCK) {
        record_sample(server, server->space, time);
        record_command(server, sample);
    }
    if (server->stage == IDENTIFY_RETURN)
        return_wrench(server, time, wrench);
    else if (server->stage != IDENTIFY_REST)
        push_wrench(server, time, wrench);
    limit_length(wrench->force, server->bound[IDENTIFY_POSITIONS]);
    limit_length(wrench->torque, server->bound[IDENTIFY_ANGLES]);
    if (time >= server->duration)
        end_stage(server);
    if (server->is_over)
        *wrench = zero;
    return DPT_OK;
}

/* ---- a stage ---- */

static dpt_result note_run(struct identify_server *server, const dpt_loop_stats *stats, dpt_result result)
{
    const int pushes = server->stage != IDENTIFY_REST;
    server->result->lost += stats->skipped;
    server->result->late += stats->stale - stats->reordered;
    server->result->doubled += stats->reordered;
    server->past += server->duration;
    if (server->result->end != DPT_IDENTIFY_END_COMPLETE)
        return DPT_OK;
    if (result == DPT_E_LOST)
        server->result->end = DPT_IDENTIFY_END_LOST;
    else if (result == DPT_E_NOT_READY)
        server->result->end = pushes ? DPT_IDENTIFY_END_NOT_READY : DPT_IDENTIFY_END_COMPLETE;
    else if (result == DPT_E_SYSTEM)
        return result;
    else if (!server->is_over || (pushes && result != DPT_OK))
        server->result->end = DPT_IDENTIFY_END_SAMPLES;
    return DPT_OK;
}

dpt_result identify_serve(struct identify_server *server)
{
    dpt_loop_def def;
    dpt_guard_def guard;
    dpt_loop_stats stats = { .size = sizeof stats };
    const int pushes = server->stage != IDENTIFY_REST;
    dpt_loop_def_init(&def);
    dpt_guard_def_init(&guard);
    guard.force_max = pushes ? server->bound[IDENTIFY_POSITIONS] : 0.0;
    guard.torque_max = pushes ? server->bound[IDENTIFY_ANGLES] : 0.0;
    guard.force_slew = guard.torque_slew = guard.start = 0.0;
    guard.hold = fmax(guard.hold, 3.0 / server->info.rate);
    def.guard = &guard;
    def.tick = tick;
    def.user = server;
    def.lock = 0;
    /* A device without samples must not be served for ever. */
    def.ticks = (uint64_t)(1.25 * server->duration * server->info.rate) + 50;
    server->is_over = server->has_sample = 0;
    server->unsent = 0;
    server->sent_ns = 0;
    server->reported = -REPORT_TIME;
    server->settled = -1.0;
    identify_motion_pause(&server->motion);
    DPT_TRY(dpt_loop_open(server->device, &def, &server->loop));
    const dpt_result result = dpt_loop_run(server->loop, &stats);
    dpt_loop_close(server->loop);
    server->loop = NULL;
    return note_run(server, &stats, result);
}
