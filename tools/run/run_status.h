/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A line on the terminal that follows a run: its time, the force, how deep the tool is, what was late. A thread of its own
 * writes it, four times a second; the loop hands over its latest numbers and waits for nothing.
 */
#ifndef DPT_TOOLS_RUN_STATUS_H
#define DPT_TOOLS_RUN_STATUS_H

#include <pthread.h>

#include "dynpoint/exchange.h"

/* Of one tick. */
struct run_status_tick {
    double seconds; /* since the run began, by the device's time */
    double force;   /* N, before the guard */
    double depth;   /* m, the largest so far */
    double late;    /* s, the most so far */
    int touches;    /* 1: in contact */
};

/* Begin with zeros. */
struct run_status {
    dpt_latest latest;
    struct run_status_tick places[DPT_LATEST_PLACES];
    pthread_mutex_t lock; /* of is_ended */
    pthread_t thread;
    int is_open, is_ended;
};

/* Follow the run, if standard error is a terminal. */
void run_status_open(struct run_status *status);

/* In the loop's thread. Without a line it does nothing. */
void run_status_tell(struct run_status *status, const struct run_status_tick *tick);

/* End the thread and wipe the line. */
void run_status_close(struct run_status *status);

/* The line's text, without an end. */
void run_status_text(const struct run_status_tick *tick, char *text, size_t bytes);

#endif
