/* SPDX-License-Identifier: BSD-3-Clause */
#include "compile/grow.h"

#include <stdint.h>
#include <stdlib.h>

void *grown(void *array, size_t *room, size_t need, size_t item_size)
{
    size_t wanted = *room < 32 ? 64 : *room > SIZE_MAX / 2 ? SIZE_MAX : *room * 2;
    if (wanted < need)
        wanted = need;
    if (wanted > SIZE_MAX / item_size)
        return NULL;
    void *bigger = realloc(array, wanted * item_size);
    if (bigger != NULL)
        *room = wanted;
    return bigger;
}
