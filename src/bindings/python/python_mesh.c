/* SPDX-License-Identifier: BSD-3-Clause */
#include "bindings/python/python_mesh.h"

#include "dynpoint/compile.h"
#include "dynpoint/query.h"

#include "platform/file.h"

#include <stdlib.h>
#include <string.h>

PyObject *dpy_mesh_type;

const dpt_mesh *dpy_mesh_of(PyObject *object)
{
    if (PyObject_TypeCheck(object, (PyTypeObject *)dpy_mesh_type))
        return ((dpy_mesh *)object)->mesh;
    PyErr_Format(PyExc_TypeError, "wanted a Mesh, not %R", object);
    return NULL;
}

static void free_bytes(void *bytes, size_t size, int is_compiled)
{
    dpt_compiled compiled = { bytes, size };
    if (is_compiled)
        dpt_compiled_free(&compiled);
    else
        free(bytes);
}

/* A mesh that looks into bytes of its own, which it frees. */
static PyObject *own(PyTypeObject *type, void *bytes, size_t size, int is_compiled, const char *what)
{
    dpy_mesh *self = (dpy_mesh *)dpy_allocate(type);
    if (self) {
        self->bytes = bytes;
        self->is_compiled = is_compiled;
        self->size = (Py_ssize_t)size;
        dpt_mesh_fault fault = { .size = sizeof fault };
        dpt_result result = dpt_mesh_open(bytes, size, &self->mesh);
        if (result == DPT_OK)
            return (PyObject *)self;
        if (dpt_mesh_verify(bytes, size, &fault) != DPT_OK && fault.section[0]) {
            PyObject *text = PyUnicode_FromFormat("%s (byte %llu, %s)", dpt_result_text(result),
                                                  (unsigned long long)fault.byte, fault.section);
            PyObject *utf8 = text ? PyUnicode_AsUTF8String(text) : NULL;
            if (utf8)
                dpy_fail(result, what, PyBytes_AsString(utf8));
            Py_XDECREF(utf8);
            Py_XDECREF(text);
        } else
            dpy_fail(result, what, NULL);
        Py_DECREF(self);
        return NULL;
    }
    free_bytes(bytes, size, is_compiled);
    return NULL;
}

static PyObject *mesh_new(PyTypeObject *type, PyObject *args, PyObject *keywords)
{
    static char *names[] = { "content", NULL };
    Py_buffer view;
    if (!PyArg_ParseTupleAndKeywords(args, keywords, "y*:Mesh", names, &view))
        return NULL;
    void *bytes = file_memory(view.len > 0 ? (size_t)view.len : 1);
    if (!bytes)
        PyErr_NoMemory();
    else
        memcpy(bytes, view.buf, (size_t)view.len);
    size_t size = (size_t)view.len;
    PyBuffer_Release(&view);
    return bytes && !PyErr_Occurred() ? own(type, bytes, size, 0, "Mesh") : NULL;
}

static void mesh_dealloc(PyObject *self)
{
    const dpy_mesh *mesh = (dpy_mesh *)self;
    free_bytes(mesh->bytes, (size_t)mesh->size, mesh->is_compiled);
    dpy_free(self);
}

static int mesh_get_buffer(PyObject *self, Py_buffer *view, int flags)
{
    return PyBuffer_FillInfo(view, self, ((dpy_mesh *)self)->bytes, ((dpy_mesh *)self)->size, 1, flags);
}

/* A compilation without Python's lock, which it takes for what Python is to know. */
typedef struct compilation {
    PyThreadState *released;
    PyObject *notes;
} compilation;

static int goes_on(void *user, const char *step, double done)
{
    compilation *now = user;
    (void)step;
    (void)done;
    PyEval_RestoreThread(now->released);
    int stops = PyErr_Occurred() || PyErr_CheckSignals() != 0;
    now->released = PyEval_SaveThread();
    return stops;
}

static void keep_note(void *user, const dpt_diag *note)
{
    compilation *now = user;
    PyEval_RestoreThread(now->released);
    PyObject *text = PyErr_Occurred() ? NULL : PyUnicode_FromString(note->text);
    if (text)
        (void)PyList_Append(now->notes, text);
    Py_XDECREF(text);
    now->released = PyEval_SaveThread();
}

static PyObject *say_place(const dpt_diag *diag)
{
    if (diag->line > 0)
        return PyUnicode_FromFormat("line %llu: %s", (unsigned long long)diag->line, diag->text);
    if (diag->byte > 0)
        return PyUnicode_FromFormat("byte %llu: %s", (unsigned long long)diag->byte, diag->text);
    return PyUnicode_FromString(diag->text);
}

/* Springs of a dict: numbers, `fixed` of uint32 and `regions` of structs. */
static int read_springs(PyObject *from, dpt_spring_net_def *net, Py_buffer *fixed, Py_buffer *regions)
{
    PyObject *rest = PyDict_Copy(from);
    int result = -1;
    if (!rest)
        return -1;
    PyObject *held = PyDict_GetItemString(rest, "fixed"), *places = PyDict_GetItemString(rest, "regions");
    Py_ssize_t count;
    if (held) {
        if (dpy_get_array(held, fixed, "I", 4, 1, &count, "springs['fixed']") != 0)
            goto done;
        net->fixed = fixed->buf;
        net->fixed_count = (uint32_t)count;
        PyDict_DelItemString(rest, "fixed");
    }
    if (places) {
        if (dpy_get_array(places, regions, "", sizeof(dpt_spring_region), 1, &count, "springs['regions']") != 0)
            goto done;
        net->regions = regions->buf;
        net->region_count = (uint32_t)count;
        PyDict_DelItemString(rest, "regions");
    }
    result = dpy_fill(net, "dpt_spring_net_def", rest);
done:
    Py_DECREF(rest);
    return result;
}

/*
 * compile_source(what, vertices, triangles, notes, springs, nodes, cells, **settings): from arrays; from the bytes of a file if
 * triangles is None, whose name is `what`.
 */
static PyObject *mesh_compile(PyObject *type, PyObject *args, PyObject *keywords)
{
    PyObject *source, *triangles, *notes, *springs, *nodes, *cells, *mesh = NULL;
    const char *what;
    if (!PyArg_ParseTuple(args, "sOOO!OOO:compile_source", &what, &source, &triangles, &PyList_Type, &notes, &springs,
                          &nodes, &cells))
        return NULL;
    Py_buffer views[6];
    memset(views, 0, sizeof views);
    Py_ssize_t vertex_count = 0, triangle_count = 0, count;
    dpt_compile_def def;
    dpt_spring_net_def net;
    dpt_compile_def_init(&def);
    dpt_spring_net_def_init(&net);
    int is_file = triangles == Py_None;
    if (is_file ? dpy_get_array(source, views, "B", 1, 1, &vertex_count, what) != 0
                : dpy_get_array(source, views, "d", 8, 3, &vertex_count, "vertices") != 0 ||
                      dpy_get_array(triangles, views + 1, "I", 4, 3, &triangle_count, "triangles") != 0)
        goto done;
    if (springs != Py_None) {
        if (read_springs(springs, &net, views + 2, views + 3) != 0)
            goto done;
        def.springs = &net;
    }
    if (nodes != Py_None) {
        if (dpy_get_array(nodes, views + 4, "d", 8, 3, &count, "nodes") != 0)
            goto done;
        def.nodes = views[4].buf;
        def.node_count = (uint32_t)count;
        if (dpy_get_array(cells, views + 5, "I", 4, 4, &count, "cells") != 0)
            goto done;
        def.cells = views[5].buf;
        def.cell_count = (uint32_t)count;
    }
    if (dpy_fill(&def, "dpt_compile_def", keywords) != 0)
        goto done;
    compilation now = { .notes = notes };
    dpt_compiled compiled = { NULL, 0 };
    dpt_diag diag = { .size = sizeof diag };
    def.progress = goes_on;
    def.note = keep_note;
    def.user = def.note_user = &now;
    def.name = is_file ? what : NULL;
    now.released = PyEval_SaveThread();
    dpt_result result = is_file ? dpt_compile_bytes(views[0].buf, (size_t)views[0].len, &def, &compiled, &diag)
                                : dpt_compile_arrays(views[0].buf, (size_t)vertex_count, views[1].buf,
                                                     (size_t)triangle_count, &def, &compiled, &diag);
    PyEval_RestoreThread(now.released);
    if (result == DPT_OK && !PyErr_Occurred())
        mesh = own((PyTypeObject *)type, compiled.bytes, compiled.size, 1, what);
    else
        dpt_compiled_free(&compiled);
    if (result != DPT_OK && !PyErr_Occurred()) {
        PyObject *place = say_place(&diag), *utf8 = place ? PyUnicode_AsUTF8String(place) : NULL;
        if (utf8)
            dpy_fail(result, what, PyBytes_AsString(utf8));
        Py_XDECREF(utf8);
        Py_XDECREF(place);
    }
done:
    for (size_t i = 0; i < sizeof views / sizeof *views; i++)
        if (views[i].obj)
            PyBuffer_Release(views + i);
    return mesh;
}

/* query(ends, radii, hits, pose, first, count, **settings): rows first to first + count, without Python's lock. */
static PyObject *mesh_query(PyObject *self, PyObject *args, PyObject *keywords)
{
    PyObject *ends, *radii, *hits, *at;
    Py_ssize_t first, count, rows, radius_count = 0, hit_count;
    if (!PyArg_ParseTuple(args, "OOOOnn:query", &ends, &radii, &hits, &at, &first, &count))
        return NULL;
    Py_buffer end_view, radius_view, hit_view;
    dpt_query_def def;
    dpt_pose room;
    const dpt_pose *pose;
    memset(&def, 0, sizeof def);
    def.size = sizeof def;
    if (dpy_fill(&def, "dpt_query_def", keywords) != 0 || dpy_get_pose(at, &room, &pose) != 0)
        return NULL;
    if (dpy_get_array(ends, &end_view, "d", 8, 6, &rows, "ends") != 0)
        return NULL;
    PyObject *answer = NULL;
    if (radii != Py_None && dpy_get_array(radii, &radius_view, "d", 8, 1, &radius_count, "radius") != 0)
        goto no_radii;
    if (dpy_get_array(hits, &hit_view, "", sizeof(dpt_hit), 1, &hit_count, "hits") != 0)
        goto no_hits;
    if (first < 0 || count < 0 || count > rows - first || hit_count < rows || hit_view.readonly ||
        (radii != Py_None && radius_count < rows)) {
        PyErr_Format(PyExc_ValueError, "query: wanted %zd radii and room for as many hits", rows);
    } else {
        dpt_hit *out = (dpt_hit *)hit_view.buf + first;
        dpt_result result = DPT_OK;
        if (count > 0)
            out->size = sizeof *out;
        Py_BEGIN_ALLOW_THREADS result = dpt_query_segments(
            ((dpy_mesh *)self)->mesh, pose, (const double *)end_view.buf + 6 * first,
            radii != Py_None ? (const double *)radius_view.buf + first : NULL, (size_t)count, out, &def);
        Py_END_ALLOW_THREADS answer = result == DPT_OK ? Py_NewRef(Py_None) : dpy_fail(result, "Mesh.query", NULL);
    }
    PyBuffer_Release(&hit_view);
no_hits:
    if (radii != Py_None)
        PyBuffer_Release(&radius_view);
no_radii:
    PyBuffer_Release(&end_view);
    return answer;
}

static PyObject *mesh_get_info(PyObject *self, PyObject *to)
{
    Py_buffer view;
    if (dpy_get_structs(to, &view, sizeof(dpt_mesh_info), NULL, "info") != 0)
        return NULL;
    dpt_result result = dpt_mesh_get_info(((dpy_mesh *)self)->mesh, view.buf);
    PyBuffer_Release(&view);
    return result == DPT_OK ? Py_NewRef(Py_None) : dpy_fail(result, "Mesh.info", NULL);
}

/* place(name): where an array lies in the buffer, and how many items it has; None where the mesh has none. */
static PyObject *mesh_place(PyObject *self, PyObject *args)
{
    const dpt_mesh *mesh = ((dpy_mesh *)self)->mesh;
    const char *name;
    if (!PyArg_ParseTuple(args, "s:place", &name))
        return NULL;
    const float *reals = NULL;
    const uint32_t *words = NULL, *others = NULL;
    uint32_t count = 0;
    dpt_result result;
    const void *at;
    if (strcmp(name, "vertices") == 0)
        result = dpt_mesh_get_vertices(mesh, &reals, &count), at = reals, count *= 3;
    else if (strcmp(name, "triangles") == 0)
        result = dpt_mesh_get_triangles(mesh, &words, &others, &count), at = words, count *= 3;
    else if (strcmp(name, "numbers") == 0)
        result = dpt_mesh_get_triangles(mesh, &others, &words, &count), at = words;
    else if (strcmp(name, "sources") == 0)
        result = dpt_mesh_get_vertex_sources(mesh, &words, &count), at = words;
    else {
        PyErr_Format(PyExc_ValueError, "place: there is no array %s", name);
        return NULL;
    }
    if (result != DPT_OK)
        return dpy_fail(result, "Mesh", NULL);
    return Py_BuildValue("nI", (Py_ssize_t)((const char *)at - (const char *)((dpy_mesh *)self)->bytes), count);
}

static PyMethodDef methods[] = { { "compile_source", DPY_FASTCALL(mesh_compile),
                                   METH_VARARGS | METH_KEYWORDS | METH_CLASS, NULL },
                                 { "query_rows", DPY_FASTCALL(mesh_query), METH_VARARGS | METH_KEYWORDS, NULL },
                                 { "get_info", mesh_get_info, METH_O, NULL },
                                 { "place", mesh_place, METH_VARARGS, NULL },
                                 { NULL, NULL, 0, NULL } };

static PyType_Slot slots[] = { { Py_tp_new, mesh_new },
                               { Py_tp_dealloc, mesh_dealloc },
                               { Py_tp_methods, methods },
                               { Py_bf_getbuffer, mesh_get_buffer },
                               { 0, NULL } };
static PyType_Spec spec = { "dynpoint._dynpoint.Mesh", sizeof(dpy_mesh), 0, Py_TPFLAGS_DEFAULT | Py_TPFLAGS_BASETYPE,
                            slots };

int dpy_mesh_init(PyObject *module)
{
    dpy_mesh_type = dpy_add_type(module, &spec);
    return dpy_mesh_type ? 0 : -1;
}
