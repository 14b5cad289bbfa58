/* SPDX-License-Identifier: BSD-3-Clause */
/* The layout of a snapshot (snapshot.h, docs/format.md), little-endian on every machine. */
#ifndef DPT_SNAPSHOT_FORMAT_H
#define DPT_SNAPSHOT_FORMAT_H

#include <stddef.h>

#include "dynpoint/snapshot.h"

enum { SNAPSHOT_VERSION = 1, SNAPSHOT_SECTIONS_MAX = 64 };

/* Offsets in the header, and its length. */
enum {
    SNAPSHOT_AT_VERSION = 8,
    SNAPSHOT_AT_HEADER_BYTES = 12,
    SNAPSHOT_AT_BYTES = 16,
    SNAPSHOT_AT_STEPS = 24,
    SNAPSHOT_AT_TIME = 32,
    SNAPSHOT_AT_FLAGS = 40,
    SNAPSHOT_AT_SECTIONS = 44,
    SNAPSHOT_AT_WORK = 48,
    SNAPSHOT_HEADER_BYTES = 64
};

/* Offsets in an entry of the table of sections, and its length. */
enum {
    SNAPSHOT_AT_KIND = 0,
    SNAPSHOT_AT_COUNT = 4,
    SNAPSHOT_AT_STRIDE = 8,
    SNAPSHOT_AT_OFFSET = 16,
    SNAPSHOT_ENTRY_BYTES = 24
};

enum snapshot_kind {
    SNAPSHOT_BODIES = 1,
    SNAPSHOT_TOOLS,
    SNAPSHOT_SEGMENTS,
    SNAPSHOT_CONTACTS,
    SNAPSHOT_STRIPS,
    SNAPSHOT_VERTICES,
    SNAPSHOT_CHANNELS,
    SNAPSHOT_KINDS_END
};

/* Bytes of an item of a kind, and in the first snapshots. */
static const uint32_t snapshot_stride[SNAPSHOT_KINDS_END] = { 0, 80, 304, 224, 144, 32, 12, 128 };
static const uint32_t snapshot_first_stride[SNAPSHOT_KINDS_END] = { 0, 80, 248, 224, 144, 32, 12, 128 };

static inline void snapshot_put4(unsigned char *to, uint32_t value)
{
    for (uint32_t i = 0; i < 4; i++)
        to[i] = (unsigned char)(value >> 8 * i);
}

static inline void snapshot_put8(unsigned char *to, uint64_t value)
{
    for (uint32_t i = 0; i < 8; i++)
        to[i] = (unsigned char)(value >> 8 * i);
}

/* Write the magic number and the version. */
void dpti_snapshot_put_magic(unsigned char *to);

/* Write one item of any kind but vertices: a struct of snapshot.h, from its second field on. */
void dpti_snapshot_put_item(enum snapshot_kind kind, const void *item, unsigned char *to);

/* Write vertices: 3 floats each. */
void dpti_snapshot_put_vertices(const float *xyz, size_t count, unsigned char *to);

#endif
