/* SPDX-License-Identifier: BSD-3-Clause */
/* Laws on an organ, up to the limit of the law linearised at the pose. */
#include <math.h>

#include "dynpoint/coupling.h"
#include "lab/hand_sway.h"
#include "lab/lab.h"
#include "lab/lab_lead.h"

enum { PLACES = 3, TOOLS = 2, DEVICES = 4, LOOPS = PLACES * TOOLS * DEVICES };

#define PERIOD    1e-3
#define SECONDS   1.5
#define REFERENCE 200.0 /* N/m: at which the tool is lowered, 1 mm deep */

static const struct hand_tool tools[TOOLS] = { { 0.06, 0.002, 0.0 }, { 0.06, 0.002, 0.5 } };

static const struct device {
    double mass, damping, delay;
} devices[DEVICES] = { { 0.1, 0.5, 0 }, { 0.2, 2, 1 }, { 0.1, 0.5, 1 }, { 0.2, 2, 0 } };

struct tally {
    uint64_t loops, growing, growing_beyond, uneven;
};

/* Try the coupling at 0.97 of its limit along each direction, and beyond the limit along the stiffest. */
static void try_loop(struct hand_loop *loop, double limit, struct tally *tally)
{
    struct hand_law law;
    hand_law_find(loop, &law);
    const double felt = law.stiffness[0] / loop->stiffness;
    tally->loops++;
    tally->uneven += law.asymmetry > 1e-3 * law.stiffness[0];
    hand_hold(loop, &law, 1.1 * limit);
    hand_loop_stiffen(loop, 0.97 * limit / felt, 0.0, 0.0);
    int grows = 0;
    for (int n = 0; n < law.axes && !grows; n++) {
        struct hand_search search = hand_search_for_law(loop, &law, limit, SECONDS);
        for (int k = 0; k < HAND_AXES; k++)
            search.tap.direction[k] = law.direction[n][k];
        search.tap.stiffness = law.stiffness[n] / law.stiffness[0] * 0.97 * limit;
        grows = !hand_sway(loop, &search.tap).is_stable;
    }
    tally->growing += (uint64_t)grows;
    struct hand_search search = hand_search_for_law(loop, &law, limit, SECONDS);
    search.tap.stiffness = 1.1 * limit;
    hand_loop_stiffen(loop, 1.1 * limit / felt, 0.0, 0.0);
    tally->growing_beyond += !hand_sway(loop, &search.tap).is_stable;
}

static void run_method(struct lab *lab, const struct hand_mesh *liver, int method)
{
    struct tally tally = { 0 };
    const uint64_t loops = lab_share(lab, LOOPS);
    uint64_t seed = 5;
    for (uint64_t i = 0; i < loops; i++) {
        const struct device *device = &devices[i / TOOLS % DEVICES];
        struct hand_place place;
        struct hand_loop loop = { .tool = tools[i % TOOLS], .method = method, .stiffness = REFERENCE, .place = &place };
        const double rho = hand_loop_rho(&loop);
        loop.device = hand_device_even(device->mass, device->damping, device->delay, rho);
        place.mesh = liver;
        if (hand_loop_open(&loop) && hand_loop_seek(&loop, liver, &seed, 1e-3 * REFERENCE, &place))
            try_loop(&loop, dpt_stable_stiffness(device->mass, device->damping, PERIOD, device->delay * PERIOD, 0.0),
                     &tally);
        hand_loop_close(&loop);
    }
    const char *word = lab_method_name(method);
    const double all = (double)tally.loops;
    lab_note(lab, word, "loops that were tried", all, "");
    lab_at_most(lab, word, "share of loops at 0.97 of the limit whose motion grows", (double)tally.growing / all, "",
                0.0);
    lab_at_least(lab, word, "share of loops at 1.1 limits whose motion grows", (double)tally.growing_beyond / all, "",
                 0.9);
    lab_note(lab, word, "share of loops whose force is no gradient at the pose", (double)tally.uneven / all, "");
}

static void run(struct lab *lab)
{
    struct hand_mesh liver = { .mesh = NULL };
    if (!hand_mesh_open(&liver, "liver", 10000, 1.0)) {
        lab->is_out_of_memory = 1;
        return;
    }
    for (int method = 0; method < LAB_METHODS; method++)
        run_method(lab, &liver, method);
    hand_mesh_close(&liver);
}

const struct lab_case organs_case = {
    .name = "organs",
    .title = "Tools that a hand holds on an organ",
    .method = "A tool of 60 mm lies on a liver of 10,000 triangles, or stands on its tip. The hand holds it "
              "by a spring and presses it 1 mm deep. The law is linearised there by differences. The "
              "coupling is set to 0.97 of the stiffness at which the sampled loop is at its limit along the "
              "stiffest of six directions. The tool is tapped along each of them, and its motion has to die "
              "away. At 1.1 limits it has to grow.",
    .advice = "What limits a coupling is the stiffest direction that a contact makes, with turns counted. "
              "Leave the margin of 1.5 that dpt_coupling_for_device has for the directions that it cannot know.",
    .run = run
};

/* A needle over spikes, and one held through an organ: the trials of `dynpoint force-test`, method by method. */

static void note_push(struct lab *lab, int method, const struct push_result *result)
{
    const char *name = lab_method_name(method);
    lab_at_most(lab, name, "ticks that turn the force by over 30 degrees, folds apart",
                lab_per_cent(result->turns, result->ticks), "%", 0.0);
    lab_at_most(lab, name, "ticks that reverse the force, by over 90 degrees",
                lab_per_cent(result->reversals, result->ticks), "%", 0.0);
    lab_at_most(lab, name, "largest |dW| in a tick, of K (3 |motion| + 1 mm)", result->largest_share, "",
                LEAD_SHARE_MAX);
    lab_note(lab, name, "largest change of force in a tick", result->largest_jump, "N");
    lab_note(lab, name, "ticks with a force", (double)result->ticks, "");
    if (!lab_has_proxy(method))
        return;
    lab_at_most(lab, name, "ticks whose proxy is in the body", (double)result->penetrations, "", 0.0);
    lab_at_most(lab, name, "ticks of a fold that push harder than the motion explains", (double)result->fold_pushes, "",
                0.0);
    lab_note(lab, name, "ticks with a fold", lab_per_cent(result->folds, result->ticks), "%");
}

static void push_over(struct lab *lab, const char *shape, uint64_t triangles, uint64_t places,
                      int (*trial)(const struct force_trial_def *, struct push_result *))
{
    struct lab_mesh mesh;
    if (!lab_mesh_shape(lab, &mesh, shape, triangles))
        return;
    for (int method = 0; method < LAB_METHODS; method++) {
        struct force_trial_def def = lab_trial_def(method, mesh.mesh);
        struct push_result result;
        def.places = lab_share(lab, places);
        if (trial(&def, &result))
            note_push(lab, method, &result);
        else
            lab->is_out_of_memory = 1;
    }
    lab_mesh_close(&mesh);
}

static void run_spikes(struct lab *lab)
{
    push_over(lab, "star", 20480, 200, force_trial_push);
}

const struct lab_case spikes_case = {
    .name = "spikes",
    .title = "Across spikes and deep concavities",
    .method = "A needle of 100 mm is pushed 5 mm into a star of 48 spikes at random places, upright to "
              "lying, and then led 40 mm across its spikes at 0.1 m/s with a tremor of 0.2 mm. The ball "
              "is this library's proxy of one point at the needle's tip, as point-based toolkits have "
              "it; it is not their code. Where a proxy leaves a spike it reports a fold, and its force may turn there.",
    .advice = "Use the proxy. Between spikes the nearest way out changes from one tick to the next, so "
              "a law without a memory of where the tool came from jumps. A fold is a real event: the "
              "tool has slipped over a spike. Count folds with dpt_force_info if a scene needs to know.",
    .run = run_spikes
};

static void run_medial(struct lab *lab)
{
    push_over(lab, "liver", 20000, 100, force_trial_through);
}

const struct lab_case medial_case = {
    .name = "medial",
    .title = "A needle held through an organ",
    .method = "A needle that is longer than a liver is pushed in sideways by 27 mm, tip first to lying, "
              "and held there with a tremor of 0.2 mm. Somewhere along its axis two ways out are "
              "equally long. The ball is this library's proxy of one point at the tip.",
    .advice = "Never use the push at the deepest point where a tool can go through a thick body. No "
              "stiffness, damping or filter cures its reversals; a filter slow enough to hide them "
              "makes the wall soft and late. The bed turns seldom. The proxy turns only where it reports a fold.",
    .run = run_medial
};

/* Thin walls and open sheets: what goes through, at a border, and behind a sheet. */

static const double upright[3] = { 0.0, 0.0, 1.0 }, lying[3] = { 1.0, 0.0, 0.0 };

/* A wall of 120 x 120 mm with its upper side at z = 0; of no thickness: the sheet of 200 mm of `dynpoint make`. */
static int make_wall(struct lab *lab, struct lab_mesh *mesh, double thickness)
{
    return thickness > 0.0 ? lab_mesh_slab(lab, mesh, -0.06, 0.06, -thickness, 0.0, 0.06)
                           : lab_mesh_shape(lab, mesh, "membrane", 512);
}

/* Lead the tool from 20 mm above to 15 mm beyond the far side, and hold it: 1 if nothing pushes it back. */
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

/* The largest force that pushes the tool back, N, until the force collapses or the depth ends. */
static double pop_force(struct lab_lead *lead, const double *axis, double x, double depth_max)
{
    const double down = 5e-5;
    const int ticks = (int)((depth_max + 0.001) / down) + 1;
    double max = 0.0;
    int is_through = 0;
    lab_lead_calm(lead);
    for (int i = 0; i < ticks && !is_through; i++) {
        const double tip[3] = { x, 0.003, LAB_RADIUS + 0.001 - down * i };
        lab_lead_aim(lead, tip, axis);
        lab_lead_tick(lead, i == 0);
        const double force = lab_lead_force(lead)[2];
        max = fmax(max, force);
        is_through = force < 0.5 * max && max > SMALL_FORCE;
    }
    return max;
}

static void push_quasi_statically(struct lab *lab)
{
    static const double thicknesses[] = { 0.0, 0.0002, 0.0005, 0.001, 0.002, 0.005, 0.01, 0.02 };
    double min[LAB_METHODS] = { HUGE_VAL, HUGE_VAL, HUGE_VAL, HUGE_VAL }, free_tip = HUGE_VAL;
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
                min[method] = fmin(min[method], force);
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
                     min[method], "N", 50.0);
    lab_note(lab, "proxy", "force of a tip 6 degrees off upright that lies in front, 100 mm deep", free_tip, "N");
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
              "meets. A long tool that is pushed down on its tip by more than a sixth of its length "
              "leans, and lies down in front, as a pencil would; it is led back when the hand lifts. "
              "Set lock_rotation or a greater rotational_stiffness where it is to stand. Only where the "
              "hand itself turns by 1 rad from where it was free, and the tool cannot follow, is it put "
              "at the device, without a force until it is in front again.",
    .run = run_thinsheet
};

/* Lead the pressed tool to and fro across the border x = 0.1 of the sheet. */
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
