/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Friction along a shaft: elastic bristles that are anchored in the tissue, and slip where they are stretched too far
 * (docs/algorithms/insertion.md). A shaft that sticks moves by what its bristles give, and back: it neither creeps nor
 * drifts, as the anchor moves by slipping alone. What it stores is never more than the work that was done on it.
 */
#ifndef DPT_SHAFT_FRICTION_H
#define DPT_SHAFT_FRICTION_H

#include "base/vec3.h"

/* m: a slip that is shorter is rounding, and would add up to creep. */
#define SHAFT_ROUNDING 1e-13

/* Of a shaft in one body; x is where its tip is in the channel, m. */
struct shaft {
    double friction;  /* N/m: at most so much for each metre that is inside */
    double viscosity; /* Ns/m2 */
    double stiffness; /* N/m2, above 0: of the bristles, for each metre inside */
    double inside;    /* m: when the tip is at the anchor */
    double anchor;    /* x where the bristles are not stretched */
    double last;      /* x in the last tick */
};

/*
 * m: the bristles are never stretched farther. The half of what is inside counts while that is little: what the bristles
 * store, stiffness * inside * stretch^2 / 2, could else grow faster by the length than friction takes energy.
 */
static inline double shaft_stretch_max(const struct shaft *shaft)
{
    return min_of(shaft->friction / shaft->stiffness, 0.5 * shaft->inside);
}

/* m: from the anchor to x, as far as the bristles hold. */
static inline double shaft_stretch(const struct shaft *shaft, double x)
{
    const double most = shaft_stretch_max(shaft);
    return min_of(max_of(x - shaft->anchor, -most), most);
}

/* N, against a motion to x in a tick of dt: never falls as x grows. */
static inline double shaft_resistance(const struct shaft *shaft, double x, double dt)
{
    return shaft->inside * (shaft->stiffness * shaft_stretch(shaft, x) + shaft->viscosity * (x - shaft->last) / dt);
}

/* The tip has come to x: where the bristles could not hold, the anchor has slipped. */
static inline void shaft_follow(struct shaft *shaft, double x)
{
    const double stretch = shaft_stretch(shaft, x);
    if (fabs(x - shaft->anchor - stretch) > SHAFT_ROUNDING)
        shaft->anchor = x - stretch;
    shaft->last = x;
}

/* J: what the bristles store. */
static inline double shaft_energy(const struct shaft *shaft, double x)
{
    const double stretch = shaft_stretch(shaft, x);
    return 0.5 * shaft->stiffness * shaft->inside * stretch * stretch;
}

#endif
