/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The codec of our serial protocol (drivers/serial/wire.h), against frames built another way (wire_frame.h) and against damage
 * of every kind. What is random has a seed; the same on every machine, as tests/cross.sh asks of a big-endian one.
 *
 *     test_wire [N]      with N, one of N double flips, bursts and bytes of noise
 */
#include <ctype.h>

#include "serial/wire.h"

#include "drivers/wire_frame.h"
#include "lib/check.h"

static unsigned thinned = 1;

static float random_float(uint64_t *seed)
{
    return (float)random_in(seed, -10, 10);
}

static void fill(uint64_t *seed, float *field, int count)
{
    for (int i = 0; i < count; i++)
        field[i] = random_float(seed);
}

/* Any message that may be sent; what its type does not have is zero. */
static struct wire_message any_message(uint64_t *seed, uint8_t type)
{
    struct wire_message message;
    memset(&message, 0, sizeof message);
    message.type = type;
    message.session = (uint16_t)random_bits(seed);
    struct wire_info *info = &message.as.info;
    struct wire_state *state = &message.as.state;
    switch (type) {
    case WIRE_INFO:
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
        break;
    case WIRE_STATE:
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

static void make_record(struct record *record, uint64_t seed)
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

static void replay_bytes(const struct record *record, const uint8_t *bytes, size_t size,
                         struct outcome *outcome)
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
            while (before < next &&
                   memcmp(&message, &record->messages[before], sizeof message) != 0)
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

static void crc_is_the_known_one(void)
{
    const uint8_t digits[] = "123456789";
    CHECK(frame_crc(digits, 9) == 0xe3069283u, "CRC-32C of the digits: %08x",
          (unsigned)frame_crc(digits, 9));
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
        CHECK(page && strstr(page, known[i].hex), "docs/wire.md does not show the %s",
              known[i].what);
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
        CHECK(frame_of(body, size - 7, again) == size && memcmp(frame, again, size) == 0, "type %d",
              sent.type);
        if (sent.type == WIRE_STATE)
            CHECK(size == wire_state_bytes(sent.as.state.pose_dofs, sent.as.state.joints), "%zu",
                  size);
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

static void nonsense_is_refused(void)
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
        CHECK((wire_encode(&message, frame) != 0) == (i == 1 || i == 2),
              "a quaternion of length %g", (double)lengths[i]);
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

    uint8_t body[250] = { WIRE_HELLO, WIRE_VERSION, 1, 2, 3 };
    CHECK(answer_to(body, 4) == WIRE_MESSAGE, "a hello");
    CHECK(answer_to(body, 5) == WIRE_DAMAGED, "a byte more");
    CHECK(answer_to(body, 3) == WIRE_DAMAGED, "a byte less");
    for (size_t size = 0; size < 250; size++)
        for (unsigned type = 0; type < 256; type++) {
            body[0] = (uint8_t)type;
            const int result = answer_to(body, size);
            const int expected =
                (type == WIRE_HELLO && size == 4) || (type == WIRE_INFO && size == 160) ||
                (type == WIRE_COMMAND && size == 36) || (type == WIRE_HEARTBEAT && size == 15) ||
                (type == WIRE_ORDER && size == 5) || (type == WIRE_LOG && size >= 4 && size <= 124);
            CHECK((result == WIRE_MESSAGE) == expected, "type %u, %zu bytes: %d", type, size,
                  result);
        }
    /* A good checksum, and a distance that leads beyond the end, or short of the one that is there. */
    for (uint8_t distance = 1; distance < 20; distance++) {
        uint8_t frame[20] = { distance, WIRE_HELLO, WIRE_VERSION, 7, 7 };
        struct wire_reader reader = { 0 };
        const uint64_t crc = frame_crc(frame, 5);
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

/*
 * That no pattern of up to five flipped bits in a frame of the longest kind keeps its checksum, computed from the
 * syndromes of its bits: none is zero; none, and no two, are equal; no two pairs have the same sum; and with an odd
 * number of ones in each, an odd number of them never cancels.
 */
static int by_value(const void *a, const void *b)
{
    const uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return (x > y) - (x < y);
}

static void five_flips_are_never_missed(void)
{
    enum { DATA = WIRE_FRAME_MAX - 6, BITS = 8 * DATA + 32, PAIRS = BITS * (BITS - 1) / 2 };
    static uint8_t bytes[DATA];
    static uint32_t syndromes[BITS], sums[PAIRS];
    const uint32_t zero = frame_crc(bytes, DATA);
    for (int bit = 0; bit < BITS; bit++) {
        if (bit < 8 * DATA) {
            bytes[bit / 8] = (uint8_t)(1 << bit % 8);
            syndromes[bit] = frame_crc(bytes, DATA) ^ zero;
            bytes[bit / 8] = 0;
        } else {
            syndromes[bit] = (uint32_t)1 << (bit - 8 * DATA);
        }
        int ones = 0;
        for (uint32_t left = syndromes[bit]; left; left &= left - 1)
            ones++;
        CHECK(ones % 2 == 1, "bit %d: %d ones", bit, ones);
    }
    int pairs = 0;
    for (int i = 0; i < BITS; i++)
        for (int k = 0; k < i; k++)
            sums[pairs++] = syndromes[i] ^ syndromes[k];
    qsort(sums, (size_t)pairs, sizeof *sums, by_value);
    CHECK(sums[0] != 0, "two flips cancel");
    int equal = 0;
    for (int i = 1; i < pairs; i++)
        equal += sums[i] == sums[i - 1];
    CHECK(pairs == PAIRS && equal == 0, "%d patterns of four flips cancel", equal);
}

/* Damage is put into frames MIDDLE and MIDDLE + 1, and into the zero before them. */
enum { MIDDLE = 20 };

static long accepted, tried;

static void try_stretch(const struct record *record, const uint8_t *bytes, const char *what,
                        size_t at)
{
    struct wire_reader reader = { 0 };
    struct wire_message message;
    const size_t from = record->begin[MIDDLE - 1], to = record->begin[MIDDLE + 5];
    tried++;
    for (size_t i = from; i < to; i++)
        if (wire_read(&reader, bytes[i], &message) == WIRE_MESSAGE) {
            int known = 0;
            for (int k = MIDDLE - 1; k < MIDDLE + 5; k++)
                known |= memcmp(&message, &record->messages[k], sizeof message) == 0;
            if (!known)
                accepted++;
            CHECK(known, "%s at %zu: a frame that none sent", what, at);
        }
    /* Of six frames the first two and the next two may be hurt, or their zeros: the last two are whole. */
    CHECK(reader.messages >= 2, "%s at %zu: %u frames", what, at, (unsigned)reader.messages);
}

static void flip(uint8_t *bytes, size_t bit)
{
    bytes[bit / 8] = (uint8_t)(bytes[bit / 8] ^ 1 << bit % 8);
}

static void flips_and_bursts_are_refused(void)
{
    static struct record record;
    make_record(&record, 4);
    accepted = tried = 0;
    const size_t from = 8 * (record.begin[MIDDLE] - 1), to = 8 * record.begin[MIDDLE + 2];
    uint8_t *bytes = record.bytes;
    for (size_t i = from; i < to; i++) {
        flip(bytes, i);
        try_stretch(&record, bytes, "one flip", i);
        for (size_t k = from + i % thinned; k < i; k += thinned) {
            flip(bytes, k);
            try_stretch(&record, bytes, "two flips", i);
            flip(bytes, k);
        }
        flip(bytes, i);
    }
    /* All bursts of up to 10 bits, then random ones of up to 64. */
    for (size_t i = from; i < to - 64; i++)
        for (unsigned pattern = 1 + (unsigned)(i % thinned); pattern < 512; pattern += thinned) {
            for (unsigned bit = 0; bit < 9; bit++)
                if (pattern >> bit & 1)
                    flip(bytes, i + 1 + bit);
            flip(bytes, i);
            try_stretch(&record, bytes, "a burst", i);
            flip(bytes, i);
            for (unsigned bit = 0; bit < 9; bit++)
                if (pattern >> bit & 1)
                    flip(bytes, i + 1 + bit);
        }
    uint64_t seed = 5;
    for (int round = 0; round < 500000 / (int)thinned; round++) {
        const size_t at = from + random_bits(&seed) % (to - from - 64);
        const uint64_t pattern = random_bits(&seed) >> random_bits(&seed) % 62 | 1;
        for (unsigned bit = 0; bit < 64; bit++)
            if (pattern >> bit & 1)
                flip(bytes, at + bit);
        try_stretch(&record, bytes, "a long burst", at);
        for (unsigned bit = 0; bit < 64; bit++)
            if (pattern >> bit & 1)
                flip(bytes, at + bit);
    }
    printf("    %ld damaged stretches of %zu bits, %ld frames accepted that none sent\n", tried,
           to - from, accepted);
}

/*
 * Damage to the bytes [from, to) of the record costs the frames that it touches, and the one after a zero that is
 * hurt; all others come, in order, and nothing else.
 */
static void expect(const struct record *record, const uint8_t *bytes, size_t size, size_t from,
                   size_t to, int twice, const char *what)
{
    struct outcome outcome;
    replay_bytes(record, bytes, size, &outcome);
    CHECK(outcome.wrong == 0 && outcome.disordered == 0, "%s at %zu: %d wrong, %d disordered", what,
          from, outcome.wrong, outcome.disordered);
    for (int i = 0; i < FRAMES; i++) {
        /* A frame needs its own bytes, and the zero before it. */
        const size_t begin = i ? record->begin[i] - 1 : 0;
        if (record->begin[i + 1] <= from || begin >= to)
            CHECK(outcome.came[i] == 1, "%s at %zu: frame %d came %d times", what, from, i,
                  outcome.came[i]);
        else
            CHECK(outcome.came[i] <= 1 + twice, "%s at %zu: frame %d came %d times", what, from, i,
                  outcome.came[i]);
    }
}

static void every_byte_is_damaged(void)
{
    static struct record record;
    static uint8_t hurt[sizeof record.bytes + 1];
    make_record(&record, 6);
    const size_t size = record.begin[FRAMES];
    uint64_t seed = 7;
    expect(&record, record.bytes, size, size, size, 0, "nothing");
    for (size_t at = 0; at < size; at++) {
        memcpy(hurt, record.bytes, at);
        memcpy(hurt + at, record.bytes + at + 1, size - at - 1);
        expect(&record, hurt, size - 1, at, at + 1, 0, "cut");
        /* The rest of the stream is cut, and all before is whole. */
        expect(&record, record.bytes, at, at, size, 0, "ended");
        hurt[at] = record.bytes[at];
        memcpy(hurt + at + 1, record.bytes + at, size - at);
        expect(&record, hurt, size + 1, at, at + 1, 0, "doubled");
        memcpy(hurt, record.bytes, size);
        for (int bit = 0; bit < 8; bit++) {
            flip(hurt, 8 * at + (size_t)bit);
            expect(&record, hurt, size, at, at + 1, 0, "flipped");
            flip(hurt, 8 * at + (size_t)bit);
        }
        hurt[at] ^= 0xff;
        expect(&record, hurt, size, at, at + 1, 0, "inverted");
        hurt[at] = 0;
        expect(&record, hurt, size, at, at + 1, 0, "zeroed");
        hurt[at] = record.bytes[at];
        /* Held back, so that later ones overtake it. */
        const size_t by = 1 + random_bits(&seed) % 300;
        const size_t to = at + by < size ? at + by : size - 1;
        memmove(hurt + at, hurt + at + 1, to - at);
        hurt[to] = record.bytes[at];
        expect(&record, hurt, size, at, to + 1, 0, "delayed");
    }
}

/* However the bytes come: in pieces of any length the reader says the same. And no noise is a message. */
static void noise_is_no_message(void)
{
    uint64_t seed = 8;
    struct wire_reader reader = { 0 };
    struct wire_message message;
    for (int i = 0; i < 20000000 / (int)thinned; i += 8) {
        const uint64_t bits = random_bits(&seed);
        for (int k = 0; k < 8; k++)
            wire_read(&reader, (uint8_t)(bits >> 8 * k), &message);
    }
    CHECK(reader.messages == 0 && reader.foreign == 0, "%u, %u", (unsigned)reader.messages,
          (unsigned)reader.foreign);
    CHECK(reader.damaged > 70000 / thinned, "%u", (unsigned)reader.damaged);
    /* In the middle of noise: the frame behind the next zero is read. */
    struct wire_message sent = any_message(&seed, WIRE_STATE);
    uint8_t frame[WIRE_FRAME_MAX];
    const size_t size = wire_encode(&sent, frame);
    wire_read(&reader, 0, &message);
    for (size_t i = 0; i < size; i++)
        wire_read(&reader, frame[i], &message);
    CHECK(reader.messages == 1 && memcmp(&message, &sent, sizeof sent) == 0, "%u",
          (unsigned)reader.messages);
    /* A stream without a zero fills nothing but the reader's own room. */
    for (int i = 0; i < 100000; i++)
        CHECK(wire_read(&reader, 7, &message) == WIRE_MORE, "at %d", i);
    CHECK(wire_read(&reader, 0, &message) == WIRE_DAMAGED, "too long");
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
            CHECK(wire_sequence_accept(&sequence, start + (uint32_t)number) == fresh, "round %d",
                  round);
            taken += (uint32_t)fresh;
            repeated += !fresh && came[number];
            reordered += !fresh && !came[number];
            came[number] = 1;
            newest = fresh ? number : newest;
        }
        for (int i = 0; i < newest; i++)
            lost += !came[i];
        CHECK(sequence.accepted == taken && sequence.lost == lost &&
                  sequence.reordered == reordered && sequence.repeated == repeated,
              "round %d: %u %u %u %u, not %u %u %u %u", round, (unsigned)sequence.accepted,
              (unsigned)sequence.lost, (unsigned)sequence.reordered, (unsigned)sequence.repeated,
              (unsigned)taken, (unsigned)lost, (unsigned)reordered, (unsigned)repeated);
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
    TEST(nonsense_is_refused);
    TEST(five_flips_are_never_missed);
    TEST(flips_and_bursts_are_refused);
    TEST(every_byte_is_damaged);
    TEST(noise_is_no_message);
    TEST(orders_are_counted);
    return check_report();
}
