/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A program that a test starts and watches: what it says, on both of its outputs, and how it ends.
 *
 *     char *const words[] = { "build/tests/safe_device", "membrane", "sim", NULL };
 *     child_start(&child, words);
 *     kill(child.process, SIGINT);
 *     if (child_end(&child, 5.0)) ... child.status, child.text
 */
#ifndef DPT_TESTS_CHILD_H
#define DPT_TESTS_CHILD_H

#include <sys/types.h>

struct child {
    pid_t process; /* 0: it has ended */
    int from;
    int status; /* of exit; 128 and the signal; -1: it did not end */
    char text[4096];
};

/* 0 and a status of 127, if it cannot be started. */
int child_start(struct child *child, char *const *words);

/* Whether it has ended; child_end is still to be called. */
int child_has_ended(const struct child *child);

/* Wait until it ends, so many seconds at most, and take what it says; 1 if it did. Else it is killed. */
int child_end(struct child *child, double seconds);

#endif
