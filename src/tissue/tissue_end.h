/* SPDX-License-Identifier: BSD-3-Clause */
/* Where tools are at the end of a step of tissue, which is where their proxies go first in the next tick. */
#ifndef DPT_TISSUE_END_H
#define DPT_TISSUE_END_H

#include "tissue/tissue_state.h"

/* After the last substep: where each tool's spring holds it. Or, if the step is undone, where it was before. */
void dpti_tissue_end(struct tissue_solve *solve, struct dpt_world *world);
void dpti_tissue_unend(struct tissue_solve *solve, struct dpt_world *world);

/*
 * After the surfaces have moved: ends of tools give way to what the solve took as flat. There proxies are free in the next
 * tick.
 */
void dpti_tissue_settle(struct tissue_solve *solve, struct dpt_world *world);

/*
 * After that: whether each tool has a free way to its end, straight and in the time in which the surfaces move. Only where a
 * surface has moved farther than the tool is thick, and than it goes, is that looked at; what it takes is counted.
 */
int dpti_tissue_ways_are_free(struct tissue_solve *solve, struct dpt_world *world);

#endif
