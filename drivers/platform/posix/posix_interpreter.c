/* SPDX-License-Identifier: BSD-3-Clause */
/* Forks and Ctrl-C, for an interpreter's extension. */
#define _GNU_SOURCE
#include <pthread.h>
#include <signal.h>

#include "platform/interpreter.h"

static void (*call_stop)(void);
static struct sigaction before;

int forks_watch(void (*call)(void))
{
    return pthread_atfork(NULL, NULL, call);
}

static void on_interrupt(int number)
{
    (void)number;
    call_stop();
}

void interrupts_take(void (*stop)(void))
{
    struct sigaction action = { .sa_handler = on_interrupt };
    sigemptyset(&action.sa_mask);
    call_stop = stop;
    if (sigaction(SIGINT, NULL, &before) == 0 && before.sa_handler != SIG_IGN)
        sigaction(SIGINT, &action, NULL);
}

void interrupts_give_back(void)
{
    if (before.sa_handler != SIG_IGN)
        sigaction(SIGINT, &before, NULL);
}
