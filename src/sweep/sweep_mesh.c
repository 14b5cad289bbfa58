/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Depth first through the box tree, nearest to the swept hull first (docs/algorithms/sweep.md). Each hit shortens the
 * time to search, and with it the hull. Float bounds rule triangles out; dpti_sweep_triangle decides on the others.
 */
#include "sweep/sweep_mesh.h"

#include "nearest/filter_segment.h"

/*
 * The axes of a box around the swept hull. end: the ends of the tool's axis at both times, in the filter's frame. The
 * last box axis makes bounds, so it must be of unit length: vectors too short to have a direction get any direction.
 */
static void swept_hull_set_box(const vec3 end[4], vec3 axis[3])
{
    const double min_square = 1e-100;
    vec3 u = add(sub(end[1], end[0]), sub(end[3], end[2]));
    vec3 displacement = add(sub(end[2], end[0]), sub(end[3], end[1]));
    double uu = dot(u, u);
    vec3 x = uu > min_square ? scaled(u, 1.0 / sqrt(uu)) : (vec3){ 1.0, 0.0, 0.0 };
    vec3 y = along(displacement, -dot(displacement, x), x);
    y = along(y, -dot(y, x), x);
    double yy = dot(y, y);
    if (!(yy > 0x1p-60 * dot(displacement, displacement) && yy > min_square)) {
        struct filter_segment segment;
        filter_segment_set_frame(&segment, x);
        y = vec3_of_float(segment.y);
        yy = dot(y, y);
    }
    axis[0] = x;
    axis[1] = scaled(y, 1.0 / sqrt(yy));
    axis[2] = cross(axis[0], axis[1]);
}

static void swept_hull_of(const struct mesh_sweep *search, struct swept_hull *hull)
{
    const struct surface *surface = search->surface;
    const double scale = surface->filter_scale;
    const double times[2] = { search->from, search->progress->until };
    vec3 end[4], axis[3];
    double max_square = 0.0;
    for (int k = 0; k < 2; k++) {
        vec3 a, u;
        dpti_sweep_axis(search->sweep, times[k], &a, &u);
        end[2 * k] = scaled(sub(a, surface->filter_centre), scale);
        end[2 * k + 1] = along(end[2 * k], scale, u);
    }
    for (int k = 0; k < 4; k++) {
        put_float(end[k], hull->end[k]);
        max_square = max_of(max_square, dot(end[k], end[k]));
    }
    swept_hull_set_box(end, axis);
    vec3 centre = { 0.0, 0.0, 0.0 };
    for (int k = 0; k < 3; k++) {
        double low = HUGE_VAL, high = -HUGE_VAL;
        for (int e = 0; e < 4; e++) {
            low = min_of(low, dot(end[e], axis[k]));
            high = max_of(high, dot(end[e], axis[k]));
        }
        centre = along(centre, 0.5 * (low + high), axis[k]);
        hull->half[k] = (float)(0.5 * (high - low));
        put_float(axis[k], hull->axis[k]);
    }
    put_float(centre, hull->centre);
    const double *reach = search->sweep->reach;
    for (int k = 0; k < 2; k++)
        hull->reach[k] = (float)(reach[k] * scale * (1.0 + KERNEL_STRETCH));
    const double farthest = sqrt(max_square) + scale * max_of(reach[0], reach[1]);
    double limit = search->sweep->no_hit_limit * scale * (1.0 + KERNEL_STRETCH);
    hull->limit = (float)(limit + kernel_swept_margin(farthest) + surface_margin(surface));
    const struct surface_motion *motion = search->times->tick ? surface->motion : NULL;
    const double surface_moves = motion ? (double)motion->step[motion->first[motion->levels]] : 0.0;
    hull->beside = (float)(limit + scale * max_of(reach[0], reach[1]) + surface_moves + surface_margin(surface) +
                           PIECE_MARGIN * (1.0 + farthest));
}

static float hull_support(const struct swept_hull *hull, const float n[3])
{
    float support = -INFINITY;
    for (int k = 0; k < 4; k++) {
        const float *end = hull->end[k];
        const float at = n[0] * end[0] + n[1] * end[1] + n[2] * end[2] + hull->reach[k % 2];
        support = at > support ? at : support;
    }
    return support;
}

/* Set the hull of what is left of the motion, and the planes that are tried first. */
static void set_hull(struct mesh_sweep *search)
{
    const struct sweep *sweep = search->sweep;
    swept_hull_of(search, &search->hull);
    search->first_plane_count = search->times->tick ? 0 : sweep->direction_count;
    for (uint32_t i = 0; i < search->first_plane_count; i++) {
        struct first_plane *plane = &search->first_planes[i];
        put_float(sweep->directions[i], plane->normal);
        plane->limit = hull_support(&search->hull, plane->normal) + search->hull.limit;
    }
}

/* A triangle during the sweep. */
static void triangle_during(const struct mesh_sweep *search, uint32_t triangle, struct moving_triangle *moving)
{
    const struct surface *surface = search->surface;
    const struct surface_times *times = search->times;
    moving->is_moving = times->tick != 0;
    for (uint32_t k = 0; k < 3; k++) {
        const uint32_t vertex = surface_corner(surface, triangle, k);
        const vec3 now = vec3_of_float(surface->positions + 3 * (size_t)vertex);
        moving->corner[k] = now;
        if (!times->tick)
            continue;
        const vec3 last = vec3_of_float(surface_motion_previous(surface->motion, vertex, times->tick));
        moving->corner[k] = along(last, times->from, sub(now, last));
        moving->shift[k] = scaled(sub(now, last), times->to - times->from);
    }
}

/* 1 if the triangle is before the best one in the source: of triangles that are hit at one time, the first counts. */
static int comes_first(const struct mesh_sweep *search, uint32_t triangle)
{
    const struct sweep_progress *progress = search->progress;
    const uint32_t *sources = search->surface->sources;
    return progress->triangle == DPT_NONE || sources[triangle] < sources[progress->triangle];
}

/*
 * Sweep one triangle, in double, and note its hit if it is the first so far. A tool that begins on many triangles need
 * not be compared with all: nothing is sooner than time 0.
 */
static void evaluate_triangle(struct mesh_sweep *search, uint32_t triangle)
{
    struct sweep_progress *progress = search->progress;
    struct moving_triangle moving;
    double time;
    uint32_t evaluations = 0;
    if (progress->until == 0.0 && !comes_first(search, triangle))
        return;
    triangle_during(search, triangle, &moving);
    work_spend(search->work, 1);
    if (dpti_sweep_triangle(search->sweep, &moving, progress->until, &time, &evaluations) != SWEEP_HIT ||
        (time == progress->until && !comes_first(search, triangle)))
        return;
    int is_sooner = time < progress->until;
    progress->until = time;
    progress->triangle = triangle;
    if (is_sooner)
        set_hull(search);
}

/* What vertices below the children moved in the tick is taken off their bounds. Returns the open lanes. */
static uint32_t lower_bounds(const struct mesh_sweep *search, uint32_t level, uint32_t node, float *bound)
{
    const struct surface_motion *motion = search->surface->motion;
    const float *step = motion->step + (level ? motion->first[level - 1] + node * LANES : node);
    uint32_t open = 0;
    for (uint32_t i = 0; i < LANES; i++) {
        bound[i] -= step[level ? i : 0];
        open |= (uint32_t) !(bound[i] > search->hull.limit) << i;
    }
    return open;
}

/* The triangles of a leaf that neither the first planes nor bounds of their own rule out. */
static uint32_t open_triangles(const struct mesh_sweep *search, const float *rows, float *bound)
{
    uint32_t open = lanes_of(LANES);
    for (uint32_t i = 0; i < search->first_plane_count && open; i++) {
        const struct first_plane *plane = &search->first_planes[i];
        open &= search->kernel->common_triangles(rows, plane->normal, plane->limit, bound);
    }
    return open ? open & search->kernel->swept_triangles(rows, &search->hull, bound) : 0;
}

void dpti_sweep_aim(struct mesh_sweep *search)
{
    set_hull(search);
}

uint32_t dpti_sweep_open_boxes(const struct mesh_sweep *search, const float *rows)
{
    uint32_t open = lanes_of(LANES);
    float bound[LANES];
    for (uint32_t i = 0; i < search->first_plane_count && open; i++) {
        const struct first_plane *plane = &search->first_planes[i];
        open &= search->kernel->common_boxes(rows, plane->normal, plane->limit, bound);
    }
    return open ? open & search->kernel->swept_boxes(rows, &search->hull, bound) : 0;
}

uint32_t dpti_sweep_open_triangles(const struct mesh_sweep *search, const float *rows)
{
    float bound[LANES];
    return open_triangles(search, rows, bound);
}

/* Put a node on the path and test its children. Level 0: a leaf, whose children are triangles. */
static void open_node(struct mesh_sweep *search, uint32_t level, uint32_t node)
{
    const struct surface *surface = search->surface;
    struct sweep_node *opened = &search->progress->path[level];
    uint32_t children = level ? surface->count[level - 1] : surface_triangles(surface), open;
    work_spend(search->work, 1);
    search->progress->level = level;
    opened->node = node;
    if (level)
        open =
            search->kernel->swept_boxes(surface_node(surface, level, node, search->work), &search->hull, opened->bound);
    else
        open = open_triangles(search, surface_leaf(surface, node, search->work), opened->bound);
    if (search->times->tick)
        open = lower_bounds(search, level, node, opened->bound);
    opened->lanes = open & lanes_of(children - node * LANES);
}

/* Begin above the root: at a node whose only child is the root. */
static void begin_search(struct mesh_sweep *search, uint32_t hint)
{
    struct sweep_progress *progress = search->progress;
    progress->has_begun = 1;
    progress->hint = hint;
    progress->triangle = DPT_NONE;
    progress->until = 1.0;
    progress->level = search->surface->levels + 1;
    progress->path[progress->level] = (struct sweep_node){ .lanes = 1 };
    set_hull(search);
    if (hint < surface_triangles(search->surface))
        evaluate_triangle(search, hint);
}

/* Whether the motion may touch a triangle that the bounds in float do not rule out. */
static int may_touch_triangle(struct mesh_sweep *search, uint32_t triangle)
{
    struct moving_triangle moving;
    triangle_during(search, triangle, &moving);
    work_spend(search->work, 1);
    return dpti_sweep_may_touch_triangle(search->sweep, &moving);
}

/*
 * Where so many triangles of a leaf, or of all leaves, are in doubt, the motion is too long for its test: a shorter one
 * is cheaper than a proof of each.
 */
enum { DOUBTED_OF_LEAF = 8, DOUBTED_MAX = 32 };

static int is_too_long(const struct sweep_progress *progress)
{
    uint32_t count = 0;
    for (uint32_t lanes = progress->path[0].lanes; lanes; lanes &= lanes - 1)
        count++;
    return count >= DOUBTED_OF_LEAF || progress->ruled_out == DOUBTED_MAX;
}

/* Visit what is left until a triangle may be touched. */
static int continue_test(struct mesh_sweep *search, uint32_t *leaf)
{
    struct sweep_progress *progress = search->progress;
    while (progress->level <= search->surface->levels || progress->path[progress->level].lanes) {
        struct sweep_node *opened = &progress->path[progress->level];
        if (!opened->lanes) {
            progress->level++;
            continue;
        }
        if (work_is_spent(search->work))
            return SWEEP_UNFINISHED;
        uint32_t lane = lowest_lane(opened->bound, opened->lanes);
        uint32_t child = opened->node * LANES + lane;
        opened->lanes &= ~(1u << lane);
        if (progress->level) {
            open_node(search, progress->level - 1, child);
        } else if (is_too_long(progress) || may_touch_triangle(search, child)) {
            *leaf = opened->node;
            return SWEEP_HIT;
        } else {
            progress->ruled_out++;
        }
    }
    return SWEEP_FREE;
}

int dpti_sweep_may_touch(struct mesh_sweep *search, uint32_t *leaf)
{
    struct sweep_progress *progress = search->progress;
    const uint32_t above_root = search->surface->levels + 1;
    if (search->from >= 1.0)
        return SWEEP_FREE;
    if (work_is_spent(search->work))
        return SWEEP_UNFINISHED;
    progress->until = 1.0;
    set_hull(search);
    if (!progress->has_begun) {
        progress->has_begun = 1;
        progress->ruled_out = 0;
        progress->path[above_root] = (struct sweep_node){ .lanes = 1 };
        progress->level = above_root;
        if (*leaf != DPT_NONE) {
            open_node(search, 0, *leaf);
            if (!progress->path[0].lanes)
                progress->level = above_root;
        }
    }
    int status = continue_test(search, leaf);
    progress->has_begun = status == SWEEP_UNFINISHED;
    return status;
}

/* Visit the nodes and triangles that are left. Returns 0 if the work is spent before all are visited. */
static int continue_search(struct mesh_sweep *search)
{
    struct sweep_progress *progress = search->progress;
    for (;;) {
        struct sweep_node *opened = &progress->path[progress->level];
        if (!opened->lanes) {
            if (progress->level > search->surface->levels)
                return 1;
            progress->level++;
            continue;
        }
        if (work_is_spent(search->work))
            return 0;
        uint32_t lane = lowest_lane(opened->bound, opened->lanes);
        uint32_t child = opened->node * LANES + lane;
        opened->lanes &= ~(1u << lane);
        if (progress->level)
            open_node(search, progress->level - 1, child);
        else if (child != progress->hint)
            evaluate_triangle(search, child);
    }
}

int dpti_sweep_mesh(struct mesh_sweep *search, uint32_t hint, struct impact *first)
{
    const struct surface *surface = search->surface;
    const struct surface_times *times = search->times;
    struct sweep_progress *progress = search->progress;
    *first = (struct impact){ .time = 1.0, .triangle = DPT_NONE };
    if (search->from >= 1.0)
        return SWEEP_FREE;
    if (progress->has_begun)
        set_hull(search);
    else
        begin_search(search, hint);
    int is_done = continue_search(search);
    progress->has_begun = !is_done;
    first->time = is_done ? progress->until : search->from;
    if (!is_done || progress->triangle == DPT_NONE)
        return is_done ? SWEEP_FREE : SWEEP_UNFINISHED;
    vec3 a, u;
    dpti_sweep_axis(search->sweep, progress->until, &a, &u);
    const double time = times->from + progress->until * (times->to - times->from);
    const struct surface then = surface_view(surface, times->tick, time);
    first->triangle = progress->triangle;
    first->pair = dpti_triangle_pair(times->tick ? &then : surface, progress->triangle, a, u);
    first->q = sub(along(a, first->pair.s, u), first->pair.gap);
    return SWEEP_HIT;
}
