/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A tool that stands on a surface and is pushed down along its axis: docs/algorithms/force.md, "Upright tools". Up to the
 * force 2 K_r / L it stands; beyond it leans, lies down in front of the surface, and is led back when the hand lifts.
 */
#include "force/side_scene.h"
#include "lib/fixture.h"
#include "proxy/place_visit.h"

enum { SHEET = 0, GROOVE = 1 };

#define STEP 1e-4 /* m in a tick */

static const double lengths[] = { 0.02, 0.05, 0.1, 0.2, 0.3 }, stiffnesses[] = { 50, 500, 5000 };
enum { LENGTHS = sizeof lengths / sizeof *lengths, STIFFNESSES = sizeof stiffnesses / sizeof *stiffnesses };

static void stiffen(const struct rig *rig, double stiffness, double rotational)
{
    dpt_tool_settings settings = { .size = sizeof settings };
    dpt_tool_get_settings(rig->world, rig->tool, &settings);
    settings.stiffness = stiffness;
    settings.rotational_stiffness = rotational;
    dpt_tool_set_settings(rig->world, rig->tool, &settings);
}

/* A tool above the middle of a scene, tilted from the upright by `lean`. */
static int stand(struct side_scene *scene, int shape, double length, double lean)
{
    static const double axis[3] = { 0.6, 0.8, 0 };
    const dpt_segment segment = { { 0, 0, 0 }, { 0, 0, length }, 0.001 };
    if (!side_scene_open(scene, shape, NULL, &segment, 1, 1))
        return 0;
    scene->rig.device = (dpt_pose){ { 0.0011, 0.0007, 0.004 }, { 1, 0, 0, 0 } };
    pose_orient(&scene->rig.device, axis, lean);
    rig_place(&scene->rig);
    return 1;
}

/* rad, of the proxy from the upright */
static double lean_of(const struct rig *rig)
{
    double ends[6];
    rig_proxy_ends(rig, 0, ends);
    return atan2(hypot(ends[3] - ends[0], ends[4] - ends[1]), ends[5] - ends[2]);
}

/* Let it come to rest, as deep as pushes it with that force. */
static void push(struct side_scene *scene, double force, double stiffness)
{
    scene->rig.device.position[2] = 0.001 - force / stiffness;
    for (int tick = 0; tick < 4000; tick++)
        rig_step(&scene->rig);
}

/*
 * rad: where 1/2 K (centre's sink)^2 + 1/2 K_r (turn)^2 is least, for a device that leans, `deep` m too low: the first
 * zero of its slope. With a small lean below the limit that is lean / (1 - F L / 2 K_r).
 */
static double lean_expected(double length, double stiffness, double turn, double lean, double deep)
{
    double low = lean, high = 1.5;
    for (int i = 0; i < 60; i++) {
        const double at = 0.5 * (low + high), sunk = deep - 0.5 * length * (cos(lean) - cos(at));
        const double slope = turn * (at - lean) - stiffness * sunk * 0.5 * length * sin(at);
        *(slope < 0 ? &low : &high) = at;
    }
    return low;
}

static void it_buckles_where_the_formula_says(void)
{
    const double lean = 0.01;
    for (int i = 1; i < LENGTHS; i++)
        for (int k = 0; k < 2; k++) {
            struct side_scene scene;
            const double length = lengths[i], stiffness = 500, rotational = k ? 0.2 * length : 0;
            const double turn = k ? rotational : stiffness * length * length / 12, critical = 2 * turn / length;
            if (stand(&scene, SHEET, length, lean)) {
                stiffen(&scene.rig, stiffness, rotational);
                for (double share = 0.2; share < 1.6; share += 0.2) {
                    const double deep = share * critical / stiffness;
                    const double expected = lean_expected(length, stiffness, turn, lean, deep);
                    push(&scene, share * critical, stiffness);
                    CHECK(fabs(lean_of(&scene.rig) / expected - 1) < 0.03,
                          "%g mm, K_r %g, %g of the limit: %g rad, not %g", 1e3 * length, turn, share,
                          lean_of(&scene.rig), expected);
                    CHECK(k || share > 0.65 || fabs(expected / lean * (1 - share) - 1) < 0.02,
                          "%g of the limit: grown %g times", share, expected / lean);
                    CHECK(share < 1.3 || lean_of(&scene.rig) > 6 * lean, "beyond the limit: %g rad",
                          lean_of(&scene.rig));
                }
            }
            side_scene_close(&scene);
        }
}

static double wrench_apart(const dpt_wrench *a, const dpt_wrench *b, double rho)
{
    return hypot(apart(a->force, b->force), apart(a->torque, b->torque) / rho);
}

/* J: of the wrench, about the frame's origin, over one step of the device, which does not turn. */
static double work_of_shift(const dpt_wrench *before, const dpt_wrench *now, const double step[3])
{
    double work = 0;
    for (int k = 0; k < 3; k++)
        work += 0.5 * (before->force[k] + now->force[k]) * step[k];
    return work;
}

/* Down by `deep` lengths and up again: in front on each tick, without a jump, without work won, and back with its device. */
static void lead_down(int shape, double length, double stiffness, double deep)
{
    struct side_scene scene;
    const int ticks = (int)(deep * length / STEP);
    double most_turned = 0, work = 0, energy = 0;
    if (stand(&scene, shape, length, 0.05)) {
        stiffen(&scene.rig, stiffness, 0);
        for (int tick = 0; tick < 2 * ticks + 20; tick++) {
            const dpt_wrench before = scene.rig.force.wrench;
            const double step[3] = { 0, 0, tick < ticks ? -STEP : STEP };
            scene.rig.device.position[2] += step[2];
            rig_step(&scene.rig);
            const double jump = wrench_apart(&before, &scene.rig.force.wrench, length);
            CHECK(scene.rig.force.reason <= DPT_FORCE_FREE, "%s, %g mm, tick %d: reason %u, flags %u", scene.name,
                  1e3 * length, tick, scene.rig.force.reason, scene.rig.force.flags);
            CHECK(jump <= stiffness * (3 * STEP + RIG_DT), "%s, %g mm, tick %d: jumps by %g N", scene.name,
                  1e3 * length, tick, jump);
            if (!side_scene_judge(&scene))
                break;
            work += work_of_shift(&before, &scene.rig.force.wrench, step);
            energy = fmax(energy, scene.rig.force.energy);
            most_turned = fmax(most_turned, lean_of(&scene.rig));
        }
        CHECK(most_turned > 1.05, "%s, %g mm: it leans by %g rad at most", scene.name, 1e3 * length, most_turned);
        CHECK(work <= 1e-3 * energy, "%s, %g mm, %g N/m: emits %g J of %g", scene.name, 1e3 * length, stiffness, work,
              energy);
        CHECK(scene.rig.force.reason == DPT_FORCE_FREE &&
                  !memcmp(&scene.rig.proxy, &scene.rig.device, sizeof(dpt_pose)),
              "%s, %g mm: not led back, reason %u", scene.name, 1e3 * length, scene.rig.force.reason);
    }
    side_scene_close(&scene);
}

static void one_that_topples_lies_in_front_and_is_led_back(void)
{
    for (int i = 0; i < LENGTHS; i++)
        for (int k = 0; k < STIFFNESSES; k++)
            lead_down(SHEET, lengths[i], stiffnesses[k], 1.3);
}

static void so_it_does_in_a_groove_of_60_degrees(void)
{
    for (int i = 1; i < LENGTHS; i++)
        lead_down(GROOVE, lengths[i], 500, 1.3);
}

/* A membrane of springs, whose drag resists. */
struct tissue {
    struct rig rig;
    struct fixture mesh;
    dpt_body body;
    dpt_springs *springs;
};

static int open_tissue(struct tissue *tissue, const dpt_segment *segment)
{
    const dpt_spring_net_def net = { .size = sizeof net,
                                     .kind = DPT_NET_SHEET,
                                     .young = 2e6,
                                     .thickness = 5e-3,
                                     .density = 4000.0,
                                     .drag = 2000.0,
                                     .viscosity = 1e-4 };
    dpt_deformable_def deform;
    dpt_springs_def springs;
    *tissue = (struct tissue){ .body = 0 };
    if (!rig_open(&tissue->rig, NULL, NULL, segment, 1) || !fixture_with_springs(&tissue->mesh, "membrane", 512, &net))
        return 0;
    dpt_deformable_def_init(&deform);
    dpt_springs_def_init(&springs);
    deform.mesh = springs.mesh = tissue->mesh.mesh;
    for (int k = 0; k < 3; k++) {
        deform.box_min[k] = -1.0;
        deform.box_max[k] = 1.0;
    }
    tissue->body = rig_add_deformable(&tissue->rig, &deform);
    tissue->springs = rig_add_springs(&tissue->rig, &springs);
    return tissue->springs != NULL;
}

/* Whether a ray upwards from a point meets the membrane an even number of times. */
static int is_over(const struct tissue *tissue, const double x[3])
{
    const float *vertices;
    const uint32_t *corners;
    uint32_t vertex_count, count;
    int above = 0;
    dpt_body_get_vertices(tissue->rig.world, tissue->body, &vertices, &vertex_count);
    dpt_mesh_get_triangles(tissue->mesh.mesh, &corners, NULL, &count);
    for (uint32_t t = 0; t < count; t++) {
        double c[3][3];
        for (int i = 0; i < 9; i++)
            c[i / 3][i % 3] = (double)vertices[3 * corners[3 * t + (uint32_t)i / 3] + (uint32_t)i % 3];
        const double area = (c[1][0] - c[0][0]) * (c[2][1] - c[0][1]) - (c[2][0] - c[0][0]) * (c[1][1] - c[0][1]);
        const double v = ((x[0] - c[0][0]) * (c[2][1] - c[0][1]) - (c[2][0] - c[0][0]) * (x[1] - c[0][1])) / area;
        const double w = ((c[1][0] - c[0][0]) * (x[1] - c[0][1]) - (x[0] - c[0][0]) * (c[1][1] - c[0][1])) / area;
        if (v >= 0 && w >= 0 && v + w <= 1)
            above ^= c[0][2] + v * (c[1][2] - c[0][2]) + w * (c[2][2] - c[0][2]) > x[2];
    }
    return !above;
}

/* Pushed down in 0.5 s, held, and led up again, by hands that lean: in front on each tick, and led back. */
static void so_it_does_on_tissue(void)
{
    static const dpt_segment stylus = { { 0, 0, 0 }, { 0, 0, 0.05 }, 0.001 };
    for (int i = 0; i < 4; i++) {
        struct tissue tissue;
        const double axis[3] = { cos(i), sin(i), 0 }, deep = 0.02 + 0.015 * i;
        double most_turned = 0;
        int is_right = open_tissue(&tissue, &stylus);
        tissue.rig.device = (dpt_pose){ { 0.003, 0.002, 0.004 }, { 1, 0, 0, 0 } };
        pose_orient(&tissue.rig.device, axis, 0.1);
        if (is_right)
            rig_place(&tissue.rig);
        for (int tick = 0; is_right && tick < 1500; tick++) {
            double ends[6], x[3];
            const double share = tick < 500 ? tick / 500.0 : tick < 900 ? 1 : fmax(-0.5, 1 - (tick - 900) / 300.0);
            tissue.rig.device.position[2] = 0.004 - deep * share;
            rig_step(&tissue.rig);
            CHECK(dpt_body_step_springs(tissue.rig.world, tissue.body, tissue.springs, RIG_DT, NULL) == DPT_OK,
                  "springs");
            rig_proxy_ends(&tissue.rig, 0, ends);
            for (int n = 0; n < 6; n++) {
                for (int k = 0; k < 3; k++)
                    x[k] = ends[k] + n / 5.0 * (ends[3 + k] - ends[k]);
                is_right &= is_over(&tissue, x) && tissue.rig.force.reason <= DPT_FORCE_FREE;
            }
            CHECK(is_right, "tissue, %g mm, tick %d: behind, or reason %u, flags %u", 1e3 * deep, tick,
                  tissue.rig.force.reason, tissue.rig.force.flags);
            most_turned = fmax(most_turned, lean_of(&tissue.rig));
        }
        CHECK(!is_right || tissue.rig.force.reason == DPT_FORCE_FREE, "tissue, %g mm: not led back", 1e3 * deep);
        CHECK(i < 2 || most_turned > 1.2, "tissue, %g mm: it leans by %g rad at most", 1e3 * deep, most_turned);
        rig_close(&tissue.rig);
        fixture_free(&tissue.mesh);
    }
}

/*
 * Down, to and fro, turning, and up again, by paths that close: energy as the spring stores it, and no work is won, though
 * the tool lies far turned from the device meanwhile.
 */
static void no_path_on_which_it_topples_gives_work(void)
{
    static const dpt_segment stylus = { { 0, 0, 0 }, { 0, 0, 0.05 }, 0.001 };
    struct solid sheet;
    double most_turned = 0;
    uint64_t seed = 5;
    if (!solid_from_shape(&sheet, "membrane", 512))
        return;
    for (int path = 0; path < 12; path++) {
        struct visit visit;
        double axis[3], side[3], turn = random_in(&seed, 0.1, 0.8), aside = random_in(&seed, 0, 0.02);
        random_unit(&seed, axis);
        random_unit(&seed, side);
        visit_open(&visit, "stylus", &stylus, 1);
        visit_add(&visit, &sheet, NULL);
        for (int tick = 0; tick <= 3000; tick++) {
            const double share = sin(3.14159265358979 * tick / 3000),
                         swing = share * sin(6.28318530717959 * tick / 1000);
            for (int k = 0; k < 3; k++)
                visit.rig.device.position[k] =
                    (k == 2 ? 0.003 - 0.06 * share : 0) + (k < 2 ? aside * swing * side[k] : 0);
            pose_orient(&visit.rig.device, axis, turn * swing);
            if (tick == 0)
                visit_begin(&visit);
            visit_tick(&visit);
            most_turned = fmax(most_turned, angle_apart(&visit, &visit.rig.proxy, &visit.rig.device));
        }
        visit_end(&visit);
        CHECK(!visit.is_replaced, "path %d: it was put", path);
        visit_close(&visit);
    }
    CHECK(most_turned > 1.5, "turned by %g rad at most", most_turned);
    solid_close(&sheet);
}

/* 15 N times half of the length holds it with a small lean, whatever its length and the spring's stiffness. */
static void a_stiffness_against_turns_holds_it_up_to_10_newtons(void)
{
    for (int i = 1; i < LENGTHS; i++)
        for (int k = 0; k < STIFFNESSES; k++) {
            struct side_scene scene;
            const double length = lengths[i], stiffness = stiffnesses[k], lean = 0.05;
            if (stand(&scene, SHEET, length, lean)) {
                stiffen(&scene.rig, stiffness, 15.0 * 0.5 * length);
                int tick = 0;
                for (; tick < 4000 && scene.rig.force.wrench.force[2] < 10; tick++) {
                    scene.rig.device.position[2] -= 0.01 / stiffness;
                    rig_step(&scene.rig);
                    CHECK(lean_of(&scene.rig) < 3.1 * lean, "%g mm, %g N/m, %g N: it leans by %g rad", 1e3 * length,
                          stiffness, scene.rig.force.wrench.force[2], lean_of(&scene.rig));
                }
                CHECK(tick < 4000, "%g mm, %g N/m: %g N at most", 1e3 * length, stiffness,
                      scene.rig.force.wrench.force[2]);
            }
            side_scene_close(&scene);
        }
}

int main(void)
{
    TEST(it_buckles_where_the_formula_says);
    TEST(one_that_topples_lies_in_front_and_is_led_back);
    TEST(so_it_does_in_a_groove_of_60_degrees);
    TEST(so_it_does_on_tissue);
    TEST(no_path_on_which_it_topples_gives_work);
    TEST(a_stiffness_against_turns_holds_it_up_to_10_newtons);
    return check_report();
}
