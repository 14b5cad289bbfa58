/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * docs/samples/own_physics.c in one thread, as it stands: an organ that beats against a needle, and gives way to it. Where
 * the needle's proxy is, is judged by brute force over the vertices of that tick, before they give way.
 *
 *     test_own_physics [PER CENT]   of the ticks that are judged by brute force
 */
#include <complex.h>

#include "lib/fixture.h"

static float *seen; /* the vertices of the tick */

static dpt_result see_and_step(dpt_world *world, dpt_body body, dpt_springs *springs, double dt, dpt_springs_info *info)
{
    const float *at;
    uint32_t vertices;
    dpt_body_get_vertices(world, body, &at, &vertices);
    seen = realloc(seen, 3 * sizeof *seen * (size_t)vertices);
    memcpy(seen, at, 3 * sizeof *seen * (size_t)vertices);
    return dpt_body_step_springs(world, body, springs, dt, info);
}

#define dpt_body_step_springs see_and_step
#define main                  sample_main
#include "samples/own_physics.c"
#undef main
#undef dpt_body_step_springs

/* m: from the proxy's surface to the nearest triangle. The proxy begins outside: it is, as long as this is not negative. */
static double clearance(const struct scene *scene, const dpt_pose *proxy)
{
    const double *p = proxy->position, *q = proxy->orientation;
    const double axis[6] = { p[0],
                             p[1],
                             p[2],
                             p[0] + 0.3 * (q[1] * q[3] + q[0] * q[2]),
                             p[1] + 0.3 * (q[2] * q[3] - q[0] * q[1]),
                             p[2] + 0.15 * (1.0 - 2.0 * (q[1] * q[1] + q[2] * q[2])) };
    const uint32_t *corners;
    uint32_t triangles;
    double nearest = INFINITY, triangle[9];
    dpt_mesh_get_triangles(scene->mesh, &corners, NULL, &triangles);
    for (uint32_t i = 0; i < triangles; i++) {
        for (uint32_t k = 0; k < 9; k++)
            triangle[k] = (double)seen[3 * corners[3 * i + k / 3] + k % 3];
        nearest = fmin(nearest, dpt_segment_triangle(axis, triangle, NULL, NULL, NULL));
    }
    return nearest - RADIUS;
}

/* What is left of loads and wrench, forces and moments about the needle's origin, in parts of the largest of them. */
static double imbalance(const struct scene *scene, const dpt_wrench *wrench)
{
    static dpt_load loads[LOADS_MAX];
    uint32_t count;
    dpt_wrench sum = *wrench;
    double peak = 1e-3, worst = 0.0, r[3];
    if (dpt_body_get_loads(scene->world, scene->body, loads, LOADS_MAX, &count) != DPT_OK)
        return INFINITY;
    for (int k = 0; k < 3; k++)
        peak = fmax(peak, fabs(wrench->force[k]));
    for (uint32_t i = 0; i < count; i++) {
        const double *f = loads[i].force;
        for (uint32_t k = 0; k < 3; k++)
            r[k] = (double)seen[3 * loads[i].vertex + k] - scene->device.position[k];
        for (int k = 0; k < 3; k++) {
            sum.force[k] += f[k];
            sum.torque[k] += r[(k + 1) % 3] * f[(k + 2) % 3] - r[(k + 2) % 3] * f[(k + 1) % 3];
        }
    }
    for (int k = 0; k < 3; k++)
        worst = fmax(worst, fmax(fabs(sum.force[k]), fabs(sum.torque[k])));
    return worst / peak;
}

/* Hz: the peak of the force's spectrum over the last four seconds, in steps of a quarter. */
static double beat_of(const struct felt *felt)
{
    double peak = 0.0, strongest = 0.0;
    for (double hertz = 0.25; hertz <= 10.0; hertz += 0.25) {
        double complex part = 0.0;
        for (int tick = TICKS - 4000; tick < TICKS; tick++)
            part += felt[tick].report.wrench.force[2] * cexp(I * TURN * hertz * TICK * tick);
        if (cabs(part) > peak) {
            peak = cabs(part);
            strongest = hertz;
        }
    }
    return strongest;
}

static struct scene scene;
static struct felt felt[TICKS], again[TICKS];
static struct fixture liver;

static void every_tick_is_right(void)
{
    const int stride = (int)(TICKS / part_of(TICKS));
    double nearest = INFINITY, worst = 0.0;
    int held = 0;
    open_scene(&scene, liver.mesh);
    for (int tick = 0; tick < TICKS; tick++) {
        if (tick % TICKS_A_PERIOD == 0)
            physics_step(&scene);
        felt[tick] = haptic_tick(&scene, tick);
        const dpt_force_info *report = &felt[tick].report;
        CHECK(!(report->flags & DPT_FORCE_FLAG_SQUEEZED), "tick %d", tick);
        CHECK(report->reason == DPT_FORCE_ACTS || report->reason == DPT_FORCE_FREE, "tick %d: %u", tick,
              report->reason);
        worst = fmax(worst, imbalance(&scene, &report->wrench));
        held += report->reason == DPT_FORCE_ACTS;
        if (tick % stride == 0)
            nearest = fmin(nearest, clearance(&scene, &felt[tick].proxy));
    }
    close_scene(&scene);
    CHECK(nearest >= 0.0, "%g m", nearest);
    CHECK(worst <= 1e-12, "loads and wrench leave %g", worst);
    CHECK(held > TICKS / 3 && held < TICKS - 500, "%d ticks with a force", held);
    printf("    %g m free at least, %g N left of 1; a force on %d of %d ticks\n", nearest, worst, held, TICKS);
}

static void the_force_beats_with_the_organ(void)
{
    const double beat = beat_of(felt);
    CHECK(beat == 1.0, "%g Hz", beat);
}

static void two_runs_are_the_same(void)
{
    open_scene(&scene, liver.mesh);
    run_in_one_thread(&scene, again);
    close_scene(&scene);
    CHECK(memcmp(felt, again, sizeof felt) == 0, "they differ");
}

int main(int argc, char **argv)
{
    take_percent(argc, argv);
    if (!fixture_from_shape(&liver, "liver", 5000))
        return check_report();
    TEST(every_tick_is_right);
    TEST(the_force_beats_with_the_organ);
    TEST(two_runs_are_the_same);
    fixture_free(&liver);
    free(seen);
    return check_report();
}
