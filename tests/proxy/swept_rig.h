/* SPDX-License-Identifier: BSD-3-Clause */
/* A rig whose proxy is swept in each tick, as those of tools are that have no patch (docs/algorithms/patch.md). */
#ifndef DPT_SWEPT_RIG_H
#define DPT_SWEPT_RIG_H

#include "lib/rig.h"

/* Use no patch for the first tool of a rig, from now on. */
void rig_use_sweeps(const struct rig *rig);

#endif
