/* SPDX-License-Identifier: BSD-3-Clause */
/* What tools do to bodies, and where: docs/algorithms/force.md, and for deformable ones docs/algorithms/deform.md. */
#ifndef DPT_TOOL_LOADS_H
#define DPT_TOOL_LOADS_H

#include "proxy/proxy_tick.h"

/* Its share of dpt_world_bytes. */
uint64_t dpti_loads_bytes(const dpt_world_def *def);

/* Place its memory at `at`; returns where it ends. */
char *dpti_loads_place(struct dpt_world *world, char *at);

/* Forget the notes of the last tick, but those of tools for which `keeps` says 1. */
void dpti_loads_begin_tick(struct dpt_world *world, int (*keeps)(const struct tool *tool));

/* Note where a proxy is held, at the end of its tick. */
void dpti_loads_note_proxy(struct proxy_tick *tick);

/* Note where the segments of a tool without a proxy are pushed. */
void dpti_loads_note_segments(struct dpt_world *world, struct tool *tool);

/* Forget a tool's notes of this tick, on all bodies. */
void dpti_loads_forget(struct dpt_world *world, struct tool *tool);

/* A part of a tool pushes a body at a point of a triangle; all in the world. */
struct tool_push {
    uint32_t part, body_id, triangle;
    vec3 at;            /* on the triangle */
    vec3 normal;        /* unit, towards the tool */
    double depth;       /* m: so far beneath it lies the mean of what it loads, where the force acts */
    vec3 force;         /* N, on the body; not 0 */
    uint32_t is_narrow; /* 1: it is not spread */
    uint32_t is_part;   /* 1: of a couple, which the wrench has beside the tool's loads */
};

/* Note it. */
void dpti_loads_note_push(struct dpt_world *world, struct tool *tool, const struct tool_push *push);

/* After the tool's wrench is known: what its points sum up to on each deformable body is the reaction to it. */
void dpti_loads_settle(struct dpt_world *world, struct tool *tool);

/*
 * What a tool's notes become as parts of its wrench: `scale` times each force, and by `share` of its size what the wrench
 * is beyond their sum, on the bodies.
 */
struct load_settlement {
    double scale;
    double rigid_share, deform_share;
    dpt_wrench rest;
    uint32_t count; /* of notes; 0: no force */
};

struct load_settlement dpti_loads_settlement(const struct dpt_world *world, const struct tool *tool);

/* The force on the body of one of the tool's notes, and its torque about the note's point. */
dpt_wrench dpti_loads_of_note(const struct dpt_world *world, const struct tool *tool,
                              const struct load_settlement *settled, const struct load_note *note);

#endif
