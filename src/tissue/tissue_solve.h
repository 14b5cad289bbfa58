/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A step of tissue together with the tools that touch it: SPEC's linear complementarity problem of tools, couplings and
 * tissue, one in each substep. docs/algorithms/tissue.md.
 */
#ifndef DPT_TISSUE_SOLVE_H
#define DPT_TISSUE_SOLVE_H

#include "deform/loaded_step.h"
#include "tissue/touches.h"

enum { TISSUE_NODES_MAX = 1536, TISSUE_TABLE = 4096, TISSUE_BODIES_MAX = 16 };

/* A body whose springs are stepped. */
struct tissue_body {
    uint32_t number; /* the caller's */
    const struct body *body;
    struct loaded_step step;
};

/* A node that a touch loads. */
struct tissue_node {
    uint32_t body; /* of the solve */
    uint32_t node;
    double response; /* m/N, in a substep */
    vec3 begin;      /* where it was before the step, in the body's frame */
    vec3 moved;      /* m: how far from there it would be after the substep, without tools */
    vec3 load;       /* N, of a substep's answer */
    int is_foreseen; /* `moved` is of this substep */
};

/* How a touch loads the tissue. */
struct tissue_link {
    uint32_t body;              /* of the solve, or DPT_NONE: what is touched is stepped by nobody here */
    uint32_t count;             /* of nodes */
    vec3 normal;                /* in the body's frame */
    double stiffness;           /* N/m, of the tool */
    uint32_t node[TOUCH_NODES]; /* of the solve */
    double weight[TOUCH_NODES];
};

/* By what a touch is known again in the next step. */
struct touch_name {
    uint32_t tool_slot, part, body_id, triangle, feature;
};

struct tissue_solve {
    uint32_t body_count;
    uint32_t node_count;
    uint32_t is_full; /* 1: touches or nodes had no room, too many held at one time, or one could be met by no push */
    struct tissue_body bodies[TISSUE_BODIES_MAX];
    struct touches touches;
    struct tissue_link links[COMPLEMENTARITY_MAX];
    struct tissue_node nodes[TISSUE_NODES_MAX];
    uint32_t table[TISSUE_TABLE];    /* one more than a node's number; 0: none */
    double spread[TISSUE_NODES_MAX]; /* how a newton of one touch moves each node; zero between columns */
    double free_gap[COMPLEMENTARITY_MAX];
    double push[COMPLEMENTARITY_MAX]; /* N, of each touch: the mean of all substeps */
    uint32_t held_count;              /* touches that held at the end of the last step */
    struct touch_name held[COMPLEMENTARITY_ACTIVE_MAX];
    struct complementarity problem;
};

/* After touches were gathered and the bodies' steps have begun: links, and the nodes of the touches. */
void dpti_tissue_link(struct tissue_solve *solve, const struct dpt_world *world);

/*
 * Solve for the next substep. Returns how far, m, any touch goes from where it was gathered: its tool, and its point on the
 * tissue, together.
 */
double dpti_tissue_solve(struct tissue_solve *solve);

/* Make the substep that was solved for. Returns 0 if a body would leave the finite range. */
int dpti_tissue_substep(struct tissue_solve *solve);

#endif
