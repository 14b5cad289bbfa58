/* SPDX-License-Identifier: BSD-3-Clause */
#include "convex/convex_pair.h"

#include <ccd/ccd.h>
#include <string.h>

#include "dynpoint/query.h"

/*
 * libccd's penetration has no limit on the number of support points. After this many it gets the origin, which ends its
 * search, and its result is refused.
 */
enum { POINTS_MAX = 400, ITERATIONS_MAX = 100, DESCENTS = 24, PARTINGS = 60 };

/*
 * libccd's own, in its units: those of EPA are lengths times the depth, so that it must be far below what is asked of
 * the depth.
 */
#define TOLERANCE 1e-7

/* The square of a distance that is rounding. */
#define SAME 1e-24

/* No shape is deeper than its own width, 2 sizes. */
#define DEPTH_MAX 2.0

vec3 dpti_convex_place_support(const struct convex_place *place, vec3 d)
{
    const struct convex_body *body = place->body;
    const vec3 p = dpti_convex_support(body, frame_turn_back(&place->frame, d));
    return scaled(frame_turn(&place->frame, sub(p, body->centre)), 1.0 / body->size);
}

static vec3 support_of_piece(const struct convex_piece *piece, vec3 d)
{
    const vec3 far = convex_farthest(piece->points, piece->count, d);
    const int is_behind = piece->has_front && dot(piece->front, d) < 0.0;
    return is_behind ? along(far, -CONVEX_BEHIND, piece->front) : far;
}

double dpti_convex_width(const struct convex_place *place, const struct convex_piece *piece, vec3 n)
{
    const vec3 back = scaled(n, -1.0);
    return dot(n, sub(support_of_piece(piece, n), dpti_convex_place_support(place, back)));
}

/* The unit vector along n; one that leads behind a piece is turned as far as its border. 0 where there is none. */
static vec3 turned_ahead(const struct convex_piece *piece, vec3 n)
{
    const vec3 unit = unit_of(n);
    const double ahead = dot(unit, piece->front);
    return piece->has_front && ahead < 0.0 ? unit_of(along(unit, -ahead, piece->front)) : unit;
}

/* ---- libccd ---- */

/* One of the two convex sets that libccd is given. */
struct side {
    const struct convex_place *place; /* or */
    const struct convex_piece *piece;
    vec3 centre, first;
    uint32_t *points; /* that were asked of both sets so far */
};

static void give_point(const void *user, const ccd_vec3_t *direction, ccd_vec3_t *point)
{
    const struct side *side = user;
    const vec3 d = { direction->v[0], direction->v[1], direction->v[2] };
    vec3 p = { 0.0, 0.0, 0.0 };
    if (++*side->points <= POINTS_MAX && vec3_within(direction->v, HUGE_VAL))
        p = side->place ? dpti_convex_place_support(side->place, d) : support_of_piece(side->piece, d);
    else
        *side->points = POINTS_MAX + 1;
    ccdVec3Set(point, p.x, p.y, p.z);
}

static void give_centre(const void *user, ccd_vec3_t *centre)
{
    const struct side *side = user;
    ccdVec3Set(centre, side->centre.x, side->centre.y, side->centre.z);
}

/* Where its simplex begins: answers that are wrong for one beginning are right for another as a rule. */
static void give_first_direction(const void *one, const void *other, ccd_vec3_t *direction)
{
    const struct side *side = one;
    (void)other;
    ccdVec3Set(direction, side->first.x, side->first.y, side->first.z);
}

static vec3 middle_of(const struct convex_piece *piece)
{
    vec3 sum = { 0.0, 0.0, 0.0 };
    for (uint32_t i = 0; i < piece->count; i++)
        sum = along(sum, 1.0 / piece->count, piece->points[i]);
    return piece->has_front ? along(sum, -0.5 * CONVEX_BEHIND, piece->front) : sum;
}

static void prepare(ccd_t *ccd)
{
    CCD_INIT(ccd);
    ccd->first_dir = give_first_direction;
    ccd->support1 = ccd->support2 = give_point;
    ccd->center1 = ccd->center2 = give_centre;
    ccd->max_iterations = ITERATIONS_MAX;
    ccd->epa_tolerance = TOLERANCE;
    ccd->mpr_tolerance = TOLERANCE;
    ccd->dist_tolerance = TOLERANCE;
}

/*
 * The check of an answer: it is a direction and a length, it does not lead behind the piece, and the planes across it
 * prove that the motion suffices.
 */
static void check(const struct convex_place *place, const struct convex_piece *piece, double depth,
                  const ccd_vec3_t *direction, struct convex_said *said)
{
    const vec3 n = { direction->v[0], direction->v[1], direction->v[2] };
    const double size = length(n);
    said->is_refused = 1;
    if (!(fabs(size - 1.0) <= 1e-6) || !(depth >= 0.0 && depth <= DEPTH_MAX))
        return;
    said->direction = turned_ahead(piece, n);
    if (!(dot(said->direction, said->direction) > 0.0))
        return;
    said->depth = dpti_convex_width(place, piece, said->direction);
    said->is_refused = !(said->depth <= depth + 10.0 * CONVEX_TOLERANCE);
    said->depth = max_of(said->depth, 0.0);
}

/* Whether the two meet, as one algorithm says. */
static int says_that_they_meet(const struct convex_place *place, const struct convex_piece *piece, int algorithm,
                               vec3 first)
{
    ccd_t ccd;
    uint32_t points = 0;
    const struct side shape = { .place = place, .points = &points };
    const struct side surface = { .piece = piece, .centre = middle_of(piece), .first = first, .points = &points };
    prepare(&ccd);
    return algorithm == CONVEX_MPR ? ccdMPRIntersect(&surface, &shape, &ccd) : ccdGJKIntersect(&surface, &shape, &ccd);
}

void dpti_convex_ask(const struct convex_place *place, const struct convex_piece *piece, int algorithm, vec3 first,
                     struct convex_said *said)
{
    ccd_t ccd;
    ccd_real_t depth = NAN;
    ccd_vec3_t direction, point;
    uint32_t points = 0;
    const struct side shape = { .place = place, .points = &points };
    const struct side surface = { .piece = piece, .centre = middle_of(piece), .first = first, .points = &points };
    prepare(&ccd);
    ccdVec3Set(&direction, NAN, NAN, NAN);
    ccdVec3Set(&point, NAN, NAN, NAN);
    memset(said, 0, sizeof *said);
    const int result = algorithm == CONVEX_MPR ? ccdMPRPenetration(&surface, &shape, &ccd, &depth, &direction, &point)
                                               : ccdGJKPenetration(&surface, &shape, &ccd, &depth, &direction, &point);
    said->meets = result == 0;
    said->is_refused = result == -2 || points > POINTS_MAX;
    if (result != 0 || said->is_refused)
        return;
    check(place, piece, depth, &direction, said);
    if (algorithm == CONVEX_EPA && !said->is_refused)
        said->min_depth = min_of(depth, said->depth);
}

/* ---- our own ---- */

/*
 * A direction that needs a shorter motion than n, by steps down the width's slope, which across n is that of the two
 * farthest points; at most `steps` of them. Ends where the width is 0 or less.
 */
static double descend(const struct convex_place *place, const struct convex_piece *piece, int steps, vec3 *n)
{
    double width = dpti_convex_width(place, piece, *n), stride = 1.0;
    for (int i = 0; i < steps && width > 0.0 && stride > 1e-6; i++) {
        const vec3 gap = sub(support_of_piece(piece, *n), dpti_convex_place_support(place, scaled(*n, -1.0)));
        const vec3 next = turned_ahead(piece, along(*n, -stride, along(gap, -dot(gap, *n), *n)));
        const double there = dpti_convex_width(place, piece, next);
        if (there < width && dot(next, next) > 0.0) {
            width = there;
            *n = next;
            stride *= 1.5;
        } else
            stride *= 0.5;
    }
    return width;
}

/* How libccd is asked, one attempt after the other. */
static const struct {
    int algorithm;
    double across; /* its first direction is the first guess plus this much of a vector across */
} turns[] = { { CONVEX_EPA, 0.1 }, { CONVEX_EPA, -3.0 }, { CONVEX_EPA, 0.9 }, { CONVEX_MPR, 0.0 } };

enum { TURNS = 4 };

static vec3 first_of(int turn, vec3 towards)
{
    vec3 across[2];
    unit_across(towards, across);
    return along(along(towards, turns[turn].across, across[0]), 0.7 * turns[turn].across, across[1]);
}

/* What a search for a plane between the two ends with. */
enum parting { PARTED, MET, OPEN };

/* Whether the origin is in a tetrahedron that has a volume. */
static int holds_origin(const vec3 p[4])
{
    int signs = 0;
    for (int i = 0; i < 4; i++) {
        const vec3 a = p[(i + 1) % 4], b = p[(i + 2) % 4], c = p[(i + 3) % 4];
        const vec3 n = cross(sub(b, a), sub(c, a));
        const double here = -dot(n, a), there = dot(n, sub(p[i], a));
        signs += (here > 0.0 && there > 0.0) || (here < 0.0 && there < 0.0);
    }
    return signs == 4;
}

/* The nearest point to the origin of a triangle, which may be flat. */
static vec3 nearest_of(const vec3 p[3])
{
    const double origin[6] = { 0.0, 0.0, 0.0, 0.0, 0.0, 0.0 };
    double corners[9], q[3];
    for (int k = 0; k < 3; k++)
        vec3_store(p[k], corners + 3 * k);
    dpt_segment_triangle(origin, corners, NULL, NULL, q);
    return vec3_of(q);
}

/*
 * Look for a plane between the two, by the nearest point to the origin among their differences (as Gilbert, Johnson and
 * Keerthi, 1988): three of these are kept, each step adds the farthest one towards the origin, and the nearest of the
 * triangles with it stays. Degenerate ones do no harm, as dpt_segment_triangle takes any. PARTED is proven by the
 * plane, MET by four differences around the origin, or one at it; OPEN is left where rounding ends it. *n becomes the
 * exit direction that it was led to.
 */
static enum parting part(const struct convex_place *place, const struct convex_piece *piece, vec3 *n)
{
    vec3 v = sub(support_of_piece(piece, *n), dpti_convex_place_support(place, scaled(*n, -1.0)));
    vec3 p[4] = { v, v, v, v };
    for (int i = 0; i < PARTINGS && dot(v, v) > SAME; i++) {
        vec3 nearest = v;
        int dropped = -1;
        *n = scaled(unit_of(v), -1.0);
        p[3] = sub(support_of_piece(piece, *n), dpti_convex_place_support(place, unit_of(v)));
        if (dot(v, p[3]) > 0.0)
            return PARTED;
        if (holds_origin(p))
            return MET;
        for (int k = 0; k < 3; k++) {
            const vec3 with[3] = { p[3], p[(k + 1) % 3], p[(k + 2) % 3] };
            const vec3 q = nearest_of(with);
            if (dot(q, q) < dot(nearest, nearest)) {
                nearest = q;
                dropped = k;
            }
        }
        if (dropped < 0)
            break;
        p[dropped] = p[3];
        v = nearest;
    }
    return dot(v, v) > SAME ? OPEN : MET;
}

int dpti_convex_meets(const struct convex_place *place, const struct convex_piece *piece, vec3 towards,
                      struct convex_tally *tally)
{
    vec3 n = towards;
    const enum parting parting = part(place, piece, &n);
    if (parting != OPEN)
        return parting == MET;
    for (int i = 0; i < TURNS; i++) {
        tally->asked++;
        if (says_that_they_meet(place, piece, turns[i].algorithm, first_of(i, n)))
            return 1;
    }
    return 0;
}

static void take(struct convex_exit *found, vec3 direction, double depth)
{
    if (!(depth < found->depth))
        return;
    found->direction = direction;
    found->depth = max_of(0.0, depth);
}

/* Directions that do not lead behind the piece, and the widths along them. */
enum { LEANS = 3, AROUND = 8, GUESSES = 2 + LEANS * AROUND };

struct guesses {
    vec3 direction[GUESSES];
    double width[GUESSES];
};

static void guess(const struct convex_place *place, const struct convex_piece *piece, vec3 towards,
                  struct guesses *guesses)
{
    static const double lean[LEANS][2] = { { 0.866, 0.5 }, { 0.5, 0.866 }, { 0.0, 1.0 } };
    static const double around[AROUND][2] = { { 1, 0 },  { 0.7071, 0.7071 },   { 0, 1 },  { -0.7071, 0.7071 },
                                              { -1, 0 }, { -0.7071, -0.7071 }, { 0, -1 }, { 0.7071, -0.7071 } };
    vec3 across[2];
    unit_across(piece->front, across);
    guesses->direction[0] = piece->front;
    guesses->direction[1] = turned_ahead(piece, towards);
    if (!(dot(guesses->direction[1], guesses->direction[1]) > 0.0))
        guesses->direction[1] = piece->front;
    for (int i = 0; i < LEANS * AROUND; i++) {
        const double *a = around[i % AROUND], *b = lean[i / AROUND];
        const vec3 level = along(scaled(across[0], a[0]), a[1], across[1]);
        guesses->direction[2 + i] = unit_of(along(scaled(level, b[1]), b[0], piece->front));
    }
    for (int i = 0; i < GUESSES; i++)
        guesses->width[i] = dpti_convex_width(place, piece, guesses->direction[i]);
}

/* Go down from the best guesses, `starts` of them, each well apart from those before. */
static void go_down(const struct convex_place *place, const struct convex_piece *piece, int starts,
                    struct guesses *guesses, struct convex_exit *found)
{
    for (int k = 0; k < starts; k++) {
        int best = -1;
        for (int i = 0; i < GUESSES; i++)
            if (guesses->width[i] < HUGE_VAL && (best < 0 || guesses->width[i] < guesses->width[best]))
                best = i;
        if (best < 0)
            return;
        const vec3 from = guesses->direction[best];
        vec3 n = from;
        const double width = descend(place, piece, DESCENTS, &n);
        take(found, n, width);
        for (int i = 0; i < GUESSES; i++)
            if (dot(guesses->direction[i], from) > 0.8)
                guesses->width[i] = HUGE_VAL;
    }
}

void dpti_convex_exit(const struct convex_place *place, const struct convex_piece *piece, vec3 towards,
                      struct convex_tally *tally, struct convex_exit *found)
{
    struct convex_said said = { 0 };
    struct guesses guesses;
    double min_depth = 0.0;
    int stood = 0;
    vec3 n;
    /* Ways of our own: along the piece's front there always is one. They are the bar that libccd's must pass. */
    *found = (struct convex_exit){ .depth = HUGE_VAL };
    guess(place, piece, towards, &guesses);
    take(found, guesses.direction[0], guesses.width[0]);
    go_down(place, piece, 2, &guesses, found);
    for (int i = 0; i < TURNS && !stood; i++) {
        dpti_convex_ask(place, piece, turns[i].algorithm, first_of(i, found->direction), &said);
        tally->asked++;
        /* The piece is met: that it is not, or only by a longer way than is known, is wrong. */
        stood = said.meets && !said.is_refused && said.depth <= found->depth + CONVEX_TOLERANCE;
        if (stood) {
            /* It is wrong where a motion in a direction beside it is shorter. */
            n = said.direction;
            const double beside = descend(place, piece, DESCENTS / 2, &n);
            stood = beside >= said.depth - CONVEX_TOLERANCE;
            take(found, n, beside);
        }
        tally->refused += (uint32_t)!stood;
        if (stood) {
            min_depth = said.min_depth;
            take(found, said.direction, said.depth);
        }
    }
    found->is_own = !stood;
    if (!(min_depth > 0.0))
        go_down(place, piece, GUESSES, &guesses, found);
    found->error = found->depth - min_of(found->depth, min_depth);
}
