/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The bed: an energy along the tool and at its free ends, docs/algorithms/force.md. What contact gives for it, of one
 * segment, summed up over bodies.
 */
#ifndef DPT_BED_H
#define DPT_BED_H

#include "base/vec3.h"
#include "dynpoint/types.h"

/* Let w(s) be the depth of the tool's surface at s, in m, 0 outside, and n(s) the exit direction, unit, in the world. */
struct bed_depth {
    double square;        /* integral of w^2 over the length, m^3 */
    vec3 thrust;          /* integral of w n over the length, m^2 */
    vec3 moment;          /* integral of (x(s) - x(0)) x (w n) over the length, m^3 */
    double end_square[2]; /* w^2 at end a and end b */
    vec3 end_thrust[2];   /* w n there */
};

/* Stiffness per length, N/m^2, and of each end, N/m: of a free one the tool's half. */
struct bed_stiffness {
    double line;
    double end[2];
};

/* Adds a segment's share to a wrench, with the torque about `origin`; a and b are its ends. Returns its energy, J. */
static inline double bed_respond(const struct bed_depth *depth, const struct bed_stiffness *stiffness, vec3 a, vec3 b,
                                 vec3 origin, dpt_wrench *sum)
{
    const vec3 at[2] = { a, b };
    double energy = 0.5 * stiffness->line * depth->square;
    vec3 force = scaled(depth->thrust, stiffness->line);
    vec3 torque = add(scaled(depth->moment, stiffness->line), cross(sub(a, origin), force));
    for (int e = 0; e < 2; e++) {
        const vec3 push = scaled(depth->end_thrust[e], stiffness->end[e]);
        energy += 0.5 * stiffness->end[e] * depth->end_square[e];
        force = add(force, push);
        torque = add(torque, cross(sub(at[e], origin), push));
    }
    vec3_store(add(vec3_of(sum->force), force), sum->force);
    vec3_store(add(vec3_of(sum->torque), torque), sum->torque);
    return energy;
}

#endif
