/* SPDX-License-Identifier: BSD-3-Clause */
#include "scene/scene_passivity.h"

#include <math.h>
#include <string.h>

static void restart(struct scene_passivity *passivity)
{
    passivity->observer.size = sizeof passivity->observer;
    dpt_passivity_init(&passivity->observer, &passivity->def);
}

void scene_passivity_begin(struct scene_passivity *passivity, const dpt_passivity_def *def)
{
    memset(passivity, 0, sizeof *passivity);
    if (!def)
        return;
    passivity->is_used = 1;
    passivity->def = *def;
    restart(passivity);
}

dpt_passivity_info scene_passivity_info(const struct scene_passivity *passivity)
{
    dpt_passivity_info info = { .size = sizeof info };
    const dpt_passivity_info *before = &passivity->before;
    dpt_passivity_get_info(&passivity->observer, &info);
    info.steps += before->steps;
    info.acted += before->acted;
    info.damped += before->damped;
    info.body_work += before->body_work;
    info.taken += before->taken;
    info.account_min = fmin(info.account_min, before->account_min);
    info.eps = fmax(info.eps, before->eps);
    return info;
}

/* A device that has taken no command gives no energy, and may be anywhere when it comes back. */
static int is_idle(const dpt_loop_sample *sample)
{
    return sample->sent_ns == 0 || sample->state->status != DPT_DEVICE_STATUS_READY;
}

void scene_passivity_step(struct scene_passivity *passivity, const dpt_loop_sample *sample, double energy,
                          double body_work, dpt_wrench *wrench)
{
    if (passivity->is_used && is_idle(sample)) {
        passivity->before = scene_passivity_info(passivity);
        restart(passivity);
    }
    scene_passivity_go_on(passivity, sample, energy, body_work, wrench);
}

void scene_passivity_go_on(struct scene_passivity *passivity, const dpt_loop_sample *sample, double energy,
                           double body_work, dpt_wrench *wrench)
{
    if (!passivity->is_used)
        return;
    const dpt_passivity_sample seen = { .size = sizeof seen,
                                        .dt = sample->dt,
                                        .energy = energy,
                                        .body_work = body_work,
                                        .pose = sample->state->pose,
                                        .sent = sample->sent };
    dpt_passivity_step(&passivity->observer, &seen, wrench);
}
