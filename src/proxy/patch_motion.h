/* SPDX-License-Identifier: BSD-3-Clause */
/* A proxy's motions within its patch, which the solve proves: docs/algorithms/patch.md. */
#ifndef DPT_PATCH_MOTION_H
#define DPT_PATCH_MOTION_H

#include "proxy/proxy_tick.h"

/*
 * Follow the goal by motions within the patch, as far as the proxy may still move: *allowed, m. Returns 0 where that is
 * not possible: it is to be followed by motions that are swept, from where it is now.
 */
int dpti_patch_follow(struct proxy_tick *tick, double *allowed);

#endif
