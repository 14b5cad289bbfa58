/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * run_loop(device, tick, state, wrench, guard, stats, **settings): serve a device in this thread, as dpt_loop_run does.
 * tick(state, wrench, dt) fills `wrench`, or returns 6 numbers. After an exception in it, and Ctrl-C, the loop sends zero
 * force and ends, and the exception goes on.
 *   state, wrench, stats   arrays of one dpt_device_state, of 6 numbers, and of one dpt_loop_stats
 *   guard                  None, or a dict of dpt_guard_def's fields
 */
#ifndef PYTHON_LOOP_H
#define PYTHON_LOOP_H

#include "bindings/python/python_error.h"

PyObject *dpy_run_loop(PyObject *module, PyObject *args, PyObject *keywords);

#endif
