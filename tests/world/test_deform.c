/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Deformable bodies. In each tick the nearest pair is that of brute force over the positions of that tick, whatever the
 * motion and however it is handed over; gap and contacts are those of a rigid body that is compiled of these positions.
 * Whether the force is a good one test_deform_push judges.
 *
 *     test_deform [PER CENT]   of the ticks
 */
#include "lib/mesh_builder.h"
#include "oracle/brute.h"
#include "world/deform_scene.h"

static const char *const shapes[] = { "liver", "cloth", "torus", "star", "membrane" };
static const uint64_t triangles[] = { 2000, 1800, 800, 2000, 1250 };
enum { SHAPES = sizeof shapes / sizeof *shapes };

/* m a tick, as shares of the diagonal: 0.03 mm to 10 mm on an organ. */
static const double steps[] = { 1e-4, 3e-3, 3e-2 };

static uint64_t seed = 1;

/* The tool wanders about the body, in it and beside it, now and then jumps, and half of the time it rests. */
static dpt_pose next_pose(struct deform_scene *scene, uint64_t tick)
{
    const double speed = tick % 32 < 16 ? 1.0 : 0.0;
    static double place[3], axis[4] = { 1.0, 0.0, 0.0, 0.0 };
    dpt_pose pose;
    double size = 0.0;
    for (int k = 0; k < 3; k++) {
        const double middle = 0.5 * (scene->low[k] + scene->high[k]);
        if (tick % 64 == 0)
            place[k] = middle + random_in(&seed, -0.6, 0.6) * scene->diagonal;
        else
            place[k] += random_in(&seed, -2e-3, 2e-3) * speed * scene->diagonal;
    }
    for (int k = 0; k < 4; k++) {
        axis[k] += random_in(&seed, -0.02, 0.02) * speed;
        size += axis[k] * axis[k];
    }
    for (int k = 0; k < 4; k++)
        pose.orientation[k] = axis[k] /= sqrt(size);
    memcpy(pose.position, place, sizeof place);
    return pose;
}

static void add_tool(struct deform_scene *scene, double radius)
{
    const dpt_segment segment = { { 0.0, 0.0, 0.0 }, { 0.3 * scene->diagonal, 0.0, 0.0 }, radius };
    rig_add_tool(&scene->rig, &segment, 1);
}

/* The ends of the segment at a pose. */
static void ends_at(const struct deform_scene *scene, const dpt_pose *pose, double ends[6])
{
    const double w = pose->orientation[0], x = pose->orientation[1], y = pose->orientation[2], z = pose->orientation[3],
                 length = 0.3 * scene->diagonal;
    const double u[3] = { w * w + x * x - y * y - z * z, 2.0 * (x * y + w * z), 2.0 * (x * z - w * y) };
    for (int k = 0; k < 3; k++) {
        ends[k] = pose->position[k];
        ends[3 + k] = pose->position[k] + length * u[k];
    }
}

/* Brute force over the positions of this tick. */
static double truth_at(const struct deform_scene *scene, const double ends[6])
{
    const uint32_t *corners;
    uint32_t count;
    dpt_mesh_get_triangles(scene->fixture.mesh, &corners, NULL, &count);
    oracle_mesh *mesh = oracle_brute_open(scene->positions, scene->vertices, corners, count);
    const double distance = oracle_brute(mesh, ends, NULL);
    oracle_brute_close(mesh);
    return distance;
}

static void check_tick(struct deform_scene *scene, const char *name, uint64_t tick, uint32_t budget)
{
    const dpt_pose pose = next_pose(scene, tick);
    dpt_hit hit = DPT_HIT_INIT;
    double ends[6];
    rig_step_to(&scene->rig, &pose);
    dpt_tool_get_hit(scene->rig.world, scene->rig.tool, &hit);
    ends_at(scene, &pose, ends);
    const double truth = truth_at(scene, ends), slack = 1e-14 * (1.0 + scene->diagonal);
    CHECK(budget || hit.status == DPT_STATUS_EXACT, "%s %u: status %u", name, (unsigned)tick, hit.status);
    CHECK(hit.distance >= truth - hit.error_bound - slack && hit.lower_bound <= truth + slack,
          "%s %u: %.17g..%.17g, not %.17g", name, (unsigned)tick, hit.lower_bound, hit.distance, truth);
    if (hit.status == DPT_STATUS_EXACT)
        CHECK(fabs(hit.distance - truth) <= hit.error_bound + slack, "%s %u: %.17g, not %.17g", name, (unsigned)tick,
              hit.distance, truth);
}

static void follow_motion(int shape, enum deform_kind kind, double step, uint32_t budget, uint64_t ticks)
{
    struct deform_scene scene;
    dpt_world_def def = rig_def(DPT_LAW_PROXY);
    def.until = DPT_UNTIL_TRACK;
    def.budget = budget;
    if (!deform_scene_open(&scene, shapes[shape], triangles[shape], &def, NULL))
        return;
    add_tool(&scene, 0.0);
    scene.kind = kind;
    scene.step = step * scene.diagonal;
    for (uint64_t tick = 0; tick < ticks; tick++) {
        /* Physics is slower than the loop at times. */
        if (random_bits(&seed) % 4) {
            deform_scene_advance(&scene);
            deform_scene_set(&scene, (enum deform_form)(random_bits(&seed) % DEFORM_FORMS));
        }
        check_tick(&scene, shapes[shape], tick, budget);
    }
    deform_scene_close(&scene);
}

static void the_nearest_pair_is_exact(void)
{
    for (int shape = 0; shape < SHAPES; shape++)
        for (int kind = 0; kind < DEFORM_KINDS; kind++)
            for (size_t s = 0; s < sizeof steps / sizeof *steps; s++)
                follow_motion(shape, (enum deform_kind)kind, steps[s], 0, part_of(200));
}

static void a_budget_bounds_the_answer(void)
{
    for (int shape = 0; shape < SHAPES; shape++)
        for (int kind = 0; kind < DEFORM_KINDS; kind++)
            follow_motion(shape, (enum deform_kind)kind, 3e-3, 10 + 30 * (uint32_t)kind, part_of(300));
}

/* A rigid body of the positions of this tick. */
static int compile_now(const struct deform_scene *scene, struct fixture *fixture)
{
    const uint32_t *corners;
    uint32_t count;
    dpt_mesh_get_triangles(scene->fixture.mesh, &corners, NULL, &count);
    double *vertices = malloc(3 * sizeof *vertices * (size_t)scene->vertices);
    for (size_t i = 0; i < 3 * (size_t)scene->vertices; i++)
        vertices[i] = (double)scene->positions[i];
    const int made = fixture_from_arrays(fixture, vertices, scene->vertices, corners, count);
    free(vertices);
    return made;
}

static double sum_overlap(const dpt_world *world, dpt_tool tool)
{
    dpt_contact contacts[32];
    uint32_t count;
    double sum = 0.0;
    contacts[0].size = sizeof *contacts;
    CHECK(dpt_tool_get_contacts(world, tool, contacts, 32, &count) == DPT_OK && count <= 32, "%u contacts", count);
    for (uint32_t i = 0; i < count && i < 32; i++)
        sum += contacts[i].overlap;
    return sum;
}

/* A body that cuts itself has another inside by winding number than by its normals: nothing to compare. */
static int cuts_itself(const struct fixture *fixture)
{
    dpt_mesh_info info = { .size = sizeof info };
    dpt_mesh_get_info(fixture->mesh, &info);
    return info.self_intersections > 0;
}

/* How overlaps and gaps agree with those of rigid bodies that have never been sampled before. */
struct agreement {
    uint64_t compared, off, gaps_off;
    double peak, farthest;
};

static void note_sums(struct agreement *sums, double sum, double truth, double diagonal)
{
    const double apart = fabs(sum - truth);
    sums->compared++;
    sums->off += apart > 0.02 * truth + 1e-4 * diagonal * diagonal;
    sums->peak = fmax(sums->peak, truth);
    sums->farthest = fmax(sums->farthest, apart);
}

/* As for a rigid body (test_contact_integrals.c): 2 % of the peak, as different samples may show different surface. */
static void check_sums(const struct agreement *sums, const char *name)
{
    CHECK(sums->farthest <= 0.02 * sums->peak, "%s: overlap %g off, of %g", name, sums->farthest, sums->peak);
    CHECK(sums->off <= 1 + sums->compared / 10000, "%s: %u of %u overlaps are off", name, (unsigned)sums->off,
          (unsigned)sums->compared);
    CHECK(sums->gaps_off == 0, "%s: %u of %u gaps are off", name, (unsigned)sums->gaps_off, (unsigned)sums->compared);
}

/* The same pose in a new world with a rigid body. */
static void compare_contact(struct deform_scene *scene, const dpt_world_def *def, const dpt_pose *pose,
                            struct agreement *sums, const char *name)
{
    struct deform_scene rigid = { .diagonal = scene->diagonal };
    dpt_hit hit = DPT_HIT_INIT, truth = DPT_HIT_INIT;
    if (!compile_now(scene, &rigid.fixture))
        return;
    dpt_world_def unlimited = *def;
    unlimited.budget = 0;
    rig_open(&rigid.rig, &unlimited, rigid.fixture.mesh, NULL, 0);
    add_tool(&rigid, 0.02 * scene->diagonal);
    rig_step_to(&rigid.rig, pose);
    dpt_tool_get_hit(scene->rig.world, scene->rig.tool, &hit);
    dpt_tool_get_hit(rigid.rig.world, rigid.rig.tool, &truth);
    const double sum = def->max_contacts ? sum_overlap(scene->rig.world, scene->rig.tool) : 0.0;
    const double true_sum = def->max_contacts ? sum_overlap(rigid.rig.world, rigid.rig.tool) : 0.0;
    if (cuts_itself(&rigid.fixture) || (def->budget && !(hit.flags & DPT_HIT_FLAG_GAP))) {
        rig_close(&rigid.rig);
        fixture_free(&rigid.fixture);
        return;
    }
    CHECK(hit.flags == truth.flags, "%s: flags %u, not %u", name, hit.flags, truth.flags);
    sums->gaps_off += fabs(hit.gap - truth.gap) > 3e-5 * scene->diagonal;
    note_sums(sums, sum, true_sum, scene->diagonal);
    rig_close(&rigid.rig);
    fixture_free(&rigid.fixture);
}

/* step: m a tick, as a share of the diagonal. */
static void compare_contacts(const dpt_world_def *def, double step)
{
    static const int closed[] = { 0, 2, 3 };
    for (int c = 0; c < 3; c++)
        for (int kind = 0; kind < DEFORM_KINDS; kind++) {
            struct deform_scene scene;
            struct agreement sums = { 0 };
            if (kind == DEFORM_FOLD || !deform_scene_open(&scene, shapes[closed[c]], triangles[closed[c]], def, NULL))
                continue;
            add_tool(&scene, 0.02 * scene.diagonal);
            scene.kind = (enum deform_kind)kind;
            scene.step = step * scene.diagonal;
            for (uint64_t tick = 0; tick < part_of(120); tick++) {
                deform_scene_advance(&scene);
                deform_scene_set(&scene, (enum deform_form)(random_bits(&seed) % DEFORM_FORMS));
                const dpt_pose pose = next_pose(&scene, tick);
                rig_step_to(&scene.rig, &pose);
                if (tick % 3 == 2)
                    compare_contact(&scene, def, &pose, &sums, shapes[closed[c]]);
            }
            check_sums(&sums, shapes[closed[c]]);
            deform_scene_close(&scene);
        }
}

static void contact_is_that_of_a_rigid_body(void)
{
    dpt_world_def def = rig_def(DPT_LAW_PROXY);
    def.until = DPT_UNTIL_CONTACT;
    def.margin = 0.005;
    compare_contacts(&def, 1e-3);
}

/* A budget that suffices as a rule: what the point cache holds of the last tick must not count. */
static void contact_within_a_budget(void)
{
    dpt_world_def def = rig_def(DPT_LAW_PROXY);
    def.until = DPT_UNTIL_CONTACT;
    def.max_contacts = 0;
    def.budget = 4000;
    compare_contacts(&def, 1e-2);
}

/* All on a point, on a line, in a plane, inside out, or anywhere. */
static void spoil(struct deform_scene *scene, uint64_t tick)
{
    const float at[3] = { (float)random_in(&seed, scene->low[0], scene->high[0]), 0.0f, 0.01f };
    for (uint32_t v = 0; v < scene->vertices; v++)
        for (uint32_t k = 0; k < 3; k++) {
            const float x = scene->rest[3 * v + k];
            float *next = &scene->next[3 * v + k];
            switch (tick / 4 % 6) {
            case 0:
                *next = at[k];
                break;
            case 1:
                *next = k == 0 ? x : at[k];
                break;
            case 2:
                *next = k == 2 ? at[k] : x;
                break;
            case 3:
                *next = (float)(scene->low[k] + scene->high[k]) - x;
                break;
            case 4:
                *next = (float)random_in(&seed, scene->low[k], scene->high[k]);
                break;
            default:
                *next = x;
            }
        }
}

static int is_finite(const double *numbers, int count)
{
    int all = 1;
    for (int i = 0; i < count; i++)
        all &= isfinite(numbers[i]) != 0;
    return all;
}

static void spoil_with(uint32_t law, uint32_t budget, const char *shape, uint64_t count)
{
    struct deform_scene scene;
    dpt_world_def def = rig_def(law);
    def.budget = budget;
    def.strip = DPT_STRIP_KIND_SHADOW;
    if (!deform_scene_open(&scene, shape, count, &def, NULL))
        return;
    add_tool(&scene, 0.02 * scene.diagonal);
    for (uint64_t tick = 0; tick < part_of(200); tick++) {
        dpt_force_info force = { .size = sizeof force };
        static dpt_load loads[4096];
        uint32_t loaded;
        spoil(&scene, tick);
        deform_scene_set(&scene, (enum deform_form)(random_bits(&seed) % DEFORM_FORMS));
        if (law == DPT_LAW_PROXY) {
            const dpt_pose pose = next_pose(&scene, tick);
            rig_step_to(&scene.rig, &pose);
        } else {
            check_tick(&scene, shape, tick, budget);
        }
        dpt_tool_get_force_info(scene.rig.world, scene.rig.tool, &force);
        CHECK(is_finite(force.wrench.force, 6) && is_finite(&force.energy, 1), "%s: no number", shape);
        CHECK(dpt_body_get_loads(scene.rig.world, scene.rig.body, loads, 4096, &loaded) == DPT_OK &&
                  (loaded == 0 || is_finite(loads[0].force, 3)),
              "%s: %u loads", shape, loaded);
    }
    deform_scene_close(&scene);
}

static void spoilt_shapes_have_answers(void)
{
    for (uint32_t law = DPT_LAW_POINT; law <= DPT_LAW_PROXY; law++)
        for (uint32_t k = 0; k < 2; k++) {
            spoil_with(law, 500 * k, "membrane", 200);
            spoil_with(law, 500 * k, "torus", 400);
        }
}

/* Real organs, clean and dirty: their units, and whether they are free of holes and of crossings. */
static const struct organ {
    const char *name;
    double scale;
} organs[] = { { "openhelp_liver.stl", 1e-3 },   { "gallbladder_fine.stl", 1.0 }, { "liver_dirty_low.stl", 1.0 },
               { "vessel_open_ends.stl", 1.0 },  { "aneurysm_sofa.off", 1.0 },    { "openhelp_stomach.stl", 1e-3 },
               { "liver_smooth_sofa.obj", 1e-2 } };

static void follow_organ(const struct organ *organ, const char *folder)
{
    struct deform_scene scene;
    dpt_world_def def = rig_def(DPT_LAW_PROXY);
    char path[1024];
    def.until = DPT_UNTIL_CONTACT;
    snprintf(path, sizeof path, "%s/meshes/organs/%s", folder, organ->name);
    if (!deform_scene_open_file(&scene, path, organ->scale, &def))
        return;
    add_tool(&scene, 0.02 * scene.diagonal);
    for (uint64_t tick = 0; tick < part_of(60); tick++) {
        scene.kind = (enum deform_kind)(tick / 20 % DEFORM_KINDS);
        deform_scene_advance(&scene);
        deform_scene_set(&scene, (enum deform_form)(random_bits(&seed) % DEFORM_FORMS));
        check_tick(&scene, organ->name, tick, 0);
    }
    deform_scene_close(&scene);
}

static void organs_are_followed(void)
{
    const char *folder = getenv("DPT_DATA");
    if (!folder) {
        SKIP("organs that deform", "DPT_DATA does not name the data folder");
        return;
    }
    for (size_t i = 0; i < sizeof organs / sizeof *organs; i++)
        follow_organ(&organs[i], folder);
}

/*
 * The winding number of a deforming body with holes, against that of a rigid one of the same positions. Through a hole
 * an axis may go in and out between two samples: overlaps are not compared, and 2 of 1,000 gaps may be off (sign.md).
 */
static void insides_with_holes_are_known(void)
{
    struct deform_scene scene;
    struct mesh_builder builder = { 0 };
    struct agreement sums = { 0 };
    dpt_world_def def = rig_def(DPT_LAW_PROXY);
    def.until = DPT_UNTIL_CONTACT;
    builder_add_ball(&builder, (vec3){ 0.0, 0.0, 0.0 }, 0.1, 0.03, 0);
    memset(&scene, 0, sizeof scene);
    if (!fixture_from_arrays(&scene.fixture, builder.vertices, builder.vertex_count, builder.corners,
                             builder.triangle_count) ||
        !deform_scene_open_mesh(&scene, &def, NULL))
        return;
    add_tool(&scene, 0.02 * scene.diagonal);
    scene.kind = DEFORM_BREATH;
    for (uint64_t tick = 0; tick < part_of(200); tick++) {
        deform_scene_advance(&scene);
        deform_scene_set(&scene, DEFORM_WHOLE);
        const dpt_pose pose = next_pose(&scene, tick);
        rig_step_to(&scene.rig, &pose);
        compare_contact(&scene, &def, &pose, &sums, "a ball with a hole");
    }
    CHECK(sums.gaps_off <= 1 + sums.compared / 500, "%u of %u gaps are off", (unsigned)sums.gaps_off,
          (unsigned)sums.compared);
    deform_scene_close(&scene);
    free(builder.vertices);
    free(builder.corners);
}

int main(int argc, char **argv)
{
    take_percent(argc, argv);
    TEST(the_nearest_pair_is_exact);
    TEST(a_budget_bounds_the_answer);
    TEST(contact_is_that_of_a_rigid_body);
    TEST(contact_within_a_budget);
    TEST(insides_with_holes_are_known);
    TEST(spoilt_shapes_have_answers);
    TEST(organs_are_followed);
    return check_report();
}
