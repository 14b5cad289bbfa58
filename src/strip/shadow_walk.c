/* SPDX-License-Identifier: BSD-3-Clause */
#include "strip/shadow_walk.h"

#include <string.h>

#include "mesh/corners.h"

static void put_slab(struct shadow_volume *volume, int slab, vec3 normal, double low, double high)
{
    volume->normal[0][slab] = normal.x;
    volume->normal[1][slab] = normal.y;
    volume->normal[2][slab] = normal.z;
    volume->low[slab] = low;
    volume->high[slab] = high;
}

void dpti_shadow_volume_of(vec3 a, vec3 u, vec3 direction, double half_width, double depth,
                           struct shadow_volume *volume)
{
    vec3 d = unit_of(direction), side = cross(d, u), across[2];
    int is_aslant = length(side) > 1e-9 * length(u);
    unit_across(d, across);
    vec3 w = is_aslant ? unit_of(side) : across[0], e = cross(w, d);
    double ue = dot(u, e), ud = dot(u, d);
    double projected_length = sqrt(ue * ue + ud * ud);
    /* A shadow that is a mere line or plane might be empty by rounding: the slabs get a little slack. */
    double slack = 64.0 * 0x1p-53 * (extent_of(a) + projected_length + half_width + depth);
    *volume =
        (struct shadow_volume){ .a = a, .u = u, .d = d, .e = e, .w = w, .half_width = half_width, .depth = depth };
    put_slab(volume, 0, w, -half_width - slack, half_width + slack);
    put_slab(volume, 1, e, min_of(0.0, ue) - half_width - slack, max_of(0.0, ue) + half_width + slack);
    put_slab(volume, 2, d, min_of(0.0, ud) - depth - slack, max_of(0.0, ud) + depth + slack);
    if (projected_length > 0.0) {
        double ne = ud / projected_length, nd = -ue / projected_length;
        double half_extent = half_width * fabs(ne) + depth * fabs(nd) + slack;
        put_slab(volume, 3, along(scaled(e, ne), nd, d), -half_extent, half_extent);
    }
}

/* ---- the walk ---- */

/*
 * The walk goes breadth first from the start, over every edge that meets the shadow. A triangle that is entered adds
 * one corner, the one opposite to that edge. A corner may be stored several times: a strip is long and thin, so few
 * are.
 */

#define LINE_WORDS 16 /* 32-bit words of a cache line, on most machines */

/*
 * Compute a vertex from its position `at`, in the mesh's frame. The four slabs are one vector: so the bits are as wide
 * as the numbers, and the loop must not be unrolled before the compiler vectorises it.
 */
static inline void measure_vertex(const struct shadow_volume *volume, const float *at, struct shadow_vertex *vertex)
{
    static const uint64_t below[SHADOW_SLABS] = { 1, 4, 16, 64 };
    static const uint64_t above[SHADOW_SLABS] = { 2, 8, 32, 128 };
    double x = at[0] - volume->a.x, y = at[1] - volume->a.y, z = at[2] - volume->a.z;
    uint64_t outside = 0;
#pragma GCC unroll 1
    for (int k = 0; k < SHADOW_SLABS; k++) {
        double value = x * volume->normal[0][k] + y * volume->normal[1][k] + z * volume->normal[2][k];
        vertex->value[k] = value;
        outside |= (value < volume->low[k] ? below[k] : 0) | (value > volume->high[k] ? above[k] : 0);
    }
    vertex->outside = (uint32_t)outside;
}

/* 1: a part of the edge lies between all planes that separate its ends. */
static int edge_has_part_inside(const struct shadow_volume *volume, const struct shadow_vertex *a,
                                const struct shadow_vertex *b)
{
    double from = 0.0, to = 1.0;
    for (int k = 0; k < SHADOW_SLABS; k++) {
        if (!((a->outside | b->outside) >> 2 * k & 3))
            continue;
        double inverse = 1.0 / (b->value[k] - a->value[k]);
        double low = (volume->low[k] - a->value[k]) * inverse;
        double high = (volume->high[k] - a->value[k]) * inverse;
        from = max_of(from, min_of(low, high));
        to = min_of(to, max_of(low, high));
    }
    return from <= to;
}

/* 1: the edge between two vertices has a point within the shadow. */
static inline int edge_meets(const struct shadow_volume *volume, const struct shadow_vertex *a,
                             const struct shadow_vertex *b)
{
    uint32_t any = a->outside | b->outside;
    if (a->outside & b->outside)
        return 0;
    /* One end is inside, or the ends are on opposite sides of the first or second slab alone: a part is inside. */
    if (!(any & ~3u) || !(any & ~12u) || !a->outside || !b->outside)
        return 1;
    return edge_has_part_inside(volume, a, b);
}

/* The slot of a triangle, a place, or the free one where it would go. */
static inline struct shadow_slot *slot_of(const struct shadow_walk *walk, uint32_t place)
{
    uint32_t mask = walk->slot_count - 1;
    for (uint32_t at = ((place >> 3) * 0x9e3779b1u >> 7 << 3) + (place & 7);; at++) {
        struct shadow_slot *slot = &walk->slots[at & mask];
        if (slot->stamp != walk->stamp || slot->place == place)
            return slot;
    }
}

/* Empty the walk. */
static void begin_walk(struct shadow_walk *walk)
{
    if (!++walk->stamp) {
        memset(walk->slots, 0, walk->slot_count * sizeof *walk->slots);
        walk->stamp = 1;
    }
    walk->triangle_count = walk->vertex_count = 0;
    walk->flags = 0;
    walk->prefetched_leaf = DPT_NONE;
}

/* Prefetch the triangles of a leaf: they lie close together on the surface, so the walk will need most of them. */
static void prefetch_leaf(struct shadow_walk *walk, uint32_t leaf)
{
    const size_t first = 3 * LANES * (size_t)leaf;
    for (size_t line = 0; line < 3 * LANES; line += LINE_WORDS) {
        __builtin_prefetch(walk->corners + first + line);
        __builtin_prefetch(walk->neighbours + first + line);
    }
    __builtin_prefetch(walk->sources + LANES * (size_t)leaf);
    walk->prefetched_leaf = leaf;
}

/*
 * Add a vertex of the mesh and return its index in the walk. Each triangle adds one, the first one three. In a forged
 * mesh, whose neighbours may not touch, there could be more: the last one is overwritten then.
 */
static inline uint32_t add_vertex(struct shadow_walk *walk, uint32_t number)
{
    uint32_t index = walk->vertex_count;
    if (index < walk->capacity + 2)
        walk->vertex_count++;
    else
        index--;
    struct shadow_vertex *vertex = &walk->vertices[index];
    vertex->number = number;
    measure_vertex(&walk->volume, walk->positions + 3 * (size_t)number, vertex);
    return index;
}

static const uint32_t AFTER[3] = { 1, 2, 0 };

/*
 * Add a triangle, a place, over its edge between two vertices of the walk. The apex and the direction of the edge are
 * computed without branches, since no branch could be predicted.
 */
static inline void enter_triangle(struct shadow_walk *walk, uint32_t place, uint32_t from, uint32_t to)
{
    struct shadow_slot *slot = slot_of(walk, place);
    if (slot->stamp == walk->stamp)
        return;
    if (walk->triangle_count == walk->capacity) {
        walk->flags |= DPT_STRIP_FLAG_FULL;
        return;
    }
    if (place / LANES != walk->prefetched_leaf)
        prefetch_leaf(walk, place / LANES);
    *slot = (struct shadow_slot){ place, walk->stamp };
    const uint32_t *corners = walk->corners + 3 * (size_t)place;
    const uint32_t a = walk->vertices[from].number, b = walk->vertices[to].number;
    const uint32_t is_1 = (corners[1] != a) & (corners[1] != b);
    const uint32_t is_2 = (corners[2] != a) & (corners[2] != b) & !is_1;
    const uint32_t apex = is_1 + 2 * is_2;
    const uint32_t is_reversed = corners[AFTER[apex]] != a;
    struct shadow_triangle *triangle = &walk->triangles[walk->triangle_count++];
    *triangle = (struct shadow_triangle){
        place, apex, { add_vertex(walk, corners[apex]), is_reversed ? to : from, is_reversed ? from : to }
    };
}

/* Cross an edge of three triangles or more, to all triangles that have both its ends. */
static void cross_many(struct shadow_walk *walk, uint32_t from, uint32_t to)
{
    const uint32_t *first = mesh_words(walk->mesh, MESH_FAN_FIRST);
    const uint32_t *fans = mesh_words(walk->mesh, MESH_FANS);
    const uint32_t ends[2] = { walk->vertices[from].number, walk->vertices[to].number };
    int is_second_smaller = first[ends[1] + 1] - first[ends[1]] < first[ends[0] + 1] - first[ends[0]];
    uint32_t hub = ends[is_second_smaller], other = ends[!is_second_smaller];
    walk->flags |= DPT_STRIP_FLAG_NONMANIFOLD;
    for (uint32_t i = first[hub]; i < first[hub + 1]; i++)
        if (has_corner(walk->corners + 3 * (size_t)fans[i], other))
            enter_triangle(walk, fans[i], from, to);
}

/*
 * Cross an edge of a triangle if it meets the shadow. Returns 1 if it does.
 *
 *   edge    0..2, counted from the apex
 *   corner  of the mesh's triangle, 0..2, at which this edge begins
 */
static inline int cross_edge(struct shadow_walk *walk, const struct shadow_triangle *here, uint32_t edge,
                             uint32_t corner)
{
    const uint32_t from = here->corner[edge], to = here->corner[AFTER[edge]];
    if (!edge_meets(&walk->volume, &walk->vertices[from], &walk->vertices[to]))
        return 0;
    const uint32_t next = walk->neighbours[3 * (size_t)here->place + corner];
    if (next == MESH_EDGE_OPEN)
        walk->flags |= DPT_STRIP_FLAG_BORDER;
    else if (next == MESH_EDGE_MANY)
        cross_many(walk, from, to);
    else
        enter_triangle(walk, next, from, to);
    return 1;
}

/* Add the first triangle, a place, and cross all of its edges. Returns 1 if one of them meets the shadow. */
static int enter_first(struct shadow_walk *walk, uint32_t start)
{
    const uint32_t *corners = walk->corners + 3 * (size_t)start;
    *slot_of(walk, start) = (struct shadow_slot){ start, walk->stamp };
    struct shadow_triangle first = { .place = start };
    for (uint32_t k = 0; k < 3; k++)
        first.corner[k] = add_vertex(walk, corners[k]);
    walk->triangles[walk->triangle_count++] = first;
    int meets_any = 0;
    for (uint32_t k = 0; k < 3; k++)
        meets_any |= cross_edge(walk, &first, k, k);
    return meets_any;
}

/* 1: the first triangle meets the shadow. It is cut by one plane after the other, and something is left. */
static int first_triangle_meets(const struct shadow_walk *walk)
{
    const struct shadow_volume *volume = &walk->volume;
    double from[2 * SHADOW_SLABS + 3][SHADOW_SLABS], to[2 * SHADOW_SLABS + 3][SHADOW_SLABS];
    int count = 3;
    for (int k = 0; k < 3; k++)
        memcpy(from[k], walk->vertices[k].value, sizeof from[k]);
    for (int cut = 0; cut < 2 * SHADOW_SLABS && count; cut++) {
        int k = cut / 2, kept_count = 0;
        double sign = cut % 2 ? -1.0 : 1.0;
        double limit = cut % 2 ? -volume->high[k] : volume->low[k];
        for (int i = 0; i < count; i++) {
            const double *a = from[i], *b = from[i + 1 < count ? i + 1 : 0];
            double beyond_a = sign * a[k] - limit, beyond_b = sign * b[k] - limit;
            if (beyond_a >= 0.0)
                memcpy(to[kept_count++], a, sizeof to[0]);
            if ((beyond_a >= 0.0) != (beyond_b >= 0.0)) {
                double t = beyond_a / (beyond_a - beyond_b);
                for (int c = 0; c < SHADOW_SLABS; c++)
                    to[kept_count][c] = a[c] + t * (b[c] - a[c]);
                to[kept_count++][k] = sign * limit;
            }
        }
        memcpy(from, to, sizeof from);
        count = kept_count;
    }
    return count > 0;
}

void dpti_shadow_walk(struct shadow_walk *walk, const struct surface *surface, const struct shadow_volume *volume,
                      uint32_t start)
{
    const struct dpt_mesh *mesh = surface->mesh;
    if (walk->mesh == mesh && walk->crc32 == mesh->header_crc32 && walk->positions == surface->positions &&
        walk->start == start && !memcmp(&walk->volume, volume, sizeof *volume))
        return;
    begin_walk(walk);
    walk->mesh = mesh;
    walk->crc32 = mesh->header_crc32;
    walk->start = start;
    walk->volume = *volume;
    walk->corners = surface->corners;
    walk->neighbours = surface_neighbours(surface);
    walk->sources = surface->sources;
    walk->positions = surface->positions;
    if (!enter_first(walk, start) && !first_triangle_meets(walk)) {
        begin_walk(walk);
        return;
    }
    for (uint32_t i = 1; i < walk->triangle_count; i++) {
        const struct shadow_triangle here = walk->triangles[i];
        cross_edge(walk, &here, 0, here.apex);
        cross_edge(walk, &here, 2, AFTER[AFTER[here.apex]]);
    }
}
