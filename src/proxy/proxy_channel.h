/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A proxy in the channels that its tool has made: it keeps to their line, and goes along it as friction and cutting let
 * it. docs/algorithms/insertion.md.
 */
#ifndef DPT_PROXY_CHANNEL_H
#define DPT_PROXY_CHANNEL_H

#include "insertion/world_channels.h"
#include "proxy/proxy_tick.h"

/* The tick of a proxy that is in channels. It may move by `allowed`, m, beyond what bodies move it by. */
void dpti_proxy_follow_channel(struct proxy_tick *tick, double allowed, double dt);

/*
 * After the tick of a proxy in the open: where its tip is at a hole that its tool has made, and the device is nearer to
 * the channel than to where the proxy is, it goes in. Returns 1 if it did.
 */
int dpti_proxy_enter_channel(struct proxy_tick *tick, double allowed, double dt);

/* What is felt in channels: what bodies give way, what their motion does, and where they are pushed. */
void dpti_proxy_feel_channel(struct proxy_tick *tick);

/* At the end of a tick: whether a wall before the tip ruptures. The tip goes on in the next tick. */
void dpti_proxy_pierce(struct proxy_tick *tick);

/*
 * Put the tool into channels of all bodies that its axis goes into, where its device is, as if it had gone there along
 * its axis. DPT_E_ARGUMENT: it begins inside a body or behind a sheet, touches one that cannot be pierced, or goes into
 * none. DPT_E_FULL: there is no room for its channels. The tool must have been forgotten before.
 */
dpt_result dpti_proxy_insert(struct dpt_world *world, struct tool *tool);

#endif
