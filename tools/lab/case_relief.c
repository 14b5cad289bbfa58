/* SPDX-License-Identifier: BSD-3-Clause */
/* Relief: shallow dents under a tool, and ridges and notches where a local minimum vanishes. */
#include <math.h>

#include "lab/lab_lead.h"
#include "lab/lab_mesh.h"

static const double along_x[3] = { 1.0, 0.0, 0.0 }, along_y[3] = { 0.0, 1.0, 0.0 };
static const double leaning[3] = { 0.3, 0.2, 1.0 };

/* A sheet of 80 x 60 mm with dents 4 mm apart, whose depth is the context. */
static void dented(const void *context, double u, double v, double x[3])
{
    const double depth = *(const double *)context, pitch = 0.004;
    x[0] = 0.08 * (v - 0.5);
    x[1] = 0.06 * (u - 0.5);
    const double a = sin(3.141592653589793 * x[0] / pitch);
    const double b = sin(3.141592653589793 * x[1] / pitch);
    x[2] = -depth * a * a * b * b;
}

struct slide_report {
    struct lab_tally sum;
    uint64_t inward; /* ticks whose force points through the surface */
};

/* Pressed in by 1 mm, along x at 0.05 m/s, with a tremor. */
static void slide(struct lab *lab, struct lab_lead *lead, const double *axis, struct slide_report *report)
{
    const int down = 60, ticks = down + (int)lab_share(lab, 700);
    const double y = axis[1] > 0.5 ? -0.015 : 0.0013;
    lab_lead_calm(lead);
    for (int i = 0; i <= ticks; i++) {
        const double share = fmin(1.0, (double)i / down);
        const double tip[3] = { i > down ? -0.032 + 5e-5 * (i - down) : -0.032, y, LAB_RADIUS + 0.002 - 0.003 * share };
        if (i > down)
            lab_lead_shake(lead);
        lab_lead_aim(lead, tip, axis);
        lab_lead_tick(lead, i == 0);
        report->inward += lab_lead_force(lead)[2] < -SMALL_FORCE;
    }
    lab_tally_add(&report->sum, &lead->tally);
}

static void run_microconcave(struct lab *lab)
{
    static const double dents[] = { 1e-4, 3e-4, 1e-3 };
    struct slide_report reports[LAB_METHODS] = { { .inward = 0 } };
    for (int i = 0; i < 3; i++) {
        struct lab_mesh sheet;
        if (!lab_mesh_net(lab, &sheet, 120, 160, dented, &dents[i]))
            return;
        for (int method = 0; method < LAB_METHODS; method++) {
            const struct lab_lead_def def = { .method = method, .meshes = { sheet.mesh }, .length = 0.03 };
            struct lab_lead lead;
            if (lab_lead_open(lab, &lead, &def)) {
                slide(lab, &lead, along_x, &reports[method]);
                slide(lab, &lead, along_y, &reports[method]);
                slide(lab, &lead, leaning, &reports[method]);
            }
            lab_lead_close(&lead);
        }
        lab_mesh_close(&sheet);
    }
    for (int method = 0; method < LAB_METHODS; method++) {
        const struct slide_report *report = &reports[method];
        const char *name = lab_method_name(method);
        lab_at_most(lab, name, "ticks whose force points through the surface", (double)report->inward, "", 0.0);
        lab_note(lab, name, "mean turn of the force in a tick",
                 report->sum.turning / LAB_DEGREE / fmax(1.0, (double)report->sum.acting), "deg");
        lab_tally_note(lab, method, &report->sum);
    }
}

const struct lab_case microconcave_case = {
    .name = "microconcave",
    .title = "Over shallow dents",
    .method = "A needle of 30 mm slides at 0.05 m/s with a tremor of 0.2 mm over a sheet with dents 4 "
              "mm apart that are 0.1, 0.3 and 1 mm deep, pressed in by 1 mm: lying along and across its "
              "way, and on its tip. Its radius of 2 mm does not fit into the deeper dents, so it stands "
              "on their rims. The ball is this library's proxy of one point at the tip.",
    .advice = "A relief finer than the tool's radius is felt as the rims that carry the tool. If a "
              "scanned surface feels rough where it should be smooth, smooth the mesh, or give the tool "
              "its true radius; a tool of radius 0 falls into every dent.",
    .run = run_microconcave
};

/* A triangle wave of height 1: 0 at 0, up first, of period 1. */
static double zigzag(double phase)
{
    const double at = phase - floor(phase);
    return at < 0.25 ? 4.0 * at : at < 0.75 ? 2.0 - 4.0 * at : 4.0 * at - 4.0;
}

/* From above down to a height at x = `wide` zigzag(phase), then to and fro along x at 0.1 m/s, with a tremor. */
static void go_to_and_fro(struct lab *lab, struct lab_lead *lead, const double *axis, double height, double wide,
                          double phase)
{
    const double top = 0.01, step = 1e-4;
    const int down = (int)((top - height) / step), lap = (int)(4.0 * wide / step);
    const int ticks = down + lap * (int)lab_share(lab, 10);
    const double y = axis[1] > 0.5 ? -0.05 : 0.003;
    lab_lead_calm(lead);
    for (int i = 0; i <= ticks; i++) {
        const double along = i > down ? (double)(i - down) / lap : 0.0;
        const double tip[3] = { wide * zigzag(phase + along), y, fmax(height, top - step * i) };
        if (i > down)
            lab_lead_shake(lead);
        lab_lead_aim(lead, tip, axis);
        lab_lead_tick(lead, i == 0);
    }
}

/* A ridge with its edge at z = 0, and a block with a notch of 30 mm. */
static int make_relief(struct lab *lab, int is_notch, struct lab_mesh *mesh)
{
    static const double ridge[][2] = { { -0.02, -0.06 }, { 0.02, -0.06 }, { 0.0, 0.0 } };
    static const double notch[][2] = { { -0.026, -0.12 }, { 0.026, -0.12 }, { 0.026, 0.0 }, { 0.017, 0.0 },
                                       { 0.0, -0.03 },    { -0.017, 0.0 },  { -0.026, 0.0 } };
    return is_notch ? lab_mesh_prism(lab, mesh, notch, 7, 0.1) : lab_mesh_prism(lab, mesh, ridge, 3, 0.1);
}

static void run_folds(struct lab *lab)
{
    static const double heights[] = { -0.001, -0.005, -0.015 };
    struct lab_tally sums[LAB_METHODS] = { { .ticks = 0 } };
    for (int i = 0; i < 2; i++) {
        /* Beside the ridge at first; in the notch. */
        const double wide = i ? 0.024 : 0.035, phase = i ? 0.0 : 0.75;
        struct lab_mesh mesh;
        if (!make_relief(lab, i, &mesh))
            return;
        for (int method = 0; method < LAB_METHODS; method++) {
            const struct lab_lead_def def = { .method = method, .meshes = { mesh.mesh } };
            struct lab_lead lead;
            if (lab_lead_open(lab, &lead, &def))
                for (int k = 0; k < 3; k++) {
                    go_to_and_fro(lab, &lead, along_y, heights[k], wide, phase);
                    lab_tally_add(&sums[method], &lead.tally);
                    go_to_and_fro(lab, &lead, leaning, heights[k], wide, phase);
                    lab_tally_add(&sums[method], &lead.tally);
                }
            lab_lead_close(&lead);
        }
        lab_mesh_close(&mesh);
    }
    for (int method = 0; method < LAB_METHODS; method++) {
        if (lab_has_proxy(method))
            lab_at_least(lab, lab_method_name(method), "folds", (double)sums[method].folds, "", 1.0);
        lab_tally_note(lab, method, &sums[method]);
    }
}

const struct lab_case folds_case = {
    .name = "folds",
    .title = "Where the place that holds the tool vanishes",
    .method = "A needle of 100 mm is led at 0.1 m/s with a tremor of 0.2 mm through a sharp ridge and a "
              "notched block, 1, 5 and 15 mm below their tops, lying along the edge and on its tip. Its "
              "proxy stays on one flank until it can slip over the edge; then the nearest place that it "
              "could reach has vanished, and it folds to another. Folds there must be, and the force "
              "may not jump in them. The ball is this library's proxy of one point at the tip.",
    .advice = "A fold changes the force by as much as the shape asks for, but over several ticks: at "
              "most K (3 |motion| + 1 mm) in each. If that is too fast for a device, lower K, or press "
              "less deep: up to a fifth of the tool's radius there are no folds on convex bodies.",
    .run = run_folds
};
