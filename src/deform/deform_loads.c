/* SPDX-License-Identifier: BSD-3-Clause */
#include "deform/deform_loads.h"

#include "nearest/nearest_pair.h"

/* Passes that make the sums exact: the second one removes what rounding left. */
enum { BALANCE_PASSES = 3 };

/* Vertices lie on a line if the determinant of their moments is below this share of the trace cubed. */
#define FLAT 1e-12

/* Where in the table a vertex is, or may be. The factor, of the golden ratio, scatters neighbours' numbers. */
static uint32_t slot_of(const struct load_patch *patch, uint32_t vertex)
{
    uint32_t slot = (vertex * 2654435769u) >> (32 - LOAD_TABLE_BITS);
    while (patch->known[slot] && patch->known[slot] != vertex + 1)
        slot = (slot + 1) % LOAD_TABLE;
    return slot;
}

/* A third of the area of the triangles at a vertex. */
static double area_of(const struct surface *surface, uint32_t vertex)
{
    const uint32_t *first, *fans = surface_fans(surface, &first);
    double sum = 0.0;
    for (uint32_t i = first[vertex]; i < first[vertex + 1]; i++) {
        vec3 v[3];
        surface_corners(surface, fans[i], v);
        sum += length(cross(sub(v[1], v[0]), sub(v[2], v[0]))) / 6.0;
    }
    return sum;
}

/* A vertex is met a dozen times, once for each corner of the triangles at it. */
static void add_if_near(const struct surface *surface, const struct load_point *point, double radius, uint32_t vertex,
                        struct load_patch *patch)
{
    if (patch->count == LOAD_PATCH_MAX)
        return;
    const uint32_t slot = slot_of(patch, vertex);
    if (patch->known[slot])
        return;
    const vec3 away = sub(surface_vertex(surface, vertex), point->at);
    const double ratio = dot(away, away) / (radius * radius);
    const int is_near = ratio < 1.0;
    if (is_near || patch->far_count++ < LOAD_FAR)
        patch->known[slot] = vertex + 1;
    if (!is_near)
        return;
    patch->vertex[patch->count] = vertex;
    patch->share[patch->count++] = (1.0 - ratio) * (1.0 - ratio) * area_of(surface, vertex);
}

/* From the point's triangle over the triangles round each vertex that is near enough. */
static void gather_patch(const struct surface *surface, const struct load_point *point, double radius,
                         struct load_patch *patch)
{
    const uint32_t *first, *fans = surface_fans(surface, &first);
    memset(patch->known, 0, sizeof patch->known);
    patch->far_count = 0;
    for (uint32_t k = 0; k < 3; k++)
        add_if_near(surface, point, radius, surface_corner(surface, point->triangle, k), patch);
    for (uint32_t i = 0; i < patch->count; i++) {
        const uint32_t here = patch->vertex[i];
        for (uint32_t f = first[here]; f < first[here + 1]; f++)
            for (uint32_t k = 0; k < 3; k++)
                add_if_near(surface, point, radius, surface_corner(surface, fans[f], k), patch);
    }
}

/* The corners alone, as the point lies between them. */
static void take_corners(const struct surface *surface, const struct load_point *point, struct load_patch *patch)
{
    pair nearest;
    dpti_triangle_point_pair(surface, point->triangle, point->at, &nearest);
    patch->count = 3;
    for (uint32_t k = 0; k < 3; k++) {
        patch->vertex[k] = surface_corner(surface, point->triangle, k);
        patch->share[k] = nearest.weight[k];
    }
}

/*
 * Make shares linear across the point's normal, so that their mean lies on the line along it. Returns 0 where vertices lie on
 * a line, as they are seen along the normal.
 */
static int level_shares(const struct surface *surface, const struct load_point *point, struct load_patch *patch)
{
    vec3 across[2], middle = { 0.0, 0.0, 0.0 };
    double uu = 0.0, uv = 0.0, vv = 0.0;
    unit_across(point->normal, across);
    for (uint32_t i = 0; i < patch->count; i++)
        middle = along(middle, patch->share[i], surface_vertex(surface, patch->vertex[i]));
    for (uint32_t i = 0; i < patch->count; i++) {
        const vec3 r = sub(surface_vertex(surface, patch->vertex[i]), middle);
        const double u = dot(r, across[0]), v = dot(r, across[1]);
        uu += patch->share[i] * u * u;
        uv += patch->share[i] * u * v;
        vv += patch->share[i] * v * v;
    }
    const double determinant = uu * vv - uv * uv;
    if (!(determinant > FLAT * (uu + vv) * (uu + vv)))
        return 0;
    const vec3 missing = sub(point->at, middle);
    const double u = dot(missing, across[0]) / determinant, v = dot(missing, across[1]) / determinant;
    const vec3 slope = along(scaled(across[0], vv * u - uv * v), uu * v - uv * u, across[1]);
    for (uint32_t i = 0; i < patch->count; i++)
        patch->share[i] *= 1.0 + dot(slope, sub(surface_vertex(surface, patch->vertex[i]), middle));
    return 1;
}

void dpti_deform_patch(const struct surface *surface, const struct load_point *point, double radius,
                       struct load_patch *patch)
{
    double sum = 0.0;
    patch->count = 0;
    if (radius > 0.0)
        gather_patch(surface, point, radius, patch);
    for (uint32_t i = 0; i < patch->count; i++)
        sum += patch->share[i];
    if (patch->count < 3 || !(sum > 0.0)) {
        take_corners(surface, point, patch);
        return;
    }
    for (uint32_t i = 0; i < patch->count; i++)
        patch->share[i] /= sum;
    if (dot(point->normal, point->normal) > 0.0 && !level_shares(surface, point, patch))
        take_corners(surface, point, patch);
}

/* The loads of one tool. While they are made, `reserved` of each holds how much it may change, as a float. */
struct spread {
    const struct surface *surface;
    dpt_load *loads;
    uint32_t count;
    vec3 centre;     /* of the vertices, weighted */
    double weight;   /* their sum */
    double about[6]; /* xx, yy, zz, xy, xz, yz: sum of weight ((r.r) 1 - r r) about the centre */
};

static double weight_of(const dpt_load *load)
{
    float weight;
    memcpy(&weight, &load->reserved, sizeof weight);
    return (double)weight;
}

/* A point at a corner or an edge is held by few vertices, which cannot take any moment: the others help a little. */
#define SHARE_MIN 0.05

static void put_load(dpt_load *load, uint32_t vertex, double share, vec3 force)
{
    const float weight = (float)((share + SHARE_MIN) * length(force));
    load->vertex = vertex;
    memcpy(&load->reserved, &weight, sizeof weight);
    vec3_store(scaled(force, share), load->force);
}

static vec3 place_of(const struct spread *spread, uint32_t i)
{
    return surface_vertex(spread->surface, spread->loads[i].vertex);
}

static void measure(struct spread *spread)
{
    vec3 sum = { 0.0, 0.0, 0.0 };
    spread->weight = 0.0;
    memset(spread->about, 0, sizeof spread->about);
    for (uint32_t i = 0; i < spread->count; i++) {
        sum = along(sum, weight_of(&spread->loads[i]), place_of(spread, i));
        spread->weight += weight_of(&spread->loads[i]);
    }
    spread->centre = scaled(sum, 1.0 / spread->weight);
    for (uint32_t i = 0; i < spread->count; i++) {
        const vec3 r = sub(place_of(spread, i), spread->centre);
        const double w = weight_of(&spread->loads[i]);
        spread->about[0] += w * (r.y * r.y + r.z * r.z);
        spread->about[1] += w * (r.x * r.x + r.z * r.z);
        spread->about[2] += w * (r.x * r.x + r.y * r.y);
        spread->about[3] -= w * r.x * r.y;
        spread->about[4] -= w * r.x * r.z;
        spread->about[5] -= w * r.y * r.z;
    }
}

/* The turn that gives a torque about the centre; zero where the vertices lie on a line. */
static vec3 turn_for(const double m[6], vec3 torque)
{
    const double xx = m[1] * m[2] - m[5] * m[5], xy = m[4] * m[5] - m[3] * m[2];
    const double xz = m[3] * m[5] - m[4] * m[1], yy = m[0] * m[2] - m[4] * m[4];
    const double yz = m[3] * m[4] - m[0] * m[5], zz = m[0] * m[1] - m[3] * m[3];
    const double determinant = m[0] * xx + m[3] * xy + m[4] * xz, trace = m[0] + m[1] + m[2];
    if (!(determinant > FLAT * trace * trace * trace))
        return (vec3){ 0.0, 0.0, 0.0 };
    return scaled((vec3){ xx * torque.x + xy * torque.y + xz * torque.z, xy * torque.x + yy * torque.y + yz * torque.z,
                          xz * torque.x + yz * torque.y + zz * torque.z },
                  1.0 / determinant);
}

/* Change the loads by the least, as they are weighted, so that they sum up to a wrench about the origin. */
static void balance(const struct spread *spread, const dpt_wrench *whole)
{
    vec3 force = vec3_of(whole->force), torque = vec3_of(whole->torque);
    for (uint32_t i = 0; i < spread->count; i++) {
        const vec3 load = vec3_of(spread->loads[i].force);
        force = sub(force, load);
        torque = sub(torque, cross(place_of(spread, i), load));
    }
    const vec3 shift = scaled(force, 1.0 / spread->weight);
    const vec3 turn = turn_for(spread->about, sub(torque, cross(spread->centre, force)));
    for (uint32_t i = 0; i < spread->count; i++) {
        dpt_load *load = &spread->loads[i];
        const vec3 r = sub(place_of(spread, i), spread->centre);
        vec3_store(along(vec3_of(load->force), weight_of(load), add(shift, cross(turn, r))), load->force);
    }
}

uint32_t dpti_deform_spread(const struct surface *surface, const struct load_point *points, uint32_t point_count,
                            double radius, const dpt_wrench *whole, dpt_load *loads, uint32_t capacity)
{
    struct spread spread = { .surface = surface, .loads = loads };
    struct load_patch patch;
    for (uint32_t p = 0; p < point_count; p++) {
        dpti_deform_patch(surface, &points[p], points[p].is_narrow ? 0.0 : radius, &patch);
        for (uint32_t i = 0; i < patch.count; i++, spread.count++)
            if (spread.count < capacity)
                put_load(&loads[spread.count], patch.vertex[i], patch.share[i], points[p].force);
    }
    if (spread.count > capacity || !spread.count)
        return spread.count;
    measure(&spread);
    for (int pass = 0; pass < BALANCE_PASSES && spread.weight > 0.0; pass++)
        balance(&spread, whole);
    for (uint32_t i = 0; i < spread.count; i++)
        loads[i].reserved = 0;
    return spread.count;
}
