/* SPDX-License-Identifier: BSD-3-Clause */
#include "bindings/python/python_member.h"

#include "dynpoint/body.h"
#include "dynpoint/tool.h"

/* Room for the settings of either; both begin with their size. */
union settings {
    uint32_t size;
    dpt_body_settings body;
    dpt_tool_settings tool;
};

PyObject *dpy_member_make(PyTypeObject *type, dpy_world *world, uint32_t id, PyObject *part)
{
    dpy_member *self = (dpy_member *)dpy_allocate(type);
    if (!self)
        return NULL;
    self->world = (dpy_world *)Py_NewRef((PyObject *)world);
    self->id = id;
    self->part = Py_XNewRef(part);
    return (PyObject *)self;
}

void dpy_member_dealloc(PyObject *self)
{
    dpy_member *member = (dpy_member *)self;
    Py_XDECREF((PyObject *)member->world);
    Py_XDECREF(member->part);
    dpy_free(self);
}

PyObject *dpy_member_get_setting(dpy_member *self, PyObject *name, const dpy_member_calls *calls)
{
    union settings settings;
    PyObject *utf8 = PyUnicode_AsUTF8String(name);
    const dpy_field *field = utf8 ? dpy_find_field(calls->settings, PyBytes_AsString(utf8)) : NULL;
    Py_XDECREF(utf8);
    if (!field)
        return NULL;
    settings.size = calls->settings_bytes;
    ON_WORLD(calls->name, calls->get_settings(world, self->id, &settings));
    return result == DPT_OK ? dpy_read_field(&settings, field) : dpy_fail(result, calls->name, NULL);
}

PyObject *dpy_member_set_settings(dpy_member *self, PyObject *keywords, const dpy_member_calls *calls)
{
    union settings settings;
    settings.size = calls->settings_bytes;
    {
        ON_WORLD(calls->name, calls->get_settings(world, self->id, &settings));
        if (result != DPT_OK)
            return dpy_fail(result, calls->name, NULL);
    }
    if (dpy_fill(&settings, calls->settings, keywords) != 0)
        return NULL;
    ON_WORLD(calls->name, calls->set_settings(world, self->id, &settings));
    return dpy_result(result, calls->name);
}

PyObject *dpy_member_is_valid(dpy_member *self, const dpy_member_calls *calls)
{
    if (!self->world->world)
        Py_RETURN_FALSE;
    dpt_world *world = dpy_world_enter(self->world, calls->name);
    if (!world)
        return NULL;
    const int is_valid = calls->is_valid(world, self->id);
    dpy_world_leave(self->world);
    return PyBool_FromLong(is_valid);
}

PyObject *dpy_member_place(dpy_member *self, PyObject *to, const char *what,
                           dpt_result (*place)(dpt_world *world, uint32_t id, const dpt_pose *pose))
{
    dpt_pose room;
    const dpt_pose *pose;
    if (dpy_get_pose(to, &room, &pose) != 0)
        return NULL;
    ON_WORLD(what, place(world, self->id, pose));
    return dpy_result(result, what);
}

PyObject *dpy_member_get_id(PyObject *self, void *unused)
{
    (void)unused;
    return PyLong_FromUnsignedLong(((dpy_member *)self)->id);
}

PyObject *dpy_member_get_world(PyObject *self, void *unused)
{
    (void)unused;
    return Py_NewRef((PyObject *)((dpy_member *)self)->world);
}
