/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A scene as a command opens it. Each call says on standard error what it has to say, and returns 0, or 2, the exit
 * status. The host library's own calls have the contracts: scene/scene_def.h, scene/scene.h.
 */
#ifndef DPT_TOOLS_SCENE_COMMAND_H
#define DPT_TOOLS_SCENE_COMMAND_H

#include "cli/command_options.h"
#include "scene/scene.h"

int read_scene_def(struct scene_def *def);

/* law  the word of --law, or NULL */
int complete_scene_def(struct scene_def *def, const char *law);

/* The texts of --at, "X,Y,Z", and --tip. */
int read_origin(struct scene_def *def, const char *text);
int read_tip_shapes(struct tip_shapes *tips, const char *command, const struct option_texts *texts);

/* Refuse an output that is one of the scene's files. */
int check_scene_output(const struct scene_def *def, const char *path);

int open_scene(struct scene *scene, const struct scene_def *def);

#endif
