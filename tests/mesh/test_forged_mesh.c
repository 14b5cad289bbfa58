/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Mesh files whose checksums are good and whose numbers are not: each word that could lead beyond the bytes is refused,
 * with the byte where it stands. A file that random forgery leaves openable is searched, and must not be read beyond
 * its end; the sanitizer judges that. Damage with wrong checksums is for test_mesh.
 *
 *     test_forged_mesh [PER CENT]   of the random forgeries
 */
#include <math.h>

#include "mesh/mesh_checks.h"

static void newer_versions_are_refused(void)
{
    const uint32_t versions[] = { MESH_VERSION + 1, MESH_VERSION + 2, 256, UINT32_MAX };
    for (int i = 0; i < 4; i++) {
        struct file file = copy_of(&small_file);
        memcpy(file.bytes + offsetof(struct dpt_mesh, version), &versions[i], 4);
        expect_fault(&file, DPT_E_VERSION, offsetof(struct dpt_mesh, version), "header");
        seal(&file);
        expect_fault(&file, DPT_E_VERSION, offsetof(struct dpt_mesh, version), "header");
        free(file.bytes);
    }
}

/* A word of a section set to a value, the checksums made good again. */
struct forgery {
    int section;
    int64_t word; /* from the end when negative */
    uint32_t value;
    dpt_result code;
    int64_t where; /* the word that is named, as `word` */
};

static uint32_t float_bits(float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

static uint64_t word_offset(const struct mesh_section *section, int64_t word)
{
    return section->offset + 4 * (uint64_t)word + (word < 0 ? section->bytes : 0);
}

/* The checksums made good, each is refused where it says, or opens. */
static void expect_forgeries(const struct file *whole, const struct forgery *forgeries, size_t count)
{
    const struct dpt_mesh header = header_of(whole);
    for (size_t i = 0; i < count; i++) {
        const struct forgery *forgery = &forgeries[i];
        const struct mesh_section *section = &header.section[forgery->section];
        struct file file = copy_of(whole);
        memcpy(file.bytes + word_offset(section, forgery->word), &forgery->value, 4);
        seal(&file);
        if (forgery->code == DPT_OK)
            CHECK(fault_of(&file).code == DPT_OK, "%s", section->name);
        else
            expect_fault(&file, forgery->code, word_offset(section, forgery->where), section->name);
        free(file.bytes);
    }
}

static void forged_words_are_refused(void)
{
    const struct dpt_mesh header = header_of(&large_file);
    const uint32_t t = header.triangles, v = header.vertices;
    const uint32_t nan = float_bits(NAN), inf = float_bits(-INFINITY);
    const dpt_result index = DPT_E_INDEX, finite = DPT_E_FINITE;
    const struct forgery forgeries[] = {
        { MESH_VERTICES, 0, nan, finite, 0 },
        { MESH_VERTICES, -1, inf, finite, -1 },
        { MESH_VERTICES, 7, float_bits(1000000.0625f), finite, 7 },
        { MESH_TRIANGLES, 5, v, index, 5 },
        { MESH_TRIANGLES, -1, UINT32_MAX, index, -1 },
        { MESH_NEIGHBOURS, 0, t, index, 0 },
        { MESH_NEIGHBOURS, -1, MESH_EDGE_MANY - 1, index, -1 },
        { MESH_NEIGHBOURS, 3, MESH_EDGE_MANY, DPT_OK, 0 },
        { MESH_NEIGHBOURS, 3, MESH_EDGE_OPEN, DPT_OK, 0 },
        { MESH_NEIGHBOURS, 3, t - 1, DPT_OK, 0 },
        { MESH_FAN_FIRST, 0, 1, index, 0 },
        { MESH_FAN_FIRST, 4, 0, index, 4 },
        { MESH_FAN_FIRST, 4, UINT32_MAX, index, 5 },
        { MESH_FAN_FIRST, -1, 3 * t - 1, index, -1 },
        { MESH_FAN_FIRST, -1, 3 * t + 1, index, -1 },
        { MESH_FANS, 9, t, index, 9 },
        { MESH_FANS, -1, UINT32_MAX, index, -1 },
        { MESH_PARTS, 8, header.parts, index, 8 },
        { MESH_PARTS, -1, UINT32_MAX, index, -1 },
        { MESH_SOURCES, 1, header.source_triangles, index, 1 },
        { MESH_SOURCES, -1, UINT32_MAX, index, -1 },
        { MESH_PLACES, 2, t, index, 2 },
        { MESH_PLACES, -1, MESH_DROPPED_DUPLICATE - 1, index, -1 },
        { MESH_PLACES, 0, MESH_DROPPED_DUPLICATE, index, 0 },
        { MESH_PLACES, 0, MESH_DROPPED_DEGENERATE, index, 0 },
        { MESH_BOXES, 0, nan, finite, 0 },
        { MESH_BOXES, -1, inf, finite, -1 },
        { MESH_LEAVES, 11, nan, finite, 11 },
        { MESH_LEAVES, -1, inf, finite, -1 },
        { MESH_NORMALS, 0, nan, finite, 0 },
        { MESH_NORMALS, -1, float_bits(-1.0000001f), finite, -1 },
        { MESH_NORMALS, 3, float_bits(-1.0f), DPT_OK, 0 },
        { MESH_FLAGS, 1, MESH_FLAGS_END, index, 1 },
        { MESH_FLAGS, -1, UINT32_MAX, index, -1 },
        { MESH_FLAGS, 2, MESH_FLAGS_END - 1, DPT_OK, 0 },
        { MESH_VERTEX_SOURCES, 0, header.source_vertices, index, 0 },
        { MESH_VERTEX_SOURCES, -1, UINT32_MAX, index, -1 },
        { MESH_VERTEX_SOURCES, 4, header.source_vertices - 1, DPT_OK, 0 },
    };
    expect_forgeries(&large_file, forgeries, sizeof forgeries / sizeof *forgeries);
    /* 39 triangles: three leaves, of which the last has 7. */
    const struct forgery of_moments[] = {
        { MESH_MOMENTS, 0, nan, finite, 0 },
        { MESH_MOMENTS, -4, inf, finite, -4 },
        { MESH_MOMENTS, 5, float_bits(1e31f), finite, 5 },
        { MESH_MOMENTS, 5, float_bits(-1e30f), DPT_OK, 0 },
        { MESH_MOMENTS, -3, 0x10000, index, -3 },
        { MESH_MOMENTS, -2, UINT32_MAX, index, -2 },
        { MESH_MOMENTS, -1, 0x80, index, -1 },
        { MESH_MOMENTS, -1, 0x7f, DPT_OK, 0 },
        { MESH_MOMENTS, -3, 0, DPT_OK, 0 },
    };
    expect_forgeries(&holed_file, of_moments, sizeof of_moments / sizeof *of_moments);
    /* 27 nodes; a wrong sum is told of its first weight. */
    const struct forgery of_embedding[] = {
        { MESH_EMBED_NODES, 0, 27, index, 0 },
        { MESH_EMBED_NODES, -1, UINT32_MAX, index, -1 },
        { MESH_EMBED_NODES, 7, 26, DPT_OK, 0 },
        { MESH_EMBED_WEIGHTS, 0, nan, finite, 0 },
        { MESH_EMBED_WEIGHTS, -1, inf, finite, -1 },
        { MESH_EMBED_WEIGHTS, 6, float_bits(128.01f), finite, 6 },
        { MESH_EMBED_WEIGHTS, 6, float_bits(-128.0f), finite, 4 },
        { MESH_EMBED_WEIGHTS, -2, float_bits(-1.0f), finite, -4 },
    };
    expect_forgeries(&embedded_file, of_embedding, sizeof of_embedding / sizeof *of_embedding);
    /* 22 nodes in two slices; what is allowed. */
    const struct forgery of_springs[] = {
        { MESH_SPRING_MASS, 0, nan, finite, 0 },
        { MESH_SPRING_MASS, -1, inf, finite, -1 },
        { MESH_SPRING_DRAG, 3, inf, finite, 3 },
        { MESH_SPRING_DRAG, -1, 0, DPT_OK, 0 },
        { MESH_SPRING_FIRST, 0, UINT32_MAX, index, 1 },
        { MESH_SPRING_FIRST, -1, UINT32_MAX, index, -1 },
        { MESH_SPRING_ENDS, 0, UINT32_MAX, index, 0 },
        { MESH_SPRING_ENDS, -1, UINT32_MAX, index, -1 },
        { MESH_SPRING_STIFFNESS, -1, 0x80000000, DPT_OK, 0 },
        { MESH_SPRING_STIFFNESS, 1, float_bits(2e15f), finite, 1 },
        { MESH_SPRING_LENGTH, 1, float_bits(-1.0f), finite, 1 },
    };
    expect_forgeries(&sheet_file, of_springs, sizeof of_springs / sizeof *of_springs);
}

/* A number of the header; `size` bytes of `value`, sealed. */
static dpt_result forge_header(size_t at, const void *value, size_t size)
{
    struct file file = copy_of(&large_file);
    memcpy(file.bytes + at, value, size);
    seal(&file);
    dpt_mesh_fault fault = fault_of(&file);
    free(file.bytes);
    return fault.code;
}

static void forged_headers_are_refused(void)
{
    /* None of these counts is free: each decides the length of a section, or the order of the tree.
     */
    const size_t counts[] = { AT(version),
                              AT(header_bytes),
                              AT(section_count),
                              AT(triangles),
                              AT(vertices),
                              AT(parts),
                              AT(leaves),
                              AT(levels),
                              AT(reserved),
                              AT(bytes),
                              AT(byte_order),
                              AT(source_triangles),
                              PLAIN_TAIL_AT(winding_components),
                              PLAIN_TAIL_AT(nodes),
                              PLAIN_TAIL_AT(spring_nodes),
                              PLAIN_TAIL_AT(springs),
                              PLAIN_TAIL_AT(spring_entries) };
    const uint32_t values[] = { 0, 1, 2, 599, 601, 0x7fffffff, 0x80000000, 0xfffffffe, UINT32_MAX };
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++)
        for (size_t k = 0; k < sizeof values / sizeof *values; k++) {
            if (memcmp(large_file.bytes + counts[i], &values[k], 4) == 0)
                continue;
            dpt_result result = forge_header(counts[i], &values[k], 4);
            CHECK(result != DPT_OK, "%u at %zu", values[k], counts[i]);
        }
    const size_t numbers[] = { AT(box_min),      AT(box_max) + 16, AT(filter_centre),
                               AT(filter_scale), AT(scale),        AT(rounding) };
    const double wrong[] = { NAN, INFINITY, -INFINITY, 1e301 };
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
        for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
            dpt_result result = forge_header(numbers[i], &wrong[k], sizeof wrong[k]);
            CHECK(result == DPT_E_FINITE, "%g at %zu: %d", wrong[k], numbers[i], result);
        }
    const double nothing = 0.0;
    CHECK(forge_header(AT(filter_scale), &nothing, sizeof nothing) == DPT_E_FINITE, "scale 0");
}

/* Nothing of the section table is free either, but for the sums; the fault names the section. */
static void forged_tables_are_refused(void)
{
    const struct dpt_mesh header = header_of(&large_file);
    const size_t entry = sizeof header.section[0], sum = offsetof(struct mesh_section, crc32);
    for (int id = 0; id < PLAIN_SECTIONS; id++)
        for (size_t at = 0; at < entry; at++) {
            if (at >= sum && at < sum + 4)
                continue;
            struct file file = copy_of(&large_file);
            file.bytes[AT(section) + (size_t)id * entry + at] ^= 0x40;
            seal_header(&file);
            expect_fault(&file, DPT_E_LAYOUT, AT(section) + (size_t)id * entry, header.section[id].name);
            free(file.bytes);
        }
}

/* Any word, any value, checksums made good: refused, or used without harm. */
static void random_forgeries_do_no_harm(void)
{
    uint64_t random = 1, opened = 0;
    const uint32_t odd[] = { 0,          1,          15,         16,         39,
                             40,         UINT32_MAX, 0x7f800000, 0xffc00000, 0x7149f2ca,
                             0x80000000, 0x00000001, 0x49742400, 0xfffffffe, 0x3f800000 };
    for (uint64_t i = 0; i < part_of(20000); i++) {
        struct file file = copy_of(i % 16 == 0  ? &large_file
                                   : i % 8 == 1 ? &embedded_file
                                   : i % 8 == 5 ? &sheet_file
                                   : i % 8 == 2 ? &volume_file
                                   : i % 4 == 3 ? &small_file
                                                : &holed_file);
        for (uint64_t words = 1 + random_bits(&random) % 3; words; words--) {
            size_t at = 4 * (size_t)(random_bits(&random) % (file.size / 4));
            uint32_t value = odd[random_bits(&random) % (sizeof odd / sizeof *odd)];
            if (random_bits(&random) % 4 == 0)
                value = (uint32_t)random_bits(&random);
            memcpy(file.bytes + at, &value, 4);
        }
        seal(&file);
        if (fault_of(&file).code == DPT_OK) {
            opened++;
            use_mesh((const dpt_mesh *)(const void *)file.bytes, &random);
        }
        free(file.bytes);
    }
    CHECK(opened > part_of(1000), "only %llu opened: the test tests little", (unsigned long long)opened);
}

int main(int argc, char **argv)
{
    take_percent(argc, argv);
    if (!open_files())
        return 1;
    TEST(newer_versions_are_refused);
    TEST(forged_words_are_refused);
    TEST(forged_headers_are_refused);
    TEST(forged_tables_are_refused);
    TEST(random_forgeries_do_no_harm);
    free_files();
    return check_report();
}
