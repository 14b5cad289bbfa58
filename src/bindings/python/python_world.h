/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * dynpoint._dynpoint.World, and the bodies and tools in it. A world keeps what its bodies need: meshes, blocks, springs. A
 * body and a tool keep their world.
 */
#ifndef PYTHON_WORLD_H
#define PYTHON_WORLD_H

#include "bindings/python/python_numbers.h"

#include "dynpoint/world.h"

typedef struct dpy_world dpy_world;
struct dpy_world {
    PyObject ob_base;
    dpy_owner owner;
    dpt_world *world; /* NULL: it is closed */
    void *block;      /* NULL: it is `holder`'s */
    PyObject *holder; /* a scene, which is kept, or NULL */
    dpy_world **link; /* where the holder has this world; it does not keep it */
    PyObject *kept;   /* a dict from a body's id to what it needs; the holder's too */
};

extern PyObject *dpy_world_type;
extern PyObject *dpy_body_type;
extern PyObject *dpy_tool_type;

/* NULL: an exception is set. Else the caller is in it, until dpy_world_leave. */
dpt_world *dpy_world_enter(dpy_world *self, const char *what);

static inline void dpy_world_leave(dpy_world *self)
{
    dpy_owner_leave(&self->owner);
}

/* The world of an argument, or NULL with TypeError. */
dpy_world *dpy_world_of(PyObject *object);

/*
 * A world of `holder`, which dpy_world_forget ends; *link is the world as long as there is one. `kept` is a dict that the
 * holder has as long as the library's world, which may outlive this one.
 */
PyObject *dpy_world_wrap(PyTypeObject *type, dpt_world *world, PyObject *holder, dpy_world **link, PyObject *kept);
void dpy_world_forget(dpy_world *self);

/* None for DPT_OK, else an exception: what a setter ends with. */
static inline PyObject *dpy_result(dpt_result result, const char *what)
{
    if (result == DPT_OK)
        return Py_NewRef(Py_None);
    return dpy_fail(result, what, NULL);
}

int dpy_world_init(PyObject *module);
int dpy_body_init(PyObject *module);
int dpy_tool_init(PyObject *module);

#endif
