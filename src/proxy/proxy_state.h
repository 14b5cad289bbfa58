/* SPDX-License-Identifier: BSD-3-Clause */
/* The memory of proxies: where it lies, which tools have one, what is forgotten: docs/algorithms/force.md. */
#ifndef DPT_PROXY_STATE_H
#define DPT_PROXY_STATE_H

#include "track/world_state.h"

/* Its share of dpt_world_bytes. */
uint64_t dpti_proxy_bytes(const dpt_world_def *def);

/* Place its memory at `at`; returns where it ends. */
char *dpti_proxy_place(struct dpt_world *world, char *at);

/* 1 if tools with this law have one in this world. */
int dpti_proxy_is_of(const struct dpt_world *world, uint32_t law);

/* 1 if this tool has one. */
int dpti_proxy_is_used(const struct dpt_world *world, const struct tool *tool);

/* Where it is, is not known any more: it starts again at the device's pose. */
void dpti_proxy_forget(struct dpt_world *world, struct tool *tool);

/* What it remembers of a body, by its id, is forgotten. */
void dpti_proxy_forget_body(struct dpt_world *world, uint32_t body);

#endif
