/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A point behind a sheet, h from it, beside whose border the way back ends when that is as near as the sheet: b = h.
 * So what pushes it is no deeper than b - h. Both are distances, so that this changes by no more than the point moves
 * where the ways to sheet and border turn less than 60 degrees from each other; beyond, b > 2 h on a flat sheet, a
 * slower rise keeps it so. A tool is pushed at the point of its axis that is deepest by that measure.
 */
#include "contact/sheet_border.h"

#include "nearest/filter_segment.h"

enum {
    EDGES_MAX = 256,
    BLOCKS_MAX = 2048,  /* of a search for the border, beside the budget */
    STRETCH_STEPS = 16, /* of a stretch that is behind */
    WINDOW_STEPS = 8,   /* of two of them */
    GOLDEN_STEPS = 14   /* of a golden section: 7e-4 of its span */
};

#define GOLDEN    0.6180339887498949
#define RISE_SLOW 0.8

/* Edges of sheets' borders that may count. */
struct border_edges {
    const struct surface *surface;
    uint32_t count;
    uint32_t stride; /* of so many only one was kept */
    struct border_edge {
        uint32_t from, to; /* vertices */
        uint32_t part;
    } edge[EDGES_MAX];
};

/* What a border at distance b leaves of the depth of a point that is h behind, or in front, at h = 0. */
static double depth_left_by_border(double h, double b)
{
    return max_of(0.0, min_of(b - h, h + RISE_SLOW * (b - 2.0 * h)));
}

/* A border that is farther changes no point's depth that is as deep, or less. */
static double border_reach(double h, double radius, double share)
{
    return 2.0 * h + ((h + radius) / share - h) / RISE_SLOW;
}

static double edge_square_distance(const struct border_edges *border,
                                   const struct border_edge *edge, vec3 x)
{
    vec3 from = surface_vertex(border->surface, edge->from);
    vec3 along_edge = sub(surface_vertex(border->surface, edge->to), from), way = sub(x, from);
    double size = dot(along_edge, along_edge);
    vec3 off = along(way, size > 0.0 ? -clamp01(dot(way, along_edge) / size) : 0.0, along_edge);
    return dot(off, off);
}

static double border_distance(const struct border_edges *border, uint32_t part, vec3 x)
{
    double least = HUGE_VAL;
    for (uint32_t i = 0; i < border->count; i++)
        if (border->edge[i].part == part)
            least = min_of(least, edge_square_distance(border, &border->edge[i], x));
    return sqrt(least);
}

/* Where there are too many, every other one does: each is short beside the reach then. */
static void put_edge(struct border_edges *border, uint32_t number, const struct border_edge *edge)
{
    if (number % border->stride)
        return;
    if (border->count == EDGES_MAX) {
        for (uint32_t i = 0; i < EDGES_MAX / 2; i++)
            border->edge[i] = border->edge[2 * i];
        border->count = EDGES_MAX / 2;
        border->stride *= 2;
    }
    border->edge[border->count++] = *edge;
}

/* Those of a leaf, of sheets with a side, that are within reach of a point; `number` counts all that were seen. */
static void add_leaf_edges(const struct distance_profile *profile, uint32_t leaf, vec3 x,
                           double reach, uint32_t *number, struct border_edges *border)
{
    const struct surface *surface = profile->surface;
    const uint32_t *neighbour = surface_neighbours(surface);
    const uint32_t first = leaf * LANES, left = surface_triangles(surface) - first;
    for (uint32_t i = 0; i < 3 * (left < LANES ? left : LANES); i++) {
        const uint32_t t = first + i / 3, k = i % 3;
        if (neighbour[3 * (size_t)first + i] != MESH_EDGE_OPEN)
            continue;
        const struct border_edge edge = { surface_corner(surface, t, k),
                                          surface_corner(surface, t, (k + 1) % 3),
                                          surface_part(surface, t) };
        if (dpti_sides_get(profile->sides, edge.part) &&
            edge_square_distance(border, &edge, x) <= reach * reach)
            put_edge(border, (*number)++, &edge);
    }
}

/* Border edges within reach of a point; 0 where that was too much work. */
static int gather_edges(const struct distance_profile *profile, vec3 x, double reach,
                        struct border_edges *border)
{
    const struct surface *surface = profile->surface;
    const vec3 seen = scaled(sub(x, surface->filter_centre), surface->filter_scale);
    const double far = reach * surface->filter_scale + kernel_margin(length(seen), length(seen));
    const float limit = (float)(far * far * (1.0 + 4.0 * KERNEL_STRETCH));
    uint32_t node[MESH_LEVELS_MAX + 1], lanes[MESH_LEVELS_MAX + 1], number = 0, blocks = 0;
    uint32_t level = surface->levels;
    float at[3], bound[LANES];
    put_float(seen, at);
    border->surface = surface;
    border->count = 0;
    border->stride = 1;
    node[level] = 0;
    for (int is_new = 1; level <= surface->levels; is_new = 0) {
        if (is_new || lanes[level] == UINT32_MAX)
            lanes[level] =
                lanes_of(surface->count[level - 1] - node[level] * LANES) &
                profile->kernel->point_boxes(
                    surface->level[level] + (size_t)node[level] * MESH_BOX_WORDS, at, limit, bound);
        if (!lanes[level]) {
            level++;
            continue;
        }
        const uint32_t child = node[level] * LANES + first_lane(lanes[level]);
        lanes[level] &= lanes[level] - 1;
        if (++blocks > BLOCKS_MAX)
            return 0;
        if (level == 1) {
            add_leaf_edges(profile, child, x, reach, &number, border);
        } else {
            node[--level] = child;
            lanes[level] = UINT32_MAX; /* not yet looked at */
        }
    }
    return 1;
}

/*
 * Is there a border within reach of a sample? One looks twice as far, so as not to look again in each tick. Where
 * that is too much work, none counts until the tool has gone on by a reach.
 */
static int is_border_near(const struct distance_profile *profile,
                          const struct profile_sample *deepest, double reach, uint32_t id,
                          struct border_view *view, struct border_edges *border)
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
    const int all = gather_edges(profile, x, 2.0 * reach, border);
    const double clear = all ? border_distance(border, part, x) : HUGE_VAL;
    *view = (struct border_view){ .centre = x,
                                  .clear_radius = min_of(2.0 * reach, clear),
                                  .body = id,
                                  .part = part,
                                  .has_border = clear < 2.0 * reach };
    return clear <= reach;
}

/* A search for the deepest point of an axis. */
struct border_search {
    struct distance_profile *profile;
    const struct border_edges *border;
    double radius;
    /*
     * Of the room that counts: more than all of a tool that has hardly come through, as for one in front there is no
     * border.
     */
    double share;
    uint32_t last_triangle;     /* triangle of the last point that was tried */
    struct profile_sample best; /* the best so far */
    double best_depth;
};

/*
 * How deep a sample counts; not one beside the border, which would push another way than back through the sheet. In
 * front of the sheet the border counts too: there it is that the rest of the axis is behind.
 */
static double depth_of(const struct border_search *quest, const struct profile_sample *sample)
{
    const struct distance_profile *profile = quest->profile;
    if (sample->triangle == DPT_NONE)
        return -HUGE_VAL;
    const uint32_t part = surface_part(profile->surface, sample->triangle);
    const double depth = quest->radius - sample->height;
    if (depth <= quest->best_depth || !dpti_sides_get(profile->sides, part))
        return depth; /* or less, which does not count */
    if (sample->height >= 0.0 &&
        dpti_side_is_border(profile->surface, sample->triangle, sample->weight))
        return -HUGE_VAL;
    double b = border_distance(quest->border, part, profile_point(profile, sample->s));
    return min_of(depth, quest->share * depth_left_by_border(fabs(sample->height), b));
}

static double try_sample(struct border_search *quest, const struct profile_sample *sample)
{
    double depth = depth_of(quest, sample);
    if (depth > quest->best_depth) {
        quest->best = *sample;
        quest->best_depth = depth;
    }
    return depth;
}

/* By descent from where the last one was, which is near. */
static double try_place(struct border_search *quest, double s)
{
    struct profile_sample sample;
    dpti_profile_take_sample(quest->profile, s, quest->last_triangle, 0, &sample);
    quest->last_triangle = sample.triangle;
    return try_sample(quest, &sample);
}

/* The top of a hill, by a golden section. */
static void climb(struct border_search *quest, double from, double to)
{
    double left = to - GOLDEN * (to - from), right = from + GOLDEN * (to - from);
    double at_left = try_place(quest, left), at_right = try_place(quest, right);
    for (int i = 0; i < GOLDEN_STEPS; i++) {
        if (at_left > at_right) {
            to = right;
            right = left;
            at_right = at_left;
            left = to - GOLDEN * (to - from);
            at_left = try_place(quest, left);
        } else {
            from = left;
            left = right;
            at_left = at_right;
            right = from + GOLDEN * (to - from);
            at_right = try_place(quest, right);
        }
    }
}

static void search_stretch(struct border_search *quest, double from, double to, int steps);

/* A piece of a stretch, with those edges alone that may be nearest to a point of it. */
static void search_window(struct border_search *quest, double from, double to)
{
    const struct border_edges *all = quest->border;
    const double half = 0.5 * (to - from) * quest->profile->axis_length;
    const vec3 x = profile_point(quest->profile, 0.5 * (from + to));
    struct border_edges near = { .surface = all->surface };
    uint32_t part = DPT_NONE;
    double reach = 0.0;
    for (uint32_t i = 0; i < all->count; i++) {
        if (all->edge[i].part != part) {
            part = all->edge[i].part;
            reach = border_distance(all, part, x) + 2.0 * half;
        }
        if (edge_square_distance(all, &all->edge[i], x) <= reach * reach)
            near.edge[near.count++] = all->edge[i];
    }
    quest->border = &near;
    search_stretch(quest, from, to, WINDOW_STEPS);
    quest->border = all;
}

/* A stretch may have more than one hill, and what looks like one, two beside each other: so steps are taken twice. */
static void search_stretch(struct border_search *quest, double from, double to, int steps)
{
    double depth[STRETCH_STEPS + 1], step = (to - from) / steps;
    for (int i = 0; i <= steps; i++)
        depth[i] = try_place(quest, from + i * step);
    for (int i = 0; i <= steps; i++) {
        double before = i ? depth[i - 1] : -HUGE_VAL, after = i < steps ? depth[i + 1] : -HUGE_VAL;
        double left = max_of(from, from + (i - 1) * step),
               right = min_of(to, from + (i + 1) * step);
        /* The depth changes by no more than twice the way. */
        if (!(depth[i] >= before && depth[i] > after &&
              depth[i] + 2.0 * step * quest->profile->axis_length > quest->best_depth))
            continue;
        if (steps == STRETCH_STEPS)
            search_window(quest, left, right);
        else
            climb(quest, left, right);
    }
}

static int is_on_border(const struct distance_profile *profile, const struct profile_sample *sample)
{
    return sample->triangle != DPT_NONE &&
           dpti_side_is_border(profile->surface, sample->triangle, sample->weight);
}

/*
 * Where a stretch that ends with a sample may go on to, towards the next one: to that, where it is beside the
 * border; else until the tool's surface leaves the sheet, and half as far again.
 */
static double stretch_end(const struct border_search *quest, const struct profile_sample *last,
                          const struct profile_sample *next)
{
    const double way = next->s - last->s, rise = fabs(last->slope);
    const double left = 1.5 * (quest->radius - last->height);
    if (is_on_border(quest->profile, next) || rise * fabs(way) <= left)
        return next->s;
    return last->s + (way < 0.0 ? -left : left) / rise;
}

/* The tool's surface is within the sheet there, or it is behind. */
static int is_on_sheet_or_behind(const struct border_search *quest,
                                 const struct profile_sample *sample)
{
    return sample->height <= 0.0 ||
           (sample->height < quest->radius && !is_on_border(quest->profile, sample));
}

/* The next stretch of which a part at least is behind, from sample *i on, which is moved past it; 0: there is none. */
static int next_stretch(const struct border_search *quest, uint32_t *i, double *from, double *to)
{
    const struct profile_sample *sample = quest->profile->sample;
    const uint32_t count = quest->profile->sample_count;
    while (*i < count) {
        const uint32_t first = *i;
        int behind = 0;
        for (; *i < count && is_on_sheet_or_behind(quest, &sample[*i]); ++*i)
            behind |= sample[*i].height <= 0.0;
        const uint32_t end = *i;
        *i += end == first;
        if (!behind)
            continue;
        *from = first ? stretch_end(quest, &sample[first], &sample[first - 1]) : sample[first].s;
        *to = end < count ? stretch_end(quest, &sample[end - 1], &sample[end]) : sample[end - 1].s;
        return 1;
    }
    return 0;
}

/* All of them as one: of that the border is asked for. */
static int gather_stretches(const struct border_search *quest, double reach,
                            struct border_edges *border)
{
    double from = 1.0, to = 0.0, first, last;
    for (uint32_t i = 0; next_stretch(quest, &i, &first, &last);) {
        from = min_of(from, first);
        to = max_of(to, last);
    }
    const double half = 0.5 * (to - from) * quest->profile->axis_length;
    return from <= to &&
           gather_edges(quest->profile, profile_point(quest->profile, 0.5 * (from + to)),
                        half + reach, border);
}

/* No search puts a sample into the profile: it stays as it is. */
static void search_axis(struct border_search *quest)
{
    const struct distance_profile *profile = quest->profile;
    double from, to;
    for (uint32_t i = 0; i < profile->sample_count; i++)
        try_sample(quest, &profile->sample[i]);
    for (uint32_t i = 0; next_stretch(quest, &i, &from, &to);)
        search_stretch(quest, from, to, STRETCH_STEPS);
}

/*
 * How far the search must look, or 0: no border can be near. The samples tell of it where they go on beside it in
 * front; what is between such two may be deeper than both.
 */
static double max_depth_behind(const struct distance_profile *profile)
{
    double most = -profile->sample[profile->deepest].height;
    for (uint32_t i = 0; i + 1 < profile->sample_count; i++) {
        const struct profile_sample *low = &profile->sample[i], *high = low + 1;
        if (low->height > high->height) {
            low = high;
            high = &profile->sample[i];
        }
        if (low->height <= 0.0 && high->height > most && is_on_border(profile, high))
            most = high->height;
    }
    return most;
}

/* How far the axis has come through the sheet's plane, beside its border too. */
static double depth_through_plane(const struct distance_profile *profile,
                                  const struct profile_sample *deepest)
{
    vec3 a = along(deepest->gap, -deepest->s, profile->axis->u);
    return max_of(-dot(a, deepest->normal), -dot(add(a, profile->axis->u), deepest->normal));
}

int dpti_sheet_border_reduce(struct distance_profile *profile, const struct frame *body,
                             uint32_t id, double radius, uint32_t smooth, struct border_view *view,
                             struct penetration *penetration, struct warm_start *found)
{
    const struct profile_sample deepest = profile->sample[profile->deepest];
    const double most = max_depth_behind(profile), through = depth_through_plane(profile, &deepest);
    const double share = max_of(1.0, radius / max_of(max_of(most, through), DBL_MIN));
    const double reach = border_reach(most, radius, share);
    struct border_edges border;
    if (!(penetration->depth > 0.0) || !is_border_near(profile, &deepest, reach, id, view, &border))
        return 0;
    struct border_search quest = { .profile = profile,
                                   .border = &border,
                                   .radius = radius,
                                   .share = share,
                                   .last_triangle = deepest.triangle,
                                   .best = deepest };
    if (!gather_stretches(&quest, reach, &border))
        return 0;
    quest.best_depth = depth_of(&quest, &deepest) + profile->tolerance;
    *found = (struct warm_start){ deepest.s, deepest.triangle, 1.0f };
    if (most == -deepest.height && quest.best_depth >= penetration->depth)
        return 1;
    const uint32_t cut = profile->is_cut;
    const struct work work = profile->work;
    struct point_cache *cache = profile->point_cache;
    profile->point_cache = NULL;
    profile->work = work_of(WORK_UNLIMITED);
    search_axis(&quest);
    dpti_profile_take_sample(profile, quest.best.s, quest.best.triangle, 1, &quest.best);
    quest.best_depth = -HUGE_VAL;
    profile->point_cache = cache;
    profile->work = work;
    profile->is_cut = cut;
    penetration->direction = frame_turn(body, dpti_contact_normal(profile, &quest.best, smooth));
    penetration->at =
        along(profile->axis->a, quest.best.s, sub(profile->axis->b, profile->axis->a));
    penetration->depth = max_of(0.0, depth_of(&quest, &quest.best));
    *found = (struct warm_start){ quest.best.s, quest.best.triangle, 1.0f };
    return 1;
}
