/* SPDX-License-Identifier: BSD-3-Clause */
#include "oracle/ball_path.h"

#include <stdlib.h>
#include <string.h>

#include "lib/vector.h"

enum { PUSHES_MAX = 200, NORMALS_MAX = 64 };

#define STEP     1e-6 /* m */
#define LISTED   2e-3 /* m, beyond the radius */
#define TOUCHING 1e-5 /* of the radius: so near is touching */
#define PUSHED   1e-6 /* of the radius: no deeper than that is outside */
#define SAME     1e-12
#define GAIN     1e-12 /* of the distance */

int ball_path_open(struct ball_path *path, const float *corners, uint32_t count, double radius, const double at[3])
{
    *path = (struct ball_path){ .corners = corners, .count = count, .radius = radius, .listed_reach = -1 };
    memcpy(path->at, at, sizeof path->at);
    path->listed = malloc((count + 1) * sizeof *path->listed);
    return path->listed != NULL;
}

void ball_path_close(struct ball_path *path)
{
    free(path->listed);
}

/* The point of a segment nearest to x. */
static void nearest_on(const double a[3], const double b[3], const double x[3], double q[3])
{
    double u[3], v[3];
    for (int k = 0; k < 3; k++) {
        u[k] = b[k] - a[k];
        v[k] = x[k] - a[k];
    }
    const double size = dot3(u, u), s = size > 0 ? fmin(1, fmax(0, dot3(u, v) / size)) : 0;
    for (int k = 0; k < 3; k++)
        q[k] = a[k] + s * u[k];
}

/* The distance to a triangle; away: the unit way from its nearest point to x. */
static double distance_to(const struct ball_path *path, uint32_t triangle, const double x[3], double away[3])
{
    double c[3][3], u[3], v[3], w[3], n[3], q[3], best = INFINITY;
    for (int k = 0; k < 9; k++)
        c[k / 3][k % 3] = (double)path->corners[9 * (size_t)triangle + (size_t)k];
    for (int k = 0; k < 3; k++) {
        u[k] = c[1][k] - c[0][k];
        v[k] = c[2][k] - c[0][k];
        w[k] = x[k] - c[0][k];
    }
    cross3(u, v, n);
    const double square = dot3(n, n);
    double side[3];
    cross3(w, v, side);
    const double s = square > 0 ? dot3(side, n) / square : -1;
    cross3(u, w, side);
    const double t = square > 0 ? dot3(side, n) / square : -1;
    if (s >= 0 && t >= 0 && s + t <= 1) {
        const double height = dot3(w, n) / sqrt(square);
        for (int k = 0; k < 3; k++)
            away[k] = (height < 0 ? -1 : 1) * n[k] / sqrt(square);
        return fabs(height);
    }
    for (int e = 0; e < 3; e++) {
        double way[3];
        nearest_on(c[e], c[(e + 1) % 3], x, q);
        for (int k = 0; k < 3; k++)
            way[k] = x[k] - q[k];
        const double far = unit3(way);
        if (far < best) {
            best = far;
            memcpy(away, way, sizeof way);
        }
    }
    return best;
}

/* List what is near x, unless the list has all that could be touched there. */
static void list_near(struct ball_path *path, const double x[3])
{
    if (apart(x, path->listed_at) + path->radius + 2 * STEP < path->listed_reach)
        return;
    memcpy(path->listed_at, x, sizeof path->listed_at);
    path->listed_reach = path->radius + LISTED;
    path->listed_count = 0;
    for (uint32_t i = 0; i < path->count; i++) {
        const float *c = path->corners + 9 * (size_t)i;
        int is_far = 0;
        for (int k = 0; k < 3; k++) {
            const double low = fmin((double)c[k], fmin((double)c[3 + k], (double)c[6 + k]));
            const double high = fmax((double)c[k], fmax((double)c[3 + k], (double)c[6 + k]));
            is_far |= low - x[k] > path->listed_reach || x[k] - high > path->listed_reach;
        }
        if (!is_far)
            path->listed[path->listed_count++] = i;
    }
}

/* The planes that it touches, each once. */
static int touched_planes(struct ball_path *path, const double x[3], double normals[NORMALS_MAX][3])
{
    int count = 0;
    list_near(path, x);
    for (uint32_t i = 0; i < path->listed_count && count < NORMALS_MAX; i++) {
        double *n = normals[count];
        if (distance_to(path, path->listed[i], x, n) > (1 + TOUCHING) * path->radius)
            continue;
        int is_new = 1;
        for (int k = 0; k < count; k++)
            is_new &= 1 - dot3(normals[k], n) > SAME;
        count += is_new;
    }
    return count;
}

static int violates(double normals[][3], int count, const double v[3], int but, int or_but)
{
    for (int i = 0; i < count; i++)
        if (i != but && i != or_but && dot3(normals[i], v) < 0)
            return 1;
    return 0;
}

/* Keep the longer of two ways. */
static void take_longer(double best[3], const double v[3])
{
    if (dot3(v, v) > dot3(best, best))
        memcpy(best, v, 3 * sizeof *v);
}

/* What the planes leave of a pull. */
static void project(double normals[][3], int count, const double pull[3], double free_pull[3])
{
    memset(free_pull, 0, 3 * sizeof *free_pull);
    if (!violates(normals, count, pull, -1, -1)) {
        memcpy(free_pull, pull, 3 * sizeof *pull);
        return;
    }
    for (int i = 0; i < count; i++) {
        double along[3], line[3];
        const double into = dot3(normals[i], pull);
        for (int k = 0; k < 3; k++)
            along[k] = pull[k] - into * normals[i][k];
        if (into < 0 && !violates(normals, count, along, i, -1))
            take_longer(free_pull, along);
        for (int j = 0; j < i; j++) {
            cross3(normals[i], normals[j], line);
            if (unit3(line) < 1e-9)
                continue;
            const double share = dot3(line, pull);
            for (int k = 0; k < 3; k++)
                along[k] = share * line[k];
            if (!violates(normals, count, along, i, j))
                take_longer(free_pull, along);
        }
    }
}

/* Push it out of what it is in. 0: there is no way out. */
static int push_out(struct ball_path *path, double x[3])
{
    for (int k = 0; k < PUSHES_MAX; k++) {
        double deepest = path->radius, out[3] = { 0, 0, 0 };
        list_near(path, x);
        for (uint32_t i = 0; i < path->listed_count; i++) {
            double away[3];
            const double distance = distance_to(path, path->listed[i], x, away);
            if (distance < deepest) {
                deepest = distance;
                memcpy(out, away, sizeof out);
            }
        }
        if (deepest >= (1 - PUSHED) * path->radius)
            return 1;
        for (int i = 0; i < 3; i++)
            x[i] += (path->radius - deepest) * out[i];
    }
    return 0;
}

/* One step of that length at most. 0: it comes no nearer. */
static int step(struct ball_path *path, const double device[3], double longest)
{
    double normals[NORMALS_MAX][3], pull[3], way[3], to[3];
    const double far = apart(device, path->at);
    for (int k = 0; k < 3; k++)
        pull[k] = device[k] - path->at[k];
    project(normals, touched_planes(path, path->at, normals), pull, way);
    const double size = length3(way);
    if (!(size > 0))
        return 0;
    for (int k = 0; k < 3; k++)
        to[k] = path->at[k] + fmin(1, longest / size) * way[k];
    if (!push_out(path, to) || !(apart(device, to) < (1 - GAIN) * far))
        return 0;
    memcpy(path->at, to, sizeof to);
    path->steps++;
    return 1;
}

int ball_path_follow(struct ball_path *path, const double device[3], double longest)
{
    const double most = fmin(STEP, 0.5 * path->radius);
    double gone = 0;
    while (gone < longest) {
        const double from[3] = { path->at[0], path->at[1], path->at[2] };
        if (!step(path, device, most) && !step(path, device, most / 16))
            return 1;
        gone += apart(from, path->at);
    }
    return 0;
}
