/* SPDX-License-Identifier: BSD-3-Clause */
#include "wire.h"

#include <string.h>

#define CRC_BYTES 5

/* CRC-32C (Castagnoli), reflected, four bits a step: 64 bytes of table, which a small flash can spare. */
static uint32_t crc32c(const uint8_t *bytes, size_t size)
{
    static const uint32_t table[16] = {
        0x00000000, 0x105ec76f, 0x20bd8ede, 0x30e349b1, 0x417b1dbc, 0x5125dad3, 0x61c69362, 0x7198540d,
        0x82f63b78, 0x92a8fc17, 0xa24bb5a6, 0xb21572c9, 0xc38d26c4, 0xd3d3e1ab, 0xe330a81a, 0xf36e6f75,
    };
    uint32_t crc = 0xffffffffu;
    while (size--) {
        crc ^= *bytes++;
        crc = crc >> 4 ^ table[crc & 15];
        crc = crc >> 4 ^ table[crc & 15];
    }
    return ~crc;
}

/*
 * transfer_body() describes a message's body once for both directions: a cursor writes each field to the bytes, or
 * reads it from them. It becomes bad at a field that does not fit or is not allowed.
 */
struct cursor {
    uint8_t *at;
    size_t left;
    int is_writing;
    int is_bad;
};

static void transfer_bytes(struct cursor *cursor, void *field, size_t size)
{
    if (cursor->left < size) {
        cursor->is_bad = 1;
        return;
    }
    if (cursor->is_writing)
        memcpy(cursor->at, field, size);
    else
        memcpy(field, cursor->at, size);
    cursor->at += size;
    cursor->left -= size;
}

static void transfer_u8(struct cursor *cursor, uint8_t *field)
{
    transfer_bytes(cursor, field, 1);
}

static void transfer_u16(struct cursor *cursor, uint16_t *field)
{
    uint8_t b[2] = { (uint8_t)*field, (uint8_t)(*field >> 8) };
    transfer_bytes(cursor, b, 2);
    *field = (uint16_t)(b[0] | b[1] << 8);
}

static void transfer_u32(struct cursor *cursor, uint32_t *field)
{
    uint8_t b[4] = { (uint8_t)*field, (uint8_t)(*field >> 8), (uint8_t)(*field >> 16), (uint8_t)(*field >> 24) };
    transfer_bytes(cursor, b, 4);
    *field = (uint32_t)b[0] | (uint32_t)b[1] << 8 | (uint32_t)b[2] << 16 | (uint32_t)b[3] << 24;
}

static void transfer_floats(struct cursor *cursor, float *field, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        uint32_t bits;
        memcpy(&bits, &field[i], 4);
        transfer_u32(cursor, &bits);
        memcpy(&field[i], &bits, 4);
        if ((bits & 0x7f800000u) == 0x7f800000u)
            cursor->is_bad = 1;
    }
}

static void transfer_info(struct cursor *cursor, struct wire_info *info)
{
    transfer_u8(cursor, &info->pose_dofs);
    transfer_u8(cursor, &info->wrench_dofs);
    transfer_u8(cursor, &info->joints);
    transfer_u8(cursor, &info->buttons);
    transfer_u32(cursor, &info->flags);
    transfer_floats(cursor, &info->rate, 1);
    transfer_floats(cursor, &info->force_max, 1);
    transfer_floats(cursor, &info->force_continuous, 1);
    transfer_floats(cursor, &info->torque_max, 1);
    transfer_floats(cursor, &info->stiffness_max, 1);
    transfer_floats(cursor, &info->position_step, 1);
    transfer_floats(cursor, &info->watchdog, 1);
    transfer_floats(cursor, info->workspace_min, 3);
    transfer_floats(cursor, info->workspace_max, 3);
    transfer_bytes(cursor, info->name, WIRE_NAME_MAX);
    transfer_bytes(cursor, info->serial, WIRE_NAME_MAX);
    if (info->name[WIRE_NAME_MAX - 1] || info->serial[WIRE_NAME_MAX - 1])
        cursor->is_bad = 1;
}

static void transfer_state(struct cursor *cursor, struct wire_state *state)
{
    uint8_t shape = (uint8_t)(state->joints << 4 | state->pose_dofs);
    transfer_u8(cursor, &shape);
    state->pose_dofs = shape & 15;
    state->joints = shape >> 4;
    if ((state->pose_dofs != 3 && state->pose_dofs != 6) || state->joints > WIRE_JOINTS_MAX) {
        cursor->is_bad = 1;
        return;
    }
    transfer_u8(cursor, &state->status);
    transfer_u8(cursor, &state->temperature);
    transfer_u8(cursor, &state->reordered);
    transfer_u16(cursor, &state->reasons);
    transfer_u16(cursor, &state->code);
    transfer_u16(cursor, &state->buttons);
    transfer_u16(cursor, &state->lost);
    transfer_u16(cursor, &state->late);
    transfer_u32(cursor, &state->sequence);
    transfer_u32(cursor, &state->time);
    transfer_u32(cursor, &state->echo);
    transfer_floats(cursor, state->position, 3);
    transfer_floats(cursor, state->velocity, 3);
    if (state->pose_dofs == 6) {
        transfer_floats(cursor, state->orientation, 4);
        transfer_floats(cursor, state->spin, 3);
        float square = 0;
        for (int i = 0; i < 4; i++)
            square += state->orientation[i] * state->orientation[i];
        if (!(square > 0.999f && square < 1.001f))
            cursor->is_bad = 1;
    }
    transfer_floats(cursor, state->joint, state->joints);
    if (state->status < WIRE_STATUS_FAULT || state->status > WIRE_STATUS_READY)
        cursor->is_bad = 1;
}

static void transfer_log(struct cursor *cursor, struct wire_log *log)
{
    if (!cursor->is_writing)
        log->size = (uint8_t)(cursor->left <= WIRE_LOG_MAX ? cursor->left : 0);
    if (log->size > WIRE_LOG_MAX)
        cursor->is_bad = 1;
    else
        transfer_bytes(cursor, log->text, log->size);
}

static void transfer_body(struct cursor *cursor, struct wire_message *message)
{
    transfer_u16(cursor, &message->session);
    switch (message->type) {
    case WIRE_HELLO:
        break;
    case WIRE_INFO:
        transfer_info(cursor, &message->as.info);
        break;
    case WIRE_STATE:
        transfer_state(cursor, &message->as.state);
        break;
    case WIRE_COMMAND:
        transfer_u32(cursor, &message->as.command.sequence);
        transfer_u32(cursor, &message->as.command.answers);
        transfer_floats(cursor, message->as.command.force, 3);
        transfer_floats(cursor, message->as.command.torque, 3);
        break;
    case WIRE_ORDER:
        transfer_u8(cursor, &message->as.order);
        if (message->as.order < WIRE_ENABLE || message->as.order > WIRE_STOP)
            cursor->is_bad = 1;
        break;
    case WIRE_HEARTBEAT:
        transfer_u8(cursor, &message->as.heartbeat.status);
        transfer_u16(cursor, &message->as.heartbeat.reasons);
        transfer_u32(cursor, &message->as.heartbeat.sequence);
        transfer_u32(cursor, &message->as.heartbeat.time);
        break;
    case WIRE_LOG:
        transfer_log(cursor, &message->as.log);
        break;
    default:
        cursor->is_bad = 1;
    }
}

/* COBS for less than 254 bytes: adds one byte, and replaces each zero by the distance to the next. */
static size_t stuff(const uint8_t *body, size_t size, uint8_t *out)
{
    size_t code = 0;
    for (size_t i = 0; i < size; i++)
        if (body[i] == 0) {
            out[code] = (uint8_t)(i + 1 - code);
            code = i + 1;
        } else {
            out[i + 1] = body[i];
        }
    out[code] = (uint8_t)(size + 1 - code);
    return size + 1;
}

/* Undo COBS in place: the body begins at stuffed[1]. Returns 0 if a distance leads beyond the end. */
static int unstuff(uint8_t *stuffed, size_t size)
{
    size_t code = 0;
    while (code < size) {
        const size_t next = code + stuffed[code];
        stuffed[code] = 0;
        code = next;
    }
    return code == size;
}

size_t wire_encode(const struct wire_message *message, uint8_t frame[WIRE_FRAME_MAX])
{
    uint8_t body[WIRE_BODY_MAX] = { message->type, WIRE_VERSION };
    struct wire_message copy = *message;
    struct cursor cursor = { body + 2, sizeof body - 2, 1, 0 };
    transfer_body(&cursor, &copy);
    if (cursor.is_bad)
        return 0;
    size_t size = stuff(body, (size_t)(cursor.at - body), frame);
    uint32_t crc = crc32c(frame, size);
    for (int i = 0; i < CRC_BYTES; i++, crc >>= 7)
        frame[size++] = (uint8_t)(0x80 | (crc & 0x7f));
    frame[size++] = 0;
    return size;
}

size_t wire_state_bytes(unsigned pose_dofs, unsigned joints)
{
    return 7 + 30 + 24 + (pose_dofs == 6 ? 28u : 0u) + 4 * (size_t)joints;
}

static int crc_matches(const uint8_t *frame, size_t size)
{
    uint32_t crc = crc32c(frame, size);
    for (int i = 0; i < CRC_BYTES; i++, crc >>= 7)
        if (frame[size + (size_t)i] != (0x80 | (crc & 0x7f)))
            return 0;
    return 1;
}

static int count_damaged(struct wire_reader *reader)
{
    reader->damaged++;
    return WIRE_DAMAGED;
}

int wire_read(struct wire_reader *reader, uint8_t byte, struct wire_message *message)
{
    if (byte != 0) {
        if (reader->count < sizeof reader->bytes)
            reader->bytes[reader->count++] = byte;
        return WIRE_MORE;
    }
    const size_t count = reader->count;
    reader->count = 0;
    if (count == 0)
        return WIRE_MORE;
    /* The zero itself is not stored, so a full buffer is a frame that was too long. */
    if (count < 3 + CRC_BYTES || count == sizeof reader->bytes)
        return count_damaged(reader);
    const size_t size = count - CRC_BYTES;
    if (!crc_matches(reader->bytes, size) || !unstuff(reader->bytes, size))
        return count_damaged(reader);
    if (reader->bytes[2] != WIRE_VERSION) {
        reader->foreign++;
        reader->version = reader->bytes[2];
        return WIRE_FOREIGN;
    }
    struct cursor cursor = { reader->bytes + 3, size - 3, 0, 0 };
    memset(message, 0, sizeof *message);
    message->type = reader->bytes[1];
    transfer_body(&cursor, message);
    if (cursor.is_bad || cursor.left != 0)
        return count_damaged(reader);
    reader->messages++;
    return WIRE_MESSAGE;
}

void wire_sequence_start(struct wire_sequence *sequence, uint32_t last)
{
    memset(sequence, 0, sizeof *sequence);
    sequence->last = last;
    sequence->received_bits = ~(uint64_t)0;
}

int wire_sequence_accept(struct wire_sequence *sequence, uint32_t number)
{
    const uint32_t ahead = number - sequence->last;
    if (ahead != 0 && ahead < 0x80000000u) {
        sequence->received_bits = ahead < 64 ? sequence->received_bits << ahead | 1 : 1;
        sequence->last = number;
        sequence->lost += ahead - 1;
        sequence->accepted++;
        return 1;
    }
    const uint32_t behind = 0u - ahead;
    if (behind >= 64 || sequence->received_bits >> behind & 1) {
        sequence->repeated++;
    } else {
        sequence->received_bits |= (uint64_t)1 << behind;
        sequence->lost--;
        sequence->reordered++;
    }
    return 0;
}
