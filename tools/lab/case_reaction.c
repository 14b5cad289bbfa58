/* SPDX-License-Identifier: BSD-3-Clause */
/* What a tool does to tissue is what the tissue does to the tool, in each tick of a loop. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/vec3.h"
#include "lab/hand_loop.h"
#include "lab/lab.h"

enum { LAWS = 3, SPEEDS = 2, MODES = 2, TOOLS = 2, TICKS = 1500, TURN = 250, LOADS = 8192 };

#define STIFFNESS 500.0
#define DEPTH     5e-3
#define SLIDE     0.03  /* m: across the surface */
#define LEAP      1.3   /* rad: a turn that no proxy follows, so that the force fades */
#define ARM       0.06  /* m: moments are of the peak force at the tool's length */
#define EXACT     1e-12 /* of the peak */

static const int laws[LAWS] = { LAB_PROXY, LAB_BED, LAB_POINT };
static const uint32_t speeds[SPEEDS] = { 4, 33 };
static const struct hand_tool tools[TOOLS] = { { ARM, 0.004, 0.0 }, { ARM, 0.004, 0.6 } };

/* Of all ticks of a law, in N and Nm; fading ones apart. */
struct tally {
    double peak;
    double force, moment;
    double fading_force, fading_moment;
    uint64_t fading, failed;
};

/* What loads and wrench sum up to, about the tool's origin. */
static void weigh(const struct hand_loop *loop, dpt_load *loads, struct tally *tally)
{
    dpt_force_info report = { .size = sizeof report };
    const float *positions;
    uint32_t count, vertices;
    dpt_pose pose;
    double force[3], moment[3];
    dpt_tool_get_force_info(loop->stage.world, loop->stage.tool, &report);
    dpt_tool_get_pose(loop->stage.world, loop->stage.tool, &pose);
    dpt_body_get_vertices(loop->stage.world, loop->body, &positions, &vertices);
    if (dpt_body_get_loads(loop->stage.world, loop->body, loads, LOADS, &count) != DPT_OK)
        tally->failed++;
    memcpy(force, report.wrench.force, sizeof force);
    memcpy(moment, report.wrench.torque, sizeof moment);
    tally->peak = fmax(tally->peak, vec3_length(force));
    for (uint32_t i = 0; i < count; i++) {
        double arm[3], part[3];
        for (int k = 0; k < 3; k++)
            arm[k] = (double)positions[3 * (size_t)loads[i].vertex + (size_t)k] - pose.position[k];
        vec3_cross(arm, loads[i].force, part);
        for (int k = 0; k < 3; k++) {
            force[k] += loads[i].force[k];
            moment[k] += part[k];
        }
    }
    const int is_fading = (report.flags & DPT_FORCE_FLAG_FADING) != 0;
    double *max = is_fading ? &tally->fading_force : &tally->force;
    *max = hand_max(*max, vec3_length(force));
    max = is_fading ? &tally->fading_moment : &tally->moment;
    *max = hand_max(*max, vec3_length(moment));
    tally->fading += (uint64_t)is_fading;
}

/* Friction, a damper on the tool, and a surface with a stiffness of its own. */
static void make_rough(struct hand_loop *loop)
{
    dpt_body_settings settings = { .size = sizeof settings };
    dpt_body_get_settings(loop->stage.world, loop->body, &settings);
    settings.static_friction = settings.kinetic_friction = 0.6;
    settings.stiffness = 800.0;
    dpt_body_set_settings(loop->stage.world, loop->body, &settings);
}

/* The tool is pressed in, slides and rocks; then it leaps by 1.3 rad, goes out of the tissue, and comes again. */
static void lead(struct hand_loop *loop, dpt_load *loads, struct tally *tally)
{
    for (int i = 0; i < TICKS; i++) {
        double at[HAND_AXES] = { 0.0 }, wrench[HAND_AXES];
        const double part = (double)(i % TURN) / TURN, depth = fmin(8.0 * part, 1.0);
        at[0] = SLIDE * part;
        at[2] = 0.3 * at[0];
        at[1] = 2.0 * DEPTH - 3.0 * DEPTH * depth;
        at[5] = 0.1 * part;
        if (part > 0.88)
            at[5] += LEAP;
        if (part > 0.92)
            at[1] = ARM;
        hand_loop_ask(loop, at, TISSUE_TICK, wrench);
        weigh(loop, loads, tally);
    }
}

static void try_law(const struct hand_mesh *mesh, int law, uint64_t which, dpt_load *loads, struct tally *tally)
{
    struct hand_place place = { .mesh = mesh };
    struct tissue tissue = { .mesh = mesh->mesh,
                             .matter = tissue_soft,
                             .ticks = speeds[which % SPEEDS],
                             .is_interpolated = which / SPEEDS % MODES == 0,
                             .load_radius = 0.048 };
    struct hand_loop loop = { .device = { .dofs = HAND_AXES },
                              .place = &place,
                              .tissue = &tissue,
                              .tool = tools[which / SPEEDS / MODES],
                              .method = law,
                              .stiffness = STIFFNESS,
                              .damping = 0.3 };
    hand_place_top(mesh, &place);
    if (hand_loop_open(&loop) && hand_loop_lower(&loop, 0.2 * STIFFNESS * DEPTH)) {
        make_rough(&loop);
        lead(&loop, loads, tally);
    } else {
        tally->failed++;
    }
    hand_loop_close(&loop);
}

static void note_law(struct lab *lab, int law, const struct tally *tally)
{
    const char *word = lab_method_name(law);
    lab_at_most(lab, word, "largest |sum of loads + force|, of the peak force", tally->force / tally->peak, "", EXACT);
    lab_at_most(lab, word, "largest |sum of moments|, of the peak force at 60 mm", tally->moment / (tally->peak * ARM),
                "", EXACT);
    lab_note(lab, word, "ticks whose force fades", (double)tally->fading, "");
    if (tally->fading) {
        lab_at_most(lab, word, "while the force fades: |sum of loads + force|", tally->fading_force / tally->peak, "",
                    EXACT);
        lab_at_most(lab, word, "while the force fades: |sum of moments|", tally->fading_moment / (tally->peak * ARM),
                    "", EXACT);
    }
    lab_at_most(lab, word, "ticks or loops that failed", (double)tally->failed, "", 0.0);
}

static void run(struct lab *lab)
{
    struct hand_mesh liver = { .mesh = NULL };
    const uint64_t loops = lab_share(lab, SPEEDS * MODES * TOOLS);
    dpt_load *loads = malloc(LOADS * sizeof *loads);
    if (loads && hand_mesh_open(&liver, "liver", 1200, 1.0)) {
        for (int i = 0; i < LAWS; i++) {
            struct tally tally = { 0 };
            for (uint64_t which = 0; which < loops; which++)
                try_law(&liver, laws[i], which, loads, &tally);
            note_law(lab, laws[i], &tally);
        }
    } else {
        lab->is_out_of_memory = 1;
    }
    hand_mesh_close(&liver);
    free(loads);
}

const struct lab_case reaction_case = {
    .name = "reaction",
    .title = "Loads and wrench sum up to zero",
    .method = "A tool, tilted or lying, is pressed into an organ that gives way (the case tissue), slides by "
              "30 mm and rocks, with friction of 0.6, a damper of 0.3 Ns/m and a surface of 800 N/m, at "
              "physics of 30 and 250 Hz, in steps and interpolated. Six times it leaps by 1.3 rad, which no "
              "proxy follows: it starts again there, and its force fades. In each tick the loads of "
              "dpt_body_get_loads and the wrench of dpt_tool_get_force_info are summed up, and their "
              "moments about the tool's origin.",
    .advice = "Take the loads right after the step whose wrench the hand gets, and scale them if a guard sends less.",
    .run = run
};
