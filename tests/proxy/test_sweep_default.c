/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Who sets no sweep_budget has one. A fan of segments that turns about its end, close to a torus, needs more in one tick:
 * the step ends its sweeps there, the next ones go on, and in the end each segment has the sweep that it has without a
 * budget, bit for bit.
 */
#include "lib/arm_random.h"
#include "lib/fixture.h"
#include "lib/rig.h"

enum { SEGMENTS = 64, TURNS = 20, DEFAULT = 4000, TICKS_MOST = 100 };

static struct fixture torus;
static uint64_t rng = 1;

/* Spokes all round: whichever way they turn, many pass close to the torus. */
static void make_fan(dpt_segment *fan)
{
    for (int i = 0; i < SEGMENTS; i++) {
        const double angle = 6.283185307179586 * i / SEGMENTS;
        fan[i] = (dpt_segment){ { 0, 0, 0 }, { 0.15 * cos(angle), 0.15 * sin(angle), 0 }, 0.002 };
    }
}

static int open_fan(struct rig *rig, int is_unlimited, const dpt_segment *fan)
{
    dpt_world_def def = rig_def(DPT_LAW_POINT);
    CHECK(def.sweep_budget == DEFAULT, "%u units", def.sweep_budget);
    def.max_segments = SEGMENTS;
    if (is_unlimited)
        def.sweep_budget = 0;
    return rig_open(rig, &def, torus.mesh, fan, SEGMENTS);
}

/* How many are done, of which all that are have told what `truth` has. */
static uint32_t done_of(const struct rig *rig, const dpt_sweep *truth, uint8_t *is_done)
{
    uint32_t done = 0;
    for (uint32_t i = 0; i < SEGMENTS; i++) {
        dpt_sweep sweep = { .size = sizeof sweep };
        CHECK(dpt_tool_get_sweep(rig->world, rig->tool, i, &sweep) == DPT_OK, "no sweep");
        if (!is_done[i] && sweep.status != DPT_SWEEP_UNFINISHED) {
            CHECK(sweep.status == truth[i].status && sweep.triangle == truth[i].triangle &&
                      sweep.time == truth[i].time && sweep.s == truth[i].s,
                  "segment %u: sweep %u, triangle %u at %.17g, not %u, %u, %.17g", i, sweep.status, sweep.triangle,
                  sweep.time, truth[i].status, truth[i].triangle, truth[i].time);
            is_done[i] = 1;
        }
        done += is_done[i];
    }
    return done;
}

static void what_takes_more_is_finished_by_the_next_ticks(void)
{
    dpt_segment fan[SEGMENTS];
    uint32_t waited = 0, longest = 0, hits = 0;
    make_fan(fan);
    for (int i = 0; i < TURNS; i++) {
        struct rig by_default, unlimited;
        dpt_sweep truth[SEGMENTS];
        uint8_t is_done[SEGMENTS] = { 0 };
        if (!open_fan(&by_default, 0, fan) || !open_fan(&unlimited, 1, fan))
            return;
        dpt_pose from = pose_random(&rng, 0.0), to = pose_random(&rng, 0.0);
        from.position[2] = to.position[2] = random_in(&rng, 0.03, 0.06);
        from.position[0] = to.position[0] = 0.12;
        dpt_tool_teleport(by_default.world, by_default.tool, &from);
        dpt_tool_teleport(unlimited.world, unlimited.tool, &from);
        rig_tick(&by_default);
        rig_tick(&unlimited);
        dpt_tool_set_pose(by_default.world, by_default.tool, &to);
        dpt_tool_set_pose(unlimited.world, unlimited.tool, &to);
        rig_tick(&unlimited);
        for (uint32_t k = 0; k < SEGMENTS; k++) {
            truth[k] = (dpt_sweep){ .size = sizeof truth[k] };
            dpt_tool_get_sweep(unlimited.world, unlimited.tool, k, &truth[k]);
            hits += truth[k].status == DPT_SWEEP_HIT;
        }
        uint32_t ticks = 0, done;
        do {
            dpt_tool_set_pose(by_default.world, by_default.tool, &to);
            rig_tick(&by_default);
            done = done_of(&by_default, truth, is_done);
        } while (++ticks < TICKS_MOST && done < SEGMENTS);
        CHECK(done == SEGMENTS, "%u done after %u ticks", done, ticks);
        longest = ticks > longest ? ticks : longest;
        waited += ticks > 1;
        rig_close(&by_default);
        rig_close(&unlimited);
    }
    printf("    %u of %d turns wait, up to %u ticks; %u segments meet something\n", waited, TURNS, longest, hits);
    CHECK(waited > TURNS / 4 && hits > 4 * TURNS, "%u wait, %u meet something", waited, hits);
}

int main(void)
{
    if (!fixture_from_shape(&torus, "torus", 5568))
        return check_report();
    TEST(what_takes_more_is_finished_by_the_next_ticks);
    fixture_free(&torus);
    return check_report();
}
