/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Memory that calls write to: filled with a pattern, and with the same pattern about it. Under the address
 * sanitizer what lies behind it is poisoned, so that a read ends the run too.
 */
#include "fuzz/calls/calls.h"

#ifdef __SANITIZE_ADDRESS__
#include <sanitizer/asan_interface.h>
#else
#define ASAN_POISON_MEMORY_REGION(at, size)   ((void)(at), (void)(size))
#define ASAN_UNPOISON_MEMORY_REGION(at, size) ((void)(at), (void)(size))
#endif

enum { PATTERN = 0xa5, GUARD = 64, STRUCT_SIZE_MAX = 4096 };

static _Alignas(64) unsigned char room[OUTPUTS][GUARD + OUTPUT_ROOM + GUARD];
static size_t sizes[OUTPUTS];
static int is_filled[OUTPUTS];

static unsigned char *base_of(int slot)
{
    return room[slot] + GUARD;
}

void *output_of(int slot, size_t size)
{
    HOLDS(size <= OUTPUT_ROOM, "%zu bytes", size);
    ASAN_UNPOISON_MEMORY_REGION(room[slot], sizeof room[slot]);
    memset(room[slot], PATTERN, GUARD + size + GUARD);
    ASAN_POISON_MEMORY_REGION(base_of(slot) + size, OUTPUT_ROOM + GUARD - size);
    sizes[slot] = size;
    is_filled[slot] = 1;
    return base_of(slot);
}

void *output_at(int slot)
{
    return base_of(slot);
}

void *output_sized(int slot, uint32_t size)
{
    const size_t own = size < sizeof size ? sizeof size : size > STRUCT_SIZE_MAX ? 8 : size;
    void *out = output_of(slot, own);
    memcpy(out, &size, sizeof size);
    return out;
}

static int is_pattern(const unsigned char *from, size_t size)
{
    for (size_t i = 0; i < size; i++)
        if (from[i] != PATTERN)
            return 0;
    return 1;
}

void outputs_are_guarded(int first, int count)
{
    for (int slot = first; slot < first + count; slot++) {
        if (!is_filled[slot])
            continue; /* no call has had it yet */
        const unsigned char *end = base_of(slot) + sizes[slot];
        ASAN_UNPOISON_MEMORY_REGION(end, GUARD);
        HOLDS(is_pattern(room[slot], GUARD), "output %d, written before its begin", slot);
        HOLDS(is_pattern(end, GUARD), "output %d, written behind its %zu bytes", slot, sizes[slot]);
        ASAN_POISON_MEMORY_REGION(end, GUARD);
    }
}

void outputs_agree(int pairs)
{
    for (int slot = 0; slot < 2 * pairs; slot += 2)
        HOLDS(sizes[slot] == sizes[slot + 1] && !memcmp(base_of(slot), base_of(slot + 1), sizes[slot]),
              "output %d: a second world in another block answers otherwise", slot);
}

int output_is_untouched(int slot, size_t from)
{
    return from >= sizes[slot] || is_pattern(base_of(slot) + from, sizes[slot] - from);
}

void numbers_are_finite(const double *numbers, size_t count, const char *what)
{
    for (size_t i = 0; i < count; i++)
        HOLDS(isfinite(numbers[i]), "%s, number %zu: %g", what, i, numbers[i]);
}

int output_read(int slot, uint32_t size, size_t today, size_t doubles, void *copy)
{
    const unsigned char *bytes = base_of(slot);
    const size_t known = size < today ? size : today;
    uint32_t now;
    memcpy(&now, bytes, sizeof now);
    HOLDS(now == size, "its size became %u", now);
    for (size_t i = today; i < size; i++)
        HOLDS(bytes[i] == 0, "byte %zu behind today's is %x", i - today, bytes[i]);
    memset(copy, 0, today);
    memcpy(copy, bytes, known);
    for (size_t i = doubles; i + sizeof(double) <= known; i += sizeof(double)) {
        double number;
        memcpy(&number, bytes + i, sizeof number);
        HOLDS(isfinite(number), "the number at byte %zu is %g", i, number);
    }
    game_digest(bytes, known);
    return size >= today;
}

static int is_size_of_defaults(uint32_t size)
{
    return size >= sizeof size && size <= STRUCT_SIZE_MAX;
}

void *output_of_defaults(int slot, uint32_t size)
{
    return output_of(slot, is_size_of_defaults(size) || size < sizeof size ? size : 8);
}

void defaults_must_hold(int slot, uint32_t size, int is_null, const void *whole, size_t today)
{
    const unsigned char *bytes = base_of(slot);
    const size_t known = size < today ? size : today;
    uint32_t now;
    outputs_are_guarded(slot, 1);
    if (is_null || !is_size_of_defaults(size)) {
        HOLDS(output_is_untouched(slot, 0), "written with a size of %u", size);
        return;
    }
    memcpy(&now, bytes, sizeof now);
    HOLDS(now == size, "the size of %u became %u", size, now);
    HOLDS(!memcmp(bytes + sizeof size, (const unsigned char *)whole + sizeof size, known - sizeof size),
          "not the defaults, as far as %u bytes go", size);
    for (size_t i = today; i < size; i++)
        HOLDS(bytes[i] == 0, "byte %zu of size %u", i, size);
}
