/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Which triangles share an edge, which meet at a vertex, and which form a part. Two counting sorts find the edges, one
 * more finds the fans. Time is linear in the triangles, at hubs too.
 */
#include <stdlib.h>
#include <string.h>

#include "base/return_if_error.h"
#include "base/vec3.h"
#include "compile/model.h"
#include "mesh/mesh_format.h"

/* A half-edge is 3 * triangle + k: the edge of that triangle from corner k to corner k + 1. */
static uint32_t edge_from(const struct model *model, uint32_t half)
{
    return model->corners[half];
}

static uint32_t edge_to(const struct model *model, uint32_t half)
{
    return model->corners[half % 3 == 2 ? half - 2 : half + 1];
}

/* The end of a half-edge with the higher vertex number (`higher` 1) or with the lower one (0). */
static uint32_t edge_end(const struct model *model, uint32_t half, int higher)
{
    uint32_t from = edge_from(model, half), to = edge_to(model, half);
    return (from > to) == higher ? from : to;
}

static int same_edge(const struct model *model, uint32_t a, uint32_t b)
{
    return edge_end(model, a, 0) == edge_end(model, b, 0) && edge_end(model, a, 1) == edge_end(model, b, 1);
}

/* Sort half-edges by one end: a stable counting sort. `first` is scratch of vertex_count + 1 words. */
static void sort_by_end(const struct model *model, const uint32_t *in, uint32_t *out, uint32_t *first, int higher)
{
    size_t count = 3 * (size_t)model->triangle_count;
    memset(first, 0, ((size_t)model->vertex_count + 1) * sizeof *first);
    for (size_t i = 0; i < count; i++)
        first[edge_end(model, in[i], higher) + 1]++;
    for (uint32_t v = 0; v < model->vertex_count; v++)
        first[v + 1] += first[v];
    for (size_t i = 0; i < count; i++)
        out[first[edge_end(model, in[i], higher)]++] = in[i];
}

/* Union-find: each part is a tree of `parent` links. Return the root of t's tree, and shorten the path to it. */
static uint32_t root_of(uint32_t *parent, uint32_t t)
{
    while (parent[t] != t) {
        parent[t] = parent[parent[t]];
        t = parent[t];
    }
    return t;
}

static void unite(uint32_t *parent, uint32_t a, uint32_t b)
{
    a = root_of(parent, a);
    b = root_of(parent, b);
    if (a < b)
        parent[b] = a;
    else
        parent[a] = b;
}

/* Record one edge: `half` lists its `count` half-edges. */
static void connect_edge(struct model *model, uint32_t *parent, const uint32_t *half, size_t count)
{
    if (count == 1) {
        model->neighbours[half[0]] = MESH_EDGE_OPEN;
        model->open_edges++;
    } else if (count == 2) {
        model->neighbours[half[0]] = half[1] / 3;
        model->neighbours[half[1]] = half[0] / 3;
        if (edge_from(model, half[0]) == edge_from(model, half[1]))
            model->wrong_way_edges++;
    } else {
        for (size_t i = 0; i < count; i++)
            model->neighbours[half[i]] = MESH_EDGE_MANY;
        model->nonmanifold_edges++;
    }
    for (size_t i = 1; i < count; i++)
        unite(parent, half[0] / 3, half[i] / 3);
}

static void connect_edges(struct model *model, uint32_t *parent, const uint32_t *half)
{
    size_t count = 3 * (size_t)model->triangle_count;
    for (size_t i = 0, next; i < count; i = next) {
        for (next = i + 1; next < count && same_edge(model, half[i], half[next]); next++)
            ;
        connect_edge(model, parent, half + i, next - i);
    }
}

int model_is_wound_against(const struct model *model, uint32_t half, uint32_t neighbour)
{
    uint32_t from = edge_from(model, half), to = edge_to(model, half);
    const uint32_t *corner = model->corners + 3 * (size_t)neighbour;
    for (int k = 0; k < 3; k++)
        if (corner[k] == from && corner[(k + 1) % 3] == to)
            return 1;
    return 0;
}

/* Number the parts by their first triangle. Count the triangles and edges of each. */
static dpt_result number_parts(struct model *model, const struct compile_context *context, uint32_t *parent)
{
    uint32_t count = 0;
    for (uint32_t t = 0; t < model->triangle_count; t++)
        count += parent[t] == t;
    model->parts = compile_alloc(context, count, sizeof *model->parts);
    if (!model->parts)
        return DPT_E_MEMORY;
    memset(model->parts, 0, count * sizeof *model->parts);
    for (uint32_t t = 0; t < model->triangle_count; t++) {
        uint32_t root = root_of(parent, t);
        if (root == t)
            model->parts[model->part_count].flags = MESH_PART_WOUND;
        model->part_of[t] = root == t ? model->part_count++ : model->part_of[root];
        struct part *part = &model->parts[model->part_of[t]];
        part->triangles++;
        for (uint32_t half = 3 * t; half < 3 * t + 3; half++) {
            uint32_t n = model->neighbours[half];
            part->open_edges += n == MESH_EDGE_OPEN;
            part->nonmanifold_edges += n == MESH_EDGE_MANY;
            if (n < MESH_EDGE_MANY && model_is_wound_against(model, half, n))
                part->flags &= ~MESH_PART_WOUND;
        }
    }
    return DPT_OK;
}

enum { UNVISITED, AS_READ, TURNED };

/*
 * Walk from triangle `start` over manifold edges. Set state[t] of each triangle reached: TURNED if its winding must be
 * reversed to agree with `start`, else AS_READ.
 *
 *   queue          receives the triangles reached; *reached_count of them
 *   turned_count   the TURNED ones are added to it
 *
 * Returns 0 when no winding agrees across all edges (a Moebius strip).
 */
static int find_turned(const struct model *model, uint32_t start, uint8_t *state, uint32_t *queue,
                       uint32_t *turned_count, size_t *reached_count)
{
    size_t head = 0, tail = 0;
    int is_orientable = 1;
    state[start] = AS_READ;
    queue[tail++] = start;
    while (head < tail) {
        uint32_t t = queue[head++];
        for (uint32_t half = 3 * t; half < 3 * t + 3; half++) {
            uint32_t n = model->neighbours[half];
            if (n >= MESH_EDGE_MANY)
                continue;
            int is_against = model_is_wound_against(model, half, n);
            uint8_t wanted = (state[t] == AS_READ) == !is_against ? AS_READ : TURNED;
            if (state[n] == UNVISITED) {
                state[n] = wanted;
                *turned_count += wanted == TURNED;
                queue[tail++] = n;
            } else if (state[n] != wanted) {
                is_orientable = 0;
            }
        }
    }
    *reached_count = tail;
    return is_orientable;
}

/*
 * Decide which triangles of a part to turn so that it is wound one way: the smaller of the two groups. Turn none if the
 * part cannot be wound one way, or if only non-manifold edges connect some of its triangles.
 */
static void wind_part(struct model *model, struct part *part, uint32_t start, uint32_t *queue)
{
    uint32_t turned_count = 0;
    size_t reached_count;
    int is_orientable = find_turned(model, start, model->is_turned, queue, &turned_count, &reached_count);
    int is_consistent = is_orientable && reached_count == part->triangles;
    uint8_t minority = 2 * (uint64_t)turned_count <= part->triangles ? TURNED : AS_READ;
    for (size_t i = 0; i < reached_count; i++)
        model->is_turned[queue[i]] = is_consistent && model->is_turned[queue[i]] == minority ? TURNED : AS_READ;
    if (!part->nonmanifold_edges)
        part->flags |= MESH_PART_MANIFOLD;
    if (part->open_edges || part->nonmanifold_edges || !is_orientable)
        return;
    part->flags |= MESH_PART_CLOSED | MESH_PART_WOUND;
    model->closed_parts++;
}

static dpt_result wind_parts(struct model *model, const struct compile_context *context)
{
    model->is_turned = compile_alloc(context, model->triangle_count, sizeof *model->is_turned);
    uint32_t *queue = compile_alloc(context, model->triangle_count, sizeof *queue);
    dpt_result result = DPT_E_MEMORY;
    if (model->is_turned && queue) {
        memset(model->is_turned, UNVISITED, model->triangle_count);
        uint32_t next_part = 0;
        for (uint32_t t = 0; t < model->triangle_count; t++)
            if (model->part_of[t] == next_part)
                wind_part(model, &model->parts[next_part++], t, queue);
        for (uint32_t t = 0; t < model->triangle_count; t++)
            model->is_turned[t] = model->is_turned[t] == TURNED;
        result = DPT_OK;
    }
    free(queue);
    return result;
}

/* List the triangles at each vertex, ascending: those of v are fans[fan_first[v]..fan_first[v + 1]). */
static void fill_fans(struct model *model)
{
    size_t count = 3 * (size_t)model->triangle_count;
    uint32_t *first = model->fan_first;
    memset(first, 0, ((size_t)model->vertex_count + 1) * sizeof *first);
    for (size_t c = 0; c < count; c++)
        first[model->corners[c]]++;
    uint32_t end = 0;
    for (uint32_t v = 0; v <= model->vertex_count; v++) {
        uint32_t size = v < model->vertex_count ? first[v] : 0;
        first[v] = end += size;
    }
    for (size_t c = count; c-- > 0;)
        model->fans[--first[model->corners[c]]] = (uint32_t)(c / 3);
}

dpt_result model_adjacency(struct model *model, const struct compile_context *context)
{
    size_t count = 3 * (size_t)model->triangle_count;
    uint32_t *half = compile_alloc(context, count, sizeof *half);
    uint32_t *spare = compile_alloc(context, count, sizeof *spare);
    model->neighbours = compile_alloc(context, count, sizeof *model->neighbours);
    model->fans = compile_alloc(context, count, sizeof *model->fans);
    model->part_of = compile_alloc(context, model->triangle_count, sizeof *model->part_of);
    model->fan_first = compile_alloc(context, (size_t)model->vertex_count + 1, sizeof *model->fan_first);
    dpt_result result = DPT_E_MEMORY;
    if (half && spare && model->neighbours && model->fans && model->part_of && model->fan_first) {
        for (uint32_t h = 0; h < count; h++)
            spare[h] = h;
        sort_by_end(model, spare, half, model->fan_first, 1);
        sort_by_end(model, half, spare, model->fan_first, 0);
        for (uint32_t t = 0; t < model->triangle_count; t++)
            half[t] = t;
        connect_edges(model, half, spare);
        result = number_parts(model, context, half);
        if (result == DPT_OK)
            result = wind_parts(model, context);
        if (result == DPT_OK)
            fill_fans(model);
    }
    free(half);
    free(spare);
    return result;
}
