/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * One body's trouble is not that of the others: what cannot be moved is held where it was and told, and all else is as if it
 * were not there. And the room of what falls goes with it.
 */
#include "world/tissue_rig.h"

enum { NODES = 4096 };

static const dpt_segment lying = { { -0.03, 0.0, 0.0 }, { 0.03, 0.0, 0.0 }, 0.004 };

/* Two balls that two tools press; between them in the list, if it is asked for, one that nothing holds, far away. */
static int open_balls(struct tissue_rig *tissue, uint32_t integrator, int has_third)
{
    struct tissue_def def = tissue_ball();
    int is_there;
    def.integrator = integrator;
    tissue_rig_open(tissue);
    def.place[1] = -0.2;
    is_there = tissue_rig_add_soft(tissue, &def) != NULL;
    if (has_third) {
        def.place[1] = 5.0;
        def.floor = -1.0;
        is_there = is_there && tissue_rig_add_soft(tissue, &def);
        def.floor = -0.02;
    }
    def.place[1] = 0.2;
    is_there = is_there && tissue_rig_add_soft(tissue, &def);
    for (int i = 0; is_there && i < 2; i++) {
        struct tissue_tool *tool = tissue_rig_add_tool(tissue, &lying, 500.0);
        tool->device.position[1] = i ? 0.2 : -0.2;
        tool->device.position[2] = tissue->body[0].top + 0.005;
    }
    if (is_there)
        tissue_rig_place(tissue);
    return is_there;
}

/* All nodes of a body fall, m/s. */
static void let_fall(const struct tissue_body *body, float speed)
{
    static float at[3 * NODES], speeds[3 * NODES];
    const uint32_t nodes = dpt_springs_get_count(body->springs);
    CHECK(nodes <= NODES, "%u nodes", nodes);
    dpt_springs_get_nodes(body->springs, nodes, at, NULL);
    for (uint32_t i = 0; i < nodes; i++) {
        speeds[3 * i] = speeds[3 * i + 1] = 0.0f;
        speeds[3 * i + 2] = -speed;
    }
    CHECK(dpt_springs_set_nodes(body->springs, 0, nodes, at, speeds) == DPT_OK, "not set");
}

/* A body leaves its box of 1 m at 20 m/s: both others are felt as without it, bit for bit, in every tick. */
static void a_body_that_falls_takes_no_force_from_others(void)
{
    for (int i = 0; i < 3; i++) {
        struct tissue_rig with, without;
        int held = 0, differ = 0;
        const int is_there =
            open_balls(&with, tissue_integrators[i], 1) & open_balls(&without, tissue_integrators[i], 0);
        if (is_there)
            let_fall(&with.body[1], 20.0f);
        for (int t = 0; is_there && t < 200; t++) {
            for (int k = 0; k < 2; k++)
                with.tool[k].device.position[2] = without.tool[k].device.position[2] -= 2e-5;
            const int was_held = held > 0;
            tissue_rig_step_world(&with);
            CHECK(!(with.rig.step.flags & DPT_STEP_FLAG_BODY_HELD) == !was_held, "case %d, tick %d: flags %x", i, t,
                  with.rig.step.flags);
            tissue_rig_step_springs(&with);
            tissue_rig_tick(&without);
            held += with.result == DPT_E_FINITE;
            CHECK(with.result == (held ? DPT_E_FINITE : DPT_OK), "case %d, tick %d: %s", i, t,
                  dpt_result_name(with.result));
            CHECK(with.info[0].result == DPT_OK && with.info[2].result == DPT_OK && with.info[1].result == with.result,
                  "case %d, tick %d: %s, %s, %s", i, t, dpt_result_name(with.info[0].result),
                  dpt_result_name(with.info[1].result), dpt_result_name(with.info[2].result));
            for (int k = 0; k < 2; k++)
                differ += memcmp(&with.tool[k].force.wrench, &without.tool[k].force.wrench, sizeof(dpt_wrench)) != 0;
        }
        CHECK(held > 100 && held < 190, "case %d: held in %d ticks", i, held);
        CHECK(!differ, "case %d: %d wrenches differ", i, differ);
        for (int k = 0; is_there && k < 2; k++)
            CHECK(length3(with.tool[k].force.wrench.force) > 0.1, "case %d: %g N", i,
                  length3(with.tool[k].force.wrench.force));
        tissue_rig_close(&with);
        tissue_rig_close(&without);
    }
}

/* It is held as a whole: neither a vertex nor a node of it moves, until it is led back. */
static void what_is_held_has_not_moved(void)
{
    static float vertices[3 * NODES], nodes[3 * NODES], now[3 * NODES];
    struct tissue_rig tissue;
    if (open_balls(&tissue, DPT_INTEGRATOR_SYMPLECTIC, 1)) {
        const struct tissue_body *body = &tissue.body[1];
        const uint32_t count = dpt_springs_get_count(body->springs);
        uint32_t own;
        let_fall(body, 20.0f);
        for (int t = 0; t < 200; t++) {
            const float *at = tissue_vertices(&tissue, body, &own);
            CHECK(own <= NODES && count <= NODES, "no room");
            memcpy(vertices, at, 3 * own * sizeof *at);
            dpt_springs_get_nodes(body->springs, count, nodes, NULL);
            tissue_rig_step_world(&tissue);
            tissue_rig_step_springs(&tissue);
            at = tissue_vertices(&tissue, body, &own);
            dpt_springs_get_nodes(body->springs, count, now, NULL);
            const int is_same = !memcmp(vertices, at, 3 * own * sizeof *at);
            CHECK(is_same == (tissue.result != DPT_OK), "tick %d: vertices %s", t, is_same ? "stand still" : "move");
            CHECK(is_same == !memcmp(nodes, now, 3 * count * sizeof *now), "tick %d: nodes are elsewhere", t);
        }
        CHECK(tissue.result == DPT_E_FINITE, "%s", dpt_result_name(tissue.result));
        let_fall(body, -1.0f);
        tissue_rig_tick(&tissue);
        CHECK(memcmp(vertices, tissue_vertices(&tissue, body, &own), 3 * own * sizeof *vertices) != 0, "it is held on");
    }
    tissue_rig_close(&tissue);
}

/* One of two bodies needs more substeps than there may be: it is held, and the other goes on. */
static void a_body_that_is_too_stiff_is_held_alone(void)
{
    struct tissue_rig tissue;
    struct tissue_def def = tissue_ball();
    tissue_rig_open(&tissue);
    def.place[1] = 1.0;
    def.stiffness = 1e6;
    int is_there = tissue_rig_add_soft(&tissue, &def) != NULL;
    def.place[1] = 0.0;
    def.stiffness = 1.0;
    is_there = is_there && tissue_rig_add_soft(&tissue, &def);
    if (is_there) {
        struct tissue_tool *tool = tissue_rig_add_tool(&tissue, &lying, 500.0);
        tool->device.position[2] = tissue.body[1].top + 0.005;
        tissue_rig_place(&tissue);
        for (int t = 0; t < 200; t++) {
            tool->device.position[2] -= 2e-5;
            tissue_rig_step_world(&tissue);
            tissue_rig_step_springs(&tissue);
            CHECK(tissue.result == DPT_E_UNSTABLE && tissue.info[0].result == DPT_E_UNSTABLE &&
                      tissue.info[1].result == DPT_OK && tissue.info[1].active > 0,
                  "tick %d: %s", t, dpt_result_name(tissue.result));
        }
        CHECK(length3(tool->force.wrench.force) > 0.1, "%g N", length3(tool->force.wrench.force));
        CHECK(tool->force.reason == DPT_FORCE_ACTS, "reason %u", tool->force.reason);
    }
    tissue_rig_close(&tissue);
}

/* Vertices of one's own that are out of the box, or no numbers: nothing moves, and the next step tells it, and it alone. */
static void what_is_refused_is_told(void)
{
    static float positions[3 * NODES];
    struct fixture ball;
    dpt_deformable_def def;
    struct rig rig;
    dpt_deformable_def_init(&def);
    for (int k = 0; k < 3; k++) {
        def.box_min[k] = -1.0;
        def.box_max[k] = 1.0;
    }
    if (fixture_from_shape(&ball, "sphere", 512) && rig_open(&rig, NULL, NULL, &rig_point, 1)) {
        const float *at;
        uint32_t count;
        def.mesh = ball.mesh;
        const dpt_body body = rig_add_deformable(&rig, &def);
        rig.device.position[2] = 0.2;
        rig_place(&rig);
        for (int i = 0; i < 40; i++) {
            dpt_body_get_vertices(rig.world, body, &at, &count);
            CHECK(count <= NODES, "%u vertices", count);
            memcpy(positions, at, 3 * count * sizeof *at);
            const int is_wrong = i % 3 > 0;
            positions[3 * (count / 2) + 1] = i % 3 == 1 ? 1.001f : i % 3 == 2 ? NAN : 0.9f;
            const dpt_result result = dpt_body_set_vertices(rig.world, body, 0, count, positions, -1.0);
            CHECK(result == (is_wrong ? DPT_E_FINITE : DPT_OK), "%s", dpt_result_name(result));
            rig_step(&rig);
            CHECK(!(rig.step.flags & DPT_STEP_FLAG_BODY_HELD) == !is_wrong, "step %d: flags %x", i, rig.step.flags);
            CHECK(rig.hit.status == DPT_STATUS_EXACT && rig.step.distance > 0.0, "step %d: no answer", i);
            rig_step(&rig);
            CHECK(!(rig.step.flags & DPT_STEP_FLAG_BODY_HELD), "step %d: it is told again", i);
        }
        rig_close(&rig);
    }
    fixture_free(&ball);
}

/* A snapshot has it, after the step of the springs and in the next tick. */
static void snapshots_have_it(void)
{
    struct tissue_rig tissue;
    if (open_balls(&tissue, DPT_INTEGRATOR_SYMPLECTIC, 1)) {
        dpt_snapshot_def def;
        dpt_snapshot_def_init(&def);
        const size_t bytes = dpt_snapshot_bytes(tissue.rig.world, &def);
        void *block = malloc(bytes);
        int told = 0;
        let_fall(&tissue.body[1], 20.0f);
        for (int t = 0; t < 100; t++) {
            size_t size;
            dpt_snapshot_info info = { .size = sizeof info };
            tissue_rig_step_world(&tissue);
            tissue_rig_step_springs(&tissue);
            CHECK(dpt_world_take_snapshot(tissue.rig.world, &def, block, bytes, &size) == DPT_OK, "no snapshot");
            CHECK(dpt_snapshot_get_info(block, size, &info) == DPT_OK && info.bodies == 3, "%u bodies", info.bodies);
            for (uint32_t b = 0; b < info.bodies; b++) {
                dpt_snapshot_body body = { .size = sizeof body };
                CHECK(dpt_snapshot_get_body(block, size, b, &body) == DPT_OK, "no body");
                const int is_held = (body.flags & DPT_SNAPSHOT_BODY_FLAG_HELD) != 0;
                CHECK(is_held == (b == 1 && tissue.result != DPT_OK), "tick %d, body %u: flags %x", t, b, body.flags);
                told += is_held;
            }
        }
        CHECK(told > 10, "told in %d", told);
        free(block);
    }
    tissue_rig_close(&tissue);
}

/* The vertices of a mesh from `first` on, elsewhere. */
static void shift(const float *rest, uint32_t first, uint32_t count, const double by[3], float *to)
{
    for (uint32_t i = 3 * first; i < 3 * (first + count); i++)
        to[i] = (float)((double)rest[i] + by[i % 3]);
}

/* Bodies enough for lists of those that are near: they lie far away. */
static void add_others(struct rig *rig, const dpt_mesh *mesh)
{
    dpt_pose pose = DPT_POSE_IDENTITY;
    for (int i = 0; i < 4; i++) {
        pose.position[0] = 40.0 + i;
        rig_add_body(rig, mesh, &pose);
    }
}

/*
 * A body that falls by 10 m, one half of it after the other, and is thrown about, is found where it is, by brute force over
 * its positions; the tool goes with it, and then comes near.
 */
static void the_room_of_a_body_goes_with_it(void)
{
    static float positions[3 * NODES];
    for (int budget = 0; budget < 2; budget++) {
        struct fixture ball;
        struct rig exact, brute;
        dpt_world_def def = rig_def(DPT_LAW_PROXY), truth = rig_def(DPT_LAW_POINT);
        dpt_deformable_def deform;
        uint64_t seed = 5;
        def.budget = budget ? 40 : 0;
        truth.method = DPT_METHOD_BRUTE;
        dpt_deformable_def_init(&deform);
        if (fixture_from_shape(&ball, "sphere", 512) && rig_open(&exact, &def, NULL, &lying, 1) &&
            rig_open(&brute, &truth, NULL, &lying, 1)) {
            const float *rest;
            uint32_t count, exactly = 0;
            double by[3] = { 0.0, 0.0, 0.0 };
            dpt_mesh_get_vertices(ball.mesh, &rest, &count);
            deform.mesh = ball.mesh;
            dpt_body in_exact = rig_add_deformable(&exact, &deform), in_brute = rig_add_deformable(&brute, &deform);
            add_others(&exact, ball.mesh);
            add_others(&brute, ball.mesh);
            CHECK(count <= NODES, "%u vertices", count);
            memcpy(positions, rest, 3 * count * sizeof *rest);
            for (int t = 0; t < 2000; t++) {
                const uint32_t half = count / 2, first = t % 2 ? half : 0, some = t % 2 ? count - half : half;
                by[2] -= 0.005;
                for (int k = 0; k < 2; k++)
                    by[k] += random_in(&seed, -1e-4, 1e-4) * (t % 500 == 0 ? 2e4 : 1.0);
                shift(rest, first, some, by, positions);
                CHECK(dpt_body_set_vertices(exact.world, in_exact, first, some, positions + 3 * first, -1.0) ==
                              DPT_OK &&
                          dpt_body_set_vertices(brute.world, in_brute, first, some, positions + 3 * first, -1.0) ==
                              DPT_OK,
                      "tick %d: refused", t);
                memcpy(exact.device.position, by, sizeof by);
                exact.device.position[2] += 0.16 + 0.1 * sin(0.009 * t);
                brute.device = exact.device;
                rig_step(&exact);
                rig_step(&brute);
                const double off = fabs(exact.hit.distance - brute.hit.distance);
                const int is_exact = exact.hit.status == DPT_STATUS_EXACT;
                CHECK(!is_exact || off <= exact.hit.error_bound + brute.hit.error_bound, "tick %d: off by %g m", t,
                      off);
                CHECK(!is_exact || exact.hit.error_bound < 1e-10, "tick %d: error bound %g m", t,
                      exact.hit.error_bound);
                CHECK(exact.hit.lower_bound <= brute.hit.distance + 1e-12, "tick %d: a bound of %g m at %g m", t,
                      exact.hit.lower_bound, brute.hit.distance);
                exactly += (uint32_t)is_exact;
            }
            CHECK(exactly > (budget ? 300u : 1999u), "exact in %u", exactly);
        }
        rig_close(&exact);
        rig_close(&brute);
        fixture_free(&ball);
    }
}

int main(void)
{
    TEST(a_body_that_falls_takes_no_force_from_others);
    TEST(what_is_held_has_not_moved);
    TEST(a_body_that_is_too_stiff_is_held_alone);
    TEST(what_is_refused_is_told);
    TEST(snapshots_have_it);
    TEST(the_room_of_a_body_goes_with_it);
    return check_report();
}
