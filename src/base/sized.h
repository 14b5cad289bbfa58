/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Structs that begin with `uint32_t size`: one rule for callers that are older or newer than the library.
 *
 *     size                      input                                          output
 *     below the first release's DPT_E_SIZE                                     DPT_E_SIZE
 *     up to today's             what is missing counts as its default          filled as far as it goes
 *     above today's             the rest must be zero, else DPT_E_UNSUPPORTED  the rest is zeroed
 *     above SIZED_MAX           DPT_E_SIZE: never set                          DPT_E_SIZE
 *
 * The first release's size is that of the struct up to, not including, the first field that was added since:
 * SIZED_FIRST(type, field), or sizeof(type) where there is none.
 */
#ifndef DPT_SIZED_H
#define DPT_SIZED_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "dynpoint/result.h"

#define SIZED_MAX                4096u
#define SIZED_FIRST(type, field) offsetof(type, field)

/* The size that a caller has set. */
static inline uint32_t sized_of(const void *given)
{
    uint32_t size;
    memcpy(&size, given, sizeof size);
    return size;
}

/* Item i of a caller's array; the first item's size is the distance between items. */
static inline const void *sized_item(const void *array, size_t i)
{
    return (const unsigned char *)array + i * sized_of(array);
}

/*
 * Copy a caller's input of `size` bytes into `own`, which has `today` bytes and holds the defaults and its own size.
 * first: the size in the first release. On an error `own` stays as it was.
 */
static inline dpt_result sized_take(const void *given, uint32_t size, size_t first, void *own, size_t today)
{
    const size_t known = size < today ? size : today;
    if (size < first || size > SIZED_MAX)
        return DPT_E_SIZE;
    for (size_t i = today; i < size; i++)
        if (((const unsigned char *)given)[i])
            return DPT_E_UNSUPPORTED;
    memcpy((unsigned char *)own + sizeof size, (const unsigned char *)given + sizeof size, known - sizeof size);
    return DPT_OK;
}

/* The same for an input whose first field is its size. */
static inline dpt_result sized_read(const void *given, size_t first, void *own, size_t today)
{
    return sized_take(given, sized_of(given), first, own, today);
}

/*
 * DPT_OK if an output with this size may be written, else DPT_E_SIZE. For the first item of an array `stride` is 1:
 * its size must be a multiple of 8 then, so that each item is aligned.
 */
static inline dpt_result sized_check(const void *out, size_t first, int stride)
{
    const uint32_t size = sized_of(out);
    return size < first || size > SIZED_MAX || (stride && size % 8) ? DPT_E_SIZE : DPT_OK;
}

/* Write `own`, of `today` bytes, to a caller's output of `size` bytes, which was checked; the size field stays. */
static inline void sized_write(void *out, uint32_t size, const void *own, size_t today)
{
    const size_t known = size < today ? size : today;
    memcpy(out, &size, sizeof size);
    memcpy((unsigned char *)out + sizeof size, (const unsigned char *)own + sizeof size, known - sizeof size);
    memset((unsigned char *)out + known, 0, size - known);
}

/* The body of a def's _defaults function: fill in the first `size` bytes. Does nothing for an invalid size. */
static inline void sized_defaults(void *def, size_t size, const void *defaults, size_t today)
{
    if (def && size >= sizeof(uint32_t) && size <= SIZED_MAX)
        sized_write(def, (uint32_t)size, defaults, today);
}

#endif
