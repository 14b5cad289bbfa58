/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The paper's micro-concavity (its Figure 4): a pin is pushed into a membrane, and the membrane out of the pin's way. If
 * only the nearest triangle is moved, others at the crater's rim stay in the pin; if all of the strip are, none does.
 * Judged right after the passes, before the membrane springs back, by brute force over its positions.
 *
 *     test_deform_displace [PER CENT]   of the ticks
 */
#include "oracle/brute.h"
#include "world/deform_scene.h"

#define PIN_RADIUS 0.005
#define SINKING    2e-4 /* m a tick */

struct pin {
    struct deform_scene scene;
    dpt_pose pose;
    const uint32_t *corners;
    uint32_t triangles;
};

static int open_pin(struct pin *pin, uint32_t response, uint32_t law, uint32_t cells, double lean)
{
    const dpt_segment segment = { { 0.0, 0.0, 0.0 }, { lean, 0.0, 0.08 }, PIN_RADIUS };
    dpt_world_def def = rig_def(law);
    dpt_deformable_def deform;
    dpt_deformable_def_init(&deform);
    memset(pin, 0, sizeof *pin);
    def.strip = DPT_STRIP_KIND_SHADOW;
    def.strip_width = PIN_RADIUS;
    def.strip_capacity = 4096;
    deform.response = response;
    if (!deform_scene_open(&pin->scene, "membrane", 2 * (uint64_t)cells * cells, &def, &deform))
        return 0;
    dpt_mesh_get_triangles(pin->scene.fixture.mesh, &pin->corners, NULL, &pin->triangles);
    rig_add_tool(&pin->scene.rig, &segment, 1);
    pin->pose = (dpt_pose){ { 0.0013, -0.0007, 0.006 }, { 1.0, 0.0, 0.0, 0.0 } };
    dpt_tool_teleport(pin->scene.rig.world, pin->scene.rig.tool, &pin->pose);
    rig_tick(&pin->scene.rig);
    return 1;
}

/* One tick: the pin sinks and wanders, and goes no deeper than 1 cm. */
static void sink(struct pin *pin, uint64_t tick)
{
    pin->pose.position[2] = fmax(pin->pose.position[2] - SINKING, -0.01);
    pin->pose.position[0] += 2e-5 * sin(0.05 * (double)tick);
    rig_step_to(&pin->scene.rig, &pin->pose);
}

static void read_positions(struct pin *pin)
{
    const float *positions;
    uint32_t count;
    dpt_body_get_vertices(pin->scene.rig.world, pin->scene.rig.body, &positions, &count);
    memcpy(pin->scene.positions, positions, 3 * sizeof *positions * (size_t)count);
}

/* How many triangles the pin penetrates by more than 1e-5 of the diagonal. */
static uint32_t penetrated(const struct pin *pin, double lean)
{
    const double *p = pin->pose.position;
    const double ends[6] = { p[0], p[1], p[2], p[0] + lean, p[1], p[2] + 0.08 };
    oracle_mesh *mesh = oracle_brute_open(pin->scene.positions, pin->scene.vertices, pin->corners, pin->triangles);
    uint32_t count = 0;
    for (uint32_t t = 0; t < pin->triangles; t++)
        count += oracle_brute_triangle(mesh, t, ends) < PIN_RADIUS - 1e-5 * pin->scene.diagonal;
    oracle_brute_close(mesh);
    return count;
}

/* What stands for physics: a part of the way back to where the membrane was at rest. */
static void spring_back(struct pin *pin)
{
    for (size_t i = 0; i < 3 * (size_t)pin->scene.vertices; i++)
        pin->scene.next[i] = pin->scene.positions[i] + 0.05f * (pin->scene.rest[i] - pin->scene.positions[i]);
    deform_scene_set(&pin->scene, DEFORM_WHOLE);
}

/* Move the nearest triangle alone out of the pin, as a method without a strip does. */
static void displace_nearest(struct pin *pin)
{
    dpt_overlap overlaps[4096], nearest = { .distance = HUGE_VAL };
    uint32_t count, flags;
    overlaps[0].size = sizeof *overlaps;
    dpt_tool_get_strip(pin->scene.rig.world, pin->scene.rig.tool, 0, overlaps, 4096, &count, &flags);
    for (uint32_t i = 0; i < count && i < 4096; i++)
        if (overlaps[i].distance < nearest.distance)
            nearest = overlaps[i];
    read_positions(pin);
    if (!count || !(nearest.overlap > 0.0))
        return;
    for (uint32_t t = 0; t < pin->triangles; t++) {
        const uint32_t *numbers;
        dpt_mesh_get_triangles(pin->scene.fixture.mesh, &pin->corners, &numbers, &count);
        if (numbers[t] != nearest.triangle)
            continue;
        for (uint32_t k = 0; k < 3; k++)
            pin->scene.positions[3 * pin->corners[3 * t + k] + 2] -= (float)nearest.overlap;
    }
    memcpy(pin->scene.next, pin->scene.positions, 3 * sizeof *pin->scene.next * (size_t)pin->scene.vertices);
    deform_scene_set(&pin->scene, DEFORM_WHOLE);
}

struct tally {
    uint64_t ticks, penetrating, triangles;
    double force;
};

static void push_pin(uint32_t response, uint32_t law, uint32_t cells, double lean, struct tally *tally)
{
    struct pin pin;
    if (!open_pin(&pin, response, law, cells, lean))
        return;
    for (uint64_t tick = 0; tick < part_of(150); tick++) {
        dpt_force_info force = { .size = sizeof force };
        sink(&pin, tick);
        dpt_tool_get_force_info(pin.scene.rig.world, pin.scene.rig.tool, &force);
        if (response == DPT_RESPONSE_DISPLACE)
            read_positions(&pin);
        else
            displace_nearest(&pin);
        const uint32_t count = penetrated(&pin, lean);
        tally->ticks++;
        tally->penetrating += count > 0;
        tally->triangles += count;
        tally->force = fmax(tally->force, force.wrench.force[2]);
        spring_back(&pin);
    }
    deform_scene_close(&pin.scene);
}

static void a_strip_leaves_none_in_the_pin(void)
{
    for (uint32_t law = DPT_LAW_POINT; law <= DPT_LAW_BED; law++)
        for (uint32_t cells = 20; cells <= 80; cells *= 2)
            for (int k = 0; k < 2; k++) {
                struct tally tally = { 0 };
                push_pin(DPT_RESPONSE_DISPLACE, law, cells, 0.03 * k, &tally);
                CHECK(tally.penetrating == 0, "law %u, %u cells, lean %d: %u triangles in %u of %u", law, cells, k,
                      (unsigned)tally.triangles, (unsigned)tally.penetrating, (unsigned)tally.ticks);
                CHECK(tally.force > 1e-3, "law %u: %g N", law, tally.force);
            }
}

/* The baseline is what the strip is there to mend: it must fail here, or the test shows nothing. */
static void a_single_triangle_leaves_some(void)
{
    struct tally tally = { 0 };
    push_pin(DPT_RESPONSE_LOAD, DPT_LAW_POINT, 40, 0.0, &tally);
    printf("    one triangle: %u triangles penetrate, in %u of %u ticks\n", (unsigned)tally.triangles,
           (unsigned)tally.penetrating, (unsigned)tally.ticks);
    CHECK(tally.penetrating > tally.ticks / 4, "%u of %u", (unsigned)tally.penetrating, (unsigned)tally.ticks);
}

int main(int argc, char **argv)
{
    take_percent(argc, argv);
    TEST(a_strip_leaves_none_in_the_pin);
    TEST(a_single_triangle_leaves_some);
    return check_report();
}
