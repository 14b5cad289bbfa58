/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * RobStride's motors by their private protocol, and Xiaomi's CyberGear, from which it stems. An id has 29 bits: the type of
 * message << 24 | 16 bits of data << 8 | the addressee. The torque of a command is in the data of its id; the motor's number,
 * faults and mode are in that of a status.
 */
#include <math.h>
#include <string.h>

#include "can/drive.h"
#include "dynpoint/device.h"

#define TURN 6.283185307179586476925

enum { COMMAND = 1, STATUS = 2, ON = 3, OFF = 4, READ = 17, WRITE = 18, FAULT = 21 };
enum { MODE_RUN = 2 };

#define WATCHDOG_UNIT 50e-6 /* s: 20000 are one second */
#define MIT_MODE      0.0

static const struct drive_parameter robstride_parameters[] = {
    { .parameter = DRIVE_CONTROL, .action = DRIVE_SET, .index = 0x7005, .bytes = 1, .unit = 1.0, .min = MIT_MODE },
    { .parameter = DRIVE_TORQUE_LIMIT, .action = DRIVE_SET, .index = 0x700b },
    { .parameter = DRIVE_WATCHDOG, .action = DRIVE_SET, .index = 0x7028, .bytes = 4, .unit = WATCHDOG_UNIT },
};

static const struct drive_parameter cybergear_parameters[] = {
    { .parameter = DRIVE_CONTROL, .action = DRIVE_SET, .index = 0x7005, .bytes = 1, .unit = 1.0, .min = MIT_MODE },
    { .parameter = DRIVE_TORQUE_LIMIT, .action = DRIVE_SET, .index = 0x700b },
    { .parameter = DRIVE_WATCHDOG, .action = DRIVE_SET, .index = 0x200c, .bytes = 4, .unit = WATCHDOG_UNIT },
};

/* Bits 0 to 5: a status's. From bit 8 on: those of a fault message, shifted by 8. */
static const struct drive_fault faults[] = { { 0x1, DPT_REASON_DEVICE, "UNDER_VOLTAGE" },
                                             { 0x2, DPT_REASON_OVERLOADED, "OVER_CURRENT" },
                                             { 0x4, DPT_REASON_OVERHEATED, "OVER_TEMPERATURE" },
                                             { 0x8, DPT_REASON_UNCALIBRATED, "MAGNETIC_ENCODER" },
                                             { 0x10, DPT_REASON_OVERLOADED, "STALLED_OR_HALL_ENCODER" },
                                             { 0x20, DPT_REASON_UNCALIBRATED, "NOT_CALIBRATED" },
                                             { 0x100, DPT_REASON_OVERHEATED, "MOTOR_OVER_TEMPERATURE" },
                                             { 0x200, DPT_REASON_DEVICE, "DRIVER_CHIP" },
                                             { 0x400, DPT_REASON_DEVICE, "BUS_UNDER_VOLTAGE" },
                                             { 0x800, DPT_REASON_DEVICE, "BUS_OVER_VOLTAGE" },
                                             { 0x1000, DPT_REASON_OVERLOADED, "PHASE_B_OVER_CURRENT" },
                                             { 0x2000, DPT_REASON_OVERLOADED, "PHASE_C_OVER_CURRENT" },
                                             { 0x8000, DPT_REASON_UNCALIBRATED, "ENCODER_NOT_CALIBRATED" },
                                             { 0xff0000, DPT_REASON_OVERLOADED, "OVERLOAD" },
                                             { 0x1000000, DPT_REASON_OVERLOADED, "PHASE_A_OVER_CURRENT" },
                                             { 0, 0, NULL } };

static void put_16(uint8_t *at, uint32_t value)
{
    at[0] = (uint8_t)(value >> 8);
    at[1] = (uint8_t)value;
}

static uint32_t get_16(const uint8_t *at)
{
    return (uint32_t)at[0] << 8 | at[1];
}

static int address(struct can_message *frame, unsigned type, uint32_t data, unsigned to)
{
    frame->id = (uint32_t)type << 24 | (data & 0xffff) << 8 | (to & 0xff);
    frame->flags = CAN_MESSAGE_EXTENDED;
    frame->size = 8;
    return 1;
}

static int encode_parameter(const struct drive_node *node, const struct drive_message *message,
                            struct can_message *frame)
{
    const struct drive_parameter *parameter = drive_parameter_of(node->drive, message->parameter);
    if (!parameter)
        return 0;
    frame->data[0] = (uint8_t)parameter->index;
    frame->data[1] = (uint8_t)(parameter->index >> 8);
    if (message->kind != DRIVE_READ)
        drive_put_value(parameter, message->as.value, frame->data + 4);
    if (message->kind == DRIVE_VALUE)
        return address(frame, READ, node->number, node->answer);
    return address(frame, message->kind == DRIVE_READ ? READ : WRITE, node->answer, node->number);
}

static int encode(const struct drive_node *node, const struct drive_message *message, struct can_message *frame)
{
    memset(frame, 0, sizeof *frame);
    switch (message->kind) {
    case DRIVE_TORQUE: {
        const double torque = (double)message->as.command.torque;
        if (!isfinite(torque) || !(node->torque_range > 0.0) || !(node->velocity_range > 0.0))
            return 0;
        put_16(frame->data, drive_quantise(0.0, node->position_range, 16));
        put_16(frame->data + 2, drive_quantise(0.0, node->velocity_range, 16)); /* stiffness and damping are 0 */
        return address(frame, COMMAND, drive_quantise(torque, node->torque_range, 16), node->number);
    }
    case DRIVE_ON:
        return address(frame, ON, node->answer, node->number);
    case DRIVE_OFF:
    case DRIVE_STOP:
    case DRIVE_ASK:
        return address(frame, OFF, node->answer, node->number);
    case DRIVE_CLEAR:
        frame->data[0] = 1;
        return address(frame, OFF, node->answer, node->number);
    case DRIVE_READ:
    case DRIVE_WRITE:
    case DRIVE_VALUE:
        return encode_parameter(node, message, frame);
    case DRIVE_STATUS: {
        const struct drive_status *status = &message->as.status;
        if (!(node->torque_range > 0.0) || !(node->velocity_range > 0.0))
            return 0;
        put_16(frame->data, drive_quantise(TURN * (double)status->position, node->position_range, 16));
        put_16(frame->data + 2, drive_quantise(TURN * (double)status->velocity, node->velocity_range, 16));
        put_16(frame->data + 4, drive_quantise((double)status->torque, node->torque_range, 16));
        put_16(frame->data + 6, status->temperature > 0.0f ? (uint32_t)((double)status->temperature * 10.0 + 0.5) : 0);
        return address(frame, STATUS,
                       node->number | (status->fault & 0x3f) << 8 | (status->is_on ? (uint32_t)MODE_RUN << 14 : 0u),
                       node->answer);
    }
    case DRIVE_FAULT: {
        const uint32_t bits = message->as.fault >> 8;
        for (int i = 0; i < 4; i++)
            frame->data[i] = (uint8_t)(bits >> 8 * i);
        return address(frame, FAULT, node->number, node->answer);
    }
    default:
        return 0;
    }
}

static int decode_parameter(const struct drive_node *node, const uint8_t *data, struct drive_message *message, int kind)
{
    for (uint32_t i = 0; i < node->drive->parameter_count; i++) {
        const struct drive_parameter *parameter = &node->drive->parameters[i];
        if (parameter->index != (data[0] | data[1] << 8))
            continue;
        message->parameter = parameter->parameter;
        return kind == DRIVE_READ || drive_get_value(parameter, data + 4, &message->as.value) ? kind : DRIVE_DAMAGED;
    }
    return kind == DRIVE_WRITE ? DRIVE_ORDER : DRIVE_OTHER;
}

static int decode_command(const struct drive_node *node, uint32_t type, uint32_t data, const uint8_t *bytes,
                          struct drive_message *message)
{
    switch (type) {
    case 0: /* who are you? */
        return DRIVE_OTHER;
    case COMMAND:
        if (get_16(bytes + 4) || get_16(bytes + 6) || !(node->torque_range > 0.0))
            return DRIVE_ORDER; /* with stiffness or damping */
        message->as.command.torque = (float)drive_value_of(data, node->torque_range, 16);
        return DRIVE_TORQUE;
    case ON:
        return DRIVE_ON;
    case OFF:
        return bytes[0] == 1 ? DRIVE_CLEAR : DRIVE_OFF;
    case READ:
        return decode_parameter(node, bytes, message, DRIVE_READ);
    case WRITE:
        return decode_parameter(node, bytes, message, DRIVE_WRITE);
    default:
        return DRIVE_ORDER;
    }
}

static int decode_answer(const struct drive_node *node, uint32_t type, uint32_t data, const uint8_t *bytes,
                         struct drive_message *message)
{
    struct drive_status *status = &message->as.status;
    switch (type) {
    case STATUS:
        if (!(node->torque_range > 0.0) || !(node->velocity_range > 0.0))
            return DRIVE_OTHER;
        status->position = (float)(drive_value_of(get_16(bytes), node->position_range, 16) / TURN);
        status->velocity = (float)(drive_value_of(get_16(bytes + 2), node->velocity_range, 16) / TURN);
        status->torque = (float)drive_value_of(get_16(bytes + 4), node->torque_range, 16);
        status->temperature = (float)(0.1 * get_16(bytes + 6));
        status->fault = data >> 8 & 0x3f;
        status->is_on = data >> 14 == MODE_RUN;
        return DRIVE_STATUS;
    case READ:
        /* The byte above the number says why there is no value. */
        return data >> 8 ? DRIVE_OTHER : decode_parameter(node, bytes, message, DRIVE_VALUE);
    case FAULT:
        for (int i = 0; i < 3; i++)
            message->as.fault |= (uint32_t)bytes[i] << 8 * (i + 1);
        return message->as.fault ? DRIVE_FAULT : DRIVE_OTHER;
    default:
        return DRIVE_OTHER;
    }
}

static int decode(const struct drive_node *node, const struct can_message *frame, struct drive_message *message)
{
    const uint32_t type = frame->id >> 24 & 0x1f, data = frame->id >> 8 & 0xffff, to = frame->id & 0xff;
    memset(message, 0, sizeof *message);
    if (!(frame->flags & CAN_MESSAGE_EXTENDED) || frame->flags & (CAN_MESSAGE_REMOTE | CAN_MESSAGE_FD))
        return DRIVE_OTHER;
    const int is_command = to == node->number, is_answer = to == node->answer && (data & 0xff) == node->number;
    if (!is_command && !is_answer)
        return DRIVE_OTHER;
    if (frame->size != 8)
        return message->kind = DRIVE_DAMAGED;
    /* The manual has the addresses of a fault message the other way round, as if it went to the motor. */
    const int is_to_motor = is_command && type != FAULT;
    return message->kind = (uint8_t)(is_to_motor ? decode_command(node, type, data, frame->data, message)
                                                 : decode_answer(node, type, data, frame->data, message));
}

static int wanted(const struct drive_node *node, struct can_wanted *out)
{
    out[0] = (struct can_wanted){ .id = node->number, .mask = 0xff, .is_extended = 1 };
    out[1] = (struct can_wanted){ .id = (uint32_t)node->number << 8 | node->answer, .mask = 0xffff, .is_extended = 1 };
    return 2;
}

const struct can_drive robstride_drive = {
    .name = "robstride",
    .title = "RobStride",
    .answers = 1,
    .has_models = 1,
    .number_min = 1,
    .number_max = 127,
    .answer = 0xfd,
    .command_bits = 160,
    .answer_bits = 160,
    .position_range = 2.0 * TURN,
    .position_steps = 65535,
    .torque_steps = 65535,
    .parameters = robstride_parameters,
    .parameter_count = sizeof robstride_parameters / sizeof *robstride_parameters,
    .faults = faults,
    .faults_are_bits = 1,
    .encode = encode,
    .decode = decode,
    .wanted = wanted,
};

const struct can_drive cybergear_drive = {
    .name = "cybergear",
    .title = "CyberGear",
    .answers = 1,
    .number_min = 1,
    .number_max = 127,
    .answer = 0xfd,
    .command_bits = 160,
    .answer_bits = 160,
    .position_range = 12.5,
    .velocity_range = 30.0,
    .torque_range = 12.0,
    .heat_limit = 80.0,
    .position_steps = 65535,
    .torque_steps = 65535,
    .parameters = cybergear_parameters,
    .parameter_count = sizeof cybergear_parameters / sizeof *cybergear_parameters,
    .faults = faults,
    .faults_are_bits = 1,
    .encode = encode,
    .decode = decode,
    .wanted = wanted,
};
