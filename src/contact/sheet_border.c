/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Let a point be behind a sheet, at distance h from it and b from its border. Once the border is as near as the sheet,
 * b = h, the point counts as in front. So near the border its depth is at most b - h. Both are distances. While the
 * directions to sheet and border are less than 60 degrees apart, b - h changes by no more than the point moves. Beyond
 * that, b > 2 h on a flat sheet, a slower rise keeps this so. The tool is pushed at the point of its axis whose reduced
 * depth is largest.
 */
#include "contact/sheet_border.h"

#include "nearest/filter_segment.h"

enum {
    EDGES_MAX = 256,
    BLOCKS_MAX = 2048,  /* of one search for the border; they are not part of the budget */
    STRETCH_STEPS = 16, /* along a stretch that is behind the sheet */
    WINDOW_STEPS = 8,   /* along two of those steps, round a local maximum */
    GOLDEN_STEPS = 14   /* of a golden section search, down to 7e-4 of its interval */
};

#define GOLDEN    0.6180339887498949
#define RISE_SLOW 0.8

struct border_edge {
    uint32_t from, to; /* vertices of the mesh */
    uint32_t part;
};

/* Border edges of sheets near the tool. */
struct border_edges {
    const struct surface *surface;
    uint32_t count;
    uint32_t stride; /* one in so many edges is held */
    struct border_edge edge[EDGES_MAX];
};

/* The depth that a border at `distance` leaves to a point at `height` from the sheet, both in m and >= 0. */
static double depth_left_by_border(double height, double distance)
{
    return max_of(0.0, min_of(distance - height, height + RISE_SLOW * (distance - 2.0 * height)));
}

/* The distance, m, beyond which a border reduces no point that is at most `height` behind the sheet. */
static double border_reach(double height, double radius, double share)
{
    return 2.0 * height + ((height + radius) / share - height) / RISE_SLOW;
}

/* The square of the distance from x, in the body's frame, to an edge, m^2. */
static double edge_square_distance(const struct border_edges *border, const struct border_edge *edge, vec3 x)
{
    vec3 from = surface_vertex(border->surface, edge->from);
    vec3 along_edge = sub(surface_vertex(border->surface, edge->to), from);
    vec3 gap = along(sub(x, from), -nearest_on(from, along_edge, x), along_edge);
    return dot(gap, gap);
}

/* The distance from x, in the body's frame, to the border of a part, m; HUGE_VAL if none is near. */
static double border_distance(const struct border_edges *border, uint32_t part, vec3 x)
{
    double min_square = HUGE_VAL;
    for (uint32_t i = 0; i < border->count; i++)
        if (border->edge[i].part == part)
            min_square = min_of(min_square, edge_square_distance(border, &border->edge[i], x));
    return sqrt(min_square);
}

/* Add an edge. If there are too many, every other one is dropped: so many edges are short compared to the reach. */
static void put_edge(struct border_edges *border, uint32_t edge_number, const struct border_edge *edge)
{
    if (edge_number % border->stride)
        return;
    if (border->count == EDGES_MAX) {
        for (uint32_t i = 0; i < EDGES_MAX / 2; i++)
            border->edge[i] = border->edge[2 * i];
        border->count = EDGES_MAX / 2;
        border->stride *= 2;
    }
    border->edge[border->count++] = *edge;
}

/*
 * Add the border edges of a leaf's triangles that are within reach of x, in the body's frame, if they are of a sheet
 * whose side is known. *seen_count counts all such edges of the search.
 */
static void add_leaf_edges(const struct distance_profile *profile, uint32_t leaf, vec3 x, double reach,
                           uint32_t *seen_count, struct border_edges *border)
{
    const struct surface *surface = profile->surface;
    const uint32_t *neighbour = surface_neighbours(surface);
    const uint32_t first = leaf * LANES, remaining = surface_triangles(surface) - first;
    for (uint32_t i = 0; i < 3 * (remaining < LANES ? remaining : LANES); i++) {
        const uint32_t triangle = first + i / 3, corner = i % 3;
        if (neighbour[3 * (size_t)first + i] != MESH_EDGE_OPEN)
            continue;
        const struct border_edge edge = { surface_corner(surface, triangle, corner),
                                          surface_corner(surface, triangle, (corner + 1) % 3),
                                          surface_part(surface, triangle) };
        if (dpti_sides_get(profile->sides, edge.part) && edge_square_distance(border, &edge, x) <= reach * reach)
            put_edge(border, (*seen_count)++, &edge);
    }
}

/* Find the border edges within reach, m, of x, in the body's frame. Returns 0 if that is too much work. */
static int gather_edges(const struct distance_profile *profile, vec3 x, double reach, struct border_edges *border)
{
    const struct surface *surface = profile->surface;
    const vec3 x_filter = scaled(sub(x, surface->filter_centre), surface->filter_scale);
    const double filter_reach =
        reach * surface->filter_scale + kernel_margin(length(x_filter), length(x_filter)) + surface_margin(surface);
    const float limit = (float)(filter_reach * filter_reach * (1.0 + 4.0 * KERNEL_STRETCH));
    uint32_t node[MESH_LEVELS_MAX + 1], lanes[MESH_LEVELS_MAX + 1], seen_count = 0, blocks = 0;
    uint32_t level = surface->levels;
    float x_float[3], bound[LANES];
    struct work uncounted = work_of(WORK_UNLIMITED);
    put_float(x_filter, x_float);
    border->surface = surface;
    border->count = 0;
    border->stride = 1;
    node[level] = 0;
    for (int is_new = 1; level <= surface->levels; is_new = 0) {
        if (is_new || lanes[level] == UINT32_MAX)
            lanes[level] = lanes_of(surface->count[level - 1] - node[level] * LANES) &
                           profile->kernel->point_boxes(surface_node(surface, level, node[level], &uncounted), x_float,
                                                        limit, bound);
        if (!lanes[level]) {
            level++;
            continue;
        }
        const uint32_t child = node[level] * LANES + first_lane(lanes[level]);
        lanes[level] &= lanes[level] - 1;
        if (++blocks > BLOCKS_MAX)
            return 0;
        if (level == 1) {
            add_leaf_edges(profile, child, x, reach, &seen_count, border);
        } else {
            node[--level] = child;
            lanes[level] = UINT32_MAX; /* its bounds are not known yet */
        }
    }
    return 1;
}

/*
 * 1: a border is within reach, m, of the deepest sample. The search goes twice as far, so that most ticks need none:
 * *view tells. If a search is too much work, borders do not count until the tool has moved by the reach.
 */
static int is_border_near(const struct distance_profile *profile, const struct profile_sample *deepest, double reach,
                          uint32_t id, struct border_view *view, struct border_edges *border)
{
    const uint32_t part = surface_part(profile->surface, deepest->triangle);
    vec3 x = profile_point(profile, deepest->s);
    if (view->clear_radius > 0.0 && view->body == id && view->part == part) {
        double moved = length(sub(x, view->centre));
        if (view->clear_radius - moved > reach)
            return 0;
        if (view->has_border && view->clear_radius + moved < reach)
            return 1;
    }
    const int is_complete = gather_edges(profile, x, 2.0 * reach, border);
    const double clear_radius = is_complete ? border_distance(border, part, x) : HUGE_VAL;
    *view = (struct border_view){ .centre = x,
                                  .clear_radius = min_of(2.0 * reach, clear_radius),
                                  .body = id,
                                  .part = part,
                                  .has_border = clear_radius < 2.0 * reach };
    return clear_radius <= reach;
}

/* A search for the point of an axis with the largest reduced depth. */
struct border_search {
    struct distance_profile *profile;
    const struct border_edges *border;
    double radius;
    /*
     * Factor, >= 1, of the depth that the border leaves. It is above 1 for a tool that has hardly come through the
     * sheet, since a tool in front of it feels no border.
     */
    double share;
    uint32_t last_triangle;     /* place; of the last point that was tried */
    struct profile_sample best; /* the best so far */
    double best_depth;          /* m, reduced */
};

/*
 * The reduced depth of a sample, m. One whose nearest point is on the border does not count: it would push sideways,
 * not back through the sheet. The border also reduces a sample in front of the sheet, because the rest of the axis is
 * behind.
 */
static double reduced_depth(const struct border_search *search, const struct profile_sample *sample)
{
    const struct distance_profile *profile = search->profile;
    if (sample->triangle == DPT_NONE)
        return -HUGE_VAL;
    const uint32_t part = surface_part(profile->surface, sample->triangle);
    const double depth = search->radius - sample->height;
    if (depth <= search->best_depth || !dpti_sides_get(profile->sides, part))
        return depth; /* it may be less, but it cannot be the best */
    if (sample->height >= 0.0 && dpti_side_is_border(profile->surface, sample->triangle, sample->weight))
        return -HUGE_VAL;
    double distance = border_distance(search->border, part, profile_point(profile, sample->s));
    return min_of(depth, search->share * depth_left_by_border(fabs(sample->height), distance));
}

/* Make a sample the best if its reduced depth is larger. Returns that depth. */
static double try_sample(struct border_search *search, const struct profile_sample *sample)
{
    double depth = reduced_depth(search, sample);
    if (depth > search->best_depth) {
        search->best = *sample;
        search->best_depth = depth;
    }
    return depth;
}

/* Try a sample at s, by descent from the triangle of the last one, which is near. Returns its reduced depth. */
static double try_place(struct border_search *search, double s)
{
    struct profile_sample sample;
    dpti_profile_take_sample(search->profile, s, search->last_triangle, 0, &sample);
    search->last_triangle = sample.triangle;
    return try_sample(search, &sample);
}

/* Climb to a local maximum between two places, s, by a golden section search. */
static void climb(struct border_search *search, double from, double to)
{
    double left = to - GOLDEN * (to - from), right = from + GOLDEN * (to - from);
    double depth_left = try_place(search, left), depth_right = try_place(search, right);
    for (int i = 0; i < GOLDEN_STEPS; i++) {
        if (depth_left > depth_right) {
            to = right;
            right = left;
            depth_right = depth_left;
            left = to - GOLDEN * (to - from);
            depth_left = try_place(search, left);
        } else {
            from = left;
            left = right;
            depth_left = depth_right;
            right = from + GOLDEN * (to - from);
            depth_right = try_place(search, right);
        }
    }
}

static void search_stretch(struct border_search *search, double from, double to, int steps);

/* Search a piece of a stretch more closely, with only those edges that may be nearest to one of its points. */
static void search_window(struct border_search *search, double from, double to)
{
    const struct border_edges *all_edges = search->border;
    const double half_length = 0.5 * (to - from) * search->profile->axis_length;
    const vec3 x = profile_point(search->profile, 0.5 * (from + to));
    struct border_edges near_edges = { .surface = all_edges->surface };
    uint32_t part = DPT_NONE;
    double reach = 0.0;
    for (uint32_t i = 0; i < all_edges->count; i++) {
        if (all_edges->edge[i].part != part) {
            part = all_edges->edge[i].part;
            reach = border_distance(all_edges, part, x) + 2.0 * half_length;
        }
        if (edge_square_distance(all_edges, &all_edges->edge[i], x) <= reach * reach)
            near_edges.edge[near_edges.count++] = all_edges->edge[i];
    }
    search->border = &near_edges;
    search_stretch(search, from, to, WINDOW_STEPS);
    search->border = all_edges;
}

/*
 * Search a stretch in steps, and the surroundings of each local maximum again. A stretch may have several local
 * maxima, and what looks like one may be two side by side: so there is a second, finer round before the climb.
 */
static void search_stretch(struct border_search *search, double from, double to, int steps)
{
    double depth[STRETCH_STEPS + 1], step = (to - from) / steps;
    for (int i = 0; i <= steps; i++)
        depth[i] = try_place(search, from + i * step);
    for (int i = 0; i <= steps; i++) {
        double before = i ? depth[i - 1] : -HUGE_VAL, after = i < steps ? depth[i + 1] : -HUGE_VAL;
        double left = max_of(from, from + (i - 1) * step), right = min_of(to, from + (i + 1) * step);
        /* The depth changes by at most twice the distance along the axis. */
        if (!(depth[i] >= before && depth[i] > after &&
              depth[i] + 2.0 * step * search->profile->axis_length > search->best_depth))
            continue;
        if (steps == STRETCH_STEPS)
            search_window(search, left, right);
        else
            climb(search, left, right);
    }
}

/* 1: the sample's nearest point is on a border. */
static int is_on_border(const struct distance_profile *profile, const struct profile_sample *sample)
{
    return sample->triangle != DPT_NONE && dpti_side_is_border(profile->surface, sample->triangle, sample->weight);
}

/*
 * Where a stretch whose last sample is `last` may end, in s, towards the sample `next`: at `next` if that is on the
 * border; otherwise where the tool's surface leaves the sheet by the tangent, and half as far again.
 */
static double stretch_end(const struct border_search *search, const struct profile_sample *last,
                          const struct profile_sample *next)
{
    const double width = next->s - last->s, slope = fabs(last->slope);
    const double reach_left = 1.5 * (search->radius - last->height);
    if (is_on_border(search->profile, next) || slope * fabs(width) <= reach_left)
        return next->s;
    return last->s + (width < 0.0 ? -reach_left : reach_left) / slope;
}

/* 1: at this sample the axis is behind the sheet, or the tool's surface reaches into it from the front. */
static int is_on_sheet_or_behind(const struct border_search *search, const struct profile_sample *sample)
{
    return sample->height <= 0.0 || (sample->height < search->radius && !is_on_border(search->profile, sample));
}

/*
 * Find the next stretch of the axis of which at least a part is behind the sheet, from sample *i on, and move *i past
 * it. Its ends, in s, go to *from and *to. Returns 0 if there is none.
 */
static int next_stretch(const struct border_search *search, uint32_t *i, double *from, double *to)
{
    const struct profile_sample *sample = search->profile->sample;
    const uint32_t count = search->profile->sample_count;
    while (*i < count) {
        const uint32_t first = *i;
        int has_behind = 0;
        for (; *i < count && is_on_sheet_or_behind(search, &sample[*i]); ++*i)
            has_behind |= sample[*i].height <= 0.0;
        const uint32_t end = *i;
        *i += end == first;
        if (!has_behind)
            continue;
        *from = first ? stretch_end(search, &sample[first], &sample[first - 1]) : sample[first].s;
        *to = end < count ? stretch_end(search, &sample[end - 1], &sample[end]) : sample[end - 1].s;
        return 1;
    }
    return 0;
}

/* Find the border edges within reach, m, of all stretches together. Returns 0 if there are none, or too much work. */
static int gather_stretches(const struct border_search *search, double reach, struct border_edges *border)
{
    double from = 1.0, to = 0.0, first, last;
    for (uint32_t i = 0; next_stretch(search, &i, &first, &last);) {
        from = min_of(from, first);
        to = max_of(to, last);
    }
    const double half_length = 0.5 * (to - from) * search->profile->axis_length;
    return from <= to && gather_edges(search->profile, profile_point(search->profile, 0.5 * (from + to)),
                                      half_length + reach, border);
}

/* Try the profile's samples, then search all stretches. The profile itself stays as it is. */
static void search_axis(struct border_search *search)
{
    const struct distance_profile *profile = search->profile;
    double from, to;
    for (uint32_t i = 0; i < profile->sample_count; i++)
        try_sample(search, &profile->sample[i]);
    for (uint32_t i = 0; next_stretch(search, &i, &from, &to);)
        search_stretch(search, from, to, STRETCH_STEPS);
}

/*
 * The largest possible distance of the axis behind the sheet, m: that of the deepest sample, or more. Where a sample
 * behind the sheet has a neighbour in front whose nearest point is on the border, the axis may be deeper between the
 * two.
 */
static double max_depth_behind(const struct distance_profile *profile)
{
    double max_depth = -profile->sample[profile->deepest].height;
    for (uint32_t i = 0; i + 1 < profile->sample_count; i++) {
        const struct profile_sample *low = &profile->sample[i], *high = low + 1;
        if (low->height > high->height) {
            low = high;
            high = &profile->sample[i];
        }
        if (low->height <= 0.0 && high->height > max_depth && is_on_border(profile, high))
            max_depth = high->height;
    }
    return max_depth;
}

/* How far the axis reaches through the sheet's plane at the deepest sample, m, also beyond the sheet's border. */
static double depth_through_plane(const struct distance_profile *profile, const struct profile_sample *deepest)
{
    vec3 a = along(deepest->gap, -deepest->s, profile->axis->u);
    return max_of(-dot(a, deepest->normal), -dot(add(a, profile->axis->u), deepest->normal));
}

int dpti_sheet_border_reduce(struct distance_profile *profile, uint32_t body, double radius, struct border_view *view,
                             double *depth, struct profile_sample *pushed)
{
    const struct profile_sample deepest = profile->sample[profile->deepest];
    const double max_depth = max_depth_behind(profile), through = depth_through_plane(profile, &deepest);
    const double share = max_of(1.0, radius / max_of(max_of(max_depth, through), DBL_MIN));
    const double reach = border_reach(max_depth, radius, share);
    struct border_edges border;
    if (!(*depth > 0.0) || !is_border_near(profile, &deepest, reach, body, view, &border))
        return 0;
    struct border_search search = { .profile = profile,
                                    .border = &border,
                                    .radius = radius,
                                    .share = share,
                                    .last_triangle = deepest.triangle,
                                    .best = deepest };
    if (!gather_stretches(&search, reach, &border))
        return 0;
    search.best_depth = reduced_depth(&search, &deepest) + profile->tolerance;
    *pushed = deepest;
    if (max_depth == -deepest.height && search.best_depth >= *depth)
        return 1;
    const uint32_t cut = profile->is_cut;
    const struct work work = profile->work;
    struct point_cache *cache = profile->point_cache;
    profile->point_cache = NULL;
    profile->work = work_of(WORK_UNLIMITED);
    search_axis(&search);
    dpti_profile_take_sample(profile, search.best.s, search.best.triangle, 1, &search.best);
    search.best_depth = -HUGE_VAL;
    profile->point_cache = cache;
    profile->work = work;
    profile->is_cut = cut;
    *depth = max_of(0.0, reduced_depth(&search, &search.best));
    *pushed = search.best;
    return 1;
}
