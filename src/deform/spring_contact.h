/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Nodes that tools have moved out of themselves (DPT_RESPONSE_DISPLACE), with Coulomb friction.
 * docs/algorithms/springs.md.
 *
 * Under a tool that moves, a node falls against it in each step, and is put back. Of its speed against the tool, what
 * goes into the tool is gone, and friction takes its share of what goes along it. That is all that positions alone can
 * tell. On a tool that does not move, a node counts as fixed while its springs and weight push it into the tool, and
 * friction holds it there: so a body comes to rest, and sleeps. It stays where the step put it, and what is felt of it
 * goes on.
 *
 * Calls between two steps: begin, hold for each node that was moved, end.
 */
#ifndef DPT_SPRING_CONTACT_H
#define DPT_SPRING_CONTACT_H

#include "base/vec3.h"
#include "deform/spring_state.h"

struct tool_touch {
    double static_friction, kinetic_friction;
    double dt;     /* s: the step in which nodes went into the tool */
    int has_moved; /* 1: some tool is not where it was in the step before, or touches for the first time, or lets go */
};

/* Wakes what sleeps on tools that have moved. */
void dpti_spring_contact_begin(struct dpt_springs *springs, const struct tool_touch *touch);

/* A node was moved to `to`, m, by a tool whose axis moves by `motion` there in dt. */
void dpti_spring_contact_hold(struct dpt_springs *springs, uint32_t node, vec3 to, vec3 motion,
                              const struct tool_touch *touch);

void dpti_spring_contact_end(struct dpt_springs *springs);

#endif
