/* SPDX-License-Identifier: BSD-3-Clause */
/* The vertices of surface.h. */
#include "oracle/surface.h"

#include <stdlib.h>
#include <string.h>

struct place {
    double at[3];
    uint32_t corner; /* 3 triangle + k */
};

static int by_place(const void *a, const void *b)
{
    const struct place *p = a, *q = b;
    for (int k = 0; k < 3; k++)
        if (p->at[k] != q->at[k])
            return p->at[k] < q->at[k] ? -1 : 1;
    return p->corner < q->corner ? -1 : p->corner > q->corner;
}

/* Corners in the order of their places: those at one place are one vertex. */
static void weld(struct oracle_surface *surface, const struct place *places, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        const struct place *p = &places[i];
        if (!i || memcmp(p->at, places[i - 1].at, sizeof p->at) != 0) {
            surface->first[surface->vertices] = i;
            memcpy(surface->place[surface->vertices++], p->at, sizeof p->at);
        }
        surface->corner[p->corner / 3][p->corner % 3] = surface->vertices - 1;
        surface->fan[i] = p->corner / 3;
    }
    surface->first[surface->vertices] = count;
}

int oracle_surface_open(struct oracle_surface *surface, const double *corners, const unsigned char *there,
                        uint32_t triangles)
{
    const size_t most = 3 * (size_t)triangles + 1;
    struct place *places = malloc(most * sizeof *places);
    uint32_t count = 0;
    *surface = (struct oracle_surface){ .triangles = triangles };
    surface->place = malloc(most * sizeof *surface->place);
    surface->corner = malloc(most * sizeof *surface->corner);
    surface->first = malloc(most * sizeof *surface->first);
    surface->fan = malloc(most * sizeof *surface->fan);
    const int made = places && surface->place && surface->corner && surface->first && surface->fan;
    for (uint32_t i = 0; made && i < 3 * triangles; i++) {
        surface->corner[i / 3][i % 3] = ORACLE_NONE;
        if (!there[i / 3])
            continue;
        places[count].corner = i;
        for (int k = 0; k < 3; k++) /* -0 + 0 is 0 */
            places[count].at[k] = corners[3 * (size_t)i + (size_t)k] + 0.0;
        count++;
    }
    if (made) {
        qsort(places, count, sizeof *places, by_place);
        weld(surface, places, count);
    } else {
        oracle_surface_close(surface);
    }
    free(places);
    return made ? 0 : -1;
}

void oracle_surface_close(struct oracle_surface *surface)
{
    free(surface->place);
    free(surface->corner);
    free(surface->first);
    free(surface->fan);
    memset(surface, 0, sizeof *surface);
}

static int has(const struct oracle_surface *surface, uint32_t triangle, uint32_t vertex)
{
    const uint32_t *c = surface->corner[triangle];
    return c[0] == vertex || c[1] == vertex || c[2] == vertex;
}

int oracle_surface_common(const struct oracle_surface *surface, uint32_t a, uint32_t b)
{
    int common = 0;
    for (int k = 0; k < 3 && surface->corner[a][0] != ORACLE_NONE; k++)
        common += has(surface, b, surface->corner[a][k]);
    return common;
}

uint32_t oracle_surface_edge(const struct oracle_surface *surface, uint32_t u, uint32_t v, uint32_t *triangles,
                             uint32_t room)
{
    uint32_t count = 0;
    const uint32_t *first = surface->first;
    if (first[v + 1] - first[v] < first[u + 1] - first[u]) { /* a hub */
        const uint32_t swap = u;
        u = v;
        v = swap;
    }
    for (uint32_t i = first[u]; i < first[u + 1]; i++) {
        if (!has(surface, surface->fan[i], v))
            continue;
        if (count < room)
            triangles[count] = surface->fan[i];
        count++;
    }
    return count;
}
