/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A body at rest costs nothing, whatever its size: counted in basic blocks (lib/block_count.h).
 */
#include "dynpoint.h"
#include "dynpoint/compile.h"
#include "lib/block_count.h"
#include "lib/check.h"
#include "shape.h"

/* A ball of springs in a world without tools. */
struct ball {
    dpt_compiled compiled;
    const dpt_mesh *mesh;
    void *world_block, *body_block, *springs_block;
    dpt_world *world;
    dpt_body body;
    dpt_springs *springs;
};

static void open_ball(struct ball *ball, uint64_t triangles, double spacing)
{
    dpt_spring_net_def net;
    dpt_compile_def compile;
    dpt_world_def world;
    dpt_deform_def deform;
    dpt_springs_def def;
    struct shape shape;
    shape_reason reason;
    dpt_spring_net_def_init(&net);
    dpt_compile_def_init(&compile);
    dpt_world_def_init(&world);
    dpt_deform_def_init(&deform);
    dpt_springs_def_init(&def);
    net.kind = DPT_NET_VOLUME;
    net.drag = 5.0;
    net.viscosity = 1e-3;
    net.spacing = spacing;
    compile.springs = &net;
    CHECK(!shape_make("sphere", triangles, 0, &shape, reason), "%s", reason);
    CHECK(dpt_compile_arrays(shape.vertices, shape.vertex_count, shape.corners,
                             shape.triangle_count, &compile, &ball->compiled, NULL) == DPT_OK,
          "not compiled");
    shape_free(&shape);
    CHECK(dpt_mesh_open(ball->compiled.bytes, ball->compiled.size, &ball->mesh) == DPT_OK, "bad");
    deform.mesh = def.mesh = ball->mesh;
    ball->world_block = malloc(dpt_world_bytes(&world));
    ball->body_block = malloc(dpt_deform_bytes(&deform));
    ball->springs_block = malloc(dpt_springs_bytes(&def));
    CHECK(dpt_world_create(ball->world_block, dpt_world_bytes(&world), &world, &ball->world) ==
                  DPT_OK &&
              dpt_deform_add(ball->world, ball->body_block, dpt_deform_bytes(&deform), &deform,
                             &ball->body) == DPT_OK &&
              dpt_springs_create(ball->springs_block, dpt_springs_bytes(&def), &def,
                                 &ball->springs) == DPT_OK,
          "not made");
}

static void close_ball(struct ball *ball)
{
    dpt_compiled_free(&ball->compiled);
    free(ball->world_block);
    free(ball->body_block);
    free(ball->springs_block);
}

/* The basic blocks of one step of a ball; `report` is filled in. */
static uint64_t step_cost(struct ball *ball, dpt_springs_report *report)
{
    const uint64_t begin = block_count;
    const dpt_result result =
        dpt_deform_step_springs(ball->world, ball->body, ball->springs, 1e-3, report);
    const uint64_t cost = block_count - begin;
    CHECK(result == DPT_OK, "%s", dpt_result_name(result));
    return cost;
}

/* Let a ball fall asleep. What its steps cost, awake, then asleep. */
static void costs_of(struct ball *ball, uint64_t *awake, uint64_t *asleep)
{
    dpt_springs_report report = { .size = sizeof report };
    *awake = step_cost(ball, &report);
    CHECK(report.active == report.nodes, "%u of %u awake", report.active, report.nodes);
    for (int i = 0; i < 1000 && report.active; i++)
        step_cost(ball, &report);
    *asleep = step_cost(ball, &report);
    CHECK(report.active == 0, "%u of %u awake", report.active, report.nodes);
    printf("    %u nodes: %.0f basic blocks awake, %.0f asleep\n", report.nodes, (double)*awake,
           (double)*asleep);
}

static void a_body_at_rest_costs_nothing(void)
{
    struct ball small, large;
    uint64_t awake[2], asleep[2];
    open_ball(&small, 320, 0.02);
    open_ball(&large, 20480, 0.006);
    costs_of(&small, &awake[0], &asleep[0]);
    costs_of(&large, &awake[1], &asleep[1]);
    CHECK(awake[1] > 10 * awake[0], "%.0f and %.0f", (double)awake[0], (double)awake[1]);
    CHECK(asleep[1] < asleep[0] + 20 && asleep[0] < 300, "%.0f and %.0f", (double)asleep[0],
          (double)asleep[1]);
    close_ball(&small);
    close_ball(&large);
}

/* Where all vertices are handed over, the body's array is another one in the next tick. */
static void a_body_at_rest_is_not_handed_over(void)
{
    struct ball ball;
    dpt_springs_report report = { .size = sizeof report };
    const float *positions, *again;
    uint32_t count;
    open_ball(&ball, 1280, 0.02);
    for (int i = 0; i < 1000 && (!i || report.active); i++) {
        CHECK(dpt_world_step(ball.world, 1e-3, NULL) == DPT_OK, "no step");
        step_cost(&ball, &report);
    }
    dpt_deform_get_vertices(ball.world, ball.body, &positions, &count);
    for (int i = 0; i < 3; i++) {
        CHECK(dpt_world_step(ball.world, 1e-3, NULL) == DPT_OK, "no step");
        step_cost(&ball, &report);
        dpt_deform_get_vertices(ball.world, ball.body, &again, &count);
        CHECK(again == positions, "handed over");
    }
    close_ball(&ball);
}

int main(void)
{
    TEST(a_body_at_rest_costs_nothing);
    TEST(a_body_at_rest_is_not_handed_over);
    return check_report();
}
