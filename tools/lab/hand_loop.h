/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A hand holds a simulated device, and feels a place of a mesh through it: driver, servo loop, guard, controller and
 * world are the library's own. The hand is a spring, a damper and a constant push; a tap disturbs it.
 *
 *     struct hand_loop loop = { .device = ..., .place = &place, .tool = ..., .method = LAB_PROXY, .stiffness = 500 };
 *     hand_loop_open(&loop) && hand_loop_lower(&loop, 1.0)
 *     hand_loop_run(&loop, 6000);
 *     look at loop.track
 *     hand_loop_close(&loop);
 *
 * Coordinates are the hand's, in m and rad: x is the place's `along`, y its `out`. Angles are a rotation vector. The
 * device begins at zero, at rest, with the tool in the surface.
 */
#ifndef DPT_TOOLS_HAND_LOOP_H
#define DPT_TOOLS_HAND_LOOP_H

#include "dynpoint/loop.h"
#include "dynpoint/passivity.h"
#include "dynpoint/world.h"
#include "lab/hand_place.h"
#include "lab/lab.h"
#include "lab/tissue.h"
#include "scene/scene_passivity.h"
#include "scene/scene_stage.h"

enum { HAND_AXES = 6 };

/*
 * As the settings of "sim" (docs/back_ends.md), with two differences: `weight` is what presses along -y, in N, and the
 * steps of the encoders are taken by the laboratory, so that it sees the true motion. Zero is the driver's default
 * where that is not zero.
 */
struct hand_device {
    int dofs; /* 3 or 6 */
    double mass, damping, friction, step;
    double inertia, turn_damping, turn_friction, turn_step;
    double rate, delay, jitter, loss, doubled, seed, force, torque;
    const char *script; /* of the hand; NULL: there is none, and no grip */
    double grip, turn_grip, hand_damping, weight, reach, cycle;
};

/* A capsule whose axis rises by `tilt` rad from the surface; held at its middle. */
struct hand_tool {
    double length, radius, tilt;
};

/* The state at a sample: where the device truly is, how fast, and what acted since the sample before. */
struct hand_moment {
    double time;
    double at[HAND_AXES], speed[HAND_AXES], sent[HAND_AXES];
    double energy; /* J, of the law, at the hand */
    /* J, that bodies did since the sample before: by the force report, at the hand; by tissue's own loads. */
    double body_work, tissue_work;
};

struct hand_loop {
    /* Given. */
    struct hand_device device;
    const struct hand_place *place; /* NULL: a linear spring and damper at zero instead of a world */
    /* In place of the place's rigid body. While the tool is lowered it stands still. */
    struct tissue *tissue;
    struct spring_body *springs; /* likewise; it stands still until the tool was lowered, once */
    int is_uncounted;            /* hand_loop_choose does not count the delay of its interpolation */
    struct hand_tool tool;
    int method;                                      /* enum lab_method */
    double zoom, force_scale;                        /* 0: 1 */
    double stiffness, rotational_stiffness, damping; /* of the scene */
    const dpt_passivity_def *passivity;              /* NULL: no controller */
    int is_uncredited;                               /* the controller is not told what moving bodies do */
    const dpt_guard_def *guard;                      /* NULL: limits of 1000 N and Nm, no slew, no ramps */
    double push[HAND_AXES];                          /* N and Nm: constant, added to what is sent */
    double tap[HAND_AXES];                           /* Ns and Nms: added to the first command */
    /* Before each step, to move the body, at a time in s; NULL: it rests. */
    void (*move)(struct hand_loop *loop, double time);

    /* Made. */
    struct scene_stage stage; /* its tool is held */
    dpt_body body;
    double origin[3], axes[4]; /* of the hand's coordinates in the scene; unit quaternion */
    dpt_pose body_pose;        /* while `move` moves it */
    double first[HAND_AXES];   /* the law's wrench at zero, at the hand */
    double before[HAND_AXES];  /* where the linear spring was */
    int has_begun;
    struct scene_passivity observer;
    dpt_loop *running;
    struct hand_moment *track;
    size_t count, room;
};

/* Root of the mean squared distance of the tool's points from its middle, m of the hand. */
double hand_loop_rho(const struct hand_loop *loop);

/* Make the world. Returns 0 if memory runs out. */
int hand_loop_open(struct hand_loop *loop);
void hand_loop_close(struct hand_loop *loop);

/* Set the three stiffnesses of the scene for what follows. */
void hand_loop_stiffen(struct hand_loop *loop, double stiffness, double rotational_stiffness, double damping);

/*
 * Lower the tool on to the place until the surface presses it out with `force` N at the hand, and make that pose the
 * hand's zero. Returns 0 if there is no surface, or it presses in another direction than out.
 */
int hand_loop_lower(struct hand_loop *loop, double force);

/* Draw places of a mesh until the tool can be lowered on to one; `place` is that one. Returns 0 after 100 of them. */
int hand_loop_seek(struct hand_loop *loop, const struct hand_mesh *mesh, uint64_t *seed, double force,
                   struct hand_place *place);

/* Lower it once more, to where it was lowered before. Tissue that gives way then has a second to come to rest. */
void hand_loop_return(struct hand_loop *loop);

/* Lift the tool by `height` m of the hand above the lowered pose, and make that pose the hand's zero. */
void hand_loop_lift(struct hand_loop *loop, double height);

/* The law's force on the coordinates, at the hand, after one more step of the world. */
void hand_loop_ask(struct hand_loop *loop, const double at[HAND_AXES], double dt, double wrench[HAND_AXES]);

/* The coupling that the library chooses for the device and the tool; `margin` as in dpt_coupling_def. */
dpt_coupling hand_loop_choose(const struct hand_loop *loop, double margin);

/*
 * Run the servo loop. loop->track has the ticks that saw a sample. A device that goes 0.1 m or 2 rad astray ends it.
 * Returns 0 if the device cannot be opened or memory runs out.
 */
int hand_loop_run(struct hand_loop *loop, uint64_t ticks);

/* The maximum and the minimum of two results; NaN if one is, so that a failed run shows in the figure. */
double hand_max(double a, double b);
double hand_min(double a, double b);

/* What the controller saw in the last run. */
dpt_passivity_info hand_loop_account(const struct hand_loop *loop);

#endif
