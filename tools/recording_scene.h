/* SPDX-License-Identifier: BSD-3-Clause */
/* The scene of a recording, made again from its header's text. */
#ifndef DPT_TOOLS_RECORDING_SCENE_H
#define DPT_TOOLS_RECORDING_SCENE_H

#include "scene_text.h"

/*
 * Make it, with its world. The files must be those of the recording, by length and CRC-32. Returns 0, or 2 after a message.
 * Close the scene in any case.
 *   scene_path, tool_path   where the files are; NULL: where the text says
 */
int recording_scene_open(struct scene *scene, const char *command, const struct scene_text *text,
                         const char *scene_path, const char *tool_path);

#endif
