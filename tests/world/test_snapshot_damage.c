/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A snapshot that is cut, damaged or made up is refused by its code, and never leads a reader out of the block.
 *
 *     test_snapshot_damage [PER CENT]   of the random damage
 */
#include "lib/random.h"
#include "world/snapshot_scene.h"

static void read_everything(const unsigned char *from, size_t size)
{
    dpt_snapshot_info info = { .size = sizeof info };
    float xyz[30];
    dpt_snapshot_get_info(from, size, &info);
    for (uint32_t i = 0; i < 8; i++) {
        dpt_snapshot_body body = { .size = sizeof body };
        dpt_snapshot_tool tool = { .size = sizeof tool };
        dpt_snapshot_segment segment = { .size = sizeof segment };
        dpt_snapshot_contact contact = { .size = sizeof contact };
        dpt_snapshot_strip strip = { .size = sizeof strip };
        dpt_snapshot_get_body(from, size, i, &body);
        dpt_snapshot_get_tool(from, size, i, &tool);
        dpt_snapshot_get_segment(from, size, i, &segment);
        dpt_snapshot_get_contact(from, size, i, &contact);
        dpt_snapshot_get_strip(from, size, i, &strip);
        dpt_snapshot_get_vertices(from, size, 10 * i, 10, xyz);
    }
}

static dpt_result verdict(const void *from, size_t size)
{
    dpt_snapshot_info info = { .size = sizeof info };
    return dpt_snapshot_get_info(from, size, &info);
}

static void put_word(unsigned char *to, uint32_t value)
{
    for (int i = 0; i < 4; i++)
        to[i] = (unsigned char)(value >> 8 * i);
}

/* One word of a good block is another: the code that it must earn. */
static void wrong_words_are_refused(void)
{
    struct scene scene;
    uint32_t count;
    scene_in_contact(&scene);
    take(&scene, NULL);
    const size_t tool = item(TOOLS, 0, &count), segment = item(SEGMENTS, 0, &count),
                 contact = item(CONTACTS, 0, &count), body = item(BODIES, 1, &count);
    const struct {
        const char *what;
        size_t at;
        uint32_t value;
        dpt_result code;
    } cases[] = {
        { "magic", 0, 0x20202020, DPT_E_MAGIC },
        { "newer", 8, 2, DPT_E_VERSION },
        { "no version", 8, 0, DPT_E_LAYOUT },
        { "short header", 12, 56, DPT_E_LAYOUT },
        { "odd header", 12, 65, DPT_E_LAYOUT },
        { "header beyond the end", 12, 1u << 30, DPT_E_LAYOUT },
        { "longer than it is", 16, (uint32_t)bytes + 8, DPT_E_TRUNCATED },
        { "shorter than its table", 16, 64, DPT_E_LAYOUT },
        { "too many sections", 44, 65, DPT_E_LAYOUT },
        { "no kind", 64, 0, DPT_E_LAYOUT },
        { "a kind twice", 64, 2, DPT_E_LAYOUT },
        { "count", 64 + 24 + 4, 0xffffffff, DPT_E_LAYOUT },
        { "stride", 64 + 24 + 8, 240, DPT_E_LAYOUT },
        { "huge stride", 64 + 24 + 8, 0xfffffff8, DPT_E_LAYOUT },
        { "offset in the table", 64 + 16, 64, DPT_E_LAYOUT },
        { "odd offset", 64 + 16, 212, DPT_E_LAYOUT },
        { "offset beyond the end", 64 + 20, 1, DPT_E_LAYOUT },
        { "segments", tool + 16, SEGMENT_COUNT, DPT_E_LAYOUT },
        { "contacts", tool + 28, 100000, DPT_E_LAYOUT },
        { "strips", tool + 32, 0xfffffffe, DPT_E_LAYOUT },
        { "nearest segment", tool + 40, 1, DPT_E_LAYOUT },
        { "tool of a segment", segment + 24, TOOL_COUNT, DPT_E_LAYOUT },
        { "tool of a contact", contact + 24, TOOL_COUNT, DPT_E_LAYOUT },
        { "vertices", body + 8, 0, DPT_E_LAYOUT },
    };
    CHECK(verdict(block, bytes) == DPT_OK, "a good one");
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        unsigned char kept[4];
        memcpy(kept, block + cases[i].at, 4);
        put_word(block + cases[i].at, cases[i].value);
        const dpt_result code = verdict(block, bytes);
        CHECK(code == cases[i].code, "%s: %s", cases[i].what, dpt_result_name(code));
        memcpy(block + cases[i].at, kept, 4);
    }
    put_word(block + 64, 77); /* a kind of a later release */
    CHECK(verdict(block, bytes) == DPT_OK, "a kind that is not known");
    scene_close(&scene);
}

/* Cut at each length, and a thousand times with bytes at random: nothing outside of the block is read. */
static void damage_harms_no_one(void)
{
    struct scene scene;
    uint64_t sound = 0;
    scene_in_contact(&scene);
    take(&scene, NULL);
    const size_t whole = bytes;
    for (size_t size = 0; size < whole; size += size < 300 ? 1 : 97) {
        unsigned char *cut = malloc(size ? size : 1);
        memcpy(cut, block, size);
        CHECK(verdict(cut, size) == DPT_E_TRUNCATED, "%zu of %zu bytes", size, whole);
        read_everything(cut, size);
        free(cut);
    }
    unsigned char *copy = malloc(whole);
    for (uint64_t i = 0; i < part_of(100000); i++) {
        memcpy(copy, block, whole);
        const uint32_t changes = 1 + (uint32_t)random_in(&seed, 0.0, 4.0);
        for (uint32_t k = 0; k < changes; k++) {
            const size_t region = random_in(&seed, 0.0, 1.0) < 0.7 ? 512 : whole;
            const size_t at = (size_t)random_in(&seed, 0.0, (double)region);
            copy[at] = (unsigned char)random_in(&seed, 0.0, 256.0);
        }
        sound += verdict(copy, whole) == DPT_OK;
        read_everything(copy, whole);
    }
    CHECK(sound >= least_seen(1000), "%llu sound", (unsigned long long)sound);
    free(copy);
    scene_close(&scene);
}

int main(int argc, char **argv)
{
    take_percent(argc, argv);
    TEST(wrong_words_are_refused);
    TEST(damage_harms_no_one);
    return check_report();
}
