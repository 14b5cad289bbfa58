/* SPDX-License-Identifier: BSD-3-Clause */
#include "bindings/python/python_error.h"

#include "bindings/python/python_interrupt.h"

#include "platform/interpreter.h"

PyObject *dpy_error;

/* Grows in each child of a fork: objects that were made before are its parent's. */
unsigned dpy_process;

static void count_process(void)
{
    dpy_process++;
    dpy_interrupt_fork();
}

PyObject *dpy_fail(dpt_result code, const char *what, const char *text)
{
    if (!text || !*text)
        text = dpt_result_text(code);
    PyObject *error = PyObject_CallFunction(dpy_error, "N", PyUnicode_FromFormat("%s: %s", what, text));
    if (!error)
        return NULL;
    PyObject *number = PyLong_FromLong(code), *name = PyUnicode_FromString(dpt_result_name(code));
    if (number && name && PyObject_SetAttrString(error, "code", number) == 0 &&
        PyObject_SetAttrString(error, "name", name) == 0)
        PyErr_SetObject(dpy_error, error);
    Py_XDECREF(number);
    Py_XDECREF(name);
    Py_DECREF(error);
    return NULL;
}

void dpy_owner_init(dpy_owner *owner)
{
    owner->process = dpy_process;
    owner->busy = 0;
}

int dpy_owner_is_here(const dpy_owner *owner)
{
    return owner->process == dpy_process;
}

int dpy_owner_refuse(const dpy_owner *owner, const char *what)
{
    PyErr_Format(PyExc_RuntimeError,
                 dpy_owner_is_here(owner) ? "%s: another thread is in it; one thread at a time may use it"
                                          : "%s: it belongs to the process that made it, and this is a fork of that",
                 what);
    return -1;
}

int dpy_error_init(PyObject *module)
{
    static int is_counting;
    if (!is_counting && forks_watch(count_process) != 0) {
        PyErr_SetString(PyExc_ImportError, "dynpoint: forks cannot be noticed");
        return -1;
    }
    is_counting = 1;
    PyObject *members = Py_BuildValue("{sisssO}", "code", 0, "name", "", "__module__", Py_None);
    if (!members)
        return -1;
    PyObject *of = PyUnicode_FromString("dynpoint");
    if (of)
        PyDict_SetItemString(members, "__module__", of);
    Py_XDECREF(of);
    dpy_error = PyErr_NewExceptionWithDoc(
        "dynpoint.Error", "A call that the library refused: its text, `code` and `name`.", NULL, members);
    Py_DECREF(members);
    return dpy_error ? PyModule_AddObjectRef(module, "Error", dpy_error) : -1;
}
