/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Between the haptic loop and the physics of a soft body: vertices one way, loads on the nodes the other way. Neither
 * side waits for the other, and the newest value counts (exchange.h).
 *
 *     haptic loop, before a step of the world:   soft_exchange_take_vertices(exchange, world, body, &is_new);
 *                  after it:                     soft_exchange_give_loads(exchange, world, body);
 *     physics:                                   soft_exchange_step(exchange, springs, dt, &report);
 */
#ifndef DPT_TOOLS_SOFT_EXCHANGE_H
#define DPT_TOOLS_SOFT_EXCHANGE_H

#include "dynpoint/exchange.h"
#include "dynpoint/springs.h"

/* The loads of one step of the world. */
struct soft_loads {
    dpt_load *load;
    uint32_t count;
};

/* Begin with zeros. */
struct soft_exchange {
    dpt_latest latest_vertices, latest_loads;
    float *vertices[DPT_LATEST_PLACES]; /* 3 numbers a vertex, in the body's frame */
    struct soft_loads loads[DPT_LATEST_PLACES];
    uint32_t vertex_count, node_count, loads_room;
    /* The vertices are embedded in nodes: four for each vertex. NULL: they are the nodes. */
    const uint32_t *embedding;
    const float *weights;
    float *nodes; /* of physics, if there is an embedding */
};

/*
 * Of a mesh with springs, which stays open. DPT_E_MEMORY: memory ran out. Close it also after a failure.
 *   max_points   of the body's dpt_deformable_def
 */
dpt_result soft_exchange_open(struct soft_exchange *exchange, const dpt_mesh *mesh, uint32_t max_points);
void soft_exchange_close(struct soft_exchange *exchange);

/* If physics has new vertices, the body's are bound for there. *is_new says whether it had. */
dpt_result soft_exchange_take_vertices(struct soft_exchange *exchange, dpt_world *world, dpt_body body, int *is_new);

/* What tools do to the body since the last step of the world. */
dpt_result soft_exchange_give_loads(struct soft_exchange *exchange, const dpt_world *world, dpt_body body);

/*
 * Physics goes on by dt, s, under the newest loads. Vertices are handed over if any node is awake. The report's size is
 * set by the caller.
 */
dpt_result soft_exchange_step(struct soft_exchange *exchange, dpt_springs *springs, double dt,
                              dpt_springs_info *report);

#endif
