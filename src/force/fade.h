/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The fade of a wrench: after a decision it goes from what was felt to the true value in a stated time.
 * docs/algorithms/penalty.md.
 */
#ifndef DPT_FADE_H
#define DPT_FADE_H

#include "base/vec3.h"
#include "dynpoint/types.h"

struct fade {
    dpt_wrench felt;  /* in the last tick */
    double time_left; /* s, until `felt` is the true wrench; 0: no fade is under way */
};

/* A share of a tick. Less time than that counts as none: sums of dt are off by so much. */
#define FADE_OVER 1e-9

/* Write felt + share * (truth - felt). */
static inline void fade_blend(vec3 felt, double share, const double truth[3], double to[3])
{
    vec3_store(along(felt, share, sub(vec3_of(truth), felt)), to);
}

/*
 * Advance a fade by a tick of dt (s): `felt` moves in a straight line towards the true wrench, and never beyond it.
 * Without a fade it becomes the true wrench.
 */
static inline void fade_step(struct fade *fade, const dpt_wrench *truth, double dt)
{
    if (!(fade->time_left - dt > FADE_OVER * dt)) {
        fade->felt = *truth;
        fade->time_left = 0.0;
        return;
    }
    fade_blend(vec3_of(fade->felt.force), dt / fade->time_left, truth->force, fade->felt.force);
    fade_blend(vec3_of(fade->felt.torque), dt / fade->time_left, truth->torque, fade->felt.torque);
    fade->time_left -= dt;
}

#endif
