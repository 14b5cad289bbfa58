/* SPDX-License-Identifier: BSD-3-Clause */
/* The viewers of a run: a page in a browser, served by a thread of its own beside the haptic loop. */
#ifndef DPT_TOOLS_RUN_VIEW_H
#define DPT_TOOLS_RUN_VIEW_H

#include "dynpoint/loop.h"
#include "scene/scene.h"

/* Begin with zeros: no viewer. */
struct run_view_options {
    int is_on;
    int open;            /* a browser */
    int control;         /* the page may steer a simulated hand */
    uint64_t port;       /* 0: a free one */
    const char *address; /* NULL: this machine alone */
    int json;            /* its address is told as a JSON object */
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

/* Before and after a step of the scene, which returned `result`. Without viewers (NULL) they do nothing. */
void run_view_begin(struct run_view *view);
void run_view_tick(struct run_view *view, const dpt_loop_sample *sample, dpt_result result);

/* The run ended: tell the pages why, and stop to serve. NULL is fine. */
void run_view_close(struct run_view *view, const char *why, struct run_view_report *report);

#endif
