/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A damaged file for each check of the reader, refused with a reason of its own: the code, the byte and the section.
 *
 *     test_damaged_files [MESH_OPEN]
 *
 * MESH_OPEN is the source of the reader; from the top of the tree it is found without. The program is linked with a
 * copy of it that notes in `site` the line of the check that failed (tests.mk), and a check that no row reaches fails
 * the test.
 *
 * The damaged files are made here, each from one of eight whole ones in the host's byte order: `plain`, a sphere of 40
 * triangles, closed; `holed`, the same less one, which so has moments; `embedded`, the same in 27 nodes; `sheet`
 * and `volume`, the same with springs; `moved`, the same from far away; `old` and `old_4`, the golden files of versions 1
 * and 4. A row says what is changed, one word or the length, and which checksums are made good afterwards.
 */
#include <math.h>

#include "base/byte_order.h"
#include "lib/dpa.h"
#include "lib/sites.h"
#include "mesh/mesh_swap.h"

static const char *reader = "src/mesh/mesh_open.c";

enum whole { PLAIN, HOLED, EMBEDDED, SHEET, VOLUME, CELLS, MOVED, OLD, OLD_4, WHOLES };
static struct file wholes[WHOLES];

enum seal { AS_IT_IS, HEADER, ALL };
enum change { SET, CUT, GROW, SHIFT, NO_BYTES };

struct damage {
    enum whole of;
    enum change change;
    int section; /* that `at` counts in, in words, from its end when negative; MESH_HEADER: in bytes */
    int64_t at;  /* CUT and GROW: by how many bytes */
    uint32_t value;
    enum seal seal;
    dpt_result code;
    const char *named; /* section; NULL: the one that `section` says */
    int64_t byte;      /* THERE: of the word that was changed */
};

#define THERE      (-1)
#define AT(name)   (int64_t) offsetof(struct dpt_mesh, name)
#define TAIL(name) (int64_t) PLAIN_TAIL_AT(name)
#define ENTRY(id, name)                                                                                                \
    (AT(section) + (id) * (int64_t)sizeof(struct mesh_section) + (int64_t)offsetof(struct mesh_section, name))

static uint32_t bits_of(float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

static uint64_t place_of(const struct dpt_mesh *header, int section, int64_t at)
{
    if (section == MESH_HEADER)
        return (uint64_t)at;
    const struct mesh_section *in = &header->section[section];
    return in->offset + 4 * (uint64_t)at + (at < 0 ? in->bytes : 0);
}

/* The file, in `block`, which is freed. */
static struct file damaged(const struct damage *damage, unsigned char **block)
{
    const struct file *whole = &wholes[damage->of];
    const struct dpt_mesh header = header_of(whole);
    size_t size = whole->size;
    size += damage->change == GROW ? (size_t)damage->at : 0;
    size -= damage->change == CUT ? (size_t)damage->at : 0;
    *block = calloc(1, size + 8);
    struct file file = { *block + (damage->change == SHIFT ? damage->at : 0), size };
    memcpy(file.bytes, whole->bytes, size < whole->size ? size : whole->size);
    if (damage->change == SET)
        memcpy(file.bytes + place_of(&header, damage->section, damage->at), &damage->value, 4);
    if (damage->change != SET && damage->seal == HEADER) {
        uint64_t told = size;
        memcpy(file.bytes + AT(bytes), &told, sizeof told);
    }
    if (damage->seal == ALL)
        seal(&file);
    if (damage->seal == HEADER)
        seal_header(&file);
    if (damage->change == NO_BYTES)
        file.size = 0;
    return file;
}

static void expect_row(const struct damage *damage, size_t row)
{
    const struct dpt_mesh header = header_of(&wholes[damage->of]);
    unsigned char *block;
    struct file file = damaged(damage, &block);
    dpt_mesh_fault fault = { .size = sizeof fault };
    const dpt_mesh *mesh = NULL;
    char named[16];
    mesh_section_name(damage->section, named);
    uint64_t byte = damage->byte == THERE ? place_of(&header, damage->section, damage->at) : (uint64_t)damage->byte;
    site = 0;
    dpt_result result = dpt_mesh_verify(file.bytes, file.size, &fault);
    site_note();
    CHECK(result == damage->code && fault.code == result && fault.byte == byte &&
              !strcmp(fault.section, damage->named ? damage->named : named),
          "row %zu: %s at %llu (%s), line %d, not %s at %llu (%s)", row, dpt_result_name(fault.code),
          (unsigned long long)fault.byte, fault.section, site, dpt_result_name(damage->code), (unsigned long long)byte,
          damage->named ? damage->named : named);
    CHECK(dpt_mesh_open(file.bytes, file.size, &mesh) == damage->code && !mesh, "row %zu opens", row);
    /* That a file of the other byte order is converted first changes nothing else. */
    if (result != DPT_E_BYTE_ORDER)
        CHECK(dpt_mesh_convert(file.bytes, file.size, NULL) == damage->code, "row %zu converts", row);
    free(block);
}

enum { ROWS_MAX = 120 };
static struct damage table[ROWS_MAX];
static size_t table_rows;

static void add_rows(const struct damage *rows, size_t count)
{
    CHECK(table_rows + count <= ROWS_MAX, "%zu rows", table_rows + count);
    memcpy(table + table_rows, rows, count * sizeof *rows);
    table_rows += count;
}

/* What is no mesh file of this version and length. */
static void add_header_rows(void)
{
    const int64_t size = (int64_t)wholes[PLAIN].size, header = (int64_t)PLAIN_HEADER;
    const dpt_result layout = DPT_E_LAYOUT;
    const struct damage rows[] = {
        /* begin */
        { PLAIN, SHIFT, MESH_HEADER, 4, 0, AS_IT_IS, DPT_E_ALIGN, NULL, 0 },
        { PLAIN, NO_BYTES, MESH_HEADER, 0, 0, AS_IT_IS, DPT_E_TRUNCATED, NULL, 0 },
        { PLAIN, SET, MESH_HEADER, 0, 0x20796c70, AS_IT_IS, DPT_E_MAGIC, NULL, 0 },
        { PLAIN, CUT, MESH_HEADER, size - 5, 0, AS_IT_IS, DPT_E_TRUNCATED, NULL, 5 },
        /* dpt_mesh_verify */
        { PLAIN, SET, MESH_HEADER, AT(byte_order), MESH_BYTE_ORDER_SWAPPED, HEADER, DPT_E_BYTE_ORDER, NULL, THERE },
        { PLAIN, SET, MESH_HEADER, AT(byte_order), 0x01020403, HEADER, layout, NULL, THERE },
        /* check_header */
        { PLAIN, SET, MESH_HEADER, AT(version), MESH_VERSION + 1, HEADER, DPT_E_VERSION, NULL, THERE },
        { PLAIN, SET, MESH_HEADER, AT(version), 0, HEADER, layout, NULL, THERE },
        { PLAIN, CUT, MESH_HEADER, size - header + 1, 0, AS_IT_IS, DPT_E_TRUNCATED, NULL, header - 1 },
        { PLAIN, SET, MESH_HEADER, AT(header_bytes), 816, HEADER, layout, NULL, THERE },
        { PLAIN, SET, MESH_HEADER, AT(section_count), 13, HEADER, layout, NULL, THERE },
        { PLAIN, SET, MESH_HEADER, AT(reserved), 1, HEADER, layout, NULL, THERE },
        { PLAIN, CUT, MESH_HEADER, 1, 0, AS_IT_IS, DPT_E_TRUNCATED, NULL, size - 1 },
        { PLAIN, GROW, MESH_HEADER, 1, 0, AS_IT_IS, DPT_E_TRAILING, NULL, size },
        /* check_header_crc */
        { PLAIN, SET, MESH_HEADER, AT(source_hash), 1, AS_IT_IS, DPT_E_CHECKSUM, NULL, 0 },
        { OLD, SET, MESH_HEADER, AT(source_hash), 1, AS_IT_IS, DPT_E_CHECKSUM, NULL, 0 },
    };
    add_rows(rows, sizeof rows / sizeof *rows);
}

/* A header whose numbers do not fit the sections, and sections whose checksums are wrong. */
static void add_layout_rows(void)
{
    const struct dpt_mesh plain = header_of(&wholes[PLAIN]);
    const uint32_t t = plain.triangles, v = plain.vertices, nan = bits_of(NAN);
    const int64_t size = (int64_t)wholes[PLAIN].size;
    const int64_t padding = (int64_t)(plain.section[0].offset + plain.section[0].bytes);
    const int64_t upper = host_is_little() ? 4 : 0, lower = 4 - upper; /* of 8 bytes */
    const dpt_result layout = DPT_E_LAYOUT, index = DPT_E_INDEX, finite = DPT_E_FINITE;
    const struct damage rows[] = {
        /* check_layout: counts that fit no others, and each field of an entry */
        { PLAIN, SET, MESH_HEADER, AT(triangles), 0, HEADER, layout, NULL, THERE },
        { PLAIN, SET, MESH_HEADER, AT(leaves), 4, HEADER, layout, NULL, AT(triangles) },
        { PLAIN, SET, MESH_HEADER, AT(source_triangles), t - 1, HEADER, layout, NULL, AT(triangles) },
        { PLAIN, SET, MESH_HEADER, AT(vertices), 0x80000000, HEADER, layout, NULL, AT(triangles) },
        { PLAIN, SET, MESH_HEADER, AT(levels), 2, HEADER, layout, NULL, AT(triangles) },
        { PLAIN, SET, MESH_HEADER, AT(source_vertices), v - 1, HEADER, layout, NULL, AT(triangles) },
        { PLAIN, SET, MESH_HEADER, AT(vertices), v - 1, HEADER, layout, "vertices", ENTRY(0, name) },
        { PLAIN, SET, MESH_HEADER, ENTRY(4, name), 0x746e6166, HEADER, layout, "fans", ENTRY(4, name) },
        { PLAIN, SET, MESH_HEADER, ENTRY(4, offset) + lower, 0, HEADER, layout, "fans", ENTRY(4, name) },
        { PLAIN, SET, MESH_HEADER, ENTRY(4, bytes) + lower, 4, HEADER, layout, "fans", ENTRY(4, name) },
        { PLAIN, SET, MESH_HEADER, ENTRY(12, bytes) + lower, 0, HEADER, layout, "normals", ENTRY(12, name) },
        { PLAIN, SET, MESH_HEADER, ENTRY(4, reserved), 1, HEADER, layout, "fans", ENTRY(4, name) },
        { PLAIN, SET, MESH_HEADER, TAIL(nodes), 27, HEADER, layout, "embed_nodes", ENTRY(15, name) },
        { EMBEDDED, SET, MESH_HEADER, TAIL(nodes), 0, HEADER, layout, "embed_nodes", ENTRY(15, name) },
        { EMBEDDED, SET, MESH_HEADER, TAIL(nodes), 0x80000000, HEADER, layout, NULL, THERE },
        { EMBEDDED, SET, MESH_HEADER, TAIL(outside_vertices), v + 1, HEADER, layout, NULL, TAIL(nodes) },
        { PLAIN, CUT, MESH_HEADER, 64, 0, HEADER, DPT_E_TRUNCATED, "vertex_sources", size - 64 },
        { PLAIN, GROW, MESH_HEADER, 64, 0, HEADER, layout, NULL, size },
        /* check_sections_crc */
        { PLAIN, SET, MESH_HEADER, padding, 0x01000001, AS_IT_IS, layout, "padding", padding },
        { PLAIN, SET, MESH_LEAVES, 0, nan, AS_IT_IS, DPT_E_CHECKSUM, NULL, THERE },
        { PLAIN, SET, MESH_FLAGS, 0, 1, AS_IT_IS, DPT_E_CHECKSUM, NULL, THERE },
        { OLD, SET, MESH_LEAVES, 0, nan, AS_IT_IS, DPT_E_CHECKSUM, NULL, THERE },
        /* check_numbers: the upper halves of doubles, made infinite */
        { PLAIN, SET, MESH_HEADER, AT(box_max) + upper, 0x7ff00000, HEADER, finite, NULL, AT(scale) },
        { PLAIN, SET, MESH_HEADER, TAIL(crease) + upper, 0x7ff00000, HEADER, finite, NULL, TAIL(crease) },
        { PLAIN, SET, MESH_HEADER, TAIL(crease) + upper, 0xbff00000, HEADER, finite, NULL, TAIL(crease) },
        { OLD_4, SET, MESH_HEADER, 920 + upper, 0xbff00000, HEADER, finite, NULL, 920 },
        { EMBEDDED, SET, MESH_HEADER, TAIL(outside_distance) + upper, 0x7ff00000, HEADER, finite, NULL,
          TAIL(outside_distance) },
        { EMBEDDED, SET, MESH_HEADER, TAIL(outside_distance) + upper, 0xbff00000, HEADER, finite, NULL,
          TAIL(outside_distance) },
        { MOVED, SET, MESH_HEADER, AT(tail.origin) + upper, 0x7ff00000, HEADER, finite, NULL, AT(tail.origin) },
        { MOVED, SET, MESH_HEADER, AT(tail.origin[2]) + upper, 0xc1d00000, HEADER, finite, NULL, AT(tail.origin) },
        /* check_example: one of two, and a number that there is not */
        { PLAIN, SET, MESH_HEADER, TAIL(self_intersection), 0, HEADER, index, NULL, THERE },
        { PLAIN, SET, MESH_HEADER, TAIL(self_intersection) + 4, t, HEADER, index, NULL, TAIL(self_intersection) },
        { OLD_4, SET, MESH_HEADER, 936, 0, HEADER, index, NULL, 936 },
    };
    add_rows(rows, sizeof rows / sizeof *rows);
}

/* What the sections hold. */
static void add_section_rows(void)
{
    const struct dpt_mesh plain = header_of(&wholes[PLAIN]);
    const uint32_t t = plain.triangles, v = plain.vertices, nan = bits_of(NAN);
    const dpt_result index = DPT_E_INDEX, finite = DPT_E_FINITE;
    const struct damage rows[] = {
        /* check_some_floats, by section */
        { PLAIN, SET, MESH_VERTICES, 7, nan, ALL, finite, NULL, THERE },
        { PLAIN, SET, MESH_BOXES, -1, nan, ALL, finite, NULL, THERE },
        { PLAIN, SET, MESH_LEAVES, 0, nan, ALL, finite, NULL, THERE },
        { HOLED, SET, MESH_MOMENTS, 5, bits_of(1e31f), ALL, finite, NULL, THERE },
        { PLAIN, SET, MESH_NORMALS, 4, nan, ALL, finite, NULL, THERE },
        { PLAIN, SET, MESH_NORMALS, -1, bits_of(1.0000001f), ALL, finite, NULL, THERE },
        { OLD, SET, MESH_VERTICES, 7, nan, ALL, finite, NULL, THERE },
        /* check_box */
        { PLAIN, SET, MESH_VERTICES, 7, bits_of(1e5f), ALL, finite, NULL, THERE },
        /* check_indices, by section */
        { PLAIN, SET, MESH_TRIANGLES, 5, v, ALL, index, NULL, THERE },
        { PLAIN, SET, MESH_NEIGHBOURS, -1, t, ALL, index, NULL, THERE },
        { PLAIN, SET, MESH_FANS, 0, t, ALL, index, NULL, THERE },
        { PLAIN, SET, MESH_PARTS, 3, plain.parts, ALL, index, NULL, THERE },
        { PLAIN, SET, MESH_SOURCES, 1, t, ALL, index, NULL, THERE },
        { PLAIN, SET, MESH_PLACES, 2, MESH_DROPPED_DUPLICATE - 1, ALL, index, NULL, THERE },
        { PLAIN, SET, MESH_FLAGS, -1, MESH_FLAGS_END, ALL, index, NULL, THERE },
        { PLAIN, SET, MESH_VERTEX_SOURCES, 3, v, ALL, index, NULL, THERE },
        { EMBEDDED, SET, MESH_EMBED_NODES, -1, 27, ALL, index, NULL, THERE },
        /* check_sources */
        { PLAIN, SET, MESH_PLACES, 0, MESH_DROPPED_DUPLICATE, ALL, index, NULL, THERE },
        /* check_fans */
        { PLAIN, SET, MESH_FAN_FIRST, 4, 0, ALL, index, NULL, THERE },
        { PLAIN, SET, MESH_FAN_FIRST, 0, 1, ALL, index, NULL, THERE },
        { PLAIN, SET, MESH_FAN_FIRST, -1, 3 * t + 1, ALL, index, NULL, THERE },
        /* check_weights: by check_some_floats, and a sum that is not 1 */
        { EMBEDDED, SET, MESH_EMBED_WEIGHTS, 2, nan, ALL, finite, NULL, THERE },
        { EMBEDDED, SET, MESH_EMBED_WEIGHTS, 5, bits_of(-128.01f), ALL, finite, NULL, THERE },
        { EMBEDDED, SET, MESH_EMBED_WEIGHTS, -4, bits_of(2.0f), ALL, finite, NULL, THERE },
        /* check_moments */
        { HOLED, SET, MESH_MOMENTS, -1, 0x80, ALL, index, NULL, THERE },
    };
    add_rows(rows, sizeof rows / sizeof *rows);
}

static uint32_t word_of(enum whole of, int section, int64_t at)
{
    const struct dpt_mesh header = header_of(&wholes[of]);
    uint32_t word;
    memcpy(&word, wholes[of].bytes + place_of(&header, section, at), 4);
    return word;
}

/* The word of the last spring of node 0, in a file with springs. */
static int64_t last_spring(enum whole of)
{
    int64_t at = 0;
    while (word_of(of, MESH_SPRING_ENDS, at + 16) != 0)
        at += 16;
    return at;
}

/* Masses and springs. The last word of an entry of the second slice is beyond the last of 22 nodes: padding. */
static void add_spring_rows(void)
{
    const struct dpt_mesh sheet = header_of(&wholes[SHEET]);
    const uint32_t nan = bits_of(NAN), entries = mesh_tail(&sheet).spring_entries;
    const int64_t upper = host_is_little() ? 4 : 0, last = last_spring(SHEET);
    const int64_t first_stiffness = (int64_t)sheet.section[MESH_SPRING_STIFFNESS].offset;
    const dpt_result layout = DPT_E_LAYOUT, index = DPT_E_INDEX, finite = DPT_E_FINITE;
    const struct damage rows[] = {
        /* check_layout */
        { PLAIN, SET, MESH_HEADER, TAIL(springs), 1, HEADER, layout, NULL, TAIL(spring_nodes) },
        { SHEET, SET, MESH_HEADER, TAIL(spring_nodes), 21, HEADER, layout, NULL, THERE },
        { VOLUME, SET, MESH_HEADER, TAIL(spring_nodes), 22, HEADER, layout, NULL, THERE },
        { SHEET, SET, MESH_HEADER, TAIL(fixed_nodes), 23, HEADER, layout, NULL, TAIL(spring_nodes) },
        { SHEET, SET, MESH_HEADER, TAIL(spring_entries), 0x10000000, HEADER, layout, NULL, TAIL(spring_nodes) },
        { SHEET, SET, MESH_HEADER, TAIL(spring_entries), 1, HEADER, layout, "spring_ends",
          ENTRY(MESH_SPRING_ENDS, name) },
        /* check_nodes */
        { VOLUME, SET, MESH_SPRING_REST, 1, bits_of(2.01e6f), ALL, finite, NULL, THERE },
        { SHEET, SET, MESH_SPRING_MASS, 3, nan, ALL, finite, NULL, THERE },
        { SHEET, SET, MESH_SPRING_MASS, -1, bits_of(1e-16f), ALL, finite, NULL, THERE },
        { SHEET, SET, MESH_SPRING_DRAG, 7, bits_of(-0.5f), ALL, finite, NULL, THERE },
        { SHEET, SET, MESH_SPRING_MASS, 2, 0, ALL, finite, "header", TAIL(fixed_nodes) },
        /* check_slices */
        { SHEET, SET, MESH_SPRING_FIRST, 1, entries + 1, ALL, index, NULL,
          (int64_t)sheet.section[MESH_SPRING_FIRST].offset + 8 },
        { SHEET, SET, MESH_SPRING_FIRST, 1, 1025, ALL, index, NULL, THERE },
        { SHEET, SET, MESH_SPRING_FIRST, 0, 1, ALL, index, NULL, THERE },
        { SHEET, SET, MESH_SPRING_FIRST, -1, entries - 1, ALL, index, NULL, THERE },
        /* check_rows: no node, twice the same, beyond the last node */
        { SHEET, SET, MESH_SPRING_ENDS, last, 22, ALL, index, NULL, THERE },
        { SHEET, SET, MESH_SPRING_ENDS, 16, word_of(SHEET, MESH_SPRING_ENDS, 0), ALL, index, NULL, THERE },
        { SHEET, SET, MESH_SPRING_ENDS, -1, 0, ALL, index, NULL, THERE },
        /* check_spring_numbers: of a spring, and of none */
        { SHEET, SET, MESH_SPRING_STIFFNESS, 0, nan, ALL, finite, NULL, THERE },
        { SHEET, SET, MESH_SPRING_STIFFNESS, -1, bits_of(1.0f), ALL, finite, NULL, THERE },
        { VOLUME, SET, MESH_SPRING_LENGTH, 0, 0, ALL, finite, NULL, THERE },
        { SHEET, SET, MESH_SPRING_LENGTH, -1, 0, ALL, finite, NULL, THERE },
        /* check_symmetry */
        { SHEET, SET, MESH_SPRING_ENDS, last, word_of(SHEET, MESH_SPRING_ENDS, last) + 1, ALL, index, NULL, THERE },
        { SHEET, SET, MESH_SPRING_STIFFNESS, 0, bits_of(0.5f), ALL, finite, NULL, THERE },
        { SHEET, SET, MESH_SPRING_LENGTH, 0, bits_of(0.5f), ALL, finite, "spring_stiff", first_stiffness },
        { SHEET, SET, MESH_HEADER, TAIL(springs), mesh_tail(&sheet).springs + 1, HEADER, index, NULL, THERE },
        /* check_step: upper halves of doubles */
        { SHEET, SET, MESH_HEADER, TAIL(viscosity) + upper, 0x7ff00000, HEADER, finite, NULL, TAIL(viscosity) },
        { SHEET, SET, MESH_HEADER, TAIL(spring_mass) + upper, 0xbff00000, HEADER, finite, NULL, TAIL(viscosity) },
        { SHEET, SET, MESH_HEADER, TAIL(poisson) + upper, 0x3fe33333, HEADER, finite, NULL, TAIL(viscosity) },
        { SHEET, SET, MESH_HEADER, TAIL(stable_step) + upper, 0xbff00000, HEADER, finite, NULL, TAIL(viscosity) },
        { SHEET, SET, MESH_HEADER, TAIL(stable_step) + upper, 0x40000000, HEADER, finite, NULL, TAIL(stable_step) },
        { VOLUME, SET, MESH_SPRING_MASS, 5, bits_of(1e-9f), ALL, finite, "header", TAIL(stable_step) },
    };
    add_rows(rows, sizeof rows / sizeof *rows);
}

/* Cells with a term for their volume: a file of the newest version. */
static void add_cell_rows(void)
{
    const dpt_result layout = DPT_E_LAYOUT, index = DPT_E_INDEX, finite = DPT_E_FINITE;
    const uint32_t upper = host_is_little() ? 4 : 0, cells = (uint32_t)header_of(&wholes[CELLS]).tail.cells;
    const int64_t first = (int64_t)header_of(&wholes[CELLS]).section[MESH_CELL_NODES].offset;
    const struct damage rows[] = {
        /* check_layout */
        { CELLS, SET, MESH_HEADER, AT(tail.cells) + 4, 1, HEADER, layout, NULL, AT(tail.spring_nodes) },
        { CELLS, SET, MESH_HEADER, AT(tail.cells), cells + 16, HEADER, layout, "cell_nodes",
          ENTRY(MESH_CELL_NODES, name) },
        /* check_cells: a node that is not there, one that is no neighbour, the same twice; numbers */
        { CELLS, SET, MESH_CELL_NODES, -1, 0x7fffffff, ALL, index, NULL, THERE },
        { CELLS, SET, MESH_CELL_NODES, 0, word_of(CELLS, MESH_CELL_NODES, 16 * 3), ALL, index, NULL, first },
        { CELLS, SET, MESH_HEADER, AT(tail.cell_size) + upper, 0, HEADER, finite, NULL, AT(tail.cell_size) },
        { CELLS, SET, MESH_HEADER, AT(tail.poisson) + upper, 0x3fde0000, HEADER, finite, NULL, AT(tail.cell_size) },
        { CELLS, SET, MESH_CELL_STIFFNESS, 0, 0, ALL, finite, NULL, THERE },
        { CELLS, SET, MESH_CELL_STIFFNESS, -1, bits_of(1.0f), ALL, finite, NULL, THERE },
    };
    add_rows(rows, sizeof rows / sizeof *rows);
}

static void each_check_has_its_damage(void)
{
    add_header_rows();
    add_layout_rows();
    add_section_rows();
    add_spring_rows();
    add_cell_rows();
    for (size_t row = 0; row < table_rows; row++) {
        expect_row(&table[row], row);
        for (size_t other = 0; other < row; other++)
            CHECK(memcmp(&table[row], &table[other], sizeof *table), "row %zu is row %zu", row, other);
    }
}

static void no_check_is_forgotten(void)
{
    site_expect_all(reader, 46);
}

static void whole_files_pass_all(void)
{
    for (int i = 0; i < WHOLES; i++) {
        site = 0;
        CHECK(dpt_mesh_verify(wholes[i].bytes, wholes[i].size, NULL) == DPT_OK && !site, "file %d", i);
    }
}

static struct file open_golden(const char *path)
{
    struct file file = { malloc(1 << 14), 0 };
    FILE *stream = fopen(path, "rb");
    if (stream) {
        file.size = fread(file.bytes, 1, 1 << 14, stream);
        fclose(stream);
        dpt_mesh_convert(file.bytes, file.size, NULL);
    }
    return file;
}

int main(int argc, char **argv)
{
    if (argc > 1)
        reader = argv[1];
    wholes[PLAIN] = file_of_shape("sphere", 40);
    wholes[HOLED] = file_of_holed_shape("sphere", 40, 1);
    wholes[EMBEDDED] = file_of_embedded_shape("sphere", 40);
    wholes[SHEET] = file_of_sprung_shape("sphere", 40, DPT_NET_SHEET);
    wholes[VOLUME] = file_of_sprung_shape("sphere", 40, DPT_NET_VOLUME);
    wholes[CELLS] = file_of_bulging_shape("sphere", 40, 0.45);
    wholes[MOVED] = file_of_moved_shape("sphere", 40);
    wholes[OLD] = open_golden("tests/golden/torus.dpa");
    wholes[OLD_4] = open_golden("tests/golden/torus_4.dpa");
    TEST(whole_files_pass_all);
    TEST(each_check_has_its_damage);
    TEST(no_check_is_forgotten);
    for (int i = 0; i < WHOLES; i++)
        free(wholes[i].bytes);
    return check_report();
}
