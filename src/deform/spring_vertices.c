/* SPDX-License-Identifier: BSD-3-Clause */
#include "deform/spring_vertices.h"

#include <string.h>

#include "mesh/mesh_format.h"
#include "mesh/surface_motion.h"

typedef char groups_are_slices[(int)MOTION_GROUP == (int)LANES ? 1 : -1];

/* The slices of nodes that a group of vertices follows, each once. Returns how many. */
static uint32_t slices_of_group(const struct dpt_mesh *mesh, uint32_t group, uint32_t slices[4 * MOTION_GROUP])
{
    const uint32_t *nodes = mesh_words(mesh, MESH_EMBED_NODES);
    const size_t first = (size_t)MOTION_GROUP * group;
    const size_t end = first + MOTION_GROUP < mesh->vertices ? first + MOTION_GROUP : mesh->vertices;
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
            vertices->first[group] + slices_of_group(mesh, group, vertices->slices + vertices->first[group]);
    for (uint32_t slice = 0; slice < springs->net.slices; slice++)
        springs->kernel.spring_points(springs->state[springs->now] + slice, 0.0f,
                                      vertices->points + SPRING_POINTS * (size_t)slice);
}

void dpti_spring_vertices_note(struct dpt_springs *springs)
{
    struct spring_vertices *vertices = &springs->vertices;
    for (uint32_t i = 0; vertices->moved && i < springs->region.count; i++)
        vertices->moved[springs->region.slices[i]] = 1;
    vertices->has_moved |= springs->region.count > 0;
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

/* A group that is not full: what it lacks follows the first node, without weight. */
static void follow_some(const struct dpt_springs *springs, uint32_t first, uint32_t count, float *to)
{
    const struct spring_vertices *vertices = &springs->vertices;
    uint32_t nodes[4 * MOTION_GROUP] = { 0 };
    float weights[4 * MOTION_GROUP] = { 0.0f };
    memcpy(nodes, vertices->nodes + 4 * (size_t)first, 4 * count * sizeof *nodes);
    memcpy(weights, vertices->weights + 4 * (size_t)first, 4 * count * sizeof *weights);
    springs->kernel.spring_follow(vertices->points, nodes, weights, to);
}

/* Where the vertices of a group are: 48 floats, and one more is written. */
static void place_group(const struct dpt_springs *springs, uint32_t group, float *to)
{
    const struct spring_vertices *vertices = &springs->vertices;
    const uint32_t first = MOTION_GROUP * group, count = springs->def.mesh->vertices - first;
    const float *x = springs->state[springs->now][group].x;
    if (vertices->nodes && count < MOTION_GROUP)
        follow_some(springs, first, count, to);
    else if (vertices->nodes)
        springs->kernel.spring_follow(vertices->points, vertices->nodes + 4 * (size_t)first,
                                      vertices->weights + 4 * (size_t)first, to);
    else
        for (uint32_t i = 0; i < MOTION_GROUP; i++)
            for (uint32_t k = 0; k < 3; k++)
                to[3 * i + k] = x[LANES * k + i];
}

/* Those of which some have moved, in a list; or all, without a list, if they are most: that takes less time. */
static uint32_t moved_groups(const struct spring_vertices *vertices, uint32_t groups, uint32_t *list)
{
    uint32_t count = 0;
    for (uint32_t group = 0; group < groups; group++)
        if (has_moved(vertices, group))
            list[count++] = group;
    return (uint64_t)4 * count < (uint64_t)3 * groups ? count : groups;
}

/* From groups to their vertices, from the last one on: each takes the place of what was read already. */
static uint32_t list_vertices(uint32_t *list, uint32_t groups, uint32_t all)
{
    uint32_t count = 0;
    for (uint32_t i = groups; i-- > 0;) {
        const uint32_t first = MOTION_GROUP * list[i];
        for (uint32_t v = first; v < all && v < first + MOTION_GROUP; v++, count++)
            list[MOTION_GROUP * i + v - first] = v;
    }
    return count;
}

uint32_t dpti_spring_vertices_gather(struct dpt_springs *springs)
{
    struct spring_vertices *vertices = &springs->vertices;
    const struct spring_slice *state = springs->state[springs->now];
    const uint32_t all = springs->def.mesh->vertices, whole = mesh_slices(all);
    if (!vertices->has_moved)
        return 0;
    for (uint32_t slice = 0; vertices->nodes && slice < springs->net.slices; slice++)
        if (vertices->moved[slice])
            springs->kernel.spring_points(state + slice, 0.0f, vertices->points + SPRING_POINTS * (size_t)slice);
    const uint32_t groups = moved_groups(vertices, whole, vertices->list);
    for (uint32_t i = 0; i < groups; i++)
        place_group(springs, groups < whole ? vertices->list[i] : i,
                    vertices->positions + 3 * MOTION_GROUP * (size_t)i);
    memset(vertices->moved, 0, springs->net.slices);
    vertices->has_moved = 0;
    return groups < whole ? list_vertices(vertices->list, groups, all) : all;
}
