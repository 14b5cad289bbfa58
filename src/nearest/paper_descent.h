/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The dynamic point of Maciel and De (2008), as docs/algorithms/paper.md reads it: it moves from last tick's triangle
 * to a nearer neighbour until none is nearer. It can end in a local minimum; that is the method.
 */
#ifndef DPT_PAPER_DESCENT_H
#define DPT_PAPER_DESCENT_H

#include "nearest/bvh.h"

/*
 * Steepest descent over triangles that share a vertex. Each move goes to a strictly nearer triangle. Of equally near
 * neighbours the one that shares two vertices wins, then the one with the lower source number.
 *
 *   a, u      the axis a + s u, in the mesh's frame
 *   one_step  1: move at most once
 *   nearest   in: nearest->triangle, by its place, is where to start. out: triangle and pair where the descent ended
 */
void dpti_paper_descend(const struct surface *surface, const struct kernel *kernel, vec3 a, vec3 u, int one_step,
                        struct work *work, struct pair_search *nearest);

#endif
