/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A proxy under strain: small budgets, bodies that turn fast, many bodies, tools of many segments, meshes that are
 * large, tiny, far away or ill-shaped, other methods and kernels. Oracle: a brute force over all triangles of all
 * bodies at each tick. It cannot judge what lies between two ticks.
 *
 *     test_proxy_strain [PER CENT of the random cases = 100]
 */
#include "lib/rig.h"
#include "lib/solid.h"

static const dpt_segment needle = { { 0, 0, 0 }, { 0, 0, 0.08 }, 0.002 };

#define TOP 0.04

/* The gap of a rig's proxy to a mesh at a pose. */
static double gap_to(const struct rig *rig, const struct solid *solid, const dpt_pose *pose)
{
    double least = INFINITY;
    for (uint32_t s = 0; s < rig->count; s++) {
        double ends[6], local[6];
        rig_proxy_ends(rig, s, ends);
        pose_local(pose, ends, local);
        pose_local(pose, ends + 3, local + 3);
        least = fmin(least, oracle_brute(solid->brute, local, NULL) - rig->segments[s].radius);
    }
    return least;
}

/*
 * Within a budget the proxy stays where it was proven free, and its force is not lost. A tick spends no more than its
 * budget. At rest the answer becomes that of a world without a budget.
 */
static void press_within(const struct solid *solid, uint32_t budget, uint64_t seed)
{
    const dpt_pose origin = DPT_POSE_IDENTITY;
    struct rig bounded, whole;
    dpt_world_def def = rig_def(DPT_LAW_PROXY);
    double least = INFINITY;
    uint32_t most = 0;
    rig_open(&whole, &def, solid->mesh, &needle, 1);
    def.budget = budget;
    rig_open(&bounded, &def, solid->mesh, &needle, 1);
    double axis[3];
    random_unit(&seed, axis);
    pose_orient(&bounded.device, axis, 0.8);
    bounded.device.position[2] = (double)solid->place.high[2] + 0.03;
    dpt_tool_set_pose(bounded.world, bounded.tool, &bounded.device);
    for (int i = 0; i < 200; i++)
        dpt_world_step(bounded.world, RIG_DT, &bounded.step);
    dpt_tool_get_force_info(bounded.world, bounded.tool, &bounded.force);
    CHECK(bounded.force.reason == DPT_FORCE_FREE, "%s, budget %u: reason %u", solid->name, budget,
          bounded.force.reason);
    for (uint64_t i = 0; i < 700; i++) {
        for (int k = 0; k < 3; k++)
            bounded.device.position[k] += random_in(&seed, -2e-5, 2e-5);
        if (i < 400)
            bounded.device.position[2] -= 1.5e-4;
        else
            bounded.device.position[0] += 1e-4;
        rig_step(&bounded);
        most = bounded.step.work > most ? bounded.step.work : most;
        least = fmin(least, gap_to(&bounded, solid, &origin));
        CHECK(!(bounded.force.flags & DPT_FORCE_FLAG_SQUEEZED) && bounded.force.reason <= DPT_FORCE_FREE,
              "%s, budget %u, tick %llu: reason %u, flags %u", solid->name, budget, (unsigned long long)i,
              bounded.force.reason, bounded.force.flags);
    }
    for (int i = 0; i < 4000; i++)
        rig_step(&bounded);
    CHECK(least > 0, "%s, budget %u: gap %g", solid->name, budget, least);
    CHECK(bounded.force.lag < 0.002 * apart(bounded.device.position, bounded.proxy.position) + 1e-7,
          "%s, budget %u: at rest it lags by %g of %g", solid->name, budget, bounded.force.lag,
          apart(bounded.device.position, bounded.proxy.position));
    dpt_world_info usage = { .size = sizeof usage };
    dpt_world_get_info(bounded.world, &usage);
    CHECK(most <= budget && usage.work <= budget, "%s, budget %u: %u units", solid->name, budget, most);
    printf("    %s: budget %u, worst tick %u units, gap %.3g, at rest %s\n", solid->name, budget, most, least,
           bounded.step.status == DPT_STATUS_EXACT ? "exact" : "bounded");
    rig_close(&bounded);
    rig_close(&whole);
}

static void budgets_bound_the_tick_and_lose_nothing(void)
{
    static const char *const names[] = { "liver", "star", "torus" };
    static const uint32_t budgets[] = { 3000, 400, 100 };
    for (size_t i = 0; i < 3; i++) {
        struct solid solid;
        if (!solid_from_shape(&solid, names[i], i == 2 ? 4096 : 8000))
            continue;
        for (size_t k = 0; k < 3; k++)
            for (uint64_t seed = 1; seed <= part_of(3); seed++)
                press_within(&solid, budgets[k], seed);
        solid_close(&solid);
    }
}

/* Of several tools none takes all of the budget. */
static void tools_share_a_budget(void)
{
    enum { TOOLS = 4 };
    struct solid box;
    dpt_world_def def = rig_def(DPT_LAW_PROXY);
    dpt_tool tools[TOOLS];
    dpt_pose poses[TOOLS];
    struct rig rig;
    if (!solid_from_shape(&box, "box", 20172))
        return;
    def.budget = 100;
    rig_open(&rig, &def, box.mesh, &needle, 1);
    tools[0] = rig.tool;
    for (int t = 0; t < TOOLS; t++) {
        if (t)
            dpt_tool_add(rig.world, &needle, 1, &tools[t]);
        poses[t] = rig.device;
        poses[t].position[0] = 0.02 * (t - 1.5);
        poses[t].position[2] = TOP + 0.01;
        dpt_tool_teleport(rig.world, tools[t], &poses[t]);
    }
    for (int i = 0; i < 200; i++)
        dpt_world_step(rig.world, RIG_DT, NULL);
    for (int i = 0; i < 3000; i++) {
        for (int t = 0; t < TOOLS; t++) {
            poses[t].position[1] = 0.03 * sin(0.005 * i);
            if (i < 150)
                poses[t].position[2] -= 1e-4;
            dpt_tool_set_pose(rig.world, tools[t], &poses[t]);
        }
        dpt_world_step(rig.world, RIG_DT, &rig.step);
        CHECK(rig.step.work <= def.budget, "tick %d: %u units", i, rig.step.work);
        for (int t = 0; t < TOOLS; t++) {
            dpt_pose proxy;
            dpt_tool_get_proxy(rig.world, tools[t], &proxy);
            const double behind = fabs(proxy.position[1] - poses[t].position[1]);
            CHECK(behind < 0.025, "tick %d: tool %d is %g m behind its device", i, t, behind);
        }
    }
    rig_close(&rig);
    solid_close(&box);
}

/*
 * A body that turns and shakes under a tool that is held pushes it away, and never enters it; there is always room,
 * so it is never squeezed.
 */
static int shake(const struct solid *solid, double speed, uint32_t budget, uint64_t seed)
{
    struct rig rig;
    dpt_world_def def = rig_def(DPT_LAW_PROXY);
    dpt_pose pose = DPT_POSE_IDENTITY;
    double axis[3], least = INFINITY;
    int acts = 0, squeezed = 0;
    def.budget = budget;
    rig_open(&rig, &def, solid->mesh, &needle, 1);
    random_unit(&seed, axis);
    rig.device.position[0] = 0.6 * (double)solid->place.high[0];
    rig.device.position[2] = 0.5 * (double)solid->place.high[2];
    pose.position[2] = -0.2;
    dpt_body_set_pose(rig.world, rig.body, &pose);
    for (int i = 0; i < 20; i++)
        rig_step(&rig);
    CHECK(rig.force.reason == DPT_FORCE_FREE, "%s: reason %u", solid->name, rig.force.reason);
    double angle = 0;
    for (uint64_t i = 0; i < 800; i++) {
        angle += speed * (1 + 0.5 * sin(0.05 * (double)i));
        pose.position[2] = i < 200 ? -0.2 + 1e-3 * (double)i : 0;
        pose.position[0] = 0.01 * sin(0.02 * (double)i);
        pose_orient(&pose, axis, angle);
        dpt_body_set_pose(rig.world, rig.body, &pose);
        rig_step(&rig);
        least = fmin(least, gap_to(&rig, solid, &pose));
        acts += rig.force.reason == DPT_FORCE_ACTS;
        squeezed += (rig.force.flags & DPT_FORCE_FLAG_SQUEEZED) != 0;
        /* Turned away by too much it starts again, perhaps inside. */
        if (rig.force.flags & DPT_FORCE_FLAG_REPLACED)
            break;
    }
    CHECK(!squeezed, "%s, %g rad a tick, budget %u: squeezed on %d ticks", solid->name, speed, budget, squeezed);
    CHECK(least > 0 || rig.force.flags & DPT_FORCE_FLAG_REPLACED, "%s, %g rad a tick: gap %g", solid->name, speed,
          least);
    rig_close(&rig);
    return acts;
}

static void a_body_that_turns_fast_pushes(void)
{
    static const char *const names[] = { "star", "torus", "liver", "box" };
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        struct solid solid;
        if (!solid_from_shape(&solid, names[i], i == 3 ? 300 : i == 2 ? 2000 : 2048))
            continue;
        int acts = 0;
        for (uint64_t seed = 1; seed <= part_of(4); seed++) {
            acts += shake(&solid, 0.002, 0, seed);
            acts += shake(&solid, 0.02, 0, seed);
            acts += shake(&solid, 0.2, 0, seed);
            acts += shake(&solid, 0.02, 200, seed);
        }
        CHECK(acts > 100, "%s: only %d ticks with a force", solid.name, acts);
        solid_close(&solid);
    }
}

/* Thirty boxes, of which some move: none is missed, whatever the lists of near bodies hold. */
static void among_many(uint32_t budget, uint32_t method)
{
    enum { BODIES = 30 };
    struct solid box;
    struct rig rig;
    dpt_world_def def = rig_def(DPT_LAW_PROXY);
    dpt_body bodies[BODIES];
    dpt_pose poses[BODIES];
    uint64_t seed = 3, acts = 0, squeezed = 0;
    double least = INFINITY;
    if (!solid_from_shape(&box, "box", 12))
        return;
    def.max_bodies = BODIES;
    def.budget = budget;
    def.method = method;
    rig_open(&rig, &def, NULL, &needle, 1);
    for (int b = 0; b < BODIES; b++) {
        poses[b] = rig.device;
        poses[b].position[0] = 0.2 * (b % 6 - 2.5);
        poses[b].position[1] = 0.2 * (b / 6 - 2.0);
        dpt_body_add(rig.world, box.mesh, &poses[b], &bodies[b]);
    }
    rig.device.position[2] = 0.2;
    rig_place(&rig);
    double aim[3] = { 0, 0, 0.2 };
    for (uint64_t i = 0; i < part_of(4000); i++) {
        for (int b = 0; b < BODIES; b += 3) {
            poses[b].position[2] = 0.05 * sin(0.05 * (double)i + b);
            pose_orient(&poses[b], (const double[3]){ 0, 0, 1 }, 0.03 * (double)i);
            dpt_body_set_pose(rig.world, bodies[b], &poses[b]);
        }
        if (i % 300 == 0)
            for (int k = 0; k < 3; k++)
                aim[k] = random_in(&seed, -0.4, 0.4) * (k == 2 ? 0.1 : 1);
        for (int k = 0; k < 3; k++)
            rig.device.position[k] += fmax(-3e-3, fmin(3e-3, 0.05 * (aim[k] - rig.device.position[k])));
        rig_step(&rig);
        acts += rig.force.reason == DPT_FORCE_ACTS;
        squeezed += (rig.force.flags & DPT_FORCE_FLAG_SQUEEZED) != 0;
        CHECK(rig.force.reason <= DPT_FORCE_FREE || rig.force.reason == DPT_FORCE_INSIDE, "reason %u",
              rig.force.reason);
        for (int b = 0; b < BODIES && rig.force.reason <= DPT_FORCE_FREE; b++)
            least = fmin(least, gap_to(&rig, &box, &poses[b]));
    }
    CHECK(least > 0, "budget %u, method %u: gap %g", budget, method, least);
    CHECK(acts > least_seen(500), "only %llu ticks with a force", (unsigned long long)acts);
    /* Between two that close on it at 2 m/s no way out is found now and then; with a small budget more often. */
    CHECK(squeezed <= (budget ? part_of(4000) / 100 + 4 : 4), "budget %u: squeezed on %llu ticks", budget,
          (unsigned long long)squeezed);
    rig_close(&rig);
    solid_close(&box);
}

static void among_many_bodies_none_is_missed(void)
{
    among_many(0, DPT_METHOD_EXACT);
    among_many(400, DPT_METHOD_EXACT);
    among_many(0, DPT_METHOD_TREE);
    among_many(0, DPT_METHOD_BRUTE);
}

/* A comb of many teeth: each is felt, also those beyond what can be looked at together. */
static void every_segment_of_many_is_felt(void)
{
    enum { TEETH = 60 };
    const dpt_segment handle = { { 0, 0, 0.02 }, { 0, 0, 0.05 }, 0.001 };
    struct solid box;
    if (!solid_from_shape(&box, "box", 300))
        return;
    for (int longest = 0; longest < TEETH; longest += 7) {
        dpt_segment teeth[TEETH];
        dpt_world_def def = rig_def(DPT_LAW_PROXY);
        dpt_tool tool;
        struct rig rig;
        def.max_segments = TEETH + 1;
        rig_open(&rig, &def, box.mesh, &handle, 1);
        for (int t = 0; t < TEETH; t++) {
            const double x = 0.05 * (t - 0.5 * TEETH) / TEETH;
            teeth[t] = (dpt_segment){ { x, 0, t == longest ? 0 : 0.004 }, { x, 0, 0.02 }, 3e-4 };
        }
        dpt_tool_add(rig.world, teeth, TEETH, &tool);
        dpt_tool_remove(rig.world, rig.tool);
        rig.tool = tool;
        rig.device.position[2] = TOP + 0.002;
        rig_place(&rig);
        for (int i = 0; i < 40; i++) {
            rig.device.position[2] -= 1e-4;
            rig.device.position[0] += 2e-5;
            rig_step(&rig);
            double low[3];
            turn3(rig.proxy.orientation, teeth[longest].a, low);
            CHECK(low[2] + rig.proxy.position[2] > TOP + 3e-4, "tooth %d, tick %d: at %g", longest, i,
                  low[2] + rig.proxy.position[2] - TOP);
        }
        CHECK(rig.force.reason == DPT_FORCE_ACTS && rig.force.wrench.force[2] > 0.3 && rig.force.lag < 1e-5,
              "tooth %d: reason %u, %g N, lag %g", longest, rig.force.reason, rig.force.wrench.force[2], rig.force.lag);
        rig_close(&rig);
    }
    solid_close(&box);
}

/* On every kernel the same bits. */
static void kernels_give_the_same_bits(void)
{
    const uint32_t best = dpt_kernel_best();
    struct solid star;
    struct rig rigs[2];
    dpt_world_def def;
    uint64_t seed = 4, acts = 0;
    if (best == DPT_KERNEL_SCALAR) {
        SKIP("kernels_give_the_same_bits", "this machine has one kernel");
        return;
    }
    if (!solid_from_shape(&star, "star", 4000))
        return;
    for (uint32_t budget = 0; budget <= 600; budget += 600) {
        dpt_world_def_init(&def);
        def.max_contacts = 32;
        def.budget = budget;
        for (int k = 0; k < 2; k++) {
            def.kernel = k ? best : DPT_KERNEL_SCALAR;
            rig_open(&rigs[k], &def, star.mesh, &needle, 1);
            rigs[k].device.position[2] = 0.17;
            rig_place(&rigs[k]);
        }
        for (uint64_t i = 0; i < 1500; i++) {
            dpt_pose pose = DPT_POSE_IDENTITY;
            pose_orient(&pose, (const double[3]){ 0.6, 0, 0.8 }, 3e-4 * (double)i);
            rigs[0].device.position[0] += random_in(&seed, -1e-4, 1e-4);
            rigs[0].device.position[2] -= i < 1000 ? 1e-4 : 0;
            rigs[1].device = rigs[0].device;
            for (int k = 0; k < 2; k++) {
                dpt_body_set_pose(rigs[k].world, rigs[k].body, &pose);
                rig_step(&rigs[k]);
            }
            acts += rigs[0].force.reason == DPT_FORCE_ACTS;
            CHECK(!memcmp(&rigs[0].force, &rigs[1].force, sizeof rigs[0].force) &&
                      !memcmp(&rigs[0].proxy, &rigs[1].proxy, sizeof rigs[0].proxy) &&
                      rigs[0].step.work == rigs[1].step.work,
                  "budget %u, tick %llu differs", budget, (unsigned long long)i);
        }
        for (int k = 0; k < 2; k++)
            rig_close(&rigs[k]);
    }
    CHECK(acts > 500, "only %llu ticks with a force", (unsigned long long)acts);
    solid_close(&star);
}

/* A box of any size, at any place that is allowed, is felt as another. */
static void size_and_place_do_not_matter(void)
{
    static const struct {
        double scale, far;
    } cases[] = { { 1, 0 },   { 1, 1e3 },   { 1, 1e5 },   { 1e-2, 0 }, { 1e-2, 1e3 },
                  { 1e2, 0 }, { 1e2, 1e5 }, { 1e4, 1e5 }, { 5e5, 0 } };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const double scale = cases[i].scale;
        struct solid box;
        struct rig rig;
        struct shape shape;
        shape_reason reason;
        if (shape_make("box", 300, 0, &shape, reason))
            return;
        for (size_t k = 0; k < 3 * shape.vertex_count; k++)
            shape.vertices[k] *= scale;
        const int opened =
            solid_from_arrays(&box, "box", shape.vertices, shape.vertex_count, shape.corners, shape.triangle_count);
        shape_free(&shape);
        if (!opened)
            return;
        dpt_segment tool = needle;
        tool.b[2] *= fmin(scale, 1);
        tool.radius *= fmin(scale, 1);
        const double unit = fmin(scale, 1);
        rig_open(&rig, NULL, box.mesh, &tool, 1);
        dpt_pose pose = DPT_POSE_IDENTITY;
        pose.position[0] = cases[i].far;
        pose.position[1] = -cases[i].far;
        dpt_body_set_pose(rig.world, rig.body, &pose);
        memcpy(rig.device.position, pose.position, sizeof pose.position);
        const double top = (double)(float)(TOP * scale);
        rig.device.position[2] = top + tool.radius + 0.001 * unit;
        rig_place(&rig);
        for (int k = 0; k < 60; k++) {
            rig.device.position[2] -= 1e-4 * unit;
            rig.device.position[0] += 1e-4 * unit;
            rig_step(&rig);
            double ends[6];
            rig_proxy_ends(&rig, 0, ends);
            CHECK(ends[2] > top + tool.radius, "scale %g at %g, tick %d: end at %g", scale, cases[i].far, k,
                  ends[2] - top - tool.radius);
        }
        const double expected = RIG_STIFFNESS * 0.005 * unit;
        CHECK(fabs(rig_force(&rig) / expected - 1) < 0.01, "scale %g at %g: %g N, not %g, flags %u", scale,
              cases[i].far, rig_force(&rig), expected, rig.force.flags);
        rig_close(&rig);
        solid_close(&box);
    }
}

/* Slivers, doubled faces, crossing triangles: nothing is entered, nothing is stuck, all numbers are finite. */
static void prod(struct solid *solid, const dpt_segment *segment, uint64_t seed)
{
    const dpt_pose origin = DPT_POSE_IDENTITY;
    struct rig rig;
    double least = INFINITY;
    uint64_t acts = 0;
    rig_open(&rig, NULL, solid->mesh, segment, 1);
    rig.device.position[2] = 0.25;
    rig_place(&rig);
    for (uint64_t i = 0; i < 1500; i++) {
        rig.device.position[0] = 0.05 * sin(0.004 * (double)i);
        rig.device.position[1] = 0.05 * cos(0.003 * (double)i);
        rig.device.position[2] = 0.12 + 0.13 * cos(0.006 * (double)i);
        for (int k = 0; k < 3; k++)
            rig.device.position[k] += random_in(&seed, -2e-5, 2e-5);
        rig_step(&rig);
        /* A tool that the device turns by 1 rad among crossing triangles begins again there. */
        if (rig.force.flags & DPT_FORCE_FLAG_REPLACED)
            break;
        acts += rig.force.reason == DPT_FORCE_ACTS;
        CHECK(rig.force.reason <= DPT_FORCE_FREE && !(rig.force.flags & DPT_FORCE_FLAG_SQUEEZED),
              "%s, tick %llu: reason %u, flags %u", solid->name, (unsigned long long)i, rig.force.reason,
              rig.force.flags);
        CHECK(isfinite(rig_force(&rig) + rig.force.lag + rig.force.energy), "%s: not finite", solid->name);
        least = fmin(least, gap_to(&rig, solid, &origin));
    }
    rig.device.position[2] = 0.5;
    for (int i = 0; i < 700; i++)
        rig_step(&rig);
    CHECK(!memcmp(&rig.proxy, &rig.device, sizeof rig.proxy), "%s: %g m from its device", solid->name,
          apart(rig.proxy.position, rig.device.position));
    CHECK(least > 0, "%s: gap %g", solid->name, least);
    CHECK(acts > 50, "%s: only %llu ticks with a force", solid->name, (unsigned long long)acts);
    rig_close(&rig);
}

static void hostile_meshes_hold(void)
{
    enum { TRIANGLES = 300 };
    const dpt_segment line = { { 0, 0, 0 }, { 0, 0, 0.06 }, 0 };
    static double vertices[9 * TRIANGLES];
    static uint32_t corners[3 * TRIANGLES];
    for (uint64_t kind = 0; kind < 3; kind++) {
        static const char *const names[] = { "slivers", "doubled", "soup" };
        struct solid solid;
        uint64_t seed = 20 + kind;
        for (uint32_t t = 0; t < TRIANGLES; t++)
            for (uint32_t k = 0; k < 9; k++) {
                const uint32_t c = k / 3;
                double x = random_in(&seed, -0.1, 0.1);
                /* Long and thin ones, in one plane; each twice, off by a micrometre; anywhere. */
                if (kind == 0)
                    x = k % 3 == 2   ? 0.0
                        : k % 3 == 1 ? -0.1 + 0.2 * (t + 0.01 * c) / TRIANGLES
                        : c == 1     ? 0.1
                                     : -0.1 - 1e-6 * c;
                else if (kind == 1 && t % 2)
                    x = vertices[9 * (t - 1) + k] + (k % 3 == 2 ? 1e-6 : 0);
                else if (kind == 1)
                    x *= k % 3 == 2 ? 0.1 : 1;
                vertices[9 * t + k] = x;
                corners[3 * t + c] = 3 * t + c;
            }
        if (!solid_from_arrays(&solid, names[kind], vertices, 3 * TRIANGLES, corners, TRIANGLES))
            continue;
        for (uint64_t i = 0; i < part_of(4); i++) {
            prod(&solid, &needle, i);
            if (kind)
                prod(&solid, &line, i);
        }
        solid_close(&solid);
    }
}

/* A trial begins at the device, tells what a step would, and changes nothing. */
static void a_trial_changes_nothing(void)
{
    struct solid liver;
    struct rig tried, other;
    if (!solid_from_shape(&liver, "liver", 2000))
        return;
    rig_open(&tried, NULL, liver.mesh, &needle, 1);
    rig_open(&other, NULL, liver.mesh, &needle, 1);
    tried.device.position[2] = other.device.position[2] = (double)liver.place.high[2] + 0.01;
    rig_place(&tried);
    rig_place(&other);
    for (int i = 0; i < 500; i++) {
        dpt_sweep sweep = { .size = sizeof sweep };
        dpt_pose to = tried.device, reached;
        to.position[2] -= 0.2;
        dpt_tool_try_pose(tried.world, tried.tool, &to, 0, &sweep, &reached);
        CHECK(sweep.status == DPT_SWEEP_HIT, "tick %d: %u", i, sweep.status);
        tried.device.position[2] -= 1e-4;
        other.device = tried.device;
        rig_step(&tried);
        rig_step(&other);
        CHECK(!memcmp(&tried.force, &other.force, sizeof tried.force), "tick %d differs", i);
    }
    CHECK(tried.force.reason == DPT_FORCE_ACTS, "reason %u", tried.force.reason);
    rig_close(&tried);
    rig_close(&other);
    solid_close(&liver);
}

int main(int argc, char **argv)
{
    take_percent(argc, argv);
    TEST(budgets_bound_the_tick_and_lose_nothing);
    TEST(tools_share_a_budget);
    TEST(a_body_that_turns_fast_pushes);
    TEST(among_many_bodies_none_is_missed);
    TEST(every_segment_of_many_is_felt);
    TEST(kernels_give_the_same_bits);
    TEST(size_and_place_do_not_matter);
    TEST(hostile_meshes_hold);
    TEST(a_trial_changes_nothing);
    return check_report();
}
