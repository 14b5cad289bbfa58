/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Tips that move in their tool: jaws that open and close. Oracles: closed forms on flat sheets, a tool whose hull was made
 * at the pose, and a brute force in long double over all triangles (oracle/hull_surface.h). It cannot judge what lies
 * between two ticks, but for the side of a sheet that a jaw is on at the end.
 *
 *     test_jaws [PER CENT of the random cases = 100]
 */
#include "lib/public_meshes.h"
#include "world/tip_rig.h"

/* What contacts are held apart by, at most: 2e-6 of the largest body, up to 1 m. */
#define CLEARANCE 2e-6

static const dpt_segment point = { { 0, 0, 0 }, { 0, 0, 0 }, 0 };

/* Two jaws on a hinge at the tool's origin, which turn about y: the upper one has z from 0, the lower one up to 0. */
enum { CORNERS = 8 };
static const double jaw_length = 0.04, jaw_width = 0.006, jaw_height = 0.002;

struct jaws {
    struct rig rig;
    uint64_t blocks[2][2048];
    const dpt_hull *hulls[2];
    double corners[2][3 * CORNERS];
    double radius;
    dpt_pose wanted[2];
};

static void jaws_give(struct jaws *jaws, double radius)
{
    static const dpt_pose identity = DPT_POSE_IDENTITY;
    dpt_tip tips[2];
    jaws->radius = radius;
    for (int j = 0; j < 2; j++) {
        const double z[2] = { j ? -jaw_height : radius, j ? -radius : jaw_height };
        for (int c = 0; c < CORNERS; c++) {
            double *corner = jaws->corners[j] + 3 * c;
            corner[0] = c & 1 ? jaw_length : 0.001;
            corner[1] = c & 2 ? jaw_width / 2 : -jaw_width / 2;
            corner[2] = z[(c & 4) / 4];
        }
        const dpt_hull_def def = { .size = sizeof def,
                                   .corner_count = CORNERS,
                                   .corners = jaws->corners[j],
                                   .radius = radius };
        CHECK(dpt_hull_create(jaws->blocks[j], sizeof jaws->blocks[j], &def, &jaws->hulls[j]) ==
                  DPT_OK,
              "hull %d", j);
        jaws->wanted[j] = identity;
        tips[j] = (dpt_tip){ .size = sizeof *tips, .hull = jaws->hulls[j] };
    }
    CHECK(dpt_tool_set_tips(jaws->rig.world, jaws->rig.tool, tips, 2) == DPT_OK, "tips");
}

static void jaws_open(struct jaws *jaws, const dpt_world_def *def, const dpt_mesh *mesh,
                      double radius)
{
    rig_open(&jaws->rig, def, mesh, &point, 1);
    jaws_give(jaws, radius);
}

/* rad: how far both are wanted from where they meet. */
static void jaws_want(struct jaws *jaws, double angle)
{
    for (int j = 0; j < 2; j++) {
        rig_orient(&jaws->wanted[j], (const double[3]){ 0, 1, 0 }, j ? angle : -angle);
        const dpt_result result =
            dpt_tool_set_tip_pose(jaws->rig.world, jaws->rig.tool, (uint32_t)j, &jaws->wanted[j]);
        CHECK(result == DPT_OK, "%s", dpt_result_name(result));
    }
}

static dpt_pose jaw_pose(const struct jaws *jaws, int jaw)
{
    dpt_pose pose = DPT_POSE_IDENTITY;
    CHECK(dpt_tool_get_tip_pose(jaws->rig.world, jaws->rig.tool, (uint32_t)jaw, &pose) == DPT_OK,
          "jaw %d", jaw);
    return pose;
}

/* A jaw's corners in the world, where the proxy and the jaw in it are. */
static void jaw_corners(const struct jaws *jaws, int jaw, double corners[3 * CORNERS])
{
    const dpt_pose pose = jaw_pose(jaws, jaw), *tool = &jaws->rig.proxy;
    for (int c = 0; c < CORNERS; c++) {
        double in_tool[3];
        rig_turn(pose.orientation, jaws->corners[jaw] + 3 * c, in_tool);
        for (int k = 0; k < 3; k++)
            in_tool[k] += pose.position[k];
        rig_turn(tool->orientation, in_tool, corners + 3 * c);
        for (int k = 0; k < 3; k++)
            corners[3 * c + k] += tool->position[k];
    }
}

static struct oracle_interval jaw_gap(const struct jaws *jaws, int jaw,
                                      const struct oracle_triangles *triangles, double limit)
{
    double corners[3 * CORNERS];
    jaw_corners(jaws, jaw, corners);
    struct oracle_interval gap =
        oracle_hull_surface(corners, CORNERS, triangles, 0, limit + jaws->radius, NULL);
    gap.lower -= jaws->radius;
    gap.upper -= jaws->radius;
    return gap;
}

static int is_there(const struct jaws *jaws, int jaw)
{
    const dpt_pose pose = jaw_pose(jaws, jaw);
    return memcmp(&pose, &jaws->wanted[jaw], sizeof pose) == 0;
}

static struct solid sheet;
static double rim; /* the sheet's least x; it lies in z = 0 */

/* The jaws stand over the sheet's rim, open, one on each side; the hinge is beside it. */
static void stand_at_rim(struct jaws *jaws, double y, double angle)
{
    static const dpt_pose identity = DPT_POSE_IDENTITY;
    jaws->rig.device = identity;
    jaws->rig.device.position[0] = rim - 0.005;
    jaws->rig.device.position[1] = y;
    jaws_want(jaws, angle);
    rig_place(&jaws->rig);
}

/* Of the two far ends, how many corners are not on their side of the sheet. */
static int passed(const struct jaws *jaws)
{
    int count = 0;
    for (int j = 0; j < 2; j++) {
        double corners[3 * CORNERS];
        jaw_corners(jaws, j, corners);
        for (int c = 1; c < CORNERS; c += 2)
            count += !((j ? -corners[3 * c + 2] : corners[3 * c + 2]) - jaws->radius > 0);
    }
    return count;
}

static void what_cannot_be_is_refused(void)
{
    struct jaws jaws;
    dpt_pose pose = DPT_POSE_IDENTITY, bad = pose;
    jaws_open(&jaws, NULL, sheet.mesh, 0);
    stand_at_rim(&jaws, 0, 0.3);
    dpt_world *world = jaws.rig.world;
    const dpt_tool tool = jaws.rig.tool;
    CHECK(dpt_tool_set_tip_pose(NULL, tool, 0, &pose) == DPT_E_ARGUMENT, "no world");
    CHECK(dpt_tool_set_tip_pose(world, 0, 0, &pose) == DPT_E_HANDLE, "no tool");
    CHECK(dpt_tool_set_tip_pose(world, tool, 2, &pose) == DPT_E_ARGUMENT, "no third tip");
    CHECK(dpt_tool_set_tip_pose(world, tool, 0, NULL) == DPT_E_ARGUMENT, "no pose");
    bad.orientation[0] = 1.1;
    CHECK(dpt_tool_set_tip_pose(world, tool, 0, &bad) == DPT_E_POSE, "no turn");
    bad = pose;
    bad.position[1] = NAN;
    CHECK(dpt_tool_set_tip_pose(world, tool, 0, &bad) == DPT_E_FINITE, "no number");
    CHECK(dpt_tool_get_tip_pose(NULL, tool, 0, &pose) == DPT_E_ARGUMENT, "no world");
    CHECK(dpt_tool_get_tip_pose(world, 0, 0, &pose) == DPT_E_HANDLE, "no tool");
    CHECK(dpt_tool_get_tip_pose(world, tool, 2, &pose) == DPT_E_ARGUMENT, "no third tip");
    CHECK(dpt_tool_get_tip_pose(world, tool, 0, NULL) == DPT_E_ARGUMENT, "nowhere to write");
    rig_step(&jaws.rig);
    CHECK(is_there(&jaws, 0) && is_there(&jaws, 1), "a jaw went elsewhere");
    const dpt_tip with_bad = { .size = sizeof with_bad, .hull = jaws.hulls[0], .pose = &bad };
    CHECK(dpt_tool_set_tips(world, tool, &with_bad, 1) == DPT_E_FINITE, "given at no pose");
    CHECK(is_there(&jaws, 1), "the tips that it has are gone");
    rig_close(&jaws.rig);
}

static void random_pose(uint64_t *seed, double reach, dpt_pose *pose)
{
    for (int k = 0; k < 3; k++)
        pose->position[k] = random_in(seed, -reach, reach);
    random_turn(seed, pose->orientation);
}

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
        double corners[3 * CORNERS];
        dpt_hit hit = DPT_HIT_INIT, as = DPT_HIT_INIT;
        random_pose(&seed, 0.02, &pose);
        jaws.wanted[0] = pose;
        CHECK(dpt_tool_set_tip_pose(jaws.rig.world, jaws.rig.tool, 0, &pose) == DPT_OK, "pose");
        rig_step(&jaws.rig);
        CHECK(is_there(&jaws, 0) && is_there(&jaws, 1), "case %d: not there", (int)i);
        dpt_tool_get_segment_hit(jaws.rig.world, jaws.rig.tool, 1, &hit);
        jaw_corners(&jaws, 0, corners);
        rig_open(&baked.rig, NULL, liver.mesh, &point, 1);
        const dpt_hull_def def = {
            .size = sizeof def, .corner_count = CORNERS, .corners = corners, .radius = 0.0005
        };
        CHECK(dpt_hull_create(baked.blocks[0], sizeof baked.blocks[0], &def, baked.hulls) == DPT_OK,
              "baked");
        const dpt_tip tip = { .size = sizeof tip, .hull = baked.hulls[0] };
        dpt_tool_set_tips(baked.rig.world, baked.rig.tool, &tip, 1);
        rig_place(&baked.rig);
        dpt_tool_get_segment_hit(baked.rig.world, baked.rig.tool, 1, &as);
        CHECK(fabs(hit.distance - as.distance) < 1e-12 && fabs(hit.gap - as.gap) < 1e-12 &&
                  apart(hit.p, as.p) < 1e-9 && hit.status == DPT_STATUS_EXACT,
              "case %d: %.17g, baked %.17g", (int)i, hit.distance, as.distance);
        rig_close(&baked.rig);
    }
    rig_close(&jaws.rig);
    solid_close(&liver);
}

/* Jaws that close on a sheet stop at it, one on each side, at any speed; then they open again at once. */
static void jaws_close_on_a_sheet(void)
{
    const struct oracle_triangles triangles = tip_triangles(&sheet);
    uint64_t seed = 4;
    long ticks = 0, wrong = 0, felt = 0;
    for (uint64_t run = 0; run < part_of(200); run++) {
        struct jaws jaws;
        jaws_open(&jaws, NULL, sheet.mesh, run % 2 ? 0.0004 : 0);
        const double speed = pow(10, random_in(&seed, -3.5, 0)), open = random_in(&seed, 0.1, 1.2);
        const double close = random_in(&seed, -0.5, 0);
        stand_at_rim(&jaws, random_in(&seed, -0.03, 0.03), open);
        const int shut = (int)((open - close) / speed);
        for (int tick = 0; tick < shut + 60; tick++) {
            jaws_want(&jaws, fmax(close, open - tick * speed));
            rig_step(&jaws.rig);
            ticks++;
            wrong += passed(&jaws) > 0;
            felt += jaws.rig.force.reason != DPT_FORCE_FREE;
        }
        for (int j = 0; j < 2; j++) {
            const struct oracle_interval gap = jaw_gap(&jaws, j, &triangles, 0.01);
            CHECK(gap.lower > 0 && gap.upper < CLEARANCE, "run %d, jaw %d: a gap of %g", (int)run,
                  j, gap.upper);
        }
        dpt_contact contacts[4] = { { .size = sizeof *contacts } };
        uint32_t count;
        dpt_tool_get_contacts(jaws.rig.world, jaws.rig.tool, contacts, 4, &count);
        CHECK(count == 2 && contacts[0].segment + contacts[1].segment == 3, "%u contacts", count);
        jaws_want(&jaws, open);
        rig_step(&jaws.rig);
        CHECK(is_there(&jaws, 0) && is_there(&jaws, 1), "run %d: not open again", (int)run);
        rig_close(&jaws.rig);
    }
    CHECK(ticks > (long)least_seen(10000) && wrong == 0 && felt == 0,
          "on %ld of %ld ticks a jaw is through, on %ld something is felt", wrong, ticks, felt);
    free((void *)triangles.corners);
}

/* From any pose above a sheet to any below it, in one step. */
static void a_tip_that_jumps_stops_at_a_sheet(void)
{
    const struct oracle_triangles triangles = tip_triangles(&sheet);
    uint64_t seed = 15;
    long wrong = 0, far = 0;
    for (uint64_t run = 0; run < part_of(400); run++) {
        struct jaws jaws;
        dpt_pose pose;
        double corners[3 * CORNERS];
        jaws_open(&jaws, NULL, sheet.mesh, run % 2 ? 0.0004 : 0);
        jaws.rig.device.position[2] = 0.1;
        random_turn(&seed, jaws.rig.device.orientation);
        rig_place(&jaws.rig);
        /* What is z in the world, in the tool's frame. */
        double *q = jaws.rig.device.orientation, up[3];
        const double back[4] = { q[0], -q[1], -q[2], -q[3] };
        rig_turn(back, (const double[3]){ 0, 0, 1 }, up);
        for (int step = 0; step < 30; step++) {
            random_pose(&seed, 0.01, &pose);
            for (int k = 0; k < 3; k++)
                pose.position[k] -= (step < 2 ? 0.02 : random_in(&seed, 0.1, 0.2)) * up[k];
            dpt_tool_set_tip_pose(jaws.rig.world, jaws.rig.tool, 0, &pose);
            rig_step(&jaws.rig);
            jaw_corners(&jaws, 0, corners);
            for (int c = 0; c < CORNERS; c++)
                wrong += !(corners[3 * c + 2] - jaws.radius > 0);
        }
        far += !(jaw_gap(&jaws, 0, &triangles, 0.1).upper < 10 * CLEARANCE);
        rig_close(&jaws.rig);
    }
    CHECK(wrong == 0 && far < (long)part_of(400) / 8,
          "%ld corners are through; %ld stopped far off", wrong, far);
    free((void *)triangles.corners);
}

/* What jaws hold, holds the tool: pulled away from the sheet it is felt, and when they open no more. */
static void what_jaws_hold_is_felt(void)
{
    struct jaws jaws;
    jaws_open(&jaws, NULL, sheet.mesh, 0);
    stand_at_rim(&jaws, 0, 0.3);
    for (int tick = 0; tick < 40; tick++) {
        jaws_want(&jaws, fmax(0, 0.3 - 0.01 * tick));
        rig_step(&jaws.rig);
    }
    for (int tick = 0; tick < 20; tick++) {
        jaws.rig.device.position[2] += 5e-5;
        rig_step(&jaws.rig);
        CHECK(passed(&jaws) == 0, "tick %d: through", tick);
    }
    CHECK(jaws.rig.force.reason == DPT_FORCE_ACTS && jaws.rig.force.wrench.force[2] < -0.2,
          "reason %u, %g N", jaws.rig.force.reason, jaws.rig.force.wrench.force[2]);
    const uint32_t folds = jaws.rig.force.flags & DPT_FORCE_FLAG_FOLD;
    for (int tick = 0; tick < 60; tick++) {
        jaws_want(&jaws, fmin(0.3, 0.02 * tick));
        rig_step(&jaws.rig);
        CHECK(passed(&jaws) == 0, "tick %d: through", tick);
    }
    CHECK(jaws.rig.force.reason == DPT_FORCE_FREE && !folds, "reason %u", jaws.rig.force.reason);
    rig_close(&jaws.rig);
}

/* While jaws close the sheet moves, and the hand trembles. */
static void sheets_that_move_are_not_passed(void)
{
    uint64_t seed = 31;
    long ticks = 0, wrong = 0, ended = 0;
    for (uint64_t run = 0; run < part_of(200); run++) {
        struct jaws jaws;
        dpt_pose body = DPT_POSE_IDENTITY;
        const double speed = pow(10, random_in(&seed, -3.5, -1));
        const double up = random_in(&seed, 0.3, 1) * pow(10, random_in(&seed, -6, -3.5));
        double corners[3 * CORNERS];
        jaws_open(&jaws, NULL, sheet.mesh, run % 2 ? 0.0004 : 0);
        stand_at_rim(&jaws, random_in(&seed, -0.03, 0.03), 0.5);
        for (int tick = 0; tick < 150; tick++) {
            jaws_want(&jaws, 0.5 * fabs(1 - fmod(tick * speed, 2)));
            body.position[2] = 0.001 * sin(up * 1e3 * tick);
            dpt_body_set_pose(jaws.rig.world, jaws.rig.body, &body);
            for (int k = 1; k < 3; k++)
                jaws.rig.device.position[k] += random_in(&seed, -5e-5, 5e-5);
            rig_step(&jaws.rig);
            if (jaws.rig.force.flags & (DPT_FORCE_FLAG_SQUEEZED | DPT_FORCE_FLAG_REPLACED)) {
                ended++;
                break;
            }
            ticks++;
            for (int j = 0; j < 2; j++) {
                jaw_corners(&jaws, j, corners);
                for (int c = 1; c < CORNERS; c += 2) {
                    const double above = corners[3 * c + 2] - body.position[2];
                    wrong += !((j ? -above : above) - jaws.radius > 0);
                }
            }
        }
        rig_close(&jaws.rig);
    }
    CHECK(ticks > (long)least_seen(15000) && wrong == 0 && ended < (long)part_of(200) / 4,
          "of %ld ticks %ld corners are through; %ld of the runs ended early", ticks, wrong, ended);
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
                if (jaws.rig.force.reason == DPT_FORCE_INSIDE ||
                    jaws.rig.force.flags & DPT_FORCE_FLAG_REPLACED)
                    break;
                behind += !is_there(&jaws, 0) || !is_there(&jaws, 1);
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
                        off += hit.gap > gap.upper + 1e-12 ||
                               (hit.gap < gap.lower - 1e-12 && hit.gap < 0.0009);
                }
            }
        }
        rig_close(&jaws.rig);
        free((void *)triangles.corners);
        solid_close(&solid);
    }
    CHECK(looked > (long)least_seen(3000) && behind > (long)least_seen(1000) &&
              on > (long)least_seen(1000) && met == 0 && off == 0,
          "%ld of %ld meet, %ld are told wrong; %ld ticks a jaw was held, %ld the tool", met,
          looked, off, behind, on);
}

/* A tip that is taken from under its tool: it sinks, without a fold; one that comes goes no farther than it is free. */
static void a_tool_sinks_where_its_tip_goes(void)
{
    static const double small[3] = { 0.006, 0.006, 0.002 };
    struct tip_rig tip;
    tip_rig_open(&tip, NULL, sheet.mesh, DPT_HULL_KIND_BOX, small, 0);
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
    CHECK(fabs(rig->force.wrench.force[2] - pressed) < 0.01, "%g N in the step of the tip",
          rig->force.wrench.force[2]);
    rig_step(rig);
    const int folds = (rig->force.flags & DPT_FORCE_FLAG_FOLD) != 0;
    const double left = RIG_STIFFNESS * (small[2] / 2 - 5e-4);
    CHECK(fabs(rig->force.wrench.force[2] - left) < 0.01 && !folds, "%g N for %g, %d folds",
          rig->force.wrench.force[2], left, folds);
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
    jaws_open(&jaws, NULL, sheet.mesh, 0);
    jaws.rig.device.position[2] = 0.06;
    rig_orient(&jaws.rig.device, (const double[3]){ 0, 1, 0 }, -acos(0));
    rig_place(&jaws.rig);
    while (jaws.rig.device.position[2] > -0.001) {
        jaws.rig.device.position[2] = fmax(-0.001, jaws.rig.device.position[2] - 1e-3);
        jaws.rig.device.position[0] += 1e-5;
        rig_orient(&jaws.rig.device, (const double[3]){ 0, 1, 0 }, 0.05 - acos(0));
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
                    fabs(jaws.rig.force.wrench.torque[k] - before.torque[k]) / jaw_length;
        CHECK(is_there(&jaws, 0) && is_there(&jaws, 1) && before.force[2] > 0.2 && away < 1e-6,
              "tick %d: %g N of %g N", tick, away, before.force[2]);
    }
    rig_close(&jaws.rig);
}

/* FNV-1a */
static uint64_t mixed(uint64_t hash, const void *bytes, size_t size)
{
    for (size_t i = 0; i < size; i++)
        hash = (hash ^ ((const unsigned char *)bytes)[i]) * 0x100000001b3;
    return hash;
}

static uint64_t run_of(const dpt_world_def *def, long *wrong)
{
    struct jaws jaws;
    uint64_t hash = 0xcbf29ce484222325;
    jaws_open(&jaws, def, sheet.mesh, 0.0002);
    stand_at_rim(&jaws, 0.01, 0.4);
    for (int tick = 0; tick < 300; tick++) {
        jaws_want(&jaws, fmax(0, 0.4 - 0.004 * tick));
        jaws.rig.device.position[2] = 1e-3 * sin(0.05 * tick);
        rig_step(&jaws.rig);
        *wrong += passed(&jaws) > 0;
        for (int j = 0; j < 2; j++) {
            const dpt_pose pose = jaw_pose(&jaws, j);
            hash = mixed(hash, &pose, sizeof pose);
        }
        hash = mixed(hash, &jaws.rig.proxy, sizeof jaws.rig.proxy);
        hash = mixed(hash, &jaws.rig.force.wrench, sizeof jaws.rig.force.wrench);
    }
    rig_close(&jaws.rig);
    return hash;
}

static void the_same_bits(void)
{
    long wrong = 0;
    dpt_world_def def;
    dpt_world_def_init(&def);
    const uint64_t first = run_of(&def, &wrong);
    def.kernel = DPT_KERNEL_SCALAR;
    CHECK(run_of(&def, &wrong) == first && wrong == 0, "other bits, or %ld are through", wrong);
}

/* Whatever the budget leaves undone: no jaw is through, and in the end both are closed. */
static void budgets_let_nothing_through(void)
{
    const struct oracle_triangles triangles = tip_triangles(&sheet);
    static const uint32_t budgets[] = { 1, 10, 40, 100, 300, 1000 };
    for (size_t b = 0; b < sizeof budgets / sizeof *budgets; b++) {
        struct jaws jaws;
        dpt_world_def def;
        dpt_world_def_init(&def);
        def.budget = budgets[b];
        long wrong = 0;
        jaws_open(&jaws, &def, sheet.mesh, 0);
        stand_at_rim(&jaws, 0, 0.5);
        for (int tick = 0; tick < 60; tick++)
            rig_step(&jaws.rig);
        for (int tick = 0; tick < 400; tick++) {
            jaws_want(&jaws, tick < 2 ? 0.25 : 0);
            rig_step(&jaws.rig);
            wrong += jaws.rig.force.reason != DPT_FORCE_INSIDE &&
                     jaws.rig.force.reason != DPT_FORCE_UNDECIDED && passed(&jaws) > 0;
        }
        const double gap = jaw_gap(&jaws, 0, &triangles, 0.2).upper;
        CHECK(wrong == 0 && (def.budget < 300 || gap < CLEARANCE),
              "budget %u: %ld are through, gap %g", def.budget, wrong, gap);
        rig_close(&jaws.rig);
    }
    free((void *)triangles.corners);
}

/* Jaws that are closed on a sheet rest; a snapshot has their edges where they are. */
static void jaws_rest_and_are_seen(void)
{
    struct jaws jaws;
    jaws_open(&jaws, NULL, sheet.mesh, 0);
    stand_at_rim(&jaws, 0, 0.3);
    jaws_want(&jaws, 0);
    for (int tick = 0; tick < 60; tick++)
        rig_step(&jaws.rig);
    rig_step(&jaws.rig);
    CHECK(jaws.rig.step.work == 0, "work %u", jaws.rig.step.work);
    jaws_want(&jaws, 0.2);
    rig_step(&jaws.rig);
    const size_t room = dpt_snapshot_bytes(jaws.rig.world, NULL);
    void *block = malloc(room);
    size_t bytes;
    dpt_snapshot_tool tool = { .size = sizeof tool };
    CHECK(dpt_world_take_snapshot(jaws.rig.world, NULL, block, room, &bytes) == DPT_OK &&
              dpt_snapshot_get_tool(block, bytes, 0, &tool) == DPT_OK && tool.segments == 25,
          "%u segments", tool.segments);
    double highest = 0, lowest = 0;
    for (uint32_t i = 0; i < tool.segments; i++) {
        dpt_snapshot_segment segment = { .size = sizeof segment };
        dpt_snapshot_get_segment(block, bytes, tool.first_segment + i, &segment);
        highest = fmax(highest, segment.a[2]);
        lowest = fmin(lowest, segment.b[2]);
    }
    const double far = jaw_length * sin(0.2) + jaw_height * cos(0.2);
    CHECK(fabs(highest - far) < 1e-9 && fabs(lowest + far) < 1e-9, "%g to %g, not %g", lowest,
          highest, far);
    free(block);
    rig_close(&jaws.rig);
}

/* The tips of a later tool move up when one is removed: each stays where it is in its tool. */
static void tools_keep_their_jaws(void)
{
    struct jaws first, second;
    dpt_tool other;
    dpt_hit hit = DPT_HIT_INIT;
    jaws_open(&first, NULL, sheet.mesh, 0);
    stand_at_rim(&first, 0, 0.3);
    dpt_tool_add(first.rig.world, &point, 1, &other);
    second = first;
    second.rig.tool = other;
    jaws_give(&second, 0);
    second.rig.device.position[2] = 0.1;
    dpt_tool_teleport(first.rig.world, other, &second.rig.device);
    jaws_want(&second, 0.5);
    dpt_world_step(first.rig.world, RIG_DT, NULL);
    dpt_tool_remove(first.rig.world, first.rig.tool);
    dpt_tool_add(first.rig.world, &point, 1, &first.rig.tool);
    jaws_give(&first, 0);
    jaws_want(&first, -0.7);
    second.rig.device.position[2] = 0.09;
    dpt_tool_set_pose(first.rig.world, other, &second.rig.device);
    dpt_world_step(first.rig.world, RIG_DT, NULL);
    dpt_tool_get_segment_hit(first.rig.world, other, 2, &hit);
    const double low = 0.09 - jaw_length * sin(0.5) - jaw_height * cos(0.5);
    CHECK(is_there(&second, 0) && is_there(&second, 1) && fabs(hit.distance - low) < 1e-9,
          "%g, not %g", hit.distance, low);
    rig_close(&first.rig);
}

int main(int argc, char **argv)
{
    take_percent(argc, argv);
    if (!solid_from_shape(&sheet, "membrane", 512))
        return check_report();
    for (uint32_t i = 0; i < 3 * sheet.info.triangles; i++)
        rim = fmin(rim, sheet.corners[3 * i]);
    TEST(what_cannot_be_is_refused);
    TEST(in_the_open_a_tip_arrives);
    TEST(jaws_close_on_a_sheet);
    TEST(a_tip_that_jumps_stops_at_a_sheet);
    TEST(what_jaws_hold_is_felt);
    TEST(sheets_that_move_are_not_passed);
    TEST(a_tool_sinks_where_its_tip_goes);
    TEST(what_is_felt_knows_no_opening);
    TEST(jaws_never_penetrate);
    TEST(the_same_bits);
    TEST(budgets_let_nothing_through);
    TEST(jaws_rest_and_are_seen);
    TEST(tools_keep_their_jaws);
    solid_close(&sheet);
    return check_report();
}
