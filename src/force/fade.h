/* SPDX-License-Identifier: BSD-3-Clause */
/* A wrench that ends by decision goes to what is true over a stated time: docs/algorithms/penalty.md. */
#ifndef DPT_FADE_H
#define DPT_FADE_H

#include "base/vec3.h"
#include "dynpoint/types.h"

struct fade {
    dpt_wrench felt;  /* what was felt in the last tick */
    double time_left; /* s, to when it is what is true; 0: it is */
};

/* Below this share of a tick nothing is left: what sums of dt are off by. */
#define FADE_OVER 1e-9

static inline void fade_blend(vec3 felt, double share, const double truth[3], double to[3])
{
    vec3_store(along(felt, share, sub(vec3_of(truth), felt)), to);
}

/* A tick of `dt`: a straight way from what was felt to what is true, and never beyond it. */
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
