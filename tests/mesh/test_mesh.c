/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Compiled meshes: what is whole opens, and nothing else does; no damage, however made, is read
 * beyond the bytes.
 *
 *     test_mesh [GOLDEN]
 *
 * GOLDEN is the folder golden; from the top of the tree it is found without. Its files were made by
 *
 *     build/dynpoint make torus 96 -o tests/golden/torus.ply
 *     build/dynpoint compile tests/golden/torus.ply -o tests/golden/torus_4.dpa
 *
 * torus.dpa, torus_2.dpa and torus_3.dpa by compilers of versions 1 to 3. They are to be kept: a new format gets a new file beside them,
 * for every version must always open.
 *
 * All tests start from a file in the host's byte order, and so hold on every machine.
 */
#define _GNU_SOURCE
#include <math.h>
#include <sys/mman.h>

#include "contact/winding_number.h"
#include "lib/dpa.h"

static const char *golden = "tests/golden";

static struct file small, large; /* one level of boxes, and two */
static struct file holed;        /* solid with a defect: has moments */

static dpt_mesh_fault verified(const struct file *file)
{
    dpt_mesh_fault fault = { .size = sizeof fault };
    dpt_result result = dpt_mesh_verify(file->bytes, file->size, &fault);
    CHECK(fault.code == result, "the fault says %d, verify %d", fault.code, result);
    CHECK(memchr(fault.section, 0, sizeof fault.section) != NULL, "section has no end");
    return fault;
}

/* What verify says; open must agree, and leave its output alone unless all is well. */
static dpt_mesh_fault fault_of(const struct file *file)
{
    const dpt_mesh *untouched = (const dpt_mesh *)(const void *)&golden, *mesh = untouched;
    dpt_mesh_fault fault = verified(file);
    dpt_result opened = dpt_mesh_open(file->bytes, file->size, &mesh);
    CHECK(opened == fault.code, "open %d, verify %d", opened, fault.code);
    CHECK(mesh == (opened == DPT_OK ? (const void *)file->bytes : (const void *)untouched),
          "%d, and the output is changed", opened);
    return fault;
}

static void expect_fault(const struct file *file, dpt_result code, uint64_t byte,
                         const char *section)
{
    dpt_mesh_fault fault = fault_of(file);
    CHECK(fault.code == code && fault.byte == byte && !strcmp(fault.section, section),
          "%s at %llu (%s), not %s at %llu (%s)", dpt_result_name(fault.code),
          (unsigned long long)fault.byte, fault.section, dpt_result_name(code),
          (unsigned long long)byte, section);
}

static void whole_files_open(void)
{
    const struct file *files[] = { &small, &large };
    for (int i = 0; i < 2; i++) {
        struct dpt_mesh header = header_of(files[i]);
        const dpt_mesh *mesh = (const dpt_mesh *)(const void *)files[i]->bytes;
        dpt_mesh_info info = { .size = sizeof info };
        dpt_mesh_section section = { .size = sizeof section };
        uint32_t id = 0;
        CHECK(fault_of(files[i]).code == DPT_OK, "file %d", i);
        CHECK(dpt_mesh_get_info(mesh, &info) == DPT_OK, "file %d", i);
        CHECK(info.bytes == files[i]->size && info.triangles == (i ? 600 : 40) &&
                  info.tree_levels == 1u + (uint32_t)i && info.format_version == MESH_VERSION,
              "%u triangles, %u levels", info.triangles, info.tree_levels);
        for (; dpt_mesh_get_section(mesh, id, &section) == DPT_OK; id++) {
            CHECK(section.offset == header.section[id].offset && section.offset % 64 == 0 &&
                      section.bytes == header.section[id].bytes,
                  "section %u", id);
            CHECK(section.crc32 == crc_of(files[i]->bytes + section.offset, (size_t)section.bytes),
                  "%s", section.name);
        }
        CHECK(id == MESH_SECTION_COUNT, "%u sections", id);
    }
}

/* Each length that is too short; a file in the other byte order is cut short likewise. */
static void truncations_are_refused(void)
{
    const struct file *files[] = { &small, &large, &holed };
    for (int i = 0; i < 3; i++)
        for (size_t size = 0; size < files[i]->size; size++) {
            struct file cut = file_of(files[i]->bytes, size);
            expect_fault(&cut, DPT_E_TRUNCATED, size, "header");
            CHECK(dpt_mesh_convert(cut.bytes, size, NULL) == DPT_E_TRUNCATED, "%zu bytes", size);
            CHECK(!memcmp(cut.bytes, files[i]->bytes, size), "convert changed %zu bytes", size);
            free(cut.bytes);
        }
}

static void trailing_bytes_are_refused(void)
{
    for (size_t more = 1; more < 200; more += 63) {
        struct file file = { calloc(1, small.size + more), small.size + more };
        memcpy(file.bytes, small.bytes, small.size);
        expect_fault(&file, DPT_E_TRAILING, small.size, "header");
        free(file.bytes);
    }
}

/* One byte, told apart by where it lies: the checksum of its section catches it, or the padding
 * does. */
static void expect_byte_fault(const struct file *file, const struct dpt_mesh *header, size_t at)
{
    dpt_mesh_fault fault = verified(file);
    int id = section_at(header, at);
    if (id == MESH_SECTION_COUNT) {
        CHECK(fault.code != DPT_OK && !strcmp(fault.section, "header"), "byte %zu: %s in %s", at,
              dpt_result_name(fault.code), fault.section);
        CHECK(at >= 8 || fault.code == DPT_E_MAGIC, "byte %zu: %s", at,
              dpt_result_name(fault.code));
        return;
    }
    dpt_result code = id < 0 ? DPT_E_LAYOUT : DPT_E_CHECKSUM;
    uint64_t byte = id < 0 ? at : header->section[id].offset;
    CHECK(fault.code == code && fault.byte == byte &&
              !strcmp(fault.section, section_name_at(header, at)),
          "byte %zu: %s at %llu (%s)", at, dpt_result_name(fault.code),
          (unsigned long long)fault.byte, fault.section);
}

static void changed_bytes_are_refused(void)
{
    const struct file *files[] = { &small, &large, &holed };
    for (int i = 0; i < 3; i++) {
        struct dpt_mesh header = header_of(files[i]);
        struct file file = copy_of(files[i]);
        for (size_t at = 0; at < file.size; at++)
            for (int bit = 0; bit < 8; bit += 7) {
                if (i == 1 && (at % 2 == 0) == (bit == 0))
                    continue; /* each byte of the large one once, for time */
                file.bytes[at] ^= (unsigned char)(1 << bit);
                expect_byte_fault(&file, &header, at);
                file.bytes[at] ^= (unsigned char)(1 << bit);
            }
        free(file.bytes);
    }
}

/* Damage of transfers in text mode, and files of another kind. */
static void other_files_are_refused(void)
{
    static const unsigned char texts[][16] = {
        "\x89"
        "DPA\r\r\n\x1a\r\n\0\0\0\0\0",
        "\x89"
        "DPA\n\x1a\n\0\0\0\0\0\0\0\0",
        "\x89"
        "DPA\r\x1a\r\0\0\0\0\0\0\0\0",
        "\x09"
        "DPA\r\n\x1a\n\0\0\0\0\0\0\0",
        "\x89"
        "PNG\r\n\x1a\n\0\0\0\0\0\0\0",
        "ply\nformat ascii",
    };
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        struct file file = copy_of(&small);
        memcpy(file.bytes, texts[i], sizeof texts[i]);
        expect_fault(&file, DPT_E_MAGIC, 0, "header");
        CHECK(dpt_mesh_convert(file.bytes, file.size, NULL) == DPT_E_MAGIC, "text %zu", i);
        free(file.bytes);
    }
    /* All of a file, each LF made CR LF. */
    struct file file = { malloc(2 * small.size), 0 };
    for (size_t i = 0; i < small.size; i++) {
        if (small.bytes[i] == '\n')
            file.bytes[file.size++] = '\r';
        file.bytes[file.size++] = small.bytes[i];
    }
    expect_fault(&file, DPT_E_MAGIC, 0, "header");
    free(file.bytes);
}

static void newer_versions_are_refused(void)
{
    const uint32_t versions[] = { MESH_VERSION + 1, MESH_VERSION + 2, 256, UINT32_MAX };
    for (int i = 0; i < 4; i++) {
        struct file file = copy_of(&small);
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
static void expect_forgeries(const struct file *whole, const struct forgery *forgeries,
                             size_t count)
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
    const struct dpt_mesh header = header_of(&large);
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
    };
    expect_forgeries(&large, forgeries, sizeof forgeries / sizeof *forgeries);
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
    expect_forgeries(&holed, of_moments, sizeof of_moments / sizeof *of_moments);
}

/* A number of the header; `size` bytes of `value`, sealed. */
static dpt_result forge_header(size_t at, const void *value, size_t size)
{
    struct file file = copy_of(&large);
    memcpy(file.bytes + at, value, size);
    seal(&file);
    dpt_mesh_fault fault = fault_of(&file);
    free(file.bytes);
    return fault.code;
}

#define AT(field) offsetof(struct dpt_mesh, field)

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
                              AT(tail.winding_components) };
    const uint32_t values[] = { 0, 1, 2, 599, 601, 0x7fffffff, 0x80000000, 0xfffffffe, UINT32_MAX };
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++)
        for (size_t k = 0; k < sizeof values / sizeof *values; k++) {
            if (memcmp(large.bytes + counts[i], &values[k], 4) == 0)
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
    const struct dpt_mesh header = header_of(&large);
    const size_t entry = sizeof header.section[0], sum = offsetof(struct mesh_section, crc32);
    for (int id = 0; id < MESH_SECTION_COUNT; id++)
        for (size_t at = 0; at < entry; at++) {
            if (at >= sum && at < sum + 4)
                continue;
            struct file file = copy_of(&large);
            file.bytes[AT(section) + (size_t)id * entry + at] ^= 0x40;
            seal_header(&file);
            expect_fault(&file, DPT_E_LAYOUT, AT(section) + (size_t)id * entry,
                         header.section[id].name);
            free(file.bytes);
        }
}

static int is_sound(const dpt_hit *hit)
{
    const double numbers[] = { hit->distance, hit->gap,  hit->depth,       hit->s,
                               hit->p[0],     hit->q[0], hit->p[1],        hit->q[1],
                               hit->p[2],     hit->q[2], hit->error_bound, hit->lower_bound };
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
        if (!isfinite(numbers[i]) && hit->status != DPT_STATUS_STALE)
            return 0;
    return 1;
}

/* Search, sign and force on a mesh that opened: whatever it says, it stays within the bytes. */
static void use(const dpt_mesh *mesh, uint64_t *random)
{
    static double block[12288];
    double ends[6 * 4];
    struct surface surface;
    struct kernel kernel;
    struct work work = work_of(WORK_UNLIMITED);
    uint32_t chosen;
    dpt_hit hits[4] = { DPT_HIT_INIT };
    dpt_query_def query = { .size = sizeof query };
    dpt_world_def def;
    dpt_world *world;
    dpt_body body;
    dpt_tool tool;
    for (int i = 0; i < 24; i++)
        ends[i] = random_in(random, -0.15, 0.15);
    dpti_surface_of_mesh(mesh, &surface);
    dpti_kernel_get(DPT_KERNEL_AUTO, &kernel, &chosen);
    for (int i = 0; i < 8; i++)
        CHECK(isfinite(dpti_winding_number(&surface, &kernel, vec3_of(ends + 3 * i), &work)),
              "a winding number that is none");
    for (query.method = 0; query.method <= DPT_METHOD_BRUTE; query.method++) {
        dpt_query_segments(mesh, NULL, ends, NULL, 4, hits, &query);
        for (int i = 0; i < 4; i++)
            CHECK(is_sound(&hits[i]), "hit %d is not finite", i);
    }
    dpt_world_def_init(&def);
    def.max_bodies = def.max_tools = def.max_segments = 1;
    def.certificate_bytes = 2048;
    def.smooth_normals = 1;
    CHECK(dpt_world_bytes(&def) <= sizeof block, "%zu bytes", dpt_world_bytes(&def));
    if (dpt_world_create(block, sizeof block, &def, &world) != DPT_OK ||
        dpt_body_add(world, mesh, NULL, &body) != DPT_OK)
        return;
    for (int i = 0; i < 4; i++) {
        dpt_segment segment = { { ends[6 * i], ends[6 * i + 1], ends[6 * i + 2] },
                                { ends[6 * i + 3], ends[6 * i + 4], ends[6 * i + 5] },
                                0.05 };
        dpt_wrench wrench;
        if (i == 0)
            dpt_tool_add(world, &segment, 1, &tool);
        dpt_tool_set_segments(world, tool, &segment, 1);
        dpt_world_step(world, 1e-3, NULL);
        dpt_tool_get_hit(world, tool, hits);
        dpt_tool_get_wrench(world, tool, &wrench);
        CHECK(is_sound(hits) && isfinite(wrench.force[0] + wrench.torque[0]), "not finite");
    }
}

/* Any word, any value, checksums made good: refused, or used without harm. */
static void random_forgeries_do_no_harm(void)
{
    uint64_t random = 1, opened = 0;
    const uint32_t odd[] = { 0,          1,          15,         16,         39,
                             40,         UINT32_MAX, 0x7f800000, 0xffc00000, 0x7149f2ca,
                             0x80000000, 0x00000001, 0x49742400, 0xfffffffe, 0x3f800000 };
    for (int i = 0; i < 20000; i++) {
        struct file file = copy_of(i % 16 == 0 ? &large : i % 2 ? &small : &holed);
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
            use((const dpt_mesh *)(const void *)file.bytes, &random);
        }
        free(file.bytes);
    }
    CHECK(opened > 1000, "only %llu opened: the test tests little", (unsigned long long)opened);
}

static void misaligned_bytes_are_refused(void)
{
    unsigned char *block = malloc(small.size + 16);
    for (size_t shift = 0; shift <= 8; shift++) {
        struct file file = { block + shift, small.size };
        memcpy(file.bytes, small.bytes, small.size);
        if (shift % 8 == 0)
            CHECK(fault_of(&file).code == DPT_OK, "shift %zu", shift);
        else
            expect_fault(&file, DPT_E_ALIGN, 0, "header");
        CHECK(dpt_mesh_convert(file.bytes, file.size, NULL) == (shift % 8 ? DPT_E_ALIGN : DPT_OK),
              "shift %zu", shift);
    }
    free(block);
}

static void wrong_arguments_are_refused(void)
{
    struct file *file = &small;
    const dpt_mesh *mesh = (const dpt_mesh *)(const void *)file->bytes, *opened = NULL;
    dpt_mesh_fault fault = { .size = sizeof fault - 1, .code = 77 };
    dpt_mesh_info info = { .size = 159, .triangles = 77, .solid_components = 77 };
    dpt_mesh_section section = { .size = 4, .crc32 = 77 };
    double corners[9] = { 77.0 };
    CHECK(dpt_mesh_open(NULL, file->size, &opened) == DPT_E_ARGUMENT && !opened, "NULL opened");
    CHECK(dpt_mesh_open(file->bytes, file->size, NULL) == DPT_E_ARGUMENT, "no output");
    CHECK(dpt_mesh_open(NULL, 0, &opened) == DPT_E_ARGUMENT && !opened, "NULL of 0 bytes");
    CHECK(dpt_mesh_verify(NULL, file->size, NULL) == DPT_E_ARGUMENT, "NULL verified");
    CHECK(dpt_mesh_verify(file->bytes, file->size, NULL) == DPT_OK, "the fault may be NULL");
    CHECK(dpt_mesh_verify(file->bytes, 1, NULL) == DPT_E_TRUNCATED, "the fault may be NULL");
    CHECK(dpt_mesh_verify(file->bytes, 1, &fault) == DPT_E_SIZE && fault.code == 77, "fault");
    CHECK(dpt_mesh_convert(NULL, file->size, NULL) == DPT_E_ARGUMENT, "NULL converted");
    CHECK(dpt_mesh_convert(file->bytes, file->size, &fault) == DPT_E_SIZE, "fault");
    CHECK(dpt_mesh_get_info(NULL, &info) == DPT_E_ARGUMENT, "no mesh");
    CHECK(dpt_mesh_get_info(mesh, NULL) == DPT_E_ARGUMENT, "no info");
    CHECK(dpt_mesh_get_info(mesh, &info) == DPT_E_SIZE && info.triangles == 77, "info");
    info.size = 160; /* of a caller that was built before there was more */
    CHECK(dpt_mesh_get_info(mesh, &info) == DPT_OK && info.triangles == 40 &&
              info.solid_components == 77,
          "info of 160 bytes");
    info = (dpt_mesh_info){ .size = 176, .crease = 77.0 };
    CHECK(dpt_mesh_get_info(mesh, &info) == DPT_OK && info.solid_components == 1 &&
              info.crease == 77.0,
          "info of 176 bytes");
    info = (dpt_mesh_info){ .size = 192, .self_intersections = 77 };
    CHECK(dpt_mesh_get_info(mesh, &info) == DPT_OK && info.crease > 0.0 &&
              info.self_intersections == 77,
          "info of 192 bytes");
    info.size = sizeof info;
    CHECK(dpt_mesh_get_info(mesh, &info) == DPT_OK && info.crease == 3.14159265358979323846 / 3.0,
          "creases of %.17g", info.crease);
    for (uint32_t t = 0; t < 43; t += t < 39 ? 39 : 1) {
        uint32_t flags = 77;
        dpt_result wanted = t < 40 ? DPT_OK : DPT_E_ARGUMENT;
        CHECK(dpt_mesh_get_triangle_flags(mesh, t, &flags) == wanted &&
                  (flags == 77) == (t >= 40) &&
                  dpt_mesh_get_vertex_normals(mesh, t, corners) == wanted,
              "triangle %u", t);
    }
    uint32_t flags;
    CHECK(dpt_mesh_get_triangle_flags(NULL, 0, &flags) == DPT_E_ARGUMENT &&
              dpt_mesh_get_triangle_flags(mesh, 0, NULL) == DPT_E_ARGUMENT &&
              dpt_mesh_get_vertex_normals(NULL, 0, corners) == DPT_E_ARGUMENT &&
              dpt_mesh_get_vertex_normals(mesh, 0, NULL) == DPT_E_ARGUMENT,
          "NULL");
    corners[0] = 77.0;
    CHECK(dpt_mesh_get_section(NULL, 0, &section) == DPT_E_ARGUMENT, "no mesh");
    CHECK(dpt_mesh_get_section(mesh, 0, NULL) == DPT_E_ARGUMENT, "no section");
    CHECK(dpt_mesh_get_section(mesh, 0, &section) == DPT_E_SIZE && section.crc32 == 77, "size");
    section.size = sizeof section;
    CHECK(dpt_mesh_get_section(mesh, 14, &section) == DPT_E_ARGUMENT, "there are 14 sections");
    CHECK(dpt_mesh_get_section(mesh, UINT32_MAX, &section) == DPT_E_ARGUMENT, "no such section");
    CHECK(dpt_mesh_get_triangle(NULL, 0, corners) == DPT_E_ARGUMENT, "no mesh");
    CHECK(dpt_mesh_get_triangle(mesh, 0, NULL) == DPT_E_ARGUMENT, "no corners");
    CHECK(dpt_mesh_get_triangle(mesh, 40, corners) == DPT_E_ARGUMENT, "there are 40 triangles");
    CHECK(dpt_mesh_get_triangle(mesh, UINT32_MAX, corners) == DPT_E_ARGUMENT, "no such triangle");
    CHECK(corners[0] == 77.0, "a refused call wrote");
}

static void other_byte_order_converts(void)
{
    const struct file *files[] = { &small, &large, &holed };
    for (int i = 0; i < 3; i++) {
        struct file other = other_order(files[i]);
        dpt_mesh_fault fault = { .size = sizeof fault };
        expect_fault(&other, DPT_E_BYTE_ORDER, AT(byte_order), "header");
        CHECK(dpt_mesh_convert(other.bytes, other.size, &fault) == DPT_OK, "%d in %s", fault.code,
              fault.section);
        CHECK(!memcmp(other.bytes, files[i]->bytes, other.size), "not the bytes it was made of");
        CHECK(dpt_mesh_convert(other.bytes, other.size, NULL) == DPT_OK, "a second time");
        CHECK(!memcmp(other.bytes, files[i]->bytes, other.size), "a second time changes it");
        CHECK(fault_of(&other).code == DPT_OK, "does not open");
        free(other.bytes);
    }
}

/* Cut short or damaged, it is refused and stays as it is. */
static void other_byte_order_is_checked(void)
{
    struct file whole = other_order(&small);
    struct dpt_mesh header = header_of(&small);
    for (size_t at = 0; at < whole.size; at++) {
        struct file cut = file_of(whole.bytes, at), file = copy_of(&whole);
        dpt_mesh_fault fault = { .size = sizeof fault };
        CHECK(dpt_mesh_convert(cut.bytes, at, NULL) == DPT_E_TRUNCATED, "%zu bytes", at);
        CHECK(!memcmp(cut.bytes, whole.bytes, at), "%zu bytes changed", at);
        file.bytes[at] ^= 0x10;
        CHECK(dpt_mesh_convert(file.bytes, file.size, &fault) != DPT_OK, "byte %zu", at);
        CHECK(!strcmp(fault.section, section_name_at(&header, at)), "byte %zu: %s", at,
              fault.section);
        file.bytes[at] ^= 0x10;
        CHECK(!memcmp(file.bytes, whole.bytes, file.size), "byte %zu: changed", at);
        free(cut.bytes);
        free(file.bytes);
    }
    /* Forged before it was turned round: found behind the conversion. */
    struct file forged = copy_of(&small);
    uint64_t at = header.section[MESH_TRIANGLES].offset + 8;
    memset(forged.bytes + at, 0xff, 4);
    seal(&forged);
    struct file other = other_order(&forged);
    dpt_mesh_fault fault = { .size = sizeof fault };
    CHECK(dpt_mesh_convert(other.bytes, other.size, &fault) == DPT_E_INDEX && fault.byte == at,
          "%s at %llu", dpt_result_name(fault.code), (unsigned long long)fault.byte);
    free(forged.bytes);
    free(other.bytes);
    free(whole.bytes);
}

static struct file read_golden(const char *name)
{
    char path[512];
    struct file file = { malloc(1 << 14), 0 };
    snprintf(path, sizeof path, "%s/%s", golden, name);
    FILE *stream = fopen(path, "rb");
    if (stream) {
        file.size = fread(file.bytes, 1, 1 << 14, stream);
        fclose(stream);
    }
    CHECK(file.size > 0 && file.size < 1 << 14, "%s: %zu bytes", path, file.size);
    return file;
}

/* The compiler writes the same bytes, but for its own version. */
static void golden_file_is_what_we_write(void)
{
    struct file source = read_golden("torus.ply"), kept = read_golden("torus_4.dpa");
    dpt_compiled compiled;
    if (source.size && kept.size > sizeof(struct dpt_mesh) &&
        dpt_compile_bytes(source.bytes, source.size, NULL, &compiled, NULL) == DPT_OK) {
        struct file today = file_of(compiled.bytes, compiled.size);
        dpt_compiled_free(&compiled);
        CHECK(kept.size == today.size, "%zu bytes, not %zu", today.size, kept.size);
        dpt_mesh_convert(today.bytes, today.size, NULL);
        dpt_mesh_convert(kept.bytes, kept.size, NULL);
        CHECK(fault_of(&kept).code == DPT_OK, "does not open");
        memcpy(kept.bytes + AT(writer_version), today.bytes + AT(writer_version), 4);
        seal(&kept);
        CHECK(!memcmp(kept.bytes, today.bytes, kept.size), "the compiler writes other bytes");
        free(today.bytes);
        /* The shape is the source: only its float vertices went through the file. */
        struct file shape = file_of_shape("torus", 96);
        CHECK(shape.size == kept.size && !memcmp(shape.bytes + sizeof(struct dpt_mesh),
                                                 kept.bytes + sizeof(struct dpt_mesh),
                                                 kept.size - sizeof(struct dpt_mesh)),
              "the shape has changed");
        free(shape.bytes);
    } else {
        CHECK(0, "the golden files cannot be read");
    }
    free(source.bytes);
    free(kept.bytes);
}

/* An old file against the same mesh of today: its findings, as far as it has them, and the same answers. */
static void answer_alike(const struct file *old, const struct file *today, uint32_t version)
{
    const dpt_mesh *meshes[2] = { NULL, NULL };
    dpt_mesh_info info = { .size = sizeof info };
    dpt_mesh_section section = { .size = sizeof section };
    uint32_t flags, sections = version == 1 ? 11 : version == 2 ? 12 : 14;
    uint64_t random = 5;
    if (dpt_mesh_open(old->bytes, old->size, &meshes[0]) != DPT_OK ||
        dpt_mesh_open(today->bytes, today->size, &meshes[1]) != DPT_OK) {
        CHECK(0, "version %u does not open", version);
        return;
    }
    dpt_mesh_get_info(meshes[0], &info);
    CHECK(info.format_version == version && info.solid_components == 1 && !info.cavities &&
              !info.winding_components && !info.buried_components,
          "version %u, %u solid", info.format_version, info.solid_components);
    CHECK((info.crease > 0.0) == (version > 2), "version %u has creases of %g", version,
          info.crease);
    CHECK(info.self_intersections == (version > 3 ? 0 : DPT_NONE) &&
              !info.self_intersections_more && info.self_intersection[0] == DPT_NONE &&
              info.self_intersection[1] == DPT_NONE,
          "version %u has %u self-intersections", version, info.self_intersections);
    CHECK(mesh_part_flags(meshes[0], 0) == 15 && mesh_part_flags(meshes[1], 0) == 15,
          "flags %u, %u", mesh_part_flags(meshes[0], 0), mesh_part_flags(meshes[1], 0));
    CHECK(dpt_mesh_get_section(meshes[0], sections - 1, &section) == DPT_OK &&
              dpt_mesh_get_section(meshes[0], sections, &section) == DPT_E_ARGUMENT,
          "version %u has not %u sections", version, sections);
    CHECK(dpt_mesh_get_triangle_flags(meshes[0], 0, &flags) ==
              (version > 2 ? DPT_OK : DPT_E_UNSUPPORTED),
          "flags of version %u", version);
    for (uint32_t t = 0; t < info.triangles; t++) {
        double normals[2][9];
        for (int m = 0; m < 2; m++)
            CHECK(dpt_mesh_get_vertex_normals(meshes[m], t, normals[m]) == DPT_OK, "triangle %u",
                  t);
        for (int i = 0; i < 9; i++)
            CHECK(fabs(normals[0][i] - normals[1][i]) < 0x1p-24, "normal %d of triangle %u", i, t);
    }
    for (int i = 0; i < 200; i++) {
        double ends[6], radius = 0.01;
        dpt_hit hits[2] = { DPT_HIT_INIT, DPT_HIT_INIT };
        for (int k = 0; k < 6; k++)
            ends[k] = random_in(&random, -0.2, 0.2);
        for (int m = 0; m < 2; m++)
            dpt_query_segments(meshes[m], NULL, ends, &radius, 1, &hits[m], NULL);
        CHECK(!memcmp(&hits[0], &hits[1], sizeof hits[0]), "another answer");
    }
    use(meshes[0], &random);
}

/* Every version opens forever, in either byte order, and is checked as today's is. */
static void all_versions_open(void)
{
    const char *const names[] = { "torus.dpa", "torus_2.dpa", "torus_3.dpa", "torus_4.dpa" };
    struct file today = file_of_shape("torus", 96);
    for (uint32_t version = 1; version <= 4; version++) {
        struct file old = read_golden(names[version - 1]);
        dpt_mesh_convert(old.bytes, old.size, NULL);
        CHECK(fault_of(&old).code == DPT_OK, "does not open");
        answer_alike(&old, &today, version);
        for (size_t size = 0; size < old.size; size += size < 1000 ? 1 : 97) {
            struct file cut = file_of(old.bytes, size);
            expect_fault(&cut, DPT_E_TRUNCATED, size, "header");
            free(cut.bytes);
        }
        struct dpt_mesh header = header_of(&old);
        for (size_t at = 0; at < old.size; at += at < 1000 ? 1 : 13) {
            old.bytes[at] ^= 0x10;
            expect_byte_fault(&old, &header, at);
            old.bytes[at] ^= 0x10;
        }
        struct file other = other_order(&old);
        CHECK(dpt_mesh_convert(other.bytes, other.size, NULL) == DPT_OK &&
                  !memcmp(other.bytes, old.bytes, old.size),
              "not the bytes it was made of");
        free(other.bytes);
        free(old.bytes);
    }
    free(today.bytes);
}

/* Nothing is written to an open mesh: of pages that cannot be written, all answers are as of others. */
static void read_only_memory_is_enough(void)
{
    uint64_t random = 9;
    size_t room = (large.size + 65535) / 65536 * 65536;
    unsigned char *pages =
        mmap(NULL, room, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    CHECK(pages != MAP_FAILED, "no pages");
    if (pages == MAP_FAILED)
        return;
    memcpy(pages, large.bytes, large.size);
    CHECK(mprotect(pages, room, PROT_READ) == 0, "still writable");
    const dpt_mesh *mesh;
    CHECK(dpt_mesh_open(pages, large.size, &mesh) == DPT_OK, "does not open");
    /* In the host's order already, so that there is nothing to convert. */
    CHECK(dpt_mesh_convert(pages, large.size, NULL) == DPT_OK, "does not convert");
    for (int i = 0; i < 50; i++)
        use(mesh, &random);
    munmap(pages, room);
}

int main(int argc, char **argv)
{
    if (argc > 1)
        golden = argv[1];
    small = file_of_shape("sphere", 40);
    large = file_of_shape("sphere", 600);
    holed = file_of_holed_shape("sphere", 40, 1);
    if (!small.size || !large.size || !holed.size)
        return 1;
    TEST(whole_files_open);
    TEST(truncations_are_refused);
    TEST(trailing_bytes_are_refused);
    TEST(changed_bytes_are_refused);
    TEST(other_files_are_refused);
    TEST(newer_versions_are_refused);
    TEST(forged_words_are_refused);
    TEST(forged_headers_are_refused);
    TEST(forged_tables_are_refused);
    TEST(random_forgeries_do_no_harm);
    TEST(misaligned_bytes_are_refused);
    TEST(wrong_arguments_are_refused);
    TEST(other_byte_order_converts);
    TEST(other_byte_order_is_checked);
    TEST(golden_file_is_what_we_write);
    TEST(all_versions_open);
    TEST(read_only_memory_is_enough);
    free(holed.bytes);
    free(small.bytes);
    free(large.bytes);
    return check_report();
}
