/* SPDX-License-Identifier: BSD-3-Clause */
/* dynpoint._dynpoint: what the typed package (dynpoint/) stands on. */
#include "bindings/python/python_arm.h"
#include "bindings/python/python_batch.h"
#include "bindings/python/python_device.h"
#include "bindings/python/python_guard.h"
#include "bindings/python/python_loop.h"
#include "bindings/python/python_mesh.h"
#include "bindings/python/python_record.h"
#include "bindings/python/python_scene.h"
#include "bindings/python/python_springs.h"
#include "bindings/python/python_world.h"

#include "dynpoint/host.h"
#include "dynpoint/record.h"

/* read_header(bytes): text, rate, began_ns, writer_version and where the first record begins. */
static PyObject *read_header(PyObject *module, PyObject *from)
{
    Py_buffer view;
    (void)module;
    if (PyObject_GetBuffer(from, &view, PyBUF_SIMPLE) != 0)
        return NULL;
    dpt_record_header header = { .size = sizeof header };
    size_t at = 0;
    dpt_result result = dpt_record_header_read(view.buf, (size_t)view.len, &header, &at);
    PyObject *answer = result == DPT_OK
                           ? Py_BuildValue("s#dKIn", header.text, (Py_ssize_t)header.text_bytes, header.rate,
                                           (unsigned long long)header.began_ns, header.writer_version, (Py_ssize_t)at)
                           : dpy_fail(result, "Recording", NULL);
    PyBuffer_Release(&view);
    return answer;
}

/* read_records(bytes, at, out): how many were read into `out`, where the next begins, and "" or the name of what ended it. */
static PyObject *read_records(PyObject *module, PyObject *args)
{
    Py_buffer view, out;
    PyObject *to;
    Py_ssize_t start, rows;
    (void)module;
    if (!PyArg_ParseTuple(args, "y*nO:read_records", &view, &start, &to))
        return NULL;
    PyObject *answer = NULL;
    if (dpy_get_structs(to, &out, sizeof(dpt_record), &rows, "out") == 0) {
        size_t at = (size_t)start;
        uint32_t count = 0;
        dpt_result result = dpt_record_read(view.buf, (size_t)view.len, &at, out.buf, (uint32_t)rows, &count);
        answer = Py_BuildValue("Ins", count, (Py_ssize_t)at, result == DPT_OK ? "" : dpt_result_text(result));
        PyBuffer_Release(&out);
    }
    PyBuffer_Release(&view);
    return answer;
}

/* scene_names(): what Scene makes itself. */
static PyObject *scene_names(PyObject *module, PyObject *unused)
{
    PyObject *names = PyList_New(0);
    const char *text;
    (void)module;
    (void)unused;
    for (uint32_t i = 0; names && (text = dpt_host_get_scene(i)) != NULL; i++) {
        PyObject *name = PyUnicode_FromString(text);
        if (!name || PyList_Append(names, name) != 0)
            Py_CLEAR(names);
        Py_XDECREF(name);
    }
    return names;
}

static PyMethodDef methods[] = { { "fields", dpy_list_fields, METH_O, NULL },
                                 { "constants", dpy_list_constants, METH_NOARGS, NULL },
                                 { "run_loop", DPY_FASTCALL(dpy_run_loop), METH_VARARGS | METH_KEYWORDS, NULL },
                                 { "read_header", read_header, METH_O, NULL },
                                 { "read_records", read_records, METH_VARARGS, NULL },
                                 { "write_records", dpy_write_records, METH_O, NULL },
                                 { "scene_names", scene_names, METH_NOARGS, NULL },
                                 { "step_batch", dpy_step_batch, METH_VARARGS, NULL },
                                 { NULL, NULL, 0, NULL } };

static struct PyModuleDef definition = {
    PyModuleDef_HEAD_INIT, "dynpoint._dynpoint", NULL, -1, methods, NULL, NULL, NULL, NULL
};

PyMODINIT_FUNC PyInit__dynpoint(void);
PyMODINIT_FUNC PyInit__dynpoint(void)
{
    PyObject *module = PyModule_Create(&definition);
    if (!module)
        return NULL;
    if (dpy_error_init(module) == 0 && dpy_mesh_init(module) == 0 && dpy_world_init(module) == 0 &&
        dpy_body_init(module) == 0 && dpy_tool_init(module) == 0 && dpy_springs_init(module) == 0 &&
        dpy_arm_init(module) == 0 && dpy_guard_init(module) == 0 && dpy_device_init(module) == 0 &&
        dpy_scene_init(module) == 0 && PyModule_AddStringConstant(module, "version", dpt_version()) == 0)
        return module;
    Py_DECREF(module);
    return NULL;
}
