/* SPDX-License-Identifier: BSD-3-Clause */

#include "bindings/python/python_world.h"
#include "platform/file.h"

#include <stdlib.h>
#include <string.h>

PyObject *dpy_world_type;

dpt_world *dpy_world_enter(dpy_world *self, const char *what)
{
    if (dpy_owner_enter(&self->owner, what) != 0)
        return NULL;
    if (self->world)
        return self->world;
    dpy_owner_leave(&self->owner);
    PyErr_Format(PyExc_ValueError, "%s: the world is closed", what);
    return NULL;
}

dpy_world *dpy_world_of(PyObject *object)
{
    if (PyObject_TypeCheck(object, (PyTypeObject *)dpy_world_type))
        return (dpy_world *)object;
    PyErr_Format(PyExc_TypeError, "wanted a World, not %R", object);
    return NULL;
}

PyObject *dpy_world_wrap(PyTypeObject *type, dpt_world *world, PyObject *holder, dpy_world **link, PyObject *kept)
{
    dpy_world *self = (dpy_world *)dpy_allocate(type);
    if (!self)
        return NULL;
    dpy_owner_init(&self->owner);
    self->world = world;
    self->holder = Py_XNewRef(holder);
    self->kept = kept ? Py_NewRef(kept) : PyDict_New();
    if (!self->kept) {
        Py_DECREF((PyObject *)self);
        return NULL;
    }
    self->link = link;
    if (link)
        *link = self;
    return (PyObject *)self;
}

void dpy_world_forget(dpy_world *self)
{
    self->world = NULL;
    free(self->block);
    self->block = NULL;
    if (self->link)
        *self->link = NULL;
    self->link = NULL;
    Py_CLEAR(self->holder);
    Py_CLEAR(self->kept);
}

static PyObject *world_new(PyTypeObject *type, PyObject *args, PyObject *keywords)
{
    if (!PyArg_ParseTuple(args, ":World"))
        return NULL;
    dpt_world_def def;
    dpt_world_def_init(&def);
    if (dpy_fill(&def, "dpt_world_def", keywords) != 0)
        return NULL;
    size_t bytes = dpt_world_bytes(&def);
    void *block = NULL;
    if (bytes > 0 && !(block = file_memory(bytes)))
        return PyErr_NoMemory();
    dpt_world *world;
    dpt_result result = bytes > 0 ? dpt_world_create(block, bytes, &def, &world) : DPT_E_ARGUMENT;
    dpy_world *self = result == DPT_OK ? (dpy_world *)dpy_world_wrap(type, world, NULL, NULL, NULL) : NULL;
    if (self) {
        self->block = block;
        return (PyObject *)self;
    }
    free(block);
    if (result != DPT_OK)
        dpy_fail(result, "World", NULL);
    return NULL;
}

static void world_dealloc(PyObject *self)
{
    dpy_world_forget((dpy_world *)self);
    dpy_free(self);
}

static PyObject *world_close(PyObject *object, PyObject *unused)
{
    dpy_world *self = (dpy_world *)object;
    (void)unused;
    if (self->holder) {
        PyErr_SetString(PyExc_ValueError, "World.close: it is a scene's; close that");
        return NULL;
    }
    if (!self->world)
        Py_RETURN_NONE;
    if (dpy_owner_enter(&self->owner, "World.close") != 0)
        return NULL;
    dpy_world_forget(self);
    dpy_owner_leave(&self->owner);
    Py_RETURN_NONE;
}

/* step(dt, out=None) */
static PyObject *world_step(PyObject *object, PyObject *const *args, Py_ssize_t count)
{
    dpy_world *self = (dpy_world *)object;
    if (count < 1 || count > 2) {
        PyErr_SetString(PyExc_TypeError, "World.step(dt, out=None)");
        return NULL;
    }
    double dt = PyFloat_AsDouble(args[0]);
    if (dt == -1 && PyErr_Occurred())
        return NULL;
    Py_buffer view;
    dpt_step *out = NULL;
    if (count == 2 && args[1] != Py_None) {
        if (dpy_get_structs(args[1], &view, sizeof *out, NULL, "out") != 0)
            return NULL;
        out = view.buf;
    }
    dpt_world *world = dpy_world_enter(self, "World.step");
    dpt_result result = DPT_OK;
    if (world) {
        result = dpt_world_step(world, dt, out);
        dpy_world_leave(self);
    }
    if (out)
        PyBuffer_Release(&view);
    return world ? dpy_result(result, "World.step") : NULL;
}

static PyObject *world_reset(PyObject *object, PyObject *unused)
{
    dpy_world *self = (dpy_world *)object;
    (void)unused;
    dpt_world *world = dpy_world_enter(self, "World.reset");
    if (!world)
        return NULL;
    dpt_result result = dpt_world_reset(world);
    dpy_world_leave(self);
    return dpy_result(result, "World.reset");
}

static PyObject *world_get_info(PyObject *object, PyObject *to)
{
    dpy_world *self = (dpy_world *)object;
    Py_buffer view;
    if (dpy_get_structs(to, &view, sizeof(dpt_world_info), NULL, "info") != 0)
        return NULL;
    dpt_world *world = dpy_world_enter(self, "World.info");
    dpt_result result = DPT_OK;
    if (world) {
        result = dpt_world_get_info(world, view.buf);
        dpy_world_leave(self);
    }
    PyBuffer_Release(&view);
    return world ? dpy_result(result, "World.info") : NULL;
}

static PyObject *world_is_closed(PyObject *self, void *unused)
{
    (void)unused;
    return PyBool_FromLong(!((dpy_world *)self)->world);
}

static PyMethodDef methods[] = { { "step", DPY_FASTCALL(world_step), METH_FASTCALL, NULL },
                                 { "reset", world_reset, METH_NOARGS, NULL },
                                 { "close", world_close, METH_NOARGS, NULL },
                                 { "get_info", world_get_info, METH_O, NULL },
                                 { NULL, NULL, 0, NULL } };
static PyGetSetDef properties[] = { { "closed", world_is_closed, NULL, NULL, NULL }, { NULL, NULL, NULL, NULL, NULL } };
static PyType_Slot slots[] = { { Py_tp_new, world_new },
                               { Py_tp_dealloc, world_dealloc },
                               { Py_tp_methods, methods },
                               { Py_tp_getset, properties },
                               { 0, NULL } };
static PyType_Spec spec = { "dynpoint._dynpoint.World", sizeof(dpy_world), 0, Py_TPFLAGS_DEFAULT | Py_TPFLAGS_BASETYPE,
                            slots };

int dpy_world_init(PyObject *module)
{
    dpy_world_type = dpy_add_type(module, &spec);
    return dpy_world_type ? 0 : -1;
}
