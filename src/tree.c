/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Depth first, nearest child first, through a tree that is 16 wide (docs/algorithms/tree.md). Bounds
 * are float and sound by KERNEL_MARGIN; what they cannot rule out is evaluated in double. So float
 * decides how long it takes, never what the answer is.
 */
#include "tree.h"

struct search {
    const struct tree *tree;
    struct nearest *nearest;
    vec3 a, u;
    struct probe probe;
    float margin;
    float limit; /* what lies beyond cannot be the answer, in the filter's frame */
    int has_plane;
};

/* A node still to be looked into. */
struct visit {
    float bound;
    uint32_t level; /* 0 is a leaf */
    uint32_t node;
};

void tree_of_mesh(const struct dpt_mesh *mesh, struct tree *tree)
{
    uint64_t nodes;
    tree->mesh = mesh;
    tree->positions = mesh_floats(mesh, MESH_VERTICES);
    tree->corners = mesh_words(mesh, MESH_TRIANGLES);
    tree->sources = mesh_words(mesh, MESH_SOURCES);
    tree->leaves = mesh_floats(mesh, MESH_LEAVES);
    tree->levels = mesh_levels(mesh->leaves, tree->count, &nodes);
    tree->level[0] = NULL;
    const float *level = mesh_floats(mesh, MESH_BOXES);
    for (uint32_t l = 1; l <= tree->levels; l++) {
        tree->level[l] = level;
        level += (size_t)tree->count[l] * MESH_BOX_WORDS;
    }
}

double tree_extent(const struct tree *tree)
{
    return larger(extent_of(vec3_of(tree->mesh->box_min)), extent_of(vec3_of(tree->mesh->box_max)));
}

pair tree_pair(const struct tree *tree, uint32_t triangle, vec3 a, vec3 u)
{
    const uint32_t *corner = tree->corners + 3 * (size_t)triangle;
    return segment_triangle(a, u, vec3_of_float(tree->positions + 3 * (size_t)corner[0]),
                            vec3_of_float(tree->positions + 3 * (size_t)corner[1]),
                            vec3_of_float(tree->positions + 3 * (size_t)corner[2]));
}

/* As near, the lower source number wins: the same answer in whatever order triangles are tried. */
static int try_triangle(const struct tree *tree, uint32_t triangle, vec3 a, vec3 u,
                        struct nearest *nearest)
{
    pair found = tree_pair(tree, triangle, a, u);
    if (found.distance2 > nearest->pair.distance2 ||
        (found.distance2 == nearest->pair.distance2 && nearest->triangle != DPT_NONE &&
         tree->sources[triangle] >= tree->sources[nearest->triangle]))
        return 0;
    nearest->pair = found;
    nearest->triangle = triangle;
    return 1;
}

void tree_brute(const struct tree *tree, vec3 a, vec3 u, struct nearest *nearest)
{
    for (uint32_t t = 0; t < tree->mesh->triangles; t++)
        try_triangle(tree, t, a, u, nearest);
    nearest->work += tree->mesh->leaves;
}

static void put_float(vec3 v, float out[3])
{
    out[0] = (float)v.x;
    out[1] = (float)v.y;
    out[2] = (float)v.z;
}

/* Two unit vectors that make a right-handed frame with the unit vector x. */
static void complete_frame(vec3 x, vec3 *y, vec3 *z)
{
    double ax = fabs(x.x), ay = fabs(x.y), az = fabs(x.z);
    vec3 least = { ax <= ay && ax <= az, ay < ax && ay <= az, az < ax && az < ay };
    *y = cross(least, x);
    *y = scaled(*y, 1.0 / length(*y));
    *z = cross(x, *y);
}

static void take_axis(struct search *search)
{
    const struct dpt_mesh *mesh = search->tree->mesh;
    double scale = mesh->filter_scale;
    vec3 a = scaled(sub(search->a, vec3_of(mesh->filter_centre)), scale);
    double axis = length(search->u);
    vec3 x = axis > 0.0 ? scaled(search->u, 1.0 / axis) : (vec3){ 1.0, 0.0, 0.0 }, y, z;
    complete_frame(x, &y, &z);
    put_float(a, search->probe.a);
    put_float(x, search->probe.x);
    put_float(y, search->probe.y);
    put_float(z, search->probe.z);
    search->probe.length = (float)(axis * scale);
    double reach = length(a) + length(along(a, scale, search->u));
    search->margin = KERNEL_MARGIN * (1.0f + (float)reach);
}

/*
 * Take over a new best distance, and the plane through its pair: what lies behind that plane, most of
 * the mesh near a contact, is ruled out by three dot products.
 */
static void set_limit(struct search *search)
{
    const struct dpt_mesh *mesh = search->tree->mesh;
    const struct nearest *nearest = search->nearest;
    double distance = sqrt(nearest->pair.distance2);
    search->limit = (float)(distance * mesh->filter_scale) * (1.0f + 0x1p-22f) + search->margin;
    search->has_plane = nearest->triangle != DPT_NONE && distance > 0.0;
    if (!search->has_plane)
        return;
    vec3 normal = scaled(nearest->pair.gap, -1.0 / distance);
    vec3 from_centre = sub(search->a, vec3_of(mesh->filter_centre));
    double height = dot(normal, from_centre) + larger(0.0, dot(normal, search->u));
    put_float(normal, search->probe.normal);
    search->probe.height = (float)(height * mesh->filter_scale);
}

/* A bound that is no number decides nothing. */
static int may_hold(const struct search *search, float bound)
{
    return !(bound > search->limit);
}

/* The lane with the least bound of those in `lanes`. */
static uint32_t least_lane(const float *bound, uint32_t lanes)
{
    uint32_t best = (uint32_t)__builtin_ctz(lanes);
    for (uint32_t rest = lanes & (lanes - 1); rest; rest &= rest - 1) {
        uint32_t lane = (uint32_t)__builtin_ctz(rest);
        if (bound[lane] < bound[best])
            best = lane;
    }
    return best;
}

static uint32_t lanes_within(const struct search *search, const float *bound, uint32_t count)
{
    uint32_t lanes = 0;
    for (uint32_t i = 0; i < LANES; i++)
        lanes |= (uint32_t)may_hold(search, bound[i]) << i;
    return count < LANES ? lanes & ((1u << count) - 1) : lanes;
}

static void look_into_leaf(struct search *search, const struct kernel *kernel, uint32_t leaf)
{
    float bound[LANES];
    uint32_t first = leaf * LANES;
    uint32_t count = search->tree->mesh->triangles - first;
    const float *block = search->tree->leaves + (size_t)leaf * MESH_LEAF_WORDS;
    if (search->has_plane) {
        search->nearest->work++;
        kernel->planes(block, &search->probe, bound);
        if (!lanes_within(search, bound, count))
            return;
    }
    search->nearest->work++;
    kernel->triangles(block, &search->probe, bound);
    for (uint32_t lanes = lanes_within(search, bound, count); lanes;) {
        uint32_t lane = least_lane(bound, lanes);
        lanes &= ~(1u << lane);
        if (may_hold(search, bound[lane]) &&
            try_triangle(search->tree, first + lane, search->a, search->u, search->nearest))
            set_limit(search);
    }
}

/* Push the children that may hold the answer, the nearest one last. */
static struct visit *look_into_boxes(struct search *search, const struct kernel *kernel,
                                     uint32_t level, uint32_t node, struct visit *top)
{
    float bound[LANES];
    uint32_t first = node * LANES;
    kernel->boxes(search->tree->level[level] + (size_t)node * MESH_BOX_WORDS, &search->probe,
                  bound);
    search->nearest->work++;
    struct visit *base = top;
    uint32_t lanes = lanes_within(search, bound, search->tree->count[level - 1] - first);
    for (; lanes; lanes &= lanes - 1) {
        uint32_t lane = (uint32_t)__builtin_ctz(lanes);
        struct visit child = { bound[lane] > 0.0f ? bound[lane] : 0.0f, level - 1, first + lane };
        struct visit *at = top++;
        for (; at > base && at[-1].bound < child.bound; at--)
            *at = at[-1];
        *at = child;
    }
    return top;
}

void tree_search(const struct tree *tree, const struct kernel *kernel, vec3 a, vec3 u,
                 struct nearest *nearest)
{
    struct visit stack[MESH_LEVELS_MAX * LANES];
    struct search search = { .tree = tree, .nearest = nearest, .a = a, .u = u };
    take_axis(&search);
    set_limit(&search);
    struct visit *top = look_into_boxes(&search, kernel, tree->levels, 0, stack);
    while (top > stack && !(nearest->pair.distance2 == 0.0 && nearest->triangle != DPT_NONE)) {
        struct visit next = *--top;
        if (!may_hold(&search, next.bound))
            continue;
        if (next.level == 0)
            look_into_leaf(&search, kernel, next.node);
        else
            top = look_into_boxes(&search, kernel, next.level, next.node, top);
    }
}
