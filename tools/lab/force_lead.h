/* SPDX-License-Identifier: BSD-3-Clause */
/* A needle that is led over one mesh, tick by tick, for the trials of force_trial.h. */
#ifndef DPT_TOOLS_FORCE_LEAD_H
#define DPT_TOOLS_FORCE_LEAD_H

#include "lab/force_trial.h"
#include "scene/scene_stage.h"

#define LEAD_DT 1e-3

/* Forces up to this count for nothing, N. */
#define SMALL_FORCE 0.05

/* Nor do those below this share of the largest one. */
#define SMALL_SHARE 0.02

/* m/s: how fast a proxy may move beside its device; world.h. */
#define PROXY_SPEED 1.0

/*
 * The limit of |dW| as a share of K (3 |motion| + PROXY_SPEED dt). A proxy that moves by its cap meets the bound exactly;
 * both sides are differences of poses, and rounding must not decide.
 */
#define LEAD_SHARE_MAX (1.0 + 1e-9)

struct force_lead {
    const struct force_trial_def *def;
    struct scene_stage stage;
    dpt_pose device, before;
    dpt_force_info force, last; /* their wrenches behind the low-pass */
    int is_folding;             /* the last tick is one of a fold: it told it, or came after such a one that lagged */
    uint64_t seed;
    double rho; /* m: what a turn of 1 rad counts as */
    double tremor[3];
    double *us; /* that ticks with a force took */
    size_t us_count, us_room;
};

/* A place on the mesh, the way out of it there, a random way along it, and the way across both. */
struct place {
    double x[3], normal[3], side[3], across[3];
};

/* 0 where memory ran out. force_lead_close is due in any case. */
int force_lead_open(struct force_lead *lead, const struct force_trial_def *def);
void force_lead_close(struct force_lead *lead);

/* `force` is that of a new tick, and `last` that of the one before: is it one of a fold? */
void force_lead_note_fold(struct force_lead *lead);

/* A tick to `device`. */
void force_lead_step(struct force_lead *lead);

/* A teleport to `device`, and two ticks there. */
void force_lead_start(struct force_lead *lead);

/* How the device moved since `before`: of its middle, and the least turn of its axis, which is small. */
void force_lead_motion(const struct force_lead *lead, double *shift, double *turn);

/* |motion| of the last tick, m, in the norm in which the middle's shift and rho times the turn count alike. */
double force_lead_moved(const struct force_lead *lead);

/* |dW| of the last tick, N: of force and torque / rho. Of a ball the force alone. */
double force_lead_change(const struct force_lead *lead);

/* Whether a tick left the proxy more than 1 % of |p - d| before its place of rest. */
int force_lead_lags(const struct force_lead *lead, const dpt_force_info *force);

/* By how much |W| grew in the last tick, N. */
double force_lead_growth(const struct force_lead *lead);

/* By how much the last tick turned the force, rad; 0 while it was small before or behind, or beside the largest one. */
double force_lead_turned(const struct force_lead *lead, double largest);

/* The next of a random motion whose standard deviation is 0.08 mm and whose peaks are about 0.2 mm. */
void force_lead_tremor(struct force_lead *lead);

/* 0 if there is no triangle to be found. */
int force_lead_place(struct force_lead *lead, struct place *place);

/* The least gap of the tool's surface at a pose; crossing is below 0. */
double force_lead_gap(const struct force_lead *lead, const dpt_pose *pose);

/*
 * The device's end a is `height` above the place and `along` beside it, plus the tremor. The needle leans by `tilt`
 * towards the side.
 */
void force_lead_hold(struct force_lead *lead, const struct place *place, double tilt, double height, double along);

/* The orientation that turns x to a unit vector. */
void point_along(const double *axis, double *orientation);

double uniform(uint64_t *seed, double low, double high);

#endif
