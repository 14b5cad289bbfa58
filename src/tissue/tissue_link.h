/* SPDX-License-Identifier: BSD-3-Clause */
/* Which nodes of the tissue touches load, by how much, and how these loads move them. docs/algorithms/tissue.md. */
#ifndef DPT_TISSUE_LINK_H
#define DPT_TISSUE_LINK_H

#include "tissue/tissue_state.h"

/* After touches were gathered and the bodies' steps have begun: links, and the nodes of the touches. */
void dpti_tissue_link(struct tissue_solve *solve);

/* The number of a body's node in the solve, which is made if there is none; DPT_NONE without room. */
uint32_t dpti_tissue_node(struct tissue_solve *solve, uint32_t body, uint32_t node);

/* How a newton of a touch moves nodes, m, times a share: added to `spread`. And zero again. */
void dpti_tissue_spread_touch(struct tissue_solve *solve, const struct tissue_link *link, double share);
void dpti_tissue_clear_spread(struct tissue_solve *solve, const struct tissue_link *link);

/* m/N: how far its point moves by a force on it. */
double dpti_tissue_compliance(struct tissue_solve *solve, const struct tissue_link *link);

/* How far the point of a touch moves by what is in `spread`. */
static inline double tissue_spread_at(const struct tissue_solve *solve, const struct tissue_link *link)
{
    double sum = 0.0;
    for (uint32_t k = 0; k < link->count; k++)
        sum += link->weight[k] * solve->spread[link->node[k]];
    return sum;
}

/* The answers of nodes to a force on a touch, N, along a vector in the body's frame, are added. */
void dpti_tissue_add_answer(struct tissue_solve *solve, const struct tissue_link *link, double force, vec3 within);

/* What a force along a row that is known, N, does to its tool, or to that and its nodes, is added. */
void dpti_tissue_push_tool(struct tissue_solve *solve, const struct tissue_row *row, double force);
void dpti_tissue_add_known(struct tissue_solve *solve, const struct tissue_row *row, double force);

/* How far the loads of all nodes move them: their answers. Where a shaft alone touches a body, its points know. */
void dpti_tissue_answer(struct tissue_solve *solve);

#endif
