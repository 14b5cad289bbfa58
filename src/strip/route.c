/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Triangles t and w that share no vertex are 1 + d steps apart if the nearest of their vertices are d edges apart. So
 * the search goes over vertices: there are half as many, with half as many neighbours, and each fan is read once. It
 * starts from both triangles and adds a whole ring of vertices at a time, on the side whose ring is cheaper, until an
 * edge leads from one side to the other. Then the start's vertices on a shortest path are marked, backwards from where
 * the sides met. The route is chosen triangle by triangle among the fans of marked vertices. Triangles are places
 * here.
 */
#include "strip/route.h"

#include <string.h>

#include "base/return_if_error.h"
#include "mesh/corners.h"

enum {
    ROUTE_GOAL = 1,     /* reached from the goal */
    ROUTE_SHORTEST = 2, /* reached from the start, and on a shortest path */
    ROUTE_STEP = 4
};

struct route_finder {
    struct route_search *search;
    const uint32_t *corners, *fan_first, *fans, *sources;
    /* Of the start's side and of the goal's: edges to the outermost ring, and where that ring begins in the queue. */
    uint32_t ring[2];
    uint32_t ring_begin[2];
    uint32_t corners_per_triangle; /* to read for a vertex' neighbours: 1 or 2 */
    uint32_t edge_count;           /* edges between the two triangles, once known */
};

static const uint32_t *corners_of(const struct route_finder *f, uint32_t triangle)
{
    return f->corners + 3 * (size_t)triangle;
}

/*
 * The slot of a vertex, or the free one where it would go. Eight consecutive vertices lie in one cache line; mostly
 * they are close to each other on the surface.
 */
static struct visited_vertex *slot_of(const struct route_search *search, uint32_t vertex)
{
    uint32_t mask = search->slot_count - 1;
    uint32_t at = ((vertex >> 3) * 0x9e3779b1u >> 7 << 3) + (vertex & 7);
    while (search->slots[at & mask].vertex_plus_1 && search->slots[at & mask].vertex_plus_1 != vertex + 1)
        at++;
    return &search->slots[at & mask];
}

/* The slot that a side queued: the start's side (0) fills the queue from the front, the goal's (1) from the back. */
static struct visited_vertex *queued(const struct route_search *search, int side, uint32_t index)
{
    return &search->slots[search->queue[side ? search->queue_capacity - 1 - index : index]];
}

static void clear_search(struct route_search *search)
{
    for (int side = 0; side < 2; side++) {
        for (uint32_t i = 0; i < search->queued_count[side]; i++)
            *queued(search, side, i) = (struct visited_vertex){ 0, 0 };
        search->queued_count[side] = 0;
    }
}

/* Store a vertex in its free slot and queue it. */
static dpt_result put_vertex(struct route_search *search, struct visited_vertex *slot, uint32_t vertex, int side,
                             uint32_t mark)
{
    if (search->queued_count[0] + search->queued_count[1] == search->queue_capacity)
        return DPT_E_FULL;
    uint32_t index = search->queued_count[side]++;
    *slot = (struct visited_vertex){ vertex + 1, mark };
    search->queue[side ? search->queue_capacity - 1 - index : index] = (uint32_t)(slot - search->slots);
    return DPT_OK;
}

/* Queue a side's first ring: the corners of its triangle. */
static dpt_result begin_ring(const struct route_finder *f, int side, uint32_t triangle)
{
    for (int k = 0; k < 3; k++) {
        uint32_t vertex = corners_of(f, triangle)[k];
        DPT_TRY(put_vertex(f->search, slot_of(f->search, vertex), vertex, side, side ? ROUTE_GOAL : 0));
    }
    return DPT_OK;
}

/*
 * For every vertex `next` that has an edge with vertex `at`, at least once. In a triangle of its fan that is the corner
 * after `at`. The corner before `at` follows it in the neighbouring triangle if all parts are closed; otherwise both
 * corners are read.
 */
#define FOR_NEXT_TO(f, at, next)                                                                                       \
    for (uint32_t fan_ = (f)->fan_first[at]; fan_ < (f)->fan_first[(at) + 1]; fan_++)                                  \
        for (uint32_t k_ = 1, next; k_ <= (f)->corners_per_triangle; k_++)                                             \
            if (((next) = corner_after(corners_of(f, (f)->fans[fan_]), at, k_)), 1)

/* The vertex `places` corners, 1 or 2, after another one in a triangle. */
static uint32_t corner_after(const uint32_t *corners, uint32_t vertex, uint32_t places)
{
    uint32_t k = places + (corners[1] == vertex) + 2 * (uint32_t)(corners[2] == vertex);
    return corners[k < 3 ? k : k - 3];
}

/*
 * Add the neighbours of a vertex of the ring to the next ring. Where an edge leads to the other side, *has_met is 1,
 * and its end on the start's side is marked as on a shortest path.
 */
static dpt_result expand_vertex(struct route_finder *f, int side, struct visited_vertex *slot, int *has_met)
{
    const uint32_t vertex = slot->vertex_plus_1 - 1;
    const uint32_t mark = (f->ring[side] + 1) * ROUTE_STEP + (side ? ROUTE_GOAL : 0);
    FOR_NEXT_TO(f, vertex, next)
    {
        struct visited_vertex *other = slot_of(f->search, next);
        if (!other->vertex_plus_1) {
            DPT_TRY(put_vertex(f->search, other, next, side, mark));
        } else if ((other->mark & ROUTE_GOAL) != (mark & ROUTE_GOAL)) {
            *has_met = 1;
            if (side)
                other->mark |= ROUTE_SHORTEST;
            else
                slot->mark |= ROUTE_SHORTEST;
        }
    }
    return DPT_OK;
}

/* Triangles to read for the neighbours of a side's outermost ring. */
static uint64_t cost_of_ring(const struct route_finder *f, int side)
{
    uint64_t cost = 0;
    for (uint32_t i = f->ring_begin[side]; i < f->search->queued_count[side]; i++) {
        uint32_t vertex = queued(f->search, side, i)->vertex_plus_1 - 1;
        cost += f->fan_first[vertex + 1] - f->fan_first[vertex];
    }
    return cost;
}

/* Add rings, each on the cheaper side, until the sides meet. */
static dpt_result search_until_met(struct route_finder *f)
{
    struct route_search *search = f->search;
    uint64_t cost[2] = { cost_of_ring(f, 0), cost_of_ring(f, 1) };
    for (int has_met = 0; !has_met;) {
        int side = cost[1] < cost[0];
        uint32_t end = search->queued_count[side];
        if (f->ring_begin[side] == end)
            return DPT_E_UNREACHABLE;
        for (uint32_t i = f->ring_begin[side]; i < end; i++)
            DPT_TRY(expand_vertex(f, side, queued(search, side, i), &has_met));
        if (has_met) {
            f->edge_count = f->ring[0] + f->ring[1] + 1;
        } else {
            f->ring_begin[side] = end;
            f->ring[side]++;
            cost[side] = cost_of_ring(f, side);
        }
    }
    return DPT_OK;
}

/* Mark the start's vertices that lie on a shortest path, from the outermost ring inwards. */
static void mark_shortest(const struct route_finder *f)
{
    for (uint32_t i = f->search->queued_count[0]; i-- > 0;) {
        const struct visited_vertex *slot = queued(f->search, 0, i);
        if (!(slot->mark & ROUTE_SHORTEST) || slot->mark < ROUTE_STEP)
            continue;
        const uint32_t vertex = slot->vertex_plus_1 - 1;
        const uint32_t previous_ring = slot->mark / ROUTE_STEP - 1;
        FOR_NEXT_TO(f, vertex, next)
        {
            struct visited_vertex *other = slot_of(f->search, next);
            if (other->vertex_plus_1 && other->mark == previous_ring * ROUTE_STEP)
                other->mark |= ROUTE_SHORTEST;
        }
    }
}

/* Edges from a vertex to the goal; UINT32_MAX for one that is neither on a shortest path nor reached from the goal. */
static uint32_t steps_to_goal(const struct route_finder *f, uint32_t vertex)
{
    const struct visited_vertex *slot = slot_of(f->search, vertex);
    if (!slot->vertex_plus_1)
        return UINT32_MAX;
    if (slot->mark & ROUTE_GOAL)
        return slot->mark / ROUTE_STEP;
    return slot->mark & ROUTE_SHORTEST ? f->edge_count - slot->mark / ROUTE_STEP : UINT32_MAX;
}

/*
 * The triangle after `current`, whose nearest vertex is `steps` edges from the goal: it shares a vertex with `current`
 * and has one that is an edge nearer. Of several, the paper's rule chooses. DPT_NONE in a forged mesh.
 */
static uint32_t next_triangle(const struct route_finder *f, uint32_t current, uint32_t steps)
{
    const uint32_t *own_corners = corners_of(f, current);
    uint32_t best = DPT_NONE;
    int best_shared = 0;
    for (int k = 0; k < 3; k++) {
        if (steps_to_goal(f, own_corners[k]) != steps)
            continue;
        for (uint32_t i = f->fan_first[own_corners[k]]; i < f->fan_first[own_corners[k] + 1]; i++) {
            uint32_t triangle = f->fans[i];
            const uint32_t *corners = corners_of(f, triangle);
            int shared = shared_corners(own_corners, 3, corners), is_nearer = 0;
            if (!shared || (shared < best_shared && shared < 2))
                continue; /* only in a forged mesh is none shared */
            for (int c = 0; c < 3; c++)
                is_nearer |= steps_to_goal(f, corners[c]) == steps - 1;
            shared = shared > 2 ? 2 : shared;
            if (is_nearer &&
                (shared > best_shared || (shared == best_shared && f->sources[triangle] < f->sources[best]))) {
                best = triangle;
                best_shared = shared;
            }
        }
    }
    return best;
}

/* Add a triangle to a route; `remaining` come after it. Returns 0, and adds none, if it is on route->other too. */
static int add_triangle(struct route *route, uint32_t place, uint32_t remaining)
{
    const struct route *other = route->other;
    if (other && remaining < other->count) {
        uint32_t index = other->count - 1 - remaining;
        if (index < other->capacity && other->places[index] == place)
            return 0;
    }
    if (route->count < route->capacity)
        route->places[route->count] = place;
    route->count++;
    return 1;
}

/* Choose the route triangle by triangle, up to the first that is on route->other too. */
static dpt_result follow_route(const struct route_finder *f, uint32_t from, uint32_t to, struct route *route)
{
    uint32_t current = from;
    for (uint32_t steps = f->edge_count; add_triangle(route, current, steps + 1); steps--) {
        if (!steps) {
            add_triangle(route, to, 0);
            break;
        }
        current = next_triangle(f, current, steps);
        if (current == DPT_NONE)
            return DPT_E_LAYOUT;
    }
    return DPT_OK;
}

static dpt_result search_both_sides(struct route_finder *f, uint32_t from, uint32_t to, struct route *route)
{
    if (!f->search->queue_capacity)
        return DPT_E_FULL;
    DPT_TRY(begin_ring(f, 0, from));
    DPT_TRY(begin_ring(f, 1, to));
    DPT_TRY(search_until_met(f));
    mark_shortest(f);
    return follow_route(f, from, to, route);
}

dpt_result dpti_route_find(struct route_search *search, const struct dpt_mesh *mesh, uint32_t from, uint32_t to,
                           struct route *route)
{
    struct route_finder f = {
        .search = search,
        .corners = mesh_words(mesh, MESH_TRIANGLES),
        .fan_first = mesh_words(mesh, MESH_FAN_FIRST),
        .fans = mesh_words(mesh, MESH_FANS),
        .sources = mesh_words(mesh, MESH_SOURCES),
        .corners_per_triangle = mesh->closed_components == mesh->parts ? 1 : 2,
    };
    const uint32_t *goal = corners_of(&f, to);
    route->count = 0;
    if (from == to) {
        add_triangle(route, to, 0);
        return DPT_OK;
    }
    int share_vertex = 0;
    for (int k = 0; k < 3; k++)
        share_vertex |= has_corner(corners_of(&f, from), goal[k]);
    if (share_vertex)
        return follow_route(&f, from, to, route);
    const dpt_result result = search_both_sides(&f, from, to, route);
    clear_search(search);
    return result;
}
