/* SPDX-License-Identifier: BSD-3-Clause */
/* What a mesh answers without a world: what it holds, queries and strips. A part of answers.c, which alone includes it. */
#ifndef DPT_BENCH_ANSWERS_MESH_H
#define DPT_BENCH_ANSWERS_MESH_H

#include "bench/answers_subjects.h"

static uint32_t kernels[8], kernel_count;

static void kernels_find(void)
{
    const double ends[6] = { 0, 0, 1, 0, 0, 2 };
    snprintf(place, sizeof place, "kernels");
    for (uint32_t k = DPT_KERNEL_AUTO; k <= DPT_KERNEL_WASM128; k++) {
        dpt_query_def def = { .size = sizeof def, .kernel = k };
        dpt_hit hit = DPT_HIT_INIT;
        dpt_result result = dpt_query_segments(subjects[0].mesh, NULL, ends, NULL, 1, &hit, &def);
        put_hit(dpt_kernel_name(k), result, &hit);
        if (result == DPT_OK)
            kernels[kernel_count++] = k;
    }
    begin("best");
    put_count("kernel", dpt_kernel_best());
    end();
}

static void mesh_content(const struct subject *subject)
{
    const dpt_mesh *mesh = subject->mesh;
    dpt_mesh_info info = { .size = sizeof info };
    put_info(dpt_mesh_get_info(mesh, &info), &info);
    for (uint32_t i = 0; i < 32; i++) {
        dpt_mesh_section section = { .size = sizeof section };
        dpt_result result = dpt_mesh_get_section(mesh, i, &section);
        begin("section");
        put_code("result", (int32_t)result);
        put_count("crc32", section.crc32);
        put_count("offset", section.offset);
        put_count("bytes", section.bytes);
        put_word("name", section.name);
        end();
        if (result != DPT_OK)
            break;
    }
    uint64_t hash = 1;
    for (uint32_t i = 0; i <= info.source_triangles; i++) {
        double corners[9] = { 0 }, normals[9] = { 0 };
        uint32_t flags = 0;
        const int32_t results[3] = { (int32_t)dpt_mesh_get_triangle(mesh, i, corners),
                                     (int32_t)dpt_mesh_get_vertex_normals(mesh, i, normals),
                                     (int32_t)dpt_mesh_get_triangle_flags(mesh, i, &flags) };
        hash = hash_bytes(hash, results, sizeof results);
        hash = hash_bytes(hash, corners, sizeof corners);
        hash = hash_bytes(hash, normals, sizeof normals);
        hash = hash_bytes(hash, &flags, sizeof flags);
        if (i % 64 != 63 && i != info.source_triangles)
            continue;
        begin("triangles");
        put_count("up_to", i);
        put_hash("all", hash);
        put_numbers("corner", corners, 9);
        put_numbers("normal", normals, 9);
        put_count("flags", flags);
        end();
    }
}

/* A triangle that counts; its corners in the mesh's frame. 0 when luck is against it. */
static int draw_triangle(const struct subject *subject, uint32_t *number, double corners[9])
{
    for (int i = 0; i < 50; i++) {
        *number = below(subject->info.source_triangles);
        if (dpt_mesh_get_triangle(subject->mesh, *number, corners) == DPT_OK)
            return 1;
    }
    return 0;
}

/* A point over a triangle or under it, and the triangle's normal there; in the mesh's frame. */
static void over_triangle(const double corners[9], double height, double point[3], double normal[3])
{
    double u = in(0.0, 1.0), v = in(0.0, 1.0), e[3], f[3], length = 0.0;
    if (u + v > 1.0)
        u = 1.0 - u, v = 1.0 - v;
    for (int i = 0; i < 3; i++) {
        e[i] = corners[3 + i] - corners[i];
        f[i] = corners[6 + i] - corners[i];
        point[i] = corners[i] + u * e[i] + v * f[i];
    }
    for (int i = 0; i < 3; i++) {
        normal[i] = e[(i + 1) % 3] * f[(i + 2) % 3] - e[(i + 2) % 3] * f[(i + 1) % 3];
        length += normal[i] * normal[i];
    }
    for (int i = 0; i < 3; i++) {
        normal[i] = length > 0.0 ? normal[i] / sqrt(length) : i == 2;
        point[i] += height * normal[i];
    }
}

/* Segments in a mesh's neighbourhood, most of them at its surface or through it. */
static void draw_ends(const struct subject *subject, double ends[6])
{
    const double size = subject->diagonal;
    double corners[9], normal[3], along[3];
    uint32_t number;
    double length = size * (once_in(8) ? 0.0 : pow(10.0, in(-3.0, 0.3))), share = in(0.0, 1.0);
    draw_unit(along, 3);
    if (once_in(10) || !draw_triangle(subject, &number, corners))
        for (int i = 0; i < 3; i++)
            ends[i] = in(-3.0, 3.0) * size;
    else
        over_triangle(corners, size * in(-0.02, 0.05) * in(0.0, 1.0), ends, normal);
    for (int i = 0; i < 3; i++) {
        const double middle = ends[i];
        ends[i] = middle - share * length * along[i];
        ends[3 + i] = middle + (1.0 - share) * length * along[i];
    }
    if (once_in(60))
        ends[below(6)] = once_in(2) ? NAN : 2e6;
}

enum { BATCH = 24 };

static void mesh_queries(const struct subject *subject, int rounds)
{
    for (int round = 0; round < rounds; round++) {
        double ends[6 * BATCH], radii[BATCH];
        dpt_hit hits[BATCH];
        static const uint32_t methods[] = { DPT_METHOD_EXACT, DPT_METHOD_EXACT, DPT_METHOD_EXACT,
                                            DPT_METHOD_TREE,  DPT_METHOD_BRUTE, DPT_METHOD_PAPER };
        dpt_query_def def = { .size = sizeof def, .method = ONE_OF(methods), .kernel = kernels[below(kernel_count)] };
        if (def.method == DPT_METHOD_BRUTE && subject->info.triangles > 4000)
            def.method = DPT_METHOD_TREE;
        dpt_pose pose = draw_pose(subject->diagonal);
        const int posed = !once_in(3), rounded = !once_in(3);
        for (int i = 0; i < BATCH; i++) {
            double local[6];
            draw_ends(subject, local);
            memcpy(ends + 6 * i, local, sizeof local);
            if (posed) {
                apply(&pose, local, ends + 6 * i);
                apply(&pose, local + 3, ends + 6 * i + 3);
            }
            radii[i] = once_in(4) ? 0.0 : subject->diagonal * in(0.0, 0.02);
            hits[i] = (dpt_hit)DPT_HIT_INIT;
        }
        if (once_in(12))
            pose.orientation[2] += 0.1;
        dpt_result result = dpt_query_segments(subject->mesh, posed ? &pose : NULL, ends, rounded ? radii : NULL, BATCH,
                                               hits, once_in(6) ? NULL : &def);
        for (int i = 0; i < BATCH; i++)
            put_hit("query", result, &hits[i]);
    }
}

static void put_triangles(const char *what, dpt_result result, const dpt_strip *strip)
{
    uint32_t count = 0, flags = 0;
    const uint32_t *triangles = dpt_strip_get_triangles(strip, &count, &flags);
    begin(what);
    put_code("result", (int32_t)result);
    put_count("count", count);
    put_count("flags", flags);
    put_hash("all", hash_bytes(1, triangles, count * sizeof *triangles));
    for (uint32_t i = 0; i < count && i < 12; i++)
        put_count("triangle", triangles[i]);
    end();
}

enum { STRIP_MAX = 2048 };
static dpt_overlap overlaps[STRIP_MAX];

static void strip_stands(const struct subject *subject, const dpt_strip *strip, const dpt_pose *pose,
                         const dpt_segment *segment)
{
    uint32_t count = 0, flags = 0;
    dpt_strip_get_triangles(strip, &count, &flags);
    memset(overlaps, 0, sizeof overlaps);
    overlaps[0].size = sizeof overlaps[0];
    count = 0;
    dpt_result result =
        dpt_strip_overlaps(strip, subject->mesh, pose, segment, once_in(3) ? -1 : 1, overlaps, STRIP_MAX, &count);
    put_overlaps("overlaps", result, overlaps, count < STRIP_MAX ? count : STRIP_MAX, count, flags);
}

static void mesh_shadow(const struct subject *subject, dpt_strip *strip)
{
    double ends[6], world[6], radius = once_in(3) ? 0.0 : subject->diagonal * in(0.0, 0.02);
    dpt_pose pose = draw_pose(subject->diagonal);
    dpt_hit hit = DPT_HIT_INIT;
    dpt_shadow shadow = { .size = sizeof shadow };
    draw_ends(subject, ends);
    apply(&pose, ends, world);
    apply(&pose, ends + 3, world + 3);
    dpt_result result = dpt_query_segments(subject->mesh, &pose, world, &radius, 1, &hit, NULL);
    memcpy(shadow.segment.a, world, sizeof shadow.segment.a);
    memcpy(shadow.segment.b, world + 3, sizeof shadow.segment.b);
    shadow.segment.radius = radius;
    shadow.triangle = result == DPT_OK ? hit.triangle : below(10);
    for (int i = 0; i < 3; i++)
        shadow.direction[i] = hit.q[i] - hit.p[i];
    if (hit.distance == 0.0 || once_in(5))
        draw_unit(shadow.direction, 3);
    shadow.width = once_in(2) ? 0.0 : subject->diagonal * in(0.0, 0.03);
    shadow.depth = subject->diagonal * in(0.0, 0.2);
    for (int again = 0; again < 2; again++) {
        put_triangles("shadow", dpt_strip_shadow(strip, subject->mesh, &pose, &shadow), strip);
        strip_stands(subject, strip, &pose, &shadow.segment);
        for (int i = 0; i < 3; i++)
            shadow.segment.b[i] += subject->diagonal * in(-0.001, 0.001);
    }
}

static void mesh_strips(const struct subject *subject, int rounds)
{
    const dpt_strip_def defs[] = { { sizeof(dpt_strip_def), 2048, 16384, 0 },
                                   { sizeof(dpt_strip_def), 300, 200, 0 },
                                   { sizeof(dpt_strip_def), 7, 4096, 0 } };
    const dpt_strip_def def = ONE_OF(defs);
    const size_t bytes = dpt_strip_bytes(&def);
    const size_t table_bytes = subject->info.triangles <= 1000 ? dpt_route_table_bytes(subject->mesh) : 0;
    const dpt_route_table *table = NULL;
    void *table_block = malloc(table_bytes + 1), *block = malloc(bytes);
    dpt_strip *strip;
    memset(block, 0xa5, bytes);
    put_result("strip_create", dpt_strip_create(block, bytes, &def, &strip));
    if (table_bytes)
        put_result("route_table", dpt_route_table_create(table_block, table_bytes, subject->mesh, &table));
    for (int round = 0; round < rounds; round++) {
        const uint32_t all = subject->info.source_triangles + (once_in(20) ? 1 : 0);
        const uint32_t a = below(all), b = below(all), p = below(all);
        mesh_shadow(subject, strip);
        put_triangles("route", dpt_strip_route(strip, subject->mesh, a, b), strip);
        put_triangles("routes", dpt_strip_routes(strip, subject->mesh, a, b, p), strip);
        dpt_segment segment = { .radius = subject->diagonal * in(0.0, 0.01) };
        double ends[6];
        draw_ends(subject, ends);
        memcpy(segment.a, ends, sizeof segment.a);
        memcpy(segment.b, ends + 3, sizeof segment.b);
        strip_stands(subject, strip, NULL, &segment);
        if (table)
            put_triangles("route_by_table", dpt_strip_route_by_table(strip, table, a, b), strip);
    }
    free(block);
    free(table_block);
}

/* A copy with a byte that is wrong: what the check says. */
static void mesh_damage(const struct subject *subject, int rounds)
{
    unsigned char *copy = malloc(subject->size + 64);
    for (int round = 0; round < rounds; round++) {
        const dpt_mesh *mesh = NULL;
        const size_t most = once_in(2) ? 1024 : subject->size;
        dpt_mesh_fault fault = { .size = sizeof fault };
        memcpy(copy, subject->bytes, subject->size);
        copy[bits() % (most < subject->size ? most : subject->size)] ^= (unsigned char)(1 << below(8));
        const size_t size = once_in(6) ? bits() % subject->size : subject->size;
        put_fault("verify", dpt_mesh_verify(copy, size, &fault), &fault);
        put_result("open_damaged", dpt_mesh_open(copy, size, &mesh));
        put_fault("convert", dpt_mesh_convert(copy, size, &fault), &fault);
    }
    free(copy);
}

static void meshes_alone(void)
{
    for (uint32_t i = 0; i < subject_count; i++) {
        const struct subject *subject = &subjects[i];
        random_state = 1000 + i;
        snprintf(place, sizeof place, "mesh %.40s", subject->name);
        mesh_content(subject);
        mesh_queries(subject, 60);
        mesh_strips(subject, 40);
        mesh_strips(subject, 40);
        if (subject->size < 200000)
            mesh_damage(subject, 200);
    }
}

static void pairs_alone(int rounds)
{
    random_state = 7;
    snprintf(place, sizeof place, "pair");
    for (int round = 0; round < rounds; round++) {
        double segment[6], triangle[9], s = 0.0, p[3] = { 0 }, q[3] = { 0 };
        const double size = pow(10.0, in(-6.0, 3.0)), flat = once_in(3) ? 1e-9 : 1.0;
        for (int i = 0; i < 6; i++)
            segment[i] = size * in(-1.0, 1.0);
        for (int i = 0; i < 9; i++)
            triangle[i] = size * in(-1.0, 1.0) * (i % 3 == 2 ? flat : 1.0);
        if (once_in(6))
            memcpy(triangle + 3, triangle, 3 * sizeof(double));
        if (once_in(6))
            memcpy(segment + 3, segment, 3 * sizeof(double));
        if (once_in(6))
            memcpy(segment, triangle + 6, 3 * sizeof(double));
        if (once_in(200))
            segment[below(6)] = INFINITY;
        double distance = dpt_segment_triangle(segment, triangle, &s, p, q);
        begin("segment_triangle");
        put_number("distance", distance);
        put_number("s", s);
        put_numbers("p", p, 3);
        put_numbers("q", q, 3);
        end();
    }
}

#endif
