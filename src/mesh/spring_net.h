/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Masses and springs as a file holds them and as the solver reads them (docs/algorithms/springs.md).
 *
 * A spring stands in the rows of both of its nodes. 16 consecutive nodes make a slice. An entry of a slice has one
 * spring for each of its nodes, 16 lanes side by side (a sliced ELL format). A row's neighbours ascend. Where a node has
 * no spring in an entry, it is its own neighbour there, with stiffness 0 and length 1; so are lanes beyond the last node.
 */
#ifndef DPT_SPRING_NET_H
#define DPT_SPRING_NET_H

#include <stdint.h>

struct spring_net {
    uint32_t nodes;
    uint32_t slices;           /* (nodes + 15) / 16 */
    uint32_t springs;          /* each counted once */
    const float *rest;         /* 3 a node: where it is at rest, in the body's frame, m */
    const float *mass;         /* 1 a node: kg; 0: it is fixed */
    const float *drag;         /* 1 a node: 1/s, of its motion against the body's frame */
    const uint32_t *first;     /* 1 a slice and one more: its first entry */
    const uint32_t *neighbour; /* 16 an entry: nodes */
    const float *stiffness;    /* 16 an entry: N/m */
    const float *length;       /* 16 an entry: of the spring at rest, m */
    double viscosity;          /* s: the damping of a spring is that times its stiffness */
    double square;             /* 1/s^2: no squared frequency is higher, the file says; 0: it does not */
    /* Cells whose volume has a term beside the springs, 16 a slice. A lane beyond the last has stiffness 0. */
    uint32_t cells;              /* 0: there are none */
    uint32_t cell_slices;        /* (cells + 15) / 16 */
    const uint32_t *cell_nodes;  /* 8 rows of 16 a slice: corners of cubes; bit k of a corner's number is axis k */
    const float *cell_stiffness; /* 16 a slice: shear modulus times size, N/m */
    double cell_size;            /* of a cube's edge at rest, m */
    double poisson;              /* Poisson's ratio, CELL_POISSON_MIN to CELL_POISSON_MAX */
};

/* Springs alone have a Poisson's ratio of 1/4. */
#define CELL_POISSON_MIN 0.1
#define CELL_POISSON_MAX 0.45

/*
 * How fast a cell's pressure grows with its volume, by the shear modulus: about its volume at rest, so that both Lame's
 * constants are the material's; and below cell_turn, faster: a material that hardly shrinks shrinks less, as springs do
 * less the more they are pressed, and another one does not turn inside out.
 */
static inline double cell_slope(double poisson)
{
    return 2.0 * poisson / (1.0 - 2.0 * poisson) - 1.0;
}

static inline double cell_turn_slope(double poisson)
{
    return 1.25 * cell_slope(poisson) > 2.0 ? 1.25 * cell_slope(poisson) : 2.0;
}

static inline double cell_turn(double poisson)
{
    return 1.25 * cell_slope(poisson) > 2.0 ? 0.984375 : 0.75;
}

/*
 * No direction of a cell's mean edges is stiffer than this times the second slope, in any configuration; springs along
 * its face diagonals that are by `cell_bound` of its stiffness as stiff bound its term ("The stable step").
 */
#define CELL_STIFFEST 4.3

static inline double cell_bound(double poisson)
{
    return 0.125 * CELL_STIFFEST * cell_turn_slope(poisson);
}

#endif
