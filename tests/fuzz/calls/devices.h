/* SPDX-License-Identifier: BSD-3-Clause */
/* What calls of devices and of loops share. */
#ifndef DPT_TESTS_CALLS_DEVICES_H
#define DPT_TESTS_CALLS_DEVICES_H

#include "dynpoint/device.h"
#include "fuzz/calls/calls.h"

/* Of a device with a time of its own; valid until the next draw. */
const char *draw_device_name(void);

#endif
