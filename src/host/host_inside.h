/* SPDX-License-Identifier: BSD-3-Clause */
/* What a viewer sees of a host (host.h): its scene, and the hand that feels it. */
#ifndef DPT_HOST_INSIDE_H
#define DPT_HOST_INSIDE_H

#include "dynpoint/host.h"
#include "scene/scene.h"

/* Valid as long as the host; to be read between its ticks, and in dpt_host_felt_fn. */
const struct scene *host_scene(const dpt_host *host);

/* Its device, or NULL in it; without a name. */
struct scene_hand host_hand(const dpt_host *host);

/* ns, of clock_now: when the last tick began. 0 for a host without dpt_host_def.felt. */
uint64_t host_tick_began(const dpt_host *host);

#endif
