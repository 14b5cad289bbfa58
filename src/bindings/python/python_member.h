/* SPDX-License-Identifier: BSD-3-Clause */
/* What bodies and tools have in common: a world, an id, a pose, settings. */
#ifndef PYTHON_MEMBER_H
#define PYTHON_MEMBER_H

#include "bindings/python/python_world.h"

/* A body or a tool: its world and its id. */
typedef struct dpy_member {
    PyObject ob_base;
    dpy_world *world;
    uint32_t id;
    PyObject *part; /* of a tool NULL; of a body its mesh */
} dpy_member;

/* The calls of one of them. */
typedef struct dpy_member_calls {
    const char *name;     /* "Body" */
    const char *settings; /* the name of its struct of settings */
    uint32_t settings_bytes;
    dpt_result (*get_settings)(const dpt_world *world, uint32_t id, void *settings);
    dpt_result (*set_settings)(dpt_world *world, uint32_t id, const void *settings);
    int (*is_valid)(const dpt_world *world, uint32_t id);
} dpy_member_calls;

/* A call on the world of `self`; `call` uses `world` and `self->id`. Then `result` is what it returned. */
#define ON_WORLD(what, call)                                                                                           \
    dpt_world *world = dpy_world_enter(self->world, what);                                                             \
    if (!world)                                                                                                        \
        return NULL;                                                                                                   \
    dpt_result result = (call);                                                                                        \
    dpy_world_leave(self->world)

/* A new member of a type of Python's. */
PyObject *dpy_member_make(PyTypeObject *type, dpy_world *world, uint32_t id, PyObject *part);
void dpy_member_dealloc(PyObject *self);

PyObject *dpy_member_get_setting(dpy_member *self, PyObject *name, const dpy_member_calls *calls);

/* **settings: all of them, or none after an error. */
PyObject *dpy_member_set_settings(dpy_member *self, PyObject *keywords, const dpy_member_calls *calls);

PyObject *dpy_member_is_valid(dpy_member *self, const dpy_member_calls *calls);

/* Hand over a pose: move there, or teleport. */
PyObject *dpy_member_place(dpy_member *self, PyObject *to, const char *what,
                           dpt_result (*place)(dpt_world *world, uint32_t id, const dpt_pose *pose));

/* Properties. */
PyObject *dpy_member_get_id(PyObject *self, void *unused);
PyObject *dpy_member_get_world(PyObject *self, void *unused);

#endif
