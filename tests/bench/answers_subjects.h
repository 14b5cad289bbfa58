/* SPDX-License-Identifier: BSD-3-Clause */
/* The meshes that answers are asked of: made of grids, or read. A part of answers.c, which alone includes it. */
#ifndef DPT_BENCH_ANSWERS_SUBJECTS_H
#define DPT_BENCH_ANSWERS_SUBJECTS_H

#include "bench/answers_draw.h"

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
static void grid_add(struct grid *grid, enum form form, uint32_t columns, uint32_t rows, double rough, double scale,
                     uint32_t holes)
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
                    memcpy(grid->corners + 3 * grid->triangle_count++, two + 3 * t, 3 * sizeof *two);
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
        dpt_result result = dpt_compile_arrays(grid->vertices, grid->vertex_count, grid->corners, grid->triangle_count,
                                               &def, &compiled, &diag);
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
    struct grid grid = { malloc(3 * room * sizeof(double)), malloc(3 * room * sizeof(uint32_t)), 0, 0 };
    random_state = 1;
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

#endif
