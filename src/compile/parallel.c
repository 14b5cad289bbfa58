/* SPDX-License-Identifier: BSD-3-Clause */
#include "compile/parallel.h"

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
