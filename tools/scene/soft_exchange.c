/* SPDX-License-Identifier: BSD-3-Clause */
#include "scene/soft_exchange.h"

#include <stdlib.h>

/* For each point at which a tool pushes (body.h); and of each vertex, embedded in nodes. */
enum { VERTICES_OF_POINT = 256, NODES_OF_VERTEX = 4 };

static dpt_result open_nodes(struct soft_exchange *exchange, const dpt_mesh *mesh)
{
    const float *rest;
    dpt_result result = dpt_mesh_get_vertices(mesh, &rest, &exchange->vertex_count);
    if (result == DPT_OK)
        result = dpt_mesh_get_embedding(mesh, &exchange->embedding, &exchange->weights, &exchange->node_count);
    if (result != DPT_OK)
        return result;
    if (!exchange->node_count) {
        exchange->node_count = exchange->vertex_count;
        exchange->embedding = NULL;
        return DPT_OK;
    }
    exchange->nodes = calloc(3 * (size_t)exchange->node_count, sizeof *exchange->nodes);
    return exchange->nodes ? DPT_OK : DPT_E_MEMORY;
}

dpt_result soft_exchange_open(struct soft_exchange *exchange, const dpt_mesh *mesh, uint32_t max_points)
{
    dpt_result result = open_nodes(exchange, mesh);
    exchange->loads_room = VERTICES_OF_POINT * max_points;
    if (exchange->embedding)
        exchange->loads_room *= NODES_OF_VERTEX;
    dpt_latest_init(&exchange->latest_vertices);
    dpt_latest_init(&exchange->latest_loads);
    for (int i = 0; result == DPT_OK && i < DPT_LATEST_PLACES; i++) {
        exchange->vertices[i] = calloc(3 * (size_t)exchange->vertex_count, sizeof(float));
        exchange->loads[i].load = calloc(exchange->loads_room, sizeof(dpt_load));
        if (!exchange->vertices[i] || !exchange->loads[i].load)
            result = DPT_E_MEMORY;
    }
    return result;
}

void soft_exchange_close(struct soft_exchange *exchange)
{
    for (int i = 0; i < DPT_LATEST_PLACES; i++) {
        free(exchange->vertices[i]);
        free(exchange->loads[i].load);
    }
    free(exchange->nodes);
    *exchange = (struct soft_exchange){ .nodes = NULL };
}

dpt_result soft_exchange_take_vertices(struct soft_exchange *exchange, dpt_world *world, dpt_body body, int *is_new)
{
    *is_new = dpt_latest_take(&exchange->latest_vertices);
    if (!*is_new)
        return DPT_OK;
    return dpt_body_set_vertices(world, body, 0, exchange->vertex_count,
                                 exchange->vertices[exchange->latest_vertices.reading], -1.0);
}

dpt_result soft_exchange_give_loads(struct soft_exchange *exchange, const dpt_world *world, dpt_body body)
{
    struct soft_loads *loads = &exchange->loads[exchange->latest_loads.writing];
    const dpt_result result =
        exchange->embedding ? dpt_body_get_node_loads(world, body, loads->load, exchange->loads_room, &loads->count)
                            : dpt_body_get_loads(world, body, loads->load, exchange->loads_room, &loads->count);
    if (result == DPT_OK)
        dpt_latest_publish(&exchange->latest_loads);
    return result;
}

/* Vertices follow their nodes. It is done by physics, because it takes as long as many a tick. */
static void place_vertices(const struct soft_exchange *exchange, float *to)
{
    for (size_t v = 0; v < exchange->vertex_count; v++) {
        const uint32_t *nodes = exchange->embedding + NODES_OF_VERTEX * v;
        const float *weights = exchange->weights + NODES_OF_VERTEX * v;
        double sum[3] = { 0.0, 0.0, 0.0 };
        for (int i = 0; i < NODES_OF_VERTEX; i++)
            for (int k = 0; k < 3; k++)
                sum[k] += (double)weights[i] * (double)exchange->nodes[3 * (size_t)nodes[i] + (size_t)k];
        for (int k = 0; k < 3; k++)
            to[3 * v + (size_t)k] = (float)sum[k];
    }
}

dpt_result soft_exchange_step(struct soft_exchange *exchange, dpt_springs *springs, double dt, dpt_springs_info *report)
{
    dpt_latest_take(&exchange->latest_loads);
    const struct soft_loads *loads = &exchange->loads[exchange->latest_loads.reading];
    float *vertices = exchange->vertices[exchange->latest_vertices.writing];
    dpt_result result = dpt_springs_step(springs, dt, loads->load, loads->count, report);
    if (result != DPT_OK || !report->active)
        return result;
    result =
        dpt_springs_get_nodes(springs, exchange->node_count, exchange->embedding ? exchange->nodes : vertices, NULL);
    if (result != DPT_OK)
        return result;
    if (exchange->embedding)
        place_vertices(exchange, vertices);
    dpt_latest_publish(&exchange->latest_vertices);
    return DPT_OK;
}
