/* SPDX-License-Identifier: BSD-3-Clause */
/* A proxy's motions, each swept before it is made: docs/algorithms/force.md. */
#ifndef DPT_PROXY_MOTION_H
#define DPT_PROXY_MOTION_H

#include "proxy/proxy_tick.h"

/* The nearest pairs of all segments at tick->at; sets tick->gap. */
void dpti_proxy_find_nearest(struct proxy_tick *tick);

/*
 * Move from tick->at towards `to`, as far as the tool meets nothing and its gap stays at least tick->min_gap. Triangles
 * that it met are remembered. Returns the share of the motion that was made. If that is 0, tick->at and its nearest
 * pairs are unchanged.
 *   met   the share up to which the sweep found it free, within the budget
 *
 * While tick->is_before the bodies move along by the same share: tick->time grows. The nearest pairs then belong to
 * another pose.
 */
double dpti_proxy_move(struct proxy_tick *tick, const struct proxy_pose *to, double *met);

/* What a tool met on its way. */
struct tool_sweep {
    int status;        /* SWEEP_...; SWEEP_UNFINISHED where a budget ended the sweep of any body */
    double time;       /* the share of the way that is free */
    int is_alone;      /* no body was near enough to be swept */
    uint32_t body_id;  /* that it touches first; 0: none is known */
    uint32_t triangle; /* place of the one it touches there */
};

/*
 * Sweep the tool on its way to a pose past all bodies in whose channels it is not, without moving it. What it meets is
 * remembered.
 */
struct tool_sweep dpti_proxy_sweep(struct proxy_tick *tick, const struct proxy_pose *to);

/*
 * While tick->is_before: move with a body that moved, as if fixed to it, if no other body is in the way. It needs no
 * search and no sweep of that body. Returns 0, with tick->at as before, if there is no such body.
 */
int dpti_proxy_carry(struct proxy_tick *tick);

/*
 * While tick->is_before: the same with one body, which may also have stayed where it was, if no other one can be near on
 * the way. Nearest pairs belong to another pose then.
 */
int dpti_proxy_carry_alone(struct proxy_tick *tick, const struct body *body);

/*
 * The same where other bodies are near, by a sweep past them; what gap it leaves to them is not known. Returns 0, and it
 * stays where it is, if one is met, or a body has friction: what sticks to another body would slip unseen.
 */
int dpti_proxy_carry_past(struct proxy_tick *tick, const struct body *body);

#endif
