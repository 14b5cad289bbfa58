/* SPDX-License-Identifier: BSD-3-Clause */
/* The servo loop whose tick is a function of Python's. */
#include "bindings/python/python_loop.h"
#include "bindings/python/python_device.h"
#include "bindings/python/python_interrupt.h"

#include "dynpoint/loop.h"

#include <string.h>

/*
 * What a tick needs. The sample and the wrench are arrays of Python's, which every tick shares: `state` gets a copy of the
 * sample, and the wrench is read back after the call.
 */
typedef struct ticking {
    PyObject *tick, *state_object, *wrench_object;
    dpt_device_state *state;
    double *wrench;
    dpt_loop *loop;
    PyObject *device;
} ticking;

static dpt_result answer(ticking *now, const dpt_loop_sample *sample, dpt_wrench *wrench)
{
    memcpy(now->state, sample->state, sizeof *now->state);
    memset(now->wrench, 0, sizeof *wrench);
    PyObject *made = PyObject_CallFunction(now->tick, "OOd", now->state_object, now->wrench_object, sample->dt);
    if (!made)
        return DPT_E_CANCELLED;
    int is_given = made == Py_None || dpy_get_numbers(made, now->wrench, 6, "what the tick returned") == 0;
    Py_DECREF(made);
    if (!is_given || PyErr_CheckSignals() != 0)
        return DPT_E_CANCELLED;
    memcpy(wrench, now->wrench, sizeof *wrench);
    return DPT_OK;
}

static dpt_result tick(void *user, const dpt_loop_sample *sample, dpt_wrench *wrench)
{
    ticking *now = user;
    PyGILState_STATE state = PyGILState_Ensure();
    dpt_result result = DPT_E_CANCELLED;
    if (!PyErr_Occurred()) {
        /* The function may clear the device. */
        dpy_device_leave(now->device);
        result = answer(now, sample, wrench);
        PyObject *type, *value, *trace;
        PyErr_Fetch(&type, &value, &trace);
        if (!dpy_device_enter(now->device, "Loop")) {
            result = DPT_E_CANCELLED;
            if (type)
                PyErr_Clear();
        }
        if (type)
            PyErr_Restore(type, value, trace);
    }
    if (result != DPT_OK)
        dpt_loop_stop(now->loop);
    PyGILState_Release(state);
    return result;
}

static void stop(void *loop)
{
    dpt_loop_stop(loop);
}

PyObject *dpy_run_loop(PyObject *module, PyObject *args, PyObject *keywords)
{
    PyObject *guard, *to;
    ticking now;
    Py_buffer state, wrench, stats;
    Py_ssize_t count;
    (void)module;
    memset(&now, 0, sizeof now);
    if (!PyArg_ParseTuple(args, "OOOOOO:run_loop", &now.device, &now.tick, &now.state_object, &now.wrench_object,
                          &guard, &to))
        return NULL;
    dpt_loop_def def;
    dpt_guard_def limits;
    dpt_loop_def_init(&def);
    dpt_guard_def_init(&limits);
    if (dpy_fill(&def, "dpt_loop_def", keywords) != 0 ||
        (guard != Py_None && dpy_fill(&limits, "dpt_guard_def", guard) != 0))
        return NULL;
    if (dpy_get_structs(now.state_object, &state, sizeof(dpt_device_state), NULL, "state") != 0)
        return NULL;
    PyObject *answer = NULL;
    if (dpy_get_array(now.wrench_object, &wrench, "d", 8, 6, &count, "wrench") != 0)
        goto no_wrench;
    if (dpy_get_structs(to, &stats, sizeof(dpt_loop_stats), NULL, "stats") != 0)
        goto no_stats;
    dpt_device *device = dpy_device_enter(now.device, "Loop");
    if (!device)
        goto no_device;
    now.state = state.buf;
    now.wrench = wrench.buf;
    def.tick = tick;
    def.user = &now;
    def.guard = &limits;
    dpt_result result = dpt_loop_open(device, &def, &now.loop);
    if (result != DPT_OK) {
        dpy_fail(result, "Loop", NULL);
    } else {
        dpy_interrupt interrupt = { stop, now.loop, 0 };
        if (dpy_interrupt_begin(&interrupt) == 0) {
            PyThreadState *released = PyEval_SaveThread();
            result = dpt_loop_run(now.loop, stats.buf);
            PyEval_RestoreThread(released);
            int is_interrupted = dpy_interrupt_end(&interrupt);
            if (!PyErr_Occurred() && is_interrupted == 0) {
                if (result == DPT_OK)
                    answer = Py_NewRef(Py_None);
                else
                    dpy_fail(result, "Loop.run", NULL);
            }
        }
        dpt_loop_close(now.loop);
    }
    dpy_device_leave(now.device);
no_device:
    PyBuffer_Release(&stats);
no_stats:
    PyBuffer_Release(&wrench);
no_wrench:
    PyBuffer_Release(&state);
    return answer;
}
