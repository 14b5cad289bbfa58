/* SPDX-License-Identifier: BSD-3-Clause */
/* Methods of a body with a compliance, whose physics is somebody else's: what it gets, and what it answered. */
#ifndef PYTHON_ANSWER_H
#define PYTHON_ANSWER_H

#include "bindings/python/python_error.h"

/*
 * get_mean_loads(out): how many there are, and of how many seconds they are the mean; they are in `out` if it has room for
 * all.
 */
PyObject *dpy_get_mean_loads(PyObject *body, PyObject *out);

/* set_answered_loads(loads): structs, which the positions that are set next hold. */
PyObject *dpy_set_answered_loads(PyObject *body, PyObject *loads);

#endif
