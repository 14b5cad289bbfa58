/* SPDX-License-Identifier: BSD-3-Clause */
#include "loop_line.h"

#include <string.h>

#include "base/return_if_error.h"
#include "base/sized.h"
#include "base/vec3.h"

static const uint64_t RETRY_NS = 1000000000u;

dpt_result loop_line_open(struct loop_line_def *line, dpt_device *device, const dpt_guard_def *given,
                          uint64_t period_ns)
{
    dpt_guard_def *def = &line->guard;
    dpt_guard guard = { .size = sizeof guard };
    memset(line, 0, sizeof *line);
    line->device = device;
    line->info.size = sizeof line->info;
    DPT_TRY(dpt_device_get_info(device, &line->info));
    dpt_guard_def_init(def);
    if (given)
        DPT_TRY(sized_read(given, sizeof *given, def, sizeof *def));
    DPT_TRY(dpt_guard_init(&guard, def));
    if ((uint64_t)(def->hold * 1e9 + 0.5) < period_ns)
        return DPT_E_ARGUMENT;
    const double force = line->info.wrench_dofs < 3 ? 0.0 : line->info.force_max;
    const double torque = line->info.wrench_dofs < 6 ? 0.0 : line->info.torque_max;
    def->force_max = min_of(def->force_max, max_of(force, 0.0));
    def->torque_max = min_of(def->torque_max, max_of(torque, 0.0));
    return DPT_OK;
}

void loop_line_begin(struct loop_line *line, const struct loop_line_def *def)
{
    memset(line, 0, sizeof *line);
    line->def = def;
    line->stats.size = sizeof line->stats;
    line->state.size = sizeof line->state;
    line->guard.size = sizeof line->guard;
    line->sample.size = sizeof line->sample;
    line->sample.state = &line->state;
    line->sample.info = &def->info;
    dpt_guard_init(&line->guard, &def->guard);
}

static int pose_is_sound(const dpt_pose *pose)
{
    const double *q = pose->orientation;
    return vec3_within(pose->position, DPT_COORDINATE_MAX) &&
           within(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3] - 1.0, 2e-6);
}

/* Count the sample that was read. Returns 1 if it is newer than all before. */
static int accept_sample(struct loop_line *line)
{
    const dpt_device_state *state = &line->state;
    if (!state->fresh)
        return 0;
    if (line->has_sequence && state->sequence <= line->sequence) {
        line->stats.reordered++;
        return 0;
    }
    if (line->has_sequence)
        line->stats.skipped += state->sequence - line->sequence - 1;
    line->has_sequence = 1;
    line->sequence = state->sequence;
    return 1;
}

void loop_line_read(struct loop_line *line)
{
    const dpt_result result = dpt_device_read(line->def->device, &line->state);
    line->stats.ticks++;
    line->is_fresh = result == DPT_OK && accept_sample(line);
    line->is_ready = line->state.status == DPT_DEVICE_STATUS_READY && pose_is_sound(&line->state.pose);
    line->is_served = 0;
    if (result == DPT_E_LOST)
        line->state.status = DPT_DEVICE_STATUS_LOST;
}

/* The device gives no force until it takes the next command. */
static void clear_sent(struct loop_line *line)
{
    static const dpt_wrench zero;
    line->sample.sent = zero;
    line->sample.sent_ns = 0;
}

int loop_line_check_loss(struct loop_line *line, uint64_t now, int reopens)
{
    if (line->state.status != DPT_DEVICE_STATUS_LOST) {
        line->stats.reopened += (uint64_t)line->is_lost;
        line->is_lost = 0;
        return 0;
    }
    line->stats.lost++;
    if (!line->is_lost) {
        line->is_lost = 1;
        line->stats.losses++;
        line->retry_ns = now + RETRY_NS;
        line->has_sequence = line->has_host_sample = 0;
    }
    if (reopens && now >= line->retry_ns) {
        line->retry_ns = now + RETRY_NS;
        dpt_device_clear(line->def->device);
    }
    return 1;
}

int loop_line_has_sample(struct loop_line *line, double period)
{
    const dpt_device_state *state = &line->state;
    line->sample.dt = 0.0;
    if (line->is_lost || !line->is_fresh || !pose_is_sound(&state->pose))
        return 0;
    line->sample.dt = period;
    if (line->has_host_sample && state->time_ns > line->host_sample_ns)
        line->sample.dt = (double)(state->time_ns - line->host_sample_ns) * 1e-9;
    line->has_host_sample = 1;
    line->host_sample_ns = state->time_ns;
    return 1;
}

void loop_line_count(struct loop_line *line, int is_answered)
{
    const int is_seen = line->sample.dt > 0.0;
    if (line->is_lost)
        return;
    if (!line->is_fresh)
        line->stats.stale++;
    else if (!line->is_ready)
        line->stats.not_ready++;
    else if (is_seen && is_answered)
        line->stats.fresh++;
    else if (is_seen)
        line->stats.failed++;
    line->is_served = is_seen && is_answered;
    if (is_seen)
        line->sample.commands = 0;
}

static void send(struct loop_line *line, const dpt_wrench *wrench, uint64_t time_ns)
{
    const dpt_result result = dpt_device_write(line->def->device, wrench);
    if (result == DPT_OK) {
        line->stats.sent++;
        line->sample.commands++;
        line->sample.sent = *wrench;
        line->sample.sent_ns = time_ns;
        return;
    }
    line->stats.refused++;
    if (result == DPT_E_NOT_READY || result == DPT_E_LOST)
        clear_sent(line);
}

void loop_line_send(struct loop_line *line, const dpt_wrench *command, uint64_t now, uint64_t time_ns)
{
    dpt_wrench wrench;
    const int is_ready = line->is_ready && !line->is_lost;
    dpt_guard_step(&line->guard, now, line->is_served ? command : NULL, is_ready, &wrench);
    if (!line->is_lost && line->state.status == DPT_DEVICE_STATUS_READY)
        send(line, &wrench, time_ns);
    else
        clear_sent(line);
}

void loop_line_stop(struct loop_line *line, uint64_t now)
{
    dpt_wrench ignored;
    dpt_guard_step(&line->guard, now, NULL, 0, &ignored);
}

void loop_line_end(struct loop_line *line)
{
    dpt_guard_info guard = { .size = sizeof guard };
    dpt_guard_get_info(&line->guard, &guard);
    line->stats.stops = guard.stops;
    line->stats.clamped = guard.clamped;
    line->stats.slewed = guard.slewed;
    line->stats.not_finite = guard.not_finite;
}
