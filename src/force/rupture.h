/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * When a wall gives way to a tip: docs/algorithms/insertion.md. A tip of radius r that is pressed against it with the
 * force F by a spring of stiffness k holds the energy F^2 / 2k. The wall ruptures at a stated force; or, by its
 * toughness J, where the energy suffices to open the tip's cross-section, J pi r^2.
 */
#ifndef DPT_RUPTURE_H
#define DPT_RUPTURE_H

#include "base/angle.h"

/* Of what a body is made, for a piercing point. All 0 or more; with the first two 0 it cannot be pierced. */
struct pierce_law {
    double puncture_force;  /* N; 0: by the toughness */
    double toughness;       /* J/m2 */
    double cutting_force;   /* N, beside what the toughness gives */
    double shaft_friction;  /* N/m */
    double shaft_viscosity; /* Ns/m2 */
    double shaft_stiffness; /* N/m2; 0: the shaft yields by SHAFT_STRETCH before it slips */
};

/* m */
#define SHAFT_STRETCH 1e-5

static inline int pierce_law_is_any(const struct pierce_law *law)
{
    return law->puncture_force > 0.0 || law->toughness > 0.0;
}

/* N: a wall ruptures above this force of a tip of that radius, m, on a spring of that stiffness, N/m. */
static inline double rupture_force(const struct pierce_law *law, double radius, double stiffness)
{
    const double area = 0.5 * ANGLE_TURN * radius * radius;
    return law->puncture_force > 0.0 ? law->puncture_force : sqrt(2.0 * stiffness * law->toughness * area);
}

/* N: what a tip takes to go on in a layer, a cut as wide as it is (Azar and Hayward 2008). */
static inline double cutting_force(const struct pierce_law *law, double radius)
{
    return law->cutting_force + 2.0 * radius * law->toughness;
}

#endif
