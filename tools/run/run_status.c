/* SPDX-License-Identifier: BSD-3-Clause */
#include "run/run_status.h"

#include <stdio.h>
#include <unistd.h>

#include "platform/clock.h"
#include "platform/thread.h"

enum { LETTERS = 72, PERIOD_NS = 250000000, PERIODS_SILENT = 4 };

void run_status_text(const struct run_status_tick *tick, char *text, size_t bytes)
{
    snprintf(text, bytes, "%6.1f s  %s %6.2f N  deepest %.2f mm  late %.0f us at most", tick->seconds,
             tick->touches ? "touches" : "free   ", tick->force, 1e3 * tick->depth, 1e6 * tick->late);
}

static int has_ended(struct run_status *status)
{
    pthread_mutex_lock(&status->lock);
    const int is_ended = status->is_ended;
    pthread_mutex_unlock(&status->lock);
    return is_ended;
}

/* A run that is over within a second has no line. */
static void *follow(void *user)
{
    struct run_status *status = user;
    int is_shown = 0;
    for (int period = 0; !has_ended(status); period++) {
        if (period >= PERIODS_SILENT && dpt_latest_take(&status->latest)) {
            char text[LETTERS + 1];
            run_status_text(&status->places[status->latest.reading], text, sizeof text);
            fprintf(stderr, "\r%-*s", LETTERS, text);
            is_shown = 1;
        }
        clock_sleep(PERIOD_NS);
    }
    if (is_shown)
        fprintf(stderr, "\r%*s\r", LETTERS, "");
    return NULL;
}

void run_status_open(struct run_status *status)
{
    dpt_latest_init(&status->latest);
    if (!isatty(STDERR_FILENO) || pthread_mutex_init(&status->lock, NULL) != 0)
        return;
    status->is_open = thread_start(&status->thread, follow, status) == 0;
    if (!status->is_open)
        pthread_mutex_destroy(&status->lock);
}

void run_status_tell(struct run_status *status, const struct run_status_tick *tick)
{
    if (!status->is_open)
        return;
    status->places[status->latest.writing] = *tick;
    dpt_latest_publish(&status->latest);
}

void run_status_close(struct run_status *status)
{
    if (!status->is_open)
        return;
    pthread_mutex_lock(&status->lock);
    status->is_ended = 1;
    pthread_mutex_unlock(&status->lock);
    pthread_join(status->thread, NULL);
    pthread_mutex_destroy(&status->lock);
    status->is_open = 0;
}
