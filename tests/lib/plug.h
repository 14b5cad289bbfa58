/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Pulls of the plug while docs/samples/safe_device.c pushes: how it ends after each kind of pull and what it says then, and
 * what came of them. What is pulled, and how the other end is watched, is the test's.
 *
 *     struct plug plug = { .kinds = kinds, .kind_count = KINDS, .wait_for = ..., .is_pushing = ... };
 *     plug_pull_all(&plug, pulls, run_host, pull_once);
 */
#ifndef DPT_TESTS_PLUG_H
#define DPT_TESTS_PLUG_H

#include <stdint.h>

#include "lib/child.h"

struct plug_kind {
    const char *name;
    int goes_on; /* without force, until it is interrupted; else it ends by itself */
    int status;  /* with which it ends */
    const char *says;

    /* What came of the pulls. */
    unsigned pulls, running, pushing;
    unsigned longest; /* ms from the pull to the end of the force; 0: not looked at */
    unsigned guarded; /* commands with a force until the guard had ended it; 0: not looked at */
};

struct plug {
    struct plug_kind *kinds;
    int kind_count;
    struct child host; /* safe_device */
    /* Wait for so many seconds, or until `enough` says so; whether it did. */
    int (*wait_for)(double seconds, int (*enough)(void));
    int (*has_ended)(void); /* the host */
    int (*is_pushing)(void);
    double patience;  /* s, for the host to end */
    const char *busy; /* what a busy machine does */
};

/* Send the host the signal of a kind: SIGKILL where its status says so, SIGSTOP where it goes on, else SIGINT. */
void plug_signal(const struct plug *plug, const struct plug_kind *kind);

/* It has pushed too early or not at all: end it. On a busy machine it may have ended before. */
void plug_give_up(struct plug *plug);

/*
 * How the host ends after a pull, and what it says then.
 *   was_running   it had sent commands when the plug was pulled
 */
void plug_check_end(struct plug *plug, const struct plug_kind *kind, int was_running);

/* Count a pull. ms: from it to the end of the force; 0 where that is not looked at. */
void plug_note(struct plug_kind *kind, int was_running, int was_pushing, unsigned ms, unsigned guarded);

/*
 * So many pulls, of one kind after another, half of them while it pushes; print what came of them. At least a quarter must
 * be with a force.
 *   run    begin; 0: the machine is too busy, try again
 *   pull   once
 */
void plug_pull_all(struct plug *plug, unsigned long pulls, int (*run)(int must_push), void (*pull)(int kind));

#endif
