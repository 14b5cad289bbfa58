/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What went wrong in the ticks of a scene: those that failed have no force, and those in which a body was held have the
 * force of all others. A command that counts any says so first, and exits with 2 (docs/index.md).
 */
#ifndef DPT_SCENE_TROUBLE_H
#define DPT_SCENE_TROUBLE_H

#include "scene/scene.h"

/* Begin with zeros. */
struct scene_trouble {
    uint64_t ticks, failed;
    uint64_t failed_first; /* number of the tick, from 0 */
    dpt_result why;        /* of that one, and its length, s */
    double dt;
};

/*
 * After scene_feel, which returned `result`. Neither a first sample, before which no time has passed, nor what the clutch
 * holds back is a failure. Returns 1 if it was one.
 */
int scene_trouble_note(struct scene_trouble *trouble, const struct scene *scene, const dpt_loop_sample *sample,
                       dpt_result result);

enum { SCENE_TROUBLE_BYTES = 640 };

/* Write it as one line, without its end; "", and 0 is returned, if all went well. */
int scene_trouble_text(const struct scene_trouble *trouble, const struct scene *scene, char text[SCENE_TROUBLE_BYTES]);

#endif
