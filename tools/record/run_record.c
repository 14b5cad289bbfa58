/* SPDX-License-Identifier: BSD-3-Clause */
#include "record/run_record.h"

#include <ctype.h>
#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "cli/command_options.h"
#include "clock.h"
#include "record/scene_record.h"
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
                    const char *device, double rate, double force_max, uint32_t budget)
{
    *record = (struct run_record){ .path = path,
                                   .is_timed = !(scene->device.flags & DPT_DEVICE_FLAG_DETERMINISTIC),
                                   .counts.size = sizeof record->counts };
    struct scene_text *text = malloc(sizeof *text);
    char *words = malloc(DPT_RECORD_TEXT_MAX + 1);
    int status = text && words ? 0 : complain("run", "memory ran out");
    if (status == 0) {
        scene_text_of(text, scene, def);
        snprintf(text->device, sizeof text->device, "%s", device);
        text->force_max = force_max;
        text->budget = budget;
        status = scene_text_write(text, scene, words);
    }
    if (status == 0) {
        const dpt_record_header header = { .size = sizeof header,
                                           .rate = rate,
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
