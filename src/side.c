/* SPDX-License-Identifier: BSD-3-Clause */
#include "side.h"

#include "angle.h"

static vec3 corner_of(const struct tree *tree, uint32_t triangle, int k)
{
    uint32_t v = tree->corners[3 * (size_t)triangle + (size_t)(k % 3)];
    return vec3_of_float(tree->positions + 3 * (size_t)v);
}

static vec3 unit(vec3 v)
{
    double size = length(v);
    return size > 0.0 ? scaled(v, 1.0 / size) : (vec3){ 0.0, 0.0, 0.0 };
}

vec3 side_face_normal(const struct tree *tree, uint32_t triangle)
{
    vec3 a = corner_of(tree, triangle, 0);
    return unit(cross(sub(corner_of(tree, triangle, 1), a), sub(corner_of(tree, triangle, 2), a)));
}

/* Between two unit vectors, 0..pi (Kahan): good for small and for straight angles. */
static double angle_between(vec3 a, vec3 b)
{
    double chord = length(sub(a, b)), sum = length(add(a, b));
    if (chord <= sum)
        return chord > 0.0 ? 2.0 * arctangent(chord / sum) : 0.0;
    return 0.5 * ANGLE_TURN - 2.0 * arctangent(sum / chord);
}

/* Angle-weighted (Baerentzen and Aanaes 2005), over the vertex's triangles of the same part. */
static vec3 vertex_normal(const struct tree *tree, uint32_t triangle, int k)
{
    const uint32_t *part = mesh_words(tree->mesh, MESH_PARTS);
    const uint32_t *first = mesh_words(tree->mesh, MESH_FAN_FIRST);
    const uint32_t *fans = mesh_words(tree->mesh, MESH_FANS);
    uint32_t v = tree->corners[3 * (size_t)triangle + (size_t)k];
    vec3 normal = { 0.0, 0.0, 0.0 };
    for (uint32_t i = first[v]; i < first[v + 1]; i++) {
        uint32_t t = fans[i];
        if (part[t] != part[triangle])
            continue;
        int at = 0;
        while (at < 2 && tree->corners[3 * (size_t)t + (size_t)at] != v)
            at++;
        vec3 here = corner_of(tree, t, at);
        double angle = angle_between(unit(sub(corner_of(tree, t, at + 1), here)),
                                     unit(sub(corner_of(tree, t, at + 2), here)));
        normal = along(normal, angle, side_face_normal(tree, t));
    }
    return normal;
}

static vec3 edge_normal(const struct tree *tree, uint32_t triangle, int k)
{
    uint32_t other = mesh_words(tree->mesh, MESH_NEIGHBOURS)[3 * (size_t)triangle + (size_t)k];
    vec3 normal = side_face_normal(tree, triangle);
    return other < tree->mesh->triangles ? add(normal, side_face_normal(tree, other)) : normal;
}

vec3 side_feature_normal(const struct tree *tree, uint32_t triangle, const double weight[3])
{
    int corners = 0, zero = 0, corner = 0;
    for (int k = 0; k < 3; k++) {
        if (weight[k] > 0.0) {
            corners++;
            corner = k;
        } else {
            zero = k;
        }
    }
    if (corners == 1)
        return vertex_normal(tree, triangle, corner);
    if (corners == 2)
        return edge_normal(tree, triangle, (zero + 1) % 3);
    return side_face_normal(tree, triangle);
}

vec3 side_smooth_normal(const struct tree *tree, uint32_t triangle, const double weight[3])
{
    vec3 normal = { 0.0, 0.0, 0.0 };
    for (int k = 0; k < 3; k++)
        normal = along(normal, weight[k], unit(vertex_normal(tree, triangle, k)));
    return unit(normal);
}

uint32_t side_part(const struct tree *tree, uint32_t triangle)
{
    return mesh_words(tree->mesh, MESH_PARTS)[triangle];
}

int side_is_sheet(const struct tree *tree, uint32_t part)
{
    uint32_t flags = mesh_part_flags(tree->mesh, part);
    return !(flags & MESH_PART_SOLID) && (flags & MESH_PART_MANIFOLD) && (flags & MESH_PART_WOUND);
}

int side_is_border(const struct tree *tree, uint32_t triangle, const double weight[3])
{
    const uint32_t *neighbour = mesh_words(tree->mesh, MESH_NEIGHBOURS);
    const uint32_t *first = mesh_words(tree->mesh, MESH_FAN_FIRST);
    const uint32_t *fans = mesh_words(tree->mesh, MESH_FANS);
    for (size_t k = 0; k < 3; k++)
        if (weight[(k + 2) % 3] <= 0.0 && neighbour[3 * (size_t)triangle + k] == MESH_EDGE_OPEN)
            return 1;
    for (size_t k = 0; k < 3; k++) {
        if (weight[(k + 1) % 3] > 0.0 || weight[(k + 2) % 3] > 0.0)
            continue;
        uint32_t v = tree->corners[3 * (size_t)triangle + k];
        for (uint32_t i = first[v]; i < first[v + 1]; i++) {
            size_t at = 3 * (size_t)fans[i];
            for (size_t e = 0; e < 3; e++)
                if (neighbour[at + e] == MESH_EDGE_OPEN &&
                    (tree->corners[at + e] == v || tree->corners[at + (e + 1) % 3] == v))
                    return 1;
        }
    }
    return 0;
}

int side_of_pair(const struct tree *tree, uint32_t triangle, const pair *found)
{
    return dot(side_feature_normal(tree, triangle, found->weight), found->gap) < 0.0 ? -1 : 1;
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
    pair best = tree_pair(tree, triangle, x, (vec3){ 0.0, 0.0, 0.0 });
    for (uint32_t i = first[v]; i < first[v + 1]; i++) {
        pair found = tree_pair(tree, fans[i], x, (vec3){ 0.0, 0.0, 0.0 });
        if (found.distance2 < best.distance2) {
            best = found;
            nearest = fans[i];
        }
    }
    return side_of_pair(tree, nearest, &best);
}
