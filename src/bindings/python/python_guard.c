/* SPDX-License-Identifier: BSD-3-Clause */
/* dynpoint._dynpoint.Guard: between a loop of Python's own and a device's motors. */
#include "bindings/python/python_guard.h"

#include "dynpoint/guard.h"

typedef struct dpy_guard {
    PyObject ob_base;
    dpy_owner owner;
    dpt_guard guard;
} dpy_guard;

static PyObject *guard_new(PyTypeObject *type, PyObject *args, PyObject *keywords)
{
    if (!PyArg_ParseTuple(args, ":Guard"))
        return NULL;
    dpt_guard_def def;
    dpt_guard_def_init(&def);
    if (dpy_fill(&def, "dpt_guard_def", keywords) != 0)
        return NULL;
    dpy_guard *self = (dpy_guard *)dpy_allocate(type);
    if (!self)
        return NULL;
    dpy_owner_init(&self->owner);
    self->guard.size = sizeof self->guard;
    dpt_result result = dpt_guard_init(&self->guard, &def);
    if (result == DPT_OK)
        return (PyObject *)self;
    Py_DECREF(self);
    return dpy_fail(result, "Guard", NULL);
}

/* step(now_ns, wrench, ready): what to send, a tuple of 6; `wrench` None: no command came. */
static PyObject *guard_step(PyObject *object, PyObject *args)
{
    dpy_guard *self = (dpy_guard *)object;
    unsigned long long now;
    PyObject *from;
    int ready;
    dpt_wrench command, out;
    if (!PyArg_ParseTuple(args, "KOp:step", &now, &from, &ready))
        return NULL;
    if (from != Py_None && dpy_get_numbers(from, command.force, 6, "wrench") != 0)
        return NULL;
    if (dpy_owner_enter(&self->owner, "Guard.step") != 0)
        return NULL;
    dpt_guard_step(&self->guard, now, from == Py_None ? NULL : &command, ready, &out);
    dpy_owner_leave(&self->owner);
    return dpy_make_numbers(out.force, 6);
}

static PyObject *guard_get_info(PyObject *object, PyObject *to)
{
    dpy_guard *self = (dpy_guard *)object;
    Py_buffer view;
    if (dpy_get_structs(to, &view, sizeof(dpt_guard_info), NULL, "info") != 0)
        return NULL;
    dpt_result result = dpt_guard_get_info(&self->guard, view.buf);
    PyBuffer_Release(&view);
    return result == DPT_OK ? Py_NewRef(to) : dpy_fail(result, "Guard.info", NULL);
}

static PyMethodDef methods[] = { { "decide", guard_step, METH_VARARGS, NULL },
                                 { "get_info", guard_get_info, METH_O, NULL },
                                 { NULL, NULL, 0, NULL } };
static PyType_Slot slots[] = {
    { Py_tp_new, guard_new }, { Py_tp_dealloc, dpy_free }, { Py_tp_methods, methods }, { 0, NULL }
};
static PyType_Spec spec = { "dynpoint._dynpoint.Guard", sizeof(dpy_guard), 0, Py_TPFLAGS_DEFAULT | Py_TPFLAGS_BASETYPE,
                            slots };

int dpy_guard_init(PyObject *module)
{
    PyObject *type = dpy_add_type(module, &spec);
    Py_XDECREF(type);
    return type ? 0 : -1;
}
