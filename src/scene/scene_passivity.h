/* SPDX-License-Identifier: BSD-3-Clause */
/* The observer of the energy that goes through a scene's device, and what it has seen. */
#ifndef DPT_SCENE_PASSIVITY_H
#define DPT_SCENE_PASSIVITY_H

#include "dynpoint/loop.h"
#include "dynpoint/passivity.h"

struct scene_passivity {
    int is_used;
    dpt_passivity_def def;
    dpt_passivity observer;
    dpt_passivity_info before; /* sums of observers that ended; the least account and the eps of one of them */
};

/* Use it from now on; `def` NULL: not at all. */
void scene_passivity_begin(struct scene_passivity *passivity, const dpt_passivity_def *def);

/*
 * Limit a wrench, in the device's frame, to what the controller allows. Where the device is idle the account begins anew.
 *   energy, body_work   of the tool, at the hand, J
 */
void scene_passivity_step(struct scene_passivity *passivity, const dpt_loop_sample *sample, double energy,
                          double body_work, dpt_wrench *wrench);

/* The same, whether the device is idle or not: the account of a trial goes on from its first sample. */
void scene_passivity_go_on(struct scene_passivity *passivity, const dpt_loop_sample *sample, double energy,
                           double body_work, dpt_wrench *wrench);

/* Sums over all observers since scene_passivity_begin. */
dpt_passivity_info scene_passivity_info(const struct scene_passivity *passivity);

#endif
