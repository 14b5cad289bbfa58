/* SPDX-License-Identifier: BSD-3-Clause */
/* A straight tool that is led by one method over the bodies of a case, tick by tick, and what its force did. */
#ifndef DPT_TOOLS_LAB_LEAD_H
#define DPT_TOOLS_LAB_LEAD_H

#include "lab/force_lead.h"
#include "lab/lab.h"

#define LAB_STIFFNESS 500.0 /* N/m: of every tool */
#define LAB_LENGTH    0.1   /* m, unless a case says otherwise */
#define LAB_RADIUS    0.002

/* rad */
#define LAB_DEGREE 0.017453292519943295

enum { LAB_BODIES = 2, LAB_PIECES_MAX = 8 };

/* The tool, its method and the bodies. A zero selects the default. */
struct lab_lead_def {
    int method;
    const dpt_mesh *meshes[LAB_BODIES]; /* NULL: no more bodies */
    const double *middle;               /* where the bodies' frames are; NULL: at the origin */
    double length, radius;
    uint32_t pieces;   /* segments of the same length that the tool consists of */
    uint32_t budget;   /* of a tick */
    double side_limit; /* of the bodies, m */
    int lock_rotation;
};

/* Statistics of the force. The ticks of lab_lead_start are not counted. */
struct lab_tally {
    uint64_t ticks;                 /* since the start */
    uint64_t acting;                /* with a force */
    uint64_t turns;                 /* off folds, by more than 30 degrees */
    uint64_t reversals;             /* by more than 90 */
    double turning;                 /* rad: all turns of the force, off folds */
    uint64_t folds, replaced;       /* that the force report flags */
    uint64_t unknown;               /* without a force, as contact was not known */
    uint64_t in_mesh;               /* whose proxy is in a body */
    uint64_t lagging;               /* whose lag is above 1 % of |p - d| */
    uint64_t not_finite;            /* with a force or torque that is no number */
    double jump, torque_jump;       /* the largest in a tick, N, Nm */
    double drop;                    /* the largest loss of force in a tick, N */
    double share;                   /* of |dW| in K (3 |motion| + v_max dt), the largest */
    uint64_t shallow;               /* ticks whose W is at most K r / 5 */
    double gain;                    /* |dW| over K |motion| in these, the largest */
    double largest, largest_torque; /* N, Nm */
    double gap_min;                 /* of the proxy, m */
};

struct lab_lead {
    struct force_trial_def def;
    struct force_lead lead; /* def is the one above */
    const dpt_mesh *meshes[LAB_BODIES];
    double middle[3];
    double slack; /* m: what the proxy's clearance leaves open */
    int method;
    uint32_t work; /* units of the last tick */
    struct lab_tally tally;
};

/* Where memory runs out it sets lab->is_out_of_memory, and returns 0. lab_lead_close is due in any case. */
int lab_lead_open(struct lab *lab, struct lab_lead *lead, const struct lab_lead_def *def);
void lab_lead_close(struct lab_lead *lead);

/* 1 if the method is a proxy: of the tool, or of its tip. */
static inline int lab_has_proxy(int method)
{
    return method == LAB_PROXY || method == LAB_BALL;
}

/* Put the device's tip, end a, at x, pointing along an axis to end b. The tremor is added. */
void lab_lead_aim(struct lab_lead *lead, const double *x, const double *axis);

/* A teleport to the device. Then the tally begins anew. */
void lab_lead_start(struct lab_lead *lead);

/* A tick to the device, and its tally. */
void lab_lead_step(struct lab_lead *lead);

/* One of both: what the first tick of a path, and every other one, does. */
static inline void lab_lead_tick(struct lab_lead *lead, int is_first)
{
    (is_first ? lab_lead_start : lab_lead_step)(lead);
}

/* The next of a tremor of 0.2 mm, for lab_lead_aim. */
void lab_lead_shake(struct lab_lead *lead);
void lab_lead_calm(struct lab_lead *lead);

/* The force of the last tick, N. */
static inline const double *lab_lead_force(const struct lab_lead *lead)
{
    return lead->lead.force.wrench.force;
}

/* What force_test leads: the needle of a method over a mesh. Of BALL the ball at its end. */
struct force_trial_def lab_trial_def(int method, const dpt_mesh *mesh);

/* A share in per cent; 0 if the whole is 0. */
double lab_per_cent(uint64_t part, uint64_t whole);

/* What one method did in all of a case's leads. */
void lab_tally_add(struct lab_tally *sum, const struct lab_tally *tally);

/*
 * Note the figures that bound every proxy, and those that compare methods: turns, the largest change of force, ticks in
 * the mesh, folds.
 */
void lab_tally_note(struct lab *lab, int method, const struct lab_tally *tally);

/* Over convex bodies besides: |dW| over K |motion| in shallow ticks, if there were some. */
void lab_tally_note_convex(struct lab *lab, int method, const struct lab_tally *tally);

#endif
