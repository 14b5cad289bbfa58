/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A recording's bytes as they are; then with all checksums made good, so that nonsense gets past them. Refused with a
 * code and a place, or read: each record is what is written again from it, and a search finds the rest.
 */
#include <string.h>

#include "base/crc32.h"
#include "fuzz/target.h"

static uint32_t get4(const unsigned char *from)
{
    return (uint32_t)from[0] | (uint32_t)from[1] << 8 | (uint32_t)from[2] << 16 | (uint32_t)from[3] << 24;
}

/* The checksum at `at` of these bytes, as if it were 0. */
static void seal(const struct crc32 *crc, unsigned char *bytes, size_t size, size_t at)
{
    memset(bytes + at, 0, 4);
    const uint32_t sum = crc32_of(crc, bytes, size);
    for (int i = 0; i < 4; i++)
        bytes[at + (size_t)i] = (unsigned char)(sum >> 8 * i);
}

static void seal_all(unsigned char *bytes, size_t size)
{
    struct crc32 crc;
    size_t at = size >= 24 ? get4(bytes + 12) : size;
    crc32_init(&crc);
    if (size < 24 || at > size || at < 24)
        return;
    seal(&crc, bytes, at, 16);
    while (size - at >= 12) {
        const size_t length = get4(bytes + at + 4);
        if (length < 12 || length > size - at)
            return;
        seal(&crc, bytes + at, length, 8);
        at += length;
    }
}

static void use(const dpt_record *record)
{
    unsigned char bytes[1024];
    dpt_record again = { .size = sizeof again };
    size_t written = 0, at = 0;
    uint32_t count = 0;
    MUST(dpt_record_write(record, 1, bytes, sizeof bytes, &written) == DPT_OK);
    MUST(dpt_record_read(bytes, written, &at, &again, 1, &count) == DPT_OK && count == 1);
    MUST(at == written && !memcmp(&again, record, sizeof again));
}

/* The bytes of a tick in the first release, which are read too. */
enum { OLDEST = 504 };

static void read_all(const uint8_t *bytes, size_t size)
{
    dpt_record_header header = { .size = sizeof header };
    dpt_record records[3] = { { .size = sizeof *records } };
    size_t at = size + 1;
    uint32_t count = 0, all = 0;
    if (dpt_record_header_read(bytes, size, &header, &at) != DPT_OK) {
        MUST(at == size + 1);
        return;
    }
    fuzz_accepted++;
    MUST(at <= size && at >= 56 && at % 8 == 0 && strlen(header.text) == header.text_bytes);
    MUST(header.rate >= 0.0 && header.rate <= 1e9);
    while (at < size) {
        const size_t before = at;
        const dpt_result result = dpt_record_read(bytes, size, &at, records, 3, &count);
        MUST(at <= size && count <= 3 && at >= before + count * OLDEST);
        MUST(result == DPT_OK ||
             (!count && (result == DPT_E_TRUNCATED || result == DPT_E_LAYOUT || result == DPT_E_CHECKSUM)));
        for (uint32_t i = 0; i < count; i++)
            use(&records[i]);
        all += count;
        at += result != DPT_OK;
    }
    MUST(all <= size / OLDEST);
}

FUZZ_TARGET(record)
{
    if (size == 0)
        return 0;
    const uint64_t accepted = fuzz_accepted;
    read_all(bytes, size);
    if (fuzz_accepted > accepted)
        return 0;
    unsigned char *sealed = malloc(size);
    MUST(sealed);
    memcpy(sealed, bytes, size);
    seal_all(sealed, size);
    read_all(sealed, size);
    free(sealed);
    return 0;
}
