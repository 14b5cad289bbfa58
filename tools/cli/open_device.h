/* SPDX-License-Identifier: BSD-3-Clause */
/* A program that holds a device: opened by the name that --device takes, and let go in order when it is interrupted. */
#ifndef DPT_TOOLS_OPEN_DEVICE_H
#define DPT_TOOLS_OPEN_DEVICE_H

#include "dynpoint/device.h"
#include "dynpoint/loop.h"

/* Open a device by the name that --device takes. */

/* Returns 0, or 2 after a message. Also prints what must still be done before there is force. */
int open_device(const char *command, const char *name, dpt_device **device);

/*
 * End a fault that the device has from before, for example because a host died, and print that. Returns 2 after a
 * message if the fault stays, else 0. A deterministic device is left alone, because a read would use up one of its
 * samples.
 */
int end_fault(const char *command, const char *name, dpt_device *device);

/*
 * Refuse an output that is one of the files in a device's name: its address or the value of a setting. Returns 0, or 2
 * after a message.
 */
int device_output_check(const char *command, const char *path, const char *name);

/*
 * For a program that runs until it is interrupted. SIGINT, SIGTERM, a closed terminal (SIGHUP) and a pipe without a
 * reader (SIGPIPE) end it in order, because it may have to switch motors off.
 */

/* From now on watch for these signals and for the end of `seconds`. They also stop `loop`, which may be NULL. */
void stop_watch(dpt_loop *loop, double seconds);

/* Not 0 after a signal. */
int stop_requested(void);
const volatile int *stop_flag(void);

/* The monotonic clock, s. */
double seconds_now(void);
void sleep_seconds(double seconds);

#endif
