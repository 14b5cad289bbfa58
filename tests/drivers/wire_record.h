/* SPDX-License-Identifier: BSD-3-Clause */
/* Any messages of our serial protocol, as bytes on a line; and what a reader makes of these bytes when they are damaged. */
#ifndef DPT_TESTS_WIRE_RECORD_H
#define DPT_TESTS_WIRE_RECORD_H

#include "serial/wire.h"

#include "drivers/wire_frame.h"
#include "lib/check.h"

static inline float random_float(uint64_t *seed)
{
    return (float)random_in(seed, -10, 10);
}

static inline void fill(uint64_t *seed, float *field, int count)
{
    for (int i = 0; i < count; i++)
        field[i] = random_float(seed);
}

static inline void fill_info(uint64_t *seed, struct wire_info *info)
{
    info->pose_dofs = 6;
    info->wrench_dofs = (uint8_t)random_bits(seed);
    info->joints = 8;
    info->buttons = (uint8_t)random_bits(seed);
    info->flags = (uint32_t)random_bits(seed);
    fill(seed, &info->rate, 1);
    fill(seed, &info->force_max, 1);
    fill(seed, &info->force_continuous, 1);
    fill(seed, &info->torque_max, 1);
    fill(seed, &info->stiffness_max, 1);
    fill(seed, &info->position_step, 1);
    fill(seed, &info->watchdog, 1);
    fill(seed, info->workspace_min, 3);
    fill(seed, info->workspace_max, 3);
    for (int i = 0; i < WIRE_NAME_MAX - 1; i++)
        info->name[i] = (char)('a' + random_bits(seed) % 26);
    strcpy(info->serial, "7");
}

static inline void fill_state(uint64_t *seed, struct wire_state *state)
{
    state->pose_dofs = random_bits(seed) % 2 ? 6 : 3;
    state->joints = (uint8_t)(random_bits(seed) % 9);
    state->status = (uint8_t)(1 + random_bits(seed) % 3);
    state->temperature = (uint8_t)random_bits(seed);
    state->reordered = (uint8_t)random_bits(seed);
    state->reasons = (uint16_t)random_bits(seed);
    state->code = (uint16_t)random_bits(seed);
    state->buttons = (uint16_t)random_bits(seed);
    state->lost = (uint16_t)random_bits(seed);
    state->late = (uint16_t)random_bits(seed);
    state->sequence = (uint32_t)random_bits(seed);
    state->time = (uint32_t)random_bits(seed);
    state->echo = (uint32_t)random_bits(seed);
    fill(seed, state->position, 3);
    fill(seed, state->velocity, 3);
    if (state->pose_dofs == 6) {
        const float unit[4] = { 0.5f, -0.5f, 0.5f, -0.5f };
        memcpy(state->orientation, unit, sizeof unit);
        fill(seed, state->spin, 3);
    }
    fill(seed, state->joint, state->joints);
}

/* Any message that may be sent; what its type does not have is zero. */
static inline struct wire_message any_message(uint64_t *seed, uint8_t type)
{
    struct wire_message message;
    memset(&message, 0, sizeof message);
    message.type = type;
    message.session = (uint16_t)random_bits(seed);
    switch (type) {
    case WIRE_INFO:
        fill_info(seed, &message.as.info);
        break;
    case WIRE_STATE:
        fill_state(seed, &message.as.state);
        break;
    case WIRE_COMMAND:
        message.as.command.sequence = (uint32_t)random_bits(seed);
        message.as.command.answers = (uint32_t)random_bits(seed) % 1000;
        fill(seed, message.as.command.force, 3);
        fill(seed, message.as.command.torque, 2);
        break;
    case WIRE_ORDER:
        message.as.order = (uint8_t)(1 + random_bits(seed) % 3);
        break;
    case WIRE_HEARTBEAT:
        message.as.heartbeat.status = (uint8_t)random_bits(seed);
        message.as.heartbeat.reasons = (uint16_t)random_bits(seed);
        message.as.heartbeat.sequence = (uint32_t)random_bits(seed);
        message.as.heartbeat.time = (uint32_t)random_bits(seed);
        break;
    case WIRE_LOG:
        message.as.log.size = (uint8_t)(random_bits(seed) % (WIRE_LOG_MAX + 1));
        for (int i = 0; i < message.as.log.size; i++)
            message.as.log.text[i] = (char)random_bits(seed);
        break;
    default:
        break;
    }
    return message;
}

/* A line's record: frames one after another, and where each begins. */
enum { FRAMES = 40 };
struct record {
    struct wire_message messages[FRAMES];
    size_t begin[FRAMES + 1];
    uint8_t bytes[FRAMES * WIRE_FRAME_MAX];
};

static inline void make_record(struct record *record, uint64_t seed)
{
    record->begin[0] = 0;
    for (int i = 0; i < FRAMES; i++) {
        const int type = i % 5 == 3 ? 1 + i / 5 % 7 : i % 2 ? WIRE_COMMAND : WIRE_STATE;
        record->messages[i] = any_message(&seed, (uint8_t)type);
        const size_t size = wire_encode(&record->messages[i], record->bytes + record->begin[i]);
        CHECK(size > 0, "frame %d of type %d", i, type);
        record->begin[i + 1] = record->begin[i] + size;
    }
}

/* What came of a damaged record: which frames, and how many that none ever sent. */
struct outcome {
    int came[FRAMES];
    int messages, wrong, disordered;
    uint32_t damaged;
};

static inline void replay_bytes(const struct record *record, const uint8_t *bytes, size_t size, struct outcome *outcome)
{
    struct wire_reader reader;
    struct wire_message message;
    int next = 0;
    memset(outcome, 0, sizeof *outcome);
    memset(&reader, 0, sizeof reader);
    for (size_t i = 0; i < size; i++) {
        if (wire_read(&reader, bytes[i], &message) != WIRE_MESSAGE)
            continue;
        outcome->messages++;
        int k = next;
        while (k < FRAMES && memcmp(&message, &record->messages[k], sizeof message) != 0)
            k++;
        if (k == FRAMES) {
            int before = 0;
            while (before < next && memcmp(&message, &record->messages[before], sizeof message) != 0)
                before++;
            outcome->disordered += before < next;
            outcome->wrong += before == next;
            continue;
        }
        outcome->came[k]++;
        next = k + 1;
    }
    outcome->damaged = reader.damaged;
}

#endif
