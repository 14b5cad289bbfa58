/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What a tick costs with a needle in a soft body, beside one with the same needle that presses on it: in basic blocks
 * (lib/block_count.h). These leave out what kernels do, as springs pull and are moved, which is the most of both ticks
 * and almost the same: whole ticks are nearer to each other (docs/algorithms/insertion.md).
 */
#include "lib/block_count.h"
#include "world/soft_needle.h"

enum { TICKS = 100 };

/* How deep it presses, and how deep it is in, m. */
#define PRESSED 0.01
#define IN      0.027

enum hand { ADVANCES, WITHDRAWS, TREMBLES, HANDS };
static const char *const names[HANDS] = { "advances", "withdraws", "trembles" };

/* N: more than any needle here pushes with. */
#define NEVER 1e6

/*
 * So many times the blocks of one that presses. Measured: 1.2 to 1.5 with SYMPLECTIC, 1.1 to 1.2 with IMPLICIT, 1.4 to
 * 1.6 where another tool presses, too. Where each row of the shaft asks all nodes that it loads it is 3.5 to 4.3, 6 to 8,
 * and 3 to 4.
 */
#define MOST_SYMPLECTIC 1.9
#define MOST_IMPLICIT   1.6
#define MOST_BESIDE     2.1

struct cost {
    double blocks; /* a tick */
    uint32_t channels;
};

/* `has_other`: another tool presses on the body beside it. */
static struct cost cost_of(const struct tissue_def *def, double puncture, double depth, enum hand hand, int has_other)
{
    static const dpt_segment rod = { { 0.0, 0.0, 0.0 }, { 0.0, 0.0, NEEDLE_LENGTH }, NEEDLE_RADIUS };
    struct soft_needle needle;
    struct cost cost = { 0.0, 0 };
    dpt_body_settings gel = soft_needle_gel(15.0);
    uint64_t seed = 3;
    gel.puncture_force = puncture;
    if (!soft_needle_open_unlisted(&needle, def, &gel, 500.0))
        return cost;
    if (has_other) {
        struct tissue_tool *other = tissue_rig_add_tool(&needle.tissue, &rod, 500.0);
        other->device.position[0] = -0.02;
        other->device.position[1] = 0.002;
        other->device.position[2] = needle.body->top + 0.002;
        tissue_rig_place(&needle.tissue);
        for (int i = 0; i < 400; i++) {
            other->device.position[2] -= NEEDLE_SLOW;
            soft_needle_tick(&needle);
        }
    }
    soft_needle_go(&needle, hand == WITHDRAWS ? depth + 0.004 : depth);
    soft_needle_hold(&needle, 200);
    const double held = needle.depth;
    const uint64_t begin = block_count;
    for (int i = 0; i < TICKS; i++) {
        needle.depth += hand == ADVANCES ? NEEDLE_SLOW : hand == WITHDRAWS ? -NEEDLE_SLOW : 0.0;
        if (hand == TREMBLES)
            needle.depth = held + random_in(&seed, -2e-6, 2e-6);
        soft_needle_tick(&needle);
    }
    cost.blocks = (double)(block_count - begin) / TICKS;
    cost.channels = soft_needle_channels(&needle, NULL, 0);
    soft_needle_close(&needle);
    return cost;
}

static void compare(const char *what, const struct tissue_def *def, int has_other, double most)
{
    for (int hand = 0; hand < HANDS; hand++) {
        const struct cost pressing = cost_of(def, NEVER, PRESSED, (enum hand)hand, has_other);
        const struct cost in = cost_of(def, 0.4, IN, (enum hand)hand, has_other);
        printf("    %s, %s: %.0f blocks a tick while it presses, %.0f inside\n", what, names[hand], pressing.blocks,
               in.blocks);
        CHECK(pressing.channels == 0 && in.channels == 1, "%s: %u and %u channels", what, pressing.channels,
              in.channels);
        CHECK(in.blocks > 0.0 && in.blocks <= most * pressing.blocks, "%s, %s: %.3f times", what, names[hand],
              in.blocks / pressing.blocks);
    }
}

static void a_tick_inside_costs_about_as_much(void)
{
    const struct tissue_def symplectic = soft_needle_liver(DPT_INTEGRATOR_SYMPLECTIC);
    const struct tissue_def implicit = soft_needle_liver(DPT_INTEGRATOR_IMPLICIT);
    compare("SYMPLECTIC", &symplectic, 0, MOST_SYMPLECTIC);
    compare("IMPLICIT", &implicit, 0, MOST_IMPLICIT);
    compare("SYMPLECTIC, another tool presses", &symplectic, 1, MOST_BESIDE);
}

int main(void)
{
    TEST(a_tick_inside_costs_about_as_much);
    return check_report();
}
