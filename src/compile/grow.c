/* SPDX-License-Identifier: BSD-3-Clause */
#include "compile/grow.h"

#include <stdint.h>
#include <stdlib.h>

void *grow_array(void *array, size_t *capacity, size_t need, size_t item_size)
{
    size_t new_capacity = *capacity < 32 ? 64 : *capacity > SIZE_MAX / 2 ? SIZE_MAX : *capacity * 2;
    if (new_capacity < need)
        new_capacity = need;
    if (new_capacity > SIZE_MAX / item_size)
        return NULL;
    void *bigger = realloc(array, new_capacity * item_size);
    if (bigger)
        *capacity = new_capacity;
    return bigger;
}
