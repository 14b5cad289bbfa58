/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The compiler from its entries: what it keeps, mends, counts and refuses, and what it costs.
 * Whatever compiles is compared with compiled.h, which works everything out by comparing all with
 * all.
 */
#include <unistd.h>

#include "compile/compiled.h"

/* Allocations can be made to fail, and are counted, where the C library lets them be replaced. */
#if defined(__has_feature)
#if __has_feature(address_sanitizer)
#define REPLACED_BY_SANITIZER
#endif
#endif
#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(REPLACED_BY_SANITIZER)
#define CAN_FAIL_ALLOCATIONS
static long allocations_left = -1, blocks_in_use;
extern void *__libc_malloc(size_t size);
extern void *__libc_calloc(size_t count, size_t size);
extern void *__libc_realloc(void *block, size_t size);
extern void __libc_free(void *block);

static int may_allocate(void)
{
    if (allocations_left > 0)
        allocations_left--;
    return allocations_left != 0;
}

void *malloc(size_t size)
{
    void *block = may_allocate() ? __libc_malloc(size) : NULL;
    blocks_in_use += block != NULL;
    return block;
}

void *calloc(size_t count, size_t size)
{
    void *block = may_allocate() ? __libc_calloc(count, size) : NULL;
    blocks_in_use += block != NULL;
    return block;
}

void *realloc(void *old, size_t size)
{
    void *block = may_allocate() ? __libc_realloc(old, size) : NULL;
    blocks_in_use += block != NULL && old == NULL;
    return block;
}

void free(void *block)
{
    blocks_in_use -= block != NULL;
    __libc_free(block);
}
#endif

static dpt_result compile(const struct source *source, dpt_compiled *out, dpt_diag *diag)
{
    dpt_compile_def def = { .size = sizeof def, .scale = source->scale };
    return dpt_compile_arrays(source->vertices, source->vertex_count, source->corners, source->triangle_count, &def,
                              out, diag);
}

/* Compile, compare with compiled.h, and tell what was found. */
static dpt_mesh_info compiled_info(const struct source *source)
{
    dpt_compiled compiled;
    dpt_diag diag = { .size = sizeof diag };
    struct sections s = { .info.size = sizeof s.info };
    dpt_result result = compile(source, &compiled, &diag);
    CHECK(result == DPT_OK && diag.code == DPT_OK, "%d: %s", result, diag.text);
    if (result != DPT_OK)
        return s.info;
    CHECK((uintptr_t)compiled.bytes % 64 == 0, "aligned to %zu", (uintptr_t)compiled.bytes % 64);
    check_compiled(source, &compiled);
    sections_open(&s, &compiled);
    sections_close(&s);
    dpt_compiled_free(&compiled);
    CHECK(compiled.bytes == NULL && compiled.size == 0, "freed and not empty");
    return s.info;
}

#define COUNT_OF(array) ((uint32_t)(sizeof(array) / sizeof *(array)))
#define SOURCE(vertices, corners)                                                                                      \
    (struct source)                                                                                                    \
    {                                                                                                                  \
        vertices, corners, COUNT_OF(vertices) / 3, COUNT_OF(corners) / 3, 1.0                                          \
    }

static const double cube[] = { 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, 1, 1, 1, 0, 1, 1 };
static const uint32_t cube_corners[] = { 0, 2, 1, 0, 3, 2, 4, 5, 6, 4, 6, 7, 0, 1, 5, 0, 5, 4,
                                         1, 2, 6, 1, 6, 5, 2, 3, 7, 2, 7, 6, 3, 0, 4, 3, 4, 7 };

static void equal_vertices_are_joined(void)
{
    double loose[36 * 3];
    uint32_t corners[36];
    for (uint32_t i = 0; i < 36; i++) {
        corners[i] = i;
        for (uint32_t k = 0; k < 3; k++) {
            double x = cube[3 * cube_corners[i] + k];
            loose[3 * i + k] = x == 0.0 && i % 2 ? -0.0 : x;
        }
    }
    struct source source = SOURCE(loose, corners);
    dpt_mesh_info info = compiled_info(&source);
    CHECK(info.vertices == 8 && info.triangles == 12 && info.closed_components == 1 && info.open_edges == 0 &&
              info.unused_vertices == 0 && info.source_vertices == 36,
          "%u vertices, %u open edges", info.vertices, info.open_edges);
    /* What is equal after rounding is one; what differs by the last bit of a float is not. */
    loose[0] = 1e-60;
    CHECK(compiled_info(&source).vertices == 8, "1e-60 is not 0");
    loose[3 * 1] = 1.0 + 0x1p-25;
    CHECK(compiled_info(&source).vertices == 8, "rounds to 1");
    loose[3 * 1] = 1.0 + 0x1p-23;
    CHECK(compiled_info(&source).vertices == 9, "does not round to 1");
}

static void bad_triangles_are_dropped(void)
{
    const double vertices[] = { 0, 0, 0, 1, 0, 0, 0, 1, 0, 2, 0, 0, 0, 0, 0, 5, 5, 5, 1, 1, 0 };
    const uint32_t corners[] = {
        0, 0, 1, /* two corners alike */
        0, 1, 3, /* in a line */
        0, 1, 2, /* kept */
        0, 4, 2, /* two corners at one place */
        2, 0, 1, /* again */
        1, 0, 2, /* again, the other way round */
        4, 1, 2, /* again, by the vertex at the same place */
        1, 6, 2, /* kept */
        6, 6, 6, /* a point */
    };
    struct source source = SOURCE(vertices, corners);
    dpt_mesh_info info = compiled_info(&source);
    CHECK(info.triangles == 2 && info.dropped_degenerate == 4 && info.dropped_duplicate == 3 &&
              info.unused_vertices == 1 && info.vertices == 4 && info.open_edges == 4,
          "%u, %u, %u", info.triangles, info.dropped_degenerate, info.dropped_duplicate);
    dpt_compiled compiled;
    const dpt_mesh *mesh;
    double at[9];
    compile(&source, &compiled, NULL);
    CHECK(dpt_mesh_convert(compiled.bytes, compiled.size, NULL) == DPT_OK, "not opened");
    CHECK(dpt_mesh_open(compiled.bytes, compiled.size, &mesh) == DPT_OK, "not opened");
    for (uint32_t t = 0; t < 10; t++)
        CHECK(dpt_mesh_get_triangle(mesh, t, at) == (t == 2 || t == 7 ? DPT_OK : DPT_E_ARGUMENT), "triangle %u", t);
    for (int method = 0; method <= DPT_METHOD_BRUTE; method++)
        for (int i = 0; i < 100; i++) {
            uint64_t random = (uint64_t)i;
            dpt_query_def query = { .size = sizeof query, .method = (uint32_t)method };
            dpt_hit hit = DPT_HIT_INIT;
            double ends[6];
            for (int k = 0; k < 6; k++)
                ends[k] = random_in(&random, -1, 3);
            dpt_query_segments(mesh, NULL, ends, NULL, 1, &hit, &query);
            CHECK(hit.triangle == 2 || hit.triangle == 7, "%u was dropped", hit.triangle);
        }
    dpt_compiled_free(&compiled);
}

static void closed_parts_are_wound_outward(void)
{
    uint32_t corners[36];
    double two[48];
    struct source source = SOURCE(cube, corners);
    for (int flips = 0; flips < 4096; flips += flips < 64 ? 1 : 63) {
        memcpy(corners, cube_corners, sizeof corners);
        for (int t = 0; t < 12; t++)
            if (flips >> t & 1) {
                corners[3 * t] = cube_corners[3 * t + 1];
                corners[3 * t + 1] = cube_corners[3 * t];
            }
        dpt_mesh_info info = compiled_info(&source);
        CHECK(info.closed_components == 1 && info.components == 1 && info.inward_components == (flips == 4095) &&
                  info.turned_triangles == (uint32_t)__builtin_popcount((unsigned)flips),
              "%03x: %u turned, %u inward", flips, info.turned_triangles, info.inward_components);
    }
    /* Two parts far apart, the second one inward: each is judged alone. */
    uint32_t both[72];
    for (int i = 0; i < 36; i++) {
        both[i] = cube_corners[i];
        both[36 + i] = 8 + cube_corners[i / 3 * 3 + 2 - i % 3];
    }
    for (int i = 0; i < 24; i++) {
        two[i] = cube[i];
        two[24 + i] = cube[i] + 5e5;
    }
    source = SOURCE(two, both);
    dpt_mesh_info info = compiled_info(&source);
    CHECK(info.components == 2 && info.closed_components == 2 && info.inward_components == 1 &&
              info.turned_triangles == 12,
          "%u parts, %u turned", info.components, info.turned_triangles);
}

/* A band of `count` squares that closes on itself, with a half turn or without. */
static dpt_mesh_info band(uint32_t count, int half_turn)
{
    double vertices[60 * 2];
    uint32_t corners[120];
    for (uint32_t i = 0; i < count; i++) {
        double turn = 6.28318530717958648 * i / count, lean = half_turn ? 0.5 * turn : 0.0;
        for (int side = 0; side < 2; side++) {
            double *v = vertices + 6 * i + 3 * side, out = side ? 0.3 : -0.3;
            v[0] = cos(turn) * (1.0 + out * sin(lean));
            v[1] = sin(turn) * (1.0 + out * sin(lean));
            v[2] = out * cos(lean);
        }
        uint32_t a = 2 * i, b = a + 1, c = 2 * ((i + 1) % count), d = c + 1;
        if (half_turn && i + 1 == count) {
            c = 1;
            d = 0;
        }
        const uint32_t square[6] = { a, c, d, a, d, b };
        memcpy(corners + 6 * i, square, sizeof square);
    }
    return compiled_info(&(struct source){ vertices, corners, 2 * count, 2 * count, 1.0 });
}

static void surfaces_of_every_kind(void)
{
    dpt_mesh_info info = band(12, 0);
    CHECK(info.open_edges == 24 && info.wrong_way_edges == 0 && info.closed_components == 0, "band: %u open",
          info.open_edges);
    info = band(12, 1);
    CHECK(info.open_edges == 24 && info.wrong_way_edges == 1 && info.closed_components == 0 &&
              info.turned_triangles == 0,
          "Moebius strip: %u open, %u against", info.open_edges, info.wrong_way_edges);

    /* The projective plane in six vertices: every edge has two triangles, and there is no inside.
     */
    const double six[] = { 0, 0, 1, 1, 0, 0, 0.3, 1, 0, -0.8, 0.6, 0.1, -0.8, -0.6, 0, 0.3, -1, 0.2 };
    const uint32_t plane[] = {
        0, 1, 2, 0, 2, 3, 0, 3, 4, 0, 4, 5, 0, 5, 1, 1, 2, 4, 2, 3, 5, 3, 4, 1, 4, 5, 2, 5, 1, 3
    };
    struct source source = SOURCE(six, plane);
    info = compiled_info(&source);
    CHECK(info.open_edges == 0 && info.nonmanifold_edges == 0 && info.components == 1 && info.closed_components == 0 &&
              info.turned_triangles == 0,
          "projective plane: %u closed", info.closed_components);

    /* Three half planes on one edge, each of two triangles: one part, one edge of three. */
    const double leaves[] = { 0, 0, 0, 0, 0, 1, 1, 0, 0, -1, 1, 0, -1, -1, 0, 2, 0, 1, -2, 2, 1 };
    const uint32_t three[] = { 0, 1, 2, 0, 1, 3, 0, 1, 4, 2, 1, 5, 3, 6, 1 };
    source = SOURCE(leaves, three);
    info = compiled_info(&source);
    CHECK(info.nonmanifold_edges == 1 && info.components == 1 && info.closed_components == 0 &&
              info.wrong_way_edges == 1,
          "three on an edge: %u many, %u against", info.nonmanifold_edges, info.wrong_way_edges);

    /* Two tetrahedra that meet in a vertex are two closed parts, in an edge one that is not. */
    const double points[] = { 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, -1, 0, 0, 0, -1, 0, 0, 0, -1 };
    const uint32_t corner[] = { 0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3, 0, 4, 5, 0, 6, 4, 0, 5, 6, 4, 6, 5 };
    const uint32_t edge[] = { 0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3, 0, 3, 4, 0, 4, 5, 0, 5, 3, 3, 5, 4 };
    source = SOURCE(points, corner);
    info = compiled_info(&source);
    CHECK(info.components == 2 && info.closed_components == 2 && info.vertices == 7, "meet in a vertex: %u parts",
          info.components);
    source = SOURCE(points, edge);
    info = compiled_info(&source);
    CHECK(info.components == 1 && info.closed_components == 0 && info.nonmanifold_edges == 1,
          "meet in an edge: %u many", info.nonmanifold_edges);
}

static void shapes_agree_with_brute_force(void)
{
    static const struct {
        const char *name;
        uint32_t count;
    } wanted[] = {
        { "torus", 400 }, { "liver", 300 }, { "stomach", 301 }, { "spleen", 272 }, { "star", 2000 },
        { "cloth", 288 }, { "box", 300 },   { "hub", 500 },     { "sphere", 256 }, { "sphere", 258 },
    };
    for (size_t i = 0; i < COUNT_OF(wanted); i++) {
        struct shape shape;
        shape_reason reason;
        if (shape_make(wanted[i].name, wanted[i].count, 0, &shape, reason)) {
            CHECK(0, "%s", reason);
            continue;
        }
        struct source source = { shape.vertices, shape.corners, (uint32_t)shape.vertex_count,
                                 (uint32_t)shape.triangle_count, i % 2 ? 0.001 : 1.0 };
        dpt_mesh_info info = compiled_info(&source);
        CHECK(info.triangles == wanted[i].count && info.components == 1, "%s: %u triangles", wanted[i].name,
              info.triangles);
        shape_free(&shape);
    }
}

/* A few places and many triangles between them: every defect there is, in all combinations. */
static void soups_agree_with_brute_force(void)
{
    uint64_t random = 7;
    double vertices[60 * 3];
    uint32_t corners[200 * 3];
    for (int i = 0; i < 2000; i++) {
        struct source source = { vertices, corners, 4 + (uint32_t)(random_bits(&random) % 40),
                                 1 + (uint32_t)(random_bits(&random) % (i % 50 ? 24 : 200)), 1.0 };
        uint64_t places = 2 + random_bits(&random) % 4;
        if (i % 3 == 0)
            source.scale = 1.0 / 3.0;
        for (uint32_t k = 0; k < 3 * source.vertex_count; k++)
            vertices[k] = (double)(random_bits(&random) % places) - (double)(places / 2);
        for (uint32_t k = 0; k < 3 * source.triangle_count; k++)
            corners[k] = (uint32_t)(random_bits(&random) % source.vertex_count);
        corners[0] = 0;
        corners[1] = 1;
        corners[2] = 2; /* at least this one has an area */
        vertices[0] = 9.0;
        vertices[4] = 9.1;
        vertices[8] = 9.2;
        compiled_info(&source);
        if (check_bad)
            break;
    }
}

static dpt_mesh_info info_of_text(const char *text, dpt_result expected)
{
    dpt_compiled compiled;
    dpt_diag diag = { .size = sizeof diag };
    struct sections s = { .info.size = sizeof s.info };
    dpt_result result = dpt_compile_bytes(text, strlen(text), NULL, &compiled, &diag);
    CHECK(result == expected && diag.code == expected, "%d: %s", result, diag.text);
    if (result == DPT_OK && sections_open(&s, &compiled))
        sections_close(&s);
    dpt_compiled_free(&compiled);
    return s.info;
}

static void concave_polygons_are_reported(void)
{
    dpt_mesh_info info = info_of_text("v 0 0 0\nv 2 0 0\nv 0.5 0.5 0\nv 0 2 0\nf 1 2 3 4\n", DPT_OK);
    CHECK(info.concave_polygons == 1 && info.source_triangles == 2, "arrow: %u", info.concave_polygons);
    info = info_of_text("v 0 0 0\nv 2 0 0\nv 3 1 0\nv 1 3 0\nv 0 2 0\nf 1 2 3 4 5\nf 5 4 3\n", DPT_OK);
    CHECK(info.concave_polygons == 0 && info.source_triangles == 4, "pentagon: %u", info.concave_polygons);
}

/* The same arguments, the same bytes; through a text or a file only the source's own data differ.
 */
static void same_input_gives_same_bytes(void)
{
    const char *text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
    char path[64];
    const double vertices[] = { 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1 };
    const uint32_t corners[] = { 0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3 };
    const size_t header = mesh_header_bytes(MESH_VERSION_PLAIN);
    struct source source = SOURCE(vertices, corners);
    dpt_compiled made[6];
    snprintf(path, sizeof path, "build/test_compile.%ld.obj", (long)getpid());
    FILE *file = fopen(path, "wb");
    CHECK(file != NULL, "%s", path);
    if (!file)
        return;
    fputs(text, file);
    fclose(file);
    for (int i = 0; i < 2; i++) {
        CHECK(compile(&source, &made[i], NULL) == DPT_OK, "arrays");
        CHECK(dpt_compile_bytes(text, strlen(text), NULL, &made[2 + i], NULL) == DPT_OK, "bytes");
        CHECK(dpt_compile_file(path, NULL, &made[4 + i], NULL) == DPT_OK, "file");
    }
    remove(path);
    for (int i = 0; i < 6; i++) {
        CHECK(made[i].size == made[0].size, "%zu bytes", made[i].size);
        size_t from = i < 2 ? 0 : header;
        CHECK(!memcmp((char *)made[i].bytes + from, (char *)made[0].bytes + from, made[0].size - from),
              "other bytes in %d", i);
    }
    CHECK(!memcmp(made[2].bytes, made[3].bytes, made[0].size), "other bytes the second time");
    CHECK(!memcmp(made[2].bytes, made[4].bytes, made[0].size), "other bytes from a file");
    for (int i = 0; i < 6; i++)
        dpt_compiled_free(&made[i]);
}

struct meter {
    int calls, stop_at, bad;
    double done;
    char step[32];
};

static int watch(void *user, const char *step, double done)
{
    struct meter *meter = user;
    meter->bad += !(done >= 0.0 && done <= 1.0);
    meter->bad += !strcmp(step, meter->step) && done < meter->done;
    snprintf(meter->step, sizeof meter->step, "%s", step);
    meter->done = done;
    return ++meter->calls == meter->stop_at;
}

static void progress_is_told_and_cancels(void)
{
    struct shape shape;
    shape_reason reason;
    struct meter meter = { .stop_at = 0 };
    dpt_compile_def def = { .size = sizeof def, .progress = watch, .user = &meter };
    dpt_compiled out;
    dpt_diag diag = { .size = sizeof diag };
    if (shape_make("torus", 140000, 0, &shape, reason))
        return;
    for (int stop = 0, calls = 1; stop <= calls; stop++) {
        meter = (struct meter){ .stop_at = stop };
        out = (dpt_compiled){ &out, 7 };
        dpt_result result = dpt_compile_arrays(shape.vertices, shape.vertex_count, shape.corners, shape.triangle_count,
                                               &def, &out, &diag);
        CHECK(meter.bad == 0, "%d calls went back", meter.bad);
        if (stop == 0) {
            calls = meter.calls;
            CHECK(result == DPT_OK && calls >= 5, "%d calls", calls);
        } else {
            CHECK(result == DPT_E_CANCELLED && diag.code == DPT_E_CANCELLED && !out.bytes && !out.size &&
                      meter.calls == stop,
                  "stopped at %d: %d after %d", stop, result, meter.calls);
        }
        dpt_compiled_free(&out);
    }
    shape_free(&shape);
}

static void expect_refusal(const struct source *source, const dpt_compile_def *def, dpt_result code, uint64_t byte)
{
    dpt_diag diag = { .size = sizeof diag };
    dpt_compiled out = { &diag, 7 };
    dpt_result result = dpt_compile_arrays(source->vertices, source->vertex_count, source->corners,
                                           source->triangle_count, def, &out, &diag);
    CHECK(result == code && diag.code == code && diag.byte == byte && diag.line == 0 && diag.text[0] &&
              memchr(diag.text, 0, sizeof diag.text),
          "%s at %llu (%s), not %s", dpt_result_name(result), (unsigned long long)diag.byte, diag.text,
          dpt_result_name(code));
    CHECK(!out.bytes && !out.size, "left an output");
    CHECK(dpt_compile_arrays(source->vertices, source->vertex_count, source->corners, source->triangle_count, def, &out,
                             NULL) == code,
          "the diag may be NULL");
}

static void wrong_input_is_refused(void)
{
    const double scales[] = { -1.0, -1e-300, NAN, INFINITY, -INFINITY, 1e300 };
    const double nothing[] = { 0, 0, 0, 0, 0, 0, 1, 0, 0 };
    const uint32_t corners[] = { 0, 1, 2 }, beyond[] = { 0, 1, 2, 2, 8, 1 };
    dpt_compile_def def = { .size = sizeof def };
    struct source good = SOURCE(cube, cube_corners), bad = good;
    for (size_t i = 0; i < COUNT_OF(scales); i++) {
        def.scale = scales[i];
        expect_refusal(&good, &def, DPT_E_ARGUMENT, 0);
    }
    def.scale = 1000001.0;
    expect_refusal(&good, &def, DPT_E_FINITE, 24);
    def.scale = 1e6;
    dpt_compiled out;
    CHECK(dpt_compile_arrays(cube, 8, cube_corners, 12, &def, &out, NULL) == DPT_OK, "1e6 m");
    dpt_compiled_free(&out);
    def.scale = 0.0;
    bad.vertices = NULL;
    expect_refusal(&bad, &def, DPT_E_ARGUMENT, 0);
    bad.vertex_count = 0;
    expect_refusal(&bad, &def, DPT_E_INDEX, 36);
    bad = good;
    bad.corners = NULL;
    expect_refusal(&bad, NULL, DPT_E_ARGUMENT, 0);
    bad.triangle_count = 0;
    expect_refusal(&bad, NULL, DPT_E_EMPTY, 0);
    bad.vertices = NULL;
    bad.vertex_count = 0;
    expect_refusal(&bad, NULL, DPT_E_EMPTY, 0);
    bad = SOURCE(nothing, corners);
    expect_refusal(&bad, NULL, DPT_E_EMPTY, 0);
    bad = SOURCE(cube, beyond);
    expect_refusal(&bad, NULL, DPT_E_INDEX, 12);
    for (uint32_t k = 0; k < 24; k++) {
        double vertices[24];
        const double values[] = { NAN, INFINITY, -INFINITY, 1e7 };
        memcpy(vertices, cube, sizeof vertices);
        vertices[k] = values[k % 4];
        bad = SOURCE(vertices, cube_corners);
        expect_refusal(&bad, NULL, DPT_E_FINITE, k / 3 * 24);
    }
    def.recentre = 2;
    expect_refusal(&good, &def, DPT_E_ARGUMENT, 0);
    def.size = offsetof(dpt_compile_def, recentre); /* where it ends before, nobody looks */
    CHECK(dpt_compile_arrays(cube, 8, cube_corners, 12, &def, &out, NULL) == DPT_OK, "recentre");
    dpt_compiled_free(&out);
    def.size = offsetof(dpt_compile_def, crease) - 1;
    expect_refusal(&good, &def, DPT_E_SIZE, 0);
}

static void wrong_arguments_are_refused(void)
{
    dpt_compiled out = { &out, 7 };
    dpt_diag small = { .size = 8, .code = 77 };
    CHECK(dpt_compile_arrays(cube, 8, cube_corners, 12, NULL, NULL, NULL) == DPT_E_ARGUMENT, "out");
    CHECK(dpt_compile_bytes("v", 1, NULL, NULL, NULL) == DPT_E_ARGUMENT, "out");
    CHECK(dpt_compile_file("none", NULL, NULL, NULL) == DPT_E_ARGUMENT, "out");
    CHECK(dpt_compile_bytes(NULL, 1, NULL, &out, NULL) == DPT_E_ARGUMENT && !out.bytes, "bytes");
    CHECK(dpt_compile_bytes(NULL, 0, NULL, &out, NULL) == DPT_E_EMPTY, "no bytes");
    CHECK(dpt_compile_file(NULL, NULL, &out, NULL) == DPT_E_ARGUMENT && !out.bytes, "no name");
    CHECK(dpt_compile_file("build/no/such", NULL, &out, &small) == DPT_E_SIZE, "small");
    CHECK(dpt_compile_file("build/no/such", NULL, &out, NULL) == DPT_E_OPEN, "no file");
    CHECK(small.code == 77, "a diag that is too small is written");
    CHECK(dpt_compile_file("tests", NULL, &out, NULL) == DPT_E_OPEN, "a folder");
    for (uint32_t format = DPT_FORMAT_OFF + 1; format; format = format > 9 ? 0 : UINT32_MAX) {
        dpt_compile_def def = { .size = sizeof def, .format = format };
        CHECK(dpt_compile_bytes("v 0 0 0\n", 8, &def, &out, NULL) == DPT_E_ARGUMENT, "%u", format);
    }
    /* -1 of another language, and what is near it: nothing is read, not the arrays' ends either. */
    const size_t counts[] = { UINT32_MAX, UINT32_MAX - 1, (size_t)INT32_MAX + 1, SIZE_MAX };
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++) {
        dpt_diag diag = { .size = sizeof diag };
        CHECK(dpt_compile_arrays(cube, counts[i], cube_corners, 12, NULL, &out, &diag) == DPT_E_LIMIT &&
                  strstr(diag.text, "vertices"),
              "%zu vertices: %s", counts[i], diag.text);
        CHECK(dpt_compile_arrays(cube, 8, cube_corners, counts[i], NULL, &out, &diag) == DPT_E_LIMIT &&
                  strstr(diag.text, "triangles"),
              "%zu triangles: %s", counts[i], diag.text);
    }
    dpt_compiled_free(NULL);
    dpt_compiled_free(&out);
    /* Of a def that is too short nothing beyond its end is read: the sanitizer looks on. */
    uint32_t *words = malloc(8);
    words[0] = 8;
    words[1] = 0;
    CHECK(dpt_compile_arrays(cube, 8, cube_corners, 12, (dpt_compile_def *)(void *)words, &out, NULL) == DPT_E_SIZE,
          "a def of 8 bytes");
    free(words);
}

/* Let the first, the second, ... allocation fail, through every entry and reader. */
static void failing_allocations_leave_nothing(void)
{
#ifdef CAN_FAIL_ALLOCATIONS
    static const char *const texts[] = {
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n",
        "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
        "endloop\nendfacet\nendsolid\n",
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
        "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
        "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
        "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
    };
    const double nodes[] = { 0, 0, 0, 4, 0, 0, 0, 4, 0, 0, 0, 4 };
    const uint32_t cell[] = { 0, 1, 2, 3 };
    const dpt_compile_def embedding = {
        .size = sizeof embedding, .nodes = nodes, .cells = cell, .node_count = 4, .cell_count = 1
    };
    const dpt_spring_net_def springs = { sizeof springs, DPT_NET_VOLUME, .spacing = 0.5 };
    const dpt_compile_def with_springs = { .size = sizeof with_springs, .springs = &springs };
    const dpt_compile_def *const defs[] = { NULL, &embedding, &with_springs };
    for (int entry = 0; entry < 8; entry++) {
        dpt_result result = DPT_E_MEMORY;
        long fail_at = 1;
        for (; result != DPT_OK && fail_at < 1000; fail_at++) {
            dpt_compiled out;
            dpt_diag diag = { .size = sizeof diag };
            long before = blocks_in_use;
            allocations_left = fail_at;
            if (entry < 4)
                result = dpt_compile_bytes(texts[entry], strlen(texts[entry]), NULL, &out, &diag);
            else if (entry < 7)
                result = dpt_compile_arrays(cube, 8, cube_corners, 12, defs[entry - 4], &out, &diag);
            else
                result = dpt_compile_file("tests/golden/torus.ply", NULL, &out, &diag);
            allocations_left = -1;
            CHECK(result == DPT_OK || result == DPT_E_MEMORY || (entry == 7 && result == DPT_E_OPEN),
                  "entry %d, allocation %ld: %s", entry, fail_at, dpt_result_name(result));
            CHECK(diag.code == result && (result == DPT_OK || (!out.bytes && !out.size)),
                  "entry %d, allocation %ld: %d", entry, fail_at, diag.code);
            dpt_compiled_free(&out);
            CHECK(blocks_in_use == before, "entry %d, allocation %ld: %ld blocks are left", entry, fail_at,
                  blocks_in_use - before);
        }
        CHECK(fail_at > 10 && fail_at < 1000, "entry %d: %ld allocations", entry, fail_at);
    }
#else
    SKIP("allocations that fail", "the sanitizer's allocator cannot be replaced");
#endif
}

int main(void)
{
    TEST(equal_vertices_are_joined);
    TEST(bad_triangles_are_dropped);
    TEST(closed_parts_are_wound_outward);
    TEST(surfaces_of_every_kind);
    TEST(shapes_agree_with_brute_force);
    TEST(soups_agree_with_brute_force);
    TEST(concave_polygons_are_reported);
    TEST(same_input_gives_same_bytes);
    TEST(progress_is_told_and_cancels);
    TEST(wrong_input_is_refused);
    TEST(failing_allocations_leave_nothing);
    TEST(wrong_arguments_are_refused);
    return check_report();
}
