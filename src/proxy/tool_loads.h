/* SPDX-License-Identifier: BSD-3-Clause */
/* What tools do to deformable bodies: docs/algorithms/deform.md. In worlds without such bodies nothing is noted. */
#ifndef DPT_TOOL_LOADS_H
#define DPT_TOOL_LOADS_H

#include "proxy/proxy_tick.h"

/* Note where a proxy is held, at the end of its tick. */
void dpti_loads_note_proxy(struct proxy_tick *tick);

/* Note where the segments of a tool without a proxy are pushed. */
void dpti_loads_note_segments(struct dpt_world *world, struct tool *tool);

/* After the tool's wrench is known: what its points sum up to on each body is the reaction to it. */
void dpti_loads_settle(struct dpt_world *world, struct tool *tool);

#endif
