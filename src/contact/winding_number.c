/* SPDX-License-Identifier: BSD-3-Clause */
#include "contact/winding_number.h"

#include "base/angle.h"
#include "base/box.h"

/* The series' part of WINDING_ERROR; the rest is for rounding. */
#define SERIES_ERROR (0.9 * WINDING_ERROR)

/*
 * The error that one set of triangles may have in the first pass, divided by the number of levels, since each level of
 * a smooth surface adds about as much. If the sum of the errors is too large, another pass uses a smaller limit. The
 * sum falls like the square root of that limit, or a little faster.
 */
#define FIRST_NODE_ERROR  5e-4f
#define NODE_ERROR_SHRINK 0.25f
#define PASSES_MAX        8

/* Farther away than this, in half widths of the mesh, the winding number is below 1e-9. */
#define DISTANCE_MAX 0x1p20

struct winding_traversal {
    const struct surface *surface;
    const struct kernel *kernel;
    const float *moments;
    const uint32_t *solid_lanes;        /* a word a leaf: lanes of triangles of solid parts */
    vec3 x;                             /* in the mesh's frame */
    float x_filter[3];                  /* in the filter's frame */
    float winding[LANES], error[LANES]; /* sums by lane, in turns */
    double exact;                       /* sum over the triangles that are evaluated in double, in turns */
    struct work *work;
};

static double sum_of(const float *lanes)
{
    double sum = 0.0;
    for (int i = 0; i < LANES; i++)
        sum += (double)lanes[i];
    return sum;
}

/* Corner k of a triangle, a place, as seen from x. */
static vec3 corner_from_x(const struct winding_traversal *traversal, uint32_t triangle, uint32_t k)
{
    uint32_t vertex = traversal->surface->corners[3 * (size_t)triangle + k];
    return sub(vec3_of_float(traversal->surface->positions + 3 * (size_t)vertex), traversal->x);
}

/* Add the triangles of a leaf. */
static void sum_leaf(struct winding_traversal *traversal, uint32_t leaf)
{
    uint32_t lanes = traversal->solid_lanes[leaf];
    if (!lanes)
        return;
    const float *rows = surface_leaf(traversal->surface, leaf, traversal->work);
    uint32_t open = traversal->kernel->angles(rows, traversal->x_filter, lanes, traversal->winding);
    work_spend(traversal->work, 1);
    for (; open; open &= open - 1) {
        uint32_t triangle = leaf * LANES + first_lane(open);
        traversal->exact += solid_turns(corner_from_x(traversal, triangle, 0), corner_from_x(traversal, triangle, 1),
                                        corner_from_x(traversal, triangle, 2));
    }
}

/* Add the series of a node's children whose error is at most max_error. Returns the lanes of the others. */
static uint32_t sum_node(struct winding_traversal *traversal, uint32_t level, uint32_t node, float max_error)
{
    const struct surface *surface = traversal->surface;
    size_t row = surface->first[level] - surface->first[1] + node;
    uint32_t children = lanes_of(surface->count[level - 1] - node * LANES);
    work_spend(traversal->work, 1);
    return children & traversal->kernel->moments(traversal->moments + row * MESH_MOMENT_WORDS, traversal->x_filter,
                                                 max_error, traversal->winding, traversal->error);
}

/* Sum over the whole tree. Returns a bound of the error, or HUGE_VAL if the work was spent before. */
static double sum_tree(struct winding_traversal *traversal, float max_error)
{
    uint32_t node[MESH_LEVELS_MAX + 1], open[MESH_LEVELS_MAX + 1];
    uint32_t top = traversal->surface->levels, level = top;
    memset(traversal->winding, 0, sizeof traversal->winding);
    memset(traversal->error, 0, sizeof traversal->error);
    traversal->exact = 0.0;
    node[level] = 0;
    open[level] = sum_node(traversal, level, 0, max_error);
    while (level <= top) {
        if (work_is_spent(traversal->work))
            return HUGE_VAL;
        if (!open[level]) {
            level++;
            continue;
        }
        uint32_t child = node[level] * LANES + first_lane(open[level]);
        open[level] &= open[level] - 1;
        if (level == 1) {
            sum_leaf(traversal, child);
        } else {
            node[--level] = child;
            open[level] = sum_node(traversal, level, child, max_error);
        }
    }
    return sum_of(traversal->error);
}

/* Leaves after which the sums in float are put aside. */
enum { LEAVES_SUMMED = 16 };

/*
 * A deformable body has no moments: they would have to be made anew for whatever moved, which takes longer than to look
 * at all of its triangles. Returns HUGE_VAL if the work was spent before.
 */
static double sum_leaves(struct winding_traversal *traversal)
{
    const uint32_t leaves = traversal->surface->count[0];
    double sum = 0.0;
    traversal->exact = 0.0;
    for (uint32_t leaf = 0; leaf < leaves; leaf++) {
        if (leaf % LEAVES_SUMMED == 0) {
            sum += leaf ? sum_of(traversal->winding) : 0.0;
            memset(traversal->winding, 0, sizeof traversal->winding);
        }
        if (work_is_spent(traversal->work))
            return HUGE_VAL;
        sum_leaf(traversal, leaf);
    }
    return sum + sum_of(traversal->winding) + traversal->exact;
}

/* The comparisons turn NaN, which a forged file can yield, into 0. */
double dpti_winding_number(const struct surface *surface, const struct kernel *kernel, vec3 x, struct work *work)
{
    struct winding_traversal traversal = { .surface = surface, .kernel = kernel, .x = x, .work = work };
    traversal.moments = surface_moments(surface, &traversal.solid_lanes);
    vec3 x_filter = scaled(sub(x, surface->filter_centre), surface->filter_scale);
    if (!traversal.moments || !within(x_filter.x, DISTANCE_MAX) || !within(x_filter.y, DISTANCE_MAX) ||
        !within(x_filter.z, DISTANCE_MAX))
        return 0.0;
    traversal.x_filter[0] = (float)x_filter.x;
    traversal.x_filter[1] = (float)x_filter.y;
    traversal.x_filter[2] = (float)x_filter.z;
    if (surface->motion)
        return sum_leaves(&traversal);
    float max_node_error = FIRST_NODE_ERROR / (float)surface->levels;
    double error = sum_tree(&traversal, max_node_error);
    for (int pass = 1; !(error <= SERIES_ERROR) && pass < PASSES_MAX && !work_is_spent(work); pass++) {
        float share = (float)(SERIES_ERROR / error);
        max_node_error *= share * share < NODE_ERROR_SHRINK ? share * share : NODE_ERROR_SHRINK;
        error = sum_tree(&traversal, max_node_error);
    }
    if (work_is_spent(work))
        return HUGE_VAL;
    double winding = sum_of(traversal.winding) + traversal.exact;
    return fabs(winding) <= (double)surface_triangles(surface) ? winding : 0.0;
}

/* ---- holes ---- */

/*
 * Seen from outside its ball a hole fills less than half of the view. The winding number is off by the sum of these
 * shares at most; up to this sum its rounded value is right.
 */
#define SHARES_MAX 0.45

/* Units in the mesh's diagonal. A radius has at most twice as many: nothing that is farther is in the mesh's box. */
#define UNITS 32000.0

/* A ball's radius is enlarged by this factor, which covers rounding. */
#define ROUND_UP (1.0 + 0x1p-40)

/* The triangles at a vertex that are looked at to see whether one of its edges is a rim. */
enum { FAN_MAX = 64 };

/* The number of triangles whose two sides are looked at, and how far from them, as a share of the diagonal. */
enum { SAMPLES = 64 };
#define SAMPLE_HEIGHT 1e-6

struct rim {
    struct box box;
    double length; /* m: of all its edges */
};

/* Edges of rims, by where they lie. */
struct rims {
    uint32_t count;
    double grain; /* m: boxes whose common box is no larger are one */
    struct rim rim[HOLES_MAX + 1];
};

static int are_one(const struct rims *rims, const struct rim *a, const struct rim *b)
{
    const struct box both = box_joined(&a->box, &b->box);
    return box_meets(&a->box, &b->box) || box_diagonal(&both) <= rims->grain;
}

/* Add a rim: edges of one hole share vertices, so their boxes meet, if not at once then with edges between them. */
static void add_rim(struct rims *rims, struct rim rim)
{
    for (uint32_t i = 0; i < rims->count;) {
        if (!are_one(rims, &rims->rim[i], &rim)) {
            i++;
            continue;
        }
        rim.box = box_joined(&rims->rim[i].box, &rim.box);
        rim.length += rims->rim[i].length;
        rims->rim[i] = rims->rim[--rims->count];
        i = 0;
    }
    rims->rim[rims->count++] = rim;
}

/* The least diagonal of a box around two rims. */
static double nearest_two(const struct rims *rims)
{
    double min = HUGE_VAL;
    for (uint32_t i = 0; i < rims->count; i++)
        for (uint32_t k = i + 1; k < rims->count; k++) {
            const struct box both = box_joined(&rims->rim[i].box, &rims->rim[k].box);
            min = min_of(min, box_diagonal(&both));
        }
    return min;
}

/* Make room for another rim: coarser and coarser, until some are one. */
static void join_rims(struct rims *rims)
{
    while (rims->count > HOLES_MAX) {
        const uint32_t count = rims->count;
        rims->grain = max_of(2.0 * rims->grain, nearest_two(rims));
        rims->count = 0;
        for (uint32_t i = 0; i < count; i++)
            add_rim(rims, rims->rim[i]);
    }
}

/* How often a triangle leads from one vertex to another, less how often back: 1, 0 or -1. */
static int leads(const uint32_t *corners, uint32_t triangle, uint32_t from, uint32_t to)
{
    const uint32_t *corner = corners + 3 * (size_t)triangle;
    int sum = 0;
    for (uint32_t k = 0; k < 3; k++) {
        const uint32_t here = corner[k], next = corner[(k + 1) % 3];
        sum += (here == from && next == to) - (here == to && next == from);
    }
    return sum;
}

/* 1: the triangles at edge k of a triangle, a place, do not cancel there, or are too many to tell. */
static int is_rim(const struct surface *surface, uint32_t triangle, uint32_t k)
{
    const uint32_t *corners = surface->corners, *first,
                   neighbour = surface_neighbours(surface)[3 * (size_t)triangle + k];
    const uint32_t from = surface_corner(surface, triangle, k), to = surface_corner(surface, triangle, (k + 1) % 3);
    if (neighbour < MESH_EDGE_MANY)
        return leads(corners, neighbour, from, to) != -1;
    const uint32_t *fans = surface_fans(surface, &first);
    if (first[from + 1] - first[from] > FAN_MAX)
        return 1;
    int sum = 0;
    for (uint32_t i = first[from]; i < first[from + 1]; i++)
        sum += leads(corners, fans[i], from, to);
    return sum != 0;
}

static void collect_rims(const struct surface *surface, struct rims *rims)
{
    vec3 v[3];
    rims->count = 0;
    rims->grain = 0.0;
    for (uint32_t t = 0; t < surface_triangles(surface); t++) {
        if (!(surface_part_flags(surface, surface_part(surface, t)) & MESH_PART_SOLID))
            continue;
        for (uint32_t k = 0; k < 3; k++) {
            if (!is_rim(surface, t, k))
                continue;
            surface_corners(surface, t, v);
            const vec3 a = v[k], b = v[(k + 1) % 3];
            add_rim(rims, (struct rim){ box_of_axis(a, b), length(sub(b, a)) });
            join_rims(rims);
        }
    }
}

/* Steps of the unit up to a length, rounded up. The core takes sqrt and floor alone from libm. */
static uint16_t steps_of(double length, double unit)
{
    return (uint16_t)min_of(-floor(-length / unit), UINT16_MAX);
}

/* Balls that hold the rims, and are as long around. */
static void make_balls(const struct surface *surface, const struct rims *rims, struct holes *holes)
{
    holes->origin = surface->box_min;
    holes->unit = surface_diagonal(surface) / UNITS;
    holes->count = rims->count;
    for (uint32_t i = 0; i < rims->count; i++) {
        const struct rim *rim = &rims->rim[i];
        struct hole *ball = &holes->ball[i];
        const vec3 centre = scaled(add(rim->box.low, rim->box.high), 0.5);
        const vec3 from_origin = sub(centre, holes->origin);
        ball->centre[0] = steps_of(from_origin.x, holes->unit);
        ball->centre[1] = steps_of(from_origin.y, holes->unit);
        ball->centre[2] = steps_of(from_origin.z, holes->unit);
        const double farthest = 0.5 * box_diagonal(&rim->box) + length(sub(centre, hole_centre(holes, i)));
        ball->radius = steps_of(ROUND_UP * max_of(farthest, rim->length / ANGLE_TURN), holes->unit);
    }
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

/* Whether sample triangles that are away from the holes have the material behind them. */
static int samples_agree(const struct surface *surface, const struct kernel *kernel, const struct holes *holes)
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

static uint32_t has_sheets(const struct dpt_mesh *mesh)
{
    for (uint32_t part = 0; part < mesh->parts; part++)
        if (!(mesh_part_flags(mesh, part) & (MESH_PART_SOLID | MESH_PART_BURIED)))
            return 1;
    return 0;
}

int dpti_holes_find(const struct surface *surface, const struct kernel *kernel, struct holes *holes)
{
    struct rims rims;
    collect_rims(surface, &rims);
    if (surface->motion && rims.count)
        return 0;
    make_balls(surface, &rims, holes);
    holes->has_sheets = has_sheets(surface->mesh);
    holes->normals_tell = has_holes_alone(surface->mesh) && samples_agree(surface, kernel, holes);
    holes->reserved = 0;
    return 1;
}

/*
 * The share of the view that surfaces which close a hole fill at most. Its rims, no longer than 2 pi r, are at least
 * d - r away: on a sphere they are curves of length l = 2 pi r / (d - r), and a curve of that length surrounds no more
 * than a circle does, 2 pi - sqrt(4 pi^2 - l^2). Nearer than 2 r it may be anything.
 */
static double share_of_view(double r, double distance)
{
    if (!(distance > 2.0 * r))
        return 1.0;
    const double sine = r / (distance - r);
    return 0.5 * (1.0 - sqrt(1.0 - sine * sine));
}

int dpti_holes_are_far_from(const struct holes *holes, vec3 a, vec3 u)
{
    double shares = 0.0;
    for (uint32_t i = 0; i < holes->count && shares <= SHARES_MAX; i++) {
        const vec3 centre = hole_centre(holes, i);
        const vec3 nearest = along(a, nearest_on(a, u, centre), u);
        shares += share_of_view(hole_radius(holes, i), length(sub(centre, nearest)));
    }
    return shares <= SHARES_MAX;
}

int dpti_holes_are_beyond(const struct holes *holes, vec3 x, double distance)
{
    for (uint32_t i = 0; i < holes->count; i++)
        if (!(length(sub(hole_centre(holes, i), x)) > distance + hole_radius(holes, i)))
            return 0;
    return 1;
}
