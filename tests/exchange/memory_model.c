/* SPDX-License-Identifier: BSD-3-Clause */
#include "exchange/memory_model.h"

#include <string.h>

static void take_over(struct memory_view *view, const struct memory_view *other)
{
    for (int i = 0; i < MEMORY_THREADS; i++)
        if (view->steps[i] < other->steps[i])
            view->steps[i] = other->steps[i];
    if (view->oldest < other->oldest)
        view->oldest = other->oldest;
}

/* The view of a thread in the step that it begins now. */
static struct memory_view *begin(struct memory_model *memory, int thread)
{
    memory->views[thread].steps[thread]++;
    return &memory->views[thread];
}

void memory_init(struct memory_model *memory, uint32_t value)
{
    memset(memory, 0, sizeof *memory);
    memory->values[0].value = value;
    memory->count = 1;
}

uint32_t memory_loads(const struct memory_model *memory, int thread)
{
    return memory->count - memory->views[thread].oldest;
}

uint32_t memory_load(struct memory_model *memory, int thread, uint32_t age, int orders)
{
    struct memory_view *view = begin(memory, thread);
    const uint32_t at = memory->count - 1 - age;
    view->oldest = at;
    if (orders & MEMORY_ACQUIRES)
        take_over(view, &memory->values[at].released);
    return memory->values[at].value;
}

uint32_t memory_exchange(struct memory_model *memory, int thread, uint32_t value, int orders)
{
    struct memory_view *view = begin(memory, thread);
    const uint32_t at = memory->count++;
    memory->values[at].value = value;
    memory->values[at].released = memory->values[at - 1].released;
    view->oldest = at;
    if (orders & MEMORY_ACQUIRES)
        take_over(view, &memory->values[at - 1].released);
    if (orders & MEMORY_RELEASES)
        take_over(&memory->values[at].released, view);
    return memory->values[at - 1].value;
}

void memory_write(struct memory_model *memory, int thread, uint32_t cell, uint32_t value)
{
    const struct memory_view *view = begin(memory, thread);
    const int other = 1 - thread;
    memory->races +=
        memory->cells[cell].written[other] > view->steps[other] || memory->cells[cell].read[other] > view->steps[other];
    memory->cells[cell].written[thread] = view->steps[thread];
    memory->cells[cell].value = value;
}

uint32_t memory_read(struct memory_model *memory, int thread, uint32_t cell)
{
    const struct memory_view *view = begin(memory, thread);
    const int other = 1 - thread;
    memory->races += memory->cells[cell].written[other] > view->steps[other];
    memory->cells[cell].read[thread] = view->steps[thread];
    return memory->cells[cell].value;
}

void memory_join(struct memory_model *memory, int thread)
{
    take_over(&memory->views[thread], &memory->views[1 - thread]);
}
