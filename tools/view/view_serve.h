/* SPDX-License-Identifier: BSD-3-Clause */
/* Serve the viewer's page, and tell the user where: what `dynpoint view` and `dynpoint run --view` share. */
#ifndef DPT_TOOLS_VIEW_SERVE_H
#define DPT_TOOLS_VIEW_SERVE_H

#include <stddef.h>

#include "dynpoint/loop.h"
#include "scene/scene.h"
#include "view/server/view_server.h"

/* The viewers of a run: a page in a browser, served by a thread of its own beside the haptic loop. */

/* Begin with zeros: no viewer. */
struct run_view_options {
    int is_on;
    int open;            /* a browser */
    int control;         /* the page may steer a simulated hand */
    uint64_t port;       /* 0: a free one */
    const char *address; /* NULL: this machine alone */
};

/* Refuse options that do not go together. Returns 0, or 2 after a message. */
int run_view_check(const char *command, const struct run_view_options *options);

struct run_view_report {
    uint64_t made, taken; /* snapshots, and those that the serving thread took */
    uint64_t sent;        /* frames, to all pages */
};

struct run_view;

/*
 * Serve a scene whose world was made. Says on standard output where. *view is NULL without viewers. Returns 0, or 2 after a
 * message. The device stays open until run_view_close.
 */
int run_view_open(struct run_view **view, const struct run_view_options *options, const struct scene *scene,
                  const char *title, const struct scene_hand *hand);

/* What became of the snapshots, if there were any: a line, or a key of a JSON object and the comma before it. */
void run_view_print(const struct run_view_report *report, int json);

/* Before and after a step of the scene. Without viewers (NULL) they do nothing. */
void run_view_begin(struct run_view *view);
void run_view_tick(struct run_view *view, const struct scene *scene, const dpt_loop_sample *sample);

/* The run ended: tell the pages why, and stop to serve. NULL is fine. */
void run_view_close(struct run_view *view, const char *why, struct run_view_report *report);

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
