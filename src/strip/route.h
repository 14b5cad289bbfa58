/* SPDX-License-Identifier: BSD-3-Clause */
/* Shortest routes over triangles that share a vertex: docs/algorithms/routes.md. */
#ifndef DPT_ROUTE_H
#define DPT_ROUTE_H

#include "dynpoint/strip.h"
#include "mesh/mesh_format.h"

/* A vertex that a search has come to. */
struct visited_vertex {
    uint32_t vertex_plus_1; /* and one, so that 0 is a free slot */
    uint32_t mark;          /* steps from its end, times 4, and ROUTE_... */
};

/* The memory of a search. All free between two of them. */
struct route_search {
    struct visited_vertex *slots; /* open addressing */
    uint32_t *
        queue; /* slots that were filled: those from the start, and, from the back, from the goal */
    uint32_t slot_count;     /* a power of two */
    uint32_t queue_capacity; /* of the queue */
    uint32_t queued_count[2];
};

/*
 * A route as it goes into a strip: places in the mesh, up to `room` of them; `count` is how many there are of it. With
 * `other`, a route to the same goal, only those before the first that both have: from there on they go on as one.
 */
struct route {
    uint32_t *places;
    uint32_t capacity;
    uint32_t count;
    const struct route *other; /* or NULL */
};

/* Both are places in the mesh. */
dpt_result dpti_route_find(struct route_search *search, const struct dpt_mesh *mesh, uint32_t from,
                           uint32_t to, struct route *route);

#endif
