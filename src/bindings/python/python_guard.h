/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef PYTHON_GUARD_H
#define PYTHON_GUARD_H

#include "bindings/python/python_numbers.h"

int dpy_guard_init(PyObject *module);

#endif
