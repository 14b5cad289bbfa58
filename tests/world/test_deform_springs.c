/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * dpt_body_step_springs against the same done by hand, by the public calls of an own physics: loads, a step, positions;
 * in the tick, and in a thread of its own that takes turns with it through the exchange. All must have the same bits. What
 * springs do is not judged here (tests/deform).
 */
#include <pthread.h>
#include <sched.h>

#include "world/deform_scene.h"

enum { TICKS = 600, NODES_MOST = 4096, LOADS_MOST = 4096 };
#define TICK 1e-3

struct cushion {
    struct deform_scene scene;
    void *block;
    dpt_springs *springs;
    uint32_t nodes;
    int is_embedded;
    dpt_pose pose;
    dpt_springs_info report;
};

static int make_mesh(struct fixture *fixture, uint32_t kind)
{
    const dpt_spring_region border = { .kind = DPT_REGION_BOX,
                                       .fixed = 1,
                                       .box = { -1.0, -1.0, -1.0, 1.0, -0.02, 1.0 } };
    const dpt_spring_net_def net = { .size = sizeof net,
                                     .kind = kind,
                                     .young = 2e4,
                                     .density = 1000.0,
                                     .drag = 5.0,
                                     .viscosity = 1e-3,
                                     .spacing = kind == DPT_NET_VOLUME ? 0.02 : 0.0,
                                     .regions = &border,
                                     .region_count = 1 };
    return fixture_with_springs(fixture, kind == DPT_NET_SHEET ? "membrane" : "sphere", 512, &net);
}

/* A ball on a stick above the body's middle; the membrane lies in z = 0. */
static int open_cushion(struct cushion *cushion, uint32_t kind, uint32_t integrator, double sleep_speed)
{
    const dpt_segment ball = { { 0.0, 0.0, 0.0 }, { 0.0, 0.0, 0.03 }, 0.004 };
    dpt_deformable_def deform;
    dpt_springs_def springs;
    dpt_deformable_def_init(&deform);
    dpt_springs_def_init(&springs);
    memset(cushion, 0, sizeof *cushion);
    if (!make_mesh(&cushion->scene.fixture, kind))
        return 0;
    deform.load_radius = 0.02;
    if (!deform_scene_open_mesh(&cushion->scene, NULL, &deform))
        return 0;
    springs.mesh = cushion->scene.fixture.mesh;
    springs.integrator = integrator;
    springs.sleep_speed = sleep_speed;
    cushion->block = malloc(dpt_springs_bytes(&springs));
    const dpt_result result =
        dpt_springs_create(cushion->block, dpt_springs_bytes(&springs), &springs, &cushion->springs);
    CHECK(result == DPT_OK, "%s", dpt_result_name(result));
    /* With a proxy, tool and springs would be solved together. */
    rig_set_law(&cushion->scene.rig, rig_add_tool(&cushion->scene.rig, &ball, 1), DPT_LAW_POINT, 500.0);
    cushion->nodes = dpt_springs_get_count(cushion->springs);
    cushion->is_embedded = kind == DPT_NET_VOLUME;
    cushion->report.size = sizeof cushion->report;
    CHECK(cushion->nodes <= NODES_MOST, "%u nodes", cushion->nodes);
    return result == DPT_OK && cushion->nodes <= NODES_MOST;
}

static void close_cushion(struct cushion *cushion)
{
    free(cushion->block);
    deform_scene_close(&cushion->scene);
}

/* The ball comes down, presses, slides, and leaves. */
static void step_world(struct cushion *cushion, int tick)
{
    const double t = TICK * tick;
    cushion->pose =
        (dpt_pose){ { 0.0, 0.02 + 0.01 * sin(12.0 * t), cushion->scene.high[2] + 0.005 - 0.03 * sin(6.0 * t) },
                    { 1.0, 0.0, 0.0, 0.0 } };
    CHECK((tick ? dpt_tool_set_pose : dpt_tool_teleport)(cushion->scene.rig.world, cushion->scene.rig.tool,
                                                         &cushion->pose) == DPT_OK,
          "no pose");
    rig_tick(&cushion->scene.rig);
}

static double force_of(const struct cushion *cushion)
{
    dpt_force_info force = { .size = sizeof force };
    dpt_tool_get_force_info(cushion->scene.rig.world, cushion->scene.rig.tool, &force);
    return force.wrench.force[2];
}

/* ---- by hand ---- */

static uint32_t read_loads(const struct cushion *cushion, dpt_load *loads)
{
    uint32_t count = 0;
    const dpt_result result =
        cushion->is_embedded
            ? dpt_body_get_node_loads(cushion->scene.rig.world, cushion->scene.rig.body, loads, LOADS_MOST, &count)
            : dpt_body_get_loads(cushion->scene.rig.world, cushion->scene.rig.body, loads, LOADS_MOST, &count);
    CHECK(result == DPT_OK, "%s", dpt_result_name(result));
    return count;
}

static void hand_over(struct cushion *cushion, const float *nodes)
{
    const dpt_result result =
        cushion->is_embedded
            ? dpt_body_set_nodes(cushion->scene.rig.world, cushion->scene.rig.body, nodes)
            : dpt_body_set_vertices(cushion->scene.rig.world, cushion->scene.rig.body, 0, cushion->nodes, nodes, -1.0);
    CHECK(result == DPT_OK, "%s", dpt_result_name(result));
}

static void step_by_hand(struct cushion *cushion)
{
    static dpt_load loads[LOADS_MOST];
    static float nodes[3 * NODES_MOST];
    const uint32_t count = read_loads(cushion, loads);
    CHECK(dpt_springs_step(cushion->springs, TICK, loads, count, NULL) == DPT_OK, "no physics");
    dpt_springs_get_nodes(cushion->springs, cushion->nodes, nodes, NULL);
    hand_over(cushion, nodes);
}

/* ---- a thread of its own ---- */

struct places {
    dpt_latest latest;
    struct {
        uint32_t count;
        dpt_load loads[LOADS_MOST];
        float nodes[3 * NODES_MOST];
    } place[DPT_LATEST_PLACES];
};

struct physics {
    struct cushion *cushion;
    struct places loads, nodes;
};

static void wait_for(dpt_latest *latest)
{
    while (!dpt_latest_take(latest))
        sched_yield();
}

static void *physics_thread(void *user)
{
    struct physics *physics = user;
    for (int tick = 0; tick < TICKS; tick++) {
        wait_for(&physics->loads.latest);
        const uint32_t from = physics->loads.latest.reading, to = physics->nodes.latest.writing;
        CHECK(dpt_springs_step(physics->cushion->springs, TICK, physics->loads.place[from].loads,
                               physics->loads.place[from].count, NULL) == DPT_OK,
              "no physics");
        dpt_springs_get_nodes(physics->cushion->springs, physics->cushion->nodes, physics->nodes.place[to].nodes, NULL);
        dpt_latest_publish(&physics->nodes.latest);
    }
    return NULL;
}

static void step_by_thread(struct physics *physics)
{
    const uint32_t to = physics->loads.latest.writing;
    physics->loads.place[to].count = read_loads(physics->cushion, physics->loads.place[to].loads);
    dpt_latest_publish(&physics->loads.latest);
    wait_for(&physics->nodes.latest);
    hand_over(physics->cushion, physics->nodes.place[physics->nodes.latest.reading].nodes);
}

/* ---- */

static void check_same(uint32_t kind, uint32_t integrator, double sleep_speed)
{
    static struct physics physics;
    static struct cushion cushions[3]; /* the call, by hand, by a thread */
    pthread_t thread;
    double peak = 0.0;
    uint32_t least = UINT32_MAX;
    int is_open = 1;
    for (int i = 0; i < 3; i++)
        is_open &= open_cushion(&cushions[i], kind, integrator, sleep_speed);
    physics.cushion = &cushions[2];
    dpt_latest_init(&physics.loads.latest);
    dpt_latest_init(&physics.nodes.latest);
    is_open = is_open && pthread_create(&thread, NULL, physics_thread, &physics) == 0;
    CHECK(is_open, "not open");
    for (int tick = 0; is_open && tick < TICKS; tick++) {
        const float *positions[3];
        uint32_t count;
        for (int i = 0; i < 3; i++)
            step_world(&cushions[i], tick);
        const dpt_result result = dpt_body_step_springs(cushions[0].scene.rig.world, cushions[0].scene.rig.body,
                                                        cushions[0].springs, TICK, &cushions[0].report);
        CHECK(result == DPT_OK, "%s", dpt_result_name(result));
        step_by_hand(&cushions[1]);
        step_by_thread(&physics);
        for (int i = 0; i < 3; i++)
            dpt_body_get_vertices(cushions[i].scene.rig.world, cushions[i].scene.rig.body, &positions[i], &count);
        for (int i = 1; i < 3; i++)
            CHECK(!memcmp(positions[0], positions[i], 3 * sizeof(float) * count) &&
                      force_of(&cushions[0]) == force_of(&cushions[i]),
                  "tick %d, %s: other vertices, %g N and %g", tick, i == 1 ? "by hand" : "thread",
                  force_of(&cushions[0]), force_of(&cushions[i]));
        peak = fmax(peak, force_of(&cushions[0]));
        least = cushions[0].report.active < least ? cushions[0].report.active : least;
    }
    if (is_open)
        pthread_join(thread, NULL);
    CHECK(peak > 0.01, "%g N at most", peak);
    CHECK((least < cushions[0].nodes) == (sleep_speed > 0.0), "at least %u of %u awake", least, cushions[0].nodes);
    for (int i = 0; i < 3; i++)
        close_cushion(&cushions[i]);
}

static void a_sheet_is_as_by_hand(void)
{
    check_same(DPT_NET_SHEET, DPT_INTEGRATOR_SYMPLECTIC, 0.0);
    check_same(DPT_NET_SHEET, DPT_INTEGRATOR_IMPLICIT, 1e-3);
}

static void a_volume_is_as_by_hand(void)
{
    check_same(DPT_NET_VOLUME, DPT_INTEGRATOR_SYMPLECTIC, 1e-3);
    check_same(DPT_NET_VOLUME, DPT_INTEGRATOR_IMPLICIT, 0.0);
}

/* More loads than there is room for: told, and nothing has moved. */
static void too_many_loads_are_told(void)
{
    struct cushion cushion;
    if (open_cushion(&cushion, DPT_NET_SHEET, DPT_INTEGRATOR_SYMPLECTIC, 0.0)) {
        dpt_springs_def def;
        dpt_springs_def_init(&def);
        def.mesh = cushion.scene.fixture.mesh;
        def.max_loads = 1;
        void *block = malloc(dpt_springs_bytes(&def));
        dpt_springs *few = NULL;
        CHECK(dpt_springs_create(block, dpt_springs_bytes(&def), &def, &few) == DPT_OK, "no springs");
        int tick = 0;
        for (; tick < TICKS && force_of(&cushion) == 0.0; tick++) {
            step_world(&cushion, tick);
            dpt_body_step_springs(cushion.scene.rig.world, cushion.scene.rig.body, cushion.springs, TICK, NULL);
        }
        step_world(&cushion, tick);
        float before[3 * NODES_MOST], after[3 * NODES_MOST];
        dpt_springs_get_nodes(few, cushion.nodes, before, NULL);
        const dpt_result result =
            dpt_body_step_springs(cushion.scene.rig.world, cushion.scene.rig.body, few, TICK, NULL);
        dpt_springs_get_nodes(few, cushion.nodes, after, NULL);
        CHECK(result == DPT_E_FULL, "%s", dpt_result_name(result));
        CHECK(!memcmp(before, after, 3 * sizeof *before * cushion.nodes), "it has moved");
        free(block);
    }
    close_cushion(&cushion);
}

int main(void)
{
    TEST(a_sheet_is_as_by_hand);
    TEST(a_volume_is_as_by_hand);
    TEST(too_many_loads_are_told);
    return check_report();
}
