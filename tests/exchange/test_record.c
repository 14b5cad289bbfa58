/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The format of recordings: what is written is read bit for bit, cut at any byte the whole records before the cut are
 * read, each flipped bit is found at its record, and a file of each version stays readable.
 */
#include <stddef.h>

#include "base/crc32.h"
#include "dynpoint.h"
#include "lib/check.h"

enum { RECORDS = 5, ROOM = 8192 };

static const char text[] = "scene=torus.dpa\nstiffness=500\n";

static dpt_record_header header_of(const char *words)
{
    return (dpt_record_header){ .size = sizeof(dpt_record_header),
                                .rate = 1000.0,
                                .began_ns = 1700000000123456789u,
                                .text = words,
                                .text_bytes = words ? strlen(words) : 0 };
}

/* Any bits: numbers that are none are numbers to keep, too. */
static dpt_record random_record(uint64_t *random)
{
    dpt_record record;
    unsigned char *bytes = (unsigned char *)&record;
    for (size_t i = 0; i < sizeof record; i++)
        bytes[i] = (unsigned char)random_bits(random);
    record.size = sizeof record;
    return record;
}

struct file {
    unsigned char bytes[ROOM];
    size_t size, first;
    dpt_record records[RECORDS];
};

static void make_file(struct file *file)
{
    const dpt_record_header header = header_of(text);
    uint64_t random = 7;
    size_t written = 0;
    for (int i = 0; i < RECORDS; i++)
        file->records[i] = random_record(&random);
    CHECK(dpt_record_header_write(&header, file->bytes, ROOM, &file->first) == DPT_OK, "header");
    CHECK(dpt_record_write(file->records, RECORDS, file->bytes + file->first, ROOM - file->first, &written) == DPT_OK,
          "records");
    file->size = file->first + written;
    CHECK(written == RECORDS * dpt_record_bytes() && dpt_record_bytes() % 8 == 0 &&
              file->first == dpt_record_header_bytes(&header) && file->first % 8 == 0,
          "%zu bytes, %zu of them the header", file->size, file->first);
}

static void what_is_written_is_read(void)
{
    struct file file;
    dpt_record_header header = { .size = sizeof header };
    dpt_record records[RECORDS + 1] = { { .size = sizeof *records } };
    size_t at = 0;
    uint32_t count = 0;
    make_file(&file);
    CHECK(dpt_record_header_read(file.bytes, file.size, &header, &at) == DPT_OK && at == file.first,
          "header of %zu bytes", at);
    CHECK(header.rate == 1000.0 && header.began_ns == 1700000000123456789u &&
              header.writer_version == dpt_version_number() && header.text_bytes == strlen(text) &&
              !strcmp(header.text, text),
          "%g Hz, '%s'", header.rate, header.text);
    CHECK(dpt_record_read(file.bytes, file.size, &at, records, RECORDS + 1, &count) == DPT_OK && count == RECORDS &&
              at == file.size,
          "%u records", count);
    CHECK(!memcmp(records, file.records, sizeof file.records), "other bits");
    CHECK(dpt_record_read(file.bytes, file.size, &at, records, 1, &count) == DPT_OK && count == 0,
          "%u records behind the end", count);
    at = file.first;
    for (int i = 0; i < RECORDS; i++)
        CHECK(dpt_record_read(file.bytes, file.size, &at, records, 1, &count) == DPT_OK && count == 1 &&
                  !memcmp(records, &file.records[i], sizeof *records),
              "record %d by itself", i);
}

/* Also where nothing is aligned. */
static void a_cut_leaves_what_is_before_it(void)
{
    struct file file;
    make_file(&file);
    const size_t bytes = dpt_record_bytes();
    for (size_t size = 0; size <= file.size; size++) {
        unsigned char *cut = malloc(size + 1);
        dpt_record_header header = { .size = sizeof header };
        dpt_record records[RECORDS] = { { .size = sizeof *records } };
        size_t at = 0;
        uint32_t count = 99;
        memcpy(cut + 1, file.bytes, size);
        dpt_result result = dpt_record_header_read(cut + 1, size, &header, &at);
        CHECK(result == (size < file.first ? DPT_E_TRUNCATED : DPT_OK), "cut at %zu: %s", size,
              dpt_result_name(result));
        if (result == DPT_OK) {
            const uint32_t whole = (uint32_t)((size - file.first) / bytes);
            const size_t end = file.first + whole * bytes;
            result = dpt_record_read(cut + 1, size, &at, records, RECORDS, &count);
            CHECK(count == whole && at == end && !memcmp(records, file.records, whole * sizeof *records),
                  "cut at %zu: %u records, up to %zu", size, count, at);
            if (whole)
                result = dpt_record_read(cut + 1, size, &at, records, RECORDS, &count);
            CHECK(result == (size == end ? DPT_OK : DPT_E_TRUNCATED) && !count && at == end,
                  "cut at %zu: then %s at %zu", size, dpt_result_name(result), at);
        }
        free(cut);
    }
}

/* How many records there are from byte `at` on, searched byte by byte where one is damaged. */
static uint32_t records_from(const struct file *file, size_t at)
{
    dpt_record record = { .size = sizeof record };
    uint32_t found = 0, count;
    while (at < file->size) {
        size_t next = at;
        const dpt_result result = dpt_record_read(file->bytes, file->size, &next, &record, 1, &count);
        found += result == DPT_OK ? count : 0;
        at = result == DPT_OK ? next : at + 1;
    }
    return found;
}

static void each_flipped_bit_is_found(void)
{
    struct file file;
    make_file(&file);
    const size_t bytes = dpt_record_bytes();
    for (size_t bit = 0; bit < 8 * file.size; bit++) {
        dpt_record_header header = { .size = sizeof header };
        dpt_record records[RECORDS] = { { .size = sizeof *records } };
        size_t at = 0;
        uint32_t count = 0;
        file.bytes[bit / 8] ^= (unsigned char)(1u << bit % 8);
        dpt_result result = dpt_record_header_read(file.bytes, file.size, &header, &at);
        if (bit < 8 * file.first) {
            CHECK(result != DPT_OK, "bit %zu of the header", bit);
        } else {
            const uint32_t damaged = (uint32_t)((bit / 8 - file.first) / bytes);
            result = dpt_record_read(file.bytes, file.size, &at, records, RECORDS, &count);
            CHECK(count == damaged && at == file.first + damaged * bytes, "bit %zu: %u records", bit, count);
            if (count)
                result = dpt_record_read(file.bytes, file.size, &at, records, RECORDS, &count);
            CHECK(result == DPT_E_CHECKSUM || result == DPT_E_LAYOUT || result == DPT_E_TRUNCATED, "bit %zu: %s", bit,
                  dpt_result_name(result));
            if (bit % 61 == 0)
                CHECK(records_from(&file, file.first) == RECORDS - 1, "bit %zu: the others are not found", bit);
        }
        file.bytes[bit / 8] ^= (unsigned char)(1u << bit % 8);
    }
}

static void put4(unsigned char *to, uint32_t value)
{
    for (int i = 0; i < 4; i++)
        to[i] = (unsigned char)(value >> 8 * i);
}

/* Make the checksum at `at` good again: that of `size` bytes with it set to 0. */
static void seal(unsigned char *bytes, size_t size, size_t at)
{
    struct crc32 crc;
    crc32_init(&crc);
    put4(bytes + at, 0);
    put4(bytes + at, crc32_of(&crc, bytes, size));
}

/* A newer release may write other kinds, and ticks that go on. */
static void newer_records_are_read_as_far_as_they_are_known(void)
{
    struct file file;
    make_file(&file);
    const size_t bytes = dpt_record_bytes(), longer = bytes + 16;
    unsigned char *all = malloc(3 * ROOM), *to = all;
    dpt_record records[4] = { { .size = sizeof *records } };
    size_t at = 0;
    uint32_t count = 0;
    memset(all, 0x5a, 3 * ROOM);
    memcpy(to, file.bytes + file.first, bytes);
    to += bytes;
    put4(to, 77); /* a kind that is none yet */
    put4(to + 4, 4000);
    seal(to, 4000, 8);
    to += 4000;
    memcpy(to, file.bytes + file.first + bytes, bytes);
    put4(to + 4, (uint32_t)longer);
    seal(to, longer, 8);
    to += longer;
    memcpy(to, file.bytes + file.first + 2 * bytes, bytes);
    to += bytes;
    const size_t size = (size_t)(to - all);
    CHECK(dpt_record_read(all, size, &at, records, 4, &count) == DPT_OK && count == 3 && at == size,
          "%u records, %zu of %zu bytes", count, at, size);
    CHECK(!memcmp(records, file.records, 3 * sizeof *records), "other bits");
    all[bytes + 3000] ^= 1;
    at = 0;
    CHECK(dpt_record_read(all, size, &at, records, 4, &count) == DPT_OK && count == 1 && at == bytes,
          "a damaged record of an unknown kind: %u, %zu", count, at);
    free(all);
}

static void lengths_that_cannot_be_are_refused(void)
{
    const uint32_t lengths[] = { 0, 8, 16, 23, 25, 1u << 20 | 8, 0xfffffff8u };
    struct file file;
    dpt_record record = { .size = sizeof record };
    make_file(&file);
    for (size_t i = 0; i < sizeof lengths / sizeof *lengths; i++) {
        size_t at = file.first;
        uint32_t count;
        put4(file.bytes + at + 4, lengths[i]);
        CHECK(dpt_record_read(file.bytes, file.size, &at, &record, 1, &count) == DPT_E_LAYOUT && !count &&
                  at == file.first,
              "length %u", lengths[i]);
    }
    /* One that is too short for a tick, and otherwise sound. */
    put4(file.bytes + file.first + 4, 32);
    seal(file.bytes + file.first, 32, 8);
    size_t at = file.first;
    uint32_t count;
    CHECK(dpt_record_read(file.bytes, file.size, &at, &record, 1, &count) == DPT_E_LAYOUT, "short");
}

static void headers_that_cannot_be_are_refused(void)
{
    struct file file;
    dpt_record_header header = { .size = sizeof header };
    size_t at = 0;
    make_file(&file);
    const struct {
        size_t at;
        uint32_t value;
        dpt_result result;
    } cases[] = { { 0, 0x4b504489, DPT_E_MAGIC },   { 8, 2, DPT_E_VERSION },          { 8, 0, DPT_E_LAYOUT },
                  { 12, 40, DPT_E_LAYOUT },         { 12, 81, DPT_E_LAYOUT },         { 12, 1u << 20, DPT_E_LAYOUT },
                  { 28, 0x7ff00000, DPT_E_FINITE }, { 28, 0xbff00000, DPT_E_FINITE }, { 40, 4, DPT_E_LAYOUT },
                  { 40, 0xffffffff, DPT_E_LAYOUT }, { 44, 1, DPT_E_LAYOUT },          { 52, 0, DPT_E_LAYOUT } };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct file damaged = file;
        put4(damaged.bytes + cases[i].at, cases[i].value);
        seal(damaged.bytes, damaged.first, 16);
        dpt_result result = dpt_record_header_read(damaged.bytes, damaged.size, &header, &at);
        CHECK(result == cases[i].result, "case %zu: %s", i, dpt_result_name(result));
    }
    /* Bytes behind the text are zero. */
    file.bytes[file.first - 1] = 1;
    seal(file.bytes, file.first, 16);
    CHECK(dpt_record_header_read(file.bytes, file.size, &header, &at) == DPT_E_LAYOUT, "padding");
}

static void what_cannot_be_written_is_refused(void)
{
    static char long_text[DPT_RECORD_TEXT_MAX + 2];
    unsigned char bytes[ROOM];
    size_t written = 3;
    dpt_record_header header = header_of(text);
    dpt_record record = { .size = sizeof record };
    memset(long_text, 'x', sizeof long_text - 1);
    CHECK(dpt_record_header_write(&header, bytes, dpt_record_header_bytes(&header) - 1, &written) == DPT_E_MEMORY,
          "too little room");
    header.rate = -1.0;
    CHECK(dpt_record_header_write(&header, bytes, ROOM, &written) == DPT_E_FINITE &&
              dpt_record_header_bytes(&header) == 0,
          "a rate below 0");
    header = header_of("a\n");
    header.text_bytes = 3;
    CHECK(dpt_record_header_write(&header, bytes, ROOM, &written) == DPT_E_ARGUMENT, "a zero");
    header = header_of(long_text);
    CHECK(dpt_record_header_write(&header, bytes, ROOM, &written) == DPT_E_LIMIT, "a long text");
    header.text_bytes--;
    CHECK(dpt_record_header_bytes(&header) == 48 + DPT_RECORD_TEXT_MAX + 8, "the longest text");
    header = header_of(NULL);
    CHECK(dpt_record_header_write(&header, bytes, ROOM, &written) == DPT_OK && written == 56, "no text: %zu bytes",
          written);
    CHECK(dpt_record_write(&record, 1, bytes, dpt_record_bytes() - 1, &written) == DPT_E_MEMORY && written == 56,
          "too little room for a record");
    CHECK(dpt_record_write(&record, 0, bytes, 0, &written) == DPT_OK && written == 0, "none");
    record.size += 4;
    CHECK(dpt_record_write(&record, 1, bytes, ROOM, &written) == DPT_E_SIZE, "a size");
}

/* The record k of the golden file: each word is other, and what its number says. */
static dpt_record golden_record(uint32_t k)
{
    dpt_record record = { .size = sizeof record, .device = k };
    unsigned char *bytes = (unsigned char *)&record;
    for (size_t at = offsetof(dpt_record, number); at < sizeof record;) {
        const int is_narrow = at >= offsetof(dpt_record, flags) && at < offsetof(dpt_record, pose);
        const uint32_t narrow = (uint32_t)(at * 65537u + k);
        const uint64_t wide = at * 0x0101010101010101u + k;
        const double number = (double)at / 3.0 - (double)k;
        if (is_narrow)
            memcpy(bytes + at, &narrow, sizeof narrow);
        else if (at < offsetof(dpt_record, dt))
            memcpy(bytes + at, &wide, sizeof wide);
        else
            memcpy(bytes + at, &number, sizeof number);
        at += is_narrow ? sizeof narrow : sizeof wide;
    }
    return record;
}

/* Records of 0.2 have 504 bytes, and nothing from `depth` on. */
enum { GOLDEN_RECORDS = 3, GOLDEN_BYTES = 504, RECORD_PREFIX = 12 };

/* The bytes of golden records, and half of one more. */
static size_t write_golden_records(unsigned char *bytes, size_t room)
{
    dpt_record records[GOLDEN_RECORDS + 1];
    size_t written = 0;
    for (uint32_t k = 0; k <= GOLDEN_RECORDS; k++)
        records[k] = golden_record(k);
    CHECK(dpt_record_write(records, GOLDEN_RECORDS + 1, bytes, room, &written) == DPT_OK, "write");
    return written - dpt_record_bytes() / 2;
}

/* tests/golden/recording_1.dpr is what `test_record write` of 0.2 wrote. */
static int write_golden(void)
{
    static unsigned char bytes[ROOM];
    const dpt_record_header header = header_of(text);
    size_t size = 0;
    dpt_record_header_write(&header, bytes, ROOM, &size);
    size += write_golden_records(bytes + size, ROOM - size);
    return fwrite(bytes, size, 1, stdout) != 1;
}

static void the_golden_file_stays_readable(void)
{
    static unsigned char bytes[ROOM], again[ROOM];
    FILE *file = fopen("tests/golden/recording_1.dpr", "rb");
    const size_t size = file ? fread(bytes, 1, sizeof bytes, file) : 0;
    dpt_record_header header = { .size = sizeof header };
    dpt_record records[4] = { { .size = sizeof *records } };
    size_t at = 0;
    uint32_t count = 0;
    if (file)
        fclose(file);
    CHECK(dpt_record_header_read(bytes, size, &header, &at) == DPT_OK && header.rate == 1000.0 &&
              header.began_ns == 1700000000123456789u && header.writer_version == 0x000200 &&
              !strcmp(header.text, text),
          "header");
    const size_t begin = at;
    CHECK(dpt_record_read(bytes, size, &at, records, 4, &count) == DPT_OK && count == 3, "%u records", count);
    CHECK(size == at + GOLDEN_BYTES / 2, "%zu bytes", size);
    CHECK(write_golden_records(again, ROOM) > 0, "write");
    for (uint32_t k = 0; k < count; k++) {
        dpt_record expected = golden_record(k);
        memset((unsigned char *)&expected + offsetof(dpt_record, depth), 0,
               sizeof expected - offsetof(dpt_record, depth));
        CHECK(!memcmp(&records[k], &expected, sizeof expected), "record %u", k);
        CHECK(!memcmp(again + k * dpt_record_bytes() + RECORD_PREFIX, bytes + begin + k * GOLDEN_BYTES + RECORD_PREFIX,
                      GOLDEN_BYTES - RECORD_PREFIX),
              "record %u: other bytes are written", k);
    }
    CHECK(dpt_record_read(bytes, size, &at, records, 4, &count) == DPT_E_TRUNCATED, "the fourth");
}

int main(int argc, char **argv)
{
    if (argc > 1 && !strcmp(argv[1], "write"))
        return write_golden();
    TEST(what_is_written_is_read);
    TEST(a_cut_leaves_what_is_before_it);
    TEST(each_flipped_bit_is_found);
    TEST(newer_records_are_read_as_far_as_they_are_known);
    TEST(lengths_that_cannot_be_are_refused);
    TEST(headers_that_cannot_be_are_refused);
    TEST(what_cannot_be_written_is_refused);
    TEST(the_golden_file_stays_readable);
    return check_report();
}
