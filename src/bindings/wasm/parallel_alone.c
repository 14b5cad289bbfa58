/* SPDX-License-Identifier: BSD-3-Clause */
/* Loops where there are no threads, in place of compile/parallel.c. */
#include "compile/parallel.h"

void parallel_for(uint32_t threads, size_t count, size_t min_items, parallel_work *work,
                  void *context)
{
    (void)threads;
    (void)min_items;
    work(context, 0, count);
}
