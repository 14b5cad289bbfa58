/* SPDX-License-Identifier: BSD-3-Clause */
/* What the contact stage gives to the force stage: where and how a tool would be pushed out. */
#ifndef DPT_PENETRATION_H
#define DPT_PENETRATION_H

#include "base/vec3.h"

/* In world coordinates. */
struct penetration {
    vec3 direction; /* the exit direction, unit; zero where it is not known */
    vec3 at;        /* the pushed point of the axis, m */
    double depth;   /* m, >= 0 */
};

#endif
