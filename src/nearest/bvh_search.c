/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Depth first, nearest child first, through a tree that is 16 wide (docs/algorithms/bvh.md). Float bounds, sound by
 * kernel_margin, close lanes; triangles that stay open are evaluated in double. So float decides how long a search
 * takes, never what it answers.
 */
#include "nearest/bvh_planes.h"

/*
 * Set the limit from the best distance, and the plane through the best pair. Near a contact most of the mesh lies
 * beyond that plane, and three dot products a triangle rule it out.
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

/* Those of a leaf's `lanes` that are neither the best triangle nor excluded. first: place of the leaf's lane 0. */
static uint32_t untested_triangles(const struct pair_search *nearest, uint32_t first, uint32_t lanes)
{
    if (nearest->triangle - first < LANES)
        lanes &= ~(1u << (nearest->triangle - first));
    for (uint32_t i = 0; i < nearest->excluded_count; i++)
        if (nearest->excluded[i] - first < LANES)
            lanes &= ~(1u << (nearest->excluded[i] - first));
    return lanes;
}

static void visit_leaf(struct bvh_search *search, uint32_t leaf)
{
    float bound[LANES];
    const struct surface *surface = search->surface;
    uint32_t first = leaf * LANES;
    uint32_t all = lanes_of(surface_triangles(surface) - first);
    uint32_t lanes = untested_triangles(search->nearest, first, all);
    struct cached_planes cached = bvh_cached_planes(search, 0, leaf);
    int has_tested = lanes != all;
    lanes = dpti_bvh_open_triangles(search, leaf, &cached, lanes, !has_tested, bound);
    if (lanes || has_tested)
        search->traversal->path[1].has_open = 1;
    else if (bvh_owns_block(search, &cached))
        dpti_bvh_close_in_parent(search, cached.block, 1, leaf);
    while (lanes) {
        uint32_t lane = lowest_lane(bound, lanes);
        lanes &= ~(1u << lane);
        if (bound[lane] > search->segment.limit)
            return;
        if (search->slack > 0.0 && search->has_plane &&
            dpti_triangle_is_beyond(surface, &search->nearest->plane, first + lane))
            continue;
        pair found = dpti_triangle_pair(surface, first + lane, search->a, search->u);
        if (pair_search_improve(surface, first + lane, &found, search->nearest))
            set_limit(search);
        else
            dpti_bvh_close_triangle(search, leaf, lane, &found);
    }
}

/* Tell the parent that this node has open parts, or close the node there. block: the node's own, or NULL. */
static void leave_node(struct bvh_search *search, struct plane_block *block, uint32_t level)
{
    const struct path_entry *entry = &search->traversal->path[level];
    if (level == search->surface->levels)
        return;
    if (entry->has_open)
        search->traversal->path[level + 1].has_open = 1;
    else if (block)
        dpti_bvh_close_in_parent(search, block, level + 1, entry->node);
}

/*
 * Put a node on the path and test all of its children but path_lanes, which are visited anyway. Returns 0 if no child
 * is left to visit.
 */
static int visit_node(struct bvh_search *search, uint32_t level, uint32_t node, uint32_t path_lanes)
{
    struct path_entry *entry = &search->traversal->path[level];
    const struct surface *surface = search->surface;
    const float *rows = surface_node(surface, level, node, search->work);
    struct cached_planes cached = bvh_cached_planes(search, level, node);
    uint32_t lanes = lanes_of(surface->count[level - 1] - node * LANES) & ~path_lanes;
    if (!cached.is_empty)
        lanes &= bvh_test_planes(search, search->kernel->cached_boxes, rows, &cached, entry->bound);
    if (cached.is_empty || lanes & ~cached.block->open)
        lanes = dpti_bvh_close_boxes(search, level, node, &cached, lanes, entry->bound);
    if (cached.block)
        cached.block->open = lanes | path_lanes;
    entry->node = node;
    entry->lanes = lanes;
    entry->has_open = path_lanes != 0;
    entry->lower_bound = 0.0f;
    if (lanes | path_lanes)
        return 1;
    leave_node(search, cached.block, level);
    return 0;
}

/*
 * Begin at the root; or, if last tick's triangle is the best, visit its leaf at once and test the nodes above it: no
 * plane could close the lanes that lead to it. Returns the level at which the traversal continues; above
 * surface->levels: it is done.
 */
static uint32_t begin_traversal(struct bvh_search *search)
{
    uint32_t level = search->surface->levels, best = search->nearest->triangle;
    if (!search->cache.count || search->cache.is_write_only || search->slack == 0.0 || best == DPT_NONE ||
        work_left(search->work) < 4 * (level + 1)) {
        return visit_node(search, level, 0, 0) ? level : level + 1;
    }
    for (; level >= 1; level--) {
        uint32_t child = best >> 4 * level;
        visit_node(search, level, child / LANES, 1u << child % LANES);
    }
    visit_leaf(search, best / LANES);
    return 1;
}

/*
 * The open lane to visit next. As a rule it is the nearest one. With at most four open lanes the order hardly matters,
 * and taking the first one saves the comparisons. Two searches always take the nearest:
 *   - Without history (no slack) the first crossing found is the answer; it must not depend on where a search begins.
 *   - A write-only search, of a tool at rest, must cost no more than a search from nothing.
 */
static uint32_t next_lane(const struct bvh_search *search, const struct path_entry *entry)
{
    uint32_t beyond_four = entry->lanes;
    for (int i = 0; i < 4; i++)
        beyond_four &= beyond_four - 1;
    int takes_first = !beyond_four && search->slack > 0.0 && !search->cache.is_write_only;
    return takes_first ? first_lane(entry->lanes) : lowest_lane(entry->bound, entry->lanes);
}

static int is_touching(const struct pair_search *nearest)
{
    return nearest->pair.distance2 == 0.0 && nearest->triangle != DPT_NONE;
}

int dpti_bvh_traverse(const struct surface *surface, const struct kernel *kernel, const struct plane_cache_view *cache,
                      vec3 a, vec3 u, double slack, struct bvh_traversal *traversal, struct work *work,
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
    search.traversal = traversal;
    search.x = filter_segment_set_axis(&search.segment, surface, a, u);
    set_limit(&search);
    uint32_t level = traversal->level;
    if (!level && !work_is_spent(search.work))
        level = begin_traversal(&search);
    while (level && level <= surface->levels && !is_touching(nearest)) {
        struct path_entry *entry = &traversal->path[level];
        if (!entry->lanes) {
            leave_node(&search, plane_cache_own_block(&search.cache, surface->first[level] + entry->node), level);
            level++;
            continue;
        }
        uint32_t lane = next_lane(&search, entry);
        int is_closed = entry->bound[lane] > search.segment.limit;
        if (!is_closed && work_is_spent(search.work))
            break;
        entry->lanes &= ~(1u << lane);
        if (is_closed)
            continue;
        uint32_t child = entry->node * LANES + lane;
        if (level == 1) {
            visit_leaf(&search, child);
        } else {
            float lower_bound = entry->bound[lane] > entry->lower_bound ? entry->bound[lane] : entry->lower_bound;
            if (visit_node(&search, level - 1, child, 0))
                traversal->path[--level].lower_bound = lower_bound;
        }
    }
    int is_done = level > surface->levels || is_touching(nearest);
    traversal->level = is_done ? 0 : level;
    return is_done;
}

void dpti_bvh_search(const struct surface *surface, const struct kernel *kernel, const struct plane_cache_view *cache,
                     vec3 a, vec3 u, double slack, struct work *work, struct pair_search *nearest)
{
    struct bvh_traversal traversal;
    traversal.level = 0;
    dpti_bvh_traverse(surface, kernel, cache, a, u, slack, &traversal, work, nearest);
}

/* The factors cover the growth of the margin with the ends, and rounding here. */
void dpti_bvh_weaken_bounds(struct bvh_traversal *traversal, const struct surface *surface, double motion)
{
    float drop = (float)(motion * surface->filter_scale * (1.0 + 0x1p-16));
    for (uint32_t level = traversal->level; level && level <= surface->levels; level++) {
        float *bound = traversal->path[level].bound;
        traversal->path[level].lower_bound -= drop + 0x1p-22f * fabsf(traversal->path[level].lower_bound);
        for (int i = 0; i < LANES; i++)
            bound[i] = bound[i] - drop - 0x1p-22f * fabsf(bound[i]);
    }
}

double dpti_bvh_unvisited_bound(const struct bvh_traversal *traversal, const struct surface *surface, vec3 a, vec3 u)
{
    struct filter_segment segment;
    filter_segment_set_axis(&segment, surface, a, u);
    double min_bound = HUGE_VAL;
    for (uint32_t level = traversal->level; level <= surface->levels; level++) {
        const struct path_entry *entry = &traversal->path[level];
        if (!entry->lanes)
            continue;
        double bound = entry->bound[lowest_lane(entry->bound, entry->lanes)];
        bound = max_of(entry->lower_bound, bound);
        double distance = bound * (1.0 - KERNEL_STRETCH) - segment.margin;
        if (!(distance > 0.0))
            return 0.0;
        min_bound = min_of(min_bound, distance);
    }
    return min_bound / surface->filter_scale;
}
