/* SPDX-License-Identifier: BSD-3-Clause */
/* What Python is told when a call cannot be done, and who may call. */
#ifndef PYTHON_ERROR_H
#define PYTHON_ERROR_H

/*
 * The limited API of Python 3.11: one binary for it and all later ones. Builds without Python's lock have no such API;
 * there the extension is built for that Python alone, and takes its lock back.
 */
#include <pyconfig.h>
#if !defined(Py_LIMITED_API) && !defined(Py_GIL_DISABLED)
#define Py_LIMITED_API 0x030B0000
#endif
#define PY_SSIZE_T_CLEAN
#include <Python.h>

#include "dynpoint/result.h"

/* dynpoint.Error: `code` and `name` beside its text. */
extern PyObject *dpy_error;

/*
 * Raise dynpoint.Error and return NULL.
 *   what   what was tried, as "World.step"
 *   text   the library's own, or NULL or "": that of the code
 */
PyObject *dpy_fail(dpt_result code, const char *what, const char *text);

/*
 * Whose an object is. Its memory is of one process: after a fork the child may not use it, and what it holds of a device
 * stays the parent's. One thread at a time may be in it.
 */
typedef struct dpy_owner {
    unsigned process;
    int busy;
} dpy_owner;

void dpy_owner_init(dpy_owner *owner);

/* 1: the object belongs to this process. */
int dpy_owner_is_here(const dpy_owner *owner);

/* Raise what keeps the caller out, a RuntimeError, and return -1. */
int dpy_owner_refuse(const dpy_owner *owner, const char *what);

/* 0: the caller is in, until dpy_owner_leave. -1: an exception is set. */
static inline int dpy_owner_enter(dpy_owner *owner, const char *what)
{
    extern unsigned dpy_process;
    if (owner->process != dpy_process || __atomic_exchange_n(&owner->busy, 1, __ATOMIC_ACQUIRE))
        return dpy_owner_refuse(owner, what);
    return 0;
}

static inline void dpy_owner_leave(dpy_owner *owner)
{
    __atomic_store_n(&owner->busy, 0, __ATOMIC_RELEASE);
}

/* Make the exception, and count processes from now on. */
int dpy_error_init(PyObject *module);

#endif
