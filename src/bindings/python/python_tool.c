/* SPDX-License-Identifier: BSD-3-Clause */
#include "bindings/python/python_member.h"

#include "dynpoint/insertion.h"
#include "dynpoint/tool.h"

#include <string.h>

PyObject *dpy_tool_type;

/* Tool(world, segments): structs */
static PyObject *tool_new(PyTypeObject *type, PyObject *args, PyObject *keywords)
{
    static char *names[] = { "world", "segments", NULL };
    PyObject *world_object, *segments, *self = NULL;
    Py_buffer view;
    Py_ssize_t count;
    if (!PyArg_ParseTupleAndKeywords(args, keywords, "OO:Tool", names, &world_object, &segments))
        return NULL;
    dpy_world *holder = dpy_world_of(world_object);
    if (!holder || dpy_get_array(segments, &view, "", sizeof(dpt_segment), 1, &count, "segments") != 0)
        return NULL;
    dpt_world *world = dpy_world_enter(holder, "Tool");
    if (world) {
        dpt_tool tool = 0;
        dpt_result result = dpt_tool_add(world, view.buf, (uint32_t)count, &tool);
        if (result != DPT_OK)
            dpy_fail(result, "Tool", NULL);
        else if (!(self = dpy_member_make(type, holder, tool, NULL)))
            dpt_tool_remove(world, tool);
        dpy_world_leave(holder);
    }
    PyBuffer_Release(&view);
    return self;
}

/* A tool that is there already, as a scene's: of(world, id). */
static PyObject *tool_of(PyObject *type, PyObject *args)
{
    PyObject *world;
    unsigned id;
    if (!PyArg_ParseTuple(args, "OI:of", &world, &id))
        return NULL;
    dpy_world *holder = dpy_world_of(world);
    return holder ? dpy_member_make((PyTypeObject *)type, holder, id, NULL) : NULL;
}

static PyObject *tool_remove(PyObject *object, PyObject *unused)
{
    dpy_member *self = (dpy_member *)object;
    (void)unused;
    ON_WORLD("Tool.remove", dpt_tool_remove(world, self->id));
    return dpy_result(result, "Tool.remove");
}

static PyObject *tool_set_segments(PyObject *object, PyObject *segments)
{
    dpy_member *self = (dpy_member *)object;
    Py_buffer view;
    Py_ssize_t count;
    if (dpy_get_array(segments, &view, "", sizeof(dpt_segment), 1, &count, "segments") != 0)
        return NULL;
    dpt_world *world = dpy_world_enter(self->world, "Tool.set_segments");
    dpt_result result = world ? dpt_tool_set_segments(world, self->id, view.buf, (uint32_t)count) : DPT_OK;
    if (world)
        dpy_world_leave(self->world);
    PyBuffer_Release(&view);
    return world ? dpy_result(result, "Tool.set_segments") : NULL;
}

static PyObject *get_pose(PyObject *object, const char *what,
                          dpt_result (*get)(const dpt_world *, dpt_tool, dpt_pose *))
{
    dpy_member *self = (dpy_member *)object;
    dpt_pose pose;
    ON_WORLD(what, get(world, self->id, &pose));
    return result == DPT_OK ? dpy_make_pose(&pose) : dpy_fail(result, what, NULL);
}

static PyObject *tool_get_pose(PyObject *self, PyObject *unused)
{
    (void)unused;
    return get_pose(self, "Tool.pose", dpt_tool_get_pose);
}

static PyObject *tool_get_proxy(PyObject *self, PyObject *unused)
{
    (void)unused;
    return get_pose(self, "Tool.proxy", dpt_tool_get_proxy);
}

/* Six float64 that can be written to: force, then torque. */
static int get_wrench_buffer(PyObject *to, Py_buffer *view)
{
    Py_ssize_t rows;
    if (dpy_get_array(to, view, "d", 8, 1, &rows, "out") != 0)
        return -1;
    if (rows == 6 && !view->readonly)
        return 0;
    PyBuffer_Release(view);
    PyErr_SetString(PyExc_ValueError, "out: wanted 6 numbers of float64 that can be written to");
    return -1;
}

/*
 * What a call returns for a wrench: `out`, into whose view it is written, or a new array. wrench: NULL: an exception is set.
 * The view of `out` ends.
 */
static PyObject *hand_over(const dpt_wrench *wrench, dpt_result result, const char *what, PyObject *out,
                           Py_buffer *view)
{
    if (out && wrench)
        memcpy(view->buf, wrench, sizeof *wrench);
    if (out)
        PyBuffer_Release(view);
    if (!wrench)
        return NULL;
    if (result != DPT_OK)
        return dpy_fail(result, what, NULL);
    return out ? Py_NewRef(out) : dpy_make_numbers(wrench->force, 6);
}

/* get_wrench(out=None): a tuple of 6, or `out`. */
static PyObject *tool_get_wrench(PyObject *object, PyObject *const *args, Py_ssize_t count)
{
    dpy_member *self = (dpy_member *)object;
    dpt_wrench wrench;
    if (count > 1) {
        PyErr_SetString(PyExc_TypeError, "Tool.get_wrench(out=None)");
        return NULL;
    }
    Py_buffer view;
    int has_out = count == 1 && args[0] != Py_None;
    if (has_out && get_wrench_buffer(args[0], &view) != 0)
        return NULL;
    dpt_world *world = dpy_world_enter(self->world, "Tool.get_wrench");
    dpt_result result = world ? dpt_tool_get_wrench(world, self->id, &wrench) : DPT_OK;
    if (world)
        dpy_world_leave(self->world);
    return hand_over(world ? &wrench : NULL, result, "Tool.get_wrench", has_out ? args[0] : NULL, &view);
}

/* tick(pose, dt, out=None): set_pose, World.step and get_wrench in one call. */
static PyObject *tool_tick(PyObject *object, PyObject *const *args, Py_ssize_t count)
{
    dpy_member *self = (dpy_member *)object;
    dpt_pose room;
    const dpt_pose *pose;
    dpt_wrench wrench;
    Py_buffer view;
    if (count < 2 || count > 3) {
        PyErr_SetString(PyExc_TypeError, "Tool.tick(pose, dt, out=None)");
        return NULL;
    }
    double dt = PyFloat_AsDouble(args[1]);
    if ((dt == -1 && PyErr_Occurred()) || dpy_get_pose(args[0], &room, &pose) != 0)
        return NULL;
    int has_out = count == 3 && args[2] != Py_None;
    if (has_out && get_wrench_buffer(args[2], &view) != 0)
        return NULL;
    dpt_world *world = dpy_world_enter(self->world, "Tool.tick");
    dpt_result result = DPT_OK;
    if (world) {
        /* A pose that cannot be used ends the force: the step tells so, and is made. */
        dpt_result moved = dpt_tool_set_pose(world, self->id, pose);
        dpt_result stepped = dpt_world_step(world, dt, NULL);
        result = moved != DPT_OK ? moved : stepped;
        dpt_result got = dpt_tool_get_wrench(world, self->id, &wrench);
        if (result == DPT_OK)
            result = got;
        dpy_world_leave(self->world);
    }
    return hand_over(world ? &wrench : NULL, result, "Tool.tick", has_out ? args[2] : NULL, &view);
}

/* get(name, out, segment=0): one struct of the last step. */
static PyObject *tool_get(PyObject *object, PyObject *args)
{
    dpy_member *self = (dpy_member *)object;
    const char *name;
    PyObject *to;
    unsigned segment = 0;
    Py_buffer view;
    if (!PyArg_ParseTuple(args, "sO|I:get", &name, &to, &segment))
        return NULL;
    Py_ssize_t bytes = strcmp(name, "hit") == 0 || strcmp(name, "segment_hit") == 0 ? (Py_ssize_t)sizeof(dpt_hit)
                       : strcmp(name, "force") == 0                                 ? (Py_ssize_t)sizeof(dpt_force_info)
                                                                                    : (Py_ssize_t)sizeof(dpt_sweep);
    if (dpy_get_structs(to, &view, bytes, NULL, "out") != 0)
        return NULL;
    dpt_world *world = dpy_world_enter(self->world, "Tool");
    dpt_result result = DPT_OK;
    if (world) {
        result = strcmp(name, "hit") == 0           ? dpt_tool_get_hit(world, self->id, view.buf)
                 : strcmp(name, "segment_hit") == 0 ? dpt_tool_get_segment_hit(world, self->id, segment, view.buf)
                 : strcmp(name, "force") == 0       ? dpt_tool_get_force_info(world, self->id, view.buf)
                                                    : dpt_tool_get_sweep(world, self->id, segment, view.buf);
        dpy_world_leave(self->world);
    }
    PyBuffer_Release(&view);
    return world ? dpy_result(result, "Tool") : NULL;
}

/* list(name, out): how many there are; `out` has as many of them as it has room for. */
static PyObject *tool_list(PyObject *object, PyObject *args)
{
    dpy_member *self = (dpy_member *)object;
    const char *name;
    PyObject *to;
    Py_buffer view;
    Py_ssize_t rows;
    if (!PyArg_ParseTuple(args, "sO:list", &name, &to))
        return NULL;
    const int is_contacts = strcmp(name, "contacts") == 0, is_channels = strcmp(name, "channels") == 0;
    const Py_ssize_t bytes = is_contacts   ? (Py_ssize_t)sizeof(dpt_contact)
                             : is_channels ? (Py_ssize_t)sizeof(dpt_channel)
                                           : (Py_ssize_t)sizeof(dpt_tool_load);
    if (dpy_get_structs(to, &view, bytes, &rows, "out") != 0)
        return NULL;
    uint32_t count = 0;
    dpt_world *world = dpy_world_enter(self->world, "Tool");
    dpt_result result = DPT_OK;
    if (world) {
        result = is_contacts   ? dpt_tool_get_contacts(world, self->id, view.buf, (uint32_t)rows, &count)
                 : is_channels ? dpt_tool_get_channels(world, self->id, view.buf, (uint32_t)rows, &count)
                               : dpt_tool_get_loads(world, self->id, view.buf, (uint32_t)rows, &count);
        dpy_world_leave(self->world);
    }
    PyBuffer_Release(&view);
    if (!world)
        return NULL;
    if (result != DPT_OK)
        return dpy_fail(result,
                        is_contacts   ? "Tool.contacts"
                        : is_channels ? "Tool.channels"
                                      : "Tool.loads",
                        is_contacts && result == DPT_E_FULL ? "the world lists no contacts: give it max_contacts"
                        : is_channels && result == DPT_E_UNSUPPORTED ? "the world has no channels: give it max_channels"
                                                                     : NULL);
    return PyLong_FromUnsignedLong(count);
}

/* get_body_wrench(body): what this tool does to it. */
static PyObject *tool_get_body_wrench(PyObject *object, PyObject *body)
{
    dpy_member *self = (dpy_member *)object;
    dpt_wrench wrench;
    if (!PyObject_TypeCheck(body, (PyTypeObject *)dpy_body_type)) {
        PyErr_Format(PyExc_TypeError, "get_body_wrench: wanted a Body, not %R", body);
        return NULL;
    }
    ON_WORLD("Tool.get_body_wrench", dpt_tool_get_body_wrench(world, self->id, ((dpy_member *)body)->id, &wrench));
    return result == DPT_OK ? dpy_make_numbers(wrench.force, 6) : dpy_fail(result, "Tool.get_body_wrench", NULL);
}

static dpt_result read_settings(const dpt_world *world, uint32_t id, void *settings)
{
    return dpt_tool_get_settings(world, id, settings);
}

static dpt_result write_settings(dpt_world *world, uint32_t id, const void *settings)
{
    return dpt_tool_set_settings(world, id, settings);
}

static const dpy_member_calls calls = { "Tool",        "dpt_tool_settings", sizeof(dpt_tool_settings),
                                        read_settings, write_settings,      dpt_tool_is_valid };

static PyObject *tool_get_setting(PyObject *self, PyObject *name)
{
    return dpy_member_get_setting((dpy_member *)self, name, &calls);
}

static PyObject *tool_set_settings(PyObject *self, PyObject *args, PyObject *keywords)
{
    (void)args;
    return dpy_member_set_settings((dpy_member *)self, keywords, &calls);
}

static PyObject *tool_is_valid(PyObject *self, void *unused)
{
    (void)unused;
    return dpy_member_is_valid((dpy_member *)self, &calls);
}

static PyObject *tool_set_pose(PyObject *self, PyObject *to)
{
    return dpy_member_place((dpy_member *)self, to, "Tool.set_pose", dpt_tool_set_pose);
}

static PyObject *tool_insert(PyObject *object, PyObject *unused)
{
    dpy_member *self = (dpy_member *)object;
    (void)unused;
    ON_WORLD("Tool.insert", dpt_tool_insert(world, self->id));
    return dpy_result(result, "Tool.insert");
}

static PyObject *tool_teleport(PyObject *self, PyObject *to)
{
    return dpy_member_place((dpy_member *)self, to, "Tool.teleport", dpt_tool_teleport);
}

static PyMethodDef methods[] = { { "of", tool_of, METH_VARARGS | METH_CLASS, NULL },
                                 { "remove", tool_remove, METH_NOARGS, NULL },
                                 { "set_pose", tool_set_pose, METH_O, NULL },
                                 { "teleport", tool_teleport, METH_O, NULL },
                                 { "insert", tool_insert, METH_NOARGS, NULL },
                                 { "put_segments", tool_set_segments, METH_O, NULL },
                                 { "get_pose", tool_get_pose, METH_NOARGS, NULL },
                                 { "get_proxy", tool_get_proxy, METH_NOARGS, NULL },
                                 { "get_wrench", DPY_FASTCALL(tool_get_wrench), METH_FASTCALL, NULL },
                                 { "tick", DPY_FASTCALL(tool_tick), METH_FASTCALL, NULL },
                                 { "get", tool_get, METH_VARARGS, NULL },
                                 { "list", tool_list, METH_VARARGS, NULL },
                                 { "get_body_wrench", tool_get_body_wrench, METH_O, NULL },
                                 { "get_setting", tool_get_setting, METH_O, NULL },
                                 { "set_settings", DPY_FASTCALL(tool_set_settings), METH_VARARGS | METH_KEYWORDS,
                                   NULL },
                                 { NULL, NULL, 0, NULL } };
static PyGetSetDef properties[] = { { "valid", tool_is_valid, NULL, NULL, NULL },
                                    { "id", dpy_member_get_id, NULL, NULL, NULL },
                                    { "world", dpy_member_get_world, NULL, NULL, NULL },
                                    { NULL, NULL, NULL, NULL, NULL } };
static PyType_Slot slots[] = { { Py_tp_new, tool_new },
                               { Py_tp_dealloc, dpy_member_dealloc },
                               { Py_tp_methods, methods },
                               { Py_tp_getset, properties },
                               { 0, NULL } };
static PyType_Spec spec = { "dynpoint._dynpoint.Tool", sizeof(dpy_member), 0, Py_TPFLAGS_DEFAULT | Py_TPFLAGS_BASETYPE,
                            slots };

int dpy_tool_init(PyObject *module)
{
    dpy_tool_type = dpy_add_type(module, &spec);
    return dpy_tool_type ? 0 : -1;
}
