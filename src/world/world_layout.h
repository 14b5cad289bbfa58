/* SPDX-License-Identifier: BSD-3-Clause */
/* What a world's block holds, and where. */
#ifndef DPT_WORLD_LAYOUT_H
#define DPT_WORLD_LAYOUT_H

#include "track/world_state.h"

/* dpt_world_bytes of a valid def. */
size_t dpti_world_layout_bytes(const dpt_world_def *def);

/* The arrays of a world whose def is set, in its block, which is all zeros. */
void dpti_world_layout_place(struct dpt_world *world);

#endif
