/* SPDX-License-Identifier: BSD-3-Clause */
#include "compile/parallel.h"

#include <pthread.h>

struct parallel_piece {
    parallel_work *work;
    void *context;
    size_t first, end;
    pthread_t thread;
    int made;
};

static void *do_piece(void *argument)
{
    const struct parallel_piece *piece = argument;
    piece->work(piece->context, piece->first, piece->end);
    return NULL;
}

void parallel_for(uint32_t threads, size_t count, size_t least, parallel_work *work, void *context)
{
    struct parallel_piece pieces[PARALLEL_MAX];
    size_t most = threads < PARALLEL_MAX ? threads : PARALLEL_MAX;
    size_t n = count / least < most ? count / least : most;
    if (n <= 1) {
        work(context, 0, count);
        return;
    }
    for (size_t i = 0; i < n; i++) {
        struct parallel_piece *piece = &pieces[i];
        *piece = (struct parallel_piece){ .work = work, .context = context };
        piece->first = (size_t)((uint64_t)count * i / n);
        piece->end = (size_t)((uint64_t)count * (i + 1) / n);
        piece->made = i > 0 && pthread_create(&piece->thread, NULL, do_piece, piece) == 0;
    }
    for (size_t i = 0; i < n; i++)
        if (!pieces[i].made)
            do_piece(&pieces[i]);
    for (size_t i = 0; i < n; i++)
        if (pieces[i].made)
            pthread_join(pieces[i].thread, NULL);
}
