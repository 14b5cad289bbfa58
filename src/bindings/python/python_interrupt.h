/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Ctrl-C while a loop runs without Python: the signal's handler ends the loop, which then sends zero force; after that
 * whoever the signal was for gets it, Python as a rule.
 */
#ifndef PYTHON_INTERRUPT_H
#define PYTHON_INTERRUPT_H

#include "bindings/python/python_error.h"

typedef struct dpy_interrupt {
    void (*stop)(void *loop); /* may be called from a signal handler */
    void *loop;
    int place;
} dpy_interrupt;

/* Both with Python's lock. -1: more loops run than there is room for, and an exception is set. */
int dpy_interrupt_begin(dpy_interrupt *interrupt);

/* 0: none came, or it was for another thread, which is told; -1: KeyboardInterrupt is set. */
int dpy_interrupt_end(dpy_interrupt *interrupt);

/* In a child of a fork, by its handler: no loop of its parent's runs there, and Ctrl-C is its own. */
void dpy_interrupt_fork(void);

#endif
