/* SPDX-License-Identifier: BSD-3-Clause */
#include "wire_device.h"

#include <math.h>
#include <string.h>

static void relax(struct wire_device *device)
{
    device->armed = 0;
    device->silence = 0;
    memset(device->force, 0, sizeof device->force);
    memset(device->torque, 0, sizeof device->torque);
}

void wire_device_init(struct wire_device *device, const struct wire_info *info)
{
    memset(device, 0, sizeof *device);
    device->info = *info;
    device->watchdog = (uint32_t)(info->watchdog * info->rate + 0.5f);
    if (device->watchdog == 0)
        device->watchdog = 1;
    wire_order_start(&device->order, 0);
}

uint8_t wire_device_status(const struct wire_device *device)
{
    if (device->reasons)
        return WIRE_STATUS_FAULT;
    return device->enabled && !(device->causes & WIRE_REASON_UNCALIBRATED) ? WIRE_STATUS_READY
                                                                           : WIRE_STATUS_UNREADY;
}

/* In double: no square of a float is too large for it. */
static void take_vector(float out[3], const float in[3], double most)
{
    double square = 0.0;
    for (int i = 0; i < 3; i++)
        square += (double)in[i] * in[i];
    const double scale = square > most * most ? most / sqrt(square) : 1.0;
    for (int i = 0; i < 3; i++)
        out[i] = (float)(in[i] * scale);
}

static void take_command(struct wire_device *device, const struct wire_command *command)
{
    if (!wire_order_take(&device->order, command->sequence))
        return;
    if (device->sequence - command->answers > device->watchdog) {
        device->late++;
        return;
    }
    if (wire_device_status(device) != WIRE_STATUS_READY)
        return;
    device->armed = 1;
    device->silence = 0;
    if (device->info.wrench_dofs >= 3)
        take_vector(device->force, command->force, device->info.force_max);
    if (device->info.wrench_dofs >= 6)
        take_vector(device->torque, command->torque, device->info.torque_max);
}

static void take_order(struct wire_device *device, uint8_t order)
{
    switch (order) {
    case WIRE_ENABLE:
        if (!device->reasons)
            device->enabled = 1;
        return;
    case WIRE_CLEAR:
        device->reasons = device->causes & (uint16_t)~WIRE_REASON_UNCALIBRATED;
        break;
    default:
        device->enabled = 0;
    }
    if (wire_device_status(device) != WIRE_STATUS_READY)
        relax(device);
}

static void begin(struct wire_device *device, uint16_t session)
{
    device->session = session;
    device->enabled = 0;
    device->late = 0;
    device->greeted = 1;
    wire_order_start(&device->order, 0);
    relax(device);
}

void wire_device_take(struct wire_device *device, uint8_t byte)
{
    struct wire_message message;
    if (wire_read(&device->reader, byte, &message) != WIRE_MESSAGE)
        return;
    if (message.type == WIRE_HELLO && message.session != 0) {
        device->unheard = 0;
        /* A hello that is repeated because its answer was lost must not undo what came between. */
        if (message.session != device->session)
            begin(device, message.session);
        device->greeted = 1;
    }
    if (message.session != device->session || device->session == 0)
        return;
    device->unheard = 0;
    if (message.type == WIRE_COMMAND)
        take_command(device, &message.as.command);
    else if (message.type == WIRE_ORDER)
        take_order(device, message.as.order);
}

void wire_device_log(struct wire_device *device, const char *text)
{
    size_t size = strlen(text);
    if (size > WIRE_LOG_MAX)
        size = WIRE_LOG_MAX;
    memcpy(device->log, text, size);
    device->log_size = (uint8_t)size;
}

static void watch(struct wire_device *device, const struct wire_sample *sample)
{
    const uint16_t faults = sample->causes & (uint16_t)~WIRE_REASON_UNCALIBRATED;
    device->causes = sample->causes;
    if (faults & ~device->reasons)
        device->code = sample->code;
    device->reasons |= faults;
    if (device->armed && ++device->silence > device->watchdog)
        device->reasons |= WIRE_REASON_WATCHDOG;
    if (device->reasons)
        device->enabled = 0;
    if (wire_device_status(device) != WIRE_STATUS_READY)
        relax(device);
    /* A host that is gone: the line becomes quiet for the next one. */
    if (device->session != 0 && (float)++device->unheard > device->info.rate) {
        device->session = 0;
        device->enabled = 0;
        relax(device);
    }
}

static size_t say_state(struct wire_device *device, const struct wire_sample *sample, uint8_t *out)
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
    state->lost = (uint16_t)device->order.lost;
    state->late = (uint16_t)device->late;
    state->reordered = (uint8_t)device->order.reordered;
    state->sequence = device->sequence;
    state->time = sample->time;
    state->echo = device->order.last;
    memcpy(state->position, sample->position, sizeof state->position);
    memcpy(state->velocity, sample->velocity, sizeof state->velocity);
    memcpy(state->orientation, sample->orientation, sizeof state->orientation);
    memcpy(state->spin, sample->spin, sizeof state->spin);
    memcpy(state->joint, sample->joint, sizeof state->joint);
    return wire_encode(&message, out);
}

static size_t say_alive(const struct wire_device *device, const struct wire_sample *sample,
                        uint8_t *out)
{
    struct wire_message message = { .type = WIRE_HEARTBEAT };
    message.as.heartbeat.status = wire_device_status(device);
    message.as.heartbeat.reasons = device->reasons;
    message.as.heartbeat.sequence = device->sequence;
    message.as.heartbeat.time = sample->time;
    return wire_encode(&message, out);
}

size_t wire_device_sample(struct wire_device *device, const struct wire_sample *sample,
                          uint8_t out[WIRE_OUT_MAX])
{
    struct wire_message message = { .session = device->session };
    size_t size = 0;
    device->sequence++;
    watch(device, sample);
    if (device->session == 0) {
        uint32_t period = (uint32_t)(device->info.rate / 10.0f);
        if (device->sequence % (period > 0 ? period : 1) == 0)
            size = say_alive(device, sample, out);
        return size;
    }
    if (device->greeted) {
        device->greeted = 0;
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
    return size + say_state(device, sample, out + size);
}
