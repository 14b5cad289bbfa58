/* SPDX-License-Identifier: BSD-3-Clause */

#include "bindings/python/python_springs.h"
#include "platform/file.h"

#include "bindings/python/python_mesh.h"

#include <stdlib.h>

typedef struct dpy_springs {
    PyObject ob_base;
    dpy_owner owner;
    dpt_springs *springs;
    void *block;
    PyObject *mesh;
} dpy_springs;

static PyObject *springs_type;

dpt_springs *dpy_springs_enter(PyObject *object, const char *what)
{
    if (!PyObject_TypeCheck(object, (PyTypeObject *)springs_type)) {
        PyErr_Format(PyExc_TypeError, "%s: wanted Springs, not %R", what, object);
        return NULL;
    }
    dpy_springs *self = (dpy_springs *)object;
    return dpy_owner_enter(&self->owner, what) == 0 ? self->springs : NULL;
}

void dpy_springs_leave(PyObject *object)
{
    dpy_owner_leave(&((dpy_springs *)object)->owner);
}

/* Springs(mesh, **settings) */
static PyObject *springs_new(PyTypeObject *type, PyObject *args, PyObject *keywords)
{
    PyObject *mesh;
    if (!PyArg_ParseTuple(args, "O:Springs", &mesh))
        return NULL;
    dpt_springs_def def;
    dpt_springs_def_init(&def);
    def.mesh = dpy_mesh_of(mesh);
    if (!def.mesh || dpy_fill(&def, "dpt_springs_def", keywords) != 0)
        return NULL;
    dpt_springs *springs;
    void *block = NULL;
    size_t bytes = dpt_springs_bytes(&def);
    dpt_result result = dpt_springs_create(NULL, 0, &def, &springs);
    if (bytes == 0)
        return dpy_fail(result, "Springs", NULL);
    if (!(block = file_memory(bytes)))
        return PyErr_NoMemory();
    result = dpt_springs_create(block, bytes, &def, &springs);
    dpy_springs *self = result == DPT_OK ? (dpy_springs *)dpy_allocate(type) : NULL;
    if (!self) {
        free(block);
        if (result != DPT_OK)
            dpy_fail(result, "Springs", NULL);
        return NULL;
    }
    dpy_owner_init(&self->owner);
    self->springs = springs;
    self->block = block;
    self->mesh = Py_NewRef(mesh);
    return (PyObject *)self;
}

static void springs_dealloc(PyObject *object)
{
    dpy_springs *self = (dpy_springs *)object;
    free(self->block);
    Py_XDECREF(self->mesh);
    dpy_free(object);
}

/* step(dt, loads, info): `loads` None or structs; without Python's lock. */
static PyObject *springs_step(PyObject *object, PyObject *args)
{
    PyObject *from, *to;
    double dt;
    Py_ssize_t count = 0;
    Py_buffer loads, info;
    if (!PyArg_ParseTuple(args, "dOO:step", &dt, &from, &to))
        return NULL;
    int has_loads = from != Py_None;
    if (has_loads && dpy_get_array(from, &loads, "", sizeof(dpt_load), 1, &count, "loads") != 0)
        return NULL;
    dpt_springs *springs = NULL;
    dpt_result result = DPT_OK;
    if (dpy_get_structs(to, &info, sizeof(dpt_springs_info), NULL, "info") == 0) {
        springs = dpy_springs_enter(object, "Springs.step");
        if (springs) {
            Py_BEGIN_ALLOW_THREADS result =
                dpt_springs_step(springs, dt, has_loads ? loads.buf : NULL, (uint32_t)count, info.buf);
            Py_END_ALLOW_THREADS dpy_springs_leave(object);
        }
        PyBuffer_Release(&info);
    }
    if (has_loads)
        PyBuffer_Release(&loads);
    if (!springs)
        return NULL;
    return result == DPT_OK ? Py_NewRef(Py_None) : dpy_fail(result, "Springs.step", NULL);
}

/* foresee_once(dt, loads, positions): `loads` None or structs, positions float32 of shape (n, 3); without Python's lock. */
static PyObject *springs_foresee(PyObject *object, PyObject *args)
{
    PyObject *from, *to;
    double dt;
    Py_ssize_t load_count = 0, count = 0;
    Py_buffer loads, positions;
    if (!PyArg_ParseTuple(args, "dOO:foresee", &dt, &from, &to) ||
        dpy_get_array(to, &positions, "f", 4, 3, &count, "positions") != 0)
        return NULL;
    const int has_loads = from != Py_None;
    dpt_springs *springs = NULL;
    dpt_result result = DPT_OK;
    if (positions.readonly)
        PyErr_SetString(PyExc_TypeError, "foresee: wanted an array that can be written to");
    else if (!has_loads || dpy_get_array(from, &loads, "", sizeof(dpt_load), 1, &load_count, "loads") == 0) {
        springs = dpy_springs_enter(object, "Springs.foresee");
        if (springs) {
            Py_BEGIN_ALLOW_THREADS result = dpt_springs_foresee(springs, dt, has_loads ? loads.buf : NULL,
                                                                (uint32_t)load_count, (uint32_t)count, positions.buf);
            Py_END_ALLOW_THREADS dpy_springs_leave(object);
        }
        if (has_loads)
            PyBuffer_Release(&loads);
    }
    PyBuffer_Release(&positions);
    if (!springs)
        return NULL;
    return result == DPT_OK ? Py_NewRef(Py_None) : dpy_fail(result, "Springs.foresee", NULL);
}

/* get_nodes(positions, speeds), set_nodes(first, positions, speeds): float32 of shape (n, 3) */
static PyObject *exchange_nodes(PyObject *object, PyObject *first, PyObject *places, PyObject *speeds)
{
    Py_buffer place_view, speed_view;
    Py_ssize_t count, speed_count;
    int has_speeds = speeds != Py_None;
    unsigned long from = first ? PyLong_AsUnsignedLong(first) : 0;
    if (PyErr_Occurred() || dpy_get_array(places, &place_view, "f", 4, 3, &count, "positions") != 0)
        return NULL;
    if (has_speeds && dpy_get_array(speeds, &speed_view, "f", 4, 3, &speed_count, "speeds") != 0) {
        PyBuffer_Release(&place_view);
        return NULL;
    }
    dpt_springs *springs = NULL;
    dpt_result result = DPT_OK;
    if (has_speeds && speed_count != count) {
        PyErr_SetString(PyExc_ValueError, "speeds: wanted as many as positions");
    } else if (!first && (place_view.readonly || (has_speeds && speed_view.readonly))) {
        PyErr_SetString(PyExc_TypeError, "get_nodes: wanted arrays that can be written to");
    } else if ((springs = dpy_springs_enter(object, "Springs")) != NULL) {
        float *speed = has_speeds ? speed_view.buf : NULL;
        result = first ? dpt_springs_set_nodes(springs, (uint32_t)from, (uint32_t)count, place_view.buf, speed)
                       : dpt_springs_get_nodes(springs, (uint32_t)count, place_view.buf, speed);
        dpy_springs_leave(object);
    }
    if (has_speeds)
        PyBuffer_Release(&speed_view);
    PyBuffer_Release(&place_view);
    if (!springs)
        return NULL;
    return result == DPT_OK ? Py_NewRef(Py_None) : dpy_fail(result, "Springs", NULL);
}

static PyObject *springs_get_nodes(PyObject *self, PyObject *args)
{
    PyObject *places, *speeds;
    return PyArg_ParseTuple(args, "OO:get_nodes", &places, &speeds) ? exchange_nodes(self, NULL, places, speeds) : NULL;
}

static PyObject *springs_set_nodes(PyObject *self, PyObject *args)
{
    PyObject *first, *places, *speeds;
    return PyArg_ParseTuple(args, "OOO:set_nodes", &first, &places, &speeds)
               ? exchange_nodes(self, first, places, speeds)
               : NULL;
}

static PyObject *springs_energy(PyObject *object, PyObject *unused)
{
    double elastic, kinetic;
    (void)unused;
    dpt_springs *springs = dpy_springs_enter(object, "Springs.energy");
    if (!springs)
        return NULL;
    dpt_result result = dpt_springs_get_energy(springs, &elastic, &kinetic);
    dpy_springs_leave(object);
    return result == DPT_OK ? Py_BuildValue("dd", elastic, kinetic) : dpy_fail(result, "Springs.energy", NULL);
}

static PyObject *springs_get_count(PyObject *self, void *unused)
{
    (void)unused;
    return PyLong_FromUnsignedLong(dpt_springs_get_count(((dpy_springs *)self)->springs));
}

static PyObject *springs_get_stable_step(PyObject *self, void *unused)
{
    (void)unused;
    return PyFloat_FromDouble(dpt_springs_get_stable_step(((dpy_springs *)self)->springs));
}

static PyMethodDef methods[] = {
    { "step_once", springs_step, METH_VARARGS, NULL },      { "foresee_once", springs_foresee, METH_VARARGS, NULL },
    { "get_nodes", springs_get_nodes, METH_VARARGS, NULL }, { "put_nodes", springs_set_nodes, METH_VARARGS, NULL },
    { "get_energy", springs_energy, METH_NOARGS, NULL },    { NULL, NULL, 0, NULL }
};
static PyGetSetDef properties[] = { { "count", springs_get_count, NULL, NULL, NULL },
                                    { "stable_step", springs_get_stable_step, NULL, NULL, NULL },
                                    { NULL, NULL, NULL, NULL, NULL } };
static PyType_Slot slots[] = { { Py_tp_new, springs_new },
                               { Py_tp_dealloc, springs_dealloc },
                               { Py_tp_methods, methods },
                               { Py_tp_getset, properties },
                               { 0, NULL } };
static PyType_Spec spec = { "dynpoint._dynpoint.Springs", sizeof(dpy_springs), 0,
                            Py_TPFLAGS_DEFAULT | Py_TPFLAGS_BASETYPE, slots };

int dpy_springs_init(PyObject *module)
{
    springs_type = dpy_add_type(module, &spec);
    return springs_type ? 0 : -1;
}
