/* SPDX-License-Identifier: BSD-3-Clause */
/* Arrays that grow while a source is read. */
#ifndef DPT_COMPILE_GROW_H
#define DPT_COMPILE_GROW_H

#include <stddef.h>

/*
 * `array` with room for at least `need` items, and twice what it had; NULL, and all as it was, when
 * there is no memory.
 */
void *grow_array(void *array, size_t *capacity, size_t need, size_t item_size);

#endif
