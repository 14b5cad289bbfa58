/* SPDX-License-Identifier: BSD-3-Clause */
/* Which files were read: their length and the CRC-32 of their bytes, one behind the other. Begin with zeros. */
#ifndef DPT_SCENE_FILE_IDENTITY_H
#define DPT_SCENE_FILE_IDENTITY_H

#include <stddef.h>

#include "base/crc32.h"

struct file_identity {
    uint64_t bytes;
    uint32_t crc32;
};

/* One more. The bytes as they were read: a big-endian machine converts them. */
static inline void file_identity_add(struct file_identity *identity, const void *bytes, size_t size)
{
    struct crc32 crc;
    crc32_init(&crc);
    identity->crc32 = crc32_more(&crc, identity->crc32, bytes, size);
    identity->bytes += size;
}

#endif
