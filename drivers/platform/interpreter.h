/* SPDX-License-Identifier: BSD-3-Clause */
/* What an extension of an interpreter asks of a process that is not its own: forks and Ctrl-C. */
#ifndef DPT_PLATFORM_INTERPRETER_H
#define DPT_PLATFORM_INTERPRETER_H

/* Call `call` first in each child of a fork, from now on. Nonzero: that cannot be had. Windows has no forks. */
int forks_watch(void (*call)(void));

/*
 * From now on Ctrl-C calls `stop`, from a signal or from another thread, in place of what the interpreter does then;
 * until interrupts_give_back. A process that does not listen to Ctrl-C goes on so. One at a time; both from one thread
 * at a time.
 */
void interrupts_take(void (*stop)(void));
void interrupts_give_back(void);

#endif
