/* SPDX-License-Identifier: BSD-3-Clause */
/* The scenes in which a force may hum: those of scene_list.h, and real organs that are made soft. y is up. */
#ifndef DPT_TOOLS_HUM_SCENE_H
#define DPT_TOOLS_HUM_SCENE_H

#include "scene/scene_bodies.h"

struct hum_scene {
    struct scene_bodies bodies;
    int is_soft, is_below; /* the first body gives way; it falls on to the tool */
    int is_needle;         /* the tool pierces it, with its lower end */
    uint32_t integrator;   /* DPT_INTEGRATOR_..., the scene's own */
    double start[3];       /* m: over the first body, or under it, where a tool's surface begins */
    double length, radius; /* m, of the scene's stylus */
    double edge;           /* m: mean of the first body's edges */
};

/* Each returns 0 if the scene cannot be made. hum_scene_close is due in any case. */
int hum_scene_open(struct hum_scene *scene, const char *name);

/* A file of an organ in mm, with the springs of the scene soft-liver. It lies flat, and its lower part is fixed. */
int hum_scene_open_organ(struct hum_scene *scene, const char *path);

void hum_scene_close(struct hum_scene *scene);

#endif
