/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The first touch of a mesh: depth first through the box tree, nearest to the swept hull first, the
 * time shrinking with each hit (docs/algorithms/sweep.md). Float bounds say which triangles need
 * not be asked, sweep_pair answers.
 */
#include "sweep.h"

#include "probe.h"

/* A node whose children are being looked into. */
struct opened {
    float bound[LANES];
    uint32_t lanes;
    uint32_t node;
};

struct hunt {
    const struct tree *tree;
    const struct kernel *kernel;
    const struct sweep *sweep;
    double from, to;   /* what is searched; `to` is the first hit so far, if there is one */
    uint32_t triangle; /* that is hit then, or DPT_NONE */
    uint32_t asked;    /* distances evaluated */
    uint32_t blocks;   /* 16-lane blocks looked at */
    uint32_t most;
    struct swath swath;
};

static uint32_t spent(const struct hunt *hunt)
{
    return hunt->blocks + (hunt->asked + LANES - 1) / LANES;
}

static uint32_t lanes_of(uint32_t count)
{
    return count < LANES ? (1u << count) - 1 : 0xffff;
}

/*
 * The axes of a box around what the axis sweeps: of ends in the filter's frame, at both times. The
 * last one makes bounds and so must be of unit length: what is too short to have a direction gets
 * any.
 */
static void swath_box(const vec3 end[4], vec3 axis[3])
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
        struct probe any;
        probe_frame(&any, x);
        y = vec3_of_float(any.y);
        yy = dot(y, y);
    }
    axis[0] = x;
    axis[1] = scaled(y, 1.0 / sqrt(yy));
    axis[2] = cross(axis[0], axis[1]);
}

static void swath_of(const struct hunt *hunt, struct swath *swath)
{
    const struct dpt_mesh *mesh = hunt->tree->mesh;
    const double scale = mesh->filter_scale, times[2] = { hunt->from, hunt->to };
    vec3 end[4], axis[3];
    double far = 0.0;
    for (int k = 0; k < 2; k++) {
        vec3 a, u;
        sweep_axis(hunt->sweep, times[k], &a, &u);
        end[2 * k] = scaled(sub(a, vec3_of(mesh->filter_centre)), scale);
        end[2 * k + 1] = along(end[2 * k], scale, u);
    }
    for (int k = 0; k < 4; k++) {
        put_float(end[k], swath->end[k]);
        far = larger(far, dot(end[k], end[k]));
    }
    swath_box(end, axis);
    vec3 centre = { 0.0, 0.0, 0.0 };
    for (int k = 0; k < 3; k++) {
        double low = HUGE_VAL, high = -HUGE_VAL;
        for (int e = 0; e < 4; e++) {
            low = smaller(low, dot(end[e], axis[k]));
            high = larger(high, dot(end[e], axis[k]));
        }
        centre = along(centre, 0.5 * (low + high), axis[k]);
        swath->half[k] = (float)(0.5 * (high - low));
        put_float(axis[k], swath->axis[k]);
    }
    put_float(centre, swath->centre);
    double limit = hunt->sweep->beyond * scale * (1.0 + KERNEL_STRETCH);
    swath->limit = (float)(limit + kernel_margin(sqrt(far), sqrt(far)));
}

/* One triangle, in double. 0 when the work allowed ran out. */
static int ask(struct hunt *hunt, uint32_t triangle)
{
    const struct tree *tree = hunt->tree;
    const uint32_t *of = tree->corners + 3 * (size_t)triangle;
    const vec3 corner[3] = { vec3_of_float(tree->positions + 3 * (size_t)of[0]),
                             vec3_of_float(tree->positions + 3 * (size_t)of[1]),
                             vec3_of_float(tree->positions + 3 * (size_t)of[2]) };
    uint64_t most = (uint64_t)LANES * (hunt->most - hunt->blocks);
    double time;
    int result = sweep_pair(hunt->sweep, corner, hunt->to,
                            most < UINT32_MAX ? (uint32_t)most : UINT32_MAX, &time, &hunt->asked);
    if (result != SWEEP_HIT || (time == hunt->to && hunt->triangle != DPT_NONE &&
                                tree->sources[triangle] >= tree->sources[hunt->triangle]))
        return result != SWEEP_UNFINISHED;
    int sooner = time < hunt->to;
    hunt->to = time;
    hunt->triangle = triangle;
    if (sooner)
        swath_of(hunt, &hunt->swath);
    return 1;
}

/* 0 when the work allowed ran out. */
static int look_into_leaf(struct hunt *hunt, uint32_t leaf, uint32_t hint)
{
    float bound[LANES];
    const struct tree *tree = hunt->tree;
    hunt->blocks++;
    uint32_t lanes = hunt->kernel->swept_triangles(tree->leaves + (size_t)leaf * MESH_LEAF_WORDS,
                                                   &hunt->swath, bound);
    lanes &= lanes_of(tree->mesh->triangles - leaf * LANES);
    while (lanes) {
        uint32_t lane = least_lane(bound, lanes);
        lanes &= ~(1u << lane);
        if (leaf * LANES + lane != hint && !ask(hunt, leaf * LANES + lane))
            return 0;
    }
    return 1;
}

static void look_into_boxes(struct hunt *hunt, uint32_t level, uint32_t node, struct opened *opened)
{
    const struct tree *tree = hunt->tree;
    hunt->blocks++;
    opened->node = node;
    opened->lanes = hunt->kernel->swept_boxes(tree->level[level] + (size_t)node * MESH_BOX_WORDS,
                                              &hunt->swath, opened->bound) &
                    lanes_of(tree->count[level - 1] - node * LANES);
}

/* 0 when the work allowed ran out. */
static int hunt_all(struct hunt *hunt, uint32_t hint)
{
    struct opened path[MESH_LEVELS_MAX + 1];
    uint32_t level = hunt->tree->levels;
    swath_of(hunt, &hunt->swath);
    if (hint < hunt->tree->mesh->triangles && !ask(hunt, hint))
        return 0;
    if (spent(hunt) >= hunt->most)
        return 0;
    look_into_boxes(hunt, level, 0, &path[level]);
    while (level <= hunt->tree->levels) {
        struct opened *opened = &path[level];
        if (!opened->lanes) {
            level++;
            continue;
        }
        if (spent(hunt) >= hunt->most)
            return 0;
        uint32_t lane = least_lane(opened->bound, opened->lanes);
        uint32_t child = opened->node * LANES + lane;
        opened->lanes &= ~(1u << lane);
        if (level > 1)
            look_into_boxes(hunt, level - 1, child, &path[level - 1]);
        else if (!look_into_leaf(hunt, child, hint))
            return 0;
        level -= level > 1;
    }
    return 1;
}

int sweep_mesh(const struct tree *tree, const struct kernel *kernel, const struct sweep *sweep,
               double from, uint32_t hint, uint32_t most, struct strike *first, uint32_t *work)
{
    struct hunt hunt;
    hunt.tree = tree;
    hunt.kernel = kernel;
    hunt.sweep = sweep;
    hunt.from = from;
    hunt.to = 1.0;
    hunt.triangle = DPT_NONE;
    hunt.asked = hunt.blocks = 0;
    hunt.most = most ? most : UINT32_MAX;
    int done = from >= 1.0 || hunt_all(&hunt, hint);
    *work += spent(&hunt);
    *first = (struct strike){ .time = done ? hunt.to : from, .triangle = DPT_NONE };
    if (!done || hunt.triangle == DPT_NONE)
        return done ? SWEEP_FREE : SWEEP_UNFINISHED;
    vec3 a, u;
    sweep_axis(sweep, hunt.to, &a, &u);
    first->triangle = hunt.triangle;
    first->pair = tree_pair(tree, hunt.triangle, a, u);
    first->q = sub(along(a, first->pair.s, u), first->pair.gap);
    return SWEEP_HIT;
}
