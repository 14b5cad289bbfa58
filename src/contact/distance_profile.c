/* SPDX-License-Identifier: BSD-3-Clause */
#include "contact/distance_profile.h"

#include "contact/winding_number.h"
#include "nearest/bvh.h"

/* Put a crossing of a triangle, a place, into the list, in order of s. Only a crossing of its face has known sides. */
static void put_crossing(struct distance_profile *profile, uint32_t triangle, const pair *found)
{
    uint32_t i = profile->crossing_count;
    if (i == PROFILE_CROSSINGS) {
        profile->is_full = 1;
        return;
    }
    for (; i && profile->crossing[i - 1].s > found->s; i--)
        profile->crossing[i] = profile->crossing[i - 1];
    struct crossing *crossing = &profile->crossing[i];
    *crossing = (struct crossing){ .s = found->s, .triangle = triangle };
    memcpy(crossing->weight, found->weight, sizeof crossing->weight);
    profile->crossing_count++;
    vec3 normal = dpti_profile_exit_direction(profile, triangle, found->weight);
    double along_axis = dot(normal, profile->axis->u);
    int on_face = found->weight[0] > 0.0 && found->weight[1] > 0.0 && found->weight[2] > 0.0;
    if (on_face && fabs(along_axis) > 1e-6 * profile->axis_length) {
        uint32_t flags = surface_part_flags(profile->surface, surface_part(profile->surface, triangle));
        crossing->side_after = along_axis > 0.0 ? 1 : -1;
        crossing->side_before = -crossing->side_after;
        crossing->winding = flags & MESH_PART_SOLID ? -crossing->side_after : 0;
        crossing->is_counted = 1;
        if (flags & MESH_PART_BURIED)
            crossing->side_before = crossing->side_after = -1;
    }
}

/*
 * Join crossings at one place: of both triangles at an edge, or of a vertex' fan. Their sides are unknown then, and so
 * is what they count.
 */
static void join_crossings(struct distance_profile *profile)
{
    double tolerance = 4.0 * profile->axis->error;
    uint32_t joined_count = 0;
    for (uint32_t i = 0; i < profile->crossing_count; i++) {
        const struct crossing *crossing = &profile->crossing[i];
        struct crossing *previous = &profile->crossing[joined_count ? joined_count - 1 : 0];
        if (joined_count && (crossing->s - previous->s) * profile->axis_length <= tolerance) {
            previous->side_before = previous->side_after = 0;
            previous->is_counted = 0;
        } else {
            profile->crossing[joined_count++] = *crossing;
        }
    }
    profile->crossing_count = joined_count;
}

/*
 * Add the stretch of the axis that can be within reach of a triangle, a place, to the reach intervals. Overlapping ones
 * are joined; if there are too many, so are the last ones.
 *
 *   inverse_uu  1 / (u.u), 1/m^2; 0 for an axis without length
 *   reach_s     the reach, in s
 */
static void put_reach_interval(struct distance_profile *profile, uint32_t triangle, double inverse_uu, double reach_s)
{
    const struct surface *surface = profile->surface;
    const struct axis *axis = profile->axis;
    const uint32_t *corner = surface->corners + 3 * (size_t)triangle;
    double from = HUGE_VAL, to = -HUGE_VAL;
    for (int k = 0; k < 3; k++) {
        vec3 c = vec3_of_float(surface->positions + 3 * (size_t)corner[k]);
        double s = dot(sub(c, axis->local_a), axis->u) * inverse_uu;
        from = min_of(from, s);
        to = max_of(to, s);
    }
    from = clamp01(from - reach_s);
    to = to + reach_s < 1.0 ? clamp01(to + reach_s) : 1.0;
    for (uint32_t i = 0; i < profile->reach_interval_count; i++)
        if (profile->reach_from[i] <= from && profile->reach_to[i] >= to)
            return;
    uint32_t kept_count = 0;
    for (uint32_t i = 0; i < profile->reach_interval_count; i++) {
        if (profile->reach_to[i] < from || profile->reach_from[i] > to) {
            profile->reach_from[kept_count] = profile->reach_from[i];
            profile->reach_to[kept_count++] = profile->reach_to[i];
        } else {
            from = min_of(from, profile->reach_from[i]);
            to = max_of(to, profile->reach_to[i]);
        }
    }
    if (kept_count == PROFILE_REACH_INTERVALS) {
        kept_count--;
        from = min_of(from, profile->reach_from[kept_count]);
        to = max_of(to, profile->reach_to[kept_count]);
    }
    profile->reach_from[kept_count] = from;
    profile->reach_to[kept_count] = to;
    profile->reach_interval_count = kept_count + 1;
}

/*
 * 1: at a crossing the axis changes sides. At an edge or a vertex it may come as near as rounding and stay on its
 * side. The sides a little way before and after decide there.
 */
static int goes_through(const struct distance_profile *profile, const struct crossing *crossing)
{
    vec3 u = profile->axis->u;
    double weight[3];
    int corners = 0;
    for (int k = 0; k < 3; k++) {
        weight[k] = crossing->weight[k] > 1e-12 ? crossing->weight[k] : 0.0;
        corners += weight[k] > 0.0;
    }
    if (corners == 3 || profile->axis_length == 0.0)
        return 1;
    return dpti_side_of_arrival(profile->surface, crossing->triangle, weight, u) !=
           dpti_side_of_arrival(profile->surface, crossing->triangle, weight, scaled(u, -1.0));
}

/* 1: the axis goes through an open sheet whose side is not known. */
static int is_sideless(const struct distance_profile *profile)
{
    for (uint32_t k = 0; k < profile->crossing_count; k++) {
        uint32_t part = surface_part(profile->surface, profile->crossing[k].triangle);
        uint32_t flags = surface_part_flags(profile->surface, part);
        if (!(flags & (MESH_PART_SOLID | MESH_PART_BURIED)) && (flags & MESH_PART_MANIFOLD) &&
            !dpti_sides_get(profile->sides, part) && goes_through(profile, &profile->crossing[k]))
            return 1;
    }
    return 0;
}

void dpti_profile_find_crossings(struct distance_profile *profile)
{
    const struct axis *axis = profile->axis;
    struct range range;
    int may_cross;
    if (work_is_spent(&profile->work)) {
        profile->is_cut = 1;
        return;
    }
    double inverse_uu = profile->axis_length > 0.0 ? 1.0 / dot(axis->u, axis->u) : 0.0;
    double reach_s = profile->axis_length > 0.0 ? profile->reach / profile->axis_length : 1.0;
    dpti_range_begin(&range, profile->surface, profile->kernel, axis->local_a, axis->u, profile->reach, &profile->work);
    for (uint32_t triangle; (triangle = dpti_range_next(&range, &may_cross)) != DPT_NONE;) {
        put_reach_interval(profile, triangle, inverse_uu, reach_s);
        if (!may_cross)
            continue;
        pair found = dpti_triangle_pair(profile->surface, triangle, axis->local_a, axis->u);
        if (found.distance2 == 0.0)
            put_crossing(profile, triangle, &found);
    }
    profile->is_cut |= (uint32_t)work_is_spent(&profile->work);
    join_crossings(profile);
    profile->is_sideless = (uint32_t)is_sideless(profile);
}

/* ---- winding numbers between crossings ---- */

/* How often a stretch that is near a hole is halved again, after its first halving. */
enum { HALVINGS = 3 };

static int is_outside_of_box(const struct distance_profile *profile, double s)
{
    return !surface_box_holds(profile->surface, profile_point(profile, s));
}

static double start_of(const struct distance_profile *profile, uint32_t k)
{
    return k ? profile->crossing[k - 1].s : 0.0;
}

static double end_of(const struct distance_profile *profile, uint32_t k)
{
    return k < profile->crossing_count ? profile->crossing[k].s : 1.0;
}

static int is_far_from_holes(const struct distance_profile *profile, double from, double to)
{
    return dpti_holes_are_far_from(profile->surface->holes, profile_point(profile, from),
                                   scaled(profile->axis->u, to - from));
}

/* By a winding number on the stretch: at an end of the axis where that is outside of the mesh's box, or in the middle. */
static int32_t ask(struct distance_profile *profile, uint32_t k)
{
    const double from = start_of(profile, k), to = end_of(profile, k);
    const int is_free =
        (from == 0.0 && is_outside_of_box(profile, 0.0)) || (to == 1.0 && is_outside_of_box(profile, 1.0));
    return is_free ? 0 : dpti_profile_winding(profile, 0.5 * (from + to));
}

/* 1: in front of each face between two stretches it is outside, and inside behind it. */
static int faces_agree(const struct distance_profile *profile, uint32_t first, uint32_t last)
{
    for (uint32_t k = first; k < last; k++) {
        const struct crossing *crossing = &profile->crossing[k];
        if (crossing->side_before * (profile->winding[k] > 0 ? -1 : 1) < 0 ||
            crossing->side_after * (profile->winding[k + 1] > 0 ? -1 : 1) < 0)
            return 0;
    }
    return 1;
}

/*
 * Count along stretches that are far from holes, from the end that costs nothing, if one does. Where faces contradict
 * the count, as they do where parts overlap, the other end is asked too. Returns 0 if that contradicts: then nothing is
 * known.
 */
static int count(struct distance_profile *profile, uint32_t first, uint32_t last)
{
    int32_t *winding = profile->winding;
    const int is_backward = last == profile->crossing_count && is_outside_of_box(profile, 1.0);
    const uint32_t begin = is_backward ? last : first, end = is_backward ? first : last;
    winding[begin] = ask(profile, begin);
    for (uint32_t k = begin; k != end;) {
        const struct crossing *crossing = &profile->crossing[is_backward ? k - 1 : k];
        const uint32_t next = is_backward ? k - 1 : k + 1;
        winding[next] = !crossing->is_counted ? ask(profile, next)
                        : is_backward         ? winding[k] - crossing->winding
                                              : winding[k] + crossing->winding;
        k = next;
    }
    return begin == end || faces_agree(profile, first, last) || winding[end] == ask(profile, end);
}

/* A part of a stretch that is far from holes joins the range before it, of those from `first` on, or asks. */
static void put_range(struct distance_profile *profile, double from, double to, uint32_t first)
{
    const uint32_t count = profile->winding_range_count;
    if (count > first && profile->winding_range[count - 1].to == from) {
        profile->winding_range[count - 1].to = to;
    } else if (count < PROFILE_WINDING_RANGES) {
        const int32_t winding = dpti_profile_winding(profile, 0.5 * (from + to));
        profile->winding_range[count] = (struct winding_range){ from, to, winding, 0 };
        profile->winding_range_count++;
    }
}

/* Find the ranges of a part of a stretch that is near holes: its halves, down to so many levels. */
static void put_ranges(struct distance_profile *profile, double from, double to, uint32_t first, int levels)
{
    const double middle = 0.5 * (from + to), ends[3] = { from, middle, to };
    for (int i = 0; i < 2; i++)
        if (is_far_from_holes(profile, ends[i], ends[i + 1]))
            put_range(profile, ends[i], ends[i + 1], first);
        else if (levels)
            put_ranges(profile, ends[i], ends[i + 1], first, levels - 1);
}

int dpti_stretch_windings_find(struct distance_profile *profile)
{
    int are_known = 1;
    profile->winding_range_count = 0;
    for (uint32_t first = 0, end = 0; first <= profile->crossing_count; first = end) {
        while (end <= profile->crossing_count &&
               is_far_from_holes(profile, start_of(profile, end), end_of(profile, end)))
            end++;
        if (end > first && count(profile, first, end - 1))
            continue;
        if (end == first) {
            put_ranges(profile, start_of(profile, end), end_of(profile, end), profile->winding_range_count, HALVINGS);
            end++;
        }
        are_known = 0;
        for (uint32_t k = first; k < end; k++)
            profile->winding[k] = WINDING_UNKNOWN;
    }
    return are_known;
}

/* ---- the profile ---- */

/* 1: a triangle may be within reach of the axis at s. */
static int is_in_reach_interval(const struct distance_profile *profile, double s)
{
    for (uint32_t i = 0; i < profile->reach_interval_count; i++)
        if (s >= profile->reach_from[i] && s <= profile->reach_to[i])
            return 1;
    return 0;
}

/*
 * The side of an axis that crosses nothing, at its nearest pair. With no hole near, it is the same all along the axis,
 * and outside where one end is out of the mesh's box.
 */
static int side_of_axis(struct distance_profile *profile, const struct pair_search *nearest)
{
    const struct surface *surface = profile->surface;
    if (!profile_has_side_per_sample(profile) && surface->moments &&
        !(surface_box_holds(surface, profile_point(profile, 0.0)) &&
          surface_box_holds(surface, profile_point(profile, 1.0))))
        return 1;
    return dpti_profile_side_of(profile, nearest->pair.s, nearest->triangle, &nearest->pair);
}

/* Find the side of each stretch by its winding number, where that is known and decides. */
static void find_sides_by_winding(struct distance_profile *profile)
{
    const uint32_t has_sheets = profile->surface->holes->has_sheets;
    profile->has_winding_parts = !dpti_stretch_windings_find(profile) || has_sheets;
    profile->has_windings = 1;
    if (has_sheets)
        return;
    for (uint32_t k = 0; k <= profile->crossing_count; k++)
        if (profile->winding[k] != WINDING_UNKNOWN)
            profile->sign[k] = profile->winding[k] > 0 ? -1 : 1;
}

/*
 * Find the side of each stretch between crossings. Where the crossings at its ends do not know it, or disagree, a
 * search in its middle decides.
 */
static void find_sides(struct distance_profile *profile, const struct pair_search *nearest)
{
    const struct holes *holes = profile->surface->holes;
    for (uint32_t k = 0; k <= profile->crossing_count; k++)
        profile->sign[k] = 0;
    if (profile->surface->moments && holes && (profile->has_winding_parts || !holes->normals_tell)) {
        find_sides_by_winding(profile);
        return;
    }
    if (profile_has_side_per_sample(profile))
        return;
    if (!profile->crossing_count) {
        profile->sign[0] = side_of_axis(profile, nearest);
        return;
    }
    for (uint32_t k = 0; k <= profile->crossing_count; k++) {
        const struct crossing *here = &profile->crossing[k];
        int before = k ? here[-1].side_after : 0, after = k < profile->crossing_count ? here->side_before : 0;
        double from = k ? here[-1].s : 0.0, to = k < profile->crossing_count ? here->s : 1.0;
        int sign = before ? before : after;
        if (before * after < 0 || !sign) {
            struct profile_sample middle;
            dpti_profile_take_sample(profile, 0.5 * (from + to), nearest->triangle, 1, &middle);
            sign = middle.height < 0.0 ? -1 : 1;
        }
        profile->sign[k] = sign;
    }
}

/* Put a sample of height 0 at each crossing. */
static void put_crossing_samples(struct distance_profile *profile)
{
    for (uint32_t k = 0; k < profile->crossing_count; k++) {
        const struct crossing *crossing = &profile->crossing[k];
        struct profile_sample sample = {
            .s = crossing->s, .triangle = crossing->triangle, .is_exact = 1, .start_triangle = crossing->triangle
        };
        memcpy(sample.weight, crossing->weight, sizeof sample.weight);
        sample.normal = dpti_profile_exit_direction(profile, crossing->triangle, crossing->weight);
        sample.slope = dot(sample.normal, profile->axis->u);
        dpti_profile_put_sample(profile, &sample);
    }
}

/* Through a hole an axis goes in and out without a crossing. So there is a sample every eighth of its length. */
static void put_winding_samples(struct distance_profile *profile)
{
    enum { WINDING_PIECES = 8 };
    for (int i = 1; i < WINDING_PIECES && profile->has_winding_parts; i++) {
        double s = (double)i / WINDING_PIECES;
        if (!profile->sign[profile_stretch(profile, s)])
            dpti_profile_add_sample(profile, s, 1);
    }
}

/* Give each stretch that may be inside a sample at an end of the axis, and one in its middle if it has none. */
static void put_inner_samples(struct distance_profile *profile)
{
    for (uint32_t k = 0; k <= profile->crossing_count; k++) {
        if (profile->sign[k] > 0)
            continue;
        double from = k ? profile->crossing[k - 1].s : 0.0;
        double to = k < profile->crossing_count ? profile->crossing[k].s : 1.0;
        int has_sample = 0;
        for (uint32_t i = 0; i < profile->sample_count; i++)
            has_sample |= profile->sample[i].s > from && profile->sample[i].s < to;
        if (!k && !(has_sample && profile->sample[0].s == 0.0))
            dpti_profile_add_sample(profile, 0.0, 1);
        if (!has_sample && to > from)
            dpti_profile_add_sample(profile, 0.5 * (from + to), 1);
        if (k == profile->crossing_count && profile->sample[profile->sample_count - 1].s < 1.0)
            dpti_profile_add_sample(profile, 1.0, 1);
    }
}

/*
 * 1: an axis is outside, with no surface within reach. Its nearest point decides. On a part with holes its ends must be
 * outside too: one may lie inside through a hole. An axis that passes through two holes between its ends is taken for
 * outside.
 */
static int is_outside(struct distance_profile *profile, const struct pair_search *nearest)
{
    if (side_of_axis(profile, nearest) < 0)
        return 0;
    return !profile->has_winding_parts ||
           !(dpti_profile_is_inside(profile, 0.0) || dpti_profile_is_inside(profile, 1.0));
}

int dpti_profile_make(struct distance_profile *profile, const struct pair_search *nearest,
                      const struct warm_start *warm_starts, uint32_t warm_start_count)
{
    const struct axis *axis = profile->axis;
    double distance = sqrt(nearest->pair.distance2);
    profile->axis_length = length(axis->u);
    profile->is_full = 0;
    profile->is_cut = 0;
    profile->is_sideless = 0;
    profile->crossing_count = 0;
    profile->reach_interval_count = 0;
    profile->sample_count = 0;
    profile->deepest = 0;
    profile->unchanged_count = 0;
    const struct holes *holes = profile->surface->holes;
    profile->has_windings = 0;
    profile->has_winding_parts = profile->surface->moments && !(holes && !holes->has_sheets &&
                                                                dpti_holes_are_far_from(holes, axis->local_a, axis->u));
    int is_far = distance > profile->reach;
    if (is_far && !profile->sides->count && is_outside(profile, nearest))
        return 0;
    if (is_far && !profile_has_side_per_sample(profile)) {
        profile->sign[0] = -1;
    } else {
        dpti_profile_find_crossings(profile);
        if (profile->is_full || profile->is_cut || profile->is_sideless)
            return 1;
        find_sides(profile, nearest);
    }
    put_crossing_samples(profile);
    if (!profile->crossing_count) {
        struct profile_sample sample;
        dpti_profile_take_sample(profile, nearest->pair.s, nearest->triangle, 0, &sample);
        sample.is_exact = 1;
        dpti_profile_put_sample(profile, &sample);
    }
    for (uint32_t i = 0; i < warm_start_count; i++) {
        int sign = profile->sign[profile_stretch(profile, warm_starts[i].s)];
        if (sign > 0 && !is_in_reach_interval(profile, warm_starts[i].s))
            continue;
        /* A budget goes to the depth first: the regions search for important samples later. */
        int is_important = warm_starts[i].share > PROFILE_SEARCH_SHARE && profile->work.done < PROFILE_WORK_MAX;
        int by_search = profile->has_winding_parts || (is_important && !profile->point_cache);
        struct profile_sample sample;
        dpti_profile_take_sample(profile, warm_starts[i].s, warm_starts[i].triangle, by_search, &sample);
        dpti_profile_put_sample(profile, &sample);
    }
    for (uint32_t i = 1; i < profile->sample_count; i++)
        dpti_profile_share_triangle(profile, i, &profile->sample[i - 1]);
    for (uint32_t i = profile->sample_count - 1; i > 0; i--)
        dpti_profile_share_triangle(profile, i - 1, &profile->sample[i]);
    put_inner_samples(profile);
    put_winding_samples(profile);
    profile->deepest = dpti_profile_prove_deepest(profile, 0.0, 1.0);
    return 1;
}

/*
 * How far beyond a sample, in s, the surface is taken to be within reach: as far as its tangent stays within reach and
 * half as far again, at least a quarter of the reach. 0 for a sample that is not within reach; HUGE_VAL if the height
 * does not grow in this direction.
 *
 *   sign  the direction along the axis: +1 or -1
 */
static double exit_beyond(const struct distance_profile *profile, const struct profile_sample *sample, double sign)
{
    double slope = sign * sample->slope;
    double min_length = 0.25 * profile->reach, reach_left = profile->reach - sample->height;
    if (!(reach_left > 0.0))
        return 0.0;
    return slope > 0.0 ? max_of(min_length / profile->axis_length, 1.5 * reach_left / slope) : HUGE_VAL;
}

int dpti_profile_find_undecided(const struct distance_profile *profile, uint32_t i, double *from, double *to)
{
    const struct profile_sample *left = &profile->sample[i], *right = left + 1;
    double middle = 0.5 * (left->s + right->s);
    if (!(profile->sign[profile_stretch(profile, middle)] > 0 && is_in_reach_interval(profile, middle)))
        return 0;
    *from = left->s + exit_beyond(profile, left, 1.0);
    *to = right->s - exit_beyond(profile, right, -1.0);
    return *to > *from;
}

/* Stretches without a sample within reach come first, then those beside one. */
void dpti_profile_search_undecided(struct distance_profile *profile, double min_s, double max_s)
{
    enum { UNDECIDED_MAX = 16 };
    uint32_t searched = 0;
    double from, to;
    for (int pass = 0; pass < 2; pass++)
        for (uint32_t i = 0; i + 1 < profile->sample_count && searched < UNDECIDED_MAX && !profile->is_cut;) {
            const struct profile_sample *here = &profile->sample[i];
            int is_within = here->height < profile->reach || here[1].height < profile->reach;
            int is_undecided = is_within == pass && here->s >= min_s && here[1].s <= max_s &&
                               dpti_profile_find_undecided(profile, i, &from, &to);
            searched += (uint32_t)is_undecided;
            if (!is_undecided || dpti_profile_add_nearest(profile, from, to, profile->reach) == DPT_NONE)
                i++;
        }
}

/*
 * Beyond a reach interval an axis that is outside is out of reach, so its end is a mark. An end that is inside, or at
 * an end of the axis, or whose side is not known, gets a sample.
 */
void dpti_profile_find_reach(struct distance_profile *profile)
{
    struct profile_sample beyond = { .height = profile->reach, .triangle = DPT_NONE };
    for (uint32_t i = 0; i < profile->reach_interval_count; i++) {
        const double ends[2] = { profile->reach_from[i], profile->reach_to[i] };
        for (int k = 0; k < 2; k++) {
            int sign = profile->sign[profile_stretch(profile, ends[k])];
            beyond.s = ends[k];
            if (ends[k] <= 0.0 || ends[k] >= 1.0 || !sign)
                dpti_profile_add_sample(profile, ends[k], 1);
            else if (sign > 0)
                dpti_profile_put_sample(profile, &beyond);
        }
    }
    dpti_profile_search_undecided(profile, 0.0, 1.0);
}
