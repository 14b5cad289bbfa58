/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A proxy in the channels of bodies that give way: its tool is solved for in the step of the tissue (src/tissue), and here
 * the channels follow it and their bodies. docs/algorithms/insertion.md.
 */
#ifndef DPT_TISSUE_CHANNEL_H
#define DPT_TISSUE_CHANNEL_H

#include "insertion/world_channels.h"
#include "proxy/proxy_tick.h"

/*
 * Go where the last step with tissue ended, or with the points of a channel, past all bodies in which the tool is not. Where
 * one is in the way it stays before that. Returns 0 if there is no way at all.
 */
int dpti_proxy_go_with_tissue(struct proxy_tick *tick, int is_ended);

/*
 * The tool is where it is: its axis is the line of its channels. Their walls are found again, the tip has its place by their
 * last points, and makes new ones. It may go `allowed` deeper in the step of the tissue.
 */
void dpti_tissue_channels_update(struct proxy_tick *tick, double allowed);

/* Walls that the tip pushed too much, in the last step of the tissue, rupture. */
void dpti_tissue_channels_rupture(struct proxy_tick *tick);

/* After the tip went along the line without a step of the tissue: what the next one must know. */
void dpti_tissue_channels_balanced(struct proxy_tick *tick, double allowed);

/* A hole that nobody is in, in tissue: where it is now. Returns 0 if the tip is not near. */
int dpti_tissue_hole_find(struct proxy_tick *tick, struct channel *channel);

#endif
