/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef PYTHON_SCENE_H
#define PYTHON_SCENE_H

#include "bindings/python/python_numbers.h"

int dpy_scene_init(PyObject *module);

#endif
