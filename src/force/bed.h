/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The bed: an energy along the tool and at its free ends, docs/algorithms/force.md. This is what contact computes for
 * one segment, summed over bodies.
 */
#ifndef DPT_BED_H
#define DPT_BED_H

#include "base/vec3.h"

/* Let w(s) be the depth of the tool's surface at s, in m, 0 outside, and n(s) the exit direction, unit, in the world. */
struct bed_depth {
    double square;        /* integral of w^2 over the length, m^3 */
    vec3 thrust;          /* integral of w n over the length, m^2 */
    vec3 moment;          /* integral of (x(s) - x(0)) x (w n) over the length, m^3 */
    double end_square[2]; /* w^2 at end a and end b */
    vec3 end_thrust[2];   /* w n there */
};

#endif
