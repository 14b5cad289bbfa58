/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The format of recordings (record.h, docs/format.md), little-endian on every machine. Nothing is converted in place, so
 * neither alignment nor byte order of the host matters.
 */
#include "dynpoint/record.h"

#include "base/crc32.h"
#include "base/return_if_error.h"
#include "base/sized.h"

/* Not text, and damaged by any transfer as text, as in a mesh's file. */
static const unsigned char magic[8] = { 0x89, 'D', 'P', 'R', 0x0d, 0x0a, 0x1a, 0x0a };

/* Offsets in the header. */
enum {
    AT_VERSION = 8,
    AT_HEADER_BYTES = 12,
    AT_HEADER_CRC = 16,
    AT_WRITER = 20,
    AT_RATE = 24,
    AT_BEGAN = 32,
    AT_TEXT_BYTES = 40,
    AT_RESERVED = 44,
    AT_TEXT = 48
};
enum { VERSION = 1, HEADER_BYTES_MAX = AT_TEXT + DPT_RECORD_TEXT_MAX + 8 };

/* Offsets in a record of any kind. */
enum { AT_KIND = 0, AT_BYTES = 4, AT_CRC = 8, AT_DEVICE = 12, AT_NUMBER = 16, AT_NEXT = 24 };
enum { KIND_TICK = 1 };

/* A tick's words in their order, which is that of the struct's fields from `number` on. */
static const struct {
    uint32_t at, count, bytes; /* at: in the struct; bytes: of a word */
} words[] = { { offsetof(dpt_record, number), 7, 8 },
              { offsetof(dpt_record, flags), 14, 4 },
              { offsetof(dpt_record, pose), 47, 8 },
              { offsetof(dpt_record, depth), 2, 8 },
              { offsetof(dpt_record, ruptures), 2, 4 } };

enum { FIRST_TICK_BYTES = AT_NUMBER + 7 * 8 + 14 * 4 + 47 * 8, TICK_BYTES = FIRST_TICK_BYTES + 2 * 8 + 2 * 4 };

static uint64_t get(const unsigned char *from, uint32_t bytes)
{
    uint64_t value = 0;
    for (uint32_t i = 0; i < bytes; i++)
        value |= (uint64_t)from[i] << 8 * i;
    return value;
}

static void put(unsigned char *to, uint64_t value, uint32_t bytes)
{
    for (uint32_t i = 0; i < bytes; i++)
        to[i] = (unsigned char)(value >> 8 * i);
}

static uint32_t get4(const unsigned char *from)
{
    return (uint32_t)get(from, 4);
}

/* The checksum of `size` bytes, as if the word at `hole` were 0. */
static uint32_t crc_around(const struct crc32 *crc, const unsigned char *bytes, size_t size, size_t hole)
{
    static const unsigned char zeros[4] = { 0 };
    uint32_t sum = crc32_more(crc, 0, bytes, hole);
    sum = crc32_more(crc, sum, zeros, sizeof zeros);
    return crc32_more(crc, sum, bytes + hole + sizeof zeros, size - hole - sizeof zeros);
}

static int has_zero(const char *text, size_t size)
{
    for (size_t i = 0; i < size; i++)
        if (!text[i])
            return 1;
    return 0;
}

static int is_rate(double rate)
{
    return rate >= 0.0 && rate <= 1e9;
}

/* The text and at least one zero, up to a multiple of 8. */
static size_t header_bytes_of(size_t text_bytes)
{
    return (AT_TEXT + text_bytes + 8) & ~(size_t)7;
}

static dpt_result check_header(const dpt_record_header *given, dpt_record_header *header)
{
    *header = (dpt_record_header){ .size = sizeof *header };
    if (!given)
        return DPT_E_ARGUMENT;
    DPT_TRY(sized_read(given, sizeof *header, header, sizeof *header));
    if (!is_rate(header->rate))
        return DPT_E_FINITE;
    if (header->text_bytes > DPT_RECORD_TEXT_MAX)
        return DPT_E_LIMIT;
    if (header->text_bytes && (!header->text || has_zero(header->text, header->text_bytes)))
        return DPT_E_ARGUMENT;
    return DPT_OK;
}

size_t dpt_record_header_bytes(const dpt_record_header *given)
{
    dpt_record_header header;
    return check_header(given, &header) == DPT_OK ? header_bytes_of(header.text_bytes) : 0;
}

dpt_result dpt_record_header_write(const dpt_record_header *given, void *bytes, size_t capacity, size_t *written)
{
    dpt_record_header header;
    struct crc32 crc;
    unsigned char *to = bytes;
    uint64_t rate;
    if (!bytes || !written)
        return DPT_E_ARGUMENT;
    DPT_TRY(check_header(given, &header));
    const size_t size = header_bytes_of(header.text_bytes);
    if (capacity < size)
        return DPT_E_MEMORY;
    memset(to, 0, size);
    memcpy(to, magic, sizeof magic);
    memcpy(&rate, &header.rate, sizeof rate);
    put(to + AT_VERSION, VERSION, 4);
    put(to + AT_HEADER_BYTES, size, 4);
    put(to + AT_WRITER, DPT_VERSION_NUMBER, 4);
    put(to + AT_RATE, rate, 8);
    put(to + AT_BEGAN, header.began_ns, 8);
    put(to + AT_TEXT_BYTES, header.text_bytes, 4);
    if (header.text_bytes)
        memcpy(to + AT_TEXT, header.text, header.text_bytes);
    crc32_init(&crc);
    put(to + AT_HEADER_CRC, crc_around(&crc, to, size, AT_HEADER_CRC), 4);
    *written = size;
    return DPT_OK;
}

dpt_result dpt_record_header_read(const void *bytes, size_t size, dpt_record_header *header, size_t *at)
{
    const unsigned char *from = bytes;
    dpt_record_header read = { .size = sizeof read };
    struct crc32 crc;
    uint64_t rate;
    if (!bytes || !header || !at)
        return DPT_E_ARGUMENT;
    DPT_TRY(sized_check(header, sizeof *header, 0));
    if (memcmp(from, magic, size < sizeof magic ? size : sizeof magic) != 0)
        return DPT_E_MAGIC;
    if (size < AT_HEADER_CRC)
        return DPT_E_TRUNCATED;
    if (get4(from + AT_VERSION) > VERSION)
        return DPT_E_VERSION;
    const size_t header_bytes = get4(from + AT_HEADER_BYTES);
    if (get4(from + AT_VERSION) != VERSION || header_bytes <= AT_TEXT || header_bytes % 8 != 0 ||
        header_bytes > HEADER_BYTES_MAX)
        return DPT_E_LAYOUT;
    if (size < header_bytes)
        return DPT_E_TRUNCATED;
    crc32_init(&crc);
    if (get4(from + AT_HEADER_CRC) != crc_around(&crc, from, header_bytes, AT_HEADER_CRC))
        return DPT_E_CHECKSUM;
    rate = get(from + AT_RATE, 8);
    memcpy(&read.rate, &rate, sizeof rate);
    read.writer_version = get4(from + AT_WRITER);
    read.began_ns = get(from + AT_BEGAN, 8);
    read.text = (const char *)from + AT_TEXT;
    read.text_bytes = get4(from + AT_TEXT_BYTES);
    if (read.text_bytes > DPT_RECORD_TEXT_MAX || header_bytes_of(read.text_bytes) != header_bytes ||
        get4(from + AT_RESERVED) || has_zero(read.text, read.text_bytes))
        return DPT_E_LAYOUT;
    for (size_t i = AT_TEXT + read.text_bytes; i < header_bytes; i++)
        if (from[i])
            return DPT_E_LAYOUT;
    if (!is_rate(read.rate))
        return DPT_E_FINITE;
    sized_write(header, header->size, &read, sizeof read);
    *at = header_bytes;
    return DPT_OK;
}

size_t dpt_record_bytes(void)
{
    return TICK_BYTES;
}

static void put_tick(const struct crc32 *crc, const dpt_record *record, unsigned char *to)
{
    unsigned char *word = to + AT_NUMBER;
    put(to + AT_KIND, KIND_TICK, 4);
    put(to + AT_BYTES, TICK_BYTES, 4);
    put(to + AT_DEVICE, record->device, 4);
    for (size_t run = 0; run < sizeof words / sizeof *words; run++) {
        const unsigned char *from = (const unsigned char *)record + words[run].at;
        for (uint32_t i = 0; i < words[run].count; i++, word += words[run].bytes) {
            uint32_t narrow;
            uint64_t wide;
            memcpy(&narrow, from + words[run].bytes * i, sizeof narrow);
            if (words[run].bytes == sizeof wide)
                memcpy(&wide, from + words[run].bytes * i, sizeof wide);
            else
                wide = narrow;
            put(word, wide, words[run].bytes);
        }
    }
    put(to + AT_CRC, crc_around(crc, to, TICK_BYTES, AT_CRC), 4);
}

static void get_tick(const unsigned char *from, dpt_record *record)
{
    const unsigned char *word = from + AT_NUMBER, *end = from + get4(from + AT_BYTES);
    record->device = get4(from + AT_DEVICE);
    for (size_t run = 0; run < sizeof words / sizeof *words; run++) {
        unsigned char *to = (unsigned char *)record + words[run].at;
        for (uint32_t i = 0; i < words[run].count && word < end; i++, word += words[run].bytes) {
            const uint64_t wide = get(word, words[run].bytes);
            const uint32_t narrow = (uint32_t)wide;
            if (words[run].bytes == sizeof wide)
                memcpy(to + words[run].bytes * i, &wide, sizeof wide);
            else
                memcpy(to + words[run].bytes * i, &narrow, sizeof narrow);
        }
    }
}

dpt_result dpt_record_write(const dpt_record *records, uint32_t count, void *bytes, size_t capacity, size_t *written)
{
    struct crc32 crc;
    unsigned char *to = bytes;
    if (!records || !bytes || !written)
        return DPT_E_ARGUMENT;
    if (count > 0)
        DPT_TRY(sized_check(records, SIZED_FIRST(dpt_record, depth), 1));
    if (count > capacity / TICK_BYTES)
        return DPT_E_MEMORY;
    const uint32_t stride = count > 0 ? sized_of(records) : 0;
    dpt_record record = { .size = sizeof record };
    for (uint32_t i = 0; i < count; i++)
        DPT_TRY(sized_take(sized_item(records, i), stride, SIZED_FIRST(dpt_record, depth), &record, sizeof record));
    crc32_init(&crc);
    for (uint32_t i = 0; i < count; i++) {
        sized_take(sized_item(records, i), stride, SIZED_FIRST(dpt_record, depth), &record, sizeof record);
        put_tick(&crc, &record, to + (size_t)i * TICK_BYTES);
    }
    *written = (size_t)count * TICK_BYTES;
    return DPT_OK;
}

/* Check the place and length of the record at the beginning of these bytes. */
static dpt_result check_layout(const unsigned char *from, size_t size)
{
    if (size < AT_CRC)
        return DPT_E_TRUNCATED;
    const size_t bytes = get4(from + AT_BYTES);
    if (bytes < AT_NEXT || bytes % 8 != 0 || bytes > DPT_RECORD_BYTES_MAX ||
        (get4(from + AT_KIND) == KIND_TICK && bytes < FIRST_TICK_BYTES))
        return DPT_E_LAYOUT;
    return size < bytes ? DPT_E_TRUNCATED : DPT_OK;
}

dpt_result dpt_record_read(const void *bytes, size_t size, size_t *at, dpt_record *records, uint32_t capacity,
                           uint32_t *count)
{
    const unsigned char *from = bytes;
    struct crc32 crc;
    if (!bytes || !at || !records || !count || *at > size)
        return DPT_E_ARGUMENT;
    DPT_TRY(sized_check(records, SIZED_FIRST(dpt_record, depth), 1));
    const uint32_t stride = sized_of(records);
    size_t next = *at;
    dpt_result result = DPT_OK;
    int has_tables = 0;
    *count = 0;
    while (*count < capacity && next < size) {
        result = check_layout(from + next, size - next);
        if (result != DPT_OK)
            break;
        /* A search for the next sound record mostly ends above, without tables. */
        if (!has_tables)
            crc32_init(&crc);
        has_tables = 1;
        if (get4(from + next + AT_CRC) != crc_around(&crc, from + next, get4(from + next + AT_BYTES), AT_CRC)) {
            result = DPT_E_CHECKSUM;
            break;
        }
        if (get4(from + next + AT_KIND) == KIND_TICK) {
            dpt_record record = { .size = sizeof record };
            get_tick(from + next, &record);
            sized_write((unsigned char *)records + (size_t)*count * stride, stride, &record, sizeof record);
            ++*count;
        }
        next += get4(from + next + AT_BYTES);
    }
    *at = next;
    return *count ? DPT_OK : result;
}
