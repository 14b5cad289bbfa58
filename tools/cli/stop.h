/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * For a program that runs until it is interrupted. SIGINT, SIGTERM, a closed terminal (SIGHUP) and a pipe without a
 * reader (SIGPIPE) end it in order, because it may have to switch motors off.
 */
#ifndef DPT_TOOLS_STOP_H
#define DPT_TOOLS_STOP_H

#include "dynpoint/loop.h"

/* From now on watch for these signals and for the end of `seconds`. They also stop `loop`, which may be NULL. */
void stop_watch(dpt_loop *loop, double seconds);

/* Not 0 after a signal. */
int stop_requested(void);
const volatile int *stop_flag(void);

/* The monotonic clock, s. */
double seconds_now(void);
void sleep_seconds(double seconds);

#endif
