/* SPDX-License-Identifier: BSD-3-Clause */
/* Checks and limits of a wrench before it is sent to a device. */
#ifndef DPT_WRENCH_LIMIT_H
#define DPT_WRENCH_LIMIT_H

#include "base/vec3.h"
#include "dynpoint/types.h"

/* 1 if no component is infinite or NaN. */
static inline int wrench_is_finite(const dpt_wrench *wrench)
{
    return vec3_within(wrench->force, DBL_MAX) && vec3_within(wrench->torque, DBL_MAX);
}

static inline int wrench_is_zero(const dpt_wrench *wrench)
{
    return extent_of(vec3_of(wrench->force)) == 0.0 && extent_of(vec3_of(wrench->torque)) == 0.0;
}

/* Scale `v` down to a length of at most max_length, as length() measures it. 1 if `v` changed. */
static inline int limit_length(double *v, double max_length)
{
    double extent = extent_of(vec3_of(v));
    if (extent == 0.0 || (max_length > 0.0 && length(vec3_of(v)) <= max_length))
        return 0;
    vec3 unit = { v[0] / extent, v[1] / extent, v[2] / extent };
    vec3_store(scaled(unit, max_length / length(unit) * (1.0 - 4.0 * DBL_EPSILON)), v);
    return 1;
}

#endif
