/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Contact solved with the tissue's step. Oracles: the conditions of the problem, by brute force over the surface after the
 * step, with the tool where the felt wrench says that its spring ends; springs that are stepped by hand with the loads
 * that were told; and sums of forces. How stiff the tissue is is not judged here.
 */
#include <math.h>

#include "deform/spring_state.h"
#include "mesh/mesh_format.h"
#include "oracle/brute.h"
#include "world/tissue_scene.h"

enum { INTEGRATORS = 3 };
static const uint32_t integrators[INTEGRATORS] = { DPT_INTEGRATOR_SYMPLECTIC, DPT_INTEGRATOR_EULER,
                                                   DPT_INTEGRATOR_IMPLICIT };

static void a_still_device_is_silent(void)
{
    static const double leans[] = { 0.0, 0.6, 1.2, 1.5708 };
    for (int kind = 0; kind < 2; kind++)
        for (int i = 0; i < (int)part_of(24); i++) {
            const uint32_t integrator = integrators[i % 3];
            const double stiffness = i & 1 ? 2000.0 : 200.0, lean = leans[i / 6];
            struct tissue tissue;
            double mean;
            tissue_begin(&tissue, stiffness, lean);
            if (tissue_add(&tissue, kind ? DPT_NET_SHEET : DPT_NET_VOLUME, integrator, 0.0, 0.0)) {
                const double jump = tissue_press_and_hold(&tissue, 0.006, &mean);
                CHECK(mean > 1e-3, "case %d: it is not touched: %g N", i, mean);
                CHECK(jump <= fmax(1e-3 * mean, 1e-4), "case %d: jumps of %g N at %g N", i, jump, mean);
                CHECK(!(tissue.force.flags & (DPT_FORCE_FLAG_APART | DPT_FORCE_FLAG_CROWDED)), "case %d: flags %u", i,
                      tissue.force.flags);
            }
            tissue_close(&tissue);
        }
}

/*
 * A light sheet under a tool twice as thick as its edges are long: many nodes hold it, and what one of them takes over from
 * another moves all of them.
 */
static void implicit_light_sheets_are_silent(void)
{
    for (int i = 0; i < (int)part_of(6); i++) {
        struct tissue tissue;
        double mean;
        tissue_begin_thin(&tissue, i & 1 ? 2000.0 : 667.0, 1.5708 - 0.1 * (i / 2), 0.012);
        tissue.triangles = 2048;
        if (tissue_add(&tissue, DPT_NET_SHEET, DPT_INTEGRATOR_IMPLICIT, 0.0, 0.0)) {
            const double jump = tissue_press_and_hold(&tissue, 0.025, &mean);
            CHECK(mean > 1e-3, "case %d: it is not touched: %g N", i, mean);
            CHECK(jump <= 1e-4, "case %d: jumps of %g N at %g N", i, jump, mean);
        }
        tissue_close(&tissue);
    }
}

/* Loads that are spread over some edges of 12 mm, on a sheet of which that is a fifth, too. */
static void spread_loads_are_silent(void)
{
    static const double leans[] = { 0.0, 0.6, 1.2, 1.5708 }, radii[] = { 0.015, 0.03 };
    for (int kind = 0; kind < 2; kind++)
        for (int i = 0; i < (int)part_of(24); i++) {
            struct tissue tissue;
            double mean;
            tissue_begin(&tissue, i & 1 ? 2000.0 : 200.0, leans[i / 6]);
            if (tissue_add(&tissue, kind ? DPT_NET_SHEET : DPT_NET_VOLUME, integrators[i % 3], radii[i / 3 % 2], 0.0)) {
                const double jump = tissue_press_and_hold(&tissue, 0.006, &mean);
                CHECK(mean > 1e-3, "case %d: it is not touched: %g N", i, mean);
                CHECK(jump <= fmax(1e-3 * mean, 1e-4), "case %d: jumps of %g N at %g N", i, jump, mean);
            }
            tissue_close(&tissue);
        }
}

/* Where the patch spans three edges, a sheet feels alike when its edges are halved. */
static void a_finer_sheet_feels_alike(void)
{
    for (int lying = 0; lying < 2; lying++) {
        double force[2] = { 0.0, 0.0 };
        for (int fine = 0; fine < 2; fine++) {
            struct tissue tissue;
            tissue_begin_thin(&tissue, 500.0, 1.5708 * lying, 0.006);
            tissue.triangles = fine ? 2048 : 512;
            if (tissue_add(&tissue, DPT_NET_SHEET, DPT_INTEGRATOR_IMPLICIT, 0.04, 0.0))
                tissue_press_and_hold(&tissue, 0.02, &force[fine]);
            tissue_close(&tissue);
        }
        CHECK(force[0] > 0.05, "%g N", force[0]);
        CHECK(fabs(force[1] - force[0]) <= 0.05 * force[0], "case %d: %g N, %g N on a finer mesh", lying, force[0],
              force[1]);
    }
}

/* What the tests above look for is there without the solve: loads of the step before make a lying tool jump. */
static void loads_of_the_step_before_are_not_silent(void)
{
    struct tissue tissue;
    double mean, jump = 0.0;
    tissue_begin(&tissue, 2000.0, 1.5708);
    tissue.period = 1e-6;
    if (tissue_add(&tissue, DPT_NET_VOLUME, DPT_INTEGRATOR_SYMPLECTIC, 0.0, 0.0))
        jump = tissue_press_and_hold(&tissue, 0.006, &mean);
    tissue_close(&tissue);
    CHECK(jump > 5e-3, "it jumps by no more than %g N", jump);
}

/* The force at rest is the tissue's, whatever integrator and step: IMPLICIT beside SYMPLECTIC at 1 ms. */
static void integrators_end_at_one_force(void)
{
    static const double steps[] = { 1e-3, 1e-4, 1e-3, 1e-2 };
    for (int lean = 0; lean < (int)part_of(4); lean++) {
        double expected = 0.0;
        for (int i = 0; i < 1 + (int)part_of(3); i++) {
            struct tissue tissue;
            double jump = 0.0, mean = 0.0;
            tissue_begin(&tissue, 2000.0, 0.5236 * lean);
            tissue.is_sleepless = 1;
            tissue.rig.dt = steps[i];
            if (tissue_add(&tissue, DPT_NET_VOLUME, integrators[i ? 2 : 0], 0.0, 0.0))
                jump = tissue_press_and_hold(&tissue, 0.006, &mean);
            for (int t = 0; t < 4000 && mean > 0.0; t++)
                mean = tissue_tick(&tissue);
            tissue_close(&tissue);
            expected = i ? expected : mean;
            CHECK(jump <= 1e-3 * mean, "lean %d, %g s: jumps of %g N", lean, steps[i], jump);
            CHECK(mean > 0.1 && fabs(mean - expected) <= 0.01 * expected, "lean %d, %g s: %g N for %g", lean, steps[i],
                  mean, expected);
        }
    }
}

/* With IMPLICIT energy never exceeds the work of the loads that are told, nor what its account has proven. */
static void implicit_tissue_gains_what_tools_do(void)
{
    enum { NODES = 4096, LOADS = 1024 };
    static float from[3 * NODES], to[3 * NODES];
    static dpt_load loads[LOADS];
    for (int i = 0; i < (int)part_of(6); i++) {
        const double h = (const double[]){ 1e-4, 1e-3, 1e-2 }[i % 3];
        struct tissue tissue;
        uint64_t seed = 5 + (uint64_t)i;
        double work = 0.0, excess = -HUGE_VAL, unproven = -HUGE_VAL, most = 0.0;
        tissue_begin(&tissue, i % 2 ? 2000.0 : 300.0, 0.3 * i);
        tissue.is_sleepless = tissue.is_undamped = 1;
        tissue.rig.dt = h;
        if (tissue_add(&tissue, i < 3 ? DPT_NET_VOLUME : DPT_NET_SHEET, DPT_INTEGRATOR_IMPLICIT, 0.0, 0.0)) {
            const uint32_t nodes = dpt_springs_get_count(tissue.springs[0]);
            CHECK(nodes <= NODES, "%u nodes", nodes);
            tissue_place(&tissue, -0.001);
            rig_place(&tissue.rig);
            dpt_springs_get_nodes(tissue.springs[0], nodes, from, NULL);
            for (int t = 0; t < 2000; t++) {
                double elastic, kinetic;
                uint32_t count = 0;
                /* Up and down, in leaps, and off it now and then. */
                tissue_place(&tissue, 0.004 * sin(0.02 * t) + random_in(&seed, -2e-3, 2e-3));
                tissue_tick(&tissue);
                (i < 3 ? dpt_body_get_node_loads : dpt_body_get_loads)(tissue.rig.world, tissue.body[0], loads, LOADS,
                                                                       &count);
                dpt_springs_get_nodes(tissue.springs[0], nodes, to, NULL);
                for (uint32_t l = 0; l < count; l++)
                    for (uint32_t k = 0; k < 3; k++)
                        work += loads[l].force[k] *
                                ((double)to[3 * loads[l].vertex + k] - (double)from[3 * loads[l].vertex + k]);
                memcpy(from, to, sizeof from);
                dpt_springs_get_energy(tissue.springs[0], &elastic, &kinetic);
                excess = fmax(excess, elastic + kinetic - work);
                unproven = fmax(unproven, elastic + kinetic - tissue.springs[0]->solve.account);
                most = fmax(most, elastic + kinetic);
            }
            CHECK(most > 1e-6 && excess <= 1e-8 && unproven <= 1e-8,
                  "case %d: %g J: %g more than the work, %g than proven", i, most, excess, unproven);
        }
        tissue_close(&tissue);
    }
}

/* Where the tool would be for its spring to give the wrench that is felt. */
static void end_of_spring(const struct tissue *tissue, double stiffness, double ends[6])
{
    const dpt_segment *segment = &tissue->rig.segments[0];
    double middle[3], arm[3], torque[3], axis[3], turned[3];
    pose_ends(&tissue->rig.device, segment, ends);
    for (int k = 0; k < 3; k++) {
        middle[k] = 0.5 * (ends[k] + ends[3 + k]);
        arm[k] = tissue->rig.device.position[k] - middle[k];
        axis[k] = 0.5 * (ends[3 + k] - ends[k]);
    }
    cross3(arm, tissue->wrench.force, torque);
    for (int k = 0; k < 3; k++)
        torque[k] += tissue->wrench.torque[k];
    const double rho2 = dot3(axis, axis) / 3.0, angle = length3(torque) / (stiffness * rho2);
    double turn[4] = { cos(0.5 * angle), 0.0, 0.0, 0.0 };
    for (int k = 0; k < 3 && angle > 0.0; k++)
        turn[1 + k] = sin(0.5 * angle) * torque[k] / length3(torque);
    turn3(turn, axis, turned);
    for (int k = 0; k < 3; k++) {
        middle[k] += tissue->wrench.force[k] / stiffness;
        ends[k] = middle[k] - turned[k];
        ends[3 + k] = middle[k] + turned[k];
    }
}

/* The surface after the step, for the oracle. */
static oracle_mesh *surface_now(const struct tissue *tissue)
{
    const struct dpt_mesh *mesh = tissue->mesh[0].mesh;
    const float *positions = NULL;
    uint32_t count = 0;
    dpt_body_get_vertices(tissue->rig.world, tissue->body[0], &positions, &count);
    return oracle_brute_open(positions, count, mesh_words(mesh, MESH_TRIANGLES), mesh->triangles);
}

static void the_tool_ends_on_the_surface(void)
{
    uint64_t seed = 7;
    for (int i = 0; i < (int)part_of(12); i++) {
        const uint32_t integrator = i < 6 ? DPT_INTEGRATOR_IMPLICIT : DPT_INTEGRATOR_SYMPLECTIC;
        const double stiffness = i % 2 ? 1500.0 : 300.0;
        struct tissue tissue;
        uint32_t touched = 0;
        double deepest = 0.0, farthest = 0.0, x = 0.0, y = 0.0;
        tissue_begin(&tissue, stiffness, 0.3 * (i % 6));
        if (!tissue_add(&tissue, i < 6 && i % 2 ? DPT_NET_SHEET : DPT_NET_VOLUME, integrator, 0.0, 0.0)) {
            tissue_close(&tissue);
            continue;
        }
        tissue_place(&tissue, -0.001);
        rig_place(&tissue.rig);
        for (int t = 0; t < 900; t++) {
            x += random_in(&seed, -4e-5, 4e-5);
            y += random_in(&seed, -4e-5, 4e-5);
            tissue_place(&tissue, 0.006 * sin(0.006 * t));
            tissue.rig.device.position[0] = x;
            tissue.rig.device.position[1] = y;
            if (!(tissue_tick(&tissue) > 0.0) || t % 5)
                continue;
            double ends[6];
            oracle_mesh *mesh = surface_now(&tissue);
            end_of_spring(&tissue, stiffness, ends);
            const double gap = oracle_brute(mesh, ends, NULL) - tissue.rig.segments[0].radius;
            deepest = fmax(deepest, -gap);
            farthest = fmax(farthest, gap);
            touched++;
            oracle_brute_close(mesh);
        }
        CHECK(touched > 50, "case %d: touched in %u ticks", i, touched);
        CHECK(deepest < 3e-6 && farthest < 3e-6, "case %d: %g m deep, %g m away", i, deepest, farthest);
        tissue_close(&tissue);
    }
}

/* Springs of the same mesh, stepped by hand with the loads that are told, go where the body goes. */
static void told_loads_move_the_tissue(double load_radius)
{
    struct tissue tissue;
    dpt_springs_def def;
    tissue_begin(&tissue, 800.0, 1.1);
    tissue.is_sleepless = 1;
    if (tissue_add(&tissue, DPT_NET_VOLUME, DPT_INTEGRATOR_SYMPLECTIC, load_radius, 0.0)) {
        enum { NODES = 4096, LOADS = 4096 };
        static float mine[3 * NODES], theirs[3 * NODES];
        static dpt_load loads[LOADS];
        double off = 0.0;
        dpt_springs_def_init(&def);
        def.mesh = tissue.mesh[0].mesh;
        def.sleep_speed = 0.0;
        dpt_springs *other = rig_add_springs(&tissue.rig, &def);
        const uint32_t nodes = dpt_springs_get_count(other);
        CHECK(nodes <= NODES, "%u nodes", nodes);
        tissue_place(&tissue, -0.001);
        rig_place(&tissue.rig);
        for (int t = 0; t < 500; t++) {
            uint32_t count = 0;
            tissue_place(&tissue, 2e-5 * t - 0.001);
            tissue_tick(&tissue);
            dpt_body_get_node_loads(tissue.rig.world, tissue.body[0], loads, LOADS, &count);
            CHECK(dpt_springs_step(other, tissue.rig.dt, loads, count, NULL) == DPT_OK, "not stepped");
            dpt_springs_get_nodes(tissue.springs[0], nodes, mine, NULL);
            dpt_springs_get_nodes(other, nodes, theirs, NULL);
            for (uint32_t i = 0; i < 3 * nodes; i++)
                off = fmax(off, fabs((double)mine[i] - (double)theirs[i]));
        }
        CHECK(tissue.info[0].substeps == 1, "%u substeps: loads are a mean", tissue.info[0].substeps);
        CHECK(off < 1e-6, "nodes are %g m apart", off);
    }
    tissue_close(&tissue);
}

static void what_is_told_moves_the_tissue(void)
{
    told_loads_move_the_tissue(0.0);
    told_loads_move_the_tissue(0.03);
}

static void copy_vertices(const struct tissue *tissue, float *to)
{
    const float *positions;
    uint32_t count = 0;
    dpt_body_get_vertices(tissue->rig.world, tissue->body[0], &positions, &count);
    memcpy(to, positions, 3 * count * sizeof *to);
}

/* What the loads of the body, at the origin, sum up to; the torque about that. */
static dpt_wrench sum_of_loads(const struct tissue *tissue, const float *vertices)
{
    static dpt_load loads[4096];
    dpt_wrench sum = { { 0.0 }, { 0.0 } };
    uint32_t count = 0;
    const dpt_result result = dpt_body_get_loads(tissue->rig.world, tissue->body[0], loads, 4096, &count);
    CHECK(result == DPT_OK, "%s", dpt_result_name(result));
    for (uint32_t i = 0; i < count; i++) {
        double at[3], torque[3];
        for (int k = 0; k < 3; k++)
            at[k] = (double)vertices[3 * loads[i].vertex + (uint32_t)k];
        cross3(at, loads[i].force, torque);
        for (int k = 0; k < 3; k++) {
            sum.force[k] += loads[i].force[k];
            sum.torque[k] += torque[k];
        }
    }
    return sum;
}

/* By what the body's wrench says, and by its loads, where the vertices were in the tick. */
static void forces_sum_up_to_zero_with(uint32_t integrator, double load_radius)
{
    struct tissue tissue;
    tissue_begin(&tissue, 600.0, 1.3);
    if (tissue_add(&tissue, DPT_NET_VOLUME, integrator, load_radius, 0.0)) {
        static float before[3 * 4096];
        double worst = 0.0, peak = 0.0;
        tissue_roughen(&tissue, 0.4, 0.3);
        tissue_place(&tissue, -0.001);
        rig_place(&tissue.rig);
        for (int t = 0; t < 500; t++) {
            dpt_wrench on_body;
            double arm[3], torque[3];
            tissue_place(&tissue, 2e-5 * t - 0.001);
            copy_vertices(&tissue, before);
            peak = fmax(peak, tissue_tick(&tissue));
            dpt_body_get_wrench(tissue.rig.world, tissue.body[0], &on_body);
            /* The body is at the origin; the tool's torque is about its own. */
            for (int k = 0; k < 3; k++)
                arm[k] = tissue.rig.device.position[k];
            cross3(arm, tissue.wrench.force, torque);
            for (int k = 0; k < 3; k++) {
                worst = fmax(worst, fabs(on_body.force[k] + tissue.wrench.force[k]));
                worst = fmax(worst, fabs(on_body.torque[k] + tissue.wrench.torque[k] + torque[k]));
            }
            const dpt_wrench sum = sum_of_loads(&tissue, before);
            for (int k = 0; k < 3; k++) {
                worst = fmax(worst, fabs(sum.force[k] + tissue.wrench.force[k]));
                worst = fmax(worst, fabs(sum.torque[k] + tissue.wrench.torque[k] + torque[k]));
            }
        }
        CHECK(peak > 0.1 && worst <= 1e-12 * peak, "off by %g N of %g N", worst, peak);
    }
    tissue_close(&tissue);
}

static void forces_sum_up_to_zero(void)
{
    for (int i = 0; i < INTEGRATORS; i++)
        for (int spread = 0; spread < 2; spread++)
            forces_sum_up_to_zero_with(integrators[i], 0.03 * spread);
}

/* A tool across two bodies: one solve, in whatever order they are given; between them it feels twice what one gives. */
static void bodies_share_a_tool(void)
{
    double felt[3];
    for (int i = 0; i < 3; i++) {
        struct tissue tissue;
        double mean;
        tissue_begin(&tissue, 400.0, 1.5708);
        tissue.rig.device.position[0] = 0.0;
        int is_there = tissue_add(&tissue, DPT_NET_VOLUME, DPT_INTEGRATOR_SYMPLECTIC, 0.0, -0.025);
        if (i < 2)
            is_there = is_there && tissue_add(&tissue, DPT_NET_VOLUME, DPT_INTEGRATOR_SYMPLECTIC, 0.0, 0.025);
        if (i == 1) {
            const dpt_body body = tissue.body[0];
            dpt_springs *springs = tissue.springs[0];
            tissue.body[0] = tissue.body[1];
            tissue.springs[0] = tissue.springs[1];
            tissue.body[1] = body;
            tissue.springs[1] = springs;
        }
        if (is_there)
            tissue_press_and_hold(&tissue, 0.004, &mean);
        felt[i] = is_there ? mean : 0.0;
        CHECK(length3(tissue.wrench.force) > 0.05, "case %d: %g N", i, length3(tissue.wrench.force));
        tissue_close(&tissue);
    }
    CHECK(fabs(felt[0] - felt[1]) <= 1e-9, "%g N and %g N in another order", felt[0], felt[1]);
    CHECK(felt[2] < felt[0], "%g N on one, %g N on two", felt[2], felt[0]);
}

/* One body with IMPLICIT, one that needs several substeps: the same force. Where one fails it is held, and the other goes on. */
static void integrators_share_a_tool(void)
{
    enum { NODES = 4096 };
    static float before[2][3 * NODES], after[3 * NODES];
    double felt[2] = { 0.0, 0.0 };
    for (int i = 0; i < 2; i++) {
        const uint32_t integrator = i ? DPT_INTEGRATOR_IMPLICIT : DPT_INTEGRATOR_SYMPLECTIC;
        const float far[3] = { 0.0f, 0.0f, 0.0f }, fast[3] = { 0.0f, 0.0f, 8e8f };
        struct tissue tissue;
        tissue_begin(&tissue, 400.0, 1.5708);
        tissue.is_sleepless = 1;
        tissue.rig.dt = 4e-3;
        if (tissue_add(&tissue, DPT_NET_VOLUME, integrator, 0.0, -0.025) &&
            tissue_add(&tissue, DPT_NET_VOLUME, DPT_INTEGRATOR_EULER, 0.0, 0.025)) {
            const uint32_t nodes = dpt_springs_get_count(tissue.springs[0]);
            const double jump = tissue_press_and_hold(&tissue, 0.004, &felt[i]);
            CHECK(jump <= 1e-3 * felt[i], "case %d: jumps of %g N at %g N", i, jump, felt[i]);
            CHECK(tissue.info[0].substeps > 1 && tissue.info[0].substeps == tissue.info[1].substeps, "%u substeps",
                  tissue.info[0].substeps);
            CHECK(nodes <= NODES && nodes == dpt_springs_get_count(tissue.springs[1]), "%u nodes", nodes);
            dpt_springs_set_nodes(tissue.springs[1], nodes / 2, 1, far, fast);
            for (int b = 0; b < 2; b++)
                dpt_springs_get_nodes(tissue.springs[b], nodes, before[b], NULL);
            tissue.rig.device.position[2] -= 1e-4;
            rig_step(&tissue.rig);
            CHECK(dpt_bodies_step_springs(tissue.rig.world, tissue.body, tissue.springs, 2, 4e-3, NULL) == DPT_E_FINITE,
                  "case %d: the step is taken", i);
            for (int b = 0; b < 2; b++) {
                dpt_springs_get_nodes(tissue.springs[b], nodes, after, NULL);
                const int is_held = !memcmp(before[b], after, 3 * nodes * sizeof *after);
                CHECK(is_held == b, "case %d: body %d %s", i, b, is_held ? "is held" : "goes on");
            }
        }
        tissue_close(&tissue);
    }
    CHECK(felt[0] > 0.05 && fabs(felt[1] - felt[0]) <= 0.01 * felt[0], "%g N and %g N", felt[0], felt[1]);
}

/* A tool that lies on tissue and on a rigid body of the same shape: its spring ends on both. */
static void a_rigid_body_holds_beside_the_tissue(void)
{
    struct tissue tissue;
    double mean, ends[6];
    tissue_begin(&tissue, 400.0, 1.5708);
    if (tissue_add(&tissue, DPT_NET_VOLUME, DPT_INTEGRATOR_SYMPLECTIC, 0.0, -0.025)) {
        const struct dpt_mesh *mesh = tissue.mesh[0].mesh;
        dpt_pose pose = DPT_POSE_IDENTITY;
        const float *positions;
        uint32_t count;
        pose.position[0] = 0.025;
        rig_add_body(&tissue.rig, mesh, &pose);
        tissue_press_and_hold(&tissue, 0.004, &mean);
        CHECK(dpt_mesh_get_vertices(mesh, &positions, &count) == DPT_OK, "no vertices");
        oracle_mesh *rigid = oracle_brute_open(positions, count, mesh_words(mesh, MESH_TRIANGLES), mesh->triangles);
        oracle_mesh *soft = surface_now(&tissue);
        end_of_spring(&tissue, 400.0, ends);
        for (int side = -1; side <= 1; side += 2) {
            double local[6];
            memcpy(local, ends, sizeof local);
            local[0] -= 0.025 * side;
            local[3] -= 0.025 * side;
            const double gap = oracle_brute(side > 0 ? rigid : soft, local, NULL) - tissue.rig.segments[0].radius;
            CHECK(fabs(gap) < 3e-6, "%s: %g m away", side > 0 ? "rigid" : "soft", gap);
        }
        oracle_brute_close(rigid);
        oracle_brute_close(soft);
    }
    tissue_close(&tissue);
}

/* The spring's energy grows by what the bodies do, and by what a device does that moves without a turn. */
static void work_is_accounted_for_with(uint32_t integrator)
{
    struct tissue tissue;
    tissue_begin(&tissue, 600.0, 1.2);
    if (tissue_add(&tissue, DPT_NET_VOLUME, integrator, 0.0, 0.0)) {
        double last[3] = { 0.0, 0.0, 0.0 }, from[3], energy = 0.0, work = 0.0, worst = 0.0, most = 0.0;
        tissue_place(&tissue, -0.001);
        rig_place(&tissue.rig);
        memcpy(from, tissue.rig.device.position, sizeof from);
        for (int t = 0; t < 900; t++) {
            double by_device = 0.0;
            tissue_place(&tissue, 0.006 * sin(0.006 * t));
            tissue.rig.device.position[1] = 1e-3 * sin(0.05 * t);
            tissue_tick(&tissue);
            for (int k = 0; k < 3; k++) {
                by_device -= 0.5 * (last[k] + tissue.wrench.force[k]) * (tissue.rig.device.position[k] - from[k]);
                last[k] = tissue.wrench.force[k];
                from[k] = tissue.rig.device.position[k];
            }
            worst = fmax(worst, fabs(tissue.force.energy - energy - by_device - tissue.force.body_work));
            energy = tissue.force.energy;
            most = fmax(most, energy);
            work = fmax(work, fabs(tissue.force.body_work));
        }
        CHECK(most > 1e-6 && work > 1e-3 * most, "stored %g J, done %g J", most, work);
        CHECK(worst <= 1e-9 * most, "%g J of %g are not accounted for", worst, most);
    }
    tissue_close(&tissue);
}

static void work_is_accounted_for(void)
{
    for (int i = 0; i < INTEGRATORS; i++)
        work_is_accounted_for_with(integrators[i]);
}

static void tissue_sleeps_with(uint32_t integrator)
{
    struct tissue tissue;
    tissue_begin(&tissue, 500.0, 1.2);
    if (tissue_add(&tissue, DPT_NET_VOLUME, integrator, 0.0, 0.0)) {
        double mean, last, jump = 0.0;
        uint64_t seed = 11;
        tissue_press_and_hold(&tissue, 0.005, &mean);
        CHECK(tissue.info[0].active == 0, "%u nodes are awake", tissue.info[0].active);
        const dpt_wrench before = tissue.wrench;
        for (int t = 0; t < 50; t++)
            tissue_tick(&tissue);
        CHECK(!memcmp(&before, &tissue.wrench, sizeof before), "asleep, it is felt otherwise");
        last = length3(tissue.wrench.force);
        for (int t = 0; t < 2000; t++) {
            tissue_place(&tissue, 0.005 + random_in(&seed, -1e-6, 1e-6) * (1 + t / 100));
            const double force = tissue_tick(&tissue);
            jump = fmax(jump, fabs(force - last) - 1.5 * 500.0 * 2e-6 * (1 + t / 100));
            last = force;
        }
        CHECK(jump < 2e-3, "a tremor makes jumps of %g N beyond its own", jump);
    }
    tissue_close(&tissue);
}

static void tissue_sleeps_under_a_still_tool(void)
{
    for (int i = 0; i < INTEGRATORS; i++)
        tissue_sleeps_with(integrators[i]);
}

static void wrong_lists_are_refused(void)
{
    struct tissue tissue;
    tissue_begin(&tissue, 500.0, 0.0);
    if (tissue_add(&tissue, DPT_NET_VOLUME, DPT_INTEGRATOR_SYMPLECTIC, 0.0, 0.0) &&
        tissue_add(&tissue, DPT_NET_VOLUME, DPT_INTEGRATOR_SYMPLECTIC, 0.0, 0.2)) {
        dpt_world *world = tissue.rig.world;
        const dpt_body twice[2] = { tissue.body[0], tissue.body[0] }, none[2] = { tissue.body[0], 0 };
        dpt_springs *same[2] = { tissue.springs[0], tissue.springs[0] };
        const dpt_result results[] = {
            dpt_bodies_step_springs(NULL, tissue.body, tissue.springs, 2, 1e-3, NULL),
            dpt_bodies_step_springs(world, NULL, tissue.springs, 2, 1e-3, NULL),
            dpt_bodies_step_springs(world, tissue.body, NULL, 2, 1e-3, NULL),
            dpt_bodies_step_springs(world, twice, tissue.springs, 2, 1e-3, NULL),
            dpt_bodies_step_springs(world, tissue.body, same, 2, 1e-3, NULL),
        };
        for (size_t i = 0; i < sizeof results / sizeof *results; i++)
            CHECK(results[i] == DPT_E_ARGUMENT, "case %zu: %s", i, dpt_result_name(results[i]));
        CHECK(dpt_bodies_step_springs(world, none, tissue.springs, 2, 1e-3, NULL) == DPT_E_HANDLE, "no body");
        CHECK(dpt_bodies_step_springs(world, tissue.body, tissue.springs, 2, 0.0, NULL) == DPT_E_ARGUMENT, "no time");
        CHECK(dpt_bodies_step_springs(world, NULL, NULL, 0, 1e-3, NULL) == DPT_OK, "nothing is not allowed");
    }
    tissue_close(&tissue);
}

int main(int argc, char **argv)
{
    take_percent(argc, argv);
    TEST(a_still_device_is_silent);
    TEST(implicit_light_sheets_are_silent);
    TEST(spread_loads_are_silent);
    TEST(a_finer_sheet_feels_alike);
    TEST(loads_of_the_step_before_are_not_silent);
    TEST(integrators_end_at_one_force);
    TEST(implicit_tissue_gains_what_tools_do);
    TEST(the_tool_ends_on_the_surface);
    TEST(what_is_told_moves_the_tissue);
    TEST(forces_sum_up_to_zero);
    TEST(bodies_share_a_tool);
    TEST(integrators_share_a_tool);
    TEST(a_rigid_body_holds_beside_the_tissue);
    TEST(work_is_accounted_for);
    TEST(tissue_sleeps_under_a_still_tool);
    TEST(wrong_lists_are_refused);
    return check_report();
}
