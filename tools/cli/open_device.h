/* SPDX-License-Identifier: BSD-3-Clause */
/* Open a device by the name that --device takes. */
#ifndef DPT_TOOLS_OPEN_DEVICE_H
#define DPT_TOOLS_OPEN_DEVICE_H

#include "dynpoint/device.h"

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

#endif
