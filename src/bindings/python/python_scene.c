/* SPDX-License-Identifier: BSD-3-Clause */
/* dynpoint._dynpoint.Scene: a scene that is felt with a device (host.h). It ends with zero force, as a Device does. */
#include "bindings/python/python_scene.h"
#include "bindings/python/python_interrupt.h"
#include "bindings/python/python_mesh.h"
#include "bindings/python/python_world.h"

#include "dynpoint/host.h"
#include "view/scene_view.h"

#include <stdlib.h>
#include <string.h>

typedef struct dpy_scene {
    PyObject ob_base;
    dpy_owner owner;
    dpt_host *host;   /* NULL: it is closed */
    PyObject *bodies; /* meshes that it needs */
    PyObject *kept;   /* what its world needs beside them: a dict */
    PyObject *felt;   /* called after each tick, or NULL */
    PyObject *state, *wrench;
    Py_buffer state_view, wrench_view;
    dpy_world *world;        /* that was given away, and is there still; or NULL */
    int in_felt;             /* its function runs now: the scene is open to it */
    struct scene_view *view; /* what a viewer gets, or NULL; Python's lock keeps it */
} dpy_scene;

static dpt_host *enter(dpy_scene *self, const char *what)
{
    if (dpy_owner_enter(&self->owner, what) != 0)
        return NULL;
    if (self->host)
        return self->host;
    dpy_owner_leave(&self->owner);
    PyErr_Format(PyExc_ValueError, "%s: the scene is closed", what);
    return NULL;
}

/* What may be read within `felt` too: NULL, or a host that leave_reading ends. */
static dpt_host *enter_reading(dpy_scene *self, const char *what)
{
    return self->in_felt && dpy_owner_is_here(&self->owner) ? self->host : enter(self, what);
}

static void leave_reading(dpy_scene *self)
{
    if (!self->in_felt)
        dpy_owner_leave(&self->owner);
}

static void call_felt(dpy_scene *self, const dpt_loop_sample *sample, dpt_result result, const dpt_wrench *wrench)
{
    memcpy(self->state_view.buf, sample->state, sizeof *sample->state);
    memcpy(self->wrench_view.buf, wrench, sizeof *wrench);
    PyObject *name = PyUnicode_FromString(dpt_result_name(result));
    PyObject *made =
        name ? PyObject_CallFunction(self->felt, "OOdO", self->state, self->wrench, sample->dt, name) : NULL;
    Py_XDECREF(name);
    Py_XDECREF(made);
}

/* What is Python's sees the scene between ticks: its world is nobody's meanwhile. */
static void felt(void *user, dpt_host *host, const dpt_loop_sample *sample, dpt_result result, const dpt_wrench *wrench)
{
    dpy_scene *self = user;
    /* While the clutch is down there is no tick to be shown. */
    if (self->view && result != DPT_E_NOT_READY)
        scene_view_felt(self->view, host, sample, result);
    if (!self->felt)
        return;
    PyGILState_STATE state = PyGILState_Ensure();
    if (!PyErr_Occurred()) {
        if (self->world)
            dpy_world_leave(self->world);
        self->in_felt = 1;
        call_felt(self, sample, result, wrench);
        self->in_felt = 0;
        while (self->world && __atomic_exchange_n(&self->world->owner.busy, 1, __ATOMIC_ACQUIRE)) {
            Py_BEGIN_ALLOW_THREADS Py_END_ALLOW_THREADS
        }
        if (PyErr_Occurred())
            dpt_host_stop(host);
    }
    PyGILState_Release(state);
}

/* (mesh, pose, name, settings) each; `poses`, `settings` and `bodies` have room for `count`. */
static int read_bodies(PyObject *list, Py_ssize_t count, dpt_pose *poses, dpt_body_settings *settings,
                       dpt_host_body *bodies)
{
    for (Py_ssize_t i = 0; i < count; i++) {
        PyObject *item = PyList_GetItem(list, i), *mesh, *pose, *given;
        if (!item || !PyArg_ParseTuple(item, "OOOzO:bodies", &mesh, &pose, &given, &bodies[i].name, &item))
            return -1;
        bodies[i].size = sizeof *bodies;
        bodies[i].mesh = dpy_mesh_of(mesh);
        if (!bodies[i].mesh || dpy_get_pose(pose, poses + i, &bodies[i].pose) != 0)
            return -1;
        settings[i].size = sizeof *settings;
        if (given != Py_None) {
            if (dpy_fill(settings + i, "dpt_body_settings", given) != 0)
                return -1;
            bodies[i].settings = settings + i;
        }
        if (item != Py_None && dpy_fill(bodies + i, "dpt_host_body", item) != 0)
            return -1;
    }
    return 0;
}

/*
 * Scene(texts, tips, segments, bodies, info, felt, state, wrench, **settings)
 *   texts   a dict: scene, device, tool, identified, record, jaw
 */
static PyObject *scene_new(PyTypeObject *type, PyObject *args, PyObject *keywords)
{
    static const char *const names[] = { "scene", "device", "tool", "identified", "record", "jaw" };
    PyObject *texts, *tips, *segments, *bodies, *info, *called, *state, *wrench;
    if (!PyArg_ParseTuple(args, "O!O!OO!OOOO:Scene", &PyDict_Type, &texts, &PyList_Type, &tips, &segments, &PyList_Type,
                          &bodies, &info, &called, &state, &wrench))
        return NULL;
    dpt_host_def def;
    dpt_host_def_init(&def);
    const char **places[] = { &def.scene, &def.device, &def.tool, &def.identified, &def.record, &def.jaw };
    if (dpy_fill(&def, "dpt_host_def", keywords) != 0)
        return NULL;
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        PyObject *text = PyDict_GetItemString(texts, names[i]);
        if (text && text != Py_None && !(*places[i] = PyBytes_AsString(text)))
            return NULL;
    }
    Py_ssize_t tip_count = PyList_Size(tips), body_count = PyList_Size(bodies), count;
    if (tip_count > 16 || body_count > 64) {
        PyErr_SetString(PyExc_ValueError, "Scene: wanted 16 tips and 64 bodies at most");
        return NULL;
    }
    const char *tip_texts[17] = { NULL };
    for (Py_ssize_t i = 0; i < tip_count; i++)
        if (!(tip_texts[i] = PyBytes_AsString(PyList_GetItem(tips, i))))
            return NULL;
    if (tip_count > 0)
        def.tips = tip_texts;
    dpt_pose poses[64];
    dpt_body_settings settings[64];
    dpt_host_body own[64];
    memset(own, 0, sizeof own);
    memset(settings, 0, sizeof settings);
    if (read_bodies(bodies, body_count, poses, settings, own) != 0)
        return NULL;
    if (body_count > 0)
        def.bodies = own;
    def.body_count = (uint32_t)body_count;
    Py_buffer segment_view, info_view;
    dpy_scene *self = NULL;
    if (segments != Py_None) {
        if (dpy_get_array(segments, &segment_view, "", sizeof(dpt_segment), 1, &count, "segments") != 0)
            return NULL;
        def.segments = segment_view.buf;
        def.segment_count = (uint32_t)count;
    }
    if (info != Py_None) {
        if (dpy_get_structs(info, &info_view, sizeof(dpt_device_info), NULL, "info") != 0)
            goto no_info;
        def.info = info_view.buf;
    }
    self = (dpy_scene *)dpy_allocate(type);
    if (!self)
        goto done;
    dpy_owner_init(&self->owner);
    self->bodies = Py_NewRef(bodies);
    if (!(self->kept = PyDict_New())) {
        Py_CLEAR(self);
        goto done;
    }
    if (called != Py_None) {
        if (dpy_get_structs(state, &self->state_view, sizeof(dpt_device_state), NULL, "state") != 0 ||
            dpy_get_array(wrench, &self->wrench_view, "d", 8, 6, NULL, "wrench") != 0) {
            Py_CLEAR(self);
            goto done;
        }
        self->felt = Py_NewRef(called);
        self->state = Py_NewRef(state);
        self->wrench = Py_NewRef(wrench);
    }
    def.felt = felt;
    def.user = self;
    dpt_host_error error = { .size = sizeof error };
    dpt_result result;
    Py_BEGIN_ALLOW_THREADS result = dpt_host_open(&def, &self->host, &error);
    Py_END_ALLOW_THREADS if (result != DPT_OK)
    {
        self->host = NULL;
        dpy_fail(result, "Scene", error.text);
        Py_CLEAR(self);
    }
    else if (error.text[0] && PyErr_WarnFormat(PyExc_UserWarning, 1, "%s", error.text) != 0)
    {
        Py_CLEAR(self);
    }
done:
    if (info != Py_None)
        PyBuffer_Release(&info_view);
no_info:
    if (segments != Py_None)
        PyBuffer_Release(&segment_view);
    return (PyObject *)self;
}

/* 0, or -1 with an exception: some of a recording could not be written. */
static int let_go(dpy_scene *self)
{
    dpt_host *host = self->host;
    dpt_host_error error = { .size = sizeof error };
    dpt_result result = DPT_OK;
    scene_view_close(self->view);
    self->view = NULL;
    self->host = NULL;
    if (self->world)
        dpy_world_forget(self->world);
    if (host && dpy_owner_is_here(&self->owner)) {
        Py_BEGIN_ALLOW_THREADS result = dpt_host_close(host, &error);
        Py_END_ALLOW_THREADS
    }
    Py_CLEAR(self->bodies);
    Py_CLEAR(self->kept);
    Py_CLEAR(self->felt);
    if (self->state_view.obj)
        PyBuffer_Release(&self->state_view);
    if (self->wrench_view.obj)
        PyBuffer_Release(&self->wrench_view);
    Py_CLEAR(self->state);
    Py_CLEAR(self->wrench);
    if (result == DPT_OK)
        return 0;
    dpy_fail(result, "Scene.close", error.text);
    return -1;
}

static void scene_dealloc(PyObject *self)
{
    PyObject *type, *value, *trace;
    PyErr_Fetch(&type, &value, &trace);
    if (let_go((dpy_scene *)self) != 0)
        PyErr_WriteUnraisable(NULL);
    PyErr_Restore(type, value, trace);
    dpy_free(self);
}

static PyObject *scene_close(PyObject *object, PyObject *unused)
{
    dpy_scene *self = (dpy_scene *)object;
    (void)unused;
    if (!self->host)
        Py_RETURN_NONE;
    if (dpy_owner_enter(&self->owner, "Scene.close") != 0)
        return NULL;
    int result = let_go(self);
    dpy_owner_leave(&self->owner);
    return result == 0 ? Py_NewRef(Py_None) : NULL;
}

static void stop(void *host)
{
    dpt_host_stop(host);
}

/* run(stats): serve the device in this thread, without Python's lock; what a person should know, or "". */
static PyObject *scene_run(PyObject *object, PyObject *to)
{
    dpy_scene *self = (dpy_scene *)object;
    Py_buffer stats;
    if (dpy_get_structs(to, &stats, sizeof(dpt_loop_stats), NULL, "stats") != 0)
        return NULL;
    PyObject *answer = NULL;
    dpt_host *host = enter(self, "Scene.run");
    if (host && (!self->world || dpy_owner_enter(&self->world->owner, "Scene.run") == 0)) {
        dpt_host_error error = { .size = sizeof error };
        dpy_interrupt interrupt = { stop, host, 0 };
        if (dpy_interrupt_begin(&interrupt) == 0) {
            PyThreadState *released = PyEval_SaveThread();
            dpt_result result = dpt_host_run(host, stats.buf, &error);
            PyEval_RestoreThread(released);
            int is_interrupted = dpy_interrupt_end(&interrupt);
            if (!PyErr_Occurred() && is_interrupted == 0) {
                if (result == DPT_OK)
                    answer = PyUnicode_FromString(error.text);
                else
                    dpy_fail(result, "Scene.run", error.text);
            }
        }
        if (self->world)
            dpy_world_leave(self->world);
    }
    if (host)
        dpy_owner_leave(&self->owner);
    PyBuffer_Release(&stats);
    return answer;
}

/* stop(): from any thread, also while it runs. */
static PyObject *scene_stop(PyObject *object, PyObject *unused)
{
    dpy_scene *self = (dpy_scene *)object;
    (void)unused;
    if (self->host && dpy_owner_is_here(&self->owner))
        dpt_host_stop(self->host);
    Py_RETURN_NONE;
}

/* tick(state, now_ns): what to send, a tuple of 6, in a loop of Python's own. */
static PyObject *scene_tick(PyObject *object, PyObject *args)
{
    dpy_scene *self = (dpy_scene *)object;
    PyObject *from;
    unsigned long long now;
    Py_buffer state;
    if (!PyArg_ParseTuple(args, "OK:tick", &from, &now) ||
        dpy_get_structs(from, &state, sizeof(dpt_device_state), NULL, "state") != 0)
        return NULL;
    PyObject *answer = NULL;
    dpt_host *host = enter(self, "Scene.tick");
    if (host && (!self->world || dpy_owner_enter(&self->world->owner, "Scene.tick") == 0)) {
        dpt_wrench wrench = { { 0, 0, 0 }, { 0, 0, 0 } };
        /* Its wrench is to be sent whatever it returns: after a tick that failed the guard ends the force. */
        dpt_result result = dpt_host_tick(host, state.buf, now, &wrench);
        if (self->world)
            dpy_world_leave(self->world);
        if (!PyErr_Occurred())
            answer =
                result == DPT_E_ARGUMENT ? dpy_fail(result, "Scene.tick", NULL) : dpy_make_numbers(wrench.force, 6);
    }
    if (host)
        dpy_owner_leave(&self->owner);
    PyBuffer_Release(&state);
    return answer;
}

static PyObject *scene_get_info(PyObject *object, PyObject *to)
{
    dpy_scene *self = (dpy_scene *)object;
    Py_buffer view;
    if (dpy_get_structs(to, &view, sizeof(dpt_host_info), NULL, "info") != 0)
        return NULL;
    dpt_host *host = enter_reading(self, "Scene.info");
    dpt_result result = DPT_OK;
    if (host) {
        result = dpt_host_get_info(host, view.buf);
        leave_reading(self);
    }
    PyBuffer_Release(&view);
    if (!host)
        return NULL;
    return result == DPT_OK ? Py_NewRef(to) : dpy_fail(result, "Scene.info", NULL);
}

/* get_world(type): the scene's world, the same each time; it keeps the scene. */
static PyObject *scene_get_world(PyObject *object, PyObject *type)
{
    dpy_scene *self = (dpy_scene *)object;
    if (self->world)
        return Py_NewRef((PyObject *)self->world);
    dpt_host *host = enter_reading(self, "Scene.world");
    if (!host)
        return NULL;
    PyObject *world = dpy_world_wrap((PyTypeObject *)type, dpt_host_get_world(host), object, &self->world, self->kept);
    leave_reading(self);
    return world;
}

static PyObject *scene_get_tool(PyObject *object, PyObject *unused)
{
    (void)unused;
    return PyLong_FromUnsignedLong(dpt_host_get_tool(((dpy_scene *)object)->host));
}

static PyObject *scene_get_body(PyObject *object, PyObject *index)
{
    unsigned long number = PyLong_AsUnsignedLong(index);
    if (PyErr_Occurred())
        return NULL;
    return PyLong_FromUnsignedLong(dpt_host_get_body(((dpy_scene *)object)->host, (uint32_t)number));
}

/* view_begin(title, device or "", control): a viewer's first message; its frames are of the ticks from now on. */
static PyObject *scene_view_begin(PyObject *object, PyObject *args)
{
    dpy_scene *self = (dpy_scene *)object;
    const char *title, *device;
    int control;
    if (!PyArg_ParseTuple(args, "yyp:view_begin", &title, &device, &control))
        return NULL;
    dpt_host *host = enter(self, "Scene.view");
    if (!host)
        return NULL;
    PyObject *answer = NULL;
    if (self->view) {
        PyErr_SetString(PyExc_RuntimeError, "Scene.view: it is viewed already; close that view first");
    } else if (control && !scene_view_can_steer_host(host)) {
        PyErr_SetString(PyExc_ValueError,
                        "control: only a simulated hand can be steered, as that of 'sim:?hand=hold&live=1'");
    } else {
        self->view = scene_view_open_host(host, title, device[0] ? device : NULL, control);
        const struct view_message first =
            self->view ? scene_view_first(self->view) : (struct view_message){ .size = 0 };
        answer = self->view ? PyBytes_FromStringAndSize(first.bytes, (Py_ssize_t)first.size) : PyErr_NoMemory();
    }
    dpy_owner_leave(&self->owner);
    return answer;
}

static PyObject *scene_view_end(PyObject *object, PyObject *unused)
{
    dpy_scene *self = (dpy_scene *)object;
    (void)unused;
    if (!self->view)
        Py_RETURN_NONE;
    if (!enter(self, "View.close"))
        return NULL;
    scene_view_close(self->view);
    self->view = NULL;
    dpy_owner_leave(&self->owner);
    Py_RETURN_NONE;
}

/* view_next(): a newer frame, or None. Of one thread, which need not be that of the loop. */
static PyObject *scene_view_next_frame(PyObject *object, PyObject *unused)
{
    dpy_scene *self = (dpy_scene *)object;
    struct view_message frame;
    (void)unused;
    if (self->view && dpy_owner_is_here(&self->owner) && scene_view_next(self->view, &frame))
        return PyBytes_FromStringAndSize(frame.bytes, (Py_ssize_t)frame.size);
    Py_RETURN_NONE;
}

/* view_steer(x, y, z): where the simulated hand is to go, in the scene. */
static PyObject *scene_view_steer_hand(PyObject *object, PyObject *args)
{
    dpy_scene *self = (dpy_scene *)object;
    double at[3];
    if (!PyArg_ParseTuple(args, "ddd:view_steer", &at[0], &at[1], &at[2]))
        return NULL;
    if (self->view && dpy_owner_is_here(&self->owner))
        scene_view_steer(self->view, at);
    Py_RETURN_NONE;
}

static PyObject *scene_is_closed(PyObject *self, void *unused)
{
    (void)unused;
    return PyBool_FromLong(!((dpy_scene *)self)->host);
}

static PyObject *scene_is_running(PyObject *self, void *unused)
{
    (void)unused;
    return PyBool_FromLong(__atomic_load_n(&((dpy_scene *)self)->owner.busy, __ATOMIC_ACQUIRE));
}

static PyMethodDef methods[] = { { "close", scene_close, METH_NOARGS, NULL },
                                 { "run_into", scene_run, METH_O, NULL },
                                 { "stop", scene_stop, METH_NOARGS, NULL },
                                 { "decide", scene_tick, METH_VARARGS, NULL },
                                 { "get_info", scene_get_info, METH_O, NULL },
                                 { "get_world", scene_get_world, METH_O, NULL },
                                 { "get_tool", scene_get_tool, METH_NOARGS, NULL },
                                 { "get_body", scene_get_body, METH_O, NULL },
                                 { "view_begin", scene_view_begin, METH_VARARGS, NULL },
                                 { "view_end", scene_view_end, METH_NOARGS, NULL },
                                 { "view_next", scene_view_next_frame, METH_NOARGS, NULL },
                                 { "view_steer", scene_view_steer_hand, METH_VARARGS, NULL },
                                 { NULL, NULL, 0, NULL } };
static PyGetSetDef properties[] = { { "closed", scene_is_closed, NULL, NULL, NULL },
                                    { "running", scene_is_running, NULL, NULL, NULL },
                                    { NULL, NULL, NULL, NULL, NULL } };
static PyType_Slot slots[] = { { Py_tp_new, scene_new },
                               { Py_tp_dealloc, scene_dealloc },
                               { Py_tp_methods, methods },
                               { Py_tp_getset, properties },
                               { 0, NULL } };
static PyType_Spec spec = { "dynpoint._dynpoint.Scene", sizeof(dpy_scene), 0, Py_TPFLAGS_DEFAULT | Py_TPFLAGS_BASETYPE,
                            slots };

int dpy_scene_init(PyObject *module)
{
    PyObject *type = dpy_add_type(module, &spec);
    Py_XDECREF(type);
    return type ? 0 : -1;
}
