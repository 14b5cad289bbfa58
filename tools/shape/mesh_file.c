/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * One writer for each format, then the choice among them. The caller checks the file's error flag once, at the end.
 */
#include "shape/mesh_file.h"

#include <ctype.h>
#include <math.h>
#include <string.h>

#include "base/vec3.h"

static void write_vertices_text(FILE *file, const char *before, const struct shape *shape)
{
    for (const double *v = shape->vertices; v < shape->vertices + 3 * shape->vertex_count; v += 3)
        fprintf(file, "%s%.9g %.9g %.9g\n", before, (float)v[0], (float)v[1], (float)v[2]);
}

static void write_obj(FILE *file, const struct shape *shape)
{
    const uint32_t *t = shape->corners, *end = t + 3 * shape->triangle_count;
    write_vertices_text(file, "v ", shape);
    for (; t < end; t += 3)
        fprintf(file, "f %lu %lu %lu\n", t[0] + 1ul, t[1] + 1ul, t[2] + 1ul);
}

static void write_off(FILE *file, const struct shape *shape)
{
    const uint32_t *t = shape->corners, *end = t + 3 * shape->triangle_count;
    fprintf(file, "OFF\n%zu %zu 0\n", shape->vertex_count, shape->triangle_count);
    write_vertices_text(file, "", shape);
    for (; t < end; t += 3)
        fprintf(file, "3 %lu %lu %lu\n", t[0] + 0ul, t[1] + 0ul, t[2] + 0ul);
}

static unsigned char *put_u32(unsigned char *to, uint32_t value)
{
    for (int i = 0; i < 4; i++)
        *to++ = (unsigned char)(value >> (8 * i));
    return to;
}

static unsigned char *put_vector(unsigned char *to, const float vector[3])
{
    for (int i = 0; i < 3; i++) {
        uint32_t bits;
        memcpy(&bits, &vector[i], sizeof bits);
        to = put_u32(to, bits);
    }
    return to;
}

static void round_vertex(const struct shape *shape, uint32_t vertex, float rounded[3])
{
    for (size_t i = 0; i < 3; i++)
        rounded[i] = (float)shape->vertices[3 * (size_t)vertex + i];
}

/* The normal of the rounded corners; zero, as the format allows, if rounding left no area. */
static void unit_normal(const float a[3], const float b[3], const float c[3], float normal[3])
{
    const vec3 corner = vec3_of_float(a);
    double n[3];
    vec3_store(cross(sub(vec3_of_float(b), corner), sub(vec3_of_float(c), corner)), n);
    const double size = vec3_length(n);
    for (int i = 0; i < 3; i++)
        normal[i] = size > 0.0 ? (float)(n[i] / size) : 0.0f;
}

static void write_stl(FILE *file, const struct shape *shape)
{
    unsigned char head[84] = "binary STL, metres", record[50] = { 0 };
    const uint32_t *t = shape->corners, *end = t + 3 * shape->triangle_count;
    put_u32(head + 80, (uint32_t)shape->triangle_count);
    fwrite(head, sizeof head, 1, file);
    for (; t < end; t += 3) {
        float corner[3][3], normal[3];
        for (int i = 0; i < 3; i++)
            round_vertex(shape, t[i], corner[i]);
        unit_normal(corner[0], corner[1], corner[2], normal);
        unsigned char *to = put_vector(record, normal);
        for (int i = 0; i < 3; i++)
            to = put_vector(to, corner[i]);
        fwrite(record, sizeof record, 1, file);
    }
}

static void write_ply(FILE *file, const struct shape *shape)
{
    const uint32_t *t = shape->corners, *end = t + 3 * shape->triangle_count;
    unsigned char record[13];
    fprintf(file,
            "ply\nformat binary_little_endian 1.0\n"
            "element vertex %zu\nproperty float x\nproperty float y\nproperty float z\n"
            "element face %zu\nproperty list uchar int vertex_indices\nend_header\n",
            shape->vertex_count, shape->triangle_count);
    for (uint32_t v = 0; v < shape->vertex_count; v++) {
        float rounded[3];
        round_vertex(shape, v, rounded);
        put_vector(record, rounded);
        fwrite(record, 12, 1, file);
    }
    for (; t < end; t += 3) {
        record[0] = 3;
        put_u32(put_u32(put_u32(record + 1, t[0]), t[1]), t[2]);
        fwrite(record, 13, 1, file);
    }
}

mesh_writer *mesh_file_writer(const char *path)
{
    static const struct {
        char ending[5];
        mesh_writer *write;
    } formats[] = { { ".obj", write_obj }, { ".stl", write_stl }, { ".ply", write_ply }, { ".off", write_off } };
    size_t length = strlen(path);
    char ending[5] = { 0 };
    for (size_t i = 0; length > 4 && i < 4; i++)
        ending[i] = (char)tolower((unsigned char)path[length - 4 + i]);
    for (size_t i = 0; i < sizeof formats / sizeof *formats; i++)
        if (strcmp(ending, formats[i].ending) == 0)
            return formats[i].write;
    return NULL;
}
