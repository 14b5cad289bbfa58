/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A program that runs until it is interrupted: SIGINT and SIGTERM end it in order, and so do a terminal that is closed
 * and a pipe that no one reads (SIGHUP, SIGPIPE), as it may have motors to switch off.
 */
#ifndef DPT_TOOLS_STOP_H
#define DPT_TOOLS_STOP_H

#include "dynpoint/loop.h"

/* Watch for them from here on, and for the end of so many seconds; `loop`, which may be NULL, is stopped too. */
void stop_watch(dpt_loop *loop, double seconds);

/* Not 0 after one. */
int stop_requested(void);
const volatile int *stop_flag(void);

/* Monotonic, in s. */
double seconds_now(void);
void sleep_seconds(double seconds);

#endif
