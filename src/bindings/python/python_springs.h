/* SPDX-License-Identifier: BSD-3-Clause */
/* dynpoint._dynpoint.Springs: masses and springs of a mesh, stepped over time. */
#ifndef PYTHON_SPRINGS_H
#define PYTHON_SPRINGS_H

#include "bindings/python/python_numbers.h"

#include "dynpoint/springs.h"

/* The springs of an object that the caller is in until dpy_springs_leave, or NULL with an exception. */
dpt_springs *dpy_springs_enter(PyObject *object, const char *what);
void dpy_springs_leave(PyObject *object);

int dpy_springs_init(PyObject *module);

#endif
