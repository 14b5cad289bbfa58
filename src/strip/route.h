/* SPDX-License-Identifier: BSD-3-Clause */
/* Shortest routes over triangles that share a vertex: docs/algorithms/routes.md. */
#ifndef DPT_ROUTE_H
#define DPT_ROUTE_H

#include "dynpoint/strip.h"
#include "mesh/mesh_format.h"

/* A vertex that a search has reached. */
struct visited_vertex {
    uint32_t vertex_plus_1; /* 0: a free slot */
    uint32_t mark;          /* edges from its side's triangle, times 4, and ROUTE_... (route.c) */
};

/* The memory of a search. Between searches all slots are free. */
struct route_search {
    struct visited_vertex *slots; /* open addressing */
    /* Indices of the filled slots: the start's side from the front, the goal's side from the back. */
    uint32_t *queue;
    uint32_t slot_count;      /* a power of two */
    uint32_t queue_capacity;  /* of the queue */
    uint32_t queued_count[2]; /* of the start's side and of the goal's */
};

/*
 * A route, as places of triangles. It holds at most `capacity` of them; `count` says how many it has. If `other` is a
 * route to the same goal, this one ends before the first triangle that both have, since they are the same from there
 * on.
 */
struct route {
    uint32_t *places;
    uint32_t capacity;
    uint32_t count;
    const struct route *other; /* or NULL */
};

/*
 * Find the shortest route between two triangles, places in the mesh, by the paper's rule.
 *
 *   DPT_E_FULL         the search needs more vertices than its queue holds
 *   DPT_E_UNREACHABLE  no triangles lead from one to the other
 *   DPT_E_LAYOUT       the mesh is forged
 */
dpt_result dpti_route_find(struct route_search *search, const struct dpt_mesh *mesh, uint32_t from, uint32_t to,
                           struct route *route);

#endif
