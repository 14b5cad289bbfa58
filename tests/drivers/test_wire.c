/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The codec of our serial protocol (drivers/serial/wire.h), against frames built another way (wire_frame.h). What is random
 * has a seed; the same on every machine, as tests/cross.sh asks of a big-endian one.
 *
 *     test_wire [N]      with N, one of N messages
 */
#include <ctype.h>

#include "drivers/wire_record.h"

static unsigned thinned = 1;

static void crc_is_the_known_one(void)
{
    const uint8_t digits[] = "123456789";
    CHECK(frame_crc(digits, 9) == 0xe3069283u, "CRC-32C of the digits: %08x", (unsigned)frame_crc(digits, 9));
}

/* Its words with one space between them: a long frame has several lines. */
static char *page_of(const char *path)
{
    FILE *file = fopen(path, "rb");
    char *page = calloc(1, 1 << 16);
    if (file && page && fread(page, 1, (1 << 16) - 1, file) == 0)
        page[0] = 0;
    if (file)
        fclose(file);
    char *to = page;
    for (const char *from = page; from && *from; from++)
        if (!isspace((unsigned char)*from))
            *to++ = *from;
        else if (to > page && to[-1] != ' ')
            *to++ = ' ';
    if (to)
        *to = 0;
    return page;
}

/* Computed by another program, of Python, from docs/wire.md, which shows these bytes. */
static void frames_are_the_documented_ones(void)
{
    static const struct {
        const char *what;
        const char *hex;
    } known[] = {
#include "drivers/wire_known.h"
    };
    struct wire_message messages[4];
    memset(messages, 0, sizeof messages);
    messages[0].type = WIRE_HELLO;
    messages[0].session = 0x1234;
    messages[1].type = WIRE_ORDER;
    messages[1].session = 0x1234;
    messages[1].as.order = WIRE_ENABLE;
    messages[2].type = WIRE_COMMAND;
    messages[2].session = 0x1234;
    messages[2].as.command.sequence = 7;
    messages[2].as.command.answers = 1000;
    messages[2].as.command.force[0] = 1.5f;
    messages[2].as.command.force[1] = -0.25f;
    messages[2].as.command.torque[2] = 0.125f;
    struct wire_state *state = &messages[3].as.state;
    messages[3].type = WIRE_STATE;
    messages[3].session = 0x1234;
    state->pose_dofs = 3;
    state->joints = 1;
    state->status = WIRE_STATUS_FAULT;
    state->temperature = 255;
    state->reordered = 5;
    state->reasons = WIRE_REASON_WATCHDOG | WIRE_REASON_DEVICE;
    state->code = 42;
    state->buttons = 3;
    state->lost = 258;
    state->late = 9;
    state->sequence = 1000;
    state->time = 0xfedcba98u;
    state->echo = 7;
    state->position[0] = 0.1f;
    state->velocity[2] = -1;
    state->joint[0] = 2;
    char *page = page_of("docs/wire.md");
    for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
        CHECK(page && strstr(page, known[i].hex), "docs/wire.md does not show the %s", known[i].what);
        uint8_t frame[WIRE_FRAME_MAX];
        char hex[3 * WIRE_FRAME_MAX] = "";
        const size_t size = wire_encode(&messages[i], frame);
        for (size_t k = 0; k < size; k++)
            sprintf(hex + 3 * k, "%02x ", frame[k]);
        if (size > 0)
            hex[3 * size - 1] = 0;
        CHECK(strcmp(hex, known[i].hex) == 0, "%s: %s", known[i].what, hex);
    }
    free(page);
}

static void all_messages_go_round(void)
{
    uint64_t seed = 1;
    for (int i = 0; i < 70000; i++) {
        const struct wire_message sent = any_message(&seed, (uint8_t)(1 + i % 7));
        struct wire_message got;
        struct wire_reader reader = { 0 };
        uint8_t frame[WIRE_FRAME_MAX], body[WIRE_BODY_MAX], again[WIRE_FRAME_MAX];
        const size_t size = wire_encode(&sent, frame);
        CHECK(size >= 11 && size <= WIRE_FRAME_MAX, "type %d: %zu bytes", sent.type, size);
        CHECK(memchr(frame, 0, size) == frame + size - 1, "a zero within");
        int result = WIRE_MORE;
        for (size_t k = 0; k < size; k++) {
            CHECK(result == WIRE_MORE, "%d before the end", result);
            result = wire_read(&reader, frame[k], &got);
        }
        CHECK(result == WIRE_MESSAGE, "type %d: %d", sent.type, result);
        CHECK(memcmp(&got, &sent, sizeof got) == 0, "type %d", sent.type);
        /* The body, by a walk along the zeros, framed the other way. */
        size_t zero = frame[0];
        for (size_t k = 1; k < size - 6; k++) {
            body[k - 1] = k == zero ? 0 : frame[k];
            zero += k == zero ? frame[k] : 0u;
        }
        CHECK(frame_of(body, size - 7, again) == size && memcmp(frame, again, size) == 0, "type %d", sent.type);
        if (sent.type == WIRE_STATE)
            CHECK(size == wire_state_bytes(sent.as.state.pose_dofs, sent.as.state.joints), "%zu", size);
    }
}

/* In a millisecond 1 Mbaud carries 100 bytes each way, 921,600 baud 92. */
static void sizes_fit_a_kilohertz(void)
{
    uint64_t seed = 2;
    uint8_t frame[WIRE_FRAME_MAX];
    const struct wire_message command = any_message(&seed, WIRE_COMMAND);
    CHECK(wire_encode(&command, frame) == 43, "%zu", wire_encode(&command, frame));
    CHECK(wire_state_bytes(3, 0) == 61, "%zu", wire_state_bytes(3, 0));
    CHECK(wire_state_bytes(6, 0) == 89, "%zu", wire_state_bytes(6, 0));
    CHECK(wire_state_bytes(3, 8) == 93, "%zu", wire_state_bytes(3, 8));
}

static void refuse(const char *what, const struct wire_message *message)
{
    uint8_t frame[WIRE_FRAME_MAX];
    CHECK(wire_encode(message, frame) == 0, "%s is sent", what);
}

/* Bodies with a good checksum that are no messages. */
static int answer_to(const uint8_t *body, size_t size)
{
    uint8_t frame[300];
    struct wire_reader reader = { 0 };
    struct wire_message message;
    const size_t count = frame_of(body, size, frame);
    int result = WIRE_MORE;
    for (size_t i = 0; i < count; i++)
        result = wire_read(&reader, frame[i], &message);
    return result;
}

static void values_without_sense_are_refused(void)
{
    uint64_t seed = 3;
    const uint32_t wild[] = { 0x7f800000u, 0xff800000u, 0x7fc00000u, 0xffffffffu };
    for (int i = 0; i < 4; i++) {
        struct wire_message message = any_message(&seed, WIRE_COMMAND);
        memcpy(&message.as.command.torque[2], &wild[i], 4);
        refuse("a number that is not finite", &message);
        message = any_message(&seed, WIRE_STATE);
        memcpy(&message.as.state.position[i % 3], &wild[i], 4);
        refuse("a place that is not finite", &message);
    }
    struct wire_message message = any_message(&seed, WIRE_STATE);
    message.as.state.pose_dofs = 4;
    refuse("4 freedoms", &message);
    message.as.state.pose_dofs = 3;
    message.as.state.joints = 9;
    refuse("9 joints", &message);
    message.as.state.joints = 0;
    message.as.state.status = 0;
    refuse("a status", &message);
    message.as.state.status = 1;
    message.as.state.pose_dofs = 6;
    memset(message.as.state.orientation, 0, sizeof message.as.state.orientation);
    refuse("a quaternion of length 0", &message);
    const float lengths[] = { 0.99925f, 0.99975f, 1.00025f, 1.00075f };
    for (int i = 0; i < 4; i++) {
        uint8_t frame[WIRE_FRAME_MAX];
        message.as.state.orientation[i] = lengths[i];
        CHECK((wire_encode(&message, frame) != 0) == (i == 1 || i == 2), "a quaternion of length %g",
              (double)lengths[i]);
        message.as.state.orientation[i] = 0.0f;
    }
    message = any_message(&seed, WIRE_ORDER);
    message.as.order = 4;
    refuse("an order", &message);
    message = any_message(&seed, WIRE_LOG);
    message.as.log.size = WIRE_LOG_MAX + 1;
    refuse("a long line", &message);
    message.type = 8;
    refuse("a type", &message);
}

static void bodies_that_are_no_messages_are_refused(void)
{
    uint8_t body[250] = { WIRE_HELLO, WIRE_VERSION, 1, 2, 3 };
    CHECK(answer_to(body, 4) == WIRE_MESSAGE, "a hello");
    CHECK(answer_to(body, 5) == WIRE_DAMAGED, "a byte more");
    CHECK(answer_to(body, 3) == WIRE_DAMAGED, "a byte less");
    for (size_t size = 0; size < 250; size++)
        for (unsigned type = 0; type < 256; type++) {
            body[0] = (uint8_t)type;
            const int result = answer_to(body, size);
            const int expected = (type == WIRE_HELLO && size == 4) || (type == WIRE_INFO && size == 160) ||
                                 (type == WIRE_COMMAND && size == 36) || (type == WIRE_HEARTBEAT && size == 15) ||
                                 (type == WIRE_ORDER && size == 5) || (type == WIRE_LOG && size >= 4 && size <= 124);
            CHECK((result == WIRE_MESSAGE) == expected, "type %u, %zu bytes: %d", type, size, result);
        }
    /* A good checksum, and a distance that leads beyond the end, or short of the one that is there. */
    for (uint8_t distance = 1; distance < 20; distance++) {
        uint8_t frame[20] = { distance, WIRE_HELLO, WIRE_VERSION, 7, 7 };
        struct wire_reader reader = { 0 };
        const uint64_t crc = frame_crc(frame, 5);
        struct wire_message message;
        int result = WIRE_MORE;
        for (int i = 0; i < 5; i++)
            frame[5 + i] = (uint8_t)(0x80 + crc / ((uint64_t)1 << 7 * i) % 128);
        for (int i = 0; i < 11; i++)
            result = wire_read(&reader, frame[i], &message);
        CHECK((result == WIRE_MESSAGE) == (distance == 5), "distance %d: %d", distance, result);
    }
    body[0] = WIRE_HELLO;
    body[1] = WIRE_VERSION + 1;
    CHECK(answer_to(body, 4) == WIRE_FOREIGN, "another version");
    CHECK(answer_to(body, 40) == WIRE_FOREIGN, "another version, another length");
}

/* Numbers dropped, doubled and displaced, against the plain truth of which came and when. */
static void orders_are_counted(void)
{
    uint64_t seed = 9;
    for (int round = 0; round < 2000; round++) {
        enum { SENT = 300 };
        uint32_t line[2 * SENT];
        int count = 0;
        /* A number is dropped, or comes up to 20 places late, perhaps twice. */
        int due[SENT][2];
        for (int i = 0; i < SENT; i++) {
            const uint64_t dice = random_bits(&seed) % 10;
            due[i][0] = dice == 0 ? -1 : dice < 3 ? i + 1 + (int)(random_bits(&seed) % 20) : i;
            due[i][1] = dice == 4 ? i + (int)(random_bits(&seed) % 20) : -1;
        }
        for (int now = 0; now < SENT + 40; now++)
            for (int i = 0; i < SENT; i++)
                for (int k = 0; k < 2; k++)
                    if (due[i][k] == now)
                        line[count++] = (uint32_t)i;
        const uint32_t start = (uint32_t)random_bits(&seed) % 2 ? 0xffffff80u : 0;
        struct wire_sequence sequence;
        wire_sequence_start(&sequence, start - 1);
        uint32_t taken = 0, reordered = 0, repeated = 0, lost = 0;
        int newest = -1, came[SENT] = { 0 };
        for (int i = 0; i < count; i++) {
            const int number = (int)line[i];
            const int fresh = number > newest;
            CHECK(wire_sequence_accept(&sequence, start + (uint32_t)number) == fresh, "round %d", round);
            taken += (uint32_t)fresh;
            repeated += !fresh && came[number];
            reordered += !fresh && !came[number];
            came[number] = 1;
            newest = fresh ? number : newest;
        }
        for (int i = 0; i < newest; i++)
            lost += !came[i];
        CHECK(sequence.accepted == taken && sequence.lost == lost && sequence.reordered == reordered &&
                  sequence.repeated == repeated,
              "round %d: %u %u %u %u, not %u %u %u %u", round, (unsigned)sequence.accepted, (unsigned)sequence.lost,
              (unsigned)sequence.reordered, (unsigned)sequence.repeated, (unsigned)taken, (unsigned)lost,
              (unsigned)reordered, (unsigned)repeated);
    }
}

int main(int argc, char **argv)
{
    if (argc > 1 && atoi(argv[1]) > 0)
        thinned = (unsigned)atoi(argv[1]);
    TEST(crc_is_the_known_one);
    TEST(frames_are_the_documented_ones);
    TEST(all_messages_go_round);
    TEST(sizes_fit_a_kilohertz);
    TEST(values_without_sense_are_refused);
    TEST(bodies_that_are_no_messages_are_refused);
    TEST(orders_are_counted);
    return check_report();
}
