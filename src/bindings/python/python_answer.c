/* SPDX-License-Identifier: BSD-3-Clause */
#include "bindings/python/python_answer.h"

#include "bindings/python/python_member.h"

#include "dynpoint/body.h"

PyObject *dpy_get_mean_loads(PyObject *object, PyObject *out)
{
    dpy_member *self = (dpy_member *)object;
    Py_buffer view;
    Py_ssize_t rows;
    if (dpy_get_array(out, &view, "", sizeof(dpt_load), 1, &rows, "out") != 0)
        return NULL;
    uint32_t count = 0;
    double seconds = 0;
    dpt_result result = DPT_E_ARGUMENT;
    dpt_world *world = dpy_world_enter(self->world, "DeformableBody.mean_loads");
    if (world) {
        if (!view.readonly)
            result = dpt_body_get_mean_loads(world, self->id, view.buf, (uint32_t)rows, &count, &seconds);
        dpy_world_leave(self->world);
    }
    PyBuffer_Release(&view);
    if (!world)
        return NULL;
    if (result != DPT_OK && (result != DPT_E_FULL || (Py_ssize_t)count <= rows))
        return dpy_fail(result, "DeformableBody.mean_loads", NULL);
    return Py_BuildValue("Id", count, seconds);
}

PyObject *dpy_set_answered_loads(PyObject *object, PyObject *loads)
{
    dpy_member *self = (dpy_member *)object;
    Py_buffer view;
    Py_ssize_t count;
    if (dpy_get_array(loads, &view, "", sizeof(dpt_load), 1, &count, "loads") != 0)
        return NULL;
    dpt_result result = DPT_OK;
    dpt_world *world = dpy_world_enter(self->world, "DeformableBody.answer");
    if (world) {
        result = dpt_body_set_answered_loads(world, self->id, view.buf, (uint32_t)count);
        dpy_world_leave(self->world);
    }
    PyBuffer_Release(&view);
    return world ? dpy_result(result, "DeformableBody.answer") : NULL;
}
