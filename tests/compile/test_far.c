/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Meshes far from the origin: floats are coarse there. What is noted, what is refused, and what moving a mesh makes of it.
 */
#include <math.h>

#include "base/vec3.h"
#include "compile/heard.h"
#include "dynpoint/compile.h"
#include "dynpoint/mesh.h"
#include "scene/shape.h"
#include "lib/check.h"

static struct shape shape; /* a liver of 0.28 m, as it is made */

struct attempt {
    dpt_result result;
    dpt_diag diag;
    struct heard heard;
    dpt_compiled out;
    dpt_mesh_info info;
    const dpt_mesh *mesh;
};

/* The place of a vertex of the shape, far away. */
static void far_vertex(size_t v, const double far[3], double at[3])
{
    for (size_t k = 0; k < 3; k++)
        at[k] = shape.vertices[3 * v + k] + far[k];
}

static void compile_far(struct attempt *attempt, const double far[3], uint32_t recentre)
{
    double *vertices = malloc(3 * shape.vertex_count * sizeof *vertices);
    dpt_compile_def def;
    dpt_compile_def_init(&def);
    memset(attempt, 0, sizeof *attempt);
    attempt->diag.size = sizeof attempt->diag;
    attempt->info.size = sizeof attempt->info;
    def.note = hear;
    def.note_user = &attempt->heard;
    def.recentre = recentre;
    for (size_t v = 0; v < shape.vertex_count; v++)
        far_vertex(v, far, vertices + 3 * v);
    attempt->result = dpt_compile_arrays(vertices, shape.vertex_count, shape.corners, shape.triangle_count, &def,
                                         &attempt->out, &attempt->diag);
    if (attempt->result == DPT_OK)
        attempt->result = dpt_mesh_open(attempt->out.bytes, attempt->out.size, &attempt->mesh);
    if (attempt->result == DPT_OK)
        dpt_mesh_get_info(attempt->mesh, &attempt->info);
    free(vertices);
}

static int compare_edges(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

/* By sorting, of the floats that would be stored. */
static double median_edge(const double far[3])
{
    const size_t count = 3 * shape.triangle_count;
    double *edges = malloc(count * sizeof *edges);
    for (size_t i = 0; i < count; i++) {
        double a[3], b[3], square = 0.0;
        far_vertex(shape.corners[i], far, a);
        far_vertex(shape.corners[i % 3 == 2 ? i - 2 : i + 1], far, b);
        for (int k = 0; k < 3; k++) {
            const double side = (double)(float)a[k] - (double)(float)b[k];
            square += side * side;
        }
        edges[i] = sqrt(square);
    }
    qsort(edges, count, sizeof *edges, compare_edges);
    size_t zeros = 0;
    while (zeros < count && !(edges[zeros] > 0.0))
        zeros++;
    const double median = edges[zeros + (count - zeros) / 2];
    free(edges);
    return median;
}

static double rounding_of(const double far[3])
{
    double rounding = 0.0;
    for (size_t v = 0; v < shape.vertex_count; v++) {
        double at[3];
        far_vertex(v, far, at);
        for (int k = 0; k < 3; k++)
            rounding = fmax(rounding, fabs((double)(float)at[k] - at[k]));
    }
    return rounding;
}

/* Half as far again and again: at each place it is what the stated shares of the median edge say. */
static void shares_of_the_median_edge_decide(void)
{
    int seen[3] = { 0 };
    for (double distance = 500e3; distance > 0.01; distance *= 0.5) {
        const double far[3] = { distance, -0.25 * distance, 0.0 };
        const double share = rounding_of(far) / median_edge(far);
        const int expected = share > 0.1 ? 2 : share > 0.001 ? 1 : 0;
        struct attempt attempt;
        compile_far(&attempt, far, 0);
        const int found = attempt.result == DPT_E_FINITE ? 2 : attempt.heard.count;
        CHECK(found == expected && (found == 2 || attempt.result == DPT_OK), "at %g m: %d, not %d: %s", distance, found,
              expected, attempt.diag.text);
        if (found == 2)
            CHECK(strstr(attempt.diag.text, "too far from the origin; --recentre moves it"), "%s", attempt.diag.text);
        if (found == 1)
            CHECK(strstr(attempt.heard.last.text, "far from the origin; --recentre moves it"), "%s",
                  attempt.heard.last.text);
        seen[expected]++;
        dpt_compiled_free(&attempt.out);
    }
    CHECK(seen[0] > 2 && seen[1] > 2 && seen[2] > 2, "%d, %d, %d", seen[0], seen[1], seen[2]);
}

static void a_mesh_that_is_moved_keeps_its_shape(void)
{
    const double places[][3] = {
        { 500e3, 0.0, 0.0 }, { -4.2e6, 5.5e6, 120.0 }, { 9.9e8, 0.0, -1e3 }, { 0.3, 0.1, 0.0 }
    };
    for (size_t i = 0; i < sizeof places / sizeof *places; i++) {
        const double *far = places[i];
        struct attempt attempt;
        const float *xyz;
        const uint32_t *sources;
        uint32_t count = 0;
        double max = 0.0;
        compile_far(&attempt, far, 1);
        const dpt_mesh_info *info = &attempt.info;
        CHECK(attempt.result == DPT_OK && attempt.heard.count == 0, "%s%s", attempt.diag.text, attempt.heard.last.text);
        if (attempt.result != DPT_OK)
            continue;
        CHECK(info->format_version == 7 && info->triangles == shape.triangle_count, "%u triangles", info->triangles);
        dpt_mesh_get_vertices(attempt.mesh, &xyz, &count);
        dpt_mesh_get_vertex_sources(attempt.mesh, &sources, &count);
        for (uint32_t v = 0; v < count; v++) {
            double at[3];
            far_vertex(sources[v], far, at);
            for (int k = 0; k < 3; k++)
                max = fmax(max, fabs((double)xyz[3 * v + (uint32_t)k] - (at[k] - info->origin[k])));
        }
        CHECK(max == info->rounding && max < 1e-8, "rounded by %g, told %g", max, info->rounding);
        for (int k = 0; k < 3; k++) {
            const double tenths = info->origin[k] * 10.0;
            CHECK(fabs(0.5 * (info->box_min[k] + info->box_max[k])) <= 0.0501, "centre %g",
                  0.5 * (info->box_min[k] + info->box_max[k]));
            CHECK(fabs(tenths - floor(tenths + 0.5)) < 1e-5, "%.17g has many digits", info->origin[k]);
        }
        dpt_compiled_free(&attempt.out);
    }
}

static void a_mesh_at_the_origin_stays(void)
{
    const double here[3] = { 0.0 };
    struct attempt moved, left;
    compile_far(&moved, here, 1);
    compile_far(&left, here, 0);
    CHECK(moved.result == DPT_OK && moved.info.format_version == 6 && moved.out.size == left.out.size &&
              !memcmp(moved.out.bytes, left.out.bytes, left.out.size),
          "other bytes");
    dpt_compiled_free(&moved.out);
    dpt_compiled_free(&left.out);
}

static void what_cannot_be_moved_is_refused(void)
{
    const double far[3] = { 1.1e9, 0.0, 0.0 }, none[3] = { 0.0 };
    const double wide[9] = { 0.0, 0.0, 0.0, 1.1e6, 0.0, 0.0, 0.0, 1.0, 0.0 };
    const double nodes[12] = { 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1 };
    const uint32_t corners[4] = { 0, 1, 2, 3 };
    struct attempt attempt;
    dpt_diag diag = { .size = sizeof diag };
    dpt_compiled out;
    dpt_compile_def def;
    compile_far(&attempt, far, 1);
    CHECK(attempt.result == DPT_E_FINITE && strstr(attempt.diag.text, "x is 1.1"), "%s", attempt.diag.text);
    compile_far(&attempt, none, 2);
    CHECK(attempt.result == DPT_E_ARGUMENT, "%s", attempt.diag.text);
    dpt_compile_def_init(&def);
    def.recentre = 1;
    CHECK(dpt_compile_arrays(wide, 3, corners, 1, &def, &out, &diag) == DPT_E_FINITE && strstr(diag.text, "m large"),
          "%s", diag.text);
    def.nodes = nodes;
    def.node_count = 4;
    def.cells = corners;
    def.cell_count = 1;
    CHECK(dpt_compile_arrays(nodes, 3, corners, 1, &def, &out, &diag) == DPT_E_ARGUMENT &&
              strstr(diag.text, "recentre and cells"),
          "%s", diag.text);
}

/* A vertex that no polygon uses may lie anywhere. */
static void unused_vertices_do_not_count(void)
{
    const double vertices[12] = { 1e5, 0, 0, 1e5 + 1, 0, 0, 1e5, 1, 0, -1e9, 0, 0 };
    const uint32_t corners[3] = { 0, 1, 2 };
    const dpt_mesh *mesh;
    dpt_mesh_info info = { .size = sizeof info };
    dpt_diag diag = { .size = sizeof diag };
    dpt_compiled out;
    const dpt_compile_def def = { .size = sizeof def, .recentre = 1 };
    CHECK(dpt_compile_arrays(vertices, 4, corners, 1, &def, &out, &diag) == DPT_OK, "%s", diag.text);
    if (diag.code)
        return;
    dpt_mesh_open(out.bytes, out.size, &mesh);
    dpt_mesh_get_info(mesh, &info);
    CHECK(info.origin[0] == 100001.0 && info.rounding == 0.0, "%g, rounded by %g", info.origin[0], info.rounding);
    dpt_compiled_free(&out);
}

int main(void)
{
    shape_reason reason;
    if (shape_make("liver", 2000, 0, &shape, reason))
        return 1;
    TEST(shares_of_the_median_edge_decide);
    TEST(a_mesh_that_is_moved_keeps_its_shape);
    TEST(a_mesh_at_the_origin_stays);
    TEST(what_cannot_be_moved_is_refused);
    TEST(unused_vertices_do_not_count);
    shape_free(&shape);
    return check_report();
}
