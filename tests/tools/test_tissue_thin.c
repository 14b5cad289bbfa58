/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A needle that is pressed deep into a fine soft organ, and led across until it slips off: the surface goes many times as far
 * in a tick as the needle is thick. Oracle: the distance of the proxy's axis to all triangles. The needle is never squeezed nor
 * put, and its force goes on from tick to tick.
 */
#include <math.h>

#include "lib/pose.h"
#include "lib/soft_scene.h"
#include "oracle/brute.h"
#include "scene/scene_list.h"

enum { CASES = 12, TICKS_MAX = 1600, LOOKED_AT = 24 };

#define LENGTH  0.15 /* m, of the needle */
#define PRESSED 1e-4 /* m a tick */
#define DEEPEST 0.06 /* m */
#define ACROSS  0.1  /* m */
#define FASTEST 1e-3 /* m: of a tick's motion, that a fold allows beyond the device's */
#define LEAST   0.05 /* N: a needle that has let go is not judged any more */

/* Without cuts of steps the first three are put at their devices. */
static const struct needle {
    uint32_t integrator;
    double lean, stiffness, radius, force, speed, along[2]; /* degrees, N/m, m, N, m/s, x and z */
} needles[CASES] = {
    { DPT_INTEGRATOR_SYMPLECTIC, 45.0, 667.0, 1e-4, 2.0, 0.5, { 0.866, 0.5 } },
    { DPT_INTEGRATOR_SYMPLECTIC, 45.0, 2000.0, 1e-4, 2.0, 0.3, { 0.866, 0.5 } },
    { DPT_INTEGRATOR_SYMPLECTIC, 20.0, 667.0, 1e-4, 2.0, 0.2, { 0.0, 1.0 } },
    { DPT_INTEGRATOR_SYMPLECTIC, 45.0, 2000.0, 1e-4, 2.0, 0.5, { 0.866, 0.5 } },
    { DPT_INTEGRATOR_SYMPLECTIC, 20.0, 2000.0, 1e-4, 2.0, 0.3, { 0.866, 0.5 } },
    { DPT_INTEGRATOR_SYMPLECTIC, 20.0, 2000.0, 1e-4, 2.0, 0.5, { 0.0, 1.0 } },
    { DPT_INTEGRATOR_EULER, 45.0, 667.0, 5e-5, 0.5, 0.5, { 0.0, 1.0 } },
    { DPT_INTEGRATOR_EULER, 0.0, 2000.0, 1e-4, 4.0, 0.5, { 0.866, 0.5 } },
    { DPT_INTEGRATOR_IMPLICIT, 45.0, 667.0, 1e-4, 1.0, 0.5, { 0.866, 0.5 } },
    { DPT_INTEGRATOR_IMPLICIT, 20.0, 2000.0, 2e-4, 4.0, 1.0, { 0.0, -1.0 } },
    { DPT_INTEGRATOR_SYMPLECTIC, 60.0, 2000.0, 2e-4, 4.0, 0.3, { 0.866, 0.5 } },
    { DPT_INTEGRATOR_SYMPLECTIC, 30.0, 667.0, 5e-5, 4.0, 1.0, { 0.0, 1.0 } },
};

struct trial {
    struct soft_scene scene;
    const struct needle *needle;
    dpt_segment segment;
    float *before; /* where vertices were */
    double force, moved;
    int number, looked_at;
};

static int open_trial(struct trial *trial)
{
    const struct needle *needle = trial->needle;
    const double axis[3] = { 1.0, 0.0, 0.0 };
    dpt_host_error error = { .size = sizeof error };
    dpt_world_def def = rig_def(DPT_LAW_PROXY);
    struct rig *rig = &trial->scene.rig;
    struct scene_bodies *bodies = &trial->scene.bodies;
    const struct force_options options = { .law = DPT_LAW_PROXY, .friction = NAN };
    struct file_identity identity = { .bytes = 0 };
    dpt_tool_settings settings = { .size = sizeof settings };
    uint32_t count;
    trial->segment = (dpt_segment){ { 0.0, 0.0, 0.0 }, { 0.0, LENGTH, 0.0 }, needle->radius };
    if (scene_bodies_of_list(bodies, scene_listed("soft-liver"), &identity, &error) != DPT_OK)
        return 0;
    bodies->body[0].integrator = needle->integrator;
    def.max_bodies = bodies->count;
    if (!rig_open(rig, &def, NULL, &trial->segment, 1) || scene_bodies_add(bodies, rig->world, &options) != DPT_OK)
        return 0;
    dpt_tool_get_settings(rig->world, rig->tool, &settings);
    settings.stiffness = needle->stiffness;
    settings.lock_rotation = 1;
    dpt_tool_set_settings(rig->world, rig->tool, &settings);
    pose_orient(&rig->device, axis, needle->lean * 0.017453292519943295);
    scene_bodies_top(bodies, rig->device.position);
    rig->device.position[1] += needle->radius + 0.002;
    dpt_tool_teleport(rig->world, rig->tool, &rig->device);
    soft_scene_vertices(&trial->scene, &count);
    trial->before = calloc(3 * (size_t)count, sizeof *trial->before);
    return trial->before != NULL;
}

/* m: how far the surface has moved in this tick. */
static double surface_motion(struct trial *trial)
{
    uint32_t count;
    const float *now = soft_scene_vertices(&trial->scene, &count);
    double most = 0.0;
    for (size_t i = 0; i < 3 * (size_t)count; i++)
        most = fmax(most, fabs((double)now[i] - (double)trial->before[i]));
    memcpy(trial->before, now, 3 * (size_t)count * sizeof *now);
    return most;
}

/* m: of the proxy to the surface, by looking at all triangles. */
static double gap_of(const struct trial *trial)
{
    const dpt_pose *body = &trial->scene.bodies.body[0].pose;
    const double back[4] = { body->orientation[0], -body->orientation[1], -body->orientation[2],
                             -body->orientation[3] };
    const uint32_t *corners;
    uint32_t count, triangles;
    double ends[6], axis[6];
    const float *vertices = soft_scene_vertices(&trial->scene, &count);
    dpt_mesh_get_triangles(trial->scene.bodies.body[0].mesh, &corners, NULL, &triangles);
    rig_proxy_ends(&trial->scene.rig, 0, ends);
    for (int k = 0; k < 6; k++)
        ends[k] -= body->position[k % 3];
    turn3(back, ends, axis);
    turn3(back, ends + 3, axis + 3);
    oracle_mesh *mesh = oracle_brute_open(vertices, count, corners, triangles);
    const double distance = oracle_brute(mesh, axis, NULL);
    oracle_brute_close(mesh);
    return distance - trial->needle->radius;
}

static void tick(struct trial *trial, int number, double motion)
{
    struct rig *rig = &trial->scene.rig;
    dpt_force_info info = { .size = sizeof info };
    rig_step(rig);
    /* Where the surface went farther in the last tick than the needle is thick. */
    if (trial->moved > trial->needle->radius && trial->looked_at < LOOKED_AT && number % 4 == 0) {
        const double gap = gap_of(trial);
        CHECK(gap > 0.0, "case %d, tick %d: a gap of %g m", trial->number, number, gap);
        trial->looked_at++;
    }
    scene_bodies_begin_tick(&trial->scene.bodies, (uint64_t)number);
    CHECK(scene_bodies_step(&trial->scene.bodies, rig->world, SOFT_TICK) == DPT_OK, "tick %d", number);
    dpt_tool_get_force_info(rig->world, rig->tool, &info);
    const double force = length3(info.wrench.force), fall = trial->force - force;
    CHECK(info.reason != DPT_FORCE_INSIDE && !(info.flags & (DPT_FORCE_FLAG_SQUEEZED | DPT_FORCE_FLAG_FADING)),
          "case %d, tick %d: reason %u, flags %u, %g N", trial->number, number, info.reason, info.flags, force);
    CHECK(!(force < LEAST && fall > trial->needle->stiffness * (3.0 * motion + FASTEST)) ||
              (info.flags & DPT_FORCE_FLAG_FOLD),
          "case %d, tick %d: %g N are gone", trial->number, number, fall);
    trial->force = force;
    trial->moved = surface_motion(trial);
}

/* Press until the force is felt, then lead across. */
static void play(struct trial *trial)
{
    const struct needle *needle = trial->needle;
    double *at = trial->scene.rig.device.position, down = 0.0, across = 0.0, peak = 0.0, farthest = 0.0;
    for (int i = 0; i < TICKS_MAX && across < ACROSS; i++) {
        const int presses = peak < needle->force && down < DEEPEST;
        const double motion = presses ? PRESSED : needle->speed * SOFT_TICK;
        at[1] -= presses ? motion : 0.0;
        at[0] += presses ? 0.0 : motion * needle->along[0];
        at[2] += presses ? 0.0 : motion * needle->along[1];
        *(presses ? &down : &across) += motion;
        tick(trial, i, motion);
        peak = fmax(peak, trial->force);
        farthest = i ? fmax(farthest, trial->moved) : 0.0;
        if (across > 0.0 && trial->force < LEAST)
            break;
    }
    CHECK(peak > 0.5 && farthest > 5.0 * needle->radius && trial->looked_at, "%g N, the surface moves by %g m", peak,
          farthest);
}

static void needles_are_not_engulfed(void)
{
    for (int i = 0; i < (int)part_of(CASES); i++) {
        struct trial trial = { .needle = &needles[i], .number = i };
        if (open_trial(&trial))
            play(&trial);
        else
            CHECK(0, "case %d does not open", i);
        free(trial.before);
        soft_scene_close(&trial.scene);
    }
}

int main(int argc, char **argv)
{
    take_percent(argc, argv);
    TEST(needles_are_not_engulfed);
    return check_report();
}
