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
};

#endif
