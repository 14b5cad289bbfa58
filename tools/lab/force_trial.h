/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Motions that break a force law, and their results: docs/algorithms/force.md says which bound holds for what.
 * Forces are before all limits. A tool of one segment is led over one mesh.
 */
#ifndef DPT_TOOLS_FORCE_TRIAL_H
#define DPT_TOOLS_FORCE_TRIAL_H

#include "dynpoint.h"

struct force_trial_def {
    const dpt_mesh *mesh;
    uint32_t law;
    double stiffness; /* N/m */
    double friction;  /* of the mesh, for the proxy */
    double length;    /* of the tool, m; 0: a ball at the needle's end */
    double radius;
    double depth;    /* that the device is pushed in, m */
    double through;  /* likewise, of the needle that is held through the mesh */
    double speed;    /* m/s */
    uint64_t places; /* where on the mesh it is tried */
    uint64_t paths;  /* closed ones */
    uint64_t seed;
    uint64_t contacts;   /* dpt_world_def.max_contacts */
    double low_pass;     /* s: of the first-order low-pass behind the law; 0: none */
    dpt_result *failure; /* gets the result of the first tick that fails; NULL: nobody asks */
    void (*show)(void *user, const char *part, double done); /* is told how much of a part is done; NULL: nobody asks */
    void *user;
};

/*
 * Of needles that are pushed in at a place, upright to lying, and led along there with a tremor.
 *
 * A fold is the mesh's: the minimum that the proxy followed has vanished (docs/algorithms/force.md). Its ticks are those
 * that report it, and those after them until the proxy has arrived: one that began the tick with a lag above 1 %.
 */
struct push_result {
    uint64_t ticks;        /* with a force, or that ought to have one */
    uint64_t turns;        /* the force turned by more than 30 degrees, and no fold was under way */
    uint64_t reversals;    /* likewise, by more than 90 degrees */
    uint64_t folds;        /* ticks that reported one */
    uint64_t fold_pushes;  /* ticks with a fold under way that made |W| grow by more than K |motion|; FOLD_PUSH */
    uint64_t jumps;        /* |dW| above K (3 |motion| + v_max dt), with a fold or without */
    uint64_t lagging;      /* lag above 1 % of |p - d|, and no fold was under way */
    uint64_t penetrations; /* the proxy's surface was nearer than 0 to the mesh */
    uint64_t unknown;      /* ticks without a force because contact was not known */
    double largest_jump;   /* N, of the force in a tick */
    double largest_share;  /* |dW| over K (3 |motion| + v_max dt) */
    double gap_min;        /* m, of the proxy's surface */
    double us_median;      /* microseconds that a tick with a force took */
    double us_p99;
};

/* Of needles that begin inside, held through the mesh or not: they are to feel nothing until they were outside. */
struct inside_result {
    uint64_t places; /* that are inside */
    uint64_t felt;   /* ticks before it was outside whose reason was not that, or that had a force */
};

/* Of a needle that is pushed in and shaken as a hand's tremor does: how far the force is behind the device. */
struct delay_result {
    uint64_t places; /* where the force changed */
    double ticks;    /* at the best fit of the changes of both; 60 if nothing fits */
};

/* Of closed paths from the open into the mesh and back. */
struct path_result {
    uint64_t paths;     /* that had a force */
    uint64_t emitting;  /* that gave more than 0.1 % of the range of their energy */
    double emitted_max; /* share of the range */
    double lost_max;    /* likewise, of paths without a fold */
};

/* 0 where memory ran out or the mesh is too small. */
int force_trial_push(const struct force_trial_def *def, struct push_result *result);
int force_trial_inside(const struct force_trial_def *def, struct inside_result *result);
int force_trial_delay(const struct force_trial_def *def, struct delay_result *result);
int force_trial_paths(const struct force_trial_def *def, struct path_result *result);

/* The needle that is held through the mesh: it sticks out on both sides, and its depth is `through`. */
struct force_trial_def force_trial_through_def(const struct force_trial_def *def);

/* As force_trial_push: that needle is pushed in from outside, tip first to lying, and held there with a tremor. */
int force_trial_through(const struct force_trial_def *def, struct push_result *result);

#endif
