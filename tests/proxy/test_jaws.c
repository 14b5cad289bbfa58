/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Tips that move in their tool: jaws that open and close. Oracles: closed forms on flat sheets, a tool whose hull was made
 * at the pose, and a brute force in long double over all triangles (oracle/hull_surface.h). It cannot judge what lies
 * between two ticks, but for the side of a sheet that a jaw is on at the end.
 *
 *     test_jaws [PER CENT of the random cases = 100]
 */
#include "lib/public_meshes.h"
#include "proxy/jaw_rig.h"

/* What contacts are held apart by, at most: 2e-6 of the largest body, up to 1 m. */
#define CLEARANCE 2e-6

/* In the open a tip arrives at once, and is what a hull is whose corners were put there before. */
static void in_the_open_a_tip_arrives(void)
{
    struct solid liver;
    struct jaws jaws, baked;
    uint64_t seed = 21;
    if (!solid_from_shape(&liver, "liver", 2000))
        return;
    jaws_open(&jaws, NULL, liver.mesh, 0.0005);
    jaws.rig.device.position[2] = 0.4;
    rig_place(&jaws.rig);
    for (uint64_t i = 0; i < part_of(200); i++) {
        dpt_pose pose;
        double corners[3 * JAW_CORNERS];
        dpt_hit hit = DPT_HIT_INIT, as = DPT_HIT_INIT;
        pose = pose_any(&seed, 0.02);
        jaws.wanted[0] = pose;
        CHECK(dpt_tool_set_tip_pose(jaws.rig.world, jaws.rig.tool, 0, &pose) == DPT_OK, "pose");
        rig_step(&jaws.rig);
        CHECK(jaw_is_there(&jaws, 0) && jaw_is_there(&jaws, 1), "case %d: not there", (int)i);
        dpt_tool_get_segment_hit(jaws.rig.world, jaws.rig.tool, 1, &hit);
        jaw_corners(&jaws, 0, corners);
        rig_open(&baked.rig, NULL, liver.mesh, &rig_point, 1);
        const dpt_hull_def def = {
            .size = sizeof def, .corner_count = JAW_CORNERS, .corners = corners, .radius = 0.0005
        };
        CHECK(dpt_hull_create(baked.blocks[0], sizeof baked.blocks[0], &def, baked.hulls) == DPT_OK, "baked");
        const dpt_tip tip = { .size = sizeof tip, .hull = baked.hulls[0] };
        dpt_tool_set_tips(baked.rig.world, baked.rig.tool, &tip, 1);
        rig_place(&baked.rig);
        dpt_tool_get_segment_hit(baked.rig.world, baked.rig.tool, 1, &as);
        CHECK(fabs(hit.distance - as.distance) < 1e-12 && fabs(hit.gap - as.gap) < 1e-12 && apart(hit.p, as.p) < 1e-9 &&
                  hit.status == DPT_STATUS_EXACT,
              "case %d: %.17g, baked %.17g", (int)i, hit.distance, as.distance);
        rig_close(&baked.rig);
    }
    rig_close(&jaws.rig);
    solid_close(&liver);
}

/* Jaws that close on a sheet stop at it, one on each side, at any speed; then they open again at once. */
static void jaws_close_on_a_sheet(void)
{
    const struct oracle_triangles triangles = tip_triangles(&jaw_sheet);
    uint64_t seed = 4;
    long ticks = 0, wrong = 0, felt = 0;
    for (uint64_t run = 0; run < part_of(200); run++) {
        struct jaws jaws;
        jaws_open(&jaws, NULL, jaw_sheet.mesh, run % 2 ? 0.0004 : 0);
        const double speed = pow(10, random_in(&seed, -3.5, 0)), open = random_in(&seed, 0.1, 1.2);
        const double close = random_in(&seed, -0.5, 0);
        stand_at_rim(&jaws, random_in(&seed, -0.03, 0.03), open);
        const int shut = (int)((open - close) / speed);
        for (int tick = 0; tick < shut + 60; tick++) {
            jaws_want(&jaws, fmax(close, open - tick * speed));
            rig_step(&jaws.rig);
            ticks++;
            wrong += jaws_passed(&jaws) > 0;
            felt += jaws.rig.force.reason != DPT_FORCE_FREE;
        }
        for (int j = 0; j < 2; j++) {
            const struct oracle_interval gap = jaw_gap(&jaws, j, &triangles, 0.01);
            CHECK(gap.lower > 0 && gap.upper < CLEARANCE, "run %d, jaw %d: a gap of %g", (int)run, j, gap.upper);
        }
        dpt_contact contacts[4] = { { .size = sizeof *contacts } };
        uint32_t count;
        dpt_tool_get_contacts(jaws.rig.world, jaws.rig.tool, contacts, 4, &count);
        CHECK(count == 2 && contacts[0].segment + contacts[1].segment == 3, "%u contacts", count);
        jaws_want(&jaws, open);
        rig_step(&jaws.rig);
        CHECK(jaw_is_there(&jaws, 0) && jaw_is_there(&jaws, 1), "run %d: not open again", (int)run);
        rig_close(&jaws.rig);
    }
    CHECK(ticks > (long)least_seen(10000) && wrong == 0 && felt == 0,
          "on %ld of %ld ticks a jaw is through, on %ld something is felt", wrong, ticks, felt);
    free((void *)triangles.corners);
}

/* From any pose above a sheet to any below it, in one step. */
static void a_tip_that_jumps_stops_at_a_sheet(void)
{
    const struct oracle_triangles triangles = tip_triangles(&jaw_sheet);
    uint64_t seed = 15;
    long wrong = 0, far = 0;
    for (uint64_t run = 0; run < part_of(400); run++) {
        struct jaws jaws;
        dpt_pose pose;
        double corners[3 * JAW_CORNERS];
        jaws_open(&jaws, NULL, jaw_sheet.mesh, run % 2 ? 0.0004 : 0);
        jaws.rig.device.position[2] = 0.1;
        random_turn(&seed, jaws.rig.device.orientation);
        rig_place(&jaws.rig);
        /* What is z in the world, in the tool's frame. */
        double up[3];
        turn_back3(jaws.rig.device.orientation, (const double[3]){ 0, 0, 1 }, up);
        for (int step = 0; step < 30; step++) {
            pose = pose_any(&seed, 0.01);
            for (int k = 0; k < 3; k++)
                pose.position[k] -= (step < 2 ? 0.02 : random_in(&seed, 0.1, 0.2)) * up[k];
            dpt_tool_set_tip_pose(jaws.rig.world, jaws.rig.tool, 0, &pose);
            rig_step(&jaws.rig);
            jaw_corners(&jaws, 0, corners);
            for (int c = 0; c < JAW_CORNERS; c++)
                wrong += !(corners[3 * c + 2] - jaws.radius > 0);
        }
        far += !(jaw_gap(&jaws, 0, &triangles, 0.1).upper < 10 * CLEARANCE);
        rig_close(&jaws.rig);
    }
    CHECK(wrong == 0 && far < (long)part_of(400) / 8, "%ld corners are through; %ld stopped far off", wrong, far);
    free((void *)triangles.corners);
}

/* What jaws hold, holds the tool: pulled away from the sheet it is felt, and when they open no more. */
static void what_jaws_hold_is_felt(void)
{
    struct jaws jaws;
    jaws_open(&jaws, NULL, jaw_sheet.mesh, 0);
    stand_at_rim(&jaws, 0, 0.3);
    for (int tick = 0; tick < 40; tick++) {
        jaws_want(&jaws, fmax(0, 0.3 - 0.01 * tick));
        rig_step(&jaws.rig);
    }
    for (int tick = 0; tick < 20; tick++) {
        jaws.rig.device.position[2] += 5e-5;
        rig_step(&jaws.rig);
        CHECK(jaws_passed(&jaws) == 0, "tick %d: through", tick);
    }
    CHECK(jaws.rig.force.reason == DPT_FORCE_ACTS && jaws.rig.force.wrench.force[2] < -0.2, "reason %u, %g N",
          jaws.rig.force.reason, jaws.rig.force.wrench.force[2]);
    const uint32_t folds = jaws.rig.force.flags & DPT_FORCE_FLAG_FOLD;
    for (int tick = 0; tick < 60; tick++) {
        jaws_want(&jaws, fmin(0.3, 0.02 * tick));
        rig_step(&jaws.rig);
        CHECK(jaws_passed(&jaws) == 0, "tick %d: through", tick);
    }
    CHECK(jaws.rig.force.reason == DPT_FORCE_FREE && !folds, "reason %u", jaws.rig.force.reason);
    rig_close(&jaws.rig);
}

/* The sheet as a deformable body; `block` and `at` are to be freed. */
static dpt_body make_soft(const struct rig *rig, void **block, float **at, uint32_t *vertices)
{
    const float *rest;
    dpt_body soft = 0;
    dpt_deformable_def def;
    dpt_deformable_def_init(&def);
    def.mesh = jaw_sheet.mesh;
    for (int k = 0; k < 3; k++) {
        def.box_min[k] = -1;
        def.box_max[k] = 1;
    }
    dpt_mesh_get_vertices(jaw_sheet.mesh, &rest, vertices);
    *block = malloc(dpt_deformable_bytes(&def));
    *at = malloc(3 * *vertices * sizeof **at);
    memcpy(*at, rest, 3 * *vertices * sizeof **at);
    const dpt_result result = dpt_body_add_deformable(rig->world, *block, dpt_deformable_bytes(&def), &def, &soft);
    CHECK(result == DPT_OK, "soft: %s", dpt_result_name(result));
    return soft;
}

/* While jaws close the sheet moves, as a rigid body or by its vertices, and the hand trembles. */
static void sheets_that_move_are_not_passed(void)
{
    uint64_t seed = 31;
    long ticks[2] = { 0 }, wrong = 0, ended = 0, held = 0;
    for (uint64_t run = 0; run < part_of(300); run++) {
        struct jaws jaws;
        dpt_pose body = DPT_POSE_IDENTITY;
        const int is_soft = run % 3 == 2;
        const double speed = pow(10, random_in(&seed, -3.5, -1));
        const double up = random_in(&seed, 0.3, 1) * pow(10, random_in(&seed, -6, -3.5));
        double corners[3 * JAW_CORNERS];
        void *block = NULL;
        float *at = NULL;
        uint32_t vertices = 0;
        dpt_body soft = 0;
        jaws_open(&jaws, NULL, is_soft ? NULL : jaw_sheet.mesh, run % 2 ? 0.0004 : 0);
        if (is_soft)
            soft = make_soft(&jaws.rig, &block, &at, &vertices);
        stand_at_rim(&jaws, random_in(&seed, -0.03, 0.03), 0.5);
        for (int tick = 0; tick < 150; tick++) {
            jaws_want(&jaws, 0.5 * fabs(1 - fmod(tick * speed, 2)));
            const float height = (float)(0.001 * sin(up * 1e3 * tick));
            body.position[2] = height;
            for (uint32_t v = 0; v < vertices; v++)
                at[3 * v + 2] = height;
            if (is_soft)
                dpt_body_set_vertices(jaws.rig.world, soft, 0, vertices, at, -1.0);
            else
                dpt_body_set_pose(jaws.rig.world, jaws.rig.body, &body);
            for (int k = 1; k < 3; k++)
                jaws.rig.device.position[k] += random_in(&seed, -5e-5, 5e-5);
            rig_step(&jaws.rig);
            if (jaws.rig.force.flags & (DPT_FORCE_FLAG_SQUEEZED | DPT_FORCE_FLAG_REPLACED)) {
                ended++;
                break;
            }
            ticks[is_soft]++;
            for (int j = 0; j < 2; j++) {
                held += !jaw_is_there(&jaws, j);
                jaw_corners(&jaws, j, corners);
                for (int c = 1; c < JAW_CORNERS; c += 2) {
                    const double above = corners[3 * c + 2] - (double)height;
                    wrong += !((j ? -above : above) - jaws.radius > 0);
                }
            }
        }
        rig_close(&jaws.rig);
        free(block);
        free(at);
    }
    CHECK(ticks[0] > (long)least_seen(15000) && ticks[1] > (long)least_seen(7000) && wrong == 0 &&
              held > (long)least_seen(1000) && ended < (long)part_of(300) / 4,
          "of %ld and %ld ticks %ld corners are through; on %ld a jaw is held; %ld of the runs ended early", ticks[0],
          ticks[1], wrong, held, ended);
}

/* Jaws that open and close while their tool goes about on an organ. */
static void jaws_never_penetrate(void)
{
    static const struct {
        const char *name;
        uint64_t count;
    } shapes[] = { { "liver", 2000 }, { "torus", 1280 }, { "star", 2000 }, { "box", 300 } };
    uint64_t seed = 77;
    long looked = 0, met = 0, off = 0, behind = 0, on = 0;
    for (size_t s = 0; s < sizeof shapes / sizeof *shapes; s++) {
        struct solid solid;
        struct jaws jaws;
        if (!solid_from_shape(&solid, shapes[s].name, shapes[s].count))
            continue;
        const struct oracle_triangles triangles = tip_triangles(&solid);
        jaws_open(&jaws, NULL, solid.mesh, s % 2 ? 0.0005 : 0);
        for (uint64_t run = 0; run < part_of(40); run++) {
            const float *v = solid.corners + 9 * (random_bits(&seed) % solid.info.triangles);
            const double rate = pow(10, random_in(&seed, -2.5, 0));
            double normal[3], place[3], e[3], f[3];
            for (int k = 0; k < 3; k++) {
                place[k] = (v[k] + v[3 + k] + v[6 + k]) / 3.0;
                e[k] = v[3 + k] - v[k];
                f[k] = v[6 + k] - v[k];
            }
            for (int k = 0; k < 3; k++)
                normal[k] = e[(k + 1) % 3] * f[(k + 2) % 3] - e[(k + 2) % 3] * f[(k + 1) % 3];
            unit3(normal);
            unit3(e);
            rig_vary(&jaws.rig, &seed);
            random_turn(&seed, jaws.rig.device.orientation);
            for (int tick = 0; tick < 200; tick++) {
                const double high = fmax(-0.004, 0.06 - 1e-3 * tick), along = 1e-4 * tick;
                for (int k = 0; k < 3; k++)
                    jaws.rig.device.position[k] = place[k] + high * normal[k] + along * e[k];
                jaws_want(&jaws, 0.4 - 0.4 * cos(rate * tick));
                if (tick == 0)
                    rig_place(&jaws.rig);
                else
                    rig_step(&jaws.rig);
                if (jaws.rig.force.reason == DPT_FORCE_INSIDE || jaws.rig.force.flags & DPT_FORCE_FLAG_REPLACED)
                    break;
                behind += !jaw_is_there(&jaws, 0) || !jaw_is_there(&jaws, 1);
                on += jaws.rig.force.reason == DPT_FORCE_ACTS;
                if (tick % 8)
                    continue;
                for (int j = 0; j < 2; j++) {
                    const struct oracle_interval gap = jaw_gap(&jaws, j, &triangles, 0.001);
                    dpt_hit hit = DPT_HIT_INIT;
                    dpt_tool_get_segment_hit(jaws.rig.world, jaws.rig.tool, 1 + (uint32_t)j, &hit);
                    looked++;
                    met += !(gap.upper > 0) || !(gap.lower >= 0);
                    if (jaws.rig.force.reason == DPT_FORCE_FREE)
                        off += hit.gap > gap.upper + 1e-12 || (hit.gap < gap.lower - 1e-12 && hit.gap < 0.0009);
                }
            }
        }
        rig_close(&jaws.rig);
        free((void *)triangles.corners);
        solid_close(&solid);
    }
    CHECK(looked > (long)least_seen(3000) && behind > (long)least_seen(1000) && on > (long)least_seen(1000) &&
              met == 0 && off == 0,
          "%ld of %ld meet, %ld are told wrong; %ld ticks a jaw was held, %ld the tool", met, looked, off, behind, on);
}

/* A tip that is taken from under its tool: it sinks, without a fold; one that comes goes no farther than it is free. */
static void a_tool_sinks_where_its_tip_goes(void)
{
    static const double small[3] = { 0.006, 0.006, 0.002 };
    struct tip_rig tip;
    tip_rig_open(&tip, NULL, jaw_sheet.mesh, DPT_HULL_KIND_BOX, small, 0);
    struct rig *rig = &tip.rig;
    dpt_pose pose = DPT_POSE_IDENTITY;
    rig->device.position[2] = 0.02;
    rig_place(rig);
    while (rig->device.position[2] > 0) {
        rig->device.position[2] = fmax(0, rig->device.position[2] - 1e-4);
        rig_step(rig);
    }
    const double pressed = rig->force.wrench.force[2];
    CHECK(fabs(pressed - RIG_STIFFNESS * small[2] / 2) < 0.01, "%g N", pressed);
    pose.position[2] = 5e-4;
    dpt_tool_set_tip_pose(rig->world, rig->tool, 0, &pose);
    rig_step(rig);
    CHECK(fabs(rig->force.wrench.force[2] - pressed) < 0.01, "%g N in the step of the tip", rig->force.wrench.force[2]);
    rig_step(rig);
    const int folds = (rig->force.flags & DPT_FORCE_FLAG_FOLD) != 0;
    const double left = RIG_STIFFNESS * (small[2] / 2 - 5e-4);
    CHECK(fabs(rig->force.wrench.force[2] - left) < 0.01 && !folds, "%g N for %g, %d folds", rig->force.wrench.force[2],
          left, folds);
    /* Back down: it does not lift the tool. */
    pose.position[2] = -0.001;
    dpt_tool_set_tip_pose(rig->world, rig->tool, 0, &pose);
    for (int tick = 0; tick < 10; tick++)
        rig_step(rig);
    dpt_tool_get_tip_pose(rig->world, rig->tool, 0, &pose);
    CHECK(fabs(rig->force.wrench.force[2] - left) < 0.01 && fabs(pose.position[2] - 5e-4) < 1e-5,
          "%g N for %g, the tip at %g", rig->force.wrench.force[2], left, pose.position[2]);
    rig_close(rig);
}

/* Jaws that open in the open change nothing of what is felt elsewhere. */
static void what_is_felt_knows_no_opening(void)
{
    struct jaws jaws;
    jaws_open(&jaws, NULL, jaw_sheet.mesh, 0);
    jaws.rig.device.position[2] = 0.06;
    pose_orient(&jaws.rig.device, (const double[3]){ 0, 1, 0 }, -acos(0));
    rig_place(&jaws.rig);
    while (jaws.rig.device.position[2] > -0.001) {
        jaws.rig.device.position[2] = fmax(-0.001, jaws.rig.device.position[2] - 1e-3);
        jaws.rig.device.position[0] += 1e-5;
        pose_orient(&jaws.rig.device, (const double[3]){ 0, 1, 0 }, 0.05 - acos(0));
        rig_step(&jaws.rig);
    }
    for (int tick = 0; tick < 20; tick++)
        rig_step(&jaws.rig);
    const dpt_wrench before = jaws.rig.force.wrench;
    for (int tick = 0; tick < 20; tick++) {
        jaws_want(&jaws, 0.01 + 0.01 * tick);
        rig_step(&jaws.rig);
        double away = 0;
        for (int k = 0; k < 3; k++)
            away += fabs(jaws.rig.force.wrench.force[k] - before.force[k]) +
                    fabs(jaws.rig.force.wrench.torque[k] - before.torque[k]) / JAW_LENGTH;
        CHECK(jaw_is_there(&jaws, 0) && jaw_is_there(&jaws, 1) && before.force[2] > 0.2 && away < 1e-6,
              "tick %d: %g N of %g N", tick, away, before.force[2]);
    }
    rig_close(&jaws.rig);
}

int main(int argc, char **argv)
{
    take_percent(argc, argv);
    if (!jaw_sheet_open())
        return check_report();
    TEST(in_the_open_a_tip_arrives);
    TEST(jaws_close_on_a_sheet);
    TEST(a_tip_that_jumps_stops_at_a_sheet);
    TEST(what_jaws_hold_is_felt);
    TEST(sheets_that_move_are_not_passed);
    TEST(a_tool_sinks_where_its_tip_goes);
    TEST(what_is_felt_knows_no_opening);
    TEST(jaws_never_penetrate);
    solid_close(&jaw_sheet);
    return check_report();
}
