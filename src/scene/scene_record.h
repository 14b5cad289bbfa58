/* SPDX-License-Identifier: BSD-3-Clause */
/* The recording of a scene's ticks, written while they last (dynpoint/recorder.h). */
#ifndef DPT_SCENE_RECORD_H
#define DPT_SCENE_RECORD_H

#include "dynpoint/loop.h"
#include "dynpoint/record.h"
#include "dynpoint/recorder.h"
#include "scene/scene_text.h"

/* Begin with zeros. */
struct scene_record {
    dpt_recorder *recorder; /* NULL: nothing is recorded */
    char *path;
    int is_timed;               /* how long a step takes is recorded, by the clock */
    uint64_t began_ns;          /* of the step that runs */
    dpt_recorder_counts counts; /* after scene_record_close */
};

/*
 * Begin a recording of a scene whose world was made.
 *   text   what a replay needs
 *   rate   of the loop, Hz
 *   waits  1: the device has a time of its own, so that the loop may wait for the disk; 0: records are dropped then
 */
dpt_result scene_record_open(struct scene_record *record, const char *path, const struct scene *scene,
                             const struct scene_text *text, double rate, int waits, dpt_host_error *error);

/* Before and after a step of the scene, and in a tick without one. Without a recording they do nothing. */
void scene_record_begin(struct scene_record *record);
void scene_record_tick(struct scene_record *record, const struct scene *scene, const dpt_loop_sample *sample,
                       dpt_result result, const dpt_wrench *wrench);
void scene_record_idle(struct scene_record *record, const dpt_loop_sample *sample);

/* End it. An error says what could not be written, a note what was dropped. */
dpt_result scene_record_close(struct scene_record *record, dpt_host_error *error);

/* A tick of a scene as a record, and back. */

/* A record of a sample, without answers. */
dpt_record record_of_sample(const dpt_loop_sample *sample);

/* Fill in what the scene answered to the sample that it felt last. */
void record_answers(dpt_record *record, const struct scene *scene, dpt_result result, const dpt_wrench *wrench);

/* The sample that a record was made of. `state` and `info` are what it points to. */
dpt_loop_sample sample_of_record(const dpt_record *record, dpt_device_state *state, const dpt_device_info *info);

#endif
