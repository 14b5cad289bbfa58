/* SPDX-License-Identifier: BSD-3-Clause */
/* dynpoint._dynpoint.Arm: a compiled arm, in bytes of its own. */
#include "bindings/python/python_arm.h"

#include "dynpoint/arm.h"

#include "platform/file.h"

#include <stdlib.h>
#include <string.h>

typedef struct dpy_arm {
    PyObject ob_base;
    const dpt_arm *arm;
    void *bytes;
    Py_ssize_t size;
    dpt_arm_info info;
} dpy_arm;

static PyObject *arm_new(PyTypeObject *type, PyObject *args, PyObject *keywords)
{
    static char *names[] = { "content", NULL };
    Py_buffer view;
    if (!PyArg_ParseTupleAndKeywords(args, keywords, "y*:Arm", names, &view))
        return NULL;
    Py_ssize_t size = view.len;
    void *bytes = file_memory(size > 0 ? (size_t)size : 1);
    if (bytes)
        memcpy(bytes, view.buf, (size_t)size);
    PyBuffer_Release(&view);
    if (!bytes)
        return PyErr_NoMemory();
    dpy_arm *self = (dpy_arm *)dpy_allocate(type);
    if (!self) {
        free(bytes);
        return NULL;
    }
    self->bytes = bytes;
    self->size = size;
    self->info.size = sizeof self->info;
    dpt_result result = dpt_arm_open(bytes, (size_t)size, &self->arm);
    if (result == DPT_OK)
        result = dpt_arm_get_info(self->arm, &self->info);
    if (result == DPT_OK)
        return (PyObject *)self;
    Py_DECREF(self);
    return dpy_fail(result, "Arm", NULL);
}

static void arm_dealloc(PyObject *self)
{
    free(((dpy_arm *)self)->bytes);
    dpy_free(self);
}

static int arm_get_buffer(PyObject *self, Py_buffer *view, int flags)
{
    return PyBuffer_FillInfo(view, self, ((dpy_arm *)self)->bytes, ((dpy_arm *)self)->size, 1, flags);
}

/* get(name, index, out): one struct. */
static PyObject *arm_get(PyObject *object, PyObject *args)
{
    const dpt_arm *arm = ((dpy_arm *)object)->arm;
    const char *name;
    unsigned index;
    PyObject *to;
    Py_buffer view;
    if (!PyArg_ParseTuple(args, "sIO:get", &name, &index, &to))
        return NULL;
    int is_info = strcmp(name, "info") == 0, is_joint = strcmp(name, "joint") == 0,
        is_segment = strcmp(name, "segment") == 0;
    Py_ssize_t bytes = is_info      ? (Py_ssize_t)sizeof(dpt_arm_info)
                       : is_joint   ? (Py_ssize_t)sizeof(dpt_arm_joint)
                       : is_segment ? (Py_ssize_t)sizeof(dpt_segment)
                                    : (Py_ssize_t)sizeof(dpt_arm_link);
    if (is_segment) {
        if (dpy_get_array(to, &view, "", bytes, 1, NULL, "out") != 0)
            return NULL;
    } else if (dpy_get_structs(to, &view, bytes, NULL, "out") != 0) {
        return NULL;
    }
    dpt_result result = is_info      ? dpt_arm_get_info(arm, view.buf)
                        : is_joint   ? dpt_arm_get_joint(arm, index, view.buf)
                        : is_segment ? dpt_arm_get_segment(arm, index, view.buf)
                                     : dpt_arm_get_link(arm, index, view.buf);
    PyBuffer_Release(&view);
    return result == DPT_OK ? Py_NewRef(Py_None) : dpy_fail(result, "Arm", NULL);
}

static int get_joints(const dpy_arm *self, PyObject *from, double *joints, const char *what)
{
    if (self->info.joints != 1)
        return dpy_get_numbers(from, joints, self->info.joints, what);
    /* One number in a sequence, too. */
    PyObject *item = PySequence_Length(from) == 1 ? PySequence_GetItem(from, 0) : NULL;
    PyErr_Clear();
    int result = dpy_get_numbers(item ? item : from, joints, 1, what);
    Py_XDECREF(item);
    return result;
}

static PyObject *arm_forward(PyObject *object, PyObject *from)
{
    double joints[DPT_JOINTS_MAX];
    dpt_pose pose;
    if (get_joints((dpy_arm *)object, from, joints, "joints") != 0)
        return NULL;
    dpt_result result = dpt_arm_forward(((dpy_arm *)object)->arm, joints, &pose);
    return result == DPT_OK ? dpy_make_pose(&pose) : dpy_fail(result, "Arm.forward", NULL);
}

static PyObject *arm_velocity(PyObject *object, PyObject *args)
{
    PyObject *at, *moving;
    double joints[DPT_JOINTS_MAX], rates[DPT_JOINTS_MAX], twist[6];
    if (!PyArg_ParseTuple(args, "OO:get_velocity", &at, &moving) ||
        get_joints((dpy_arm *)object, at, joints, "joints") != 0 ||
        get_joints((dpy_arm *)object, moving, rates, "rates") != 0)
        return NULL;
    dpt_result result = dpt_arm_velocity(((dpy_arm *)object)->arm, joints, rates, twist, twist + 3);
    return result == DPT_OK ? dpy_make_numbers(twist, 6) : dpy_fail(result, "Arm.velocity", NULL);
}

static PyObject *arm_jacobian(PyObject *object, PyObject *from)
{
    double joints[DPT_JOINTS_MAX], matrix[6 * DPT_JOINTS_MAX];
    if (get_joints((dpy_arm *)object, from, joints, "joints") != 0)
        return NULL;
    dpt_result result = dpt_arm_jacobian(((dpy_arm *)object)->arm, joints, matrix);
    return result == DPT_OK ? dpy_make_numbers(matrix, 6 * (Py_ssize_t)((dpy_arm *)object)->info.joints)
                            : dpy_fail(result, "Arm.jacobian", NULL);
}

static PyObject *arm_efforts(PyObject *object, PyObject *args)
{
    PyObject *at, *from;
    double joints[DPT_JOINTS_MAX], efforts[DPT_JOINTS_MAX];
    dpt_wrench wrench;
    if (!PyArg_ParseTuple(args, "OO:get_efforts", &at, &from) ||
        get_joints((dpy_arm *)object, at, joints, "joints") != 0 ||
        dpy_get_numbers(from, wrench.force, 6, "wrench") != 0)
        return NULL;
    dpt_result result = dpt_arm_efforts(((dpy_arm *)object)->arm, joints, &wrench, efforts);
    return result == DPT_OK ? dpy_make_numbers(efforts, ((dpy_arm *)object)->info.joints)
                            : dpy_fail(result, "Arm.efforts", NULL);
}

static PyObject *arm_weight(PyObject *object, PyObject *args)
{
    PyObject *at, *down;
    double joints[DPT_JOINTS_MAX], gravity[3], efforts[DPT_JOINTS_MAX];
    if (!PyArg_ParseTuple(args, "OO:get_weight", &at, &down) ||
        get_joints((dpy_arm *)object, at, joints, "joints") != 0 || dpy_get_numbers(down, gravity, 3, "gravity") != 0)
        return NULL;
    dpt_result result = dpt_arm_weight(((dpy_arm *)object)->arm, joints, gravity, efforts);
    return result == DPT_OK ? dpy_make_numbers(efforts, ((dpy_arm *)object)->info.joints)
                            : dpy_fail(result, "Arm.weight", NULL);
}

/* body(index): name, pose and the bytes of its mesh. */
static PyObject *arm_body(PyObject *object, PyObject *number)
{
    unsigned long index = PyLong_AsUnsignedLong(number);
    if (PyErr_Occurred())
        return NULL;
    dpt_arm_body body = { .size = sizeof body };
    dpt_result result =
        dpt_arm_get_body(((dpy_arm *)object)->arm, index > UINT32_MAX ? DPT_NONE : (uint32_t)index, &body);
    if (result != DPT_OK)
        return dpy_fail(result, "Arm.bodies", NULL);
    return Py_BuildValue("sNnn", body.name, dpy_make_pose(&body.pose),
                         (Py_ssize_t)((const char *)body.mesh - (const char *)((dpy_arm *)object)->bytes),
                         (Py_ssize_t)body.mesh_bytes);
}

static PyMethodDef methods[] = { { "get", arm_get, METH_VARARGS, NULL },
                                 { "get_forward", arm_forward, METH_O, NULL },
                                 { "get_velocity", arm_velocity, METH_VARARGS, NULL },
                                 { "get_jacobian", arm_jacobian, METH_O, NULL },
                                 { "get_efforts", arm_efforts, METH_VARARGS, NULL },
                                 { "get_weight", arm_weight, METH_VARARGS, NULL },
                                 { "get_body", arm_body, METH_O, NULL },
                                 { NULL, NULL, 0, NULL } };
static PyType_Slot slots[] = { { Py_tp_new, arm_new },
                               { Py_tp_dealloc, arm_dealloc },
                               { Py_tp_methods, methods },
                               { Py_bf_getbuffer, arm_get_buffer },
                               { 0, NULL } };
static PyType_Spec spec = { "dynpoint._dynpoint.Arm", sizeof(dpy_arm), 0, Py_TPFLAGS_DEFAULT | Py_TPFLAGS_BASETYPE,
                            slots };

int dpy_arm_init(PyObject *module)
{
    PyObject *type = dpy_add_type(module, &spec);
    Py_XDECREF(type);
    return type ? 0 : -1;
}
