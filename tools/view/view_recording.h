/* SPDX-License-Identifier: BSD-3-Clause */
/* What a viewer shows of a recording: its scene, felt again tick by tick, as frames of 60 a second. */
#ifndef DPT_TOOLS_VIEW_RECORDING_H
#define DPT_TOOLS_VIEW_RECORDING_H

#include "view/view_stream.h"

struct view_recording_files {
    const char *recording;
    /* NULL: there is none, the program knows it by name, the recording carries it, or it is where it was. */
    const char *mesh; /* the file of its scene */
    const char *tool; /* of its tool's arm */
};

/*
 * Add all messages to a stream. A recording that ends early or is damaged is shown as far as it goes, and its end says so.
 * Returns 0, or 2 after a message. *is_wrong is 1, after a message too, if ticks failed or a body was held in it.
 */
int view_recording(struct view_stream *stream, const struct view_recording_files *files, int *is_wrong);

#endif
