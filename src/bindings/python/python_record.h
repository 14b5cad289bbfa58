/* SPDX-License-Identifier: BSD-3-Clause */
/* Records of a recording as bytes again (dynpoint/exports.py). */
#ifndef PYTHON_RECORD_H
#define PYTHON_RECORD_H

#include "bindings/python/python_error.h"

/* write_records(records): the bytes of a recording behind its header. */
PyObject *dpy_write_records(PyObject *module, PyObject *records);

#endif
