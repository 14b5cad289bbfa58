/* SPDX-License-Identifier: BSD-3-Clause */
/* A tick of a rig's proxy that has not begun to move, for tests that look at what a tick works with. */
#ifndef DPT_TESTS_TICK_AT_H
#define DPT_TESTS_TICK_AT_H

#include "lib/rig.h"
#include "proxy/patch_sides.h"
#include "proxy/proxy.h"
#include "proxy/proxy_tick.h"

static inline void tick_at_proxy(const struct rig *rig, struct proxy_tick *tick)
{
    memset(tick, 0, sizeof *tick);
    tick->world = rig->world;
    tick->tool = rig->world->tools;
    tick->proxy = rig->world->proxies;
    tick->at = dpti_proxy_pose_of(tick->proxy, &tick->proxy->pose);
    tick->clearance = dpti_proxy_clearance(rig->world);
    tick->min_gap = tick->proxy->min_gap;
    tick->gap = tick->proxy->gap;
    dpti_proxy_turn_axes(tick->proxy, &tick->at, tick->axes);
}

/* All patches of the tool. */
static inline struct proxy_patch *patch_of(const struct rig *rig)
{
    return patches_of(rig->world, 0);
}

#endif
