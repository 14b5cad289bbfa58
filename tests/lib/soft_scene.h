/* SPDX-License-Identifier: BSD-3-Clause */
/* A scene by name with soft bodies, and a ball that is pressed into it. */
#ifndef DPT_TESTS_SOFT_SCENE_H
#define DPT_TESTS_SOFT_SCENE_H

#include "lib/rig.h"
#include "scene/scene_bodies.h"

#define SOFT_TICK 1e-3 /* s */

struct soft_scene {
    struct scene_bodies bodies;
    struct rig rig;
    dpt_pose pose; /* of the ball */
    double top[3]; /* of the first body */
};

/*
 * The ball is felt by that law. Physics at this rate, Hz, for which vertices move smoothly; 0: in each tick. Returns 0
 * after a failed check. Close it in any case.
 */
int soft_scene_open(struct soft_scene *scene, const char *name, double rate, uint32_t law);
void soft_scene_close(struct soft_scene *scene);

/* The ball goes down by so much from where it touches, m. */
void soft_scene_press(struct soft_scene *scene, double depth);

/* A step of the world. */
void soft_scene_step(struct soft_scene *scene);

/* Of the first body: 3 numbers a vertex. */
const float *soft_scene_vertices(const struct soft_scene *scene, uint32_t *count);

#endif
