/* SPDX-License-Identifier: BSD-3-Clause */
#include "scene/scene_record.h"

#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "base/return_if_error.h"
#include "platform/clock.h"

static dpt_result open_recorder(struct scene_record *record, const dpt_record_header *header, int waits,
                                dpt_host_error *error)
{
    dpt_recorder_def def;
    dpt_recorder_def_init(&def);
    def.wait = (uint32_t)waits;
    const dpt_result result = dpt_recorder_open(record->path, header, &def, &record->recorder);
    if (result == DPT_OK)
        return DPT_OK;
    return host_refuse(error, result, "%s: cannot be written: %s", record->path,
                       result == DPT_E_OPEN || result == DPT_E_WRITE ? strerror(errno) : dpt_result_text(result));
}

dpt_result scene_record_open(struct scene_record *record, const char *path, const struct scene *scene,
                             const struct scene_text *text, double rate, int waits, dpt_host_error *error)
{
    const size_t size = strlen(path) + 1;
    char *words = malloc(DPT_RECORD_TEXT_MAX + 1);
    *record = (struct scene_record){ .path = malloc(size), .is_timed = !waits, .counts.size = sizeof record->counts };
    dpt_result result = words && record->path ? DPT_OK : host_refuse(error, DPT_E_MEMORY, "memory ran out");
    if (result == DPT_OK) {
        memcpy(record->path, path, size);
        result = scene_text_write(text, scene, words, error);
    }
    if (result == DPT_OK) {
        const dpt_record_header header = { .size = sizeof header,
                                           .rate = rate,
                                           .began_ns = record->is_timed ? clock_wall() : 0,
                                           .text = words,
                                           .text_bytes = strlen(words) };
        result = open_recorder(record, &header, waits, error);
    }
    free(words);
    if (result != DPT_OK) {
        free(record->path);
        record->path = NULL;
    }
    return result;
}

void scene_record_begin(struct scene_record *record)
{
    if (record->recorder && record->is_timed)
        record->began_ns = clock_now();
}

void scene_record_tick(struct scene_record *record, const struct scene *scene, const dpt_loop_sample *sample,
                       dpt_result result, const dpt_wrench *wrench)
{
    if (!record->recorder)
        return;
    const uint64_t end_ns = record->is_timed ? clock_now() : 0;
    dpt_record tick = record_of_sample(sample);
    record_answers(&tick, scene, result, wrench);
    tick.took_ns = end_ns > record->began_ns ? end_ns - record->began_ns : 0;
    dpt_recorder_push(record->recorder, &tick);
}

void scene_record_idle(struct scene_record *record, const dpt_loop_sample *sample)
{
    if (!record->recorder)
        return;
    const dpt_record tick = record_of_sample(sample);
    dpt_recorder_push(record->recorder, &tick);
}

dpt_result scene_record_close(struct scene_record *record, dpt_host_error *error)
{
    const dpt_recorder_counts *counts = &record->counts;
    if (!record->recorder)
        return DPT_OK;
    dpt_result result = dpt_recorder_close(record->recorder, &record->counts);
    record->recorder = NULL;
    if (counts->dropped)
        host_note(error, "%s: %" PRIu64 " of %" PRIu64 " records were dropped: the disk was too slow", record->path,
                  counts->dropped, counts->pushed);
    if (result != DPT_OK)
        result = host_refuse(error, result, "%s: %" PRIu64 " of %" PRIu64 " records could not be written: %s",
                             record->path, counts->lost, counts->pushed, strerror((int)counts->error));
    free(record->path);
    record->path = NULL;
    return result;
}

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
    const struct scene_needle needle = scene_get_needle(scene);
    dpt_tool_get_proxy(scene->stage.world, scene->stage.tool, &record->proxy);
    record->flags |= DPT_RECORD_FLAG_FELT | (scene->bodies.is_held ? DPT_RECORD_FLAG_BODY_HELD : 0u);
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
    record->depth = needle.depth;
    record->inside = needle.inside;
    record->ruptures = needle.ruptures;
    record->layers = needle.layers;
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
