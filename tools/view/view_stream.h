/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Messages for a viewer in order: a scene, frames, an end. Served one after the other, or written into a page that plays by
 * itself: the stream of docs/view.md, in base64, at the page's place for data.
 */
#ifndef DPT_TOOLS_VIEW_STREAM_H
#define DPT_TOOLS_VIEW_STREAM_H

#include <stdint.h>
#include <stdio.h>

#include "view/page_bytes.h"
#include "view/server/view_server.h"

/* Begin with zeros. */
struct view_stream {
    struct view_message *message; /* their bytes are the stream's */
    size_t count, room;
    uint64_t bytes;
};

/* Takes bytes of malloc, also if it fails. Returns 0 if memory ran out, also for NULL. */
int view_stream_add(struct view_stream *stream, void *bytes, size_t size);

/* The end: a text in UTF-8 that says why. */
int view_stream_add_end(struct view_stream *stream, const char *text);

/* Write the page with the stream in it. Errors are left in the file's error flag. Returns 0 if the page has no place for it. */
int view_stream_write_page(const struct view_stream *stream, const struct view_page *page, FILE *file);

void view_stream_free(struct view_stream *stream);

#endif
