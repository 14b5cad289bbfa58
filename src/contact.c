/* SPDX-License-Identifier: BSD-3-Clause */
#include "contact.h"

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

static vec3 face_normal(const struct tree *tree, uint32_t triangle)
{
    vec3 a = corner_of(tree, triangle, 0);
    return unit(cross(sub(corner_of(tree, triangle, 1), a), sub(corner_of(tree, triangle, 2), a)));
}

/*
 * atan of 0..1 by two half-angle steps and the series up to z^13; error below 1e-11. Its own, so that
 * every machine gives the same bits.
 */
static double arctangent(double z)
{
    for (int i = 0; i < 2; i++)
        z = z / (1.0 + sqrt(1.0 + z * z));
    double w = z * z, sum = 0.0;
    for (int k = 13; k >= 1; k -= 2)
        sum = 1.0 / k - w * sum;
    return 4.0 * z * sum;
}

/* Between two unit vectors, 0..pi (Kahan): good for small and for straight angles. */
static double angle_between(vec3 a, vec3 b)
{
    double chord = length(sub(a, b)), sum = length(add(a, b));
    if (chord <= sum)
        return chord > 0.0 ? 2.0 * arctangent(chord / sum) : 0.0;
    return 3.14159265358979323846 - 2.0 * arctangent(sum / chord);
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
        normal = along(normal, angle, face_normal(tree, t));
    }
    return normal;
}

static vec3 edge_normal(const struct tree *tree, uint32_t triangle, int k)
{
    uint32_t other = mesh_words(tree->mesh, MESH_NEIGHBOURS)[3 * (size_t)triangle + (size_t)k];
    vec3 normal = face_normal(tree, triangle);
    return other < tree->mesh->triangles ? add(normal, face_normal(tree, other)) : normal;
}

/* The normal whose sign tells inside from outside at the nearest point: of its feature. */
static vec3 feature_normal(const struct tree *tree, uint32_t triangle, const double weight[3])
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
    return face_normal(tree, triangle);
}

static uint32_t contact_of_gap(double gap, double error)
{
    if (fabs(gap) <= error)
        return DPT_CONTACT_TOUCHING;
    return gap > 0.0 ? DPT_CONTACT_SEPARATED : DPT_CONTACT_PENETRATING;
}

void contact_set_gap(dpt_hit *hit, double gap, double error)
{
    hit->flags |= DPT_HIT_GAP;
    hit->gap = gap;
    hit->depth = larger(0.0, -gap);
    hit->contact = contact_of_gap(gap, error);
}

/* Of the axis' ends, the lower one's height over the plane of the triangle. */
static double lower_end(const struct axis *axis, const struct nearest *nearest, vec3 normal)
{
    double height_a = -nearest->pair.s * dot(axis->u, normal);
    double height_b = (1.0 - nearest->pair.s) * dot(axis->u, normal);
    return smaller(height_a, height_b);
}

/*
 * The axis goes through a closed part. How deep, the nearest pair does not tell; until contact regions
 * do, the paper's estimate pushes: the lower end's height over the plane of the triangle.
 */
static struct push through_closed(const struct tree *tree, const struct axis *axis,
                                  const struct nearest *nearest, double radius, dpt_hit *hit)
{
    vec3 normal = face_normal(tree, nearest->triangle);
    double lower = lower_end(axis, nearest, normal) - radius;
    hit->contact = contact_of_gap(lower, hit->error_bound);
    return (struct push){ normal, larger(0.0, -lower) };
}

struct push contact_of(const struct tree *tree, const struct axis *axis,
                       const struct nearest *nearest, double radius, dpt_hit *hit)
{
    const struct push none = { { 0.0, 0.0, 0.0 }, 0.0 };
    uint32_t part = mesh_words(tree->mesh, MESH_PARTS)[nearest->triangle];
    uint32_t flags = mesh_words(tree->mesh, MESH_PART_TABLE)[4 * (size_t)part];
    int closed = (flags & MESH_PART_CLOSED) != 0;
    if (nearest->pair.distance2 == 0.0) {
        if (closed)
            return through_closed(tree, axis, nearest, radius, hit);
        if (flags & MESH_PART_MANIFOLD)
            hit->contact = DPT_CONTACT_UNKNOWN;
        else
            contact_set_gap(hit, -radius, hit->error_bound);
        return none;
    }
    vec3 from_q = unit(nearest->pair.gap);
    double side = 1.0;
    if (closed && dot(feature_normal(tree, nearest->triangle, nearest->pair.weight), from_q) < 0.0)
        side = -1.0;
    contact_set_gap(hit, side * hit->distance - radius, hit->error_bound);
    return (struct push){ scaled(from_q, side), hit->depth };
}

double contact_paper(const struct tree *tree, const struct axis *part,
                     const struct nearest *nearest, double radius, struct push *push)
{
    vec3 normal = face_normal(tree, nearest->triangle);
    double distance = sqrt(nearest->pair.distance2), gap;
    if (distance == 0.0) {
        gap = lower_end(part, nearest, normal) - radius;
        push->direction = normal;
    } else {
        double side = dot(nearest->pair.gap, normal) < 0.0 ? -1.0 : 1.0;
        gap = side * distance - radius;
        push->direction = scaled(nearest->pair.gap, side / distance);
    }
    push->depth = larger(0.0, -gap);
    return gap;
}
