/* SPDX-License-Identifier: BSD-3-Clause */
/* The first message to a viewer: what is to be seen, with the meshes of the bodies (docs/view.md, "Messages"). */
#ifndef DPT_TOOLS_VIEW_SCENE_H
#define DPT_TOOLS_VIEW_SCENE_H

#include "dynpoint/mesh.h"
#include "scene/scene.h"
#include "view/view_stream.h"

struct view_scene_body {
    const char *name;
    const dpt_mesh *mesh; /* several bodies may share one; it is sent once */
    uint32_t id;
    dpt_pose pose;
    const double *colour; /* red, green, blue, 0 to 1; NULL: the page's */
    enum body_look look;
};

/* Texts are of files and users: any bytes. */
struct view_scene {
    const char *title;
    const char *mode;   /* "live", "recording" or "mesh" */
    const char *device; /* its name; NULL: there is none */
    int is_simulated, has_workspace;
    double rate;          /* Hz, of the device's loop */
    double workspace[6];  /* of the tool, in the scene's frame: three least coordinates, three largest */
    int has_control;      /* the simulated hand may be steered */
    const char *up;       /* "y" or "z" */
    const double *camera; /* position, target, up: nine numbers; NULL: the page's */
    const double *inset;  /* of a second, small view: likewise; NULL: none */
    double force_max;     /* N; 0: not known */
    enum tool_look look;
    const struct scene_dress *dress;
    int has_jaws; /* they move: ticks say how far they are open */
    const struct view_scene_body *bodies;
    uint32_t body_count;
};

/* Make the message. Returns its bytes, for free(), or NULL: memory ran out, or the meshes have more than 2 GB. */
void *view_scene_message(const struct view_scene *scene, size_t *size);

/* What a viewer is told of a scene: the message with its meshes, and a tick for the plots. */

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
