/* SPDX-License-Identifier: BSD-3-Clause */
/* Small worlds, for tests of the world's calls. */
#ifndef DPT_TESTS_SMALL_DEF_H
#define DPT_TESTS_SMALL_DEF_H

#include "dynpoint/baseline.h"
#include "lib/fixture.h"
#include "lib/rig.h"

/* Room for 4 bodies, 3 tools, 6 segments. */
static inline dpt_world_def small_def(void)
{
    dpt_world_def def = rig_def(DPT_LAW_POINT);
    def.max_bodies = 4;
    def.max_tools = 3;
    def.max_segments = 6;
    return def;
}

static inline dpt_segment capsule(double ax, double ay, double az, double bx, double by, double bz, double radius)
{
    return (dpt_segment){ { ax, ay, az }, { bx, by, bz }, radius };
}

#endif
