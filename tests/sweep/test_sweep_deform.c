/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The sweep of a surface whose vertices move, against that of each of its triangles by itself: the tree must rule none
 * out. What one triangle's sweep is worth test_sweep_moving judges.
 *
 *     test_sweep_deform [PER CENT]   of the motions
 */
#include "deform/deform_vertices.h"
#include "lib/fixture.h"
#include "sweep/sweep_scene.h"

static uint64_t rng = 5;

/* A surface, and where its vertices were and are. */
struct moving_body {
    struct fixture fixture;
    struct surface_motion motion;
    struct surface surface;
    struct kernel kernel;
    void *raw;
    float *last, *now;
    uint32_t tick;
    double diagonal;
};

static int open_body(struct moving_body *body, const char *shape, uint64_t triangles)
{
    uint32_t chosen;
    const double low[3] = { -1.0, -1.0, -1.0 }, high[3] = { 1.0, 1.0, 1.0 };
    memset(body, 0, sizeof *body);
    if (!fixture_from_shape(&body->fixture, shape, triangles) ||
        !dpti_kernel_get(DPT_KERNEL_AUTO, &body->kernel, &chosen))
        return 0;
    const struct dpt_mesh *mesh = body->fixture.mesh;
    const size_t floats = 3 * (size_t)mesh->vertices;
    body->raw = malloc((size_t)dpti_surface_motion_bytes(mesh) + 64);
    body->last = malloc(floats * sizeof(float));
    body->now = malloc(floats * sizeof(float));
    dpti_surface_of_motion(mesh, low, high, (char *)mesh_aligned((uintptr_t)body->raw), &body->motion, &body->surface);
    memcpy(body->now, body->surface.positions, floats * sizeof(float));
    body->diagonal = surface_diagonal(&body->surface);
    return 1;
}

static void close_body(struct moving_body *body)
{
    free(body->raw);
    free(body->last);
    free(body->now);
    fixture_free(&body->fixture);
}

/* A tick: all vertices, or a third of them, are shifted together, apart by a wave, each by itself, or not at all. */
static void move_body(struct moving_body *body)
{
    const uint32_t vertices = body->fixture.mesh->vertices;
    const double size = body->diagonal * power_in(&rng, -4.0, -0.7);
    const vec3 shift = scaled(any_in(&rng, 1.0), size), wave = any_in(&rng, 30.0);
    const uint64_t kind = random_bits(&rng) % 4;
    const uint32_t from = one_in(&rng, 3) ? vertices / 3 : 0;
    int has_begun_anew;
    memcpy(body->last, body->now, 3 * sizeof(float) * (size_t)vertices);
    for (uint32_t v = from; v < vertices && kind; v++) {
        const vec3 x = vec3_of_float(mesh_floats(body->fixture.mesh, MESH_VERTICES) + 3 * (size_t)v);
        const double part = kind == 1 ? 1.0 : kind == 2 ? sin(dot(x, wave)) : 0.1;
        vec3 to = along(x, part, shift);
        if (kind == 3)
            to = add(to, scaled(any_in(&rng, 1.0), 0.2 * size));
        body->now[3 * v] = (float)to.x;
        body->now[3 * v + 1] = (float)to.y;
        body->now[3 * v + 2] = (float)to.z;
    }
    const struct vertex_update update = { .positions = body->now + 3 * (size_t)from,
                                          .first = from,
                                          .count = vertices - from,
                                          .bound = -1.0,
                                          .tick = ++body->tick };
    dpti_deform_move(&body->surface, &body->kernel, &update, &has_begun_anew);
}

/* The axis begins near the surface, and goes as far as its vertices do, or farther, or rests. */
static void draw_motion(const struct moving_body *body, struct motion *m)
{
    const uint32_t v = (uint32_t)(random_bits(&rng) % body->fixture.mesh->vertices);
    const double size = body->diagonal, far = power_in(&rng, -4.0, -0.5);
    const vec3 near = vec3_of_float(body->last + 3 * (size_t)v);
    const vec3 u = scaled(any_in(&rng, 1.0), size * power_in(&rng, -3.0, 0.0));
    m->a = add(near, scaled(any_in(&rng, size), far));
    m->b = add(m->a, one_in(&rng, 5) ? (vec3){ 0.0, 0.0, 0.0 } : u);
    m->da = one_in(&rng, 3) ? (vec3){ 0.0, 0.0, 0.0 } : scaled(any_in(&rng, size), power_in(&rng, -4.0, -1.0));
    m->db = one_in(&rng, 2) ? m->da : scaled(any_in(&rng, size), power_in(&rng, -4.0, -1.0));
}

/* Every triangle, from the test's own positions. */
static struct impact sweep_all(const struct moving_body *body, const struct sweep *sweep,
                               const struct surface_times *times)
{
    struct impact first = { .time = 1.0, .triangle = DPT_NONE };
    for (uint32_t t = 0; t < body->fixture.mesh->triangles; t++) {
        struct moving_triangle triangle = { .is_moving = 1 };
        uint32_t asked = 0;
        double time;
        for (uint32_t k = 0; k < 3; k++) {
            const uint32_t v = surface_corner(&body->surface, t, k);
            const vec3 last = vec3_of_float(body->last + 3 * (size_t)v);
            const vec3 way = sub(vec3_of_float(body->now + 3 * (size_t)v), last);
            triangle.corner[k] = along(last, times->from, way);
            triangle.shift[k] = scaled(way, times->to - times->from);
        }
        if (dpti_sweep_triangle(sweep, &triangle, first.time, &time, &asked) != SWEEP_HIT)
            continue;
        if (time < first.time || first.triangle == DPT_NONE ||
            body->surface.sources[t] < body->surface.sources[first.triangle]) {
            first.time = time;
            first.triangle = t;
        }
    }
    return first;
}

static uint32_t check_motion(const struct moving_body *body, const char *name)
{
    const double part[2] = { random_in(&rng, 0.0, 0.5), random_in(&rng, 0.5, 1.0) };
    const int is_whole = one_in(&rng, 2);
    const struct surface_times times = { body->tick, is_whole ? 0.0 : part[0], is_whole ? 1.0 : part[1] };
    const struct surface_motion *motion = &body->motion;
    struct motion moved;
    struct sweep sweep;
    struct impact found;
    struct sweep_progress progress = { .has_begun = 0 };
    struct work work = work_of(WORK_UNLIMITED);
    draw_motion(body, &moved);
    const double radius = one_in(&rng, 2) ? 0.0 : body->diagonal * power_in(&rng, -4.0, -1.5);
    dpti_sweep_begin(&sweep, &moved, radius, 1e-6 * body->diagonal, 1.0);
    sweep.surface_speed =
        (times.to - times.from) * (double)motion->step[motion->first[motion->levels]] / body->surface.filter_scale;
    const struct impact truth = sweep_all(body, &sweep, &times);
    struct mesh_sweep search = { .surface = &body->surface,
                                 .kernel = &body->kernel,
                                 .sweep = &sweep,
                                 .times = &times,
                                 .work = &work,
                                 .progress = &progress };
    const int result = dpti_sweep_mesh(&search, DPT_NONE, &found);
    CHECK(result == (truth.triangle == DPT_NONE ? SWEEP_FREE : SWEEP_HIT), "%s: result %d", name, result);
    CHECK(found.time == truth.time && found.triangle == truth.triangle, "%s: %u at %.17g, not %u at %.17g", name,
          found.triangle, found.time, truth.triangle, truth.time);
    /* The distance when the motion begins tells from when on a touch is possible. */
    const struct surface then = surface_view(&body->surface, body->tick, times.from);
    double distance2 = HUGE_VAL;
    for (uint32_t t = 0; t < body->fixture.mesh->triangles; t++)
        distance2 = min_of(distance2, dpti_triangle_pair(&then, t, sweep.a, sweep.u).distance2);
    const double start = dpti_sweep_start(&sweep, sqrt(distance2));
    CHECK(truth.triangle == DPT_NONE || start <= truth.time, "%s: free until %.17g, hit at %.17g", name, start,
          truth.time);
    return truth.triangle != DPT_NONE;
}

static void no_triangle_is_ruled_out(void)
{
    static const char *const shapes[] = { "liver", "cloth", "star" };
    static const uint64_t triangles[] = { 1500, 1800, 2000 };
    for (int s = 0; s < 3; s++) {
        struct moving_body body;
        uint32_t hits = 0;
        if (!open_body(&body, shapes[s], triangles[s]))
            continue;
        for (uint64_t i = 0; i < part_of(300); i++) {
            move_body(&body);
            for (int k = 0; k < 4; k++)
                hits += check_motion(&body, shapes[s]);
        }
        CHECK(hits > least_seen(200), "%u hits", hits);
        close_body(&body);
    }
}

int main(int argc, char **argv)
{
    take_percent(argc, argv);
    TEST(no_triangle_is_ruled_out);
    return check_report();
}
