/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Damage of every kind to frames of our serial protocol (drivers/serial/wire.h): none is taken for a message.
 *
 *     test_wire_damage [N]      with N, one of N double flips, bursts and bytes of noise
 */
#include "drivers/wire_record.h"

static unsigned thinned = 1;

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

static void try_stretch(const struct record *record, const uint8_t *bytes, const char *what, size_t at)
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
    printf("    %ld damaged stretches of %zu bits, %ld frames accepted that none sent\n", tried, to - from, accepted);
}

/*
 * Damage to the bytes [from, to) of the record costs the frames that it touches, and the one after a zero that is
 * hurt; all others come, in order, and nothing else.
 */
static void expect(const struct record *record, const uint8_t *bytes, size_t size, size_t from, size_t to, int twice,
                   const char *what)
{
    struct outcome outcome;
    replay_bytes(record, bytes, size, &outcome);
    CHECK(outcome.wrong == 0 && outcome.disordered == 0, "%s at %zu: %d wrong, %d disordered", what, from,
          outcome.wrong, outcome.disordered);
    for (int i = 0; i < FRAMES; i++) {
        /* A frame needs its own bytes, and the zero before it. */
        const size_t begin = i ? record->begin[i] - 1 : 0;
        if (record->begin[i + 1] <= from || begin >= to)
            CHECK(outcome.came[i] == 1, "%s at %zu: frame %d came %d times", what, from, i, outcome.came[i]);
        else
            CHECK(outcome.came[i] <= 1 + twice, "%s at %zu: frame %d came %d times", what, from, i, outcome.came[i]);
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
    CHECK(reader.messages == 0 && reader.foreign == 0, "%u, %u", (unsigned)reader.messages, (unsigned)reader.foreign);
    CHECK(reader.damaged > 70000 / thinned, "%u", (unsigned)reader.damaged);
    /* In the middle of noise: the frame behind the next zero is read. */
    struct wire_message sent = any_message(&seed, WIRE_STATE);
    uint8_t frame[WIRE_FRAME_MAX];
    const size_t size = wire_encode(&sent, frame);
    wire_read(&reader, 0, &message);
    for (size_t i = 0; i < size; i++)
        wire_read(&reader, frame[i], &message);
    CHECK(reader.messages == 1 && memcmp(&message, &sent, sizeof sent) == 0, "%u", (unsigned)reader.messages);
    /* A stream without a zero fills nothing but the reader's own room. */
    for (int i = 0; i < 100000; i++)
        CHECK(wire_read(&reader, 7, &message) == WIRE_MORE, "at %d", i);
    CHECK(wire_read(&reader, 0, &message) == WIRE_DAMAGED, "too long");
}

int main(int argc, char **argv)
{
    if (argc > 1 && atoi(argv[1]) > 0)
        thinned = (unsigned)atoi(argv[1]);
    TEST(five_flips_are_never_missed);
    TEST(flips_and_bursts_are_refused);
    TEST(every_byte_is_damaged);
    TEST(noise_is_no_message);
    return check_report();
}
