/* SPDX-License-Identifier: BSD-3-Clause */
#include "bindings/python/python_interrupt.h"

#include <signal.h>

#include "platform/interpreter.h"

enum { LOOPS_MAX = 16 };

/* Loops that run now. The handler reads it; a place is taken and given back with Python's lock. */
static dpy_interrupt *volatile running[LOOPS_MAX];
static volatile sig_atomic_t came;
static int count;

static void end_loops(void)
{
    came = 1;
    for (int i = 0; i < LOOPS_MAX; i++) {
        dpy_interrupt *interrupt = running[i];
        if (interrupt)
            interrupt->stop(interrupt->loop);
    }
}

int dpy_interrupt_begin(dpy_interrupt *interrupt)
{
    int place = 0;
    while (place < LOOPS_MAX && running[place])
        place++;
    if (place == LOOPS_MAX) {
        PyErr_Format(PyExc_RuntimeError, "%d loops run already", LOOPS_MAX);
        return -1;
    }
    interrupt->place = place;
    running[place] = interrupt;
    if (count++ > 0)
        return 0;
    came = 0;
    interrupts_take(end_loops);
    return 0;
}

int dpy_interrupt_end(dpy_interrupt *interrupt)
{
    if (running[interrupt->place] != interrupt)
        return 0; /* it ran in the process that this one is a fork of */
    running[interrupt->place] = NULL;
    if (--count > 0)
        return 0;
    interrupts_give_back();
    if (!came)
        return 0;
    came = 0;
    raise(SIGINT); /* to whom it was for: Python, or the system, which ends the program */
    return PyErr_CheckSignals();
}

void dpy_interrupt_fork(void)
{
    for (int i = 0; i < LOOPS_MAX; i++)
        running[i] = NULL;
    if (count > 0)
        interrupts_give_back();
    count = 0;
    came = 0;
}
