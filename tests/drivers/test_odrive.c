/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * ODrive's frames (drivers/can/odrive.c) against bytes that cantools 45.1.0 made of ODrive's own message definitions, the DBC files
 * 0.5.6 and 0.6.10 in the odrive-can package, and of its documents.
 */
#include "can/odrive.h"

#include <math.h>

#include "dynpoint/device.h"
#include "lib/check.h"

static struct can_message frame_of(uint16_t id, const char *hex)
{
    struct can_message frame = { .id = id };
    for (unsigned byte; sscanf(hex + 2 * frame.size, "%2x", &byte) == 1 && frame.size < 8;)
        frame.data[frame.size++] = (uint8_t)byte;
    return frame;
}

static struct odrive_message decoded(uint16_t id, const char *hex, unsigned generation)
{
    const struct can_message frame = frame_of(id, hex);
    struct odrive_message message;
    CHECK(odrive_decode(&frame, generation, &message) == ODRIVE_MESSAGE, "%x %s", id, hex);
    CHECK(message.node == id >> 5 && message.command == (id & 31) && !message.is_request, "%x", id);
    return message;
}

/* What is encoded is the beginning of what the definitions give: a frame need not have the zeros behind its content. */
static void expect_bytes(const struct odrive_message *message, unsigned generation, uint16_t id, const char *hex,
                         unsigned size)
{
    const struct can_message known = frame_of(id, hex);
    struct can_message frame;
    CHECK(odrive_encode(message, generation, &frame), "%x", id);
    CHECK(frame.id == id && frame.size == size && frame.flags == 0 && !memcmp(frame.data, known.data, 8),
          "%x: id %x, %u bytes", id, frame.id, frame.size);
}

static void frames_are_what_the_definitions_say(void)
{
    struct odrive_message message = decoded(0x61, "4008000008010081", ODRIVE_0_5);
    struct odrive_heartbeat *beat = &message.as.heartbeat;
    CHECK(beat->errors == 0x840 && beat->state == ODRIVE_STATE_CLOSED_LOOP && beat->is_done &&
              beat->failed == (ODRIVE_FAILED_MOTOR | ODRIVE_FAILED_CONTROLLER) && !beat->result,
          "%x %u %u", beat->errors, beat->state, beat->failed);
    expect_bytes(&message, ODRIVE_0_5, 0x61, "4008000008010081", 8);
    message = decoded(0x61, "0001000001000100", ODRIVE_0_5);
    CHECK(beat->errors == 0x100 && beat->failed == ODRIVE_FAILED_ENCODER && !beat->is_done, "%x", beat->failed);
    message = decoded(0x61, "00020001080e0100", ODRIVE_0_6);
    CHECK(beat->errors == 0x1000200 && beat->state == 8 && beat->result == 14 && beat->is_done && !beat->failed,
          "%x %u", beat->errors, beat->result);
    expect_bytes(&message, ODRIVE_0_6, 0x61, "00020001080e0100", 8);
    message = decoded(0x60, "0204033a00060a01", ODRIVE_0_6);
    CHECK(message.as.version.protocol == 2 && message.as.version.hardware[2] == 58 &&
              message.as.version.firmware[1] == 6 && message.as.version.firmware[2] == 10 &&
              message.as.version.is_unreleased == 1,
          "version");
    expect_bytes(&message, ODRIVE_0_6, 0x60, "0204033a00060a01", 8);
    message = decoded(0x63, "0000000200000001", ODRIVE_0_6);
    CHECK(message.as.error.active == 0x2000000 && message.as.error.disarm == 0x1000000, "error");
    expect_bytes(&message, ODRIVE_0_6, 0x63, "0000000200000001", 8);
    message = decoded(0x66, "038f7e6d5c4b3a00", ODRIVE_0_6);
    CHECK(message.as.address.node == 3 && message.as.address.serial == 0x3a4b5c6d7e8f, "address");
    expect_bytes(&message, ODRIVE_0_6, 0x66, "038f7e6d5c4b3a00", 8);
    /* Of 0.5 the definitions have 32 bits of the motor's errors, its firmware sends 64. */
    message = decoded(0x63, "0010008004000000", ODRIVE_0_5);
    CHECK(message.as.error.active == 0x480001000, "motor");
    expect_bytes(&message, ODRIVE_0_5, 0x63, "0010008004000000", 8);
    message = decoded(0x64, "2000000000000000", ODRIVE_0_5);
    CHECK(message.as.error.active == 0x20, "encoder");
    message = decoded(0x7d, "8100000000000000", ODRIVE_0_5);
    CHECK(message.as.error.active == 0x81, "controller");
    for (unsigned generation = ODRIVE_0_5; generation <= ODRIVE_0_6; generation++) {
        message = decoded(0xe9, "0000a0bfcdcccc3d", generation);
        CHECK(message.as.estimates.position == -1.25f && message.as.estimates.velocity == 0.1f, "%g %g",
              (double)message.as.estimates.position, (double)message.as.estimates.velocity);
        expect_bytes(&message, generation, 0xe9, "0000a0bfcdcccc3d", 8);
        message = decoded(0xe7, "0800000000000000", generation);
        CHECK(message.as.state == ODRIVE_STATE_CLOSED_LOOP, "%u", message.as.state);
        expect_bytes(&message, generation, 0xe7, "0800000000000000", 4);
        message = decoded(0xeb, "0100000001000000", generation);
        CHECK(message.as.mode.control == ODRIVE_CONTROL_TORQUE && message.as.mode.input == ODRIVE_INPUT_PASSTHROUGH,
              "mode");
        expect_bytes(&message, generation, 0xeb, "0100000001000000", 8);
        message = decoded(0xee, "0000c03f00000000", generation);
        CHECK(message.as.torque == 1.5f, "%g", (double)message.as.torque);
        expect_bytes(&message, generation, 0xee, "0000c03f00000000", 4);
        message = decoded(0xf8, generation == ODRIVE_0_5 ? "" : "00", generation);
        expect_bytes(&message, generation, 0xf8, "00", generation == ODRIVE_0_5 ? 0 : 1);
        message = decoded(0x22, "", generation);
        CHECK(message.node == 1 && message.command == ODRIVE_ESTOP, "estop");
        expect_bytes(&message, generation, 0x22, "", 0);
    }
}

/* Every id of 11 bits: what belongs to a generation, and what is asked for. */
static void ids_are_node_and_command(void)
{
    static const uint32_t known[2] = { 1u << 0x01 | 1u << 0x02 | 1u << 0x03 | 1u << 0x04 | 1u << 0x07 | 1u << 0x09 |
                                           1u << 0x0b | 1u << 0x0e | 1u << 0x18 | 1u << 0x1d,
                                       1u << 0x00 | 1u << 0x01 | 1u << 0x02 | 1u << 0x03 | 1u << 0x06 | 1u << 0x07 |
                                           1u << 0x09 | 1u << 0x0b | 1u << 0x0e | 1u << 0x18 };
    static const uint32_t answers =
        1u << 0x00 | 1u << 0x01 | 1u << 0x03 | 1u << 0x04 | 1u << 0x06 | 1u << 0x09 | 1u << 0x1d;
    for (unsigned generation = ODRIVE_0_5; generation <= ODRIVE_0_6; generation++)
        for (unsigned id = 0; id < 0x800; id++) {
            const struct can_message frame = { .id = (uint16_t)id, .size = 8 };
            struct odrive_message message;
            const int is_known = known[generation == ODRIVE_0_6] >> (id & 31) & 1;
            CHECK(odrive_decode(&frame, generation, &message) == (is_known ? ODRIVE_MESSAGE : ODRIVE_OTHER),
                  "%x of 0.%u", id, generation);
            const struct odrive_message ask = { .node = (uint8_t)(id >> 5),
                                                .command = (uint8_t)(id & 31),
                                                .is_request = 1 };
            struct can_message asked;
            const int goes = odrive_encode(&ask, generation, &asked);
            CHECK(goes == (is_known && answers >> (id & 31) & 1), "%x of 0.%u", id, generation);
            if (goes)
                CHECK(asked.id == id && asked.flags == CAN_MESSAGE_REMOTE && asked.size == 0, "%x: %x", id, asked.id);
        }
    /* On 0.5 this id sets the node's number. */
    const struct odrive_message address = { .command = ODRIVE_ADDRESS, .is_request = 1 };
    struct can_message frame;
    CHECK(!odrive_encode(&address, ODRIVE_0_5, &frame), "asks 0.5 for its address");
    static const unsigned orders[] = { 0x02, 0x07, 0x0b, 0x0c, 0x0d, 0x0e, 0x0f, 0x10, 0x11,
                                       0x12, 0x13, 0x16, 0x18, 0x19, 0x1a, 0x1b, 0x1f };
    const unsigned all = sizeof orders / sizeof *orders;
    unsigned count = 0;
    for (unsigned command = 0; command < 64; command++)
        count += odrive_is_control(command) != 0;
    for (unsigned i = 0; i < all; i++)
        CHECK(odrive_is_control(orders[i]), "%x", orders[i]);
    CHECK(count == all, "%u orders", count);
}

static void what_must_not_be_sent_is_not(void)
{
    struct can_message frame;
    struct odrive_message message = { .command = ODRIVE_SET_TORQUE };
    static const float bad[] = { NAN, INFINITY, -INFINITY };
    for (int i = 0; i < 3; i++) {
        message.as.torque = bad[i];
        CHECK(!odrive_encode(&message, ODRIVE_0_6, &frame), "%g", (double)bad[i]);
    }
    message.as.torque = 1.0f;
    message.node = 64;
    CHECK(!odrive_encode(&message, ODRIVE_0_6, &frame), "node 64");
    message.node = 63;
    CHECK(odrive_encode(&message, ODRIVE_0_6, &frame) && frame.id == 0x7ee, "node 63");
    message.command = 32;
    CHECK(!odrive_encode(&message, ODRIVE_0_6, &frame), "command 32");
    message.command = 0x0c;
    CHECK(!odrive_encode(&message, ODRIVE_0_6, &frame), "a command that is not ours");
}

static void damage_is_refused(void)
{
    struct odrive_message message;
    static const char *const bad[] = { "0000c07f00000000", "0000807f00000000", "00000000000080ff" };
    for (int i = 0; i < 3; i++) {
        const struct can_message frame = frame_of(0x09, bad[i]);
        CHECK(odrive_decode(&frame, ODRIVE_0_6, &message) == ODRIVE_DAMAGED, "%s", bad[i]);
    }
    static const struct {
        uint16_t id;
        uint8_t least;
    } sizes[] = {
        { 0x01, 8 }, { 0x09, 8 }, { 0x03, 8 }, { 0x0e, 4 }, { 0x07, 4 }, { 0x0b, 8 }, { 0x00, 7 }, { 0x06, 7 }
    };
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++)
        for (uint8_t size = 0; size <= 9; size++) {
            const struct can_message frame = { .id = sizes[i].id, .size = size };
            CHECK(odrive_decode(&frame, ODRIVE_0_6, &message) ==
                      (size >= sizes[i].least && size <= 8 ? ODRIVE_MESSAGE : ODRIVE_DAMAGED),
                  "%x with %u bytes", sizes[i].id, size);
        }
}

/* What is said is what is heard, for random content of every command and node; and random frames do no harm. */
static void round_trips(void)
{
    uint64_t random = 1;
    int messages = 0;
    for (int i = 0; i < 400000; i++) {
        struct odrive_message heard, again;
        struct can_message frame = { .id = (uint16_t)(random_bits(&random) & 0xfff),
                                     .size = (uint8_t)(random_bits(&random) % 10) };
        const unsigned generation = random_bits(&random) & 1 ? ODRIVE_0_5 : ODRIVE_0_6;
        const uint64_t data = random_bits(&random);
        memcpy(frame.data, &data, 8);
        frame.flags = random_bits(&random) % 8 == 0 ? CAN_MESSAGE_REMOTE : 0;
        odrive_heartbeat_generation(&frame);
        if (odrive_decode(&frame, generation, &heard) != ODRIVE_MESSAGE)
            continue;
        CHECK(frame.id < 0x800, "id %x", frame.id);
        struct can_message said;
        if (!odrive_encode(&heard, generation, &said)) {
            CHECK(heard.is_request, "%x", frame.id);
            continue;
        }
        messages++;
        CHECK(said.id == frame.id && odrive_decode(&said, generation, &again) == ODRIVE_MESSAGE &&
                  !memcmp(&heard, &again, sizeof heard),
              "%x of 0.%u changes on its way", frame.id, generation);
    }
    CHECK(messages > 20000, "%d", messages);
}

static void generations_are_told_apart(void)
{
    static const struct {
        const char *hex;
        unsigned generation;
    } beats[] = {
        { "0000000001000080", ODRIVE_0_5 }, { "0000000001010001", ODRIVE_0_5 }, { "0000000001000000", ODRIVE_ANY },
        { "0000000001010100", ODRIVE_ANY }, { "0000000001020000", ODRIVE_0_6 }, { "00000000010e0100", ODRIVE_0_6 },
        { "000000000100", ODRIVE_ANY },
    };
    for (size_t i = 0; i < sizeof beats / sizeof *beats; i++) {
        const struct can_message frame = frame_of(0x01, beats[i].hex);
        CHECK(odrive_heartbeat_generation(&frame) == beats[i].generation, "%s", beats[i].hex);
    }
}

static void errors_have_names_and_reasons(void)
{
    static const struct {
        unsigned word;
        uint64_t bits;
        const char *name;
        uint32_t reasons;
    } known[] = {
        { ODRIVE_ERRORS_0_6, 0x01000000, "WATCHDOG_TIMER_EXPIRED", DPT_REASON_WATCHDOG },
        { ODRIVE_ERRORS_0_6, 0x02000000, "ESTOP_REQUESTED", DPT_REASON_ESTOP },
        { ODRIVE_ERRORS_0_6, 0x2000, "MOTOR_OVER_TEMP", DPT_REASON_OVERHEATED },
        { ODRIVE_ERRORS_0_6, 0x4000 | 0x1000, "CURRENT_LIMIT_VIOLATION",
          DPT_REASON_OVERHEATED | DPT_REASON_OVERLOADED },
        { ODRIVE_ERRORS_0_6, 0x40000000, "CALIBRATION_ERROR", DPT_REASON_UNCALIBRATED },
        { ODRIVE_ERRORS_0_6, 0x80000000, "unknown", DPT_REASON_DEVICE },
        { ODRIVE_AXIS_ERRORS, 0x800, "WATCHDOG_TIMER_EXPIRED", DPT_REASON_WATCHDOG },
        { ODRIVE_AXIS_ERRORS, 0x4000, "ESTOP_REQUESTED", DPT_REASON_ESTOP },
        { ODRIVE_AXIS_ERRORS, 0x40000, "OVER_TEMP", DPT_REASON_OVERHEATED },
        { ODRIVE_AXIS_ERRORS, 0x100, "ENCODER_FAILED", DPT_REASON_UNCALIBRATED },
        { ODRIVE_MOTOR_ERRORS, 0x1000, "CURRENT_LIMIT_VIOLATION", DPT_REASON_OVERLOADED },
        { ODRIVE_MOTOR_ERRORS, 0x800000000, "UNBALANCED_PHASES", DPT_REASON_DEVICE },
        { ODRIVE_ENCODER_ERRORS, 0x20, "INDEX_NOT_FOUND_YET", DPT_REASON_UNCALIBRATED },
        { ODRIVE_CONTROLLER_ERRORS, 0x1, "OVERSPEED", DPT_REASON_OVERLOADED },
    };
    for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
        const char *name = odrive_error_name(known[i].word, known[i].bits);
        CHECK(name && !strcmp(name, known[i].name), "%zu: %s", i, name ? name : "none");
        CHECK(odrive_reasons(known[i].word, known[i].bits) == known[i].reasons, "%s: %x", known[i].name,
              odrive_reasons(known[i].word, known[i].bits));
    }
    const uint32_t sound = DPT_REASON_WATCHDOG | DPT_REASON_OVERHEATED | DPT_REASON_OVERLOADED |
                           DPT_REASON_UNCALIBRATED | DPT_REASON_ESTOP | DPT_REASON_DEVICE;
    unsigned named = 0;
    for (unsigned word = 0; word < ODRIVE_ERROR_WORDS + 1; word++) {
        CHECK(!odrive_error_name(word, 0) && !odrive_reasons(word, 0), "no error is one");
        for (unsigned bit = 0; bit < 64 && word < ODRIVE_ERROR_WORDS; bit++) {
            const uint64_t error = (uint64_t)1 << bit;
            const char *name = odrive_error_name(word, error);
            const uint32_t reasons = odrive_reasons(word, error);
            CHECK(name && reasons && !(reasons & ~sound) && !(reasons & (reasons - 1)), "word %u bit %u: %x", word, bit,
                  reasons);
            named += strcmp(name, "unknown") != 0;
        }
    }
    /* 22 + 12 + 27 + 10 + 8, as the definitions have them. */
    CHECK(named == 79, "%u errors have names", named);
    CHECK(!strcmp(odrive_state_name(8), "CLOSED_LOOP_CONTROL") && !strcmp(odrive_state_name(1), "IDLE") &&
              !strcmp(odrive_state_name(15), "unknown"),
          "states");
}

int main(void)
{
    TEST(frames_are_what_the_definitions_say);
    TEST(ids_are_node_and_command);
    TEST(what_must_not_be_sent_is_not);
    TEST(damage_is_refused);
    TEST(round_trips);
    TEST(generations_are_told_apart);
    TEST(errors_have_names_and_reasons);
    return check_report();
}
