/* SPDX-License-Identifier: BSD-3-Clause */
#include "lib/dpa.h"

/* The def with the nodes and cells of a block of eight cubes, -0.05..0.05 m, six tetrahedra each. */
static dpt_compile_def def_with_cells(double nodes[3 * 27], uint32_t cells[4 * 48])
{
    static const uint32_t steps[6][3] = {
        { 1, 3, 9 }, { 1, 9, 3 }, { 3, 1, 9 }, { 3, 9, 1 }, { 9, 1, 3 }, { 9, 3, 1 }
    };
    for (uint32_t i = 0; i < 27; i++) {
        nodes[3 * i] = 0.05 * (i % 3) - 0.05;
        nodes[3 * i + 1] = 0.05 * (i / 3 % 3) - 0.05;
        nodes[3 * i + 2] = 0.05 * (i / 9) - 0.05;
    }
    for (uint32_t i = 0; i < 48; i++) {
        const uint32_t cube = i / 6, *step = steps[i % 6];
        uint32_t node = cube % 2 + 3 * (cube / 2 % 2) + 9 * (cube / 4);
        for (uint32_t k = 0; k < 4; k++) {
            cells[4 * i + k] = node;
            node += k < 3 ? step[k] : 0;
        }
    }
    return (dpt_compile_def){
        .size = sizeof(dpt_compile_def), .nodes = nodes, .cells = cells, .node_count = 27, .cell_count = 48
    };
}

static struct file file_of_compiled_shape(const char *name, uint64_t count, size_t missing, const dpt_compile_def *def)
{
    struct shape shape;
    shape_reason reason;
    dpt_compiled compiled = { NULL, 0 };
    if (shape_make(name, count, 0, &shape, reason) == 0)
        dpt_compile_arrays(shape.vertices, shape.vertex_count, shape.corners, shape.triangle_count - missing, def,
                           &compiled, NULL);
    shape_free(&shape);
    struct file file = file_of(compiled.bytes, compiled.size);
    dpt_compiled_free(&compiled);
    dpt_mesh_convert(file.bytes, file.size, NULL);
    return file;
}

struct file file_of_holed_shape(const char *name, uint64_t count, size_t missing)
{
    return file_of_compiled_shape(name, count, missing, NULL);
}

struct file file_of_embedded_shape(const char *name, uint64_t count)
{
    double nodes[3 * 27];
    uint32_t cells[4 * 48];
    const dpt_compile_def def = def_with_cells(nodes, cells);
    return file_of_compiled_shape(name, count, 0, &def);
}

static struct file file_of_springs(const char *name, uint64_t count, uint32_t kind, double poisson)
{
    const dpt_spring_net_def springs = {
        .size = sizeof springs, .kind = kind, .drag = 0.5, .viscosity = 0.001, .spacing = 0.05, .poisson = poisson
    };
    const dpt_compile_def def = { .size = sizeof def, .springs = &springs };
    return file_of_compiled_shape(name, count, 0, &def);
}

struct file file_of_sprung_shape(const char *name, uint64_t count, uint32_t kind)
{
    return file_of_springs(name, count, kind, 0.0);
}

struct file file_of_bulging_shape(const char *name, uint64_t count, double poisson)
{
    return file_of_springs(name, count, DPT_NET_VOLUME, poisson);
}

struct file file_of_moved_shape(const char *name, uint64_t count)
{
    struct shape shape;
    shape_reason reason;
    dpt_compiled compiled = { NULL, 0 };
    const dpt_compile_def def = { .size = sizeof def, .recentre = 1 };
    if (shape_make(name, count, 0, &shape, reason) == 0) {
        for (size_t v = 0; v < shape.vertex_count; v++)
            shape.vertices[3 * v] += 1000.0;
        dpt_compile_arrays(shape.vertices, shape.vertex_count, shape.corners, shape.triangle_count, &def, &compiled,
                           NULL);
    }
    shape_free(&shape);
    struct file file = file_of(compiled.bytes, compiled.size);
    dpt_compiled_free(&compiled);
    dpt_mesh_convert(file.bytes, file.size, NULL);
    return file;
}

uint32_t crc_of(const unsigned char *bytes, size_t size)
{
    uint32_t crc = 0xffffffffu;
    while (size--) {
        crc ^= *bytes++;
        for (int bit = 0; bit < 8; bit++)
            crc = (crc >> 1) ^ (crc & 1 ? 0xedb88320u : 0);
    }
    return ~crc;
}

size_t header_bytes_of(const struct dpt_mesh *header)
{
    return header->version == 1   ? 752
           : header->version == 2 ? 816
           : header->version == 3 ? 928
           : header->version == 4 ? 944
           : header->version == 5 ? 1104
           : header->version == 6 ? 1488
                                  : 1624;
}

static int sections_of(const struct dpt_mesh *header)
{
    return header->version == 1   ? 11
           : header->version == 2 ? 12
           : header->version < 5  ? 14
           : header->version == 5 ? 17
           : header->version == 6 ? 24
                                  : 26;
}

void seal_header(struct file *file)
{
    struct dpt_mesh header = header_of(file);
    header.header_crc32 = 0;
    memcpy(file->bytes, &header, sizeof header);
    header.header_crc32 = crc_of(file->bytes, header_bytes_of(&header));
    memcpy(file->bytes, &header, sizeof header);
}

void seal(struct file *file)
{
    struct dpt_mesh header = header_of(file);
    for (int id = 0; id < sections_of(&header); id++) {
        struct mesh_section *section = &header.section[id];
        if (section->offset <= file->size && section->bytes <= file->size - section->offset)
            section->crc32 = crc_of(file->bytes + section->offset, (size_t)section->bytes);
    }
    memcpy(file->bytes, &header, sizeof header);
    seal_header(file);
}

int section_at(const struct dpt_mesh *header, uint64_t byte)
{
    if (byte < header_bytes_of(header))
        return MESH_SECTION_COUNT;
    for (int id = 0; id < sections_of(header); id++)
        if (byte >= header->section[id].offset && byte < header->section[id].offset + header->section[id].bytes)
            return id;
    return -1;
}

void reverse(unsigned char *bytes, size_t width, size_t count)
{
    for (; count; count--, bytes += width)
        for (size_t i = 0; i < width / 2; i++) {
            unsigned char t = bytes[i];
            bytes[i] = bytes[width - 1 - i];
            bytes[width - 1 - i] = t;
        }
}

struct file other_order(const struct file *file)
{
    struct file other = copy_of(file);
    struct dpt_mesh header = header_of(file);
    const size_t length = header_bytes_of(&header);
    const int sections = sections_of(&header);
    for (int id = 0; id < sections; id++) {
        struct mesh_section *section = &header.section[id];
        reverse(other.bytes + section->offset, 4, (size_t)section->bytes / 4);
        section->crc32 = crc_of(other.bytes + section->offset, (size_t)section->bytes);
        reverse((unsigned char *)&section->offset, 8, 2);
        reverse((unsigned char *)&section->crc32, 4, 4);
    }
    unsigned char *bytes = (unsigned char *)&header;
    header.header_crc32 = 0;
    reverse(bytes + 8, 4, (offsetof(struct dpt_mesh, bytes) - 8) / 4);
    reverse(bytes + offsetof(struct dpt_mesh, bytes), 8,
            (offsetof(struct dpt_mesh, section) - offsetof(struct dpt_mesh, bytes)) / 8);
    if (sections == 12)
        reverse(bytes + 800, 4, 4);
    if (sections >= 14) {
        unsigned char *tail = bytes + (sections == 14 ? 896 : sections == 17 ? 1040 : sections == 24 ? 1376 : 1472);
        reverse(tail, 4, 6);
        reverse(tail + 24, 8, 1);
        if (length >= 944)
            reverse(tail + 32, 4, 4);
        if (length >= 1104) {
            reverse(tail + 48, 4, 2);
            reverse(tail + 56, 8, 1);
        }
        if (length >= 1488) {
            reverse(tail + 64, 4, 4);
            reverse(tail + 80, 8, 4);
        }
        if (length == 1624)
            reverse(tail + 112, 8, 5);
    }
    header.header_crc32 = crc_of(bytes, length);
    reverse((unsigned char *)&header.header_crc32, 4, 1);
    memcpy(other.bytes, &header, length);
    return other;
}
