/* SPDX-License-Identifier: BSD-3-Clause */
/* dynpoint replay of a recording: make its scene again, step it by what was recorded, and compare every answer. */
#ifndef DPT_TOOLS_REPLAY_RECORDING_H
#define DPT_TOOLS_REPLAY_RECORDING_H

#include "host/host_session.h"
#include "record/recording_embed.h"

/* The command's arguments, the first operand being a recording. Returns the exit status. */
int replay_recording(int argc, char **argv);

/* The scene of a recording, made again from its header's text. */

/* Which files of the scene come from the recording itself. */
void recording_scene_embedded(const struct scene_text *text, const char *scene_path, const char *tool_path,
                              int embedded[EMBED_FILES]);

/*
 * Make it, with its world and its controller. The files must be those of the recording, by length and CRC-32. A file
 * whose path is NULL is the one that the recording carries; if it carries none, the one where its text says. Returns 0, or 2 after a message.
 * Close the session's scene in any case.
 *   path                    of the recording
 *   scene_path, tool_path   where the files are, or NULL
 */
int recording_session_open(struct host_session *session, const char *command, const char *path,
                           const struct scene_text *text, const char *scene_path, const char *tool_path);

#endif
