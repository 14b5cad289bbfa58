/* SPDX-License-Identifier: BSD-3-Clause */
/* Does the force of soft scenes hum, or jump, where a device stands still, presses and wipes? */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/vec3.h"
#include "lab/hand_loop.h"
#include "lab/hum_limits.h"
#include "lab/hum_trial.h"
#include "lab/lab.h"
#include "measure/hum.h"
#include "measure/judgement.h"

/* Levels of each factor, and the scene's own. */
enum { LEVELS = 3, OWN = 3, ROWS = 20, STILL = 800, STILL_FEW = 500 };

#define SLIP_SHARE  0.05 /* of the force: each jump of a contact that slips */
#define FORCE_MIN   1e-3 /* N: less is no contact */
#define EXPLAINED   5e-3 /* of the ticks: those whose jump a flag explains */
#define STATIC_RUB  0.5  /* coefficients of friction of those rows that slip */
#define KINETIC_RUB 0.4

static const double stiffnesses[LEVELS] = { 200.0, 667.0, 2000.0 }; /* N/m */
static const double ratios[LEVELS] = { 0.5, 1.0, 2.0 };             /* edge over radius */
static const char *const integrators[LEVELS] = { "SYMPLECTIC", "EULER", "IMPLICIT" };

enum hand { HAND_STILL, HAND_PRESS, HAND_WIPE, HAND_RUB };
static const char *const hands[] = { "still", "press", "wipe", "rub" };

/*
 * A full product of hands, angles, stiffnesses, integrators and edges has 243 rows a scene; these are 20. Three are as
 * `dynpoint run` has it: lying, 667 N/m, the scene's integrator and radius. Nine of a still hand are an orthogonal array:
 * every two levels of any two of the four factors meet once. Of three that press and three that wipe, each level of each
 * factor occurs once. Two slip. Rotation is free in nine. The first are those with which a short run sees most.
 */
static const struct row {
    enum hand hand;
    int lean, stiffness, integrator, ratio, turns;
} rows[ROWS] = {
    { HAND_STILL, 2, 1, OWN, OWN, 0 }, { HAND_PRESS, 2, 1, OWN, OWN, 0 }, { HAND_WIPE, 2, 1, OWN, OWN, 0 },
    { HAND_STILL, 2, 2, 1, 0, 0 },     { HAND_WIPE, 2, 1, 0, 0, 1 },      { HAND_STILL, 1, 1, 2, 0, 1 },
    { HAND_STILL, 2, 0, 2, 2, 1 },     { HAND_STILL, 1, 2, 0, 2, 0 },     { HAND_STILL, 0, 1, 1, 2, 1 },
    { HAND_STILL, 1, 0, 1, 1, 0 },     { HAND_STILL, 0, 2, 2, 1, 1 },     { HAND_STILL, 2, 1, 0, 1, 0 },
    { HAND_STILL, 0, 0, 0, 0, 1 },     { HAND_PRESS, 0, 1, 2, 0, 0 },     { HAND_PRESS, 1, 2, 0, 1, 1 },
    { HAND_PRESS, 2, 0, 1, 2, 0 },     { HAND_WIPE, 0, 2, 1, 1, 1 },      { HAND_WIPE, 1, 0, 2, 2, 0 },
    { HAND_RUB, 2, 1, OWN, OWN, 0 },   { HAND_RUB, 1, 0, 2, 1, 1 },
};

enum { SCENES = 9 };

/* A scene by name, or an organ whose file lies below the folder of data. Angles differ, so that more are seen. */
static const struct place {
    const char *name, *file;
    double lean[LEVELS]; /* degrees: 0 upright, 90 lying */
    double own_lean;     /* of the scene's own tool, at first */
    double still, press; /* m: how deep; a cloth's tool comes from below */
    const char *hum, *still_jump, *moved, *unexplained, *explained, *slip, *count, *failures, *refused;
} places[SCENES] = {
#define WORDS(name)                                                                                                    \
    name ", still: most hum, of what is allowed", name ", still: most of 99 % of jumps, of what is allowed",           \
        name ", moving: most of 99 % of jumps, of what is allowed", name ", moving: jumps that no flag explains",      \
        name ", moving: most ticks whose jump a flag explains", name ", slipping: largest jump, of what is allowed",   \
        name ": rows that were judged", name ": rows that fail", name ": rows whose integrator refuses the step"
    { "liver", NULL, { 0.0, 45.0, 90.0 }, 90.0, 0.002, 0.004, WORDS("rigid liver") },
    { "membrane", NULL, { 30.0, 85.0, 90.0 }, 90.0, 0.015, 0.02, WORDS("membrane") },
    { "laparoscopy", NULL, { 0.0, 80.0, 90.0 }, 45.0, 0.005, 0.01, WORDS("laparoscopy") },
    { "soft-liver", NULL, { 0.0, 85.0, 90.0 }, 90.0, 0.005, 0.01, WORDS("soft-liver") },
    { "cloth", NULL, { 80.0, 85.0, 90.0 }, 90.0, 0.0, 0.025, WORDS("cloth") },
    { "biopsy", NULL, { 0.0, 0.0, 0.0 }, 0.0, 0.02, 0.02, WORDS("biopsy") },
    { "organ-liver", "openhelp_liver.stl", { 45.0, 80.0, 90.0 }, 90.0, 0.005, 0.01, WORDS("real liver") },
    { "organ-kidney", "openhelp_kidney_left.stl", { 20.0, 85.0, 90.0 }, 90.0, 0.005, 0.01, WORDS("real kidney") },
    { "organ-spleen", "openhelp_spleen.stl", { 60.0, 88.0, 90.0 }, 90.0, 0.005, 0.01, WORDS("real spleen") },
};

static const char *const columns[] = { "scene",          "integrator",   "lean_deg",       "stiffness",
                                       "edge_of_radius", "rotation",     "hand",           "mean_N",
                                       "hum_N",          "hum_percent",  "jump_median_mN", "jump_99_mN",
                                       "jump_max_mN",    "strongest_Hz", "verdict",        NULL };

/* Of a row: what it hums and jumps, N, and shares of what is allowed. What is not judged is 0. */
struct answer {
    struct hum hum;
    struct judgement_spread jump;
    double hum_share, still_share, moved_share, slip_share;
    double unexplained, explained; /* jumps; a share of the ticks */
    const char *verdict;
    int fails;
};

/* The largest of all rows of a scene. */
struct worst {
    double hum, still, moved, unexplained, explained, slip;
    size_t still_rows, moved_rows, slip_rows, failures, refused;
};

static double jump_of(const struct hum_tick *tick)
{
    return length(sub(vec3_of(tick->force), vec3_of(tick[-1].force)));
}

/* Flags that say why a force may jump. */
#define EXPLAINING                                                                                                     \
    ((uint32_t)(DPT_FORCE_FLAG_FADING | DPT_FORCE_FLAG_FOLD | DPT_FORCE_FLAG_SQUEEZED | DPT_FORCE_FLAG_REPLACED |      \
                DPT_FORCE_FLAG_BEHIND))

/* Whether a contact begins to slip: nothing slipped before, or something held the tool, and nothing does now. */
static int slip_begins(const struct hum_tick *tick)
{
    return !tick[-1].slipping || (tick[-1].sticking && !tick->sticking);
}

/* What a jump has beyond what the device's motion allows, N. A contact that slips has an allowance of its own. */
static void judge_motion(const struct hum_trial *trial, double *beyond, struct answer *answer)
{
    const double onset = (trial->static_friction - trial->kinetic_friction) / hypot(1.0, trial->static_friction);
    size_t count = 0, explained = 0, unexplained = 0;
    for (size_t i = trial->judged + 1; i < trial->count; i++) {
        const struct hum_tick *tick = &trial->tick[i];
        const double jump = jump_of(tick), over = jump - HUM_JUMP_GAIN * trial->stiffness * tick->motion;
        const double force = fmax(length(vec3_of(tick->force)), length(vec3_of(tick[-1].force)));
        const int has_flag = ((tick->flags | tick[-1].flags) & EXPLAINING) != 0;
        if (tick->slipping || tick[-1].slipping) {
            const double moved = HUM_JUMP_GAIN * trial->stiffness * tick->motion + HUM_JUMP_MOVED;
            const double allowed = fmax(moved, SLIP_SHARE * force) + (slip_begins(tick) ? onset * force : 0.0);
            explained += has_flag && jump > allowed;
            answer->slip_share = fmax(answer->slip_share, has_flag ? 0.0 : jump / allowed);
        } else {
            beyond[count++] = over;
            explained += has_flag && over > HUM_JUMP_MOST;
            unexplained += !has_flag && over > HUM_JUMP_MOST;
        }
    }
    answer->unexplained = (double)unexplained;
    answer->explained = (double)explained / (double)(trial->count - trial->judged + 1);
    answer->moved_share = fmax(judgement_spread_of(beyond, count).p99 / HUM_JUMP_MOVED, 0.0);
}

static void judge(struct lab *lab, const struct hum_trial *trial, struct answer *answer)
{
    const size_t count = trial->count - trial->judged;
    double *sizes = malloc(2 * (count + 1) * sizeof *sizes), *jumps = sizes + count + 1;
    *answer = (struct answer){ .hum = { NAN, NAN, NAN }, .fails = 1 };
    if (!sizes) {
        lab->is_out_of_memory = 1;
        return;
    }
    for (size_t i = 0; i < count; i++)
        sizes[i] = length(vec3_of(trial->tick[trial->judged + i].force));
    for (size_t i = 1; i < count; i++)
        jumps[i - 1] = jump_of(&trial->tick[trial->judged + i]);
    if (!hum_measure(&answer->hum, sizes, count))
        lab->is_out_of_memory = 1;
    answer->jump = judgement_spread_of(jumps, count > 0 ? count - 1 : 0);
    if (trial->hand == HUM_STILL) {
        answer->hum_share = answer->hum.rms / fmax(HUM_LIMIT_SHARE * answer->hum.mean, HUM_LIMIT_MIN);
        answer->still_share = answer->jump.p99 / HUM_JUMP_STILL;
    } else {
        judge_motion(trial, jumps, answer);
    }
    free(sizes);
    if (trial->has_failed || !(answer->hum.mean >= FORCE_MIN)) {
        answer->hum_share = answer->still_share = answer->moved_share = NAN;
        answer->verdict = trial->has_failed && count > 0 ? "broke" : "no force";
        return;
    }
    answer->fails = !(answer->hum_share <= 1.0 && answer->still_share <= 1.0 && answer->moved_share <= 1.0 &&
                      answer->unexplained <= 0.0 && answer->explained <= EXPLAINED && answer->slip_share <= 1.0);
    answer->verdict = answer->fails ? "fails" : "holds";
}

static void tell_row(struct lab *lab, const struct place *place, const struct row *row, const struct hum_trial *trial,
                     const struct answer *answer)
{
    const double per_cent = 100.0 * answer->hum.rms / answer->hum.mean;
    const struct lab_cell cells[LAB_COLUMNS_MAX] = {
        { .word = place->name },
        { .word = trial->scene->is_soft ? integrators[trial->integrator] : "rigid" },
        { .number = trial->lean },
        { .number = trial->stiffness },
        { .number = trial->scene->edge / trial->radius },
        { .word = trial->turns ? "free" : "locked" },
        { .word = hands[row->hand] },
        { .number = answer->hum.mean },
        { .number = answer->hum.rms },
        { .number = per_cent },
        { .number = 1e3 * answer->jump.median },
        { .number = 1e3 * answer->jump.p99 },
        { .number = 1e3 * answer->jump.max },
        { .number = answer->hum.strongest },
        { .word = answer->verdict },
    };
    lab_add_row(lab, cells);
}

static void keep_worst(struct worst *worst, const struct row *row, const struct answer *answer)
{
    if (row->hand == HAND_STILL) {
        worst->still_rows++;
        worst->hum = hand_max(worst->hum, answer->hum_share);
        worst->still = hand_max(worst->still, answer->still_share);
    } else {
        worst->moved_rows++;
        worst->slip_rows += (size_t)(row->hand == HAND_RUB);
        worst->moved = hand_max(worst->moved, answer->moved_share);
        worst->unexplained = hand_max(worst->unexplained, answer->unexplained);
        worst->explained = hand_max(worst->explained, answer->explained);
        worst->slip = hand_max(worst->slip, answer->slip_share);
    }
    worst->failures += (size_t)answer->fails;
}

static void try_row(struct lab *lab, struct hum_scene *scene, const struct place *place, const struct row *row,
                    struct worst *worst)
{
    const int is_usual = row->ratio == OWN;
    struct hum_trial trial = { .scene = scene,
                               .hand = row->hand == HAND_RUB ? HUM_WIPE : (enum hum_hand)row->hand,
                               .integrator = row->integrator == OWN ? scene->integrator : (uint32_t)row->integrator,
                               .lean = is_usual ? place->own_lean : place->lean[row->lean],
                               .stiffness = stiffnesses[row->stiffness],
                               .radius = is_usual ? scene->radius : scene->edge / ratios[row->ratio],
                               .turns = row->turns,
                               .is_usual = is_usual,
                               .depth = row->hand == HAND_PRESS ? place->press : place->still,
                               .static_friction = row->hand == HAND_RUB ? STATIC_RUB : 0.0,
                               .kinetic_friction = row->hand == HAND_RUB ? KINETIC_RUB : 0.0,
                               .still_ticks = lab->effort < 0.5 ? STILL_FEW : STILL };
    struct answer answer = { .verdict = "refused", .hum = { NAN, NAN, NAN }, .jump = { NAN, NAN, NAN, NAN } };
    if (!hum_trial_run(&trial))
        lab->is_out_of_memory = 1;
    else if (trial.is_refused)
        worst->refused++;
    else {
        judge(lab, &trial, &answer);
        keep_worst(worst, row, &answer);
    }
    tell_row(lab, place, row, &trial, &answer);
    hum_trial_close(&trial);
}

static void tell(struct lab *lab, const struct place *place, const struct worst *worst)
{
    if (worst->still_rows) {
        lab_at_most(lab, "proxy", place->hum, worst->hum, "", 1.0);
        lab_at_most(lab, "proxy", place->still_jump, worst->still, "", 1.0);
    }
    if (worst->moved_rows) {
        lab_at_most(lab, "proxy", place->moved, worst->moved, "", 1.0);
        lab_at_most(lab, "proxy", place->unexplained, worst->unexplained, "", 0.0);
        lab_at_most(lab, "proxy", place->explained, 100.0 * worst->explained, "%", 100.0 * EXPLAINED);
    }
    if (worst->slip_rows)
        lab_at_most(lab, "proxy", place->slip, worst->slip, "", 1.0);
    lab_note(lab, "proxy", place->count, (double)(worst->still_rows + worst->moved_rows), "");
    lab_note(lab, "proxy", place->failures, (double)worst->failures, "");
    if (worst->refused)
        lab_note(lab, "proxy", place->refused, (double)worst->refused, "");
}

/* Returns 0 if there is no such organ. */
static int open_place(struct hum_scene *scene, const struct place *place, const char *folder)
{
    char path[4096];
    if (!place->file)
        return hum_scene_open(scene, place->name);
    snprintf(path, sizeof path, "%s/meshes/organs/%s", folder, place->file);
    return hum_scene_open_organ(scene, path);
}

static void run(struct lab *lab)
{
    const char *folder = getenv("DPT_DATA");
    const size_t due = (size_t)lab_share(lab, ROWS);
    double skipped = 0.0;
    lab->columns = columns;
    for (int i = 0; i < SCENES && !lab->is_out_of_memory; i++) {
        struct hum_scene scene;
        struct worst worst = { .hum = 0.0 };
        if (places[i].file && (lab->effort < 0.5 || !folder || !*folder)) {
            skipped += 1.0;
            continue;
        }
        if (open_place(&scene, &places[i], folder)) {
            /* A needle stands still. */
            for (size_t row = 0; row < (scene.is_needle ? 1 : due); row++)
                try_row(lab, &scene, &places[i], &rows[row], &worst);
            tell(lab, &places[i], &worst);
        } else if (places[i].file) {
            skipped += 1.0;
        } else {
            lab->is_out_of_memory = 1;
        }
        hum_scene_close(&scene);
    }
    lab_note(lab, "data", "real organs skipped: their files are below DPT_DATA, and the effort is 0.5 or more", skipped,
             "");
}

const struct lab_case hum_case = {
    .name = "hum",
    .title = "Soft scenes that hum",
    .method =
        "A device without inertia leads a tool on to scenes at 1 kHz, and stands still, presses, wipes without "
        "friction, or rubs with coefficients of 0.5 and 0.4. The force is the one asked for, before limits. Hum "
        "is the root of the mean square of its size above 20 Hz, after lines over 51 ms are taken out "
        "(tools/measure/hum.h); a jump is its change in a tick; both from 60 ms after contact began, or where a "
        "cloth falls on to the tool from when it has. Each scene "
        "has 20 rows: three as dynpoint run has it, but for a port, about which the tool does not turn; nine of a still hand, an orthogonal array of lean (0 upright, "
        "90 lying), stiffness, integrator, and edges of a half, one and two radii of the tool; three that press "
        "and three that wipe, with each of these levels once; two that slip. Rotation is free in nine. "
        "A needle has one: it stands still, 20 mm inside. "
        "While the device has stood still for 1 s, hum may be 0.1 % of the mean force or 0.5 mN, and 99 % of "
        "jumps 1 mN. While it moves, by at most 0.05 mm a tick, 99 % of jumps may be 1.5 K times its motion and 2 "
        "mN, and none that no flag explains more than 20 mN beside that. What slips may jump so, or by 5 % of the "
        "force, and by what friction loses when slip sets in: where the last touch that held the tool lets go. Flags "
        "may explain 0.5 % of the ticks. A row without 1 "
        "mN of force fails. Tissue is as damped as its scene has it. The rigid liver is the reference; it is "
        "pressed less deep: a rigid surface with dents lets a proxy snap that is held back by more than its "
        "radius. Real organs are made soft as the liver is, and lie flat.",
    .advice =
        "Rigid bodies do not hum, and what gives way does not where it is solved together with the tool "
        "(docs/algorithms/tissue.md). Elsewhere, as with physics at its own rate, few points hold a tool that lies, give "
        "way in each tick, and others hold it in the next: a coupling of 200 N/m hums least there. More damping of the coupling makes it worse, and a low-pass slow enough to hide it makes the "
        "tissue late. A tool that is led over a fine soft surface slips off its edges: then the force jumps once.",
    .run = run,
    .is_named_only = 1
};
