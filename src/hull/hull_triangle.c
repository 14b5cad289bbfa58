/* SPDX-License-Identifier: BSD-3-Clause */
#include "hull/hull_triangle.h"

enum { ITERATIONS_MAX = 32 };

/* An iteration that gains less than this share of the distance is the last. */
#define GAIN_MIN 1e-14

/* Up to four points of the difference of two sets, whose hull is searched for the point nearest to the origin. */
struct simplex {
    vec3 w[4];
    uint32_t count;
};

/* Keep the points with these numbers. */
static void keep(struct simplex *simplex, uint32_t count, const uint32_t *kept)
{
    vec3 w[4];
    for (uint32_t i = 0; i < count; i++)
        w[i] = simplex->w[kept[i]];
    for (uint32_t i = 0; i < count; i++)
        simplex->w[i] = w[i];
    simplex->count = count;
}

/* The point of the segment w[i] w[j] that is nearest to the origin; kept: the ends that it needs. */
static vec3 nearest_of_two(const struct simplex *simplex, const uint32_t at[2], uint32_t *count, uint32_t *kept)
{
    const vec3 a = simplex->w[at[0]], u = sub(simplex->w[at[1]], a);
    const double s = nearest_on(a, u, (vec3){ 0.0, 0.0, 0.0 });
    *count = 0;
    if (s < 1.0)
        kept[(*count)++] = at[0];
    if (s > 0.0)
        kept[(*count)++] = at[1];
    return along(a, s, u);
}

/* The same of a triangle. */
static vec3 nearest_of_three(const struct simplex *simplex, const uint32_t at[3], uint32_t *count, uint32_t *kept)
{
    const vec3 a = simplex->w[at[0]], b = simplex->w[at[1]], c = simplex->w[at[2]];
    const vec3 normal = cross(sub(b, a), sub(c, a));
    const double square = dot(normal, normal);
    int is_inside = square > 0.0;
    for (uint32_t k = 0; k < 3; k++) {
        const vec3 from = simplex->w[at[k]], to = simplex->w[at[(k + 1) % 3]];
        is_inside = is_inside && dot(cross(sub(to, from), scaled(from, -1.0)), normal) > 0.0;
    }
    if (is_inside) {
        *count = 3;
        for (uint32_t k = 0; k < 3; k++)
            kept[k] = at[k];
        return scaled(normal, dot(a, normal) / square);
    }
    double best2 = HUGE_VAL;
    vec3 best = a;
    for (uint32_t k = 0; k < 3; k++) {
        const uint32_t two[2] = { at[k], at[(k + 1) % 3] };
        uint32_t some, kept_two[2];
        const vec3 found = nearest_of_two(simplex, two, &some, kept_two);
        if (dot(found, found) < best2) {
            best2 = dot(found, found);
            best = found;
            *count = some;
            for (uint32_t i = 0; i < some; i++)
                kept[i] = kept_two[i];
        }
    }
    return best;
}

/* Reduce a simplex to the points that its nearest point needs. 0: it holds the origin. */
static int reduce(struct simplex *simplex, vec3 *nearest)
{
    static const uint32_t faces[4][4] = { { 0, 1, 2, 3 }, { 0, 2, 3, 1 }, { 0, 3, 1, 2 }, { 1, 3, 2, 0 } };
    uint32_t count = 1, kept[3] = { 0 };
    if (simplex->count == 1) {
        *nearest = simplex->w[0];
    } else if (simplex->count < 4) {
        const uint32_t all[3] = { 0, 1, 2 };
        *nearest = simplex->count == 2 ? nearest_of_two(simplex, all, &count, kept)
                                       : nearest_of_three(simplex, all, &count, kept);
    } else {
        double best2 = HUGE_VAL;
        for (int f = 0; f < 4; f++) {
            const vec3 a = simplex->w[faces[f][0]];
            const vec3 normal = cross(sub(simplex->w[faces[f][1]], a), sub(simplex->w[faces[f][2]], a));
            const double fourth = dot(normal, sub(simplex->w[faces[f][3]], a));
            /* The origin is beyond a face, or nobody knows, as the four lie in a plane. */
            if (-dot(normal, a) * fourth > 0.0)
                continue;
            uint32_t some, kept_three[3];
            const vec3 found = nearest_of_three(simplex, faces[f], &some, kept_three);
            if (dot(found, found) < best2) {
                best2 = dot(found, found);
                *nearest = found;
                count = some;
                for (uint32_t i = 0; i < some; i++)
                    kept[i] = kept_three[i];
            }
        }
        if (best2 == HUGE_VAL)
            return 0;
    }
    keep(simplex, count, kept);
    return dot(*nearest, *nearest) > 0.0;
}

/* The point of a set that is farthest along n. */
static vec3 farthest_along(const vec3 *points, uint32_t count, vec3 n)
{
    uint32_t best = 0;
    double max = dot(n, points[0]);
    for (uint32_t i = 1; i < count; i++) {
        const double at = dot(n, points[i]);
        if (at > max) {
            max = at;
            best = i;
        }
    }
    return points[best];
}

/* What an iteration tells: the distance is at least `low`, along the unit vector n, and at most `high`. */
struct bracket {
    double low, high;
    vec3 n;
    struct simplex simplex;
};

static void begin_bracket(struct bracket *bracket, vec3 n)
{
    bracket->low = 0.0;
    bracket->high = HUGE_VAL;
    bracket->n = unit_of(n);
    bracket->simplex.count = 0;
}

/*
 * One iteration, from the direction bracket->n. Returns 0 where none can follow: the sets meet, as far as rounding tells,
 * or nothing is gained any more.
 */
static int narrow(struct bracket *bracket, const vec3 *a, uint32_t a_count, const vec3 *b, uint32_t b_count)
{
    vec3 v = { 0.0, 0.0, 0.0 };
    const vec3 w = sub(farthest_along(b, b_count, scaled(bracket->n, -1.0)), farthest_along(a, a_count, bracket->n));
    bracket->low = dot(w, bracket->n);
    if (bracket->simplex.count == 4)
        return 0;
    bracket->simplex.w[bracket->simplex.count++] = w;
    if (!reduce(&bracket->simplex, &v)) {
        bracket->high = 0.0;
        return 0;
    }
    /* v is the difference of two points of the sets: they are no farther apart. */
    const double size = length(v), last = bracket->high;
    bracket->high = size;
    bracket->n = scaled(v, 1.0 / size);
    return size > 0.0 && size < last * (1.0 - GAIN_MIN);
}

/* A direction to begin with, of any length but 0. */
static vec3 direction_of(const vec3 *a, const vec3 *b, vec3 n)
{
    return dot(n, n) > 0.0 ? n : sub(b[0], a[0]);
}

int dpti_separate(const vec3 *a, uint32_t a_count, const vec3 *b, uint32_t b_count, double apart, vec3 *n)
{
    struct bracket bracket;
    begin_bracket(&bracket, direction_of(a, b, *n));
    for (int k = 0; k < ITERATIONS_MAX; k++) {
        const vec3 along_it = bracket.n;
        const int goes_on = narrow(&bracket, a, a_count, b, b_count);
        if (bracket.low > apart) {
            *n = along_it;
            return 1;
        }
        if (!goes_on || bracket.high <= apart)
            return 0;
    }
    return 0;
}

/* The bracket of the distance may be this wide, as a share of it. */
#define NARROW 1e-6

double dpti_distance_upper(const vec3 *a, uint32_t a_count, const vec3 *b, uint32_t b_count, double limit, vec3 *n)
{
    struct bracket bracket;
    begin_bracket(&bracket, direction_of(a, b, *n));
    for (int k = 0; k < ITERATIONS_MAX; k++) {
        const vec3 along_it = bracket.n;
        const int goes_on = narrow(&bracket, a, a_count, b, b_count);
        if (bracket.low > limit) {
            *n = along_it;
            return HUGE_VAL;
        }
        if (!goes_on || bracket.low >= bracket.high * (1.0 - NARROW))
            break;
    }
    return bracket.high;
}

/* ---- pairs with a triangle ---- */

/* A triangle, and a ball that holds it. */
struct ball {
    const vec3 *v;
    vec3 edge[3], middle;
    double radius;
    struct triangle_frame frame;
    int has_face;
    vec3 normal; /* unit; 0 without a face */
};

static struct ball ball_of(const vec3 v[3])
{
    struct ball ball = { .v = v, .edge = { sub(v[1], v[0]), sub(v[2], v[1]), sub(v[0], v[2]) } };
    ball.middle = scaled(add(add(v[0], v[1]), v[2]), 1.0 / 3.0);
    for (int k = 0; k < 3; k++)
        ball.radius = max_of(ball.radius, length(sub(v[k], ball.middle)));
    ball.has_face = triangle_frame_set(ball.edge, &ball.frame);
    ball.normal = ball.has_face ? unit_of(ball.frame.z) : (vec3){ 0.0, 0.0, 0.0 };
    return ball;
}

/* Which of the hull's features are too far from the ball to count. */
static int corner_is_far(const struct hull_place *place, const struct ball *ball, uint32_t corner, double limit)
{
    const vec3 offset = sub(place->corner[corner], ball->middle);
    const double reach = limit + ball->radius;
    return fabs(dot(offset, ball->normal)) > limit || dot(offset, offset) > reach * reach;
}

static int edge_is_far(const struct hull_place *place, const struct ball *ball, uint32_t edge, double limit)
{
    const vec3 a = sub(place->corner[place->hull->edge[edge][0]], ball->middle);
    const vec3 b = sub(place->corner[place->hull->edge[edge][1]], ball->middle);
    const vec3 u = sub(b, a);
    const double height_a = dot(a, ball->normal), height_b = dot(b, ball->normal);
    const double reach = limit + ball->radius;
    if (min_of(height_a, height_b) > limit || max_of(height_a, height_b) < -limit)
        return 1;
    const double s = nearest_on(a, u, (vec3){ 0.0, 0.0, 0.0 });
    const vec3 nearest = along(a, s, u);
    return dot(nearest, nearest) > reach * reach;
}

static int try_corner(const struct hull_place *place, uint32_t corner, const vec3 v[3], struct hull_pair *found)
{
    point_triangle(place->corner[corner], v, &found->pair);
    found->pair.s = 0.0;
    found->feature = HULL_CORNER + corner;
    return 1;
}

static int try_edges(const struct hull_place *place, uint32_t edge, uint32_t k, const vec3 v[3],
                     struct hull_pair *found)
{
    const uint8_t *ends = place->hull->edge[edge];
    const vec3 a = place->corner[ends[0]], u = sub(place->corner[ends[1]], a);
    const vec3 e = sub(v[(k + 1) % 3], v[k]), from = sub(a, v[k]);
    double s, t;
    segment_edge(u, 1.0 / dot(u, u), from, e, &s, &t);
    /* The triangle's corner at t = 1 belongs to the next edge. */
    if (!(s > 0.0 && s < 1.0 && t < 1.0))
        return 0;
    pair *made = &found->pair;
    made->gap = sub(along(from, s, u), scaled(e, t));
    made->distance2 = dot(made->gap, made->gap);
    made->weight[k] = 1.0 - t;
    made->weight[(k + 1) % 3] = t;
    made->weight[(k + 2) % 3] = 0.0;
    made->s = 0.0;
    found->feature = HULL_EDGE + 3 * edge + k;
    return 1;
}

static int is_over_face(const struct hull_place *place, uint32_t face, vec3 x)
{
    const struct hull_face *of = &place->hull->face[face];
    const uint8_t *loop = place->hull->loop + of->first;
    vec3 from = place->corner[loop[of->count - 1]];
    for (uint32_t i = 0; i < of->count; i++) {
        const vec3 to = place->corner[loop[i]];
        if (!(dot(cross(sub(to, from), sub(x, from)), place->normal[face]) >= 0.0))
            return 0;
        from = to;
    }
    return 1;
}

static double height_over(const struct hull_place *place, uint32_t face, vec3 x)
{
    const uint8_t first = place->hull->loop[place->hull->face[face].first];
    return dot(sub(x, place->corner[first]), place->normal[face]);
}

/* Below a face by no more than rounding: what lies in the plane of a flat hull may be below both of its faces. */
static int is_above(vec3 x, double height)
{
    return height >= -0x1p-50 * extent_of(x);
}

static int try_face(const struct hull_place *place, uint32_t face, uint32_t k, const vec3 v[3], struct hull_pair *found)
{
    const double height = height_over(place, face, v[k]);
    if (!(is_above(v[k], height) && is_over_face(place, face, v[k])))
        return 0;
    found->pair = (pair){ .distance2 = height * height, .gap = scaled(place->normal[face], -height) };
    found->pair.weight[k] = 1.0;
    found->feature = HULL_FACE + 3 * face + k;
    return 1;
}

int dpti_hull_feature(const struct hull_place *place, uint32_t feature, const vec3 v[3], struct hull_pair *found)
{
    if (feature < HULL_EDGE)
        return try_corner(place, feature - HULL_CORNER, v, found);
    const uint32_t number = feature < HULL_FACE ? feature - HULL_EDGE : feature - HULL_FACE;
    return feature < HULL_FACE ? try_edges(place, number / 3, number % 3, v, found)
                               : try_face(place, number / 3, number % 3, v, found);
}

void dpti_hull_place_feature(struct hull_place *place, const struct dpt_hull *hull, uint32_t feature,
                             const struct frame *tool, const struct frame *body)
{
    const uint32_t number = feature < HULL_FACE ? feature - HULL_EDGE : feature - HULL_FACE;
    place->hull = hull;
    if (feature < HULL_EDGE) {
        const uint32_t corner = feature - HULL_CORNER;
        place->corner[corner] = hull_corner_at(hull, corner, tool, body);
    } else if (feature < HULL_FACE) {
        for (int k = 0; k < 2; k++) {
            const uint32_t corner = hull->edge[number / 3][k];
            place->corner[corner] = hull_corner_at(hull, corner, tool, body);
        }
    } else {
        const struct hull_face *face = &hull->face[number / 3];
        for (uint32_t i = face->first; i < face->first + face->count; i++)
            place->corner[hull->loop[i]] = hull_corner_at(hull, hull->loop[i], tool, body);
        place->normal[number / 3] = frame_turn_back(body, frame_turn(tool, face->normal));
    }
}

/* Call `take` for the features that are near; *limit may shrink meanwhile. */
static void visit_features(const struct hull_place *place, const struct ball *ball, const double *limit,
                           hull_take_fn *take, void *user)
{
    const struct dpt_hull *hull = place->hull;
    struct hull_pair found;
    for (uint32_t c = 0; c < hull->corner_count; c++)
        if (!corner_is_far(place, ball, c, *limit) && try_corner(place, c, ball->v, &found))
            take(user, &found);
    for (uint32_t e = 0; e < hull->edge_count; e++)
        for (uint32_t k = 0; k < 3 && (k || !edge_is_far(place, ball, e, *limit)); k++)
            if (try_edges(place, e, k, ball->v, &found))
                take(user, &found);
    for (uint32_t f = 0; f < hull->face_count; f++)
        for (uint32_t k = 0; k < 3; k++) {
            const double height = height_over(place, f, ball->v[k]);
            if (is_above(ball->v[k], height) && height <= *limit && try_face(place, f, k, ball->v, &found))
                take(user, &found);
        }
}

struct taken {
    hull_take_fn *take;
    void *user;
    double limit2;
};

static void take_within(void *user, const struct hull_pair *found)
{
    const struct taken *taken = user;
    if (found->pair.distance2 <= taken->limit2)
        taken->take(taken->user, found);
}

void dpti_hull_features(const struct hull_place *place, const vec3 v[3], double limit, hull_take_fn *take, void *user)
{
    const struct ball ball = ball_of(v);
    struct taken taken = { take, user, limit * limit };
    visit_features(place, &ball, &limit, take_within, &taken);
}

/* 1 if a motion along `direction` leads nearer than the lean allows; toward: from where it begins to the other point. */
static int leads_nearer(vec3 direction, vec3 toward, double lean)
{
    const double rise = dot(direction, toward);
    return rise > 0.0 && rise * rise > lean * lean * dot(direction, direction) * dot(toward, toward);
}

static int corner_is_local(const struct hull_place *place, uint32_t corner, vec3 toward, double lean)
{
    for (uint32_t e = 0; e < place->hull->edge_count; e++) {
        const uint8_t *ends = place->hull->edge[e];
        if (ends[0] != corner && ends[1] != corner)
            continue;
        const uint8_t other = ends[0] == corner ? ends[1] : ends[0];
        if (leads_nearer(sub(place->corner[other], place->corner[corner]), toward, lean))
            return 0;
    }
    return 1;
}

/* From a corner of the triangle both of its edges lead on. */
static int triangle_corner_is_local(const vec3 v[3], uint32_t k, vec3 toward, double lean)
{
    return !leads_nearer(sub(v[(k + 1) % 3], v[k]), toward, lean) &&
           !leads_nearer(sub(v[(k + 2) % 3], v[k]), toward, lean);
}

/* An edge's neighbours are the faces beside it, and beside the triangle's edge the triangle. */
static int edges_are_local(const struct hull_place *place, uint32_t edge, uint32_t k, const vec3 v[3],
                           const struct hull_pair *found, double lean)
{
    const vec3 gap = found->pair.gap, toward = scaled(gap, -1.0);
    const uint8_t *ends = place->hull->edge[edge], *faces = place->hull->edge_face[edge];
    const vec3 u = sub(place->corner[ends[1]], place->corner[ends[0]]);
    const vec3 e = sub(v[(k + 1) % 3], v[k]), across = sub(v[(k + 2) % 3], v[k]);
    const vec3 inward = along(across, -dot(across, e) / dot(e, e), e);
    return !leads_nearer(cross(place->normal[faces[0]], u), toward, lean) &&
           !leads_nearer(cross(u, place->normal[faces[1]]), toward, lean) &&
           (found->pair.weight[k] == 1.0 ? triangle_corner_is_local(v, k, gap, lean)
                                         : !leads_nearer(inward, gap, lean));
}

int dpti_hull_pair_is_local(const struct hull_place *place, const vec3 v[3], const struct hull_pair *found, double lean)
{
    const vec3 gap = found->pair.gap;
    if (found->feature < HULL_EDGE)
        return corner_is_local(place, found->feature - HULL_CORNER, scaled(gap, -1.0), lean);
    if (found->feature < HULL_FACE)
        return edges_are_local(place, (found->feature - HULL_EDGE) / 3, (found->feature - HULL_EDGE) % 3, v, found,
                               lean);
    return triangle_corner_is_local(v, (found->feature - HULL_FACE) % 3, gap, lean);
}

struct best {
    struct hull_pair pair;
    double limit; /* m: the distance of the pair, or what it must be below */
};

static void take_best(void *user, const struct hull_pair *found)
{
    struct best *best = user;
    if (!(found->pair.distance2 < best->pair.pair.distance2))
        return;
    best->pair = *found;
    best->limit = sqrt(found->pair.distance2);
}

/* Whether a plane across the pair parts the two: then they do not meet. */
static int is_parted(const struct hull_place *place, const vec3 v[3], vec3 gap)
{
    const double low = -support_of(place->corner, place->hull->corner_count, scaled(gap, -1.0));
    return low > support_of(v, 3, gap);
}

static int crosses_face(const struct hull_place *place, uint32_t face, const vec3 v[3], uint32_t k,
                        struct hull_pair *found)
{
    const vec3 from = v[k], to = v[(k + 1) % 3];
    const double low = height_over(place, face, from), high = height_over(place, face, to);
    if (!((low <= 0.0 && high >= 0.0) || (low >= 0.0 && high <= 0.0)) || low == high)
        return 0;
    const double t = clamp01(low / (low - high));
    if (!is_over_face(place, face, along(from, t, sub(to, from))))
        return 0;
    found->pair.weight[k] = 1.0 - t;
    found->pair.weight[(k + 1) % 3] = t;
    return 1;
}

/* Whether hull and triangle meet, and where: an edge of one goes through the other, or the hull holds a corner. */
static int meets(const struct hull_place *place, const struct ball *ball, struct hull_pair *found)
{
    const struct dpt_hull *hull = place->hull;
    const vec3 *v = ball->v;
    *found = (struct hull_pair){ .feature = DPT_NONE };
    int is_inside = !hull->is_flat;
    for (uint32_t f = 0; f < hull->face_count; f++)
        for (uint32_t k = 0; k < 3; k++) {
            is_inside &= k != 0 || height_over(place, f, v[0]) <= 0.0;
            if (crosses_face(place, f, v, k, found))
                return 1;
        }
    found->pair.weight[0] = 1.0;
    if (is_inside)
        return 1;
    for (uint32_t e = 0; e < hull->edge_count; e++) {
        const vec3 a = place->corner[hull->edge[e][0]];
        const vec3 u = sub(place->corner[hull->edge[e][1]], a);
        const pair through = segment_triangle(a, u, v[0], v[1], v[2]);
        if (through.distance2 > 0.0)
            continue;
        /* Where the edge nearly lies in the triangle's plane, its own point is the more accurate one. */
        point_triangle(along(a, through.s, u), v, &found->pair);
        found->pair.s = found->pair.distance2 = 0.0;
        found->pair.gap = (vec3){ 0.0, 0.0, 0.0 };
        return 1;
    }
    return 0;
}

/* The nearest of all features that are nearer than `limit`; 0: there is none. */
static int find_best(const struct hull_place *place, const struct ball *ball, double limit, struct hull_pair *found)
{
    struct best best = { { { .distance2 = limit * limit }, DPT_NONE }, limit };
    visit_features(place, ball, &best.limit, take_best, &best);
    *found = best.pair;
    if (found->feature == DPT_NONE)
        return 0;
    pair_snap_to_zero(&found->pair, extent_of(place->corner[0]) + extent_of(ball->v[0]) + extent_of(ball->edge[0]) +
                                        extent_of(ball->edge[2]));
    return 1;
}

int dpti_hull_triangle_apart(const struct hull_place *place, const vec3 v[3], double limit, struct hull_pair *found)
{
    const struct ball ball = ball_of(v);
    return find_best(place, &ball, limit, found);
}

/* What rounding of the features may add to the upper bound: shares of the bound and of the largest coordinate. */
#define BOUND_SPARE    1e-6
#define BOUND_ROUNDING 0x1p-40

int dpti_hull_triangle(const struct hull_place *place, const vec3 v[3], double limit, struct hull_pair *found)
{
    const struct ball ball = ball_of(v);
    const uint32_t count = place->hull->corner_count;
    struct hull_pair met;
    const double s = nearest_on(place->a, place->u, ball.middle);
    vec3 n = sub(ball.middle, along(place->a, s, place->u));
    const double upper = dpti_distance_upper(place->corner, count, v, 3, limit, &n);
    if (upper == HUGE_VAL)
        return 0;
    const double rounding = BOUND_ROUNDING * (extent_of(place->corner[0]) + extent_of(v[0]));
    const double likely = min_of(limit, upper * (1.0 + BOUND_SPARE) + rounding);
    int has_pair = find_best(place, &ball, likely, found);
    if (has_pair && (found->pair.distance2 == 0.0 || is_parted(place, v, found->pair.gap)))
        return 1;
    if (meets(place, &ball, &met)) {
        *found = met;
        return limit > 0.0;
    }
    return has_pair || find_best(place, &ball, limit, found);
}
