/* SPDX-License-Identifier: BSD-3-Clause */
/* The routes of route.h. */
#include "oracle/route.h"

#include <stdlib.h>

int oracle_route_tau(const struct oracle_surface *surface, uint32_t to, uint32_t *tau)
{
    uint32_t *queue = malloc(((size_t)surface->triangles + 1) * sizeof *queue);
    unsigned char *done = calloc((size_t)surface->vertices + 1, 1);
    uint32_t count = 0;
    const int made = queue && done;
    for (uint32_t i = 0; i < surface->triangles; i++)
        tau[i] = ORACLE_NONE;
    if (made && surface->corner[to][0] != ORACLE_NONE) {
        tau[to] = 0;
        queue[count++] = to;
    }
    for (uint32_t i = 0; made && i < count; i++)
        for (int k = 0; k < 3; k++) {
            const uint32_t v = surface->corner[queue[i]][k];
            if (done[v]) /* all of its triangles have been reached */
                continue;
            done[v] = 1;
            for (uint32_t f = surface->first[v]; f < surface->first[v + 1]; f++) {
                const uint32_t t = surface->fan[f];
                if (tau[t] != ORACLE_NONE)
                    continue;
                tau[t] = tau[queue[i]] + 1;
                queue[count++] = t;
            }
        }
    free(queue);
    free(done);
    return made ? 0 : -1;
}

uint32_t oracle_route_next(const struct oracle_surface *surface, const uint32_t *tau, uint32_t c)
{
    uint32_t by_one = ORACLE_NONE, by_two = ORACLE_NONE;
    for (int k = 0; k < 3 && tau[c] != 0; k++) {
        const uint32_t v = surface->corner[c][k];
        for (uint32_t f = surface->first[v]; f < surface->first[v + 1]; f++) {
            const uint32_t n = surface->fan[f];
            if (tau[n] != tau[c] - 1)
                continue;
            uint32_t *least = oracle_surface_common(surface, c, n) >= 2 ? &by_two : &by_one;
            *least = n < *least ? n : *least;
        }
    }
    return by_two != ORACLE_NONE ? by_two : by_one;
}

uint32_t oracle_route(const struct oracle_surface *surface, const uint32_t *tau, uint32_t from, uint32_t *route)
{
    uint32_t count = 0;
    if (tau[from] == ORACLE_NONE)
        return 0;
    for (uint32_t c = from; c != ORACLE_NONE; c = oracle_route_next(surface, tau, c))
        route[count++] = c;
    return count;
}
