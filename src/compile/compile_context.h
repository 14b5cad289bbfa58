/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What all steps of a compilation share: the settings of the def, reports of errors and progress, memory, and loops on
 * several threads.
 */
#ifndef DPT_COMPILE_CONTEXT_H
#define DPT_COMPILE_CONTEXT_H

#include <stddef.h>
#include <stdint.h>

#include "dynpoint/compile.h"

/* Of vertices, of triangles: half-edges are numbered in 32 bits. */
#define COUNT_MAX     ((size_t)INT32_MAX)
#define TRIANGLES_MAX ((size_t)UINT32_MAX / 3)

#define CREASE_DEFAULT 1.0471975511965976 /* pi / 3 */

struct compile_context {
    double scale;               /* metres per unit of the source */
    double crease;              /* rad */
    uint32_t threads;           /* 1..PARALLEL_MAX */
    int recentre;               /* 1: the mesh is moved to its origin */
    const dpt_compile_def *def; /* for cells, springs and the progress callback; may be NULL */
    dpt_diag *diag;             /* never NULL */
};

/* Take the settings of `def`; NULL for the defaults. Both pointers are kept. */
void compile_context_init(struct compile_context *context, const dpt_compile_def *def, dpt_diag *diag);

/* A location in the source: a line, from 1; or, if line is 0, a byte offset, from 0. */
typedef struct source_location {
    uint64_t line;
    uint64_t byte;
} source_location;

/* Fill the diag and return `code`. The text is formatted as by printf, and cut to fit. */
dpt_result compile_fail(const struct compile_context *context, dpt_result code, source_location location,
                        const char *format, ...)
#ifdef __GNUC__
    __attribute__((format(printf, 4, 5)))
#endif
    ;

/* Hand a note to the callback: what the user should know, of a source that compiles. Formatted as compile_fail's. */
void compile_note(const struct compile_context *context, source_location location, const char *format, ...)
#ifdef __GNUC__
    __attribute__((format(printf, 3, 4)))
#endif
    ;

/* Report to the callback that `done` (0..1) of a step is done. Returns DPT_OK or DPT_E_CANCELLED. */
dpt_result compile_report_progress(const struct compile_context *context, const char *step, double done);

/* ---- memory ---- */

/*
 * Allocate an array; at least one byte, so that only a failure gives NULL. A failure fills the diag. Other
 * threads than the caller's must not write the diag: they pass NULL.
 */
void *compile_alloc(const struct compile_context *context, size_t count, size_t item_size);

/*
 * Reallocate `array` for at least `need` items, and at least twice *capacity; update *capacity. Returns the new array.
 * Returns NULL when memory runs out; the array and *capacity then stay as they were.
 */
void *grow_array(void *array, size_t *capacity, size_t need, size_t item_size);

/* ---- loops on several threads; no thread outlives the call ---- */

/*
 * The least work for a thread of its own: this many triangles, vertices or half-edges take most steps about a tenth of
 * a millisecond.
 */
#define PARALLEL_MIN 4096u

#define PARALLEL_MAX 64u

/* Do items first..end of a loop. Data written for one item must not be read or written for another. */
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
