/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Depth first, nearest child first, through a tree that is 16 wide (docs/algorithms/tree.md). Bounds
 * are float and sound by KERNEL_MARGIN; what they cannot rule out is evaluated in double. So float
 * decides how long it takes, never what the answer is.
 */
#include "tree.h"

struct search {
    const struct tree *tree;
    const struct kernel *kernel;
    struct keeper keeper;
    struct nearest *nearest;
    vec3 a, u;
    double slack;
    struct probe probe;
    int has_frame; /* the probe's, made when first needed */
    int has_plane;
    struct front front; /* of the best pair */
    float margin;
    struct walk *walk;
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
    tree->first[0] = 0;
    for (uint32_t l = 1; l <= tree->levels; l++)
        tree->first[l] = tree->first[l - 1] + tree->count[l - 1];
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

struct front tree_front(const pair *found, vec3 a, vec3 u, double slack)
{
    double distance = sqrt(found->distance2);
    vec3 normal = scaled(found->gap, -1.0 / distance);
    double reach = dot(normal, a) + larger(0.0, dot(normal, u));
    return (struct front){ normal, reach + distance - slack };
}

int tree_is_beyond(const struct tree *tree, const struct front *front, uint32_t triangle)
{
    const uint32_t *corner = tree->corners + 3 * (size_t)triangle;
    for (int k = 0; k < 3; k++)
        if (!(dot(front->normal, vec3_of_float(tree->positions + 3 * (size_t)corner[k])) >=
              front->beyond))
            return 0;
    return 1;
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
    vec3 b = along(a, scale, search->u);
    put_float(a, search->probe.a);
    put_float(b, search->probe.b);
    search->margin = KERNEL_MARGIN * (1.0f + (float)(length(a) + length(b)));
}

static void take_frame(struct search *search)
{
    if (search->has_frame)
        return;
    double axis = length(search->u);
    vec3 x = axis > 0.0 ? scaled(search->u, 1.0 / axis) : (vec3){ 1.0, 0.0, 0.0 }, y, z;
    complete_frame(x, &y, &z);
    put_float(x, search->probe.x);
    put_float(y, search->probe.y);
    put_float(z, search->probe.z);
    search->probe.length = (float)(axis * search->tree->mesh->filter_scale);
    search->has_frame = 1;
}

static float reach_of(const struct probe *probe, const float n[3])
{
    float at_a = n[0] * probe->a[0] + n[1] * probe->a[1] + n[2] * probe->a[2];
    float at_b = n[0] * probe->b[0] + n[1] * probe->b[1] + n[2] * probe->b[2];
    return at_a > at_b ? at_a : at_b;
}

/*
 * Take over a new best distance, and the plane through its pair: what lies behind that plane, most of
 * the mesh near a contact, is ruled out by three dot products.
 */
static void set_limit(struct search *search)
{
    const struct nearest *nearest = search->nearest;
    struct probe *probe = &search->probe;
    double distance = sqrt(nearest->pair.distance2);
    probe->limit =
        (float)(distance * search->tree->mesh->filter_scale) * (1.0f + 0x1p-22f) + search->margin;
    search->has_plane = nearest->triangle != DPT_NONE && distance > 0.0;
    if (!search->has_plane)
        return;
    search->front = tree_front(&nearest->pair, search->a, search->u, search->slack);
    put_float(search->front.normal, probe->normal);
    probe->height = reach_of(probe, probe->normal);
}

/* The lane with the least bound of those in `lanes`; one that is no number comes first. */
static uint32_t least_lane(const float *bound, uint32_t lanes)
{
    uint32_t best = (uint32_t)__builtin_ctz(lanes);
    for (uint32_t rest = lanes & (lanes - 1); rest; rest &= rest - 1) {
        uint32_t lane = (uint32_t)__builtin_ctz(rest);
        if (bound[lane] < bound[best] || bound[lane] != bound[lane])
            best = lane;
    }
    return best;
}

static uint32_t lanes_of(uint32_t count)
{
    return count < LANES ? (1u << count) - 1 : 0xffff;
}

/* Take over the planes, and their bounds, of the lanes that they close. */
static void take_planes(struct planes *planes, const struct planes *made, float *bound,
                        const float *made_bound, uint32_t lanes)
{
    for (; lanes; lanes &= lanes - 1) {
        uint32_t i = (uint32_t)__builtin_ctz(lanes);
        planes_put(planes, i, (const float[3]){ made->x[i], made->y[i], made->z[i] },
                   made->support[i]);
        bound[i] = made_bound[i];
    }
}

/* A node's 16 planes, empty unless they are its own. */
struct kept {
    struct block *block; /* NULL: nothing is kept */
    int empty;
};

static struct kept find(const struct search *search, uint32_t node)
{
    struct kept kept = { keeper_block(&search->keeper, node), 1 };
    uint64_t key = keeper_key(&search->keeper, node);
    if (kept.block) {
        kept.empty = kept.block->key != key;
        kept.block->key = key;
    }
    return kept;
}

static uint32_t look_at_planes(struct search *search, const struct kept *kept, float *bound)
{
    search->nearest->work++;
    return search->kernel->held(&kept->block->planes, &search->probe, bound);
}

/* How many blocks may still be looked at. */
static uint32_t spare(const struct search *search)
{
    const struct nearest *nearest = search->nearest;
    return nearest->most ? nearest->most - nearest->work : UINT32_MAX;
}

/* New planes where there are none, or for the lanes that they close. Returns those still open. */
static uint32_t renew(struct search *search, kernel_renew *make, const float *rows,
                      const struct kept *kept, uint32_t lanes, float *bound)
{
    struct planes made;
    float made_bound[LANES];
    take_frame(search);
    search->nearest->work++;
    if (kept->empty) {
        lanes &= make(rows, &search->probe, kept->block ? &kept->block->planes : &made, bound);
    } else {
        uint32_t open = make(rows, &search->probe, &made, made_bound);
        take_planes(&kept->block->planes, &made, bound, made_bound, lanes & ~open);
        lanes &= open;
    }
    return lanes;
}

/* The plane through the best pair, for a whole leaf: its parent keeps it. */
static void close_leaf(const struct search *search, uint32_t leaf, const float *low)
{
    struct block *parent = keeper_own(&search->keeper, search->tree->first[1] + leaf / LANES);
    float support = low[0];
    for (int i = 1; i < LANES; i++)
        support = low[i] < support ? low[i] : support;
    if (parent)
        planes_put(&parent->planes, leaf % LANES, search->probe.normal, support);
}

/*
 * The triangles of a leaf that may be nearer: those that neither the plane through the best pair nor a
 * plane of their own rules out.
 */
static uint32_t open_triangles(struct search *search, uint32_t leaf, uint32_t lanes, float *bound)
{
    const float *rows = search->tree->leaves + (size_t)leaf * MESH_LEAF_WORDS;
    float low[LANES];
    uint32_t open = lanes;
    if (search->has_plane && spare(search) > 1) {
        search->nearest->work++;
        open = search->kernel->common(rows, &search->probe, low);
        if (!open) {
            close_leaf(search, leaf, low);
            return 0;
        }
        open &= lanes;
    }
    struct kept kept = find(search, leaf);
    kept.empty |= spare(search) < 2;
    if (!kept.empty) {
        lanes &= look_at_planes(search, &kept, bound);
        for (uint32_t rest = lanes & ~open; rest; rest &= rest - 1) {
            uint32_t i = (uint32_t)__builtin_ctz(rest);
            planes_put(&kept.block->planes, i, search->probe.normal, low[i]);
        }
        lanes &= open;
        if (!lanes)
            return 0;
    }
    return open & renew(search, search->kernel->triangles, rows, &kept, lanes, bound);
}

static void look_into_leaf(struct search *search, uint32_t leaf)
{
    float bound[LANES];
    const struct tree *tree = search->tree;
    uint32_t first = leaf * LANES;
    uint32_t lanes = lanes_of(tree->mesh->triangles - first);
    uint32_t known = search->nearest->triangle - first;
    if (known < LANES)
        lanes &= ~(1u << known);
    lanes = open_triangles(search, leaf, lanes, bound);
    while (lanes) {
        uint32_t lane = least_lane(bound, lanes);
        lanes &= ~(1u << lane);
        if (bound[lane] > search->probe.limit)
            return;
        if (search->slack > 0.0 && search->has_plane &&
            tree_is_beyond(tree, &search->front, first + lane))
            continue;
        if (try_triangle(tree, first + lane, search->a, search->u, search->nearest))
            set_limit(search);
    }
}

static void look_into_boxes(struct search *search, uint32_t level, uint32_t node)
{
    struct visit *visit = &search->walk->level[level];
    const struct tree *tree = search->tree;
    const float *rows = tree->level[level] + (size_t)node * MESH_BOX_WORDS;
    struct kept kept = find(search, tree->first[level] + node);
    kept.empty |= spare(search) < 2;
    visit->node = node;
    visit->lanes = lanes_of(tree->count[level - 1] - node * LANES);
    if (!kept.empty)
        visit->lanes &= look_at_planes(search, &kept, visit->bound);
    if (kept.empty || visit->lanes)
        visit->lanes =
            renew(search, search->kernel->boxes, rows, &kept, visit->lanes, visit->bound);
}

static int meets(const struct nearest *nearest)
{
    return nearest->pair.distance2 == 0.0 && nearest->triangle != DPT_NONE;
}

int tree_walk(const struct tree *tree, const struct kernel *kernel, const struct keeper *keeper,
              vec3 a, vec3 u, double slack, struct walk *walk, struct nearest *nearest)
{
    struct search search;
    search.tree = tree;
    search.kernel = kernel;
    search.keeper = keeper ? *keeper : (struct keeper){ NULL, 0 };
    search.nearest = nearest;
    search.a = a;
    search.u = u;
    search.slack = slack;
    search.has_frame = 0;
    search.walk = walk;
    take_axis(&search);
    set_limit(&search);
    uint32_t level = walk->at;
    if (!level && spare(&search)) {
        level = tree->levels;
        look_into_boxes(&search, level, 0);
    }
    while (level && level <= tree->levels && !meets(nearest)) {
        struct visit *visit = &walk->level[level];
        uint32_t lane = visit->lanes ? least_lane(visit->bound, visit->lanes) : LANES;
        if (lane == LANES || visit->bound[lane] > search.probe.limit) {
            level++;
            continue;
        }
        if (!spare(&search))
            break;
        visit->lanes &= ~(1u << lane);
        if (level == 1)
            look_into_leaf(&search, visit->node * LANES + lane);
        else
            look_into_boxes(&search, --level, visit->node * LANES + lane);
    }
    int done = level > tree->levels || meets(nearest);
    walk->at = done ? 0 : level;
    return done;
}

void tree_search(const struct tree *tree, const struct kernel *kernel, const struct keeper *keeper,
                 vec3 a, vec3 u, double slack, struct nearest *nearest)
{
    struct walk walk;
    walk.at = 0;
    tree_walk(tree, kernel, keeper, a, u, slack, &walk, nearest);
}

/* That a margin grows with the ends, and rounding here, is in the factors. */
void walk_drift(struct walk *walk, const struct tree *tree, double motion)
{
    float drop = (float)(motion * tree->mesh->filter_scale * (1.0 + 0x1p-16));
    for (uint32_t l = walk->at; l && l <= tree->levels; l++) {
        float *bound = walk->level[l].bound;
        for (int i = 0; i < LANES; i++)
            bound[i] = bound[i] - drop - 0x1p-22f * fabsf(bound[i]);
    }
}

double walk_ahead(const struct walk *walk, const struct tree *tree, vec3 a, vec3 u)
{
    struct search search = { .tree = tree, .a = a, .u = u };
    take_axis(&search);
    double least = HUGE_VAL;
    for (uint32_t l = walk->at; l <= tree->levels; l++) {
        const struct visit *visit = &walk->level[l];
        if (!visit->lanes)
            continue;
        double ahead = visit->bound[least_lane(visit->bound, visit->lanes)] - search.margin;
        if (!(ahead > 0.0))
            return 0.0;
        least = smaller(least, ahead);
    }
    return least / tree->mesh->filter_scale;
}
