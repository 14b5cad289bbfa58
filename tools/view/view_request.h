/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What a viewer's page may say to the server, once its token was accepted. A pure function of bytes that anyone may have
 * sent.
 *
 *     ready           the scene was read, frames may come
 *     drawn           one more frame was drawn
 *     hand X Y Z      where the simulated hand is to go: decimal numbers, m, in the scene's frame
 *
 * Words and numbers are separated by one space. Nothing comes before, after or between.
 */
#ifndef DPT_TOOLS_VIEW_REQUEST_H
#define DPT_TOOLS_VIEW_REQUEST_H

#include <stddef.h>

/* The longest message that the server takes, bytes. */
#define VIEW_REQUEST_BYTES_MAX 4096u
/* The largest coordinate of a hand, m. */
#define VIEW_REQUEST_HAND_MAX 1e6

enum view_request_kind { VIEW_REQUEST_UNKNOWN, VIEW_REQUEST_READY, VIEW_REQUEST_DRAWN, VIEW_REQUEST_HAND };

struct view_request {
    enum view_request_kind kind;
    double position[3]; /* of a hand: finite, within VIEW_REQUEST_HAND_MAX; else 0 */
};

/* `text` needs no zero at its end. Returns the kind. */
enum view_request_kind view_request_parse(const char *text, size_t size, struct view_request *request);

#endif
