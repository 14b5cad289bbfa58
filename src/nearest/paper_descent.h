/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The dynamic point of Maciel and De (2008), as docs/algorithms/paper.md reads it: from last tick's
 * triangle to a neighbour that is nearer, until none is. Local minima hold it; that is the method.
 */
#ifndef DPT_PAPER_DESCENT_H
#define DPT_PAPER_DESCENT_H

#include "nearest/bvh.h"

/*
 * Steepest descent over triangles that share a vertex, strictly nearer each time. Equal neighbours: the
 * one that shares two vertices, then the lower source number. With `one_step`, one move at most.
 * nearest->triangle is where to start; nearest is where it ended, its pair for the axis a + s u.
 */
void dpti_paper_descend(const struct surface *surface, const struct kernel *kernel, vec3 a, vec3 u,
                        int one_step, struct work *work, struct pair_search *nearest);

#endif
