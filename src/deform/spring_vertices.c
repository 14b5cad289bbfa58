/* SPDX-License-Identifier: BSD-3-Clause */
#include "deform/spring_vertices.h"

#include <string.h>

#include "mesh/mesh_format.h"
#include "mesh/surface_motion.h"

typedef char groups_are_slices[(int)MOTION_GROUP == (int)LANES ? 1 : -1];

/* The slices of nodes that a group of vertices follows, each once. Returns how many. */
static uint32_t slices_of_group(const struct dpt_mesh *mesh, uint32_t group,
                                uint32_t slices[4 * MOTION_GROUP])
{
    const uint32_t *nodes = mesh_words(mesh, MESH_EMBED_NODES);
    const size_t first = (size_t)MOTION_GROUP * group;
    const size_t end =
        first + MOTION_GROUP < mesh->vertices ? first + MOTION_GROUP : mesh->vertices;
    uint32_t count = 0;
    for (size_t i = 4 * first; i < 4 * end; i++) {
        const uint32_t slice = nodes[i] / LANES;
        uint32_t k = 0;
        while (k < count && slices[k] != slice)
            k++;
        if (k == count)
            slices[count++] = slice;
    }
    return count;
}

uint64_t dpti_spring_links(const struct dpt_mesh *mesh)
{
    uint32_t slices[4 * MOTION_GROUP];
    uint64_t links = 0;
    for (uint32_t group = 0; mesh_tail(mesh).nodes && group < mesh_slices(mesh->vertices); group++)
        links += slices_of_group(mesh, group, slices);
    return links;
}

void dpti_spring_vertices_begin(struct dpt_springs *springs)
{
    const struct dpt_mesh *mesh = springs->def.mesh;
    struct spring_vertices *vertices = &springs->vertices;
    if (!mesh_tail(mesh).nodes)
        return;
    vertices->nodes = mesh_words(mesh, MESH_EMBED_NODES);
    vertices->weights = mesh_floats(mesh, MESH_EMBED_WEIGHTS);
    for (uint32_t group = 0; group < mesh_slices(mesh->vertices); group++)
        vertices->first[group + 1] =
            vertices->first[group] +
            slices_of_group(mesh, group, vertices->slices + vertices->first[group]);
}

void dpti_spring_vertices_note(struct dpt_springs *springs)
{
    for (uint32_t i = 0; springs->vertices.moved && i < springs->region.count; i++)
        springs->vertices.moved[springs->region.slices[i]] = 1;
}

static int has_moved(const struct spring_vertices *vertices, uint32_t group)
{
    if (!vertices->nodes)
        return vertices->moved[group];
    for (uint32_t i = vertices->first[group]; i < vertices->first[group + 1]; i++)
        if (vertices->moved[vertices->slices[i]])
            return 1;
    return 0;
}

static void place_vertex(const struct spring_vertices *vertices, const struct spring_slice *state,
                         uint32_t vertex, float to[3])
{
    double sum[3] = { 0.0, 0.0, 0.0 };
    if (!vertices->nodes) {
        for (uint32_t k = 0; k < 3; k++)
            to[k] = state[vertex / LANES].x[LANES * k + vertex % LANES];
        return;
    }
    for (size_t i = 4 * (size_t)vertex; i < 4 * (size_t)vertex + 4; i++) {
        const uint32_t node = vertices->nodes[i];
        const float *x = state[node / LANES].x + node % LANES;
        for (uint32_t k = 0; k < 3; k++)
            sum[k] += (double)vertices->weights[i] * (double)x[LANES * k];
    }
    for (uint32_t k = 0; k < 3; k++)
        to[k] = (float)sum[k];
}

uint32_t dpti_spring_vertices_gather(struct dpt_springs *springs)
{
    struct spring_vertices *vertices = &springs->vertices;
    const struct spring_slice *state = springs->state[springs->now];
    const uint32_t all = springs->def.mesh->vertices;
    uint32_t count = 0;
    for (uint32_t group = 0; group < mesh_slices(all); group++) {
        if (!has_moved(vertices, group))
            continue;
        for (uint32_t v = MOTION_GROUP * group; v < all && v / MOTION_GROUP == group; v++) {
            place_vertex(vertices, state, v, vertices->positions + 3 * (size_t)count);
            vertices->list[count++] = v;
        }
    }
    memset(vertices->moved, 0, springs->net.slices);
    return count;
}
