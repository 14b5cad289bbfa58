/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * dynpoint._dynpoint.Device: an open device. Before its handle closes, by close, by the collector or at the interpreter's
 * end, it is sent zero force; in a fork of the process nothing is sent.
 */
#ifndef PYTHON_DEVICE_H
#define PYTHON_DEVICE_H

#include "bindings/python/python_numbers.h"

#include "dynpoint/device.h"

/* The device of an object that the caller is in until dpy_device_leave, or NULL with an exception. */
dpt_device *dpy_device_enter(PyObject *object, const char *what);
void dpy_device_leave(PyObject *object);

int dpy_device_init(PyObject *module);

#endif
