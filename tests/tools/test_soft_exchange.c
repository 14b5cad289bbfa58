/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What passes between the haptic loop and physics: means of loads, which sum up to the mean of the tool's force, one way;
 * vertices that arrive to the bit the other way. In each tick it is the same as springs that are stepped with the world.
 */
#include "scene/scene_physics.h"

#include <math.h>

#include "lib/check.h"
#include "lib/soft_scene.h"

enum { TICKS = 400, TICKS_ASLEEP_MOST = 20000, MAX_POINTS = 16 };

struct soft {
    struct soft_scene scene;
    struct soft_exchange exchange;
    uint64_t handed_over;
    double sum[3]; /* N: of the tool's force, over the ticks since the last step of physics */
    int ticks;
};

static struct scene_body *body_of(struct soft *soft)
{
    return &soft->scene.bodies.body[0];
}

static int open_soft(struct soft *soft, const char *name, double rate, uint32_t law)
{
    memset(soft, 0, sizeof *soft);
    if (!soft_scene_open(&soft->scene, name, rate, law))
        return 0;
    const dpt_result result = soft_exchange_open(&soft->exchange, body_of(soft)->mesh, MAX_POINTS,
                                                 body_of(soft)->compliances != NULL, rate > 0.0 ? 1.0 / rate : 0.0);
    CHECK(result == DPT_OK, "%s", dpt_result_name(result));
    return result == DPT_OK;
}

static void close_soft(struct soft *soft)
{
    soft_exchange_close(&soft->exchange);
    soft_scene_close(&soft->scene);
}

/* The ball goes down by 8 mm, slides on, and comes up again. */
static void lead(struct soft *soft, int tick)
{
    soft_scene_press(&soft->scene, 0.01 * sin(3.1 * tick / TICKS) - 0.001);
    soft->scene.pose.position[0] += 0.005 * tick / TICKS;
    dpt_tool_set_pose(soft->scene.rig.world, soft->scene.rig.tool, &soft->scene.pose);
}

/* Returns whether there were new vertices. */
static int haptic_tick(struct soft *soft)
{
    int is_new = 0;
    dpt_force_info report = { .size = sizeof report };
    dpt_world *world = soft->scene.rig.world;
    CHECK(soft_exchange_take_answer(&soft->exchange, world, body_of(soft)->id, &is_new) == DPT_OK,
          "vertices are refused");
    soft_scene_step(&soft->scene);
    CHECK(!body_of(soft)->compliances ||
              dpt_body_step_springs(world, body_of(soft)->id, NULL, SOFT_TICK, NULL) == DPT_OK,
          "it does not give way");
    dpt_tool_get_force_info(world, soft->scene.rig.tool, &report);
    for (int k = 0; k < 3; k++)
        soft->sum[k] += report.wrench.force[k];
    soft->ticks++;
    CHECK(soft_exchange_give_loads(&soft->exchange, world, body_of(soft)->id) == DPT_OK, "no loads");
    soft->handed_over += (uint64_t)is_new;
    return is_new;
}

static uint32_t physics_step(struct soft *soft, double dt)
{
    dpt_springs_info report = { .size = sizeof report };
    const dpt_result result = soft_exchange_step(&soft->exchange, body_of(soft)->springs, dt, &report);
    CHECK(result == DPT_OK, "%s", dpt_result_name(result));
    return report.active;
}

/* A body of these scenes is turned by -90 degrees about x: (x, y, z) is (x, z, -y) in the world. */
static void check_sums(struct soft *soft, int tick)
{
    const struct soft_loads *loads = &soft->exchange.loads[soft->exchange.latest_loads.reading];
    double sum[3] = { 0.0, 0.0, 0.0 }, size = 1e-3, off = 0.0;
    for (uint32_t i = 0; i < loads->count; i++) {
        sum[0] += loads->load[i].force[0];
        sum[1] += loads->load[i].force[2];
        sum[2] -= loads->load[i].force[1];
    }
    for (int k = 0; k < 3; k++) {
        off = fmax(off, fabs(sum[k] + soft->sum[k] / soft->ticks));
        size = fmax(size, fabs(soft->sum[k] / soft->ticks));
        soft->sum[k] = 0.0;
    }
    soft->ticks = 0;
    CHECK(off <= 1e-6 * size, "tick %d: %u loads are off by %g N of %g", tick, loads->count, off, size);
}

/* At half the loop's rate, both ticks' loads count. */
static void sums_are_the_mean_force(void)
{
    static const char *const names[] = { "membrane", "laparoscopy" };
    for (int n = 0; n < 2; n++) {
        struct soft soft;
        uint32_t loads_most = 0;
        for (int tick = open_soft(&soft, names[n], 500.0, DPT_LAW_PROXY) ? 0 : TICKS; tick < TICKS; tick++) {
            lead(&soft, tick);
            haptic_tick(&soft);
            if (tick % 2 == 0)
                continue;
            physics_step(&soft, 2.0 * SOFT_TICK);
            check_sums(&soft, tick);
            const uint32_t count = soft.exchange.loads[soft.exchange.latest_loads.reading].count;
            loads_most = count > loads_most ? count : loads_most;
        }
        CHECK(loads_most > 3, "%s: only %u loads", names[n], loads_most);
        close_soft(&soft);
    }
}

/* With a period of one tick they are there in the next step; with one of four, after four, and a part of the way before. */
static void vertices_arrive(void)
{
    static const int periods[] = { 1, 4 };
    for (int n = 0; n < 2; n++) {
        struct soft soft;
        int arrived = 0, under_way = 0;
        for (int tick = open_soft(&soft, "laparoscopy", 1000.0 / periods[n], DPT_LAW_POINT) ? 0 : TICKS; tick < TICKS;
             tick++) {
            uint32_t count = 0;
            lead(&soft, tick);
            const int is_new = haptic_tick(&soft);
            const float *bound_for = soft.exchange.answers[soft.exchange.latest_answer.reading].vertices;
            const float *now = soft_scene_vertices(&soft.scene, &count);
            const int is_there = !memcmp(now, bound_for, 3 * sizeof *now * (size_t)count);
            if (soft.handed_over && tick % periods[n] == periods[n] - 1) {
                CHECK(is_there, "period of %d ticks: not there in tick %d", periods[n], tick);
                arrived++;
            }
            under_way += is_new && !is_there;
            if (tick % periods[n] == periods[n] - 1)
                physics_step(&soft, periods[n] * SOFT_TICK);
        }
        CHECK(arrived > TICKS / 8, "they arrived %d times", arrived);
        CHECK(!under_way == (periods[n] == 1), "period of %d ticks: %d times under way", periods[n], under_way);
        close_soft(&soft);
    }
}

/* The nodes of two scenes; and how far vertices of the second one are from where they were at rest. In m. */
static void compare_nodes(const struct soft_scene *a, const struct soft_scene *b, double *off, double *moved)
{
    const struct scene_body *body = &b->bodies.body[0];
    const uint32_t count = dpt_springs_get_count(body->springs);
    float *x = calloc(6 * (size_t)count, sizeof *x), *y = x + 3 * (size_t)count;
    uint32_t vertices = 0;
    const float *rest, *now = soft_scene_vertices(b, &vertices);
    dpt_mesh_get_vertices(body->mesh, &rest, &vertices);
    CHECK(dpt_springs_get_nodes(a->bodies.body[0].springs, count, x, NULL) == DPT_OK &&
              dpt_springs_get_nodes(body->springs, count, y, NULL) == DPT_OK,
          "no nodes");
    for (size_t i = 0; i < 3 * (size_t)count; i++)
        *off = fmax(*off, fabs((double)x[i] - (double)y[i]));
    free(x);
    for (size_t i = 0; i < 3 * (size_t)vertices; i++)
        *moved = fmax(*moved, fabs((double)now[i] - (double)rest[i]));
}

static void is_as_with_the_world(void)
{
    static const char *const names[] = { "membrane", "laparoscopy" };
    for (int n = 0; n < 2; n++) {
        struct soft soft;
        struct soft_scene with;
        double off = 0.0, moved = 0.0;
        /* What a proxy holds is solved together with the tissue in the world, and not where physics is elsewhere. */
        const int is_open =
            open_soft(&soft, names[n], 1000.0, DPT_LAW_POINT) & soft_scene_open(&with, names[n], 0.0, DPT_LAW_POINT);
        for (int tick = is_open ? 0 : TICKS; tick < TICKS; tick++) {
            lead(&soft, tick);
            haptic_tick(&soft);
            physics_step(&soft, SOFT_TICK);
            with.pose = soft.scene.pose;
            dpt_tool_set_pose(with.rig.world, with.rig.tool, &with.pose);
            soft_scene_step(&with);
            CHECK(scene_bodies_step(&with.bodies, with.rig.world, SOFT_TICK) == DPT_OK, "no step");
            compare_nodes(&soft.scene, &with, &off, &moved);
        }
        CHECK(off <= 1e-6 && moved > 3e-4, "%s: %g m off, of %g", names[n], off, moved);
        soft_scene_close(&with);
        close_soft(&soft);
    }
}

/* What sleeps is not handed over, so that the haptic loop has nothing to do. */
static void sleep_is_quiet(void)
{
    struct soft soft;
    int tick = 0, awake = 1;
    if (open_soft(&soft, "laparoscopy", 1000.0, DPT_LAW_PROXY)) {
        for (; tick < TICKS; tick++) {
            lead(&soft, tick);
            haptic_tick(&soft);
            physics_step(&soft, SOFT_TICK);
        }
        soft_scene_press(&soft.scene, -0.02);
        for (; awake && tick < TICKS_ASLEEP_MOST; tick++) {
            haptic_tick(&soft);
            awake = physics_step(&soft, SOFT_TICK) > 0;
        }
        CHECK(!awake, "it is awake after %d ticks", tick);
        haptic_tick(&soft);
        for (int i = 0; i < 100; i++) {
            physics_step(&soft, SOFT_TICK);
            CHECK(!haptic_tick(&soft), "vertices of what sleeps");
        }
    }
    close_soft(&soft);
}

int main(void)
{
    TEST(sums_are_the_mean_force);
    TEST(vertices_arrive);
    TEST(is_as_with_the_world);
    TEST(sleep_is_quiet);
    return check_report();
}
