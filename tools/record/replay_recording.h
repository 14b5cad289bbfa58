/* SPDX-License-Identifier: BSD-3-Clause */
/* dynpoint replay of a recording: make its scene again, step it by what was recorded, and compare every answer. */
#ifndef DPT_TOOLS_REPLAY_RECORDING_H
#define DPT_TOOLS_REPLAY_RECORDING_H

/* The command's arguments, the first operand being a recording. Returns the exit status. */
int replay_recording(int argc, char **argv);

#endif
