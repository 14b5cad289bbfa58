/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Compiled meshes: what is whole opens, and nothing else does; no damage, however made, is read beyond the bytes.
 *
 *     test_mesh [PER CENT [GOLDEN]]
 *
 * PER CENT is how many of the bytes behind the header are changed or cut off, one by one. GOLDEN is the folder golden;
 * from the top of the tree it is found without. Its files were made by
 *
 *     build/dynpoint make torus 96 -o tests/golden/torus.ply
 *     build/dynpoint compile tests/golden/torus.ply -o tests/golden/torus_6.dpa
 *     build/dynpoint compile tests/golden/torus.ply -o tests/golden/torus_6_nodes.dpa --nodes tests/golden/torus
 *     build/dynpoint compile tests/golden/torus.ply -o tests/golden/torus_6_sheet.dpa --springs sheet --bending 100
 *     build/dynpoint compile tests/golden/torus.ply -o tests/golden/torus_6_volume.dpa --springs volume --spacing 0.05
 *     build/dynpoint compile tests/golden/torus_far.ply -o tests/golden/torus_7.dpa --recentre
 *     build/dynpoint compile tests/golden/torus.ply -o tests/golden/torus_7_cells.dpa --springs volume --spacing 0.05 \
 *         --poisson 0.45
 *
 * torus_far.ply is torus.ply, 1000 m away. torus.dpa to torus_5_nodes.dpa by compilers of versions 1 to 5. They are to be
 * kept: a new format gets a new file beside them, for every version must always open. torus.node and torus.ele are a cube
 * about the torus, cut in six.
 *
 * All tests start from a file in the host's byte order, and so hold on every machine.
 */
#define _GNU_SOURCE
#include <math.h>
#include <sys/mman.h>

#include "compile/read_tetgen.h"
#include "mesh/mesh_checks.h"

static const char *golden = "tests/golden";

static void whole_files_open(void)
{
    const struct file *files[] = { &small_file, &large_file };
    for (int i = 0; i < 2; i++) {
        struct dpt_mesh header = header_of(files[i]);
        const dpt_mesh *mesh = (const dpt_mesh *)(const void *)files[i]->bytes;
        dpt_mesh_info info = { .size = sizeof info };
        dpt_mesh_section section = { .size = sizeof section };
        uint32_t id = 0;
        CHECK(fault_of(files[i]).code == DPT_OK, "file %d", i);
        CHECK(dpt_mesh_get_info(mesh, &info) == DPT_OK, "file %d", i);
        CHECK(info.bytes == files[i]->size && info.triangles == (i ? 600 : 40) &&
                  info.tree_levels == 1u + (uint32_t)i && info.format_version == MESH_VERSION_PLAIN,
              "%u triangles, %u levels", info.triangles, info.tree_levels);
        for (; dpt_mesh_get_section(mesh, id, &section) == DPT_OK; id++) {
            CHECK(section.offset == header.section[id].offset && section.offset % 64 == 0 &&
                      section.bytes == header.section[id].bytes,
                  "section %u", id);
            CHECK(section.crc32 == crc_of(files[i]->bytes + section.offset, (size_t)section.bytes), "%s", section.name);
        }
        CHECK((int)id == PLAIN_SECTIONS, "%u sections", id);
    }
}

/* Each length that is too short; a file in the other byte order is cut short likewise. */
static void truncations_are_refused(void)
{
    const struct file *files[] = { &small_file, &large_file, &holed_file, &embedded_file, &sheet_file, &volume_file };
    const size_t step = 100 / check_percent;
    for (int i = 0; i < 6; i++)
        for (size_t size = 0; size < files[i]->size; size += size < sizeof(struct dpt_mesh) ? 1 : step) {
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
        struct file file = { calloc(1, small_file.size + more), small_file.size + more };
        memcpy(file.bytes, small_file.bytes, small_file.size);
        expect_fault(&file, DPT_E_TRAILING, small_file.size, "header");
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
        CHECK(at >= 8 || fault.code == DPT_E_MAGIC, "byte %zu: %s", at, dpt_result_name(fault.code));
        return;
    }
    dpt_result code = id < 0 ? DPT_E_LAYOUT : DPT_E_CHECKSUM;
    uint64_t byte = id < 0 ? at : header->section[id].offset;
    CHECK(fault.code == code && fault.byte == byte && !strcmp(fault.section, section_name_at(header, at)),
          "byte %zu: %s at %llu (%s)", at, dpt_result_name(fault.code), (unsigned long long)fault.byte, fault.section);
}

static void changed_bytes_are_refused(void)
{
    const struct file *files[] = { &small_file, &large_file, &holed_file, &embedded_file, &sheet_file, &volume_file };
    for (int i = 0; i < 6; i++) {
        struct dpt_mesh header = header_of(files[i]);
        struct file file = copy_of(files[i]);
        const size_t past_header = header_bytes_of(&header), step = 100 / check_percent;
        for (size_t at = 0; at < file.size; at += at < past_header ? 1 : step)
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
        struct file file = copy_of(&small_file);
        memcpy(file.bytes, texts[i], sizeof texts[i]);
        expect_fault(&file, DPT_E_MAGIC, 0, "header");
        CHECK(dpt_mesh_convert(file.bytes, file.size, NULL) == DPT_E_MAGIC, "text %zu", i);
        free(file.bytes);
    }
    /* All of a file, each LF made CR LF. */
    struct file file = { malloc(2 * small_file.size), 0 };
    for (size_t i = 0; i < small_file.size; i++) {
        if (small_file.bytes[i] == '\n')
            file.bytes[file.size++] = '\r';
        file.bytes[file.size++] = small_file.bytes[i];
    }
    expect_fault(&file, DPT_E_MAGIC, 0, "header");
    free(file.bytes);
}

static void misaligned_bytes_are_refused(void)
{
    unsigned char *block = malloc(small_file.size + 16);
    for (size_t shift = 0; shift <= 8; shift++) {
        struct file file = { block + shift, small_file.size };
        memcpy(file.bytes, small_file.bytes, small_file.size);
        if (shift % 8 == 0)
            CHECK(fault_of(&file).code == DPT_OK, "shift %zu", shift);
        else
            expect_fault(&file, DPT_E_ALIGN, 0, "header");
        CHECK(dpt_mesh_convert(file.bytes, file.size, NULL) == (shift % 8 ? DPT_E_ALIGN : DPT_OK), "shift %zu", shift);
    }
    free(block);
}

static void wrong_arguments_are_refused(void)
{
    struct file *file = &small_file;
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
    CHECK(dpt_mesh_get_info(mesh, &info) == DPT_OK && info.triangles == 40 && info.solid_components == 77,
          "info of 160 bytes");
    info = (dpt_mesh_info){ .size = 176, .crease = 77.0 };
    CHECK(dpt_mesh_get_info(mesh, &info) == DPT_OK && info.solid_components == 1 && info.crease == 77.0,
          "info of 176 bytes");
    info = (dpt_mesh_info){ .size = 192, .self_intersections = 77 };
    CHECK(dpt_mesh_get_info(mesh, &info) == DPT_OK && info.crease > 0.0 && info.self_intersections == 77,
          "info of 192 bytes");
    info = (dpt_mesh_info){ .size = 208, .nodes = 77 };
    CHECK(dpt_mesh_get_info(mesh, &info) == DPT_OK && info.self_intersections == 0 && info.nodes == 77,
          "info of 208 bytes");
    info = (dpt_mesh_info){ .size = 224, .spring_nodes = 77 };
    CHECK(dpt_mesh_get_info(mesh, &info) == DPT_OK && info.nodes == 0 && info.spring_nodes == 77, "info of 224 bytes");
    info.size = sizeof info;
    CHECK(dpt_mesh_get_info(mesh, &info) == DPT_OK && info.crease == 3.14159265358979323846 / 3.0, "creases of %.17g",
          info.crease);
    for (uint32_t t = 0; t < 43; t += t < 39 ? 39 : 1) {
        uint32_t flags = 77;
        dpt_result wanted = t < 40 ? DPT_OK : DPT_E_ARGUMENT;
        CHECK(dpt_mesh_get_triangle_flags(mesh, t, &flags) == wanted && (flags == 77) == (t >= 40) &&
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
    CHECK(dpt_mesh_get_section(mesh, 24, &section) == DPT_E_ARGUMENT, "there are 24 sections");
    CHECK(dpt_mesh_get_section(mesh, UINT32_MAX, &section) == DPT_E_ARGUMENT, "no such section");
    CHECK(dpt_mesh_get_triangle(NULL, 0, corners) == DPT_E_ARGUMENT, "no mesh");
    CHECK(dpt_mesh_get_triangle(mesh, 0, NULL) == DPT_E_ARGUMENT, "no corners");
    CHECK(dpt_mesh_get_triangle(mesh, 40, corners) == DPT_E_ARGUMENT, "there are 40 triangles");
    CHECK(dpt_mesh_get_triangle(mesh, UINT32_MAX, corners) == DPT_E_ARGUMENT, "no such triangle");
    CHECK(corners[0] == 77.0, "a refused call wrote");
}

static void wrong_arguments_of_arrays_are_refused(void)
{
    const dpt_mesh *mesh = (const dpt_mesh *)(const void *)embedded_file.bytes;
    const uint32_t *sources = NULL, *nodes = NULL;
    const float *weights = NULL;
    uint32_t count = 77, node_count = 77;
    CHECK(dpt_mesh_get_vertex_sources(NULL, &sources, &count) == DPT_E_ARGUMENT &&
              dpt_mesh_get_vertex_sources(mesh, NULL, &count) == DPT_E_ARGUMENT &&
              dpt_mesh_get_vertex_sources(mesh, &sources, NULL) == DPT_E_ARGUMENT,
          "NULL");
    CHECK(dpt_mesh_get_embedding(NULL, &nodes, &weights, &node_count) == DPT_E_ARGUMENT &&
              dpt_mesh_get_embedding(mesh, NULL, &weights, &node_count) == DPT_E_ARGUMENT &&
              dpt_mesh_get_embedding(mesh, &nodes, NULL, &node_count) == DPT_E_ARGUMENT &&
              dpt_mesh_get_embedding(mesh, &nodes, &weights, NULL) == DPT_E_ARGUMENT,
          "NULL");
    CHECK(!sources && !nodes && !weights && count == 77 && node_count == 77, "a refusal wrote");
    CHECK(dpt_mesh_get_vertex_sources(mesh, &sources, &count) == DPT_OK && sources && count == 22, "%u vertices",
          count);
    CHECK(dpt_mesh_get_embedding(mesh, &nodes, &weights, &node_count) == DPT_OK && nodes && weights && node_count == 27,
          "%u nodes", node_count);
    dpt_mesh_info info = { .size = sizeof info };
    CHECK(dpt_mesh_get_info(mesh, &info) == DPT_OK && info.nodes == 27 && info.outside_vertices > 0 &&
              info.outside_vertices <= info.vertices && info.outside_distance > 1e-3,
          "%u vertices outside, %g m", info.outside_vertices, info.outside_distance);
    mesh = (const dpt_mesh *)(const void *)small_file.bytes;
    CHECK(dpt_mesh_get_embedding(mesh, &nodes, &weights, &node_count) == DPT_OK && !nodes && !weights &&
              node_count == 0,
          "%u nodes where there are none", node_count);
}

static void wrong_arguments_of_springs_are_refused(void)
{
    const dpt_mesh *mesh = (const dpt_mesh *)(const void *)sheet_file.bytes;
    dpt_mesh_springs net = { .size = sizeof net - 1, .nodes = 77 };
    CHECK(dpt_mesh_get_springs(NULL, &net) == DPT_E_ARGUMENT && dpt_mesh_get_springs(mesh, NULL) == DPT_E_ARGUMENT &&
              dpt_mesh_get_springs(mesh, &net) == DPT_E_SIZE && net.nodes == 77,
          "refused otherwise, or a refusal wrote");
    net.size = sizeof net;
    CHECK(dpt_mesh_get_springs(mesh, &net) == DPT_OK && net.nodes == 22 && net.slices == 2 && net.viscosity == 0.001 &&
              net.drag[21] == 0.5f,
          "%u nodes, %u slices", net.nodes, net.slices);
    mesh = (const dpt_mesh *)(const void *)small_file.bytes;
    CHECK(dpt_mesh_get_springs(mesh, &net) == DPT_OK && !net.nodes && !net.springs && !net.first && !net.rest &&
              !net.neighbours,
          "%u nodes where there are none", net.nodes);
}

static void other_byte_order_converts(void)
{
    const struct file *files[] = { &small_file, &large_file, &holed_file, &embedded_file, &sheet_file, &volume_file };
    for (int i = 0; i < 6; i++) {
        struct file other = other_order(files[i]);
        dpt_mesh_fault fault = { .size = sizeof fault };
        expect_fault(&other, DPT_E_BYTE_ORDER, AT(byte_order), "header");
        CHECK(dpt_mesh_convert(other.bytes, other.size, &fault) == DPT_OK, "%d in %s", fault.code, fault.section);
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
    struct file whole = other_order(&small_file);
    struct dpt_mesh header = header_of(&small_file);
    for (size_t at = 0; at < whole.size; at++) {
        struct file cut = file_of(whole.bytes, at), file = copy_of(&whole);
        dpt_mesh_fault fault = { .size = sizeof fault };
        CHECK(dpt_mesh_convert(cut.bytes, at, NULL) == DPT_E_TRUNCATED, "%zu bytes", at);
        CHECK(!memcmp(cut.bytes, whole.bytes, at), "%zu bytes changed", at);
        file.bytes[at] ^= 0x10;
        CHECK(dpt_mesh_convert(file.bytes, file.size, &fault) != DPT_OK, "byte %zu", at);
        CHECK(!strcmp(fault.section, section_name_at(&header, at)), "byte %zu: %s", at, fault.section);
        file.bytes[at] ^= 0x10;
        CHECK(!memcmp(file.bytes, whole.bytes, file.size), "byte %zu: changed", at);
        free(cut.bytes);
        free(file.bytes);
    }
    /* Forged before it was turned round: found behind the conversion. */
    struct file forged = copy_of(&small_file);
    uint64_t at = header.section[MESH_TRIANGLES].offset + 8;
    memset(forged.bytes + at, 0xff, 4);
    seal(&forged);
    struct file other = other_order(&forged);
    dpt_mesh_fault fault = { .size = sizeof fault };
    CHECK(dpt_mesh_convert(other.bytes, other.size, &fault) == DPT_E_INDEX && fault.byte == at, "%s at %llu",
          dpt_result_name(fault.code), (unsigned long long)fault.byte);
    free(forged.bytes);
    free(other.bytes);
    free(whole.bytes);
}

static struct file read_golden(const char *name)
{
    char path[512];
    struct file file = { malloc(1 << 16), 0 };
    snprintf(path, sizeof path, "%s/%s", golden, name);
    FILE *stream = fopen(path, "rb");
    if (stream) {
        file.size = fread(file.bytes, 1, 1 << 16, stream);
        fclose(stream);
    }
    CHECK(file.size > 0 && file.size < 1 << 16, "%s: %zu bytes", path, file.size);
    return file;
}

/* The compiler writes the same bytes, but for its own version. */
static void expect_golden(const char *from, const char *name, const dpt_compile_def *def)
{
    struct file source = read_golden(from), kept = read_golden(name);
    dpt_compiled compiled;
    if (source.size && kept.size > sizeof(struct dpt_mesh) &&
        dpt_compile_bytes(source.bytes, source.size, def, &compiled, NULL) == DPT_OK) {
        struct file today = file_of(compiled.bytes, compiled.size);
        dpt_compiled_free(&compiled);
        CHECK(kept.size == today.size, "%zu bytes, not %zu", today.size, kept.size);
        dpt_mesh_convert(today.bytes, today.size, NULL);
        dpt_mesh_convert(kept.bytes, kept.size, NULL);
        CHECK(fault_of(&kept).code == DPT_OK, "does not open");
        memcpy(kept.bytes + AT(writer_version), today.bytes + AT(writer_version), 4);
        seal(&kept);
        CHECK(kept.size == today.size && !memcmp(kept.bytes, today.bytes, kept.size),
              "%s: the compiler writes other bytes", name);
        free(today.bytes);
    } else {
        CHECK(0, "%s cannot be read", name);
    }
    free(source.bytes);
    free(kept.bytes);
}

static void golden_files_are_what_we_write(void)
{
    struct file node = read_golden("torus.node"), ele = read_golden("torus.ele");
    dpt_diag diag = { .size = sizeof diag };
    struct tetgen mesh = { .nodes = NULL };
    struct compile_context context;
    expect_golden("torus.ply", "torus_6.dpa", NULL);
    compile_context_init(&context, NULL, &diag);
    CHECK(tetgen_read_nodes(&mesh, &context, node.bytes, node.size) == DPT_OK &&
              tetgen_read_cells(&mesh, &context, ele.bytes, ele.size) == DPT_OK,
          "%s", diag.text);
    const dpt_compile_def def = { .size = sizeof def,
                                  .nodes = mesh.nodes,
                                  .cells = mesh.cells,
                                  .node_count = mesh.node_count,
                                  .cell_count = mesh.cell_count };
    expect_golden("torus.ply", "torus_6_nodes.dpa", &def);
    const dpt_spring_net_def sheet = { .size = sizeof sheet, .kind = DPT_NET_SHEET, .bending = 100.0 };
    const dpt_spring_net_def volume = { .size = sizeof volume, .kind = DPT_NET_VOLUME, .spacing = 0.05 };
    dpt_compile_def with_springs = { .size = sizeof with_springs, .springs = &sheet };
    expect_golden("torus.ply", "torus_6_sheet.dpa", &with_springs);
    with_springs.springs = &volume;
    expect_golden("torus.ply", "torus_6_volume.dpa", &with_springs);
    const dpt_spring_net_def cells = { .size = sizeof cells, .kind = DPT_NET_VOLUME, .spacing = 0.05, .poisson = 0.45 };
    with_springs.springs = &cells;
    expect_golden("torus.ply", "torus_7_cells.dpa", &with_springs);
    const dpt_compile_def moved = { .size = sizeof moved, .recentre = 1 };
    expect_golden("torus_far.ply", "torus_7.dpa", &moved);
    tetgen_free(&mesh);
    free(node.bytes);
    free(ele.bytes);
}

/* The shape is the golden file's source: only its float vertices went through that file. */
static void golden_shape_is_what_we_make(void)
{
    struct file kept = read_golden("torus_6.dpa"), shape = file_of_shape("torus", 96);
    dpt_mesh_convert(kept.bytes, kept.size, NULL);
    CHECK(shape.size == kept.size &&
              !memcmp(shape.bytes + PLAIN_HEADER, kept.bytes + PLAIN_HEADER, kept.size - PLAIN_HEADER),
          "the shape has changed");
    free(shape.bytes);
    free(kept.bytes);
}

/* An old file against the same mesh of today: its findings, as far as it has them, and the same answers. */
static void answer_alike(const struct file *old, const struct file *today, uint32_t version)
{
    const dpt_mesh *meshes[2] = { NULL, NULL };
    dpt_mesh_info info = { .size = sizeof info };
    dpt_mesh_section section = { .size = sizeof section };
    const uint32_t counts[] = { 0, 11, 12, 14, 14, 17, 24, 26 }, sections = counts[version];
    uint32_t flags, vertices, nodes;
    const uint32_t *numbers, *embed_nodes;
    const float *weights;
    uint64_t random = 5;
    if (dpt_mesh_open(old->bytes, old->size, &meshes[0]) != DPT_OK ||
        dpt_mesh_open(today->bytes, today->size, &meshes[1]) != DPT_OK) {
        CHECK(0, "version %u does not open", version);
        return;
    }
    dpt_mesh_get_info(meshes[0], &info);
    CHECK(info.format_version == version && info.solid_components == 1 && !info.cavities && !info.winding_components &&
              !info.buried_components,
          "version %u, %u solid", info.format_version, info.solid_components);
    CHECK((info.crease > 0.0) == (version > 2), "version %u has creases of %g", version, info.crease);
    CHECK(info.self_intersections == (version > 3 ? 0 : DPT_NONE) && !info.self_intersections_more &&
              info.self_intersection[0] == DPT_NONE && info.self_intersection[1] == DPT_NONE,
          "version %u has %u self-intersections", version, info.self_intersections);
    CHECK(mesh_part_flags(meshes[0], 0) == 15 && mesh_part_flags(meshes[1], 0) == 15, "flags %u, %u",
          mesh_part_flags(meshes[0], 0), mesh_part_flags(meshes[1], 0));
    CHECK(dpt_mesh_get_section(meshes[0], sections - 1, &section) == DPT_OK &&
              dpt_mesh_get_section(meshes[0], sections, &section) == DPT_E_ARGUMENT,
          "version %u has not %u sections", version, sections);
    CHECK(dpt_mesh_get_triangle_flags(meshes[0], 0, &flags) == (version > 2 ? DPT_OK : DPT_E_UNSUPPORTED),
          "flags of version %u", version);
    CHECK(dpt_mesh_get_vertex_sources(meshes[0], &numbers, &vertices) == (version > 4 ? DPT_OK : DPT_E_UNSUPPORTED),
          "vertex sources of version %u", version);
    CHECK(dpt_mesh_get_embedding(meshes[0], &embed_nodes, &weights, &nodes) == DPT_OK && nodes == info.nodes &&
              !info.outside_vertices && info.outside_distance == 0.0,
          "version %u has %u nodes", version, nodes);
    dpt_mesh_springs net = { .size = sizeof net, .nodes = 77 };
    CHECK(dpt_mesh_get_springs(meshes[0], &net) == DPT_OK && net.nodes == info.spring_nodes &&
              (net.nodes == 0 || version > 5),
          "version %u has springs of %u nodes", version, net.nodes);
    for (uint32_t t = 0; t < info.triangles; t++) {
        double normals[2][9];
        for (int m = 0; m < 2; m++)
            CHECK(dpt_mesh_get_vertex_normals(meshes[m], t, normals[m]) == DPT_OK, "triangle %u", t);
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
    use_mesh(meshes[0], &random);
}

/* A mesh that was moved knows from where. */
static void expect_origin(const struct file *file, const double origin[3])
{
    dpt_mesh_info info = { .size = sizeof info };
    const dpt_mesh *mesh;
    CHECK(dpt_mesh_open(file->bytes, file->size, &mesh) == DPT_OK && dpt_mesh_get_info(mesh, &info) == DPT_OK,
          "does not open");
    CHECK(info.format_version == 7 && !memcmp(info.origin, origin, sizeof info.origin), "from %g %g %g", info.origin[0],
          info.origin[1], info.origin[2]);
}

/* Every version opens forever, in either byte order, and is checked as today's is. */
static void all_versions_open(void)
{
    const struct {
        const char *name;
        uint32_t version;
    } files[] = {
        { "torus.dpa", 1 },         { "torus_2.dpa", 2 },        { "torus_3.dpa", 3 }, { "torus_4.dpa", 4 },
        { "torus_5.dpa", 5 },       { "torus_5_nodes.dpa", 5 },  { "torus_6.dpa", 6 }, { "torus_6_nodes.dpa", 6 },
        { "torus_6_sheet.dpa", 6 }, { "torus_6_volume.dpa", 6 }, { "torus_7.dpa", 7 }, { "torus_7_cells.dpa", 7 },
    };
    struct file today = file_of_shape("torus", 96);
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        struct file old = read_golden(files[i].name);
        dpt_mesh_convert(old.bytes, old.size, NULL);
        CHECK(fault_of(&old).code == DPT_OK, "does not open");
        if (!strcmp(files[i].name, "torus_7.dpa"))
            expect_origin(&old, (const double[3]){ 1000.0, 0.0, 0.0 });
        else
            answer_alike(&old, &today, files[i].version);
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
        CHECK(dpt_mesh_convert(other.bytes, other.size, NULL) == DPT_OK && !memcmp(other.bytes, old.bytes, old.size),
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
    size_t room = (large_file.size + 65535) / 65536 * 65536;
    unsigned char *pages = mmap(NULL, room, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    CHECK(pages != MAP_FAILED, "no pages");
    if (pages == MAP_FAILED)
        return;
    memcpy(pages, large_file.bytes, large_file.size);
    CHECK(mprotect(pages, room, PROT_READ) == 0, "still writable");
    const dpt_mesh *mesh;
    CHECK(dpt_mesh_open(pages, large_file.size, &mesh) == DPT_OK, "does not open");
    /* In the host's order already, so that there is nothing to convert. */
    CHECK(dpt_mesh_convert(pages, large_file.size, NULL) == DPT_OK, "does not convert");
    for (int i = 0; i < 50; i++)
        use_mesh(mesh, &random);
    munmap(pages, room);
}

int main(int argc, char **argv)
{
    take_percent(argc, argv);
    if (argc > 2)
        golden = argv[2];
    if (!open_files())
        return 1;
    TEST(whole_files_open);
    TEST(truncations_are_refused);
    TEST(trailing_bytes_are_refused);
    TEST(changed_bytes_are_refused);
    TEST(other_files_are_refused);
    TEST(misaligned_bytes_are_refused);
    TEST(wrong_arguments_are_refused);
    TEST(wrong_arguments_of_arrays_are_refused);
    TEST(wrong_arguments_of_springs_are_refused);
    TEST(other_byte_order_converts);
    TEST(other_byte_order_is_checked);
    TEST(golden_files_are_what_we_write);
    TEST(golden_shape_is_what_we_make);
    TEST(all_versions_open);
    TEST(read_only_memory_is_enough);
    free_files();
    return check_report();
}
