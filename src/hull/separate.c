/* SPDX-License-Identifier: BSD-3-Clause */
#include "hull/separate.h"

enum { ITERATIONS_MAX = 32 };

/* Of the distance: what an iteration must gain, or it is the last. */
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
    double most = dot(n, points[0]);
    for (uint32_t i = 1; i < count; i++) {
        const double at = dot(n, points[i]);
        if (at > most) {
            most = at;
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

/* Of the distance: a bracket that is so narrow will do. */
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
