/* SPDX-License-Identifier: BSD-3-Clause */
/* What the user says of a scene: by the options of a command, and in a scene file. The options win. */
#ifndef DPT_SCENE_DEF_H
#define DPT_SCENE_DEF_H

#include "scene/force_options.h"
#include "scene/scene_file.h"
#include "scene/scene_tips.h"

/* A file's bytes, as they are in the file. */
struct scene_bytes {
    const void *bytes;
    size_t size;
};

struct scene_def {
    /* Of the program: what its own messages begin with, and its options are what texts name. "": they name fields. */
    const char *command;
    const char *path; /* of a compiled mesh or arm, of a scene file, or a name of scene_list.h */
    /* Path of a compiled arm whose tool is used. NULL: the scene's own tool, or the stylus if it has none. */
    const char *tool;
    /* Of the path and of the tool. If there are any, the scene takes a copy, and no file is opened. */
    struct scene_bytes scene_bytes, tool_bytes;
    /* Where the device's origin is in the scene's frame, m. Not given: above the bodies, or at the arm's middle. */
    double origin[3];
    int has_origin;
    double zoom;        /* metres of the scene for one metre of the hand */
    double force_scale; /* newtons at the hand for one of the scene */
    int clutch;         /* number of the button that holds the tool where it is; -1: none */
    double length;      /* of the stylus, m */
    double radius;      /* of the stylus, m */
    /* Of the tool, beside its segments. Given as a count above 0; after scene_def_complete those of the file count too. */
    struct tip_shapes tips;
    struct jaw_motion jaw; /* of the arm's tool */
    uint32_t piercing;     /* of scene_def_complete, from the file: DPT_PIERCING_... */
    struct force_options force;
    /* In place of a scene and of the tool's own segments: those of the caller, which stay until scene_open. Counts of 0: none. */
    const dpt_host_body *bodies;
    const dpt_segment *segments;
    uint32_t body_count, segment_count;
    double gravity;          /* m/s^2, of these bodies */
    double physics;          /* Hz, of what gives way, apart from the loop; 0: in each of its ticks */
    struct scene_file *file; /* of scene_def_read; NULL: the path is of no scene file */
};

/* A def in which nothing is given, of a command. */
void scene_def_init(struct scene_def *def, const char *command);

/*
 * Read the file if the path ends in .json; DPT_E_ABSENT for such a path in a build without jansson. Call scene_def_free
 * also after a failure.
 */
dpt_result scene_def_read(struct scene_def *def, dpt_host_error *error);
void scene_def_free(struct scene_def *def);

/*
 * After scene_def_read: what was not given is that of the scene, or else the default. Not given are numbers that are
 * NAN, a clutch of -1, NULL for the tool and for the law. Friction stays NAN if each body of a file has its own.
 */
dpt_result scene_def_complete(struct scene_def *def, const uint32_t *law, dpt_host_error *error);

/* 1 if a path is that of one of the scene's files, by whatever name: nothing may be written there. */
int scene_def_has_file(const struct scene_def *def, const char *path);

#endif
