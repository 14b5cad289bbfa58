/* SPDX-License-Identifier: BSD-3-Clause */
#include "bindings/python/python_batch.h"

#include "bindings/python/python_springs.h"
#include "bindings/python/python_world.h"

#include "dynpoint/tool.h"

#include "platform/thread.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Bodies of one world that springs or a compliance move, and threads of one call. */
#define SOFT_MAX    64
#define THREADS_MAX 256

/* A part of an array for each world. */
typedef struct row_part {
    char *at;       /* NULL: there is none */
    size_t stride;  /* bytes a world */
    uint32_t count; /* items a world */
} row_part;

typedef struct tool_rows {
    row_part ids, poses, wrenches, proxies, forces, hits, loads, load_counts, contacts, contact_counts;
} tool_rows;

typedef struct body_rows {
    row_part ids, poses, wrenches, vertices, loads, load_counts;
    dpt_springs **springs; /* NULL: nothing steps them; an item of NULL: by a compliance */
} body_rows;

typedef struct batch_step {
    uint32_t count, tool_count, body_count, view_count;
    uint32_t next_world, next_thread; /* that none has taken */
    double dt;
    PyObject *worlds; /* a tuple */
    dpt_world **world;
    tool_rows *tool;
    body_rows *body;
    int32_t *results;
    Py_buffer *views;
    dpt_load *rooms; /* of each thread, for the loads of one body */
    uint32_t room_loads;
} batch_step;

static void *row(const row_part *rows, uint32_t i)
{
    return rows->at ? rows->at + i * rows->stride : NULL;
}

static void note(int32_t *result, dpt_result now)
{
    if (*result == DPT_OK)
        *result = now;
}

static dpt_pose pose_of(const double *numbers)
{
    dpt_pose pose;
    memcpy(pose.position, numbers, sizeof pose.position);
    memcpy(pose.orientation, numbers + 3, sizeof pose.orientation);
    return pose;
}

/* ---- One world's tick ---- */

static void place(const batch_step *batch, uint32_t i, dpt_world *world, int32_t *result)
{
    for (uint32_t k = 0; k < batch->body_count; k++) {
        const body_rows *body = &batch->body[k];
        const dpt_body id = *(uint32_t *)row(&body->ids, i);
        const dpt_pose pose = pose_of(row(&body->poses, i));
        dpt_pose was;
        if (dpt_body_get_pose(world, id, &was) != DPT_OK || memcmp(&pose, &was, sizeof pose) != 0)
            note(result, dpt_body_set_pose(world, id, &pose));
        if (body->vertices.at)
            note(result, dpt_body_set_vertices(world, id, 0, body->vertices.count / 3, row(&body->vertices, i), -1.0));
    }
    for (uint32_t k = 0; k < batch->tool_count; k++) {
        const dpt_pose pose = pose_of(row(&batch->tool[k].poses, i));
        note(result, dpt_tool_set_pose(world, *(uint32_t *)row(&batch->tool[k].ids, i), &pose));
    }
}

static void step_soft(const batch_step *batch, uint32_t i, dpt_world *world, int32_t *result)
{
    dpt_body ids[SOFT_MAX];
    dpt_springs *springs[SOFT_MAX];
    uint32_t count = 0;
    for (uint32_t k = 0; k < batch->body_count; k++)
        if (batch->body[k].springs) {
            ids[count] = *(uint32_t *)row(&batch->body[k].ids, i);
            springs[count++] = batch->body[k].springs[i];
        }
    if (count)
        note(result, dpt_bodies_step_springs(world, ids, springs, count, batch->dt, NULL));
}

/* Structs that begin with their size: it is set in the first. */
static void *sized(const row_part *rows, uint32_t i)
{
    uint32_t *first = row(rows, i);
    if (first)
        *first = (uint32_t)(rows->stride / rows->count);
    return first;
}

static void tell_tool(const tool_rows *tool, uint32_t i, dpt_world *world, int32_t *result)
{
    const dpt_tool id = *(uint32_t *)row(&tool->ids, i);
    note(result, dpt_tool_get_wrench(world, id, row(&tool->wrenches, i)));
    if (tool->proxies.at) {
        dpt_pose pose;
        double *to = row(&tool->proxies, i);
        dpt_result got = dpt_tool_get_proxy(world, id, &pose);
        note(result, got);
        if (got == DPT_OK) {
            memcpy(to, pose.position, sizeof pose.position);
            memcpy(to + 3, pose.orientation, sizeof pose.orientation);
        }
    }
    if (tool->forces.at)
        note(result, dpt_tool_get_force_info(world, id, sized(&tool->forces, i)));
    if (tool->hits.at)
        note(result, dpt_tool_get_hit(world, id, sized(&tool->hits, i)));
    if (tool->loads.at)
        note(result,
             dpt_tool_get_loads(world, id, sized(&tool->loads, i), tool->loads.count, row(&tool->load_counts, i)));
    if (tool->contacts.at)
        note(result, dpt_tool_get_contacts(world, id, sized(&tool->contacts, i), tool->contacts.count,
                                           row(&tool->contact_counts, i)));
}

static void tell_body(const batch_step *batch, const body_rows *body, uint32_t i, dpt_world *world, dpt_load *room,
                      int32_t *result)
{
    const dpt_body id = *(uint32_t *)row(&body->ids, i);
    note(result, dpt_body_get_wrench(world, id, row(&body->wrenches, i)));
    if (!body->loads.at)
        return;
    double *loads = row(&body->loads, i);
    uint32_t *count = row(&body->load_counts, i), vertices = body->loads.count / 3;
    if (*count)
        memset(loads, 0, body->loads.stride);
    *count = 0;
    dpt_result got = dpt_body_get_loads(world, id, room, batch->room_loads, count);
    note(result, got);
    if (got != DPT_OK)
        *count = 0;
    for (uint32_t k = 0; k < *count; k++)
        for (int axis = 0; axis < 3 && room[k].vertex < vertices; axis++)
            loads[3 * room[k].vertex + (uint32_t)axis] += room[k].force[axis];
}

static void tick(const batch_step *batch, uint32_t i, dpt_load *room)
{
    dpt_world *world = batch->world[i];
    int32_t *result = &batch->results[i];
    *result = DPT_OK;
    place(batch, i, world, result);
    note(result, dpt_world_step(world, batch->dt, NULL));
    step_soft(batch, i, world, result);
    for (uint32_t k = 0; k < batch->tool_count; k++)
        tell_tool(&batch->tool[k], i, world, result);
    for (uint32_t k = 0; k < batch->body_count; k++)
        tell_body(batch, &batch->body[k], i, world, room, result);
}

static void *work(void *user)
{
    batch_step *batch = user;
    uint32_t i, number = __atomic_fetch_add(&batch->next_thread, 1, __ATOMIC_RELAXED);
    while ((i = __atomic_fetch_add(&batch->next_world, 1, __ATOMIC_RELAXED)) < batch->count)
        tick(batch, i, batch->rooms + (size_t)number * batch->room_loads);
    return NULL;
}

/* The caller works too: a thread that cannot be started only makes it slower. Signals stay with Python's threads. */
static void run(batch_step *batch, uint32_t threads)
{
    pthread_t thread[THREADS_MAX];
    uint32_t started = 0;
    while (started + 1 < threads && thread_start(&thread[started], work, batch) == 0)
        started++;
    work(batch);
    while (started > 0)
        pthread_join(thread[--started], NULL);
}

/* ---- What Python hands over ---- */

/* An array of a row a world. Item 0: of structs, of any size. */
static int take(batch_step *batch, PyObject *from, const char *format, Py_ssize_t item, Py_ssize_t columns, int is_out,
                row_part *to, const char *what)
{
    *to = (row_part){ NULL, 0, 0 };
    if (from == Py_None)
        return 0;
    Py_buffer *view = &batch->views[batch->view_count];
    Py_ssize_t count;
    if (dpy_get_array(from, view, format, item, columns, &count, what) != 0)
        return -1;
    batch->view_count++;
    if (batch->count == 0 || view->len % (item * batch->count) != 0 || view->len == 0 || (is_out && view->readonly)) {
        PyErr_Format(PyExc_ValueError, "%s: wanted %u rows, one a world%s", what, batch->count,
                     is_out ? ", that can be written to" : "");
        return -1;
    }
    to->at = view->buf;
    to->stride = (size_t)(view->len / batch->count);
    to->count = (uint32_t)(to->stride / (size_t)item);
    return 0;
}

/* An array of `each` numbers a world. */
static int take_numbers(batch_step *batch, PyObject *from, const char *format, Py_ssize_t item, uint32_t each,
                        int is_out, row_part *to, const char *what)
{
    if (take(batch, from, format, item, each, is_out, to, what) != 0)
        return -1;
    if (to->at && to->count == each)
        return 0;
    PyErr_Format(PyExc_ValueError, "%s: wanted %u numbers a world", what, each);
    return -1;
}

static int take_tool(batch_step *batch, PyObject *from, tool_rows *tool)
{
    PyObject *ids, *poses, *wrenches, *proxies, *forces, *hits, *loads, *load_counts, *contacts, *contact_counts;
    if (!PyArg_ParseTuple(from, "OOOOOOOOOO:tool", &ids, &poses, &wrenches, &proxies, &forces, &hits, &loads,
                          &load_counts, &contacts, &contact_counts))
        return -1;
    if (take_numbers(batch, ids, "I", 4, 1, 0, &tool->ids, "ids") != 0 ||
        take_numbers(batch, poses, "d", 8, 7, 0, &tool->poses, "poses") != 0 ||
        take_numbers(batch, wrenches, "d", 8, 6, 1, &tool->wrenches, "wrenches") != 0 ||
        take(batch, proxies, "d", 8, 7, 1, &tool->proxies, "proxies") != 0 ||
        take(batch, forces, "", sizeof(dpt_force_info), 1, 1, &tool->forces, "forces") != 0 ||
        take(batch, hits, "", sizeof(dpt_hit), 1, 1, &tool->hits, "hits") != 0 ||
        take(batch, loads, "", sizeof(dpt_tool_load), 1, 1, &tool->loads, "loads") != 0 ||
        take(batch, load_counts, "I", 4, 1, 1, &tool->load_counts, "load_counts") != 0 ||
        take(batch, contacts, "", sizeof(dpt_contact), 1, 1, &tool->contacts, "contacts") != 0 ||
        take(batch, contact_counts, "I", 4, 1, 1, &tool->contact_counts, "contact_counts") != 0)
        return -1;
    if ((!tool->loads.at || tool->load_counts.at) && (!tool->contacts.at || tool->contact_counts.at))
        return 0;
    PyErr_SetString(PyExc_TypeError, "wanted counts beside loads and contacts");
    return -1;
}

/* Enter the springs of all worlds; those that were entered are left by leave_springs. */
static int take_springs(batch_step *batch, PyObject *list, body_rows *body)
{
    if (list == Py_None)
        return 0;
    if (!PyTuple_Check(list) || PyTuple_Size(list) != (Py_ssize_t)batch->count) {
        PyErr_SetString(PyExc_TypeError, "springs: wanted a tuple of as many as there are worlds");
        return -1;
    }
    body->springs = calloc(batch->count, sizeof *body->springs);
    if (!body->springs) {
        PyErr_NoMemory();
        return -1;
    }
    for (uint32_t i = 0; i < batch->count; i++) {
        PyObject *springs = PyTuple_GetItem(list, (Py_ssize_t)i);
        if (springs != Py_None && !(body->springs[i] = dpy_springs_enter(springs, "batch.World.step")))
            return -1;
    }
    return 0;
}

static int take_body(batch_step *batch, PyObject *from, body_rows *body, PyObject **list)
{
    PyObject *ids, *poses, *wrenches, *vertices, *loads, *load_counts;
    if (!PyArg_ParseTuple(from, "OOOOOOO:body", &ids, &poses, &wrenches, &vertices, list, &loads, &load_counts))
        return -1;
    if (take_numbers(batch, ids, "I", 4, 1, 0, &body->ids, "ids") != 0 ||
        take_numbers(batch, poses, "d", 8, 7, 0, &body->poses, "poses") != 0 ||
        take_numbers(batch, wrenches, "d", 8, 6, 1, &body->wrenches, "wrenches") != 0 ||
        take(batch, vertices, "f", 4, 3, 0, &body->vertices, "vertices") != 0 ||
        take(batch, loads, "d", 8, 3, 1, &body->loads, "loads") != 0 ||
        take(batch, load_counts, "I", 4, 1, 1, &body->load_counts, "load_counts") != 0)
        return -1;
    if (!body->loads.at || body->load_counts.at)
        return take_springs(batch, *list, body);
    PyErr_SetString(PyExc_TypeError, "wanted counts beside loads");
    return -1;
}

static void leave_springs(const batch_step *batch, PyObject *bodies)
{
    for (uint32_t k = 0; k < batch->body_count; k++) {
        dpt_springs **springs = batch->body[k].springs;
        PyObject *list = springs ? PyTuple_GetItem(PyTuple_GetItem(bodies, (Py_ssize_t)k), 4) : NULL;
        for (uint32_t i = 0; springs && i < batch->count; i++)
            if (springs[i])
                dpy_springs_leave(PyTuple_GetItem(list, (Py_ssize_t)i));
        free(springs);
    }
}

/* How many worlds were entered; fewer than all: an exception is set. */
static uint32_t enter_worlds(batch_step *batch)
{
    for (uint32_t i = 0; i < batch->count; i++) {
        dpy_world *world = dpy_world_of(PyTuple_GetItem(batch->worlds, (Py_ssize_t)i));
        if (!world || !(batch->world[i] = dpy_world_enter(world, "batch.World.step")))
            return i;
    }
    return batch->count;
}

static int take_all(batch_step *batch, PyObject *tools, PyObject *bodies, PyObject *results)
{
    row_part codes;
    uint32_t soft = 0;
    for (uint32_t k = 0; k < batch->tool_count; k++)
        if (take_tool(batch, PyTuple_GetItem(tools, (Py_ssize_t)k), &batch->tool[k]) != 0)
            return -1;
    for (uint32_t k = 0; k < batch->body_count; k++) {
        PyObject *list;
        if (take_body(batch, PyTuple_GetItem(bodies, (Py_ssize_t)k), &batch->body[k], &list) != 0)
            return -1;
        soft += batch->body[k].springs != NULL;
    }
    if (soft > SOFT_MAX) {
        PyErr_Format(PyExc_ValueError, "batch.World.step: at most %d bodies of a world are stepped", SOFT_MAX);
        return -1;
    }
    if (take_numbers(batch, results, "i", 4, 1, 1, &codes, "results") != 0)
        return -1;
    batch->results = (int32_t *)(void *)codes.at;
    return 0;
}

/* None, or the exception of the first world that failed. */
static PyObject *judge(const batch_step *batch)
{
    uint32_t first = batch->count, failed = 0;
    for (uint32_t i = batch->count; i-- > 0;)
        if (batch->results[i] != DPT_OK) {
            first = i;
            failed++;
        }
    if (!failed)
        return Py_NewRef(Py_None);
    char text[256];
    snprintf(text, sizeof text, "environment %u, and %u others: %s", first, failed - 1,
             dpt_result_text(batch->results[first]));
    return dpy_fail(batch->results[first], "batch.World.step", text);
}

static void *make(size_t count, size_t bytes)
{
    return calloc(count ? count : 1, bytes);
}

PyObject *dpy_step_batch(PyObject *module, PyObject *args)
{
    PyObject *tools, *bodies, *results;
    batch_step batch = { 0 };
    unsigned threads, points;
    (void)module;
    if (!PyArg_ParseTuple(args, "O!dIIO!O!O:step_batch", &PyTuple_Type, &batch.worlds, &batch.dt, &threads, &points,
                          &PyTuple_Type, &tools, &PyTuple_Type, &bodies, &results))
        return NULL;
    batch.count = (uint32_t)PyTuple_Size(batch.worlds);
    batch.tool_count = (uint32_t)PyTuple_Size(tools);
    batch.body_count = (uint32_t)PyTuple_Size(bodies);
    batch.room_loads = 256 * (points < 65535 ? points : 65535);
    threads = threads < THREADS_MAX ? threads : THREADS_MAX;
    threads = threads < batch.count ? threads : batch.count;
    batch.world = make(batch.count, sizeof *batch.world);
    batch.tool = make(batch.tool_count, sizeof *batch.tool);
    batch.body = make(batch.body_count, sizeof *batch.body);
    batch.views = make(10 * ((size_t)batch.tool_count + batch.body_count) + 1, sizeof *batch.views);
    batch.rooms = make((size_t)(threads ? threads : 1) * batch.room_loads, sizeof *batch.rooms);
    uint32_t entered = 0;
    int is_ready = 0;
    if (!batch.world || !batch.tool || !batch.body || !batch.views || !batch.rooms) {
        PyErr_NoMemory();
    } else if (take_all(&batch, tools, bodies, results) == 0) {
        entered = enter_worlds(&batch);
        is_ready = entered == batch.count;
    }
    if (is_ready) {
        Py_BEGIN_ALLOW_THREADS run(&batch, threads);
        Py_END_ALLOW_THREADS
    }
    for (uint32_t i = 0; i < entered; i++)
        dpy_world_leave((dpy_world *)PyTuple_GetItem(batch.worlds, (Py_ssize_t)i));
    if (batch.body)
        leave_springs(&batch, bodies);
    PyObject *answer = is_ready ? judge(&batch) : NULL;
    for (uint32_t i = 0; i < batch.view_count; i++)
        PyBuffer_Release(&batch.views[i]);
    free(batch.rooms);
    free(batch.views);
    free(batch.body);
    free(batch.tool);
    free(batch.world);
    return answer;
}
