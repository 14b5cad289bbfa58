/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What rows of a shaft do to nodes, in a step of tissue: docs/algorithms/insertion.md. A row loads points of the channel,
 * one or some of them by their shares, and feels how far these move. So nodes are asked once a point. Where a shaft alone
 * touches a body, what a newton on one point does to the others is all that is needed.
 */
#ifndef DPT_SHAFT_POINTS_H
#define DPT_SHAFT_POINTS_H

#include "tissue/tissue_state.h"

/* A column of the solve's matrix, of a row of a shaft. */
void dpti_shafts_give_column(struct tissue_solve *solve, uint32_t index, uint32_t first, double *column);

/* How far the point of a row of a shaft moves by what is in `spread`. */
double dpti_shaft_spread_at(const struct tissue_solve *solve, const struct tissue_row *row);

/*
 * The same, which is a newton of a touch that is of no shaft. Before that is spread: what such touches and shafts do to
 * each other is found, once.
 */
double dpti_shaft_moved_by(const struct tissue_solve *solve, const struct tissue_row *row, uint32_t touch);
void dpti_shafts_find_beside(struct tissue_solve *solve);

/* Before a pass: no force is known. Then what a force along a row, N, does to tool and points; after all, to nodes. */
void dpti_shafts_forget_known(struct tissue_solve *solve);
void dpti_shaft_push(struct tissue_solve *solve, const struct tissue_row *row, double force);
void dpti_shafts_push_nodes(struct tissue_solve *solve);

/* How far points would go with what is known. Then that of a row, in the body's frame. */
void dpti_shafts_find_moved(struct tissue_solve *solve);
vec3 dpti_shaft_moved(const struct tissue_solve *solve, const struct tissue_row *row);

/* After multipliers were found: what rows of shafts load nodes with is added to their loads. */
void dpti_shafts_load_nodes(struct tissue_solve *solve);

/* m: how far what touches along shafts has come apart since touches were gathered, at most. */
double dpti_shafts_farthest(const struct tissue_solve *solve);

#endif
