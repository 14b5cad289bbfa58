/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What a solve of tissue knows of a needle from tick to tick: what other tools beside it, and a reset of the world, leave of
 * that.
 */
#include "world/soft_needle.h"
#include "world/tissue_matrix.h"

#define STIFFNESS 500.0

static int is_in(const struct soft_needle *needle)
{
    return (needle->tool->force.flags & DPT_FORCE_FLAG_INSERTED) != 0;
}

/* What a newton along one row does to another is what one along the other does to it, asked of a solve that knows neither. */
static void check_symmetry(const struct soft_needle *needle)
{
    uint32_t touches, others;
    const double most = tissue_matrix_asymmetry(needle->tissue.rig.world, needle->body->id, &touches, &others);
    CHECK(touches > 6 && others > 8 && most < 1e-9, "%u touches, %u other rows, %g apart", touches, others, most);
}

/*
 * A needle is in, and another tool presses beside it: nodes that both load are those of both, and what one
 * does to the other is what that does to it, whatever is asked for first.
 */
static void tools_beside_it_load_its_nodes(void)
{
    static const dpt_segment rod = { { 0.0, 0.0, 0.0 }, { 0.0, 0.0, NEEDLE_LENGTH }, 0.004 };
    const dpt_body_settings gel = soft_needle_gel(15.0);
    for (int i = 0; i < TISSUE_INTEGRATORS; i++) {
        struct soft_needle needle;
        uint32_t others = 0;
        const struct tissue_def def = soft_needle_liver(tissue_integrators[i]);
        if (!soft_needle_open(&needle, &def, &gel, STIFFNESS))
            return;
        soft_needle_go(&needle, 0.02);
        struct tissue_tool *other = tissue_rig_add_tool(&needle.tissue, &rod, STIFFNESS);
        other->device.position[0] = NEEDLE_LATERAL - 0.006;
        other->device.position[2] = needle.body->top + 0.005;
        dpt_tool_teleport(needle.tissue.rig.world, other->id, &other->device);
        for (int k = 0; k < 300; k++) {
            other->device.position[2] -= NEEDLE_SLOW;
            soft_needle_tick(&needle);
            double off;
            others += tissue_matrix_shares(needle.tissue.rig.world, needle.body->id, &off) > 0;
            CHECK(off < 1e-5, "%d, tick %d: shares are off by %g", i, k, off);
        }
        check_symmetry(&needle);
        CHECK(is_in(&needle) && others > 50 && length3(other->force.wrench.force) > 0.05,
              "%d: %u ticks with others, %g N", i, others, length3(other->force.wrench.force));
        soft_needle_close(&needle);
    }
}

static void put_in_at(struct soft_needle *needle, double x)
{
    needle->depth = 0.03;
    needle->tool->device.position[0] = x;
    soft_needle_aim(needle);
    dpt_tool_teleport(needle->tissue.rig.world, needle->tool->id, &needle->tool->device);
    const dpt_result result = dpt_tool_insert(needle->tissue.rig.world, needle->tool->id);
    CHECK(result == DPT_OK, "%s", dpt_result_name(result));
}

/* A reset leaves nothing of what a solve knew: a needle that is put in elsewhere after it feels what it would without. */
static void a_reset_forgets_the_solve(void)
{
    const struct tissue_def def = soft_needle_liver(DPT_INTEGRATOR_SYMPLECTIC);
    const dpt_body_settings gel = soft_needle_gel(15.0);
    static dpt_wrench felt[2][300];
    for (int is_cleared = 0; is_cleared < 2; is_cleared++) {
        struct soft_needle needle;
        if (!soft_needle_open(&needle, &def, &gel, STIFFNESS))
            return;
        dpt_world *world = needle.tissue.rig.world;
        put_in_at(&needle, NEEDLE_LATERAL);
        soft_needle_hold(&needle, 50);
        CHECK(dpt_world_reset(world) == DPT_OK, "no reset");
        if (is_cleared)
            tissue_matrix_forget(world, needle.body->id);
        put_in_at(&needle, -4.0 * NEEDLE_LATERAL);
        for (int k = 0; k < 300; k++) {
            needle.tool->device.position[0] += 1e-5;
            soft_needle_tick(&needle);
            felt[is_cleared][k] = needle.tool->force.wrench;
        }
        CHECK(is_in(&needle) && length3(needle.tool->force.wrench.force) > 0.05, "it is not held");
        soft_needle_close(&needle);
    }
    CHECK(!memcmp(felt[0], felt[1], sizeof *felt), "a reset world remembers");
}

int main(void)
{
    TEST(tools_beside_it_load_its_nodes);
    TEST(a_reset_forgets_the_solve);
    return check_report();
}
