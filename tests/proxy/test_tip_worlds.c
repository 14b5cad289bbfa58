/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Tips in a world: calls that are refused, tools that come and go, friction, budgets, rest, kernels, trials and
 * snapshots. Oracles: closed forms on flat faces, the same world again, and a brute force over all triangles
 * (oracle/hull_surface.h). It cannot judge what lies between two ticks.
 *
 *     test_tip_worlds [PER CENT of the random cases = 100]
 */
#include "lib/size_checks.h"
#include "proxy/tip_rig.h"

static const double plate[3] = { 0.02, 0.008, 0.001 }, blade[3] = { 0.02, 0.001, 0.006 };
static const double cube[3] = { 0.006, 0.006, 0.006 };

/* The top of the box of `dynpoint make`. */
#define TOP 0.04

static struct solid box;
static struct tip_rig sized;

static dpt_result set_sized(void *given)
{
    return dpt_tool_set_tips(sized.rig.world, sized.rig.tool, given, 1);
}

static void what_cannot_be_is_refused(void)
{
    static const dpt_segment shaft[2] = { { { 0, 0, 0 }, { 0, 0, 0.1 }, 0.002 },
                                          { { 0, 0, 0.1 }, { 0, 0.1, 0.1 }, 0.002 } };
    struct tip_rig tip;
    dpt_tool other;
    tip_rig_open(&tip, NULL, box.mesh, DPT_HULL_KIND_BOX, plate, 0);
    dpt_world *world = tip.rig.world;
    const dpt_tip good = { .size = sizeof good, .hull = tip.hull };
    dpt_tip bad = good;
    CHECK(dpt_tool_set_tips(NULL, tip.rig.tool, &good, 1) == DPT_E_ARGUMENT, "no world");
    CHECK(dpt_tool_set_tips(world, 0, &good, 1) == DPT_E_HANDLE, "no tool");
    CHECK(dpt_tool_set_tips(world, tip.rig.tool, NULL, 1) == DPT_E_ARGUMENT, "no tips");
    bad.hull = NULL;
    CHECK(dpt_tool_set_tips(world, tip.rig.tool, &bad, 1) == DPT_E_ARGUMENT, "no hull");
    bad = good;
    bad.reserved = 1;
    CHECK(dpt_tool_set_tips(world, tip.rig.tool, &bad, 1) == DPT_E_ARGUMENT, "reserved");
    dpt_tip many[5];
    for (int i = 0; i < 5; i++)
        many[i] = good;
    CHECK(dpt_tool_set_tips(world, tip.rig.tool, many, 5) == DPT_E_FULL, "more than four");
    CHECK(dpt_tool_set_tips(world, tip.rig.tool, many, 4) == DPT_OK, "four");
    dpt_tool_add(world, shaft, 1, &other);
    CHECK(dpt_tool_set_tips(world, other, &good, 1) == DPT_E_FULL, "the others have them all");
    CHECK(dpt_tool_set_tips(world, tip.rig.tool, NULL, 0) == DPT_OK, "none");
    CHECK(dpt_tool_set_tips(world, other, &good, 1) == DPT_OK, "and so there is one");
    dpt_tool_settings settings = { .size = sizeof settings };
    dpt_tool_get_settings(world, other, &settings);
    settings.law = DPT_LAW_BED;
    CHECK(dpt_tool_set_settings(world, other, &settings) == DPT_E_UNSUPPORTED, "another law");
    CHECK(dpt_tool_set_segments(world, other, shaft, 1) == DPT_E_UNSUPPORTED, "free");
    CHECK(dpt_tool_try_segments(world, other, shaft, 1, 0, NULL, NULL) == DPT_E_UNSUPPORTED, "a free trial");
    dpt_tool_set_tips(world, other, NULL, 0);
    CHECK(dpt_tool_set_settings(world, other, &settings) == DPT_OK, "without a tip it may");
    CHECK(dpt_tool_set_tips(world, other, &good, 1) == DPT_E_UNSUPPORTED, "a bed has no tip");
    settings.law = DPT_LAW_PROXY;
    dpt_tool_set_settings(world, other, &settings);
    CHECK(dpt_tool_set_segments(world, other, shaft, 1) == DPT_OK, "free");
    CHECK(dpt_tool_set_tips(world, other, &good, 1) == DPT_E_UNSUPPORTED, "a free tool");
    rig_close(&tip.rig);
    tip_rig_open(&sized, NULL, box.mesh, DPT_HULL_KIND_BOX, plate, 0);
    const dpt_tip whole = { .size = sizeof whole, .hull = sized.hull };
    check_input(&(struct sized){ "dpt_tip", sizeof(dpt_tip), sizeof(dpt_tip), set_sized }, &whole);
    rig_close(&sized.rig);
}

/* The tips of later tools move up when one is removed: each still has its own. */
static void tools_keep_their_tips(void)
{
    static const dpt_segment point = { { 0, 0, 0 }, { 0, 0, 0 }, 0 };
    struct tip_rig flat, tall;
    dpt_tool second;
    tip_rig_open(&flat, NULL, box.mesh, DPT_HULL_KIND_BOX, plate, 0);
    tip_rig_open(&tall, NULL, NULL, DPT_HULL_KIND_WEDGE, blade, 0);
    dpt_world *world = flat.rig.world;
    dpt_tool_add(world, &point, 1, &second);
    const dpt_tip tip = { .size = sizeof tip, .hull = tall.hull };
    CHECK(dpt_tool_set_tips(world, second, &tip, 1) == DPT_OK, "a second tool's tip");
    for (int round = 0; round < 2; round++) {
        dpt_pose pose = DPT_POSE_IDENTITY;
        dpt_hit hit = DPT_HIT_INIT;
        pose.position[2] = TOP + 0.01;
        dpt_tool_teleport(world, second, &pose);
        if (round)
            dpt_tool_remove(world, flat.rig.tool);
        dpt_world_step(world, RIG_DT, NULL);
        dpt_tool_get_segment_hit(world, second, 1, &hit);
        CHECK(fabs(hit.distance - (0.01 - blade[2] / 2)) < 1e-9 && hit.status == DPT_STATUS_EXACT, "round %d: %g",
              round, hit.distance);
    }
    rig_close(&flat.rig);
    rig_close(&tall.rig);
}

/* Tools with tips come and go: each time there is room for them. */
static void removed_tools_give_their_tips_back(void)
{
    static const dpt_segment point = { { 0, 0, 0 }, { 0, 0, 0 }, 0 };
    struct tip_rig tip;
    tip_rig_open(&tip, NULL, box.mesh, DPT_HULL_KIND_BOX, plate, 0);
    dpt_tip three[3];
    for (int i = 0; i < 3; i++)
        three[i] = (dpt_tip){ .size = sizeof *three, .hull = tip.hull };
    for (int round = 0; round < 5; round++) {
        dpt_tool tool;
        dpt_tool_add(tip.rig.world, &point, 1, &tool);
        CHECK(dpt_tool_set_tips(tip.rig.world, tool, three, 3) == DPT_OK, "round %d", round);
        dpt_world_step(tip.rig.world, RIG_DT, NULL);
        dpt_tool_remove(tip.rig.world, tool);
    }
    rig_close(&tip.rig);
}

/* Coulomb on a flat face: a plate that is led sideways sticks up to the cone, and then the pull is what the cone allows. */
static void a_plate_sticks_and_slips(void)
{
    struct tip_rig tip;
    const double mu = 0.4, depth = 0.002;
    tip_rig_open(&tip, NULL, box.mesh, DPT_HULL_KIND_BOX, plate, 0);
    struct rig *rig = &tip.rig;
    rig_set_body(rig, (dpt_body_settings){ .static_friction = mu, .kinetic_friction = mu });
    rig->device.position[2] = TOP + plate[2] / 2 + 0.001;
    rig_place(rig);
    while (rig->device.position[2] > TOP + plate[2] / 2 - depth) {
        rig->device.position[2] -= 1e-4;
        rig_step(rig);
    }
    const double normal = rig->force.wrench.force[2], stuck = rig->proxy.position[0];
    for (int tick = 0; tick < 60; tick++) {
        rig->device.position[0] += 1e-5;
        rig_step(rig);
    }
    CHECK(fabs(rig->proxy.position[0] - stuck) < 2e-6 && rig->force.sticking > 0, "moved %g, %u stick",
          rig->proxy.position[0] - stuck, rig->force.sticking);
    for (int tick = 0; tick < 200; tick++) {
        rig->device.position[0] += 1e-5;
        rig_step(rig);
    }
    /* It lies on three of its corners, which need not bear alike: it may turn as it slips. */
    const double pull = hypot(rig->force.wrench.force[0], rig->force.wrench.force[1]);
    CHECK(fabs(pull - mu * normal) < 0.03 * mu * normal && rig->force.wrench.force[0] < -0.9 * pull,
          "pulled by %g N of %g, %g N along the way", pull, mu * normal, rig->force.wrench.force[0]);
    CHECK(rig->force.slipping > 0, "%u slip", rig->force.slipping);
    rig_close(rig);
}

static uint64_t hash_of(uint64_t hash, const void *bytes, size_t size)
{
    for (size_t i = 0; i < size; i++)
        hash = (hash ^ ((const unsigned char *)bytes)[i]) * 0x100000001b3u;
    return hash;
}

/* One run over a liver; what it gave, as a hash of wrenches, proxies and contacts. */
static uint64_t run_of(const struct solid *liver, const dpt_world_def *def)
{
    struct tip_rig tip;
    uint64_t hash = 0xcbf29ce484222325u;
    tip_rig_open(&tip, def, liver->mesh, DPT_HULL_KIND_CYLINDER, cube, 0.0003);
    struct rig *rig = &tip.rig;
    rig_set_body(rig, (dpt_body_settings){ .static_friction = 0.3, .kinetic_friction = 0.3 });
    rig->device.position[2] = 0.12;
    rig_place(rig);
    for (int tick = 0; tick < 900; tick++) {
        const double angle = 0.002 * tick;
        rig->device.position[2] = fmax(0.03, rig->device.position[2] - 2e-4);
        rig->device.position[0] = 0.02 * sin(angle);
        pose_orient(&rig->device, (const double[3]){ 0.6, 0, 0.8 }, 0.3 * angle);
        rig_step(rig);
        dpt_contact contact = { .size = sizeof contact };
        tip_rig_contact(&tip, &contact);
        hash = hash_of(hash, &rig->force.wrench, sizeof rig->force.wrench);
        hash = hash_of(hash, &rig->proxy, sizeof rig->proxy);
        hash = hash_of(hash, contact.q, sizeof contact.q);
    }
    CHECK(rig->force.reason == DPT_FORCE_ACTS, "reason %u at the end", rig->force.reason);
    rig_close(rig);
    return hash;
}

static void kernels_give_the_same_bits(void)
{
    struct solid liver;
    dpt_world_def def = rig_def(DPT_LAW_PROXY);
    uint64_t first = 0;
    if (!solid_from_shape(&liver, "liver", 2000))
        return;
    for (uint32_t kernel = DPT_KERNEL_AUTO + 1; kernel < DPT_KERNEL_AUTO + 16; kernel++) {
        if (!rig_has_kernel(kernel))
            continue;
        def.kernel = kernel;
        const uint64_t hash = run_of(&liver, &def);
        first = first ? first : hash;
        CHECK(hash == first, "kernel %u gives other bits", kernel);
    }
    CHECK(first, "no kernel ran");
    solid_close(&liver);
}

/* What does not move is not searched for: no work, and the same bits. */
static void a_tip_rests(void)
{
    struct tip_rig tip;
    tip_rig_open(&tip, NULL, box.mesh, DPT_HULL_KIND_BOX, plate, 0);
    struct rig *rig = &tip.rig;
    rig->device.position[2] = TOP + 0.002;
    rig_place(rig);
    rig->device.position[2] = TOP - 0.001;
    for (int tick = 0; tick < 60; tick++)
        rig_step(rig);
    const dpt_wrench before = rig->force.wrench;
    dpt_contact contact, last;
    CHECK(tip_rig_contact(&tip, &last) == 1, "no contact");
    for (int tick = 0; tick < 10; tick++) {
        rig_step(rig);
        CHECK(rig->step.work == 0 && memcmp(&before, &rig->force.wrench, sizeof before) == 0 &&
                  tip_rig_contact(&tip, &contact) == 1 && memcmp(&contact, &last, sizeof last) == 0,
              "work %u", rig->step.work);
    }
    /* A body that comes is noticed. */
    dpt_pose body = DPT_POSE_IDENTITY;
    body.position[2] = 0.0005;
    dpt_body_set_pose(rig->world, rig->body, &body);
    rig_step(rig);
    CHECK(rig->force.wrench.force[2] > before.force[2] + 0.2, "%g N, before %g N", rig->force.wrench.force[2],
          before.force[2]);
    rig_close(rig);
}

/* Whatever the budget leaves undone, the proxy is where it was proven free. */
static void budgets_let_nothing_through(void)
{
    struct solid liver;
    if (!solid_from_shape(&liver, "liver", 2000))
        return;
    const struct oracle_triangles triangles = tip_triangles(&liver);
    static const uint32_t budgets[] = { 1, 10, 40, 100, 300, 1000 };
    for (size_t b = 0; b < sizeof budgets / sizeof *budgets; b++) {
        struct tip_rig tip;
        dpt_world_def def = rig_def(DPT_LAW_PROXY);
        def.budget = budgets[b];
        tip_rig_open(&tip, &def, liver.mesh, DPT_HULL_KIND_BOX, plate, 0);
        struct rig *rig = &tip.rig;
        long met = 0, held = 0;
        rig->device.position[2] = 0.12;
        rig_place(rig);
        for (int tick = 0; tick < 100; tick++)
            rig_step(rig);
        for (int tick = 0; tick < 600; tick++) {
            rig->device.position[2] = fmax(0.04, rig->device.position[2] - 2e-4);
            rig_step(rig);
            held += rig->force.reason == DPT_FORCE_ACTS;
            if (tick % 16 == 0 && rig->force.reason == DPT_FORCE_ACTS)
                met += !(tip_rig_gap(&tip, &triangles, &rig->proxy, 0.2).lower >= 0);
        }
        CHECK(met == 0, "budget %u: the proxy meets the liver on %ld of the ticks looked at", def.budget, met);
        CHECK(def.budget < 300 || held > 100, "budget %u: held on %ld ticks", def.budget, held);
        rig_close(rig);
    }
    free((void *)triangles.corners);
    solid_close(&liver);
}

/* A trial tells where a step's sweep would touch first; on the way there nothing is touched. */
static void trials_know_tips(void)
{
    struct tip_rig tip;
    uint64_t seed = 9;
    tip_rig_open(&tip, NULL, box.mesh, DPT_HULL_KIND_WEDGE, blade, 0);
    struct rig *rig = &tip.rig;
    for (uint64_t i = 0; i < part_of(200); i++) {
        dpt_pose to, reached;
        dpt_sweep first = { .size = sizeof first };
        double axis[3] = { random_in(&seed, -1, 1), random_in(&seed, -1, 1), random_in(&seed, -1, 1) },
               corners[3 * ORACLE_CORNERS], lowest = 1;
        unit3(axis);
        pose_orient(&rig->device, axis, random_in(&seed, -1, 1));
        for (int k = 0; k < 3; k++)
            rig->device.position[k] = k == 2 ? TOP + 0.02 : random_in(&seed, -0.03, 0.03);
        rig_place(rig);
        to = rig->device;
        to.position[2] = TOP - random_in(&seed, -0.02, 0.02);
        pose_orient(&to, axis, random_in(&seed, -1, 1));
        CHECK(dpt_tool_try_pose(rig->world, rig->tool, &to, 0, &first, &reached) == DPT_OK, "trial");
        tip_rig_corners(&tip, &reached, corners);
        for (uint32_t c = 0; c < tip.as.corner_count; c++)
            lowest = fmin(lowest, corners[3 * c + 2] - TOP);
        const int hits = first.status == DPT_SWEEP_HIT;
        CHECK(lowest > 0 && (!hits || (lowest < 5e-7 && first.segment <= 1 && first.normal[2] > 0.9999)),
              "status %u: %g above, segment %u, normal %g", first.status, lowest, first.segment, first.normal[2]);
        CHECK(hits || first.time == 1, "free up to %g", first.time);
    }
    rig_close(rig);
}

/* A snapshot has a tip's edges as segments, and its contact names the first of them. */
static void snapshots_show_tips(void)
{
    struct tip_rig tip;
    tip_rig_open(&tip, NULL, box.mesh, DPT_HULL_KIND_BOX, plate, 0);
    struct rig *rig = &tip.rig;
    rig->device.position[2] = TOP + plate[2] / 2 + 0.0005;
    rig_place(rig);
    const size_t room = dpt_snapshot_bytes(rig->world, NULL);
    void *block = malloc(room);
    size_t bytes;
    CHECK(dpt_world_take_snapshot(rig->world, NULL, block, room, &bytes) == DPT_OK, "snapshot");
    dpt_snapshot_tool tool = { .size = sizeof tool };
    CHECK(dpt_snapshot_get_tool(block, bytes, 0, &tool) == DPT_OK, "tool");
    CHECK(tool.segments == 13 && tool.contacts >= 1, "%u segments, %u contacts", tool.segments, tool.contacts);
    double longest = 0;
    for (uint32_t i = 0; i < tool.segments; i++) {
        dpt_snapshot_segment segment = { .size = sizeof segment };
        CHECK(dpt_snapshot_get_segment(block, bytes, tool.first_segment + i, &segment) == DPT_OK, "segment %u", i);
        longest = fmax(longest, apart(segment.a, segment.b));
        CHECK(i == 0 || fabs(segment.gap - 0.0005) < 1e-9, "segment %u: gap %g", i, segment.gap);
    }
    CHECK(fabs(longest - plate[0]) < 1e-12 && tool.nearest_segment == 1, "longest %g, nearest %u", longest,
          tool.nearest_segment);
    free(block);
    rig_close(rig);
}

int main(int argc, char **argv)
{
    take_percent(argc, argv);
    if (!solid_from_shape(&box, "box", 300))
        return check_report();
    TEST(what_cannot_be_is_refused);
    TEST(tools_keep_their_tips);
    TEST(removed_tools_give_their_tips_back);
    TEST(a_plate_sticks_and_slips);
    TEST(kernels_give_the_same_bits);
    TEST(a_tip_rests);
    TEST(budgets_let_nothing_through);
    TEST(trials_know_tips);
    TEST(snapshots_show_tips);
    solid_close(&box);
    return check_report();
}
