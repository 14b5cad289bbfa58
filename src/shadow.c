/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Breadth first from the start, over every edge that meets the shadow. A triangle that is entered brings one corner, the
 * one off that edge; corners are not joined, for a strip is long and thin and has few twice.
 */
#include "shadow.h"

#include <string.h>

#include "corners.h"

#if defined(__GNUC__)
#define PREFETCH(address) __builtin_prefetch(address)
#else
#define PREFETCH(address) ((void)0)
#endif
#define LINE_WORDS 16 /* of a cache line, mostly */

static void measure(const struct shade *shade, const float *at, struct shadow_vertex *vertex)
{
    double x = at[0] - shade->a.x, y = at[1] - shade->a.y, z = at[2] - shade->a.z;
    uint32_t outside = 0;
    for (int k = 0; k < SHADE_SLABS; k++) {
        double value = x * shade->normal[0][k] + y * shade->normal[1][k] + z * shade->normal[2][k];
        vertex->value[k] = value;
        outside |= (uint32_t)(value < shade->low[k]) << 2 * k;
        outside |= (uint32_t)(value > shade->high[k]) << (2 * k + 1);
    }
    vertex->outside = outside;
}

/* The stretch of an edge that is left between the planes, which its ends are on both sides of, is not empty. */
static int edge_is_left(const struct shade *shade, const struct shadow_vertex *a,
                        const struct shadow_vertex *b)
{
    double from = 0.0, to = 1.0;
    for (int k = 0; k < SHADE_SLABS; k++) {
        if (!((a->outside | b->outside) >> 2 * k & 3))
            continue;
        double per = 1.0 / (b->value[k] - a->value[k]);
        double low = (shade->low[k] - a->value[k]) * per;
        double high = (shade->high[k] - a->value[k]) * per;
        from = larger(from, smaller(low, high));
        to = smaller(to, larger(low, high));
    }
    return from <= to;
}

static inline int edge_meets(const struct shade *shade, const struct shadow_vertex *a,
                             const struct shadow_vertex *b)
{
    uint32_t any = a->outside | b->outside;
    if (a->outside & b->outside)
        return 0;
    /* Outside of one slab alone, to both sides or at one end: a stretch is left. */
    if (!(any & ~3u) || !(any & ~12u) || !a->outside || !b->outside)
        return 1;
    return edge_is_left(shade, a, b);
}

/* The slot of a triangle, or the free one where it would be. */
static struct shadow_slot *slot_of(const struct shadow_walk *walk, uint32_t place)
{
    uint32_t mask = walk->slot_count - 1;
    for (uint32_t at = ((place >> 3) * 0x9e3779b1u >> 7 << 3) + (place & 7);; at++) {
        struct shadow_slot *slot = &walk->slots[at & mask];
        if (!slot->used || slot->place == place)
            return slot;
    }
}

/* From the last one back, so that each is found where it was put. */
static void forget(struct shadow_walk *walk)
{
    if (walk->triangle_count > walk->slot_count / 8)
        memset(walk->slots, 0, walk->slot_count * sizeof *walk->slots);
    else
        while (walk->triangle_count > 0)
            slot_of(walk, walk->triangles[--walk->triangle_count].place)->used = 0;
    walk->triangle_count = walk->vertex_count = 0;
    walk->flags = 0;
    walk->leaf = DPT_NONE;
}

/* Triangles that follow each other lie together: those of a leaf will mostly be asked for. */
static void fetch_leaf(struct shadow_walk *walk, uint32_t leaf)
{
    const size_t first = 3 * LANES * (size_t)leaf;
    for (size_t line = 0; line < 3 * LANES; line += LINE_WORDS) {
        PREFETCH(walk->corners + first + line);
        PREFETCH(walk->neighbours + first + line);
    }
    PREFETCH(walk->sources + LANES * (size_t)leaf);
    walk->leaf = leaf;
}

/* Each triangle has one and the first has three; in a forged mesh, where they may not touch, the last is overwritten. */
static uint32_t new_vertex(struct shadow_walk *walk, uint32_t vertex)
{
    uint32_t made = walk->vertex_count;
    if (made < walk->room + 2)
        walk->vertex_count++;
    else
        made--;
    measure(&walk->shade, walk->positions + 3 * (size_t)vertex, &walk->vertices[made]);
    return made;
}

/* A triangle with an edge `known` of the mesh, which is `vertex` of the walk. */
static void enter(struct shadow_walk *walk, uint32_t place, const uint32_t known[2],
                  const uint32_t vertex[2])
{
    struct shadow_slot *slot = slot_of(walk, place);
    if (slot->used)
        return;
    if (walk->triangle_count == walk->room) {
        walk->flags |= DPT_STRIP_FULL;
        return;
    }
    if (place / LANES != walk->leaf)
        fetch_leaf(walk, place / LANES);
    const uint32_t *corners = walk->corners + 3 * (size_t)place;
    struct shadow_triangle *triangle = &walk->triangles[walk->triangle_count++];
    *slot = (struct shadow_slot){ place, 1 };
    triangle->place = place;
    triangle->entry = 3;
    for (uint32_t k = 0; k < 3; k++) {
        if (corners[k] == known[0] || corners[k] == known[1]) {
            triangle->corner[k] = vertex[corners[k] == known[1]];
        } else {
            triangle->corner[k] = new_vertex(walk, corners[k]);
            triangle->entry = k < 2 ? k + 1 : 0;
        }
    }
}

/* Over an edge of three triangles or more: to all that have both its ends. */
static void cross_many(struct shadow_walk *walk, const uint32_t known[2], const uint32_t vertex[2])
{
    const uint32_t *first = mesh_words(walk->mesh, MESH_FAN_FIRST);
    const uint32_t *fans = mesh_words(walk->mesh, MESH_FANS);
    int less = first[known[1] + 1] - first[known[1]] < first[known[0] + 1] - first[known[0]];
    uint32_t hub = known[less], other = known[!less];
    walk->flags |= DPT_STRIP_NONMANIFOLD;
    for (uint32_t i = first[hub]; i < first[hub + 1]; i++)
        if (has_corner(walk->corners + 3 * (size_t)fans[i], other))
            enter(walk, fans[i], known, vertex);
}

/* On from a triangle; 1 if one of its edges meets the shadow. */
static int cross_edges(struct shadow_walk *walk, uint32_t from)
{
    const struct shadow_triangle here = walk->triangles[from];
    const uint32_t *corners = walk->corners + 3 * (size_t)here.place;
    const uint32_t *next = walk->neighbours + 3 * (size_t)here.place;
    int any = 0;
    for (uint32_t k = 0; k < 3; k++) {
        const uint32_t end = k < 2 ? k + 1 : 0;
        const uint32_t known[2] = { corners[k], corners[end] };
        const uint32_t vertex[2] = { here.corner[k], here.corner[end] };
        if (k == here.entry ||
            !edge_meets(&walk->shade, &walk->vertices[vertex[0]], &walk->vertices[vertex[1]]))
            continue;
        any = 1;
        if (next[k] == MESH_EDGE_OPEN)
            walk->flags |= DPT_STRIP_BORDER;
        else if (next[k] == MESH_EDGE_MANY)
            cross_many(walk, known, vertex);
        else
            enter(walk, next[k], known, vertex);
    }
    return any;
}

/* What is left of the first triangle between the planes, cut by one after the other, is not nothing. */
static int first_meets(const struct shadow_walk *walk)
{
    const struct shade *shade = &walk->shade;
    double from[2 * SHADE_SLABS + 3][SHADE_SLABS], to[2 * SHADE_SLABS + 3][SHADE_SLABS];
    int count = 3;
    for (int k = 0; k < 3; k++)
        memcpy(from[k], walk->vertices[k].value, sizeof from[k]);
    for (int cut = 0; cut < 2 * SHADE_SLABS && count; cut++) {
        int k = cut / 2, left = 0;
        double sign = cut % 2 ? -1.0 : 1.0;
        double limit = cut % 2 ? -shade->high[k] : shade->low[k];
        for (int i = 0; i < count; i++) {
            const double *a = from[i], *b = from[i + 1 < count ? i + 1 : 0];
            double beyond_a = sign * a[k] - limit, beyond_b = sign * b[k] - limit;
            if (beyond_a >= 0.0)
                memcpy(to[left++], a, sizeof to[0]);
            if ((beyond_a >= 0.0) != (beyond_b >= 0.0)) {
                double t = beyond_a / (beyond_a - beyond_b);
                for (int c = 0; c < SHADE_SLABS; c++)
                    to[left][c] = a[c] + t * (b[c] - a[c]);
                to[left++][k] = sign * limit;
            }
        }
        memcpy(from, to, sizeof from);
        count = left;
    }
    return count > 0;
}

void shadow_walk(struct shadow_walk *walk, const struct dpt_mesh *mesh, const struct shade *shade,
                 uint32_t start)
{
    const uint32_t none[2] = { DPT_NONE, DPT_NONE };
    if (walk->mesh == mesh && walk->crc32 == mesh->header_crc32 && walk->start == start &&
        !memcmp(&walk->shade, shade, sizeof *shade))
        return;
    forget(walk);
    walk->mesh = mesh;
    walk->crc32 = mesh->header_crc32;
    walk->start = start;
    walk->shade = *shade;
    walk->corners = mesh_words(mesh, MESH_TRIANGLES);
    walk->neighbours = mesh_words(mesh, MESH_NEIGHBOURS);
    walk->sources = mesh_words(mesh, MESH_SOURCES);
    walk->positions = mesh_floats(mesh, MESH_VERTICES);
    enter(walk, start, none, none);
    walk->triangles[0].entry = 3;
    if (!cross_edges(walk, 0) && !first_meets(walk)) {
        forget(walk);
        return;
    }
    for (uint32_t i = 1; i < walk->triangle_count; i++)
        cross_edges(walk, i);
}
