/* SPDX-License-Identifier: BSD-3-Clause */
/* Two bodies: a slot between them that is hardly wider than the tool, and the seam where they touch. */
#include <math.h>

#include "base/vec3.h"
#include "lab/lab.h"
#include "lab/lab_lead.h"

static const double along_x[3] = { 1.0, 0.0, 0.0 }, along_y[3] = { 0.0, 1.0, 0.0 };
static const double leaning[3] = { 0.3, 0.2, 1.0 };

/* Blocks left and right of x = 0, `apart` from each other, their tops at z = 0. */
static int make_pair(struct lab *lab, struct lab_mesh pair[2], double apart)
{
    if (!lab_mesh_slab(lab, &pair[0], -0.15, -0.5 * apart, -0.06, 0.0, 0.1))
        return 0;
    if (lab_mesh_slab(lab, &pair[1], 0.5 * apart, 0.15, -0.06, 0.0, 0.1))
        return 1;
    lab_mesh_close(&pair[0]);
    return 0;
}

static void close_pair(struct lab_mesh pair[2])
{
    lab_mesh_close(&pair[0]);
    lab_mesh_close(&pair[1]);
}

/* Lead the tool to and fro in the slot, turning, with a tremor. */
static void sway(struct lab *lab, struct lab_lead *lead, double wide)
{
    const int ticks = 1000 * (int)lab_share(lab, 10);
    lab_lead_calm(lead);
    for (int i = 0; i <= ticks; i++) {
        const double t = 6.283185307179586 * i / 1000.0;
        const double lean = 2.0 * LAB_DEGREE * sin(0.7 * t);
        const double axis[3] = { lean, 1.0, 0.0 };
        const double tip[3] = { wide * sin(t), -0.05, -0.02 };
        lab_lead_aim(lead, tip, axis);
        lab_lead_shake(lead);
        lab_lead_tick(lead, i == 0);
    }
}

static void run_slot(struct lab *lab)
{
    static const double spaces[] = { 1e-5, 1e-4, 1e-3 };
    struct lab_tally sums[LAB_METHODS] = { { .ticks = 0 } };
    for (int i = 0; i < 3; i++) {
        struct lab_mesh pair[2];
        if (!make_pair(lab, pair, 2.0 * (LAB_RADIUS + spaces[i])))
            return;
        for (int method = 0; method < LAB_METHODS; method++) {
            const struct lab_lead_def def = { .method = method, .meshes = { pair[0].mesh, pair[1].mesh } };
            struct lab_lead lead;
            if (lab_lead_open(lab, &lead, &def)) {
                sway(lab, &lead, 0.0015);
                lab_tally_add(&sums[method], &lead.tally);
                sway(lab, &lead, 0.006);
                lab_tally_add(&sums[method], &lead.tally);
            }
            lab_lead_close(&lead);
        }
        close_pair(pair);
    }
    for (int method = 0; method < LAB_METHODS; method++)
        lab_tally_note(lab, method, &sums[method]);
}

const struct lab_case slot_case = {
    .name = "slot",
    .title = "In a slot between two bodies",
    .method = "A needle of 100 mm lies between two blocks that leave it 0.01, 0.1 and 1 mm on either "
              "side. It sways across the slot by 1.5 and 6 mm, turns by 2 degrees, and has a tremor of "
              "0.2 mm, so it meets one block, the other, or both with its two ends. The ball is this "
              "library's proxy of one point at the needle's end.",
    .advice = "Between bodies use the proxy. The laws without one sink into one block and may come out "
              "of its far side, or be pushed by both at once. A device that gives no torque cannot show "
              "a slot well: set lock_rotation, and expect to be held by one contact.",
    .run = run_slot
};

/* Lead a tool across the seam at 0.1 m/s with a tremor, over the pair and over one body at once. */
static double slide_over(struct lab_lead *lead, struct lab_lead *whole, const double *axis)
{
    const double depth = 0.001;
    const int down = 60, ticks = 660;
    double off = 0.0, largest = 0.0;
    struct lab_lead *const both[2] = { lead, whole };
    for (int i = 0; i <= ticks; i++)
        for (int k = 0; k < 2; k++) {
            const double share = fmin(1.0, (double)i / down);
            const double tip[3] = { i > down ? -0.03 + 1e-4 * (i - down) : -0.03, 0.003,
                                    LAB_RADIUS + 0.002 - (0.002 + depth) * share };
            if (i > down)
                lab_lead_shake(both[k]);
            else
                lab_lead_calm(both[k]);
            lab_lead_aim(both[k], tip, axis);
            lab_lead_tick(both[k], i == 0);
            double difference[3];
            for (int j = 0; j < 3; j++)
                difference[j] = lab_lead_force(lead)[j] - lab_lead_force(whole)[j];
            if (k)
                off = fmax(off, vec3_length(difference));
            largest = fmax(largest, vec3_length(lab_lead_force(whole)));
        }
    return off / largest;
}

static void run_over(struct lab *lab, int method, const struct lab_mesh pair[2], const struct lab_mesh *one)
{
    const double *const axes[3] = { along_x, along_y, leaning };
    const struct lab_lead_def of_pair = { .method = method, .meshes = { pair[0].mesh, pair[1].mesh } };
    const struct lab_lead_def of_one = { .method = method, .meshes = { one->mesh } };
    struct lab_tally sum = { .ticks = 0 };
    double off = 0.0;
    struct lab_lead lead, whole;
    const int has_lead = lab_lead_open(lab, &lead, &of_pair);
    if (lab_lead_open(lab, &whole, &of_one) && has_lead) {
        const int laps = (int)lab_share(lab, 10);
        for (int i = 0; i < 3 * laps; i++) {
            off = fmax(off, slide_over(&lead, &whole, axes[i % 3]));
            lab_tally_add(&sum, &lead.tally);
        }
        lab_at_most(lab, lab_method_name(method), "largest departure from the force of one body", 100.0 * off, "%",
                    1.0);
        lab_tally_note(lab, method, &sum);
    }
    lab_lead_close(&whole);
    lab_lead_close(&lead);
}

static void run_bodies(struct lab *lab)
{
    struct lab_mesh pair[2], one;
    if (!make_pair(lab, pair, 0.0))
        return;
    if (lab_mesh_slab(lab, &one, -0.15, 0.15, -0.06, 0.0, 0.1)) {
        for (int method = 0; method < LAB_METHODS; method++)
            run_over(lab, method, pair, &one);
        lab_mesh_close(&one);
    }
    close_pair(pair);
}

const struct lab_case bodies_case = {
    .name = "bodies",
    .title = "Over the seam between two bodies",
    .method = "A needle of 100 mm slides at 0.1 m/s with a tremor of 0.2 mm over two blocks that touch, "
              "their tops flush, pressed in by 1 mm: lying across the seam, lying along it, and on its "
              "tip. At the same time it slides over one block of the same size. The forces should be "
              "the same. The ball is this library's proxy of one point at the tip.",
    .advice =
        "What is one thing to the hand should be one mesh, if a law without a proxy is used: "
        "each body pushes for itself, so a bed feels up to twice the force along a seam, and inner walls count as surfaces "
        "there and take force away. The proxy never meets them.",
    .run = run_bodies
};

/* Relief: shallow dents under a tool, and ridges and notches where a local minimum vanishes. */

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

/* Press the tool in by 1 mm, and lead it along x at 0.05 m/s, with a tremor. */
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
        const struct lab_net net = { 120, 160, dented, &dents[i] };
        struct lab_mesh sheet;
        if (!lab_mesh_net(lab, &sheet, &net))
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
