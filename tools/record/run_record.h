/* SPDX-License-Identifier: BSD-3-Clause */
/* The recording of a run, written while it lasts. */
#ifndef DPT_TOOLS_RUN_RECORD_H
#define DPT_TOOLS_RUN_RECORD_H

#include "cli/command_options.h"
#include "dynpoint/loop.h"
#include "dynpoint/record.h"
#include "dynpoint/recorder.h"
#include "dynpoint/types.h"
#include "host/scene.h"

struct run_record {
    dpt_recorder *recorder; /* NULL: nothing is recorded */
    const char *path;
    int is_timed;               /* the device's time is the clock's */
    uint64_t began_ns;          /* of the step that runs */
    dpt_recorder_counts counts; /* after run_record_close */
};

/* 1 if the path ends in .csv: a trace is wanted, and no recording. */
int is_trace_name(const char *path);

struct measure_setting; /* measure/measure_setting.h */

/* Begin a recording of a scene whose world was made. planned: by a plan, or NULL. Returns 0, or 2 after a message. */
int run_record_open(struct run_record *record, const char *path, const struct scene *scene, const struct scene_def *def,
                    const struct measure_setting *planned, const struct scene_hand *hand, uint32_t budget);

/* Before and after a step of the scene, and in a tick without one. Without a recording they do nothing. */
void run_record_begin(struct run_record *record);
void run_record_tick(struct run_record *record, const struct scene *scene, const dpt_loop_sample *sample,
                     dpt_result result, const dpt_wrench *wrench);
void run_record_idle(struct run_record *record, const dpt_loop_sample *sample);

/* End it. Returns 0, or 2 after a message: some of it could not be written. */
int run_record_close(struct run_record *record);

/* A tick of a scene as a record, and back. */

/* A record of a sample, without answers. */
dpt_record record_of_sample(const dpt_loop_sample *sample);

/* Fill in what the scene answered to the sample that it felt last. */
void record_answers(dpt_record *record, const struct scene *scene, dpt_result result, const dpt_wrench *wrench);

/* The sample that a record was made of. `state` and `info` are what it points to. */
dpt_loop_sample sample_of_record(const dpt_record *record, dpt_device_state *state, const dpt_device_info *info);

/* How the stylus moved in a run, as a trace (F.csv): kept in memory, because a tick must not write. */

#define RUN_TRACE_MAX 100000000

/* Begin with zeros. */
struct run_trace {
    double *rows; /* six numbers a tick, or NULL */
    uint64_t count, capacity;
    struct output output; /* opened before anything moves, so that an error shows at once */
};

int run_trace_open(struct run_trace *trace, const char *path);

/* Make room. Returns 0, or 2 after a message. */
int run_trace_allocate(struct run_trace *trace, uint64_t capacity);

/* Without a trace, or without room, it does nothing. */
void run_trace_tick(struct run_trace *trace, const dpt_segment *stylus);

/* Returns 0, or 2 after a message. */
int run_trace_write(struct run_trace *trace);

/* Drop what was not written. */
void run_trace_close(struct run_trace *trace);

#endif
