/* SPDX-License-Identifier: BSD-3-Clause */
/* What a person may know of a device that its maker does not tell: named behind the '?', it is in the info. */
#ifndef DPT_TESTS_DYNAMICS_CHECKS_H
#define DPT_TESTS_DYNAMICS_CHECKS_H

#include "dynpoint/device.h"
#include "lib/check.h"

#define DYNAMICS                                                                                                       \
    "mass=0.31&inertia=2e-4&damping=0.7&spin_damping=3e-3&friction=0.02&spin_friction=0.01&"                           \
    "delay=0.002&position_step=3e-5&angle_step=4e-4"

static inline void check_dynamics(const dpt_device *of)
{
    dpt_device_info info = { .size = sizeof info };
    CHECK(dpt_device_get_info(of, &info) == DPT_OK, "info");
    CHECK(info.mass == 0.31 && info.inertia == 2e-4 && info.damping == 0.7 && info.spin_damping == 3e-3,
          "%g kg, %g kg m2, %g Ns/m, %g Nms", info.mass, info.inertia, info.damping, info.spin_damping);
    CHECK(info.friction == 0.02 && info.spin_friction == 0.01 && info.delay == 0.002 && info.position_step == 3e-5 &&
              info.angle_step == 4e-4,
          "%g N, %g Nm, %g s, %g m, %g rad", info.friction, info.spin_friction, info.delay, info.position_step,
          info.angle_step);
}

/* And where nobody has named it, it is 0 unless the device tells. */
static inline void check_no_dynamics(const dpt_device *of)
{
    dpt_device_info info = { .size = sizeof info };
    CHECK(dpt_device_get_info(of, &info) == DPT_OK && info.mass == 0.0 && info.inertia == 0.0 && info.damping == 0.0 &&
              info.spin_damping == 0.0 && info.friction == 0.0 && info.spin_friction == 0.0 && info.delay == 0.0 &&
              info.angle_step == 0.0,
          "a number that nobody told");
}

#endif
