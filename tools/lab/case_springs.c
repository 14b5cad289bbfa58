/* SPDX-License-Identifier: BSD-3-Clause */
/* A needle that is held in a liver of masses and springs, and a tool that presses it, for a minute. */
#include <math.h>
#include <stdlib.h>

#include "lab/hand_loop.h"
#include "lab/hand_sway.h"
#include "lab/hum_limits.h"
#include "lab/lab.h"
#include "measure/hum.h"
#include "measure/judgement.h"

enum { TOOLS = 2, INTEGRATORS = 2, TRIANGLES = 50332, FEWER = 10000, TICKS = 60000, TICKS_MIN = 3000 };

#define PRESS  1.0   /* N */
#define GRIP   200.0 /* N/m */
#define DRIFT  0.1   /* mm */
#define SPEED  1.0   /* mm/s */
#define SPREAD 0.02  /* m */

static const dpt_spring_region bed = { .kind = DPT_REGION_BOX,
                                       .fixed = 1,
                                       .box = { -0.2, -0.2, -0.1, 0.2, 0.2, -0.035 } };

static const dpt_spring_net_def liver = { .size = sizeof(dpt_spring_net_def),
                                          .kind = DPT_NET_VOLUME,
                                          .young = 5000.0,
                                          .density = 1000.0,
                                          .drag = 5.0,
                                          .viscosity = 1e-3,
                                          .regions = &bed,
                                          .region_count = 1 };

/* A needle on a device that turns, and a lying tool on one of light friction and fine steps. */
static const struct trial {
    const char *speed, *jump, *hum, *jumps, *drift, *account, *awake, *depth;
    struct hand_tool tool;
    struct hand_device device;
} trials[TOOLS][INTEGRATORS] = {
#define NEEDLE                                                                                                         \
    { 0.12, 0.001, 1.2 },                                                                                              \
    {                                                                                                                  \
        .dofs = 6, .mass = 0.2, .damping = 2.0, .friction = 0.1, .step = 2e-5, .inertia = 2e-4, .turn_damping = 2e-3,  \
        .turn_friction = 1e-3, .turn_step = 1e-4, .force = 8.0, .torque = 0.4                                          \
    }
#define LYING                                                                                                          \
    { 0.06, 0.003, 0.0 },                                                                                              \
    {                                                                                                                  \
        .dofs = 3, .mass = 0.1, .damping = 0.5, .friction = 0.05, .step = 1e-5, .force = 8.0                           \
    }
#define FIGURES(what)                                                                                                  \
    what ": fastest in the last quarter", what ": largest change of force in a tick there",                            \
        what ": hum there, of what is allowed", what ": 99 % of jumps there, of what is allowed",                      \
        what ": drift from the second quarter to the last", what ": least account", what ": nodes that were awake",    \
        what ": how deep the liver was pressed"
    { { FIGURES("needle, SYMPLECTIC"), NEEDLE }, { FIGURES("needle, IMPLICIT"), NEEDLE } },
    { { FIGURES("lying tool, SYMPLECTIC"), LYING }, { FIGURES("lying tool, IMPLICIT"), LYING } }
};
static const uint32_t integrators[INTEGRATORS] = { DPT_INTEGRATOR_SYMPLECTIC, DPT_INTEGRATOR_IMPLICIT };

/* The mean place in a quarter of the track. */
static void mean_of(const struct hand_loop *loop, size_t quarter, double mean[3])
{
    const size_t part = loop->count / 4;
    for (int k = 0; k < 3; k++)
        mean[k] = 0.0;
    for (size_t i = quarter * part; i < (quarter + 1) * part; i++)
        for (int k = 0; k < 3; k++)
            mean[k] += loop->track[i].at[k] / (double)part;
}

static double in_steps(double value, double step)
{
    return step > 0.0 ? step * floor(value / step + 0.5) : value;
}

/* How far the sampled tool moved in the tick before this moment, m: its middle, and its points about it. */
static double motion_of(const struct hand_loop *loop, const struct hand_moment *moment)
{
    const struct hand_device *device = &loop->device;
    double sum = 0.0;
    for (int k = 0; k < device->dofs; k++) {
        const double step = k < 3 ? device->step : device->turn_step, arm = k < 3 ? 1.0 : hand_loop_rho(loop);
        sum += pow(arm * (in_steps(moment->at[k], step) - in_steps(moment[-1].at[k], step)), 2.0);
    }
    return sqrt(sum);
}

/*
 * Shares of what may hum and jump (lab/hum_limits.h) in the last quarter. What is sent is of one of the last two samples.
 * NANs if memory ran out.
 */
static void judge_hum(struct lab *lab, const struct hand_loop *loop, double *hum_share, double *jump_share)
{
    const size_t part = loop->count / 4, begin = loop->count - part;
    double *sizes = malloc(2 * part * sizeof *sizes), *beyond = sizes + part;
    struct hum hum;
    *hum_share = *jump_share = NAN;
    if (!sizes) {
        lab->is_out_of_memory = 1;
        return;
    }
    for (size_t i = 0; i < part; i++) {
        const struct hand_moment *moment = &loop->track[begin + i];
        const double motion =
            fmax(motion_of(loop, moment), fmax(motion_of(loop, moment - 1), motion_of(loop, moment - 2)));
        const double stand = motion > 0.0 ? HUM_JUMP_MOVED : HUM_JUMP_STILL;
        const double allowed = stand + HUM_JUMP_GAIN * loop->stiffness * motion;
        double size = 0.0, change = 0.0;
        for (int k = 0; k < 3; k++) {
            size += moment->sent[k] * moment->sent[k];
            change += pow(moment->sent[k] - moment[-1].sent[k], 2.0);
        }
        sizes[i] = sqrt(size);
        beyond[i] = sqrt(change) / allowed;
    }
    if (!hum_measure(&hum, sizes, part))
        lab->is_out_of_memory = 1;
    *hum_share = hum.rms / fmax(HUM_LIMIT_SHARE * hum.mean, HUM_LIMIT_MIN);
    *jump_share = judgement_spread_of(beyond, part).p99;
    free(sizes);
}

static void look(struct lab *lab, const struct hand_loop *loop, const struct trial *trial)
{
    const dpt_passivity_info info = hand_loop_account(loop);
    double speed = 0.0, jump = 0.0, drift = 0.0, hum, jumps, early[3], late[3];
    for (size_t i = 3 * (loop->count / 4); i < loop->count; i++) {
        const struct hand_moment *moment = &loop->track[i];
        double fast = 0.0, change = 0.0;
        for (int k = 0; k < 3; k++) {
            fast += moment->speed[k] * moment->speed[k];
            change += pow(moment->sent[k] - moment[-1].sent[k], 2.0);
        }
        speed = fmax(speed, sqrt(fast));
        jump = fmax(jump, sqrt(change));
    }
    mean_of(loop, 1, early);
    mean_of(loop, 3, late);
    for (int k = 0; k < 3; k++)
        drift += (late[k] - early[k]) * (late[k] - early[k]);
    lab_at_most(lab, "proxy", trial->speed, 1e3 * speed, "mm/s", SPEED);
    lab_note(lab, "proxy", trial->jump, jump, "N");
    judge_hum(lab, loop, &hum, &jumps);
    lab_at_most(lab, "proxy", trial->hum, hum, "", 1.0);
    lab_at_most(lab, "proxy", trial->jumps, jumps, "", 1.0);
    lab_at_most(lab, "proxy", trial->drift, 1e3 * sqrt(drift), "mm", DRIFT);
    lab_at_least(lab, "observer", trial->account, info.account_min / info.eps, "eps", -1.0);
    lab_note(lab, "proxy", trial->awake, 100.0 * (double)loop->springs->active / (double)loop->springs->nodes, "%");
    lab_note(lab, "proxy", trial->depth, -1e3 * late[1], "mm");
}

/* The same where loads are spread. */
static void look_at_spread(struct lab *lab, const struct hand_loop *loop)
{
    double hum, jumps;
    judge_hum(lab, loop, &hum, &jumps);
    lab_at_most(lab, "proxy", "lying tool, loads spread over 20 mm: hum there, of what is allowed", hum, "", 1.0);
    lab_at_most(lab, "proxy", "lying tool, loads spread over 20 mm: 99 % of jumps there, of what is allowed", jumps, "",
                1.0);
}

/* The tool's weight presses, a hand holds the tool sideways, and a tap disturbs it aslant. */
static void hold(struct lab *lab, const struct hand_mesh *mesh, const struct trial *trial, uint32_t integrator,
                 double load_radius)
{
    struct hand_place place = { .mesh = mesh };
    struct spring_body springs = { .mesh = mesh->mesh, .integrator = integrator, .load_radius = load_radius };
    dpt_passivity_def observer;
    struct hand_loop loop = { .device = trial->device,
                              .place = &place,
                              .springs = &springs,
                              .tool = trial->tool,
                              .method = LAB_PROXY,
                              .passivity = &observer,
                              .tap = { 1e-3, -2e-3, 5e-4 } };
    const uint64_t due = lab_share(lab, TICKS), ticks = due > TICKS_MIN ? due : TICKS_MIN;
    dpt_passivity_def_init(&observer);
    observer.observe_only = 1;
    observer.damping = trial->device.damping;
    observer.spin_damping = trial->device.turn_damping;
    observer.force_max = trial->device.force;
    observer.torque_max = trial->device.torque > 0.0 ? trial->device.torque : 0.2;
    observer.delay = 1e-3;
    loop.device.rate = 1000.0;
    loop.device.delay = 1.0;
    loop.device.script = "hold";
    loop.device.grip = GRIP;
    loop.device.turn_grip = 0.2;
    loop.device.weight = PRESS;
    const dpt_coupling coupling = hand_loop_choose(&loop, 1.5);
    loop.stiffness = coupling.stiffness;
    loop.rotational_stiffness = coupling.rotational_stiffness;
    hand_place_top(mesh, &place);
    const int is_whole = hand_loop_open(&loop) && hand_loop_lower(&loop, PRESS) && hand_loop_run(&loop, ticks) &&
                         loop.count == ticks && !springs.has_failed;
    if (is_whole && load_radius > 0.0)
        look_at_spread(lab, &loop);
    else if (is_whole)
        look(lab, &loop, trial);
    else
        lab_at_most(lab, "proxy", trial->speed, NAN, "mm/s", SPEED);
    hand_loop_close(&loop);
}

static void run_springs(struct lab *lab)
{
    struct hand_mesh mesh;
    if (hand_mesh_open_springs(&mesh, "liver", lab->effort < 0.5 ? FEWER : TRIANGLES, &liver)) {
        for (int tool = 0; tool < TOOLS; tool++)
            for (uint64_t i = 0; i < lab_share(lab, INTEGRATORS); i++)
                hold(lab, &mesh, &trials[tool][i], integrators[i], 0.0);
        hold(lab, &mesh, &trials[TOOLS - 1][0], integrators[0], SPREAD);
    } else
        lab->is_out_of_memory = 1;
    hand_mesh_close(&mesh);
}

const struct lab_case springs_case = {
    .name = "springs",
    .title = "Held for a minute in a liver of masses and springs",
    .method =
        "A liver of 50,332 triangles hangs on its back: a lattice of 11,401 nodes, 5 kPa, 5 /s of drag, 1 ms of viscosity, stepped in every tick of 1 kHz, and solved together with the tool. A needle of 120 mm that stands aslant, on a device that turns, and a lying tool of 60 mm, on one of 0.05 N of friction, press it with 1 N at the coupling that is chosen for them. A hand of 200 N/m holds them, and they are tapped. For 60 s nothing may buzz (1 mm/s in the last quarter) or drift (0.1 mm). In the last quarter the force may hum and jump as in the case hum: 0.1 % of the mean force or 0.5 mN of hum; of jumps 99 % at most 1 mN in ticks without motion, else 2 mN and 1.5 K times the motion. An observer of passivity that does not act sees what the hand gets: never more than one sample can be off by. So does the lying tool with loads that are spread over 20 mm, which are felt by the same weights.",
    .advice =
        "Soft bodies need no softer coupling than rigid ones: tool and tissue are solved together, and loads that are spread are felt by the same weights. Nothing hums, and the body falls asleep.",
    .run = run_springs
};

/* A hand presses on tissue that gives way: does its device come to rest at the coupling that is chosen? */

enum { PLACES = 4, SPEEDS = 4, HALVINGS = 7 };

#define MASS    0.1
#define DAMPING 0.5
#define MARGIN  1.5
#define DEPTH   4e-3 /* m: that the surface is pressed in by, while it stands still */
#define REACH   2e-4 /* m: of the tap */
#define SECONDS 1.5

/* Bounds of the search for the stiffest stable coupling, N/m. */
#define STIFFNESS_MIN 10.0
#define STIFFNESS_MAX 20000.0

/* Tissue that swings. */
static const struct tissue_matter lively = { 1e5, 30.0, 1e3, 20.0 };

/* Ticks of the loop for a step of physics: at 1 kHz, 250, 100 and 30 Hz. */
static const uint32_t speeds[SPEEDS] = { 1, 4, 10, 33 };

/* A ball and a lying tool. */
static const struct trial_place {
    const char *shape;
    uint64_t triangles;
    double load_radius;
    struct hand_tool tool;
} places[PLACES] = { { "membrane", 512, 0.04, { 0.0, 0.008, 0.0 } },
                     { "liver", 1200, 0.048, { 0.06, 0.004, 0.0 } },
                     { "membrane", 512, 0.04, { 0.06, 0.004, 0.0 } },
                     { "liver", 1200, 0.048, { 0.0, 0.008, 0.0 } } };

/* How positions are handed over, and whether a period of physics is counted as delay. */
enum exchange { INTERPOLATED, UNCOUNTED, STEPPED, STEPPED_SLOWLY, STEPPED_COUNTED, EXCHANGES };

/* For each exchange, the number of loops, and of those whose motion does not die away. */
struct tally {
    double loops[EXCHANGES], restless[EXCHANGES];
};

static struct hand_loop loop_on(const struct hand_place *place, const struct hand_tool *tool, struct tissue *tissue)
{
    const double rho = tool->length / sqrt(12.0);
    struct hand_loop loop = { .device = hand_device_even(MASS, DAMPING, 1.0, rho),
                              .place = place,
                              .tissue = tissue,
                              .tool = *tool,
                              .method = LAB_PROXY };
    const struct hand_law none = { .axes = loop.device.dofs, .stiffness = { 1.0 } };
    hand_hold(&loop, &none, 0.0);
    return loop;
}

static int rests(struct hand_loop *loop)
{
    const struct hand_tap tap = {
        .direction = { 0.0, 1.0 }, .stiffness = loop->stiffness, .reach = REACH, .seconds = SECONDS
    };
    return hand_sway(loop, &tap).is_stable && !loop->tissue->has_failed;
}

static void try_exchange(const struct hand_mesh *mesh, const struct trial_place *as, uint32_t ticks,
                         enum exchange exchange, struct tally *tally)
{
    struct hand_place place = { .mesh = mesh };
    struct tissue tissue = { .mesh = mesh->mesh,
                             .matter = tissue_soft,
                             .ticks = ticks,
                             .is_interpolated = exchange != STEPPED,
                             .load_radius = as->load_radius };
    struct hand_loop loop = loop_on(&place, &as->tool, &tissue);
    loop.is_uncounted = exchange == UNCOUNTED;
    loop.stiffness = hand_loop_choose(&loop, MARGIN).stiffness;
    tissue.is_interpolated = exchange < STEPPED;
    hand_place_top(mesh, &place);
    const int has_begun = hand_loop_open(&loop) && hand_loop_lower(&loop, loop.stiffness * DEPTH) && rests(&loop);
    const enum exchange told = exchange == STEPPED && ticks == speeds[SPEEDS - 1] ? STEPPED_SLOWLY : exchange;
    tally->loops[told] += 1.0;
    tally->restless[told] += has_begun ? 0.0 : 1.0;
    hand_loop_close(&loop);
}

static void try_place(struct lab *lab, const struct trial_place *as, struct tally *tally)
{
    struct hand_mesh mesh = { .mesh = NULL };
    if (!hand_mesh_open(&mesh, as->shape, as->triangles, 1.0)) {
        lab->is_out_of_memory = 1;
        return;
    }
    for (int s = 0; s < SPEEDS; s++)
        for (int exchange = 0; exchange < EXCHANGES; exchange++)
            if (exchange != STEPPED_SLOWLY && (exchange != STEPPED_COUNTED || s == SPEEDS - 1))
                try_exchange(&mesh, as, speeds[s], (enum exchange)exchange, tally);
    hand_mesh_close(&mesh);
}

/* The stiffest coupling at which a ball on lively tissue comes to rest, N/m. */
static double stiffest(struct hand_loop *loop)
{
    double low = STIFFNESS_MIN, high = STIFFNESS_MAX;
    for (int i = 0; i < HALVINGS; i++) {
        const double middle = sqrt(low * high);
        hand_loop_stiffen(loop, middle, 0.0, 0.0);
        *(rests(loop) ? &low : &high) = middle;
    }
    return low;
}

/* Against the rate of physics: least shares of what is chosen with the delay of interpolation counted, and without. */
static void map(struct lab *lab, const struct hand_mesh *mesh, int is_interpolated, double *counted, double *uncounted)
{
    const uint64_t due = lab_share(lab, SPEEDS);
    struct hand_place place = { .mesh = mesh };
    hand_place_top(mesh, &place);
    for (uint64_t s = SPEEDS - due; s < SPEEDS; s++) {
        struct tissue tissue = { .mesh = mesh->mesh,
                                 .matter = lively,
                                 .ticks = speeds[s],
                                 .is_interpolated = is_interpolated,
                                 .load_radius = places[0].load_radius };
        struct hand_loop loop = loop_on(&place, &places[0].tool, &tissue);
        const double rate = 1.0 / tissue_period(&tissue);
        const double chosen = hand_loop_choose(&loop, MARGIN).stiffness;
        loop.is_uncounted = 1;
        const double bolder = hand_loop_choose(&loop, MARGIN).stiffness;
        loop.stiffness = chosen;
        double found = NAN;
        if (hand_loop_open(&loop) && hand_loop_lower(&loop, chosen * DEPTH))
            found = stiffest(&loop);
        hand_loop_close(&loop);
        *counted = hand_min(*counted, found / chosen);
        *uncounted = hand_min(*uncounted, found / bolder);
        lab_point_at(lab, "stability-tissue", is_interpolated ? "interpolated" : "stepped", rate, found);
        if (is_interpolated)
            lab_point_at(lab, "stability-tissue", "chosen, interpolated", rate, chosen);
        else
            lab_point_at(lab, "stability-tissue", "chosen, stepped", rate, chosen);
    }
}

static void try_map(struct lab *lab)
{
    struct hand_mesh mesh = { .mesh = NULL };
    double counted = HUGE_VAL, uncounted = HUGE_VAL, stepped = HUGE_VAL;
    if (!hand_mesh_open(&mesh, places[0].shape, places[0].triangles, 1.0)) {
        lab->is_out_of_memory = 1;
        return;
    }
    map(lab, &mesh, 1, &counted, &uncounted);
    map(lab, &mesh, 0, &stepped, &stepped);
    hand_mesh_close(&mesh);
    lab_at_least(lab, "proxy", "ball, interpolated: stiffest that comes to rest, of the chosen", counted, "", 1.0);
    lab_note(lab, "proxy", "the same, of that chosen without counting the period", uncounted, "");
    lab_at_least(lab, "proxy", "ball, stepped: stiffest that comes to rest, of the chosen", stepped, "", 1.0);
}

static void run_soft(struct lab *lab)
{
    struct tally tally = { { 0.0 }, { 0.0 } };
    const uint64_t due = lab_share(lab, PLACES);
    double restless[EXCHANGES];
    for (uint64_t i = 0; i < due; i++)
        try_place(lab, &places[i], &tally);
    for (int exchange = 0; exchange < EXCHANGES; exchange++)
        restless[exchange] = tally.restless[exchange] / tally.loops[exchange];
    lab_at_most(lab, "proxy", "interpolated, 30 Hz to 1 kHz: share of loops that do not come to rest",
                restless[INTERPOLATED], "", 0.0);
    lab_note(lab, "proxy", "interpolated, the period not counted: the same", restless[UNCOUNTED], "");
    lab_at_most(lab, "proxy", "stepped, 100 Hz to 1 kHz: the same", restless[STEPPED], "", 0.0);
    lab_note(lab, "proxy", "stepped, 30 Hz: the same", restless[STEPPED_SLOWLY], "");
    lab_at_most(lab, "proxy", "stepped, 30 Hz, with the period counted: the same", restless[STEPPED_COUNTED], "", 0.0);
    try_map(lab);
}

const struct lab_case soft_case = {
    .name = "soft",
    .title = "A hand on tissue that gives way",
    .method = "A hand of 200 N/m presses a ball and a lying tool on to a membrane and an organ that give way "
              "(the case tissue), on a device of 0.1 kg and 0.5 Ns/m at 1 kHz with a delay of one period. "
              "Physics has 30, 100, 250 and 1000 Hz, and hands positions over in steps, or interpolated, "
              "which delays them by one of its periods. The coupling is the one that dpt_coupling_for_device "
              "chooses, with that period in loop_delay where positions are interpolated. The tool rests on "
              "the tissue for a second, and is tapped by 0.2 mm: that has to die away. The chart has the "
              "stiffest coupling at which it does, for a ball on tissue with a fifth of the damping.",
    .advice = "Count the period of interpolation in dpt_coupling_def.loop_delay: no loop grows then. It is a "
              "bound for walls, and tissue that gives way takes more, so that a measured stiffness may be "
              "higher. With physics of 30 Hz in steps count the period, too: a tool that lies is held by "
              "other points after each step, and shakes the hand by a millimetre.",
    .run = run_soft
};
