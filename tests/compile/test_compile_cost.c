/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * How the cost of compiling grows with the mesh, and that it depends little on its shape, in basic blocks
 * (lib/block_count.h). Input that is made to be slow is in world/test_linear_cost.c.
 *
 *     test_compile_cost [PERCENT]      of the triangles; 100
 */
#include <math.h>

#include "compile/lattice.h"
#include "lib/block_count.h"
#include "lib/mesh_builder.h"

static double cost_of(struct mesh_builder *builder)
{
    const uint64_t begin = block_count;
    builder_compile(builder);
    return (double)(block_count - begin);
}

static double cost_of_shape(const char *name, uint64_t count)
{
    struct mesh_builder builder = { .vertices = NULL };
    builder_add_shape(&builder, name, count, (vec3){ 0.0, 0.0, 0.0 }, 1.0, 0, 0);
    const double cost = cost_of(&builder);
    builder_free(&builder);
    return cost;
}

/* Measured are 1,050 to 1,120 a triangle, with nothing to read. */
static void an_ordinary_mesh(void)
{
    const uint64_t count = part_of(50000);
    const double once = cost_of_shape("torus", count), again = cost_of_shape("torus", count);
    CHECK(once == again, "%.0f and %.0f basic blocks", once, again);
    printf("    %.0f basic blocks a triangle of a torus\n", once / (double)count);
    CHECK(once < 1800.0 * (double)count, "%.0f basic blocks a triangle", once / (double)count);
}

/* Measured: 1.5 to 1.6. */
static void the_shape_matters_little(void)
{
    const double ratio = cost_of_shape("hub", part_of(50000)) / cost_of_shape("torus", part_of(50000));
    CHECK(ratio <= 2.0, "a hub costs %.2f times as much as a torus", ratio);
    printf("    hub against torus: %.2f\n", ratio);
}

/* Measured: 17.1. n log n may come to 20; n^1.5, the next that code falls into, to 64. */
static void large_meshes_cost_in_proportion(void)
{
    const double ratio = cost_of_shape("torus", part_of(1280000)) / cost_of_shape("torus", part_of(80000));
    CHECK(ratio < 22.0, "16 times the triangles cost %.1f times as much", ratio);
    printf("    16 times the triangles: %.2f\n", ratio);
}

/* Long triangles all across a cube, of which all boxes meet. */
static double cost_of_slivers(size_t count, int joined)
{
    uint64_t random = 97;
    struct mesh_builder builder = { .vertices = NULL };
    builder_reserve(&builder, 3 * count, count);
    for (size_t t = 0; t < count; t++) {
        for (int v = 0; v < 2; v++)
            builder_add_vertex(&builder, random_in(&random, -1, 1), random_in(&random, -1, 1), v ? 1.0 : -1.0);
        builder_add_vertex(&builder, random_in(&random, -1, 1), random_in(&random, -1, 1), 1.0);
        if (joined) /* a strip: one part */
            builder_add_triangle(&builder, t, t + 1, t + 2, 0);
        else
            builder_add_triangle(&builder, 3 * t, 3 * t + 1, 3 * t + 2, 0);
    }
    const double cost = cost_of(&builder);
    CHECK(builder.info.self_intersections_more == 1, "%zu slivers: all searched", count);
    builder_free(&builder);
    return cost;
}

/*
 * The search for pairs that cut each other may take 2^23 units, 64 for each triangle and 1024 for each 16 of them
 * (intersections.c). Measured are 78 to 91 basic blocks a unit. All pairs of 20,000 slivers come to 1,100.
 */
static void cost_is_bounded_where_all_boxes_meet(void)
{
    const size_t counts[] = { 20000, 80000 };
    for (int joined = 0; joined < 2; joined++)
        for (int i = 0; i < (check_percent < 100 ? 1 : 2); i++) {
            const double units = 0x1p23 + 128.0 * (double)counts[i];
            const double a_unit = cost_of_slivers(counts[i], joined) / units;
            printf("    %zu slivers%s: %.1f basic blocks a unit\n", counts[i], joined ? " in a strip" : "", a_unit);
            CHECK(a_unit < 130.0, "%zu slivers: %.1f basic blocks a unit", counts[i], a_unit);
        }
}

/* Small tetrahedra in a grid, all within a ball. */
static double cost_of_parts(uint32_t across)
{
    const double size = 0.6 / across;
    const size_t count = (size_t)across * across * across;
    struct mesh_builder builder = { .vertices = NULL };
    builder_add_ball(&builder, (vec3){ 0.5, 0.5, 0.5 }, 2.0, 0.0, 0);
    builder_reserve(&builder, 4 * count, 4 * count);
    for (size_t i = 0; i < count; i++) {
        const double x = (double)(i % across) / across, y = (double)(i / across % across) / across;
        const double z = (double)(i / across / across) / across;
        const size_t base = builder.vertex_count;
        builder_add_vertex(&builder, x, y, z);
        builder_add_vertex(&builder, x + size, y, z);
        builder_add_vertex(&builder, x, y + size, z);
        builder_add_vertex(&builder, x, y, z + size);
        builder_add_triangle(&builder, base, base + 2, base + 1, 0);
        builder_add_triangle(&builder, base, base + 1, base + 3, 0);
        builder_add_triangle(&builder, base, base + 3, base + 2, 0);
        builder_add_triangle(&builder, base + 1, base + 2, base + 3, 0);
    }
    const double cost = cost_of(&builder);
    CHECK(builder.info.buried_components == count, "%u of %zu buried", builder.info.buried_components, count);
    builder_free(&builder);
    return cost;
}

/* Measured: 9.8 for 1,000 and 8,000 parts; 7.2 for 216 and 1,728, beside which the ball is large. */
static void many_parts_cost_in_proportion(void)
{
    const uint32_t few = check_percent < 100 ? 6 : 10;
    const double ratio = cost_of_parts(2 * few) / cost_of_parts(few);
    CHECK(ratio <= 12.0, "8 times the parts cost %.1f times as much", ratio);
    printf("    8 times the parts: %.2f\n", ratio);
}

/* A torus in a block of 6 across^3 cells; `share` of the block's size, so that it reaches out of it or not. */
static double cost_of_embedding(uint64_t triangles, uint32_t across, double share)
{
    struct shape shape;
    shape_reason reason;
    struct lattice lattice;
    dpt_compiled compiled;
    dpt_compile_def def = { .size = sizeof def };
    const double low[3] = { -0.16 * share, -0.16 * share, -0.05 * share };
    const double high[3] = { 0.16 * share, 0.16 * share, 0.05 * share };
    double cost[2] = { 0.0, 0.0 };
    if (shape_make("torus", triangles, 0, &shape, reason))
        return 0.0;
    lattice_make(&lattice, across, low, high, 3);
    for (int i = 0; i < 2; i++) {
        const uint64_t begin = block_count;
        CHECK(dpt_compile_arrays(shape.vertices, shape.vertex_count, shape.corners, shape.triangle_count, &def,
                                 &compiled, NULL) == DPT_OK,
              "%g of the block", share);
        cost[i] = (double)(block_count - begin);
        lattice_use(&lattice, &def);
        dpt_compiled_free(&compiled);
    }
    lattice_free(&lattice);
    shape_free(&shape);
    return cost[1] - cost[0];
}

/* Eight times the cells and four times the vertices. */
static void an_embedding_costs_in_proportion(void)
{
    const uint32_t across = check_percent < 100 ? 4 : 10;
    const double shares[] = { 1.0, 0.7 };
    for (int i = 0; i < 2; i++) {
        const double few = cost_of_embedding(part_of(25000), across, shares[i]);
        const double many = cost_of_embedding(4 * part_of(25000), 2 * across, shares[i]);
        printf("    %.0f%% of the block: %.0f and %.0f basic blocks a vertex\n", 100 * shares[i],
               few / (0.5 * (double)part_of(25000)), many / (2.0 * (double)part_of(25000)));
        CHECK(many < 8.0 * few, "%.1f times as much", many / few);
    }
}

int main(int argc, char **argv)
{
    take_percent(argc, argv);
    TEST(an_ordinary_mesh);
    TEST(the_shape_matters_little);
    TEST(large_meshes_cost_in_proportion);
    TEST(cost_is_bounded_where_all_boxes_meet);
    TEST(many_parts_cost_in_proportion);
    TEST(an_embedding_costs_in_proportion);
    return check_report();
}
