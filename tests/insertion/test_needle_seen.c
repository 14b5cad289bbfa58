/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Channels in snapshots: each number stands where docs/format.md says, with the value that dpt_tool_get_channels gives;
 * the reader finds the same; a world without room for channels has no section of them.
 */
#include "insertion/needle_rig.h"

#include "dynpoint/snapshot.h"
#include "lib/size_checks.h"

enum { KIND = 7, ITEM_BYTES = 128, ROOM = 1 << 16, ENTRY_BYTES = 24, HEADER_BYTES = 64 };

static unsigned char block[ROOM];
static size_t bytes;

static uint32_t word(size_t at)
{
    return (uint32_t)block[at] | (uint32_t)block[at + 1] << 8 | (uint32_t)block[at + 2] << 16 |
           (uint32_t)block[at + 3] << 24;
}

static int are(size_t at, const double *values, uint32_t count)
{
    int same = 1;
    for (uint32_t i = 0; i < count; i++) {
        const uint64_t bits = word(at + 8 * (size_t)i) | (uint64_t)word(at + 8 * (size_t)i + 4) << 32;
        same &= !memcmp(&bits, values + i, sizeof bits);
    }
    return same;
}

static void take(const struct needle_rig *needle)
{
    CHECK(dpt_world_take_snapshot(needle->rig.world, NULL, block, sizeof block, &bytes) == DPT_OK, "a snapshot");
    CHECK(bytes <= dpt_snapshot_bytes(needle->rig.world, NULL), "%zu bytes", bytes);
}

/* Where the table's entry of channels is; 0: there is none. */
static size_t section(void)
{
    for (uint32_t i = 0; i < word(44); i++)
        if (word(HEADER_BYTES + ENTRY_BYTES * i) == KIND)
            return HEADER_BYTES + ENTRY_BYTES * (size_t)i;
    return 0;
}

static void compare(const struct needle_rig *needle, uint32_t wanted)
{
    dpt_channel channels[4];
    const uint32_t count = needle_channels(needle, channels, 4);
    dpt_snapshot_info info = { .size = sizeof info };
    take(needle);
    const size_t entry = section(), first = entry ? word(entry + 16) : 0;
    CHECK(entry && count == wanted && word(entry + 4) == count && word(entry + 8) == ITEM_BYTES,
          "%u channels, %u in the snapshot, not %u", count, entry ? word(entry + 4) : 0, wanted);
    CHECK(dpt_snapshot_get_info(block, bytes, &info) == DPT_OK && info.channels == count, "%u told", info.channels);
    for (uint32_t i = 0; i < count && i < wanted; i++) {
        const dpt_channel *channel = &channels[i];
        const double numbers[6] = { NEEDLE_RADIUS,   channel->depth,    channel->deepest,
                                    channel->inside, channel->friction, channel->tip };
        const size_t at = first + i * ITEM_BYTES;
        dpt_snapshot_channel read = { .size = sizeof read };
        CHECK(word(at) == channel->id && word(at + 4) == channel->body && word(at + 8) == channel->triangle &&
                  word(at + 12) == channel->flags && word(at + 16) == channel->ruptures &&
                  word(at + 20) == channel->layers && word(at + 24) == 0 && word(at + 28) == 0,
              "words of channel %u", i);
        CHECK(are(at + 32, channel->entry, 3) && are(at + 56, channel->axis, 3) && are(at + 80, numbers, 6),
              "numbers of channel %u", i);
        CHECK(dpt_snapshot_get_channel(block, bytes, i, &read) == DPT_OK && read.id == channel->id &&
                  read.layers == channel->layers && read.tool == 0 &&
                  !memcmp(read.entry, channel->entry, sizeof read.entry) && read.radius == NEEDLE_RADIUS &&
                  read.tip == channel->tip && read.inside == channel->inside,
              "channel %u is read otherwise", i);
    }
    dpt_snapshot_channel none = { .size = sizeof none };
    CHECK(dpt_snapshot_get_channel(block, bytes, count, &none) == DPT_E_ARGUMENT && none.id == 0, "one too many");
}

static void a_needle_is_seen_in_and_out(void)
{
    struct needle_rig needle;
    const dpt_body_settings gel = needle_gel();
    needle_open(&needle, &gel, 4);
    compare(&needle, 0);
    needle_go(&needle, 0.04, 0.05);
    compare(&needle, 1);
    dpt_channel channel = needle_channel(&needle);
    CHECK(channel.layers == 1 && channel.depth > 0.03 && fabs(channel.inside - channel.depth) < 1e-9, "%u layers",
          channel.layers);
    needle_go(&needle, -0.02, 0.05);
    compare(&needle, 1);
    channel = needle_channel(&needle);
    CHECK(channel.flags == 0 && channel.layers == 0 && channel.deepest > 0.03, "the hole is left: %u", channel.flags);
    needle.at[0] += 0.01;
    needle_go(&needle, -0.021, 0.05);
    needle_go(&needle, 0.03, 0.05);
    compare(&needle, 2);
    needle_close(&needle);
}

static dpt_result channel_out(void *out)
{
    return dpt_snapshot_get_channel(block, bytes, 0, out);
}

static void the_struct_is_filled_as_far_as_it_goes(void)
{
    static const struct sized out = { "dpt_snapshot_channel", sizeof(dpt_snapshot_channel),
                                      sizeof(dpt_snapshot_channel), channel_out };
    check_output(&out);
}

static void a_tool_that_is_not_there_is_refused(void)
{
    dpt_snapshot_info info = { .size = sizeof info };
    block[word(section() + 16) + 24] = 1;
    CHECK(dpt_snapshot_get_info(block, bytes, &info) == DPT_E_LAYOUT, "a channel of another tool");
}

static void without_room_there_is_no_section(void)
{
    struct needle_rig needle;
    needle_open(&needle, NULL, 0);
    needle_go(&needle, 0.002, 0.05);
    take(&needle);
    CHECK(!section() && word(44) == KIND - 1, "%u sections", word(44));
    needle_close(&needle);
}

int main(void)
{
    TEST(a_needle_is_seen_in_and_out);
    TEST(the_struct_is_filled_as_far_as_it_goes);
    TEST(a_tool_that_is_not_there_is_refused);
    TEST(without_room_there_is_no_section);
    return check_report();
}
