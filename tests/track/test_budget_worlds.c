/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What a budget means for a world: what a def with one costs in bytes, that the same calls give the same bits, that a
 * budget which is never reached changes nothing, that what is proven ends with its body, and that no tool starves. How
 * good the answers are is for test_budget.
 *
 *     test_budget_worlds [TICKS]   of each scene
 */
#include "track/budget_scene.h"

/* A tool that rests beside one that moves, and is never done, is exact before long. */
static void who_moves_leaves_something(void)
{
    struct fixture liver;
    if (!fixture_from_shape(&liver, "liver", 5000))
        return;
    for (uint32_t budget = 1; budget <= 4; budget++) {
        const dpt_segment resting = { { 0.0, -0.1, -0.15 }, { 0.0, 0.1, -0.15 }, 0.0 };
        dpt_segment moving = { { -0.1, 0.0, 0.15 }, { 0.1, 0.0, 0.15 }, 0.0 };
        dpt_world_def def = rig_def(DPT_LAW_POINT);
        struct rig rig;
        dpt_hit hit = DPT_HIT_INIT;
        uint32_t tick = 0;
        def.budget = budget;
        def.until = DPT_UNTIL_TRACK;
        rig_open(&rig, &def, liver.mesh, &moving, 1);
        const dpt_tool rests = rig_add_tool(&rig, &resting, 1);
        for (; hit.status != DPT_STATUS_EXACT && tick < 400; tick++) {
            moving.a[1] = moving.b[1] = 1e-4 * (tick % 7);
            dpt_tool_set_segments(rig.world, rig.tool, &moving, 1);
            rig_tick(&rig);
            dpt_tool_get_hit(rig.world, rests, &hit);
        }
        CHECK(tick < 100, "budget %u: exact at tick %u", budget, tick);
        rig_close(&rig);
    }
    fixture_free(&liver);
}

/*
 * A point in a torus' hole, 0.03 m under a sheet. Nothing of the torus is as near, which is proven;
 * then another sheet, 0.01 m below the point, takes its slot and its pose.
 */
static void what_was_proven_leaves_with_its_body(void)
{
    const dpt_segment point = { { 0.0, 0.0, 0.01 }, { 0.0, 0.0, 0.01 }, 0.0 };
    const dpt_pose above = { { 0.0, 0.0, 0.04 }, { 1.0, 0.0, 0.0, 0.0 } };
    struct fixture sheet;
    if (!fixture_from_shape(&sheet, "membrane", 0))
        return;
    for (uint32_t b = 0; b < BUDGETS; b++) {
        dpt_world_def def = rig_def(DPT_LAW_POINT);
        struct rig rig;
        def.budget = budgets[b];
        rig_open(&rig, &def, NULL, &point, 1);
        rig_add_body(&rig, sheet.mesh, &above);
        dpt_body second = rig_add_body(&rig, small_mesh.mesh, NULL);
        for (int pass = 0; pass < 2; pass++) {
            double truth = pass ? 0.01 : 0.03;
            for (int tick = 0; tick < 100; tick++) {
                rig_tick(&rig);
                CHECK(rig.hit.lower_bound <= truth + 1e-8, "budget %u: %g", def.budget, rig.hit.lower_bound);
            }
            CHECK(rig.hit.status == DPT_STATUS_EXACT && fabs(rig.hit.distance - truth) < 1e-8,
                  "budget %u: status %u, %g", def.budget, rig.hit.status, rig.hit.distance);
            dpt_body_remove(rig.world, second);
            second = rig_add_body(&rig, sheet.mesh, NULL);
        }
        rig_close(&rig);
    }
    fixture_free(&sheet);
}

/* Where the nearest pair alone is asked, a rest that is proven costs nothing more. */
static void a_proven_rest_costs_nothing(void)
{
    struct fixture mesh;
    if (!fixture_from_shape(&mesh, "torus", 5568))
        return;
    dpt_world_def def = rig_def(DPT_LAW_POINT);
    struct rig rig;
    def.budget = 3;
    def.until = DPT_UNTIL_TRACK;
    const dpt_segment segment = { { 0.02, 0.01, 0.2 }, { 0.3, 0.1, 0.25 }, 0.0 };
    rig_open(&rig, &def, mesh.mesh, &segment, 1);
    uint32_t exact = 0, rests = 0;
    for (uint32_t tick = 0; tick < 1000 && rests < 20; tick++) {
        rig_tick(&rig);
        CHECK(!exact || (rig.step.status == DPT_STATUS_EXACT && rig.step.work == 0),
              "tick %u: status %u, work %u though exact", tick, rig.step.status, rig.step.work);
        rests += exact;
        exact |= rig.step.status == DPT_STATUS_EXACT;
    }
    CHECK(rests == 20, "exact in %u ticks only", rests);
    rig_close(&rig);
    fixture_free(&mesh);
}

/*
 * A budget that is never reached costs nothing: all is exact, and the same. (Not the same bits: what is proven already
 * is not searched again, and of two triangles as near either may be named.)
 */
static void budget_out_of_reach(void)
{
    for (uint32_t n = 0; n < SCENES * MOTIONS; n++) {
        struct budget_input input;
        struct budget_sim sims[2];
        int motion = (int)(n % MOTIONS);
        input_start(&input, &budget_scenes[n / MOTIONS], n + 70);
        for (uint32_t i = 0; i < 2; i++)
            budget_sim_open(&sims[i], &input, DPT_METHOD_EXACT, i ? UINT32_MAX : 0, caches[n % CACHES]);
        for (uint32_t tick = 0; tick < budget_ticks && motion != REST; tick++) {
            for (int i = 0; i < 2; i++)
                budget_sim_step(&sims[i], &input);
            for (uint32_t i = 0; i < input.scene->segments; i++) {
                dpt_hit *with = &sims[1].hits[i], *without = &sims[0].hits[i];
                double apart = fabs(with->distance - without->distance);
                CHECK(with->status == DPT_STATUS_EXACT && apart <= with->error_bound &&
                          with->error_bound == without->error_bound,
                      "%s, %u segments, tick %u: %.17g, without a budget %.17g", motions[motion], input.scene->segments,
                      tick, with->distance, without->distance);
            }
            do
                input_move(&input, motion, &sims[0].hits[0]);
            while (!(input.moved > 0.0));
        }
        rig_close(&sims[0].rig);
        rig_close(&sims[1].rig);
    }
}

/* The same calls give the same bits: in another world, and after a reset. */
static void same_calls_same_bits(void)
{
    for (uint32_t n = 0; n < 2 * SCENES; n++) {
        struct budget_input input, begin;
        struct budget_sim sims[2];
        uint64_t hash[4] = { 0 };
        input_start(&begin, &budget_scenes[n % SCENES], n + 3);
        for (int i = 0; i < 2; i++)
            budget_sim_open(&sims[i], &begin, DPT_METHOD_EXACT, budgets[n % BUDGETS], caches[n % CACHES]);
        for (uint32_t pass = 0; pass < 4; pass++) {
            struct budget_sim *sim = &sims[pass % 2];
            CHECK(pass < 2 || dpt_world_reset(sim->rig.world) == DPT_OK, "reset");
            input = begin;
            for (uint32_t tick = 0; tick < 2 * budget_ticks; tick++) {
                const unsigned char *byte = (const unsigned char *)sim->hits;
                budget_sim_step(sim, &input);
                for (size_t k = 0; k < input.scene->segments * sizeof *sim->hits; k++)
                    hash[pass] = (hash[pass] ^ byte[k]) * 0x100000001b3u;
                if (tick % 30 < 20)
                    input_move(&input, tick % 60 < 30 ? MOVED : SLIDE, &sim->hits[0]);
            }
            CHECK(hash[pass] == hash[0], "scene %u, pass %u", n % SCENES, pass);
        }
        rig_close(&sims[0].rig);
        rig_close(&sims[1].rig);
    }
}

static uint32_t some(uint64_t *random)
{
    return 1 + (uint32_t)(random_bits(random) % 2000);
}

static void a_def_says_what_it_costs(void)
{
    uint64_t random = 4;
    char block[64] = { 0 };
    dpt_world *world = NULL;
    for (uint32_t n = 0; n < 1000; n++) {
        dpt_world_def def;
        dpt_world_def_init(&def);
        def.law = DPT_LAW_POINT;
        CHECK(def.budget == 0, "a budget by default");
        uint64_t bodies = def.max_bodies = some(&random), tools = def.max_tools = some(&random);
        uint64_t segments = def.max_segments = some(&random), both = segments * bodies;
        def.certificate_bytes = random_bits(&random) % 100000;
        def.budget = n % 2 * some(&random);
        uint64_t contacts = def.max_contacts = n % 3 * some(&random);
        const size_t bytes = dpt_world_bytes(&def);
        CHECK(bytes >= 24 * bodies + 24 * tools + 200 * segments + 200 * contacts + 12 * both,
              "%zu bytes cannot hold it", bytes);
        CHECK(bytes <= (1 << 20) + 2048 * (bodies + tools + contacts) + 13328 * (segments + def.max_tips) + 80 * both +
                           def.certificate_bytes,
              "%zu bytes", bytes);
        def.method = DPT_METHOD_TREE + n / 2 % 3;
        CHECK((dpt_world_bytes(&def) == 0) == (def.budget > 0), "method %u", def.method);
        dpt_result made = dpt_world_create(block, sizeof block, &def, &world);
        CHECK(made == (def.budget ? DPT_E_ARGUMENT : DPT_E_MEMORY), "%s", dpt_result_name(made));
    }
}

int main(int argc, char **argv)
{
    if (argc > 1)
        budget_ticks = (uint32_t)strtoul(argv[1], NULL, 10);
    TEST(a_def_says_what_it_costs);
    if (!fixture_from_shape(&small_mesh, "torus", 600) || !fixture_from_shape(&budget_mesh, "torus", 5568))
        return 2;
    TEST(who_moves_leaves_something);
    TEST(what_was_proven_leaves_with_its_body);
    TEST(a_proven_rest_costs_nothing);
    TEST(budget_out_of_reach);
    TEST(same_calls_same_bits);
    fixture_free(&budget_mesh);
    fixture_free(&small_mesh);
    return check_report();
}
