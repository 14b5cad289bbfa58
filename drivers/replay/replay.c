/* SPDX-License-Identifier: BSD-3-Clause */
/* A device that plays a recorded motion, a trace of tick,ax,ay,az,bx,by,bz (docs/back_ends.md, "replay"). */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/angle.h"
#include "base/quaternion.h"
#include "base/return_if_error.h"
#include "base/vec3.h"
#include "csv.h"
#include "dynpoint/driver.h"
#include "platform/clock.h"
#include "settings.h"

/* The longest trace. 2^63 ns are 292 years, and a trace may be repeated. */
static const double SECONDS_MAX = 100.0 * 365.0 * 86400.0;

struct replay {
    dpt_device device;
    double rate, live, again;
    struct dynamics dynamics;
    struct csv_table table;
    size_t row; /* of the present sample */
    int has_begun, has_ended;
    uint64_t past_ticks; /* of the repetitions that are over */
    uint64_t began_ns, read_sequence;
    int was_read;
    dpt_device_state sample;
    dpt_device_counts counts;
};

static uint64_t tick_at(const struct replay *replay, size_t row)
{
    return (uint64_t)(csv_table_row(&replay->table, row)[0] - csv_table_row(&replay->table, 0)[0]);
}

static uint64_t ticks_of(const struct replay *replay)
{
    return tick_at(replay, replay->table.rows - 1) + 1;
}

/* The smallest rotation from one direction to another, both of unit length, as a quaternion. */
static void shortest_turn(vec3 from, vec3 to, double *q)
{
    double w = 1.0 + dot(from, to);
    vec3 axis = cross(from, to);
    if (w < 1e-12) {
        w = 0.0;
        axis = fabs(from.x) < 0.7 ? cross(from, (vec3){ 1.0, 0.0, 0.0 }) : cross(from, (vec3){ 0.0, 1.0, 0.0 });
    }
    double size = sqrt(w * w + dot(axis, axis));
    q[0] = w / size;
    vec3_store(scaled(axis, 1.0 / size), q + 1);
}

/* The tool's own axis, z, in the world. */
static vec3 tool_axis(const double *q)
{
    return (vec3){ 2.0 * (q[1] * q[3] + q[0] * q[2]), 2.0 * (q[2] * q[3] - q[0] * q[1]),
                   1.0 - 2.0 * (q[1] * q[1] + q[2] * q[2]) };
}

/*
 * The sample of the present row: the origin is A, z points to B. It turns no more than it must, from the identity
 * after a jump.
 */
static void take_sample(struct replay *replay, int is_jump)
{
    dpt_device_state *sample = &replay->sample;
    const double *ends = csv_table_row(&replay->table, replay->row) + 1;
    vec3 a = vec3_of(ends), along_tool = sub(vec3_of(ends + 3), a), direction_before = { 0.0, 0.0, 1.0 };
    double size = length(along_tool), rotation[4];
    static const double identity[4] = { 1.0, 0.0, 0.0, 0.0 };
    memset(sample->velocity, 0, sizeof sample->velocity);
    memset(sample->spin, 0, sizeof sample->spin);
    if (is_jump)
        memcpy(sample->pose.orientation, identity, sizeof identity);
    else
        vec3_store(scaled(sub(a, vec3_of(sample->pose.position)), replay->rate), sample->velocity);
    vec3_store(a, sample->pose.position);
    sample->sequence = replay->past_ticks + tick_at(replay, replay->row);
    sample->time_ns = replay->began_ns + (uint64_t)((double)sample->sequence * 1e9 / replay->rate + 0.5);
    sample->temperature = -1.0;
    if (size == 0.0)
        return;
    vec3 direction = scaled(along_tool, 1.0 / size);
    direction_before = tool_axis(sample->pose.orientation);
    shortest_turn(direction_before, direction, rotation);
    const double half_sine = length(vec3_of(rotation + 1));
    if (!is_jump && half_sine > 0.0)
        vec3_store(scaled(vec3_of(rotation + 1), replay->rate * angle_between(direction_before, direction) / half_sine),
                   sample->spin);
    quaternion_multiply(rotation, sample->pose.orientation, sample->pose.orientation);
    quaternion_normalise(sample->pose.orientation);
}

static void next_row(struct replay *replay)
{
    if (replay->row + 1 < replay->table.rows) {
        replay->row++;
        take_sample(replay, trace_is_jump(&replay->table, replay->row));
    } else if (replay->again != 0.0) {
        replay->past_ticks += ticks_of(replay);
        replay->row = 0;
        take_sample(replay, 1);
    } else {
        replay->has_ended = 1;
    }
}

static uint64_t next_sequence(const struct replay *replay)
{
    return replay->row + 1 < replay->table.rows ? replay->past_ticks + tick_at(replay, replay->row + 1)
                                                : replay->past_ticks + ticks_of(replay);
}

static dpt_result catch_up(struct replay *replay)
{
    uint64_t now;
    DPT_TRY(clock_read(&now));
    if (!replay->has_begun) {
        replay->began_ns = now;
        take_sample(replay, 1);
    }
    uint64_t sequence = (uint64_t)((double)(now - replay->began_ns) * replay->rate * 1e-9);
    while (!replay->has_ended && next_sequence(replay) <= sequence)
        next_row(replay);
    return DPT_OK;
}

static dpt_result replay_read(dpt_device *device, dpt_device_state *state)
{
    struct replay *replay = (struct replay *)device;
    dpt_result result = DPT_OK;
    if (replay->live != 0.0)
        result = catch_up(replay);
    else if (replay->has_begun && !replay->has_ended)
        next_row(replay);
    replay->has_begun = 1;
    *state = replay->sample;
    state->status = replay->has_ended ? DPT_DEVICE_STATUS_LOST : DPT_DEVICE_STATUS_READY;
    state->reasons = replay->has_ended ? DPT_REASON_UNPLUGGED : 0;
    if (replay->has_ended || result != DPT_OK)
        return replay->has_ended ? DPT_E_LOST : result;
    uint64_t passed = replay->was_read ? state->sequence - replay->read_sequence : 1;
    state->fresh = passed < UINT32_MAX ? (uint32_t)passed : UINT32_MAX;
    replay->was_read = 1;
    replay->read_sequence = state->sequence;
    return DPT_OK;
}

static dpt_result replay_write(dpt_device *device, const dpt_wrench *wrench)
{
    struct replay *replay = (struct replay *)device;
    (void)wrench;
    if (replay->has_ended)
        return DPT_E_LOST;
    replay->counts.commands++;
    return DPT_OK;
}

static void rewind_trace(struct replay *replay)
{
    replay->row = 0;
    replay->past_ticks = 0;
    replay->has_begun = replay->has_ended = replay->was_read = 0;
    take_sample(replay, 1);
}

static dpt_result replay_clear(dpt_device *device)
{
    struct replay *replay = (struct replay *)device;
    if (!replay->has_ended)
        return DPT_OK;
    replay->counts.resets++;
    rewind_trace(replay);
    return DPT_OK;
}

static void replay_counts(const dpt_device *device, dpt_device_counts *counts)
{
    const struct replay *replay = (const struct replay *)device;
    *counts = replay->counts;
    counts->samples = replay->has_begun ? replay->sample.sequence + 1 : 0;
}

static void replay_info(const dpt_device *device, dpt_device_info *info)
{
    const struct replay *replay = (const struct replay *)device;
    *info = (dpt_device_info){ .pose_dofs = 6,
                               .wrench_dofs = 6,
                               .flags = DPT_DEVICE_FLAG_SIMULATED |
                                        (replay->live != 0.0 ? 0 : DPT_DEVICE_FLAG_DETERMINISTIC),
                               .rate = replay->rate,
                               .force_max = 1000.0,
                               .torque_max = 1000.0,
                               .name = "recorded motion" };
    dynamics_override(&replay->dynamics, info);
    for (int k = 0; k < 3; k++) {
        info->workspace_min[k] = info->workspace_max[k] = replay->table.values[1 + k];
        for (size_t row = 0; row < replay->table.rows; row++) {
            double value = csv_table_row(&replay->table, row)[1 + k];
            info->workspace_min[k] = min_of(info->workspace_min[k], value);
            info->workspace_max[k] = max_of(info->workspace_max[k], value);
        }
    }
}

static void replay_close(dpt_device *device)
{
    struct replay *replay = (struct replay *)device;
    csv_table_free(&replay->table);
    free(replay);
}

static dpt_result check_length(const struct replay *replay, const char *path, dpt_device_error *error)
{
    const struct csv_table *table = &replay->table;
    const double ticks = csv_table_row(table, table->rows - 1)[0] - csv_table_row(table, 0)[0];
    if (ticks > SECONDS_MAX * replay->rate)
        return device_error(error, DPT_E_LIMIT, "%.160s: its ticks, at %g Hz, are more than 100 years", path,
                            replay->rate);
    return DPT_OK;
}

static dpt_result read_settings_and_trace(struct replay *replay, const char *where, dpt_device_error *error)
{
    char path[1024];
    const struct setting settings[] = {
        { .name = "rate", .number = &replay->rate, .min = 1.0, .max = 1e5 },
        { .name = "live", .number = &replay->live, .max = 1.0 },
        { .name = "again", .number = &replay->again, .max = 1.0 },
    };
    DPT_TRY(settings_read(where, path, sizeof path, settings, sizeof settings / sizeof *settings, &replay->dynamics,
                          error));
    if (!path[0])
        return device_error(error, DPT_E_SETTING, "name a trace, as in replay:slide.csv");
    DPT_TRY(csv_table_read(&replay->table, path, &trace_format, error));
    return check_length(replay, path, error);
}

static dpt_result replay_open(const dpt_driver *driver, const char *where, dpt_device **device, dpt_device_error *error)
{
    (void)driver;
    struct replay *replay = calloc(1, sizeof *replay);
    if (!replay)
        return device_error(error, DPT_E_MEMORY, "memory ran out");
    replay->rate = 1000.0;
    const dpt_result result = read_settings_and_trace(replay, where, error);
    if (result != DPT_OK) {
        replay_close(&replay->device);
        return result;
    }
    rewind_trace(replay);
    *device = &replay->device;
    return DPT_OK;
}

const dpt_driver replay_driver = {
    .size = sizeof(dpt_driver),
    .version = DPT_DRIVER_VERSION,
    .name = "replay",
    .about = "a recorded motion; what is written to it has no effect",
    .open = replay_open,
    .info = replay_info,
    .read = replay_read,
    .write = replay_write,
    .clear = replay_clear,
    .counts = replay_counts,
    .close = replay_close,
};
