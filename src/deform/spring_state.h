/* SPDX-License-Identifier: BSD-3-Clause */
/* The state of springs between steps (docs/algorithms/springs.md). */
#ifndef DPT_SPRING_STATE_H
#define DPT_SPRING_STATE_H

#include "dynpoint/springs.h"
#include "kernel/kernel_ops.h"
#include "mesh/spring_net.h"

/* m/s: a state with a faster node is refused. */
#define SPRING_FAST 1e9

/* N: a larger load is refused. */
#define SPRING_LOAD_MAX 1e9

/* The loads of a step: a row of 16 x, y, z a slice; zero but in the slices that are listed. */
struct spring_loads {
    float *force;
    uint8_t *marked; /* 1 a slice */
    uint32_t *slices;
    uint32_t count;
};

/* What IMPLICIT solves with; rows of 48 a slice, directions are points. */
struct spring_solve {
    struct spring_system *systems;
    float *force, *product;
    float *direction;
    uint8_t *is_near; /* 1 a slice: the answer to the loads reaches it */
    uint32_t *near;   /* those */
    uint32_t near_count;
    float *stiffness;           /* 16 a slice: the sum over a node's springs */
    struct spring_slice *begin; /* where a step of several substeps began */
    double *energy;             /* 1 a slice: of its nodes, when it was last stepped */
    double step;                /* for which the diagonals were made; 0: none */
    double min_norm;            /* J: a residual whose norm is no larger has converged */
    double account;             /* J: a proven upper bound of the energy; below 0: not known */
    int is_free;                /* 1: no node is fixed */
    double common[3];           /* m/s2: the common acceleration of all nodes awake in the last step, without drag */
};

/* The terms of cells' volumes (cell_volume.h); all 0 where there are none. */
struct cell_volumes {
    struct spring_cells cells;
    float *pulls;     /* 4 points a cell, and one more that is zero */
    uint32_t *places; /* 8 rows of 16 a slice of nodes: where their cells' pulls are */
    uint32_t *first;  /* 1 a slice of cells and one more: its first in `slices` */
    uint32_t *slices; /* those of its corners */
    uint32_t *active; /* slices of cells with a corner that is awake, ascending */
    uint32_t count;
    float *bound; /* 16 an entry, N/m: stiffness of springs that are nowhere softer than springs and volumes together */
    double *energy; /* of IMPLICIT, 1 a slice of cells, J: when it was last asked */
};

/* Which slices are stepped. */
struct active_region {
    uint32_t *slices; /* those awake, ascending */
    uint32_t count;
    uint8_t *is_awake;    /* 1 a slice */
    uint8_t *is_fixed;    /* 1 a slice: all of its nodes are */
    uint16_t *quiet;      /* 1 a slice: for how many steps it has been slow */
    float *square;        /* 1 a slice: the largest squared speed after the last step */
    float *drag;          /* 1 a slice: the largest of its nodes */
    uint32_t *first;      /* 1 a slice and one more: its first in `neighbours` */
    uint32_t *neighbours; /* slices that springs lead to */
    uint8_t *is_told;     /* 1 a slice: `told` is set, the positions when a neighbour may have fallen asleep */
    float *told;          /* rows of 48 a slice */
    float *held;          /* rows of 48 a slice: the load with which it fell asleep */
};

/* Nodes on tools (spring_contact.h); 1 a slice, NULL where the net is no mesh's. */
struct spring_contact {
    uint16_t *fixed; /* bits of the nodes that count as fixed because they lie on a tool that does not move */
    uint16_t *next;  /* those of the step to come; only in slices that are awake */
    uint8_t *moved;  /* 1: tools have moved nodes since the last step */
    uint32_t tools;  /* that touched in the last step */
};

/* The mesh's vertices; all NULL where the net is no mesh's. */
struct spring_vertices {
    const uint32_t *nodes; /* of the embedding; NULL: vertices are the nodes */
    const float *weights;
    uint32_t *first; /* of an embedding, 1 a group and one more: its first slice in `slices` */
    uint32_t *slices;
    uint8_t *moved;     /* 1 a slice: it was stepped since vertices were gathered */
    uint32_t has_moved; /* one of them was */
    float *points;      /* of an embedding: 4 a node, where it was when vertices were gathered */
    uint32_t *list;     /* those that were gathered */
    float *positions;
    dpt_load *loads; /* max_loads: what tools do to vertices */
};

struct dpt_springs {
    struct spring_net net;
    dpt_springs_def def;
    struct kernel kernel;
    struct spring_rows rows;
    struct spring_rows bound; /* the same, with the stiffness that bounds cells' terms as well */
    struct cell_volumes volumes;
    double square;      /* 1/s2: a bound of all squared frequencies */
    double stable_step; /* s */
    double lead;        /* s: points are the nodes' positions after it; this models viscosity */
    struct spring_nodes *nodes;
    struct spring_slice *state[2];
    uint32_t now; /* which of the states is the last step's */
    float *points[2];
    uint32_t at;        /* which of the points are those of the state */
    float *forces;      /* of SYMPLECTIC and EULER: rows of 48 a slice, in a substep that is foreseen */
    uint8_t *is_forced; /* 1 a slice: they are known */
    struct spring_loads loads[2];
    uint32_t loaded; /* which of the loads are the last step's */
    struct active_region region;
    struct spring_solve solve;
    struct spring_vertices vertices;
    struct spring_contact contact;
    dpt_result result; /* of the last step with a world: DPT_OK, or why its body was held */
};

/* The sum of 16 lanes, in a fixed order. */
static inline double spring_sum(const double lanes[LANES])
{
    double sum[LANES];
    for (int i = 0; i < LANES; i++)
        sum[i] = lanes[i];
    for (int half = LANES / 2; half; half /= 2)
        for (int i = 0; i < half; i++)
            sum[i] += sum[i + half];
    return sum[0];
}

#endif
