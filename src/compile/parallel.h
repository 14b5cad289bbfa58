/* SPDX-License-Identifier: BSD-3-Clause */
/* A loop on several threads, of which none outlives the call. */
#ifndef DPT_COMPILE_PARALLEL_H
#define DPT_COMPILE_PARALLEL_H

#include <stddef.h>
#include <stdint.h>

/* What is worth a thread: of steps over triangles, vertices or half-edges so many take about a tenth of a millisecond. */
#define PARALLEL_MIN 4096u

#define PARALLEL_MAX 64u

/* Items first..end of a loop. What it writes for one item, it may not read or write for another. */
typedef void parallel_work(void *context, size_t first, size_t end);

/*
 * Call `work` for pieces of 0..count that follow each other, of `least` items or more each (one piece where there
 * are fewer), on at most `threads` threads, never more than PARALLEL_MAX; return when all are done. The calling
 * thread is one of them: it does the first piece, and afterwards those for which no thread could be made.
 */
void parallel_for(uint32_t threads, size_t count, size_t min_items, parallel_work *work,
                  void *context);

#endif
