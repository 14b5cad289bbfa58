/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Which corners of triangles are one vertex, from their positions alone: equal numbers, and the two zeros are equal.
 * It shares nothing with the library. Triangles keep their numbers; those that are not there have none of the rest.
 */
#ifndef DPT_TESTS_ORACLE_SURFACE_H
#define DPT_TESTS_ORACLE_SURFACE_H

#include <stdint.h>

#define ORACLE_NONE UINT32_MAX

struct oracle_surface {
    uint32_t triangles, vertices;
    double (*place)[3];    /* of a vertex */
    uint32_t (*corner)[3]; /* of a triangle: its vertices, or ORACLE_NONE */
    uint32_t *first;       /* vertices + 1: vertex v's triangles are fan[first[v]] .. fan[first[v + 1] - 1] */
    uint32_t *fan;         /* ascending */
};

/* From 9 numbers a triangle; there[i] is 0 for one that was dropped. -1 when there is no memory. */
int oracle_surface_open(struct oracle_surface *surface, const double *corners, const unsigned char *there,
                        uint32_t triangles);
void oracle_surface_close(struct oracle_surface *surface);

/* How many vertices two triangles have in common: 0 when one is not there. */
int oracle_surface_common(const struct oracle_surface *surface, uint32_t a, uint32_t b);

/* How many triangles have both vertices; the first `room` of them. */
uint32_t oracle_surface_edge(const struct oracle_surface *surface, uint32_t u, uint32_t v, uint32_t *triangles,
                             uint32_t room);

#endif
