/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A sheet whose vertices move pushes tools, and they push it. The sheet is a height over a plane at all times, so which
 * side a point is on needs no library: the height of the triangle under it. Tools stay away from the sheet's border.
 *
 *     test_deform_push [PER CENT]   of the ticks
 */
#include "world/deform_scene.h"

enum { CELLS = 40 }; /* of the membrane, on each side */
#define SIDE 0.2

static const double tool_radius[] = { 0.003, 0.0 };

/* A membrane of waves: the amplitude in m, and by how much the phase grows in a tick. */
struct sheet {
    struct deform_scene scene;
    double amplitude, turn, time;
    dpt_pose device;
    double goal[3];
    uint64_t random;
};

static double wave(const struct sheet *sheet, double x, double y)
{
    return sheet->amplitude *
           (sin(40.0 * x + 0.7 * sheet->time) * cos(30.0 * y) + 0.5 * cos(3.0 * sheet->time + 20.0 * y));
}

static void move_sheet(struct sheet *sheet)
{
    struct deform_scene *scene = &sheet->scene;
    sheet->time += sheet->turn;
    for (uint32_t v = 0; v < scene->vertices; v++) {
        const float *rest = scene->rest + 3 * (size_t)v;
        float *next = scene->next + 3 * (size_t)v;
        next[0] = rest[0];
        next[1] = rest[1];
        next[2] = (float)wave(sheet, (double)rest[0], (double)rest[1]);
    }
    deform_scene_set(scene, DEFORM_WHOLE);
}

/* The height of the sheet's triangle over or under a place; the membrane's cells are cut along one diagonal each. */
static double height_at(const struct sheet *sheet, double x, double y)
{
    const struct deform_scene *scene = &sheet->scene;
    for (uint32_t number = 0; number < 2 * CELLS * CELLS; number++) {
        double c[9];
        if (!deform_scene_triangle(scene, number, c))
            continue;
        const double area = (c[3] - c[0]) * (c[7] - c[1]) - (c[6] - c[0]) * (c[4] - c[1]);
        const double v = ((x - c[0]) * (c[7] - c[1]) - (c[6] - c[0]) * (y - c[1])) / area;
        const double w = ((c[3] - c[0]) * (y - c[1]) - (x - c[0]) * (c[4] - c[1])) / area;
        if (v >= -1e-12 && w >= -1e-12 && v + w <= 1.0 + 1e-12)
            return c[2] + v * (c[5] - c[2]) + w * (c[8] - c[2]);
    }
    CHECK(0, "no triangle at %g %g", x, y);
    return 0.0;
}

static int open_sheet(struct sheet *sheet, double speed, const dpt_world_def *def, const dpt_segment *segment)
{
    memset(sheet, 0, sizeof *sheet);
    if (!deform_scene_open(&sheet->scene, "membrane", 2 * CELLS * CELLS, def, NULL))
        return 0;
    sheet->amplitude = 0.02;
    sheet->turn = speed / (2.2 * sheet->amplitude);
    sheet->random = 5;
    sheet->device = (dpt_pose){ { 0.0, 0.0, 0.045 }, { 1.0, 0.0, 0.0, 0.0 } };
    rig_add_tool(&sheet->scene.rig, segment, 1);
    return 1;
}

/* The device goes to and fro over the sheet and through it, at `speed` m a tick. */
static void move_device(struct sheet *sheet, uint64_t tick, double speed)
{
    double away[3], size = 0.0;
    if (tick % 150 == 0) {
        sheet->goal[0] = random_in(&sheet->random, -0.035, 0.035);
        sheet->goal[1] = random_in(&sheet->random, -0.035, 0.035);
        sheet->goal[2] = random_in(&sheet->random, -0.05, 0.035);
    }
    for (int k = 0; k < 3; k++) {
        away[k] = sheet->goal[k] - sheet->device.position[k];
        size += away[k] * away[k];
    }
    size = sqrt(size);
    for (int k = 0; k < 3 && size > speed; k++)
        sheet->device.position[k] += speed / size * away[k];
    dpt_tool_set_pose(sheet->scene.rig.world, sheet->scene.rig.tool, &sheet->device);
}

static void set_on_top(struct sheet *sheet)
{
    sheet->device.position[2] = 0.045;
    dpt_tool_teleport(sheet->scene.rig.world, sheet->scene.rig.tool, &sheet->device);
    rig_tick(&sheet->scene.rig);
}

/* Ball, upright and lying. */
static const dpt_segment tools[] = {
    { { 0.0, 0.0, 0.0 }, { 0.0, 0.0, 0.0 }, 0.003 },
    { { 0.0, 0.0, 0.0 }, { 0.0, 0.0, 0.1 }, 0.002 },
    { { -0.04, 0.0, 0.0 }, { 0.04, 0.0, 0.0 }, 0.002 },
};
enum { TOOLS = sizeof tools / sizeof *tools };

struct tally {
    uint64_t held, squeezed, passed, folds;
};

/* A proxy that has begun above the sheet stays above it. */
static void push_proxy(int tool, double speed, uint64_t ticks, struct tally *tally)
{
    struct sheet sheet;
    if (!open_sheet(&sheet, speed, NULL, &tools[tool]))
        return;
    set_on_top(&sheet);
    for (uint64_t tick = 0; tick < ticks; tick++) {
        dpt_force_info force = { .size = sizeof force };
        dpt_pose proxy;
        move_sheet(&sheet);
        move_device(&sheet, tick, 2e-4);
        rig_tick(&sheet.scene.rig);
        dpt_tool_get_force_info(sheet.scene.rig.world, sheet.scene.rig.tool, &force);
        dpt_tool_get_proxy(sheet.scene.rig.world, sheet.scene.rig.tool, &proxy);
        tally->held += force.reason == DPT_FORCE_ACTS;
        tally->folds += (force.flags & DPT_FORCE_FLAG_FOLD) != 0;
        const int has_begun_again = (force.flags & (DPT_FORCE_FLAG_SQUEEZED | DPT_FORCE_FLAG_REPLACED)) != 0;
        tally->squeezed += (force.flags & DPT_FORCE_FLAG_SQUEEZED) != 0;
        if (has_begun_again || force.reason == DPT_FORCE_INSIDE) {
            set_on_top(&sheet);
            continue;
        }
        const double above = proxy.position[2] - height_at(&sheet, proxy.position[0], proxy.position[1]);
        CHECK(above >= tools[tool].radius * (1.0 - 1e-9), "tool %d, %g m a tick, %u: %g above", tool, speed,
              (unsigned)tick, above);
        if (above < 0.0) {
            tally->passed++;
            set_on_top(&sheet);
        }
    }
    deform_scene_close(&sheet.scene);
}

static void check_tally(const struct tally *tally, double speed, double squeezed_max)
{
    printf("    %g mm a tick: %u held, %u folds, %u squeezed, %u passed\n", 1e3 * speed, (unsigned)tally->held,
           (unsigned)tally->folds, (unsigned)tally->squeezed, (unsigned)tally->passed);
    CHECK(tally->held > least_seen(1000), "it was hardly touched");
    CHECK((double)tally->squeezed <= squeezed_max * (double)tally->held, "%u squeezed", (unsigned)tally->squeezed);
}

static void no_proxy_passes_a_slow_sheet(void)
{
    struct tally tally = { 0 };
    for (int tool = 0; tool < TOOLS; tool++)
        push_proxy(tool, 1e-3, part_of(4000), &tally);
    check_tally(&tally, 1e-3, 1e-5);
}

static void no_proxy_passes_a_fast_sheet(void)
{
    struct tally tally = { 0 };
    for (int tool = 0; tool < TOOLS; tool++)
        push_proxy(tool, 1e-2, part_of(1500), &tally);
    check_tally(&tally, 1e-2, 1e-3);
}

/* Where an end is, in tick after tick, tells that the sheet has passed it: the sweep must have seen that. */
static void count_passages(double radius, double speed, double reach, uint64_t ticks)
{
    struct sheet sheet;
    dpt_world_def def = rig_def(DPT_LAW_PROXY);
    const dpt_segment segment = { { -0.01, 0.0, 0.0 }, { 0.02, 0.01, 0.0 }, radius };
    uint64_t passed = 0;
    int last[2] = { 1, 1 };
    def.until = DPT_UNTIL_CONTACT;
    if (!open_sheet(&sheet, speed, &def, &segment))
        return;
    for (uint64_t tick = 0; tick < ticks; tick++) {
        dpt_sweep sweep = { .size = sizeof sweep };
        move_sheet(&sheet);
        move_device(&sheet, tick, 5e-4);
        sheet.device.position[2] = random_in(&sheet.random, -reach, reach);
        rig_step_to(&sheet.scene.rig, &sheet.device);
        dpt_tool_get_sweep(sheet.scene.rig.world, sheet.scene.rig.tool, 0, &sweep);
        int has_passed = 0, is_free = sweep.status == DPT_SWEEP_FREE;
        for (int e = 0; e < 2; e++) {
            const double *end = e ? segment.b : segment.a;
            const double x = sheet.device.position[0] + end[0];
            const double y = sheet.device.position[1] + end[1];
            const int now = sheet.device.position[2] > height_at(&sheet, x, y);
            has_passed |= tick > 0 && now != last[e];
            last[e] = now;
        }
        passed += (uint64_t)has_passed;
        CHECK(!(has_passed && is_free), "%g m a tick, %u: not seen", speed, (unsigned)tick);
    }
    printf("    %g mm a tick: %u passages\n", 1e3 * speed, (unsigned)passed);
    CHECK(passed > least_seen(200), "%u passages", (unsigned)passed);
    deform_scene_close(&sheet.scene);
}

static void no_passage_is_missed(void)
{
    for (int r = 0; r < 2; r++) {
        count_passages(tool_radius[r], 1e-3, 0.01, part_of(6000));
        count_passages(tool_radius[r], 1e-2, 0.01, part_of(6000));
        count_passages(tool_radius[r], 2e-2, 1e-4, part_of(6000));
    }
}

int main(int argc, char **argv)
{
    take_percent(argc, argv);
    TEST(no_proxy_passes_a_slow_sheet);
    TEST(no_proxy_passes_a_fast_sheet);
    TEST(no_passage_is_missed);
    return check_report();
}
