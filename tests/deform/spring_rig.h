/* SPDX-License-Identifier: BSD-3-Clause */
/* Nets of springs that are made in memory, and springs of them. */
#ifndef DPT_TESTS_SPRING_RIG_H
#define DPT_TESTS_SPRING_RIG_H

#include <math.h>

#include "deform/active_region.h"
#include "deform/spring_step.h"
#include "deform/springs_net.h"
#include "lib/check.h"

enum { RIG_LINKS = 32 };

struct rig_spring {
    uint32_t a, b;
    double stiffness, length;
};

/* A net in the making: nodes, then springs, then rig_open. */
struct rig {
    uint32_t nodes, springs, room;
    float *rest, *mass, *drag;
    struct rig_spring *list;
    uint32_t *links, *degree; /* of each node: its springs */
    double viscosity;
    uint32_t *first, *neighbour;
    float *stiffness, *length;
    struct spring_net net;
    void *block;
    dpt_springs *made;
};

uint32_t rig_node(struct rig *rig, double x, double y, double z, double mass);
/* A second spring between the same two nodes makes the first one stiffer. length < 0: as far as they are apart. */
void rig_spring(struct rig *rig, uint32_t a, uint32_t b, double stiffness, double length);
void rig_drag(struct rig *rig, double drag);
void rig_fix(struct rig *rig, uint32_t node);
/* Make the net and springs of it. Returns the code of their creation. */
dpt_result rig_open(struct rig *rig, const dpt_springs_def *def);
/* Other springs of the same net. */
dpt_result rig_reopen(struct rig *rig, const dpt_springs_def *def);
void rig_close(struct rig *rig);

/*
 * A block of cubes with nx x ny x nz nodes, the first at the origin: every cube gives its edges a quarter, and the
 * diagonals of its faces a half, of 0.4 E s, and each of its corners an eighth of its mass. It is isotropic with the
 * Poisson ratio 1/4.
 */
void rig_block(struct rig *rig, uint32_t nx, uint32_t ny, uint32_t nz, double s, double e, double density);

/* Positions and speeds of all nodes; the arrays last until the next call. */
const float *rig_positions(const struct rig *rig);
const float *rig_speeds(const struct rig *rig);

/* Step, and complain if it fails. */
void rig_steps(struct rig *rig, double dt, uint32_t steps);

/* The stiffness matrix of 3 nodes x 3 coordinates at rest, in double, rows of fixed nodes zero; for free(). */
double *rig_matrix(const struct rig *rig);

#endif
