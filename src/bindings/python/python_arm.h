/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef PYTHON_ARM_H
#define PYTHON_ARM_H

#include "bindings/python/python_numbers.h"

int dpy_arm_init(PyObject *module);

#endif
