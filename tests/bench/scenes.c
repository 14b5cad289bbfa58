/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The scenes of the paper's Table 1: full checks a millisecond, which is a thousand over the median time in us.
 *
 *     scenes [TICKS]      prints CSV, a row a scene and method
 *
 * The stylus comes down on the first body, goes to and fro by 1 cm at 1 Hz and up and down by 3 mm at 0.7 Hz, so that it
 * presses half of the time. In the cloth's scene it is the sword, and rests. Methods: `exact` is what a world does by
 * default, with its force; `brute` asks every triangle, and `paper` is the paper's dynamic point in one part: both end at
 * contact, with the tool where the device is and the vertices that `exact` has. A check is dpt_world_step; with physics it
 * is dpt_deform_step_springs as well, in the same thread, where the paper had four. `wrong` counts ticks in which the
 * distance is not that of `brute` within 1 um; that of `exact` is another tool's, and is not asked (tests/world hold it).
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "bench/timing.h"
#include "dynpoint.h"
#include "dynpoint/compile.h"
#include "scene_list.h"
#include "shape.h"

enum { BODIES = LISTED_BODIES_MAX, TICKS_MAX = 100000, METHODS = 3 };

static const char *const names[] = { "membrane", "cloth", "laparoscopy", "liver" };

static const struct {
    const char *name;
    uint32_t method, until;
} methods[METHODS] = { { "exact", DPT_METHOD_EXACT, DPT_UNTIL_RESPOND },
                       { "brute", DPT_METHOD_BRUTE, DPT_UNTIL_CONTACT },
                       { "paper", DPT_METHOD_PAPER, DPT_UNTIL_CONTACT } };

struct body {
    dpt_compiled compiled;
    const dpt_mesh *mesh;
    dpt_mesh_info info;
};

struct soft {
    void *block, *springs_block;
    dpt_springs *springs;
    dpt_body id;
};

struct stage {
    void *block;
    dpt_world *world;
    dpt_tool tool;
    struct soft soft[BODIES];
};

struct bench {
    const struct listed_scene *scene;
    struct body body[BODIES];
    int bodies, displaces;
    uint32_t triangles, springs;
    double touch[3];
};

static void fail(const char *what)
{
    fprintf(stderr, "scenes: %s\n", what);
    exit(2);
}

static void *array(size_t bytes)
{
    void *made = malloc(bytes);
    if (!bytes || !made)
        fail("no memory");
    return made;
}

static void make_body(struct bench *bench, const struct listed_body *listed)
{
    struct body *body = &bench->body[bench->bodies++];
    struct shape shape;
    shape_reason reason;
    dpt_compile_def def;
    dpt_compile_def_init(&def);
    def.springs = listed->springs.kind ? &listed->springs : NULL;
    body->info.size = sizeof body->info;
    if (shape_make(listed->shape, listed->triangles, 0, &shape, reason) ||
        dpt_compile_arrays(shape.vertices, shape.vertex_count, shape.corners, shape.triangle_count,
                           &def, &body->compiled, NULL) != DPT_OK ||
        dpt_mesh_open(body->compiled.bytes, body->compiled.size, &body->mesh) != DPT_OK ||
        dpt_mesh_get_info(body->mesh, &body->info) != DPT_OK)
        fail("a body cannot be made");
    shape_free(&shape);
    bench->triangles += body->info.triangles;
    bench->springs += body->info.springs;
    bench->displaces |= listed->response == DPT_RESPONSE_DISPLACE;
}

static dpt_result add_soft(const struct bench *bench, struct stage *stage, int i)
{
    const struct listed_body *listed = &bench->scene->bodies[i];
    struct soft *soft = &stage->soft[i];
    dpt_deform_def deform;
    dpt_springs_def springs;
    dpt_deform_def_init(&deform);
    dpt_springs_def_init(&springs);
    deform.mesh = springs.mesh = bench->body[i].mesh;
    deform.pose = &listed->pose;
    deform.load_radius = listed->load_radius;
    deform.response = listed->response;
    for (int k = 0; k < 3; k++) {
        deform.box_min[k] = -1.0;
        deform.box_max[k] = 1.0;
    }
    springs.integrator = listed->integrator;
    springs.iterations = listed->iterations ? listed->iterations : springs.iterations;
    /* Gravity is that of the cloth alone, which lies: its own z is up. */
    springs.gravity[2] = -bench->scene->gravity;
    soft->block = array(dpt_deform_bytes(&deform));
    soft->springs_block = array(dpt_springs_bytes(&springs));
    const dpt_result result =
        dpt_deform_add(stage->world, soft->block, dpt_deform_bytes(&deform), &deform, &soft->id);
    return result != DPT_OK ? result
                            : dpt_springs_create(soft->springs_block, dpt_springs_bytes(&springs),
                                                 &springs, &soft->springs);
}

/* Returns 0 if the library has no such world. */
static int open_stage(const struct bench *bench, struct stage *stage, int method)
{
    const struct listed_scene *scene = bench->scene;
    dpt_world_def world;
    const dpt_segment stylus =
        bench->displaces ? (dpt_segment){ { 0, 0, -0.25 }, { 0, 0, 0.25 }, scene->radius }
                         : (dpt_segment){ { 0, 0, 0 }, { 0, scene->length, 0 }, scene->radius };
    memset(stage, 0, sizeof *stage);
    dpt_world_def_init(&world);
    world.method = methods[method].method;
    world.until = methods[method].until;
    world.law = bench->displaces || method ? DPT_LAW_POINT : DPT_LAW_PROXY;
    if (bench->displaces && !method) {
        world.strip = DPT_STRIP_KIND_SHADOW;
        world.strip_width = 0.01;
        world.strip_capacity = 4096;
    }
    stage->block = array(dpt_world_bytes(&world));
    dpt_result result =
        dpt_world_create(stage->block, dpt_world_bytes(&world), &world, &stage->world);
    for (int i = 0; i < bench->bodies && result == DPT_OK; i++)
        result = bench->body[i].info.springs
                     ? add_soft(bench, stage, i)
                     : dpt_body_add(stage->world, bench->body[i].mesh, &scene->bodies[i].pose,
                                    &stage->soft[i].id);
    if (result == DPT_OK)
        result = dpt_tool_add(stage->world, &stylus, 1, &stage->tool);
    return result == DPT_OK;
}

static void close_stage(struct stage *stage)
{
    free(stage->block);
    for (int i = 0; i < BODIES; i++) {
        free(stage->soft[i].block);
        free(stage->soft[i].springs_block);
    }
}

static void place(const struct bench *bench, const struct stage *stage, int tick)
{
    const double t = 1e-3 * tick;
    dpt_pose pose = DPT_POSE_IDENTITY;
    memcpy(pose.position, bench->touch, sizeof pose.position);
    if (!bench->displaces) {
        pose.position[1] +=
            tick < 200 ? 0.008 * (1.0 - 5.0 * t) : 0.003 * sin(4.398229715 * (t - 0.2));
        pose.position[0] += 0.01 * sin(6.2831853 * t);
    }
    if ((tick ? dpt_tool_set_pose(stage->world, stage->tool, &pose)
              : dpt_tool_teleport(stage->world, stage->tool, &pose)) != DPT_OK)
        fail("the tool does not move");
}

/* Lower the stylus by its distance until it touches. */
static void find_touch(struct bench *bench)
{
    struct stage stage;
    const dpt_mesh_info *info = &bench->body[0].info;
    const int lies = bench->scene->bodies[0].pose.orientation[1] != 0.0;
    bench->touch[0] = 0.5 * (info->box_min[0] + info->box_max[0]);
    bench->touch[1] = (lies ? info->box_max[2] : info->box_max[1]) + 0.02;
    bench->touch[2] = lies ? 0.0 : 0.5 * (info->box_min[2] + info->box_max[2]);
    if (bench->displaces) {
        bench->touch[1] = -0.05;
        return;
    }
    if (!open_stage(bench, &stage, 1))
        fail("no world");
    for (int i = 0; i < 100; i++) {
        dpt_pose pose = DPT_POSE_IDENTITY;
        dpt_hit hit = DPT_HIT_INIT;
        memcpy(pose.position, bench->touch, sizeof pose.position);
        if (dpt_tool_teleport(stage.world, stage.tool, &pose) != DPT_OK ||
            dpt_world_step(stage.world, 1e-3, NULL) != DPT_OK ||
            dpt_tool_get_hit(stage.world, stage.tool, &hit) != DPT_OK)
            fail("no way to the body");
        bench->touch[1] -= hit.distance - bench->scene->radius;
    }
    close_stage(&stage);
}

static double distance_of(const struct stage *stage)
{
    dpt_hit hit = DPT_HIT_INIT;
    dpt_tool_get_hit(stage->world, stage->tool, &hit);
    return hit.distance;
}

/* What the leader's vertices are, the follower's are. */
static void follow(const struct bench *bench, const struct stage *leader,
                   const struct stage *follower)
{
    for (int i = 0; i < bench->bodies; i++) {
        const float *positions;
        uint32_t count;
        if (!leader->soft[i].springs)
            continue;
        if (dpt_deform_get_vertices(leader->world, leader->soft[i].id, &positions, &count) !=
                DPT_OK ||
            dpt_deform_set_vertices(follower->world, follower->soft[i].id, 0, count, positions,
                                    -1.0) != DPT_OK)
            fail("vertices");
    }
}

static double per_ms(double *times, int count)
{
    qsort(times, (size_t)count, sizeof *times, by_size);
    return 1e6 / times[count / 2];
}

/* All methods in turn, tick by tick, with the tool and the vertices of the first. */
static void run(const struct bench *bench, int ticks)
{
    static double step[METHODS][TICKS_MAX], whole[TICKS_MAX];
    struct stage stage[METHODS];
    int is_there[METHODS], wrong = 0;
    for (int m = 0; m < METHODS; m++)
        is_there[m] = open_stage(bench, &stage[m], m);
    for (int tick = 0; tick < ticks; tick++) {
        for (int m = METHODS - 1; m >= 0; m--) {
            if (!is_there[m])
                continue;
            if (m)
                follow(bench, &stage[0], &stage[m]);
            place(bench, &stage[m], tick);
            const double begin = now();
            if (dpt_world_step(stage[m].world, 1e-3, NULL) != DPT_OK)
                fail("a tick failed");
            step[m][tick] = whole[tick] = now() - begin;
        }
        wrong += is_there[2] && fabs(distance_of(&stage[2]) - distance_of(&stage[1])) > 1e-6;
        for (int i = 0; i < bench->bodies; i++) {
            const double begin = now();
            if (stage[0].soft[i].springs &&
                dpt_deform_step_springs(stage[0].world, stage[0].soft[i].id,
                                        stage[0].soft[i].springs, 1e-3, NULL) != DPT_OK)
                fail("physics failed");
            whole[tick] += now() - begin;
        }
    }
    for (int m = 0; m < METHODS; m++) {
        if (is_there[m])
            printf("%s,%u,%u,%s,%.3g,%.3g,%d\n", bench->scene->name, bench->triangles,
                   bench->springs, methods[m].name, per_ms(step[m], ticks),
                   m ? 0.0 : per_ms(whole, ticks), m == 2 ? wrong : 0);
        close_stage(&stage[m]);
    }
}

int main(int argc, char **argv)
{
    const int ticks = argc > 1 ? atoi(argv[1]) : 3000;
    if (argc > 2 || ticks < 1 || ticks > TICKS_MAX)
        fail("TICKS is 1 to 100000");
    printf("scene,triangles,springs,method,checks_per_ms,with_physics_per_ms,wrong\n");
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        struct bench bench = { .scene = scene_listed(names[i]) };
        for (const struct listed_body *body = bench.scene->bodies; body->shape; body++)
            make_body(&bench, body);
        find_touch(&bench);
        run(&bench, ticks);
        for (int k = 0; k < bench.bodies; k++)
            dpt_compiled_free(&bench.body[k].compiled);
    }
    return 0;
}
