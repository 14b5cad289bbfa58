/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The first touch of a mesh: depth first through the box tree, nearest to the swept hull first, the
 * time shrinking with each hit (docs/algorithms/sweep.md). Float bounds say which triangles need
 * not be asked, dpti_sweep_pair answers.
 */
#include "sweep/sweep_mesh.h"

#include "nearest/filter_segment.h"

/* One call of dpti_sweep_mesh. */
struct mesh_sweep {
    const struct surface *surface;
    const struct kernel *kernel;
    const struct sweep *sweep;
    double from; /* what is searched: from here to progress->to */
    struct work *work;
    struct swept_hull swath;
    struct sweep_progress *progress;
};

/*
 * The axes of a box around what the axis sweeps: of ends in the filter's frame, at both times. The
 * last one makes bounds and so must be of unit length: what is too short to have a direction gets
 * any.
 */
static void swept_hull_set_box(const vec3 end[4], vec3 axis[3])
{
    const double least = 1e-100;
    vec3 u = add(sub(end[1], end[0]), sub(end[3], end[2]));
    vec3 way = add(sub(end[2], end[0]), sub(end[3], end[1]));
    double uu = dot(u, u);
    vec3 x = uu > least ? scaled(u, 1.0 / sqrt(uu)) : (vec3){ 1.0, 0.0, 0.0 };
    vec3 y = along(way, -dot(way, x), x);
    y = along(y, -dot(y, x), x);
    double yy = dot(y, y);
    if (!(yy > 0x1p-60 * dot(way, way) && yy > least)) {
        struct filter_segment any;
        filter_segment_set_frame(&any, x);
        y = vec3_of_float(any.y);
        yy = dot(y, y);
    }
    axis[0] = x;
    axis[1] = scaled(y, 1.0 / sqrt(yy));
    axis[2] = cross(axis[0], axis[1]);
}

static void swept_hull_of(const struct mesh_sweep *search, struct swept_hull *hull)
{
    const struct surface *surface = search->surface;
    const double scale = surface->filter_scale, times[2] = { search->from, search->progress->to };
    vec3 end[4], axis[3];
    double far = 0.0;
    for (int k = 0; k < 2; k++) {
        vec3 a, u;
        dpti_sweep_axis(search->sweep, times[k], &a, &u);
        end[2 * k] = scaled(sub(a, surface->filter_centre), scale);
        end[2 * k + 1] = along(end[2 * k], scale, u);
    }
    for (int k = 0; k < 4; k++) {
        put_float(end[k], hull->end[k]);
        far = max_of(far, dot(end[k], end[k]));
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
    double limit = search->sweep->beyond * scale * (1.0 + KERNEL_STRETCH);
    hull->limit = (float)(limit + kernel_margin(sqrt(far), sqrt(far)));
}

/* One triangle, in double. */
static void ask(struct mesh_sweep *search, uint32_t triangle)
{
    const struct surface *surface = search->surface;
    struct sweep_progress *progress = search->progress;
    const uint32_t *of = surface->corners + 3 * (size_t)triangle;
    const vec3 corner[3] = { vec3_of_float(surface->positions + 3 * (size_t)of[0]),
                             vec3_of_float(surface->positions + 3 * (size_t)of[1]),
                             vec3_of_float(surface->positions + 3 * (size_t)of[2]) };
    double time;
    uint32_t asked = 0;
    work_spend(search->work, 1);
    if (dpti_sweep_pair(search->sweep, corner, progress->to, &time, &asked) != SWEEP_HIT ||
        (time == progress->to && progress->triangle != DPT_NONE &&
         surface->sources[triangle] >= surface->sources[progress->triangle]))
        return;
    int sooner = time < progress->to;
    progress->to = time;
    progress->triangle = triangle;
    if (sooner)
        swept_hull_of(search, &search->swath);
}

/* A leaf is of level 0, and its children are triangles. */
static void open_node(struct mesh_sweep *search, uint32_t level, uint32_t node)
{
    const struct surface *surface = search->surface;
    struct sweep_node *opened = &search->progress->path[level];
    uint32_t children = level ? surface->count[level - 1] : surface_triangles(surface);
    work_spend(search->work, 1);
    search->progress->level = level;
    opened->node = node;
    opened->lanes = lanes_of(children - node * LANES);
    if (level)
        opened->lanes &= search->kernel->swept_boxes(
            surface->level[level] + (size_t)node * MESH_BOX_WORDS, &search->swath, opened->bound);
    else
        opened->lanes &= search->kernel->swept_triangles(
            surface->leaves + (size_t)node * MESH_LEAF_WORDS, &search->swath, opened->bound);
}

/* Above the root is a node of which it is the one child. */
static void begin(struct mesh_sweep *search, uint32_t hint)
{
    struct sweep_progress *progress = search->progress;
    progress->begun = 1;
    progress->hint = hint;
    progress->triangle = DPT_NONE;
    progress->to = 1.0;
    progress->level = search->surface->levels + 1;
    progress->path[progress->level] = (struct sweep_node){ .lanes = 1 };
    swept_hull_of(search, &search->swath);
    if (hint < surface_triangles(search->surface))
        ask(search, hint);
}

/* 0 when the work is spent. */
static int go_on(struct mesh_sweep *search)
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
            ask(search, child);
    }
}

int dpti_sweep_mesh(const struct surface *surface, const struct kernel *kernel,
                    const struct sweep *sweep, double from, uint32_t hint, struct work *work,
                    struct sweep_progress *progress, struct impact *first)
{
    struct mesh_sweep search;
    search.surface = surface;
    search.kernel = kernel;
    search.sweep = sweep;
    search.from = from;
    search.work = work;
    search.progress = progress;
    *first = (struct impact){ .time = 1.0, .triangle = DPT_NONE };
    if (from >= 1.0)
        return SWEEP_FREE;
    if (progress->begun)
        swept_hull_of(&search, &search.swath);
    else
        begin(&search, hint);
    int done = go_on(&search);
    progress->begun = !done;
    first->time = done ? progress->to : from;
    if (!done || progress->triangle == DPT_NONE)
        return done ? SWEEP_FREE : SWEEP_UNFINISHED;
    vec3 a, u;
    dpti_sweep_axis(sweep, progress->to, &a, &u);
    first->triangle = progress->triangle;
    first->pair = dpti_triangle_pair(surface, progress->triangle, a, u);
    first->q = sub(along(a, first->pair.s, u), first->pair.gap);
    return SWEEP_HIT;
}
