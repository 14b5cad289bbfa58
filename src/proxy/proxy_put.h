/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A proxy that is put at its device's pose, without a way there that was proven free: docs/algorithms/force.md. It counts
 * as inside, without a force, until it is known to be on the side of all surfaces on which it was.
 */
#ifndef DPT_PROXY_PUT_H
#define DPT_PROXY_PUT_H

#include "proxy/proxy_tick.h"

/* Put the proxy where the device is. Whether it is outside there, contact tells later. */
void dpti_proxy_put(struct proxy_tick *tick);

/* The same in the middle of contact: the force fades. */
void dpti_proxy_put_again(struct proxy_tick *tick);

/* If bodies moved in a tick in which the tool was not stepped, it is not known any more what is round the proxy. */
void dpti_proxy_doubt_unseen_motion(const struct dpt_world *world, struct proxy *proxy);

/* The proxy is with its device, which is turned like that. */
void dpti_proxy_note_free_turn(struct proxy *proxy, const dpt_pose *device);

/*
 * Whether the device has turned by at most 1 rad since its proxy was with it last. While it has, no turn of the proxy is
 * a reason to put it.
 */
int dpti_proxy_is_near_free_turn(const struct proxy_tick *tick);

#endif
