/* SPDX-License-Identifier: BSD-3-Clause */
/* Is tissue as stiff on a finer mesh, and with a faster physics? */
#include <math.h>

#include "base/sincos.h"
#include "lab/hand_loop.h"
#include "lab/lab.h"

enum { BODIES = 2, TOOLS = 3, DENSITIES = 2, SPEEDS = 5, MODES = 2, RESTING = 128 };

#define STIFFNESS 500.0 /* N/m: of the coupling, beside which tissue is soft */
#define DEPTH     5e-3  /* m: of the device below where it touches */
#define SWING     2e-3  /* m and Hz: of a device that goes up and down about there */
#define RATE      2.0
#define EDGES     3.0 /* of the coarser mesh, that a load is spread over */
#define CHANGE    0.05
#define SIDE      0.2 /* m: of the membrane, and what makes its cells uneven */
#define WARP      0.026

/* Ticks of the loop for a step of physics; and the place in the list of half as many, before its own, or none. */
static const struct {
    uint32_t ticks;
    int twice;
} speeds[SPEEDS] = { { 4, -1 }, { 2, 0 }, { 32, -1 }, { 16, 2 }, { 1, 1 } };

/* Of 250 Hz and more: what swings is judged. */
#define SWINGING 4u

/* Each has halved edges in the second mesh. Figures are of a change that is allowed, but for those of bare corners. */
static const struct trial_body {
    const char *shape;
    uint64_t triangles[DENSITIES];
    double edge; /* m: the coarser mesh's mean */
    const char *by_mesh[TOOLS], *by_time[TOOLS], *felt[TOOLS], *bare[TOOLS];
    const char *ripple, *swing_by_mesh, *swing_by_time, *phase_by_mesh, *phase_by_time;
} bodies[BODIES] = {
    { "membrane",
      { 648, 2592 },
      0.0114,
      { "membrane, ball: stiffness, change by edges halved", "membrane, upright: stiffness, change by edges halved",
        "membrane, lying: stiffness, change by edges halved" },
      { "membrane, ball: stiffness, change by dt halved", "membrane, upright: stiffness, change by dt halved",
        "membrane, lying: stiffness, change by dt halved" },
      { "membrane, ball: stiffness felt", "membrane, upright: stiffness felt", "membrane, lying: stiffness felt" },
      { "membrane, ball: change by edges halved, loads on corners alone",
        "membrane, upright: change by edges halved, loads on corners alone",
        "membrane, lying: change by edges halved, loads on corners alone" },
      "membrane: largest share by which the force sways at rest",
      "membrane: force at 2 Hz, change by edges halved",
      "membrane: force at 2 Hz, change by dt halved",
      "membrane: phase at 2 Hz, change by edges halved",
      "membrane: phase at 2 Hz, change by dt halved" },
    { "liver",
      { 1200, 4800 },
      0.0137,
      { "organ, ball: stiffness, change by edges halved", "organ, upright: stiffness, change by edges halved",
        "organ, lying: stiffness, change by edges halved" },
      { "organ, ball: stiffness, change by dt halved", "organ, upright: stiffness, change by dt halved",
        "organ, lying: stiffness, change by dt halved" },
      { "organ, ball: stiffness felt", "organ, upright: stiffness felt", "organ, lying: stiffness felt" },
      { "organ, ball: change by edges halved, loads on corners alone",
        "organ, upright: change by edges halved, loads on corners alone",
        "organ, lying: change by edges halved, loads on corners alone" },
      "organ: largest share by which the force sways at rest",
      "organ: force at 2 Hz, change by edges halved",
      "organ: force at 2 Hz, change by dt halved",
      "organ: phase at 2 Hz, change by edges halved",
      "organ: phase at 2 Hz, change by dt halved" }
};

static const struct hand_tool tools[TOOLS] = { { 0.0, 0.008, 0.0 },
                                               { 0.06, 0.004, 1.5707963267948966 },
                                               { 0.06, 0.004, 0.0 } };

/* What a tool felt: N/m after a second, a share of that by which it went up and down, and N/m and rad of a swing. */
struct response {
    double felt, ripple, swing, phase;
};

/* The second of two periods. Of the force only the motion's frequency counts. */
static void swing(struct hand_loop *loop, struct response *response)
{
    double at[HAND_AXES] = { 0.0 }, wrench[HAND_AXES], sums[2] = { 0.0, 0.0 };
    const int period = (int)(1.0 / (RATE * TISSUE_TICK) + 0.5);
    for (int i = 0; i < 2 * period; i++) {
        double sine, cosine;
        turn_sincos((double)i / period, &sine, &cosine);
        at[1] = -SWING * sine;
        hand_loop_ask(loop, at, TISSUE_TICK, wrench);
        if (i >= period) {
            sums[0] += 2.0 * wrench[1] * sine / period;
            sums[1] += 2.0 * wrench[1] * cosine / period;
        }
    }
    response->swing = sqrt(sums[0] * sums[0] + sums[1] * sums[1]) / SWING;
    response->phase = atan2(sums[1], sums[0]);
}

/* The mean force of some ticks, and how far it goes from there: a tool that lies on tissue is not still. */
static double rest(struct hand_loop *loop, double *ripple)
{
    const double zero[HAND_AXES] = { 0.0 };
    double wrench[HAND_AXES], sum = 0.0, low = HUGE_VAL, high = -HUGE_VAL;
    for (int i = 0; i < RESTING; i++) {
        hand_loop_ask(loop, zero, TISSUE_TICK, wrench);
        sum += wrench[1] / RESTING;
        low = fmin(low, wrench[1]);
        high = fmax(high, wrench[1]);
    }
    *ripple = fmax(high - sum, sum - low) / sum;
    return sum;
}

static struct response respond(struct tissue tissue, const struct hand_mesh *mesh, const struct hand_place *place,
                               const struct hand_tool *tool)
{
    struct response response = { NAN, NAN, NAN, NAN };
    struct hand_loop loop = { .device = { .dofs = HAND_AXES },
                              .place = place,
                              .tissue = &tissue,
                              .tool = *tool,
                              .method = LAB_PROXY,
                              .stiffness = STIFFNESS };
    tissue.mesh = mesh->mesh;
    tissue.matter = tissue_soft;
    if (hand_loop_open(&loop) && hand_loop_lower(&loop, STIFFNESS * DEPTH)) {
        response.felt = rest(&loop, &response.ripple) / DEPTH;
        if (tissue.ticks <= SWINGING)
            swing(&loop, &response);
        if (tissue.has_failed)
            response.felt = NAN;
    }
    hand_loop_close(&loop);
    return response;
}

/* The largest changes of responses, as shares and in rad. NaN if there was no response. */
struct change {
    double felt, swing, phase;
    double ripple; /* the largest of the second response */
};

static void compare(const struct response *a, const struct response *b, struct change *change)
{
    change->felt = hand_max(change->felt, fabs(a->felt / b->felt - 1.0));
    change->ripple = hand_max(change->ripple, b->ripple);
    if (isnan(a->swing) || isnan(b->swing))
        return;
    change->swing = fmax(change->swing, fabs(a->swing / b->swing - 1.0));
    change->phase = fmax(change->phase, fabs(a->phase - b->phase));
}

/* What a tool feels on both meshes, at all speeds that are due. */
static void try_tool(struct lab *lab, const struct hand_mesh *meshes, const struct hand_place *place,
                     const struct trial_body *body, int tool, struct change *by_mesh, struct change *by_time)
{
    const uint64_t due = lab->effort < 0.5 ? 2 : SPEEDS, modes = lab_share(lab, MODES);
    by_mesh->felt = by_time->felt = 0.0;
    for (uint64_t mode = 0; mode < modes; mode++) {
        struct response seen[SPEEDS][DENSITIES];
        for (uint64_t s = 0; s < due; s++) {
            const struct tissue as = { .ticks = speeds[s].ticks,
                                       .is_interpolated = mode == 0,
                                       .load_radius = EDGES * body->edge };
            const int densities = speeds[s].ticks > 1 ? DENSITIES : 1;
            for (int d = 0; d < densities; d++) {
                seen[s][d] = respond(as, &meshes[d], place, &tools[tool]);
                if (speeds[s].twice >= 0)
                    compare(&seen[speeds[s].twice][d], &seen[s][d], by_time);
            }
            if (densities > 1)
                compare(&seen[s][0], &seen[s][1], by_mesh);
        }
        if (mode == 0)
            lab_note(lab, "proxy", body->felt[tool], seen[1][1].felt, "N/m");
    }
    lab_at_most(lab, "proxy", body->by_mesh[tool], by_mesh->felt, "", CHANGE);
    lab_at_most(lab, "proxy", body->by_time[tool], by_time->felt, "", CHANGE);
}

/* Loads on the corners alone are no stiffness that a mesh could agree on: that is told, and not judged. */
static void try_corners(struct lab *lab, const struct hand_mesh *meshes, const struct hand_place *place,
                        const struct trial_body *body, int tool)
{
    const struct tissue as = { .ticks = speeds[0].ticks };
    struct change change = { 0.0, 0.0, 0.0, 0.0 };
    struct response seen[DENSITIES];
    for (int d = 0; d < DENSITIES; d++)
        seen[d] = respond(as, &meshes[d], place, &tools[tool]);
    compare(&seen[0], &seen[1], &change);
    lab_note(lab, "proxy", body->bare[tool], change.felt, "");
}

static void try_body(struct lab *lab, const struct trial_body *body)
{
    struct hand_mesh meshes[DENSITIES] = { { .mesh = NULL }, { .mesh = NULL } };
    struct change by_mesh = { 0.0, 0.0, 0.0, 0.0 }, by_time = by_mesh;
    struct hand_place place;
    const int due = (int)lab_share(lab, TOOLS);
    if (hand_mesh_open(&meshes[0], body->shape, body->triangles[0], 1.0) &&
        hand_mesh_open(&meshes[1], body->shape, body->triangles[1], 1.0)) {
        hand_place_top(&meshes[0], &place);
        for (int tool = 0; tool < due; tool++) {
            try_tool(lab, meshes, &place, body, tool, &by_mesh, &by_time);
            try_corners(lab, meshes, &place, body, tool);
        }
        lab_at_most(lab, "proxy", body->swing_by_mesh, by_mesh.swing, "", CHANGE);
        lab_at_most(lab, "proxy", body->swing_by_time, by_time.swing, "", CHANGE);
        lab_at_most(lab, "proxy", body->phase_by_mesh, by_mesh.phase, "rad", CHANGE);
        lab_at_most(lab, "proxy", body->phase_by_time, by_time.phase, "rad", CHANGE);
        lab_note(lab, "proxy", body->ripple, by_mesh.ripple, "");
    } else {
        lab->is_out_of_memory = 1;
    }
    hand_mesh_close(&meshes[0]);
    hand_mesh_close(&meshes[1]);
}

/* Cells become a third as wide on one side of a place, and 1.7 times on the other; the border stays. */
static void make_uneven(double x[3])
{
    for (int k = 0; k < 2; k++) {
        double sine, cosine;
        turn_sincos(x[k] / SIDE, &sine, &cosine);
        x[k] += WARP * (1.0 + cosine);
    }
}

/* The finer membrane where its cells change their size, against the even one at the same place. */
static void try_uneven(struct lab *lab, const struct trial_body *body)
{
    const struct tissue as = { .ticks = speeds[0].ticks, .load_radius = EDGES * body->edge };
    struct hand_mesh meshes[DENSITIES] = { { .mesh = NULL }, { .mesh = NULL } };
    struct change change = { 0.0, 0.0, 0.0, 0.0 };
    struct hand_place place;
    if (hand_mesh_open(&meshes[0], body->shape, body->triangles[1], 1.0) &&
        hand_mesh_open(&meshes[1], body->shape, body->triangles[1], 1.0) && hand_mesh_warp(&meshes[1], make_uneven)) {
        struct response seen[DENSITIES];
        hand_place_top(&meshes[0], &place);
        place.at[0] += 2.0 * WARP;
        place.at[1] += 2.0 * WARP;
        for (int d = 0; d < DENSITIES; d++)
            seen[d] = respond(as, &meshes[d], &place, &tools[0]);
        compare(&seen[0], &seen[1], &change);
        lab_at_most(lab, "proxy", "membrane, ball: stiffness, change on uneven cells", change.felt, "", CHANGE);
    } else {
        lab->is_out_of_memory = 1;
    }
    hand_mesh_close(&meshes[0]);
    hand_mesh_close(&meshes[1]);
}

static void run(struct lab *lab)
{
    for (int i = 0; i < BODIES; i++)
        try_body(lab, &bodies[i]);
    try_uneven(lab, &bodies[0]);
}

const struct lab_case tissue_case = {
    .name = "tissue",
    .title = "Felt stiffness of tissue that gives way",
    .method = "A ball, an upright and a lying tool are lowered 5 mm below where they touch a membrane with a "
              "fixed border, and an organ, with a coupling of 500 N/m. A small physics of the laboratory "
              "moves their vertices: springs per area to their rest, tension, mass and damping, solved "
              "implicitly. Loads are spread over three edges of the coarser mesh. What is felt after a "
              "second, and the force at 2 Hz with physics of "
              "250 Hz and more, may change by at most 5 % (and its phase by 0.05 rad) when edges are halved, "
              "where cells become uneven, and when the physics' dt is halved: from 31 to 63 Hz, from 250 to "
              "500 Hz and to 1 kHz, stepped and interpolated.",
    .advice =
        "Give dpt_deformable_def a load_radius of three edges or more. With 0 a finer mesh is softer: a "
        "point load has no stiffness of its own. With slow physics the force of a tool that lies goes "
        "up and down by some per cent even at rest: few points hold it in each step, and not the same ones in the next.",
    .run = run
};
