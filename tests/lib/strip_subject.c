/* SPDX-License-Identifier: BSD-3-Clause */
#include "lib/strip_subject.h"

#include "lib/public_meshes.h"

int subject_open(struct subject *subject)
{
    subject->info.size = sizeof subject->info;
    const dpt_result result = dpt_mesh_open(subject->compiled.bytes, subject->compiled.size, &subject->mesh);
    CHECK(result == DPT_OK, "%s: %s", subject->name, dpt_result_name(result));
    if (result != DPT_OK)
        return 0;
    dpt_mesh_get_info(subject->mesh, &subject->info);
    const uint32_t count = subject->info.source_triangles;
    double *corners = calloc(9 * (size_t)count, sizeof *corners);
    unsigned char *there = calloc(count, 1);
    for (uint32_t i = 0; i < count; i++)
        there[i] = dpt_mesh_get_triangle(subject->mesh, i, corners + 9 * (size_t)i) == DPT_OK;
    const int failed = oracle_surface_open(&subject->surface, corners, there, count);
    CHECK(!failed, "%s: memory", subject->name);
    CHECK(subject->surface.vertices == subject->info.vertices, "%s: %u vertices, not %u", subject->name,
          subject->info.vertices, subject->surface.vertices);
    double square = 0;
    for (int k = 0; k < 3; k++)
        square += pow(subject->info.box_max[k] - subject->info.box_min[k], 2);
    subject->diagonal = sqrt(square);
    free(corners);
    free(there);
    return !failed;
}

int subject_from_arrays(struct subject *subject, const char *name, const double *vertices, size_t vertex_count,
                        const uint32_t *corners, size_t triangle_count)
{
    dpt_diag diag = { .size = sizeof diag };
    *subject = (struct subject){ .mesh = NULL };
    snprintf(subject->name, sizeof subject->name, "%s", name);
    const dpt_result result =
        dpt_compile_arrays(vertices, vertex_count, corners, triangle_count, NULL, &subject->compiled, &diag);
    CHECK(result == DPT_OK, "%s: %s", name, diag.text);
    return result == DPT_OK && subject_open(subject);
}

int subject_from_shape(struct subject *subject, const char *name, uint64_t count)
{
    struct shape shape;
    shape_reason reason;
    char called[264];
    const int failed = shape_make(name, count, 0, &shape, reason);
    CHECK(!failed, "%s: %s", name, reason);
    if (failed)
        return 0;
    snprintf(called, sizeof called, "%s %zu", name, shape.triangle_count);
    const int opened =
        subject_from_arrays(subject, called, shape.vertices, shape.vertex_count, shape.corners, shape.triangle_count);
    shape_free(&shape);
    return opened;
}

int subject_from_file(struct subject *subject, const char *data, const char *folder, const char *file)
{
    char path[1024];
    dpt_diag diag = { .size = sizeof diag };
    *subject = (struct subject){ .mesh = NULL };
    snprintf(path, sizeof path, "%s/meshes/%s/%s", data, folder, file);
    snprintf(subject->name, sizeof subject->name, "%s", file);
    const dpt_result result = dpt_compile_file(path, NULL, &subject->compiled, &diag);
    CHECK(result == DPT_OK, "%s: %s", file, diag.text);
    return result == DPT_OK && subject_open(subject);
}

int subject_from_lattice(struct subject *subject, uint32_t size, uint32_t triangles, uint64_t seed)
{
    const uint32_t points = size * size * size;
    double *vertices = malloc(3 * (size_t)points * sizeof *vertices);
    uint32_t *corners = malloc(3 * (size_t)triangles * sizeof *corners);
    char name[264];
    for (uint32_t i = 0; i < points; i++) {
        vertices[3 * i] = 0.01 * (i % size);
        vertices[3 * i + 1] = 0.01 * (i / size % size);
        vertices[3 * i + 2] = 0.01 * (i / size / size);
    }
    for (uint32_t i = 0; i < 3 * triangles; i++)
        corners[i] = (uint32_t)(random_bits(&seed) % points);
    snprintf(name, sizeof name, "lattice %u %u", size, triangles);
    const int opened = subject_from_arrays(subject, name, vertices, points, corners, triangles);
    free(vertices);
    free(corners);
    return opened;
}

struct each_subject {
    const char *data;
    void (*each)(const struct subject *subject);
};

static void open_each(const char *folder, const char *file, void *user)
{
    const struct each_subject *to = user;
    struct subject subject;
    if (subject_from_file(&subject, to->data, folder, file))
        to->each(&subject);
    subject_close(&subject);
}

void for_public_meshes(const char *data, void (*each)(const struct subject *subject))
{
    struct each_subject to = { data, each };
    for_each_public_mesh(data, open_each, &to);
}

dpt_strip *guarded_strip_open(struct guarded_strip *guarded, uint32_t capacity, uint32_t search)
{
    const dpt_strip_def def = { .size = sizeof def, .capacity = capacity, .search = search };
    guarded->bytes = dpt_strip_bytes(&def);
    guarded->block = malloc(guarded->bytes + 8);
    guarded->strip = NULL;
    memset(guarded->block, 0x5a, guarded->bytes + 8);
    const dpt_result result = dpt_strip_create(guarded->block, guarded->bytes, &def, &guarded->strip);
    CHECK(guarded->bytes > 0 && result == DPT_OK, "%u, %u: %zu bytes, %s", capacity, search, guarded->bytes,
          dpt_result_name(result));
    return guarded->strip;
}
