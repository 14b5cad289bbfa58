/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Taking the patch: breadth first from the start, over every edge that meets the shadow widened by the margin. Each
 * triangle that is entered brings one new corner, the one off the edge; corners are not joined, for a strip is long and
 * thin and has few twice. Then the shadow itself is cut out of the patch: a gate is open when its edge meets it.
 */
#include "patch.h"

#include <string.h>

#include "corners.h"

/* Place of x by the planes of a shadow. */
static void measure(const struct shade *shade, double margin, struct patch_vertex *vertex)
{
    double x = vertex->x[0] - shade->a.x, y = vertex->x[1] - shade->a.y;
    double z = vertex->x[2] - shade->a.z;
    uint32_t outside = 0;
    for (int k = 0; k < SHADE_SLABS; k++) {
        const vec3 *n = &shade->normal[k];
        double value = x * n->x + y * n->y + z * n->z;
        vertex->value[k] = value;
        outside |= (uint32_t)(value < shade->low[k] - margin) << 2 * k;
        outside |= (uint32_t)(value > shade->high[k] + margin) << (2 * k + 1);
    }
    vertex->outside = outside;
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

static int edge_meets(const struct shade *shade, double margin, const struct patch_vertex *a,
                      const struct patch_vertex *b)
{
    if (a->outside & b->outside)
        return 0;
    return !a->outside || !b->outside || edge_is_left(shade, margin, a, b);
}

/* The slot of a triangle, or the free one where it would be. */
static uint32_t *slot_of(const struct patch *patch, uint32_t place)
{
    uint32_t mask = patch->slot_count - 1;
    for (uint32_t at = ((place >> 4) * 0x9e3779b1u >> 7 << 4) + (place & 15);; at++) {
        uint32_t *slot = &patch->slots[at & mask];
        if (!*slot || patch->triangles[*slot - 1].place == place)
            return slot;
    }
}

static void forget(struct patch *patch)
{
    if (patch->triangle_count > patch->slot_count / 8)
        memset(patch->slots, 0, patch->slot_count * sizeof *patch->slots);
    else
        for (uint32_t i = patch->triangle_count; i-- > 0;)
            *slot_of(patch, patch->triangles[i].place) = 0;
    patch->triangle_count = patch->vertex_count = patch->gate_count = 0;
    patch->full = 0;
    patch->asked = 0;
}

/* A triangle, of which the corners `known` of the mesh are these two of the patch; its number here, or PATCH_BORDER. */
static uint32_t enter(struct patch *patch, uint32_t place, const uint32_t known[2],
                      const uint32_t vertex[2])
{
    uint32_t *slot = slot_of(patch, place);
    if (*slot)
        return *slot - 1;
    if (patch->triangle_count == patch->room || patch->vertex_count > patch->room - 1) {
        patch->full = 1;
        return PATCH_BORDER;
    }
    const uint32_t *corners = mesh_words(patch->mesh, MESH_TRIANGLES) + 3 * (size_t)place;
    struct patch_triangle *triangle = &patch->triangles[patch->triangle_count];
    triangle->place = place;
    for (int k = 0; k < 3; k++) {
        if (corners[k] == known[0] || corners[k] == known[1]) {
            triangle->corner[k] = vertex[corners[k] == known[1]];
            continue;
        }
        struct patch_vertex *at = &patch->vertices[patch->vertex_count];
        memcpy(at->x, mesh_floats(patch->mesh, MESH_VERTICES) + 3 * (size_t)corners[k],
               sizeof at->x);
        measure(&patch->shade, patch->margin, at);
        triangle->corner[k] = patch->vertex_count++;
    }
    *slot = ++patch->triangle_count;
    return patch->triangle_count - 1;
}

static void connect(struct patch *patch, uint32_t from, uint32_t to, const uint32_t vertex[2],
                    uint16_t many)
{
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
    const uint32_t *corners = mesh_words(patch->mesh, MESH_TRIANGLES);
    int less = first[known[1] + 1] - first[known[1]] < first[known[0] + 1] - first[known[0]];
    uint32_t hub = known[less], other = known[!less];
    for (uint32_t i = first[hub]; i < first[hub + 1] && !patch->full; i++) {
        if (fans[i] == patch->triangles[from].place ||
            !has_corner(corners + 3 * (size_t)fans[i], other))
            continue;
        uint32_t to = enter(patch, fans[i], known, vertex);
        if (to != PATCH_BORDER)
            connect(patch, from, to, vertex, 1);
    }
}

static void cross_edges(struct patch *patch, uint32_t from)
{
    const struct patch_triangle here = patch->triangles[from];
    const uint32_t *corners = mesh_words(patch->mesh, MESH_TRIANGLES) + 3 * (size_t)here.place;
    const uint32_t *next = mesh_words(patch->mesh, MESH_NEIGHBOURS) + 3 * (size_t)here.place;
    for (int k = 0; k < 3; k++) {
        const int end = k < 2 ? k + 1 : 0;
        const uint32_t known[2] = { corners[k], corners[end] };
        const uint32_t vertex[2] = { here.corner[k], here.corner[end] };
        if (!edge_meets(&patch->shade, patch->margin, &patch->vertices[vertex[0]],
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
    const uint32_t none[2] = { UINT32_MAX, UINT32_MAX };
    forget(patch);
    patch->mesh = mesh;
    patch->shade = *shade;
    patch->margin = margin;
    enter(patch, start, none, none);
    for (uint32_t i = 0; i < patch->triangle_count && !patch->full; i++)
        cross_edges(patch, i);
}

/*
 * How far to reach beyond the shadow: for eight more of its motion a tick, as it was since the last patch. None where
 * that is more than an edge is long: then little of the patch would be met again.
 */
static double margin_for(const struct patch *patch, const struct shade *shade)
{
    if (!patch->triangle_count || !patch->asked)
        return 0.0;
    const struct patch_triangle *first = &patch->triangles[0];
    vec3 from = vec3_of_float(patch->vertices[first->corner[0]].x);
    vec3 to = vec3_of_float(patch->vertices[first->corner[1]].x);
    double motion = shade_excess(shade, &patch->shade) / patch->asked;
    double edge = length(sub(to, from)), margin = larger(8.0 * motion, edge / 64.0);
    return margin <= edge ? margin : 0.0;
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

/* An open gate leads from one to the other. 1 when that is new. */
static int pass(struct patch *patch, const struct gate *gate)
{
    if (!gate->open || gate->to == PATCH_BORDER)
        return 0;
    uint32_t *from = &patch->triangles[gate->from].reached;
    uint32_t *to = &patch->triangles[gate->to].reached;
    int is_new = *from != *to;
    *from = *to = *from | *to;
    return is_new;
}

/* Gates lead outward from where the patch was begun: back and forth through their list is mostly enough. */
static void flood(struct patch *patch)
{
    int more = 1;
    while (more) {
        more = 0;
        for (uint32_t i = patch->gate_count; i-- > 0;)
            more |= pass(patch, &patch->gates[i]);
        if (!more && patch->asked > 1)
            break;
        more = 0;
        for (uint32_t i = 0; i < patch->gate_count; i++)
            more |= pass(patch, &patch->gates[i]);
    }
}

/* Cut the shadow out of the patch. */
static uint32_t cut(struct patch *patch, const struct shade *shade, uint32_t start)
{
    uint32_t flags = 0;
    for (uint32_t i = 0; i < patch->vertex_count; i++)
        measure(shade, 0.0, &patch->vertices[i]);
    for (uint32_t i = 0; i < patch->gate_count; i++) {
        struct gate *gate = &patch->gates[i];
        gate->open = (uint16_t)edge_meets(shade, 0.0, &patch->vertices[gate->vertex[0]],
                                          &patch->vertices[gate->vertex[1]]);
    }
    for (uint32_t i = 0; i < patch->triangle_count; i++)
        patch->triangles[i].reached = 0;
    struct patch_triangle *first = &patch->triangles[start];
    first->reached = (uint32_t)start_meets(patch, shade, first);
    flood(patch);
    for (uint32_t i = 0; i < patch->gate_count; i++) {
        const struct gate *gate = &patch->gates[i];
        if (gate->open && patch->triangles[gate->from].reached)
            flags |= (gate->to == PATCH_BORDER ? DPT_STRIP_BORDER : 0u) |
                     (gate->many ? DPT_STRIP_NONMANIFOLD : 0u);
    }
    return flags;
}

uint32_t patch_walk(struct patch *patch, const struct dpt_mesh *mesh, const struct shade *shade,
                    uint32_t start)
{
    if (patch->mesh != mesh || shade_excess(shade, &patch->shade) > patch->margin ||
        !*slot_of(patch, start)) {
        double margin = patch->mesh == mesh ? margin_for(patch, shade) : 0.0;
        take(patch, mesh, shade, margin, start);
        if (patch->full && margin > 0.0)
            take(patch, mesh, shade, 0.0, start);
    }
    patch->asked++;
    uint32_t flags = cut(patch, shade, *slot_of(patch, start) - 1);
    return flags | (patch->full ? DPT_STRIP_FULL : 0u);
}
