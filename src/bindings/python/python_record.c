/* SPDX-License-Identifier: BSD-3-Clause */
#include "bindings/python/python_record.h"

#include "bindings/python/python_numbers.h"

#include "dynpoint/record.h"

PyObject *dpy_write_records(PyObject *module, PyObject *records)
{
    Py_buffer view;
    Py_ssize_t rows;
    (void)module;
    if (dpy_get_structs(records, &view, sizeof(dpt_record), &rows, "records") != 0)
        return NULL;
    size_t room = (size_t)rows * dpt_record_bytes(), written = 0;
    PyObject *bytes = PyBytes_FromStringAndSize(NULL, (Py_ssize_t)room);
    dpt_result result = DPT_OK;
    if (bytes && rows > 0)
        result = dpt_record_write(view.buf, (uint32_t)rows, PyBytes_AsString(bytes), room, &written);
    PyBuffer_Release(&view);
    if (result == DPT_OK)
        return bytes;
    Py_XDECREF(bytes);
    return dpy_fail(result, "write_records", NULL);
}
