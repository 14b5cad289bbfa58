/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Springs that move a body: its vertices are where the nodes carry them, whether all are awake, some or none.
 */
#include "deform/spring_ball.h"

/* As dpt_mesh_get_embedding says: the sum of four weighted nodes, in double; or the node itself. */
static void place_of(const struct ball *ball, const float *nodes, uint32_t vertex, float place[3])
{
    const uint32_t *corners = NULL;
    const float *weights = NULL;
    uint32_t count = 0;
    dpt_mesh_get_embedding(ball->mesh, &corners, &weights, &count);
    for (int k = 0; k < 3; k++) {
        double sum = 0.0;
        for (size_t c = 4 * (size_t)vertex; count && c < 4 * (size_t)vertex + 4; c++)
            sum += (double)weights[c] * (double)nodes[3 * (size_t)corners[c] + (size_t)k];
        place[k] = count ? (float)sum : nodes[3 * (size_t)vertex + (size_t)k];
    }
}

/* How many vertices are not exactly there. */
static uint32_t misplaced(const struct ball *ball)
{
    const uint32_t nodes = dpt_springs_get_count(ball->springs);
    float *at = malloc(3 * (size_t)nodes * sizeof *at);
    const float *positions = NULL;
    uint32_t vertices = 0, wrong = 0;
    CHECK(dpt_springs_get_nodes(ball->springs, nodes, at, NULL) == DPT_OK &&
              dpt_body_get_vertices(ball->rig.world, ball->rig.body, &positions, &vertices) == DPT_OK,
          "no places");
    for (uint32_t v = 0; v < vertices; v++) {
        float place[3];
        place_of(ball, at, v, place);
        wrong += memcmp(place, positions + 3 * (size_t)v, sizeof place) != 0;
    }
    free(at);
    return wrong;
}

/* Move some nodes of one end by so much along x. */
static void push_end(const struct ball *ball, float by)
{
    float at[3 * 40], *all = malloc(3 * (size_t)dpt_springs_get_count(ball->springs) * sizeof *all);
    dpt_springs_get_nodes(ball->springs, dpt_springs_get_count(ball->springs), all, NULL);
    memcpy(at, all, sizeof at);
    for (int i = 0; i < 40; i++)
        at[3 * i] += by;
    CHECK(dpt_springs_set_nodes(ball->springs, 0, 40, at, NULL) == DPT_OK, "not moved");
    free(all);
}

/* Asleep, then pushed a little, which wakes some, and more, which wakes all. The sum of the vertices' bits. */
static uint64_t run(struct ball *ball)
{
    dpt_springs_info report = { .size = sizeof report };
    uint32_t some = 0, most = 0, none = 0;
    uint64_t sum = 0;
    for (int tick = 0; tick < 1600; tick++) {
        if (tick == 200 || tick == 300)
            push_end(ball, tick == 200 ? 2e-5f : 1e-3f);
        rig_tick(&ball->rig);
        ball_step(ball, &report);
        none += report.active == 0;
        some += report.active > 0 && 2 * report.active < report.nodes;
        most += 10 * report.active > 9 * report.nodes && tick > 300;
        const uint32_t wrong = tick % 7 == 0 || tick < 320 ? misplaced(ball) : 0;
        CHECK(wrong == 0, "%u vertices are elsewhere at tick %d, %u nodes awake", wrong, tick, report.active);
    }
    CHECK(some > 0 && most > 0 && none > 0, "ticks with some awake %u, most %u, none %u", some, most, none);
    const float *positions = NULL;
    uint32_t vertices = 0;
    dpt_body_get_vertices(ball->rig.world, ball->rig.body, &positions, &vertices);
    for (size_t i = 0; i < 3 * (size_t)vertices; i++) {
        uint32_t bits;
        memcpy(&bits, positions + i, sizeof bits);
        sum = 31 * sum + bits;
    }
    return sum;
}

static void vertices_follow(uint32_t kind)
{
    uint64_t first = 0;
    for (uint32_t kernel = DPT_KERNEL_SCALAR; kernel <= DPT_KERNEL_WASM128; kernel++) {
        struct ball ball;
        if (!ball_open(&ball, kind, 5120, 0.01, kernel))
            continue;
        const uint64_t sum = run(&ball);
        CHECK(kernel == DPT_KERNEL_SCALAR || sum == first, "%s has other bits", dpt_kernel_name(kernel));
        first = kernel == DPT_KERNEL_SCALAR ? sum : first;
        ball_close(&ball);
    }
}

static void embedded_vertices_follow_their_nodes(void)
{
    vertices_follow(DPT_NET_VOLUME);
}

static void vertices_are_nodes_of_a_sheet(void)
{
    vertices_follow(DPT_NET_SHEET);
}

/* Where all vertices are handed over, the body's array is another one in the next tick. */
static void a_body_at_rest_is_not_handed_over(void)
{
    struct ball ball;
    dpt_springs_info report = { .size = sizeof report };
    const float *positions, *again;
    uint32_t count;
    if (!ball_open(&ball, DPT_NET_VOLUME, 1280, 0.02, DPT_KERNEL_AUTO))
        return;
    for (int i = 0; i < 1000 && (!i || report.active); i++) {
        rig_tick(&ball.rig);
        ball_step(&ball, &report);
    }
    dpt_body_get_vertices(ball.rig.world, ball.rig.body, &positions, &count);
    for (int i = 0; i < 3; i++) {
        rig_tick(&ball.rig);
        ball_step(&ball, &report);
        dpt_body_get_vertices(ball.rig.world, ball.rig.body, &again, &count);
        CHECK(again == positions, "handed over");
    }
    ball_close(&ball);
}

int main(void)
{
    TEST(embedded_vertices_follow_their_nodes);
    TEST(vertices_are_nodes_of_a_sheet);
    TEST(a_body_at_rest_is_not_handed_over);
    return check_report();
}
