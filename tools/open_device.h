/* SPDX-License-Identifier: BSD-3-Clause */
/* A device by the name that --device takes. */
#ifndef DPT_TOOLS_OPEN_DEVICE_H
#define DPT_TOOLS_OPEN_DEVICE_H

#include "dynpoint/device.h"

/* 0, or 2 after the complaint; what is still to be done before there is force is printed too. */
int open_device(const char *command, const char *name, dpt_device **device);

/*
 * A fault that stands from before, as a host that died leaves it, is ended, and this said. 2 after the complaint where
 * it stays. One that has its own time is left alone: a read would be one of its samples.
 */
int end_fault(const char *command, const char *name, dpt_device *device);

#endif
