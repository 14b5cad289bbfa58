/* SPDX-License-Identifier: BSD-3-Clause */
#include "nearest/side.h"

#include "base/angle.h"

static vec3 corner_of(const struct tree *tree, uint32_t triangle, int k)
{
    uint32_t v = tree->corners[3 * (size_t)triangle + (size_t)(k % 3)];
    return vec3_of_float(tree->positions + 3 * (size_t)v);
}

vec3 side_face_normal(const struct tree *tree, uint32_t triangle)
{
    vec3 a = corner_of(tree, triangle, 0);
    return unit_of(
        cross(sub(corner_of(tree, triangle, 1), a), sub(corner_of(tree, triangle, 2), a)));
}

/* What a triangle adds to the normal of its corner's vertex: that of its plane, by its angle there. */
static vec3 weighted_normal(const struct tree *tree, uint32_t triangle, int k)
{
    vec3 here = corner_of(tree, triangle, k);
    double angle = angle_between(unit_of(sub(corner_of(tree, triangle, k + 1), here)),
                                 unit_of(sub(corner_of(tree, triangle, k + 2), here)));
    return scaled(side_face_normal(tree, triangle), angle);
}

static int corner_at(const struct tree *tree, uint32_t triangle, uint32_t vertex)
{
    int k = 0;
    while (k < 2 && tree->corners[3 * (size_t)triangle + (size_t)k] != vertex)
        k++;
    return k;
}

/* Angle-weighted (Baerentzen and Aanaes 2005), over the vertex's triangles of the same part. */
static vec3 fan_normal(const struct tree *tree, uint32_t triangle, int k)
{
    const uint32_t *part = mesh_words(tree->mesh, MESH_PARTS);
    const uint32_t *first = mesh_words(tree->mesh, MESH_FAN_FIRST);
    const uint32_t *fans = mesh_words(tree->mesh, MESH_FANS);
    uint32_t v = tree->corners[3 * (size_t)triangle + (size_t)k];
    vec3 normal = { 0.0, 0.0, 0.0 };
    for (uint32_t i = first[v]; i < first[v + 1]; i++)
        if (part[fans[i]] == part[triangle])
            normal = add(normal, weighted_normal(tree, fans[i], corner_at(tree, fans[i], v)));
    return normal;
}

vec3 side_vertex_normal(const struct tree *tree, uint32_t triangle, int k)
{
    const float *normals = mesh_normals(tree->mesh);
    if (normals) {
        uint32_t v = tree->corners[3 * (size_t)triangle + (size_t)k];
        vec3 n = vec3_of_float(normals + 3 * (size_t)v);
        if (n.x != 0.0 || n.y != 0.0 || n.z != 0.0)
            return n;
    }
    return fan_normal(tree, triangle, k);
}

static vec3 edge_normal(const struct tree *tree, uint32_t triangle, int k)
{
    uint32_t other = mesh_words(tree->mesh, MESH_NEIGHBOURS)[3 * (size_t)triangle + (size_t)k];
    vec3 normal = side_face_normal(tree, triangle);
    return other < tree->mesh->triangles ? add(normal, side_face_normal(tree, other)) : normal;
}

/* The corner that these weights are all of, or -1. */
static int lone_corner(const double weight[3])
{
    for (int k = 0; k < 3; k++)
        if (!(weight[(k + 1) % 3] > 0.0) && !(weight[(k + 2) % 3] > 0.0))
            return k;
    return -1;
}

vec3 side_feature_normal(const struct tree *tree, uint32_t triangle, const double weight[3])
{
    int corner = lone_corner(weight);
    if (corner >= 0)
        return side_vertex_normal(tree, triangle, corner);
    for (int k = 0; k < 3; k++)
        if (!(weight[(k + 2) % 3] > 0.0))
            return edge_normal(tree, triangle, k);
    return side_face_normal(tree, triangle);
}

/* Of a crease's side no more triangles are asked, each way: a hub may have any number. */
#define SECTOR_MOST 64

/* Over the triangles round the vertex up to the next crease either way, or where they end. */
static vec3 sector_normal(const struct tree *tree, uint32_t triangle, int k)
{
    const uint32_t *flags = mesh_flags(tree->mesh);
    const uint32_t *neighbours = mesh_words(tree->mesh, MESH_NEIGHBOURS);
    uint32_t v = tree->corners[3 * (size_t)triangle + (size_t)k];
    vec3 normal = weighted_normal(tree, triangle, k);
    for (int way = 0; way < 2; way++) {
        uint32_t t = triangle;
        int edge = way ? (k + 2) % 3 : k;
        for (int i = 0; i < SECTOR_MOST; i++) {
            uint32_t next = neighbours[3 * (size_t)t + (size_t)edge];
            if (flags[t] & (uint32_t)DPT_EDGE_CREASE << edge || next >= tree->mesh->triangles)
                break;
            if (next == triangle)
                return normal;
            int at = corner_at(tree, next, v), before = (at + 2) % 3;
            edge = neighbours[3 * (size_t)next + (size_t)before] == t ? at : before;
            t = next;
            normal = add(normal, weighted_normal(tree, t, at));
        }
    }
    return normal;
}

vec3 side_smooth_normal(const struct tree *tree, uint32_t triangle, const double weight[3])
{
    const uint32_t *flags = mesh_flags(tree->mesh);
    const uint32_t ends = DPT_CORNER_CREASE | DPT_CORNER_NONMANIFOLD;
    vec3 normal = { 0.0, 0.0, 0.0 };
    for (int k = 0; k < 3; k++) {
        int ended = flags && (flags[triangle] & ends << k);
        vec3 corner =
            ended ? sector_normal(tree, triangle, k) : side_vertex_normal(tree, triangle, k);
        normal = along(normal, weight[k], unit_of(corner));
    }
    return unit_of(normal);
}

uint32_t side_part(const struct tree *tree, uint32_t triangle)
{
    return mesh_words(tree->mesh, MESH_PARTS)[triangle];
}

int side_is_sheet(const struct tree *tree, uint32_t part)
{
    uint32_t flags = mesh_part_flags(tree->mesh, part);
    return !(flags & (MESH_PART_SOLID | MESH_PART_BURIED)) && (flags & MESH_PART_MANIFOLD) &&
           (flags & MESH_PART_WOUND);
}

int side_is_border(const struct tree *tree, uint32_t triangle, const double weight[3])
{
    const uint32_t *neighbour = mesh_words(tree->mesh, MESH_NEIGHBOURS);
    const uint32_t *first = mesh_words(tree->mesh, MESH_FAN_FIRST);
    const uint32_t *fans = mesh_words(tree->mesh, MESH_FANS);
    const uint32_t *flags = mesh_flags(tree->mesh);
    for (size_t k = 0; k < 3; k++)
        if (weight[(k + 2) % 3] <= 0.0 && neighbour[3 * (size_t)triangle + k] == MESH_EDGE_OPEN)
            return 1;
    int corner = lone_corner(weight);
    if (corner < 0)
        return 0;
    if (flags)
        return (flags[triangle] & (uint32_t)DPT_CORNER_BORDER << corner) != 0;
    uint32_t v = tree->corners[3 * (size_t)triangle + (size_t)corner];
    for (uint32_t i = first[v]; i < first[v + 1]; i++) {
        size_t at = 3 * (size_t)fans[i];
        for (size_t e = 0; e < 3; e++)
            if (neighbour[at + e] == MESH_EDGE_OPEN &&
                (tree->corners[at + e] == v || tree->corners[at + (e + 1) % 3] == v))
                return 1;
    }
    return 0;
}

/*
 * A stored normal is off by no more than that: half a unit in the last place of each float, and what the compiler leaves
 * out of a fan that cancels.
 */
#define STORED_ERROR 0x1p-23

int side_of_pair(const struct tree *tree, uint32_t triangle, const pair *found)
{
    double rise = dot(side_feature_normal(tree, triangle, found->weight), found->gap);
    int corner = lone_corner(found->weight);
    if (corner >= 0 && fabs(rise) <= STORED_ERROR * length(found->gap))
        rise = dot(fan_normal(tree, triangle, corner), found->gap);
    return rise < 0.0 ? -1 : 1;
}

/* Of an edge, how far back one looks. */
#define SIDE_BACK 1e-3

int side_of_way(const struct tree *tree, uint32_t triangle, const double weight[3], vec3 back)
{
    const uint32_t *first = mesh_words(tree->mesh, MESH_FAN_FIRST);
    const uint32_t *fans = mesh_words(tree->mesh, MESH_FANS);
    int most = weight[1] > weight[0] ? 1 : 0;
    most = weight[2] > weight[most] ? 2 : most;
    double size = length(back);
    if ((weight[0] > 0.0 && weight[1] > 0.0 && weight[2] > 0.0) || !(size > 0.0))
        return dot(side_face_normal(tree, triangle), back) < 0.0 ? -1 : 1;
    vec3 q = { 0.0, 0.0, 0.0 };
    for (int k = 0; k < 3; k++)
        q = along(q, weight[k], corner_of(tree, triangle, k));
    double edge = length(sub(corner_of(tree, triangle, most + 1), corner_of(tree, triangle, most)));
    vec3 x = along(q, smaller(SIDE_BACK * edge, size) / size, back);
    uint32_t v = tree->corners[3 * (size_t)triangle + (size_t)most], nearest = triangle;
    pair best, found;
    tree_point(tree, triangle, x, &best);
    for (uint32_t i = first[v]; i < first[v + 1]; i++) {
        tree_point(tree, fans[i], x, &found);
        if (found.distance2 < best.distance2) {
            best = found;
            nearest = fans[i];
        }
    }
    return side_of_pair(tree, nearest, &best);
}
