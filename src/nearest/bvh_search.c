/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Depth first, nearest child first, through a tree that is 16 wide (docs/algorithms/bvh.md). Float bounds, sound by
 * kernel_margin, close lanes; triangles that stay open are evaluated in double. So float decides how long a search
 * takes, never what it answers.
 */
#include "nearest/bvh.h"

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

int dpti_bvh_traverse(struct bvh_search *search)
{
    const struct surface *surface = search->surface;
    struct bvh_traversal *traversal = search->traversal;
    const struct pair_search *nearest = search->nearest;
    search->has_frame = 0;
    search->x = filter_segment_set_axis(&search->segment, surface, search->a, search->u);
    set_limit(search);
    uint32_t level = traversal->level;
    if (!level && !work_is_spent(search->work))
        level = begin_traversal(search);
    while (level && level <= surface->levels && !is_touching(nearest)) {
        struct path_entry *entry = &traversal->path[level];
        if (!entry->lanes) {
            leave_node(search, plane_cache_own_block(&search->cache, surface->first[level] + entry->node), level);
            level++;
            continue;
        }
        uint32_t lane = next_lane(search, entry);
        int is_closed = entry->bound[lane] > search->segment.limit;
        if (!is_closed && work_is_spent(search->work))
            break;
        entry->lanes &= ~(1u << lane);
        if (is_closed)
            continue;
        uint32_t child = entry->node * LANES + lane;
        if (level == 1) {
            visit_leaf(search, child);
        } else {
            float lower_bound = entry->bound[lane] > entry->lower_bound ? entry->bound[lane] : entry->lower_bound;
            if (visit_node(search, level - 1, child, 0))
                traversal->path[--level].lower_bound = lower_bound;
        }
    }
    int is_done = level > surface->levels || is_touching(nearest);
    traversal->level = is_done ? 0 : level;
    return is_done;
}

int dpti_bvh_search(const struct surface *surface, const struct kernel *kernel, vec3 a, vec3 u, struct work *work,
                    struct pair_search *nearest)
{
    struct bvh_traversal traversal;
    struct bvh_search search;
    traversal.level = 0;
    search.surface = surface;
    search.kernel = kernel;
    search.a = a;
    search.u = u;
    search.slack = 0.0;
    search.cache = (struct plane_cache_view){ .count = 0 };
    search.work = work;
    search.traversal = &traversal;
    search.nearest = nearest;
    return dpti_bvh_traverse(&search);
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

void dpti_brute_search(const struct surface *surface, vec3 a, vec3 u, struct work *work, struct pair_search *nearest)
{
    for (uint32_t t = 0; t < surface_triangles(surface); t++) {
        pair found = dpti_triangle_pair(surface, t, a, u);
        pair_search_improve(surface, t, &found, nearest);
    }
    work_spend(work, surface->mesh->leaves);
}

/* ---- the nearest to a point ---- */

/*
 * The search above, with squared distances. The distance from a point to a box takes three differences, so no
 * direction is guessed. A search that starts from a triangle visits boxes in their order: it starts near the answer and
 * gains little from visiting the nearest first.
 */

struct point_search_state {
    const struct surface *surface;
    const struct kernel *kernel;
    struct pair_search *nearest;
    struct work *work;
    vec3 x;            /* in the mesh's frame */
    float filter_x[3]; /* x in the filter's frame, as limit and margin */
    float limit;       /* a lane whose squared bound exceeds it is farther than the best */
    float margin;
    struct bvh_traversal *traversal;
};

/* The factor covers the rounding of squares. */
static void set_point_limit(struct point_search_state *search)
{
    double distance = sqrt(search->nearest->pair.distance2);
    double limit = distance * search->surface->filter_scale + (double)search->margin;
    search->limit = (float)(limit * limit * (1.0 + 4.0 * KERNEL_STRETCH));
}

static void visit_point_node(struct point_search_state *search, uint32_t level, uint32_t node)
{
    const struct surface *surface = search->surface;
    struct path_entry *entry = &search->traversal->path[level];
    work_spend(search->work, 1);
    search->traversal->level = level;
    entry->node = node;
    entry->lanes = lanes_of(surface->count[level - 1] - node * LANES) &
                   search->kernel->point_boxes(surface_node(surface, level, node, search->work), search->filter_x,
                                               search->limit, entry->bound);
}

static void visit_point_leaf(struct point_search_state *search, uint32_t leaf)
{
    const struct surface *surface = search->surface;
    struct pair_search *nearest = search->nearest;
    uint32_t first = leaf * LANES, lanes = lanes_of(surface_triangles(surface) - first);
    float bound[LANES];
    if (nearest->triangle - first < LANES)
        lanes &= ~(1u << (nearest->triangle - first));
    work_spend(search->work, 1);
    lanes &= search->kernel->point_triangles(surface_leaf(surface, leaf, search->work), search->filter_x, search->limit,
                                             bound);
    while (lanes) {
        uint32_t lane = lowest_lane(bound, lanes);
        lanes &= ~(1u << lane);
        if (bound[lane] > search->limit)
            return;
        if (dpti_pair_search_try_point(surface, first + lane, search->x, nearest))
            set_point_limit(search);
    }
}

int dpti_point_search(const struct surface *surface, const struct kernel *kernel, vec3 x,
                      struct bvh_traversal *traversal, struct work *work, struct pair_search *nearest)
{
    struct point_search_state search;
    int has_start = nearest->triangle != DPT_NONE;
    vec3 filter_x = scaled(sub(x, surface->filter_centre), surface->filter_scale);
    search.surface = surface;
    search.kernel = kernel;
    search.nearest = nearest;
    search.traversal = traversal;
    search.work = work;
    search.x = x;
    put_float(filter_x, search.filter_x);
    search.margin = (float)(kernel_margin(length(filter_x), length(filter_x)) + surface_margin(surface));
    set_point_limit(&search);
    if (!traversal->level)
        visit_point_node(&search, surface->levels, 0);
    while (traversal->level <= surface->levels && (nearest->pair.distance2 > 0.0 || nearest->triangle == DPT_NONE)) {
        struct path_entry *entry = &traversal->path[traversal->level];
        if (!entry->lanes) {
            traversal->level++;
            continue;
        }
        uint32_t lane = has_start ? first_lane(entry->lanes) : lowest_lane(entry->bound, entry->lanes);
        uint32_t rest = entry->lanes & ~(1u << lane);
        if (entry->bound[lane] > search.limit) {
            entry->lanes = has_start ? rest : 0;
            continue;
        }
        if (work_is_spent(work))
            return 0;
        entry->lanes = rest;
        uint32_t child = entry->node * LANES + lane;
        if (traversal->level == 1)
            visit_point_leaf(&search, child);
        else
            visit_point_node(&search, traversal->level - 1, child);
    }
    return 1;
}

/* ---- all within reach ---- */

/*
 * 1 if each triangle of a leaf is out of reach along at least one of the four directions. That holds for most leaves
 * whose boxes are within reach.
 */
static int is_out_of_reach(const struct range *range, const float *rows, uint32_t lanes)
{
    float support[LANES];
    for (int i = 0; i < 4 && lanes; i++)
        lanes &= range->kernel->common_triangles(rows, range->directions[i], range->limits[i], support);
    return !lanes;
}

static void visit(struct range *range, uint32_t level, uint32_t node)
{
    const struct surface *surface = range->surface;
    uint32_t children = level ? surface->count[level - 1] : surface_triangles(surface);
    uint32_t lanes = lanes_of(children - node * LANES);
    const float *rows =
        level ? surface_node(surface, level, node, range->work) : surface_leaf(surface, node, range->work);
    kernel_new_planes *loop = level ? range->kernel->boxes : range->kernel->triangles;
    struct planes planes;
    work_spend(range->work, 1);
    range->level = level;
    range->node[level] = node;
    range->lanes[level] = 0;
    if (level || !is_out_of_reach(range, rows, lanes))
        range->lanes[level] = lanes & loop(rows, &range->segment, &planes, range->bound);
}

void dpti_range_begin(struct range *range, const struct surface *surface, const struct kernel *kernel, vec3 a, vec3 u,
                      double reach, struct work *work)
{
    range->surface = surface;
    range->kernel = kernel;
    range->work = work;
    vec3 x = filter_segment_set_axis(&range->segment, surface, a, u);
    filter_segment_set_frame(&range->segment, x);
    filter_segment_set_limit(&range->segment, surface, reach);
    for (int i = 0; i < 4; i++) {
        const float *direction = i % 2 ? range->segment.z : range->segment.y;
        for (int k = 0; k < 3; k++)
            range->directions[i][k] = i < 2 ? direction[k] : -direction[k];
        range->limits[i] = filter_segment_support(&range->segment, range->directions[i]) + range->segment.limit;
    }
    visit(range, surface->levels, 0);
}

/* The next child of a node of level `last` that may be within reach, or DPT_NONE. */
static uint32_t next_child(struct range *range, uint32_t last)
{
    while (range->level <= range->surface->levels) {
        uint32_t level = range->level;
        if (!range->lanes[level]) {
            range->level++;
            continue;
        }
        if (level > last && work_is_spent(range->work))
            return DPT_NONE;
        uint32_t lane = first_lane(range->lanes[level]);
        range->lanes[level] &= range->lanes[level] - 1;
        uint32_t child = range->node[level] * LANES + lane;
        if (level == last)
            return child;
        visit(range, level - 1, child);
    }
    return DPT_NONE;
}

uint32_t dpti_range_next(struct range *range, int *may_touch)
{
    const uint32_t triangle = next_child(range, 0);
    if (triangle != DPT_NONE)
        *may_touch = !(range->bound[triangle % LANES] > range->segment.margin);
    return triangle;
}

uint32_t dpti_range_next_leaf(struct range *range)
{
    return next_child(range, 1);
}
