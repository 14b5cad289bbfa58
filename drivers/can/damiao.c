/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Damiao's joint motors in MIT mode. A command is a frame of 8 bytes to the motor's id (ESC_ID): position 16 bits, velocity,
 * stiffness, damping and torque 12 bits each. Eight bytes FF..FC to FF..FB switch on, switch off, set zero, forget faults.
 * Registers are read and written by the id 0x7ff. All answers come with the motor's answer id (MST_ID).
 */
#include <math.h>
#include <string.h>

#include "can/drive.h"
#include "dynpoint/device.h"

#define TURN 6.283185307179586476925

enum { REGISTERS_ID = 0x7ff, READ = 0x33, WRITE = 0x55, ASK = 0xcc, ON = 0xfc, OFF = 0xfd, CLEAR = 0xfb };
enum { STATE_OFF = 0, STATE_ON = 1 };

#define STIFFNESS_RANGE 500.0 /* Nm/rad, from 0 */
#define WATCHDOG_UNIT   50e-6 /* s */
#define MIT_MODE        1.0

static const struct drive_parameter parameters[] = {
    { .parameter = DRIVE_VERSION, .action = DRIVE_LEARN, .index = 14, .bytes = 4, .unit = 1.0 },
    { .parameter = DRIVE_CONTROL, .action = DRIVE_SET, .index = 10, .bytes = 4, .unit = 1.0, .min = MIT_MODE },
    { .parameter = DRIVE_POSITION_RANGE, .action = DRIVE_LEARN, .index = 21 },
    { .parameter = DRIVE_VELOCITY_RANGE, .action = DRIVE_LEARN, .index = 22 },
    { .parameter = DRIVE_TORQUE_RANGE, .action = DRIVE_LEARN, .index = 23 },
    { .parameter = DRIVE_HEAT_LIMIT, .action = DRIVE_LEARN, .index = 2 },
    { .parameter = DRIVE_WATCHDOG, .action = DRIVE_SET, .index = 9, .bytes = 4, .unit = WATCHDOG_UNIT },
};

static const struct drive_fault faults[] = { { 0x8, DPT_REASON_DEVICE, "OVER_VOLTAGE" },
                                             { 0x9, DPT_REASON_DEVICE, "UNDER_VOLTAGE" },
                                             { 0xa, DPT_REASON_OVERLOADED, "OVER_CURRENT" },
                                             { 0xb, DPT_REASON_OVERHEATED, "MOS_OVER_TEMPERATURE" },
                                             { 0xc, DPT_REASON_OVERHEATED, "COIL_OVER_TEMPERATURE" },
                                             { 0xd, DPT_REASON_WATCHDOG, "COMMUNICATION_LOST" },
                                             { 0xe, DPT_REASON_OVERLOADED, "OVERLOAD" },
                                             { 0, 0, NULL } };

static int has_ranges(const struct drive_node *node)
{
    return node->position_range > 0.0 && node->velocity_range > 0.0 && node->torque_range > 0.0;
}

static int encode_order(const struct drive_node *node, uint8_t order, struct can_message *frame)
{
    frame->id = node->number;
    frame->size = 8;
    memset(frame->data, 0xff, 7);
    frame->data[7] = order;
    return 1;
}

static int encode_register(const struct drive_node *node, const struct drive_message *message, uint8_t order,
                           struct can_message *frame)
{
    const struct drive_parameter *parameter = drive_parameter_of(node->drive, message->parameter);
    if (!parameter && order != ASK)
        return 0;
    frame->id = message->kind == DRIVE_VALUE ? node->answer : REGISTERS_ID;
    frame->size = 8;
    frame->data[0] = (uint8_t)node->number;
    frame->data[1] = (uint8_t)(node->number >> 8);
    frame->data[2] = order;
    if (parameter && order != ASK)
        frame->data[3] = (uint8_t)parameter->index;
    if (message->kind == DRIVE_WRITE || message->kind == DRIVE_VALUE)
        drive_put_value(parameter, message->as.value, frame->data + 4);
    return 1;
}

/* Position, velocity and torque as the five bytes after the first of an answer have them. */
static void put_state(const struct drive_node *node, const struct drive_status *status, uint8_t *data)
{
    const uint32_t position = drive_quantise(TURN * (double)status->position, node->position_range, 16);
    const uint32_t velocity = drive_quantise(TURN * (double)status->velocity, node->velocity_range, 12);
    const uint32_t torque = drive_quantise((double)status->torque, node->torque_range, 12);
    data[0] = (uint8_t)(position >> 8);
    data[1] = (uint8_t)position;
    data[2] = (uint8_t)(velocity >> 4);
    data[3] = (uint8_t)(velocity << 4 | torque >> 8);
    data[4] = (uint8_t)torque;
}

static int encode(const struct drive_node *node, const struct drive_message *message, struct can_message *frame)
{
    memset(frame, 0, sizeof *frame);
    switch (message->kind) {
    case DRIVE_TORQUE: {
        if (!has_ranges(node) || !isfinite((double)message->as.command.torque))
            return 0;
        const struct drive_status asked = { .torque = message->as.command.torque };
        uint8_t state[5];
        put_state(node, &asked, state);
        frame->id = node->number;
        frame->size = 8;
        memcpy(frame->data, state, 3);
        frame->data[3] = (uint8_t)(state[3] & 0xf0); /* no stiffness, no damping */
        frame->data[6] = (uint8_t)(state[3] & 0x0f);
        frame->data[7] = state[4];
        return 1;
    }
    case DRIVE_ON:
        return encode_order(node, ON, frame);
    case DRIVE_OFF:
    case DRIVE_STOP:
        return encode_order(node, OFF, frame);
    case DRIVE_CLEAR:
        return encode_order(node, CLEAR, frame);
    case DRIVE_ASK:
        return encode_register(node, message, ASK, frame);
    case DRIVE_READ:
    case DRIVE_VALUE:
        return encode_register(node, message, READ, frame);
    case DRIVE_WRITE:
        return encode_register(node, message, WRITE, frame);
    case DRIVE_STATUS: {
        const struct drive_status *status = &message->as.status;
        const uint32_t state = status->fault ? status->fault : status->is_on ? STATE_ON : STATE_OFF;
        if (!has_ranges(node) || state > 0xf)
            return 0;
        frame->id = node->answer;
        frame->size = 8;
        frame->data[0] = (uint8_t)(state << 4 | (node->number & 0xf));
        put_state(node, status, frame->data + 1);
        frame->data[6] = frame->data[7] = (uint8_t)(status->temperature > 0.0f ? status->temperature : 0.0f);
        return 1;
    }
    default:
        return 0;
    }
}

static int decode_register(const struct drive_node *node, const uint8_t *data, struct drive_message *message)
{
    for (uint32_t i = 0; i < node->drive->parameter_count; i++) {
        const struct drive_parameter *parameter = &node->drive->parameters[i];
        if (parameter->index != data[3])
            continue;
        message->parameter = parameter->parameter;
        return message->kind == DRIVE_READ || drive_get_value(parameter, data + 4, &message->as.value) ? message->kind
                                                                                                       : DRIVE_DAMAGED;
    }
    return DRIVE_OTHER;
}

static int decode_command(const struct drive_node *node, const uint8_t *data, struct drive_message *message)
{
    static const uint8_t order[7] = { 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff };
    if (!memcmp(data, order, 7))
        switch (data[7]) {
        case ON:
            return DRIVE_ON;
        case OFF:
            return DRIVE_OFF;
        case CLEAR:
            return DRIVE_CLEAR;
        default:
            return DRIVE_ORDER;
        }
    /* With stiffness or damping it is an order of another kind. */
    if (!has_ranges(node) || data[3] & 0x0f || data[4] || data[5] || data[6] & 0xf0)
        return DRIVE_ORDER;
    message->as.command.torque =
        (float)drive_value_of((uint32_t)(data[6] & 0x0f) << 8 | data[7], node->torque_range, 12);
    return DRIVE_TORQUE;
}

static int decode_status(const struct drive_node *node, const uint8_t *data, struct drive_message *message)
{
    struct drive_status *status = &message->as.status;
    const uint32_t state = data[0] >> 4;
    if ((data[0] & 0xf) != (node->number & 0xf) || !has_ranges(node))
        return DRIVE_OTHER;
    const uint32_t position = (uint32_t)data[1] << 8 | data[2];
    const uint32_t velocity = (uint32_t)data[3] << 4 | data[4] >> 4;
    const uint32_t torque = (uint32_t)(data[4] & 0xf) << 8 | data[5];
    status->position = (float)(drive_value_of(position, node->position_range, 16) / TURN);
    status->velocity = (float)(drive_value_of(velocity, node->velocity_range, 12) / TURN);
    status->torque = (float)drive_value_of(torque, node->torque_range, 12);
    status->temperature = (float)(data[6] > data[7] ? data[6] : data[7]);
    status->is_on = state == STATE_ON;
    status->fault = state > STATE_ON ? state : 0;
    return DRIVE_STATUS;
}

static int decode(const struct drive_node *node, const struct can_message *frame, struct drive_message *message)
{
    const uint8_t *data = frame->data;
    memset(message, 0, sizeof *message);
    if (frame->flags & (CAN_MESSAGE_EXTENDED | CAN_MESSAGE_REMOTE | CAN_MESSAGE_FD))
        return DRIVE_OTHER;
    const int is_to_registers = frame->id == REGISTERS_ID;
    if (!is_to_registers && frame->id != node->number && frame->id != node->answer)
        return DRIVE_OTHER;
    if (frame->size != 8)
        return message->kind = is_to_registers ? DRIVE_OTHER : DRIVE_DAMAGED;
    if (frame->id == node->number)
        return message->kind = (uint8_t)decode_command(node, data, message);
    const int is_own = data[0] == (node->number & 0xff) && data[1] == node->number >> 8;
    if (is_to_registers && is_own) {
        message->kind = data[2] == READ ? DRIVE_READ : data[2] == WRITE ? DRIVE_WRITE : DRIVE_OTHER;
        if (message->kind)
            return message->kind = (uint8_t)decode_register(node, data, message);
        return message->kind = data[2] == ASK ? DRIVE_ASK : DRIVE_ORDER;
    }
    if (is_to_registers)
        return DRIVE_OTHER;
    /*
     * A status of a motor that is off and stands at the very beginning of its range could have the same bytes; of one that is
     * on the first byte differs.
     */
    if (is_own && (data[2] == READ || data[2] == WRITE)) {
        message->kind = DRIVE_VALUE;
        const int kind = decode_register(node, data, message);
        if (kind != DRIVE_OTHER)
            return message->kind = (uint8_t)kind;
    }
    return message->kind = (uint8_t)decode_status(node, data, message);
}

static int wanted(const struct drive_node *node, struct can_wanted *out)
{
    out[0] = (struct can_wanted){ .id = node->number, .mask = 0x7ff };
    out[1] = (struct can_wanted){ .id = node->answer, .mask = 0x7ff };
    out[2] = (struct can_wanted){ .id = REGISTERS_ID, .mask = 0x7ff };
    return 3;
}

const struct can_drive damiao_drive = {
    .name = "damiao",
    .title = "Damiao",
    .answers = 1,
    .number_min = 1,
    .number_max = 15, /* an answer has four bits for it */
    .answer = 16,
    .answer_has_number = 1,
    .command_bits = 135,
    .answer_bits = 135,
    .position_steps = 65535,
    .torque_steps = 4095,
    .parameters = parameters,
    .parameter_count = sizeof parameters / sizeof *parameters,
    .faults = faults,
    .encode = encode,
    .decode = decode,
    .wanted = wanted,
};
