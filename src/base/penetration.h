/* SPDX-License-Identifier: BSD-3-Clause */
/* What contact tells a force: where and how a tool would be pushed out. */
#ifndef DPT_PENETRATION_H
#define DPT_PENETRATION_H

#include "base/vec3.h"

struct penetration {
    vec3 direction; /* unit, the way out; zero where it is not known */
    vec3 at;        /* the point of the axis */
    double depth;   /* how far, >= 0 */
};

#endif
