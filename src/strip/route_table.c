/* SPDX-License-Identifier: BSD-3-Clause */
/* The paper's adjacency structure: every traversal distance, looked up. */
#include <string.h>

#include "base/return_if_error.h"
#include "dynpoint/baseline.h"
#include "mesh/corners.h"
#include "strip/strip_state.h"

enum { TABLE_TRIANGLES_MAX = 10000, TABLE_UNREACHABLE = UINT16_MAX };

struct dpt_route_table {
    const struct dpt_mesh *mesh;
    const uint16_t *steps; /* traversal distances: a row for each goal, by places */
};

static uint64_t bytes_of_steps(const struct dpt_mesh *mesh)
{
    return mesh_aligned(2 * (uint64_t)mesh->triangles * mesh->triangles);
}

size_t dpt_route_table_bytes(const dpt_mesh *mesh)
{
    if (!mesh || mesh->triangles > TABLE_TRIANGLES_MAX)
        return 0;
    uint64_t bytes =
        mesh_aligned(sizeof(dpt_route_table)) + bytes_of_steps(mesh) + 4 * ((uint64_t)mesh->triangles + mesh->vertices);
    return bytes <= SIZE_MAX ? (size_t)bytes : 0;
}

/*
 * Fill the row of one goal, a place, breadth first. Each fan is read once: seen[vertex] is 1 + the last goal for which
 * it was.
 */
static void fill_row(const struct dpt_mesh *mesh, uint32_t goal, uint16_t *steps, uint32_t *queue, uint32_t *seen)
{
    const uint32_t *corners = mesh_words(mesh, MESH_TRIANGLES);
    const uint32_t *fan_first = mesh_words(mesh, MESH_FAN_FIRST);
    const uint32_t *fans = mesh_words(mesh, MESH_FANS);
    uint32_t head = 0, tail = 0;
    for (uint32_t t = 0; t < mesh->triangles; t++)
        steps[t] = TABLE_UNREACHABLE;
    steps[goal] = 0;
    queue[tail++] = goal;
    while (head < tail) {
        uint32_t current = queue[head++];
        for (int k = 0; k < 3; k++) {
            uint32_t vertex = corners[3 * (size_t)current + (size_t)k];
            if (seen[vertex] == goal + 1)
                continue;
            seen[vertex] = goal + 1;
            for (uint32_t i = fan_first[vertex]; i < fan_first[vertex + 1]; i++)
                if (steps[fans[i]] == TABLE_UNREACHABLE) {
                    steps[fans[i]] = (uint16_t)(steps[current] + 1);
                    queue[tail++] = fans[i];
                }
        }
    }
}

dpt_result dpt_route_table_create(void *block, size_t bytes, const dpt_mesh *mesh, const dpt_route_table **table)
{
    if (!block || !mesh || !table)
        return DPT_E_ARGUMENT;
    if ((uintptr_t)block % 8)
        return DPT_E_ALIGN;
    size_t needed = dpt_route_table_bytes(mesh);
    if (!needed)
        return DPT_E_UNSUPPORTED;
    if (bytes < needed)
        return DPT_E_MEMORY;
    struct dpt_route_table *created = block;
    char *at = (char *)block + mesh_aligned(sizeof *created);
    uint16_t *steps = (void *)at;
    uint32_t *queue = (void *)(at + bytes_of_steps(mesh));
    uint32_t *seen = queue + mesh->triangles;
    memset(seen, 0, 4 * (size_t)mesh->vertices);
    for (uint32_t goal = 0; goal < mesh->triangles; goal++)
        fill_row(mesh, goal, steps + (size_t)goal * mesh->triangles, queue, seen);
    *created = (struct dpt_route_table){ mesh, steps };
    *table = created;
    return DPT_OK;
}

/* Of the triangles that share a vertex with `current`, a place, and are nearer to the row's goal, the rule's choice. */
static uint32_t next_triangle(const struct dpt_mesh *mesh, const uint16_t *steps, uint32_t current)
{
    const uint32_t *corners = mesh_words(mesh, MESH_TRIANGLES);
    const uint32_t *fan_first = mesh_words(mesh, MESH_FAN_FIRST);
    const uint32_t *fans = mesh_words(mesh, MESH_FANS);
    const uint32_t *sources = mesh_words(mesh, MESH_SOURCES);
    const uint32_t *own_corners = corners + 3 * (size_t)current;
    uint32_t best = DPT_NONE;
    int best_shares_edge = 0;
    for (int k = 0; k < 3; k++)
        for (uint32_t i = fan_first[own_corners[k]]; i < fan_first[own_corners[k] + 1]; i++) {
            uint32_t triangle = fans[i];
            if (steps[triangle] + 1 != steps[current])
                continue;
            const uint32_t *corner = corners + 3 * (size_t)triangle;
            int shares_edge = shared_corners(own_corners, 3, corner) >= 2;
            if (best == DPT_NONE || shares_edge > best_shares_edge ||
                (shares_edge == best_shares_edge && sources[triangle] < sources[best])) {
                best = triangle;
                best_shares_edge = shares_edge;
            }
        }
    return best;
}

dpt_result dpt_strip_route_by_table(dpt_strip *strip, const dpt_route_table *table, uint32_t from, uint32_t to)
{
    if (!strip)
        return DPT_E_ARGUMENT;
    dpti_strip_clear(strip, table ? table->mesh : NULL);
    if (!table)
        return DPT_E_ARGUMENT;
    const struct dpt_mesh *mesh = table->mesh;
    uint32_t current, goal;
    DPT_TRY(dpti_strip_place(mesh, from, &current));
    DPT_TRY(dpti_strip_place(mesh, to, &goal));
    const uint16_t *steps = table->steps + (size_t)goal * mesh->triangles;
    if (steps[current] == TABLE_UNREACHABLE)
        return DPT_E_UNREACHABLE;
    dpti_strip_add(strip, current);
    while (current != goal) {
        current = next_triangle(mesh, steps, current);
        if (current == DPT_NONE) {
            dpti_strip_clear(strip, mesh);
            return DPT_E_LAYOUT;
        }
        dpti_strip_add(strip, current);
    }
    return DPT_OK;
}
