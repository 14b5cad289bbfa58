/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Hulls and bodies whose vertices move: the nearest pair on what they have become, and the sweep while they move, from
 * any time of their motion on, against the oracle.
 *
 *     test_hull_deform [PER CENT]   of the motions
 */
#include "deform/deform_vertices.h"
#include "hull/hull_motion.h"
#include "hull/hull_search.h"

static uint64_t rng = 5;

/* A body, and where its vertices were and are. */
struct soft_body {
    struct hull_body body; /* the surface is the one that moves */
    struct surface_motion motion;
    void *raw;
    float *last, *now;
    double *corners, *shift; /* of the triangles, from a time of the motion on */
    struct oracle_triangles triangles;
    uint32_t tick;
};

static int open_soft(struct soft_body *soft, const char *shape, uint64_t triangles)
{
    const double low[3] = { -1.0, -1.0, -1.0 }, high[3] = { 1.0, 1.0, 1.0 };
    memset(soft, 0, sizeof *soft);
    if (!body_from_shape(&soft->body, shape, triangles))
        return 0;
    const struct dpt_mesh *mesh = soft->body.fixture.mesh;
    const size_t floats = 3 * (size_t)mesh->vertices;
    soft->raw = malloc((size_t)dpti_surface_motion_bytes(mesh) + 64);
    soft->last = malloc(floats * sizeof(float));
    soft->now = malloc(floats * sizeof(float));
    soft->corners = malloc(9 * sizeof(double) * mesh->triangles);
    soft->shift = malloc(9 * sizeof(double) * mesh->triangles);
    soft->triangles = (struct oracle_triangles){ soft->corners, soft->shift, soft->body.triangles.count };
    dpti_surface_of_motion(mesh, low, high, (char *)mesh_aligned((uintptr_t)soft->raw), &soft->motion,
                           &soft->body.surface);
    memcpy(soft->now, soft->body.surface.positions, floats * sizeof(float));
    return 1;
}

static void close_soft(struct soft_body *soft)
{
    free(soft->raw);
    free(soft->last);
    free(soft->now);
    free(soft->corners);
    free(soft->shift);
    body_close(&soft->body);
}

/* A tick: all vertices, or two thirds of them, are shifted together, apart by a wave, or each by itself. */
static void move_soft(struct soft_body *soft)
{
    const uint32_t vertices = soft->body.fixture.mesh->vertices;
    const double size = soft->body.diagonal * power_in(&rng, -4.0, -0.7);
    const vec3 shift = scaled(any_in(&rng, 1.0), size), wave = any_in(&rng, 30.0);
    const uint32_t kind = whole_in(&rng, 1, 3), from = one_in(&rng, 3) ? vertices / 3 : 0;
    int has_begun_anew;
    memcpy(soft->last, soft->now, 3 * sizeof(float) * (size_t)vertices);
    for (uint32_t v = from; v < vertices; v++) {
        const vec3 x = vec3_of_float(mesh_floats(soft->body.fixture.mesh, MESH_VERTICES) + 3 * (size_t)v);
        const double part = kind == 1 ? 1.0 : kind == 2 ? sin(dot(x, wave)) : 0.1;
        vec3 to = along(x, part, shift);
        if (kind == 3)
            to = add(to, scaled(any_in(&rng, 1.0), 0.2 * size));
        soft->now[3 * v] = (float)to.x;
        soft->now[3 * v + 1] = (float)to.y;
        soft->now[3 * v + 2] = (float)to.z;
    }
    const struct vertex_update update = { .positions = soft->now + 3 * (size_t)from,
                                          .first = from,
                                          .count = vertices - from,
                                          .bound = -1.0,
                                          .tick = ++soft->tick };
    dpti_deform_move(&soft->body.surface, &soft->body.kernel, &update, &has_begun_anew);
}

/* The triangles from a time of the motion on; 1: as they are now. */
static void set_triangles(struct soft_body *soft, double from)
{
    for (uint32_t t = 0; t < soft->triangles.count; t++)
        for (uint32_t k = 0; k < 9; k++) {
            const uint32_t v = 3 * surface_corner(&soft->body.surface, t, k / 3) + k % 3;
            const double last = (double)soft->last[v], now = (double)soft->now[v];
            soft->corners[9 * (size_t)t + k] = from < 1.0 ? last + from * (now - last) : now;
            soft->shift[9 * (size_t)t + k] = (1.0 - from) * (now - last);
        }
}

/* At a vertex or beside it, where it was or where it is. */
static vec3 near_vertex(const struct soft_body *soft, double off)
{
    const uint32_t v = whole_in(&rng, 0, soft->body.fixture.mesh->vertices - 1);
    const float *x = one_in(&rng, 2) ? soft->last : soft->now;
    return along(vec3_of_float(x + 3 * (size_t)v), off, any_unit(&rng));
}

static void check_search(struct soft_body *soft, const struct made_hull *made, struct hull_place *place)
{
    const dpt_pose pose = any_pose(&rng, 0.0);
    struct frame tool;
    struct hull_nearest nearest;
    struct work work = work_of(WORK_UNLIMITED);
    double corners[3 * ORACLE_CORNERS];
    frame_of_pose(&pose, &tool);
    tool.origin = near_vertex(soft, made->size * power_in(&rng, -1.0, 1.0));
    set_triangles(soft, 1.0);
    hull_place_set(place, made->hull, &tool, &frame_identity);
    for (uint32_t i = 0; i < made->as.corner_count; i++)
        vec3_store(place->corner[i], corners + 3 * i);
    const int is_proven = dpti_hull_search(&soft->body.surface, &soft->body.kernel, place,
                                           one_in(&rng, 2) ? whole_in(&rng, 0, soft->triangles.count - 1) : DPT_NONE,
                                           HUGE_VAL, &work, &nearest);
    const double bound = dpti_hull_error(place, &soft->body.surface, &tool, &frame_identity);
    const struct oracle_interval truth =
        oracle_hull_surface(corners, made->as.corner_count, &soft->triangles, 0.0, HUGE_VAL, NULL);
    CHECK(is_proven && nearest.distance >= truth.lower - bound && nearest.distance <= truth.upper + bound,
          "%d, %.17g, not %.17g..%.17g", is_proven, nearest.distance, truth.lower, truth.upper);
}

static void check_sweep(struct soft_body *soft, const struct made_hull *made, struct throw_tally *tally)
{
    const int is_at_rest = one_in(&rng, 10);
    struct hull_throw thrown = { .surface = &soft->body.surface,
                                 .kernel = &soft->body.kernel,
                                 .triangles = &soft->triangles,
                                 .made = made,
                                 .tick = is_at_rest ? 0 : soft->tick };
    dpt_pose *pose = &thrown.motion.tool_from, turn = DPT_POSE_IDENTITY;
    const double off = made->size * random_in(&rng, 0.3, 3.0);
    thrown.tick_from = one_in(&rng, 2) ? 0.0 : random_in(&rng, 0.0, 0.9);
    set_triangles(soft, is_at_rest ? 1.0 : thrown.tick_from);
    thrown.tolerance = soft->body.diagonal * power_in(&rng, -7.0, -4.0);
    thrown.clearance = one_in(&rng, 2) ? 0.0 : 0.1 * made->size;
    thrown.noise = 0x1p-40;
    for (int i = 0; i < 4; i++)
        pose[i] = (dpt_pose)DPT_POSE_IDENTITY;
    pose[0] = pose[1] = any_pose(&rng, 0.0);
    vec3_store(near_vertex(soft, off), pose[0].position);
    memcpy(pose[1].position, pose[0].position, sizeof pose[0].position);
    if (!one_in(&rng, 4))
        vec3_store(one_in(&rng, 2) ? near_vertex(soft, off) : add(vec3_of(pose[0].position), any_in(&rng, made->size)),
                   pose[1].position);
    if (one_in(&rng, 2)) {
        pose_turn(any_unit(&rng), random_in(&rng, -1.0, 1.0), &turn);
        const dpt_pose turned = pose_in(&turn, &pose[1]);
        memcpy(pose[1].orientation, turned.orientation, sizeof turned.orientation);
    }
    check_throw(&rng, &thrown, tally);
}

static void what_moves_is_met_in_time(void)
{
    static const char *const shapes[] = { "membrane", "liver", "cloth" };
    static const uint64_t triangles[] = { 128, 500, 450 };
    static struct made_hull made;
    static struct hull_place place;
    for (int s = 0; s < 3; s++) {
        struct soft_body soft;
        struct throw_tally tally = { .throws = 0 };
        if (!open_soft(&soft, shapes[s], triangles[s]))
            continue;
        for (uint64_t i = 0; i < part_of(400); i++) {
            const double size = soft.body.diagonal * power_in(&rng, -2.0, -0.5);
            move_soft(&soft);
            make_any_hull(&rng, size, &made);
            if (one_in(&rng, 2))
                CHECK(make_hull(&made, size * power_in(&rng, -2.0, 0.0)) == DPT_OK, "a radius");
            check_search(&soft, &made, &place);
            for (int k = 0; k < 3; k++)
                check_sweep(&soft, &made, &tally);
        }
        print_throws(shapes[s], &tally);
        CHECK(tally.hits > tally.throws / 10 && tally.hits < tally.throws, "%lu hits", tally.hits);
        close_soft(&soft);
    }
}

int main(int argc, char **argv)
{
    take_percent(argc, argv);
    TEST(what_moves_is_met_in_time);
    return check_report();
}
