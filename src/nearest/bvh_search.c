/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Depth first, nearest child first, through a tree that is 16 wide (docs/algorithms/tree.md). Bounds
 * are float and sound by kernel_margin; what they cannot rule out is evaluated in double. So float
 * decides how long it takes, never what the answer is.
 */
#include "nearest/bvh_planes.h"

/*
 * Take over a new best distance, and the plane through its pair: what lies behind that plane, most of
 * the mesh near a contact, is ruled out by three dot products.
 */
static void set_limit(struct bvh_search *search)
{
    struct nearest *nearest = search->nearest;
    struct probe *probe = &search->probe;
    double distance = sqrt(nearest->pair.distance2);
    probe_limit(probe, search->surface, distance);
    search->has_plane = nearest->triangle != DPT_NONE && distance > 0.0;
    if (!search->has_plane)
        return;
    dpti_nearest_front(nearest, search->a, search->u, search->slack);
    put_float(nearest->front.normal, probe->normal);
    probe->height = probe_reach(probe, probe->normal);
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

static void look_into_leaf(struct bvh_search *search, uint32_t leaf)
{
    float bound[LANES];
    const struct surface *surface = search->surface;
    uint32_t first = leaf * LANES;
    uint32_t all = lanes_of(surface_triangles(surface) - first);
    uint32_t lanes = unknown_triangles(search->nearest, first, all);
    struct node_planes kept = bvh_planes_of(search, leaf);
    int near = lanes != all;
    lanes = dpti_bvh_open_triangles(search, leaf, &kept, lanes, !near, bound);
    if (lanes || near)
        search->walk->level[1].found = 1;
    else if (bvh_is_own(search, &kept))
        dpti_bvh_close_whole(search, kept.block, 1, leaf);
    while (lanes) {
        uint32_t lane = least_lane(bound, lanes);
        lanes &= ~(1u << lane);
        if (bound[lane] > search->probe.limit)
            return;
        if (search->slack > 0.0 && search->has_plane &&
            dpti_tree_is_beyond(surface, &search->nearest->front, first + lane))
            continue;
        pair found = dpti_tree_pair(surface, first + lane, search->a, search->u);
        if (nearest_take(surface, first + lane, &found, search->nearest))
            set_limit(search);
        else
            dpti_bvh_close_triangle(search, leaf, lane, &found);
    }
}

/* Its parent learns what was found. */
static void leave_boxes(struct bvh_search *search, struct block *block, uint32_t level)
{
    const struct visit *visit = &search->walk->level[level];
    if (level == search->surface->levels)
        return;
    if (visit->found)
        search->walk->level[level + 1].found = 1;
    else if (block)
        dpti_bvh_close_whole(search, block, level + 1, visit->node);
}

/* Look at all children but those of the lanes `but`, which are looked into anyway. 0: nothing is left to look into. */
static int look_into_boxes(struct bvh_search *search, uint32_t level, uint32_t node, uint32_t but)
{
    struct visit *visit = &search->walk->level[level];
    const struct surface *surface = search->surface;
    const float *rows = surface->level[level] + (size_t)node * MESH_BOX_WORDS;
    struct node_planes kept = bvh_planes_of(search, surface->first[level] + node);
    uint32_t lanes = lanes_of(surface->count[level - 1] - node * LANES) & ~but;
    if (!kept.empty)
        lanes &= bvh_look_at_planes(search, search->kernel->held_boxes, rows, &kept, visit->bound);
    if (kept.empty || lanes & ~kept.block->open)
        lanes = dpti_bvh_close_boxes(search, level, node, &kept, lanes, visit->bound);
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
static uint32_t begin(struct bvh_search *search)
{
    uint32_t level = search->surface->levels, known = search->nearest->triangle;
    if (!search->keeper.count || search->keeper.anew || search->slack == 0.0 || known == DPT_NONE ||
        work_left(search->work) < 4 * (level + 1)) {
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
static uint32_t next_lane(const struct bvh_search *search, const struct visit *visit)
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

int dpti_tree_walk(const struct surface *surface, const struct kernel *kernel,
                   const struct keeper *keeper, vec3 a, vec3 u, double slack, struct walk *walk,
                   struct work *work, struct nearest *nearest)
{
    struct bvh_search search;
    search.surface = surface;
    search.kernel = kernel;
    search.keeper = keeper ? *keeper : (struct keeper){ .count = 0 };
    search.nearest = nearest;
    search.a = a;
    search.u = u;
    search.slack = slack;
    search.work = work;
    search.has_frame = 0;
    search.walk = walk;
    search.x = probe_axis(&search.probe, surface, a, u);
    set_limit(&search);
    uint32_t level = walk->at;
    if (!level && !work_is_spent(search.work))
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
        if (!closed && work_is_spent(search.work))
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

void dpti_tree_search(const struct surface *surface, const struct kernel *kernel,
                      const struct keeper *keeper, vec3 a, vec3 u, double slack, struct work *work,
                      struct nearest *nearest)
{
    struct walk walk;
    walk.at = 0;
    dpti_tree_walk(surface, kernel, keeper, a, u, slack, &walk, work, nearest);
}

/* That a margin grows with the ends, and rounding here, is in the factors. */
void dpti_walk_drift(struct walk *walk, const struct surface *surface, double motion)
{
    float drop = (float)(motion * surface->filter_scale * (1.0 + 0x1p-16));
    for (uint32_t l = walk->at; l && l <= surface->levels; l++) {
        float *bound = walk->level[l].bound;
        walk->level[l].least -= drop + 0x1p-22f * fabsf(walk->level[l].least);
        for (int i = 0; i < LANES; i++)
            bound[i] = bound[i] - drop - 0x1p-22f * fabsf(bound[i]);
    }
}

double dpti_walk_ahead(const struct walk *walk, const struct surface *surface, vec3 a, vec3 u)
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
