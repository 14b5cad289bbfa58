/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The vertices that follow the nodes of springs: the nodes themselves, or embedded in them
 * (docs/algorithms/springs.md). Vertices are taken in groups of 16, as a surface takes them (surface_motion.h). Groups
 * that follow only sleeping slices are left alone.
 */
#ifndef DPT_SPRING_VERTICES_H
#define DPT_SPRING_VERTICES_H

#include "deform/spring_state.h"

/* The number of pairs of a group and a slice that it follows; 0 where vertices are the nodes. */
uint64_t dpti_spring_links(const struct dpt_mesh *mesh);

/* Fill in which slices each group follows. The arrays of springs->vertices must exist. */
void dpti_spring_vertices_begin(struct dpt_springs *springs);

/* Note that slices which are awake are about to move. */
void dpti_spring_vertices_note(struct dpt_springs *springs);

/*
 * Gather the vertices whose nodes have moved since the last call: numbers into vertices.list, ascending, positions into
 * vertices.positions. If most have moved, gather all, without a list. Returns their number.
 */
uint32_t dpti_spring_vertices_gather(struct dpt_springs *springs);

/* Whether dt is a step's length, and a report can be used. In springs.c. */
dpt_result dpti_springs_check_step(double dt, const dpt_springs_info *info);

#endif
