/* SPDX-License-Identifier: BSD-3-Clause */
/* Numbers in and out: Python's objects, arrays and keywords on one side, the library's structs on the other. */
#ifndef PYTHON_NUMBERS_H
#define PYTHON_NUMBERS_H

#include "bindings/python/python_error.h"

#include "dynpoint/types.h"

/*
 * A field of a public struct, as the list of layouts has it (tests/abi/layouts.txt).
 *   kind   I i Q q f d: as in Python's struct; s: text; 0: a pointer or a struct without one kind of number
 */
typedef struct dpy_field {
    const char *type, *name; /* no name: the struct's own size, or a constant */
    uint32_t offset, bytes;
    char kind;
    long long value;
} dpy_field;

/* fields(name): a struct's size and its fields, for a dtype; constants(): name and value of all. */
PyObject *dpy_list_fields(PyObject *module, PyObject *name);
PyObject *dpy_list_constants(PyObject *module, PyObject *unused);

/* NULL with AttributeError. */
const dpy_field *dpy_find_field(const char *type, const char *name);

/* A number, a tuple of numbers or a text; of a choice, as `law`, its name. */
PyObject *dpy_read_field(const void *at, const dpy_field *field);
int dpy_write_field(void *at, const dpy_field *field, PyObject *value);

/* Write keywords into a struct that has its defaults. Names that it lacks: TypeError, with those that it has. */
int dpy_fill(void *at, const char *type, PyObject *keywords);

/* `count` numbers from an array of float64 or any sequence, as "pose: wanted 7 numbers". */
int dpy_get_numbers(PyObject *from, double *to, Py_ssize_t count, const char *what);

/* None is the identity, and leaves *pose NULL. A position alone (3 numbers) does not turn. */
int dpy_get_pose(PyObject *from, dpt_pose *room, const dpt_pose **pose);
PyObject *dpy_make_pose(const dpt_pose *pose);
PyObject *dpy_make_numbers(const double *from, Py_ssize_t count);

/*
 * A whole C-contiguous array, without a copy. Release the view.
 *   format    what Python's buffers call an item, as "d"; "" for structs of `item` bytes
 *   columns   numbers in a row; 1: any shape
 *   rows      may be NULL
 */
int dpy_get_array(PyObject *from, Py_buffer *view, const char *format, Py_ssize_t item, Py_ssize_t columns,
                  Py_ssize_t *rows, const char *what);

/* The same of structs to be written to, which begin with their size: it is set in the first. */
int dpy_get_structs(PyObject *to, Py_buffer *view, Py_ssize_t item, Py_ssize_t *rows, const char *what);

/* A type of Python's from its slots; NULL after an error. */
PyObject *dpy_add_type(PyObject *module, PyType_Spec *spec);

/* An object of a type or of one derived from it, all zero. */
PyObject *dpy_allocate(PyTypeObject *type);

/* What each type's dealloc ends with. */
void dpy_free(PyObject *self);

#define DPY_FASTCALL(function) ((PyCFunction)(void (*)(void))(function))

#endif
