/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Tips: a proxy with a convex body at its end. Oracles: closed forms on flat surfaces, and a brute force in long double
 * over all triangles that shares no code with the library (oracle/hull_surface.h). It cannot judge what lies between two
 * ticks, but for the side that the tip is on at the end.
 *
 *     test_tips [PER CENT of the random cases = 100]
 */
#include "proxy/tip_rig.h"

static const double plate[3] = { 0.02, 0.008, 0.001 }, blade[3] = { 0.02, 0.001, 0.006 };
static const double needle[3] = { 0.003, 0.003, 0.012 }, cube[3] = { 0.006, 0.006, 0.006 };

/* The top of the box of `dynpoint make`, 0.12 x 0.10 x 0.08 m. */
#define TOP 0.04

/* What contacts are held apart by, at most: 2e-6 of the largest body, up to 1 m. */
#define CLEARANCE 2e-6

static void lower(struct rig *rig, double to, double step)
{
    while (rig->device.position[2] > to) {
        rig->device.position[2] = fmax(to, rig->device.position[2] - step);
        rig_step(rig);
    }
}

/* A plate flat on a flat face: the whole stiffness, no torque, and it stays level. */
static void a_plate_rests_flat(void)
{
    struct solid box;
    struct tip_rig tip;
    if (!solid_from_shape(&box, "box", 300))
        return;
    for (int round = 0; round < 2; round++) {
        const double radius = round ? 0.0005 : 0, half = plate[2] / 2 + radius;
        tip_rig_open(&tip, NULL, box.mesh, DPT_HULL_KIND_BOX, plate, radius);
        struct rig *rig = &tip.rig;
        rig->device.position[0] = 0.003;
        rig->device.position[2] = TOP + half + 0.002;
        rig_place(rig);
        CHECK(rig->force.reason == DPT_FORCE_FREE, "reason %u", rig->force.reason);
        lower(rig, TOP + half - 0.003, 1e-4);
        for (int tick = 0; tick < 20; tick++)
            rig_step(rig);
        const double *force = rig->force.wrench.force, *torque = rig->force.wrench.torque;
        const double gap = rig->proxy.position[2] - TOP - half;
        CHECK(gap > 0 && gap < CLEARANCE, "gap %g", gap);
        CHECK(fabs(force[2] - RIG_STIFFNESS * (0.003 + gap)) < 1e-6, "%g N", force[2]);
        CHECK(hypot(force[0], force[1]) < 1e-6 && sqrt(dot3(torque, torque)) < 1e-7, "across %g N, %g Nm",
              hypot(force[0], force[1]), sqrt(dot3(torque, torque)));
        CHECK(1 - fabs(rig->proxy.orientation[0]) < 1e-9, "turned: w %g", rig->proxy.orientation[0]);
        rig_close(rig);
    }
    solid_close(&box);
}

/* A pyramid under the middle of a plate's face: segments along its edges would let it through. */
static void a_corner_of_the_mesh_holds_a_face(void)
{
    static const double vertices[] = { 0, 0, 0.03, 0.05, 0.05, 0, -0.05, 0.05, 0, -0.05, -0.05, 0, 0.05, -0.05, 0 };
    static const uint32_t corners[] = { 0, 1, 2, 0, 2, 3, 0, 3, 4, 0, 4, 1, 1, 3, 2, 1, 4, 3 };
    struct solid pyramid;
    struct tip_rig tip;
    if (!solid_from_arrays(&pyramid, "pyramid", vertices, 5, corners, 6))
        return;
    tip_rig_open(&tip, NULL, pyramid.mesh, DPT_HULL_KIND_BOX, plate, 0);
    struct rig *rig = &tip.rig;
    rig->device.position[0] = 1e-4; /* not quite in the middle, within its corners' reach */
    rig->device.position[2] = 0.03 + plate[2] / 2 + 0.001;
    rig_place(rig);
    lower(rig, 0.03 + plate[2] / 2 - 0.002, 1e-4);
    dpt_hit hit = DPT_HIT_INIT;
    dpt_tool_get_segment_hit(rig->world, rig->tool, 1, &hit);
    CHECK(rig->force.reason == DPT_FORCE_ACTS && rig->force.wrench.force[2] > 0.9, "reason %u, %g N", rig->force.reason,
          rig->force.wrench.force[2]);
    CHECK(hit.segment == 1 && hit.contact == DPT_CONTACT_PENETRATING && hit.distance == 0,
          "segment %u, contact %u, distance %g", hit.segment, hit.contact, hit.distance);
    dpt_contact contact;
    uint32_t count = tip_rig_contact(&tip, &contact);
    CHECK(count == 1 && contact.segment == 1 && contact.id && contact.gap > 0 && contact.gap < CLEARANCE &&
              fabs(contact.normal[2]) > 0.9 && apart(contact.q, (const double[3]){ 0, 0, (float)0.03 }) < 1e-9,
          "%u contacts; gap %g", count, contact.gap);
    const uint32_t id = contact.id;
    rig_step(rig);
    count = tip_rig_contact(&tip, &contact);
    CHECK(count == 1 && contact.id == id, "id %u, then %u", id, contact.id);
    rig_close(rig);
    solid_close(&pyramid);
}

/* Two roofs crosswise: an edge of a tip on an edge of the mesh, and nothing else. */
static void an_edge_rests_on_an_edge(void)
{
    static const double roof[] = { -0.05, 0,    0.02, 0.05,  0,     0.02, -0.05, 0.05,  0,
                                   0.05,  0.05, 0,    -0.05, -0.05, 0,    0.05,  -0.05, 0 };
    static const uint32_t corners[] = { 0, 1, 3, 0, 3, 2, 0, 4, 5, 0, 5, 1, 0, 2, 4, 1, 5, 3, 2, 3, 5, 2, 5, 4 };
    struct solid solid;
    struct tip_rig tip;
    if (!solid_from_arrays(&solid, "roof", roof, 6, corners, 8))
        return;
    tip_rig_open(&tip, NULL, solid.mesh, DPT_HULL_KIND_WEDGE, blade, 0);
    struct rig *rig = &tip.rig;
    pose_orient(&rig->device, (const double[3]){ 0, 0, 1 }, 1.2);
    rig->device.position[2] = 0.02 + blade[2] / 2 + 0.001;
    rig_place(rig);
    lower(rig, 0.02 + blade[2] / 2 - 0.001, 1e-4);
    const double gap = rig->proxy.position[2] - 0.02 - blade[2] / 2;
    CHECK(gap > 0 && gap < CLEARANCE, "gap %g", gap);
    CHECK(fabs(rig->force.wrench.force[2] - RIG_STIFFNESS * (0.001 + gap)) < 1e-6, "%g N", rig->force.wrench.force[2]);
    rig_close(rig);
    solid_close(&solid);
}

/* One path: from above a random place of the solid into it, then along and turning. */
struct path {
    double place[3], normal[3], along[3], turn[3];
    double depth;
};

static int random_path(const struct solid *solid, uint64_t *seed, dpt_pose *pose, struct path *path)
{
    const float *v = solid->corners + 9 * (random_bits(seed) % solid->info.triangles);
    double e[3], f[3];
    for (int k = 0; k < 3; k++) {
        path->place[k] = (v[k] + v[3 + k] + v[6 + k]) / 3.0;
        e[k] = v[3 + k] - v[k];
        f[k] = v[6 + k] - v[k];
        path->turn[k] = random_in(seed, -1, 1);
    }
    for (int k = 0; k < 3; k++)
        path->normal[k] = e[(k + 1) % 3] * f[(k + 2) % 3] - e[(k + 2) % 3] * f[(k + 1) % 3];
    memcpy(path->along, e, sizeof e);
    random_turn(seed, pose->orientation);
    path->depth = random_in(seed, 0.001, 0.005);
    return unit3(path->normal) > 0 && unit3(path->along) > 0 && unit3(path->turn) > 0;
}

/* Turn a pose by a small angle about a unit axis. */
static void turn_by(dpt_pose *pose, const double axis[3], double angle)
{
    const double w = cos(angle / 2), s = sin(angle / 2);
    pose_turn_by(pose, (const double[4]){ w, s * axis[0], s * axis[1], s * axis[2] });
}

struct counts {
    long ticks, held, looked, met, low, off;
    long lags, folds;
    long toppled, toppled_folds; /* of held and folds: turned from the device by more than 1 rad */
};

/*
 * Press, slide and turn; every 16th held tick is looked at by the oracle: the proxy's gap is what the tool says, and
 * never below 0.
 */
static void follow(struct tip_rig *tip, const struct solid *solid, const struct oracle_triangles *triangles,
                   uint64_t *seed, double high, struct counts *counts)
{
    struct rig *rig = &tip->rig;
    struct path path;
    if (!random_path(solid, seed, &rig->device, &path))
        return;
    const double speed = random_in(seed, 2e-5, 3e-4);
    double down = high, slid = 0;
    for (int tick = 0; tick < 240; tick++) {
        down = tick ? fmax(-path.depth, down - 4 * speed) : down;
        slid += down == -path.depth ? speed : 0;
        for (int k = 0; k < 3; k++)
            rig->device.position[k] = path.place[k] + down * path.normal[k] + slid * path.along[k];
        turn_by(&rig->device, path.turn, down == -path.depth ? 5 * speed : 0);
        if (tick == 0)
            rig_place(rig);
        else
            rig_step(rig);
        counts->ticks++;
        if (rig->force.reason != DPT_FORCE_ACTS)
            continue;
        counts->held++;
        const int is_fold = (rig->force.flags & DPT_FORCE_FLAG_FOLD) != 0;
        const int has_toppled = pose_angle(&rig->device, &rig->proxy) > 1.0;
        counts->folds += is_fold;
        counts->toppled += has_toppled;
        counts->toppled_folds += is_fold && has_toppled;
        const double pull = rig_force(rig) / RIG_STIFFNESS;
        counts->lags += !(rig->force.flags & DPT_FORCE_FLAG_FOLD) && rig->force.lag > 0.01 * pull;
        if (tick % 16)
            continue;
        dpt_contact contact;
        const uint32_t count = tip_rig_contact(tip, &contact);
        const struct oracle_interval gap = tip_rig_gap(tip, triangles, &rig->proxy, 0.001);
        counts->looked++;
        counts->met += !(gap.upper > 0);
        counts->low += !(gap.lower >= 0);
        counts->off +=
            count ? contact.gap > gap.upper + 1e-12 || contact.gap < gap.lower - 1e-12 : gap.upper < 0.001 - 1e-9;
    }
}

static const struct tip_case {
    uint32_t kind;
    const double *extent;
    double radius;
} tip_cases[] = { { DPT_HULL_KIND_BOX, plate, 0 },
                  { DPT_HULL_KIND_WEDGE, blade, 0 },
                  { DPT_HULL_KIND_CONE, needle, 0 },
                  { DPT_HULL_KIND_CYLINDER, cube, 0 },
                  { DPT_HULL_KIND_BOX, plate, 0.0005 } };

static void follow_on(const struct solid *solid, uint64_t paths, uint64_t *seed, struct counts *total)
{
    const struct oracle_triangles triangles = tip_triangles(solid);
    for (size_t t = 0; t < sizeof tip_cases / sizeof *tip_cases; t++) {
        struct tip_rig tip;
        struct counts counts = { 0 };
        tip_rig_open(&tip, NULL, solid->mesh, tip_cases[t].kind, tip_cases[t].extent, tip_cases[t].radius);
        for (uint64_t i = 0; i < paths; i++) {
            rig_vary(&tip.rig, seed);
            follow(&tip, solid, &triangles, seed, 0.02, &counts);
        }
        CHECK(counts.met == 0 && counts.low == 0 && counts.off == 0,
              "%s, tip %zu: of %ld looked at, %ld meet, %ld are below 0, %ld are not what is told", solid->name, t,
              counts.looked, counts.met, counts.low, counts.off);
        total->looked += counts.looked;
        total->held += counts.held;
        total->lags += counts.lags;
        total->folds += counts.folds;
        total->toppled += counts.toppled;
        total->toppled_folds += counts.toppled_folds;
        rig_close(&tip.rig);
    }
    free((void *)triangles.corners);
}

static void tips_never_penetrate(void)
{
    static const struct {
        const char *name;
        uint64_t count;
    } shapes[] = { { "liver", 2000 }, { "torus", 1280 }, { "star", 2000 }, { "box", 300 }, { "sphere", 1280 } };
    struct counts counts = { 0 };
    uint64_t seed = 11;
    for (size_t s = 0; s < sizeof shapes / sizeof *shapes; s++) {
        struct solid solid;
        if (!solid_from_shape(&solid, shapes[s].name, shapes[s].count))
            continue;
        follow_on(&solid, part_of(40), &seed, &counts);
        solid_close(&solid);
    }
    CHECK(counts.looked >= (long)least_seen(400), "only %ld looked at", counts.looked);
    const long upright = counts.held - counts.toppled, folds = counts.folds - counts.toppled_folds;
    CHECK(folds <= upright / 50, "%ld folds on %ld held ticks", folds, upright);
    /* Of a few paths it may be any share. */
    CHECK(counts.toppled < 5000 || counts.toppled_folds <= counts.toppled / 20,
          "%ld folds on %ld held ticks of tools that have toppled", counts.toppled_folds, counts.toppled);
    CHECK(counts.lags <= counts.held / 20, "%ld lag on %ld held ticks", counts.lags, counts.held);
}

/* Across a membrane at any speed, up to 20 m/s: the proxy stays on its side. */
static void thin_walls_are_not_passed(void)
{
    struct solid sheet;
    uint64_t seed = 5;
    long pokes = 0, passed = 0;
    if (!solid_from_shape(&sheet, "membrane", 512))
        return;
    for (size_t t = 0; t < sizeof tip_cases / sizeof *tip_cases; t++) {
        struct tip_rig tip;
        tip_rig_open(&tip, NULL, sheet.mesh, tip_cases[t].kind, tip_cases[t].extent, tip_cases[t].radius);
        struct rig *rig = &tip.rig;
        for (uint64_t i = 0; i < part_of(400); i++) {
            double axis[3] = { random_in(&seed, -1, 1), random_in(&seed, -1, 1), random_in(&seed, -1, 1) };
            double corners[3 * ORACLE_CORNERS];
            const double speed = pow(10, random_in(&seed, -3.5, -1));
            unit3(axis);
            pose_orient(&rig->device, axis, random_in(&seed, -3, 3));
            for (int k = 0; k < 3; k++)
                rig->device.position[k] = k == 2 ? 0.02 : random_in(&seed, -0.05, 0.05);
            rig_place(rig);
            for (int tick = 0; tick < 12; tick++) {
                rig->device.position[2] -= speed;
                turn_by(&rig->device, axis, random_in(&seed, -0.03, 0.03));
                rig_step(rig);
                tip_rig_corners(&tip, &rig->proxy, corners);
                /* Turned by more than 1 rad from its device, a proxy starts again there. */
                if (rig->force.flags & DPT_FORCE_FLAG_REPLACED)
                    break;
                pokes++;
                for (uint32_t c = 0; c < tip.as.corner_count; c++)
                    passed += !(corners[3 * c + 2] - tip.radius > 0);
            }
        }
        rig_close(rig);
    }
    CHECK(pokes >= (long)least_seen(16000), "only %ld ticks", pokes);
    CHECK(passed == 0, "of %ld ticks %ld corners are behind the sheet", pokes, passed);
    solid_close(&sheet);
}

/* A tip beside a shaft: what touches first holds, and hits and contacts are numbered on. */
static void a_shaft_and_its_tip_are_one_tool(void)
{
    static const dpt_segment shaft = { { 0, 0, 0.01 }, { 0, 0, 0.1 }, 0.003 };
    struct solid box;
    struct tip_rig tip;
    if (!solid_from_shape(&box, "box", 300))
        return;
    rig_open(&tip.rig, NULL, box.mesh, &shaft, 1);
    tip_rig_give(&tip, DPT_HULL_KIND_WEDGE, blade, 0);
    struct rig *rig = &tip.rig;
    rig->device.position[2] = TOP + blade[2] / 2 + 0.002;
    rig_place(rig);
    dpt_hit hit = DPT_HIT_INIT, of_tip = DPT_HIT_INIT;
    dpt_tool_get_hit(rig->world, rig->tool, &hit);
    dpt_tool_get_segment_hit(rig->world, rig->tool, 1, &of_tip);
    CHECK(hit.segment == 1 && of_tip.segment == 1 && hit.distance == of_tip.distance && fabs(hit.gap - 0.002) < 1e-9 &&
              hit.contact == DPT_CONTACT_SEPARATED,
          "segment %u, gap %g", hit.segment, hit.gap);
    CHECK(dpt_tool_get_segment_hit(rig->world, rig->tool, 2, &hit) == DPT_E_ARGUMENT, "there is no third part");
    lower(rig, TOP + blade[2] / 2 - 0.002, 1e-4);
    CHECK(fabs(rig->force.wrench.force[2] - RIG_STIFFNESS * 0.002) < 1e-3, "%g N", rig->force.wrench.force[2]);
    /* Lying on its side, the shaft touches and the tip does not. */
    pose_orient(&rig->device, (const double[3]){ 1, 0, 0 }, acos(0));
    rig->device.position[1] = 0.04;
    rig->device.position[2] = TOP + 0.005;
    rig_place(rig);
    lower(rig, TOP + 0.002, 1e-4);
    dpt_contact contacts[4] = { { .size = sizeof *contacts } };
    uint32_t count;
    dpt_tool_get_contacts(rig->world, rig->tool, contacts, 4, &count);
    CHECK(count >= 1 && contacts[0].segment == 0 && rig->force.reason == DPT_FORCE_ACTS,
          "%u contacts, segment %u, reason %u", count, contacts[0].segment, rig->force.reason);
    rig_close(rig);
    solid_close(&box);
}

int main(int argc, char **argv)
{
    take_percent(argc, argv);
    TEST(a_plate_rests_flat);
    TEST(a_corner_of_the_mesh_holds_a_face);
    TEST(an_edge_rests_on_an_edge);
    TEST(a_shaft_and_its_tip_are_one_tool);
    TEST(thin_walls_are_not_passed);
    TEST(tips_never_penetrate);
    return check_report();
}
