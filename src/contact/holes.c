/* SPDX-License-Identifier: BSD-3-Clause */
#include "contact/holes.h"

#include "base/box.h"
#include "contact/winding_number.h"

/* Of a hole's radius: nearer than that to its centre a hole counts. */
#define NEAR_HOLE 1.05

/*
 * Seen from outside its ball a hole fills less than half of the view. The winding number is off by the sum of these
 * shares at most; up to this sum its rounded value is right.
 */
#define SHARES_MAX 0.45

/* The number of triangles whose two sides are looked at, and how far from them, as a share of the diagonal. */
enum { SAMPLES = 64 };
#define SAMPLE_HEIGHT 1e-6

static void remove_box(struct box *boxes, uint32_t *count, uint32_t i)
{
    boxes[i] = boxes[--*count];
}

/* Join the two boxes whose common box is smallest. */
static void join_nearest(struct box *boxes, uint32_t *count)
{
    uint32_t first = 0, second = 1;
    double least = HUGE_VAL;
    for (uint32_t i = 0; i < *count; i++)
        for (uint32_t k = i + 1; k < *count; k++) {
            const struct box both = box_joined(&boxes[i], &boxes[k]);
            if (box_diagonal(&both) < least) {
                least = box_diagonal(&both);
                first = i;
                second = k;
            }
        }
    boxes[first] = box_joined(&boxes[first], &boxes[second]);
    remove_box(boxes, count, second);
}

/* Add an edge: edges of one hole share vertices, so their boxes meet, if not at once then with edges between them. */
static void add_edge(struct box boxes[HOLES_MAX + 1], uint32_t *count, struct box edge)
{
    for (uint32_t i = 0; i < *count;)
        if (box_meets(&boxes[i], &edge)) {
            edge = box_joined(&boxes[i], &edge);
            remove_box(boxes, count, i);
            i = 0;
        } else {
            i++;
        }
    boxes[(*count)++] = edge;
    if (*count > HOLES_MAX)
        join_nearest(boxes, count);
}

static uint32_t collect_edges(const struct surface *surface, struct box boxes[HOLES_MAX + 1])
{
    const uint32_t *neighbours = surface_neighbours(surface);
    uint32_t count = 0;
    vec3 v[3];
    for (uint32_t i = 0; i < 3 * surface_triangles(surface); i++) {
        if (neighbours[i] != MESH_EDGE_OPEN)
            continue;
        surface_corners(surface, i / 3, v);
        add_edge(boxes, &count, box_of_axis(v[i % 3], v[(i + 1) % 3]));
    }
    return count;
}

/* Whether the mesh is one part whose only defects are open edges. */
static int has_holes_alone(const struct dpt_mesh *mesh)
{
    const uint32_t wanted = MESH_PART_WINDING | MESH_PART_WOUND | MESH_PART_MANIFOLD;
    if (mesh->parts != 1 || (mesh_part_flags(mesh, 0) & wanted) != wanted)
        return 0;
    const struct mesh_tail tail = mesh_tail(mesh);
    return mesh->open_edges && !tail.self_intersections && !tail.self_intersections_more;
}

/* The share of the view that a hole fills at most, at that distance from its centre; more than a half within its ball. */
static double share_of_view(const struct hole *hole, double distance)
{
    const double sine = hole->radius / distance;
    return distance > NEAR_HOLE * hole->radius ? 0.5 * (1.0 - sqrt(1.0 - sine * sine)) : 1.0;
}

/* Whether sample triangles that are away from the holes have the material behind them. */
static int samples_agree(const struct surface *surface, const struct kernel *kernel,
                         const struct holes *holes)
{
    const uint32_t triangles = surface_triangles(surface);
    const double height = SAMPLE_HEIGHT * surface_diagonal(surface);
    for (uint32_t k = 0; k < SAMPLES; k++) {
        struct work work = work_of(WORK_UNLIMITED);
        vec3 v[3];
        surface_corners(surface, (uint32_t)((uint64_t)k * triangles / SAMPLES), v);
        const vec3 normal = cross(sub(v[1], v[0]), sub(v[2], v[0]));
        const double size = length(normal);
        const vec3 middle = scaled(add(add(v[0], v[1]), v[2]), 1.0 / 3.0);
        if (!(size > 0.0) || !dpti_holes_are_far_from(holes, middle, (vec3){ 0.0, 0.0, 0.0 }))
            continue;
        const double step = height / size;
        if (dpti_winding_number(surface, kernel, along(middle, step, normal), &work) > 0.5 ||
            dpti_winding_number(surface, kernel, along(middle, -step, normal), &work) < 0.5)
            return 0;
    }
    return 1;
}

void dpti_holes_find(const struct surface *surface, const struct kernel *kernel,
                     struct holes *holes)
{
    struct box boxes[HOLES_MAX + 1];
    holes->count = holes->reserved = 0;
    if (!surface->moments || surface->motion || !has_holes_alone(surface->mesh))
        return;
    holes->count = collect_edges(surface, boxes);
    for (uint32_t i = 0; i < holes->count; i++)
        holes->ball[i] = (struct hole){ scaled(add(boxes[i].low, boxes[i].high), 0.5),
                                        0.5 * box_diagonal(&boxes[i]) };
    if (!samples_agree(surface, kernel, holes))
        holes->count = 0;
}

int dpti_holes_are_far_from(const struct holes *holes, vec3 a, vec3 u)
{
    double shares = 0.0;
    for (uint32_t i = 0; i < holes->count; i++) {
        const vec3 centre = holes->ball[i].centre;
        const vec3 nearest = along(a, nearest_on(a, u, centre), u);
        shares += share_of_view(&holes->ball[i], length(sub(centre, nearest)));
    }
    return holes->count && shares <= SHARES_MAX;
}

int dpti_holes_are_beyond(const struct holes *holes, vec3 x, double distance)
{
    for (uint32_t i = 0; i < holes->count; i++)
        if (!(length(sub(holes->ball[i].centre, x)) > distance + NEAR_HOLE * holes->ball[i].radius))
            return 0;
    return 1;
}
