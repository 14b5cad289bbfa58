/* SPDX-License-Identifier: BSD-3-Clause */
#include "scene/scene_physics.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "platform/clock.h"
#include "platform/thread.h"

/* Loads that a body may have at a time: for each point at which a tool pushes (body.h), and at least. */
enum { VERTICES_OF_POINT = 256, LOADS_MIN = 2048, NODES_OF_VERTEX = 4 };

/* s: in longer steps of physics, volumes look ahead as well. */
#define FORESEEN_PERIOD 3e-3

/* Whether its cells have terms for their volume: springs alone have a ratio of 1/4. */
static int keeps_volume(const dpt_mesh *mesh)
{
    dpt_mesh_info info = { .size = sizeof info };
    return dpt_mesh_get_info(mesh, &info) == DPT_OK && fabs(info.poisson - 0.25) > 1e-12;
}

static dpt_result open_nodes(struct soft_exchange *exchange, const dpt_mesh *mesh)
{
    const float *rest;
    dpt_result result = dpt_mesh_get_vertices(mesh, &rest, &exchange->vertex_count);
    if (result == DPT_OK)
        result = dpt_mesh_get_embedding(mesh, &exchange->embedding, &exchange->weights, &exchange->node_count);
    if (result != DPT_OK)
        return result;
    if (!exchange->node_count) {
        exchange->node_count = exchange->vertex_count;
        exchange->embedding = NULL;
        return DPT_OK;
    }
    exchange->nodes = calloc(3 * (size_t)exchange->node_count, sizeof *exchange->nodes);
    exchange->node_loads = calloc(NODES_OF_VERTEX * (size_t)exchange->loads_room, sizeof *exchange->node_loads);
    return exchange->nodes && exchange->node_loads ? DPT_OK : DPT_E_MEMORY;
}

dpt_result soft_exchange_open(struct soft_exchange *exchange, const dpt_mesh *mesh, uint32_t max_points,
                              int has_compliance, double period)
{
    exchange->has_compliance = has_compliance;
    exchange->loads_room = VERTICES_OF_POINT * max_points;
    if (exchange->loads_room < LOADS_MIN)
        exchange->loads_room = LOADS_MIN;
    dpt_result result = open_nodes(exchange, mesh);
    dpt_latest_init(&exchange->latest_answer);
    dpt_latest_init(&exchange->latest_loads);
    for (int i = 0; result == DPT_OK && i < DPT_LATEST_PLACES; i++) {
        struct soft_answer *answer = &exchange->answers[i];
        answer->vertices = calloc(3 * (size_t)exchange->vertex_count, sizeof(float));
        answer->loads.load = calloc(exchange->loads_room, sizeof(dpt_load));
        exchange->loads[i].load = calloc(exchange->loads_room, sizeof(dpt_load));
        /*
         * Of a sheet the nodes are light. A body that has volume is held without, at half of the cost, but it lags; not
         * where its cells keep their volume.
         */
        const int foresees = has_compliance && (!exchange->embedding || period > FORESEEN_PERIOD || keeps_volume(mesh));
        answer->foreseen = foresees ? calloc(3 * (size_t)exchange->vertex_count, sizeof(float)) : NULL;
        if ((foresees && !answer->foreseen) || !answer->vertices || !answer->loads.load || !exchange->loads[i].load)
            result = DPT_E_MEMORY;
    }
    return result;
}

void soft_exchange_close(struct soft_exchange *exchange)
{
    for (int i = 0; i < DPT_LATEST_PLACES; i++) {
        free(exchange->answers[i].vertices);
        free(exchange->answers[i].foreseen);
        free(exchange->answers[i].loads.load);
        free(exchange->loads[i].load);
    }
    free(exchange->nodes);
    free(exchange->node_loads);
    *exchange = (struct soft_exchange){ .nodes = NULL };
}

dpt_result soft_exchange_take_answer(struct soft_exchange *exchange, dpt_world *world, dpt_body body, int *is_new)
{
    *is_new = 0;
    if (!dpt_latest_take(&exchange->latest_answer))
        return DPT_OK;
    const struct soft_answer *answer = &exchange->answers[exchange->latest_answer.reading];
    const dpt_result result = exchange->has_compliance
                                  ? dpt_body_set_answered_loads(world, body, answer->loads.load, answer->loads.count)
                                  : DPT_OK;
    *is_new = answer->has_moved;
    if (result != DPT_OK || !answer->has_moved)
        return result;
    const dpt_result moved = dpt_body_set_vertices(world, body, 0, exchange->vertex_count, answer->vertices, -1.0);
    return moved == DPT_OK && answer->foreseen
               ? dpt_body_set_foreseen_vertices(world, body, 0, exchange->vertex_count, answer->foreseen)
               : moved;
}

dpt_result soft_exchange_give_loads(struct soft_exchange *exchange, const dpt_world *world, dpt_body body)
{
    struct soft_loads *loads = &exchange->loads[exchange->latest_loads.writing];
    double seconds;
    const dpt_result result =
        exchange->has_compliance
            ? dpt_body_get_mean_loads(world, body, loads->load, exchange->loads_room, &loads->count, &seconds)
            : dpt_body_get_loads(world, body, loads->load, exchange->loads_room, &loads->count);
    if (result == DPT_OK)
        dpt_latest_publish(&exchange->latest_loads);
    return result;
}

/* Vertices follow their nodes. It is done by physics, because it takes as long as many a tick. */
static void place_vertices(const struct soft_exchange *exchange, float *to)
{
    for (size_t v = 0; v < exchange->vertex_count; v++) {
        const uint32_t *nodes = exchange->embedding + NODES_OF_VERTEX * v;
        const float *weights = exchange->weights + NODES_OF_VERTEX * v;
        double sum[3] = { 0.0, 0.0, 0.0 };
        for (int i = 0; i < NODES_OF_VERTEX; i++)
            for (int k = 0; k < 3; k++)
                sum[k] += (double)weights[i] * (double)exchange->nodes[3 * (size_t)nodes[i] + (size_t)k];
        for (int k = 0; k < 3; k++)
            to[3 * v + (size_t)k] = (float)sum[k];
    }
}

/* And their loads are their nodes'. */
static const dpt_load *loads_of_nodes(const struct soft_exchange *exchange, const struct soft_loads *loads,
                                      uint32_t *count)
{
    *count = loads->count;
    if (!exchange->embedding)
        return loads->load;
    for (size_t i = 0; i < NODES_OF_VERTEX * (size_t)loads->count; i++) {
        const dpt_load *from = &loads->load[i / NODES_OF_VERTEX];
        const size_t at = NODES_OF_VERTEX * (size_t)from->vertex + i % NODES_OF_VERTEX;
        exchange->node_loads[i] = (dpt_load){ .vertex = exchange->embedding[at] };
        for (int k = 0; k < 3; k++)
            exchange->node_loads[i].force[k] = (double)exchange->weights[at] * from->force[k];
    }
    *count *= NODES_OF_VERTEX;
    return exchange->node_loads;
}

static void copy_loads(struct soft_loads *to, const struct soft_loads *from)
{
    to->count = from->count;
    memcpy(to->load, from->load, from->count * sizeof *from->load);
}

dpt_result soft_exchange_step(struct soft_exchange *exchange, dpt_springs *springs, double dt, dpt_springs_info *report)
{
    dpt_latest_take(&exchange->latest_loads);
    const struct soft_loads *loads = &exchange->loads[exchange->latest_loads.reading];
    struct soft_answer *answer = &exchange->answers[exchange->latest_answer.writing];
    uint32_t count;
    const dpt_load *on_nodes = loads_of_nodes(exchange, loads, &count);
    dpt_result result = dpt_springs_step(springs, dt, on_nodes, count, report);
    if (result != DPT_OK)
        return result;
    copy_loads(&answer->loads, loads);
    answer->has_moved = report->active > 0;
    if (answer->has_moved)
        result = dpt_springs_get_nodes(springs, exchange->node_count,
                                       exchange->embedding ? exchange->nodes : answer->vertices, NULL);
    if (result == DPT_OK && exchange->embedding && answer->has_moved)
        place_vertices(exchange, answer->vertices);
    if (result == DPT_OK && answer->has_moved && answer->foreseen)
        result = dpt_springs_foresee(springs, dt, on_nodes, count, exchange->node_count,
                                     exchange->embedding ? exchange->nodes : answer->foreseen);
    if (result != DPT_OK)
        return result;
    if (exchange->embedding && answer->has_moved && answer->foreseen)
        place_vertices(exchange, answer->foreseen);
    if (answer->has_moved || exchange->has_compliance)
        dpt_latest_publish(&exchange->latest_answer);
    return DPT_OK;
}

/* Without a tick for so long, physics stands still. */
#define LOOP_PERIODS_HELD 3.0
#define SECONDS_HELD      0.02

/* ns: how long the thread sleeps before it looks whether it must end. */
#define NAP 20000000u

/* A ratio of rates is a whole number within this share of it. */
#define WHOLE_NUMBER 1e-9

struct scene_physics {
    struct scene_bodies *bodies;
    struct soft_exchange exchange[DPT_ARM_BODIES_MAX]; /* of those that have springs */
    double rate, period;                               /* Hz, s */
    /* Of the haptic loop. */
    double due; /* s of the loop that were not stepped yet */
    /* Of the side that steps. */
    uint64_t late;
    /* Written by the haptic thread, read by physics, and the other way. */
    uint64_t ticks;
    uint64_t steps;
    int32_t results[DPT_ARM_BODIES_MAX]; /* of each body's last step */
    /* The thread. */
    pthread_t thread;
    int is_running, has_thread;
    uint32_t must_end;
    uint64_t held_ns;
};

dpt_result scene_physics_choose(struct scene_bodies *bodies, const char *path, const char *name, double rate,
                                dpt_host_error *error)
{
    int is_soft = 0;
    if (!(rate >= SCENE_PHYSICS_RATE_MIN && rate <= SCENE_PHYSICS_RATE_MAX))
        return host_refuse(error, DPT_E_ARGUMENT, "%s must be %g to %g", name, SCENE_PHYSICS_RATE_MIN,
                           SCENE_PHYSICS_RATE_MAX);
    for (uint32_t i = 0; i < bodies->count; i++) {
        struct scene_body *body = &bodies->body[i];
        if (!scene_body_is_soft(body))
            continue;
        is_soft = 1;
        if (body->response == DPT_RESPONSE_DISPLACE)
            return host_refuse(error, DPT_E_UNSUPPORTED,
                               "%s: %s: bodies[%u] is displaced by the tool, which is part of "
                               "each tick: its springs cannot be stepped apart",
                               path, name, (unsigned)i);
        body->apart = 1.0 / rate;
        body->period = fmax(body->period, body->apart);
    }
    return is_soft ? DPT_OK : host_refuse(error, DPT_E_ARGUMENT, "%s: %s: none of its bodies gives way", path, name);
}

dpt_result scene_physics_check_loop(const char *name, double rate, double loop_rate, dpt_host_error *error)
{
    const double ratio = loop_rate / rate, whole = round(ratio);
    if (whole >= 1.0 && fabs(ratio - whole) <= WHOLE_NUMBER * ratio)
        return DPT_OK;
    return host_refuse(error, DPT_E_ARGUMENT,
                       "%s %g: this device has a time of its own, so that physics is stepped "
                       "every so many ticks: its rate must divide the %g Hz of the loop",
                       name, rate, loop_rate);
}

dpt_result scene_physics_open(struct scene_physics **made, struct scene_bodies *bodies, double rate)
{
    dpt_deformable_def def;
    dpt_result result = DPT_OK;
    struct scene_physics *physics = *made = calloc(1, sizeof *physics);
    if (!physics)
        return DPT_E_MEMORY;
    physics->bodies = bodies;
    physics->rate = rate;
    physics->period = 1.0 / rate;
    dpt_deformable_def_init(&def);
    for (uint32_t i = 0; result == DPT_OK && i < bodies->count; i++)
        if (bodies->body[i].springs)
            result = soft_exchange_open(&physics->exchange[i], bodies->body[i].mesh, def.max_points,
                                        bodies->body[i].compliances != NULL, physics->period);
    return result;
}

void scene_physics_close(struct scene_physics *physics)
{
    if (!physics)
        return;
    scene_physics_stop(physics);
    for (uint32_t i = 0; i < DPT_ARM_BODIES_MAX; i++)
        soft_exchange_close(&physics->exchange[i]);
    free(physics);
}

/* A body that cannot go on stays where it was, and is tried again in the next step. */
static void step(struct scene_physics *physics)
{
    struct scene_bodies *bodies = physics->bodies;
    int is_whole = 1;
    for (uint32_t i = 0; i < bodies->count; i++) {
        dpt_springs_info report = { .size = sizeof report };
        if (!bodies->body[i].springs)
            continue;
        const dpt_result result =
            soft_exchange_step(&physics->exchange[i], bodies->body[i].springs, physics->period, &report);
        bodies->nodes += report.nodes;
        bodies->active += report.active;
        __atomic_store_n(&physics->results[i], result, __ATOMIC_RELAXED);
        is_whole &= result == DPT_OK;
    }
    __atomic_store_n(&physics->steps, physics->steps + (uint64_t)is_whole, __ATOMIC_RELAXED);
}

void scene_physics_begin_tick(struct scene_physics *physics, dpt_world *world)
{
    for (uint32_t i = 0; i < physics->bodies->count; i++) {
        const struct scene_body *body = &physics->bodies->body[i];
        int is_new = 0;
        if (!body->springs)
            continue;
        dpt_result result = __atomic_load_n(&physics->results[i], __ATOMIC_RELAXED);
        if (result == DPT_OK)
            result = soft_exchange_take_answer(&physics->exchange[i], world, body->id, &is_new);
        if (result != DPT_OK)
            scene_bodies_hold(physics->bodies, i, result);
        else if (is_new)
            scene_bodies_note_moving(physics->bodies, body->period);
    }
}

/* By the loop's time: whatever is nearer to this tick than to the next one. */
static dpt_result step_by_ticks(struct scene_physics *physics, double dt)
{
    if (!(dt >= 0.0 && dt <= DPT_SPRINGS_STEP_MAX))
        return DPT_E_ARGUMENT;
    for (physics->due += dt; physics->due >= physics->period - 0.5 * dt; physics->due -= physics->period)
        step(physics);
    for (uint32_t i = 0; i < physics->bodies->count; i++)
        if (physics->results[i] != DPT_OK)
            scene_bodies_hold(physics->bodies, i, physics->results[i]);
    return DPT_OK;
}

/* Between two steps of physics tools and bodies are solved together, all in one call. */
static void give_way(struct scene_bodies *bodies, dpt_world *world, double dt)
{
    dpt_body ids[DPT_ARM_BODIES_MAX] = { 0 };
    dpt_springs *none[DPT_ARM_BODIES_MAX] = { NULL };
    dpt_springs_info reports[DPT_ARM_BODIES_MAX];
    uint32_t index[DPT_ARM_BODIES_MAX], count = 0;
    for (uint32_t i = 0; i < bodies->count; i++) {
        if (!bodies->body[i].compliances)
            continue;
        ids[count] = bodies->body[i].id;
        reports[count] = (dpt_springs_info){ .size = sizeof *reports };
        index[count++] = i;
    }
    dpt_bodies_step_springs(world, ids, none, count, dt, reports);
    for (uint32_t i = 0; i < count; i++)
        if (reports[i].result != DPT_OK)
            scene_bodies_hold(bodies, index[i], reports[i].result);
}

dpt_result scene_physics_end_tick(struct scene_physics *physics, dpt_world *world, double dt)
{
    give_way(physics->bodies, world, dt);
    for (uint32_t i = 0; i < physics->bodies->count; i++) {
        const struct scene_body *body = &physics->bodies->body[i];
        const dpt_result result =
            body->springs ? soft_exchange_give_loads(&physics->exchange[i], world, body->id) : DPT_OK;
        if (result != DPT_OK)
            scene_bodies_hold(physics->bodies, i, result);
    }
    __atomic_store_n(&physics->ticks, physics->ticks + 1, __ATOMIC_RELAXED);
    return physics->has_thread ? DPT_OK : step_by_ticks(physics, dt);
}

static int must_end(const struct scene_physics *physics)
{
    return __atomic_load_n(&physics->must_end, __ATOMIC_RELAXED) != 0;
}

static void sleep_until(const struct scene_physics *physics, uint64_t deadline)
{
    for (uint64_t now = clock_now(); now < deadline && !must_end(physics); now = clock_now())
        clock_sleep(deadline - now < NAP ? deadline - now : NAP);
}

/* Steps at absolute deadlines. Those that a long step missed are left out, so that it never runs after the loop. */
static void *run(void *user)
{
    struct scene_physics *physics = user;
    const uint64_t period = (uint64_t)(1e9 * physics->period + 0.5);
    uint64_t deadline = clock_now(), ticks = 0, ticked_ns = 0;
    while (!must_end(physics)) {
        const uint64_t ticks_now = __atomic_load_n(&physics->ticks, __ATOMIC_RELAXED);
        uint64_t now = clock_now();
        if (ticks_now != ticks)
            ticked_ns = now;
        ticks = ticks_now;
        const int is_held = now - ticked_ns > physics->held_ns;
        if (!is_held)
            step(physics);
        deadline += period;
        now = clock_now();
        if (now > deadline) {
            const uint64_t passed = (now - deadline) / period;
            physics->late += is_held ? 0 : passed;
            deadline += passed * period;
        }
        sleep_until(physics, deadline);
    }
    return NULL;
}

dpt_result scene_physics_start(struct scene_physics *physics, double loop_rate)
{
    physics->held_ns = (uint64_t)(1e9 * fmax(SECONDS_HELD, LOOP_PERIODS_HELD / loop_rate));
    physics->has_thread = 1;
    __atomic_store_n(&physics->must_end, 0u, __ATOMIC_RELAXED);
    const int error = thread_start(&physics->thread, run, physics);
    physics->is_running = error == 0;
    return error ? DPT_E_SYSTEM : DPT_OK;
}

void scene_physics_stop(struct scene_physics *physics)
{
    if (!physics || !physics->is_running)
        return;
    __atomic_store_n(&physics->must_end, 1u, __ATOMIC_RELAXED);
    pthread_join(physics->thread, NULL);
    physics->is_running = 0;
}

uint64_t scene_physics_steps(const struct scene_physics *physics)
{
    return __atomic_load_n(&physics->steps, __ATOMIC_RELAXED);
}

struct scene_physics_report scene_physics_get_report(const struct scene_physics *physics)
{
    const double periods = (double)(physics->steps + physics->late);
    return (struct scene_physics_report){ .asked = physics->rate,
                                          .rate =
                                              periods > 0.0 ? physics->rate * (double)physics->steps / periods : 0.0,
                                          .steps = physics->steps,
                                          .late = physics->late,
                                          .has_thread = physics->has_thread };
}
