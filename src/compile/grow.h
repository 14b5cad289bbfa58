/* SPDX-License-Identifier: BSD-3-Clause */
/* Arrays that grow while a file is read. */
#ifndef DPT_COMPILE_GROW_H
#define DPT_COMPILE_GROW_H

#include <stddef.h>

/*
 * Reallocate `array` for at least `need` items, and at least twice *capacity; update *capacity. Returns the new array.
 * Returns NULL when memory runs out; the array and *capacity then stay as they were.
 */
void *grow_array(void *array, size_t *capacity, size_t need, size_t item_size);

#endif
