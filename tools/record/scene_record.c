/* SPDX-License-Identifier: BSD-3-Clause */
#include "record/scene_record.h"

#include <string.h>

dpt_record record_of_sample(const dpt_loop_sample *sample)
{
    const dpt_device_state *state = sample->state;
    dpt_record record = { .size = sizeof record,
                          .sequence = state->sequence,
                          .time_ns = state->time_ns,
                          .sent_ns = sample->sent_ns,
                          .late_ns = (uint64_t)(sample->late * 1e9 + 0.5),
                          .dt = sample->dt,
                          .status = state->status,
                          .reasons = state->reasons,
                          .code = state->code,
                          .buttons = state->buttons,
                          .fresh = state->fresh,
                          .commands = sample->commands,
                          .pose = state->pose,
                          .sent = sample->sent };
    memcpy(record.velocity, state->velocity, sizeof record.velocity);
    memcpy(record.spin, state->spin, sizeof record.spin);
    memcpy(record.joint, state->joint, sizeof record.joint);
    return record;
}

void record_answers(dpt_record *record, const struct scene *scene, dpt_result result, const dpt_wrench *wrench)
{
    dpt_hit hit = DPT_HIT_INIT;
    dpt_force_info force = { .size = sizeof force };
    scene_get_hit(scene, &hit);
    scene_get_force_info(scene, &force);
    dpt_tool_get_proxy(scene->world, scene->tool, &record->proxy);
    record->flags |= DPT_RECORD_FLAG_FELT;
    record->result = result;
    record->asked = *wrench;
    record->force_reason = force.reason;
    record->force_flags = force.flags;
    record->energy = force.energy;
    record->lag = force.lag;
    record->hit_status = hit.status;
    record->contact = hit.contact;
    record->hit_flags = hit.flags;
    record->triangle = hit.triangle;
    record->distance = hit.distance;
    record->gap = hit.gap;
    memcpy(record->point, hit.q, sizeof record->point);
}

dpt_loop_sample sample_of_record(const dpt_record *record, dpt_device_state *state, const dpt_device_info *info)
{
    *state = (dpt_device_state){ .size = sizeof *state,
                                 .status = record->status,
                                 .reasons = record->reasons,
                                 .code = record->code,
                                 .buttons = record->buttons,
                                 .fresh = record->fresh,
                                 .sequence = record->sequence,
                                 .time_ns = record->time_ns,
                                 .pose = record->pose,
                                 .temperature = -1.0 };
    memcpy(state->velocity, record->velocity, sizeof state->velocity);
    memcpy(state->spin, record->spin, sizeof state->spin);
    memcpy(state->joint, record->joint, sizeof state->joint);
    return (dpt_loop_sample){ .size = sizeof(dpt_loop_sample),
                              .commands = record->commands,
                              .state = state,
                              .info = info,
                              .dt = record->dt,
                              .sent_ns = record->sent_ns,
                              .sent = record->sent,
                              .late = (double)record->late_ns * 1e-9 };
}
