/* SPDX-License-Identifier: BSD-3-Clause */
#include "compile/compile_context.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void compile_context_init(struct compile_context *context, const dpt_compile_def *def, dpt_diag *diag)
{
    *context = (struct compile_context){ .scale = def && def->scale != 0.0 ? def->scale : 1.0,
                                         .crease = def && def->crease != 0.0 ? def->crease : CREASE_DEFAULT,
                                         .threads = def && def->threads ? def->threads : 1,
                                         .recentre = def && def->recentre,
                                         .def = def,
                                         .diag = diag };
    if (context->threads > PARALLEL_MAX)
        context->threads = PARALLEL_MAX;
}

static void fill_diag(dpt_diag *diag, dpt_result code, source_location location, const char *format, va_list arguments)
{
    const int length = vsnprintf(diag->text, sizeof diag->text, format, arguments);
    if (length >= (int)sizeof diag->text)
        memcpy(diag->text + sizeof diag->text - 4, "...", 4);
    diag->code = code;
    diag->line = location.line;
    diag->byte = location.line != 0 ? 0 : location.byte;
}

dpt_result compile_fail(const struct compile_context *context, dpt_result code, source_location location,
                        const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    fill_diag(context->diag, code, location, format, arguments);
    va_end(arguments);
    return code;
}

void compile_note(const struct compile_context *context, source_location location, const char *format, ...)
{
    dpt_diag note = { .size = sizeof note };
    va_list arguments;
    if (!context->def || !context->def->note)
        return;
    va_start(arguments, format);
    fill_diag(&note, DPT_OK, location, format, arguments);
    va_end(arguments);
    context->def->note(context->def->note_user, &note);
}

dpt_result compile_report_progress(const struct compile_context *context, const char *step, double done)
{
    const dpt_compile_def *def = context->def;
    if (!def || !def->progress || !def->progress(def->user, step, done))
        return DPT_OK;
    return compile_fail(context, DPT_E_CANCELLED, (source_location){ 0, 0 }, "stopped by the caller");
}

/* ---- memory ---- */

void *compile_alloc(const struct compile_context *context, size_t count, size_t item_size)
{
    void *array = count <= SIZE_MAX / item_size ? malloc(count ? count * item_size : 1) : NULL;
    if (!array && context)
        compile_fail(context, DPT_E_MEMORY, (source_location){ 0, 0 }, "memory ran out");
    return array;
}

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

/* ---- threads ---- */

#if defined(__wasm__) && !defined(_REENTRANT)
/* WebAssembly without its threads. */
void parallel_for(uint32_t threads, size_t count, size_t min_items, parallel_work *work, void *context)
{
    (void)threads;
    (void)min_items;
    work(context, 0, count);
}
#else
#include <pthread.h>

struct parallel_piece {
    parallel_work *work;
    void *context;
    size_t first, end;
    pthread_t thread;
    int has_thread;
};

static void *do_piece(void *argument)
{
    const struct parallel_piece *piece = argument;
    piece->work(piece->context, piece->first, piece->end);
    return NULL;
}

void parallel_for(uint32_t threads, size_t count, size_t min_items, parallel_work *work, void *context)
{
    struct parallel_piece pieces[PARALLEL_MAX];
    size_t max_pieces = threads < PARALLEL_MAX ? threads : PARALLEL_MAX;
    size_t piece_count = count / min_items < max_pieces ? count / min_items : max_pieces;
    if (piece_count <= 1) {
        work(context, 0, count);
        return;
    }
    for (size_t i = 0; i < piece_count; i++) {
        struct parallel_piece *piece = &pieces[i];
        *piece = (struct parallel_piece){ .work = work, .context = context };
        piece->first = (size_t)((uint64_t)count * i / piece_count);
        piece->end = (size_t)((uint64_t)count * (i + 1) / piece_count);
        piece->has_thread = i > 0 && pthread_create(&piece->thread, NULL, do_piece, piece) == 0;
    }
    for (size_t i = 0; i < piece_count; i++)
        if (!pieces[i].has_thread)
            do_piece(&pieces[i]);
    for (size_t i = 0; i < piece_count; i++)
        if (pieces[i].has_thread)
            pthread_join(pieces[i].thread, NULL);
}
#endif
