/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What compiling costs, and what it makes of public meshes.
 *
 *     test_compile_data [TABLE]
 *
 * With DPT_DATA in the environment the meshes of TABLE, tests/data/data-meshes.txt, are compiled from
 * there. Times are compared with each other, never with a clock.
 */
#include <time.h>

#include "compile/compiled.h"

static const char *table = "tests/data/data-meshes.txt";

/* The least processor time of several compilations of each of two shapes, in turn. */
static double time_ratio(const char *name, uint32_t count, const char *other, uint32_t other_count)
{
    const char *names[] = { name, other };
    const uint32_t counts[] = { count, other_count };
    double least[2] = { HUGE_VAL, HUGE_VAL };
    for (int pass = 0; pass < 4; pass++)
        for (int i = 0; i < 2; i++) {
            struct shape shape;
            shape_reason reason;
            dpt_compiled out;
            if (shape_make(names[i], counts[i], 0, &shape, reason))
                return HUGE_VAL;
            clock_t begin = clock();
            dpt_compile_arrays(shape.vertices, shape.vertex_count, shape.corners,
                               shape.triangle_count, NULL, &out, NULL);
            least[i] = fmin(least[i], (double)(clock() - begin));
            dpt_compiled_free(&out);
            shape_free(&shape);
        }
    return least[0] / least[1];
}

/* A loaded machine can spoil one measurement, a quadratic step spoils all of them. */
static double least_ratio(const char *name, uint32_t count, const char *other, uint32_t other_count,
                          double enough)
{
    double least = HUGE_VAL;
    for (int attempt = 0; attempt < 3 && least > enough; attempt++)
        least = fmin(least, time_ratio(name, count, other, other_count));
    return least;
}

static void time_does_not_depend_on_the_shape(void)
{
    double hub = least_ratio("hub", 49928, "membrane", 49928, 4.0);
    CHECK(hub <= 4.0, "a hub takes %.1f times as long as a grid", hub);
    /* Both beyond the caches. n log n comes to 20; n^1.5, the next that code falls into, to 64. */
    double large = least_ratio("membrane", 1280000, "membrane", 80000, 35.0);
    CHECK(large < 35.0, "16 times the triangles take %.1f times as long", large);
    printf("    hub against grid: %.2f; 16 times the triangles: %.1f\n", hub, large);
}

/* One line of the table; -1 where it tells nothing. */
struct expected {
    char path[128];
    long triangles, closed, open, many, parts, degenerate, duplicate, unused;
};

static void check_count(const char *path, const char *what, long found, long expected)
{
    CHECK(expected < 0 || found == expected, "%s: %ld %s, not %ld", path, found, what, expected);
}

static void check_public_mesh(const char *folder, const struct expected *wanted)
{
    char path[1024];
    dpt_compiled out;
    struct sections s;
    dpt_diag diag = { .size = sizeof diag };
    dpt_compile_def def = { .size = sizeof def };
    snprintf(path, sizeof path, "%s/%s", folder, wanted->path);
    dpt_result result = dpt_compile_file(path, &def, &out, &diag);
    if (result == DPT_E_FINITE) {
        def.scale = 1e-34; /* cray_right_floatmax: the largest floats */
        result = dpt_compile_file(path, &def, &out, &diag);
    }
    CHECK(result == DPT_OK, "%s: %s", wanted->path, diag.text);
    if (result != DPT_OK || !sections_open(&s, &out))
        return;
    const dpt_mesh_info *info = &s.info;
    check_count(wanted->path, "triangles", info->source_triangles, wanted->triangles);
    check_count(wanted->path, "degenerate", info->dropped_degenerate, wanted->degenerate);
    check_count(wanted->path, "duplicate", info->dropped_duplicate, wanted->duplicate);
    check_count(wanted->path, "unused", info->unused_vertices, wanted->unused);
    check_count(wanted->path, "open edges", info->open_edges, wanted->open);
    check_count(wanted->path, "many-edges", info->nonmanifold_edges, wanted->many);
    check_count(wanted->path, "parts", info->components, wanted->parts);
    check_count(wanted->path, "closed", info->closed_components == info->components,
                wanted->closed);
    check_leaves(&s);
    check_boxes(&s);
    sections_close(&s);
    dpt_compiled_free(&out);
}

static void public_meshes_have_their_counts(void)
{
    const char *folder = getenv("DPT_DATA");
    char line[512];
    int count = 0;
    FILE *file = fopen(table, "r");
    CHECK(file != NULL, "%s", table);
    if (!file)
        return;
    while (folder && fgets(line, sizeof line, file)) {
        struct expected w;
        if (line[0] == '#' || line[0] == '\n')
            continue;
        int fields =
            sscanf(line, "%127s %ld %ld %ld %ld %ld %ld %ld %ld", w.path, &w.triangles, &w.closed,
                   &w.open, &w.many, &w.parts, &w.degenerate, &w.duplicate, &w.unused);
        CHECK(fields == 9, "%d fields in: %s", fields, line);
        if (fields == 9)
            check_public_mesh(folder, &w);
        count++;
    }
    fclose(file);
    CHECK(!folder || count == 61, "%d meshes", count);
}

int main(int argc, char **argv)
{
    if (argc > 1)
        table = argv[1];
    TEST(time_does_not_depend_on_the_shape);
    if (getenv("DPT_DATA"))
        TEST(public_meshes_have_their_counts);
    else
        SKIP("counts of public meshes", "DPT_DATA is not set");
    return check_report();
}
