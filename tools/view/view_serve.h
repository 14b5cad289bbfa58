/* SPDX-License-Identifier: BSD-3-Clause */
/* Serve the viewer's page, and tell the user where: what `dynpoint view` and `dynpoint run --view` share. */
#ifndef DPT_TOOLS_VIEW_SERVE_H
#define DPT_TOOLS_VIEW_SERVE_H

#include <stddef.h>

#include "view/run_view.h"
#include "view/server/view_server.h"

/*
 * The viewer's page inside the program, and the Content-Security-Policy that goes with it. A build without node or
 * three.js has none (`make deps view` gets them).
 */

struct view_page {
    const char *html; /* NULL: there is none */
    size_t size;
    const char *csp; /* the header's value: one line, with a zero at its end */
};

struct view_page view_page_bytes(void);

/* As in view_server_def. */
struct view_source {
    const struct view_message *first;
    size_t first_count;
    int (*next)(void *user, struct view_message *frame);
    void (*heard_hand)(void *user, const double position[3]); /* NULL: nothing is steered */
    void *user;
};

struct view_served {
    uint64_t sent, refused;
};

struct view_serving;

/*
 * Serve. Prints the page's address on standard output, with its token; if a browser was opened, without it. Returns 0, or 2
 * after a message: this build lacks the page or libwebsockets, or the port is taken.
 */
int view_serve(const char *command, const struct run_view_options *options, const struct view_source *source,
               struct view_serving **serving);

/* Tell the pages why it ends, and end. NULL is fine. */
struct view_served view_serve_end(struct view_serving *serving, const char *why);

#endif
