/* SPDX-License-Identifier: BSD-3-Clause */
#include "record/run_record.h"

#include <ctype.h>
#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "cli/command_options.h"
#include "clock.h"
#include "record/scene_text.h"

int is_trace_name(const char *path)
{
    static const char ending[] = ".csv";
    const size_t length = strlen(path);
    if (length < sizeof ending - 1)
        return 0;
    for (size_t i = 0; i < sizeof ending - 1; i++)
        if (tolower((unsigned char)path[length - (sizeof ending - 1) + i]) != ending[i])
            return 0;
    return 1;
}

static int open_recorder(struct run_record *record, const dpt_record_header *header)
{
    dpt_recorder_def def;
    dpt_recorder_def_init(&def);
    def.wait = !record->is_timed;
    const dpt_result result = dpt_recorder_open(record->path, header, &def, &record->recorder);
    if (result == DPT_OK)
        return 0;
    return complain("run", "%s: cannot be written: %s", record->path,
                    result == DPT_E_OPEN || result == DPT_E_WRITE ? strerror(errno) : dpt_result_text(result));
}

int run_record_open(struct run_record *record, const char *path, const struct scene *scene, const struct scene_def *def,
                    const struct measure_setting *planned, const struct scene_hand *hand, uint32_t budget)
{
    *record = (struct run_record){ .path = path,
                                   .is_timed = !(scene->device.flags & DPT_DEVICE_FLAG_DETERMINISTIC),
                                   .counts.size = sizeof record->counts };
    struct scene_text *text = malloc(sizeof *text);
    char *words = malloc(DPT_RECORD_TEXT_MAX + 1);
    int status = text && words ? 0 : complain("run", "memory ran out");
    if (status == 0) {
        scene_text_of(text, scene, def, planned);
        snprintf(text->device, sizeof text->device, "%s", hand->name);
        text->force_max = hand->force_max;
        text->budget = budget;
        status = scene_text_write(text, scene, words);
    }
    if (status == 0) {
        const dpt_record_header header = { .size = sizeof header,
                                           .rate = hand->rate,
                                           .began_ns = record->is_timed ? clock_wall() : 0,
                                           .text = words,
                                           .text_bytes = strlen(words) };
        status = open_recorder(record, &header);
    }
    free(text);
    free(words);
    return status;
}

void run_record_begin(struct run_record *record)
{
    if (record->recorder && record->is_timed)
        record->began_ns = clock_now();
}

void run_record_tick(struct run_record *record, const struct scene *scene, const dpt_loop_sample *sample,
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

void run_record_idle(struct run_record *record, const dpt_loop_sample *sample)
{
    if (!record->recorder)
        return;
    const dpt_record tick = record_of_sample(sample);
    dpt_recorder_push(record->recorder, &tick);
}

int run_record_close(struct run_record *record)
{
    const dpt_recorder_counts *counts = &record->counts;
    if (!record->recorder)
        return 0;
    const dpt_result result = dpt_recorder_close(record->recorder, &record->counts);
    record->recorder = NULL;
    if (counts->dropped)
        complain("run", "%s: %" PRIu64 " of %" PRIu64 " records were dropped: the disk was too slow", record->path,
                 counts->dropped, counts->pushed);
    if (result == DPT_OK)
        return 0;
    return complain("run", "%s: %" PRIu64 " of %" PRIu64 " records could not be written: %s", record->path,
                    counts->lost, counts->pushed, strerror((int)counts->error));
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
    dpt_tool_get_proxy(scene->world, scene->tool, &record->proxy);
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

int run_trace_open(struct run_trace *trace, const char *path)
{
    return output_open(&trace->output, "run", path);
}

int run_trace_allocate(struct run_trace *trace, uint64_t capacity)
{
    trace->capacity = capacity;
    trace->rows = calloc(capacity, 6 * sizeof *trace->rows);
    return trace->rows ? 0 : complain("run", "memory ran out");
}

void run_trace_tick(struct run_trace *trace, const dpt_segment *stylus)
{
    if (trace->count == trace->capacity)
        return;
    double *row = trace->rows + 6 * trace->count++;
    memcpy(row, stylus->a, sizeof stylus->a);
    memcpy(row + 3, stylus->b, sizeof stylus->b);
}

int run_trace_write(struct run_trace *trace)
{
    struct output output = trace->output;
    FILE *file = output.file;
    trace->output.file = NULL;
    fputs("tick,ax,ay,az,bx,by,bz\n", file);
    for (uint64_t i = 0; i < trace->count; i++) {
        fprintf(file, "%" PRIu64, i);
        for (int k = 0; k < 6; k++)
            fprintf(file, ",%.17g", trace->rows[6 * i + (uint64_t)k]);
        fputc('\n', file);
    }
    return output_close(&output, "run");
}

void run_trace_close(struct run_trace *trace)
{
    if (trace->output.file) {
        fclose(trace->output.file);
        output_drop(&trace->output);
    }
    free(trace->rows);
}
