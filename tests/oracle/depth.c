/* SPDX-License-Identifier: BSD-3-Clause */
/* The depth of depth.h. */
#include "oracle/depth.h"

#include <math.h>
#include <string.h>

double oracle_winding(const struct oracle_solid *solid, const double x[3])
{
    double sum = 0;
    for (uint32_t t = 0; t < solid->triangles; t++) {
        const float *corner = solid->corners + 9 * (size_t)t;
        double v[3][3], far[3], along[3];
        for (int i = 0; i < 3; i++) {
            for (int k = 0; k < 3; k++)
                v[i][k] = (double)corner[3 * i + k] - x[k];
            far[i] = sqrt(v[i][0] * v[i][0] + v[i][1] * v[i][1] + v[i][2] * v[i][2]);
        }
        for (int i = 0; i < 3; i++) {
            const double *a = v[i], *b = v[(i + 1) % 3];
            along[i] = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        }
        const double volume = v[0][0] * (v[1][1] * v[2][2] - v[1][2] * v[2][1]) +
                              v[0][1] * (v[1][2] * v[2][0] - v[1][0] * v[2][2]) +
                              v[0][2] * (v[1][0] * v[2][1] - v[1][1] * v[2][0]);
        sum += 2 * atan2(volume, far[0] * far[1] * far[2] + along[0] * far[2] + along[1] * far[0] + along[2] * far[1]);
    }
    return sum / (4 * 3.14159265358979323846);
}

/* A point of the axis; `side` is -1 inside, +1 outside, 0 on the surface. */
struct point {
    double s, distance;
    uint32_t triangle;
    int side;
};

struct piece {
    struct point from, to;
};

struct search {
    const struct oracle_solid *solid;
    const double *segment;
    double length;
    uint32_t points;
};

static void at(const struct search *search, double s, double x[6])
{
    for (int k = 0; k < 3; k++)
        x[k] = x[3 + k] = search->segment[k] + s * (search->segment[3 + k] - search->segment[k]);
}

static int side_of(const struct oracle_solid *solid, const double x[3], double distance)
{
    if (distance <= 1e-10 * solid->extent)
        return 0;
    return fabs(oracle_winding(solid, x)) > 0.5 ? -1 : 1;
}

/* `beside` is a point whose side is known, or NULL: no surface is within its distance of it. */
static struct point look(struct search *search, double s, const struct point *beside)
{
    struct point point = { .s = s };
    double x[6];
    at(search, s, x);
    search->points++;
    point.distance = oracle_brute(search->solid->mesh, x, &point.triangle);
    const double away = beside ? fabs(s - beside->s) * search->length : 0;
    if (beside && beside->side && point.distance > 1e-10 * search->solid->extent &&
        away < fmax(beside->distance, point.distance) * (1 - 1e-9))
        point.side = beside->side;
    else
        point.side = side_of(search->solid, x, point.distance);
    return point;
}

double oracle_signed(const struct oracle_solid *solid, const double x[3])
{
    const double point[6] = { x[0], x[1], x[2], x[0], x[1], x[2] };
    const double distance = oracle_brute(solid->mesh, point, NULL);
    return side_of(solid, x, distance) < 0 ? -distance : distance;
}

/* No point of the piece is farther from the mesh; `s` is where the chords meet. */
static double bound_of(const struct search *search, const struct piece *piece, double *s)
{
    double x[6], most = fmax(piece->from.distance, piece->to.distance);
    at(search, piece->to.s, x);
    const double beyond = oracle_brute_triangle(search->solid->mesh, piece->from.triangle, x) - piece->to.distance;
    at(search, piece->from.s, x);
    const double before = oracle_brute_triangle(search->solid->mesh, piece->to.triangle, x) - piece->from.distance;
    double share = 0.5;
    if (before > 0 && beyond > 0) {
        share = before / (before + beyond);
        most = fmax(most, piece->from.distance + share * (piece->to.distance + beyond - piece->from.distance));
    }
    share = share < 0.1 ? 0.1 : share > 0.9 ? 0.9 : share;
    *s = piece->from.s + share * (piece->to.s - piece->from.s);
    return most;
}

static int is_outside(const struct search *search, const struct piece *piece)
{
    const double length = (piece->to.s - piece->from.s) * search->length;
    return piece->from.side > 0 && piece->to.side > 0 &&
           piece->from.distance + piece->to.distance > length * (1 + 1e-9);
}

static void note(struct oracle_least *least, const struct point *point)
{
    const double height = point->side < 0 ? -point->distance : point->distance;
    least->inside |= point->side < 0;
    if (height < least->high) {
        least->high = height;
        least->s = point->s;
    }
}

enum { PIECES = 256 };

struct oracle_least oracle_least(const struct oracle_solid *solid, const double segment[6], double tolerance)
{
    struct search search = { .solid = solid, .segment = segment };
    struct oracle_least least = { .high = INFINITY };
    struct piece pieces[PIECES];
    int count = 0;
    double square = 0;
    for (int k = 0; k < 3; k++)
        square += (segment[3 + k] - segment[k]) * (segment[3 + k] - segment[k]);
    search.length = sqrt(square);
    const double nearest = oracle_brute(solid->mesh, segment, NULL);
    least.crosses = nearest <= 1e-13 * solid->extent;
    struct piece whole;
    whole.from = look(&search, 0, NULL);
    whole.to = look(&search, 1, &whole.from);
    note(&least, &whole.from);
    note(&least, &whole.to);
    if (!least.crosses && whole.from.side > 0) {
        least.low = least.high = nearest;
        least.points = search.points;
        return least;
    }
    if (least.crosses)
        least.high = fmin(least.high, nearest);
    least.low = least.high;
    pieces[count++] = whole;
    while (count > 0) {
        const struct piece piece = pieces[--count];
        double s;
        const double bound = bound_of(&search, &piece, &s);
        if (is_outside(&search, &piece))
            continue;
        if (-bound >= least.high - tolerance || count + 2 > PIECES || search.points > 200000 ||
            !(s > piece.from.s && s < piece.to.s)) {
            least.low = fmin(least.low, -bound);
            continue;
        }
        const struct point *known = piece.from.side ? &piece.from : &piece.to;
        const struct point middle = look(&search, s, known);
        note(&least, &middle);
        /* The half that reaches deeper comes next. */
        const int first = piece.from.distance < piece.to.distance;
        pieces[count + first] = (struct piece){ middle, piece.to };
        pieces[count + !first] = (struct piece){ piece.from, middle };
        count += 2;
    }
    least.low = fmin(least.low, least.high);
    least.points = search.points;
    return least;
}
