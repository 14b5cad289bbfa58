/* SPDX-License-Identifier: BSD-3-Clause */
/* The recording of a run, written while it lasts. */
#ifndef DPT_TOOLS_RUN_RECORD_H
#define DPT_TOOLS_RUN_RECORD_H

#include "dynpoint/loop.h"
#include "dynpoint/recorder.h"
#include "scene/scene.h"

struct run_record {
    dpt_recorder *recorder; /* NULL: nothing is recorded */
    const char *path;
    int is_timed;               /* the device's time is the clock's */
    uint64_t began_ns;          /* of the step that runs */
    dpt_recorder_counts counts; /* after run_record_close */
};

/* 1 if the path ends in .csv: a trace is wanted, and no recording. */
int is_trace_name(const char *path);

/*
 * Begin a recording of a scene whose world was made. Returns 0, or 2 after a message.
 *   device      its name as it was given
 *   rate        Hz
 *   force_max   of the guard, N
 */
int run_record_open(struct run_record *record, const char *path, const struct scene *scene, const struct scene_def *def,
                    const char *device, double rate, double force_max, uint32_t budget);

/* Before and after a step of the scene, and in a tick without one. Without a recording they do nothing. */
void run_record_begin(struct run_record *record);
void run_record_tick(struct run_record *record, const struct scene *scene, const dpt_loop_sample *sample,
                     dpt_result result, const dpt_wrench *wrench);
void run_record_idle(struct run_record *record, const dpt_loop_sample *sample);

/* End it. Returns 0, or 2 after a message: some of it could not be written. */
int run_record_close(struct run_record *record);

#endif
