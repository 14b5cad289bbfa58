/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Contact solved with the tissue's step. Oracles: the conditions of the problem, by brute force over the surface after the
 * step, with the tool where the felt wrench says that its spring ends; springs that are stepped by hand with the loads
 * that were told; and sums of forces. How stiff the tissue is is not judged here.
 */
#include "deform/spring_state.h"
#include "world/tissue_rig.h"

static void a_still_device_is_silent(void)
{
    static const double leans[] = { 0.0, 0.6, 1.2, 1.5708 };
    for (int kind = 0; kind < 2; kind++)
        for (int i = 0; i < (int)part_of(24); i++) {
            const uint32_t integrator = tissue_integrators[i % 3];
            const double stiffness = i & 1 ? 2000.0 : 200.0, lean = leans[i / 6];
            struct tissue_rig tissue;
            double mean;
            const struct tissue_def def = tissue_asleep(kind ? DPT_NET_SHEET : DPT_NET_VOLUME, integrator);
            struct tissue_tool *rod = tissue_rig_open_rod(&tissue, stiffness, lean, 0.004);
            if (tissue_rig_add_soft(&tissue, &def)) {
                const double jump = tissue_rod_press_and_hold(&tissue, 0.006, &mean);
                CHECK(mean > 1e-3, "case %d: it is not touched: %g N", i, mean);
                CHECK(jump <= fmax(1e-3 * mean, 1e-4), "case %d: jumps of %g N at %g N", i, jump, mean);
                CHECK(!(rod->force.flags & (DPT_FORCE_FLAG_APART | DPT_FORCE_FLAG_CROWDED)), "case %d: flags %u", i,
                      rod->force.flags);
            }
            tissue_rig_close(&tissue);
        }
}

/*
 * A light sheet under a tool twice as thick as its edges are long: many nodes hold it, and what one of them takes over from
 * another moves all of them.
 */
static void implicit_light_sheets_are_silent(void)
{
    for (int i = 0; i < (int)part_of(6); i++) {
        struct tissue_rig tissue;
        double mean;
        struct tissue_def def = tissue_asleep(DPT_NET_SHEET, DPT_INTEGRATOR_IMPLICIT);
        def.triangles = 2048;
        tissue_rig_open_rod(&tissue, i & 1 ? 2000.0 : 667.0, 1.5708 - 0.1 * (i / 2), 0.012);
        if (tissue_rig_add_soft(&tissue, &def)) {
            const double jump = tissue_rod_press_and_hold(&tissue, 0.025, &mean);
            CHECK(mean > 1e-3, "case %d: it is not touched: %g N", i, mean);
            CHECK(jump <= 1e-4, "case %d: jumps of %g N at %g N", i, jump, mean);
        }
        tissue_rig_close(&tissue);
    }
}

/* Loads that are spread over some edges of 12 mm, on a sheet of which that is a fifth, too. */
static void spread_loads_are_silent(void)
{
    static const double leans[] = { 0.0, 0.6, 1.2, 1.5708 }, radii[] = { 0.015, 0.03 };
    for (int kind = 0; kind < 2; kind++)
        for (int i = 0; i < (int)part_of(24); i++) {
            struct tissue_rig tissue;
            double mean;
            struct tissue_def def = tissue_asleep(kind ? DPT_NET_SHEET : DPT_NET_VOLUME, tissue_integrators[i % 3]);
            def.load_radius = radii[i / 3 % 2];
            tissue_rig_open_rod(&tissue, i & 1 ? 2000.0 : 200.0, leans[i / 6], 0.004);
            if (tissue_rig_add_soft(&tissue, &def)) {
                const double jump = tissue_rod_press_and_hold(&tissue, 0.006, &mean);
                CHECK(mean > 1e-3, "case %d: it is not touched: %g N", i, mean);
                CHECK(jump <= fmax(1e-3 * mean, 1e-4), "case %d: jumps of %g N at %g N", i, jump, mean);
            }
            tissue_rig_close(&tissue);
        }
}

/* Where the patch spans three edges, a sheet feels alike when its edges are halved. */
static void a_finer_sheet_feels_alike(void)
{
    for (int lying = 0; lying < few_of(2); lying++) {
        double force[2] = { 0.0, 0.0 };
        for (int fine = 0; fine < 2; fine++) {
            struct tissue_rig tissue;
            struct tissue_def def = tissue_asleep(DPT_NET_SHEET, DPT_INTEGRATOR_IMPLICIT);
            def.load_radius = 0.04;
            def.triangles = fine ? 2048 : 512;
            tissue_rig_open_rod(&tissue, 500.0, 1.5708 * lying, 0.006);
            if (tissue_rig_add_soft(&tissue, &def))
                tissue_rod_press_and_hold(&tissue, 0.02, &force[fine]);
            tissue_rig_close(&tissue);
        }
        CHECK(force[0] > 0.05, "%g N", force[0]);
        CHECK(fabs(force[1] - force[0]) <= 0.05 * force[0], "case %d: %g N, %g N on a finer mesh", lying, force[0],
              force[1]);
    }
}

/* What the tests above look for is there without the solve: loads of the step before make a lying tool jump. */
static void loads_of_the_step_before_are_not_silent(void)
{
    struct tissue_rig tissue;
    double mean, jump = 0.0;
    struct tissue_def def = tissue_asleep(DPT_NET_VOLUME, DPT_INTEGRATOR_SYMPLECTIC);
    def.period = 1e-6;
    tissue_rig_open_rod(&tissue, 2000.0, 1.5708, 0.004);
    if (tissue_rig_add_soft(&tissue, &def))
        jump = tissue_rod_press_and_hold(&tissue, 0.006, &mean);
    tissue_rig_close(&tissue);
    CHECK(jump > 5e-3, "it jumps by no more than %g N", jump);
}

/* The force at rest is the tissue's, whatever integrator, step and number of substeps: all beside SYMPLECTIC at 1 ms. */
static void integrators_end_at_one_force(void)
{
    enum { CASES = 7 };
    static const uint32_t integrator[CASES] = { 0, 2, 0, 2, 2, 1, 0 };
    static const double steps[CASES] = { 1e-3, 1e-3, 1e-2, 1e-4, 1e-2, 1e-3, 1e-4 };
    for (int lean = 0; lean < (int)part_of(4); lean++) {
        double expected = 0.0;
        for (int i = 0; i < 1 + (int)part_of(CASES - 1); i++) {
            struct tissue_rig tissue;
            double jump = 0.0, mean = 0.0;
            struct tissue_def def = tissue_asleep(DPT_NET_VOLUME, tissue_integrators[integrator[i]]);
            def.sleeps = 0;
            tissue_rig_open_rod(&tissue, 2000.0, 0.5236 * lean, 0.004);
            tissue.rig.dt = steps[i];
            if (tissue_rig_add_soft(&tissue, &def))
                jump = tissue_rod_press_and_hold(&tissue, 0.006, &mean);
            for (int t = 0; t < 1000 * few_of(4) && mean > 0.0; t++)
                mean = tissue_rig_tick(&tissue);
            tissue_rig_close(&tissue);
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
        struct tissue_rig tissue;
        uint64_t seed = 5 + (uint64_t)i;
        double work = 0.0, excess = -HUGE_VAL, unproven = -HUGE_VAL, most = 0.0;
        struct tissue_def def = tissue_asleep(i < 3 ? DPT_NET_VOLUME : DPT_NET_SHEET, DPT_INTEGRATOR_IMPLICIT);
        def.sleeps = 0;
        def.drag = def.viscosity = 0.0;
        tissue_rig_open_rod(&tissue, i % 2 ? 2000.0 : 300.0, 0.3 * i, 0.004);
        tissue.rig.dt = h;
        if (tissue_rig_add_soft(&tissue, &def)) {
            const uint32_t nodes = dpt_springs_get_count(tissue.body[0].springs);
            CHECK(nodes <= NODES, "%u nodes", nodes);
            tissue_rod_lower(&tissue, -0.001);
            tissue_rig_place(&tissue);
            dpt_springs_get_nodes(tissue.body[0].springs, nodes, from, NULL);
            for (int t = 0; t < 2000; t++) {
                double elastic, kinetic;
                uint32_t count = 0;
                /* Up and down, in leaps, and off it now and then. */
                tissue_rod_lower(&tissue, 0.004 * sin(0.02 * t) + random_in(&seed, -2e-3, 2e-3));
                tissue_rig_tick(&tissue);
                (i < 3 ? dpt_body_get_node_loads : dpt_body_get_loads)(tissue.rig.world, tissue.body[0].id, loads,
                                                                       LOADS, &count);
                dpt_springs_get_nodes(tissue.body[0].springs, nodes, to, NULL);
                for (uint32_t l = 0; l < count; l++)
                    for (uint32_t k = 0; k < 3; k++)
                        work += loads[l].force[k] *
                                ((double)to[3 * loads[l].vertex + k] - (double)from[3 * loads[l].vertex + k]);
                memcpy(from, to, sizeof from);
                dpt_springs_get_energy(tissue.body[0].springs, &elastic, &kinetic);
                excess = fmax(excess, elastic + kinetic - work);
                unproven = fmax(unproven, elastic + kinetic - tissue.body[0].springs->solve.account);
                most = fmax(most, elastic + kinetic);
            }
            CHECK(most > 1e-6 && excess <= 1e-8 && unproven <= 1e-8,
                  "case %d: %g J: %g more than the work, %g than proven", i, most, excess, unproven);
        }
        tissue_rig_close(&tissue);
    }
}

static void the_tool_ends_on_the_surface(void)
{
    uint64_t seed = 7;
    for (int i = 0; i < (int)part_of(12); i++) {
        const uint32_t integrator = i < 6 ? DPT_INTEGRATOR_IMPLICIT : DPT_INTEGRATOR_SYMPLECTIC;
        const double stiffness = i % 2 ? 1500.0 : 300.0;
        struct tissue_rig tissue;
        uint32_t touched = 0;
        double deepest = 0.0, farthest = 0.0, x = 0.0, y = 0.0;
        const struct tissue_def def = tissue_asleep(i < 6 && i % 2 ? DPT_NET_SHEET : DPT_NET_VOLUME, integrator);
        struct tissue_tool *rod = tissue_rig_open_rod(&tissue, stiffness, 0.3 * (i % 6), 0.004);
        if (!tissue_rig_add_soft(&tissue, &def)) {
            tissue_rig_close(&tissue);
            continue;
        }
        tissue_rod_lower(&tissue, -0.001);
        tissue_rig_place(&tissue);
        for (int t = 0; t < 900; t++) {
            x += random_in(&seed, -4e-5, 4e-5);
            y += random_in(&seed, -4e-5, 4e-5);
            tissue_rod_lower(&tissue, 0.006 * sin(0.006 * t));
            rod->device.position[0] = x;
            rod->device.position[1] = y;
            if (!(tissue_rig_tick(&tissue) > 0.0) || t % 5)
                continue;
            double ends[6];
            oracle_mesh *mesh = tissue_surface(&tissue, &tissue.body[0]);
            tissue_tool_end(rod, ends);
            const double gap = oracle_brute(mesh, ends, NULL) - rod->segment.radius;
            deepest = fmax(deepest, -gap);
            farthest = fmax(farthest, gap);
            touched++;
            oracle_brute_close(mesh);
        }
        CHECK(touched > 50, "case %d: touched in %u ticks", i, touched);
        CHECK(deepest < 3e-6 && farthest < 3e-6, "case %d: %g m deep, %g m away", i, deepest, farthest);
        tissue_rig_close(&tissue);
    }
}

/* Springs of the same mesh, stepped by hand with the loads that are told, go where the body goes; a rough one is twisted. */
static void told_loads_move_the_tissue(double load_radius, double friction)
{
    const double turn[4] = { 1.0, 0.0, 0.0, friction > 0.0 ? 5e-4 : 0.0 };
    struct tissue_rig tissue;
    struct tissue_def def = tissue_asleep(DPT_NET_VOLUME, DPT_INTEGRATOR_SYMPLECTIC);
    def.load_radius = load_radius;
    def.sleeps = 0;
    tissue_rig_open_rod(&tissue, 800.0, 1.1, 0.004);
    if (tissue_rig_add_soft(&tissue, &def)) {
        enum { NODES = 4096, LOADS = 4096 };
        static float mine[3 * NODES], theirs[3 * NODES];
        static dpt_load loads[LOADS];
        dpt_springs_def springs;
        double off = 0.0;
        dpt_springs_def_init(&springs);
        springs.mesh = tissue.body[0].mesh.mesh;
        springs.sleep_speed = 0.0;
        dpt_springs *other = rig_add_springs(&tissue.rig, &springs);
        const uint32_t nodes = dpt_springs_get_count(other);
        CHECK(nodes <= NODES, "%u nodes", nodes);
        tissue_body_roughen(&tissue, &tissue.body[0], friction, friction);
        tissue_rod_lower(&tissue, -0.001);
        tissue_rig_place(&tissue);
        for (int t = 0; t < 500; t++) {
            uint32_t count = 0;
            tissue_rod_lower(&tissue, 2e-5 * t - 0.001);
            pose_turn_by(&tissue.tool[0].device, turn);
            tissue_rig_tick(&tissue);
            dpt_body_get_node_loads(tissue.rig.world, tissue.body[0].id, loads, LOADS, &count);
            CHECK(dpt_springs_step(other, tissue.rig.dt, loads, count, NULL) == DPT_OK, "not stepped");
            dpt_springs_get_nodes(tissue.body[0].springs, nodes, mine, NULL);
            dpt_springs_get_nodes(other, nodes, theirs, NULL);
            for (uint32_t i = 0; i < 3 * nodes; i++)
                off = fmax(off, fabs((double)mine[i] - (double)theirs[i]));
        }
        CHECK(tissue.info[0].substeps == 1, "%u substeps: loads are a mean", tissue.info[0].substeps);
        CHECK(off < 1e-6, "nodes are %g m apart", off);
    }
    tissue_rig_close(&tissue);
}

static void what_is_told_moves_the_tissue(void)
{
    told_loads_move_the_tissue(0.0, 0.0);
    told_loads_move_the_tissue(0.03, 0.0);
    told_loads_move_the_tissue(0.0, 0.5);
    told_loads_move_the_tissue(0.03, 0.5);
}

/* What the loads of the body, at the origin, sum up to; the torque about that. */
static dpt_wrench sum_of_loads(const struct tissue_rig *tissue, const float *vertices)
{
    static dpt_load loads[4096];
    dpt_wrench sum = { { 0.0 }, { 0.0 } };
    uint32_t count = 0;
    const dpt_result result = dpt_body_get_loads(tissue->rig.world, tissue->body[0].id, loads, 4096, &count);
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
    struct tissue_rig tissue;
    struct tissue_def def = tissue_asleep(DPT_NET_VOLUME, integrator);
    def.load_radius = load_radius;
    struct tissue_tool *rod = tissue_rig_open_rod(&tissue, 600.0, 1.3, 0.004);
    if (tissue_rig_add_soft(&tissue, &def)) {
        static float before[3 * TISSUE_ROOM];
        double worst = 0.0, peak = 0.0;
        tissue_body_roughen(&tissue, &tissue.body[0], 0.4, 0.3);
        tissue_rod_lower(&tissue, -0.001);
        tissue_rig_place(&tissue);
        for (int t = 0; t < 500; t++) {
            dpt_wrench on_body;
            uint32_t count = 0;
            double torque[3];
            tissue_rod_lower(&tissue, 2e-5 * t - 0.001);
            const float *vertices = tissue_vertices(&tissue, &tissue.body[0], &count);
            memcpy(before, vertices, 3 * count * sizeof *before);
            peak = fmax(peak, tissue_rig_tick(&tissue));
            dpt_body_get_wrench(tissue.rig.world, tissue.body[0].id, &on_body);
            /* The body is at the origin; the tool's torque is about its own. */
            cross3(rod->device.position, rod->force.wrench.force, torque);
            for (int k = 0; k < 3; k++) {
                worst = fmax(worst, fabs(on_body.force[k] + rod->force.wrench.force[k]));
                worst = fmax(worst, fabs(on_body.torque[k] + rod->force.wrench.torque[k] + torque[k]));
            }
            const dpt_wrench sum = sum_of_loads(&tissue, before);
            for (int k = 0; k < 3; k++) {
                worst = fmax(worst, fabs(sum.force[k] + rod->force.wrench.force[k]));
                worst = fmax(worst, fabs(sum.torque[k] + rod->force.wrench.torque[k] + torque[k]));
            }
        }
        CHECK(peak > 0.1 && worst <= 1e-12 * peak, "off by %g N of %g N", worst, peak);
    }
    tissue_rig_close(&tissue);
}

static void forces_sum_up_to_zero(void)
{
    for (int i = 0; i < TISSUE_INTEGRATORS; i++)
        for (int spread = 0; spread < 2; spread++)
            forces_sum_up_to_zero_with(tissue_integrators[i], 0.03 * spread);
}

/* A tool across two bodies: one solve, in whatever order they are given; between them it feels twice what one gives. */
static void bodies_share_a_tool(void)
{
    double felt[3];
    for (int i = 0; i < 3; i++) {
        struct tissue_rig tissue;
        double mean;
        struct tissue_def def = tissue_asleep(DPT_NET_VOLUME, DPT_INTEGRATOR_SYMPLECTIC);
        struct tissue_tool *rod = tissue_rig_open_rod(&tissue, 400.0, 1.5708, 0.004);
        tissue.is_reversed = i == 1;
        def.place[0] = -0.025;
        int is_there = tissue_rig_add_soft(&tissue, &def) != NULL;
        def.place[0] = 0.025;
        if (i < 2)
            is_there = is_there && tissue_rig_add_soft(&tissue, &def);
        if (is_there)
            tissue_rod_press_and_hold(&tissue, 0.004, &mean);
        felt[i] = is_there ? mean : 0.0;
        CHECK(length3(rod->force.wrench.force) > 0.05, "case %d: %g N", i, length3(rod->force.wrench.force));
        tissue_rig_close(&tissue);
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
    for (int i = 0; i < few_of(2); i++) {
        const float far[3] = { 0.0f, 0.0f, 0.0f }, fast[3] = { 0.0f, 0.0f, 8e8f };
        struct tissue_rig tissue;
        struct tissue_def def[2] = {
            tissue_asleep(DPT_NET_VOLUME, i ? DPT_INTEGRATOR_IMPLICIT : DPT_INTEGRATOR_SYMPLECTIC),
            tissue_asleep(DPT_NET_VOLUME, DPT_INTEGRATOR_EULER),
        };
        struct tissue_tool *rod = tissue_rig_open_rod(&tissue, 400.0, 1.5708, 0.004);
        tissue.rig.dt = 4e-3;
        for (int b = 0; b < 2; b++) {
            def[b].sleeps = 0;
            def[b].place[0] = b ? 0.025 : -0.025;
        }
        if (tissue_rig_add_soft(&tissue, &def[0]) && tissue_rig_add_soft(&tissue, &def[1])) {
            const uint32_t nodes = dpt_springs_get_count(tissue.body[0].springs);
            const double jump = tissue_rod_press_and_hold(&tissue, 0.004, &felt[i]);
            CHECK(jump <= 1e-3 * felt[i], "case %d: jumps of %g N at %g N", i, jump, felt[i]);
            CHECK(tissue.info[0].substeps > 1 && tissue.info[0].substeps == tissue.info[1].substeps, "%u substeps",
                  tissue.info[0].substeps);
            CHECK(nodes <= NODES && nodes == dpt_springs_get_count(tissue.body[1].springs), "%u nodes", nodes);
            dpt_springs_set_nodes(tissue.body[1].springs, nodes / 2, 1, far, fast);
            for (int b = 0; b < 2; b++)
                dpt_springs_get_nodes(tissue.body[b].springs, nodes, before[b], NULL);
            rod->device.position[2] -= 1e-4;
            tissue_rig_step_world(&tissue);
            tissue_rig_step_springs(&tissue);
            CHECK(tissue.result == DPT_E_FINITE, "case %d: the step is taken", i);
            for (int b = 0; b < 2; b++) {
                dpt_springs_get_nodes(tissue.body[b].springs, nodes, after, NULL);
                const int is_held = !memcmp(before[b], after, 3 * nodes * sizeof *after);
                CHECK(is_held == b, "case %d: body %d %s", i, b, is_held ? "is held" : "goes on");
            }
        }
        tissue_rig_close(&tissue);
    }
    CHECK(felt[0] > 0.05 && (few_of(2) < 2 || fabs(felt[1] - felt[0]) <= 0.01 * felt[0]), "%g N and %g N", felt[0],
          felt[1]);
}

/* A tool that lies on tissue and on a rigid body of the same shape: its spring ends on both. */
static void a_rigid_body_holds_beside_the_tissue(void)
{
    struct tissue_rig tissue;
    double mean, ends[6];
    struct tissue_def def = tissue_asleep(DPT_NET_VOLUME, DPT_INTEGRATOR_SYMPLECTIC);
    def.place[0] = -0.025;
    struct tissue_tool *rod = tissue_rig_open_rod(&tissue, 400.0, 1.5708, 0.004);
    const int is_there = tissue_rig_add_soft(&tissue, &def) != NULL;
    def.place[0] = 0.025;
    if (is_there && tissue_rig_add_rigid(&tissue, &def)) {
        tissue_rod_press_and_hold(&tissue, 0.004, &mean);
        oracle_mesh *soft = tissue_surface(&tissue, &tissue.body[0]);
        oracle_mesh *rigid = tissue_surface(&tissue, &tissue.body[1]);
        tissue_tool_end(rod, ends);
        for (int side = -1; side <= 1; side += 2) {
            double local[6];
            memcpy(local, ends, sizeof local);
            local[0] -= 0.025 * side;
            local[3] -= 0.025 * side;
            const double gap = oracle_brute(side > 0 ? rigid : soft, local, NULL) - rod->segment.radius;
            CHECK(fabs(gap) < 3e-6, "%s: %g m away", side > 0 ? "rigid" : "soft", gap);
        }
        oracle_brute_close(rigid);
        oracle_brute_close(soft);
    }
    tissue_rig_close(&tissue);
}

/* The spring's energy grows by what the bodies do, and by what a device does that moves without a turn. */
static void work_is_accounted_for_with(uint32_t integrator)
{
    struct tissue_rig tissue;
    const struct tissue_def def = tissue_asleep(DPT_NET_VOLUME, integrator);
    struct tissue_tool *rod = tissue_rig_open_rod(&tissue, 600.0, 1.2, 0.004);
    if (tissue_rig_add_soft(&tissue, &def)) {
        double last[3] = { 0.0, 0.0, 0.0 }, from[3], energy = 0.0, work = 0.0, worst = 0.0, most = 0.0;
        tissue_rod_lower(&tissue, -0.001);
        tissue_rig_place(&tissue);
        memcpy(from, rod->device.position, sizeof from);
        for (int t = 0; t < 900; t++) {
            double by_device = 0.0;
            tissue_rod_lower(&tissue, 0.006 * sin(0.006 * t));
            rod->device.position[1] = 1e-3 * sin(0.05 * t);
            tissue_rig_tick(&tissue);
            for (int k = 0; k < 3; k++) {
                by_device -= 0.5 * (last[k] + rod->force.wrench.force[k]) * (rod->device.position[k] - from[k]);
                last[k] = rod->force.wrench.force[k];
                from[k] = rod->device.position[k];
            }
            worst = fmax(worst, fabs(rod->force.energy - energy - by_device - rod->force.body_work));
            energy = rod->force.energy;
            most = fmax(most, energy);
            work = fmax(work, fabs(rod->force.body_work));
        }
        CHECK(most > 1e-6 && work > 1e-3 * most, "stored %g J, done %g J", most, work);
        CHECK(worst <= 1e-9 * most, "%g J of %g are not accounted for", worst, most);
    }
    tissue_rig_close(&tissue);
}

static void work_is_accounted_for(void)
{
    for (int i = 0; i < TISSUE_INTEGRATORS; i++)
        work_is_accounted_for_with(tissue_integrators[i]);
}

static void tissue_sleeps_with(uint32_t integrator)
{
    struct tissue_rig tissue;
    const struct tissue_def def = tissue_asleep(DPT_NET_VOLUME, integrator);
    struct tissue_tool *rod = tissue_rig_open_rod(&tissue, 500.0, 1.2, 0.004);
    if (tissue_rig_add_soft(&tissue, &def)) {
        double mean, last, jump = 0.0;
        uint64_t seed = 11;
        tissue_rod_press_and_hold(&tissue, 0.005, &mean);
        CHECK(tissue.info[0].active == 0, "%u nodes are awake", tissue.info[0].active);
        const dpt_wrench before = rod->force.wrench;
        for (int t = 0; t < 50; t++)
            tissue_rig_tick(&tissue);
        CHECK(!memcmp(&before, &rod->force.wrench, sizeof before), "asleep, it is felt otherwise");
        last = length3(rod->force.wrench.force);
        for (int t = 0; t < 2000; t++) {
            tissue_rod_lower(&tissue, 0.005 + random_in(&seed, -1e-6, 1e-6) * (1 + t / 100));
            const double force = tissue_rig_tick(&tissue);
            jump = fmax(jump, fabs(force - last) - 1.5 * 500.0 * 2e-6 * (1 + t / 100));
            last = force;
        }
        CHECK(jump < 2e-3, "a tremor makes jumps of %g N beyond its own", jump);
    }
    tissue_rig_close(&tissue);
}

static void tissue_sleeps_under_a_still_tool(void)
{
    for (int i = 0; i < TISSUE_INTEGRATORS; i++)
        tissue_sleeps_with(tissue_integrators[i]);
}

static void wrong_lists_are_refused(void)
{
    struct tissue_rig tissue;
    struct tissue_def def = tissue_asleep(DPT_NET_VOLUME, DPT_INTEGRATOR_SYMPLECTIC);
    tissue_rig_open_rod(&tissue, 500.0, 0.0, 0.004);
    const struct tissue_body *first = tissue_rig_add_soft(&tissue, &def);
    def.place[0] = 0.2;
    const struct tissue_body *second = tissue_rig_add_soft(&tissue, &def);
    if (first && second) {
        dpt_world *world = tissue.rig.world;
        const dpt_body both[2] = { first->id, second->id }, twice[2] = { first->id, first->id };
        const dpt_body none[2] = { first->id, 0 };
        dpt_springs *springs[2] = { first->springs, second->springs }, *same[2] = { first->springs, first->springs };
        const dpt_result results[] = {
            dpt_bodies_step_springs(NULL, both, springs, 2, 1e-3, NULL),
            dpt_bodies_step_springs(world, NULL, springs, 2, 1e-3, NULL),
            dpt_bodies_step_springs(world, both, NULL, 2, 1e-3, NULL),
            dpt_bodies_step_springs(world, twice, springs, 2, 1e-3, NULL),
            dpt_bodies_step_springs(world, both, same, 2, 1e-3, NULL),
        };
        for (size_t i = 0; i < sizeof results / sizeof *results; i++)
            CHECK(results[i] == DPT_E_ARGUMENT, "case %zu: %s", i, dpt_result_name(results[i]));
        CHECK(dpt_bodies_step_springs(world, none, springs, 2, 1e-3, NULL) == DPT_E_HANDLE, "no body");
        CHECK(dpt_bodies_step_springs(world, both, springs, 2, 0.0, NULL) == DPT_E_ARGUMENT, "no time");
        CHECK(dpt_bodies_step_springs(world, NULL, NULL, 0, 1e-3, NULL) == DPT_OK, "nothing is not allowed");
    }
    tissue_rig_close(&tissue);
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
