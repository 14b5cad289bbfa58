/* SPDX-License-Identifier: BSD-3-Clause */
/* Nets of springs that are made in memory, and springs of them. */
#ifndef DPT_TESTS_MADE_NET_H
#define DPT_TESTS_MADE_NET_H

#include <math.h>

#include "deform/active_region.h"
#include "deform/spring_step.h"
#include "deform/springs_net.h"
#include "lib/check.h"

enum { NET_LINKS = 32 };

struct net_spring {
    uint32_t a, b;
    double stiffness, length;
};

/* A net in the making: nodes, then springs, then net_open. */
struct made_net {
    uint32_t nodes, springs, room;
    float *rest, *mass, *drag;
    struct net_spring *list;
    uint32_t *links, *degree; /* of each node: its springs */
    double viscosity;
    double poisson; /* of net_block, set before; 0: 1/4, springs alone */
    uint32_t cells; /* with a term for their volume */
    uint32_t (*corners)[8];
    double *cell_stiffness, cell_size;
    uint32_t *cell_nodes; /* as the file has them */
    float *cell_k;
    uint32_t *first, *neighbour;
    float *stiffness, *length;
    struct spring_net rows;
    void *block;
    dpt_springs *made;
};

uint32_t net_node(struct made_net *net, double x, double y, double z, double mass);
/* A second spring between the same two nodes makes the first one stiffer. length < 0: as far as they are apart. */
void net_spring(struct made_net *net, uint32_t a, uint32_t b, double stiffness, double length);
void net_drag(struct made_net *net, double drag);
void net_fix(struct made_net *net, uint32_t node);
/* Make the net and springs of it. Returns the code of their creation. */
dpt_result net_open(struct made_net *net, const dpt_springs_def *def);
/* Other springs of the same net. */
dpt_result net_reopen(struct made_net *net, const dpt_springs_def *def);
void net_close(struct made_net *net);

/*
 * A block of cubes with nx x ny x nz nodes, the first at the origin: every cube gives its edges a quarter, and the
 * diagonals of its faces a half, of the shear modulus times s, and each of its corners an eighth of its mass. It is
 * isotropic with the Poisson ratio 1/4, or with another one by the terms of cells.
 */
void net_block(struct made_net *net, uint32_t nx, uint32_t ny, uint32_t nz, double s, double e, double density);

/* Positions and speeds of all nodes; the arrays last until the next call. */
const float *net_positions(const struct made_net *net);
const float *net_speeds(const struct made_net *net);

/* Step, and complain if it fails. */
void net_steps(struct made_net *net, double dt, uint32_t steps);

/*
 * J: the energy of the term of a cell's volume, in double: V (p d(v)) of docs/algorithms/springs.md. x: 8 corners, 3
 * coordinates each.
 */
double net_cell_energy(const struct made_net *net, uint32_t cell, const double x[24]);

/* N, 3 a node: what springs and cells do to nodes at these places; of cells by differences of their energy. */
void net_forces(const struct made_net *net, const float *x, double *force);

/* m3: a cell's volume between 12 triangles. */
double net_cell_volume(const struct made_net *net, uint32_t cell, const float *x);

/* Whether a cell is turned inside out at any of its eight corners. */
int net_cell_is_turned(const struct made_net *net, uint32_t cell, const float *x);

/* The stiffness matrix of 3 nodes x 3 coordinates at rest, in double, rows of fixed nodes zero; for free(). */
double *net_matrix(const struct made_net *net);

#endif
