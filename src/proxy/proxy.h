/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The proxy of a tool: the pose that has gone through nothing, led by the device's and coupled to it by a spring.
 * docs/algorithms/force.md.
 *
 * A free tool of one segment is kept in a frame of its own, with end a at the origin and end b on the x axis. That
 * frame's pose is tool->pose.
 */
#ifndef DPT_PROXY_H
#define DPT_PROXY_H

#include "track/world_state.h"

/* Its share of dpt_world_bytes. */
uint64_t dpti_proxy_bytes(const dpt_world_def *def);

/* Place its memory at `at`; returns where it ends. */
char *dpti_proxy_place(struct dpt_world *world, char *at);

/* The proxy of a tool. Only in worlds that respond. */
static inline struct proxy *proxy_of(const struct dpt_world *world, const struct tool *tool)
{
    return &world->proxies[tool - world->tools];
}

/* 1 if tools with this law have one in this world. */
int dpti_proxy_is_of(const struct dpt_world *world, uint32_t law);

/* 1 if this tool has one. */
int dpti_proxy_is_used(const struct dpt_world *world, const struct tool *tool);

/* Restart the proxy at the device's pose. */
void dpti_proxy_forget(struct dpt_world *world, struct tool *tool);

/* Forget the triangles of a body, by its id, and what friction keeps of it. Returns 1 if there were any. */
int dpti_proxy_forget_triangles(struct proxy *proxy, uint32_t body);

/* Forget what proxies remember of a body that goes, by its id. One that it held is released. */
void dpti_proxy_forget_body(struct dpt_world *world, uint32_t body);

/* What a free tool with a proxy was given last, in the world. The world's own segment may be smaller. */
dpt_segment dpti_proxy_given_segment(const struct dpt_world *world, const struct tool *tool);

/*
 * Make a tool free or rigid: its proxy restarts at the device's pose. The segment last given then lies in its own
 * frame, at the identity pose.
 */
void dpti_proxy_set_free(struct dpt_world *world, struct tool *tool, uint32_t is_free);

/* The one segment of a free tool, in the world: its pose is end a, and the least turn from where it pointed. */
void dpti_proxy_set_segment(struct dpt_world *world, struct tool *tool, const dpt_segment *segment);

/* Length and radius of a free tool follow what was given, as far as the proxy's gap has room for them. */
void dpti_proxy_follow_size(struct dpt_world *world, const struct tool *tool, struct proxy *proxy);

/* 1 if length and radius have reached what was given, or the tool is rigid. */
int dpti_proxy_has_size(const struct dpt_world *world, const struct tool *tool);

/* m: contacts hold a proxy so far away from surfaces. */
double dpti_proxy_clearance(const struct dpt_world *world);

/* Remember a triangle of a body, by its place. If memory is full, the least recently used one is dropped. */
void dpti_proxy_remember(struct proxy *proxy, uint32_t segment, uint32_t body, uint32_t triangle);

/* Call after a body was added or teleported: proxies near it are no longer known to be outside of it. */
void dpti_proxy_note_body(struct dpt_world *world, uint32_t slot);

/* The proxy is put, or doubted: its home is where its last step left it, if it was anywhere. */
void dpti_proxy_leave(struct proxy *proxy);

/* One tick of `dt`: the proxy follows the device; nearest pairs of the tool's segments are those at the proxy then. */
void dpti_proxy_step(struct dpt_world *world, struct tool *tool, double dt);

/*
 * After contact: find out whether a placed or doubted proxy is outside of everything, and on the side of all surfaces on
 * which it was at home.
 */
void dpti_proxy_settle(struct dpt_world *world, struct tool *tool);

/* Whether a tool has a proxy that is not where its device is. */
int dpti_proxy_is_away(const struct dpt_world *world, const struct tool *tool);

/* Note where the device has the segments of a tool that is held away from it. */
void dpti_proxy_note_device(const struct dpt_world *world, const struct tool *tool);

/* Write their hits there, among the bodies as they were in the last step: none was added, removed or teleported since. */
void dpti_proxy_write_hits(const struct dpt_world *world, const struct tool *tool, struct work *work);

#endif
