/* SPDX-License-Identifier: BSD-3-Clause */
/* Bodies, rigid and deformable, and the springs that move the latter. */
#include "bindings/python/python_answer.h"
#include "bindings/python/python_member.h"
#include "bindings/python/python_mesh.h"
#include "bindings/python/python_springs.h"

#include "dynpoint/insertion.h"

#include "platform/file.h"

#include <stdlib.h>
#include <string.h>

PyObject *dpy_body_type;

/* With a body's id: the key of its regions. */
#define REGIONS ((uint64_t)1 << 32)

/* Let the world keep what a body needs. */
static int keep(dpy_world *world, uint64_t id, PyObject *what)
{
    PyObject *key = PyLong_FromUnsignedLongLong(id);
    int result = key ? PyDict_SetItem(world->kept, key, what) : -1;
    Py_XDECREF(key);
    return result;
}

static void forget(dpy_world *world, uint64_t id)
{
    PyObject *key = PyLong_FromUnsignedLongLong(id);
    if (key && PyDict_DelItem(world->kept, key) != 0)
        PyErr_Clear();
    Py_XDECREF(key);
}

static void free_block(PyObject *capsule)
{
    free(PyCapsule_GetPointer(capsule, NULL));
}

/* The numbers of an array, one a vertex of the mesh, to `to`; with NULL for it they are only counted. 0, or -1. */
static int take_compliances(PyObject *from, const dpt_mesh *mesh, float *to, size_t *bytes)
{
    Py_buffer view;
    Py_ssize_t count;
    dpt_mesh_info info = { .size = sizeof info };
    *bytes = 0;
    if (from == Py_None)
        return 0;
    if (dpy_get_array(from, &view, "f", sizeof(float), 1, &count, "compliances") != 0)
        return -1;
    dpt_mesh_get_info(mesh, &info);
    const int is_right = count == (Py_ssize_t)info.vertices;
    *bytes = (size_t)view.len;
    if (is_right && to)
        memcpy(to, view.buf, *bytes);
    PyBuffer_Release(&view);
    if (!is_right)
        PyErr_Format(PyExc_ValueError, "compliances: wanted %u, one a vertex", info.vertices);
    return is_right ? 0 : -1;
}

/*
 * Body(world, mesh, pose=None, deformable=None, compliances=None): `deformable` is a dict of dpt_deformable_def's
 * fields; compliances are copied.
 */
static PyObject *body_new(PyTypeObject *type, PyObject *args, PyObject *keywords)
{
    static char *names[] = { "world", "mesh", "pose", "deformable", "compliances", NULL };
    PyObject *world_object, *mesh_object, *at = Py_None, *settings = Py_None, *compliances = Py_None, *block = NULL,
                                          *kept = NULL;
    if (!PyArg_ParseTupleAndKeywords(args, keywords, "OO|OOO:Body", names, &world_object, &mesh_object, &at, &settings,
                                     &compliances))
        return NULL;
    dpy_world *holder = dpy_world_of(world_object);
    const dpt_mesh *mesh = holder ? dpy_mesh_of(mesh_object) : NULL;
    dpt_pose room;
    const dpt_pose *pose;
    if (!mesh || dpy_get_pose(at, &room, &pose) != 0)
        return NULL;
    dpt_deformable_def def;
    dpt_deformable_def_init(&def);
    void *memory = NULL;
    size_t bytes = 0, more;
    if (settings != Py_None) {
        if (dpy_fill(&def, "dpt_deformable_def", settings) != 0)
            return NULL;
        def.mesh = mesh;
        def.pose = pose;
        bytes = dpt_deformable_bytes(&def);
        if (bytes == 0)
            return dpy_fail(DPT_E_ARGUMENT, "DeformableBody", NULL);
        if (take_compliances(compliances, mesh, NULL, &more) != 0)
            return NULL;
        if (!(memory = file_memory(bytes + more)))
            return PyErr_NoMemory();
        if (more) {
            float *numbers = (float *)(void *)((char *)memory + bytes);
            if (take_compliances(compliances, mesh, numbers, &more) != 0) {
                free(memory);
                return NULL;
            }
            def.compliances = numbers;
        }
        block = PyCapsule_New(memory, NULL, free_block);
        if (!block) {
            free(memory);
            return NULL;
        }
    }
    PyObject *self = NULL;
    kept = block ? PyTuple_Pack(2, mesh_object, block) : PyTuple_Pack(1, mesh_object);
    dpt_world *world = kept ? dpy_world_enter(holder, "Body") : NULL;
    if (world) {
        dpt_body body = 0;
        dpt_result result =
            block ? dpt_body_add_deformable(world, memory, bytes, &def, &body) : dpt_body_add(world, mesh, pose, &body);
        if (result != DPT_OK)
            dpy_fail(result, block ? "DeformableBody" : "Body", NULL);
        else if (keep(holder, body, kept) != 0 || !(self = dpy_member_make(type, holder, body, mesh_object)))
            dpt_body_remove(world, body);
        dpy_world_leave(holder);
    }
    Py_XDECREF(kept);
    Py_XDECREF(block);
    return self;
}

/* A body that is there already, as a scene's: of(world, id, mesh). */
static PyObject *body_of(PyObject *type, PyObject *args)
{
    PyObject *world, *mesh;
    unsigned id;
    if (!PyArg_ParseTuple(args, "OIO:of", &world, &id, &mesh))
        return NULL;
    dpy_world *holder = dpy_world_of(world);
    return holder ? dpy_member_make((PyTypeObject *)type, holder, id, mesh == Py_None ? NULL : mesh) : NULL;
}

static PyObject *body_remove(PyObject *object, PyObject *unused)
{
    dpy_member *self = (dpy_member *)object;
    (void)unused;
    ON_WORLD("Body.remove", dpt_body_remove(world, self->id));
    if (result != DPT_OK)
        return dpy_fail(result, "Body.remove", NULL);
    forget(self->world, self->id);
    forget(self->world, self->id | REGIONS);
    Py_RETURN_NONE;
}

/* set_regions(of_triangle, regions): bytes, and dpt_body_region one behind the other. The world keeps the first. */
static PyObject *body_set_regions(PyObject *object, PyObject *args)
{
    dpy_member *self = (dpy_member *)object;
    PyObject *of_triangle;
    Py_buffer regions;
    if (!PyArg_ParseTuple(args, "Sy*:set_regions", &of_triangle, &regions))
        return NULL;
    const uint32_t count = (uint32_t)(regions.len / (Py_ssize_t)sizeof(dpt_body_region));
    dpt_result result = DPT_OK;
    int is_kept = 0;
    dpt_world *world = dpy_world_enter(self->world, "Body");
    if (world) {
        result = dpt_body_set_regions(world, self->id, (const uint8_t *)PyBytes_AsString(of_triangle),
                                      (uint32_t)PyBytes_Size(of_triangle), regions.buf, count);
        /* After an error the body goes on with the bytes that it had. */
        is_kept = result != DPT_OK || keep(self->world, self->id | REGIONS, of_triangle) == 0;
        if (!is_kept)
            dpt_body_set_regions(world, self->id, NULL, 0, NULL, 0);
        dpy_world_leave(self->world);
    }
    PyBuffer_Release(&regions);
    return is_kept ? dpy_result(result, "Body.set_regions") : NULL;
}

static PyObject *body_get_pose(PyObject *object, PyObject *unused)
{
    dpy_member *self = (dpy_member *)object;
    dpt_pose pose;
    (void)unused;
    ON_WORLD("Body.pose", dpt_body_get_pose(world, self->id, &pose));
    return result == DPT_OK ? dpy_make_pose(&pose) : dpy_fail(result, "Body.pose", NULL);
}

static PyObject *body_get_wrench(PyObject *object, PyObject *unused)
{
    dpy_member *self = (dpy_member *)object;
    dpt_wrench wrench;
    (void)unused;
    ON_WORLD("Body.wrench", dpt_body_get_wrench(world, self->id, &wrench));
    return result == DPT_OK ? dpy_make_numbers(wrench.force, 6) : dpy_fail(result, "Body.wrench", NULL);
}

static PyObject *get_part(PyObject *part)
{
    return Py_NewRef(part ? part : Py_None);
}

static PyObject *body_get_mesh(PyObject *self, void *unused)
{
    (void)unused;
    return get_part(((dpy_member *)self)->part);
}

/* Positions, float32 of shape (n, 3): of vertices from `first` on; without a bound those that are foreseen. */
static PyObject *put_vertices(PyObject *object, PyObject *from, unsigned first, const double *bound, const char *what)
{
    dpy_member *self = (dpy_member *)object;
    Py_ssize_t count;
    Py_buffer view;
    dpt_result result = DPT_OK;
    if (dpy_get_array(from, &view, "f", 4, 3, &count, "vertices") != 0)
        return NULL;
    dpt_world *world = dpy_world_enter(self->world, what);
    if (world) {
        result = bound ? dpt_body_set_vertices(world, self->id, first, (uint32_t)count, view.buf, *bound)
                       : dpt_body_set_foreseen_vertices(world, self->id, first, (uint32_t)count, view.buf);
        dpy_world_leave(self->world);
    }
    PyBuffer_Release(&view);
    return world ? dpy_result(result, what) : NULL;
}

/* set_vertices(positions, first, bound) */
static PyObject *body_set_vertices(PyObject *object, PyObject *args)
{
    PyObject *from;
    unsigned first;
    double bound;
    return PyArg_ParseTuple(args, "OId:set_vertices", &from, &first, &bound)
               ? put_vertices(object, from, first, &bound, "DeformableBody.set_vertices")
               : NULL;
}

/* set_foreseen_vertices(positions, first) */
static PyObject *body_set_foreseen_vertices(PyObject *object, PyObject *args)
{
    PyObject *from;
    unsigned first;
    return PyArg_ParseTuple(args, "OI:set_foreseen_vertices", &from, &first)
               ? put_vertices(object, from, first, NULL, "DeformableBody.foresee")
               : NULL;
}

/* get_vertices(out): float32 of shape (n, 3), n being all of them; returns n, and writes nothing where `out` has not n. */
static PyObject *body_get_vertices(PyObject *object, PyObject *to)
{
    dpy_member *self = (dpy_member *)object;
    Py_buffer view;
    Py_ssize_t rows;
    if (dpy_get_array(to, &view, "f", 4, 3, &rows, "out") != 0)
        return NULL;
    const float *positions;
    uint32_t count = 0;
    dpt_world *world = dpy_world_enter(self->world, "DeformableBody.vertices");
    dpt_result result = world ? dpt_body_get_vertices(world, self->id, &positions, &count) : DPT_OK;
    if (world && result == DPT_OK && (uint32_t)rows == count && !view.readonly)
        memcpy(view.buf, positions, (size_t)view.len);
    if (world)
        dpy_world_leave(self->world);
    PyBuffer_Release(&view);
    if (!world)
        return NULL;
    return result == DPT_OK ? PyLong_FromUnsignedLong(count) : dpy_fail(result, "DeformableBody.vertices", NULL);
}

/* get_loads(out): how many there are; those are in `out` if it has room for all. */
static PyObject *body_get_loads(PyObject *object, PyObject *to)
{
    dpy_member *self = (dpy_member *)object;
    Py_buffer view;
    Py_ssize_t rows;
    if (dpy_get_array(to, &view, "", sizeof(dpt_load), 1, &rows, "out") != 0)
        return NULL;
    uint32_t count = 0;
    dpt_world *world = dpy_world_enter(self->world, "DeformableBody.loads");
    dpt_result result =
        world && !view.readonly ? dpt_body_get_loads(world, self->id, view.buf, (uint32_t)rows, &count) : DPT_OK;
    if (world)
        dpy_world_leave(self->world);
    PyBuffer_Release(&view);
    if (!world)
        return NULL;
    if (result == DPT_E_FULL && count > rows)
        result = DPT_OK;
    return result == DPT_OK ? PyLong_FromUnsignedLong(count) : dpy_fail(result, "DeformableBody.loads", NULL);
}

/* step_springs(springs, dt, info): physics of the tissue, without Python's lock; None: of a body with a compliance. */
static PyObject *body_step_springs(PyObject *object, PyObject *args)
{
    dpy_member *self = (dpy_member *)object;
    PyObject *springs_object, *info;
    double dt;
    Py_buffer view;
    if (!PyArg_ParseTuple(args, "OdO:step_springs", &springs_object, &dt, &info))
        return NULL;
    if (dpy_get_structs(info, &view, sizeof(dpt_springs_info), NULL, "info") != 0)
        return NULL;
    int is_own = springs_object == Py_None;
    dpt_springs *springs = is_own ? NULL : dpy_springs_enter(springs_object, "DeformableBody.step_springs");
    dpt_world *world = springs || is_own ? dpy_world_enter(self->world, "DeformableBody.step_springs") : NULL;
    dpt_result result = DPT_OK;
    if (world) {
        Py_BEGIN_ALLOW_THREADS result = dpt_body_step_springs(world, self->id, springs, dt, view.buf);
        Py_END_ALLOW_THREADS dpy_world_leave(self->world);
    }
    if (springs)
        dpy_springs_leave(springs_object);
    PyBuffer_Release(&view);
    return world ? dpy_result(result, "DeformableBody.step_springs") : NULL;
}

static dpt_result read_settings(const dpt_world *world, uint32_t id, void *settings)
{
    return dpt_body_get_settings(world, id, settings);
}

static dpt_result write_settings(dpt_world *world, uint32_t id, const void *settings)
{
    return dpt_body_set_settings(world, id, settings);
}

static const dpy_member_calls calls = { "Body",        "dpt_body_settings", sizeof(dpt_body_settings),
                                        read_settings, write_settings,      dpt_body_is_valid };

static PyObject *body_get_setting(PyObject *self, PyObject *name)
{
    return dpy_member_get_setting((dpy_member *)self, name, &calls);
}

static PyObject *body_set_settings(PyObject *self, PyObject *args, PyObject *keywords)
{
    (void)args;
    return dpy_member_set_settings((dpy_member *)self, keywords, &calls);
}

static PyObject *body_is_valid(PyObject *self, void *unused)
{
    (void)unused;
    return dpy_member_is_valid((dpy_member *)self, &calls);
}

static PyObject *body_set_pose(PyObject *self, PyObject *to)
{
    return dpy_member_place((dpy_member *)self, to, "Body.set_pose", dpt_body_set_pose);
}

static PyObject *body_teleport(PyObject *self, PyObject *to)
{
    return dpy_member_place((dpy_member *)self, to, "Body.teleport", dpt_body_teleport);
}

static PyMethodDef methods[] = { { "of", body_of, METH_VARARGS | METH_CLASS, NULL },
                                 { "remove", body_remove, METH_NOARGS, NULL },
                                 { "set_pose", body_set_pose, METH_O, NULL },
                                 { "teleport", body_teleport, METH_O, NULL },
                                 { "get_pose", body_get_pose, METH_NOARGS, NULL },
                                 { "get_wrench", body_get_wrench, METH_NOARGS, NULL },
                                 { "get_setting", body_get_setting, METH_O, NULL },
                                 { "set_settings", DPY_FASTCALL(body_set_settings), METH_VARARGS | METH_KEYWORDS,
                                   NULL },
                                 { "set_regions", body_set_regions, METH_VARARGS, NULL },
                                 { "set_vertices", body_set_vertices, METH_VARARGS, NULL },
                                 { "set_foreseen_vertices", body_set_foreseen_vertices, METH_VARARGS, NULL },
                                 { "get_vertices", body_get_vertices, METH_O, NULL },
                                 { "get_loads", body_get_loads, METH_O, NULL },
                                 { "step_springs", body_step_springs, METH_VARARGS, NULL },
                                 { "get_mean_loads", dpy_get_mean_loads, METH_O, NULL },
                                 { "set_answered_loads", dpy_set_answered_loads, METH_O, NULL },
                                 { NULL, NULL, 0, NULL } };
static PyGetSetDef properties[] = { { "valid", body_is_valid, NULL, NULL, NULL },
                                    { "id", dpy_member_get_id, NULL, NULL, NULL },
                                    { "mesh", body_get_mesh, NULL, NULL, NULL },
                                    { "world", dpy_member_get_world, NULL, NULL, NULL },
                                    { NULL, NULL, NULL, NULL, NULL } };
static PyType_Slot slots[] = { { Py_tp_new, body_new },
                               { Py_tp_dealloc, dpy_member_dealloc },
                               { Py_tp_methods, methods },
                               { Py_tp_getset, properties },
                               { 0, NULL } };
static PyType_Spec spec = { "dynpoint._dynpoint.Body", sizeof(dpy_member), 0, Py_TPFLAGS_DEFAULT | Py_TPFLAGS_BASETYPE,
                            slots };

int dpy_body_init(PyObject *module)
{
    dpy_body_type = dpy_add_type(module, &spec);
    return dpy_body_type ? 0 : -1;
}
