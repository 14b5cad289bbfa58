/* SPDX-License-Identifier: BSD-3-Clause */
/* What a viewer is told of a scene: the message with its meshes, and a tick for the plots. */
#ifndef DPT_TOOLS_SCENE_PICTURE_H
#define DPT_TOOLS_SCENE_PICTURE_H

#include "scene/scene.h"
#include "view/view_frame.h"

struct scene_picture {
    const char *title, *mode, *device; /* as in view_scene.h */
    double rate, force_max;
    int has_control;
};

/* The message, for free(); NULL: memory ran out. The scene's world was made. */
void *scene_picture_message(const struct scene *scene, const struct scene_picture *picture, size_t *size);

/* Vertices of all bodies that deform. */
uint32_t scene_picture_vertices(const struct scene *scene);

/*
 * After a step.
 *   time   of the scene, s
 *   took   the step's time, s
 */
struct view_tick scene_picture_tick(const struct scene *scene, const dpt_loop_sample *sample, double time, double took);

#endif
