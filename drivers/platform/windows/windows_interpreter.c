/* SPDX-License-Identifier: BSD-3-Clause */
/* Ctrl-C, for an interpreter's extension: in the C library that both share, as Python's own handler is. */
#include <signal.h>

#include "platform/interpreter.h"

static void (*call_stop)(void);
static void (*before)(int);

int forks_watch(void (*call)(void))
{
    (void)call;
    return 0;
}

/* A handler is called once. */
static void on_interrupt(int number)
{
    signal(number, on_interrupt);
    call_stop();
}

void interrupts_take(void (*stop)(void))
{
    call_stop = stop;
    before = signal(SIGINT, on_interrupt);
    if (before == SIG_IGN)
        signal(SIGINT, SIG_IGN);
}

void interrupts_give_back(void)
{
    if (before != SIG_IGN && before != SIG_ERR)
        signal(SIGINT, before);
}
