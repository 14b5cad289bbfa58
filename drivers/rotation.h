/* SPDX-License-Identifier: BSD-3-Clause */
/* Rotations between two orientations that a device reports. */
#ifndef DPT_DRIVERS_ROTATION_H
#define DPT_DRIVERS_ROTATION_H

#include <math.h>

#include "base/vec3.h"

/* The rotation from one orientation to the next, as a rotation vector in the device's frame, rad. */
static inline void rotation_between(const double *from, const double *to, double *rotation)
{
    const vec3 u = vec3_of(from + 1), v = vec3_of(to + 1);
    const double w = to[0] * from[0] + dot(v, u);
    const vec3 axis = sub(sub(scaled(v, from[0]), scaled(u, to[0])), cross(v, u));
    const double sine = length(axis), sign = w < 0.0 ? -1.0 : 1.0;
    const double angle = 2.0 * atan2(sine, fabs(w));
    vec3_store(scaled(axis, sine > 0.0 ? sign * angle / sine : 0.0), rotation);
}

#endif
