/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * All that the library answers, for compare.sh: `answers [--worlds N] [--only FIRST LAST] [MESH.dpa ...]` writes every
 * answer of random scenes, bit by bit (answers.h), and on standard error what there was. `answers --number BITS ...` is
 * for the reader of a difference: it turns 16 hexadecimal digits back into a number.
 *
 * It uses public headers alone and is compiled against those of either commit. All is drawn from seeds; a world's seed is
 * its number, so that --only shows some of them as they are among all.
 */
#include <math.h>

#include "bench/answers.h"

/* ---- drawing (SplitMix64) ---- */

static uint64_t state;

static uint64_t bits(void)
{
    uint64_t z = (state += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

static uint32_t below(uint32_t count)
{
    return (uint32_t)(bits() % count);
}

static int once_in(uint32_t count)
{
    return below(count) == 0;
}

static double in(double low, double high)
{
    return low + (high - low) * ((double)(bits() >> 11) * 0x1p-53);
}

#define ONE_OF(array) (array)[below(sizeof(array) / sizeof(array)[0])]

static void draw_unit(double *out, int count)
{
    double square;
    do {
        square = 0.0;
        for (int i = 0; i < count; i++) {
            out[i] = in(-1.0, 1.0);
            square += out[i] * out[i];
        }
    } while (square < 0.01 || square > 1.0);
    for (int i = 0; i < count; i++)
        out[i] /= sqrt(square);
}

static dpt_pose draw_pose(double size)
{
    dpt_pose pose;
    for (int i = 0; i < 3; i++)
        pose.position[i] = in(-size, size);
    draw_unit(pose.orientation, 4);
    return pose;
}

/* ---- poses ---- */

static void turn(const double q[4], const double v[3], double out[3])
{
    const double t[3] = { 2.0 * (q[2] * v[2] - q[3] * v[1]), 2.0 * (q[3] * v[0] - q[1] * v[2]),
                          2.0 * (q[1] * v[1] - q[2] * v[0]) };
    out[0] = v[0] + q[0] * t[0] + q[2] * t[2] - q[3] * t[1];
    out[1] = v[1] + q[0] * t[1] + q[3] * t[0] - q[1] * t[2];
    out[2] = v[2] + q[0] * t[2] + q[1] * t[1] - q[2] * t[0];
}

static void apply(const dpt_pose *pose, const double v[3], double out[3])
{
    double turned[3];
    turn(pose->orientation, v, turned);
    for (int i = 0; i < 3; i++)
        out[i] = turned[i] + pose->position[i];
}

static void make_unit(double q[4])
{
    double length = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    for (int i = 0; i < 4; i++)
        q[i] /= length;
}

/* A part of the way from one pose to another. */
static dpt_pose between(const dpt_pose *from, const dpt_pose *to, double share)
{
    dpt_pose pose;
    double dot = 0.0;
    for (int i = 0; i < 4; i++)
        dot += from->orientation[i] * to->orientation[i];
    for (int i = 0; i < 3; i++)
        pose.position[i] = from->position[i] + share * (to->position[i] - from->position[i]);
    for (int i = 0; i < 4; i++)
        pose.orientation[i] = (1.0 - share) * from->orientation[i] +
                              (dot < 0.0 ? -share : share) * to->orientation[i];
    make_unit(pose.orientation);
    return pose;
}

/* ---- meshes ---- */

struct subject {
    char name[48];
    void *bytes;
    size_t size;
    const dpt_mesh *mesh;
    dpt_mesh_info info;
    double diagonal;
};

enum { SUBJECTS_MAX = 64 };
static struct subject subjects[SUBJECTS_MAX];
static uint32_t subject_count;

static int subject_open(struct subject *subject)
{
    subject->info = (dpt_mesh_info){ .size = sizeof subject->info };
    dpt_result result = dpt_mesh_open(subject->bytes, subject->size, &subject->mesh);
    put_result("open", result);
    if (result != DPT_OK)
        return 0;
    dpt_mesh_get_info(subject->mesh, &subject->info);
    double square = 0.0;
    for (int k = 0; k < 3; k++)
        square += pow(subject->info.box_max[k] - subject->info.box_min[k], 2.0);
    subject->diagonal = sqrt(square);
    return subject->diagonal > 0.0;
}

struct grid {
    double *vertices;
    uint32_t *corners;
    size_t vertex_count, triangle_count;
};

enum { GRID_MAX = 64 };

/* How a grid of u, v in 0..1 becomes a surface. */
enum form { SHEET, SPHERE, TORUS, CREASED, SLIVERS };

static void surface(enum form form, double u, double v, double rough, double out[3])
{
    const double pi = 3.141592653589793;
    double bump = 1.0 + rough * (sin(9.0 * u * pi) * cos(7.0 * v * pi) + in(-0.1, 0.1));
    switch (form) {
    case SPHERE:
        out[0] = 0.05 * bump * cos(2.0 * pi * u) * sin(pi * v);
        out[1] = 0.05 * bump * sin(2.0 * pi * u) * sin(pi * v);
        out[2] = 0.04 * bump * cos(pi * v);
        break;
    case TORUS:
        out[0] = (0.05 + 0.02 * bump * cos(2.0 * pi * v)) * cos(2.0 * pi * u);
        out[1] = (0.05 + 0.02 * bump * cos(2.0 * pi * v)) * sin(2.0 * pi * u);
        out[2] = 0.02 * bump * sin(2.0 * pi * v);
        break;
    case CREASED:
        out[0] = 0.1 * (u - 0.5);
        out[1] = 0.1 * (v - 0.5);
        out[2] = 0.03 * fabs(u - 0.4) + 0.02 * (v > 0.6 ? v - 0.6 : 0.0) + 0.005 * bump;
        break;
    case SLIVERS:
        out[0] = 0.2 * (u - 0.5);
        out[1] = 0.1 * (pow(v, 6.0) - 0.5);
        out[2] = 0.01 * bump;
        break;
    default:
        out[0] = 0.12 * (u - 0.5);
        out[1] = 0.12 * (v - 0.5);
        out[2] = 0.015 * bump;
    }
}

/* Adds a surface of columns * rows * 2 triangles, one of `holes` left out (0: none). */
static void grid_add(struct grid *grid, enum form form, uint32_t columns, uint32_t rows,
                     double rough, double scale, uint32_t holes)
{
    const int wraps = form == SPHERE || form == TORUS, closes = form == TORUS;
    const uint32_t first = (uint32_t)grid->vertex_count;
    const uint32_t wide = wraps ? columns : columns + 1, high = closes ? rows : rows + 1;
    for (uint32_t j = 0; j < high; j++)
        for (uint32_t i = 0; i < wide; i++) {
            double *vertex = grid->vertices + 3 * grid->vertex_count++;
            surface(form, (double)i / columns, (double)j / rows, rough, vertex);
            if (form == SPHERE && (j == 0 || j == rows)) /* a pole is one point */
                vertex[0] = vertex[1] = 0.0, vertex[2] = j ? -0.04 : 0.04;
            for (int k = 0; k < 3; k++)
                vertex[k] *= scale;
        }
    for (uint32_t j = 0; j < rows; j++)
        for (uint32_t i = 0; i < columns; i++) {
            uint32_t a = first + j * wide + i, b = first + j * wide + (i + 1) % wide;
            uint32_t c = first + (j + 1) % high * wide + i;
            uint32_t d = first + (j + 1) % high * wide + (i + 1) % wide;
            const uint32_t two[6] = { a, c, b, b, c, d };
            for (int t = 0; t < 2; t++)
                if (!holes || !once_in(holes))
                    memcpy(grid->corners + 3 * grid->triangle_count++, two + 3 * t,
                           3 * sizeof *two);
        }
}

/* Of the surfaces that were added since the last one. */
static void subject_compile(const char *name, struct grid *grid, double crease)
{
    struct subject *subject = &subjects[subject_count];
    for (int pass = 0; pass < 2; pass++) { /* by three threads, then by one: that is kept */
        dpt_compiled compiled;
        dpt_diag diag = { .size = sizeof diag };
        dpt_compile_def def = { .size = sizeof def, .crease = crease, .threads = pass ? 1 : 3 };
        dpt_result result = dpt_compile_arrays(grid->vertices, grid->vertex_count, grid->corners,
                                               grid->triangle_count, &def, &compiled, &diag);
        snprintf(place, sizeof place, "mesh %.40s", name);
        begin("compile");
        put_code("result", (int32_t)result);
        put_count("size", compiled.size);
        put_hash("bytes", hash_bytes(1, compiled.bytes, compiled.size));
        put_word("text", result == DPT_OK ? "" : diag.text);
        end();
        subject->bytes = compiled.bytes;
        subject->size = compiled.size;
        if (pass == 0)
            dpt_compiled_free(&compiled);
    }
    grid->vertex_count = grid->triangle_count = 0;
    snprintf(subject->name, sizeof subject->name, "%s", name);
    if (subject_open(subject))
        subject_count++;
}

static void subjects_make(void)
{
    const size_t room = 3 * 2 * GRID_MAX * GRID_MAX;
    struct grid grid = { malloc(3 * room * sizeof(double)), malloc(3 * room * sizeof(uint32_t)), 0,
                         0 };
    state = 1;
    grid_add(&grid, SHEET, 20, 20, 0.3, 1.0, 0);
    subject_compile("sheet", &grid, 0.0);
    grid_add(&grid, CREASED, 16, 15, 0.2, 1.0, 0);
    subject_compile("creased", &grid, 0.3);
    grid_add(&grid, SLIVERS, 40, 9, 0.2, 1.0, 0);
    subject_compile("slivers", &grid, 0.0);
    grid_add(&grid, SPHERE, 24, 16, 0.1, 1.0, 0);
    subject_compile("ball", &grid, 0.0);
    grid_add(&grid, SPHERE, 9, 6, 0.05, 0.4, 0);
    subject_compile("small ball", &grid, 0.0);
    grid_add(&grid, TORUS, 40, 18, 0.1, 1.0, 0);
    subject_compile("ring", &grid, 0.0);
    grid_add(&grid, SPHERE, 28, 20, 0.1, 1.0, 60);
    subject_compile("pierced", &grid, 0.0);
    grid_add(&grid, TORUS, 30, 12, 0.05, 1.0, 12);
    subject_compile("torn", &grid, 0.0);
    grid_add(&grid, SPHERE, 24, 14, 0.05, 1.0, 0);
    grid_add(&grid, SPHERE, 14, 10, 0.1, 0.6, 0);
    subject_compile("hollow", &grid, 0.0);
    grid_add(&grid, SPHERE, 24, 14, 0.05, 1.0, 40);
    grid_add(&grid, SHEET, 14, 14, 0.2, 1.1, 0);
    grid_add(&grid, TORUS, 14, 8, 0.2, 0.8, 0);
    subject_compile("crossing", &grid, 0.0);
    grid_add(&grid, SHEET, 24, 18, 0.5, 1.0, 20);
    subject_compile("holed sheet", &grid, 0.0);
    grid_add(&grid, SPHERE, 60, 50, 0.15, 2.0, 0);
    subject_compile("fine", &grid, 0.0);
    grid_add(&grid, SHEET, 1, 1, 0.0, 1.0, 0);
    grid.triangle_count = 1;
    subject_compile("one triangle", &grid, 0.0);
    grid_add(&grid, SPHERE, 12, 8, 0.5, 1.0, 0);
    for (size_t i = 0; i < 3 * grid.triangle_count; i++)
        grid.corners[i] = below((uint32_t)grid.vertex_count);
    subject_compile("soup", &grid, 0.0);
    grid_add(&grid, SHEET, 2, 2, 0.0, 1.0, 0);
    grid.corners[3] = 1000;
    subject_compile("wrong", &grid, 0.0);
    grid_add(&grid, SHEET, 2, 2, 0.0, 1.0, 0);
    grid.vertices[4] = NAN;
    subject_compile("not finite", &grid, 0.0);
    free(grid.vertices);
    free(grid.corners);
}

static void subject_read(const char *path)
{
    struct subject *subject = &subjects[subject_count];
    const char *name = strrchr(path, '/');
    FILE *file = fopen(path, "rb");
    long size = file && fseek(file, 0, SEEK_END) == 0 ? ftell(file) : -1;
    subject->bytes = size > 0 ? malloc((size_t)size) : NULL;
    if (!subject->bytes || fseek(file, 0, SEEK_SET) != 0 ||
        fread(subject->bytes, 1, (size_t)size, file) != (size_t)size) {
        fprintf(stderr, "answers: cannot read %s\n", path);
        exit(2);
    }
    fclose(file);
    subject->size = (size_t)size;
    snprintf(subject->name, sizeof subject->name, "%s", name ? name + 1 : path);
    snprintf(place, sizeof place, "mesh %.40s", subject->name);
    if (subject_count + 1 < SUBJECTS_MAX && subject_open(subject))
        subject_count++;
}

/* ---- a mesh: what it holds, queries and strips without a world ---- */

static uint32_t kernels[8], kernel_count;

static void kernels_find(void)
{
    const double ends[6] = { 0, 0, 1, 0, 0, 2 };
    snprintf(place, sizeof place, "kernels");
    for (uint32_t k = DPT_KERNEL_AUTO; k <= DPT_KERNEL_NEON; k++) {
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
        dpt_query_def def = { .size = sizeof def,
                              .method = ONE_OF(methods),
                              .kernel = kernels[below(kernel_count)] };
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
        dpt_result result =
            dpt_query_segments(subject->mesh, posed ? &pose : NULL, ends, rounded ? radii : NULL,
                               BATCH, hits, once_in(6) ? NULL : &def);
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

static void strip_stands(const struct subject *subject, const dpt_strip *strip,
                         const dpt_pose *pose, const dpt_segment *segment)
{
    uint32_t count = 0, flags = 0;
    dpt_strip_get_triangles(strip, &count, &flags);
    memset(overlaps, 0, sizeof overlaps);
    overlaps[0].size = sizeof overlaps[0];
    count = 0;
    dpt_result result = dpt_strip_overlaps(strip, subject->mesh, pose, segment, once_in(3) ? -1 : 1,
                                           overlaps, STRIP_MAX, &count);
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
    const size_t table_bytes =
        subject->info.triangles <= 1000 ? dpt_route_table_bytes(subject->mesh) : 0;
    const dpt_route_table *table = NULL;
    void *table_block = malloc(table_bytes + 1), *block = malloc(bytes);
    dpt_strip *strip;
    memset(block, 0xa5, bytes);
    put_result("strip_create", dpt_strip_create(block, bytes, &def, &strip));
    if (table_bytes)
        put_result("route_table",
                   dpt_route_table_create(table_block, table_bytes, subject->mesh, &table));
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
        copy[bits() % (most < subject->size ? most : subject->size)] ^=
            (unsigned char)(1 << below(8));
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
        state = 1000 + i;
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
    state = 7;
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

/* ---- worlds ---- */

enum { BODIES_MAX = 6, TOOLS_MAX = 4, SEGMENTS_MAX = 3, CONTACTS_MAX = 48 };

struct moving_body {
    dpt_body id;
    const struct subject *subject;
    dpt_pose pose;
    double velocity[3], spin[3]; /* of a tick */
    int there;
};

struct moving_tool {
    dpt_tool id;
    uint32_t count;
    int there, rigid;
    dpt_segment segments[SEGMENTS_MAX];
    dpt_pose pose, from, to;
    uint32_t tick, ticks; /* of the way */
};

struct scene {
    dpt_world_def def;
    dpt_world *world;
    void *block;
    double scale;
    struct moving_body bodies[BODIES_MAX];
    struct moving_tool tools[TOOLS_MAX];
};

static struct {
    uint64_t worlds, ticks, crossing, contacts, swept, stale, bounded, strips;
} met;

static dpt_world_def draw_def(double scale, int small)
{
    static const uint32_t methods[] = { DPT_METHOD_EXACT, DPT_METHOD_EXACT, DPT_METHOD_EXACT,
                                        DPT_METHOD_EXACT, DPT_METHOD_EXACT, DPT_METHOD_EXACT,
                                        DPT_METHOD_EXACT, DPT_METHOD_TREE,  DPT_METHOD_TREE,
                                        DPT_METHOD_PAPER, DPT_METHOD_BRUTE };
    static const uint32_t budgets[] = { 0, 0, 0, 20, 100, 500, 500 };
    static const uint32_t contacts[] = { 0, 1, 4, 32, 32, 32 };
    static const uint32_t untils[] = { DPT_UNTIL_RESPOND, DPT_UNTIL_RESPOND, DPT_UNTIL_RESPOND,
                                       DPT_UNTIL_RESPOND, DPT_UNTIL_RESPOND, DPT_UNTIL_CONTACT,
                                       DPT_UNTIL_TRACK };
    static const uint32_t strips[] = { DPT_STRIP_KIND_NONE, DPT_STRIP_KIND_NONE,
                                       DPT_STRIP_KIND_SHADOW, DPT_STRIP_KIND_SHADOW,
                                       DPT_STRIP_KIND_ROUTES };
    static const uint32_t capacities[] = { 5, 64, 1024, 1024 };
    static const uint64_t memories[] = { 0, 2720, 272 * 64, 1 << 20, 1 << 20, 1 << 20 };
    static const double margins[] = { 0.0, 0.003, 0.01, 0.03 };
    dpt_world_def def;
    dpt_baseline_def baseline;
    dpt_world_def_init(&def);
    def.max_bodies = BODIES_MAX;
    def.max_tools = TOOLS_MAX;
    def.max_segments = TOOLS_MAX * SEGMENTS_MAX;
    def.method = ONE_OF(methods);
    if (def.method == DPT_METHOD_BRUTE && !small)
        def.method = DPT_METHOD_EXACT;
    def.kernel = kernels[below(kernel_count)];
    def.until = ONE_OF(untils);
    if (def.method == DPT_METHOD_PAPER) {
        const uint32_t parts = 1 + below(4);
        set_baseline(&def, &baseline, parts, below(2));
    }
    if (def.method == DPT_METHOD_EXACT)
        def.budget = ONE_OF(budgets);
    def.stiffness = once_in(4) ? in(0.0, 2000.0) : 500.0;
    def.certificate_bytes = ONE_OF(memories);
    def.margin = scale * ONE_OF(margins);
    def.side_limit = once_in(3) ? scale * in(0.01, 0.3) : 0.0;
    def.max_contacts = ONE_OF(contacts);
    def.smooth_normals = below(2);
    def.strip = ONE_OF(strips);
    def.strip_capacity = ONE_OF(capacities);
    def.strip_search = once_in(4) ? 100 : 16384;
    def.strip_width = once_in(2) ? 0.0 : scale * in(0.0, 0.02);
    def.strip_depth = once_in(2) ? 0.0 : scale * in(0.0, 0.2);
    return def;
}

static void body_add(struct scene *scene, struct moving_body *body, int first, int small)
{
    do
        body->subject = &subjects[below(subject_count)];
    while (small && body->subject->info.triangles > 2500);
    if (first)
        scene->scale = body->subject->diagonal;
    body->pose = draw_pose(first ? 0.0 : 0.6 * scene->scale);
    if (first && once_in(2))
        body->pose = (dpt_pose)DPT_POSE_IDENTITY;
    const double speed = once_in(2) ? 0.0 : scene->scale * pow(10.0, in(-4.0, -2.0));
    for (int i = 0; i < 3; i++) {
        body->velocity[i] = speed * in(-1.0, 1.0);
        body->spin[i] = once_in(2) ? speed / scene->scale * in(-2.0, 2.0) : 0.0;
    }
    dpt_result result =
        dpt_body_add(scene->world, body->subject->mesh, once_in(4) ? NULL : &body->pose, &body->id);
    put_result("body_add", result);
    body->there = result == DPT_OK;
    if (body->there) /* also where it was added at the identity */
        put_result("body_set_pose", dpt_body_set_pose(scene->world, body->id, &body->pose));
}

static void body_move(struct scene *scene, struct moving_body *body, uint32_t tick)
{
    const double *w = body->spin;
    double *q = body->pose.orientation;
    const double rate[4] = { -w[0] * q[1] - w[1] * q[2] - w[2] * q[3],
                             w[0] * q[0] + w[1] * q[3] - w[2] * q[2],
                             w[1] * q[0] + w[2] * q[1] - w[0] * q[3],
                             w[2] * q[0] + w[0] * q[2] - w[1] * q[1] };
    const double sense = tick / 40 % 2 ? -1.0 : 1.0; /* there and back */
    for (int i = 0; i < 4; i++)
        q[i] += 0.5 * sense * rate[i];
    make_unit(q);
    for (int i = 0; i < 3; i++)
        body->pose.position[i] += sense * body->velocity[i];
    dpt_pose given = body->pose;
    if (once_in(2000))
        given.orientation[0] = NAN;
    if (w[0] != 0.0 || body->velocity[0] != 0.0) {
        put_result("body_set_pose", dpt_body_set_pose(scene->world, body->id, &given));
        if (given.orientation[0] != body->pose.orientation[0] && once_in(2))
            put_result("body_set_pose", dpt_body_set_pose(scene->world, body->id, &body->pose));
    }
}

/* How far a tool of an orientation reaches along a direction. */
static double reach(const struct moving_tool *tool, const double orientation[4],
                    const double along[3])
{
    double tip[3], least = 0.0;
    for (uint32_t i = 0; i < tool->count; i++) {
        turn(orientation, tool->segments[i].b, tip);
        least = fmin(least, tip[0] * along[0] + tip[1] * along[1] + tip[2] * along[2]);
    }
    return least;
}

/* Where the tool goes next: a point of it to a place at some body's surface, most often from above. */
static void tool_aim(struct scene *scene, struct moving_tool *tool)
{
    double corners[9], point[3], normal[3], up[3], to[3], anchor[3], turned[3];
    uint32_t number;
    const struct moving_body *body = &scene->bodies[below(BODIES_MAX)];
    tool->from = tool->pose;
    tool->tick = 0;
    tool->ticks = once_in(6) ? 1 + below(3) : 4 + below(50);
    if (once_in(6)) /* at rest, for budgets to catch up */
        return;
    tool->to = draw_pose(0.5 * scene->scale);
    for (int i = 0; i < 10 && !body->there; i++)
        body = &scene->bodies[below(BODIES_MAX)];
    if (!body->there || !draw_triangle(body->subject, &number, corners))
        return;
    const int dips = once_in(6);
    over_triangle(corners, scene->scale * (dips ? in(-0.08, 0.0) : in(-0.004, 0.06)), point,
                  normal);
    apply(&body->pose, point, to);
    turn(body->pose.orientation, normal, up);
    for (int i = 0; i < 8 && !dips; i++) {
        double other[4];
        draw_unit(other, 4);
        if (reach(tool, other, up) > reach(tool, tool->to.orientation, up))
            memcpy(tool->to.orientation, other, sizeof other);
    }
    const double share = once_in(6) ? in(0.0, 1.0) : 0.0;
    for (int i = 0; i < 3; i++)
        anchor[i] =
            tool->segments[0].a[i] + share * (tool->segments[0].b[i] - tool->segments[0].a[i]);
    turn(tool->to.orientation, anchor, turned);
    for (int i = 0; i < 3; i++)
        tool->to.position[i] = to[i] - turned[i];
}

static void tool_add(struct scene *scene, struct moving_tool *tool)
{
    const double radius = once_in(3) ? 0.0 : scene->scale * in(0.0, 0.02);
    const double size = once_in(3) ? 0.6 : 0.15;
    double at[3] = { 0, 0, 0 };
    tool->count = 1 + below(SEGMENTS_MAX);
    tool->rigid = !once_in(3);
    for (uint32_t i = 0; i < tool->count; i++) { /* a chain */
        double along[3];
        const double length = once_in(15) ? 0.0 : scene->scale * size * in(0.2, 1.0);
        draw_unit(along, 3);
        memcpy(tool->segments[i].a, at, sizeof at);
        for (int k = 0; k < 3; k++)
            at[k] += length * along[k];
        memcpy(tool->segments[i].b, at, sizeof at);
        tool->segments[i].radius = radius;
    }
    dpt_result result = dpt_tool_add(scene->world, tool->segments, tool->count, &tool->id);
    put_result("tool_add", result);
    tool->there = result == DPT_OK;
    tool->pose = tool->to = (dpt_pose)DPT_POSE_IDENTITY;
    tool_aim(scene, tool);
}

static void tool_move(struct scene *scene, struct moving_tool *tool)
{
    if (tool->tick++ >= tool->ticks)
        tool_aim(scene, tool);
    if (tool->tick > tool->ticks)
        tool->tick = tool->ticks;
    tool->pose = between(&tool->from, &tool->to, (double)tool->tick / tool->ticks);
    dpt_pose given = tool->pose;
    if (once_in(300))
        given.position[below(3)] = once_in(2) ? NAN : 1e7;
    if (tool->rigid) {
        const int jumps = once_in(80);
        put_result(jumps ? "teleport" : "set_pose",
                   jumps ? dpt_tool_teleport(scene->world, tool->id, &given)
                         : dpt_tool_set_pose(scene->world, tool->id, &given));
        return;
    }
    dpt_segment segments[SEGMENTS_MAX];
    for (uint32_t i = 0; i < tool->count; i++) {
        apply(&given, tool->segments[i].a, segments[i].a);
        apply(&given, tool->segments[i].b, segments[i].b);
        segments[i].radius = tool->segments[i].radius;
        if (once_in(4)) /* it bends and swells */
            segments[i].b[below(3)] += scene->scale * in(-0.01, 0.01);
        if (once_in(50))
            segments[i].radius *= in(0.0, 2.0);
    }
    const uint32_t count = once_in(500) ? tool->count - 1 : tool->count;
    if (once_in(80))
        put_result("teleport", dpt_tool_teleport(scene->world, tool->id, &tool->pose));
    put_result("set_segments", dpt_tool_set_segments(scene->world, tool->id, segments, count));
}

static void put_segment(const struct scene *scene, dpt_tool id, uint32_t segment)
{
    dpt_hit hit = DPT_HIT_INIT;
    dpt_sweep sweep = { .size = sizeof sweep };
    uint32_t count = 0, flags = 0;
    dpt_result result = dpt_tool_get_segment_hit(scene->world, id, segment, &hit);
    put_hit("segment_hit", result, &hit);
    met.bounded += hit.status == DPT_STATUS_BOUNDED;
    result = dpt_tool_get_sweep(scene->world, id, segment, &sweep);
    put_sweep(result, &sweep);
    met.swept += sweep.status == DPT_SWEEP_HIT;
    if (!scene->def.strip)
        return;
    memset(overlaps, 0, 1024 * sizeof overlaps[0]);
    overlaps[0].size = sizeof overlaps[0];
    result = dpt_tool_get_strip(scene->world, id, segment, overlaps, 1024, &count, &flags);
    put_overlaps("strip", result, overlaps, count < 1024 ? count : 1024, count, flags);
    met.strips += count > 0;
}

/* All about a tool; 1 if it touches. */
static int put_tool(const struct scene *scene, const struct moving_tool *tool)
{
    static dpt_contact contacts[CONTACTS_MAX];
    dpt_hit hit = DPT_HIT_INIT;
    dpt_wrench wrench = { { 0 }, { 0 } };
    uint32_t count = 0;
    char *more = place + strlen(place);
    const size_t room = (size_t)(place + sizeof place - more);
    snprintf(more, room, " tool %d", (int)(tool - scene->tools));
    dpt_result result = dpt_tool_get_hit(scene->world, tool->id, &hit);
    put_hit("hit", result, &hit);
    met.stale += hit.status == DPT_STATUS_STALE;
    result = dpt_tool_get_wrench(scene->world, tool->id, &wrench);
    put_wrench("wrench", result, &wrench);
    memset(contacts, 0, sizeof contacts);
    contacts[0].size = sizeof contacts[0];
    result = dpt_tool_get_contacts(scene->world, tool->id, contacts, CONTACTS_MAX, &count);
    begin("contacts");
    put_code("result", (int32_t)result);
    put_count("count", count);
    end();
    for (uint32_t i = 0; i < count && i < CONTACTS_MAX; i++)
        put_contact(&contacts[i]);
    met.contacts += count;
    for (uint32_t i = 0; tool->there && i < tool->count; i++) {
        snprintf(more, room, " tool %d.%d", (int)(tool - scene->tools), (int)i);
        put_segment(scene, tool->id, i);
    }
    *more = 0;
    return (hit.flags & DPT_HIT_FLAG_CROSSING) != 0;
}

static void scene_change(struct scene *scene, uint32_t tick, int small)
{
    for (int i = 0; i < BODIES_MAX; i++) {
        struct moving_body *body = &scene->bodies[i];
        if (body->there && !once_in(150)) {
            body_move(scene, body, tick);
        } else if (body->there) {
            put_result("body_remove", dpt_body_remove(scene->world, body->id));
            body->there = 0;
        } else if (once_in(60)) {
            body_add(scene, body, 0, small);
        }
    }
    for (int i = 0; i < TOOLS_MAX; i++) {
        struct moving_tool *tool = &scene->tools[i];
        if (tool->there && !once_in(120)) {
            tool_move(scene, tool);
        } else if (tool->there) {
            put_result("tool_remove", dpt_tool_remove(scene->world, tool->id));
            tool->there = 0;
        } else if (once_in(25)) {
            tool_add(scene, tool);
        }
    }
    if (once_in(250))
        put_result("reset", dpt_world_reset(scene->world));
}

static void world_run(uint32_t number, uint32_t ticks)
{
    struct scene scene;
    memset(&scene, 0, sizeof scene);
    state = 0x5eed0000 + number;
    const int small = once_in(3);
    snprintf(place, sizeof place, "world %u", number);
    const struct subject *first;
    const uint64_t kept = state; /* the def is drawn to the first body's size */
    do
        first = &subjects[below(subject_count)];
    while (small && first->info.triangles > 2500);
    scene.def = draw_def(first->diagonal, small);
    const size_t bytes = dpt_world_bytes(&scene.def);
    scene.block = malloc(bytes + 64);
    memset(scene.block, 0xa5, bytes + 64);
    dpt_result result = dpt_world_create(scene.block, bytes, &scene.def, &scene.world);
    begin("create");
    put_code("result", (int32_t)result);
    put_count("bytes", bytes);
    put_count("method", scene.def.method);
    put_count("budget", scene.def.budget);
    put_count("kernel", dpt_world_get_kernel(scene.world));
    end();
    if (result != DPT_OK) {
        free(scene.block);
        return;
    }
    const uint64_t drawn = state;
    state = kept;
    body_add(&scene, &scene.bodies[0], 1, small);
    state = drawn;
    const int bodies = 1 + (int)below(4), tools = 1 + (int)below(3);
    for (int i = 1; i < bodies; i++)
        body_add(&scene, &scene.bodies[i], 0, small);
    for (int i = 0; i < tools; i++)
        tool_add(&scene, &scene.tools[i]);
    for (uint32_t tick = 0; tick < ticks; tick++) {
        dpt_step step = { .size = sizeof step };
        const double dt = once_in(400) ? in(-1e-3, 0.0) : once_in(5) ? in(1e-4, 1e-2) : 1e-3;
        int crossing = 0;
        snprintf(place, sizeof place, "world %u tick %u", number, tick);
        scene_change(&scene, tick, small);
        result = dpt_world_step(scene.world, dt, &step);
        put_step(result, &step);
        for (int i = 0; i < TOOLS_MAX; i++)
            if (scene.tools[i].there || once_in(20))
                crossing |= put_tool(&scene, &scene.tools[i]);
        met.ticks++;
        met.crossing += crossing != 0;
    }
    met.worlds++;
    free(scene.block);
}

/* ---- arms ---- */

struct arm_arrays {
    dpt_arm_def def;
    dpt_arm_joint joints[DPT_JOINTS_MAX];
    dpt_arm_link links[12];
    dpt_segment segments[2];
    dpt_arm_body body;
};

/* A chain, of which links may mimic a joint before, and some links beside it. */
static void draw_arm(struct arm_arrays *arm)
{
    dpt_arm_def *def = &arm->def;
    memset(arm, 0, sizeof *arm);
    *def = (dpt_arm_def){ .size = sizeof *def,
                          .joints = arm->joints,
                          .links = arm->links,
                          .segments = arm->segments,
                          .bodies = &arm->body,
                          .segment_count = below(3),
                          .body_count = below(2),
                          .name = "drawn",
                          .root_name = "base",
                          .tool_name = "tool" };
    const uint32_t most = 1 + below(DPT_JOINTS_MAX);
    def->link_count = most + below(4);
    for (uint32_t i = 0; i < def->link_count; i++) {
        dpt_arm_link *link = &arm->links[i];
        *link = (dpt_arm_link){ .size = sizeof *link,
                                .parent = i - 1, /* -1: DPT_NONE */
                                .slides = (uint32_t)once_in(4),
                                .pose = draw_pose(0.4),
                                .factor = 1.0,
                                .mass = once_in(4) ? 0.0 : in(0.0, 2.0) };
        draw_unit(link->axis, 3);
        for (int k = 0; k < 3; k++)
            link->centre[k] = in(-0.1, 0.1);
        if (def->joint_count == 0 || (def->joint_count < most && !once_in(4))) {
            dpt_arm_joint *joint = &arm->joints[def->joint_count];
            link->joint = def->joint_count++;
            *joint =
                (dpt_arm_joint){ .size = sizeof *joint,
                                 .kind = link->slides ? DPT_JOINT_PRISMATIC : DPT_JOINT_REVOLUTE,
                                 .lower = in(-2.0, 0.0),
                                 .upper = in(0.0, 2.0),
                                 .velocity = in(0.0, 5.0),
                                 .effort = in(0.0, 5.0) };
            snprintf(joint->name, sizeof joint->name, "joint_%u", link->joint);
        } else {
            link->joint = below(def->joint_count);
            link->factor = in(0.2, 2.0) * (once_in(2) ? -1.0 : 1.0);
            link->offset = in(-1.0, 1.0);
        }
    }
    def->tool_link = def->link_count - 1;
    def->tool = draw_pose(0.2);
    for (int i = 0; i < 2; i++)
        arm->segments[i] = (dpt_segment){ { 0, 0, 0.1 * i }, { 0.01, 0, 0.2 }, in(0.0, 0.01) };
    arm->body = (dpt_arm_body){ .size = sizeof arm->body,
                                .pose = draw_pose(0.5),
                                .mesh = subjects[below(3)].mesh };
}

static void arm_kinematics(const dpt_arm *arm, uint32_t joint_count)
{
    double joints[DPT_JOINTS_MAX], rates[DPT_JOINTS_MAX], efforts[DPT_JOINTS_MAX] = { 0 };
    double velocity[3] = { 0 }, spin[3] = { 0 }, jacobian[6 * DPT_JOINTS_MAX] = { 0 };
    const double gravity[3] = { in(-1, 1), in(-1, 1), -9.81 };
    const dpt_wrench wrench = { { in(-5, 5), in(-5, 5), in(-5, 5) }, { in(-1, 1), 0.0, 0.5 } };
    dpt_pose tool = DPT_POSE_IDENTITY;
    for (int i = 0; i < DPT_JOINTS_MAX; i++) {
        joints[i] = in(-7.0, 7.0);
        rates[i] = in(-3.0, 3.0);
    }
    if (once_in(40))
        joints[0] = NAN;
    const int32_t results[5] = {
        (int32_t)dpt_arm_forward(arm, joints, &tool),
        (int32_t)dpt_arm_velocity(arm, joints, rates, velocity, spin),
        (int32_t)dpt_arm_jacobian(arm, joints, jacobian),
        (int32_t)dpt_arm_efforts(arm, joints, &wrench, efforts),
        0,
    };
    begin("kinematics");
    for (int i = 0; i < 4; i++)
        put_code("result", results[i]);
    put_numbers("position", tool.position, 3);
    put_numbers("orientation", tool.orientation, 4);
    put_numbers("velocity", velocity, 3);
    put_numbers("spin", spin, 3);
    put_numbers("jacobian", jacobian, 6 * (size_t)joint_count);
    put_numbers("effort", efforts, DPT_JOINTS_MAX);
    put_code("weight_result", (int32_t)dpt_arm_weight(arm, joints, gravity, efforts));
    put_numbers("weight", efforts, DPT_JOINTS_MAX);
    end();
}

static void arms_run(int count)
{
    for (int number = 0; number < count; number++) {
        struct arm_arrays arrays;
        dpt_compiled file = { NULL, 0 };
        dpt_diag diag = { .size = sizeof diag };
        dpt_arm_info info = { .size = sizeof info };
        const dpt_arm *arm = NULL;
        state = 0xa2a00000u + (uint32_t)number;
        snprintf(place, sizeof place, "arm %d", number);
        draw_arm(&arrays);
        if (once_in(20))
            arrays.links[below(arrays.def.link_count)].axis[1] = 3.0;
        dpt_result result = dpt_compile_arm(&arrays.def, &file, &diag);
        begin("compile");
        put_code("result", (int32_t)result);
        put_count("size", file.size);
        put_hash("bytes", hash_bytes(1, file.bytes, file.size));
        put_word("text", result == DPT_OK ? "" : diag.text);
        end();
        if (result == DPT_OK)
            put_result("open", dpt_arm_open(file.bytes, file.size, &arm));
        if (arm) {
            put_result("info", dpt_arm_get_info(arm, &info));
            for (int i = 0; i < 50; i++)
                arm_kinematics(arm, info.joints);
            for (int i = 0; i < 20; i++) { /* one byte is wrong, then right again */
                dpt_mesh_fault fault = { .size = sizeof fault };
                unsigned char *byte = (unsigned char *)file.bytes + bits() % file.size;
                *byte ^= 0x20;
                put_fault("verify", dpt_arm_verify(file.bytes, file.size, &fault), &fault);
                *byte ^= 0x20;
            }
        }
        dpt_compiled_free(&file);
    }
}

/* ---- guards, and a loop with a device that has its own time ---- */

static void guards_run(int count)
{
    for (int number = 0; number < count; number++) {
        dpt_guard_def def;
        dpt_guard guard = { .size = sizeof guard };
        uint64_t now = 0;
        dpt_guard_def_init(&def);
        state = 0x6a2d0000u + (uint32_t)number;
        snprintf(place, sizeof place, "guard %d", number);
        if (number % 2) {
            def.force_max = in(0.0, 10.0);
            def.force_slew = once_in(3) ? 0.0 : in(0.0, 5000.0);
            def.torque_slew = once_in(3) ? 0.0 : in(0.0, 100.0);
            def.hold = in(0.0, 0.01);
            def.stop = once_in(3) ? 0.0 : in(0.0, 0.01);
            def.start = once_in(3) ? 0.0 : in(0.0, 0.2);
        }
        put_result("init", dpt_guard_init(&guard, number % 2 ? &def : NULL));
        for (int tick = 0; tick < 400; tick++) {
            dpt_wrench command, out = { { 0 }, { 0 } };
            const double size = once_in(5) ? 20.0 : 4.0;
            for (int i = 0; i < 3; i++) {
                command.force[i] = in(-size, size);
                command.torque[i] = 0.05 * in(-size, size);
            }
            if (once_in(100))
                command.force[0] = NAN;
            now += once_in(50) ? 20000000 : 900000 + below(200000);
            const int silent = tick / 7 % 9 == 0 || once_in(10);
            dpt_guard_step(&guard, now, silent ? NULL : &command, !once_in(80), &out);
            put_wrench("guarded", DPT_OK, &out);
            put_guard(&guard);
        }
    }
}

struct feeling {
    dpt_world *world;
    dpt_tool tool;
    double scale, offset[3];
};

static dpt_result feel_at(struct feeling *feeling, const dpt_device_state *state, double dt,
                          dpt_wrench *wrench)
{
    dpt_pose pose = state->pose;
    for (int i = 0; i < 3; i++)
        pose.position[i] = feeling->offset[i] + feeling->scale * pose.position[i];
    begin("sample");
    put_count("status", state->status);
    put_count("reasons", state->reasons);
    put_count("sequence", state->sequence);
    put_count("time_ns", state->time_ns);
    put_number("dt", dt);
    put_numbers("position", state->pose.position, 3);
    put_numbers("orientation", state->pose.orientation, 4);
    put_numbers("velocity", state->velocity, 3);
    put_numbers("spin", state->spin, 3);
    end();
    dpt_tool_set_pose(feeling->world, feeling->tool, &pose);
    dpt_result result = dpt_world_step(feeling->world, dt, NULL);
    dpt_tool_get_wrench(feeling->world, feeling->tool, wrench);
    put_wrench("feels", result, wrench);
    return result;
}

#ifdef BEFORE_SAMPLES
static dpt_result feel(void *user, const dpt_device_state *state, double dt, dpt_wrench *wrench)
{
    return feel_at(user, state, dt, wrench);
}
#else
static dpt_result feel(void *user, const dpt_loop_sample *sample, dpt_wrench *wrench)
{
    return feel_at(user, sample->state, sample->dt, wrench);
}
#endif

static void loop_run(uint32_t number, const char *name, const struct subject *subject)
{
    dpt_device *device;
    dpt_device_error error = { .size = sizeof error };
    dpt_device_info info = { .size = sizeof info };
    dpt_device_counts counts = { .size = sizeof counts };
    dpt_loop_def def;
    dpt_loop *loop;
    dpt_loop_stats stats = { .size = sizeof stats };
    dpt_world_def world_def;
    struct feeling feeling = { .scale = 1.0 };
    dpt_body body;
    snprintf(place, sizeof place, "loop %u", number);
    dpt_result result = dpt_device_open(name, &device, &error);
    put_result("open", result);
    if (result != DPT_OK)
        return;
    dpt_world_def_init(&world_def);
    void *block = malloc(dpt_world_bytes(&world_def));
    const dpt_segment stylus = { { 0, 0, 0 }, { 0, 0, 0.1 }, 0.002 };
    dpt_world_create(block, dpt_world_bytes(&world_def), &world_def, &feeling.world);
    dpt_body_add(feeling.world, subject->mesh, NULL, &body);
    dpt_tool_add(feeling.world, &stylus, 1, &feeling.tool);
    dpt_device_get_info(device, &info);
    result = dpt_device_map(&info, subject->info.box_min, subject->info.box_max, &feeling.scale,
                            feeling.offset);
    begin("map");
    put_code("result", (int32_t)result);
    put_number("scale", feeling.scale);
    put_numbers("offset", feeling.offset, 3);
    end();
    dpt_loop_def_init(&def);
    def.priority = def.lock = 0;
    def.ticks = 1500;
    def.tick = feel;
    def.user = &feeling;
    put_result("loop_create", dpt_loop_create(device, &def, &loop));
    result = dpt_loop_run(loop, &stats);
    begin("stats");
    put_code("result", (int32_t)result);
    put_count("ticks", stats.ticks);
    put_count("fresh", stats.fresh);
    put_count("failed", stats.failed);
    put_count("stale", stats.stale);
    put_count("not_ready", stats.not_ready);
    put_count("lost", stats.lost);
    put_count("sent", stats.sent);
    put_count("refused", stats.refused);
    put_count("stops", stats.stops);
    put_count("clamped", stats.clamped);
    put_count("slewed", stats.slewed);
    dpt_device_get_counts(device, &counts);
    put_count("samples", counts.samples);
    put_count("commands", counts.commands);
    put_count("missed", counts.missed);
    end();
    dpt_loop_free(loop);
    dpt_device_close(device);
    free(block);
}

static void loops_run(void)
{
    static const char *const names[] = { "sim:?hand=press", "sim:?hand=wipe&dofs=6&delay=2",
                                         "sim:?hand=press&reach=0.05&cycle=1&step=1e-5",
                                         "sim:?hand=hold&fault=estop@0.5", "sim:?hand=nobody" };
    for (uint32_t i = 0; i < sizeof names / sizeof names[0]; i++)
        for (uint32_t k = 0; k < 4; k++)
            loop_run(4 * i + k, names[i], &subjects[(4 * i + k) % subject_count]);
}

/* ---- */

static int numbers_show(int argc, char **argv)
{
    for (int i = 2; i < argc; i++) {
        double value;
        const uint64_t pattern = strtoull(argv[i], NULL, 16);
        memcpy(&value, &pattern, sizeof value);
        printf("%.17g%c", value, i + 1 < argc ? ' ' : '\n');
    }
    return 0;
}

int main(int argc, char **argv)
{
    uint32_t worlds = 300, first = 0, last = UINT32_MAX;
    int at = 1;
    if (argc > 1 && strcmp(argv[1], "--number") == 0)
        return numbers_show(argc, argv);
    if (at + 1 < argc && strcmp(argv[at], "--worlds") == 0) {
        worlds = (uint32_t)strtoul(argv[at + 1], NULL, 10);
        at += 2;
    }
    const int only = at + 2 < argc && strcmp(argv[at], "--only") == 0;
    if (only) {
        first = (uint32_t)strtoul(argv[at + 1], NULL, 10);
        last = (uint32_t)strtoul(argv[at + 2], NULL, 10);
        at += 3;
    }
    subjects_make();
    for (; at < argc; at++)
        subject_read(argv[at]);
    kernels_find();
    if (!only) {
        pairs_alone(20000);
        meshes_alone();
        arms_run(60);
        guards_run(40);
        loops_run();
    }
    for (uint32_t i = first; i < worlds && i <= last; i++)
        world_run(i, 150);
    out_flush();
    fprintf(stderr,
            "%" PRIu64 " worlds, %" PRIu64 " ticks, %" PRIu64
            " with an axis through a surface; %" PRIu64 " regions, %" PRIu64
            " sweeps that met, %" PRIu64 " strips, %" PRIu64 " stale, %" PRIu64
            " ended by a budget; %" PRIu64 " lines, %" PRIu64 " values\n",
            met.worlds, met.ticks, met.crossing, met.contacts, met.swept, met.strips, met.stale,
            met.bounded, out_lines, out_values);
    return 0;
}
