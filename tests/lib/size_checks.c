/* SPDX-License-Identifier: BSD-3-Clause */
#include "lib/size_checks.h"

static int all_are(const unsigned char *bytes, size_t from, size_t to, unsigned char value)
{
    for (size_t i = from; i < to; i++)
        if (bytes[i] != value)
            return 0;
    return 1;
}

/* A block of `size` bytes that count, all of them 0x5a but the size. */
static dpt_result fill(const struct sized *of, unsigned char block[SIZED_ROOM], uint32_t size)
{
    memset(block, 0x5a, SIZED_ROOM);
    memcpy(block, &size, sizeof size);
    return of->call(block);
}

void check_output(const struct sized *of)
{
    _Alignas(8) unsigned char whole[SIZED_ROOM], block[SIZED_ROOM];
    const uint32_t first = (uint32_t)of->first, today = (uint32_t)of->today;
    CHECK(fill(of, whole, today) == DPT_OK, "%s: %s", of->name, dpt_result_name(fill(of, whole, today)));
    CHECK(!all_are(whole, sizeof first, today, 0x5a), "%s: nothing was filled in", of->name);
    CHECK(fill(of, block, first - 8) == DPT_E_SIZE && all_are(block, 4, SIZED_ROOM, 0x5a),
          "%s: before the first release", of->name);
    CHECK(fill(of, block, 0) == DPT_E_SIZE && fill(of, block, FAR_TOO_LARGE) == DPT_E_SIZE, "%s: a size that is none",
          of->name);
    CHECK(fill(of, block, first) == DPT_OK && all_are(block, first, SIZED_ROOM, 0x5a) &&
              !memcmp(block + 4, whole + 4, first - 4),
          "%s: of the first release", of->name);
    CHECK(fill(of, block, today + 8) == DPT_OK && all_are(block, today, today + 8, 0) &&
              all_are(block, today + 8, SIZED_ROOM, 0x5a) && !memcmp(block + 4, whole + 4, today - 4),
          "%s: of a newer caller", of->name);
    uint32_t size;
    memcpy(&size, block, sizeof size);
    CHECK(size == today + 8, "%s: its size became %u", of->name, size);
}

/* That input with another size; what lies behind what it has is `behind`. */
static dpt_result give(const struct sized *of, const void *good, uint32_t size, unsigned char behind)
{
    _Alignas(8) unsigned char block[FAR_TOO_LARGE];
    const size_t known = size < of->today ? size : of->today;
    memset(block, behind, sizeof block);
    memcpy(block, good, known);
    memcpy(block, &size, sizeof size);
    return of->call(block);
}

void check_input(const struct sized *of, const void *good)
{
    const uint32_t first = (uint32_t)of->first, today = (uint32_t)of->today;
    CHECK(give(of, good, today, 0x5a) == DPT_OK, "%s: %s", of->name, dpt_result_name(give(of, good, today, 0x5a)));
    CHECK(give(of, good, first, 0x5a) == DPT_OK, "%s: of the first release", of->name);
    CHECK(give(of, good, first - 8, 0) == DPT_E_SIZE && give(of, good, 0, 0) == DPT_E_SIZE &&
              give(of, good, FAR_TOO_LARGE, 0) == DPT_E_SIZE,
          "%s: a size that is none", of->name);
    CHECK(give(of, good, today + 8, 0) == DPT_OK, "%s: newer, and zero", of->name);
    CHECK(give(of, good, today + 8, 1) == DPT_E_UNSUPPORTED, "%s: newer, and not zero", of->name);
}

void check_defaults(const struct sized *of, void (*fill_in)(void *, size_t), const void *whole)
{
    _Alignas(8) unsigned char block[SIZED_ROOM];
    const uint32_t today = (uint32_t)of->today;
    for (uint32_t size = 0; size <= today + 64; size += 4) {
        uint32_t stamped;
        memset(block, 0x5a, sizeof block);
        fill_in(block, size);
        memcpy(&stamped, block, sizeof stamped);
        CHECK(all_are(block, size, SIZED_ROOM, 0x5a), "%s, size %u: more was written", of->name, size);
        if (size >= 4)
            CHECK(stamped == size, "%s, size %u became %u", of->name, size, stamped);
        const size_t known = size < today ? size : today;
        if (known > 4)
            CHECK(!memcmp(block + 4, (const unsigned char *)whole + 4, known - 4), "%s, size %u: other defaults",
                  of->name, size);
        if (size > today)
            CHECK(all_are(block, today, size, 0), "%s, size %u: not zero behind", of->name, size);
        if (size >= today && of->call)
            CHECK(of->call(block) == DPT_OK, "%s, size %u: its own defaults are refused", of->name, size);
    }
    fill_in(NULL, today);
    memset(block, 0x5a, sizeof block);
    fill_in(block, FAR_TOO_LARGE);
    CHECK(all_are(block, 0, SIZED_ROOM, 0x5a), "%s: a size that is none", of->name);
}
