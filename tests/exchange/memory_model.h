/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A model of memory as C11 has it, for two threads, one atomic word and a few plain cells. A caller chooses which
 * thread makes the next step; the model keeps what happened before what, and finds races.
 *
 * - Each thread has a view: how many steps of each thread happened before its next one, and the oldest value of the
 *   word that it may still load.
 * - The word is the list of its values, in the order in which they were stored. An exchange takes the newest one.
 *   A load takes any that its view allows: memory_loads says how many there are.
 * - A step that releases leaves its thread's view beside the value; one that acquires takes over the view beside the
 *   value that it finds. An exchange passes on the view beside the value that it replaces (a release sequence).
 * - A plain step races if a plain step of the other thread, one of both a write, did not happen before it.
 *
 * All values of the word come from exchanges. So they are stored in the order of the steps, and a model without stores,
 * fences and promises leaves out no behaviour.
 */
#ifndef DPT_TESTS_MEMORY_MODEL_H
#define DPT_TESTS_MEMORY_MODEL_H

#include <stdint.h>

enum { MEMORY_THREADS = 2, MEMORY_VALUES = 16, MEMORY_CELLS = 6 };
enum { MEMORY_RELAXED = 0, MEMORY_ACQUIRES = 1, MEMORY_RELEASES = 2 };

struct memory_view {
    uint32_t steps[MEMORY_THREADS];
    uint32_t oldest; /* in `values` */
};

struct memory_model {
    struct memory_view views[MEMORY_THREADS];
    struct {
        uint32_t value;
        struct memory_view released;
    } values[MEMORY_VALUES];
    uint32_t count;
    struct {
        uint32_t value, written[MEMORY_THREADS], read[MEMORY_THREADS]; /* at which step last; 0: never */
    } cells[MEMORY_CELLS];
    uint32_t races;
};

/* The word has a value, all cells are 0, and both threads begin after that. */
void memory_init(struct memory_model *memory, uint32_t value);

/* From how many values of the word a load of this thread may take one. */
uint32_t memory_loads(const struct memory_model *memory, int thread);

/* Load the value that was stored `age` values before the newest; age is less than memory_loads. */
uint32_t memory_load(struct memory_model *memory, int thread, uint32_t age, int orders);

/* Store a value, and return the one before it. At most MEMORY_VALUES - 1 times. */
uint32_t memory_exchange(struct memory_model *memory, int thread, uint32_t value, int orders);

void memory_write(struct memory_model *memory, int thread, uint32_t cell, uint32_t value);
uint32_t memory_read(struct memory_model *memory, int thread, uint32_t cell);

/* All that the other thread did happens before the next step of this one. */
void memory_join(struct memory_model *memory, int thread);

#endif
