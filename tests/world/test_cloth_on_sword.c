/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A sheet of springs falls on a rod, and the rod's triangles are displaced (DPT_RESPONSE_DISPLACE). It comes to rest on it
 * and sleeps; it never lets the rod through, and gains no energy; friction holds a sheet that
 * leans. The first argument
 * is how much of 10 s is run, in per cent.
 *
 * Distances are judged by oracle/pair.h. What the sheet does to itself is not judged.
 */
#include "lib/fixture.h"
#include "lib/rig.h"
#include "oracle/pair.h"
#include "scene/shape.h"

#define GRAVITY 9.81
#define TICK    1e-3
#define ROD     0.004
#define HEIGHT  0.02 /* of the fall, m */

enum { RODS_MAX = 7 };

static int seconds = 10;

struct sword {
    struct fixture fixture;
    struct rig rig;
    dpt_springs *springs;
    dpt_pose pose;
    dpt_springs_info report;
    dpt_mesh_springs net;
    const uint32_t *corners;
    uint32_t triangles, nodes;
    float *positions, *speeds;
};

static int open_sheet(struct fixture *fixture, const char *name, uint64_t triangles, double drag)
{
    const dpt_spring_net_def net = { .size = sizeof net,
                                     .kind = DPT_NET_SHEET,
                                     .young = 2e5,
                                     .thickness = 5e-4,
                                     .density = 400.0,
                                     .drag = drag,
                                     .viscosity = 1e-4 };
    struct shape shape;
    shape_reason reason;
    dpt_compile_def def;
    dpt_compile_def_init(&def);
    def.springs = &net;
    if (shape_make(name, triangles, 0, &shape, reason))
        return 0;
    dpt_result result = dpt_compile_arrays(shape.vertices, shape.vertex_count, shape.corners, shape.triangle_count,
                                           &def, &fixture->compiled, NULL);
    shape_free(&shape);
    if (result == DPT_OK)
        result = dpt_mesh_open(fixture->compiled.bytes, fixture->compiled.size, &fixture->mesh);
    CHECK(result == DPT_OK, "%s", dpt_result_name(result));
    return result == DPT_OK;
}

struct setup {
    const char *shape;
    uint32_t integrator;
    uint64_t triangles;
    uint32_t rods; /* along y, side by side under the middle */
    double low;    /* m: how deep their surfaces lie */
    double friction;
    double drag;
    double lean; /* rad: of the weight, towards -y */
};

/* z is up. */
static int open_sword(struct sword *sword, const struct setup *setup)
{
    dpt_world_def def = rig_def(DPT_LAW_POINT);
    dpt_deformable_def deform;
    dpt_springs_def springs;
    dpt_segment rods[RODS_MAX];
    memset(sword, 0, sizeof *sword);
    if (!open_sheet(&sword->fixture, setup->shape, setup->triangles, setup->drag))
        return 0;
    dpt_deformable_def_init(&deform);
    dpt_springs_def_init(&springs);
    def.strip = DPT_STRIP_KIND_SHADOW;
    def.strip_width = 0.01;
    def.strip_capacity = 4096;
    deform.mesh = springs.mesh = sword->fixture.mesh;
    deform.response = DPT_RESPONSE_DISPLACE;
    for (int k = 0; k < 3; k++) {
        deform.box_min[k] = -1.0;
        deform.box_max[k] = 1.0;
    }
    springs.integrator = setup->integrator;
    springs.gravity[1] = -GRAVITY * sin(setup->lean);
    springs.gravity[2] = -GRAVITY * cos(setup->lean);
    springs.sleep_speed = 0.01;
    springs.iterations = 16;
    for (uint32_t i = 0; i < setup->rods; i++) {
        const double x = 0.03 * ((double)i - 0.5 * (double)(setup->rods - 1));
        rods[i] = (dpt_segment){ { x, -0.3, 0.0 }, { x, 0.3, 0.0 }, ROD };
    }
    sword->pose = (dpt_pose){ { 0.0, 0.0, -setup->low - ROD }, { 1.0, 0.0, 0.0, 0.0 } };
    sword->report.size = sizeof sword->report;
    sword->net.size = sizeof sword->net;
    const dpt_body_settings rough = { .static_friction = setup->friction, .kinetic_friction = setup->friction };
    const int made = rig_open(&sword->rig, &def, NULL, rods, setup->rods) && rig_add_deformable(&sword->rig, &deform) &&
                     (sword->springs = rig_add_springs(&sword->rig, &springs)) != NULL &&
                     dpt_tool_teleport(sword->rig.world, sword->rig.tool, &sword->pose) == DPT_OK &&
                     dpt_mesh_get_springs(sword->fixture.mesh, &sword->net) == DPT_OK;
    CHECK(made, "not made");
    rig_set_body(&sword->rig, rough);
    dpt_mesh_get_triangles(sword->fixture.mesh, &sword->corners, NULL, &sword->triangles);
    sword->nodes = dpt_springs_get_count(sword->springs);
    sword->positions = malloc(3 * (size_t)sword->nodes * sizeof(float));
    sword->speeds = malloc(3 * (size_t)sword->nodes * sizeof(float));
    return made;
}

static void close_sword(struct sword *sword)
{
    rig_close(&sword->rig);
    free(sword->positions);
    free(sword->speeds);
    fixture_free(&sword->fixture);
}

static double gap(const struct sword *sword);

/* One tick. Returns how far the rod's surface is from the sheet, once that was displaced; HUGE_VAL: it was not asked for. */
static double tick(struct sword *sword, int measures)
{
    dpt_tool_set_pose(sword->rig.world, sword->rig.tool, &sword->pose);
    dpt_result result = dpt_world_step(sword->rig.world, TICK, NULL);
    CHECK(result == DPT_OK, "%s", dpt_result_name(result));
    const double found = measures ? gap(sword) : HUGE_VAL;
    result = dpt_body_step_springs(sword->rig.world, sword->rig.body, sword->springs, TICK, &sword->report);
    CHECK(result == DPT_OK, "%s", dpt_result_name(result));
    return found;
}

/* Of the first rod, which is under the middle. */
static double gap(const struct sword *sword)
{
    const float *positions;
    uint32_t count;
    const double *at = sword->pose.position;
    const double ends[6] = { at[0], -0.3, at[2], at[0], 0.3, at[2] };
    double least = HUGE_VAL;
    dpt_body_get_vertices(sword->rig.world, sword->rig.body, &positions, &count);
    for (uint32_t t = 0; t < sword->triangles; t++) {
        double triangle[9];
        for (uint32_t k = 0; k < 9; k++)
            triangle[k] = (double)positions[3 * (size_t)sword->corners[3 * t + k / 3] + k % 3];
        if (hypot(triangle[0] - at[0], triangle[2] - at[2]) < 0.03)
            least = fmin(least, (double)oracle_pair(ends, triangle) - ROD);
    }
    return least;
}

/* J: springs, motion and weight. */
static double energy_of(struct sword *sword)
{
    double elastic, kinetic, sum;
    dpt_springs_get_energy(sword->springs, &elastic, &kinetic);
    dpt_springs_get_nodes(sword->springs, sword->nodes, sword->positions, sword->speeds);
    sum = elastic + kinetic;
    for (uint32_t i = 0; i < sword->nodes; i++)
        sum += (double)sword->net.mass[i] * GRAVITY * (double)sword->positions[3 * i + 2];
    return sum;
}

/* Where the middle of the mass is along the rod, m. */
static double middle_of(struct sword *sword)
{
    double moment = 0.0, mass = 0.0;
    dpt_springs_get_nodes(sword->springs, sword->nodes, sword->positions, sword->speeds);
    for (uint32_t i = 0; i < sword->nodes; i++) {
        mass += (double)sword->net.mass[i];
        moment += (double)sword->net.mass[i] * (double)sword->positions[3 * i + 1];
    }
    return moment / mass;
}

/* Where its lowest node is, m. */
static double lowest_of(struct sword *sword)
{
    double lowest = HUGE_VAL;
    dpt_springs_get_nodes(sword->springs, sword->nodes, sword->positions, sword->speeds);
    for (uint32_t i = 0; i < sword->nodes; i++)
        lowest = fmin(lowest, (double)sword->positions[3 * i + 2]);
    return lowest;
}

/* Of the rod's radius: so much of it may be left inside after the passes. */
#define LEFT 0.05

static const struct setup fall = { .shape = "cloth",
                                   .integrator = DPT_INTEGRATOR_IMPLICIT,
                                   .triangles = 2048,
                                   .rods = 1,
                                   .low = HEIGHT,
                                   .friction = 0.5,
                                   .drag = 2.0 };

static void a_cloth_falls_on_a_sword(void)
{
    const int ticks = 1000 * seconds;
    struct sword sword;
    double deepest = HUGE_VAL, highest = -HUGE_VAL;
    if (open_sword(&sword, &fall)) {
        const double first = energy_of(&sword);
        for (int i = 0; i < ticks; i++) {
            deepest = fmin(deepest, tick(&sword, i % 10 == 0));
            if (i % 100 == 0)
                highest = fmax(highest, energy_of(&sword));
        }
        CHECK(deepest > -LEFT * ROD, "%g m in the rod", -deepest);
        CHECK(highest <= first + 1e-6, "%g J, %g J at first", highest, first);
        CHECK(fabs(middle_of(&sword)) < 0.005, "the middle is at %g m", middle_of(&sword));
        CHECK(sword.report.active == 0 || seconds < 10, "%u nodes are awake", sword.report.active);
        printf("    at most %.1f um left in the rod, %.3g J gained, %u of %u nodes awake\n", 1e6 * fmax(-deepest, 0.0),
               highest - first, sword.report.active, sword.report.nodes);
    }
    close_sword(&sword);
}

/* Asleep: nothing moves and the force stays. Then the sword sinks away, and the cloth falls after it. */
static void it_sleeps_until_the_sword_moves(void)
{
    struct sword sword;
    dpt_force_info before = { .size = sizeof before }, after = { .size = sizeof after };
    if (open_sword(&sword, &fall)) {
        for (int i = 0; i < 12000; i++) {
            tick(&sword, 0);
            if (sword.report.active == 0)
                break;
        }
        CHECK(sword.report.active == 0, "%u nodes are awake", sword.report.active);
        tick(&sword, 0);
        dpt_tool_get_force_info(sword.rig.world, sword.rig.tool, &before);
        const double held = energy_of(&sword);
        for (int i = 0; i < 100; i++)
            tick(&sword, 0);
        dpt_tool_get_force_info(sword.rig.world, sword.rig.tool, &after);
        CHECK(energy_of(&sword) == held && sword.report.active == 0, "it moves");
        CHECK(before.wrench.force[2] < -1e-3, "%g N: it is not felt", before.wrench.force[2]);
        for (int k = 0; k < 3; k++)
            CHECK(fabs(after.wrench.force[k] - before.wrench.force[k]) < 1e-9, "%g N, %g N before",
                  after.wrench.force[k], before.wrench.force[k]);
        const double low = lowest_of(&sword);
        for (int i = 0; i < 100; i++) {
            sword.pose.position[2] -= 1e-3;
            tick(&sword, 0);
        }
        CHECK(sword.report.active == sword.report.nodes, "only %u wake", sword.report.active);
        CHECK(lowest_of(&sword) < low - 0.03, "it has fallen by %g m", low - lowest_of(&sword));
    }
    close_sword(&sword);
}

/*
 * A sheet on a grate that leans by a: it stays if friction exceeds tan a, else it slides by g (sin a - mu cos a). The
 * grate is so close that the sheet does not hang between its rods.
 */
static void friction_holds_a_sheet_that_leans(void)
{
    const double lean = 0.3, friction[] = { 0.4, 0.1, 0.0 };
    for (size_t i = 0; i < sizeof friction / sizeof *friction; i++) {
        const struct setup setup = { .shape = "membrane",
                                     .integrator = DPT_INTEGRATOR_IMPLICIT,
                                     .triangles = 512,
                                     .rods = RODS_MAX,
                                     .low = 0.0,
                                     .friction = friction[i],
                                     .lean = lean };
        struct sword sword;
        const double pull = fmax(sin(lean) - friction[i] * cos(lean), 0.0);
        if (open_sword(&sword, &setup)) {
            for (int k = 0; k < 200; k++)
                tick(&sword, 0);
            const double way = -middle_of(&sword), expected = 0.5 * GRAVITY * pull * 0.04;
            printf("    friction %.1f: %.2f mm, expected %.2f\n", friction[i], 1e3 * way, 1e3 * expected);
            CHECK(fabs(way - expected) < 0.03 * expected + 1e-3, "friction %g: %g m, not %g", friction[i], way,
                  expected);
        }
        close_sword(&sword);
    }
}

/* A step that cannot be taken moves nothing, though the rod has moved vertices. */
static void a_refused_step_moves_nothing(void)
{
    struct setup explicit = fall;
    struct sword sword;
    explicit.integrator = DPT_INTEGRATOR_SYMPLECTIC;
    if (open_sword(&sword, &explicit)) {
        for (int i = 0; i < 200; i++)
            tick(&sword, 0);
        const size_t bytes = 3 * (size_t)sword.nodes * sizeof(float);
        float *before = malloc(bytes);
        rig_tick(&sword.rig);
        dpt_springs_get_nodes(sword.springs, sword.nodes, before, sword.speeds);
        const dpt_result result = dpt_body_step_springs(sword.rig.world, sword.rig.body, sword.springs, 0.5, NULL);
        dpt_springs_get_nodes(sword.springs, sword.nodes, sword.positions, sword.speeds);
        CHECK(result == DPT_E_UNSTABLE, "%s", dpt_result_name(result));
        CHECK(!memcmp(before, sword.positions, bytes), "nodes have moved");
        free(before);
    }
    close_sword(&sword);
}

int main(int argc, char **argv)
{
    if (argc > 1)
        seconds = atoi(argv[1]) / 10 > 0 ? atoi(argv[1]) / 10 : 1;
    TEST(a_cloth_falls_on_a_sword);
    TEST(it_sleeps_until_the_sword_moves);
    TEST(friction_holds_a_sheet_that_leans);
    TEST(a_refused_step_moves_nothing);
    return check_report();
}
