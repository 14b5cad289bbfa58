/* SPDX-License-Identifier: BSD-3-Clause */
/* Many worlds stepped by one call, on several threads, without Python's lock (dynpoint/batch.py). */
#ifndef PYTHON_BATCH_H
#define PYTHON_BATCH_H

#include "bindings/python/python_error.h"

/*
 * step_batch(worlds, dt, threads, points, tools, bodies, results): worlds a tuple of n World. Each world's tick is: poses
 * and vertices, dpt_world_step, dpt_bodies_step_springs, answers; a thread takes the next world that none has. All arrays
 * have n rows, and no world depends on another, so the answers are the same on any number of threads.
 *   points   the largest max_points of bodies
 *   tools    for each a tuple of arrays: ids, poses, wrenches; and, or None: proxies, forces, hits, loads, how many
 *            loads, contacts, how many contacts
 *   bodies   for each: ids, poses, wrenches; and, or None: new vertices, what steps them (a tuple of Springs, or of None
 *            for a compliance), loads by vertex, and how many loads they are the sum of
 *   results  int32: DPT_OK, or the first error of each world, whose tick goes on as a single world's does
 */
PyObject *dpy_step_batch(PyObject *module, PyObject *args);

#endif
