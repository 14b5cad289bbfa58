/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The spring between a device and its proxy: docs/algorithms/force.md. A displacement of the proxy from the device is a
 * translation of the tool's centre and a rotation vector about it; rho, a length, makes the two comparable.
 */
#ifndef DPT_COUPLING_H
#define DPT_COUPLING_H

#include "base/quaternion.h"
#include "dynpoint/types.h"

struct displacement {
    vec3 shift; /* m, of the centre */
    vec3 turn;  /* rotation vector, rad */
};

struct coupling {
    double stiffness;            /* N/m */
    double rotational_stiffness; /* Nm/rad */
};

/* sqrt(|shift|^2 + rho^2 |turn|^2), in m. */
static inline double displacement_norm(const struct displacement *displacement, double rho)
{
    return sqrt(dot(displacement->shift, displacement->shift) +
                rho * rho * dot(displacement->turn, displacement->turn));
}

/* What the spring stores, J. */
static inline double coupling_energy(const struct coupling *coupling,
                                     const struct displacement *from_device)
{
    return 0.5 * (coupling->stiffness * dot(from_device->shift, from_device->shift) +
                  coupling->rotational_stiffness * dot(from_device->turn, from_device->turn));
}

/* The wrench on the tool, about `origin`; `centre` is the device's. */
static inline dpt_wrench coupling_wrench(const struct coupling *coupling,
                                         const struct displacement *from_device, vec3 centre,
                                         vec3 origin)
{
    dpt_wrench wrench;
    const vec3 force = scaled(from_device->shift, coupling->stiffness);
    const vec3 torque = scaled(from_device->turn, coupling->rotational_stiffness);
    vec3_store(force, wrench.force);
    vec3_store(add(torque, cross(sub(centre, origin), force)), wrench.torque);
    return wrench;
}

#endif
