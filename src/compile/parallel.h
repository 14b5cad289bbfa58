/* SPDX-License-Identifier: BSD-3-Clause */
/* Loops on several threads. No thread outlives the call. */
#ifndef DPT_COMPILE_PARALLEL_H
#define DPT_COMPILE_PARALLEL_H

#include <stddef.h>
#include <stdint.h>

/*
 * The least work for a thread of its own: this many triangles, vertices or half-edges take most steps about a tenth of
 * a millisecond.
 */
#define PARALLEL_MIN 4096u

#define PARALLEL_MAX 64u

/* Do items first..end of a loop. What it writes for one item, it must not read or write for another. */
typedef void parallel_work(void *context, size_t first, size_t end);

/*
 * Cut 0..count into consecutive pieces and call `work` for each, on several threads. Return when all are done.
 *
 *   threads    how many at most, the calling one included; never more than PARALLEL_MAX
 *   min_items  of a piece; if there are fewer than twice as many, there is one piece
 *
 * The calling thread does the first piece, then every piece for which the system made no thread.
 */
void parallel_for(uint32_t threads, size_t count, size_t min_items, parallel_work *work, void *context);

#endif
