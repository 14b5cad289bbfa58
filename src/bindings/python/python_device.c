/* SPDX-License-Identifier: BSD-3-Clause */
#include "bindings/python/python_device.h"

typedef struct dpy_device {
    PyObject ob_base;
    dpy_owner owner;
    dpt_device *device; /* NULL: it is closed */
} dpy_device;

static PyObject *device_type;

dpt_device *dpy_device_enter(PyObject *object, const char *what)
{
    if (!PyObject_TypeCheck(object, (PyTypeObject *)device_type)) {
        PyErr_Format(PyExc_TypeError, "%s: wanted a Device, not %R", what, object);
        return NULL;
    }
    dpy_device *self = (dpy_device *)object;
    if (dpy_owner_enter(&self->owner, what) != 0)
        return NULL;
    if (self->device)
        return self->device;
    dpy_owner_leave(&self->owner);
    PyErr_Format(PyExc_ValueError, "%s: the device is closed", what);
    return NULL;
}

void dpy_device_leave(PyObject *object)
{
    dpy_owner_leave(&((dpy_device *)object)->owner);
}

static PyObject *device_new(PyTypeObject *type, PyObject *args, PyObject *keywords)
{
    static char *names[] = { "name", NULL };
    const char *name;
    if (!PyArg_ParseTupleAndKeywords(args, keywords, "s:Device", names, &name))
        return NULL;
    dpt_device_error error = { .size = sizeof error };
    dpt_device *device;
    dpt_result result;
    Py_BEGIN_ALLOW_THREADS result = dpt_device_open(name, &device, &error);
    Py_END_ALLOW_THREADS if (result != DPT_OK) return dpy_fail(result, name, error.text);
    dpy_device *self = (dpy_device *)dpy_allocate(type);
    if (!self) {
        dpt_device_close(device);
        return NULL;
    }
    dpy_owner_init(&self->owner);
    self->device = device;
    if (error.text[0] && PyErr_WarnFormat(PyExc_UserWarning, 1, "%s: %s", name, error.text) != 0) {
        Py_DECREF(self);
        return NULL;
    }
    return (PyObject *)self;
}

/* Zero force, then the end of the handle. */
static void let_go(dpy_device *self)
{
    const dpt_wrench zero = { { 0, 0, 0 }, { 0, 0, 0 } };
    dpt_device *device = self->device;
    self->device = NULL;
    if (!device || !dpy_owner_is_here(&self->owner))
        return;
    (void)dpt_device_write(device, &zero);
    dpt_device_close(device);
}

static void device_dealloc(PyObject *self)
{
    let_go((dpy_device *)self);
    dpy_free(self);
}

static PyObject *device_close(PyObject *object, PyObject *unused)
{
    dpy_device *self = (dpy_device *)object;
    (void)unused;
    if (!self->device)
        Py_RETURN_NONE;
    if (dpy_owner_enter(&self->owner, "Device.close") != 0)
        return NULL;
    let_go(self);
    dpy_owner_leave(&self->owner);
    Py_RETURN_NONE;
}

/* A call on the device that may wait for its line: without Python's lock. */
#define ON_DEVICE(what, call)                                                                                          \
    dpt_device *device = dpy_device_enter(self, what);                                                                 \
    dpt_result result = DPT_OK;                                                                                        \
    if (device) {                                                                                                      \
        Py_BEGIN_ALLOW_THREADS result = (call);                                                                        \
        Py_END_ALLOW_THREADS dpy_device_leave(self);                                                                   \
    }

static PyObject *read_into(PyObject *self, PyObject *to, Py_ssize_t bytes, const char *what,
                           dpt_result (*call)(dpt_device *, void *))
{
    Py_buffer view;
    if (dpy_get_structs(to, &view, bytes, NULL, "out") != 0)
        return NULL;
    ON_DEVICE(what, call(device, view.buf))
    PyBuffer_Release(&view);
    if (!device)
        return NULL;
    return result == DPT_OK ? Py_NewRef(to) : dpy_fail(result, what, NULL);
}

static dpt_result read_state(dpt_device *device, void *to)
{
    return dpt_device_read(device, to);
}

static dpt_result get_info(dpt_device *device, void *to)
{
    return dpt_device_get_info(device, to);
}

static dpt_result get_counts(dpt_device *device, void *to)
{
    return dpt_device_get_counts(device, to);
}

static PyObject *device_read(PyObject *self, PyObject *to)
{
    return read_into(self, to, sizeof(dpt_device_state), "Device.read", read_state);
}

static PyObject *device_get_info(PyObject *self, PyObject *to)
{
    return read_into(self, to, sizeof(dpt_device_info), "Device.info", get_info);
}

static PyObject *device_get_counts(PyObject *self, PyObject *to)
{
    return read_into(self, to, sizeof(dpt_device_counts), "Device.counts", get_counts);
}

/* write(wrench): 6 numbers, or 3 of a force. A line without room for it is no error: False. */
static PyObject *device_write(PyObject *self, PyObject *from)
{
    dpt_wrench wrench = { { 0, 0, 0 }, { 0, 0, 0 } };
    Py_ssize_t length = PyObject_Length(from);
    if (length < 0)
        PyErr_Clear();
    if (dpy_get_numbers(from, wrench.force, length == 3 ? 3 : 6, "wrench") != 0)
        return NULL;
    ON_DEVICE("Device.write", dpt_device_write(device, &wrench))
    if (!device)
        return NULL;
    if (result == DPT_OK || result == DPT_E_BUSY)
        return PyBool_FromLong(result == DPT_OK);
    return dpy_fail(result, "Device.write", NULL);
}

static PyObject *device_clear(PyObject *self, PyObject *unused)
{
    (void)unused;
    ON_DEVICE("Device.clear", dpt_device_clear(device))
    if (!device)
        return NULL;
    return result == DPT_OK ? Py_NewRef(Py_None) : dpy_fail(result, "Device.clear", NULL);
}

/* steer(position): allowed while a loop serves the device. */
static PyObject *device_steer(PyObject *object, PyObject *to)
{
    dpy_device *self = (dpy_device *)object;
    double position[3];
    if (dpy_get_numbers(to, position, 3, "position") != 0)
        return NULL;
    if (!dpy_owner_is_here(&self->owner)) {
        dpy_owner_refuse(&self->owner, "Device.steer");
        return NULL;
    }
    dpt_result result = dpt_device_steer(self->device, position);
    return result == DPT_OK ? Py_NewRef(Py_None) : dpy_fail(result, "Device.steer", NULL);
}

static PyObject *device_is_closed(PyObject *self, void *unused)
{
    (void)unused;
    return PyBool_FromLong(!((dpy_device *)self)->device);
}

static PyMethodDef methods[] = {
    { "close", device_close, METH_NOARGS, NULL },  { "read_into", device_read, METH_O, NULL },
    { "get_info", device_get_info, METH_O, NULL }, { "get_counts", device_get_counts, METH_O, NULL },
    { "write", device_write, METH_O, NULL },       { "clear", device_clear, METH_NOARGS, NULL },
    { "steer", device_steer, METH_O, NULL },       { NULL, NULL, 0, NULL }
};
static PyGetSetDef properties[] = { { "closed", device_is_closed, NULL, NULL, NULL },
                                    { NULL, NULL, NULL, NULL, NULL } };
static PyType_Slot slots[] = { { Py_tp_new, device_new },
                               { Py_tp_dealloc, device_dealloc },
                               { Py_tp_methods, methods },
                               { Py_tp_getset, properties },
                               { 0, NULL } };
static PyType_Spec spec = { "dynpoint._dynpoint.Device", sizeof(dpy_device), 0,
                            Py_TPFLAGS_DEFAULT | Py_TPFLAGS_BASETYPE, slots };

int dpy_device_init(PyObject *module)
{
    device_type = dpy_add_type(module, &spec);
    return device_type ? 0 : -1;
}
