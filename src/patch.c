/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Taking the patch: breadth first from the start, over every edge that meets the shadow widened by the margin. Each
 * triangle that is entered brings one new corner, the one off the edge; corners are not joined, for a strip is long and
 * thin and has few twice. Then the shadow itself is cut out of the patch: a gate is open when its edge meets it.
 */
#include "patch.h"

#include <string.h>

#include "corners.h"

#if defined(__GNUC__)
#define PREFETCH(address) __builtin_prefetch(address)
#else
#define PREFETCH(address) ((void)0)
#endif
#define LINE_WORDS 16 /* of a cache line, mostly */

/* Where a vertex is by the planes of a shadow. */
static inline void measure(const struct shade *shade, double margin, struct patch_vertex *vertex)
{
    double x = vertex->x[0] - shade->a.x, y = vertex->x[1] - shade->a.y;
    double z = vertex->x[2] - shade->a.z;
    uint64_t beyond[SHADE_SLABS];
    for (int k = 0; k < SHADE_SLABS; k++)
        vertex->value[k] =
            x * shade->normal[0][k] + y * shade->normal[1][k] + z * shade->normal[2][k];
    for (int k = 0; k < SHADE_SLABS; k++)
        beyond[k] = (vertex->value[k] < shade->low[k] - margin ? (uint64_t)1 << 2 * k : 0u) |
                    (vertex->value[k] > shade->high[k] + margin ? (uint64_t)2 << 2 * k : 0u);
    vertex->outside = (uint32_t)(beyond[0] | beyond[1] | beyond[2] | beyond[3]);
}

/* The stretch of an edge that is left between the planes, which its ends are on both sides of, is not empty. */
static int edge_is_left(const struct shade *shade, double margin, const struct patch_vertex *a,
                        const struct patch_vertex *b)
{
    double from = 0.0, to = 1.0;
    for (int k = 0; k < SHADE_SLABS; k++) {
        if (!((a->outside | b->outside) >> 2 * k & 3))
            continue;
        double per = 1.0 / (b->value[k] - a->value[k]);
        double low = (shade->low[k] - margin - a->value[k]) * per;
        double high = (shade->high[k] + margin - a->value[k]) * per;
        from = larger(from, smaller(low, high));
        to = smaller(to, larger(low, high));
    }
    return from <= to;
}

static inline int edge_meets(const struct shade *shade, double margin, const struct patch_vertex *a,
                             const struct patch_vertex *b)
{
    uint32_t any = a->outside | b->outside;
    if (a->outside & b->outside)
        return 0;
    /* Outside of one slab alone, to both sides or at one end: a stretch is left. */
    if (!(any & ~3u) || !(any & ~12u) || !a->outside || !b->outside)
        return 1;
    return edge_is_left(shade, margin, a, b);
}

/* The slot of a triangle, or the free one where it would be. */
static struct patch_slot *slot_of(const struct patch *patch, uint32_t place)
{
    uint32_t mask = patch->slot_count - 1;
    for (uint32_t at = ((place >> 3) * 0x9e3779b1u >> 7 << 3) + (place & 7);; at++) {
        struct patch_slot *slot = &patch->slots[at & mask];
        if (!slot->triangle || slot->place == place)
            return slot;
    }
}

static void forget(struct patch *patch)
{
    if (patch->triangle_count > patch->slot_count / 8)
        memset(patch->slots, 0, patch->slot_count * sizeof *patch->slots);
    else
        for (uint32_t i = patch->triangle_count; i-- > 0;)
            slot_of(patch, patch->triangles[i].place)->triangle = 0;
    patch->triangle_count = patch->vertex_count = patch->gate_count = 0;
    patch->full = 0;
    patch->asked = 0;
}

/* The corner off the edge that two vertices of the mesh make; others are corners of the patch already. */
static uint32_t new_vertex(struct patch *patch, uint32_t vertex)
{
    struct patch_vertex *at = &patch->vertices[patch->vertex_count];
    memcpy(at->x, patch->positions + 3 * (size_t)vertex, sizeof at->x);
    measure(&patch->shade, patch->margin, at);
    return patch->vertex_count++;
}

/* Triangles that follow each other lie together: those of a leaf will mostly be asked for. */
static void fetch_leaf(struct patch *patch, uint32_t leaf)
{
    const size_t first = 3 * LANES * (size_t)leaf;
    for (size_t line = 0; line < 3 * LANES; line += LINE_WORDS) {
        PREFETCH(patch->corners + first + line);
        PREFETCH(patch->neighbours + first + line);
    }
    PREFETCH(patch->sources + LANES * (size_t)leaf);
    patch->leaf = leaf;
}

/* The number here of a triangle, which has an edge `known` of the mesh and `vertex` of the patch; or PATCH_BORDER. */
static uint32_t enter(struct patch *patch, uint32_t place, const uint32_t known[2],
                      const uint32_t vertex[2])
{
    struct patch_slot *slot = slot_of(patch, place);
    if (slot->triangle)
        return slot->triangle - 1;
    if (patch->triangle_count == patch->room || patch->vertex_count >= patch->room) {
        patch->full = 1;
        return PATCH_BORDER;
    }
    if (place / LANES != patch->leaf)
        fetch_leaf(patch, place / LANES);
    const uint32_t *corners = patch->corners + 3 * (size_t)place;
    struct patch_triangle *triangle = &patch->triangles[patch->triangle_count];
    triangle->place = place;
    triangle->entry = 3;
    triangle->reached = 1;
    for (uint16_t k = 0; k < 3; k++) {
        if (corners[k] == known[0] || corners[k] == known[1]) {
            triangle->corner[k] = vertex[corners[k] == known[1]];
        } else {
            triangle->corner[k] = new_vertex(patch, corners[k]);
            triangle->entry = known[0] == DPT_NONE ? 3 : k < 2 ? k + 1 : 0;
        }
    }
    *slot = (struct patch_slot){ place, ++patch->triangle_count };
    return patch->triangle_count - 1;
}

static void connect(struct patch *patch, uint32_t from, uint32_t to, const uint32_t vertex[2],
                    uint16_t many)
{
    patch->flags |=
        (to == PATCH_BORDER ? DPT_STRIP_BORDER : 0u) | (many ? DPT_STRIP_NONMANIFOLD : 0u);
    /* Of two triangles, the one that was looked at first has made the gate. */
    if (to < from)
        return;
    if (patch->gate_count == 3 * patch->room) {
        patch->full = 1;
        return;
    }
    patch->gates[patch->gate_count++] =
        (struct gate){ .vertex = { vertex[0], vertex[1] }, .from = from, .to = to, .many = many };
}

/* Over an edge of three triangles or more: to all that have both its ends. */
static void cross_many(struct patch *patch, uint32_t from, const uint32_t known[2],
                       const uint32_t vertex[2])
{
    const uint32_t *first = mesh_words(patch->mesh, MESH_FAN_FIRST);
    const uint32_t *fans = mesh_words(patch->mesh, MESH_FANS);
    int less = first[known[1] + 1] - first[known[1]] < first[known[0] + 1] - first[known[0]];
    uint32_t hub = known[less], other = known[!less];
    for (uint32_t i = first[hub]; i < first[hub + 1] && !patch->full; i++) {
        if (fans[i] == patch->triangles[from].place ||
            !has_corner(patch->corners + 3 * (size_t)fans[i], other))
            continue;
        uint32_t to = enter(patch, fans[i], known, vertex);
        if (to != PATCH_BORDER)
            connect(patch, from, to, vertex, 1);
    }
}

static void cross_edges(struct patch *patch, uint32_t from)
{
    const struct patch_triangle *here = &patch->triangles[from];
    const uint32_t *corners = patch->corners + 3 * (size_t)here->place;
    const uint32_t *next = patch->neighbours + 3 * (size_t)here->place;
    for (int k = 0; k < 3; k++) {
        const int end = k < 2 ? k + 1 : 0;
        const uint32_t known[2] = { corners[k], corners[end] };
        const uint32_t vertex[2] = { here->corner[k], here->corner[end] };
        if (k == here->entry ||
            !edge_meets(&patch->shade, patch->margin, &patch->vertices[vertex[0]],
                        &patch->vertices[vertex[1]]))
            continue;
        if (next[k] == MESH_EDGE_OPEN) {
            connect(patch, from, PATCH_BORDER, vertex, 0);
        } else if (next[k] == MESH_EDGE_MANY) {
            cross_many(patch, from, known, vertex);
        } else {
            uint32_t to = enter(patch, next[k], known, vertex);
            if (to != PATCH_BORDER)
                connect(patch, from, to, vertex, 0);
        }
    }
}

static void take(struct patch *patch, const struct dpt_mesh *mesh, const struct shade *shade,
                 double margin, uint32_t start)
{
    const uint32_t none[2] = { DPT_NONE, DPT_NONE };
    forget(patch);
    patch->mesh = mesh;
    patch->corners = mesh_words(mesh, MESH_TRIANGLES);
    patch->neighbours = mesh_words(mesh, MESH_NEIGHBOURS);
    patch->sources = mesh_words(mesh, MESH_SOURCES);
    patch->positions = mesh_floats(mesh, MESH_VERTICES);
    patch->leaf = DPT_NONE;
    patch->shade = *shade;
    patch->margin = margin;
    patch->flags = 0;
    enter(patch, start, none, none);
    for (uint32_t i = 0; i < patch->triangle_count && !patch->full; i++)
        cross_edges(patch, i);
}

/*
 * How far to reach beyond the shadow: for eight ticks of its motion, as it was since the last patch, but no farther than
 * an edge is long. None where that would not last for two: then little of the patch would be met again.
 */
static double margin_for(const struct patch *patch, const struct shade *shade)
{
    if (!patch->triangle_count || !patch->asked)
        return 0.0;
    const struct patch_triangle *first = &patch->triangles[0];
    vec3 from = vec3_of_float(patch->vertices[first->corner[0]].x);
    vec3 to = vec3_of_float(patch->vertices[first->corner[1]].x);
    double motion = shade_excess(shade, &patch->shade) / patch->asked;
    double edge = length(sub(to, from));
    return 2.0 * motion <= edge ? smaller(edge, larger(8.0 * motion, edge / 64.0)) : 0.0;
}

/* What is left of a triangle between the planes, cut by one after the other, is not nothing. */
static int triangle_meets(const struct shade *shade, const struct patch *patch,
                          const struct patch_triangle *triangle)
{
    double from[2 * SHADE_SLABS + 3][SHADE_SLABS], to[2 * SHADE_SLABS + 3][SHADE_SLABS];
    int count = 3;
    for (int k = 0; k < 3; k++)
        memcpy(from[k], patch->vertices[triangle->corner[k]].value, sizeof from[k]);
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

static int start_meets(const struct patch *patch, const struct shade *shade,
                       const struct patch_triangle *start)
{
    const struct patch_vertex *at = patch->vertices;
    for (int k = 0; k < 3; k++)
        if (edge_meets(shade, 0.0, &at[start->corner[k]], &at[start->corner[k < 2 ? k + 1 : 0]]))
            return 1;
    return triangle_meets(shade, patch, start);
}

/* Open gates lead on from what was reached: outward from where the patch was begun, or inward. 1 when there is more. */
static int flood_outward(struct patch *patch)
{
    int more = 0;
    for (const struct gate *gate = patch->gates; gate < patch->gates + patch->gate_count; gate++) {
        uint16_t from = patch->triangles[gate->from].reached, to = 0;
        if (gate->to != PATCH_BORDER)
            to = patch->triangles[gate->to].reached |= from & gate->open;
        more |= to & gate->open & !from;
    }
    return more;
}

static void flood_inward(struct patch *patch)
{
    for (const struct gate *gate = patch->gates + patch->gate_count; gate-- > patch->gates;)
        if (gate->to != PATCH_BORDER)
            patch->triangles[gate->from].reached |= patch->triangles[gate->to].reached & gate->open;
}

/* Cut a shadow out of the patch. */
static void cut(struct patch *patch, const struct shade *shade, struct patch_triangle *start)
{
    for (uint32_t i = 0; i < patch->vertex_count; i++)
        measure(shade, 0.0, &patch->vertices[i]);
    for (uint32_t i = 0; i < patch->gate_count; i++) {
        struct gate *gate = &patch->gates[i];
        gate->open = (uint16_t)edge_meets(shade, 0.0, &patch->vertices[gate->vertex[0]],
                                          &patch->vertices[gate->vertex[1]]);
    }
    for (uint32_t i = 0; i < patch->triangle_count; i++)
        patch->triangles[i].reached = 0;
    start->reached = (uint16_t)start_meets(patch, shade, start);
    int more = start != patch->triangles;
    do {
        if (more)
            flood_inward(patch);
        more = flood_outward(patch);
    } while (more);
    patch->flags = 0;
    for (uint32_t i = 0; i < patch->gate_count; i++) {
        const struct gate *gate = &patch->gates[i];
        if (gate->open & patch->triangles[gate->from].reached)
            patch->flags |= (gate->to == PATCH_BORDER ? DPT_STRIP_BORDER : 0u) |
                            (gate->many ? DPT_STRIP_NONMANIFOLD : 0u);
    }
}

/* The patch holds all that the shadow can reach from there. */
static int is_held(const struct patch *patch, const struct dpt_mesh *mesh,
                   const struct shade *shade, uint32_t start)
{
    return patch->mesh == mesh && shade_excess(shade, &patch->shade) <= patch->margin &&
           slot_of(patch, start)->triangle;
}

uint32_t patch_walk(struct patch *patch, const struct dpt_mesh *mesh, const struct shade *shade,
                    uint32_t start)
{
    if (!is_held(patch, mesh, shade, start)) {
        double margin = patch->mesh == mesh ? margin_for(patch, shade) : 0.0;
        take(patch, mesh, shade, margin, start);
        if (patch->full && margin > 0.0)
            take(patch, mesh, shade, 0.0, start);
    }
    struct patch_triangle *first = &patch->triangles[slot_of(patch, start)->triangle - 1];
    if (patch->asked++ || patch->margin > 0.0)
        cut(patch, shade, first);
    else
        first->reached = (uint16_t)start_meets(patch, shade, first);
    return patch->flags | (patch->full ? DPT_STRIP_FULL : 0u);
}
