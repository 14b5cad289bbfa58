/* SPDX-License-Identifier: BSD-3-Clause */
/* Nothing is converted in place, so neither alignment nor byte order of the host matters. */
#include "exchange/snapshot_format.h"

#include "base/byte_order.h"
#include "base/return_if_error.h"
#include "base/sized.h"

/* Not text, and damaged by any transfer as text, as in a mesh's file. */
static const unsigned char magic[8] = { 0x89, 'D', 'P', 'S', 0x0d, 0x0a, 0x1a, 0x0a };

/*
 * An item's words: some of 4 bytes, then some of 8. They are fields of the struct in its order, without `size` and
 * without the one before the first wide field, which only aligns that.
 */
struct words {
    uint32_t at, count; /* at: in the struct */
};
static const struct {
    uint32_t first; /* bytes of the struct in the first release */
    uint32_t bytes; /* and today */
    struct words narrow, wide;
} items[SNAPSHOT_KINDS_END] = {
    { 0, 0, { 0, 0 }, { 0, 0 } },
    { sizeof(dpt_snapshot_body),
      sizeof(dpt_snapshot_body),
      { offsetof(dpt_snapshot_body, id), 4 },
      { offsetof(dpt_snapshot_body, user), 8 } },
    { offsetof(dpt_snapshot_tool, end),
      sizeof(dpt_snapshot_tool),
      { offsetof(dpt_snapshot_tool, id), 12 },
      { offsetof(dpt_snapshot_tool, user), 32 } },
    { sizeof(dpt_snapshot_segment),
      sizeof(dpt_snapshot_segment),
      { offsetof(dpt_snapshot_segment, status), 8 },
      { offsetof(dpt_snapshot_segment, a), 24 } },
    { sizeof(dpt_snapshot_contact),
      sizeof(dpt_snapshot_contact),
      { offsetof(dpt_snapshot_contact, id), 8 },
      { offsetof(dpt_snapshot_contact, s0), 14 } },
    { sizeof(dpt_snapshot_strip),
      sizeof(dpt_snapshot_strip),
      { offsetof(dpt_snapshot_strip, triangle), 4 },
      { offsetof(dpt_snapshot_strip, gap), 2 } },
    { 0, 0, { 0, 0 }, { 0, 0 } },
    { sizeof(dpt_snapshot_channel),
      sizeof(dpt_snapshot_channel),
      { offsetof(dpt_snapshot_channel, id), 8 },
      { offsetof(dpt_snapshot_channel, entry), 12 } },
};

static uint32_t get4(const unsigned char *from)
{
    uint32_t value = 0;
    for (uint32_t i = 0; i < 4; i++)
        value |= (uint32_t)from[i] << 8 * i;
    return value;
}

static uint64_t get8(const unsigned char *from)
{
    return get4(from) | (uint64_t)get4(from + 4) << 32;
}

void dpti_snapshot_put_magic(unsigned char *to)
{
    memcpy(to, magic, sizeof magic);
    snapshot_put4(to + SNAPSHOT_AT_VERSION, SNAPSHOT_VERSION);
}

void dpti_snapshot_put_item(enum snapshot_kind kind, const void *item, unsigned char *to)
{
    const unsigned char *narrow = (const unsigned char *)item + items[kind].narrow.at;
    const unsigned char *wide = (const unsigned char *)item + items[kind].wide.at;
    for (uint32_t i = 0; i < items[kind].narrow.count; i++, to += 4) {
        uint32_t word;
        memcpy(&word, narrow + 4 * i, sizeof word);
        snapshot_put4(to, word);
    }
    for (uint32_t i = 0; i < items[kind].wide.count; i++, to += 8) {
        uint64_t word;
        memcpy(&word, wide + 8 * i, sizeof word);
        snapshot_put8(to, word);
    }
}

void dpti_snapshot_put_vertices(const float *xyz, size_t count, unsigned char *to)
{
    if (host_is_little()) {
        memcpy(to, xyz, 3 * count * sizeof *xyz);
        return;
    }
    for (size_t i = 0; i < 3 * count; i++) {
        uint32_t word;
        memcpy(&word, xyz + i, sizeof word);
        snapshot_put4(to + 4 * i, word);
    }
}

/* An item of `stride` bytes: a short one lacks the last fields. */
static void get_item(enum snapshot_kind kind, const unsigned char *from, uint32_t stride, unsigned char *item)
{
    const uint32_t there = (stride - 4 * items[kind].narrow.count) / 8;
    const uint32_t wide = there < items[kind].wide.count ? there : items[kind].wide.count;
    for (uint32_t i = 0; i < items[kind].narrow.count; i++, from += 4) {
        const uint32_t word = get4(from);
        memcpy(item + items[kind].narrow.at + 4 * i, &word, sizeof word);
    }
    for (uint32_t i = 0; i < wide; i++, from += 8) {
        const uint64_t word = get8(from);
        memcpy(item + items[kind].wide.at + 8 * i, &word, sizeof word);
    }
}

/* A block whose header and table hold together. */
struct block {
    const unsigned char *bytes;
    struct {
        uint32_t count, stride;
        uint64_t offset;
    } section[SNAPSHOT_KINDS_END];
};

static dpt_result open_section(const unsigned char *entry, uint64_t begin, uint64_t end, struct block *block)
{
    const uint32_t kind = get4(entry + SNAPSHOT_AT_KIND);
    const uint32_t count = get4(entry + SNAPSHOT_AT_COUNT), stride = get4(entry + SNAPSHOT_AT_STRIDE);
    const uint64_t offset = get8(entry + SNAPSHOT_AT_OFFSET);
    if (offset < begin || offset > end || offset % 8 != 0 || (uint64_t)count * stride > end - offset)
        return DPT_E_LAYOUT;
    if (kind == 0 || kind >= SNAPSHOT_KINDS_END)
        return kind ? DPT_OK : DPT_E_LAYOUT;
    if (stride < snapshot_first_stride[kind] || block->section[kind].stride)
        return DPT_E_LAYOUT;
    block->section[kind].count = count;
    block->section[kind].stride = stride;
    block->section[kind].offset = offset;
    return DPT_OK;
}

static dpt_result open_block(const void *bytes, size_t size, struct block *block)
{
    const unsigned char *from = bytes;
    *block = (struct block){ .bytes = from };
    if (!bytes)
        return DPT_E_ARGUMENT;
    if (memcmp(from, magic, size < sizeof magic ? size : sizeof magic) != 0)
        return DPT_E_MAGIC;
    if (size < SNAPSHOT_HEADER_BYTES)
        return DPT_E_TRUNCATED;
    if (get4(from + SNAPSHOT_AT_VERSION) > SNAPSHOT_VERSION)
        return DPT_E_VERSION;
    const uint64_t header = get4(from + SNAPSHOT_AT_HEADER_BYTES), whole = get8(from + SNAPSHOT_AT_BYTES);
    const uint32_t sections = get4(from + SNAPSHOT_AT_SECTIONS);
    const uint64_t begin = header + (uint64_t)sections * SNAPSHOT_ENTRY_BYTES;
    if (get4(from + SNAPSHOT_AT_VERSION) != SNAPSHOT_VERSION || header < SNAPSHOT_HEADER_BYTES || header % 8 != 0 ||
        sections > SNAPSHOT_SECTIONS_MAX || whole % 8 != 0 || begin > whole)
        return DPT_E_LAYOUT;
    if (size < whole)
        return DPT_E_TRUNCATED;
    for (uint32_t i = 0; i < sections; i++)
        DPT_TRY(open_section(from + header + (uint64_t)i * SNAPSHOT_ENTRY_BYTES, begin, whole, block));
    return DPT_OK;
}

static const unsigned char *item_at(const struct block *block, enum snapshot_kind kind, uint32_t index)
{
    return block->bytes + block->section[kind].offset + (uint64_t)index * block->section[kind].stride;
}

static void read_item(const struct block *block, enum snapshot_kind kind, uint32_t index, void *item)
{
    const uint32_t stride = block->section[kind].stride;
    get_item(kind, item_at(block, kind, index), stride, (unsigned char *)item);
    if (kind == SNAPSHOT_TOOLS && stride < snapshot_stride[kind]) {
        dpt_snapshot_tool *tool = item;
        tool->end = tool->proxy;
    }
}

/* 1 if `count` items of a kind from `first` on are there. */
static int are_there(const struct block *block, enum snapshot_kind kind, uint32_t first, uint32_t count)
{
    return (uint64_t)first + count <= block->section[kind].count;
}

/* 1 if what the items say of each other is so. */
static int holds_together(const struct block *block)
{
    for (uint32_t i = 0; i < block->section[SNAPSHOT_BODIES].count; i++) {
        dpt_snapshot_body body;
        read_item(block, SNAPSHOT_BODIES, i, &body);
        if (body.first_vertex != DPT_NONE && !are_there(block, SNAPSHOT_VERTICES, body.first_vertex, body.vertices))
            return 0;
    }
    for (uint32_t i = 0; i < block->section[SNAPSHOT_TOOLS].count; i++) {
        dpt_snapshot_tool tool;
        read_item(block, SNAPSHOT_TOOLS, i, &tool);
        if (!are_there(block, SNAPSHOT_SEGMENTS, tool.first_segment, tool.segments) ||
            !are_there(block, SNAPSHOT_CONTACTS, tool.first_contact, tool.contacts) ||
            !are_there(block, SNAPSHOT_STRIPS, tool.first_strip, tool.strip) || tool.nearest_segment >= tool.segments)
            return 0;
    }
    for (uint32_t i = 0; i < block->section[SNAPSHOT_SEGMENTS].count; i++) {
        dpt_snapshot_segment segment;
        read_item(block, SNAPSHOT_SEGMENTS, i, &segment);
        if (segment.tool >= block->section[SNAPSHOT_TOOLS].count)
            return 0;
    }
    for (uint32_t i = 0; i < block->section[SNAPSHOT_CONTACTS].count; i++) {
        dpt_snapshot_contact contact;
        read_item(block, SNAPSHOT_CONTACTS, i, &contact);
        if (contact.tool >= block->section[SNAPSHOT_TOOLS].count)
            return 0;
    }
    for (uint32_t i = 0; i < block->section[SNAPSHOT_CHANNELS].count; i++) {
        dpt_snapshot_channel channel;
        read_item(block, SNAPSHOT_CHANNELS, i, &channel);
        if (channel.tool >= block->section[SNAPSHOT_TOOLS].count)
            return 0;
    }
    return 1;
}

dpt_result dpt_snapshot_get_info(const void *bytes, size_t size, dpt_snapshot_info *info)
{
    struct block block;
    if (!info)
        return DPT_E_ARGUMENT;
    dpt_snapshot_info found = { .size = sizeof found };
    DPT_TRY(sized_check(info, SIZED_FIRST(dpt_snapshot_info, channels), 0));
    sized_write(info, info->size, &found, sizeof found);
    DPT_TRY(open_block(bytes, size, &block));
    if (!holds_together(&block))
        return DPT_E_LAYOUT;
    const uint64_t time = get8(block.bytes + SNAPSHOT_AT_TIME);
    memcpy(&found.time, &time, sizeof time);
    found.version = get4(block.bytes + SNAPSHOT_AT_VERSION);
    found.flags = get4(block.bytes + SNAPSHOT_AT_FLAGS);
    found.work = get4(block.bytes + SNAPSHOT_AT_WORK);
    found.steps = get8(block.bytes + SNAPSHOT_AT_STEPS);
    found.bodies = block.section[SNAPSHOT_BODIES].count;
    found.tools = block.section[SNAPSHOT_TOOLS].count;
    found.segments = block.section[SNAPSHOT_SEGMENTS].count;
    found.contacts = block.section[SNAPSHOT_CONTACTS].count;
    found.strip = block.section[SNAPSHOT_STRIPS].count;
    found.vertices = block.section[SNAPSHOT_VERTICES].count;
    found.channels = block.section[SNAPSHOT_CHANNELS].count;
    sized_write(info, info->size, &found, sizeof found);
    return DPT_OK;
}

/* The body of the getters. `item` is zeros of the struct's size. */
static dpt_result get(const void *bytes, size_t size, enum snapshot_kind kind, uint32_t index, void *item, void *out)
{
    struct block block;
    if (!out)
        return DPT_E_ARGUMENT;
    DPT_TRY(sized_check(out, items[kind].first, 0));
    sized_write(out, sized_of(out), item, items[kind].bytes);
    DPT_TRY(open_block(bytes, size, &block));
    if (!are_there(&block, kind, index, 1))
        return DPT_E_ARGUMENT;
    read_item(&block, kind, index, item);
    sized_write(out, sized_of(out), item, items[kind].bytes);
    return DPT_OK;
}

dpt_result dpt_snapshot_get_body(const void *block, size_t bytes, uint32_t index, dpt_snapshot_body *body)
{
    dpt_snapshot_body item = { .size = sizeof item };
    return get(block, bytes, SNAPSHOT_BODIES, index, &item, body);
}

dpt_result dpt_snapshot_get_tool(const void *block, size_t bytes, uint32_t index, dpt_snapshot_tool *tool)
{
    dpt_snapshot_tool item = { .size = sizeof item };
    return get(block, bytes, SNAPSHOT_TOOLS, index, &item, tool);
}

dpt_result dpt_snapshot_get_segment(const void *block, size_t bytes, uint32_t index, dpt_snapshot_segment *segment)
{
    dpt_snapshot_segment item = { .size = sizeof item };
    return get(block, bytes, SNAPSHOT_SEGMENTS, index, &item, segment);
}

dpt_result dpt_snapshot_get_contact(const void *block, size_t bytes, uint32_t index, dpt_snapshot_contact *contact)
{
    dpt_snapshot_contact item = { .size = sizeof item };
    return get(block, bytes, SNAPSHOT_CONTACTS, index, &item, contact);
}

dpt_result dpt_snapshot_get_strip(const void *block, size_t bytes, uint32_t index, dpt_snapshot_strip *strip)
{
    dpt_snapshot_strip item = { .size = sizeof item };
    return get(block, bytes, SNAPSHOT_STRIPS, index, &item, strip);
}

dpt_result dpt_snapshot_get_channel(const void *block, size_t bytes, uint32_t index, dpt_snapshot_channel *channel)
{
    dpt_snapshot_channel item = { .size = sizeof item };
    return get(block, bytes, SNAPSHOT_CHANNELS, index, &item, channel);
}

dpt_result dpt_snapshot_get_vertices(const void *bytes, size_t size, uint32_t first, uint32_t count, float *xyz)
{
    struct block block;
    if (!xyz)
        return DPT_E_ARGUMENT;
    DPT_TRY(open_block(bytes, size, &block));
    if (!are_there(&block, SNAPSHOT_VERTICES, first, count))
        return DPT_E_ARGUMENT;
    for (uint32_t i = 0; i < count; i++)
        for (uint32_t k = 0; k < 3; k++) {
            const uint32_t word = get4(item_at(&block, SNAPSHOT_VERTICES, first + i) + 4 * k);
            memcpy(xyz + 3 * (size_t)i + k, &word, sizeof word);
        }
    return DPT_OK;
}
