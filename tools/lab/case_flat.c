/* SPDX-License-Identifier: BSD-3-Clause */
/* A tool on a plane: lying, rocking, tilted, in pieces. */
#include <math.h>

#include "lab/lab.h"
#include "lab/lab_lead.h"

/* A block with its top at z = 0, wide enough for every tool here. */
static int make_block(struct lab *lab, struct lab_mesh *mesh)
{
    return lab_mesh_slab(lab, mesh, -0.15, 0.15, -0.06, 0.0, 0.1);
}

/* The tip of a tool whose middle is at x. */
static void aim_middle(struct lab_lead *lead, const double *x, const double *axis)
{
    double tip[3];
    for (int k = 0; k < 3; k++)
        tip[k] = x[k] - 0.5 * LAB_LENGTH * axis[k];
    lab_lead_aim(lead, tip, axis);
}

/* Lower the tool at 0.05 m/s, then hold it with a tremor. */
static void hold_with_tremor(struct lab *lab, struct lab_lead *lead, const double *x, const double *out,
                             const double *axis, double depth)
{
    const double down = 5e-5, from = LAB_RADIUS + 0.002, to = LAB_RADIUS - depth;
    const int ticks_down = (int)((from - to) / down) + 1;
    const int ticks = ticks_down + (int)lab_share(lab, 20000);
    lab_lead_calm(lead);
    for (int i = 0; i <= ticks; i++) {
        const double height = fmax(to, from - down * i);
        double middle[3];
        for (int k = 0; k < 3; k++)
            middle[k] = x[k] + height * out[k];
        if (i > ticks_down)
            lab_lead_shake(lead);
        aim_middle(lead, middle, axis);
        lab_lead_tick(lead, i == 0);
    }
}

static void run_parallel(struct lab *lab)
{
    const double along_x[3] = { 1.0, 0.0, 0.0 }, up[3] = { 0.0, 0.0, 1.0 };
    const double along_y[3] = { 0.0, 1.0, 0.0 }, slope[3] = { 0.6, 0.0, 0.8 };
    const double middle[3] = { 0.01, 0.005, 0.0 }, edge[3] = { 0.15, 0.005, 0.0 };
    struct lab_mesh block;
    if (!make_block(lab, &block))
        return;
    for (int method = 0; method < LAB_METHODS; method++) {
        const struct lab_lead_def def = { .method = method, .meshes = { block.mesh } };
        const char *name = lab_method_name(method);
        struct lab_tally sum = { .ticks = 0 };
        struct lab_lead lead;
        if (lab_lead_open(lab, &lead, &def)) {
            hold_with_tremor(lab, &lead, middle, up, along_x, 0.001);
            lab_tally_add(&sum, &lead.tally);
            hold_with_tremor(lab, &lead, middle, up, along_x, 2e-4);
            lab_tally_add(&sum, &lead.tally);
            hold_with_tremor(lab, &lead, edge, slope, along_y, 0.001);
            lab_tally_add(&sum, &lead.tally);
            hold_with_tremor(lab, &lead, edge, slope, along_y, 2e-4);
            lab_tally_add(&sum, &lead.tally);
            lab_tally_note(lab, method, &sum);
            lab_tally_note_convex(lab, method, &sum);
            lab_at_most(lab, name, "largest change of torque in a tick, of peak force x L / 2",
                        100.0 * sum.torque_jump / (0.5 * LAB_LENGTH * sum.largest), "%", 1.0);
        }
        lab_lead_close(&lead);
    }
    lab_mesh_close(&block);
}

const struct lab_case parallel_case = {
    .name = "parallel",
    .title = "Lying on a plane and along an edge",
    .method = "A needle of 100 mm lies on a block, and along the edge of a block, pressed in by 0.2 and "
              "1 mm, while a tremor of 0.2 mm shakes it. The tremor does not turn it, so the torque "
              "about its middle should stay near zero. The ball is this library's proxy of one point at "
              "the needle's end; it has no torque at all.",
    .advice = "With the push at one point a lying tool buzzes: the deepest point jumps from end to end. "
              "Use the proxy, or the bed. If the device gives no torque, set lock_rotation.",
    .run = run_parallel
};

/* One lap of a swing by 1 degree, at 1 Hz. */
static void rock(struct lab_lead *lead, double depth, struct lab *lab, const char *series)
{
    const double period = 1000.0;
    const int ticks = 2000;
    double x[3] = { 0.01, 0.005, LAB_RADIUS + 0.002 };
    lab_lead_calm(lead);
    for (int i = 0; i <= 40; i++) {
        const double axis[3] = { 1.0, 0.0, 0.0 };
        x[2] = LAB_RADIUS + 0.002 - (0.002 + depth) * i / 40.0;
        aim_middle(lead, x, axis);
        lab_lead_tick(lead, i == 0);
    }
    lead->tally = (struct lab_tally){ .gap_min = HUGE_VAL };
    for (int i = 1; i <= ticks; i++) {
        const double angle = LAB_DEGREE * sin(6.283185307179586 * i / period);
        const double axis[3] = { cos(angle), 0.0, sin(angle) };
        aim_middle(lead, x, axis);
        lab_lead_step(lead);
        if (series && i > ticks - (int)period && i % 10 == 0)
            lab_point_at(lab, "stability-rocking", series, angle / LAB_DEGREE, lead->lead.force.wrench.torque[1]);
    }
}

static void run_rocking(struct lab *lab)
{
    struct lab_mesh block;
    if (!make_block(lab, &block))
        return;
    for (int method = 0; method < LAB_METHODS; method++) {
        const struct lab_lead_def def = { .method = method, .meshes = { block.mesh } };
        const char *name = lab_method_name(method);
        struct lab_tally sum = { .ticks = 0 };
        double worst = 0.0;
        struct lab_lead lead;
        if (lab_lead_open(lab, &lead, &def)) {
            static const double depths[] = { 0.0002, 0.0005, 0.001, 0.002 };
            for (int i = 0; i < 4; i++) {
                rock(&lead, depths[i], lab, i == 2 ? name : NULL);
                lab_tally_add(&sum, &lead.tally);
                if (lead.tally.largest_torque > 0.0)
                    worst = fmax(worst, lead.tally.torque_jump / lead.tally.largest_torque);
            }
            lab_at_most(lab, name, "largest change of torque in a tick, of its peak", 100.0 * worst, "%", 2.0);
            lab_tally_note_convex(lab, method, &sum);
            lab_tally_note(lab, method, &sum);
        }
        lab_lead_close(&lead);
    }
    lab_mesh_close(&block);
}

const struct lab_case rocking_case = {
    .name = "rocking",
    .title = "A lying tool rocks from end to end",
    .method = "A needle of 100 mm lies on a block, pressed in by 0.2, 0.5, 1 and 2 mm, and rocks about "
              "its middle by 1 degree to either side, once a second. A torque that follows the motion "
              "changes by 0.63 % of its peak in a tick. The chart shows the torque over the angle, at 1 "
              "mm. The ball is this library's proxy of one point at the needle's end; it feels no torque.",
    .advice = "A device with torque needs the proxy or the bed here: the push at one point throws the "
              "whole force from one end to the other when the tool is level.",
    .run = run_rocking
};

/* The stiffness of a tip at this tilt from the normal, by the formula, N/m. */
static double felt_by_formula(double tilt)
{
    const double lever = 0.5 * LAB_LENGTH * sin(tilt);
    const double turning = LAB_STIFFNESS * LAB_LENGTH * LAB_LENGTH / 12.0;
    return 1.0 / (1.0 / LAB_STIFFNESS + lever * lever / turning);
}

/* The measured stiffness of a tool that is pressed in a little: its force over its depth and the clearance, N/m. */
static double felt_at(struct lab_lead *lead, double tilt, double depth)
{
    const double axis[3] = { sin(tilt), 0.0, cos(tilt) };
    const double from = LAB_RADIUS + 2e-4, to = LAB_RADIUS - depth;
    double tip[3] = { -0.05, 0.005, from };
    lab_lead_calm(lead);
    lab_lead_aim(lead, tip, axis);
    lab_lead_start(lead);
    for (int i = 1; i <= 80; i++) {
        tip[2] = i < 40 ? from + (to - from) * i / 40.0 : to;
        lab_lead_aim(lead, tip, axis);
        lab_lead_step(lead);
    }
    return lab_lead_force(lead)[2] / (depth + (lab_has_proxy(lead->method) ? lead->slack : 0.0));
}

static void run_tilt(struct lab *lab)
{
    const double depth = 1e-4;
    struct lab_mesh block;
    if (!make_block(lab, &block))
        return;
    for (int degrees = 0; degrees <= 85; degrees += 5)
        lab_point_at(lab, "stability-tilt", "formula", degrees, felt_by_formula(degrees * LAB_DEGREE));
    for (int method = 0; method < LAB_METHODS; method++) {
        const struct lab_lead_def def = { .method = method, .meshes = { block.mesh } };
        const char *name = lab_method_name(method);
        double off = 0.0, upright = 0.0, felt = 0.0;
        struct lab_lead lead;
        if (lab_lead_open(lab, &lead, &def)) {
            for (int degrees = 0; degrees <= 90; degrees += 5) {
                const double tilt = degrees * LAB_DEGREE;
                felt = felt_at(&lead, tilt, depth);
                upright = degrees ? upright : felt;
                const double due = method == LAB_PROXY && degrees < 90 ? felt_by_formula(tilt) : LAB_STIFFNESS;
                off = fmax(off, fabs(felt / due - 1.0));
                lab_point_at(lab, "stability-tilt", name, degrees, felt);
            }
            lab_note(lab, name, "stiffness felt by an upright tip", upright, "N/m");
            lab_note(lab, name, "stiffness felt lying on the plane", felt, "N/m");
            if (method == LAB_PROXY)
                lab_at_most(lab, name, "largest departure from 1 / (1 / K + c^2 / K_r)", 100.0 * off, "%", 1.0);
            else
                lab_note(lab, name, "largest departure from K", 100.0 * off, "%");
        }
        lab_lead_close(&lead);
    }
    lab_mesh_close(&block);
}

const struct lab_case tilt_case = {
    .name = "tilt",
    .title = "Felt stiffness against tilt",
    .method = "A needle of 100 mm is pressed with its tip 0.1 mm into a plane, from upright (0 degrees) "
              "to lying (90), its orientation held. The force is divided by the depth. For the proxy it "
              "should be 1 / (1 / K + c^2 / K_r), c the lever of the contact about the middle, and K "
              "when both ends touch. The ball is this library's proxy of one point at the tip.",
    .advice = "If a tilted tip feels too soft, raise rotational_stiffness, or set lock_rotation where "
              "the device gives no torque: then it is K at every tilt. With the bed the stiffness of a "
              "lying tool is several times that of a tip; choose K for the stiffest of them.",
    .run = run_tilt
};

static void run_segments(struct lab *lab)
{
    static const uint32_t pieces[] = { 1, 2, 4, 8 };
    static const double tilts[] = { 90.0, 60.0, 0.0 };
    struct lab_mesh block;
    if (!make_block(lab, &block))
        return;
    for (int method = 0; method < LAB_BALL; method++) {
        const char *name = lab_method_name(method);
        double off = 0.0;
        for (int t = 0; t < 3; t++) {
            double one = 0.0;
            for (int i = 0; i < 4; i++) {
                const struct lab_lead_def def = {
                    .method = method, .meshes = { block.mesh }, .length = 0.08, .pieces = pieces[i]
                };
                struct lab_lead lead;
                if (lab_lead_open(lab, &lead, &def)) {
                    const double felt = felt_at(&lead, tilts[t] * LAB_DEGREE, 5e-4);
                    one = i ? one : felt;
                    off = fmax(off, fabs(felt / one - 1.0));
                    if (t == 0)
                        lab_point_at(lab, "stability-segments", name, pieces[i], felt / one);
                }
                lab_lead_close(&lead);
            }
        }
        lab_at_most(lab, name, "largest departure from the same tool in one piece", 100.0 * off, "%", 1.0);
    }
    lab_mesh_close(&block);
}

const struct lab_case segments_case = {
    .name = "segments",
    .title = "The same tool in 1, 2, 4 and 8 segments",
    .method = "A needle of 80 mm is built of 1, 2, 4 and 8 equal segments in line, and pressed 0.5 mm "
              "into a plane: lying, at 60 degrees, and upright. The stiffness felt should not depend on "
              "the number of segments. The chart has the lying tool. A ball has no segments.",
    .advice = "With the proxy and the bed a tool may have as many segments as its shape needs. The push "
              "at one point adds up over segments: divide its stiffness by their number.",
    .run = run_segments
};
