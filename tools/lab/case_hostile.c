/* SPDX-License-Identifier: BSD-3-Clause */
/* Meshes and poses that break arithmetic: slivers, faces on faces, and lengths from 0.1 mm to 3 km. */
#include <math.h>
#include <stdlib.h>

#include "base/vec3.h"
#include "lab/lab.h"
#include "lab/lab_lead.h"

static const double along_x[3] = { 1.0, 0.0, 0.0 }, along_y[3] = { 0.0, 1.0, 0.0 };
static const double leaning[3] = { 0.3, 0.2, 1.0 };

/* A plane of 0.2 x 0.2 m whose columns get narrower towards x = 0, to less than 1 nm; and in z a zigzag of 1 nm. */
static void slivered(const void *context, double u, double v, double x[3])
{
    const int columns = *(const int *)context, column = (int)(columns * v + 0.5);
    const int from_middle = column - columns / 2;
    double size = 0.1;
    for (int i = abs(from_middle); i < columns / 2; i++)
        size *= 0.9;
    x[0] = from_middle < 0 ? -size : from_middle > 0 ? size : 0.0;
    x[1] = 0.2 * (u - 0.5);
    x[2] = column % 2 ? 1e-9 : 0.0;
}

/* The most that the force is off the plane's normal, rad. */
static double slide_over(struct lab *lab, struct lab_lead *lead, const double *axis)
{
    const int down = 60, ticks = down + (int)lab_share(lab, 4000);
    double off = 0.0;
    lab_lead_calm(lead);
    for (int i = 0; i <= ticks; i++) {
        const double share = fmin(1.0, (double)i / down), t = 6.283185307179586 * i / 2000.0;
        const double tip[3] = { 0.01 * sin(t) - (axis[0] > 0.5 ? 0.05 : 0.0), axis[1] > 0.5 ? -0.05 : 0.0,
                                LAB_RADIUS + 0.002 - 0.003 * share };
        if (i > down)
            lab_lead_shake(lead);
        lab_lead_aim(lead, tip, axis);
        lab_lead_tick(lead, i == 0);
        const double *force = lab_lead_force(lead);
        if (vec3_length(force) > SMALL_FORCE)
            off = fmax(off, acos(fmax(-1.0, fmin(1.0, force[2] / vec3_length(force)))));
    }
    return off;
}

static void run_slivers(struct lab *lab)
{
    const int columns = 360;
    const struct lab_net net = { 2, (uint32_t)columns, slivered, &columns };
    struct lab_mesh plane;
    if (!lab_mesh_net(lab, &plane, &net))
        return;
    for (int method = 0; method < LAB_METHODS; method++) {
        const struct lab_lead_def def = { .method = method, .meshes = { plane.mesh } };
        const double *const axes[3] = { along_x, along_y, leaning };
        const char *name = lab_method_name(method);
        struct lab_tally sum = { .ticks = 0 };
        double off = 0.0;
        struct lab_lead lead;
        if (lab_lead_open(lab, &lead, &def)) {
            for (int i = 0; i < 3; i++) {
                off = fmax(off, slide_over(lab, &lead, axes[i]));
                lab_tally_add(&sum, &lead.tally);
            }
            lab_at_most(lab, name, "ticks whose wrench is not finite", (double)sum.not_finite, "", 0.0);
            lab_at_most(lab, name, "the most that the force is off the normal of the plane", off / LAB_DEGREE, "deg",
                        1.0);
            lab_tally_note(lab, method, &sum);
        }
        lab_lead_close(&lead);
    }
    lab_mesh_close(&plane);
}

const struct lab_case slivers_case = {
    .name = "slivers",
    .title = "Over triangles of 100 mm x 1 nm",
    .method = "A plane is cut into strips of 100 mm length whose width falls from 10 mm to below 1 nm "
              "towards its middle, with a zigzag of 1 nm in height, so that the narrowest triangles "
              "stand upright. A needle of 100 mm slides to and fro over it, pressed in by 1 mm, with a "
              "tremor of 0.2 mm: lying along and across the strips, and on its tip. The force should be "
              "that of the plane. The ball is this library's proxy of one point at the tip.",
    .advice = "Meshes need no cleaning of slivers for this library. What a sliver does cost is time: a "
              "long thin box holds little and is asked often. If a loop is short of time, remesh.",
    .run = run_slivers
};

struct start {
    double x[3], out[3], axis[3];
};

/* On a face, an edge, a corner and along an edge, the tool on its tip and lying. */
static const struct start starts[] = { { { 0.01, 0.005, 0.0 }, { 0.0, 0.0, 1.0 }, { 0.0, 0.0, 1.0 } },
                                       { { 0.01, 0.005, 0.0 }, { 0.0, 0.0, 1.0 }, { 0.3, 0.2, 1.0 } },
                                       { { 0.01, 0.005, 0.0 }, { 0.0, 0.0, 1.0 }, { 1.0, 0.0, 0.0 } },
                                       { { 0.125, 0.0, 0.0 }, { 0.6, 0.0, 0.8 }, { 0.6, 0.0, 0.8 } },
                                       { { 0.125, -0.05, 0.0 }, { 0.6, 0.0, 0.8 }, { 0.0, 1.0, 0.0 } },
                                       { { 0.125, 0.125, 0.0 }, { 0.48, 0.6, 0.64 }, { 0.48, 0.6, 0.64 } } };
enum { STARTS = sizeof starts / sizeof *starts, AT_CORNER = STARTS - 1 };

/*
 * Down by 1 mm, then shaken. The first lead begins `lift` above the surface, the second 2 mm above it. The most that
 * their forces differ, of the peak.
 */
static double go_down(struct lab *lab, struct lab_lead *leads, const struct start *start, double lift)
{
    const int down = 100, ticks = down + (int)lab_share(lab, 1000);
    double off = 0.0, largest = 0.0;
    for (int i = -40; i <= ticks; i++) {
        double difference[3];
        for (int k = 0; k < 2; k++) {
            const double above = k ? -5e-5 * i : lift;
            const double height = i < 0 ? above : -0.001 * fmin(1.0, (double)i / down);
            double tip[3];
            for (int j = 0; j < 3; j++)
                tip[j] = start->x[j] + (LAB_RADIUS + height) * start->out[j];
            if (i > down)
                lab_lead_shake(&leads[k]);
            else
                lab_lead_calm(&leads[k]);
            lab_lead_aim(&leads[k], tip, start->axis);
            lab_lead_tick(&leads[k], i == -40);
        }
        for (int j = 0; j < 3; j++)
            difference[j] = lab_lead_force(&leads[0])[j] - lab_lead_force(&leads[1])[j];
        off = fmax(off, vec3_length(difference));
        largest = fmax(largest, vec3_length(lab_lead_force(&leads[1])));
    }
    return off / largest;
}

static void run_coincident_of(struct lab *lab, int method, const struct lab_mesh *block, const struct lab_mesh *twin)
{
    const struct lab_lead_def def = { .method = method, .meshes = { block->mesh, twin->mesh } };
    const struct lab_lead_def of_one = { .method = method, .meshes = { block->mesh } };
    const char *name = lab_method_name(method);
    struct lab_tally sum = { .ticks = 0 };
    uint64_t unfelt = 0;
    double off = 0.0, off_at_corner = 0.0;
    struct lab_lead leads[2];
    const int has_first = lab_lead_open(lab, &leads[0], &def);
    if (lab_lead_open(lab, &leads[1], &of_one) && has_first) {
        for (size_t i = 0; i < STARTS; i++) {
            go_down(lab, leads, &starts[i], 0.0);
            unfelt += !leads[0].tally.acting;
            double *most = i == AT_CORNER && method == LAB_PROXY ? &off_at_corner : &off;
            *most = fmax(*most, go_down(lab, leads, &starts[i], leads[0].slack));
            lab_tally_add(&sum, &leads[0].tally);
        }
        lab_at_most(lab, name, "largest departure from one body, begun in the open", 100.0 * off, "%", 1.0);
        lab_at_most(lab, name, "ticks whose wrench is not finite", (double)sum.not_finite, "", 0.0);
        lab_tally_note(lab, method, &sum);
        if (method == LAB_PROXY)
            lab_note(lab, name, "departure at the corner, off which it slips", 100.0 * off_at_corner, "%");
        lab_note(lab, name, "starts exactly on the surface, gap 0, that feel nothing", lab_per_cent(unfelt, STARTS),
                 "%");
    }
    lab_lead_close(&leads[1]);
    lab_lead_close(&leads[0]);
}

static void run_coincident(struct lab *lab)
{
    /* The block's outline, with more corners: the same faces cut into other triangles. */
    static const double split[][2] = { { -0.125, -0.0625 }, { 0.0, -0.0625 }, { 0.125, -0.0625 }, { 0.125, 0.0 },
                                       { 0.0625, 0.0 },     { 0.03125, 0.0 }, { -0.125, 0.0 } };
    struct lab_mesh block, twin;
    if (!lab_mesh_slab(lab, &block, -0.125, 0.125, -0.0625, 0.0, 0.125))
        return;
    if (lab_mesh_prism(lab, &twin, split, 7, 0.125)) {
        for (int method = 0; method < LAB_METHODS; method++)
            run_coincident_of(lab, method, &block, &twin);
        lab_mesh_close(&twin);
    }
    lab_mesh_close(&block);
}

const struct lab_case coincident_case = {
    .name = "coincident",
    .title = "Faces on faces, and a start exactly on the surface",
    .method = "Two bodies with the same faces, cut into other triangles, lie in each other. A needle is "
              "put down so that its surface touches theirs exactly: on a face, an edge and a corner, on "
              "its tip and lying. It is pressed in by 1 mm and shaken by a tremor of 0.2 mm. Beside it "
              "the same needle began 2 mm above one body alone. The forces should be the same. A proxy "
              "of a needle that stands on a corner slips off to one of three sides; there two bodies "
              "may lead it to another side than one. The ball is this library's proxy of one point at "
              "the tip.",
    .advice = "Duplicate bodies double the force of the bed. Start tools in the open. A proxy that "
              "begins with a gap below 0.75e-6 of the diagonal, some tenths of a micrometre, counts as "
              "inside: it feels nothing until it was lifted once.",
    .run = run_coincident
};

/* A needle over a block, everything `unit` times its usual size, pressed in by a tenth of its radius. */
static void slide_at_scale(struct lab *lab, struct lab_lead *lead, double unit, double *felt)
{
    const int down = 40, ticks = down + (int)lab_share(lab, 4000);
    const double depth = 2e-4;
    const double *const axes[2] = { along_x, leaning };
    struct lab_tally sum = { .ticks = 0 };
    *felt = 0.0;
    for (int axis = 0; axis < 2; axis++) {
        for (int i = 0; i <= ticks; i++) {
            const double t = 6.283185307179586 * i / 2000.0;
            const double share = fmin(1.0, (double)i / down);
            const double tip[3] = { unit * (-0.05 + 0.02 * sin(t)), unit * 0.02 * sin(3.0 * t),
                                    unit * (LAB_RADIUS + 2e-4 - (2e-4 + depth) * share) };
            lab_lead_aim(lead, tip, axes[axis]);
            lab_lead_tick(lead, i == 0);
            if (!axis && i > down + 5)
                *felt = fmax(*felt, fabs(lab_lead_force(lead)[2] / (LAB_STIFFNESS * unit * depth) - 1.0));
        }
        lab_tally_add(&sum, &lead->tally);
    }
    lead->tally = sum;
}

static void run_scale(struct lab *lab)
{
    static const struct {
        double unit, away;
        const char *departure, *gain, *gap;
    } sizes[] = { { 3e-4, 0.0, "0.1 mm: departure from K x depth", "0.1 mm: |dW| over K |motion|",
                    "0.1 mm: depth of the proxy in the body, of its diagonal" },
                  { 1.0, 1e5, "0.3 m, 100 km away: departure from K x depth",
                    "0.3 m, 100 km away: |dW| over K |motion|",
                    "0.3 m, 100 km away: depth of the proxy, of the diagonal" },
                  { 1e4, 0.0, "3 km: departure from K x depth", "3 km: |dW| over K |motion|",
                    "3 km: depth of the proxy in the body, of its diagonal" },
                  { 3e-4, 1e3, "0.1 mm, 1 km away: departure from K x depth", "0.1 mm, 1 km away: |dW| over K |motion|",
                    "0.1 mm, 1 km away: depth of the proxy, of the diagonal" } };
    uint64_t not_finite[LAB_METHODS] = { 0 };
    for (int i = 0; i < 4; i++) {
        const double unit = sizes[i].unit;
        const double middle[3] = { sizes[i].away, -0.7 * sizes[i].away, 0.3 * sizes[i].away };
        struct lab_mesh block;
        if (!lab_mesh_slab(lab, &block, -0.15 * unit, 0.15 * unit, -0.06 * unit, 0.0, 0.1 * unit))
            return;
        for (int method = 0; method < LAB_METHODS; method++) {
            const struct lab_lead_def def = { .method = method,
                                              .meshes = { block.mesh },
                                              .middle = middle,
                                              .length = unit * LAB_LENGTH,
                                              .radius = unit * LAB_RADIUS };
            const char *name = lab_method_name(method);
            double felt;
            struct lab_lead lead;
            if (lab_lead_open(lab, &lead, &def)) {
                slide_at_scale(lab, &lead, unit, &felt);
                if (method == LAB_BED)
                    lab_note(lab, name, sizes[i].departure, 100.0 * felt, "%");
                else
                    lab_at_most(lab, name, sizes[i].departure, 100.0 * felt, "%", 1.0);
                not_finite[method] += lead.tally.not_finite;
                if (lead.tally.shallow)
                    lab_at_most(lab, name, sizes[i].gain, lead.tally.gain, "", 1.25);
                if (lab_has_proxy(method))
                    lab_at_most(lab, name, sizes[i].gap, fmax(0.0, -lead.tally.gap_min / block.diagonal), "", 0.0);
            }
            lab_lead_close(&lead);
        }
        lab_mesh_close(&block);
    }
    for (int method = 0; method < LAB_METHODS; method++)
        lab_at_most(lab, lab_method_name(method), "ticks whose wrench is not finite", (double)not_finite[method], "",
                    0.0);
}

const struct lab_case scale_case = {
    .name = "scale",
    .title = "From 0.1 mm to 3 km, and 100 km away",
    .method = "A needle slides over a block, pressed in by a tenth of its radius, lying and on its tip. "
              "Block and needle are 0.1 mm, 0.3 m and 3 km large; some stand 1 and 100 km from the "
              "origin by their body's pose. Force, smoothness and gaps are compared with the size of "
              "the scene. The bed is stiffer than K for a lying tool, by design. The ball is this "
              "library's proxy of one point at the tip.",
    .advice = "Vertices are floats: keep a mesh near the origin of its own frame and put it into the "
              "world by its pose, which is in doubles. Choose metres; at other sizes margins, side "
              "limits and the speed of folds, 1 m/s, keep their metric values.",
    .run = run_scale
};
