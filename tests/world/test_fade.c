/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A wrench that a decision ends fades, and says so: over a side that is given up, a motion that was not followed,
 * contact that is not known, a border; and only then. What ends for another reason is zero at once.
 *
 * Usage: test_fade [ticks = 60000] of the random runs.
 */
#include "world/fade_pair.h"

static struct fixture sheet, torus;
static unsigned long tick_count = 60000;
static uint64_t rng = 11;

static const dpt_segment lying = { { -0.01, 0.0, 0.0 }, { 0.02, 0.004, 0.0 }, 0.002 };

static dpt_world_def def_of(double fade)
{
    dpt_world_def def = rig_def(DPT_LAW_POINT);
    def.certificate_bytes = 1 << 16;
    def.side_limit = 0.03;
    def.fade = fade;
    return def;
}

/* Behind the sheet, lying, almost as deep as its side counts. */
static int begin_deep(struct pair *pair, double fade, double dt)
{
    const dpt_world_def def = def_of(fade);
    const dpt_pose above = pose_at(0.003, 0.002, 0.01), deep = pose_at(0.003, 0.002, -0.0275);
    if (!pair_open(pair, &sheet, NULL, &lying, 1, &def, dt))
        return 0;
    pair_go(pair, &above, &deep);
    CHECK(fabs(pair->reported.wrench.force[2] - 500.0 * 0.0295) < 1e-6 && pair->begun == 0, "%g N before, %u fades",
          pair->reported.wrench.force[2], pair->begun);
    return 1;
}

/* Deeper than side_limit: by the steps' own time, whatever that is, and the direction stays. */
static void too_deep_fades(void)
{
    static const double fades[] = { 0.002, 0.01, 0.0005, 1.0 }, dts[] = { 1e-3, 1e-4, 3e-3, 7e-4 };
    for (int i = 0; i < 16; i++) {
        struct pair pair;
        const double fade = fades[i / 4], dt = dts[i % 4];
        if (!begin_deep(&pair, fade, dt))
            return;
        const dpt_wrench last = pair.reported.wrench;
        double z = -0.0285;
        for (int n = 1; n < 40; n++, z -= 0.0005) {
            const dpt_pose pose = pose_at(0.003, 0.002, z);
            const double share = fmax(0.0, 1.0 - n * dt / fade);
            pair_pose(&pair, &pose);
            pair_step(&pair);
            for (int k = 0; k < 6; k++) {
                double wanted = share < 1e-9 ? 0.0 : share * number_of(&last, k);
                CHECK(fabs(number_of(&pair.reported.wrench, k) - wanted) <= 1e-9, "fade %g, dt %g, tick %d: %g for %g",
                      fade, dt, n, number_of(&pair.reported.wrench, k), wanted);
            }
            CHECK(pair.reported.reason == DPT_FORCE_FREE &&
                      pair.reported.flags == (share > 1e-9 ? DPT_FORCE_FLAG_FADING : 0u),
                  "fade %g, dt %g, tick %d: reason %u, flags %u", fade, dt, n, pair.reported.reason,
                  pair.reported.flags);
        }
        CHECK(pair.begun == (fade > dt), "%u fades", pair.begun);
        pair_close(&pair);
    }
}

static void a_fade_of_zero_is_at_once(void)
{
    struct pair pair;
    const dpt_pose deeper = pose_at(0.003, 0.002, -0.0285);
    if (!begin_deep(&pair, 0.0, 1e-3))
        return;
    pair_pose(&pair, &deeper);
    pair_step(&pair);
    CHECK(size_of_force(&pair.reported.wrench) == 0.0 && pair.reported.flags == 0, "%g N, flags %u",
          size_of_force(&pair.reported.wrench), pair.reported.flags);
    pair_close(&pair);
}

/* A push that ends as the tool moves away, back through the sheet: nothing fades, at any speed. */
static void moving_away_does_not_fade(void)
{
    for (double pace = 1e-4; pace < 0.05; pace *= 2.0) {
        struct pair pair;
        if (!begin_deep(&pair, 0.002, 1e-3))
            return;
        for (double z = -0.0275; z < 0.05; z += pace) {
            const dpt_pose pose = pose_at(0.003, 0.002, z);
            pair_pose(&pair, &pose);
            pair_step(&pair);
            CHECK(pair.reported.flags == 0, "pace %g, z %g: flags %u", pace, z, pair.reported.flags);
        }
        CHECK(pair.begun == 0 && pair.reported.reason == DPT_FORCE_FREE, "%u fades", pair.begun);
        pair_close(&pair);
    }
}

/*
 * With a budget that tool and sheet exceed as they move: contact is not known, then the way is given up, and known is
 * that the tool is free. One fade, that goes on meanwhile.
 */
static void a_way_that_is_given_up_fades(void)
{
    unsigned given_up = 0;
    for (uint32_t budget = 1; budget < 60; budget++) {
        struct pair pair;
        dpt_world_def def = def_of(0.02);
        def.budget = budget;
        const dpt_pose above = pose_at(0.003, 0.002, 0.001), behind = pose_at(0.003, 0.002, -0.001);
        if (!pair_open(&pair, &sheet, NULL, &lying, 1, &def, 1e-3))
            return;
        pair_pose(&pair, &above);
        for (int n = 0; n < 60; n++)
            pair_step(&pair);
        pair_pose(&pair, &behind);
        for (int n = 0; n < 60; n++)
            pair_step(&pair);
        const int pushed = size_of_force(&pair.truth.wrench) > 0.0;
        unsigned before = pair.begun;
        int given = 0;
        const dpt_pose on = pose_at(-0.07, -0.06, -0.004), beside = pose_at(0.0005, 0.0, 0.0);
        pair_pose(&pair, &on);
        pair_step(&pair);
        for (int w = 0; w < 2; w++)
            dpt_body_set_pose(pair.rig[w].world, pair.body[w][0], &beside);
        for (int n = 0; n < 18; n++) {
            int unknown = pair.was_unknown;
            pair_step(&pair);
            given |= unknown && pair.reported.reason == DPT_FORCE_FREE && pair.reported.flags == DPT_FORCE_FLAG_FADING;
        }
        given_up += pushed && given && pair.begun == before + 1;
        pair_close(&pair);
    }
    CHECK(given_up > 0, "no way was given up while its push faded");
    printf("    given up with %u budgets\n", given_up);
}

/*
 * Past the border, standing: the push through the sheet has ended by then, that of the border itself comes as in a
 * fade.
 */
static void over_the_border_fades(void)
{
    const dpt_segment standing = { { 0.0, 0.0, -0.02 }, { 0.0, 0.0, 0.05 }, 0.002 };
    const dpt_world_def def = def_of(0.002);
    const dpt_pose high = pose_at(0.05, 0.003, 0.05), low = pose_at(0.05, 0.003, 0.0),
                   beside = pose_at(0.09995, 0.003, 0.0), past = pose_at(0.10005, 0.003, 0.0);
    struct pair pair;
    if (!pair_open(&pair, &sheet, NULL, &standing, 1, &def, 1e-3))
        return;
    pair_go(&pair, &high, &low);
    CHECK(fabs(pair.reported.wrench.force[2] - 11.0) < 1e-6, "%g N", pair.reported.wrench.force[2]);
    pair_go(&pair, &low, &beside);
    CHECK(pair.begun == 0, "it fades before the border");
    const double before = pair.reported.wrench.force[2];
    pair_pose(&pair, &past);
    pair_step(&pair);
    const double *force = pair.reported.wrench.force, whole = 500.0 * (0.002 - 0.00005);
    CHECK(pair.reported.flags == DPT_FORCE_FLAG_FADING && pair.reported.reason == DPT_FORCE_ACTS &&
              fabs(force[0] - 0.5 * whole) < 1e-6 && fabs(force[2] - 0.5 * before) < 1e-6,
          "half way: flags %u, %g %g N", pair.reported.flags, force[0], force[2]);
    pair_step(&pair);
    CHECK(pair.reported.flags == 0 && fabs(force[0] - whole) < 1e-6 && fabs(force[2]) < 1e-6, "then: flags %u, %g %g N",
          pair.reported.flags, force[0], force[2]);
    pair_close(&pair);
}

/*
 * Held in a torus, in motion, with budgets that do not always reach: what is felt follows what is true by the rule
 * alone, which fade_pair.h has.
 */
static void unknown_contact_fades(void)
{
    static const uint32_t budgets[] = { 60, 120, 200, 400 };
    unsigned begun = 0, taken_up = 0, ticks = 0;
    for (int i = 0; i < 12; i++) {
        const dpt_segment tool = { { -0.03, 0.0, 0.0 }, { 0.03, 0.01, 0.0 }, 0.002 };
        dpt_world_def def = def_of(i % 3 ? 0.002 : 0.03);
        struct pair pair;
        double at[3] = { 0.1, 0.0, 0.0 };
        def.budget = budgets[i % 4];
        if (!pair_open(&pair, &torus, NULL, &tool, 1, &def, i % 2 ? 1e-3 : 3e-4))
            return;
        for (unsigned long n = 0; n < tick_count / 12; n++) {
            const double pace = n / 50 % 3 ? 0.0005 : 0.004;
            for (int k = 0; k < 3 && n % 7 < 4; k++) {
                at[k] += random_in(&rng, -pace, pace);
                at[k] *= fabs(at[k]) > (k ? 0.04 : 0.13) ? 0.9 : 1.0;
            }
            const dpt_pose pose = pose_at(at[0], at[1], at[2]);
            pair_pose(&pair, &pose);
            pair_step(&pair);
        }
        begun += pair.begun;
        ticks += pair.ticks;
        taken_up += pair.taken_up;
        pair_close(&pair);
    }
    printf("    %u fades, %u ticks, %u taken up\n", begun, ticks, taken_up);
    CHECK(begun > tick_count / 600 && taken_up > tick_count / 1200, "%u fades, %u taken up", begun, taken_up);
}

/* Sheets, at all speeds, with sides that are given up for any reason. */
static void sides_fade(void)
{
    unsigned begun = 0, ticks = 0;
    for (int i = 0; i < 12; i++) {
        dpt_world_def def = def_of(i % 3 ? 0.002 : 0.02);
        struct pair pair;
        double at[3] = { 0.05, 0.0, 0.01 };
        def.side_limit = 0.01;
        def.max_contacts = i % 4 == 3 ? 1 : 8;
        const dpt_pose second = pose_at(0.06, 0.01, -0.015);
        if (!pair_open(&pair, &sheet, &second, &lying, 1, &def, 5e-4))
            return;
        for (unsigned long n = 0; n < tick_count / 12; n++) {
            const double pace = n / 100 % 4 == 3 ? 0.01 : 0.001;
            for (int k = 0; k < 3; k++) {
                at[k] += random_in(&rng, -pace, pace);
                at[k] *= fabs(at[k]) > (k == 2 ? 0.03 : 0.12) ? 0.9 : 1.0;
            }
            const dpt_pose pose = pose_at(at[0], at[1], at[2]);
            pair_pose(&pair, &pose);
            pair_step(&pair);
        }
        begun += pair.begun;
        ticks += pair.ticks;
        pair_close(&pair);
    }
    printf("    %u fades, %u ticks\n", begun, ticks);
    CHECK(begun > tick_count / 600, "%u fades", begun);
}

/* Two segments, on two sheets: only the share fades whose side was given up. */
static void only_its_share_fades(void)
{
    const dpt_segment both[2] = { { { -0.01, 0.0, 0.0 }, { 0.01, 0.0, 0.0 }, 0.002 },
                                  { { 0.49, 0.0, 0.0 }, { 0.51, 0.0, 0.0 }, 0.002 } };
    const dpt_pose other = pose_at(0.5, 0.0, 0.0);
    const dpt_world_def def = def_of(0.004);
    struct pair pair;
    if (!pair_open(&pair, &sheet, &other, both, 2, &def, 1e-3))
        return;
    dpt_world *world = pair.rig[FADES].world;
    dpt_force_info report = { .size = sizeof report };
    const dpt_body_settings deep = { .size = sizeof deep, .side_limit = 0.05 };
    dpt_body_set_settings(world, pair.body[FADES][1], &deep);
    double last = 0.0;
    for (int n = 0; n < 84; n++) {
        const double z = 0.0052 - 0.0005 * n, depth = 0.002 - z;
        const dpt_pose pose = pose_at(0.0, 0.0, z);
        dpt_tool_set_pose(world, pair.rig[FADES].tool, &pose);
        dpt_world_step(world, 1e-3, NULL);
        dpt_tool_get_force_info(world, pair.rig[FADES].tool, &report);
        const double own = depth > 0.0 ? 500.0 * depth : 0.0;
        if (depth <= 0.03 + 1e-9) {
            last = n;
            CHECK(fabs(report.wrench.force[2] - 2.0 * own) < 1e-6 && report.flags == 0, "z %g: %g N, flags %u", z,
                  report.wrench.force[2], report.flags);
            continue;
        }
        const double share = fmax(0.0, 1.0 - (n - last) / 4.0), before = 500.0 * 0.0298;
        CHECK(fabs(report.wrench.force[2] - (own + share * before)) < 1e-6 &&
                  fabs(report.wrench.torque[1] + 0.5 * own) < 0.02 * own + 0.2 && report.reason == DPT_FORCE_ACTS &&
                  report.flags == (share > 0.0 ? DPT_FORCE_FLAG_FADING : 0u),
              "z %g: %g N, torque %g, reason %u, flags %u", z, report.wrench.force[2], report.wrench.torque[1],
              report.reason, report.flags);
    }
    pair_close(&pair);
}

/* What ends the push for another reason than a decision, before a fade or in it. */
enum { TELEPORT, RESET, NO_POSE, NO_STEP, BODY_GOES, BODY_JUMPS, BODY_IS_LOST, NO_STIFFNESS, FREE_SEGMENTS, ENDS };

static void end_it(const struct pair *pair, int how)
{
    dpt_world *world = pair->rig[FADES].world;
    const dpt_tool tool = pair->rig[FADES].tool;
    const dpt_body body = pair->body[FADES][0];
    const dpt_pose far_off = pose_at(1.0, 0.0, 0.0), here = pose_at(0.003, 0.002, -0.0285);
    const dpt_tool_settings none = { .size = sizeof none };
    dpt_segment moved = lying;
    moved.a[2] = moved.b[2] = -0.0285;
    switch (how) {
    case TELEPORT:
        dpt_tool_teleport(world, tool, &here);
        break;
    case RESET:
        dpt_world_reset(world);
        break;
    case NO_POSE:
        dpt_tool_set_pose(world, tool, NULL);
        break;
    case NO_STEP:
        CHECK(dpt_world_step(world, 0.0, NULL) == DPT_E_ARGUMENT, "a step of 0 s");
        break;
    case BODY_GOES:
        dpt_body_remove(world, body);
        break;
    case BODY_JUMPS:
        dpt_body_teleport(world, body, &far_off);
        break;
    case BODY_IS_LOST:
        dpt_body_set_pose(world, body, NULL);
        break;
    case NO_STIFFNESS:
        dpt_tool_set_settings(world, tool, &none);
        break;
    default:
        dpt_tool_set_segments(world, tool, &moved, 1);
        break;
    }
}

static void other_ends_are_at_once(void)
{
    static const uint32_t reasons[ENDS] = {
        [TELEPORT] = DPT_FORCE_FREE,      [RESET] = DPT_FORCE_FREE,       [NO_POSE] = DPT_FORCE_STALE,
        [NO_STEP] = DPT_FORCE_STALE,      [BODY_GOES] = DPT_FORCE_FREE,   [BODY_JUMPS] = DPT_FORCE_FREE,
        [BODY_IS_LOST] = DPT_FORCE_STALE, [NO_STIFFNESS] = DPT_FORCE_OFF, [FREE_SEGMENTS] = DPT_FORCE_FREE
    };
    for (int how = 0; how < ENDS; how++)
        for (int fading = 0; fading < 2; fading++) {
            struct pair pair;
            const dpt_pose deeper = pose_at(0.003, 0.002, -0.0285);
            dpt_force_info report = { .size = sizeof report };
            if (!begin_deep(&pair, 0.01, 1e-3))
                return;
            dpt_world *world = pair.rig[FADES].world;
            dpt_tool_set_pose(world, pair.rig[FADES].tool, &deeper);
            if (fading)
                dpt_world_step(world, 1e-3, NULL);
            end_it(&pair, how);
            if (how != NO_STEP)
                dpt_world_step(world, 1e-3, NULL);
            dpt_tool_get_force_info(world, pair.rig[FADES].tool, &report);
            CHECK(size_of_force(&report.wrench) == 0.0 && report.flags == 0 && report.reason == reasons[how],
                  "end %d, fading %d: %g N, flags %u, reason %u", how, fading, size_of_force(&report.wrench),
                  report.flags, report.reason);
            const dpt_pose still = DPT_POSE_IDENTITY;
            if (how == NO_POSE)
                dpt_tool_set_pose(world, pair.rig[FADES].tool, &deeper);
            if (how == BODY_IS_LOST)
                dpt_body_set_pose(world, pair.body[FADES][0], &still);
            dpt_world_step(world, 1e-3, NULL);
            dpt_tool_get_force_info(world, pair.rig[FADES].tool, &report);
            CHECK(size_of_force(&report.wrench) == 0.0 && report.flags == 0, "after end %d, fading %d: %g N", how,
                  fading, size_of_force(&report.wrench));
            pair_close(&pair);
        }
}

/* A body that goes takes its own push with it, and no other's that fades. */
static void a_body_ends_its_own_push_alone(void)
{
    const dpt_pose aside = pose_at(0.0, 0.0, 0.5);
    const dpt_world_def def = def_of(0.01);
    const dpt_pose above = pose_at(0.003, 0.002, 0.01), deep = pose_at(0.003, 0.002, -0.0275),
                   deeper = pose_at(0.003, 0.002, -0.0285);
    struct pair pair;
    if (!pair_open(&pair, &sheet, &aside, &lying, 1, &def, 1e-3))
        return;
    pair_go(&pair, &above, &deep);
    pair_pose(&pair, &deeper);
    pair_step(&pair);
    for (int w = 0; w < 2; w++)
        dpt_body_remove(pair.rig[w].world, pair.body[w][1]);
    pair_step(&pair);
    CHECK(pair.reported.flags == DPT_FORCE_FLAG_FADING &&
              fabs(pair.reported.wrench.force[2] - 0.8 * 500.0 * 0.0295) < 1e-6,
          "%g N, flags %u", pair.reported.wrench.force[2], pair.reported.flags);
    pair_close(&pair);
}

static dpt_force_info force_of(const struct pair *pair)
{
    dpt_force_info report = { .size = sizeof report, .law = 7 };
    CHECK(dpt_tool_get_force_info(pair->rig[FADES].world, pair->rig[FADES].tool, &report) == DPT_OK &&
              report.law == DPT_LAW_POINT,
          "no force");
    return report;
}

/* Added, and not yet stepped; then in the sheet without a side; then away from it. */
static void reasons_of_first_ticks(const dpt_segment *through)
{
    const dpt_pose far_off = pose_at(0.0, 0.0, 1.0);
    dpt_world_def def = def_of(0.002);
    struct pair pair;
    dpt_force_info report;
    if (!pair_open(&pair, &sheet, NULL, through, 1, &def, 1e-3))
        return;
    report = force_of(&pair);
    CHECK(report.reason == DPT_FORCE_STALE && report.flags == 0, "added: %u", report.reason);
    dpt_world_step(pair.rig[FADES].world, 1e-3, NULL);
    report = force_of(&pair);
    CHECK(report.reason == DPT_FORCE_UNDECIDED && report.flags == 0, "no side: %u", report.reason);
    dpt_tool_set_pose(pair.rig[FADES].world, pair.rig[FADES].tool, &far_off);
    dpt_world_step(pair.rig[FADES].world, 1e-3, NULL);
    report = force_of(&pair);
    CHECK(report.reason == DPT_FORCE_FREE && report.flags == 0, "far off: %u", report.reason);
    report.size = 8;
    CHECK(dpt_tool_get_force_info(pair.rig[FADES].world, pair.rig[FADES].tool, &report) == DPT_E_SIZE, "size 8");
    report.size = sizeof report;
    CHECK(dpt_tool_get_force_info(pair.rig[FADES].world, pair.body[FADES][0], &report) == DPT_E_HANDLE &&
              report.reason == DPT_FORCE_STALE,
          "a body's id: %u", report.reason);
    CHECK(dpt_tool_get_force_info(NULL, 0, &report) == DPT_E_ARGUMENT &&
              dpt_tool_get_force_info(pair.rig[FADES].world, pair.rig[FADES].tool, NULL) == DPT_E_ARGUMENT,
          "nothing to ask");
    pair_close(&pair);
}

static void a_zero_wrench_says_why(void)
{
    const dpt_segment through = { { 0.0, 0.0, -0.01 }, { 0.0, 0.0, 0.01 }, 0.001 };
    const dpt_segment two[2] = { { { 0.0, 0.0, -0.01 }, { 0.0, 0.0, 0.01 }, 0.001 },
                                 { { 0.05, 0.0, 0.0005 }, { 0.06, 0.0, 0.0005 }, 0.001 } };
    dpt_world_def def = def_of(0.002);
    struct pair pair;
    dpt_force_info report;

    reasons_of_first_ticks(&through);

    /* One segment is undecided, the other pushed. */
    if (!pair_open(&pair, &sheet, NULL, two, 2, &def, 1e-3))
        return;
    dpt_world_step(pair.rig[FADES].world, 1e-3, NULL);
    report = force_of(&pair);
    CHECK(report.reason == DPT_FORCE_ACTS && report.flags == DPT_FORCE_FLAG_PARTIAL &&
              fabs(report.wrench.force[2] - 0.25) < 1e-9,
          "partial: reason %u, flags %u, %g N", report.reason, report.flags, report.wrench.force[2]);
    pair_close(&pair);

    /* No bodies; not asked for a response. */
    if (!pair_open(&pair, NULL, NULL, &through, 1, &def, 1e-3))
        return;
    dpt_world_step(pair.rig[FADES].world, 1e-3, NULL);
    report = force_of(&pair);
    CHECK(report.reason == DPT_FORCE_FREE, "no bodies: %u", report.reason);
    pair_close(&pair);
    for (uint32_t until = DPT_UNTIL_TRACK; until <= DPT_UNTIL_CONTACT; until++) {
        def.until = until;
        if (!pair_open(&pair, &sheet, NULL, &through, 1, &def, 1e-3))
            return;
        report = force_of(&pair);
        CHECK(report.reason == DPT_FORCE_STALE, "until %u, added: %u", until, report.reason);
        dpt_world_step(pair.rig[FADES].world, 1e-3, NULL);
        report = force_of(&pair);
        CHECK(report.reason == DPT_FORCE_OFF && report.flags == 0, "until %u: %u", until, report.reason);
        pair_close(&pair);
    }
}

/* Three triangles at one edge have no sides: where the axis goes through them there is no way out. */
static void a_soup_is_undecided(void)
{
    static const double vertices[15] = { 0, -1, 0, 0, 1, 0, 1, 0, 0, -1, 0, 0, 0, 0, 1 };
    static const uint32_t corners[9] = { 0, 1, 2, 0, 1, 3, 0, 1, 4 };
    const dpt_segment tool = { { 0.3, 0.0, 0.01 }, { 0.3, 0.0, 0.2 }, 0.02 };
    const dpt_world_def def = def_of(0.002);
    struct fixture soup;
    struct pair pair;
    if (fixture_from_arrays(&soup, vertices, 5, corners, 3) && pair_open(&pair, &soup, NULL, &tool, 1, &def, 1e-3)) {
        const dpt_pose beside = pose_at(0.0, 0.0, 0.0), through = pose_at(0.0, 0.0, -0.05);
        pair_pose(&pair, &beside);
        pair_step(&pair);
        CHECK(pair.reported.reason == DPT_FORCE_ACTS, "beside: %u", pair.reported.reason);
        pair_pose(&pair, &through);
        pair_step(&pair);
        CHECK(pair.reported.reason == DPT_FORCE_UNDECIDED && pair.reported.flags == DPT_FORCE_FLAG_FADING &&
                  pair.hit.contact == DPT_CONTACT_PENETRATING,
              "through: reason %u, flags %u", pair.reported.reason, pair.reported.flags);
        pair_close(&pair);
    }
    fixture_free(&soup);
}

static void the_def_has_bounds(void)
{
    static const double good[] = { 0.0, 1.0, 0.002 }, bad[] = { -1e-9, 1.001, NAN, INFINITY };
    dpt_world_def def = def_of(0.0);
    for (int i = 0; i < 3; i++) {
        def.fade = good[i];
        CHECK(dpt_world_bytes(&def) > 0, "%g", def.fade);
    }
    for (int i = 0; i < 4; i++) {
        def.fade = bad[i];
        CHECK(dpt_world_bytes(&def) == 0, "%g", def.fade);
    }
    dpt_world_def_init(&def);
    def.max_contacts = 32;
    def.law = DPT_LAW_POINT;
    CHECK(def.fade == 0.002, "%g", def.fade);
}

int main(int argc, char **argv)
{
    if (argc > 1)
        tick_count = strtoul(argv[1], NULL, 10);
    if (!fixture_from_shape(&sheet, "membrane", 0) || !fixture_from_shape(&torus, "torus", 2000))
        return check_report();
    TEST(too_deep_fades);
    TEST(a_fade_of_zero_is_at_once);
    TEST(moving_away_does_not_fade);
    TEST(a_way_that_is_given_up_fades);
    TEST(over_the_border_fades);
    TEST(unknown_contact_fades);
    TEST(sides_fade);
    TEST(only_its_share_fades);
    TEST(other_ends_are_at_once);
    TEST(a_body_ends_its_own_push_alone);
    TEST(a_zero_wrench_says_why);
    TEST(a_soup_is_undecided);
    TEST(the_def_has_bounds);
    fixture_free(&sheet);
    fixture_free(&torus);
    return check_report();
}
