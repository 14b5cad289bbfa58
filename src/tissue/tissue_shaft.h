/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A shaft in its channel, in a step of tissue: docs/algorithms/insertion.md. It and the body share points, which are
 * touches that push by rows of their own: two across at each point, and along the line friction, viscous drag, what
 * stops the tip and what it cuts. The last two push only. Lengths along are of the tip, in the channel.
 */
#ifndef DPT_TISSUE_SHAFT_H
#define DPT_TISSUE_SHAFT_H

#include "insertion/channel_points.h"
#include "tissue/tissue_state.h"

/* Touches of a shaft after those of its points: of the mean of these, and of the last one, which is the tip's. */
enum { SHAFT_MEAN = CHANNEL_POINTS_MAX, SHAFT_TIP, SHAFT_TOUCHES };

/* The shaft of a touch, by its number, and which of its touches that is. */
static inline uint32_t shaft_of_touch(const struct touch *touch)
{
    return (touch->shaft - 1) / SHAFT_TOUCHES;
}

static inline uint32_t shaft_touch_kind(const struct touch *touch)
{
    return (touch->shaft - 1) % SHAFT_TOUCHES;
}

/*
 * Add the touches of a tool's channels, in bodies that the solve steps or in the others. The tool is the one that comes
 * next.
 */
void dpti_shafts_gather(struct tissue_solve *solve, const struct touch_search *search, int is_solved);

/* After touches were linked, and before any other rows are added: their rows. */
void dpti_shafts_add_rows(struct tissue_solve *solve);

/* Before a pass: what is known, of shafts that slip and tips that cut; and the gaps. */
void dpti_shafts_set_known(struct tissue_solve *solve);
void dpti_shafts_set_gaps(struct tissue_solve *solve);

/* After a pass: what slips now, or cuts, and did not. Without `may_stick` none begins to stick. 1: another is needed. */
int dpti_shafts_update(struct tissue_solve *solve, int may_stick);

/* After the last pass: known pulls join the multipliers. */
void dpti_shafts_take_pulls(struct tissue_solve *solve);

/* After a substep, of which `share` of the whole is: bristles follow. */
void dpti_shafts_end_substep(struct tissue_solve *solve, double share);

/* After the step: what the world knows of them. Telling it twice changes nothing. */
void dpti_shafts_tell(struct tissue_solve *solve, struct dpt_world *world);

/* J: what the bristles of a tool store. */
double dpti_shafts_stored(const struct tissue_solve *solve, const struct tissue_tool *tool);

/* Whether all of them are in the channels in which they were solved for. */
int dpti_shafts_are_there(const struct tissue_solve *solve, const struct dpt_world *world);

#endif
