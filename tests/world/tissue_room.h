/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Where a step of tissue should leave a tool: from where its pushes put it, it gives way to the surfaces as they are after
 * the step. By all pairs of tissue_brute.h, and its slow solver.
 */
#ifndef DPT_TESTS_TISSUE_ROOM_H
#define DPT_TESTS_TISSUE_ROOM_H

#include "world/tissue_brute.h"

/*
 * After the springs' step: `way` is from the proxy of brute_solve_tick to where the pushes put the tool. The brute's pairs
 * are lost. `motion`, m: how far it gives way.
 */
dpt_pose room_of_end(struct brute *brute, uint32_t tool, const double way[6], double *motion);

#endif
