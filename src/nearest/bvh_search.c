/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Depth first, nearest child first, through a tree that is 16 wide (docs/algorithms/bvh.md). Bounds
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
    struct pair_search *nearest = search->nearest;
    struct filter_segment *segment = &search->segment;
    double distance = sqrt(nearest->pair.distance2);
    filter_segment_set_limit(segment, search->surface, distance);
    search->has_plane = nearest->triangle != DPT_NONE && distance > 0.0;
    if (!search->has_plane)
        return;
    dpti_pair_search_update_plane(nearest, search->a, search->u, search->slack);
    put_float(nearest->plane.normal, segment->normal);
    segment->height = filter_segment_support(segment, segment->normal);
}

/* Of these triangles, from `first` on, those of which nothing is known. */
static uint32_t unknown_triangles(const struct pair_search *nearest, uint32_t first, uint32_t lanes)
{
    if (nearest->triangle - first < LANES)
        lanes &= ~(1u << (nearest->triangle - first));
    for (uint32_t i = 0; i < nearest->excluded_count; i++)
        if (nearest->excluded[i] - first < LANES)
            lanes &= ~(1u << (nearest->excluded[i] - first));
    return lanes;
}

static void look_into_leaf(struct bvh_search *search, uint32_t leaf)
{
    float bound[LANES];
    const struct surface *surface = search->surface;
    uint32_t first = leaf * LANES;
    uint32_t all = lanes_of(surface_triangles(surface) - first);
    uint32_t lanes = unknown_triangles(search->nearest, first, all);
    struct cached_planes cached = bvh_planes_of(search, leaf);
    int near = lanes != all;
    lanes = dpti_bvh_open_triangles(search, leaf, &cached, lanes, !near, bound);
    if (lanes || near)
        search->walk->path[1].found = 1;
    else if (bvh_is_own(search, &cached))
        dpti_bvh_close_whole(search, cached.block, 1, leaf);
    while (lanes) {
        uint32_t lane = lowest_lane(bound, lanes);
        lanes &= ~(1u << lane);
        if (bound[lane] > search->segment.limit)
            return;
        if (search->slack > 0.0 && search->has_plane &&
            dpti_triangle_is_beyond(surface, &search->nearest->plane, first + lane))
            continue;
        pair found = dpti_triangle_pair(surface, first + lane, search->a, search->u);
        if (pair_search_take(surface, first + lane, &found, search->nearest))
            set_limit(search);
        else
            dpti_bvh_close_triangle(search, leaf, lane, &found);
    }
}

/* Its parent learns what was found. */
static void leave_boxes(struct bvh_search *search, struct plane_block *block, uint32_t level)
{
    const struct path_entry *entry = &search->walk->path[level];
    if (level == search->surface->levels)
        return;
    if (entry->found)
        search->walk->path[level + 1].found = 1;
    else if (block)
        dpti_bvh_close_whole(search, block, level + 1, entry->node);
}

/* Look at all children but those of the lanes `but`, which are looked into anyway. 0: nothing is left to look into. */
static int look_into_boxes(struct bvh_search *search, uint32_t level, uint32_t node, uint32_t but)
{
    struct path_entry *entry = &search->walk->path[level];
    const struct surface *surface = search->surface;
    const float *rows = surface->level[level] + (size_t)node * MESH_BOX_WORDS;
    struct cached_planes cached = bvh_planes_of(search, surface->first[level] + node);
    uint32_t lanes = lanes_of(surface->count[level - 1] - node * LANES) & ~but;
    if (!cached.empty)
        lanes &=
            bvh_look_at_planes(search, search->kernel->cached_boxes, rows, &cached, entry->bound);
    if (cached.empty || lanes & ~cached.block->open)
        lanes = dpti_bvh_close_boxes(search, level, node, &cached, lanes, entry->bound);
    if (cached.block)
        cached.block->open = lanes | but;
    entry->node = node;
    entry->lanes = lanes;
    entry->found = but != 0;
    entry->least = 0.0f;
    if (lanes | but)
        return 1;
    leave_boxes(search, cached.block, level);
    return 0;
}

/*
 * Where the search begins: at the root; or, where the best triangle is that of a known tick, at its leaf, with all
 * nodes above it already looked at. No plane could close the way to it.
 */
static uint32_t begin(struct bvh_search *search)
{
    uint32_t level = search->surface->levels, known = search->nearest->triangle;
    if (!search->cache.count || search->cache.anew || search->slack == 0.0 || known == DPT_NONE ||
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
static uint32_t next_lane(const struct bvh_search *search, const struct path_entry *entry)
{
    uint32_t many = entry->lanes;
    for (int i = 0; i < 4; i++)
        many &= many - 1;
    int any = !many && search->slack > 0.0 && !search->cache.anew;
    return any ? first_lane(entry->lanes) : lowest_lane(entry->bound, entry->lanes);
}

static int meets(const struct pair_search *nearest)
{
    return nearest->pair.distance2 == 0.0 && nearest->triangle != DPT_NONE;
}

int dpti_bvh_traverse(const struct surface *surface, const struct kernel *kernel,
                      const struct plane_cache_view *cache, vec3 a, vec3 u, double slack,
                      struct bvh_traversal *traversal, struct work *work,
                      struct pair_search *nearest)
{
    struct bvh_search search;
    search.surface = surface;
    search.kernel = kernel;
    search.cache = cache ? *cache : (struct plane_cache_view){ .count = 0 };
    search.nearest = nearest;
    search.a = a;
    search.u = u;
    search.slack = slack;
    search.work = work;
    search.has_frame = 0;
    search.walk = traversal;
    search.x = filter_segment_set_axis(&search.segment, surface, a, u);
    set_limit(&search);
    uint32_t level = traversal->depth;
    if (!level && !work_is_spent(search.work))
        level = begin(&search);
    while (level && level <= surface->levels && !meets(nearest)) {
        struct path_entry *entry = &traversal->path[level];
        if (!entry->lanes) {
            leave_boxes(&search,
                        plane_cache_own_block(&search.cache, surface->first[level] + entry->node),
                        level);
            level++;
            continue;
        }
        uint32_t lane = next_lane(&search, entry);
        int closed = entry->bound[lane] > search.segment.limit;
        if (!closed && work_is_spent(search.work))
            break;
        entry->lanes &= ~(1u << lane);
        if (closed)
            continue;
        uint32_t child = entry->node * LANES + lane;
        if (level == 1) {
            look_into_leaf(&search, child);
        } else {
            float least = entry->bound[lane] > entry->least ? entry->bound[lane] : entry->least;
            if (look_into_boxes(&search, level - 1, child, 0))
                traversal->path[--level].least = least;
        }
    }
    int done = level > surface->levels || meets(nearest);
    traversal->depth = done ? 0 : level;
    return done;
}

void dpti_bvh_search(const struct surface *surface, const struct kernel *kernel,
                     const struct plane_cache_view *cache, vec3 a, vec3 u, double slack,
                     struct work *work, struct pair_search *nearest)
{
    struct bvh_traversal traversal;
    traversal.depth = 0;
    dpti_bvh_traverse(surface, kernel, cache, a, u, slack, &traversal, work, nearest);
}

/* That a margin grows with the ends, and rounding here, is in the factors. */
void dpti_traversal_drift(struct bvh_traversal *traversal, const struct surface *surface,
                          double motion)
{
    float drop = (float)(motion * surface->filter_scale * (1.0 + 0x1p-16));
    for (uint32_t l = traversal->depth; l && l <= surface->levels; l++) {
        float *bound = traversal->path[l].bound;
        traversal->path[l].least -= drop + 0x1p-22f * fabsf(traversal->path[l].least);
        for (int i = 0; i < LANES; i++)
            bound[i] = bound[i] - drop - 0x1p-22f * fabsf(bound[i]);
    }
}

double dpti_traversal_lower_bound(const struct bvh_traversal *traversal,
                                  const struct surface *surface, vec3 a, vec3 u)
{
    struct filter_segment segment;
    filter_segment_set_axis(&segment, surface, a, u);
    double least = HUGE_VAL;
    for (uint32_t l = traversal->depth; l <= surface->levels; l++) {
        const struct path_entry *entry = &traversal->path[l];
        if (!entry->lanes)
            continue;
        double bound = entry->bound[lowest_lane(entry->bound, entry->lanes)];
        bound = max_of(entry->least, bound);
        double ahead = bound * (1.0 - KERNEL_STRETCH) - segment.margin;
        if (!(ahead > 0.0))
            return 0.0;
        least = min_of(least, ahead);
    }
    return least / surface->filter_scale;
}
