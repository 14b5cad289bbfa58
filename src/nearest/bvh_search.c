/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Depth first, nearest child first, through a tree that is 16 wide (docs/algorithms/tree.md). Bounds
 * are float and sound by kernel_margin; what they cannot rule out is evaluated in double. So float
 * decides how long it takes, never what the answer is.
 */
#include "nearest/bvh.h"

#include "nearest/filter_segment.h"

/* A node's 16 planes, empty unless they are its own. */
struct kept {
    struct block *block; /* NULL: nothing is kept */
    uint32_t number;     /* of the node */
    int empty;
};

struct search {
    const struct surface *surface;
    const struct kernel *kernel;
    struct keeper keeper;
    struct nearest *nearest;
    uint32_t most; /* work */
    vec3 a, u, x;  /* x: unit, along u */
    double slack;
    struct probe probe;
    int has_frame; /* the probe's y and z, made when first needed */
    int has_plane;
    struct walk *walk;
};

pair tree_pair(const struct surface *surface, uint32_t triangle, vec3 a, vec3 u)
{
    vec3 v[3];
    surface_corners(surface, triangle, v);
    if (extent_of(u) > 0.0)
        return segment_triangle(a, u, v[0], v[1], v[2]);
    pair found;
    point_triangle(a, v, &found);
    return found;
}

void tree_point(const struct surface *surface, uint32_t triangle, vec3 x, pair *found)
{
    vec3 v[3];
    surface_corners(surface, triangle, v);
    point_triangle(x, v, found);
}

void nearest_front(struct nearest *nearest, vec3 a, vec3 u, double slack)
{
    const pair *found = &nearest->pair;
    if (nearest->front_of == nearest->triangle + 1)
        return;
    vec3 normal = scaled(found->gap, -1.0 / sqrt(found->distance2));
    double rise = dot(normal, u), uu = dot(u, u);
    if (found->s <= 0.0)
        rise = larger(rise, 0.0);
    else if (found->s >= 1.0)
        rise = smaller(rise, 0.0);
    nearest->front = (struct front){ normal, sub(along(a, found->s, u), found->gap),
                                     uu > 0.0 ? rise * rise / uu : 0.0, slack };
    nearest->front_of = nearest->triangle + 1;
}

/* height >= lean |c - at| - slack is concave along a triangle: where its corners hold it, all of it does. */
int tree_is_beyond(const struct surface *surface, const struct front *front, uint32_t triangle)
{
    const uint32_t *corner = surface->corners + 3 * (size_t)triangle;
    int beyond = 1;
    for (int k = 0; k < 3; k++) {
        vec3 c = sub(vec3_of_float(surface->positions + 3 * (size_t)corner[k]), front->at);
        double height = dot(front->normal, c) + front->slack;
        beyond &= (height >= 0.0) & (height * height >= front->lean2 * dot(c, c));
    }
    return beyond;
}

/* As near, the lower source number wins: the same answer in whatever order triangles are tried. */
static int take_pair(const struct surface *surface, uint32_t triangle, const pair *found,
                     struct nearest *nearest)
{
    if (found->distance2 > nearest->pair.distance2 ||
        (found->distance2 == nearest->pair.distance2 && nearest->triangle != DPT_NONE &&
         surface->sources[triangle] >= surface->sources[nearest->triangle]))
        return 0;
    nearest->pair = *found;
    nearest->triangle = triangle;
    return 1;
}

int tree_try_point(const struct surface *surface, uint32_t triangle, vec3 x,
                   struct nearest *nearest)
{
    pair found;
    tree_point(surface, triangle, x, &found);
    return take_pair(surface, triangle, &found, nearest);
}

void tree_brute(const struct surface *surface, vec3 a, vec3 u, struct nearest *nearest)
{
    for (uint32_t t = 0; t < surface_triangles(surface); t++) {
        pair found = tree_pair(surface, t, a, u);
        take_pair(surface, t, &found, nearest);
    }
    nearest->work += surface->mesh->leaves;
}

/*
 * Take over a new best distance, and the plane through its pair: what lies behind that plane, most of
 * the mesh near a contact, is ruled out by three dot products.
 */
static void set_limit(struct search *search)
{
    struct nearest *nearest = search->nearest;
    struct probe *probe = &search->probe;
    double distance = sqrt(nearest->pair.distance2);
    probe_limit(probe, search->surface, distance);
    search->has_plane = nearest->triangle != DPT_NONE && distance > 0.0;
    if (!search->has_plane)
        return;
    nearest_front(nearest, search->a, search->u, search->slack);
    put_float(nearest->front.normal, probe->normal);
    probe->height = probe_reach(probe, probe->normal);
}

/* How many blocks may still be looked at. */
static uint32_t spare(const struct search *search)
{
    return search->most - search->nearest->work;
}

/* With one block left to look at, what is kept is left alone. */
static inline struct kept find(const struct search *search, uint32_t number)
{
    const struct keeper *keeper = &search->keeper;
    struct block *block = spare(search) > 1 ? keeper_block(keeper, number) : NULL;
    int empty = !block || block->key != keeper_key(keeper, number);
    if (!empty && keeper->anew)
        return (struct kept){ NULL, number, 1 };
    return (struct kept){ block, number, empty };
}

/* By now. */
static int is_own(const struct search *search, const struct kept *kept)
{
    return kept->block && kept->block->key == keeper_key(&search->keeper, kept->number);
}

static uint32_t look_at_planes(struct search *search, kernel_held *held, const float *rows,
                               const struct kept *kept, float *bound)
{
    search->nearest->work++;
    return held(rows, &search->probe, &kept->block->planes, bound);
}

/* New planes where there are none, or where they are better. Returns those still open. */
static uint32_t renew(struct search *search, kernel_renew *make, const float *rows,
                      const struct kept *kept, uint32_t lanes, float *bound)
{
    struct planes made;
    float made_bound[LANES];
    search->nearest->work++;
    if (kept->empty) {
        lanes &= make(rows, &search->probe, kept->block ? &kept->block->planes : &made, bound);
        if (kept->block) {
            kept->block->key = keeper_key(&search->keeper, kept->number);
            kept->block->wait = 1; /* its parent's planes are as new */
            kept->block->pause = 0;
        }
    } else {
        uint32_t open = make(rows, &search->probe, &made, made_bound);
        search->kernel->better(&made, made_bound, &kept->block->planes, bound);
        lanes &= open;
    }
    return lanes;
}

static float least_of(const float *low)
{
    float m[8];
    for (int i = 0; i < 8; i++)
        m[i] = low[i] < low[i + 8] ? low[i] : low[i + 8];
    for (int i = 0; i < 4; i++)
        m[i] = m[i] < m[i + 4] ? m[i] : m[i + 4];
    m[0] = m[0] < m[2] ? m[0] : m[2];
    m[1] = m[1] < m[3] ? m[1] : m[3];
    return m[0] < m[1] ? m[0] : m[1];
}

static void put_plane(struct block *block, uint32_t lane, const float normal[3], float support)
{
    planes_put(&block->planes, lane, normal, support);
    block->open &= ~(1u << lane);
}

/* The support along n of what lies below a lane of a node: of its triangles, or of its children's boxes. */
static float support_below(struct search *search, uint32_t level, size_t child, const float n[3])
{
    const struct surface *surface = search->surface;
    const struct kernel *kernel = search->kernel;
    float low[LANES];
    search->nearest->work++;
    if (level == 1)
        kernel->common_triangles(surface->leaves + child * MESH_LEAF_WORDS, n, 0.0f, low);
    else
        kernel->common_boxes(surface->level[level - 1] + child * MESH_BOX_WORDS, n, 0.0f, low);
    return least_of(low);
}

/*
 * One plane for a lane of a node, in the direction that `boxes` takes, with the support of what lies below. Such a
 * plane lasts longer than that of a box. Returns 1 when it closes the lane.
 */
static int refine(struct search *search, uint32_t level, uint32_t node, uint32_t lane,
                  struct block *block)
{
    const struct probe *p = &search->probe;
    const float *box = search->surface->level[level] + (size_t)node * MESH_BOX_WORDS + lane;
    float n[3], s = 0.0f, square = 0.0f;
    for (int k = 0; k < 3; k++)
        s += (box[k * LANES] - p->a[k]) * p->x[k];
    s = s > 0.0f ? s : 0.0f;
    s = s < p->length ? s : p->length;
    for (int k = 0; k < 3; k++) {
        n[k] = box[k * LANES] - p->a[k] - s * p->x[k];
        square += n[k] * n[k];
    }
    if (!(square > 0x1p-100f))
        return 0;
    float unit = 1.0f / sqrtf(square);
    for (int k = 0; k < 3; k++)
        n[k] *= unit;
    float support = support_below(search, level, (size_t)node * LANES + lane, n);
    if (!(support - probe_reach(p, n) > p->limit))
        return 0;
    put_plane(block, lane, n, support);
    return 1;
}

/* For leaves, along the normal of the best pair, which closes three of four. Returns those that it closes. */
static uint32_t refine_leaves(struct search *search, uint32_t node, uint32_t lanes,
                              struct block *block)
{
    const struct probe *p = &search->probe;
    uint32_t closed = 0;
    for (uint32_t rest = lanes; rest && spare(search); rest &= rest - 1) {
        uint32_t lane = first_lane(rest);
        float support = support_below(search, 1, (size_t)node * LANES + lane, p->normal);
        if (support - p->height > p->limit) {
            put_plane(block, lane, p->normal, support);
            closed |= 1u << lane;
        }
    }
    return closed;
}

/*
 * A node or leaf, the child of a lane of a node of this level, was looked into and nothing in it was open: that
 * lane's plane is lost, or was too weak. Try another; after each failure wait longer. `block` is the child's own.
 */
static void close_whole(struct search *search, struct block *block, uint32_t level, uint32_t child)
{
    enum { PAUSE_MOST = 15 };
    if (search->keeper.anew || !spare(search))
        return;
    if (block->wait) {
        block->wait--;
        return;
    }
    uint32_t node = child / LANES, lane = child % LANES;
    struct block *parent = keeper_own(&search->keeper, search->surface->first[level] + node);
    if (!parent || !(parent->open >> lane & 1))
        return;
    uint32_t pause = 2u * block->pause + 1;
    if (refine(search, level, node, lane, parent))
        pause = 0;
    block->pause = block->wait = (uint16_t)(pause < PAUSE_MOST ? pause : PAUSE_MOST);
}

/* The plane through the best pair, for a whole leaf: its parent keeps it. */
static void close_leaf(const struct search *search, uint32_t leaf, const float *low)
{
    struct block *parent = keeper_own(&search->keeper, search->surface->first[1] + leaf / LANES);
    if (parent)
        put_plane(parent, leaf % LANES, search->probe.normal, least_of(low));
}

/* A triangle was evaluated and is farther: the plane across its own connection is the best there is. */
static void close_triangle(const struct search *search, uint32_t leaf, uint32_t lane,
                           const pair *found)
{
    struct block *block = keeper_own(&search->keeper, leaf);
    const float *rows = search->surface->leaves + (size_t)leaf * MESH_LEAF_WORDS + lane;
    float n[3], low = HUGE_VALF;
    if (!block)
        return;
    put_float(scaled(found->gap, -1.0 / sqrt(found->distance2)), n);
    for (int k = 0; k < 9; k += 3) {
        float at =
            n[0] * rows[k * LANES] + n[1] * rows[(k + 1) * LANES] + n[2] * rows[(k + 2) * LANES];
        low = at < low ? at : low;
    }
    if (low - probe_reach(&search->probe, n) > search->probe.limit)
        put_plane(block, lane, n, low);
}

/*
 * The triangles of a leaf that may be nearer: those that neither their own planes nor the plane through the best
 * pair rules out. `wanted`: where that plane rules out all of them, the parent is to have it.
 */
static uint32_t open_triangles(struct search *search, uint32_t leaf, const struct kept *kept,
                               uint32_t lanes, int wanted, float *bound)
{
    const float *rows = search->surface->leaves + (size_t)leaf * MESH_LEAF_WORDS;
    const struct probe *probe = &search->probe;
    float low[LANES];
    if (!kept->empty) {
        lanes &= look_at_planes(search, search->kernel->held_triangles, rows, kept, bound);
        wanted = wanted && !kept->block->wait;
        if (!lanes && !wanted)
            return 0;
    }
    if (search->has_plane && !search->keeper.anew && spare(search) > 1) {
        search->nearest->work++;
        uint32_t open = search->kernel->common_triangles(rows, probe->normal,
                                                         probe->height + probe->limit, low);
        if (!open && wanted)
            close_leaf(search, leaf, low);
        for (uint32_t rest = kept->empty ? 0 : lanes & ~open; rest; rest &= rest - 1) {
            uint32_t i = first_lane(rest);
            put_plane(kept->block, i, probe->normal, low[i]);
        }
        lanes &= open;
        if (!lanes)
            return 0;
    }
    if (kept->empty || lanes & ~kept->block->open) {
        if (!search->has_frame)
            probe_frame(&search->probe, search->x);
        search->has_frame = 1;
        lanes = renew(search, search->kernel->triangles, rows, kept, lanes, bound);
    }
    if (kept->block)
        kept->block->open = lanes;
    return lanes;
}

/* Of these triangles, from `first` on, those of which nothing is known. */
static uint32_t unknown_triangles(const struct nearest *nearest, uint32_t first, uint32_t lanes)
{
    if (nearest->triangle - first < LANES)
        lanes &= ~(1u << (nearest->triangle - first));
    for (uint32_t i = 0; i < nearest->tried_count; i++)
        if (nearest->tried[i] - first < LANES)
            lanes &= ~(1u << (nearest->tried[i] - first));
    return lanes;
}

static void look_into_leaf(struct search *search, uint32_t leaf)
{
    float bound[LANES];
    const struct surface *surface = search->surface;
    uint32_t first = leaf * LANES;
    uint32_t all = lanes_of(surface_triangles(surface) - first);
    uint32_t lanes = unknown_triangles(search->nearest, first, all);
    struct kept kept = find(search, leaf);
    int near = lanes != all;
    lanes = open_triangles(search, leaf, &kept, lanes, !near, bound);
    if (lanes || near)
        search->walk->level[1].found = 1;
    else if (is_own(search, &kept))
        close_whole(search, kept.block, 1, leaf);
    while (lanes) {
        uint32_t lane = least_lane(bound, lanes);
        lanes &= ~(1u << lane);
        if (bound[lane] > search->probe.limit)
            return;
        if (search->slack > 0.0 && search->has_plane &&
            tree_is_beyond(surface, &search->nearest->front, first + lane))
            continue;
        pair found = tree_pair(surface, first + lane, search->a, search->u);
        if (take_pair(surface, first + lane, &found, search->nearest))
            set_limit(search);
        else
            close_triangle(search, leaf, lane, &found);
    }
}

/* New planes for the lanes that lost theirs: for a few, better ones. Returns all that are still open. */
static uint32_t close_boxes(struct search *search, uint32_t level, uint32_t node,
                            const struct kept *kept, uint32_t lanes, float *bound)
{
    const float *rows = search->surface->level[level] + (size_t)node * MESH_BOX_WORDS;
    uint32_t lost = kept->empty ? lanes : lanes & ~kept->block->open;
    uint32_t but_one = lost & (lost - 1);
    int few = !(but_one & (but_one - 1));
    if (kept->empty || !few)
        return renew(search, search->kernel->boxes, rows, kept, lanes, bound);
    if (level == 1 && search->has_plane) {
        uint32_t closed = refine_leaves(search, node, lost, kept->block);
        lanes &= ~closed;
        lost &= ~closed;
    }
    for (; lost && spare(search); lost &= lost - 1) {
        uint32_t lane = first_lane(lost);
        if (refine(search, level, node, lane, kept->block))
            lanes &= ~(1u << lane);
    }
    return lanes;
}

/* Its parent learns what was found. */
static void leave_boxes(struct search *search, struct block *block, uint32_t level)
{
    const struct visit *visit = &search->walk->level[level];
    if (level == search->surface->levels)
        return;
    if (visit->found)
        search->walk->level[level + 1].found = 1;
    else if (block)
        close_whole(search, block, level + 1, visit->node);
}

/* Look at all children but those of the lanes `but`, which are looked into anyway. 0: nothing is left to look into. */
static int look_into_boxes(struct search *search, uint32_t level, uint32_t node, uint32_t but)
{
    struct visit *visit = &search->walk->level[level];
    const struct surface *surface = search->surface;
    const float *rows = surface->level[level] + (size_t)node * MESH_BOX_WORDS;
    struct kept kept = find(search, surface->first[level] + node);
    uint32_t lanes = lanes_of(surface->count[level - 1] - node * LANES) & ~but;
    if (!kept.empty)
        lanes &= look_at_planes(search, search->kernel->held_boxes, rows, &kept, visit->bound);
    lanes = close_boxes(search, level, node, &kept, lanes, visit->bound);
    if (kept.block)
        kept.block->open = lanes | but;
    visit->node = node;
    visit->lanes = lanes;
    visit->found = but != 0;
    visit->least = 0.0f;
    if (lanes | but)
        return 1;
    leave_boxes(search, kept.block, level);
    return 0;
}

/*
 * Where the search begins: at the root; or, where the best triangle is that of a known tick, at its leaf, with all
 * nodes above it already looked at. No plane could close the way to it.
 */
static uint32_t begin(struct search *search)
{
    uint32_t level = search->surface->levels, known = search->nearest->triangle;
    if (!search->keeper.count || search->keeper.anew || search->slack == 0.0 || known == DPT_NONE ||
        spare(search) < 4 * (level + 1)) {
        return look_into_boxes(search, level, 0, 0) ? level : level + 1;
    }
    for (; level >= 1; level--) {
        uint32_t child = known >> 4 * level;
        look_into_boxes(search, level, child / LANES, 1u << child % LANES);
    }
    look_into_leaf(search, known / LANES);
    return 1;
}

/*
 * Nearest first: where there is no history the first crossing that is found is the answer, from wherever the search
 * begins; a search at rest costs as much as any from nothing; and where many are open it saves most. Of few that last
 * tick's planes left the order does not matter.
 */
static uint32_t next_lane(const struct search *search, const struct visit *visit)
{
    uint32_t many = visit->lanes;
    for (int i = 0; i < 4; i++)
        many &= many - 1;
    int any = !many && search->slack > 0.0 && !search->keeper.anew;
    return any ? first_lane(visit->lanes) : least_lane(visit->bound, visit->lanes);
}

static int meets(const struct nearest *nearest)
{
    return nearest->pair.distance2 == 0.0 && nearest->triangle != DPT_NONE;
}

int tree_walk(const struct surface *surface, const struct kernel *kernel,
              const struct keeper *keeper, vec3 a, vec3 u, double slack, struct walk *walk,
              struct nearest *nearest)
{
    struct search search;
    search.surface = surface;
    search.kernel = kernel;
    search.keeper = keeper ? *keeper : (struct keeper){ .count = 0 };
    search.nearest = nearest;
    search.a = a;
    search.u = u;
    search.slack = slack;
    search.most = nearest->most ? nearest->most : UINT32_MAX;
    search.has_frame = 0;
    search.walk = walk;
    search.x = probe_axis(&search.probe, surface, a, u);
    set_limit(&search);
    uint32_t level = walk->at;
    if (!level && spare(&search))
        level = begin(&search);
    while (level && level <= surface->levels && !meets(nearest)) {
        struct visit *visit = &walk->level[level];
        if (!visit->lanes) {
            leave_boxes(&search, keeper_own(&search.keeper, surface->first[level] + visit->node),
                        level);
            level++;
            continue;
        }
        uint32_t lane = next_lane(&search, visit);
        int closed = visit->bound[lane] > search.probe.limit;
        if (!closed && !spare(&search))
            break;
        visit->lanes &= ~(1u << lane);
        if (closed)
            continue;
        uint32_t child = visit->node * LANES + lane;
        if (level == 1) {
            look_into_leaf(&search, child);
        } else {
            float least = visit->bound[lane] > visit->least ? visit->bound[lane] : visit->least;
            if (look_into_boxes(&search, level - 1, child, 0))
                walk->level[--level].least = least;
        }
    }
    int done = level > surface->levels || meets(nearest);
    walk->at = done ? 0 : level;
    return done;
}

void tree_search(const struct surface *surface, const struct kernel *kernel,
                 const struct keeper *keeper, vec3 a, vec3 u, double slack, struct nearest *nearest)
{
    struct walk walk;
    walk.at = 0;
    tree_walk(surface, kernel, keeper, a, u, slack, &walk, nearest);
}

/* That a margin grows with the ends, and rounding here, is in the factors. */
void walk_drift(struct walk *walk, const struct surface *surface, double motion)
{
    float drop = (float)(motion * surface->filter_scale * (1.0 + 0x1p-16));
    for (uint32_t l = walk->at; l && l <= surface->levels; l++) {
        float *bound = walk->level[l].bound;
        walk->level[l].least -= drop + 0x1p-22f * fabsf(walk->level[l].least);
        for (int i = 0; i < LANES; i++)
            bound[i] = bound[i] - drop - 0x1p-22f * fabsf(bound[i]);
    }
}

double walk_ahead(const struct walk *walk, const struct surface *surface, vec3 a, vec3 u)
{
    struct probe probe;
    probe_axis(&probe, surface, a, u);
    double least = HUGE_VAL;
    for (uint32_t l = walk->at; l <= surface->levels; l++) {
        const struct visit *visit = &walk->level[l];
        if (!visit->lanes)
            continue;
        double bound = visit->bound[least_lane(visit->bound, visit->lanes)];
        bound = larger(visit->least, bound);
        double ahead = bound * (1.0 - KERNEL_STRETCH) - probe.margin;
        if (!(ahead > 0.0))
            return 0.0;
        least = smaller(least, ahead);
    }
    return least / surface->filter_scale;
}
