/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A step of tissue together with its tools, whose bodies have no friction and whose tools no damper, by a solver that is
 * slow and obvious: pairs by looking at every triangle and every feature within half a millimetre of the proxy, the
 * problem's matrix in full, sweeps of Gauss and Seidel until the pairs that push meet all conditions. It shares no code with
 * the library's solve. Where nodes go without tools, and with the loads that it finds, is asked of the library's springs,
 * stepped in their own memory with the viscosity that touched tissue has, which is put back.
 *
 * Where loads are spread, a touch feels the patch, and what its own point rises by beyond that only later: brute_solve_tick is
 * for ticks in which there is nothing of that.
 *
 * It cannot judge a tool that reaches no soft body: the library does not solve for that.
 */
#ifndef DPT_TESTS_TISSUE_BRUTE_H
#define DPT_TESTS_TISSUE_BRUTE_H

#include "oracle/hull.h"
#include "world/tissue_rig.h"

enum { BRUTE_PAIRS = 384, BRUTE_NODES = 192, BRUTE_ROOM = 3 * TISSUE_ROOM };

/* m: pairs are as near to the proxy as that. Where a body's own surface yields, a tool that pushes it by so much, N, is met. */
#define BRUTE_NEAR 5e-4
#define BRUTE_PUSH 10.0

struct brute_pair {
    uint32_t tool, body, count; /* of nodes */
    double q[3], n[3], gap;     /* at the proxy, beyond the clearance, by the row; n from q towards the tool */
    double row[6];              /* how the gap grows with a shift, and with a turn times rho */
    uint32_t node[BRUTE_NODES];
    double weight[BRUTE_NODES], response[BRUTE_NODES]; /* m/N */
    double least; /* m: the gap that is asked for: of what is missing when a substep begins, a fifth is made good */
    double free_gap, push; /* beyond the least */
};

struct brute {
    struct tissue_rig *tissue;
    const struct oracle_hull *hull; /* of the first tool; NULL: it is its segment */
    double hull_radius;
    double clearance;   /* m */
    uint32_t substeps;  /* pairs are of surfaces as these are foreseen; 0: as they are */
    double moved[3][3]; /* m: how far the corners of a triangle are foreseen to move */
    dpt_pose proxy[TISSUE_TOOLS];
    double way[TISSUE_TOOLS][6]; /* from the proxy to where the last substep ended */
    uint32_t count;
    struct brute_pair pair[BRUTE_PAIRS];
    double matrix[BRUTE_PAIRS][BRUTE_PAIRS];
    double *begin, *end, *mine;      /* of the nodes of each body, BRUTE_ROOM each */
    double loosest;                  /* m/N: the largest response of a node of a pair */
    dpt_wrench wrench[TISSUE_TOOLS]; /* about the device's origin: the mean of the substeps */
};

/* The scene is empty. `hull` is the first tool's, where that is a tip. Returns 0 without memory; close it in any case. */
int brute_open(struct brute *brute, struct tissue_rig *tissue);
void brute_close(struct brute *brute);

/* After the world's step: what the springs' step should answer. Nodes end in brute->mine; the springs are as before. */
void brute_solve_tick(struct brute *brute, uint32_t substeps);

/* Whether a tool is held back from its device as the tick begins: springs without viscosity then have some. */
int brute_is_touched(const struct tissue_rig *tissue);

/* All pairs of the tools at `proxy`, as near as BRUTE_NEAR. */
void brute_find_pairs(struct brute *brute);

/* Of all pairs, by their free gaps and the matrix: pushes >= 0 whose gaps are >= 0, with one or the other zero. */
void brute_solve_pairs(struct brute *brute);

/* Where all nodes are, and where EULER's speeds lead them in a substep more: a load moves nodes in the step after it. */
void brute_read_nodes(const struct tissue_rig *tissue, double *at);
void brute_add_speeds(const struct tissue_rig *tissue, double h, double *at);

/* Without what is about a segment's own axis: it has no turn there, and no spring. */
void brute_without_spin(const struct brute *brute, uint32_t tool, double turn[3]);

/* The shift of the tool's centre, and its turn times rho, from the proxy to a pose. */
void brute_way_to(const struct brute *brute, uint32_t tool, const dpt_pose *pose, double way[6]);

/* How the surface goes at a pair, along its normal. */
double brute_surface_motion(const struct brute_pair *pair, const double *from, const double *to);

static inline double brute_product(const double *a, const double *b)
{
    return dot3(a, b) + dot3(a + 3, b + 3);
}

#endif
