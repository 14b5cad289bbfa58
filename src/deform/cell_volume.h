/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The terms of cells' volumes beside the springs (docs/algorithms/springs.md, "Cells keep their volume"). What cells pull
 * is asked for all of them first; then each node sums up what its own cells do, in the order of their corners.
 */
#ifndef DPT_CELL_VOLUME_H
#define DPT_CELL_VOLUME_H

#include "deform/spring_state.h"

/* How many slices of nodes the slices of cells have corners in, summed up. */
uint64_t dpti_cells_corner_slices(const struct spring_net *net);

/* Fill in what does not change. There are cells. */
void dpti_cells_begin(struct dpt_springs *springs);

/* List the slices of cells with a corner that is awake, from the slices of nodes that are. Without cells: nothing. */
void dpti_cells_list(struct dpt_springs *springs);

/* What the cells in that list pull, with nodes at the points; the second notes their energy as well. */
void dpti_cells_pull(struct dpt_springs *springs, const float *points);
void dpti_cells_pull_energy(struct dpt_springs *springs, const float *points);

/* Add it to the force on a slice of nodes that is awake. */
void dpti_cells_add(const struct dpt_springs *springs, uint32_t slice, float force[SPRING_ROWS]);

/* J: the energy of a slice of cells, in double. */
double dpti_cells_elastic(const struct dpt_springs *springs, uint32_t slice);

#endif
