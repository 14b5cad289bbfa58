/* SPDX-License-Identifier: BSD-3-Clause */
#include "bindings/python/python_numbers.h"

#include "dynpoint/baseline.h"
#include "dynpoint/convex.h"
#include "dynpoint/driver.h"
#include "dynpoint/exchange.h"
#include "dynpoint/host.h"
#include "dynpoint/identify.h"
#include "dynpoint/insertion.h"
#include "dynpoint/passivity.h"
#include "dynpoint/query.h"
#include "dynpoint/recorder.h"
#include "dynpoint/selftest.h"
#include "dynpoint/snapshot.h"
#include "dynpoint/springs.h"
#include "dynpoint/tip.h"
#include "dynpoint/tool.h"
#include "dynpoint/urdf.h"

#include <string.h>

#define KIND(type, field)                                                                                              \
    _Generic(((type *)0)->field,                                                                                       \
        uint32_t: 'I',                                                                                                 \
        uint32_t *: 'I',                                                                                               \
        int32_t: 'i',                                                                                                  \
        int32_t *: 'i',                                                                                                \
        uint64_t: 'Q',                                                                                                 \
        uint64_t *: 'Q',                                                                                               \
        double: 'd',                                                                                                   \
        double *: 'd',                                                                                                 \
        double(*)[3]: 'd',                                                                                             \
        char *: 's',                                                                                                   \
        dpt_pose: 'd',                                                                                                 \
        dpt_wrench: 'd',                                                                                               \
        default: 0)
/* Arrays decay to the pointers above; pointers of a struct do too, and are told apart by their size. */
#define IS_POINTER(type, field)                                                                                        \
    _Generic(&((type *)0)->field, const char ** : 1, const double ** : 1, const uint32_t ** : 1, const float ** : 1,   \
             double ** : 1, uint32_t ** : 1, default : 0)

/* clang-format off */
#define TYPE(type, bytes)
#define STRUCT(type)
#define FIELD(type, field, at64, bytes64, at32, bytes32) \
    { #type, #field, offsetof(type, field), sizeof(((type *)0)->field), IS_POINTER(type, field) ? 0 : KIND(type, field), 0 },
#define SIZE(type, bytes64, bytes32) { #type, NULL, 0, sizeof(type), 0, 0 },
#define VALUE(name, number) { #name, NULL, 0, 0, 0, (long long)(name) },
static const dpy_field fields[] = {
#include <layouts.txt>
    { NULL, NULL, 0, 0, 0, 0 }
};
/* clang-format on */

static uint32_t bytes_of(char kind)
{
    return kind == 's' ? 1 : kind == 'd' || kind == 'Q' || kind == 'q' ? 8 : 4;
}

PyObject *dpy_list_fields(PyObject *module, PyObject *name)
{
    (void)module;
    PyObject *utf8 = PyUnicode_AsUTF8String(name), *list = utf8 ? PyList_New(0) : NULL;
    const char *type = utf8 ? PyBytes_AsString(utf8) : NULL;
    uint32_t size = 0;
    for (const dpy_field *field = fields; list && field->type; field++) {
        if (strcmp(field->type, type) != 0)
            continue;
        if (!field->name) {
            size = field->bytes;
            continue;
        }
        const char kind[2] = { field->kind, 0 };
        PyObject *row = Py_BuildValue("ssII", field->name, kind, field->offset,
                                      field->kind ? field->bytes / bytes_of(field->kind) : field->bytes);
        if (!row || PyList_Append(list, row) != 0)
            Py_CLEAR(list);
        Py_XDECREF(row);
    }
    Py_XDECREF(utf8);
    return list ? Py_BuildValue("IN", size, list) : NULL;
}

PyObject *dpy_list_constants(PyObject *module, PyObject *unused)
{
    (void)module;
    (void)unused;
    PyObject *all = PyDict_New();
    for (const dpy_field *field = fields; all && field->type; field++) {
        if (field->name || field->bytes)
            continue;
        PyObject *value = PyLong_FromLongLong(field->value);
        if (!value || PyDict_SetItemString(all, field->type, value) != 0)
            Py_CLEAR(all);
        Py_XDECREF(value);
    }
    return all;
}

const dpy_field *dpy_find_field(const char *type, const char *name)
{
    for (const dpy_field *field = fields; field->type; field++)
        if (field->name && strcmp(field->type, type) == 0 && strcmp(field->name, name) == 0)
            return field;
    PyErr_Format(PyExc_AttributeError, "%s has no %s", type, name);
    return NULL;
}

/* How the constants of a choice begin, or NULL for a number. */
static const char *choice_of(const dpy_field *field)
{
    static const char *const choices[][2] = { { "law", "DPT_LAW_" },           { "method", "DPT_METHOD_" },
                                              { "kernel", "DPT_KERNEL_" },     { "until", "DPT_UNTIL_" },
                                              { "strip", "DPT_STRIP_KIND_" },  { "integrator", "DPT_INTEGRATOR_" },
                                              { "response", "DPT_RESPONSE_" }, { "format", "DPT_FORMAT_" },
                                              { "piercing", "DPT_PIERCING_" } };
    if (field->kind != 'I' || field->bytes != 4)
        return NULL;
    if (strcmp(field->type, "dpt_spring_net_def") == 0 && strcmp(field->name, "kind") == 0)
        return "DPT_NET_";
    if (strcmp(field->type, "dpt_world_info") == 0 && strcmp(field->name, "kernel") != 0)
        return NULL;
    for (size_t i = 0; i < sizeof choices / sizeof *choices; i++)
        if (strcmp(field->name, choices[i][0]) == 0)
            return choices[i][1];
    return NULL;
}

static int names_constant(const dpy_field *constant, const char *prefix)
{
    return !constant->name && !constant->bytes && strncmp(constant->type, prefix, strlen(prefix)) == 0;
}

static PyObject *lower(const char *text)
{
    PyObject *name = PyUnicode_FromString(text);
    PyObject *result = name ? PyObject_CallMethod(name, "lower", NULL) : NULL;
    Py_XDECREF(name);
    return result;
}

static int find_choice(const dpy_field *field, const char *prefix, PyObject *value, uint32_t *number)
{
    PyObject *known = PyList_New(0);
    int is_found = 0;
    for (const dpy_field *constant = fields; known && constant->type && !is_found; constant++) {
        if (!names_constant(constant, prefix))
            continue;
        PyObject *name = lower(constant->type + strlen(prefix));
        is_found = name && PyUnicode_Compare(name, value) == 0;
        if (is_found)
            *number = (uint32_t)constant->value;
        if (!name || PyList_Append(known, name) != 0)
            Py_CLEAR(known);
        Py_XDECREF(name);
    }
    if (known && !is_found)
        PyErr_Format(PyExc_ValueError, "%s: %R is none of %R", field->name, value, known);
    Py_XDECREF(known);
    return is_found && !PyErr_Occurred() ? 0 : -1;
}

static PyObject *read_number(const char *at, char kind)
{
    if (kind == 'd')
        return PyFloat_FromDouble(*(const double *)(const void *)at);
    if (kind == 'Q')
        return PyLong_FromUnsignedLongLong(*(const uint64_t *)(const void *)at);
    if (kind == 'i')
        return PyLong_FromLong(*(const int32_t *)(const void *)at);
    return PyLong_FromUnsignedLong(*(const uint32_t *)(const void *)at);
}

PyObject *dpy_read_field(const void *at, const dpy_field *field)
{
    const char *here = (const char *)at + field->offset, *prefix = choice_of(field);
    if (prefix)
        for (const dpy_field *constant = fields; constant->type; constant++)
            if (names_constant(constant, prefix) && constant->value == (long long)*(const uint32_t *)(const void *)here)
                return lower(constant->type + strlen(prefix));
    if (field->kind == 's')
        return PyUnicode_FromString(here);
    uint32_t item = bytes_of(field->kind), count = field->bytes / item;
    if (count == 1)
        return read_number(here, field->kind);
    PyObject *all = PyTuple_New(count);
    for (uint32_t i = 0; all && i < count; i++)
        if (PyTuple_SetItem(all, i, read_number(here + i * item, field->kind)) != 0)
            Py_CLEAR(all);
    return all;
}

int dpy_write_field(void *at, const dpy_field *field, PyObject *value)
{
    char *here = (char *)at + field->offset;
    const char *prefix = choice_of(field);
    if (prefix && PyUnicode_Check(value))
        return find_choice(field, prefix, value, (uint32_t *)(void *)here);
    if (field->kind == 'd')
        return dpy_get_numbers(value, (double *)(void *)here, (Py_ssize_t)field->bytes / 8, field->name);
    if ((field->kind != 'I' && field->kind != 'Q') || field->bytes != bytes_of(field->kind)) {
        PyErr_Format(PyExc_TypeError, "%s cannot be set", field->name);
        return -1;
    }
    PyObject *whole = PyNumber_Index(value);
    unsigned long long number = whole ? PyLong_AsUnsignedLongLong(whole) : 0;
    Py_XDECREF(whole);
    if (PyErr_Occurred() || (field->kind == 'I' && number > UINT32_MAX)) {
        PyErr_Clear();
        PyErr_Format(PyExc_ValueError, "%s: wanted a whole number from 0 to %s, not %R", field->name,
                     field->kind == 'I' ? "2^32 - 1" : "2^64 - 1", value);
        return -1;
    }
    if (field->kind == 'I')
        *(uint32_t *)(void *)here = (uint32_t)number;
    else
        *(uint64_t *)(void *)here = number;
    return 0;
}

int dpy_fill(void *at, const char *type, PyObject *keywords)
{
    Py_ssize_t place = 0;
    PyObject *key, *value;
    while (keywords && PyDict_Next(keywords, &place, &key, &value)) {
        PyObject *utf8 = PyUnicode_AsUTF8String(key);
        if (!utf8)
            return -1;
        const char *name = PyBytes_AsString(utf8);
        const dpy_field *field = dpy_find_field(type, name);
        if (!field || !field->kind || strcmp(name, "size") == 0 || strncmp(name, "reserved", 8) == 0) {
            PyErr_Clear();
            PyObject *known = PyList_New(0);
            for (field = fields; known && field->type; field++) {
                if (!field->name || !field->kind || strcmp(field->type, type) != 0 ||
                    strcmp(field->name, "size") == 0 || strncmp(field->name, "reserved", 8) == 0)
                    continue;
                PyObject *word = PyUnicode_FromString(field->name);
                if (!word || PyList_Append(known, word) != 0)
                    Py_CLEAR(known);
                Py_XDECREF(word);
            }
            if (known)
                PyErr_Format(PyExc_TypeError, "there is no setting %R; there are %R", key, known);
            Py_XDECREF(known);
            Py_DECREF(utf8);
            return -1;
        }
        int result = dpy_write_field(at, field, value);
        Py_DECREF(utf8);
        if (result != 0)
            return -1;
    }
    return 0;
}

static int is_format(const Py_buffer *view, const char *format)
{
    const char *has = view->format ? view->format : "B";
    if (*has == '@' || *has == '=' || *has == '<')
        has++;
    /* Where long has 8 bytes it is the same as long long; on Windows it has 4, as int. */
    if (strchr("iIQ", *format) && strcmp(has, *format == 'i' ? "l" : "L") == 0)
        return view->itemsize == (*format == 'Q' ? 8 : 4);
    return strcmp(has, format) == 0;
}

int dpy_get_numbers(PyObject *from, double *to, Py_ssize_t count, const char *what)
{
    Py_buffer view;
    if (PyObject_CheckBuffer(from) && PyObject_GetBuffer(from, &view, PyBUF_FORMAT | PyBUF_C_CONTIGUOUS) == 0) {
        int fits = view.len == count * 8 && is_format(&view, "d");
        if (fits)
            memcpy(to, view.buf, (size_t)count * 8);
        PyBuffer_Release(&view);
        if (fits)
            return 0;
    }
    PyErr_Clear();
    if (count == 1) {
        *to = PyFloat_AsDouble(from);
        if (!PyErr_Occurred())
            return 0;
        PyErr_Clear();
        PyErr_Format(PyExc_TypeError, "%s: wanted a number, not %R", what, from);
        return -1;
    }
    Py_ssize_t length = PyUnicode_Check(from) ? -1 : PySequence_Length(from);
    if (length != count) {
        PyErr_Clear();
        PyErr_Format(PyExc_TypeError, "%s: wanted %zd numbers, not %R", what, count, from);
        return -1;
    }
    for (Py_ssize_t i = 0; i < count; i++) {
        PyObject *item = PySequence_GetItem(from, i);
        to[i] = item ? PyFloat_AsDouble(item) : 0;
        Py_XDECREF(item);
        if (PyErr_Occurred()) {
            PyErr_Clear();
            PyErr_Format(PyExc_TypeError, "%s: wanted %zd numbers, not %R", what, count, from);
            return -1;
        }
    }
    return 0;
}

int dpy_get_pose(PyObject *from, dpt_pose *room, const dpt_pose **pose)
{
    *pose = NULL;
    if (!from || from == Py_None)
        return 0;
    *room = (dpt_pose)DPT_POSE_IDENTITY;
    *pose = room;
    Py_ssize_t length = PyObject_CheckBuffer(from) ? 7 : PySequence_Length(from);
    PyErr_Clear();
    double numbers[7];
    if (length == 3 || (PyObject_CheckBuffer(from) && PyObject_Length(from) == 3))
        return dpy_get_numbers(from, room->position, 3, "pose");
    PyErr_Clear();
    if (dpy_get_numbers(from, numbers, 7, "pose") != 0)
        return -1;
    memcpy(room->position, numbers, sizeof room->position);
    memcpy(room->orientation, numbers + 3, sizeof room->orientation);
    return 0;
}

PyObject *dpy_make_numbers(const double *from, Py_ssize_t count)
{
    PyObject *all = PyTuple_New(count);
    for (Py_ssize_t i = 0; all && i < count; i++)
        if (PyTuple_SetItem(all, i, PyFloat_FromDouble(from[i])) != 0)
            Py_CLEAR(all);
    return all;
}

PyObject *dpy_make_pose(const dpt_pose *pose)
{
    double numbers[7];
    memcpy(numbers, pose->position, sizeof pose->position);
    memcpy(numbers + 3, pose->orientation, sizeof pose->orientation);
    return dpy_make_numbers(numbers, 7);
}

int dpy_get_array(PyObject *from, Py_buffer *view, const char *format, Py_ssize_t item, Py_ssize_t columns,
                  Py_ssize_t *rows, const char *what)
{
    const char *name = !*format         ? "structs"
                       : *format == 'd' ? "float64"
                       : *format == 'f' ? "float32"
                       : *format == 'i' ? "int32"
                                        : "uint32";
    if (!PyObject_CheckBuffer(from)) {
        PyErr_Format(PyExc_TypeError, "%s: wanted an array of %s, not %R", what, name, (PyObject *)Py_TYPE(from));
        return -1;
    }
    if (PyObject_GetBuffer(from, view, PyBUF_FORMAT | PyBUF_STRIDES) != 0)
        return -1;
    if (!PyBuffer_IsContiguous(view, 'C')) {
        PyErr_Format(PyExc_ValueError, "%s: wanted an array in C order without gaps", what);
    } else if (*format ? !is_format(view, format) : view->itemsize != item) {
        PyErr_Format(PyExc_TypeError, "%s: wanted an array of %s, not one of %s", what, name,
                     view->format ? view->format : "bytes");
    } else if (view->len % (item * columns) != 0 ||
               (columns > 1 && (view->ndim < 1 || view->shape[view->ndim - 1] != columns))) {
        PyErr_Format(PyExc_ValueError, "%s: wanted an array of shape (n, %zd)", what, columns);
    } else {
        if (rows)
            *rows = view->len / (item * columns);
        return 0;
    }
    PyBuffer_Release(view);
    return -1;
}

int dpy_get_structs(PyObject *to, Py_buffer *view, Py_ssize_t item, Py_ssize_t *rows, const char *what)
{
    if (PyObject_GetBuffer(to, view, PyBUF_WRITABLE | PyBUF_FORMAT | PyBUF_C_CONTIGUOUS) != 0) {
        PyErr_Clear();
        PyErr_Format(PyExc_TypeError, "%s: wanted an array that can be written to, in C order", what);
        return -1;
    }
    if (view->itemsize != item) {
        PyErr_Format(PyExc_TypeError, "%s: wanted structs of %zd bytes, not of %zd: take the dtype of that name", what,
                     item, view->itemsize);
        PyBuffer_Release(view);
        return -1;
    }
    if (view->len > 0)
        *(uint32_t *)view->buf = (uint32_t)item;
    if (rows)
        *rows = view->len / item;
    return 0;
}

PyObject *dpy_add_type(PyObject *module, PyType_Spec *spec)
{
    PyObject *type = PyType_FromModuleAndSpec(module, spec, NULL);
    if (type && PyModule_AddObjectRef(module, strrchr(spec->name, '.') + 1, type) != 0)
        Py_CLEAR(type);
    return type;
}

PyObject *dpy_allocate(PyTypeObject *type)
{
    return ((allocfunc)PyType_GetSlot(type, Py_tp_alloc))(type, 0);
}

void dpy_free(PyObject *self)
{
    PyTypeObject *type = Py_TYPE(self);
    ((freefunc)PyType_GetSlot(type, Py_tp_free))(self);
    Py_DECREF(type);
}
