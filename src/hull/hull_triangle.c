/* SPDX-License-Identifier: BSD-3-Clause */
#include "hull/hull_triangle.h"

#include "hull/separate.h"

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

/* Whether a way along `way` leads nearer than the lean allows; toward: from where it begins to the other point. */
static int leads_nearer(vec3 way, vec3 toward, double lean)
{
    const double rise = dot(way, toward);
    return rise > 0.0 && rise * rise > lean * lean * dot(way, way) * dot(toward, toward);
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

/* Of the upper bound, and of the coordinates: what the features' own rounding may add to it. */
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
