/* SPDX-License-Identifier: BSD-3-Clause */
/* dynpoint._dynpoint.Mesh: an open mesh, which owns its bytes and shows them as a buffer. */
#ifndef PYTHON_MESH_H
#define PYTHON_MESH_H

#include "bindings/python/python_numbers.h"

#include "dynpoint/mesh.h"

typedef struct dpy_mesh {
    PyObject ob_base;
    const dpt_mesh *mesh;
    void *bytes;
    Py_ssize_t size;
    int is_compiled; /* the bytes are the compiler's */
} dpy_mesh;

extern PyObject *dpy_mesh_type;

/* The mesh of an object, or NULL with TypeError. */
const dpt_mesh *dpy_mesh_of(PyObject *object);

int dpy_mesh_init(PyObject *module);

#endif
