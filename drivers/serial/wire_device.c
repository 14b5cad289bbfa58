/* SPDX-License-Identifier: BSD-3-Clause */
#include "wire_device.h"

#include <math.h>
#include <string.h>

static void zero_wrench(struct wire_device *device)
{
    device->is_armed = 0;
    device->samples_since_command = 0;
    memset(device->force, 0, sizeof device->force);
    memset(device->torque, 0, sizeof device->torque);
}

void wire_device_init(struct wire_device *device, const struct wire_info *info)
{
    memset(device, 0, sizeof *device);
    device->info = *info;
    device->watchdog_samples = (uint32_t)(info->watchdog * info->rate + 0.5f);
    if (device->watchdog_samples == 0)
        device->watchdog_samples = 1;
    wire_sequence_start(&device->commands, 0);
}

uint8_t wire_device_status(const struct wire_device *device)
{
    if (device->reasons)
        return WIRE_STATUS_FAULT;
    return device->is_enabled && !(device->causes & WIRE_REASON_UNCALIBRATED) ? WIRE_STATUS_READY : WIRE_STATUS_UNREADY;
}

/* Copy a vector, scaled down to the length `max`. In double no square of a float overflows. */
static void set_limited(float out[3], const float in[3], double max)
{
    double square = 0.0;
    for (int i = 0; i < 3; i++)
        square += (double)in[i] * in[i];
    const double scale = square > max * max ? max / sqrt(square) : 1.0;
    for (int i = 0; i < 3; i++)
        out[i] = (float)(in[i] * scale);
}

static void accept_command(struct wire_device *device, const struct wire_command *command)
{
    if (!wire_sequence_accept(&device->commands, command->sequence))
        return;
    if (device->sequence - command->answers > device->watchdog_samples) {
        device->late++;
        return;
    }
    if (wire_device_status(device) != WIRE_STATUS_READY)
        return;
    device->is_armed = 1;
    device->samples_since_command = 0;
    if (device->info.wrench_dofs >= 3)
        set_limited(device->force, command->force, device->info.force_max);
    if (device->info.wrench_dofs >= 6)
        set_limited(device->torque, command->torque, device->info.torque_max);
}

static void obey_order(struct wire_device *device, uint8_t order)
{
    switch (order) {
    case WIRE_ENABLE:
        if (!device->reasons)
            device->is_enabled = 1;
        return;
    case WIRE_CLEAR:
        device->reasons = device->causes & (uint16_t)~WIRE_REASON_UNCALIBRATED;
        break;
    default:
        device->is_enabled = 0;
    }
    if (wire_device_status(device) != WIRE_STATUS_READY)
        zero_wrench(device);
}

static void begin_session(struct wire_device *device, uint16_t session)
{
    device->session = session;
    device->is_enabled = 0;
    device->late = 0;
    device->must_send_info = 1;
    wire_sequence_start(&device->commands, 0);
    zero_wrench(device);
}

void wire_device_take(struct wire_device *device, uint8_t byte)
{
    struct wire_message message;
    if (wire_read(&device->reader, byte, &message) != WIRE_MESSAGE)
        return;
    if (message.type == WIRE_HELLO && message.session != 0) {
        device->samples_since_frame = 0;
        /* A HELLO that is repeated because its answer was lost must not restart the session. */
        if (message.session != device->session)
            begin_session(device, message.session);
        device->must_send_info = 1;
    }
    if (message.session != device->session || device->session == 0)
        return;
    device->samples_since_frame = 0;
    if (message.type == WIRE_COMMAND)
        accept_command(device, &message.as.command);
    else if (message.type == WIRE_ORDER)
        obey_order(device, message.as.order);
}

void wire_device_log(struct wire_device *device, const char *text)
{
    size_t size = strlen(text);
    if (size > WIRE_LOG_MAX)
        size = WIRE_LOG_MAX;
    memcpy(device->log, text, size);
    device->log_size = (uint8_t)size;
}

static void update_status(struct wire_device *device, const struct wire_sample *sample)
{
    const uint16_t faults = sample->causes & (uint16_t)~WIRE_REASON_UNCALIBRATED;
    device->causes = sample->causes;
    if (faults & ~device->reasons)
        device->code = sample->code;
    device->reasons |= faults;
    if (device->is_armed && ++device->samples_since_command > device->watchdog_samples)
        device->reasons |= WIRE_REASON_WATCHDOG;
    if (device->reasons)
        device->is_enabled = 0;
    if (wire_device_status(device) != WIRE_STATUS_READY)
        zero_wrench(device);
    /* The host is gone: end the session, so that the line is quiet for the next host. */
    if (device->session != 0 && (float)++device->samples_since_frame > device->info.rate) {
        device->session = 0;
        device->is_enabled = 0;
        zero_wrench(device);
    }
}

static size_t encode_state(struct wire_device *device, const struct wire_sample *sample, uint8_t *out)
{
    struct wire_message message = { .type = WIRE_STATE, .session = device->session };
    struct wire_state *state = &message.as.state;
    state->pose_dofs = device->info.pose_dofs;
    state->joints = device->info.joints;
    state->status = wire_device_status(device);
    state->temperature = sample->temperature;
    state->reasons = device->reasons | (device->causes & WIRE_REASON_UNCALIBRATED);
    state->code = device->code;
    state->buttons = sample->buttons;
    state->lost = (uint16_t)device->commands.lost;
    state->late = (uint16_t)device->late;
    state->reordered = (uint8_t)device->commands.reordered;
    state->sequence = device->sequence;
    state->time = sample->time;
    state->echo = device->commands.last;
    memcpy(state->position, sample->position, sizeof state->position);
    memcpy(state->velocity, sample->velocity, sizeof state->velocity);
    memcpy(state->orientation, sample->orientation, sizeof state->orientation);
    memcpy(state->spin, sample->spin, sizeof state->spin);
    memcpy(state->joint, sample->joint, sizeof state->joint);
    return wire_encode(&message, out);
}

static size_t encode_heartbeat(const struct wire_device *device, const struct wire_sample *sample, uint8_t *out)
{
    struct wire_message message = { .type = WIRE_HEARTBEAT };
    message.as.heartbeat.status = wire_device_status(device);
    message.as.heartbeat.reasons = device->reasons;
    message.as.heartbeat.sequence = device->sequence;
    message.as.heartbeat.time = sample->time;
    return wire_encode(&message, out);
}

size_t wire_device_sample(struct wire_device *device, const struct wire_sample *sample, uint8_t out[WIRE_OUT_MAX])
{
    struct wire_message message = { .session = device->session };
    size_t size = 0;
    device->sequence++;
    update_status(device, sample);
    if (device->session == 0) {
        uint32_t period = (uint32_t)(device->info.rate / 10.0f);
        if (device->sequence % (period > 0 ? period : 1) == 0)
            size = encode_heartbeat(device, sample, out);
        return size;
    }
    if (device->must_send_info) {
        device->must_send_info = 0;
        message.type = WIRE_INFO;
        message.as.info = device->info;
        size += wire_encode(&message, out);
    }
    if (device->log_size > 0) {
        message.type = WIRE_LOG;
        message.as.log.size = device->log_size;
        memcpy(message.as.log.text, device->log, device->log_size);
        device->log_size = 0;
        size += wire_encode(&message, out + size);
    }
    return size + encode_state(device, sample, out + size);
}
