/* SPDX-License-Identifier: BSD-3-Clause */
/* Frames of any body, as docs/wire.md describes them, without wire.c: a bit at a time, and with a list of zeros. */
#ifndef DPT_TESTS_WIRE_FRAME_H
#define DPT_TESTS_WIRE_FRAME_H

#include <stddef.h>
#include <stdint.h>

static inline uint32_t frame_crc(const uint8_t *bytes, size_t size)
{
    uint32_t crc = 0xffffffffu;
    for (size_t bit = 0; bit < 8 * size; bit++) {
        const uint32_t one = (bytes[bit / 8] >> bit % 8 & 1) ^ (crc & 1);
        crc = crc >> 1 ^ (one ? 0x82f63b78u : 0);
    }
    return crc ^ 0xffffffffu;
}

/* `out` has room for size + 7 bytes; size < 254. Returns the length, the zero at the end included. */
static inline size_t frame_of(const uint8_t *body, size_t size, uint8_t *out)
{
    for (size_t i = 0; i <= size; i++) {
        size_t next = i;
        while (next < size && body[next] != 0)
            next++;
        if (i == 0 || body[i - 1] == 0)
            out[i] = (uint8_t)(next - i + 1);
        else
            out[i] = body[i - 1];
    }
    const uint64_t crc = frame_crc(out, size + 1);
    for (size_t k = 0; k < 5; k++)
        out[size + 1 + k] = (uint8_t)(0x80 + crc / ((uint64_t)1 << 7 * k) % 128);
    out[size + 6] = 0;
    return size + 7;
}

#endif
