/* SPDX-License-Identifier: BSD-3-Clause */
/* Thin walls and open sheets: what goes through, at a border, and behind a sheet. */
#include <math.h>

#include "lab/lab_lead.h"
#include "lab/lab_mesh.h"

static const double upright[3] = { 0.0, 0.0, 1.0 }, lying[3] = { 1.0, 0.0, 0.0 };

/* A wall of 120 x 120 mm with its upper side at z = 0; of no thickness: the sheet of 200 mm of `dynpoint make`. */
static int make_wall(struct lab *lab, struct lab_mesh *mesh, double thickness)
{
    return thickness > 0.0 ? lab_mesh_slab(lab, mesh, -0.06, 0.06, -thickness, 0.0, 0.06)
                           : lab_mesh_shape(lab, mesh, "membrane", 512);
}

/* From 20 mm above to 15 mm beyond the far side at a speed, and held there: 1 if nothing pushes it back. */
static int goes_through(struct lab_lead *lead, double thickness, double speed, double lean)
{
    const double down = speed * LEAD_DT, to = -thickness - 0.015, from = 0.02;
    const int ticks = (int)((from - to) / down) + 1;
    uint64_t *seed = &lead->lead.seed;
    const double axis[3] = { sin(lean), 0.0, cos(lean) };
    double tip[3] = { uniform(seed, -0.055, -0.045), uniform(seed, -0.01, 0.01), from };
    lab_lead_calm(lead);
    lab_lead_aim(lead, tip, axis);
    lab_lead_start(lead);
    /* Where the first tick begins is random: the wall must not lie at a tick. */
    tip[2] -= uniform(seed, 0.0, 1.0) * fmin(down, 0.01);
    for (int i = 0; i < ticks + 50; i++) {
        lab_lead_aim(lead, tip, axis);
        lab_lead_step(lead);
        tip[2] = fmax(to, tip[2] - down);
    }
    return !(lab_lead_force(lead)[2] > SMALL_FORCE);
}

static const double speeds[] = { 0.05, 0.2, 1.0, 5.0 };
static const double leans[] = { 0.0, 0.7, 1.5707963267948966 };

static void cross(struct lab *lab, double thickness, const char *what)
{
    struct lab_mesh wall;
    if (!make_wall(lab, &wall, thickness))
        return;
    for (int method = 0; method < LAB_METHODS; method++) {
        const struct lab_lead_def def = { .method = method, .meshes = { wall.mesh } };
        struct lab_lead lead;
        if (lab_lead_open(lab, &lead, &def)) {
            const uint64_t tries = lab_share(lab, 20);
            uint64_t through = 0, all = 0;
            for (uint64_t i = 0; i < 12 * tries; i++, all++)
                through += (uint64_t)goes_through(&lead, thickness, speeds[i % 4], leans[i % 3]);
            lab_at_most(lab, lab_method_name(method), what, lab_per_cent(through, all), "%", 0.0);
        }
        lab_lead_close(&lead);
    }
    lab_mesh_close(&wall);
}

/* The most that it is pushed back with, N, until that collapses or the depth ends. */
static double pop_force(struct lab_lead *lead, const double *axis, double x, double depth_max)
{
    const double down = 5e-5;
    const int ticks = (int)((depth_max + 0.001) / down) + 1;
    double most = 0.0;
    int is_through = 0;
    lab_lead_calm(lead);
    for (int i = 0; i < ticks && !is_through; i++) {
        const double tip[3] = { x, 0.003, LAB_RADIUS + 0.001 - down * i };
        lab_lead_aim(lead, tip, axis);
        lab_lead_tick(lead, i == 0);
        const double force = lab_lead_force(lead)[2];
        most = fmax(most, force);
        is_through = force < 0.5 * most && most > SMALL_FORCE;
    }
    return most;
}

static void push_quasi_statically(struct lab *lab)
{
    static const double thicknesses[] = { 0.0, 0.0002, 0.0005, 0.001, 0.002, 0.005, 0.01, 0.02 };
    double least[LAB_METHODS] = { HUGE_VAL, HUGE_VAL, HUGE_VAL, HUGE_VAL }, free_tip = HUGE_VAL;
    double locked_tip = HUGE_VAL;
    const double tilted[3] = { 0.1, 0.0, 1.0 };
    for (int i = 0; i < 8; i++) {
        struct lab_mesh wall;
        if (!make_wall(lab, &wall, thicknesses[i]))
            return;
        for (int method = 0; method < LAB_METHODS; method++) {
            const struct lab_lead_def def = { .method = method, .meshes = { wall.mesh } };
            struct lab_lead lead;
            if (lab_lead_open(lab, &lead, &def)) {
                const double force = pop_force(&lead, lying, -0.05, 0.101);
                lab_point_at(lab, "stability-thinsheet", lab_method_name(method), 1e3 * thicknesses[i], force);
                least[method] = fmin(least[method], force);
                if (method == LAB_PROXY)
                    free_tip = fmin(free_tip, pop_force(&lead, tilted, 0.0, 0.101));
            }
            lab_lead_close(&lead);
        }
        const struct lab_lead_def def = { .method = LAB_PROXY, .meshes = { wall.mesh }, .lock_rotation = 1 };
        struct lab_lead lead;
        if (lab_lead_open(lab, &lead, &def))
            locked_tip = fmin(locked_tip, pop_force(&lead, tilted, 0.0, 0.101));
        lab_lead_close(&lead);
        lab_mesh_close(&wall);
    }
    for (int method = 0; method < LAB_METHODS; method++)
        lab_at_least(lab, lab_method_name(method), "least force that a lying tool goes through with, up to 50 N",
                     least[method], "N", 50.0);
    lab_note(lab, "proxy", "force at which a tip 6 degrees off upright tips over, through it", free_tip, "N");
    lab_at_least(lab, "proxy", "the same with lock_rotation, up to 50 N", locked_tip, "N", 50.0);
}

static void run_thinsheet(struct lab *lab)
{
    cross(lab, 0.0, "tools that go through an open sheet");
    cross(lab, 0.0002, "tools that go through a wall of 0.2 mm");
    cross(lab, 0.001, "tools that go through a wall of 1 mm");
    cross(lab, 0.005, "tools that go through a wall of 5 mm");
    push_quasi_statically(lab);
}

const struct lab_case thinsheet_case = {
    .name = "thinsheet",
    .title = "Thin walls and open sheets",
    .method = "A needle of 100 mm crosses an open sheet and walls of 0.2, 1 and 5 mm, upright, leaning "
              "and lying, at 0.05, 0.2, 1 and 5 m/s, to 15 mm behind the far side. It went through if "
              "nothing pushes it back there. Then a lying needle is pushed slowly down until its force "
              "collapses, at most to 50 N, which is 100 mm at 500 N/m. The chart shows that force over "
              "the thickness, 0 for the sheet. The ball is this library's proxy of one point at the tip.",
    .advice = "Use the proxy for everything thinner than some centimetres. It goes through nothing it "
              "meets, but a long tool that is pushed down on its tip by more than a sixth of its length "
              "tips over, as a pencil would. Once the device is turned by 1 rad from it, it starts "
              "again at the device, which is behind the wall then. Set lock_rotation or a greater "
              "rotational_stiffness where users press that hard.",
    .run = run_thinsheet
};

/* To and fro across the border x = 0.1 of the sheet, pressed in. */
static void cross_border(struct lab *lab, struct lab_lead *lead, const double *axis, double x, double depth)
{
    const double step = 1e-4, swing = 0.03;
    const int down = 80, lap = 1200;
    const int ticks = down + lap * (int)lab_share(lab, 10);
    lab_lead_calm(lead);
    for (int i = 0; i <= ticks; i++) {
        const int phase = i < down ? 0 : (i - down) % lap;
        const double along = step * (phase < lap / 2 ? phase : lap - phase);
        const double share = fmin(1.0, (double)i / down);
        const double tip[3] = { x + fmin(along, 2.0 * swing), 0.003, LAB_RADIUS + 0.002 - (0.002 + depth) * share };
        if (i >= down)
            lab_lead_shake(lead);
        lab_lead_aim(lead, tip, axis);
        lab_lead_tick(lead, i == 0);
    }
}

static void run_border(struct lab *lab)
{
    static const double depths[] = { 0.001, 0.003, 0.01 };
    const double across[3] = { -1.0, 0.0, 0.0 }, along[3] = { 0.0, 1.0, 0.0 };
    const double leaning[3] = { 0.3, 0.2, 1.0 };
    struct lab_mesh sheet;
    if (!lab_mesh_shape(lab, &sheet, "membrane", 512))
        return;
    for (int method = 0; method < LAB_METHODS; method++) {
        const struct lab_lead_def def = { .method = method, .meshes = { sheet.mesh } };
        struct lab_tally sum = { .ticks = 0 };
        struct lab_lead lead;
        if (lab_lead_open(lab, &lead, &def)) {
            for (int i = 0; i < 3; i++) {
                cross_border(lab, &lead, across, 0.08, depths[i]);
                lab_tally_add(&sum, &lead.tally);
                cross_border(lab, &lead, along, 0.08, depths[i]);
                lab_tally_add(&sum, &lead.tally);
                cross_border(lab, &lead, leaning, 0.08, depths[i]);
                lab_tally_add(&sum, &lead.tally);
            }
            lab_tally_note(lab, method, &sum);
            lab_note(lab, lab_method_name(method), "largest loss of force in a tick", sum.drop, "N");
            lab_note(lab, lab_method_name(method), "ticks without a force, as contact is unknown",
                     lab_per_cent(sum.unknown, sum.ticks), "%");
        }
        lab_lead_close(&lead);
    }
    lab_mesh_close(&sheet);
}

const struct lab_case border_case = {
    .name = "border",
    .title = "Over the border of an open sheet",
    .method = "A needle of 100 mm is pressed 1, 3 and 10 mm into an open sheet and led over its border "
              "to and fro at 0.1 m/s with a tremor of 0.2 mm: lying across the border, lying along it, "
              "and on its tip. Past the border the force has to end, and on the way back the tool may "
              "be under the sheet. The ball is this library's proxy of one point at the tip.",
    .advice = "Open sheets are best closed: give a membrane its thickness. Where that cannot be, use "
              "the proxy. The laws without one must guess the side at the border, and drop the force "
              "where they cannot.",
    .run = run_border
};

static void run_sidelimit(struct lab *lab)
{
    const double leaning[3] = { 0.3, 0.2, 1.0 };
    const double *const axes[3] = { upright, lying, leaning };
    struct lab_mesh sheet;
    if (!lab_mesh_shape(lab, &sheet, "membrane", 512))
        return;
    for (int method = 0; method < LAB_METHODS; method++) {
        const struct lab_lead_def def = { .method = method, .meshes = { sheet.mesh }, .side_limit = 0.005 };
        const char *name = lab_method_name(method);
        struct lab_tally sum = { .ticks = 0 };
        struct lab_lead lead;
        if (lab_lead_open(lab, &lead, &def)) {
            for (int i = 0; i < 3; i++) {
                pop_force(&lead, axes[i], -0.05, 0.01);
                lab_tally_add(&sum, &lead.tally);
            }
            lab_at_most(lab, name, "largest loss of force in a tick", sum.drop, "N", 0.01);
            lab_tally_note(lab, method, &sum);
        }
        lab_lead_close(&lead);
    }
    lab_mesh_close(&sheet);
}

const struct lab_case sidelimit_case = {
    .name = "sidelimit",
    .title = "Behind an open sheet, beyond its side limit",
    .method = "A needle is pushed slowly down on an open sheet whose side_limit is 5 mm, to 10 mm: "
              "upright, lying and leaning. The force should grow all the way, so no tick should lose "
              "more than 0.01 N. The ball is this library's proxy of one point at the tip.",
    .advice = "With the push at one point and the bed, choose side_limit greater than any depth that "
              "users reach: beyond it the side is forgotten and the force fades within two ticks. The "
              "proxy does not use side_limit.",
    .run = run_sidelimit
};
