/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The spring and the damper between a device and its proxy: docs/algorithms/force.md. A displacement is a translation of
 * the tool's centre, a rotation vector about it and, of a straight tool, a spin about its own axis, which the rotation
 * vector does not contain. Two lengths make them comparable: rho for the turn, spin_rho for the spin.
 */
#ifndef DPT_SPRING_H
#define DPT_SPRING_H

#include "base/quaternion.h"
#include "dynpoint/types.h"

struct displacement {
    vec3 shift;  /* m, of the centre */
    vec3 turn;   /* rotation vector, rad */
    double spin; /* rad */
};

struct coupling {
    double stiffness; /* N/m */
    double rho;       /* m: the rotational stiffness is that of the shift times rho^2, in Nm/rad */
    double spin_rho;  /* likewise */
};

static inline struct displacement displacement_sum(const struct displacement *a, double share,
                                                   const struct displacement *b)
{
    return (struct displacement){ along(a->shift, share, b->shift), along(a->turn, share, b->turn),
                                  a->spin + share * b->spin };
}

/* shift . shift + rho^2 turn . turn + spin_rho^2 spin spin, in m^2. */
static inline double displacement_dot(const struct coupling *coupling, const struct displacement *a,
                                      const struct displacement *b)
{
    return dot(a->shift, b->shift) + coupling->rho * coupling->rho * dot(a->turn, b->turn) +
           coupling->spin_rho * coupling->spin_rho * a->spin * b->spin;
}

static inline double displacement_norm(const struct coupling *coupling, const struct displacement *displacement)
{
    return sqrt(displacement_dot(coupling, displacement, displacement));
}

/* What the spring stores, J. */
static inline double coupling_energy(const struct coupling *coupling, const struct displacement *from_device)
{
    return 0.5 * coupling->stiffness * displacement_dot(coupling, from_device, from_device);
}

/*
 * A damper is felt as a spring that is longer: by `time` (damping / stiffness, s) times the speed at which it grew
 * in the last tick of dt. It never makes the spring push.
 */
static inline struct displacement coupling_damped(const struct coupling *coupling,
                                                  const struct displacement *from_device,
                                                  const struct displacement *last, double time, double dt)
{
    const struct displacement grown = displacement_sum(from_device, -1.0, last);
    const double length2 = displacement_dot(coupling, from_device, from_device);
    const double less = -(time / dt) * displacement_dot(coupling, &grown, from_device);
    const double share = less > length2 ? length2 / less : 1.0;
    return displacement_sum(from_device, share * time / dt, &grown);
}

/*
 * The wrench on the tool, about `origin`; `centre` is the device's. `spin_axis` is (u + v) / (1 + u . v), u and v the
 * device's and the proxy's unit axes: so much the spin changes with a turn of the device.
 */
static inline dpt_wrench coupling_wrench(const struct coupling *coupling, const struct displacement *from_device,
                                         vec3 spin_axis, vec3 centre, vec3 origin)
{
    dpt_wrench wrench;
    const double k = coupling->stiffness;
    const vec3 force = scaled(from_device->shift, k);
    const vec3 torque = along(scaled(from_device->turn, k * coupling->rho * coupling->rho),
                              k * coupling->spin_rho * coupling->spin_rho * from_device->spin, spin_axis);
    vec3_store(force, wrench.force);
    vec3_store(add(torque, cross(sub(centre, origin), force)), wrench.torque);
    return wrench;
}

#endif
