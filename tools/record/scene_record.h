/* SPDX-License-Identifier: BSD-3-Clause */
/* A tick of a scene as a record, and back. */
#ifndef DPT_TOOLS_SCENE_RECORD_H
#define DPT_TOOLS_SCENE_RECORD_H

#include "dynpoint/loop.h"
#include "dynpoint/record.h"
#include "scene/scene.h"

/* A record of a sample, without answers. */
dpt_record record_of_sample(const dpt_loop_sample *sample);

/* Fill in what the scene answered to the sample that it felt last. */
void record_answers(dpt_record *record, const struct scene *scene, dpt_result result, const dpt_wrench *wrench);

/* The sample that a record was made of. `state` and `info` are what it points to. */
dpt_loop_sample sample_of_record(const dpt_record *record, dpt_device_state *state, const dpt_device_info *info);

#endif
