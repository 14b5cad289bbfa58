/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Tools of many segments with `near_only`: what is left out is told truly, and all else is as without it. Oracles: the same
 * world without it, which answers exactly for each segment; and, for a proxy, a question without a world. They cannot
 * judge what both worlds do wrong; the tests of segments judge that.
 *
 *     test_near_only [PER CENT of the random cases = 100]
 */
#include "track/near_pair.h"

enum { WORLDS = 30, TICKS = 300 };

static struct solid solids[NEAR_BODIES];

struct near_case {
    uint32_t until, law;
    int is_free, bodies_are_slow, is_soft;
    double force_error; /* N */
};

/* What came out of so many worlds. */
struct near_tally {
    double left_out; /* the share of all answers */
    uint64_t forces; /* ticks with one */
};

static struct near_tally compare_worlds(const struct near_case *as)
{
    uint64_t answers = 0, left_out = 0;
    struct near_tally tally = { 0, 0 };
    dpt_world_def def = rig_def(DPT_LAW_PROXY);
    def.until = as->until;
    def.law = as->law;
    for (uint64_t seed = 1; seed <= part_of(WORLDS); seed++) {
        struct near_pair pair;
        const int bad = check_bad;
        near_pair_open(&pair, solids, &def, 0, seed);
        if (as->is_soft)
            near_pair_soften(&pair);
        pair.is_free = as->is_free;
        pair.bodies_are_slow = as->bodies_are_slow;
        pair.force_error = as->force_error;
        for (int tick = 0; tick < TICKS && check_bad == bad; tick++) {
            near_pair_tick(&pair);
            near_pair_compare(&pair);
            if (check_bad != bad)
                printf("    in tick %d of world %u\n", tick, (unsigned)seed);
        }
        answers += pair.answers;
        left_out += pair.left_out;
        tally.forces += pair.forces;
        near_pair_close(&pair);
    }
    tally.left_out = (double)left_out / (double)answers;
    return tally;
}

static void what_is_left_out_is_bounded_truly(void)
{
    const struct near_tally tally = compare_worlds(&(struct near_case){ .until = DPT_UNTIL_TRACK });
    CHECK(tally.left_out > 0.5, "%.2f of all answers were left out", tally.left_out);
}

static void contacts_and_sweeps_are_the_same(void)
{
    for (int is_free = 0; is_free < 2; is_free++) {
        const struct near_tally tally =
            compare_worlds(&(struct near_case){ .until = DPT_UNTIL_CONTACT, .is_free = is_free });
        CHECK(tally.left_out > 0.4, "%.2f of all answers were left out", tally.left_out);
    }
}

/* Of a sheet in waves: bounds count how far its vertices moved. */
static void vertices_that_move_count(void)
{
    static const uint32_t untils[] = { DPT_UNTIL_TRACK, DPT_UNTIL_CONTACT };
    for (int i = 0; i < 2; i++) {
        const struct near_tally tally = compare_worlds(&(struct near_case){ .until = untils[i], .is_soft = 1 });
        CHECK(tally.left_out > 0.3, "%.2f of all answers were left out", tally.left_out);
    }
}

static void forces_are_the_same(void)
{
    static const uint32_t laws[] = { DPT_LAW_POINT, DPT_LAW_BED };
    for (int i = 0; i < 2; i++) {
        const struct near_tally tally =
            compare_worlds(&(struct near_case){ .law = laws[i], .is_free = i, .force_error = 1e-9 });
        CHECK(tally.forces > least_seen(500), "law %u: %u ticks with a force", laws[i], (unsigned)tally.forces);
    }
}

/*
 * Where no body jumps, the two proxies take the same way in all of these worlds. It need not be so: of two ways that are
 * all but equally good each may take another.
 */
static void a_proxy_feels_the_same(void)
{
    const struct near_tally tally =
        compare_worlds(&(struct near_case){ .law = DPT_LAW_PROXY, .bodies_are_slow = 1, .force_error = 1e-6 });
    CHECK(tally.left_out > 0.3, "%.2f of all answers were left out", tally.left_out);
    CHECK(tally.forces > least_seen(150), "%u ticks with a force", (unsigned)tally.forces);
}

/* Whatever happens, bodies that jump included. */
static void a_proxy_goes_through_nothing(void)
{
    uint64_t forces = 0;
    dpt_world_def def = rig_def(DPT_LAW_PROXY);
    for (uint64_t seed = 1; seed <= part_of(WORLDS); seed++) {
        struct near_pair pair;
        near_pair_open(&pair, solids, &def, 0, seed);
        for (int tick = 0; tick < TICKS; tick++) {
            dpt_wrench wrench;
            near_pair_tick(&pair);
            near_pair_check_proxy(&pair);
            dpt_tool_get_wrench(pair.near.rig.world, pair.near.rig.tool, &wrench);
            forces += wrench.force[0] != 0;
        }
        near_pair_close(&pair);
    }
    CHECK(forces > least_seen(250), "%u ticks with a force", (unsigned)forces);
}

/* A budget ends searches: what is told is less then, and never wrong. */
static void with_a_budget_nothing_is_wrong(void)
{
    dpt_world_def def = rig_def(DPT_LAW_PROXY);
    uint64_t exact = 0;
    def.until = DPT_UNTIL_CONTACT;
    for (uint64_t seed = 1; seed <= part_of(WORLDS); seed++) {
        struct near_pair pair;
        near_pair_open(&pair, solids, &def, 60, seed);
        for (int tick = 0; tick < TICKS; tick++) {
            near_pair_tick(&pair);
            near_pair_compare(&pair);
            exact += pair.near.rig.step.status == DPT_STATUS_EXACT;
        }
        near_pair_close(&pair);
    }
    CHECK(exact > least_seen(1000), "%u ticks that were exact", (unsigned)exact);
}

/* What stands still is not searched for again, far segments included. */
static void a_tool_at_rest_costs_nothing(void)
{
    dpt_world_def def = rig_def(DPT_LAW_PROXY);
    struct near_pair pair;
    near_pair_open(&pair, solids, &def, 0, 3);
    for (int tick = 0; tick < 10; tick++) {
        rig_step_to(&pair.near.rig, &pair.pose);
        CHECK(tick < 4 || pair.near.rig.step.work == 0, "tick %d: %u units", tick, pair.near.rig.step.work);
    }
    near_pair_close(&pair);
}

/* A body that comes to be beside a far segment is found in the next step. */
static void a_new_body_is_found(void)
{
    static const double away[3] = { 0, 0, 0.3 };
    struct near_pair pair;
    dpt_world_def def = rig_def(DPT_LAW_PROXY);
    dpt_pose pose = DPT_POSE_IDENTITY;
    dpt_hit hit = DPT_HIT_INIT;
    def.max_bodies = NEAR_BODIES + 1;
    near_pair_open(&pair, solids, &def, 0, 1);
    memcpy(pair.pose.position, away, sizeof away);
    for (int tick = 0; tick < 5; tick++) {
        rig_step_to(&pair.near.rig, &pair.pose);
    }
    uint32_t far = 0;
    for (uint32_t s = 0; s < NEAR_SEGMENTS; s++) {
        dpt_tool_get_segment_hit(pair.near.rig.world, pair.near.rig.tool, s, &hit);
        far = hit.status == DPT_STATUS_BOUNDED ? s : far;
    }
    dpt_tool_get_segment_hit(pair.near.rig.world, pair.near.rig.tool, far, &hit);
    CHECK(hit.status == DPT_STATUS_BOUNDED && hit.distance > 0.01, "segment %u is at %g", far, hit.distance);
    for (int k = 0; k < 3; k++)
        pose.position[k] = hit.p[k] + (k == 2 ? -0.1 : 0);
    rig_add_body(&pair.near.rig, solids[0].mesh, &pose);
    rig_tick(&pair.near.rig);
    dpt_query_def query = { .size = sizeof query };
    dpt_hit truth = DPT_HIT_INIT;
    double ends[6];
    near_pair_ends(&pair, far, ends);
    dpt_query_segments(solids[0].mesh, &pose, ends, NULL, 1, &truth, &query);
    dpt_tool_get_segment_hit(pair.near.rig.world, pair.near.rig.tool, far, &hit);
    CHECK(hit.lower_bound <= truth.distance + truth.error_bound, "at least %g, but it is %g", hit.lower_bound,
          truth.distance);
    near_pair_close(&pair);
}

static void settings_say_so(void)
{
    dpt_world_def def = rig_def(DPT_LAW_PROXY);
    struct near_pair pair;
    dpt_tool_settings settings = { .size = sizeof settings };
    near_pair_open(&pair, solids, &def, 0, 1);
    dpt_tool_get_settings(pair.near.rig.world, pair.near.rig.tool, &settings);
    CHECK(settings.near_only == 1, "%u", settings.near_only);
    dpt_tool_get_settings(pair.all.rig.world, pair.all.rig.tool, &settings);
    CHECK(settings.near_only == 0, "%u is the default", settings.near_only);
    settings.near_only = 2;
    CHECK(dpt_tool_set_settings(pair.all.rig.world, pair.all.rig.tool, &settings) == DPT_E_ARGUMENT, "2");
    near_pair_close(&pair);
}

int main(int argc, char **argv)
{
    take_percent(argc, argv);
    if (!near_solids_open(solids))
        return 2;
    TEST(what_is_left_out_is_bounded_truly);
    TEST(contacts_and_sweeps_are_the_same);
    TEST(vertices_that_move_count);
    TEST(forces_are_the_same);
    TEST(a_proxy_feels_the_same);
    TEST(a_proxy_goes_through_nothing);
    TEST(with_a_budget_nothing_is_wrong);
    TEST(a_tool_at_rest_costs_nothing);
    TEST(a_new_body_is_found);
    TEST(settings_say_so);
    for (int i = 0; i < NEAR_BODIES; i++)
        solid_close(&solids[i]);
    return check_report();
}
