/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A body at rest costs nothing, whatever its size: counted in basic blocks (lib/block_count.h).
 */
#include "deform/spring_ball.h"
#include "lib/block_count.h"

/* The basic blocks of one step. */
static uint64_t step_cost(struct ball *ball, dpt_springs_info *report)
{
    const uint64_t begin = block_count;
    ball_step(ball, report);
    return block_count - begin;
}

/* Let a ball fall asleep. What its steps cost, awake, then asleep. */
static void costs_of(uint64_t triangles, double spacing, uint64_t *awake, uint64_t *asleep)
{
    struct ball ball;
    dpt_springs_info report = { .size = sizeof report };
    if (!ball_open(&ball, DPT_NET_VOLUME, triangles, spacing, DPT_KERNEL_AUTO))
        return;
    *awake = step_cost(&ball, &report);
    CHECK(report.active == report.nodes, "%u of %u awake", report.active, report.nodes);
    for (int i = 0; i < 1000 && report.active; i++)
        step_cost(&ball, &report);
    *asleep = step_cost(&ball, &report);
    CHECK(report.active == 0, "%u of %u awake", report.active, report.nodes);
    printf("    %u nodes: %.0f basic blocks awake, %.0f asleep\n", report.nodes, (double)*awake, (double)*asleep);
    ball_close(&ball);
}

static void a_body_at_rest_costs_nothing(void)
{
    uint64_t awake[2] = { 0, 0 }, asleep[2] = { 0, 0 };
    costs_of(320, 0.02, &awake[0], &asleep[0]);
    costs_of(20480, 0.006, &awake[1], &asleep[1]);
    CHECK(awake[1] > 10 * awake[0], "%.0f and %.0f", (double)awake[0], (double)awake[1]);
    CHECK(asleep[1] < asleep[0] + 20 && asleep[0] < 300, "%.0f and %.0f", (double)asleep[0], (double)asleep[1]);
}

int main(void)
{
    TEST(a_body_at_rest_costs_nothing);
    return check_report();
}
