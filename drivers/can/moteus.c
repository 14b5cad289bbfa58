/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * moteus controllers of mjbots by CAN-FD. An id is the source << 8 | the destination; 0x8000 asks for an answer. A frame is a
 * row of subframes: registers that are written, asked for, or answered, as integers of one, two or four bytes or as floats.
 * A torque is given in the mode of position control, without a position and with all gains 0; watchdog and largest torque
 * go with it in each command, and so does the question that the status answers.
 */
#include <math.h>
#include <string.h>

#include "can/drive.h"
#include "dynpoint/device.h"

enum { WRITE = 0x00, READ = 0x10, REPLY = 0x20, REPLIES = 0x8000, PADDING = 0x50 };
enum {
    INT8 = 0,
    INT16 = 1,
    INT32 = 2,
    FLOAT = 3
}; /* type << 2 of a subframe; its lowest bits are the count, if 1 to 3 */
enum {
    R_MODE = 0x00,
    R_POSITION = 0x01,
    R_VELOCITY = 0x02,
    R_TORQUE = 0x03,
    R_TEMPERATURE = 0x0e,
    R_FAULT = 0x0f,
    R_COMMAND_TORQUE = 0x22,
    R_LIMIT = 0x25,
    R_WATCHDOG = 0x27,
    R_VERSION = 0x102
};
enum { MODE_STOPPED = 0, MODE_FAULT = 1, MODE_POSITION = 10, MODE_TIMEOUT = 11 };

static const struct drive_parameter parameters[] = {
    { .parameter = DRIVE_VERSION,
      .action = DRIVE_CHECK,
      .index = R_VERSION,
      .bytes = 4,
      .unit = 1.0,
      .min = 4.0,
      .max = 5.0 },
    { .parameter = DRIVE_TORQUE_LIMIT, .action = DRIVE_SET, .index = R_LIMIT },
    { .parameter = DRIVE_WATCHDOG, .action = DRIVE_SET, .index = R_WATCHDOG },
};

static const struct drive_fault faults[] = { { 11, DPT_REASON_WATCHDOG, "TIMEOUT" },
                                             { 32, DPT_REASON_UNCALIBRATED, "CALIBRATION_FAULT" },
                                             { 33, DPT_REASON_DEVICE, "MOTOR_DRIVER_FAULT" },
                                             { 34, DPT_REASON_DEVICE, "OVER_VOLTAGE" },
                                             { 35, DPT_REASON_UNCALIBRATED, "ENCODER_FAULT" },
                                             { 36, DPT_REASON_UNCALIBRATED, "MOTOR_NOT_CONFIGURED" },
                                             { 37, DPT_REASON_DEVICE, "PWM_CYCLE_OVERRUN" },
                                             { 38, DPT_REASON_OVERHEATED, "OVER_TEMPERATURE" },
                                             { 39, DPT_REASON_OVERLOADED, "OUTSIDE_LIMIT" },
                                             { 40, DPT_REASON_DEVICE, "UNDER_VOLTAGE" },
                                             { 41, DPT_REASON_DEVICE, "CONFIG_CHANGED" },
                                             { 42, DPT_REASON_UNCALIBRATED, "THETA_INVALID" },
                                             { 43, DPT_REASON_UNCALIBRATED, "POSITION_INVALID" },
                                             { 44, DPT_REASON_DEVICE, "DRIVER_ENABLE_FAULT" },
                                             { 46, DPT_REASON_DEVICE, "TIMING_VIOLATION" },
                                             { 48, DPT_REASON_DEVICE, "INVALID_LIMITS" },
                                             { 0, 0, NULL } };

/* ---- subframes ---- */

struct row {
    uint8_t *at, *end;
};

static void put_byte(struct row *row, unsigned byte)
{
    if (row->at < row->end)
        *row->at++ = (uint8_t)byte;
}

/* The head of `count` (1 to 3) registers from `first` on; registers above 127 take two bytes. */
static void put_head(struct row *row, unsigned kind, unsigned type, unsigned count, unsigned first)
{
    put_byte(row, kind | type << 2 | count);
    if (first > 0x7f)
        put_byte(row, (first & 0x7f) | 0x80);
    put_byte(row, first > 0x7f ? first >> 7 : first);
}

static void put_number(struct row *row, uint32_t bits, int bytes)
{
    for (int i = 0; i < bytes; i++)
        put_byte(row, bits >> 8 * i & 0xff);
}

static void put_float(struct row *row, float value)
{
    uint32_t bits;
    memcpy(&bits, &value, 4);
    put_number(row, bits, 4);
}

/* What is known of a frame's registers. */
struct registers {
    unsigned written, asked, answered;         /* numbers of them */
    uint8_t has_mode, has_state, has_torque;   /* mode; position and velocity; the command's torque */
    uint8_t is_finite, has_value, other_order; /* other_order: a register is written that this file does not write */
    unsigned parameter;                        /* asked for or answered; index in `parameters` */
    double mode, position, velocity, torque, temperature, fault, command, watchdog, limit, value;
};

static const uint8_t *get_varuint(const uint8_t *at, const uint8_t *end, uint32_t *value)
{
    *value = 0;
    for (int shift = 0; at && at < end && shift < 35; shift += 7) {
        *value |= (uint32_t)(*at & 0x7f) << shift;
        if (!(*at++ & 0x80))
            return at;
    }
    return NULL;
}

/* A number of this type; NaN where the wire says that there is none. */
static double get_number(const uint8_t *at, unsigned type)
{
    static const double none[] = { -128.0, -32768.0, -2147483648.0 };
    uint32_t bits = 0;
    float real;
    for (unsigned i = 0; i < (type == FLOAT ? 4u : 1u << type); i++)
        bits |= (uint32_t)at[i] << 8 * i;
    memcpy(&real, &bits, 4);
    if (type == FLOAT)
        return (double)real;
    const double number = type == INT8    ? (double)(int8_t)bits
                          : type == INT16 ? (double)(int16_t)bits
                                          : (double)(int32_t)bits;
    return number == none[type] ? (double)NAN : number;
}

/* The units of integers: positions, velocities and so on; 1 for a float. */
static double unit_of(uint32_t index, unsigned type)
{
    static const double position[] = { 0.01, 0.0001, 0.00001, 1.0 }, velocity[] = { 0.1, 0.00025, 0.00001, 1.0 },
                        torque[] = { 0.5, 0.01, 0.001, 1.0 }, heat[] = { 1.0, 0.1, 0.001, 1.0 },
                        seconds[] = { 0.01, 0.001, 0.000001, 1.0 };
    switch (index) {
    case R_POSITION:
        return position[type];
    case R_VELOCITY:
        return velocity[type];
    case R_TORQUE:
    case R_COMMAND_TORQUE:
    case R_LIMIT:
        return torque[type];
    case R_TEMPERATURE:
        return heat[type];
    case R_WATCHDOG:
        return seconds[type];
    default:
        return 1.0;
    }
}

static void note_parameter(struct registers *registers, uint32_t index, double value)
{
    for (unsigned i = 0; i < sizeof parameters / sizeof *parameters; i++)
        if (parameters[i].index == index) {
            registers->has_value = 1;
            registers->parameter = i;
            registers->value = value;
        }
}

static void take_register(struct registers *registers, unsigned kind, unsigned type, uint32_t index, const uint8_t *at)
{
    if (kind == READ) {
        registers->asked++;
        note_parameter(registers, index, 0.0);
        return;
    }
    const double value = get_number(at, type) * unit_of(index, type);
    registers->written += kind == WRITE;
    registers->answered += kind == REPLY;
    if (kind == REPLY)
        note_parameter(registers, index, value);
    switch (index) {
    case R_MODE:
        registers->has_mode = 1;
        registers->mode = value;
        break;
    case R_POSITION:
        registers->position = value;
        registers->has_state |= 1;
        break;
    case R_VELOCITY:
        registers->velocity = value;
        registers->has_state |= 2;
        break;
    case R_TORQUE:
        registers->torque = value;
        break;
    case R_TEMPERATURE:
        registers->temperature = value;
        break;
    case R_FAULT:
        registers->fault = value;
        break;
    case R_COMMAND_TORQUE:
        registers->command = value;
        registers->has_torque = 1;
        break;
    case R_LIMIT:
        registers->limit = value;
        break;
    case R_WATCHDOG:
        registers->watchdog = value;
        break;
    case 0x20: /* no position */
        registers->other_order |= kind == WRITE && !isnan(value);
        break;
    case 0x21: /* no velocity and no gains */
    case 0x23:
    case 0x24:
    case 0x2b:
        registers->other_order |= kind == WRITE && !(fabs(value) <= 0.0);
        break;
    default:
        registers->other_order |= kind == WRITE;
    }
}

/* Read all subframes. Returns 0 if the frame ends within one, or has one that this file does not know. */
static int read_registers(const struct can_message *frame, struct registers *registers)
{
    const uint8_t *at = frame->data, *end = frame->data + frame->size;
    memset(registers, 0, sizeof *registers);
    while (at && at < end) {
        const unsigned head = *at++, kind = head & 0xf0, type = head >> 2 & 3;
        uint32_t count = head & 3, first = 0;
        if (head == PADDING)
            continue;
        if (kind > REPLY)
            return 0;
        if (!count)
            at = get_varuint(at, end, &count);
        at = at ? get_varuint(at, end, &first) : NULL;
        const uint32_t bytes = kind == READ ? 0 : type == FLOAT ? 4u : 1u << type;
        if (!at || count > 64 || first > 0xffff || count * bytes > (uint32_t)(end - at))
            return 0;
        for (uint32_t i = 0; i < count; i++, at += bytes)
            take_register(registers, kind, type, first + i, at);
    }
    return at != NULL;
}

/* ---- messages ---- */

static void put_question(struct row *row)
{
    put_head(row, READ, INT8, 1, R_MODE);
    put_head(row, READ, FLOAT, 3, R_POSITION);
    put_head(row, READ, INT8, 2, R_TEMPERATURE);
}

static void put_torque(const struct drive_node *node, struct row *row, float torque)
{
    put_head(row, WRITE, INT8, 1, R_MODE);
    put_byte(row, MODE_POSITION);
    put_head(row, WRITE, FLOAT, 3, 0x20);
    put_float(row, NAN); /* no position */
    put_float(row, 0.0f);
    put_float(row, torque);
    put_head(row, WRITE, INT8, 2, 0x23); /* no gains */
    put_number(row, 0, 2);
    put_head(row, WRITE, FLOAT, 1, R_LIMIT);
    put_float(row, node->torque_limit > 0.0 ? (float)node->torque_limit : NAN);
    put_head(row, WRITE, FLOAT, 1, R_WATCHDOG);
    put_float(row, node->watchdog > 0.0 ? (float)node->watchdog : NAN);
    put_head(row, WRITE, INT8, 1, 0x2b);
    put_byte(row, 0);
}

static void put_status(const struct drive_status *status, struct row *row)
{
    const unsigned mode = status->fault == MODE_TIMEOUT ? (unsigned)MODE_TIMEOUT
                          : status->fault               ? (unsigned)MODE_FAULT
                          : status->is_on               ? (unsigned)MODE_POSITION
                                                        : (unsigned)MODE_STOPPED;
    put_head(row, REPLY, INT8, 1, R_MODE);
    put_byte(row, mode);
    put_head(row, REPLY, FLOAT, 3, R_POSITION);
    put_float(row, status->position);
    put_float(row, status->velocity);
    put_float(row, status->torque);
    put_head(row, REPLY, INT8, 2, R_TEMPERATURE);
    put_byte(row, (unsigned)(status->temperature > 0.0f ? status->temperature : 0.0f));
    put_byte(row, mode == MODE_FAULT ? status->fault : 0);
}

/* Pad to a length that CAN-FD has. */
static int finish(struct can_message *frame, const struct row *row, uint32_t id)
{
    static const uint8_t lengths[] = { 8, 12, 16, 20, 24, 32, 48, 64 };
    const size_t used = (size_t)(row->at - frame->data);
    size_t i = 0;
    while (lengths[i] < used)
        i++;
    memset(frame->data + used, PADDING, lengths[i] - used);
    frame->id = id;
    frame->size = lengths[i];
    frame->flags = (uint8_t)(CAN_MESSAGE_FD | (id > 0x7ff ? CAN_MESSAGE_EXTENDED : 0));
    return 1;
}

static int encode(const struct drive_node *node, const struct drive_message *message, struct can_message *frame)
{
    const uint32_t to_motor = (uint32_t)REPLIES | (uint32_t)node->answer << 8 | node->number;
    const uint32_t to_host = (uint32_t)node->number << 8 | node->answer;
    const struct drive_parameter *parameter = drive_parameter_of(node->drive, message->parameter);
    memset(frame, 0, sizeof *frame);
    struct row row = { frame->data, frame->data + sizeof frame->data };
    switch (message->kind) {
    case DRIVE_TORQUE:
        if (!isfinite((double)message->as.command.torque))
            return 0;
        put_torque(node, &row, message->as.command.torque);
        put_question(&row);
        return finish(frame, &row, to_motor);
    case DRIVE_ON: /* The watchdog and the limit go with a command: without torque. */
    case DRIVE_WRITE:
        put_torque(node, &row, 0.0f);
        put_question(&row);
        return finish(frame, &row, to_motor);
    case DRIVE_OFF:
    case DRIVE_STOP:
    case DRIVE_CLEAR:
        put_head(&row, WRITE, INT8, 1, R_MODE);
        put_byte(&row, MODE_STOPPED);
        put_question(&row);
        return finish(frame, &row, to_motor);
    case DRIVE_ASK:
        put_question(&row);
        return finish(frame, &row, to_motor);
    case DRIVE_READ:
        if (!parameter)
            return 0;
        put_head(&row, READ, parameter->bytes ? INT32 : FLOAT, 1, parameter->index);
        return finish(frame, &row, to_motor);
    case DRIVE_VALUE:
        if (!parameter)
            return 0;
        put_head(&row, REPLY, parameter->bytes ? INT32 : FLOAT, 1, parameter->index);
        if (parameter->bytes)
            put_number(&row, (uint32_t)message->as.value, 4);
        else
            put_float(&row, (float)message->as.value);
        return finish(frame, &row, to_host);
    case DRIVE_STATUS:
        put_status(&message->as.status, &row);
        return finish(frame, &row, to_host);
    default:
        return 0;
    }
}

static int decode_command(const struct registers *registers, struct drive_message *message)
{
    if (!registers->written && registers->has_value) {
        message->parameter = parameters[registers->parameter].parameter;
        return DRIVE_READ;
    }
    if (!registers->written)
        return registers->asked ? DRIVE_ASK : DRIVE_OTHER;
    if (registers->has_mode && registers->mode == MODE_STOPPED && registers->written == 1)
        return DRIVE_OFF;
    if (!registers->has_mode || registers->mode != MODE_POSITION || !registers->has_torque || registers->other_order)
        return DRIVE_ORDER;
    message->as.command.torque = (float)registers->command;
    message->as.command.watchdog = (float)registers->watchdog;
    message->as.command.limit = (float)registers->limit;
    return isfinite(registers->command) ? DRIVE_TORQUE : DRIVE_ORDER;
}

static int decode_answer(const struct registers *registers, struct drive_message *message)
{
    struct drive_status *status = &message->as.status;
    if (registers->has_mode && registers->has_state == 3) {
        if (!isfinite(registers->position) || !isfinite(registers->velocity) ||
            !(fabs(registers->position) < 1e9 && fabs(registers->velocity) < 1e9))
            return DRIVE_DAMAGED;
        status->position = (float)registers->position;
        status->velocity = (float)registers->velocity;
        status->torque = isfinite(registers->torque) ? (float)registers->torque : 0.0f;
        status->temperature = isfinite(registers->temperature) ? (float)registers->temperature : 0.0f;
        status->is_on = registers->mode == MODE_POSITION;
        if (registers->mode == MODE_TIMEOUT)
            status->fault = MODE_TIMEOUT;
        else if (registers->mode == MODE_FAULT)
            status->fault = registers->fault >= 1.0 && registers->fault < 128.0 ? (uint32_t)registers->fault : 1;
        return DRIVE_STATUS;
    }
    if (!registers->has_value)
        return DRIVE_OTHER;
    message->parameter = parameters[registers->parameter].parameter;
    /* "None" is said by NaN. */
    message->as.value = isnan(registers->value) ? 0.0 : registers->value;
    return isfinite(message->as.value) ? DRIVE_VALUE : DRIVE_DAMAGED;
}

static int decode(const struct drive_node *node, const struct can_message *frame, struct drive_message *message)
{
    struct registers registers;
    memset(message, 0, sizeof *message);
    const unsigned source = frame->id >> 8 & 0x7f, destination = frame->id & 0x7f;
    if (!(frame->flags & CAN_MESSAGE_FD) || frame->id > 0xffff || frame->size > CAN_MESSAGE_BYTES)
        return DRIVE_OTHER;
    const int is_command = destination == node->number;
    if (!is_command && !(destination == node->answer && source == node->number))
        return DRIVE_OTHER;
    if (!read_registers(frame, &registers))
        return message->kind = is_command ? DRIVE_ORDER : DRIVE_DAMAGED;
    return message->kind =
               (uint8_t)(is_command ? decode_command(&registers, message) : decode_answer(&registers, message));
}

/* Extended ids only where a short one has no room. */
static int wanted(const struct drive_node *node, struct can_wanted *out)
{
    const uint32_t answer = (uint32_t)node->number << 8 | node->answer;
    const uint32_t command = (uint32_t)REPLIES | node->number;
    out[0] = (struct can_wanted){ .id = command, .mask = 0x1fff807f, .is_extended = 1 };
    out[1] = (struct can_wanted){ .id = answer, .mask = 0x1fffffff, .is_extended = 1 };
    out[2] = (struct can_wanted){ .id = answer, .mask = 0x7ff };
    return answer > 0x7ff ? 2 : 3;
}

const struct can_drive moteus_drive = {
    .name = "moteus",
    .title = "moteus",
    .is_fd = 1,
    .answers = 1,
    .number_min = 1,
    .number_max = 126,
    .command_bits = 57, /* an extended id; 48 bytes, then an answer of 24 */
    .answer_bits = 57,
    .command_data_bits = 518,
    .answer_data_bits = 278,
    .position_step = 1.0 / 4194304.0, /* a float's, below 4 turns and below 4 Nm */
    .torque_step = 1.0 / 4194304.0,
    .parameters = parameters,
    .parameter_count = sizeof parameters / sizeof *parameters,
    .faults = faults,
    .encode = encode,
    .decode = decode,
    .wanted = wanted,
};
