/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What a tick costs on a soft liver of 50,332 triangles (the scene `soft-liver`), and what is felt of it.
 *
 *     soft_liver [PASSES]     prints CSV, a row a subject and phase
 *
 * A stylus with a proxy of 500 N/m comes down on the liver, presses 5 mm into it at 17 mm/s, holds still, trembles by
 * 0.05 mm, goes up and down by 2 mm at 2 Hz, slides by 12 mm, leaves, and is gone. Subjects are integrators, each once
 * with springs that fall asleep, and once all awake. They take turns of TURN ticks, each with a world of its own. Times are
 * in us, the least of PASSES passes a tick (3), since what else the machine does adds to them:
 *
 *   contact   of dpt_world_step until contact, in a world of its own whose tool is where the proxy was, and whose body
 *             has the same vertices; median. In passes of its own
 *   force     the rest of dpt_world_step; median of the differences
 *   physics   of dpt_body_step_springs: loads, springs, and vertices handed over; median, 99 %
 *   tick      of all of them together, contact once; median, 99 %, largest
 *
 * awake: the mean share of nodes. static: the mean force of the phase's last fifth; dynamic: half of what it goes up and
 * down in the phase's second half; N. off: by how much it differs from the same integrator's all awake, at most, as a
 * share of the largest force of all. jump: the largest change from tick to tick, N.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "bench/timing.h"
#include "dynpoint.h"
#include "dynpoint/compile.h"
#include "scene/scene_list.h"
#include "scene/shape.h"

enum { TICKS = 8000, TURN = 250, PHASES = 9, SUBJECTS = 4, CONTACT_PASSES = 2 };

static const struct {
    const char *name;
    int begin, end;
} phases[PHASES] = { { "approach", 0, 200 },   { "press", 200, 500 },   { "hold", 500, 2000 },
                     { "tremor", 2000, 3000 }, { "2 Hz", 3000, 5000 },  { "slide", 5000, 6000 },
                     { "leave", 6000, 6300 },  { "gone", 6300, TICKS }, { "all", 0, TICKS } };

struct subject {
    const char *name;
    uint32_t integrator;
    double sleep_speed; /* below 0: the default */
    void *world_block, *body_block, *springs_block;
    dpt_world *world;
    dpt_body body;
    dpt_tool tool;
    dpt_springs *springs;
    double force[TICKS], awake[TICKS], step[TICKS], physics[TICKS], contact[TICKS];
};

struct bench {
    dpt_compiled compiled;
    const dpt_mesh *mesh;
    double load_radius, radius, length;
    double touch[3]; /* where the tool's end is when it touches */
};

static void fail(const char *what)
{
    fprintf(stderr, "soft_liver: %s\n", what);
    exit(2);
}

static void *array(size_t bytes)
{
    void *made = malloc(bytes);
    if (!bytes || !made)
        fail("no memory");
    return made;
}

static void make_mesh(struct bench *bench)
{
    const struct listed_scene *scene = scene_listed("soft-liver");
    const struct listed_body *body = scene->bodies;
    struct shape shape;
    shape_reason reason;
    dpt_compile_def def;
    dpt_compile_def_init(&def);
    def.springs = &body->springs;
    if (shape_make(body->shape, body->triangles, 0, &shape, reason) ||
        dpt_compile_arrays(shape.vertices, shape.vertex_count, shape.corners, shape.triangle_count, &def,
                           &bench->compiled, NULL) != DPT_OK ||
        dpt_mesh_open(bench->compiled.bytes, bench->compiled.size, &bench->mesh) != DPT_OK)
        fail("the liver cannot be made");
    shape_free(&shape);
    bench->load_radius = body->load_radius;
    bench->radius = scene->radius;
    bench->length = scene->length;
}

/* Where the tool's end is at a tick: how far along z, and above where it touched. */
static void path(int tick, double *z, double *height)
{
    const double t = 1e-3 * tick, pi = 3.14159265358979;
    *z = tick < 5000 ? 0.0 : -0.012 * fmin(t - 5.0, 1.0);
    *height = tick < 200 ? 0.002 * (1.0 - t / 0.2) : tick < 500 ? -0.005 * (t - 0.2) / 0.3 : -0.005;
    if (tick >= 2000 && tick < 3000)
        *height += 5e-5 * fmin(1.0, 10.0 * fmin(t - 2.0, 3.0 - t)) *
                   (sin(2.0 * pi * 9.0 * t) + 0.5 * sin(2.0 * pi * 11.3 * t));
    if (tick >= 3000 && tick < 5000)
        *height += 0.002 * sin(2.0 * pi * 2.0 * (t - 3.0));
    if (tick >= 6000)
        *height += 0.03 * fmin(t - 6.0, 0.3);
}

static void open_world(const struct bench *bench, struct subject *subject, uint32_t until)
{
    dpt_world_def world;
    dpt_deformable_def deform;
    dpt_springs_def springs;
    dpt_tool_settings settings = { .size = sizeof settings };
    const dpt_segment stylus = { { 0.0, 0.0, 0.0 }, { 0.0, bench->length, 0.0 }, bench->radius };
    dpt_world_def_init(&world);
    world.max_contacts = 32;
    dpt_deformable_def_init(&deform);
    dpt_springs_def_init(&springs);
    world.until = until;
    world.law = until == DPT_UNTIL_CONTACT ? DPT_LAW_POINT : DPT_LAW_PROXY;
    deform.mesh = springs.mesh = bench->mesh;
    deform.load_radius = bench->load_radius;
    springs.integrator = subject->integrator;
    springs.sleep_speed = subject->sleep_speed < 0.0 ? springs.sleep_speed : subject->sleep_speed;
    subject->world_block = array(dpt_world_bytes(&world));
    subject->body_block = array(dpt_deformable_bytes(&deform));
    subject->springs_block = array(dpt_springs_bytes(&springs));
    if (dpt_world_create(subject->world_block, dpt_world_bytes(&world), &world, &subject->world) ||
        dpt_body_add_deformable(subject->world, subject->body_block, dpt_deformable_bytes(&deform), &deform,
                                &subject->body) ||
        dpt_springs_create(subject->springs_block, dpt_springs_bytes(&springs), &springs, &subject->springs) ||
        dpt_tool_add(subject->world, &stylus, 1, &subject->tool) ||
        dpt_tool_get_settings(subject->world, subject->tool, &settings))
        fail("no world");
    settings.lock_rotation = 1;
    if (dpt_tool_set_settings(subject->world, subject->tool, &settings) != DPT_OK)
        fail("no tool");
}

static void close_world(struct subject *subject)
{
    free(subject->world_block);
    free(subject->body_block);
    free(subject->springs_block);
}

/* Lower the tool by its distance until it touches: it cannot get through. */
static void find_touch(struct bench *bench)
{
    static struct subject probe;
    dpt_mesh_info info = { .size = sizeof info };
    dpt_mesh_get_info(bench->mesh, &info);
    for (int k = 0; k < 3; k++)
        bench->touch[k] = k == 1 ? info.box_max[k] + 0.02 : 0.5 * (info.box_min[k] + info.box_max[k]);
    open_world(bench, &probe, DPT_UNTIL_CONTACT);
    for (int i = 0; i < 200; i++) {
        dpt_pose pose = DPT_POSE_IDENTITY;
        dpt_hit hit = DPT_HIT_INIT;
        memcpy(pose.position, bench->touch, sizeof pose.position);
        if (dpt_tool_teleport(probe.world, probe.tool, &pose) != DPT_OK ||
            dpt_world_step(probe.world, 1e-3, NULL) != DPT_OK ||
            dpt_tool_get_hit(probe.world, probe.tool, &hit) != DPT_OK)
            fail("no way to the liver");
        bench->touch[1] -= hit.distance - bench->radius;
    }
    close_world(&probe);
}

/* What dpt_world_step takes until contact, with the tool and the vertices where the subject has them. */
static double time_contact(const struct subject *subject, struct subject *probe)
{
    const float *positions;
    uint32_t count;
    dpt_pose proxy;
    if (dpt_body_get_vertices(subject->world, subject->body, &positions, &count) != DPT_OK ||
        dpt_body_set_vertices(probe->world, probe->body, 0, count, positions, -1.0) != DPT_OK ||
        dpt_tool_get_proxy(subject->world, subject->tool, &proxy) != DPT_OK ||
        dpt_tool_set_pose(probe->world, probe->tool, &proxy) != DPT_OK)
        fail("no contact");
    const double begin = now();
    if (dpt_world_step(probe->world, 1e-3, NULL) != DPT_OK)
        fail("no contact");
    return now() - begin;
}

/* 0: there was none yet. */
static double least(double before, double time)
{
    return before > 0.0 && before < time ? before : time;
}

static void run_tick(const struct bench *bench, struct subject *subject, struct subject *probe, int tick, int pass)
{
    dpt_pose pose = DPT_POSE_IDENTITY;
    dpt_springs_info report = { .size = sizeof report };
    dpt_force_info force = { .size = sizeof force };
    double z, height;
    path(tick, &z, &height);
    memcpy(pose.position, bench->touch, sizeof pose.position);
    pose.position[1] += height;
    pose.position[2] += z;
    dpt_result result = tick ? dpt_tool_set_pose(subject->world, subject->tool, &pose)
                             : dpt_tool_teleport(subject->world, subject->tool, &pose);
    const double begin = now();
    result = result == DPT_OK ? dpt_world_step(subject->world, 1e-3, NULL) : result;
    const double step = now() - begin;
    if (probe)
        subject->contact[tick] = least(subject->contact[tick], time_contact(subject, probe));
    const double middle = now();
    result = result == DPT_OK ? dpt_body_step_springs(subject->world, subject->body, subject->springs, 1e-3, &report)
                              : result;
    const double physics = now() - middle;
    if (result != DPT_OK)
        fail("a tick failed");
    dpt_tool_get_force_info(subject->world, subject->tool, &force);
    if (pass && force.wrench.force[1] != subject->force[tick])
        fail("two passes have different forces");
    subject->force[tick] = force.wrench.force[1];
    subject->awake[tick] = (double)report.active / report.nodes;
    if (probe)
        return;
    subject->step[tick] = least(subject->step[tick], step);
    subject->physics[tick] = least(subject->physics[tick], physics);
}

/* Contact is timed in passes of its own: it would leave other things in the cache. */
static void run_pass(const struct bench *bench, struct subject *subjects, int pass, int has_contact)
{
    static struct subject probes[SUBJECTS];
    for (int s = 0; s < SUBJECTS; s++) {
        open_world(bench, &subjects[s], DPT_UNTIL_RESPOND);
        if (has_contact)
            open_world(bench, &probes[s], DPT_UNTIL_CONTACT);
    }
    for (int turn = 0; turn < TICKS; turn += TURN)
        for (int s = 0; s < SUBJECTS; s++)
            for (int tick = turn; tick < turn + TURN; tick++)
                run_tick(bench, &subjects[s], has_contact ? &probes[s] : NULL, tick, pass);
    for (int s = 0; s < SUBJECTS; s++) {
        close_world(&subjects[s]);
        if (has_contact)
            close_world(&probes[s]);
    }
}

/* In us. */
static double quantile(double *times, int count, double share)
{
    qsort(times, (size_t)count, sizeof *times, by_size);
    return 1e-3 * times[(int)(share * (count - 1))];
}

static void print_phase(const struct subject *subject, const struct subject *awake, int phase)
{
    static double contact[TICKS], force[TICKS], physics[TICKS], whole[TICKS];
    const int begin = phases[phase].begin, end = phases[phase].end, count = end - begin;
    const int fifth = end - count / 5, half = begin + count / 2;
    double share = 0.0, mean = 0.0, low = HUGE_VAL, high = -HUGE_VAL;
    double off = 0.0, largest = 0.0, jump = 0.0;
    for (int tick = 0; tick < TICKS; tick++)
        largest = fmax(largest, awake->force[tick]);
    for (int tick = begin; tick < end; tick++) {
        const double now = subject->force[tick];
        contact[tick - begin] = subject->contact[tick];
        force[tick - begin] = fmax(subject->step[tick] - subject->contact[tick], 0.0);
        physics[tick - begin] = subject->physics[tick];
        whole[tick - begin] = subject->step[tick] + subject->physics[tick];
        share += subject->awake[tick] / count;
        mean += tick >= fifth ? now / (end - fifth) : 0.0;
        low = tick >= half ? fmin(low, now) : low;
        high = tick >= half ? fmax(high, now) : high;
        off = fmax(off, fabs(now - awake->force[tick]) / largest);
        jump = tick ? fmax(jump, fabs(now - subject->force[tick - 1])) : 0.0;
    }
    const double physics_median = quantile(physics, count, 0.5), whole_median = quantile(whole, count, 0.5);
    printf("%s,%s,%.3f,%.1f,%.1f,%.1f,%.1f,%.1f,%.1f,%.1f,%.4f,%.4f,%.4f,%.4f\n", subject->name, phases[phase].name,
           share, quantile(contact, count, 0.5), quantile(force, count, 0.5), physics_median,
           quantile(physics, count, 0.99), whole_median, quantile(whole, count, 0.99), quantile(whole, count, 1.0),
           mean, 0.5 * (high - low), off, jump);
}

int main(int argc, char **argv)
{
    static struct subject subjects[SUBJECTS] = {
        { .name = "symplectic", .integrator = DPT_INTEGRATOR_SYMPLECTIC, .sleep_speed = -1.0 },
        { .name = "symplectic awake", .integrator = DPT_INTEGRATOR_SYMPLECTIC },
        { .name = "implicit", .integrator = DPT_INTEGRATOR_IMPLICIT, .sleep_speed = -1.0 },
        { .name = "implicit awake", .integrator = DPT_INTEGRATOR_IMPLICIT },
    };
    struct bench bench = { .mesh = NULL };
    const int passes = argc > 1 ? atoi(argv[1]) : 3;
    if (argc > 2 || passes < 1) {
        fprintf(stderr, "soft_liver [PASSES]\n");
        return 2;
    }
    make_mesh(&bench);
    find_touch(&bench);
    for (int pass = 0; pass < passes; pass++)
        run_pass(&bench, subjects, pass, 0);
    for (int pass = 0; pass < CONTACT_PASSES; pass++)
        run_pass(&bench, subjects, passes + pass, 1);
    printf("subject,phase,awake,contact_us,force_us,physics_us,physics_99_us,tick_us,tick_99_us,"
           "tick_most_us,static_n,dynamic_n,off,jump_n\n");
    for (int s = 0; s < SUBJECTS; s++)
        for (int phase = 0; phase < PHASES; phase++)
            print_phase(&subjects[s], &subjects[s | 1], phase);
    dpt_compiled_free(&bench.compiled);
    return 0;
}
