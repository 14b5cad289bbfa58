/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What happens to a needle that is in a soft body: layers of soft and rigid bodies, bodies that move, beat and go,
 * teleports, budgets, physics of somebody else's; and what a hand cannot get out of it.
 *
 *     test_needle_soft_life [PER CENT = 100]
 */
#include "dynpoint/passivity.h"
#include "dynpoint/snapshot.h"
#include "world/soft_needle.h"

#include <stdlib.h>

#define STIFFNESS 500.0

static int is_in(const struct soft_needle *needle)
{
    return (needle->tool->force.flags & DPT_FORCE_FLAG_INSERTED) != 0;
}

static double axial(const struct soft_needle *needle)
{
    return needle->tool->force.wrench.force[2];
}

/* A needle at a depth in the ball. */
static int open_inside(struct soft_needle *needle, uint32_t integrator, double depth)
{
    const struct tissue_def def = soft_needle_liver(integrator);
    const dpt_body_settings gel = soft_needle_gel(15.0);
    if (!soft_needle_open(needle, &def, &gel, STIFFNESS))
        return 0;
    soft_needle_go(needle, depth);
    CHECK(is_in(needle), "it is not in");
    return 1;
}

/* A rigid box that can be pierced, and where. */
static struct tissue_body *add_box(struct soft_needle *needle, double z)
{
    const dpt_body_settings gel = soft_needle_gel(15.0);
    struct tissue_def def = { .shape = "box", .triangles = 12, .place = { 0.0, 0.0, z } };
    struct tissue_body *box = tissue_rig_add_rigid(&needle->tissue, &def);
    soft_needle_set_gel(needle, box, &gel);
    return box;
}

/* Through a soft box into a rigid one behind it; or the other way round. */
static void layers_come_in_order(void)
{
    for (int i = 0; i < 2 * TISSUE_INTEGRATORS; i++) {
        struct tissue_def def = soft_needle_liver(tissue_integrators[i % 3]);
        const dpt_body_settings gel = soft_needle_gel(15.0);
        const int is_box_first = i >= 3;
        struct soft_needle needle;
        dpt_channel channels[4];
        uint32_t ruptures = 0, was_rupture = 0, most = 0;
        double last = 0.0;
        def.shape = "box";
        def.triangles = 432;
        if (!soft_needle_open(&needle, &def, &gel, STIFFNESS))
            return;
        const struct tissue_body *box = add_box(&needle, is_box_first ? 0.085 : -0.085);
        needle.depth = is_box_first ? -0.087 : -0.002;
        soft_needle_aim(&needle);
        tissue_rig_place(&needle.tissue);
        const double end = is_box_first ? 0.01 : 0.097;
        while (needle.depth < end) {
            needle.depth += NEEDLE_SLOW;
            soft_needle_tick(&needle);
            const uint32_t is_rupture = needle.tool->force.flags & DPT_FORCE_FLAG_RUPTURE;
            ruptures += is_rupture && !was_rupture;
            was_rupture = is_rupture;
            const double force = length3(needle.tool->force.wrench.force);
            CHECK(fabs(force - last) < STIFFNESS * (3.0 * NEEDLE_SLOW + 1e-3), "%d: a jump of %g N at %g m", i,
                  force - last, needle.depth);
            last = force;
            const uint32_t count = soft_needle_channels(&needle, channels, 4);
            most = count > most ? count : most;
        }
        CHECK(most == 2 && is_in(&needle), "%d: %u channels, flags %x", i, most, needle.tool->force.flags);
        CHECK(channels[0].body == (is_box_first ? box->id : needle.body->id), "%d: another order", i);
        /* In at the first, out of it, and in at the second. */
        CHECK(channels[0].ruptures == 2 && channels[1].ruptures == 1, "%d: %u and %u walls", i, channels[0].ruptures,
              channels[1].ruptures);
        CHECK(ruptures >= 3, "%d: %u ruptures", i, ruptures);
        const double told = channels[0].friction + channels[0].tip + channels[1].friction + channels[1].tip;
        CHECK(fabs(told - axial(&needle)) < 0.05 * told, "%d: %g N told, %g felt", i, told, axial(&needle));
        CHECK(channels[1].inside > 0.004, "%d: %g m in the second", i, channels[1].inside);
        soft_needle_go(&needle, needle.depth - 0.2);
        CHECK(!is_in(&needle) && axial(&needle) == 0.0, "%d: it is not out", i);
        soft_needle_close(&needle);
    }
}

/*
 * Through a rigid box into a soft one behind it, out of that, which goes aside by half the needle's radius, and in again:
 * its hole is there where the tissue is, and takes no rupture.
 */
static void a_hole_behind_is_found_again(void)
{
    for (int i = 0; i < TISSUE_INTEGRATORS; i++) {
        struct tissue_def def = soft_needle_liver(tissue_integrators[i]);
        const dpt_body_settings gel = soft_needle_gel(15.0);
        struct soft_needle needle;
        dpt_channel channels[4];
        uint32_t ruptures = 0;
        def.shape = "box";
        def.triangles = 432;
        if (!soft_needle_open(&needle, &def, &gel, STIFFNESS))
            return;
        add_box(&needle, 0.085);
        needle.depth = -0.087;
        soft_needle_aim(&needle);
        tissue_rig_place(&needle.tissue);
        soft_needle_go(&needle, 0.01);
        CHECK(soft_needle_channels(&needle, channels, 4) == 2 && channels[1].flags == DPT_CHANNEL_FLAG_OCCUPIED,
              "%d: it is not in both", i);
        soft_needle_go(&needle, -0.004);
        CHECK(soft_needle_channels(&needle, channels, 4) == 2 && channels[1].flags == 0, "%d: it is not out", i);
        dpt_pose aside = DPT_POSE_IDENTITY;
        for (int k = 1; k <= 100; k++) {
            aside.position[0] = 0.5 * NEEDLE_RADIUS * k / 100.0;
            CHECK(dpt_body_set_pose(needle.tissue.rig.world, needle.body->id, &aside) == DPT_OK, "it stays");
            soft_needle_tick(&needle);
        }
        while (needle.depth < 0.008) {
            soft_needle_go(&needle, needle.depth + NEEDLE_SLOW);
            ruptures += (needle.tool->force.flags & DPT_FORCE_FLAG_RUPTURE) != 0;
        }
        const uint32_t count = soft_needle_channels(&needle, channels, 4);
        CHECK(count == 2 && ruptures == 0 && channels[1].flags == DPT_CHANNEL_FLAG_OCCUPIED,
              "%d: %u channels, %u ruptures, flags %x", i, count, ruptures, channels[1].flags);
        soft_needle_close(&needle);
    }
}

/* A floor with a wall on it. */
static int is_angle(int x, int y, int z)
{
    (void)y;
    return x < 3 || z < 3;
}

/*
 * The needle is in the floor, and the hand pulls it against the wall beside it, of the same body: that leans on the shaft,
 * which does not go through it, and is felt; and all is silent.
 */
static void a_part_that_leans_on_it_is_felt(void)
{
    for (int i = 0; i < TISSUE_INTEGRATORS; i++) {
        struct tissue_def def = soft_needle_liver(tissue_integrators[i]);
        const dpt_body_settings gel = soft_needle_gel(15.0);
        struct soft_needle needle;
        double lengths[SOFT_NEEDLE_STRETCHES], jump = 0.0, last = 0.0;
        uint32_t most = 0;
        def.arrays = soft_needle_cells(is_angle);
        def.young = 1e4;
        def.spacing = SOFT_NEEDLE_CELL;
        def.floor = 0.005;
        if (!soft_needle_open(&needle, &def, &gel, STIFFNESS))
            return;
        needle.tool->device.position[0] = -0.004;
        needle.depth = 0.045;
        soft_needle_aim(&needle);
        tissue_rig_place(&needle.tissue);
        soft_needle_go(&needle, 0.07);
        CHECK(is_in(&needle) && soft_needle_channel(&needle).depth > 0.01, "%d: it is not in", i);
        for (int k = 0; k < 2500; k++) {
            needle.tool->device.position[0] -= k < 1000 ? 1.5e-5 : 0.0;
            const double force = soft_needle_tick(&needle);
            const uint32_t count = soft_needle_stretches(&needle, lengths);
            most = count > most ? count : most;
            jump = k > 2000 ? fmax(jump, fabs(force - last)) : 0.0;
            last = force;
        }
        const double aside = needle.tool->force.wrench.force[0];
        CHECK(most == 1 && is_in(&needle), "%d: the shaft goes through %u stretches", i, most);
        CHECK(aside > 0.3 && jump < 1e-3 * aside, "%d: %g N aside, a jump of %g N", i, aside, jump);
        soft_needle_close(&needle);
    }
}

static void what_goes_lets_it_go(void)
{
    for (int kind = 0; kind < 4; kind++) {
        struct soft_needle needle;
        if (!open_inside(&needle, DPT_INTEGRATOR_SYMPLECTIC, 0.02))
            return;
        dpt_world *world = needle.tissue.rig.world;
        dpt_pose pose;
        dpt_body_get_pose(world, needle.body->id, &pose);
        if (kind == 0) { /* the tool jumps */
            needle.depth = -0.01;
            soft_needle_aim(&needle);
            dpt_tool_teleport(world, needle.tool->id, &needle.tool->device);
        } else if (kind == 1) {
            CHECK(dpt_body_remove(world, needle.body->id) == DPT_OK, "not removed");
            needle.tissue.body_count = 0;
        } else if (kind == 2) { /* the body jumps */
            CHECK(dpt_body_teleport(world, needle.body->id, &pose) == DPT_OK, "no jump");
        } else {
            dpt_tool_remove(world, needle.tool->id);
            needle.tissue.tool_count = 0;
        }
        for (int i = 0; i < 200; i++) {
            tissue_rig_step_world(&needle.tissue);
            tissue_rig_step_springs(&needle.tissue);
        }
        if (kind < 3) {
            const uint32_t count = soft_needle_channels(&needle, NULL, 0);
            CHECK(!is_in(&needle) && axial(&needle) == 0.0, "%d: still in, %g N", kind, axial(&needle));
            CHECK(count == (kind == 0), "%d: %u holes", kind, count);
        }
        if (kind)
            fixture_free(&needle.tissue.body[0].mesh);
        soft_needle_close(&needle);
    }
}

/* The body sways, or beats as its owner moves its vertices: the needle goes along, and stays in its hole. */
static void bodies_that_move_take_it_along(void)
{
    for (int kind = 0; kind < 2; kind++) {
        struct soft_needle needle;
        static float rest[3 * TISSUE_ROOM], at[3 * TISSUE_ROOM];
        uint32_t count;
        double aside = 0.0, farthest = 0.0;
        if (!open_inside(&needle, DPT_INTEGRATOR_SYMPLECTIC, 0.025))
            return;
        memcpy(rest, tissue_vertices(&needle.tissue, needle.body, &count), sizeof *rest * 3 * TISSUE_ROOM / 2);
        tissue_vertices(&needle.tissue, needle.body, &count);
        const double depth = soft_needle_channel(&needle).depth;
        for (int i = 0; i < 2000; i++) {
            const double way = 0.004 * sin(i * 0.00628);
            if (kind == 0) {
                dpt_pose pose = DPT_POSE_IDENTITY;
                pose.position[0] = needle.body->place[0] = way;
                CHECK(dpt_body_set_pose(needle.tissue.rig.world, needle.body->id, &pose) == DPT_OK, "no pose");
                soft_needle_tick(&needle);
                needle.body->place[0] = 0.0;
            } else {
                for (uint32_t k = 0; k < 3 * count; k++)
                    at[k] =
                        (float)((double)rest[k] * (1.0 + (k % 3 == 2 ? 5.0 : -3.0) * way) + (k % 3 == 0 ? way : 0.0));
                dpt_body_set_vertices(needle.tissue.rig.world, needle.body->id, 0, count, at, -1.0);
                soft_needle_aim(&needle);
                tissue_rig_step_world(&needle.tissue);
                dpt_tool_get_force_info(needle.tissue.rig.world, needle.tool->id, &needle.tool->force);
            }
            CHECK(is_in(&needle) && !(needle.tool->force.flags & DPT_FORCE_FLAG_SQUEEZED), "%d: lost in tick %d", kind,
                  i);
            if (kind == 0)
                aside = fmax(aside, 0.0);
            farthest = fmax(farthest, fabs(soft_needle_channel(&needle).depth - depth));
        }
        CHECK(fabs(needle.tool->force.wrench.force[0]) + fabs(axial(&needle)) > 0.01, "%d: no force", kind);
        CHECK(farthest < 0.005, "%d: it came %g m out", kind, farthest);
        soft_needle_close(&needle);
    }
}

/* Budgets: what was pierced stays so, and nothing breaks. */
static void budgets_only_delay(void)
{
    for (int i = 0; i < 3; i++) {
        static const uint32_t budgets[] = { 100, 1000, 10000 };
        const struct tissue_def def = soft_needle_liver(DPT_INTEGRATOR_SYMPLECTIC);
        const dpt_body_settings gel = soft_needle_gel(15.0);
        struct soft_needle needle;
        if (!soft_needle_open_within(&needle, &def, &gel, STIFFNESS, budgets[i]))
            return;
        soft_needle_go(&needle, 0.04);
        CHECK(isfinite(axial(&needle)) && axial(&needle) > 0.2, "budget %u: %g N", budgets[i], axial(&needle));
        if (i)
            CHECK(is_in(&needle) && axial(&needle) < 1.0, "budget %u: %g N", budgets[i], axial(&needle));
        soft_needle_go(&needle, -0.003);
        CHECK(axial(&needle) == 0.0, "budget %u: still held", budgets[i]);
        soft_needle_close(&needle);
    }
}

/* How a needle came into the ball that it is pressed against, and rests on. */
struct pierced {
    dpt_channel channel; /* id 0: it did not */
    int waited;          /* ticks that are flagged as behind before it is in */
    uint32_t most;       /* units of a tick */
};

static struct pierced pierce_within(uint32_t budget)
{
    const struct tissue_def def = soft_needle_liver(DPT_INTEGRATOR_SYMPLECTIC);
    const dpt_body_settings gel = soft_needle_gel(15.0);
    struct pierced pierced = { .channel.id = 0 };
    struct soft_needle needle;
    if (!soft_needle_open_within(&needle, &def, &gel, STIFFNESS, budget))
        return pierced;
    soft_needle_hold(&needle, 100);
    for (int i = 0; i < 2000; i++) {
        dpt_world_info info = { .size = sizeof info };
        needle.depth += needle.depth < 0.0036 ? NEEDLE_SLOW : 0.0;
        soft_needle_tick(&needle);
        dpt_world_get_info(needle.tissue.rig.world, &info);
        pierced.most = info.work > pierced.most ? info.work : pierced.most;
        pierced.waited += !is_in(&needle) && (needle.tool->force.flags & DPT_FORCE_FLAG_BEHIND);
    }
    if (soft_needle_channels(&needle, NULL, 0))
        pierced.channel = soft_needle_channel(&needle);
    soft_needle_close(&needle);
    return pierced;
}

/*
 * Small budgets that hold the tip outside find the walls in the end, in some ticks, and again as the needle goes in. Others,
 * as 13, let it come inside where it first touches, as any tool.
 */
static void small_budgets_pierce(void)
{
    enum { INDIVISIBLE = 4 };
    static const uint32_t budgets[] = { 6, 10, 20 };
    const struct pierced whole = pierce_within(0);
    CHECK(whole.channel.id && !whole.waited, "it waits without a budget");
    for (int i = 0; i < 3; i++) {
        const uint32_t budget = budgets[i];
        const struct pierced part = pierce_within(budget);
        CHECK(part.channel.id && part.waited > 0 && part.most <= budget + INDIVISIBLE,
              "budget %u: %d ticks waited, %u units", budget, part.waited, part.most);
        CHECK(part.channel.ruptures == 1 && part.channel.layers == 1 &&
                  fabs(part.channel.depth - whole.channel.depth) < 0.1 * whole.channel.depth,
              "budget %u: %u ruptures, %g m in, not %g", budget, part.channel.ruptures, part.channel.depth,
              whole.channel.depth);
    }
}

/* Triangle by triangle another law, of three: a line that slides over the surface goes from one into the next. */
static void set_patchwork(const struct soft_needle *needle)
{
    static uint8_t of[TISSUE_ROOM];
    const dpt_body_region laws[2] = {
        { .size = sizeof *laws, .puncture_force = 0.2, .shaft_friction = 60.0, .shaft_viscosity = 30.0 },
        { .size = sizeof *laws, .puncture_force = 0.6, .cutting_force = 0.3, .shaft_friction = 2.0 }
    };
    dpt_mesh_info info = { .size = sizeof info };
    dpt_mesh_get_info(needle->body->mesh.mesh, &info);
    for (uint32_t i = 0; i < TISSUE_ROOM; i++)
        of[i] = (uint8_t)(i % 3);
    const dpt_result result =
        dpt_body_set_regions(needle->tissue.rig.world, needle->body->id, of, info.source_triangles, laws, 2);
    CHECK(result == DPT_OK, "regions: %s", dpt_result_name(result));
}

/* A hand with noise and delay on a device of quanta: the observer's account. */
static void nothing_gives_energy(void)
{
    for (int kind = 0; kind < (int)part_of(8); kind++) {
        const struct tissue_def def = soft_needle_liver(tissue_integrators[kind % 3]);
        dpt_body_settings gel = soft_needle_gel(15.0);
        dpt_passivity observer = { .size = sizeof observer };
        dpt_passivity_info info = { .size = sizeof info };
        dpt_passivity_def observed;
        dpt_wrench sent[3] = { { { 0.0 }, { 0.0 } } };
        struct soft_needle needle;
        uint64_t seed = 3 + (uint64_t)kind;
        const int delay = kind & 2 ? 1 : 0, ticks = kind & 1 ? 20000 : 8000;
        const double dt = kind & 1 ? 1e-4 : 1e-3, quantum = kind & 4 ? 2e-5 : 0.0, mass = 0.1, damping = 3.0;
        double at = -0.002, speed = 0.0, goal = 0.03;
        gel.shaft_viscosity = kind & 1 ? 10.0 : 0.0;
        gel.shaft_stiffness = kind & 2 ? 3e4 : 0.0;
        if (!soft_needle_open(&needle, &def, &gel, STIFFNESS))
            return;
        if (kind % 3 == 0)
            set_patchwork(&needle);
        needle.tissue.rig.dt = dt;
        dpt_passivity_def_init(&observed);
        observed.observe_only = 1;
        observed.damping = damping;
        observed.delay = delay * dt;
        CHECK(dpt_passivity_init(&observer, &observed) == DPT_OK, "observer");
        for (int i = 0; i < ticks; i++) {
            if (i % (ticks / 20) == 0)
                goal = random_in(&seed, -0.005, 0.07);
            needle.depth = quantum > 0.0 ? quantum * floor(at / quantum + 0.5) : at;
            needle.depth += random_in(&seed, -1e-6, 1e-6);
            soft_needle_tick(&needle);
            const dpt_passivity_sample sample = { .size = sizeof sample,
                                                  .dt = dt,
                                                  .energy = needle.tool->force.energy,
                                                  .body_work = needle.tool->force.body_work,
                                                  .pose = needle.tool->device,
                                                  .sent = sent[0] };
            dpt_wrench asked = sent[0] = needle.tool->force.wrench;
            CHECK(dpt_passivity_step(&observer, &sample, &asked) == DPT_OK, "not observed");
            sent[2] = sent[1];
            sent[1] = needle.tool->force.wrench;
            speed += (100.0 * (goal - at) - sent[1 + delay].force[2] - damping * speed) / mass * dt;
            at += speed * dt;
        }
        dpt_passivity_get_info(&observer, &info);
        CHECK(info.account_min >= -2.0 * info.eps, "kind %d: the account fell to %g, eps %g", kind, info.account_min,
              info.eps);
        CHECK(soft_needle_channels(&needle, NULL, 0) > 0, "kind %d: it was never in", kind);
        soft_needle_close(&needle);
    }
}

/* A scene that begins with the needle in. */
static void check_snapshot(const struct soft_needle *needle)
{
    const struct dpt_world *world = needle->tissue.rig.world;
    const size_t room = dpt_snapshot_bytes(world, NULL);
    const dpt_channel channel = soft_needle_channel(needle);
    dpt_snapshot_channel read = { .size = sizeof read };
    size_t bytes = 0;
    void *block = malloc(room);
    CHECK(block && dpt_world_take_snapshot(world, NULL, block, room, &bytes) == DPT_OK, "a snapshot");
    CHECK(block && dpt_snapshot_get_channel(block, bytes, 0, &read) == DPT_OK && read.id == channel.id &&
              read.ruptures == channel.ruptures && read.layers == 1 && read.depth == channel.depth &&
              read.inside == channel.inside && read.friction == channel.friction && read.tip == channel.tip &&
              !memcmp(read.entry, channel.entry, sizeof read.entry),
          "channel %u in the snapshot, %g m in", read.id, read.depth);
    free(block);
}

static void it_can_be_put_in(void)
{
    const struct tissue_def def = soft_needle_liver(DPT_INTEGRATOR_SYMPLECTIC);
    const dpt_body_settings gel = soft_needle_gel(15.0);
    struct soft_needle needle;
    if (!soft_needle_open(&needle, &def, &gel, STIFFNESS))
        return;
    needle.depth = 0.03;
    soft_needle_aim(&needle);
    dpt_tool_teleport(needle.tissue.rig.world, needle.tool->id, &needle.tool->device);
    const dpt_result result = dpt_tool_insert(needle.tissue.rig.world, needle.tool->id);
    CHECK(result == DPT_OK, "%s", dpt_result_name(result));
    soft_needle_hold(&needle, 100);
    const dpt_channel channel = soft_needle_channel(&needle);
    CHECK(is_in(&needle) && channel.depth > 0.02 && channel.ruptures == 1, "%g m in", channel.depth);
    CHECK(length3(needle.tool->force.wrench.force) < 1e-3, "%g N", length3(needle.tool->force.wrench.force));
    soft_needle_go(&needle, 0.035);
    CHECK(axial(&needle) > 0.3, "%g N", axial(&needle));
    check_snapshot(&needle);
    soft_needle_close(&needle);
}

/*
 * Physics of somebody else's: a ball that tells how far it gives way. The mean of its loads is what was felt. Where nothing
 * is cut, what holds the tip's own point is loaded only after it was made.
 */
static void others_physics_gets_the_loads(double cutting)
{
    const struct tissue_def def = { .shape = "sphere", .triangles = 512 };
    dpt_body_settings gel = soft_needle_gel(15.0);
    dpt_deformable_def deform;
    struct soft_needle needle;
    double felt = 0.0, got = 0.0, seconds;
    dpt_load loads[TISSUE_LOADS];
    uint32_t count = 0;
    if (!soft_needle_open_over(&needle, &def, STIFFNESS))
        return;
    dpt_deformable_def_init(&deform);
    deform.mesh = needle.body->mesh.mesh;
    deform.compliance = 0.002;
    deform.max_points = 64;
    needle.body->id = rig_add_deformable(&needle.tissue.rig, &deform);
    dpt_springs *none = NULL;
    dpt_world *world = needle.tissue.rig.world;
    gel.cutting_force = cutting;
    soft_needle_set_gel(&needle, needle.body, &gel);
    for (int i = 0; i < 2200; i++) {
        needle.depth += i < 1700 ? NEEDLE_SLOW : 0.0;
        soft_needle_aim(&needle);
        tissue_rig_step_world(&needle.tissue);
        const dpt_result result =
            dpt_bodies_step_springs(world, &needle.body->id, &none, 1, needle.tissue.rig.dt, NULL);
        CHECK(result == DPT_OK, "%s", dpt_result_name(result));
        dpt_tool_get_force_info(world, needle.tool->id, &needle.tool->force);
        felt += axial(&needle) / 2200.0;
    }
    const dpt_channel channel = soft_needle_channel(&needle);
    CHECK(is_in(&needle) && channel.depth > 0.02, "%g m in", channel.depth);
    CHECK(dpt_body_get_mean_loads(world, needle.body->id, loads, TISSUE_LOADS, &count, &seconds) == DPT_OK, "loads");
    for (uint32_t i = 0; i < count; i++)
        got -= loads[i].force[2];
    CHECK(felt > 0.1 + cutting && fabs(got - felt) < 1e-3 * felt, "%g N felt, %g got", felt, got);
    soft_needle_go(&needle, -0.003);
    soft_needle_close(&needle);
}

static void others_physics_gets_all_loads(void)
{
    others_physics_gets_the_loads(0.1);
    others_physics_gets_the_loads(0.0);
}

/* The same bits on all kernels. */
static void kernels_agree(void)
{
    static const uint32_t kernels[] = { DPT_KERNEL_SCALAR, DPT_KERNEL_AUTO };
    static dpt_force_info told[2][1500];
    for (int i = 0; i < 2; i++) {
        const struct tissue_def def = soft_needle_liver(DPT_INTEGRATOR_IMPLICIT);
        const dpt_body_settings gel = soft_needle_gel(15.0);
        struct soft_needle needle;
        if (!soft_needle_open_on(&needle, &def, &gel, STIFFNESS, kernels[i]))
            return;
        for (int k = 0; k < 1500; k++) {
            needle.depth += NEEDLE_SLOW;
            soft_needle_tick(&needle);
            told[i][k] = needle.tool->force;
        }
        CHECK(is_in(&needle), "it is not in");
        soft_needle_close(&needle);
    }
    CHECK(!memcmp(told[0], told[1], sizeof *told), "kernels differ");
}

int main(int argc, char **argv)
{
    take_percent(argc, argv);
    TEST(layers_come_in_order);
    TEST(a_hole_behind_is_found_again);
    TEST(a_part_that_leans_on_it_is_felt);
    TEST(what_goes_lets_it_go);
    TEST(bodies_that_move_take_it_along);
    TEST(budgets_only_delay);
    TEST(small_budgets_pierce);
    TEST(nothing_gives_energy);
    TEST(it_can_be_put_in);
    TEST(others_physics_gets_all_loads);
    TEST(kernels_agree);
    return check_report();
}
