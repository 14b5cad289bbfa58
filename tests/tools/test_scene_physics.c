/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Physics of soft bodies apart from the haptic loop: by the loop's time, to the bit in every run; and in a thread, which
 * stands still with the loop, ends in order, and holds a body that it cannot step in every tick.
 */
#define _POSIX_C_SOURCE 200809L
#include "scene/scene_physics.h"

#include <time.h>

#include "lib/check.h"
#include "lib/fixture.h"
#include "lib/soft_scene.h"
#include "platform/clock.h"

enum { TICKS = 1000, TICKS_ASLEEP_MOST = 20000 };
#define LOOP_RATE 1000.0

static void nap(double seconds)
{
    const struct timespec time = { (time_t)seconds, (long)(1e9 * (seconds - (double)(time_t)seconds)) };
    nanosleep(&time, NULL);
}

struct soft {
    struct soft_scene scene;
    struct scene_physics *physics;
};

static int open_soft(struct soft *soft, const char *name, double rate)
{
    memset(soft, 0, sizeof *soft);
    if (!soft_scene_open(&soft->scene, name, rate, DPT_LAW_PROXY))
        return 0;
    const dpt_result result = scene_physics_open(&soft->physics, &soft->scene.bodies, rate);
    CHECK(result == DPT_OK, "%s", dpt_result_name(result));
    return result == DPT_OK;
}

static void close_soft(struct soft *soft)
{
    scene_physics_close(soft->physics);
    soft_scene_close(&soft->scene);
}

static dpt_result tick(struct soft *soft, double dt)
{
    scene_physics_begin_tick(soft->physics, soft->scene.rig.world);
    dpt_result result = dpt_world_step(soft->scene.rig.world, dt, NULL);
    if (result == DPT_OK)
        result = scene_physics_end_tick(soft->physics, soft->scene.rig.world, dt);
    scene_bodies_count_moves(&soft->scene.bodies, dt);
    return result;
}

static uint64_t steps_of(const struct soft *soft)
{
    return scene_physics_steps(soft->physics);
}

/* Every fourth tick; where the loop lost a sample, its next dt is longer, and no time is lost. */
static void goes_by_the_loops_time(void)
{
    struct soft soft;
    double time = 0.0;
    if (open_soft(&soft, "laparoscopy", 250.0))
        for (int i = 1; i <= TICKS; i++) {
            const double dt = i % 7 ? SOFT_TICK : 3.0 * SOFT_TICK;
            time += dt;
            CHECK(tick(&soft, dt) == DPT_OK, "tick %d", i);
            const double due = 250.0 * time, steps = (double)steps_of(&soft);
            CHECK(steps >= due - 1.0 && steps <= due + 0.5, "%g steps, %g are due", steps, due);
        }
    CHECK(!soft.physics || !scene_physics_get_report(soft.physics).late, "it was late");
    close_soft(&soft);
}

static void press_for(struct soft *soft, int ticks)
{
    soft_scene_press(&soft->scene, 0.01);
    for (int i = 0; i < ticks; i++)
        CHECK(tick(soft, SOFT_TICK) == DPT_OK, "tick %d", i);
}

static void runs_are_the_same(void)
{
    struct soft a, b;
    uint32_t count = 0;
    if (open_soft(&a, "laparoscopy", 500.0) & open_soft(&b, "laparoscopy", 500.0)) {
        press_for(&a, TICKS);
        press_for(&b, TICKS);
        const float *x = soft_scene_vertices(&a.scene, &count);
        const float *y = soft_scene_vertices(&b.scene, &count), *rest;
        CHECK(!memcmp(x, y, 3 * sizeof *x * (size_t)count), "other bits");
        dpt_mesh_get_vertices(a.scene.bodies.body[0].mesh, &rest, &count);
        CHECK(memcmp(x, rest, 3 * sizeof *x * (size_t)count), "nothing has moved");
    }
    close_soft(&a);
    close_soft(&b);
}

/* Moves count the ticks in which vertices moved: while they are under way, until all sleeps. */
static void moves_are_those_of_vertices(void)
{
    struct soft soft;
    int still = 0, asleep = 0;
    if (open_soft(&soft, "membrane", 500.0)) {
        uint32_t count = 0;
        soft_scene_vertices(&soft.scene, &count);
        float *before = calloc(3 * (size_t)count, sizeof *before);
        for (int i = 0; i < TICKS_ASLEEP_MOST && still < 200; i++) {
            const size_t bytes = 3 * sizeof *before * (size_t)count;
            const uint64_t moves = soft.scene.bodies.moves;
            memcpy(before, soft_scene_vertices(&soft.scene, &count), bytes);
            soft_scene_press(&soft.scene, i < TICKS ? 0.005 : -0.02);
            CHECK(tick(&soft, SOFT_TICK) == DPT_OK, "tick %d", i);
            const int has_moved = memcmp(before, soft_scene_vertices(&soft.scene, &count), bytes);
            CHECK(!has_moved || soft.scene.bodies.moves == moves + 1, "tick %d: not counted", i);
            still = soft.scene.bodies.moves == moves && i > TICKS ? still + 1 : 0;
        }
        asleep = still >= 200;
        free(before);
    }
    CHECK(asleep, "moves are counted of what sleeps");
    close_soft(&soft);
}

/* Ticks by the clock for so long, s. Returns the last tick's result. */
static dpt_result tick_for(struct soft *soft, double seconds)
{
    dpt_result result = DPT_OK;
    const uint64_t end = clock_now() + (uint64_t)(1e9 * seconds);
    while (result == DPT_OK && clock_now() < end) {
        result = tick(soft, SOFT_TICK);
        nap(SOFT_TICK);
    }
    return result;
}

static void thread_stands_still_with_the_loop(void)
{
    struct soft soft;
    if (open_soft(&soft, "laparoscopy", 500.0)) {
        const uint64_t began = clock_now();
        CHECK(scene_physics_start(soft.physics, LOOP_RATE) == DPT_OK, "no thread");
        nap(0.05);
        CHECK(steps_of(&soft) == 0, "it began before the loop");
        soft_scene_press(&soft.scene, 0.01);
        CHECK(tick_for(&soft, 0.4) == DPT_OK, "a tick failed");
        nap(0.5);
        const uint64_t stood = steps_of(&soft);
        nap(0.2);
        CHECK(stood > 0 && steps_of(&soft) == stood, "%d steps without a tick", (int)(steps_of(&soft) - stood));
        CHECK(tick_for(&soft, 0.4) == DPT_OK, "a tick failed");
        CHECK(steps_of(&soft) > stood, "it did not go on");
        CHECK(soft.scene.bodies.moves > 0, "the loop got no vertices");
        scene_physics_stop(soft.physics);
        const struct scene_physics_report report = scene_physics_get_report(soft.physics);
        const double seconds = 1e-9 * (double)(clock_now() - began);
        CHECK(report.has_thread && report.asked == 500.0 && report.rate > 0.0, "%g Hz of %g", report.rate,
              report.asked);
        CHECK((double)report.steps <= 500.0 * (seconds - 0.6), "%d steps in %g s", (int)report.steps, seconds);
        CHECK(soft.scene.bodies.nodes > 0 && soft.scene.bodies.active > 0, "no nodes were counted");
    }
    close_soft(&soft);
}

/* Of the body's mesh, but of steps of a second they make 16 substeps at most: they refuse each of them. */
static void *make_stiff(const dpt_mesh *mesh, dpt_springs **springs)
{
    dpt_springs_def def;
    dpt_springs_def_init(&def);
    def.mesh = mesh;
    void *block = malloc(dpt_springs_bytes(&def));
    CHECK(block && dpt_springs_create(block, dpt_springs_bytes(&def), &def, springs) == DPT_OK, "no springs");
    return block;
}

/* Springs that refuse a step: the body is held, and the loop goes on. */
static void errors_hold(void)
{
    for (int has_thread = 0; has_thread < 2; has_thread++) {
        struct soft soft;
        if (open_soft(&soft, "membrane", 1.0)) {
            struct scene_bodies *bodies = &soft.scene.bodies;
            dpt_springs *own = bodies->body[0].springs;
            void *block = make_stiff(bodies->body[0].mesh, &bodies->body[0].springs);
            if (has_thread)
                CHECK(scene_physics_start(soft.physics, LOOP_RATE) == DPT_OK, "no thread");
            const uint64_t end = clock_now() + 5000000000u;
            for (int i = 0; !bodies->is_held && (has_thread ? clock_now() < end : i < TICKS); i++) {
                scene_bodies_begin_tick(bodies, (uint64_t)i);
                CHECK(tick(&soft, SOFT_TICK) == DPT_OK, "tick %d failed", i);
                if (has_thread)
                    nap(SOFT_TICK);
            }
            CHECK(bodies->held == 1 && bodies->body[0].held_why == DPT_E_UNSTABLE, "held on %d ticks: %s",
                  (int)bodies->held, dpt_result_name(bodies->body[0].held_why));
            scene_bodies_begin_tick(bodies, TICKS);
            CHECK(tick(&soft, SOFT_TICK) == DPT_OK && bodies->held == 2, "a tick later it is forgotten");
            CHECK(steps_of(&soft) == 0, "%d steps", (int)steps_of(&soft));
            scene_physics_stop(soft.physics);
            bodies->body[0].springs = own;
            free(block);
        }
        close_soft(&soft);
    }
}

/* Which bodies look a step ahead at 1 kHz and at 100 Hz: cells with a term for their volume do in any step. */
static void bodies_look_ahead(void)
{
    static const struct {
        double poisson, period;
        int foresees;
    } cases[] = { { 0.25, 1e-3, 0 }, { 0.25, 1e-2, 1 }, { 0.3, 1e-3, 1 }, { 0.45, 1e-2, 1 } };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct soft_exchange exchange = { .vertex_count = 0 };
        struct fixture fixture;
        dpt_spring_net_def net;
        dpt_spring_net_def_init(&net);
        net.kind = DPT_NET_VOLUME;
        net.poisson = cases[i].poisson;
        net.spacing = 0.03;
        if (!fixture_with_springs(&fixture, "torus", 320, &net))
            continue;
        CHECK(soft_exchange_open(&exchange, fixture.mesh, 16, 1, cases[i].period) == DPT_OK, "case %zu", i);
        CHECK(!exchange.answers[0].foreseen == !cases[i].foresees, "case %zu", i);
        soft_exchange_close(&exchange);
        fixture_free(&fixture);
    }
}

int main(void)
{
    TEST(goes_by_the_loops_time);
    TEST(runs_are_the_same);
    TEST(moves_are_those_of_vertices);
    TEST(thread_stands_still_with_the_loop);
    TEST(errors_hold);
    TEST(bodies_look_ahead);
    return check_report();
}
