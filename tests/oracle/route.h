/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Routes from triangle to triangle over common vertices, by the words of the definition: distances of all triangles to
 * one by breadth-first search, then from triangle to triangle by trying all those that share a vertex.
 */
#ifndef DPT_TESTS_ORACLE_ROUTE_H
#define DPT_TESTS_ORACLE_ROUTE_H

#include "oracle/surface.h"

/* tau[i], how many steps triangle i is from `to`; ORACLE_NONE where none lead there. -1 when there is no memory. */
int oracle_route_tau(const struct oracle_surface *surface, uint32_t to, uint32_t *tau);

/*
 * The triangle after c on its way, with tau as it is towards the end: of those that share a vertex with c and are one
 * step nearer, those that share two or more with c, or if there are none all of them; of these the least number.
 * ORACLE_NONE at the end.
 */
uint32_t oracle_route_next(const struct oracle_surface *surface, const uint32_t *tau, uint32_t c);

/* The route, of tau[from] + 1 triangles; returns that number, 0 when there is no route. `route` has room for all. */
uint32_t oracle_route(const struct oracle_surface *surface, const uint32_t *tau, uint32_t from, uint32_t *route);

#endif
