/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Nodes that tools have moved out of themselves (DPT_RESPONSE_DISPLACE), with Coulomb friction.
 * docs/algorithms/springs.md.
 *
 * Under a moving tool, each step moves a node into the tool, and contact puts it back. Its speed relative to the tool
 * loses the part into the tool; friction reduces the part along it. On a tool at rest, a node counts as fixed while its
 * springs and weight push it into the tool and friction holds it. So a body comes to rest and sleeps, and its force on
 * the tool continues.
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
    int has_moved; /* 1: in this step a tool moved, began to touch or ceased to touch */
};

/* Wakes the slices that lie on tools that have moved. */
void dpti_spring_contact_begin(struct dpt_springs *springs, const struct tool_touch *touch);

/* A node was moved to `to`, m, by a tool whose axis moves by `motion` there in dt. */
void dpti_spring_contact_hold(struct dpt_springs *springs, uint32_t node, vec3 to, vec3 motion,
                              const struct tool_touch *touch);

void dpti_spring_contact_end(struct dpt_springs *springs);

#endif
