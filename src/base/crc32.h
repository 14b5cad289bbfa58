/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * CRC-32 as in zlib, PNG and Ethernet (reflected polynomial 0xEDB88320), so that common tools can check a file. Eight
 * bytes a step. The caller holds the tables, on the stack.
 */
#ifndef DPT_CRC32_H
#define DPT_CRC32_H

#include <stddef.h>
#include <stdint.h>

struct crc32 {
    uint32_t table[8][256];
};

/* Compute the tables. */
static inline void crc32_init(struct crc32 *crc)
{
    for (uint32_t i = 0; i < 256; i++) {
        uint32_t c = i;
        for (int bit = 0; bit < 8; bit++)
            c = c & 1 ? (c >> 1) ^ 0xedb88320u : c >> 1;
        crc->table[0][i] = c;
    }
    for (uint32_t i = 0; i < 256; i++)
        for (int k = 1; k < 8; k++) {
            uint32_t c = crc->table[k - 1][i];
            crc->table[k][i] = (c >> 8) ^ crc->table[0][c & 255];
        }
}

/* Continue a checksum: `before` is that of the bytes in front, 0 where there are none. Returns that of all bytes. */
static inline uint32_t crc32_more(const struct crc32 *crc, uint32_t before, const void *bytes, size_t size)
{
    const unsigned char *b = bytes;
    uint32_t c = ~before;
    for (; size >= 8; size -= 8, b += 8) {
        uint32_t low = c ^ ((uint32_t)b[0] | (uint32_t)b[1] << 8 | (uint32_t)b[2] << 16 | (uint32_t)b[3] << 24);
        c = crc->table[7][low & 255] ^ crc->table[6][low >> 8 & 255] ^ crc->table[5][low >> 16 & 255] ^
            crc->table[4][low >> 24] ^ crc->table[3][b[4]] ^ crc->table[2][b[5]] ^ crc->table[1][b[6]] ^
            crc->table[0][b[7]];
    }
    while (size--)
        c = (c >> 8) ^ crc->table[0][(c ^ *b++) & 255];
    return ~c;
}

/* The checksum of `size` bytes. */
static inline uint32_t crc32_of(const struct crc32 *crc, const void *bytes, size_t size)
{
    return crc32_more(crc, 0, bytes, size);
}

#endif
